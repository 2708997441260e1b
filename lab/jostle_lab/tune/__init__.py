"""A map of the time to find all pairs, over the leaf capacity and maximum depth of the tree.

`measure` times the trees, `picture` draws the map, `command` prints a table and saves the picture.
"""
