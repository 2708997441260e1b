"""Files, in reading order.

======================= ========================================================================
exports                 names of new files; states as CSV and GSD
scene_file              a scene in a file
encoder                 frames to ffmpeg; a video recorded on a worker thread
files                   everything that a session writes and reads
config                  a scene described in TOML
======================= ========================================================================
"""
