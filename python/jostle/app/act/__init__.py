"""User actions, in reading order.

======================= ========================================================================
picking, selection      which particle is under the cursor; which particles are selected
messages                the message in the window, and the time of the session
drag_tool               dragging and throwing a particle
commands                commands on particles and walls
attractors, gravity     attractors placed by the user; direction and strength of gravity
tools                   the tools of the left mouse button
menu                    the context menu
interaction             all mouse actions in the scene
explanation             why two particles touch or do not
interaction_view        selection and the current drag, drawn
explanation_view        the shapes of that explanation, drawn
======================= ========================================================================
"""
