"""The radial distribution function of fluids, beside published results.

A Lennard-Jones fluid in two dimensions, truncated at 2.5 sigma, at the density 0.6 and kT = 1, is
that of the examples DIFFUSE and VISCOSITY of LAMMPS, whose results are in its repository
(https://github.com/lammps/lammps, log files of 13 Oct 2016 and 22 Aug 2026). Three integrals of
g(r) are in these files: the number of neighbours within 2.8 sigma, the potential energy, in which
the well has most weight, and the pressure, in which the steep inner side has most. A dilute fluid
has the g(r) of the expansion in the density, and hard discs have Henderson's value at contact.
"""

import math
from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import cKDTree

import jostle

Floats = NDArray[np.float64]

CUTOFF, REACH = 2.5, 2.8
BINS = np.linspace(0, REACH, 1401)
MIDDLES = (BINS[1:] + BINS[:-1]) / 2

# Mean and standard error over the rows of LAMMPS's log files: energy of a particle and pressure at
# the end of every 1,000 or 2,000 steps, neighbours of a particle within 2.8 in four states.
ENERGY, PRESSURE, NEIGHBORS = (-1.584, 0.004), (1.020, 0.013), (14.00, 0.012)


def potential(r: Floats) -> Floats:
    """Return the truncated potential of Lennard and Jones."""
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        return np.where(r < CUTOFF, 4 * (r**-12.0 - r**-6.0), 0.0)


def force(r: Floats) -> Floats:
    """Return minus the derivative of the potential."""
    return np.where(r < CUTOFF, 24 * (2 * r**-13.0 - r**-7.0), 0.0)


def sites(count: int, side: float) -> Floats:
    """Return places on a square lattice, as far from each other at the sides of the torus."""
    across = math.isqrt(count)
    grid = np.stack(np.meshgrid(range(across), range(across)), 2).reshape(-1, 2)
    return (grid + 0.5) * side / across


def frames(
    count: int, density: float, number: int, *, settle: int, every: int, seed: int
) -> Iterator[Floats]:
    """Yield positions of a fluid at kT = 1 in a heat bath, at times far apart."""
    side = math.sqrt(count / density)
    pair = jostle.PairForce.lennard_jones(1.0, 1.0, CUTOFF)
    world = jostle.World(
        sites(count, side),
        0.1,
        velocities=np.random.default_rng(seed).normal(0, 1, (count, 2)),
        masses=1.0,
        period=(side, side),
        on_touch="ignore",
        forces=[pair, jostle.AndersenThermostat(1.0, rate=0.5, seed=seed)],
    )
    world.step(0.005, steps=settle)
    for _ in range(number):
        world.step(0.005, steps=every)
        yield world.positions.astype(float)


def near_pairs(positions: Floats, side: float, reach: float) -> tuple[NDArray[np.intp], Floats]:
    """Return the pairs up to `reach` apart, by SciPy, and the ways from the second to the first."""
    places = positions % side
    places[places >= side] = 0
    pairs = cKDTree(places, boxsize=side).query_pairs(reach, output_type="ndarray")
    offset = places[pairs[:, 0]] - places[pairs[:, 1]]
    return pairs, offset - side * np.round(offset / side)


def distances(positions: Floats, side: float, reach: float) -> Floats:
    """Return the distances of all pairs up to `reach`."""
    return np.hypot(*near_pairs(positions, side, reach)[1].T)


def radial_distribution(
    all_distances: list[Floats], count: int, side: float, bins: Floats = BINS
) -> Floats:
    """Return g(r) of each frame, shape (frames, bins)."""
    rings = np.pi * (bins[1:] ** 2 - bins[:-1] ** 2)
    ideal = count * (count - 1) / 2 / side**2 * rings
    return np.array([np.histogram(found, bins)[0] for found in all_distances]) / ideal


