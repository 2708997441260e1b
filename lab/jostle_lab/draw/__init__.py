"""Drawing, in reading order.

======================= ========================================================================
palette, camera         every colour; world to screen and back, pan and zoom
painter                 the interface of the painters
software                the painter of videos, and of windows without a graphics card
shaders, opengl         the painter on a graphics card
screen                  the window, its painter and its icon
text                    names and numbers as text; text as pictures; cards that explain colours
view_options            the switches of the display
colouring               the colour of each particle
base_layers             background, walls and discs, and the boxes of the tree
marks                   contacts, forces, velocities, trails, rotation, labels, springs, attractors
scene_overlays          what single scenes show beside their particles
picture                 all layers in their order, for the window and for films
======================= ========================================================================
"""
