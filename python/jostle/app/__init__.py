"""The simulator: a window on a world, or a film of it where there is no screen.

In reading order; each file uses only files above it:

======================= ========================================================================
palette                 every colour, in one place
simulation              what the app asks of a simulation: the protocol, `Frame`, `Facts`
world_simulation        `jostle.World` behind that protocol
article_simulation      `jostle.article.Simulation` behind that protocol
start                   from the command's options to a running simulation
camera                  world to screen and back, pan and zoom
colouring               which particle gets which colour
stamps, dust, renderer  discs of every size, drawn by the processor alone
overlays                the boxes of the tree
text, readout           words and numbers on the screen
controls, helping       the table of keys, and the overlay that lists it
picture                 all layers in their order: the one picture of window and film
hand                    pick up and throw
pace                    real time to whole steps
window                  the interactive loop
recorder                MP4 and PNG files
headless, report        the run without a screen, and its table
======================= ========================================================================

Drawing reads a simulation's arrays once a frame and never writes to it; only the hand does, at
the user's wish. The library proper never imports this package.
"""
