"""Numbers over time, in reading order.

======================= ========================================================================
statistics              times, pairs, energy and momentum, and their change since a reference
traces                  the statistics as the lines of plots
======================= ========================================================================
"""
