"""The painter of a window, and windows that are hidden, resized, or slow."""

import importlib.util
import os
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace

import moderngl
import numpy as np
import pygame
import pytest
from lab_overlays import open_screen, pixels
from results import fields

import jostle
from jostle_lab import cli
from jostle_lab.draw import opengl
from jostle_lab.draw.camera import Camera
from jostle_lab.draw.opengl import OpenGLPainter
from jostle_lab.draw.picture import Picture
from jostle_lab.draw.screen import NoOpenGLError, Screen
from jostle_lab.draw.software import SoftwarePainter
from jostle_lab.draw.view_options import ColourBy, TreeView, ViewOptions
from jostle_lab.schema import Settings
from jostle_lab.simulate.frame import FrameContacts, FrameRequest
from jostle_lab.simulate.start import start
from jostle_lab.window import Window

FRAME = 1 / 60
SIZE = (640, 360)
KINDS = [
    Settings("pile", 60, on_touch="merge"),
    Settings("springs", 40),
    Settings("galton", 30),
    Settings("brownian", 30, container="torus"),
]


@pytest.fixture
def open_gas(open_window: Callable[..., Window]) -> Callable[..., Window]:
    return lambda n=50, **options: open_window(Settings("gas", n), **options)


@pytest.mark.skipif(
    os.environ.get("CI") != "true" or sys.platform != "linux",
    reason="without CI=true a machine need not have OpenGL",
)
def test_where_changes_are_judged_there_is_opengl() -> None:
    """Every other test of OpenGL is skipped without it, without a failure."""
    Screen(SIZE).close()


def test_the_window_has_the_icon_of_jostle(monkeypatch) -> None:
    calls = []
    for name in ("set_icon", "set_mode"):
        call = getattr(pygame.display, name)

        def noted(*args: object, call=call, name: str = name, **options: object) -> object:
            calls.append(name)
            return call(*args, **options)

        monkeypatch.setattr(pygame.display, name, noted)
    window = open_screen()
    # pygame gives a new OpenGL window its own icon.
    assert (calls[0], calls[-1]) == ("set_icon", "set_icon")
    window.close()


def test_a_graphics_card_draws_the_scene_and_without_one_the_painter_of_videos(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    screen = open_screen()
    name = screen.opengl.renderer
    screen.close()
    for emulators, kind in (((name.lower(),), SoftwarePainter), ((), OpenGLPainter)):
        monkeypatch.setattr(opengl, "_EMULATORS", emulators)
        screen = open_screen()
        assert isinstance(screen.painter, kind)
        screen.painter.fill((200, 100, 50))
        screen.painter.rects(np.array([[0, 0, 11, 11]]), np.array([[0, 200, 0]]), filled=True)
        screen.end_scene()
        shown = pixels(screen)
        assert tuple(shown[5, 5]) == (0, 200, 0) and tuple(shown[-1, -1]) == (200, 100, 50)
        screen.show()
        screen.close()

    def fail() -> None:
        raise moderngl.Error("no card")

    monkeypatch.setattr(moderngl, "init_context", fail)
    with pytest.raises(NoOpenGLError, match=r"no card; Mesa"):
        Screen(SIZE)


def test_without_imgui_the_command_names_the_python_that_has_it(
    monkeypatch, jostle_command
) -> None:
    find = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name: find(name) if name != "imgui_bundle" else None
    )
    monkeypatch.setattr(cli.runs, "has_display", lambda: True)
    assert "needs Python 3.11" in jostle_command.refuses("run", "gas")


def test_a_window_of_any_size_shows_the_scene_and_builds_panels(open_gas, monkeypatch) -> None:
    window = open_gas()
    built = []
    window.builders.append(lambda session, host: built.append((session, host)))
    for size in [(500, 300), (150, 90), (640, 360)]:
        window.frame(FRAME)
        monkeypatch.setattr(pygame.display, "get_window_size", lambda size=size: size)
        pygame.event.post(pygame.event.Event(pygame.VIDEORESIZE, size=size, w=size[0], h=size[1]))
        window.frame(FRAME)
        assert window.painter.size == window.session.camera.size == size
        assert pixels(window.screen).std() > 1
    assert built and built[0] == (window.session, window.gui)


