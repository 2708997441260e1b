"""The host of ImGui and the input of the window, in reading order.

======================= ========================================================================
keys, style             pygame's keys as ImGui's; colours, spacing and fonts
shapes, software        ImGui's triangles as shapes; their drawing without a graphics card
opengl                  drawing with ImGui's own backend
host                    one ImGui context: events in, panels out
layout                  the widths of the panels
keymap, input           keys and their commands; events of mouse and keys
======================= ========================================================================
"""
