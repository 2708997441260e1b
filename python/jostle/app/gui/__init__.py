"""The host of ImGui and the input of the window, in reading order.

======================= ========================================================================
keys, style             pygame's keys as ImGui's; colours, spacing and font
shapes, software        ImGui's triangles as shapes; their drawing without a graphics card
opengl                  drawing with ImGui's own backend
host                    one ImGui context: events in, panels out
layout                  the widths of the panels
key_bindings, input     the effect of each key; events of mouse and keys
======================= ========================================================================
"""
