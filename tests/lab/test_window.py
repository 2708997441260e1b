"""The interactive loop, driven by posted events, without a display."""

import sys
from collections.abc import Iterator
from types import FrameType

import numpy as np
import pygame
import pytest
from lab_interaction import FRAME, LEFT, SIZE, Driver, Point, post, world_of

from jostle_lab.draw.view_options import TreeView
from jostle_lab.schema import MOST_BRUTE, Settings
from jostle_lab.simulate.simulation import Inputs, Simulation
from jostle_lab.simulate.start import start

TWO = [(400, 250), (700, 100)]


def drag(driver: Driver, point: Point, move: Point, frames: int) -> tuple[int, int]:
    """Press at a world point and move by whole pixels each frame; return the last pixel."""
    driver.down(point)
    x, y = driver.pixel(point)
    for _ in range(frames):
        driver.frames(1)
        x, y = x + move[0], y + move[1]
        driver.move((x, y))
    return x, y


def let_go(driver: Driver, pixel: tuple[int, int]) -> None:
    post(pygame.MOUSEBUTTONUP, pos=pixel, button=LEFT)
    driver.frames(1)


def test_a_throw_moves_the_ball_with_the_speed_of_the_drag_tool() -> None:
    driver = Driver(world_of(TWO, 20.0))
    let_go(driver, drag(driver, TWO[0], (6, -4), frames=20))
    hand = np.array([6, -4]) / FRAME / driver.session.camera.scale
    assert driver.world.velocities[0] == pytest.approx(hand, rel=0.02)
    before = driver.world.positions[0]
    driver.frames(6)
    assert driver.world.positions[0] - before == pytest.approx(hand * 6 * FRAME, rel=0.02)
    assert driver.session.interaction.drag_tool.held is None
    assert (driver.world.velocities[1] == 0).all()


def test_a_held_ball_comes_to_rest_at_the_cursor() -> None:
    driver = Driver(world_of(TWO, 20.0))
    pixel = drag(driver, (405, 245), (3, 2), frames=10)
    driver.frames(60)
    assert driver.pixel(driver.world.positions[0]) == pytest.approx(pixel, abs=1.5)
    let_go(driver, pixel)
    assert np.abs(driver.world.velocities[0]).max() < 1e-3


def test_a_drag_crosses_the_boundary_of_a_torus() -> None:
    driver = Driver(world_of(TWO, 20.0, period=(800.0, 500.0)))
    hand = driver.session.interaction.drag_tool
    hand.grab(0, (400.0, 250.0), 0.0)
    hand.follow((1040.0, 250.0), 1.0)
    hand.follow((1040.0, 250.0), 2.0)
    driver.session.engine.hold(Inputs(hand.state))
    for _ in range(120):
        driver.session.engine.step()
    assert driver.world.positions[0] == pytest.approx((240, 250), abs=5)


@pytest.mark.parametrize(("point", "movable"), [((600, 400), True), (TWO[0], False)])
def test_neither_the_background_nor_what_cannot_move_is_held(point: Point, movable: bool) -> None:
    driver = Driver(world_of(TWO, 20.0, movable=[movable] * 2))
    driver.down(point)
    assert driver.session.interaction.drag_tool.held is None


def test_p_pauses_and_goes_on_and_o_makes_one_step_and_pauses() -> None:
    driver = Driver(Simulation.of_scene(Settings("gas", 50)))
    driver.key(pygame.K_p)
    time = driver.world.time
    driver.frames(1)
    assert driver.session.runner.paused and driver.world.time == time
    driver.key(pygame.K_p)
    driver.frames(1)
    assert driver.world.time > time
    time = driver.world.time
    driver.key(pygame.K_o)
    assert driver.world.time == pytest.approx(time + FRAME)
    driver.key(pygame.K_o)
    driver.frames(1)
    assert driver.session.runner.paused
    assert driver.world.time == pytest.approx(time + 2 * FRAME)


@pytest.mark.parametrize("method", ["quadtree", "brute"])
def test_r_starts_again_with_the_method_of_the_moment(method: str) -> None:
    driver = Driver(start(Settings("article", 40, method=method)))
    first = driver.world.positions
    driver.frames(2)
    assert (driver.world.positions != first).any()
    driver.key(pygame.K_b)
    changed = driver.session.settings.method
    driver.key(pygame.K_r)
    assert (driver.world.positions == first).all()
    assert driver.session.settings.method == changed != method


