"""Simulations, in reading order.

======================= ========================================================================
rules, settings         what to simulate: the command, a file and the sliders have it in common
simulation              what the app asks of a simulation: the protocol, `Frame`, `Facts`
packing, checking       facts and arrays in one piece of bytes; what a saved state may hold
motors                  motors whose walls are removed or moved
walls, segments, room   a container of any kind and size; line segments; free places
chance, emitters        chance that is the same everywhere; nozzles that add drops
columns, copies         which row of a world is whom; more of the same where there is room
attractions             what a person lets attract the rest, as forces
world_frame             a world as a frame
world_state             a world in bytes, and back
world_simulation        `jostle.World` behind that protocol
article_simulation      `jostle.article.Simulation` behind that protocol
start, carry            from settings to a simulation; from one set of rules to the other
pace, engine            real time to whole steps; who steps, and in which thread
making                  very many particles are made while the old scene is still shown
======================= ========================================================================
"""
