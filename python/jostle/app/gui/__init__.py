"""The host of ImGui, in reading order; nothing is imported if it is not installed.

======================= ========================================================================
keys, style             pygame's keys in ImGui's words; colours, spacing and the face of the app
shapes, software        what ImGui wants drawn, sorted out; drawn without a graphics card
opengl                  drawn by ImGui's own backend
host                    events in, panels out
layout                  who gets which room in the window
======================= ========================================================================
"""
