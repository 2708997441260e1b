"""Sweeps: worlds for all combinations of settings and seeds, in many processes.

The modules, in reading order:

=========  ==========================================================
plan       the settings, their values, and the runs of a sweep
measures   what is measured in a run
run        one run
table      the table of results, which a later sweep continues
workers    processes of this machine, or the ranks of MPI
command    the command, with its progress bar
=========  ==========================================================
"""
