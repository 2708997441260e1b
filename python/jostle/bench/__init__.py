"""The benchmark: jostle compared with other libraries on this machine.

Installed libraries are compared, and imported only when they are measured. Modules in reading
order:

`shapes`
    Scenes for the search of pairs, as plain arrays.
`timing`
    Interleaved rounds, medians and quartiles.
`machine`
    The description of the machine, and the file of results.
`pair_rivals`, `step_rivals`
    The compared functions that find pairs, and the compared simulations: a few lines each.
`pairs`, `steps`, `held`
    The runners. Each compares the answers first, and yields rows of a results file.
`command`
    The output of `jostle bench`.
"""
