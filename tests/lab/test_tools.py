"""Selecting, drawing walls, placing attractors, panning and zooming, by posted events."""

import numpy as np
import pygame
import pytest
from lab_interaction import FRAME, MIDDLE, RIGHT, Driver, post, tags, world_of

from jostle_lab.act.attractors import STRENGTH
from jostle_lab.act.interaction import Tool
from jostle_lab.act.view import draw_preview, draw_selection
from jostle_lab.draw.base_layers import draw_walls
from jostle_lab.draw.camera import Camera
from jostle_lab.draw.palette import STAGE
from jostle_lab.draw.software import SoftwarePainter
from jostle_lab.gui.input import ZOOM_STEP
from jostle_lab.schema import Polyline, Settings
from jostle_lab.simulate.region import Torus
from jostle_lab.simulate.start import start

FOUR = [(100, 100), (200, 100), (100, 300), (600, 400)]


def beside_a_wall(low: float = 50, high: float = 450) -> Driver:
    """Draw a wall to the right of a disc; the tool for walls is chosen."""
    driver = Driver(world_of([(200, 250)]))
    driver.key(pygame.K_2)
    driver.drag((400, low), (400, high))
    return driver


def test_a_box_selects_what_lies_in_it_and_shift_adds_or_takes_away() -> None:
    driver = Driver(world_of(FOUR))
    driver.drag((50, 50), (250, 350))
    assert tags(driver.session.interaction.selection.tags) == [0, 1, 2]
    driver.drag((700, 450), (550, 350))  # from the other corner; without Shift it replaces
    assert tags(driver.session.interaction.selection.tags) == [3]
    driver.click((100, 100))
    driver.drag((550, 350), (700, 450), mod=pygame.KMOD_SHIFT)
    assert tags(driver.session.interaction.selection.tags) == [0, 3]
    driver.click((600, 400), mod=pygame.KMOD_SHIFT)
    driver.click((200, 100), mod=pygame.KMOD_LSHIFT)
    assert tags(driver.session.interaction.selection.tags) == [0, 1]
    driver.click((400, 250))
    assert len(driver.session.interaction.selection) == 0


def test_what_is_deleted_falls_out_of_the_selection() -> None:
    driver = Driver(world_of(FOUR))
    driver.drag((50, 50), (250, 350))
    driver.session.engine.edit(lambda simulation: simulation.remove([1]))
    driver.frames(1)
    assert tags(driver.session.interaction.selection.tags) == [0, 2]
    driver.key(pygame.K_PAGEDOWN)
    assert driver.session.frame.tags[0] == 0 and len(driver.session.interaction.selection) == 0


def test_the_rubber_band_and_the_rings_are_drawn() -> None:
    driver = Driver(world_of(FOUR))
    driver.down((50, 50))
    driver.point_at((250, 350))
    preview = driver.session.interaction.preview
    assert preview.tool is Tool.POINTER and preview.end == pytest.approx((250, 350), abs=1)
    painter = SoftwarePainter(driver.session.camera.size)
    painter.fill((0, 0, 0))
    draw_preview(painter, preview, driver.session.camera)
    edge = driver.pixel((50, 200))
    assert pygame.surfarray.array3d(painter.canvas())[edge[0], edge[1]].any()
    driver.up((250, 350))
    assert driver.session.interaction.preview is None
    painter.fill((0, 0, 0))
    session = driver.session
    draw_selection(painter, session.frame, session.interaction.selection, session.camera)
    x, y = driver.pixel((100, 100))
    around = pygame.surfarray.array3d(painter.canvas())[x - 30 : x + 30, y - 30 : y + 30]
    assert around.any() and not around[28:32, 28:32].any()


def test_a_wall_that_is_drawn_stops_a_ball() -> None:
    driver = beside_a_wall()
    assert driver.session.frame.walls[0] == pytest.approx(np.array([(400, 50), (400, 450)]), abs=2)
    driver.session.engine.edit(lambda simulation: simulation.change([0], velocities=(900, 0)))
    driver.frames(20)
    assert driver.world.positions[0, 0] < 400 and driver.world.velocities[0, 0] < 0


