"""The tour that makes the pictures and videos of the documents, in reading order.

======================= ========================================================================
scripted_user           scripted input in a window without a display
tour                    the stops, the input at each, and the run over all of them
======================= ========================================================================
"""
