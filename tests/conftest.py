"""Settings of all tests: no window, no sound, reproducible property tests."""

import os
from collections.abc import Iterator

import pytest
from hypothesis import settings

from jostle import _core

# Small calls, which most tests make, use several threads too.
_core.wake_threads_always(True)

# Set before any test imports a window library.
os.environ["SDL_VIDEODRIVER"] = "offscreen"
os.environ["SDL_AUDIODRIVER"] = "dummy"
os.environ["PYGAME_HIDE_SUPPORT_PROMPT"] = "1"
os.environ["ARCADE_HEADLESS"] = "True"

# Times on a shared machine vary too much for a deadline. `make full` tries more examples.
settings.register_profile("here", deadline=None, print_blob=True, max_examples=40)
# Every run uses the same examples, so that a failure comes from the tested change.
settings.register_profile("ci", parent=settings.get_profile("here"), derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "here")
# On further Pythons the same compiled core is tested (pytest --hypothesis-profile=library).
settings.register_profile("library", parent=settings(), max_examples=20)
settings.register_profile("full", parent=settings.get_profile("here"), max_examples=1000)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Start slow tests first, so that none of them is the last one."""
    items.sort(key=lambda item: item.get_closest_marker("slow") is None)


@pytest.fixture
def usual_threads() -> Iterator[None]:
    """Use threads only where they save time, as programs do: for long runs of small worlds."""
    _core.wake_threads_always(False)
    yield
    _core.wake_threads_always(True)
