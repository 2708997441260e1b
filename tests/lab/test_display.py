"""Which painter a window gets, and what it does when that fails, is hidden, or is slow."""

import importlib.util
import os
import sys
import time
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
from jostle_lab.draw import background_render, opengl
from jostle_lab.draw.background_render import LONG, BackgroundRenderer
from jostle_lab.draw.camera import Camera
from jostle_lab.draw.palette import GROUND
from jostle_lab.draw.picture import Picture
from jostle_lab.draw.screen import NoRendererError, Screen
from jostle_lab.draw.software import SoftwarePainter
from jostle_lab.draw.view_options import ColourBy, TreeView, ViewOptions
from jostle_lab.simulate.frame import FrameContacts, FrameRequest
from jostle_lab.simulate.settings import Settings
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
    assert Screen(SIZE, "opengl").painter.name == "opengl"


@pytest.mark.parametrize("renderer", ["opengl", "software"])
def test_the_window_has_the_icon_of_jostle(renderer: str, monkeypatch) -> None:
    calls = []
    for name in ("set_icon", "set_mode"):
        call = getattr(pygame.display, name)

        def noted(*args: object, call=call, name: str = name, **options: object) -> object:
            calls.append(name)
            return call(*args, **options)

        monkeypatch.setattr(pygame.display, name, noted)
    window = open_screen(renderer)
    # pygame gives a new OpenGL window its own icon.
    assert (calls[0], calls[-1]) == ("set_icon", "set_icon")
    window.fall_back()
    assert calls[-1] == "set_icon"
    window.close()


def test_software_opengl_is_used_only_if_asked_for_and_software_without_a_context(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    name = open_screen("opengl").painter.renderer
    monkeypatch.setattr(opengl, "_EMULATORS", (name.lower(),))
    assert Screen(SIZE, "auto").painter.name == "software"
    assert Screen(SIZE, "opengl").painter.name == "opengl"
    monkeypatch.setattr(opengl, "_EMULATORS", ())
    assert Screen(SIZE, "auto").painter.name == "opengl"
    assert Screen(SIZE, "software").painter.name == "software"

    def fail() -> None:
        raise moderngl.Error("no card")

    monkeypatch.setattr(moderngl, "init_context", fail)
    assert Screen(SIZE, "auto").painter.name == "software"
    with pytest.raises(NoRendererError, match="no card"):
        Screen(SIZE, "opengl")


def test_without_imgui_the_command_names_the_python_that_has_it(
    monkeypatch, jostle_command
) -> None:
    find = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name: find(name) if name != "imgui_bundle" else None
    )
    monkeypatch.setattr(cli.commands, "has_display", lambda: True)
    assert "needs Python 3.11" in jostle_command.refuses("run", "gas")


@pytest.mark.parametrize("renderer", ["software", "opengl"])
def test_a_window_of_either_kind_shows_the_scene_and_builds_panels(
    open_gas, renderer, monkeypatch
) -> None:
    window = open_gas(renderer=renderer)
    built = []
    window.builders.append(lambda session, host: built.append((session, host)))
    for size in [(500, 300), (150, 90), (640, 360)]:
        window.frame(FRAME)
        if renderer == "software":
            pygame.display.set_mode(size, pygame.RESIZABLE)
        else:
            monkeypatch.setattr(pygame.display, "get_window_size", lambda size=size: size)
        pygame.event.post(pygame.event.Event(pygame.VIDEORESIZE, size=size, w=size[0], h=size[1]))
        window.frame(FRAME)
        assert window.painter.size == window.session.camera.size == size
        assert pixels(window.painter).std() > 1
    assert built and built[0] == (window.session, window.gui)


def test_a_lost_card_is_replaced_and_the_simulation_does_not_notice(open_gas) -> None:
    window = open_gas(renderer="opengl")
    window.builders.append(lambda session, host: None)
    window.frame(FRAME)
    steps, frame = window.session.engine.steps, window.session.frame

    def lost() -> None:
        raise moderngl.Error("GL_CONTEXT_LOST")

    window.painter.show = lost
    window.session.runner.paused = True
    window.frame(FRAME)
    assert window.painter.name == "software"
    assert "graphics card has failed" in window.session.message
    assert window.session.engine.steps == steps
    assert (window.session.frame.positions == frame.positions).all()
    window.session.runner.paused = False
    for _ in range(3):
        window.frame(FRAME)
    assert window.session.engine.steps > steps
    assert pixels(window.painter).std() > 1


