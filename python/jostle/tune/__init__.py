"""Measures which settings find the pairs of a scene fastest, as the article advises.

In reading order: `timing` is the protocol and knows no tree; `sample` the shapes of a scene;
`contenders` what is timed; `sweep` which settings, in which order; `report`, `records`
(the CSV) and `pictures` show what came of it; `command` is the way through all of them.
"""
