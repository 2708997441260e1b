"""The tests of the adapters, of those whose package is installed."""

import importlib
from importlib.util import find_spec

NEEDED = {
    "arcade": "test_arcade*.py",
    "mesa": "test_mesa*.py",
    "pygame": "test_pygame*.py",
    "pyqtree": "test_pyqtree.py",
}
collect_ignore_glob = [files for package, files in NEEDED.items() if find_spec(package) is None]
if find_spec("pygame") and not getattr(importlib.import_module("pygame"), "IS_CE", False):
    collect_ignore_glob.append(NEEDED["pygame"])  # the older pygame
