"""Numbers over time, in reading order.

======================= ========================================================================
series                  a ring buffer of rows with named columns
statistics              times, pairs, energy and momentum, and their change since a reference
traces                  the statistics as the lines of plots
======================= ========================================================================
"""
