"""Numbers over time, in reading order.

======================= ========================================================================
series                  columns that remember their last rows
statistics              times, pairs, energy, momentum, and how they drift
traces                  the same as the lines of plots
======================= ========================================================================
"""
