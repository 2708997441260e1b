"""Simulations, in reading order.

======================= ========================================================================
validation, settings    rules for values and their messages; the settings of a simulation
frame                   `Frame` and `StepStats`: one state, and the numbers of a step
packing                 values and bytes packed together, and their checks
world_frame             the columns of a world that edits alone change; a world as a frame
forces                  between kinds, of walls, and to attractors of the user
wall_segments           line segments: the walls inside a container
containers              the container of a world, of any kind and size; free positions in it
emitters                nozzles that add drops
simulation              `Simulation`: a scene in a `jostle.World`
start                   a simulation from settings, with the walls and particles of a file
history                 rewinding: snapshots, and re-simulation of the steps between them
worker, engine          a worker thread; steps and edits of a simulation on it, in real time
scene_loader            new simulations, made on a worker thread
======================= ========================================================================
"""
