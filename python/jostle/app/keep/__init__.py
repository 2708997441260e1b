"""Files and history, in reading order.

======================= ========================================================================
history                 the last half minute: snapshots, and the steps between made again
paths, exports          new files; states as CSV and GSD
scene_file              a scene in a file
encoder, recording      an ffmpeg that is fed pictures; a film beside the window
recorder                films and pictures of the run without a screen
files                   all that a session writes and reads
config                  a scene described in TOML
======================= ========================================================================
"""
