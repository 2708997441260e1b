"""The simulator: a window on a world, or a film of it where there is no screen.

Reading order, each file uses only files above it:

====================== =========================================================================
palette                every colour, in one place
simulation             what the app asks of a simulation: the protocol, `Frame`, `Facts`
world_simulation       `jostle.World` behind that protocol
article_simulation     `jostle.article.Simulation` behind that protocol
start                  from the command's options to a running simulation
camera                 world to screen and back, pan and zoom
colouring              which particle gets which colour
stamps, renderer       discs, drawn by the processor alone
overlays               the boxes of the tree
text, readout, helping words on the screen: numbers, and the list of keys
picture                all layers in their order: the one picture of window and film
controls               the table of keys
hand                   pick up and throw
pace                   real time to whole steps
recorder               MP4 and PNG files
window                 the interactive loop
report, headless       the run without a screen, and its table
====================== =========================================================================

Drawing reads a simulation's arrays once a frame and never writes to it; only the hand does, at
the user's wish. The library proper never imports this package.
"""