def mean_and_error(values: Floats) -> tuple[float, float]:
    """Return the mean and its standard error, from the means of ten blocks."""
    blocks = values[: len(values) // 10 * 10].reshape(10, -1).mean(axis=1)
    return float(blocks.mean()), float(blocks.std(ddof=1) / math.sqrt(10))


@pytest.mark.slow
def test_g_of_a_lennard_jones_fluid_is_that_of_lammps() -> None:
    count, density = 784, 0.6
    side = math.sqrt(count / density)
    places = frames(count, density, 200, settle=1500, every=40, seed=1)
    g = radial_distribution([distances(p, side, REACH) for p in places], count, side)
    rings = np.pi * (BINS[1:] ** 2 - BINS[:-1] ** 2) * density * (count - 1) / count
    neighbors = g @ rings
    energy = g @ (rings * potential(MIDDLES)) / 2
    pressure = density + density / 4 * (g @ (rings * MIDDLES * force(MIDDLES)))
    for values, (published, error) in (
        (neighbors, NEIGHBORS),
        (energy, ENERGY),
        (pressure, PRESSURE),
    ):
        mean, own = mean_and_error(values)
        assert abs(mean - published) < 4 * math.hypot(own, error), (mean, own, published)
        assert own < 2 * error  # the comparison is as sharp as the published figure
    peak = g.mean(axis=0)[:750].reshape(-1, 10).mean(axis=1)
    assert 1.08 < MIDDLES[:750].reshape(-1, 10).mean(axis=1)[peak.argmax()] < 1.16


def forces_on(positions: Floats, side: float) -> Floats:
    """Return the forces of the truncated potential."""
    pairs, offset = near_pairs(positions, side, CUTOFF)
    r = np.hypot(*offset.T)
    found = np.zeros_like(positions)
    np.add.at(found, pairs[:, 0], offset * (force(r) / r)[:, None])
    np.subtract.at(found, pairs[:, 1], offset * (force(r) / r)[:, None])
    return found


@pytest.mark.slow
def test_a_fluid_has_the_structure_of_an_independent_simulation() -> None:
    """g(r) at the density 0.6 and a temperature near 1, beside velocity Verlet in NumPy."""
    n, dt = 144, 0.005
    side = math.sqrt(n / 0.6)
    velocities = np.random.default_rng(4).normal(0, 1.2, (n, 2))
    velocities -= velocities.mean(axis=0)
    positions = sites(n, side)
    world = jostle.World(
        positions,
        0.1,
        velocities=velocities,
        masses=1.0,
        period=(side, side),
        on_touch="ignore",
        forces=[jostle.PairForce.lennard_jones(1.0, 1.0, CUTOFF)],
    )
    pull = forces_on(positions, side)
    ours, theirs, heat = [], [], np.zeros(2)
    for frame in range(500):
        world.step(dt, steps=20)
        for _ in range(20):
            velocities += dt / 2 * pull
            positions += dt * velocities
            pull = forces_on(positions, side)
            velocities += dt / 2 * pull
        if frame >= 100:
            ours.append(distances(world.positions.astype(float), side, 3.0))
            theirs.append(distances(positions, side, 3.0))
            heat += world.kinetic_energy() / n, 0.5 * (velocities**2).sum() / n
    bins = np.linspace(0.8, 3.0, 34)
    g, expected = (
        radial_distribution(found, n, side, bins).mean(axis=0) for found in (ours, theirs)
    )
    assert abs(heat[0] / heat[1] - 1) < 0.02
    assert 1.0 < bins[g.argmax()] < 1.2 and g.max() > 1.8
    assert np.abs(g - expected).max() < 0.08


@pytest.mark.full
def test_g_of_a_dilute_fluid_is_its_expansion_in_the_density() -> None:
    """g = exp(-u) (1 + n h), h the integral over a third particle of both Mayer functions.

    J. E. Mayer and E. Montroll, Journal of Chemical Physics 9, 2 (1941). At this density the second
    term is at most 3 %, less than the tolerance: the test is one of the first.
    """
    count, density = 900, 0.03
    side = math.sqrt(count / density)
    places = frames(count, density, 150, settle=4000, every=80, seed=2)
    g = radial_distribution([distances(p, side, REACH) for p in places], count, side)
    step = 0.04
    grid = (np.arange(-170, 170) + 0.5) * step
    x, y = np.meshgrid(grid, grid)

    def mayer(r: Floats) -> Floats:
        # Motion with a force that ends at the cutoff is that of a potential which is 0 there.
        edge = 4 * (CUTOFF**-12 - CUTOFF**-6)
        return np.exp(-np.where(r < CUTOFF, potential(r) - edge, 0.0)) - 1

    near = mayer(np.hypot(x, y))
    for r in np.arange(1.0, 2.4, 0.1):
        bins = np.abs(MIDDLES - r) < 0.03
        third = step**2 * float((near * mayer(np.hypot(x - r, y))).sum())
        theory = float(1 + mayer(MIDDLES[bins]).mean()) * (1 + density * third)
        mean, error = mean_and_error(g[:, bins].mean(axis=1))
        # Ten blocks: their standard error is itself uncertain by a quarter.
        assert abs(mean - theory) < 5 * error + 0.005, (r, mean, error, theory)


@pytest.mark.parametrize("eta", [0.2, 0.4])
def test_hard_discs_have_hendersons_value_at_contact(eta: float) -> None:
    """g(2 r) = (1 - 7 eta / 16) / (1 - eta)²: D. Henderson, Molecular Physics 30, 971 (1975)."""
    count, radius = 1600, 1.0
    side = math.sqrt(count * math.pi / eta)
    rng = np.random.default_rng(3)
    world = jostle.World(
        sites(count, side),
        radius,
        velocities=rng.normal(0, 1, (count, 2)),
        period=(side, side),
        restitution=1.0,
    )
    world.step(0.5, steps=100)
    found = []
    for _ in range(200):
        world.step(0.5, steps=4)
        found.append(distances(world.positions.astype(float), side, 2.4))
    edges = np.linspace(2.0, 2.4, 9)
    g = radial_distribution(found, count, side, edges)
    # A parabola through the logarithms, extrapolated to contact.
    middles = (edges[1:] + edges[:-1]) / 2 - 2
    blocks = np.log(g.reshape(10, -1, 8).mean(axis=1))
    contact = np.exp([np.polynomial.polynomial.polyfit(middles, block, 2)[0] for block in blocks])
    mean, error = float(contact.mean()), float(contact.std(ddof=1) / math.sqrt(10))
    theory = (1 - 7 * eta / 16) / (1 - eta) ** 2
    assert error < 0.02 * theory
    assert abs(mean - theory) < 4 * error + 0.005 * theory, (mean, error, theory)
