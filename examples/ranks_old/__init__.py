"""The run over the ranks of MPI: a video, checkpoints and a table.

The modules, in reading order:

==========  ===================================================================
composite   the picture, to which each rank adds its discs, with colours from all ranks
stages      the time of stages, of waiting and of communication; the table after a run
run         the loop over steps, with a progress bar
==========  ===================================================================
"""
