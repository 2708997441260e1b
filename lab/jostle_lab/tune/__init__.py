"""Measures the settings that find the pairs of a scene fastest.

In reading order: `timing` is the protocol, independent of trees; `sample` the shapes of a scene;
`candidates` the timed calls; `sweep` the order of the settings; `findings` the conclusions;
`report`, `records` (CSV) and `pictures` the output; `command` runs all of them.
"""
