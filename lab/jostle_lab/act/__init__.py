"""User actions, in reading order.

======================= ========================================================================
selection               the particles under the cursor, and the selected ones
commands                commands on particles and walls; new particles along the path of the cursor
attractors              attractors placed by the user; direction and strength of gravity
interaction             all mouse actions in the scene: tools and menu; the message in the window
explanation             why two particles touch or do not
view                    selection, current drag and explanation, drawn
======================= ========================================================================
"""
