"""Two methods side by side on the same scene."""

from collections.abc import Callable

import numpy as np
import pygame
import pytest
from lab_interaction import gate_steps

import jostle
from jostle_lab import race as racing
from jostle_lab.draw.view_options import TreeView
from jostle_lab.schema import Group, Settings
from jostle_lab.simulate.frame import FrameRequest
from jostle_lab.simulate.start import start
from jostle_lab.window import Window

FRAME = 1 / 60


@pytest.fixture
def open_race(open_window: Callable[..., Window]) -> Callable[..., Window]:
    """Provide windows with the scene and the same scene by another method."""

    def make(settings: Settings, method: str = "brute", **options: object) -> Window:
        window = open_window(settings, (1280, 720), **options)
        window.session.runner.toggle_race(method)
        return window

    return make


def run(window: Window, frames: int) -> None:
    """Show frames, and wait for steps on worker threads, so that nothing depends on the machine."""
    for _ in range(frames):
        window.frame(FRAME)
        for contestant in window.session.runner.race.contestants:
            contestant.engine.wait()


def halves(window: Window) -> tuple[np.ndarray, np.ndarray]:
    """What the two columns show, without headings and the readout."""
    picture = pygame.surfarray.array3d(window.screen.canvas())
    camera = window.session.camera
    edge, end, width = (
        round(at) for at in (camera.column_edge(1), camera.column_edge(2), camera.column_width)
    )
    return picture[edge - width + 2 : edge - 2, 120:600], picture[edge + 2 : end - 2, 120:600]


def test_both_have_the_same_scene_and_stay_together_where_answers_are_the_same(open_window) -> None:
    window = open_window(Settings("gas", 400, seed=3), (1280, 720))
    run_before = window.session.engine
    for _ in range(5):
        window.frame(FRAME)
    window.session.runner.toggle_race("brute")
    left, right = (contestant.engine for contestant in window.session.runner.race.contestants)
    assert left is run_before and left.frame.stats.time == right.frame.stats.time == 0
    run(window, 12)
    assert right.settings.method == "brute" and left.settings.method == "quadtree"
    assert right.frame.stats.pairs_tested == 400 * 399 // 2 > left.frame.stats.pairs_tested
    steps = [contestant.steps for contestant in window.session.runner.race.contestants]
    assert min(steps) > 5
    for contestant in window.session.runner.race.contestants:
        while contestant.steps < max(steps):
            contestant.engine.step()
    assert window.session.runner.race.contestants[0].steps == right.steps
    assert (left.frame.positions == right.frame.positions).all()


def test_the_picture_has_two_halves_that_move_together(open_race) -> None:
    window = open_race(Settings("gas", 200))
    window.session.view_options.tree = TreeView.OFF
    window.session.runner.paused = True
    session = window.session
    for move in (
        lambda: None,
        lambda: session.camera.zoom_at((500, 400), 3.0),
        lambda: session.camera.pan((30, -20)),
    ):
        move()
        window.frame(0.0)
        left, right = halves(window)
        width = min(len(left), len(right))
        assert (left != left[0, 0]).any()
        differing = (left[:width] != right[:width]).any(axis=2).mean()
        assert differing < 0.02  # but for places between two pixels


def test_nothing_of_the_left_half_reaches_into_the_right_one(open_race) -> None:
    window = open_race(Settings("gas", 200))
    window.session.runner.paused = True
    window.session.camera.pan((-2_000, 0))  # both scenes far to the right
    window.frame(0.0)
    left, _ = halves(window)
    assert len(np.unique(left.reshape(-1, 3), axis=0)) <= 2


def test_the_slower_one_falls_behind_and_the_window_does_not_wait(open_race) -> None:
    window = open_race(Settings("gas", 300), "article-quadtree", synchronous=False)
    window.session.engine.wait_for_loading()
    window.frame(0.0)
    right = window.session.runner.race.engine
    _, release = gate_steps(right.simulation)
    try:
        left_contestant, right_contestant = window.session.runner.race.contestants
        for _ in range(30):
            window.frame(FRAME)  # would never end if it waited for the current step
            left_contestant.engine.wait()
        assert right.busy and right_contestant.steps == 0
        assert left_contestant.steps > 10
        assert left_contestant.stats.time > right_contestant.stats.time
    finally:
        release()


def edited(window: Window) -> bytes:
    """Edit the scene of a window, run it a while, and return its state."""
    session = window.session
    session.interaction.commands.delete(np.array([0, 1]))
    session.interaction.commands.wall((10, 10), (60, 10))
    session.interaction.attractors.place((20, 20))
    for _ in range(5):
        window.frame(FRAME)
        session.engine.wait()
    session.runner.paused = True
    return session.engine.simulation.save()


