"""User actions, in reading order.

======================= ========================================================================
messages                the message in the window, and the time of the session
selection               the particles under the cursor, and the selected ones
commands                commands on particles and walls; new particles along the path of the cursor
attractors              attractors placed by the user; direction and strength of gravity
interaction             all mouse actions in the scene: tools and menu
explanation             why two particles touch or do not
view                    selection, current drag and explanation, drawn
======================= ========================================================================
"""
