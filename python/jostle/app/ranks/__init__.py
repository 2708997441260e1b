"""The run over the ranks of MPI: a video, checkpoints and a table.

The modules, in reading order:

==========  ===================================================================
statistics  the statistics of all ranks, for colours
composite   the picture, to which each rank adds its discs
stages      the time of stages, of waiting and of communication
report      the table of numbers after a run
run         the loop over steps, with a progress bar
==========  ===================================================================
"""
