"""The step of `jostle.World` against an event-driven reference and against analytic answers.

Within a step every disc follows its exact path: the answer must not depend on the length of the
step, on the order of the discs, or on how often a disc collides in it. The reference in
`event_driven.py` is tested first, against formulas. Then the library is tested against it, in
cases where float32 rounding does not decide the answer: a case is left out if the reference itself
gives another answer after a small perturbation.

Lengths are in radii, and the mean speed of a gas is 1: a step of `dt` is one of `dt` radii of mean
displacement.

    PYTHONPATH=tests python tests/library/physics/test_exact_step.py

prints the diffusion at several step lengths for larger gases, and the reference's own value, from
which `REFERENCE_DIFFUSION` is taken (half an hour).
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import pytest
from event_driven import Floats, Result, simulate
from gases import Period, displacements, lattice, period_of, random_velocities
from numpy.typing import ArrayLike

import jostle

EPSILON = float(np.finfo(np.float32).eps)


class Discs(NamedTuple):
    """A state that float32 represents exactly."""

    positions: Floats
    velocities: Floats
    radii: Floats
    masses: Floats

    def perturbed(self, size: float, rng: np.random.Generator) -> Discs:
        """Return the state with positions and velocities changed at random."""
        noise = size * rng.normal(size=(2, *self.positions.shape))
        return self._replace(
            positions=self.positions + noise[0], velocities=self.velocities + noise[1]
        )


def discs(
    positions: ArrayLike, velocities: ArrayLike, radii: ArrayLike = 1.0, masses: ArrayLike = 1.0
) -> Discs:
    """Return a state, rounded to float32."""
    shapes = [(-1, 2), (-1, 2), (-1,), (-1,)]
    columns = [
        np.asarray(column, np.float32).astype(float).reshape(shape)
        for column, shape in zip((positions, velocities, radii, masses), shapes, strict=True)
    ]
    n = len(columns[0])
    return Discs(columns[0], columns[1], *(np.broadcast_to(column, n) for column in columns[2:]))


def world(state: Discs, **settings: Any) -> jostle.World:
    settings = {"substeps": 1, **settings}
    return jostle.World(
        state.positions, state.radii, velocities=state.velocities, masses=state.masses, **settings
    )


def separation(a: ArrayLike, b: ArrayLike, period: Period = None) -> Floats:
    """Return the distance of each position from its counterpart, on a torus the minimum image."""
    d = displacements(a, b, period)
    lengths: Floats = np.hypot(d[:, 0], d[:, 1])
    return lengths


def energy(world: jostle.World) -> float:
    return world.kinetic_energy() + world.potential_energy()


def deepest(positions: ArrayLike, radii: Floats, period: Period = None) -> float:
    """Return the largest overlap of two discs; negative if none overlap."""
    positions = np.asarray(positions, float)
    i, j = np.triu_indices(len(positions), 1)
    distances = separation(positions[i], positions[j], period)
    return float((radii[i] + radii[j] - distances).max())


def gas(
    n: int, eta: float, seed: int, period: Period = None, container: Any = None, **settings: Any
) -> Discs:
    """Return discs of radius 1 after some collisions each, computed by the reference.

    In a box or circle, discs whose place on the lattice is outside are left out.
    """
    rng = np.random.default_rng(seed)
    side = math.sqrt(n * math.pi / eta)
    positions = lattice(n, side, side)
    if isinstance(container, jostle.Circle):
        inside = np.hypot(*(positions - container.center).T) < container.radius - 1.01
        positions = positions[inside]
    elif isinstance(container, jostle.Box):
        positions = positions[((positions > 1.01) & (positions < side - 1.01)).all(axis=1)]
    velocities = random_velocities(len(positions), rng)
    # A slightly larger radius leaves gaps that rounding to float32 cannot close.
    path = 2 if eta > 0.5 else 4
    regions = {"period": period, "container": container}
    result = simulate(positions, velocities, 1.001, 1.0, path, **regions, **settings)
    return discs(result.positions, result.velocities, np.ones(len(positions)), 1.0)


def test_reference_two_discs() -> None:
    """Masses 1 and 3, restitution 0.5: the textbook formulas along the line of centres."""
    result = simulate([(0, 0), (6, 1)], [(4, 0), (0, 0)], 1, [1, 3], 2.0, restitution=0.5)
    time = (6 - math.sqrt(3)) / 4
    normal = np.array([math.sqrt(3), 1]) / 2
    impulse = 1.5 * 4 * normal[0] / (1 / 1 + 1 / 3)
    after = np.array([[4, 0] - impulse * normal, impulse / 3 * normal])
    at = np.array([[4 * time, 0], [6, 1]])
    np.testing.assert_allclose(result.velocities, after, rtol=1e-12)
    np.testing.assert_allclose(result.positions, at + after * (2 - time), rtol=1e-12)
    assert result.collisions.tolist() == [1, 1]


def test_reference_ball_on_the_floor() -> None:
    box = jostle.Box(-2, 0, 2, 10)
    result = simulate([(0, 2.25)], [(0, 0)], 1, 1, 1000.0, gravity=(0, -10), container=box)
    np.testing.assert_allclose(result.positions, [(0, 2.25)], atol=1e-6)
    assert result.collisions.tolist() == [1000]


@pytest.mark.parametrize("carried", [(0, 0), (5, 3)])
def test_reference_ball_on_an_immovable_disc(carried: tuple[float, float]) -> None:
    state = [(0, 3.25), (0, 0)], [carried, carried], 1, 1
    result = simulate(*state, 10.0, gravity=(0, -10), movable=[True, False])
    moved = 10 * np.array(carried)
    np.testing.assert_allclose(result.positions, np.add([(0, 3.25), (0, 0)], moved), atol=1e-6)
    np.testing.assert_array_equal(result.velocities[1], carried)


def test_reference_cradle() -> None:
    """Separated balls in a row: the last leaves with the speed of the first."""
    x = np.array([0, 2.5, 5, 7.25, 10])
    row = np.stack([x, np.zeros(5)], 1)
    result = simulate(row, [(3, 0)] + [(0, 0)] * 4, 1, 1, 2.0)
    np.testing.assert_allclose(result.velocities, [(0, 0)] * 4 + [(3, 0)], atol=1e-12)
    np.testing.assert_allclose(result.positions[:, 0], [0.5, 3, 5.25, 8, 8 + 6], rtol=1e-12)


def test_reference_torus() -> None:
    """Two discs that chase each other around the torus: each flies 16 between collisions."""
    period = (20, 20)
    result = simulate([(1, 3), (11, 3)], [(1, 0), (0, 0)], 1, 1, 100.0, period=period)
    assert result.collisions.tolist() == [6, 6]  # after 8, 24, 40, 56, 72 and 88
    np.testing.assert_allclose(result.displacements, [(8 + 2 * 16 + 12, 0), (48, 0)], atol=1e-12)
    np.testing.assert_allclose(result.positions, [(13, 3), (19, 3)], atol=1e-12)


def test_reference_gas_conserves_energy_and_momentum_and_is_reversible() -> None:
    period = period_of(60, 0.6)
    start = gas(60, 0.6, 1, period)
    end = simulate(*start, 1.5, period=period)
    assert end.collisions.mean() > 4
    assert (end.velocities**2).sum() == pytest.approx((start.velocities**2).sum(), rel=1e-12)
    np.testing.assert_allclose(end.velocities.sum(axis=0), start.velocities.sum(axis=0), atol=1e-12)
    assert deepest(end.positions, start.radii, period) < 1e-9
    back = simulate(end.positions, -end.velocities, 1, 1, 1.5, period=period)
    assert separation(back.positions, start.positions, period).max() < 1e-9


def test_reference_round_container_with_gravity_conserves_energy_and_is_reversible() -> None:
    """Two balls and a static disc, about 100 parabolas that end at curved walls."""
    gravity, circle = np.array([0, -10.0]), jostle.Circle((0, 0), 10)
    settings: Any = {"gravity": (0, -10), "container": circle, "movable": [True, True, False]}
    start = discs([(3, 0), (-4, 1), (0, -5)], [(2, 1), (0, 3), (0, 0)], [1, 0.5, 2], [1, 2, 1])
    end = simulate(*start, 40.0, **settings)
    before, after = (
        start.masses @ ((s.velocities**2).sum(axis=1) / 2 - s.positions @ gravity)
        for s in (start, end)
    )
    assert end.collisions.sum() > 100
    assert after == pytest.approx(before, rel=1e-10)
    short = simulate(*start, 4.0, **settings)
    back = simulate(short.positions, -short.velocities, *start[2:], 4.0, **settings)
    assert separation(back.positions, start.positions).max() < 1e-6


def three_discs(path: float, rng: np.random.Generator) -> Discs:
    """Three discs of different sizes and masses that mostly collide within a step of `path`."""
    radii = rng.uniform(0.7, 1.3, 3)
    directions = rng.uniform(0, 2 * math.pi, 2)
    # The second and the third are beside the first or beside each other, with gaps below the path.
    gaps = 0.02 * path + path * rng.uniform(0, 0.5, 2)
    reach = np.array([radii[0] + radii[1], radii[rng.integers(2)] + radii[2]]) + gaps
    offsets = reach[:, None] * np.stack([np.cos(directions), np.sin(directions)], 1)
    middle = rng.integers(2)
    positions = np.array([np.zeros(2), offsets[0], middle * offsets[0] + offsets[1]])
    velocities = rng.normal(size=(3, 2)) * path * 0.8 - (positions - positions.mean(axis=0)) * (
        path / 2
    )
    return discs(positions, velocities, radii, rng.uniform(0.5, 2, 3))


@pytest.mark.parametrize("path", [0.1, 0.5, 1.0, 5.0])
def test_three_discs_with_two_or_more_hits_in_one_step(path: float) -> None:
    """Positions and velocities agree with the reference to 1e-4.

    Left out: overlapping starts, fewer than two hits, and ill-conditioned cases, in which the
    reference moves by more than 1e-5 if its start moves by 1e-7.
    """
    rng = np.random.default_rng(round(10 * path))
    kept, ill_conditioned, wrong = 0, 0, []
    while kept < 120:
        state = three_discs(path, rng)
        if deepest(state.positions, state.radii) > -1e-5:
            continue
        expected = simulate(*state, 1.0)
        if expected.collisions.sum() < 4:
            continue
        if difference(expected, simulate(*state.perturbed(1e-7, rng), 1.0)) > 1e-5:
            ill_conditioned += 1
            continue
        kept += 1
        one = world(state)
        one.step(1.0)
        error = difference(expected, one)
        if error > 1e-4:
            wrong.append((state, error))
    assert not wrong, f"{len(wrong)} of {kept} are wrong; the first: {wrong[0]}"
    assert ill_conditioned < kept / 5


def difference(expected: Result, other: Result | jostle.World) -> float:
    """Return the largest error: of positions in radii, of velocities relative to the fastest."""
    fastest = np.abs(expected.velocities).max()
    velocities = np.abs(other.velocities - expected.velocities).max() / fastest
    return float(max(velocities, separation(other.positions, expected.positions).max()))


SIDE = math.sqrt(120 * math.pi / 0.3)
ARENAS: dict[str, dict[str, Any]] = {
    "box": {"container": jostle.Box(0, 0, SIDE, SIDE)},
    "circle": {"container": jostle.Circle((SIDE / 2, SIDE / 2), SIDE / 2)},
    "falling": {"container": jostle.Box(0, 0, SIDE, SIDE), "gravity": (0.1, 0.3)},
}


def assert_step_agrees(state: Discs, path: float, share: float, **settings: Any) -> None:
    """Assert that one step agrees with the reference to 1e-3.

    Discs are left out whose position or velocity changes by more than 1e-4 if the start is
    perturbed by 1e-6, which is float32 rounding at the coordinates of these gases. `share` is the
    least share kept.
    """
    period = settings.get("period")
    expected = simulate(*state, path, **settings)
    shaken = simulate(*state.perturbed(1e-6, np.random.default_rng(1)), path, **settings)
    kept = separation(expected.positions, shaken.positions, period) < 1e-4
    kept &= separation(expected.velocities, shaken.velocities) < 1e-4
    assert kept.mean() >= share
    one = world(state, **settings)
    one.step(path)
    assert separation(one.positions, expected.positions, period)[kept].max() < 1e-3
    assert separation(one.velocities, expected.velocities)[kept].max() < 1e-3


@pytest.mark.parametrize(
    ("eta", "path", "share"),
    [
        (0.3, 0.1, 1.0),
        (0.3, 1.0, 1.0),
        (0.3, 5.0, 0.4),
        (0.6, 0.1, 1.0),
        (0.6, 1.0, 0.9),
        (0.6, 1.5, 0.8),
    ],
)
def test_one_long_step_of_a_gas_on_a_torus(eta: float, path: float, share: float) -> None:
    period = period_of(120, eta)
    for seed in range(2):
        assert_step_agrees(gas(120, eta, seed, period), path, share, period=period)


@pytest.mark.parametrize(
    ("arena", "path", "share"),
    [
        ("box", 1.0, 0.95),
        ("box", 5.0, 0.4),
        ("circle", 1.0, 0.95),
        ("circle", 5.0, 0.4),
        ("falling", 1.0, 0.95),
        ("falling", 3.0, 0.4),
    ],
)
def test_one_long_step_of_a_gas_between_walls(arena: str, path: float, share: float) -> None:
    settings = ARENAS[arena]
    assert_step_agrees(gas(120, 0.3, 3, **settings), path, share, **settings)


def test_one_long_step_among_static_discs() -> None:
    """A third of the discs stand still; under gravity the others fly along parabolas."""
    settings = ARENAS["falling"]
    state = gas(120, 0.3, 4, **settings)
    movable = np.arange(len(state.positions)) % 3 > 0
    state.velocities[~movable] = 0
    assert_step_agrees(state, 2.0, 0.8, **settings, movable=movable)


@pytest.mark.parametrize("gravity", [(0.0, 0.0), (0.1, 0.3)])
def test_one_long_step_among_kinematic_discs(gravity: tuple[float, float]) -> None:
    """A tenth of the discs keep their velocities. There are no walls that they press others on."""
    state = gas(120, 0.2, 4, **ARENAS["box"])
    movable = np.arange(len(state.positions)) % 10 > 0
    assert_step_agrees(state, 1.0, 0.8, gravity=gravity, movable=movable)


def test_a_step_of_five_radii_in_a_dense_gas() -> None:
    """About 25 collisions each: single paths are chaotic, the mean squared displacement is not."""
    period = period_of(200, 0.6)
    state = gas(200, 0.6, 5, period)
    expected = simulate(*state, 5.0, period=period)
    assert 20 < expected.collisions.mean() < 30
    one = world(state, period=period)
    before = one.kinetic_energy()
    one.step(5.0)
    moved = separation(one.positions, state.positions, period)
    ratio = (moved**2).mean() / (expected.displacements**2).sum(axis=1).mean()
    assert 0.85 < ratio < 1.15
    assert one.kinetic_energy() == pytest.approx(before, rel=1e-5)
    assert deepest(one.positions, state.radii, period) < 1e-4


# Mean squared displacement after a mean path of LAG radii, 400 discs on a square torus, measured by
# this file as a program with the reference; the standard errors are 0.3 % and 0.5 %.
LAG = 5.0
REFERENCE_DIFFUSION = {0.3: 10.935, 0.6: 2.636}


def squared_displacements(n: int, eta: float, lags: int, step: float | None) -> Floats:
    """Return the mean squared displacement over each of `lags` intervals of LAG.

    `step` is the step of the library in radii; None measures the reference. Each interval starts
    with new Maxwellian velocities, so that slow currents do not correlate the intervals.
    """
    rng = np.random.default_rng(n)
    period = period_of(n, eta)
    state = discs(lattice(n, *period), random_velocities(n, rng), np.ones(n))
    one = world(state, period=period)
    one.step(0.05, steps=200)  # melts the lattice
    squares = np.empty(lags)
    for k in range(lags):
        before, velocities = one.positions, random_velocities(n, rng)
        one.velocities = velocities
        if step is None:
            result = simulate(before, velocities, 1.0, 1.0, LAG, period=period)
            squares[k] = (result.displacements**2).sum(axis=1).mean()
            one.positions = result.positions
        else:
            one.step(step, steps=round(LAG / step))
            squares[k] = (separation(one.positions, before, period) ** 2).mean()
    return squares


@pytest.mark.parametrize("eta", [0.3, 0.6])
@pytest.mark.parametrize("step", [0.1, 0.5, 1.0, 5.0])
def test_diffusion_does_not_depend_on_the_step(step: float, eta: float) -> None:
    """Within 5 %, for 400 discs; the standard error of the ratio is 0.7 % and 1.2 %."""
    ratio = squared_displacements(400, eta, 80, step).mean() / REFERENCE_DIFFUSION[eta]
    assert 0.95 < ratio < 1.05


def measure_diffusion() -> None:
    """Print the mean squared displacement of the reference and of the library."""
    print(f"{'eta':>4} {'discs':>6} {'radii a step':>13} {'squared displacement':>24} {'ratio':>7}")
    for n, lags in (400, 300), (1000, 100):
        for eta in 0.3, 0.6:
            base = math.nan
            for step in None, 0.1, 0.5, 1.0, 2.5, 5.0:
                squares = squared_displacements(n, eta, lags if step is None else 4 * lags, step)
                mean, error = squares.mean(), squares.std() / math.sqrt(len(squares))
                base = mean if step is None else base
                name = "reference" if step is None else str(step)
                value = f"{mean:.3f} ± {error:.3f}"
                print(f"{eta:4} {n:6} {name:>13} {value:>24} {mean / base:7.3f}", flush=True)


@pytest.mark.parametrize("gap", [0.0, 0.25, 1.0, 5.0, 9.0])
def test_a_struck_disc_loses_no_displacement(gap: float) -> None:
    """Head on at 10 radii a step: the struck disc is at 12, wherever it stood."""
    one = world(discs([(0, 0), (2 + gap, 0)], [(10, 0), (0, 0)]))
    one.step(1.0)
    np.testing.assert_allclose(one.positions, [(gap, 0), (12, 0)], atol=1e-5)
    np.testing.assert_allclose(one.velocities, [(0, 0), (10, 0)], atol=1e-5)


@pytest.mark.parametrize("count", [3, 10])
def test_a_cradle_of_separated_balls_within_one_step(count: int) -> None:
    """Every ball moves up to the place of its successor; the last flies on."""
    x = 2.25 * np.arange(count)
    row = np.stack([x, np.zeros(count)], 1)
    one = world(discs(row, [(8, 0)] + [(0, 0)] * (count - 1)))
    one.step(1.0)
    expected = x + 0.25
    expected[-1] = x[-1] + 8 - 0.25 * (count - 1)
    np.testing.assert_allclose(one.positions[:, 0], expected, atol=1e-5)
    np.testing.assert_allclose(one.velocities[:, 0], [0] * (count - 1) + [8], atol=1e-5)


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("start", [0.0, -0.5, -3.0])
@pytest.mark.parametrize("dt", [0.25, 4.0])
def test_one_disc_on_two_at_once(dt: float, start: float, axis: int) -> None:
    """One on two that touch: the velocities are (-0.2, 0) and (0.6, ±0.346)."""
    state = discs([(start, 0), (math.sqrt(3), 1), (math.sqrt(3), -1)], [(1, 0), (0, 0), (0, 0)])
    if axis == 1:
        state = state._replace(
            positions=state.positions[:, ::-1], velocities=state.velocities[:, ::-1]
        )
    one = world(state)
    for _ in range(round(4.0 / dt)):
        one.step(dt)
    velocities, positions = one.velocities, one.positions
    if axis == 1:
        velocities, positions = velocities[:, ::-1], positions[:, ::-1]
    after = np.array([(-0.2, 0), (0.6, 0.6 / math.sqrt(3)), (0.6, -0.6 / math.sqrt(3))])
    np.testing.assert_allclose(velocities, after, atol=1e-5)
    at = np.array([(0, 0), (math.sqrt(3), 1), (math.sqrt(3), -1)])
    np.testing.assert_allclose(positions, at + after * (4 + start), atol=1e-5)


def rack(gap: float) -> tuple[Discs, list[tuple[int, int]]]:
    """A cue ball on the axis and 15 discs in a triangle; also the pairs of mirror images."""
    spacing = 2 + gap
    places = [
        (spacing * row * math.sqrt(3) / 2, spacing * (k - row / 2))
        for row in range(5)
        for k in range(row + 1)
    ]
    row_starts = [1, 2, 4, 7, 11]
    mirror = [
        (first + k, first + row - k) for row, first in enumerate(row_starts) for k in range(row + 1)
    ]
    return discs([(-5, 0), *places], [(20, 0)] + [(0, 0)] * 15, np.ones(16)), mirror


@pytest.mark.parametrize("gap", [0.0, 0.01])
@pytest.mark.parametrize("dt", [1 / 60, 0.5])
def test_a_rack_breaks_symmetrically(dt: float, gap: float) -> None:
    """Discs that mirror each other stay mirror images; energy and momentum are conserved."""
    state, mirror = rack(gap)
    one = world(state)
    one.step(dt, steps=round(0.5 / dt))
    flipped = np.array([1, -1])
    for i, j in mirror:
        np.testing.assert_allclose(one.velocities[i], one.velocities[j] * flipped, atol=20e-5)
        np.testing.assert_allclose(one.positions[i], one.positions[j] * flipped, atol=20e-5)
    np.testing.assert_allclose(one.velocities[0, 1], 0, atol=20e-5)
    assert one.velocities[0, 0] < 10  # the rack was struck
    assert one.kinetic_energy() == pytest.approx(200, rel=1e-4)
    np.testing.assert_allclose(one.momentum(), (20, 0), atol=1e-3)


def falling_gas(substeps: int) -> jostle.World:
    """300 discs, g = 500 and speeds of 100 to 300, which is up to 5 radii a step, for 30 s."""
    n, side, rng = 300, 170.0, np.random.default_rng(6)
    state = discs(lattice(n, side, side) - (-1, side + 1), 100 * random_velocities(n, rng), [1] * n)
    box = jostle.Box(0, -side - 2, side + 2, 0)
    return world(state, container=box, gravity=(0, 500), substeps=substeps)


def bouncing_balls(substeps: int) -> jostle.World:
    """40 balls of radius 0.1 bounce about 1,000 times each, at up to 7 radii a step."""
    rng = np.random.default_rng(7)
    x = np.linspace(0.5, 19.5, 40)
    state = discs(np.stack([x, -rng.uniform(0.5, 1, 40)], 1), np.zeros((40, 2)), [0.1] * 40)
    box = jostle.Box(0, -5, 20, 0)
    return world(state, container=box, gravity=(0, 1000), substeps=substeps)


def trapped_energy(one: jostle.World) -> float:
    """Return the energy of discs of mass 1 in the trap of `gas_in_a_trap`."""
    speeds, distances = (np.asarray(v, float) for v in (one.velocities, one.positions))
    return float(0.5 * (speeds**2).sum() + 0.5 * 0.5 * (distances**2).sum())


def gas_in_a_trap(substeps: int) -> jostle.World:
    rng = np.random.default_rng(1)
    state = discs(lattice(300, 54, 54) - 27, 10 * random_velocities(300, rng), np.ones(300))
    trap = jostle.Attractor((0, 0), strength=0.5)
    return world(state, forces=[trap], substeps=substeps)


# Worlds by the number of sub-steps, their energies, steps, and the numbers of sub-steps.
LONG_RUNS = {
    "gas under gravity": (falling_gas, energy, 1800, (1, 4, 16)),
    "bouncing balls": (bouncing_balls, energy, 4400, (1, 4, 16, 64)),
    "harmonic trap": (gas_in_a_trap, trapped_energy, 1800, (1, 4)),
}
RUNS = [(name, substeps) for name, run in LONG_RUNS.items() for substeps in run[-1]]


def energies(name: str, substeps: int) -> Iterator[float]:
    """Yield the energy at ten times of a long run, over that of its beginning."""
    make, energy_of, steps, _ = LONG_RUNS[name]
    one = make(substeps)
    before = energy_of(one)
    for _ in range(10):
        one.step(1 / 60, steps=steps // 10)
        yield energy_of(one) / before


@pytest.mark.parametrize(("name", "substeps"), RUNS)
def test_elastic_discs_keep_their_energy_for_long(name: str, substeps: int) -> None:
    assert [*energies(name, substeps)] == pytest.approx([1] * 10, abs=1e-3)


def height(one: jostle.World) -> float:
    """Return the second coordinate of the first particle."""
    return float(one.positions[0, 1])


BOUNCES: dict[str, tuple[Discs, dict[str, Any]]] = {
    "floor": (discs([(0, 2.25)], [(0, 0)]), {"container": jostle.Box(-5, 0, 5, 20)}),
    "static disc": (
        discs([(0, 3.25), (0, 0)], [(0, 0), (0, 0)], [1, 1]),
        {"movable": [True, False]},
    ),
    "circle": (discs([(0, 2.25)], [(0, 0)]), {"container": jostle.Circle((0, 10), 10)}),
}


@pytest.mark.parametrize("substeps", [1, 4])
@pytest.mark.parametrize("dt", [1 / 60, 0.2, 1.0])
@pytest.mark.parametrize("surface", BOUNCES)
def test_a_ball_returns_to_its_height(surface: str, dt: float, substeps: int) -> None:
    """Dropped from 1.25 with g = 10, it is at the top again after each whole second."""
    state, settings = BOUNCES[surface]
    one = world(state, gravity=(0, -10), substeps=substeps, **settings)
    for _ in range(10):
        one.step(dt, steps=round(10 / dt))
        assert height(one) == pytest.approx(state.positions[0, 1], abs=1.25e-3)
        assert one.positions[0, 0] == 0


def test_balls_in_a_round_container_keep_their_energy() -> None:
    """Off the axis, with a static disc in the way."""
    state = discs([(3, 0), (-4, 1), (0, -5)], [(2, 1), (0, 3), (0, 0)], [1, 0.5, 2], [1, 2, 1])
    circle = jostle.Circle((0, 0), 10)
    one = world(state, gravity=(0, -10), container=circle, movable=[True, True, False])
    before = energy(one) + 3 * 10 * 10  # height above the bottom
    one.step(1 / 30, steps=1200)
    assert energy(one) + 3 * 10 * 10 == pytest.approx(before, rel=1e-3)


@pytest.mark.parametrize("substeps", [1, 4])
def test_with_restitution_one_a_small_bounce_goes_on(substeps: int) -> None:
    """A ball that bounces 1e-3 radii high keeps doing so for 20 s."""
    box = jostle.Box(-5, -1, 5, 20)
    one = world(discs([(0, 1e-3)], [(0, 0)]), gravity=(0, -10), container=box, substeps=substeps)
    one.step(1 / 60, steps=1000)
    heights = []
    for _ in range(200):
        one.step(1 / 60)
        heights.append(height(one) + float(one.velocities[0, 1]) ** 2 / 20)
    assert min(heights) == pytest.approx(1e-3, rel=0.1)
    assert max(heights) == pytest.approx(1e-3, rel=0.1)


def test_five_elastic_balls_in_a_shaft_keep_their_energy() -> None:
    """They are dropped on one another; none comes to rest."""
    box = jostle.Box(-1.5, 0, 1.5, 100)
    start = discs([(0.1 * (k % 2), 1.5 + 2.5 * k) for k in range(5)], [(0, 0)] * 5, [1] * 5)
    one = world(start, gravity=(0, -10), container=box)
    before = energy(one)
    one.step(1 / 60, steps=600)
    assert energy(one) == pytest.approx(before, rel=1e-3)
    assert one.kinetic_energy() > 0.05 * before


STEPS = [(1.0, 1), (1.0, 4), (0.5, 1), (0.1, 4), (1 / 60, 1), (1 / 60, 4), (1 / 240, 1)]


def flown(dt: float, substeps: int, **settings: Any) -> tuple[jostle.World, float]:
    """Return a disc after a flight of 1 s, and the relative rounding error that is allowed."""
    one = world(discs([(0, 0)], [(3, -2)]), substeps=substeps, **settings)
    one.step(dt, steps=round(1 / dt))
    return one, EPSILON * (2 + substeps / dt)


@pytest.mark.parametrize("gravity", [0.0, 10.0])
@pytest.mark.parametrize("drag", [0.0, 1e-3, 0.8, 5.0])
@pytest.mark.parametrize(("dt", "substeps"), STEPS)
def test_a_flight_with_drag_and_gravity(
    dt: float, substeps: int, drag: float, gravity: float
) -> None:
    one, rounding = flown(dt, substeps, drag=drag, gravity=(0, gravity))
    # v = v0 f + g t s and x = v0 t s + g t² (1 - s) / (drag t) for t = 1.
    fade = math.exp(-drag)
    share = -math.expm1(-drag) / drag if drag else 1.0
    rest = (1 - share) / drag if drag else 0.5
    start, pull = np.array([(3, -2)]), np.array([(0, gravity)])
    within: dict[str, float] = {"rtol": rounding}
    if drag:
        within = {"rtol": 4 * rounding, "atol": 4 * rounding} if gravity else {"rtol": 2 * rounding}
    np.testing.assert_allclose(one.velocities, start * fade + pull * share, **within)
    np.testing.assert_allclose(one.positions, start * share + pull * rest, **within)


def test_a_wall_at_a_hundred_radii_a_step() -> None:
    """Between two walls 18 radii apart the position is a triangle wave of the unfolded path."""
    box = jostle.Box(-10, -10, 10, 10)
    one = world(discs([(1, 2)], [(100, 70)]), container=box)
    for k in range(1, 21):
        one.step(1.0)
        unfolded = np.array([1 + 100 * k, 2 + 70 * k], float)
        phase = (unfolded + 9) % 36
        np.testing.assert_allclose(one.positions[0], 9 - np.abs(phase - 18), atol=1e-3)
        np.testing.assert_array_equal(np.abs(one.velocities[0]), [100, 70])


def test_a_static_disc_hit_dead_centre_at_a_hundred_radii_a_step() -> None:
    one = world(discs([(0, 0), (50, 0)], [(100, 0), (0, 0)], [1, 1]), movable=[True, False])
    one.step(1.0)
    np.testing.assert_allclose(one.positions, [(-4, 0), (50, 0)], atol=1e-4)
    np.testing.assert_array_equal(one.velocities, [(-100, 0), (0, 0)])


def test_two_discs_in_a_harmonic_trap_bounce_off_each_other() -> None:
    """Released at ±5 they meet at ±1 after arccos(1/5), and are back after twice that time."""
    trap = jostle.Attractor((0, 0), strength=1)
    two = discs([(-5, 0), (5, 0)], np.zeros((2, 2)), [1, 1])
    meet = math.acos(1 / 5)
    errors = []
    for substeps in (16, 64, 256):
        one = world(two, forces=[trap], substeps=substeps)
        one.step(meet / 3, steps=6 * 5)
        np.testing.assert_allclose(one.positions.sum(axis=0), 0, atol=1e-5)
        errors.append(abs(one.positions[1, 0] - 5))
    assert errors[2] < 0.01
    assert errors[2] < errors[0]


def test_substeps_are_those_that_forces_need() -> None:
    two = discs([(-5, 0), (5, 0)], np.zeros((2, 2)), [1, 1])

    def taken(**settings: Any) -> int:
        one = world(two, substeps=None, **settings)
        one.step(1e-3)
        assert one.substeps is None
        return one.last_step.substeps

    assert taken() == taken(forces=[jostle.Thermostat(1.0, 1.0)]) == taken(restitution=0.5) == 1
    assert taken(gravity=(0, 1)) == 1  # nothing is pressed together
    assert taken(restitution=0.5, gravity=(0, 1)) == 4
    attractor, springs = jostle.Attractor((0, 0), strength=1), jostle.Springs([(0, 1)], 10, 1)
    for force in (attractor, springs, jostle.Gravitation(1.0)):
        assert taken(forces=[force]) == 4
    given = world(two, substeps=2)
    given.step(1e-3)
    assert given.substeps == given.last_step.substeps == 2
    given.substeps = None
    given.step(1e-3)
    assert given.substeps is None and given.last_step.substeps == 1


@pytest.mark.threads
def test_contacts_within_rounding_do_not_depend_on_threads() -> None:
    """In the third step two discs touch a third one at times that differ by less than rounding.

    The number of threads decides which discs are simulated together first.
    """
    n, columns, side = 50_000, 224, math.sqrt(50_000 * math.pi / 0.4)
    rng = np.random.default_rng(0)
    grid = np.stack(np.meshgrid(np.arange(columns), np.arange(columns)), -1).reshape(-1, 2)[:n]
    positions = (grid + 0.5) * side / columns
    radii, velocities = rng.uniform(0.5, 1.2, n), 2.0 * rng.normal(size=(n, 2))
    hashes = []
    for threads in (1, 2):
        box = jostle.Box(0, 0, side, side)
        one = jostle.World(positions, radii, velocities=velocities, threads=threads, container=box)
        one.step(1.0, steps=3)
        hashes.append(one.state_hash())
    assert hashes[0] == hashes[1]


def test_a_step_with_too_many_collisions_is_refused_soon() -> None:
    """Half a million collisions of one disc: the world stays as it was."""
    state = discs([(-3, 0), (3, 0)], [(1e7, 0), (0, 1)], [1, 1])
    one = world(state, container=jostle.Box(-10, -10, 10, 10))
    before = one.state_hash()
    with pytest.raises(ValueError, match="particle 0 has more than 100000 collisions in one step"):
        one.step(1.0)
    assert one.state_hash() == before
    one.velocities = [(1.7e6, 0), (0, 1)]
    one.step(1.0)
    assert one.last_step.unresolved == 0
    assert one.kinetic_energy() == pytest.approx(0.5 * (1.7e6**2 + 1), rel=1e-5)


def test_a_disc_that_stands_still_has_no_velocity_where_collisions_lose_energy() -> None:
    """Velocity and motion agree."""
    state = discs([(0, 1 + 1e-9)], [(0, 1e7)], [1])
    one = world(state, container=jostle.Box(-1, 0, 1, 2 + 1e-6), restitution=0.999999)
    one.step(1.0)
    assert one.last_step.unresolved == 1
    assert one.last_step.collapsed == 1
    np.testing.assert_allclose(one.velocities, [[0, 0]], atol=1e-9)  # it began with 1e7


@pytest.mark.parametrize("gaps", [(1.0, 1.0), (1.0, 1.7)])
def test_three_discs_collapse(gaps: tuple[float, float]) -> None:
    """Restitution 0.05 is below 0.072, so three discs in a row collide without end."""
    row = [(0, 0), (2 + gaps[0], 0), (4 + sum(gaps), 0)]
    one = world(discs(row, [(2, 0), (0, 0), (-1, 0)], [1] * 3), restitution=0.05)
    last = one.kinetic_energy()
    for _ in range(20 * 60):
        one.step(1 / 60)
        assert one.kinetic_energy() <= last * (1 + 1e-6)
        last = one.kinetic_energy()
    np.testing.assert_allclose(one.momentum(), (1, 0), atol=1e-5)
    assert last < 1.05 * 1 / 6  # the energy of the centre of mass
    assert (np.diff(one.positions[:, 0]) > 2 - 1e-3).all()


def test_a_shaken_granular_cluster() -> None:
    """60 discs of restitution 0.1 fly towards their centre, three times."""
    rng = np.random.default_rng(8)
    positions = lattice(60, 18.6, 18.6) - 9.3
    one = world(discs(positions, np.zeros((60, 2)), np.ones(60)), restitution=0.1)
    for _ in range(3):
        inwards = -one.positions * 0.3
        velocities = inwards - inwards.mean(axis=0) + 2 * random_velocities(60, rng)
        one.velocities = velocities
        last, momentum = one.kinetic_energy(), one.momentum()
        for _ in range(5 * 60):
            one.step(1 / 60)
            assert one.kinetic_energy() <= last * (1 + 1e-6)
            last = one.kinetic_energy()
        np.testing.assert_allclose(one.momentum(), momentum, atol=1e-3)
    assert deepest(one.positions, np.ones(60)) < 0.01


def measure_energies() -> None:
    """Print the energies after the longest simulations, over those of the beginning."""
    for name, substeps in RUNS:
        *_, last = energies(name, substeps)
        print(f"{name}, {substeps} sub-steps: 1 {last - 1:+.1e}")


def measure_long_steps() -> None:
    """Print the time in which 1,000 discs move by a thousand radii."""
    n, eta = 1000, 0.3
    period = period_of(n, eta)
    velocities = random_velocities(n, np.random.default_rng(0))
    state = discs(lattice(n, *period), velocities, np.ones(n))
    for region in {"container": jostle.Box(0, 0, *period)}, {"period": period}:
        for radii, steps in (1.0, 1000), (10.0, 100), (100.0, 10), (1000.0, 1):
            one = world(state, **region, threads=1)
            one.step(1.0, steps=20)
            begun = time.perf_counter()
            one.step(radii, steps=steps)
            seconds = time.perf_counter() - begun
            print(f"{list(region)}, {steps} steps of {radii:g} radii: {seconds:.2f} s")


if __name__ == "__main__":
    measure_energies()
    measure_long_steps()
    measure_diffusion()
