"""Two methods side by side on the same scene."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

pygame = pytest.importorskip("pygame")

from jostle.app import race as racing  # noqa: E402
from jostle.app.draw.shown import TreeView  # noqa: E402
from jostle.app.simulate.engine import SHORT  # noqa: E402
from jostle.app.simulate.settings import Settings  # noqa: E402
from jostle.app.simulate.start import start  # noqa: E402
from jostle.app.window import Window  # noqa: E402

FRAME = 1 / 60


@pytest.fixture
def open_window() -> Iterator:
    windows = []

    def make(settings: Settings) -> Window:
        window = Window(start(settings), (1280, 720))
        pygame.event.clear()
        windows.append(window)
        return window

    yield make
    for window in windows:
        window.session.close()
    pygame.display.quit()


def run(window: Window, frames: int) -> None:
    """Show frames, and let steps beside the window end, so that nothing depends on the machine."""
    for _ in range(frames):
        window.frame(FRAME)
        for lane in window.session.race.lanes:
            lane.engine.wait()


def halves(window: Window) -> tuple[np.ndarray, np.ndarray]:
    """What the two columns show, without headings and the readout."""
    picture = pygame.surfarray.array3d(window.painter.canvas())
    camera = window.session.camera
    edge, end, width = (
        round(at) for at in (camera.column_edge(1), camera.column_edge(2), camera.column_width)
    )
    return picture[edge - width + 2 : edge - 2, 120:600], picture[edge + 2 : end - 2, 120:600]


def test_both_have_the_same_scene_and_stay_together_where_answers_are_the_same(open_window) -> None:
    window = open_window(Settings("gas", 400, seed=3))
    run_before = window.session.engine
    for _ in range(5):
        window.frame(FRAME)
    window.session.toggle_race("brute")
    left, right = (lane.engine for lane in window.session.race.lanes)
    assert left is run_before and left.frame.facts.time == right.frame.facts.time == 0
    run(window, 12)
    assert right.settings.method == "brute" and left.settings.method == "quadtree"
    assert right.frame.facts.pairs_tested == 400 * 399 // 2 > left.frame.facts.pairs_tested
    steps = min(lane.steps for lane in window.session.race.lanes)
    assert steps > 5
    for lane in window.session.race.lanes:
        while lane.steps < 15:
            lane.engine.step()
    assert left.steps - window.session.race.lanes[0]._first == right.steps == 15
    assert (left.frame.positions == right.frame.positions).all()


def test_the_picture_has_two_halves_that_move_together(open_window) -> None:
    window = open_window(Settings("gas", 200))
    window.session.toggle_race("brute")
    window.session.shown.tree = TreeView.OFF
    window.session.paused = True
    session = window.session
    for move in (lambda: None, lambda: session.camera.zoom_at((500, 400), 3.0),
                 lambda: session.camera.pan((30, -20))):  # fmt: skip
        move()
        window.frame(0.0)
        left, right = halves(window)
        width = min(len(left), len(right))
        assert (left != left[0, 0]).any()
        differing = (left[:width] != right[:width]).any(axis=2).mean()
        assert differing < 0.02  # but for places between two pixels


def test_nothing_of_the_left_half_reaches_into_the_right_one(open_window) -> None:
    window = open_window(Settings("gas", 200))
    window.session.toggle_race("brute")
    window.session.paused = True
    window.session.camera.pan((-2_000, 0))  # both scenes far to the right
    window.frame(0.0)
    left, _ = halves(window)
    assert len(np.unique(left.reshape(-1, 3), axis=0)) <= 2


def test_the_slower_one_falls_behind_and_the_window_does_not_wait(open_window) -> None:
    window = open_window(Settings("gas", 300))
    window.session.toggle_race("article-quadtree")
    right = window.session.race.engine
    release = _held_up(right.simulation)
    try:
        left_lane, right_lane = window.session.race.lanes
        for _ in range(30):
            window.frame(FRAME)  # would never end if it waited for the step under way
            left_lane.engine.wait()  # so that the left one makes a step a frame on any machine
        assert right.busy and right_lane.steps == 0
        assert left_lane.steps > 10 and left_lane.facts.time > right_lane.facts.time
    finally:
        release()


def _held_up(simulation):
    """Let the simulation's steps wait until the answer is called."""
    import threading

    gate, step = threading.Event(), simulation.step

    def waiting() -> None:
        gate.wait(30)
        step()

    simulation.step = waiting
    return gate.set