def test_what_is_wrong_in_software_is_not_hidden(open_gas) -> None:
    window = open_gas(renderer="software")

    def wrong() -> None:
        raise pygame.error("wrong")

    window.painter.show = wrong
    with pytest.raises(pygame.error, match="wrong"):
        window.frame(FRAME)


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


@pytest.mark.parametrize("renderer", ["software", "opengl"])
def test_panels_without_events_are_built_every_other_frame(open_gas, renderer: str) -> None:
    window, built = open_gas(renderer=renderer), []
    window.session.runner.paused = True
    window.builders.append(lambda session, host: built.append(True))
    for _ in range(30):
        window.frame(FRAME)
    built.clear()
    pictures = []
    for _ in range(10):
        window.frame(FRAME)
        pictures.append(pixels(window.painter))
    assert len(built) == 5
    panel = [picture[:100] for picture in pictures]
    assert all((part == panel[0]).mean() > 0.98 for part in panel), "between, they are still there"
    pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=pygame.K_n, mod=0))
    window.frame(FRAME)
    window.frame(FRAME)
    assert len(built) == 7, "an event is answered at once"


@pytest.fixture
def background(monkeypatch: pytest.MonkeyPatch) -> Iterator[BackgroundRenderer]:
    """A background renderer for which every picture is slow."""
    monkeypatch.setattr(background_render, "FEW", -1)
    monkeypatch.setattr(background_render, "MANY", -1)
    monkeypatch.setattr(background_render, "LONG", -1.0)
    slow = BackgroundRenderer()
    yield slow
    slow.close()


def test_a_slow_frame_is_drawn_on_the_worker_thread(background: BackgroundRenderer) -> None:
    painter, camera = SoftwarePainter(SIZE), Camera(SIZE, (0.0, 0.0, 640.0, 360.0))
    camera.scale, camera.center = 1.0, (320.0, 180.0)
    background.draw(painter, camera, 10, lambda target, seer: target.fill((200, 0, 0)))
    assert (pixels(painter) == GROUND).all()  # nothing is finished
    background.wait()

    def corner(target, seer) -> None:
        target.fill((0, 0, 0))
        target.rects(np.array([[0, 0, 11, 11]]), np.array([[0, 200, 0]]), filled=True)

    background.draw(painter, camera, 10, corner)
    assert (pixels(painter) == (200, 0, 0)).all()
    background.wait()
    background.draw(painter, camera, 10, corner)
    assert tuple(pixels(painter)[5, 5]) == (0, 200, 0)
    background.wait()
    camera.pan((-100, -50))  # the last picture goes with the camera, before there is a new one
    background.draw(painter, camera, 10, corner)
    shown = pixels(painter)
    assert tuple(shown[105, 55]) == (0, 200, 0)
    assert tuple(shown[50, 20]) == GROUND
    camera.pan((100, 50))
    background.wait()
    background.draw(painter, camera, 10, corner)
    background.wait()
    camera.zoom_at((0, 0), 4.0)
    background.draw(painter, camera, 10, corner)
    assert tuple(pixels(painter)[30, 30]) == (0, 200, 0)


def test_an_error_of_the_worker_thread_is_raised(background: BackgroundRenderer) -> None:
    painter, camera = SoftwarePainter(SIZE), Camera(SIZE, (0.0, 0.0, 640.0, 360.0))

    def wrong(target, seer) -> None:
        raise ValueError("wrong")

    background.draw(painter, camera, 10, wrong)
    with pytest.raises(ValueError, match="wrong"):
        background.wait()
    with pytest.raises(ValueError, match="wrong"):
        background.draw(painter, camera, 10, wrong)


def test_few_particles_are_always_drawn_at_once() -> None:
    quick = BackgroundRenderer()
    painter, camera = SoftwarePainter(SIZE), Camera(SIZE, (0.0, 0.0, 640.0, 360.0))
    quick.draw(painter, camera, 100, lambda target, seer: time.sleep(2 * LONG))
    quick.draw(painter, camera, 100, lambda target, seer: target.fill((9, 9, 9)))
    assert (pixels(painter) == 9).all() and not quick.in_background


@pytest.mark.parametrize("renderer", ["software", "opengl"])
def test_a_window_on_many_particles_closes_at_any_time(open_gas, renderer) -> None:
    window = open_gas(200_000, renderer=renderer)
    window.frame(FRAME)
    assert window.background.in_background  # later pictures may be quick enough for the window
    for _ in range(2):
        window.frame(FRAME)
    window.background.wait()
    window.frame(FRAME)
    assert pixels(window.painter).std() > 1


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