def test_a_held_ball_is_not_pushed_through_a_wall_that_is_drawn() -> None:
    driver = beside_a_wall(0, 500)
    driver.key(pygame.K_1)
    driver.down((200, 250))
    driver.point_at((700, 250))
    driver.frames(90)
    assert driver.session.interaction.drag_tool.held == 0
    assert 300 < driver.world.positions[0, 0] < 400


def test_the_walls_of_a_scene_stay_when_those_that_were_drawn_are_cleared() -> None:
    simulation = start(Settings("gas", 0, walls=(Polyline(((10, 10), (50, 10), (90, 40))),)))
    driver = Driver(simulation)
    own = driver.world.walls.segments
    driver.session.interaction.commands.wall((20, 20), (70, 70))
    assert driver.session.interaction.commands.drawn_walls.tolist() == [2]
    driver.session.interaction.commands.clear_walls()
    np.testing.assert_array_equal(driver.world.walls.segments, own)


def test_a_click_removes_the_wall_under_the_cursor_or_its_image_and_all_can_be_cleared() -> None:
    driver = beside_a_wall()
    driver.drag((50, 450), (300, 450))
    driver.click((600, 250))
    assert len(driver.session.frame.walls) == 2
    driver.click((400, 200))
    assert driver.session.frame.walls[:, 0, 1] == pytest.approx([450], abs=2)
    driver.drag((400, 50), (400, 450))
    assert driver.session.interaction.commands.drawn_walls.tolist() == [0, 1]
    driver.session.interaction.commands.clear_walls()
    assert len(driver.session.frame.walls) == 0 == len(driver.world.walls)
    driver = Driver(world_of([(200, 250)], period=(800, 500)))
    driver.session.interaction.commands.wall((600, 250), (900, 250))
    driver.key(pygame.K_2)
    driver.click((300, 250))
    assert len(driver.session.frame.walls) == 1
    driver.click((50, 250))
    assert len(driver.session.frame.walls) == 0


def test_a_drawn_wall_goes_and_comes_with_the_history() -> None:
    driver = Driver(world_of([(200, 250)]))
    driver.frames(3)
    driver.key(pygame.K_2)
    driver.drag((400, 50), (400, 450))
    driver.frames(3)
    history, now = driver.session.runner.history, driver.session.frame.walls
    assert len(now) == 1
    state = driver.session.engine.simulation.save()
    driver.key(pygame.K_p)
    for _ in range(6):
        driver.key(pygame.K_u)
    assert history is not None and len(driver.session.frame.walls) == 0
    driver.session.engine.simulation.load(state)
    np.testing.assert_array_equal(driver.session.engine.simulation.frame().walls, now)
    assert driver.session.engine.simulation.frame().own_walls == 0


@pytest.mark.parametrize("size", [(640, 360), (1920, 1080)])
def test_walls_are_drawn_even_if_their_ends_are_far_outside(size) -> None:
    painter = SoftwarePainter(size)
    camera = Camera(size, (0.0, 0.0, 64.0, 36.0))
    painter.fill(STAGE)
    walls = np.array([[(-1e9, 18.0), (1e9, 18.0)], [(1e9, 1e9), (2e9, 1e9)]])
    draw_walls(painter, walls, None, camera)
    canvas = pygame.surfarray.array3d(painter.canvas())
    lit = (canvas != np.array(STAGE)).any(axis=2)
    (x,), (y,) = camera.to_screen(np.array([(32.0, 18.0)]))
    assert lit[round(float(x)) - 50 : round(float(x)) + 50, round(float(y))].all()
    assert lit.any(axis=0).sum() <= 5


