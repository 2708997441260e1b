"""The interactive loop, driven by posted events, without a display."""

from collections.abc import Iterator

import numpy as np
import pygame
import pytest

import jostle
from jostle_lab.draw.view_options import TreeView
from jostle_lab.simulate.settings import MOST_BRUTE, Settings
from jostle_lab.simulate.simulation import Simulation
from jostle_lab.simulate.start import start
from jostle_lab.window import Window

FRAME = 1 / 60
VIEW = (0.0, 0.0, 1000.0, 1000.0)


def lone_ball(container: object = None) -> Simulation:
    """A ball at rest, and another far away, without gravity."""
    places = [(500, 500), (900, 100)]
    world = jostle.World(places, [(0, 0), (0, 0)], 20.0, container=container)
    return Simulation(Settings("lone ball"), VIEW, world)


@pytest.fixture
def open_window() -> Iterator:
    def make(simulation: Simulation, **options: object) -> Window:
        window = Window(simulation, (1000, 700), **options, synchronous=True)
        pygame.event.clear()
        return window

    yield make
    pygame.display.quit()


def press(window: Window, *keys: int) -> None:
    for key in keys:
        pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=key))
        pygame.event.post(pygame.event.Event(pygame.KEYUP, key=key))
    window.frame(0.0)


def mouse(kind: int, pixel: tuple[float, float]) -> None:
    place = round(pixel[0]), round(pixel[1])
    extra = {"button": 1} if kind != pygame.MOUSEMOTION else {"rel": (0, 0), "buttons": (1, 0, 0)}
    pygame.event.post(pygame.event.Event(kind, pos=place, **extra))


def screen_place(window: Window, point: tuple[float, float]) -> tuple[float, float]:
    (x,), (y,) = window.session.camera.to_screen(np.array([point]))
    return float(x), float(y)


def drag(window: Window, start: tuple[float, float], move: tuple[float, float], frames: int):
    """Press at a world point and move by pixels each frame; return the last pixel."""
    x, y = screen_place(window, start)
    mouse(pygame.MOUSEBUTTONDOWN, (x, y))
    for _ in range(frames):
        window.frame(FRAME)
        x, y = x + move[0], y + move[1]
        mouse(pygame.MOUSEMOTION, (x, y))
    return x, y


def test_a_throw_moves_the_ball_with_the_speed_of_the_drag_tool(open_window) -> None:
    window = open_window(lone_ball())
    world = window.session.engine.simulation.world
    end = drag(window, (500, 500), (6, -4), frames=20)
    mouse(pygame.MOUSEBUTTONUP, end)
    window.frame(FRAME)
    hand = np.array([6, -4]) / FRAME / window.session.camera.scale
    assert world.velocities[0] == pytest.approx(hand, rel=0.02)
    before = world.positions[0]
    for _ in range(6):
        window.frame(FRAME)
    assert world.positions[0] - before == pytest.approx(hand * 6 * FRAME, rel=0.02)
    assert window.session.interaction.drag_tool.held is None
    assert (world.velocities[1] == 0).all()


def test_a_held_ball_comes_to_rest_at_the_cursor(open_window) -> None:
    window = open_window(lone_ball())
    x, y = drag(window, (505, 495), (3, 2), frames=10)
    for _ in range(60):
        window.frame(FRAME)
    world = window.session.engine.simulation.world
    assert screen_place(window, world.positions[0]) == pytest.approx((x, y), abs=1.5)
    mouse(pygame.MOUSEBUTTONUP, (x, y))
    window.frame(FRAME)
    assert np.abs(world.velocities[0]).max() < 1e-3


def test_a_drag_crosses_the_boundary_of_a_torus(open_window) -> None:
    window = open_window(lone_ball(jostle.Torus(1000.0, 1000.0)))
    hand, engine = window.session.interaction.drag_tool, window.session.engine
    hand.grab(0, (500.0, 500.0), 0.0)
    hand.follow((1300.0, 500.0), 1.0)
    hand.follow((1300.0, 500.0), 2.0)
    for _ in range(120):
        engine.step()
    assert window.session.engine.simulation.world.positions[0] == pytest.approx((300, 500), abs=5)


def test_a_click_on_the_background_drags_nothing(open_window) -> None:
    window = open_window(lone_ball())
    mouse(pygame.MOUSEBUTTONDOWN, screen_place(window, (700, 700)))
    window.frame(FRAME)
    assert window.session.interaction.drag_tool.held is None


def test_what_cannot_move_cannot_be_picked_up(open_window) -> None:
    world = jostle.World([(500, 500)], [(0, 0)], 20.0, movable=[False])
    window = open_window(Simulation(Settings("peg"), VIEW, world))
    mouse(pygame.MOUSEBUTTONDOWN, screen_place(window, (500, 500)))
    window.frame(FRAME)
    assert window.session.interaction.drag_tool.held is None


def test_p_pauses_and_goes_on(open_window) -> None:
    window = open_window(Simulation.of_scene(Settings("gas", 50)))
    press(window, pygame.K_p)
    time = window.session.engine.simulation.world.time
    window.frame(FRAME)
    assert window.session.runner.paused and window.session.engine.simulation.world.time == time
    press(window, pygame.K_p)
    window.frame(FRAME)
    assert window.session.engine.simulation.world.time > time


