"""`Attractor`, `Gravitation`, `Springs`, `Thermostat`, `accelerations` and `apply_force`."""

import math
import re
from typing import Any

import numpy as np
import pytest
from copies import WAYS

import jostle

FOLLOWER = jostle.Attractor(particle=1, strength=3, law="inverse_square")
SPRINGS = jostle.Springs([(0, 1), (1, 2)], [1, 2.5], stiffness=40, damping=0.1, max_stretch=3)
BY_TEXT = {
    "Attractor((1.0, 0.1), 4.0, 'harmonic')": jostle.Attractor((1, 0.1), 4),
    "Attractor(None, 3.0, 'inverse_square', particle=1)": FOLLOWER,
    "Gravitation(0.1, 0.2, 0.7)": jostle.Gravitation(0.1, softening=0.2, theta=0.7),
    "<jostle.Springs between 2 pairs>": SPRINGS,
    "Thermostat(3.0, 0.2)": jostle.Thermostat(3, 0.2),
}
ALL = list(BY_TEXT.values())


def make(n: int = 3, **options: Any) -> jostle.World:
    positions = 10.0 * np.arange(2 * n).reshape(n, 2)
    return jostle.World(positions, 0.5, masses=1.0, **options)


def test_attributes_are_the_arguments() -> None:
    point = jostle.Attractor((1, 0.1), 4)
    assert (point.point, point.strength, point.law) == ((1, 0.1), 4, "harmonic")
    assert point.particle is None
    assert (FOLLOWER.point, FOLLOWER.particle, FOLLOWER.law) == (None, 1, "inverse_square")
    gravitation = jostle.Gravitation(G=0.1)
    assert (gravitation.G, gravitation.softening, gravitation.theta) == (0.1, 0, 0.5)
    warm = jostle.Thermostat(speed=3, rate=0.2)
    assert (warm.speed, warm.rate) == (3, 0.2)


def test_springs_are_columns() -> None:
    assert len(SPRINGS) == 2
    np.testing.assert_array_equal(SPRINGS.pairs, [(0, 1), (1, 2)])
    assert SPRINGS.pairs.dtype == np.int64
    np.testing.assert_array_equal(SPRINGS.lengths, np.float32([1, 2.5]))
    np.testing.assert_array_equal(SPRINGS.stiffness, np.float32([40, 40]))
    np.testing.assert_array_equal(SPRINGS.damping, np.float32([0.1, 0.1]))
    np.testing.assert_array_equal(SPRINGS.max_stretch, np.float32([3, 3]))
    assert np.isinf(jostle.Springs([(0, 1)], 1, 1).max_stretch).all()
    assert len(jostle.Springs([], 1, 1)) == 0


@pytest.mark.parametrize("text", BY_TEXT)
def test_equal_by_value_copied_and_pickled(text: str) -> None:
    force: Any = BY_TEXT[text]
    assert repr(force) == text
    for same in (way(force) for way in WAYS):
        assert same == force
        if not isinstance(force, jostle.Springs):
            assert hash(same) == hash(force)
            assert eval(text, vars(jostle)) == force
    assert all(other != force for other in ALL if other is not force)
    with pytest.raises(AttributeError):
        force.strength = 1.0


