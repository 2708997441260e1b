"""Settings of all tests: no window, no sound, reproducible property tests."""

import os
from pathlib import Path

import pytest
from hypothesis import settings

from jostle import _core

# Small calls, which most tests make, use several threads too.
_core.wake_threads_always(True)

# Files that test the simulator, the command, the repository or the physics of the compiled core,
# which is the same for every Python.
BESIDE_THE_LIBRARY = [
    "test_app_*.py",
    "test_bench.py",
    "test_cli.py",
    "test_emitters.py",
    "test_exact_step.py",
    "test_examples.py",
    "test_fluid.py",
    "test_gas.py",
    "test_interrupt.py",
    "test_inlined.py",
    "test_layers.py",
    "test_mpi_*.py",
    "test_numpydoc.py",
    "test_resting.py",
    "test_stub.py",
    "test_sweep.py",
    "test_tune.py",
    "test_words.py",
]

# Set before any test imports a window library.
os.environ["SDL_VIDEODRIVER"] = "offscreen"
os.environ["SDL_AUDIODRIVER"] = "dummy"
os.environ["PYGAME_HIDE_SUPPORT_PROMPT"] = "1"
os.environ["ARCADE_HEADLESS"] = "True"

# Times on a shared machine vary too much for a deadline.
settings.register_profile("here", deadline=None, print_blob=True)
# Every run uses the same examples, so that a failure comes from the tested change.
settings.register_profile("ci", parent=settings.get_profile("here"), derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "here")
# On further Pythons the same compiled core is tested.
settings.register_profile("library", parent=settings(), max_examples=20)


def pytest_addoption(parser: pytest.Parser) -> None:
    text = "run only the tests of the library, which need none of the simulator's packages"
    parser.addoption("--library", action="store_true", help=text)


def pytest_configure(config: pytest.Config) -> None:
    if config.getoption("--library"):
        settings.load_profile("library")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Start slow tests first, so that none of them is the last one."""
    items.sort(key=lambda item: item.get_closest_marker("slow") is None)


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    left_out = any(collection_path.match(pattern) for pattern in BESIDE_THE_LIBRARY)
    return True if left_out and config.getoption("--library") else None
