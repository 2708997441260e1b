"""`World.accelerations` and `World.force`: forces from NumPy."""

import re
from typing import Any

import numpy as np
import pytest

import jostle


def world(**settings: Any) -> jostle.World:
    positions = [(0, 0), (5, 0), (9, 0)]
    masses, movable = [1, 2, 4], [True, True, False]
    zeros = np.zeros((3, 2))
    return jostle.World(positions, zeros, 0.5, masses=masses, movable=movable, **settings)


@pytest.mark.parametrize("steps", [1, 7, 2000])
def test_they_act_in_all_steps_of_one_call(steps: int) -> None:
    pushed = world()
    assert not pushed.accelerations.any()
    pushed.accelerations = [(0, 3), (0, 0), (1, 1)]
    pushed.force(1, (0, -4))
    pushed.force([1, 0], [(0, 2), (0, 1)])
    assert pushed.accelerations.tolist() == [[0, 4], [0, -1], [0, 0]]
    assert not pushed.accelerations.flags.writeable
    pushed.step(1.0, steps=0)
    assert pushed.accelerations.any()
    pushed.step(1 / steps, steps=steps)
    np.testing.assert_allclose(pushed.velocities, [(0, 4), (0, -1), (0, 0)], rtol=1e-4)
    np.testing.assert_allclose(pushed.positions[:, 1], [2, -0.5, 0], rtol=1e-4)
    assert not pushed.accelerations.any()


def test_none_ends_them() -> None:
    pushed = world()
    pushed.force(0, (1, 1))
    pushed.accelerations = None
    pushed.step(1.0)
    assert not pushed.velocities.any()


def test_a_magnetic_field_turns_velocities() -> None:
    """A charge moves on a circle with constant speed."""
    dt, omega = 1 / 200, 1.5
    charge = jostle.World([(0, 0)], [(3, 0)], 0.1)
    c, s = np.cos(omega * dt), np.sin(omega * dt)
    turn = np.array([[c, s], [-s, c]])
    places = []
    for _ in range(400):
        v = charge.velocities
        charge.accelerations = (v @ turn.T - v) / dt
        charge.step(dt)
        places.append(charge.positions[0])
    assert np.linalg.norm(charge.velocities) == pytest.approx(3, rel=1e-5)
    # Of radius v/ω, below the start.
    np.testing.assert_allclose(np.linalg.norm(places - np.array([0, -2.0]), axis=1), 2, rtol=1e-4)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda w: setattr(w, "accelerations", [(0, 0)]), "accelerations has shape (1, 2)"),
        (
            lambda w: setattr(w, "accelerations", [(0, 0), (0, np.inf), (0, 0)]),
            "accelerations[1] is (0, inf); both coordinates must be finite",
        ),
        (lambda w: w.force(3, (0, 0)), "ids is 3; no particle has this id"),
        (lambda w: w.force([0, 3], [(0, 0)] * 2), "ids[1] is 3; no particle has this id"),
        (lambda w: w.force([0, 1], (1, 1)), "forces has shape (2,)"),
        (lambda w: w.force(0, (np.nan, 1)), "forces"),
    ],
)
def test_wrong_ones_are_refused(change: Any, message: str) -> None:
    pushed = world()
    pushed.force(0, (1, 2))
    before = pushed.snapshot()
    with pytest.raises(ValueError, match=f"^{re.escape(message)}"):
        change(pushed)
    assert pushed.snapshot() == before
