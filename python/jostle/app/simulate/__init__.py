"""Simulations, in reading order.

======================= ========================================================================
validation, settings    rules for values and their messages; the settings of a simulation
simulation              the protocol of simulations; `Frame`, `StepStats`
packing                 values and arrays as bytes, and their checks
particle_table          the columns that the app keeps beside those of a world
forces                  between kinds, of walls, and to attractors of the user
containers              the container of a world, of any kind and size
wall_segments           line segments: the walls inside a container
placement               random directions, and free positions for discs
emitters                nozzles that add drops
world_frame             a world as a frame
world_simulation        `jostle.World` as a `Simulation`
article_state           the article's program as values and arrays, for saved states
article_simulation      `jostle.article.Simulation` as a `Simulation`
start                   a simulation from settings, from a state, or from one with other rules
history                 rewinding: snapshots, and re-simulation of the steps between them
worker, engine          a worker thread; steps and edits of a simulation on it, in real time
scene_loader            new simulations, made on a worker thread
======================= ========================================================================
"""
