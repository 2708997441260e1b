"""Real time to whole steps."""

import pytest

from jostle_lab.simulate.engine import MAX_STEPS, FixedTimestep

STEP = 1 / 60


def count(pace: FixedTimestep, elapsed: float) -> int:
    return pace.advance(elapsed, lambda: None)


def test_a_screen_of_any_speed_gives_sixty_steps_a_second() -> None:
    for screen in (30, 60, 75, 144):
        pace = FixedTimestep(STEP)
        steps = sum(count(pace, 1 / screen) for _ in range(2 * screen))
        assert steps == pytest.approx(120, abs=1)


def test_a_screen_beating_near_sixty_hertz_gives_one_step_a_frame() -> None:
    pace = FixedTimestep(STEP)
    assert [count(pace, 1 / 59.94), count(pace, 0.017), count(pace, 0.016)] == [1, 1, 1]


def test_a_slow_machine_slows_simulated_time_instead_of_falling_behind() -> None:
    pace = FixedTimestep(STEP)
    assert count(pace, 10.0) == MAX_STEPS
    assert count(pace, 0.0) == 0
    assert count(pace, STEP) == 1


def test_slow_steps_leave_time_for_the_window() -> None:
    now = [0.0]
    pace = FixedTimestep(STEP, clock=lambda: now[0])

    def step() -> None:
        now[0] += 0.04

    assert pace.advance(0.05, step) == 1
