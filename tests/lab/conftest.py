"""The tests of the simulator."""

import sys
from collections.abc import Iterator
from importlib.util import find_spec

import pygame
import pytest
from lab_command import Command

# Without it, as on Python 3.10, the simulator has no panels.
GUI = ["test_gui.py", "test_life.py", "test_menus.py", "test_panels.py"]
collect_ignore = GUI if find_spec("imgui_bundle") is None else []
if sys.platform == "win32":  # no limits of processes, and no SIGINT to send to one of them
    collect_ignore += ["test_interrupt.py", "test_writing.py"]


@pytest.fixture
def jostle_command(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Command:
    """Provide the command."""
    return Command(monkeypatch, capsys)


@pytest.fixture(autouse=True)
def closed(request: pytest.FixtureRequest, usual_threads: None) -> Iterator[None]:
    """Close the window of a `Driver`."""
    yield
    if hasattr(request.module, "Driver"):
        pygame.display.quit()
