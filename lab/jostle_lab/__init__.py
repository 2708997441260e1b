"""The simulator: a window, or a video if there is no display.

The packages and modules form layers. Each uses only those above it:

======================= ========================================================================
simulate                simulations, the engine that steps them, history
draw                    painters, and the layers of a frame
measure                 times, pairs, energy and momentum over time
act                     user actions: mouse, tools, commands on particles
race                    comparison of two methods on the same scene
runner                  scenes, settings and time of a session
storage                 scene files, videos, tables, TOML
session                 everything between the window and the simulation
gui                     the host of ImGui; the keymap and the input of the window
panels                  panels and menus, built with ImGui
window                  the interactive loop
headless                the run without a window, and its table
sweep                   runs of a scene with many settings and seeds
tune                    a map of the times of the search over leaf capacity and depth
cli                     the command `jostle`
======================= ========================================================================

Below all of them are `schema` (the settings), `interrupt` (Ctrl-C), `launcher` (the number of
ranks) and `article` (the programs of 2015). `pyproject.toml` of the repository has these rules, and
`make lint` checks them.

Drawing reads frames, which are copies of a simulation's columns, and never the simulation. The user
changes it through `Engine.edit`. The library never imports this package.
"""