@pytest.mark.parametrize("synchronous", [True, False])
def test_the_race_ends_and_the_scene_before_it_returns_bit_for_bit(
    open_window: Callable[..., Window], synchronous: bool
) -> None:
    window = open_window(Settings("gas", 100), synchronous=synchronous)
    session, before = window.session, edited(window)
    session.runner.toggle_race("brute")
    session.engine.wait_for_loading()
    window.frame(0.0)
    assert session.camera.columns == 2 and len(session.frame) == 100
    session.runner.paused = False
    run(window, 3)
    session.runner.adjust("restitution", 0.5)  # which begins both again
    session.engine.wait_for_loading()
    session.interaction.commands.delete(np.array([5]))  # which undo does not bring back later
    run(window, 3)
    session.runner.paused = True
    session.runner.toggle_race()
    window.frame(0.0)
    session.engine.wait()
    assert session.runner.race is None and session.camera.columns == 1
    assert session.engine.simulation.save() == before
    assert session.runner.history.span > 0
    session.runner.undo()  # the edits before the race
    session.engine.wait()
    assert not session.engine.simulation.attractors
    session.runner.paused = False
    time = session.frame.stats.time
    for _ in range(5):
        window.frame(FRAME)
        session.engine.wait()
    assert session.frame.stats.time > time


def test_a_changed_setting_begins_both_anew(open_race) -> None:
    window = open_race(Settings("gas", 100))
    session = window.session
    run(window, 5)
    session.runner.adjust("restitution", 0.5)
    left, right = (contestant.engine for contestant in session.runner.race.contestants)
    assert left.settings.restitution == right.settings.restitution == 0.5
    assert left.frame.stats.time == right.frame.stats.time == 0
    assert right.settings.method == "brute" and session.camera.columns == 2
    run(window, 5)
    session.runner.restart()
    contestants = session.runner.race.contestants
    assert [(each.stats.time, each.steps) for each in contestants] == [(0, 0)] * 2


def test_pause_and_single_steps_hold_for_both_and_b_does_not_end_a_race(open_race) -> None:
    window = open_race(Settings("gas", 100))
    session = window.session
    session.runner.single_step()
    for _ in range(3):
        window.frame(FRAME)
    assert [contestant.steps for contestant in session.runner.race.contestants] == [1, 1]
    window.session.runner.switch_method()
    assert window.session.runner.race is not None and "Q ends" in window.session.message


def test_a_race_of_the_article_looks_at_the_same_part_of_the_world(open_race) -> None:
    window = open_race(Settings("orbit", 60), "article-brute")
    window.session.runner.paused = True
    window.session.view_options.tree = TreeView.OFF
    window.frame(0.0)
    left, right = halves(window)
    inks = [np.argwhere((half != half[0, 0]).any(axis=2)).mean(axis=0) for half in (left, right)]
    assert inks[0] == pytest.approx(inks[1], abs=16)


@pytest.mark.parametrize("method", ["quadtree", "brute"])
@pytest.mark.parametrize("scene", ["article", "orbit", "galton"])
def test_the_article_begins_with_the_particles_of_the_scene(scene: str, method: str) -> None:
    settings = Settings(scene, 60, particles=(Group(3),))
    right, left = racing.rival(settings, f"article-{method}"), start(settings)
    before, ours = right.frame(), left.frame()
    assert right.view == left.view and len(before) == len(ours)
    assert before.positions == pytest.approx(ours.positions, abs=1e-3)
    assert before.velocities == pytest.approx(ours.velocities, abs=1e-3)
    assert before.radii.tolist() == [max(round(radius), 1) for radius in ours.radii.tolist()]
    right.step()
    frame = right.frame(FrameRequest(tree=True))
    assert frame.stats.time == pytest.approx(1 / 30) and frame.stats.pairs_tested > 0
    low, high = left.view[:2], left.view[2:]
    assert frame.container == jostle.Box(*left.view)
    if method == "quadtree":
        assert (frame.tree.boxes[:, :2] >= np.array(low)).all()
        assert (frame.tree.boxes[:, 2:] <= np.array(high) + 1).all()
    else:
        assert len(frame.tree.boxes) == 0


def test_the_rules_of_the_article_lose_energy() -> None:
    right = racing.rival(Settings("gas", 200), "article-quadtree")
    before = right.frame().stats.kinetic_energy
    for _ in range(60):
        right.step()
    assert 0 < right.frame().stats.kinetic_energy < 0.5 * before


def test_what_cannot_race_is_refused_in_a_sentence(open_race) -> None:
    assert "two methods" in racing.refusal("brute", "brute", 10)
    assert "30,000" in racing.refusal("quadtree", "brute", 30_001)
    assert racing.refusal("quadtree", "brute", 30_000) is None
    assert "1,500" in racing.refusal("article-brute", "quadtree", 2_000)
    window = open_race(Settings("gas", 100), "quadtree")
    assert window.session.runner.race is None and "two methods" in window.session.message


def test_another_size_of_window_divides_it_anew(open_race, monkeypatch) -> None:
    window = open_race(Settings("gas", 100))
    for size in [(900, 500), (1, 1), (1280, 720)]:
        monkeypatch.setattr(pygame.display, "get_window_size", lambda size=size: size)
        pygame.event.post(pygame.event.Event(pygame.VIDEORESIZE, size=size, w=size[0], h=size[1]))
        window.frame(FRAME)
    left, right = halves(window)
    assert (left != left[0, 0]).any() and (right != right[0, 0]).any()
