"""The simulator: a window on a world, or a film of it where there is no screen.

In reading order; each file uses only files above it:

======================= ========================================================================
palette                 every colour, in one place
rules, settings         what to simulate: the command, a file and the sliders have it in common
packing                 facts and arrays in one piece of bytes, for states and scene files
simulation              what the app asks of a simulation: the protocol, `Frame`, `Facts`
walls, room             the walls of a world, of any kind and size; free places in it
emitters                nozzles that add drops
world_simulation        `jostle.World` behind that protocol
article_simulation      `jostle.article.Simulation` behind that protocol
start, carry            from settings to a simulation; from one set of rules to the other
camera                  world to screen and back, pan and zoom
painter                 what can be drawn, whoever draws it
stamps, dust, strips, software  the painter that needs no graphics card
shaders, opengl         the painter on a graphics card
renderers               which of the two, and its window
words, text, legend     words on the screen; small cards that say what colours mean
stage, overlays         ground, walls and discs; the boxes of the tree
choosing                which few of many to draw
marks, trails, labels   contacts, velocities, springs, attractors; past ways; words at discs
extras                  what single scenes show beyond their particles
shown                   the switches of what is shown
colouring               which particle gets which colour
picture                 all layers in their order: the one picture of window and film
words, text, readout    words and numbers on the screen
controls                the table of keys
notices, helping        short sentences; the overlay that lists the keys
picking, hand           what is under the cursor; pick up and throw
selection               which particles are chosen
series, statistics      numbers over time; times, pairs, energy, momentum and how they drift
traces                  the same as the lines of plots
pace, engine            real time to whole steps; who steps, and in which thread
history                 the last half minute: snapshots, and the steps between made again
paths, exports          new files; states as CSV and GSD
encoder, recording      an ffmpeg that is fed pictures; a film beside the window
scene_file, files       a scene in a file; all that a session writes and reads
explain, why_view       why two particles touch or do not; the answer over the scene
gui                     the host of the panels: `gui_keys`, `gui_style` dress it,
                        `gui_shapes`, `gui_software` and `gui_opengl` draw it
deeds, pulls, gravity   what a person does to particles, with attractions, to gravity
tools, tools_view       what the left mouse button does, and how that is shown
menu, hands             what the right one offers; all that a mouse does to a scene
session                 all that a person has before them, without a window
layout, panels          the room of the panels; all that is set and measured beside the scene
acts                    what each key does to a session
input, menus            events to acts; the menus, drawn with ImGui
backdrop                a picture that takes long is drawn beside the window
window                  the interactive loop
recorder                films and pictures of the run without a screen
config                  a scene described in TOML
headless, report        the run without a screen, and its table
visitor, stops          a person who always does the same, and what there is to see
tour, tour_report       pictures and films of it, and their table
======================= ========================================================================

Drawing reads a frame, copies of a simulation's columns, and never the simulation. What a person
does to it goes through `Session` to `Engine.edit`. The library proper never imports this package.
"""
