"""Files, in reading order.

======================= ========================================================================
scene_file              a scene in a file
recording               a film recorded on a worker thread
files                   everything that a session writes and reads
config                  a scene described in TOML
======================= ========================================================================
"""