def test_images_of_walls_are_drawn_on_a_torus_alone() -> None:
    """One wall crosses the right side and one a corner; a third was carried away by its motion."""
    painter = SoftwarePainter((640, 360))
    camera = Camera((640, 360), (-8.0, -8.0, 24.0, 24.0))
    painter.fill(STAGE)
    walls = [[(14, 4), (20, 4)], [(-1, -1), (1, 1)], [(164, 12), (168, 12)]]
    draw_walls(painter, np.array(walls, np.float32), Torus(16, 16), camera)
    canvas = pygame.surfarray.array3d(painter.canvas())
    points = np.array(
        [(15, 4), (2, 4), (0.5, 0.5), (15.5, 15.5), (6, 12), (18, 4), (-2, 4), (-0.5, -0.5)]
    )
    x, y = np.rint(camera.to_screen(points)).astype(int)
    lit = (canvas[x, y] != np.array(STAGE)).any(axis=1)
    assert lit.tolist() == [True] * 5 + [False] * 3


def test_the_cursor_shows_which_tool_is_in_drag_tool() -> None:
    driver = Driver(world_of(FOUR))
    driver.point_at((300, 300))
    assert driver.session.interaction.preview is None
    driver.key(pygame.K_2)
    assert driver.session.interaction.preview.tool is Tool.WALL
    driver.point_at((320, 300))
    assert driver.session.interaction.preview.start == pytest.approx((320, 300), abs=1)


def test_escape_gives_up_a_drag_then_the_tool_then_the_selection_and_never_quits() -> None:
    driver = Driver(world_of(FOUR))
    driver.click((100, 100))
    driver.key(pygame.K_2)
    driver.down((400, 50))
    driver.point_at((400, 400))
    driver.key(pygame.K_ESCAPE)
    assert driver.session.interaction.preview.start == driver.session.interaction.preview.end
    driver.up((400, 400))
    assert len(driver.session.frame) == 4
    driver.key(pygame.K_ESCAPE)
    assert driver.session.interaction.tool is Tool.POINTER
    assert len(driver.session.interaction.selection) == 1
    driver.key(pygame.K_ESCAPE)
    assert len(driver.session.interaction.selection) == 0 and driver.session.open
    driver.key(pygame.K_ESCAPE)
    assert driver.session.open and driver.session.message == "Ctrl+Q quits."


def test_a_click_places_an_attractor_or_takes_it_away_and_a_drag_sets_its_strength() -> None:
    driver = Driver(world_of([(300, 250)]))
    driver.key(pygame.K_3)
    driver.click((400, 250))
    (pull,) = driver.session.frame.attractors
    assert pull.point == pytest.approx((400, 250), abs=1) and pull.strength == STRENGTH
    driver.frames(6)
    assert driver.session.frame.velocities[0, 0] > 10
    driver.click((400, 250))
    assert driver.session.frame.attractors == ()
    driver.drag((400, 250), (420, 250))
    driver.drag((200, 250), (500, 250))
    weak, strong = (pull.strength for pull in driver.session.frame.attractors)
    assert 0 < weak < STRENGTH < strong


@pytest.mark.parametrize("button", [MIDDLE, RIGHT])
def test_dragging_with_the_other_buttons_pans(button: int) -> None:
    driver = Driver(world_of(FOUR))
    before = driver.session.camera.to_world((700, 400))
    x, y = 500, 300
    post(pygame.MOUSEBUTTONDOWN, pos=(x, y), button=button)
    for _ in range(8):
        x, y = x + 25, y + 12
        driver.move((x, y))
        driver.frames(1, 0.0)
    post(pygame.MOUSEBUTTONUP, pos=(x, y), button=button)
    driver.frames(1, 0.0)
    assert driver.session.camera.to_world((700 + 200, 400 + 96)) == pytest.approx(before)
    assert driver.session.interaction.menu is None
    driver.move((100, 100))
    driver.frames(1, 0.0)
    assert driver.session.camera.to_world((900, 496)) == pytest.approx(before)


@pytest.mark.parametrize("notches", [2, -3])
def test_the_wheel_zooms_at_the_cursor(notches: int) -> None:
    driver = Driver(world_of(FOUR))
    driver.point_at((600, 400))
    place, camera = driver.session.interaction.cursor, driver.session.camera
    before, scale = camera.to_world(place), camera.scale
    post(pygame.MOUSEWHEEL, x=0, y=notches, precise_y=float(notches))
    driver.frames(1, FRAME)
    assert camera.scale == pytest.approx(scale * ZOOM_STEP**notches)
    assert camera.to_world(place) == pytest.approx(before)
