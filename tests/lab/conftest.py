"""The tests of the simulator."""

import sys
from importlib.util import find_spec

# Without it, as on Python 3.10, the simulator has no panels.
GUI = ["test_gui.py", "test_life.py", "test_menus.py", "test_panels.py"]
collect_ignore = GUI if find_spec("imgui_bundle") is None else []
if sys.platform == "win32":  # no limits of processes, and no SIGINT to send to one of them
    collect_ignore += ["test_interrupt.py", "test_writing.py"]
