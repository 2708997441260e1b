"""Simulations, in reading order.

======================= ========================================================================
validation, settings    rules for values and their messages; the settings of a simulation
region                  the container of a world, or its period
frame                   `Frame`: one state of a world, and the numbers of a step
forces                  between kinds, of walls, and to attractors of the user; the walls
containers              the container of a world, of any kind and size; free positions in it
simulation              `Simulation`: a scene in a `jostle.World`
start                   a simulation from settings, with the walls and particles of a file
history                 rewinding: snapshots, and re-simulation of the steps between them
engine                  steps, edits and new simulations on worker threads, in real time
======================= ========================================================================
"""
