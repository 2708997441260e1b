"""Drawing, in reading order.

======================= ========================================================================
palette, camera         every colour, in one place; world to screen and back, pan and zoom
painter                 what can be drawn, whoever draws it
stamps, dust, strips    discs of every size and lines along the axes, by the processor alone
software                the painter that needs no graphics card
shaders, opengl         the painter on a graphics card
renderers               which of the two, and its window
words, text, legend     words and numbers; small cards that say what colours mean
choosing                which few of many to draw
stage, overlays         ground, walls and discs; the boxes of the tree
chains                  forces between particles as lines
marks, trails, labels   contacts, velocities, springs, attractors; past ways; words at discs
extras                  what single scenes show beyond their particles
shown, colouring        the switches of what is shown; which particle gets which colour
picture                 all layers in their order: the one picture of window and film
backdrop                a picture that takes long is drawn beside the window
readout, notices        the panel of numbers where there is no ImGui; short sentences
helping                 the overlay that lists the keys
tools_view, why_view    what the mouse is about to do; why two particles touch or do not
======================= ========================================================================
"""