def test_o_makes_one_step_and_stays_paused(open_window) -> None:
    window = open_window(Simulation.of_scene(Settings("gas", 50)))
    press(window, pygame.K_o)
    assert window.session.engine.simulation.world.time == pytest.approx(FRAME)
    press(window, pygame.K_o)
    window.frame(FRAME)
    assert window.session.runner.paused
    assert window.session.engine.simulation.world.time == pytest.approx(2 * FRAME)


@pytest.mark.parametrize("method", ["quadtree", "brute"])
def test_r_starts_again_with_the_method_of_the_moment(open_window, method) -> None:
    window = open_window(start(Settings("article", 40, method=method)))
    first = window.session.engine.simulation.frame().positions
    window.frame(FRAME)
    window.frame(FRAME)
    assert (window.session.engine.simulation.frame().positions != first).any()
    press(window, pygame.K_b)
    method = window.session.engine.simulation.settings.method
    press(window, pygame.K_r)
    assert (window.session.engine.simulation.frame().positions == first).all()
    assert window.session.engine.simulation.settings.method == method


def test_b_switches_brute_force_and_tree(open_window) -> None:
    window = open_window(start(Settings("article", 300)))
    every_pair = 300 * 299 // 2
    for name in ("brute", "quadtree"):
        press(window, pygame.K_b)
        assert window.session.settings.method == name
        window.session.engine.step()
        tested = window.session.frame.stats.pairs_tested
        assert tested == every_pair if "brute" in name else tested < every_pair


def test_b_refuses_what_would_freeze_the_window(open_window) -> None:
    window = open_window(Simulation.of_scene(Settings("gas", MOST_BRUTE + 1)))
    window.session.runner.paused = True
    press(window, pygame.K_b)
    assert window.session.engine.simulation.world.method == "quadtree"
    assert "too slow" in window.session.message


def test_t_cycles_the_tree(open_window) -> None:
    window = open_window(Simulation.of_scene(Settings("gas", 200)))
    window.session.runner.paused = True
    first = window.session.view_options.tree
    pictures, views = [], []
    for _ in TreeView:
        press(window, pygame.K_t)
        views.append(window.session.view_options.tree)
        pictures.append(pygame.surfarray.array3d(window.painter.canvas())[300:, 60:-80].copy())
    assert set(views) == set(TreeView) and views[-1] is first
    assert all((pictures[k] != pictures[k - 1]).any() for k in range(len(pictures)))


def test_the_wheel_zooms_at_the_cursor(open_window) -> None:
    window = open_window(lone_ball())
    mouse(pygame.MOUSEMOTION, (813, 222))
    window.frame(0.0)
    camera = window.session.camera
    before, scale = camera.to_world((813, 222)), camera.scale
    pygame.event.post(pygame.event.Event(pygame.MOUSEWHEEL, x=0, y=2, precise_y=2.0))
    window.frame(0.0)
    assert camera.scale > 1.2 * scale
    assert camera.to_world((813, 222)) == pytest.approx(before)


def test_arrows_pan_while_they_are_down_and_home_goes_back(open_window) -> None:
    window = open_window(lone_ball())
    camera = window.session.camera
    start = camera.center
    pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=pygame.K_RIGHT))
    window.frame(0.1)
    window.frame(0.1)
    assert camera.center[0] > start[0] and camera.center[1] == start[1]
    pygame.event.post(pygame.event.Event(pygame.KEYUP, key=pygame.K_RIGHT))
    window.frame(0.1)
    place = camera.center
    window.frame(0.1)
    assert camera.center == place
    press(window, pygame.K_HOME)
    assert camera.center == start


def test_h_shows_and_hides_the_keys(open_window) -> None:
    window = open_window(lone_ball())
    window.session.runner.paused = True
    press(window, pygame.K_h)
    assert window.session.view_options.help
    press(window, pygame.K_h)
    assert not window.session.view_options.help


def test_escape_and_the_cross_close_the_window(open_window) -> None:
    window = open_window(lone_ball())
    press(window, pygame.K_ESCAPE)
    assert not window.session.open
    window = open_window(lone_ball())
    pygame.event.post(pygame.event.Event(pygame.QUIT))
    window.run()
    assert not window.session.open and not pygame.display.get_init()


def test_the_window_closes_after_the_steps_asked_for(open_window) -> None:
    window = open_window(lone_ball(), steps=3)
    window.run()
    assert window.session.engine.steps == 3
    assert window.session.engine.simulation.world.time == pytest.approx(3 * FRAME)


def test_the_picture_follows_the_size_of_the_window(open_window) -> None:
    window = open_window(lone_ball())
    for size in [(640, 360), (150, 90), (1, 1)]:
        pygame.display.set_mode(size, pygame.RESIZABLE)
        pygame.event.post(pygame.event.Event(pygame.VIDEORESIZE, size=size, w=size[0], h=size[1]))
        window.frame(FRAME)
        assert window.painter.size == window.screen.size == size


@pytest.mark.parametrize("method", ["quadtree", "brute"])
@pytest.mark.parametrize("n", [0, 1])
def test_nothing_and_almost_nothing_run(open_window, n: int, method: str) -> None:
    window = open_window(Simulation.of_scene(Settings("gas", n, method=method)))
    for view in TreeView:
        window.session.view_options.tree = view
        mouse(pygame.MOUSEBUTTONDOWN, (640, 350))
        window.frame(FRAME)
    assert len(window.session.engine.simulation) == n
