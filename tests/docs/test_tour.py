"""The tour: its stops lead somewhere, and leave pictures and films behind."""

import os
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace

import imageio_ffmpeg
import pygame
import pytest
from tour.scripted_user import FRAME, RIGHT, ScriptedUser
from tour.stops import STOPS, Stop, fold, nearest
from tour.tour import RATE, no_display, visit

import jostle
from jostle_lab.schema import Settings
from jostle_lab.session import Session
from jostle_lab.simulate.start import start
from jostle_lab.window import Window

SMALL = (640, 360)


def wait_less(monkeypatch, most: float = 0.5) -> None:
    """Let visitors wait no longer than so many seconds, and draw less meanwhile."""
    wait, live = ScriptedUser.wait, ScriptedUser.live
    monkeypatch.setattr(ScriptedUser, "live", lambda self, time: live(self, min(time, most)))
    monkeypatch.setattr(
        ScriptedUser, "wait", lambda self, time, every=6: wait(self, min(time, most), 20)
    )


def stop(name: str) -> Stop:
    return next(stop for stop in STOPS if stop.name == name)


@pytest.fixture
def user():
    window = Window(start(Settings("billiards")), (1280, 720), synchronous=True)
    window.session.view_options.panels = True
    window.frame(0.0)  # which moves the camera aside
    yield ScriptedUser(window)
    window.close()


def test_stops_have_names_of_their_own_and_scenes_that_exist() -> None:
    assert len({stop.name for stop in STOPS}) == len(STOPS)
    assert {stop.settings.scene for stop in STOPS} <= set(jostle.scenes.names())


@pytest.mark.parametrize("name", ["menu", "trails"])
def test_a_stop_leaves_a_picture_of_its_size(name: str, tmp_path, monkeypatch) -> None:
    wait_less(monkeypatch)
    made = visit(stop(name), tmp_path, SMALL, film=False)
    picture = pygame.image.load(str(made.still))
    assert picture.get_size() == SMALL
    assert len({tuple(picture.get_at((x, 180))) for x in range(0, 640, 3)}) > 3
    assert made.film is None and sorted(tmp_path.iterdir()) == [made.still]


def test_a_film_has_a_picture_for_every_thirtieth_of_a_second(tmp_path) -> None:
    def look(user: ScriptedUser) -> None:
        user.wait(0.5)
        user.start_recording()
        user.wait(1)

    short = replace(stop("sand"), script=look, settings=Settings("sand", 200))
    made = visit(short, tmp_path, SMALL, film=True)
    assert made.film is not None and made.frames == RATE
    reader = imageio_ffmpeg.read_frames(str(made.film))
    facts = next(reader)
    assert facts["size"] == SMALL and facts["fps"] == RATE
    assert len(list(reader)) == RATE


def test_a_still_of_a_stop_is_the_same_each_time(tmp_path) -> None:
    """The scene is: how long things took is measured, and stands in the panels."""

    def look(user: ScriptedUser) -> None:
        user.session.view_options.panels = False
        user.wait(1)

    pictures = []
    for _ in range(2):
        made = visit(replace(stop("pile"), script=look), tmp_path, SMALL, film=False)
        pictures.append(pygame.image.load(str(made.still)).get_buffer().raw)
    assert pictures[0] == pictures[1]


def test_the_environment_is_left_as_it_was(tmp_path, monkeypatch) -> None:
    wait_less(monkeypatch)
    before = dict(os.environ)
    with no_display():
        made = visit(stop("menu"), tmp_path, SMALL, film=False)
        assert made.still.exists()
    assert dict(os.environ) == before


def test_a_user_drags_and_throws(user: ScriptedUser) -> None:
    session = user.session
    session.runner.paused = True  # until it is picked up
    user.move(user.pixel(nearest(session.frame, (0.0, 0.0))))
    user.press()
    tag = session.interaction.drag_tool.held
    assert tag is not None
    session.runner.paused = False
    x, y = session.interaction.cursor
    user.move((x - 5, y - 90), 0.2)
    user.release()
    assert session.interaction.drag_tool.held is None
    assert session.frame.velocities[session.frame.rows(tag)[0], 1] < -50


def test_a_pointer_is_in_the_picture_until_it_is_put_away(user: ScriptedUser) -> None:
    def at_pointer() -> bytes:
        picture = user.picture().subsurface((601, 201, 12, 16))
        return pygame.image.tobytes(picture, "RGB")

    user.session.runner.paused = True
    user.look()
    without = at_pointer()
    user.move((600.0, 200.0), FRAME)
    assert at_pointer() != without
    user.hide_pointer()
    user.look()
    assert at_pointer() == without


def test_a_user_folds_sections_and_opens_menus(user: ScriptedUser) -> None:
    pytest.importorskip("imgui_bundle")
    user.look()
    before = user.mark("section Method")
    fold(user, "Scenes")
    after = user.mark("section Method")
    assert before and after and after[1] < before[1]
    user.session.runner.paused = True
    user.click(user.pixel(nearest(user.session.frame, (0.0, 0.0))), RIGHT)
    menu = user.session.interaction.menu
    assert menu is not None and menu.tag is not None


# What must hold when the user has done everything that they do at a stop.
ENDS: dict[str, Callable[[Session], bool]] = {
    "rules": lambda s: s.runner.race is not None and s.runner.race.method == "article-quadtree",
    "springs": lambda s: s.interaction.drag_tool.held is None and s.camera.at_home,
    "menu": lambda s: s.interaction.menu is not None and s.interaction.menu.tag is not None,
    "why": lambda s: len(s.interaction.selection) == 2 and s.explanation is not None,
    "walls": lambda s: (
        len(s.interaction.commands.drawn_walls) == 2 and len(s.interaction.attractors.placed) == 1
    ),
    "rewind": lambda s: s.runner.paused and abs(s.runner.history.back - 4.0) < 0.05,
    "settings": lambda s: isinstance(s.frame.container, jostle.Circle),
}


@pytest.mark.parametrize("name", ENDS)
def test_a_stop_reaches_its_state(name: str, monkeypatch) -> None:
    wait_less(monkeypatch, 4.0 if name == "rewind" else 0.5)
    settings = stop(name).settings
    if name != "springs":  # whose bodies are picked up where they lie
        usual = settings.n or jostle.scenes.default_count(settings.scene)
        settings = replace(settings, n=min(usual, 200))
    window = Window(start(settings), (1280, 720), synchronous=True)
    with closing(window):
        stop(name).script(ScriptedUser(window))
        assert ENDS[name](window.session)


def test_pictures_have_no_times_of_frames(tmp_path, monkeypatch) -> None:
    """They would be those of a window that is drawn in software."""
    from jostle_lab.panels import widgets

    shown = []
    section = widgets.section
    noted = lambda gui, title, *rest, **more: (  # noqa: E731
        shown.append(title),
        section(gui, title, *rest, **more),
    )
    monkeypatch.setattr(widgets, "section", noted)
    wait_less(monkeypatch)
    visit(stop("trails"), tmp_path, (1280, 720), film=False)
    assert "Energy" in shown and "Frame time" not in shown