def test_the_race_ends_and_the_scene_goes_on_alone(open_window) -> None:
    window = open_window(Settings("gas", 100))
    session = window.session
    session.toggle_race("brute")
    assert session.engine.short < SHORT and session.camera.columns == 2
    run(window, 3)
    session.toggle_race("brute")
    assert session.race is None and session.camera.columns == 1 and session.engine.short == SHORT
    before = session.frame.facts.time
    for _ in range(5):
        window.frame(FRAME)
        session.engine.wait()
    assert session.frame.facts.time > before


def test_a_changed_setting_begins_both_anew(open_window) -> None:
    window = open_window(Settings("gas", 100))
    session = window.session
    session.toggle_race("brute")
    run(window, 5)
    session.adjust("restitution", 0.5)
    left, right = (lane.engine for lane in session.race.lanes)
    assert left.settings.restitution == right.settings.restitution == 0.5
    assert left.frame.facts.time == right.frame.facts.time == 0
    assert right.settings.method == "brute" and session.camera.columns == 2
    run(window, 5)
    session.restart()
    assert all(lane.facts.time == 0 and lane.steps == 0 for lane in session.race.lanes)


def test_pause_and_single_steps_hold_for_both(open_window) -> None:
    window = open_window(Settings("gas", 100))
    session = window.session
    session.toggle_race("brute")
    session.single_step()
    for _ in range(3):
        window.frame(FRAME)
    assert [lane.steps for lane in session.race.lanes] == [1, 1]


def test_a_race_of_the_article_looks_at_the_same_part_of_the_world(open_window) -> None:
    window = open_window(Settings("orbit", 60))
    window.session.toggle_race("article-brute")
    window.session.paused = True
    window.session.shown.tree = TreeView.OFF
    window.frame(0.0)
    left, right = halves(window)
    inks = [np.argwhere((half != half[0, 0]).any(axis=2)).mean(axis=0) for half in (left, right)]
    assert inks[0] == pytest.approx(inks[1], abs=12)


def test_what_cannot_race_is_refused_in_a_sentence(open_window) -> None:
    assert "two methods" in racing.refusal("brute", "brute", 10)
    assert "30,000" in racing.refusal("quadtree", "brute", 30_001)
    assert racing.refusal("quadtree", "brute", 30_000) is None
    assert "1,500" in racing.refusal("article-brute", "quadtree", 2_000)
    window = open_window(Settings("gas", 100))
    window.session.toggle_race("quadtree")
    assert window.session.race is None and "two methods" in window.session.notice


def test_another_size_of_window_divides_it_anew(open_window) -> None:
    window = open_window(Settings("gas", 100))
    window.session.toggle_race("brute")
    for size in [(900, 500), (1, 1), (1280, 720)]:
        pygame.display.set_mode(size, pygame.RESIZABLE)
        pygame.event.post(pygame.event.Event(pygame.VIDEORESIZE, size=size, w=size[0], h=size[1]))
        window.frame(FRAME)
    left, right = halves(window)
    assert (left != left[0, 0]).any() and (right != right[0, 0]).any()


def test_b_does_not_end_a_race(open_window) -> None:
    window = open_window(Settings("gas", 100))
    window.session.toggle_race()
    window.session.switch_method()
    assert window.session.race is not None and "Q ends" in window.session.notice
