"""The tests of the simulator."""

import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from importlib.util import find_spec

import pygame
import pytest
from lab_command import Command

from jostle_lab.draw.screen import NoOpenGLError
from jostle_lab.schema import Settings
from jostle_lab.session import Session
from jostle_lab.simulate.simulation import Simulation
from jostle_lab.simulate.start import start

# Without it, as on Python 3.10, the simulator has no panels.
GUI = ["test_gui.py", "test_life.py", "test_menus.py", "test_panels.py"]
collect_ignore = GUI if find_spec("imgui_bundle") is None else []
if sys.platform == "win32":  # no limits of processes, and no SIGINT to send to one of them
    collect_ignore += ["test_interrupt.py", "test_writing.py"]


@pytest.fixture
def jostle_command(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Command:
    """Provide the command."""
    return Command(monkeypatch, capsys)


@pytest.fixture
def open_session() -> Iterator[Callable[..., Session]]:
    """Provide synchronous sessions of a scene, which are closed after the test."""
    with ExitStack() as closing:

        def make(
            scene: str, n: int, *, size: tuple[int, int] = (640, 360), **settings: object
        ) -> Session:
            session = Session(start(Settings(scene, n, **settings)), size, synchronous=True)
            closing.callback(session.close)
            return session

        yield make


@pytest.fixture
def open_window() -> Iterator[Callable[..., object]]:
    """Provide windows of settings or of a simulation, which are closed after the test."""
    from jostle_lab.window import Window  # it needs ImGui

    with ExitStack() as closing:

        def make(
            of: Settings | Simulation, size: tuple[int, int] = (640, 360), **options: object
        ) -> Window:
            simulation = start(of) if isinstance(of, Settings) else of
            try:
                window = Window(simulation, size, **{"synchronous": True, **options})
            except NoOpenGLError as error:
                pytest.skip(str(error))
            pygame.event.clear()
            closing.callback(window.close)
            return window

        yield make


@pytest.fixture(autouse=True)
def state_home(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    """Keep autosaved edits out of the home of the user."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))


@pytest.fixture(autouse=True)
def closed(request: pytest.FixtureRequest, usual_threads: None) -> Iterator[None]:
    """Close the display and the sessions of a `Driver`."""
    yield
    if driver := getattr(request.module, "Driver", None):
        while driver.opened:
            driver.opened.pop().close()
        pygame.display.quit()