def test_f11_fills_the_screen_and_ends_that(open_gas, monkeypatch) -> None:
    window, calls = open_gas(), []
    monkeypatch.setattr(pygame.display, "toggle_fullscreen", lambda: calls.append(1))
    monkeypatch.setattr(pygame.display, "get_window_size", lambda: (800, 450))
    for full in (True, False):
        pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=pygame.K_F11, mod=0))
        window.frame(FRAME)
        assert window.screen.full is full and len(calls) == 2 - full
    assert window.session.camera.size == window.painter.size == (800, 450)


def test_a_minimised_window_draws_nothing_and_the_world_goes_on(open_gas) -> None:
    window = open_gas()
    window.frame(FRAME)
    before, steps = pixels(window.painter), window.session.engine.steps
    pygame.event.post(pygame.event.Event(pygame.WINDOWMINIMIZED))
    for _ in range(20):
        window.frame(FRAME)
    assert (pixels(window.painter) == before).all()
    assert window.session.engine.steps > steps
    pygame.event.post(pygame.event.Event(pygame.WINDOWRESTORED))
    window.frame(FRAME)
    assert (pixels(window.painter) != before).any()


def test_on_a_dense_screen_the_mouse_is_where_it_is_seen(open_gas, monkeypatch) -> None:
    window = open_gas()
    monkeypatch.setattr(pygame.display, "get_window_size", lambda: (320, 180))
    assert window.screen.scale == 2.0
    pygame.event.post(
        pygame.event.Event(pygame.MOUSEMOTION, pos=(100, 50), rel=(1, 0), buttons=(0, 0, 0))
    )
    window.frame(FRAME)
    assert window.session.interaction.cursor == (200, 100)


def test_panels_without_events_are_built_every_other_frame(open_gas) -> None:
    window, built = open_gas(), []
    window.session.runner.paused = True
    window.builders.append(lambda session, host: built.append(True))
    for _ in range(30):
        window.frame(FRAME)
    built.clear()
    pictures = []
    for _ in range(10):
        window.frame(FRAME)
        pictures.append(pixels(window.screen))
    assert len(built) == 5
    panel = [picture[:100] for picture in pictures]
    assert all((part == panel[0]).mean() > 0.98 for part in panel), "between, they are still there"
    pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=pygame.K_n, mod=0))
    window.frame(FRAME)
    window.frame(FRAME)
    assert len(built) == 7, "an event is answered at once"


def test_a_window_on_many_particles_closes_at_any_time(open_gas) -> None:
    window = open_gas(200_000)
    window.frame(FRAME)
    assert pixels(window.screen).std() > 1


EVERYTHING = ViewOptions(
    tree=TreeView.OUTLINE, contacts=True, forces=True, velocities=True, trails=True, labels=True
)
EVERY_PART = FrameRequest(tree=True, contacts=True, energies=True)


def arrays_of(record: object) -> Iterator[np.ndarray]:
    """All arrays of a frame and of its parts."""
    parts = fields(record) if isinstance(record, jostle.Nodes) else record
    for value in parts if isinstance(parts, tuple) else vars(record).values():
        if isinstance(value, np.ndarray):
            yield value
        elif isinstance(value, (jostle.Nodes, FrameContacts)):
            yield from arrays_of(value)


@pytest.mark.parametrize("settings", KINDS, ids=lambda settings: settings.scene)
def test_a_frame_cannot_be_changed(settings: Settings) -> None:
    simulation = start(settings)
    for _ in range(3):
        simulation.step()
    arrays = list(arrays_of(simulation.frame(EVERY_PART)))
    assert len(arrays) >= 11
    for array in arrays:
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0


@pytest.mark.parametrize("settings", KINDS, ids=lambda settings: settings.scene)
def test_drawing_changes_no_state(settings: Settings) -> None:
    simulation, painter, picture = start(settings), SoftwarePainter(SIZE), Picture()
    camera = Camera(SIZE, simulation.view)
    for tree in TreeView:
        simulation.step()
        before = simulation.save()
        for by in ColourBy:
            options = replace(EVERYTHING, tree=tree, colour_by=by)
            picture.draw(painter, simulation.frame(EVERY_PART), camera, options)
        assert simulation.save() == before
