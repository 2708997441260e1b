"""The tour that makes the pictures and films of the documents, in reading order.

======================= ========================================================================
visitor                 somebody at a window without a display
stops                   where the tour stops, and what is done there
tour, report            from stop to stop; the table at the end
======================= ========================================================================
"""
