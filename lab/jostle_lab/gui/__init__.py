"""The host of ImGui and the input of the window, in reading order.

======================= ========================================================================
style                   the widths of the panels; colours, spacing and fonts
host                    one ImGui context: events in, panels out
keymap, input           keys and their commands; events of mouse and keys
======================= ========================================================================
"""