def test_b_switches_brute_force_and_tree_and_refuses_what_would_freeze_the_window() -> None:
    driver = Driver(start(Settings("article", 300)))
    every_pair = 300 * 299 // 2
    for name in ("brute", "quadtree"):
        driver.key(pygame.K_b)
        assert driver.session.settings.method == name
        driver.session.engine.step()
        tested = driver.session.frame.stats.pairs_tested
        assert tested == every_pair if name == "brute" else tested < every_pair
    driver = Driver(Simulation.of_scene(Settings("gas", MOST_BRUTE + 1)), paused=True)
    driver.key(pygame.K_b)
    assert driver.world.method == "quadtree"
    assert "too slow" in driver.session.message


def test_t_cycles_the_tree() -> None:
    driver = Driver(Simulation.of_scene(Settings("gas", 200)), paused=True)
    first = driver.session.view_options.tree
    pictures, views = [], []
    for _ in TreeView:
        driver.key(pygame.K_t)
        views.append(driver.session.view_options.tree)
        pictures.append(pygame.surfarray.array3d(driver.window.screen.canvas())[:, 60:-80])
    assert set(views) == set(TreeView) and views[-1] is first
    assert all((pictures[k] != pictures[k - 1]).any() for k in range(len(pictures)))


def test_arrows_pan_while_they_are_down_and_home_goes_back() -> None:
    driver = Driver(world_of(TWO))
    camera = driver.session.camera
    home = camera.center
    driver.key(pygame.K_RIGHT, up=False)
    driver.frames(2, 0.1)
    assert camera.center[0] > home[0] and camera.center[1] == home[1]
    driver.key_up(pygame.K_RIGHT)
    place = camera.center
    driver.frames(1, 0.1)
    assert camera.center == place
    driver.key(pygame.K_HOME)
    assert camera.center == home


def test_the_window_closes_by_its_cross_or_after_the_steps_asked_for() -> None:
    driver = Driver(world_of(TWO))
    post(pygame.QUIT)
    driver.window.run()
    assert not driver.session.open and not pygame.display.get_init()
    driver = Driver(world_of(TWO), steps=3)
    driver.window.run()
    assert driver.session.engine.steps == 3
    assert driver.world.time == pytest.approx(3 * FRAME)


@pytest.mark.parametrize("method", ["quadtree", "brute"])
@pytest.mark.parametrize("n", [0, 1])
def test_nothing_and_almost_nothing_run(n: int, method: str) -> None:
    driver = Driver(Simulation.of_scene(Settings("gas", n, method=method)))
    for view in TreeView:
        driver.session.view_options.tree = view
        post(pygame.MOUSEBUTTONDOWN, pos=(SIZE[0] // 2, SIZE[1] // 2), button=LEFT)
        driver.frames(1)
    assert len(driver.world) == n


def callers(frame: FrameType | None) -> Iterator[tuple[str, str]]:
    """Yield the file and the name of the functions of the simulator that are running."""
    while frame is not None:
        _, inside, file = frame.f_code.co_filename.partition("jostle_lab/")
        if inside:
            yield file, frame.f_code.co_qualname
        frame = frame.f_back


@pytest.mark.skipif(sys.version_info < (3, 11), reason="code objects have no qualified names")
def test_a_motion_of_the_mouse_reaches_the_world_in_at_most_eight_calls_and_five_files() -> None:
    """The calls on the way from an event to a step, below the loop of the window."""
    driver = Driver(world_of(TWO))
    driver.down(TWO[0])
    driver.move(driver.pixel((450, 250)))
    path: set[tuple[str, str]] = set()
    before = driver.session.interaction.cursor

    def profile(frame: FrameType, event: str, _: object) -> None:
        name = frame.f_code.co_qualname
        arrives = event == "return" and name == "Input.handle"
        cursor = driver.session.interaction.cursor
        if (arrives and cursor != before) or (
            event == "call" and name in ("Interaction.inputs", "Simulation.step")
        ):
            path.update(callers(frame))

    sys.setprofile(profile)
    try:
        driver.frames(1)
    finally:
        sys.setprofile(None)
    assert driver.world.positions[0, 0] > TWO[0][0]
    path = {(file, name) for file, name in path if file != "window.py"}
    assert path == {
        ("gui/input.py", "Input.handle"),
        ("session.py", "Session.advance"),
        ("act/interaction.py", "Interaction.inputs"),
        ("simulate/engine.py", "Engine.advance"),
        ("simulate/engine.py", "Engine._start"),
        ("simulate/engine.py", "Worker.submit"),
        ("simulate/engine.py", "Job.run"),
        ("simulate/simulation.py", "Simulation.step"),
    }
