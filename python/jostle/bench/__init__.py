"""The benchmark: jostle compared with other libraries on this machine.

Other libraries are imported only when they are measured, and only those that are installed
take part. Modules in reading order:

`shapes`
    Scenes for the search of pairs, as plain arrays.
`timing`
    Interleaved rounds, medians and quartiles.
`machine`
    What was measured on, and the file that keeps the figures.
`pair_rivals`, `step_rivals`
    Every way to find pairs, and to simulate discs, that is compared: a few lines each.
`pairs`, `steps`, `held`
    The runners. Each compares the answers first and yields rows of a results file.
`command`
    What `jostle bench` prints.
"""
