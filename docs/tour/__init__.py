"""The tour that makes the pictures and videos of the documents, in reading order.

======================= ========================================================================
scripted_user           scripted input in a window without a display
stops                   the stops of the tour, and the input at each
tour                    the run of a stop, as a picture and a video
======================= ========================================================================
"""
