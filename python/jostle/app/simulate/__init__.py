"""What runs, in reading order.

======================= ========================================================================
rules, settings         what to simulate: the command, a file and the sliders have it in common
simulation              what the app asks of a simulation: the protocol, `Frame`, `Facts`
packing                 facts and arrays in one piece of bytes, for states and scene files
walls, room             the walls of a world, of any kind and size; free places in it
chance, emitters        chance that is the same everywhere; nozzles that add drops
world_simulation        `jostle.World` behind that protocol
article_simulation      `jostle.article.Simulation` behind that protocol
start, carry            from settings to a simulation; from one set of rules to the other
pace, engine            real time to whole steps; who steps, and in which thread
======================= ========================================================================
"""
