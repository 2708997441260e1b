"""User actions, in reading order.

======================= ========================================================================
controls                the table of keys
picking, selection      what is under the cursor; which particles are chosen
hand                    pick up and throw
deeds, pulls, gravity   what a person does to particles, with attractions, to gravity
tools                   what the left mouse button does
menu                    what the right one offers
hands                   all that a mouse does to a scene: the base of a session
explain                 why two particles touch or do not
acts, input             what each key does to a session; events to acts
======================= ========================================================================
"""
