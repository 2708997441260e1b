"""The simulator: a window on a world, or a film of it where there is no screen.

======================= ========================================================================
simulate                what runs: settings, worlds behind one protocol, who steps them and when
draw                    what is seen: two painters, the layers of a picture, words and numbers
measure                 times, pairs, energy and momentum over time
act                     what a person can do: keys, mouse, tools, menus, and deeds done to particles
keep                    what lasts: the last half minute, scene files, films, tables, TOML
race                    two methods side by side on the same scene
session                 all that a person has before them, without a window
gui, panels             the host of ImGui; the panels and menus built in it
window                  the interactive loop
headless, report        the run without a screen, and its table
tour                    a visitor who makes the pictures and films of the documents
======================= ========================================================================

Drawing reads a frame, copies of a simulation's columns, and never the simulation. What a person
does to it goes through `Session` to `Engine.edit`. The library proper never imports this package.
"""
