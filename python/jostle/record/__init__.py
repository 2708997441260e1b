"""Write worlds to files: films, trajectories and tables.

`record` steps a world and writes its states, `write_states` writes those of a loop of your own. The
suffix of the file is the format:

======== =======================================================================================
`.mp4`   a film in H.264
`.gif`   an animated picture
`.gsd`   a trajectory in the schema of HOOMD, for OVITO and other programs
`.csv`   a row for each particle of each state
`.npz`   arrays with the same bits, for `numpy.load`
======== =======================================================================================

`Film` makes a film of pictures of your own, `write_png` writes one.
Films, pictures and `.gsd` need ``pip install 'jostle[record]'``, the others NumPy alone.

A new file replaces an old one when it is complete. After an error or Ctrl-C the old file is as it
was, except that a film which has a picture is completed, and can be played.

Examples
--------
>>> import jostle.record
>>> world = jostle.World([(0, 0), (5, 0)], 1.0, velocities=[(1, 0), (0, 0)])
>>> jostle.record.record(world, "two.npz", dt=0.1, steps=10, every=5)
>>> np.load("two.npz")["times"].round(3).tolist()
[0.0, 0.5, 1.0]
"""

from jostle.record.films import Film, write_png
from jostle.record.states import record, write_states

__all__ = ["Film", "record", "write_png", "write_states"]
