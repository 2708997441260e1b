"""Simulations, in reading order.

======================= ========================================================================
validation, settings    rules for values and their messages; the settings of a simulation
simulation              the protocol of simulations; `Frame`, `StepStats`
packing                 values and arrays as bytes
state_validation        checks of saved states
motors, kinds           motors whose walls change; kinds of particles, and their matrix
containers              the container of a world, of any kind and size
wall_segments           line segments: the walls inside a container
placement               free positions for discs
rng, emitters           random numbers that are the same on every machine; nozzles that add drops
particle_table          the columns that the app adds to those of a world
attractor_forces        attractors placed by the user, as forces
world_frame             a world as a frame
world_state             a world as bytes
world_simulation        `jostle.World` as a `Simulation`
article_simulation      `jostle.article.Simulation` as a `Simulation`
start, switch_rules     a simulation from settings; the other rules with the same particles
history                 rewinding: snapshots, and re-simulation of the steps between them
fixed_timestep          real time to steps of fixed length
worker, engine          a worker thread; steps and edits of a simulation on it
scene_loader            new simulations, made on a worker thread
======================= ========================================================================
"""