@pytest.mark.parametrize(
    ("call", "error", "said"),
    [
        (lambda: jostle.Attractor(), TypeError, "either a point or a particle"),
        (lambda: jostle.Attractor((0, 0), 1, particle=0), TypeError, "either a point or"),
        (lambda: jostle.Attractor((0, 0)), TypeError, "needs a strength"),
        (lambda: jostle.Attractor((0, 0), "much"), TypeError, "strength must be a number"),
        (lambda: jostle.Attractor((0, math.inf), 1), ValueError, "point is (0, inf)"),
        (lambda: jostle.Attractor((0, 0), math.nan), ValueError, "strength is NaN"),
        (lambda: jostle.Attractor((0, 0), 1, "linear"), ValueError, "law is 'linear'"),
        (lambda: jostle.Attractor(particle=-1, strength=1), ValueError, "particle is -1"),
        (lambda: jostle.Gravitation(math.inf), ValueError, "G is inf"),
        (lambda: jostle.Gravitation(1, -1), ValueError, "softening is -1"),
        (lambda: jostle.Gravitation(1, theta=2), ValueError, "theta is 2"),
        (lambda: jostle.Springs([(0, 1, 2)], 1, 1), ValueError, "pairs has shape (1, 3)"),
        (lambda: jostle.Springs([(0.5, 1)], 1, 1), TypeError, "pairs must hold integers"),
        (lambda: jostle.Springs([(0, 1), (2, 2)], 1, 1), ValueError, "pairs[1] is (2, 2)"),
        (lambda: jostle.Springs([(0, 1)], [1, 2], 1), ValueError, "lengths has shape (2,)"),
        (lambda: jostle.Springs([(0, 1)] * 2, [1, -2], 1), ValueError, "lengths[1] is -2"),
        (lambda: jostle.Springs([(0, 1)], 1, math.nan), ValueError, "stiffness[0] is NaN"),
        (lambda: jostle.Springs([(0, 1)], 1, 1, max_stretch=-1), ValueError, "max_stretch[0]"),
        (lambda: jostle.Thermostat(-1, 0.5), ValueError, "speed is -1"),
        (lambda: jostle.Thermostat(1, 1.5), ValueError, "rate is 1.5"),
        (lambda: make(forces=3), TypeError, "forces must be a sequence of forces, not int"),
        (lambda: make(forces=[ALL[0], 3]), TypeError, "forces[1] must be a jostle.Attractor"),
        (lambda: make(1, forces=[FOLLOWER]), ValueError, "forces[0] is a force on particle 1"),
        (lambda: make(forces=ALL[-1:] * 2), ValueError, "forces[1] is another Thermostat"),
    ],
)
def test_refuses_by_name(call: Any, error: type[Exception], said: str) -> None:
    with pytest.raises(error, match=re.escape(said)):
        call()


def test_a_world_has_forces() -> None:
    assert make().forces == ()
    world = make(forces=ALL)
    assert world.forces == tuple(ALL)
    world.forces = iter(ALL[:2])
    assert world.forces == tuple(ALL[:2])
    with pytest.raises(ValueError, match=r"forces\[0\]"):
        world.forces = [jostle.Attractor(particle=9, strength=1)]
    assert world.forces == tuple(ALL[:2])
    world.forces = ()
    before = world.positions
    world.step(0.1, 10)
    np.testing.assert_array_equal(world.positions, before)


def pushed_world(**settings: Any) -> jostle.World:
    positions = [(0, 0), (5, 0), (9, 0)]
    masses, movable = [1, 2, 4], [True, True, False]
    return jostle.World(positions, 0.5, masses=masses, movable=movable, **settings)


@pytest.mark.parametrize("steps", [1, 7, 2000])
def test_accelerations_act_in_all_steps_of_one_call(steps: int) -> None:
    pushed = pushed_world()
    assert not pushed.accelerations.any()
    pushed.accelerations = [(0, 3), (0, 0), (1, 1)]
    pushed.apply_force(1, (0, -4))
    pushed.apply_force([1, 0], [(0, 2), (0, 1)])
    assert pushed.accelerations.tolist() == [[0, 4], [0, -1], [0, 0]]
    assert not pushed.accelerations.flags.writeable
    pushed.step(1.0, steps=0)
    assert pushed.accelerations.any()
    pushed.step(1 / steps, steps=steps)
    np.testing.assert_allclose(pushed.velocities, [(0, 4), (0, -1), (0, 0)], rtol=1e-4)
    np.testing.assert_allclose(pushed.positions[:, 1], [2, -0.5, 0], rtol=1e-4)
    assert not pushed.accelerations.any()


def test_none_ends_accelerations() -> None:
    pushed = pushed_world()
    pushed.apply_force(0, (1, 1))
    pushed.accelerations = None
    pushed.step(1.0)
    assert not pushed.velocities.any()


def test_a_magnetic_field_turns_velocities() -> None:
    """A charge moves on a circle with constant speed."""
    dt, omega = 1 / 200, 1.5
    charge = jostle.World([(0, 0)], 0.1, velocities=[(3, 0)])
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
        (lambda w: w.apply_force(3, (0, 0)), "ids is 3; no particle has this id"),
        (lambda w: w.apply_force([0, 3], [(0, 0)] * 2), "ids[1] is 3; no particle has this id"),
        (lambda w: w.apply_force([0, 1], [(1, 1)] * 3), "forces has shape (3, 2)"),
        (lambda w: w.apply_force(0, (np.nan, 1)), "forces"),
    ],
)
def test_wrong_accelerations_are_refused(change: Any, message: str) -> None:
    pushed = pushed_world()
    pushed.apply_force(0, (1, 2))
    before = pushed.snapshot()
    with pytest.raises(ValueError, match=f"^{re.escape(message)}"):
        change(pushed)
    assert pushed.snapshot() == before
