"""Selecting, drawing walls, placing attractors, panning and zooming, by posted events."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

pygame = pytest.importorskip("pygame")

from app_hands import FRAME, MIDDLE, RIGHT, Hands, article_with, post, tags, world_of  # noqa: E402

from jostle.app.act.pulls import STRENGTH  # noqa: E402
from jostle.app.act.tools import Tool  # noqa: E402
from jostle.app.draw.camera import Camera  # noqa: E402
from jostle.app.draw.palette import STAGE  # noqa: E402
from jostle.app.draw.software import SoftwarePainter  # noqa: E402
from jostle.app.draw.stage import draw_walls  # noqa: E402
from jostle.app.draw.tools_view import draw_preview, draw_selection  # noqa: E402
from jostle.app.simulate.settings import Polyline, Settings  # noqa: E402
from jostle.app.simulate.start import start  # noqa: E402

FOUR = [(100, 100), (200, 100), (100, 300), (600, 400)]


@pytest.fixture(autouse=True)
def closed() -> Iterator[None]:
    yield
    pygame.display.quit()


# ---- selecting -----------------------------------------------------------------------------------


@pytest.mark.parametrize("make", [world_of, article_with])
def test_a_box_selects_what_lies_in_it(make) -> None:
    hands = Hands(make(FOUR))
    hands.drag((50, 50), (250, 350))
    assert tags(hands.session.selection.tags) == [0, 1, 2]
    hands.drag((700, 450), (550, 350))  # from the other corner; without Shift it replaces
    assert tags(hands.session.selection.tags) == [3]


def test_shift_adds_a_box_and_takes_a_click_away() -> None:
    hands = Hands(world_of(FOUR))
    hands.click((100, 100))
    hands.drag((550, 350), (700, 450), mod=pygame.KMOD_SHIFT)
    assert tags(hands.session.selection.tags) == [0, 3]
    hands.click((600, 400), mod=pygame.KMOD_SHIFT)
    hands.click((200, 100), mod=pygame.KMOD_LSHIFT)
    assert tags(hands.session.selection.tags) == [0, 1]
    hands.click((400, 250))
    assert len(hands.session.selection) == 0


def test_what_is_deleted_falls_out_of_the_selection() -> None:
    hands = Hands(world_of(FOUR))
    hands.drag((50, 50), (250, 350))
    hands.session.engine.edit(lambda simulation: simulation.remove([1]))
    hands.frames(1)
    assert tags(hands.session.selection.tags) == [0, 2]
    hands.key(pygame.K_PAGEDOWN)
    assert hands.session.frame.tags[0] == 0 and len(hands.session.selection) == 0


def test_the_rubber_band_and_the_rings_are_drawn() -> None:
    hands = Hands(world_of(FOUR))
    hands.down((50, 50))
    hands.point_at((250, 350))
    preview = hands.session.tools.preview
    assert preview.tool is Tool.POINTER and preview.end == pytest.approx((250, 350), abs=1)
    painter = SoftwarePainter(hands.session.camera.size)
    painter.fill((0, 0, 0))
    draw_preview(painter, preview, hands.session.camera)
    edge = hands.pixel((50, 200))
    assert pygame.surfarray.array3d(painter.canvas())[edge[0], edge[1]].any()
    hands.up((250, 350))
    assert hands.session.tools.preview is None
    painter.fill((0, 0, 0))
    session = hands.session
    draw_selection(painter, session.frame, session.selection, session.camera)
    x, y = hands.pixel((100, 100))
    around = pygame.surfarray.array3d(painter.canvas())[x - 30 : x + 30, y - 30 : y + 30]
    assert around.any() and not around[28:32, 28:32].any()


# ---- walls ---------------------------------------------------------------------------------------


def test_a_wall_that_is_drawn_stops_a_ball() -> None:
    hands = Hands(world_of([(200, 250)]))
    hands.key(pygame.K_2)
    hands.drag((400, 50), (400, 450))
    assert hands.session.frame.walls[0] == pytest.approx(np.array([(400, 50), (400, 450)]), abs=2)
    hands.session.engine.edit(lambda simulation: simulation.change([0], velocities=(900, 0)))
    hands.frames(20)
    assert hands.world.positions[0, 0] < 400 and hands.world.velocities[0, 0] < 0


def test_a_held_ball_is_not_pushed_through_a_wall_that_is_drawn() -> None:
    hands = Hands(world_of([(200, 250)]))
    hands.key(pygame.K_2)
    hands.drag((400, 0), (400, 500))
    hands.key(pygame.K_1)
    hands.down((200, 250))
    hands.point_at((700, 250))
    hands.frames(90)
    assert hands.session.hand.held == 0
    assert 300 < hands.world.positions[0, 0] < 400


def test_drawn_walls_can_be_cleared() -> None:
    hands = Hands(world_of([(200, 250)]))
    hands.key(pygame.K_2)
    hands.drag((400, 50), (400, 450))
    hands.drag((50, 450), (300, 450))
    assert hands.session.deeds.drawn_walls.tolist() == [0, 1]
    hands.session.deeds.clear_walls()
    assert len(hands.session.frame.walls) == 0 == len(hands.world.walls)


def test_the_walls_of_a_scene_stay_when_those_that_were_drawn_are_cleared() -> None:
    simulation = start(Settings("gas", 0, walls=(Polyline(((10, 10), (50, 10), (90, 40))),)))
    hands = Hands(simulation)
    own = hands.world.walls
    hands.session.deeds.wall((20, 20), (70, 70))
    assert hands.session.deeds.drawn_walls.tolist() == [2]
    hands.session.deeds.clear_walls()
    np.testing.assert_array_equal(hands.world.walls, own)


def test_a_click_removes_the_wall_under_the_cursor() -> None:
    hands = Hands(world_of([(200, 250)]))
    hands.key(pygame.K_2)
    hands.drag((400, 50), (400, 450))
    hands.drag((50, 450), (300, 450))
    hands.click((600, 250))
    assert len(hands.session.frame.walls) == 2
    hands.click((400, 200))
    assert hands.session.frame.walls[:, 0, 1] == pytest.approx([450], abs=2)


def test_a_drawn_wall_goes_and_comes_with_the_history() -> None:
    hands = Hands(world_of([(200, 250)]))
    hands.frames(3)
    hands.key(pygame.K_2)
    hands.drag((400, 50), (400, 450))
    hands.frames(3)
    history, now = hands.session.history, hands.session.frame.walls
    assert len(now) == 1
    state = hands.session.engine.simulation.save()
    hands.key(pygame.K_p)
    for _ in range(6):
        hands.key(pygame.K_u)
    assert history is not None and len(hands.session.frame.walls) == 0
    hands.session.engine.simulation.load(state)
    np.testing.assert_array_equal(hands.session.engine.simulation.frame().walls, now)
    assert hands.session.engine.simulation.frame().own_walls == 0


@pytest.mark.parametrize("size", [(640, 360), (1920, 1080)])
def test_walls_are_drawn_even_if_their_ends_are_far_outside(size) -> None:
    painter = SoftwarePainter(size)
    camera = Camera(size, (0.0, 0.0, 64.0, 36.0))
    painter.fill(STAGE)
    draw_walls(painter, np.array([[(-1e9, 18.0), (1e9, 18.0)], [(1e9, 1e9), (2e9, 1e9)]]), camera)
    canvas = pygame.surfarray.array3d(painter.canvas())
    lit = (canvas != np.array(STAGE)).any(axis=2)
    (x,), (y,) = camera.to_screen(np.array([(32.0, 18.0)]))
    assert lit[round(float(x)) - 50 : round(float(x)) + 50, round(float(y))].all()
    assert lit.any(axis=0).sum() <= 5


def test_the_cursor_shows_which_tool_is_in_hand() -> None:
    hands = Hands(world_of(FOUR))
    hands.point_at((300, 300))
    assert hands.session.tools.preview is None
    hands.key(pygame.K_2)
    assert hands.session.tools.preview.tool is Tool.WALL
    hands.point_at((320, 300))
    assert hands.session.tools.preview.start == pytest.approx((320, 300), abs=1)


def test_the_article_has_no_walls_to_draw_and_says_so() -> None:
    hands = Hands(article_with(FOUR))
    hands.key(pygame.K_2)
    hands.drag((400, 50), (400, 450))
    assert len(hands.session.frame) == 4
    assert "article" in hands.session.notice


def test_escape_gives_up_a_drag_then_the_tool_then_the_selection_then_the_window() -> None:
    hands = Hands(world_of(FOUR))
    hands.click((100, 100))
    hands.key(pygame.K_2)
    hands.down((400, 50))
    hands.point_at((400, 400))
    hands.key(pygame.K_ESCAPE)
    assert hands.session.tools.preview.start == hands.session.tools.preview.end
    hands.up((400, 400))
    assert len(hands.session.frame) == 4
    hands.key(pygame.K_ESCAPE)
    assert hands.session.tools.tool is Tool.POINTER and len(hands.session.selection) == 1
    hands.key(pygame.K_ESCAPE)
    assert len(hands.session.selection) == 0 and hands.session.open
    hands.key(pygame.K_ESCAPE)
    assert not hands.session.open


# ---- attractors ----------------------------------------------------------------------------------


@pytest.mark.parametrize("make", [world_of, article_with])
def test_a_click_places_an_attractor_and_another_takes_it_away(make) -> None:
    hands = Hands(make([(300, 250)]))
    hands.key(pygame.K_3)
    hands.click((400, 250))
    (pull,) = hands.session.frame.attractors
    assert pull.point == pytest.approx((400, 250), abs=1) and pull.strength == STRENGTH
    hands.frames(6)
    assert hands.session.frame.velocities[0, 0] > 10
    hands.click((400, 250))
    assert hands.session.frame.attractors == ()


def test_dragging_an_attractor_sets_its_strength() -> None:
    hands = Hands(world_of([(300, 250)]))
    hands.key(pygame.K_3)
    hands.drag((400, 250), (420, 250))
    hands.drag((200, 250), (500, 250))
    weak, strong = (pull.strength for pull in hands.session.frame.attractors)
    assert 0 < weak < STRENGTH < strong


# ---- the picture ---------------------------------------------------------------------------------


@pytest.mark.parametrize("button", [MIDDLE, RIGHT])
def test_dragging_with_the_other_buttons_pans(button: int) -> None:
    hands = Hands(world_of(FOUR))
    before = hands.session.camera.to_world((700, 400))
    x, y = 500, 300
    post(pygame.MOUSEBUTTONDOWN, pos=(x, y), button=button)
    for _ in range(8):
        x, y = x + 25, y + 12
        hands.move((x, y))
        hands.frames(1, 0.0)
    post(pygame.MOUSEBUTTONUP, pos=(x, y), button=button)
    hands.frames(1, 0.0)
    assert hands.session.camera.to_world((700 + 200, 400 + 96)) == pytest.approx(before)
    assert hands.session.menu is None
    hands.move((100, 100))
    hands.frames(1, 0.0)
    assert hands.session.camera.to_world((900, 496)) == pytest.approx(before)


def test_the_wheel_zooms_at_the_cursor() -> None:
    hands = Hands(world_of(FOUR))
    hands.point_at((600, 400))
    place = hands.session.cursor
    before, scale = hands.session.camera.to_world(place), hands.session.camera.scale
    post(pygame.MOUSEWHEEL, x=0, y=-3, precise_y=-3.0)
    hands.frames(1, FRAME)
    assert hands.session.camera.scale < scale
    assert hands.session.camera.to_world(place) == pytest.approx(before)
