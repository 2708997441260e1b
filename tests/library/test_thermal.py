"""`ThermalWalls` and `AndersenThermostat`, against the Maxwell distribution."""

import math
import re
from typing import Any

import numpy as np
import pytest
from copies import WAYS
from gases import lattice
from numpy.typing import NDArray
from scipy.special import ndtr

import jostle

KT = 1.0
N = 500
MIN_X, MAX_X, MIN_Y, MAX_Y = list(jostle.Side)[:4]
SIDE = math.sqrt(N * math.pi / 0.2)  # a fifth of the area is covered


def gas(forces: Any, threads: int | None = None, order: Any = slice(None)) -> jostle.World:
    """Elastic discs of radius 1 and mass 1 in a box, a quarter as warm."""
    velocities = np.random.default_rng(1).normal(size=(N, 2)) * 0.5
    return jostle.World(
        lattice(N, SIDE, SIDE)[order],
        1.0,
        velocities=velocities[order],
        masses=1.0,
        container=jostle.Box(0, 0, SIDE, SIDE),
        forces=forces,
        threads=threads,
    )


def distance_from_normal(values: NDArray[np.float32]) -> float:
    """The Kolmogorov-Smirnov distance of n values from the normal distribution, times √n."""
    n, distribution = len(values), ndtr(np.sort(values.astype(float)))
    steps = np.arange(n + 1) / n
    below, above = distribution - steps[:-1], steps[1:] - distribution
    return float(max(below.max(), above.max()) * math.sqrt(n))


@pytest.mark.usefixtures("usual_threads")
@pytest.mark.parametrize(
    ("force", "steps"),
    [(jostle.ThermalWalls(KT, seed=4), 750), (jostle.AndersenThermostat(KT, 1.0, seed=4), 30)],
)
def test_colliding_discs_reach_the_temperature(force: Any, steps: int) -> None:
    """Five samples; with the walls the deviation from kT falls e-fold in about 125 seconds."""
    world = gas([force])
    world.step(1.0, steps=steps)
    energies = []
    for _ in range(5):
        world.step(1.0, steps=steps // 10)
        velocities = world.velocities
        energies.append(world.kinetic_energy() / N)
        for axis in (0, 1):
            # A normal sample is farther away with a probability of 1e-4.
            assert distance_from_normal(velocities[:, axis]) < 2.23
    # The standard deviation of the energy of one sample is kT/√N.
    assert np.mean(energies) == pytest.approx(KT, abs=4 * KT / math.sqrt(N))
    assert world.last_step.unresolved == 0


@pytest.mark.usefixtures("usual_threads")
def test_heat_flows_from_a_hot_side_to_a_cold_one() -> None:
    world = gas([jostle.ThermalWalls(4.0, sides=[MIN_X]), jostle.ThermalWalls(1.0, sides=[MAX_X])])
    world.step(1.0, steps=750)
    warm = []
    for _ in range(10):
        world.step(1.0, steps=20)
        x, energies = world.positions[:, 0], (world.velocities**2).sum(axis=1) / 2
        warm.append(
            [energies[(x >= a) & (x < a + SIDE / 4)].mean() for a in np.arange(4) * SIDE / 4]
        )
    means = np.mean(warm, axis=0)
    assert 4 > means[0] > means[1] > means[2] > means[3] > 1


def test_they_are_values() -> None:
    walls = jostle.ThermalWalls(2.5, sides=[MAX_Y, MIN_X], seed=7)
    bath = jostle.AndersenThermostat(2.5, rate=0.5)
    assert repr(walls) == "ThermalWalls(2.5, sides=(Side.MIN_X, Side.MAX_Y), seed=7)"
    assert repr(bath) == "AndersenThermostat(2.5, 0.5, 0)"
    assert eval(repr(walls), vars(jostle)) == walls
    assert (
        repr(jostle.ThermalWalls(1, sides=MIN_X))
        == "ThermalWalls(1.0, sides=(Side.MIN_X,), seed=0)"
    )
    assert (walls.temperature, walls.sides, walls.seed) == (2.5, (MIN_X, MAX_Y), 7)
    assert (bath.temperature, bath.rate, bath.seed) == (2.5, 0.5, 0)
    assert jostle.ThermalWalls(1).sides == tuple(jostle.Side) and walls.walls == ()
    assert jostle.ThermalWalls(1) == jostle.ThermalWalls(1, sides=list(jostle.Side))
    plates = jostle.ThermalWalls(2.5, walls=[2, 0])
    assert repr(plates) == "ThermalWalls(2.5, walls=(2, 0), seed=0)"
    assert (plates.sides, plates.walls) == ((), (2, 0)) and plates != jostle.ThermalWalls(2.5)
    both = jostle.ThermalWalls(2.5, sides=list(jostle.Side), walls=[0])
    assert jostle.ThermalWalls(2.5, sides=MIN_X) == jostle.ThermalWalls(2.5, sides=[MIN_X])
    for force in (walls, bath, plates, both, jostle.ThermalWalls(1)):
        for same in (way(force) for way in WAYS):
            assert same == force and hash(same) == hash(force)
    assert walls != jostle.ThermalWalls(2.5, sides=[MAX_Y], seed=7)
    world = gas([walls, bath])
    assert world.forces == (walls, bath)
    assert jostle.World.restore(world.snapshot()).forces == (walls, bath)


@pytest.mark.parametrize(
    ("container", "sides", "rule"),
    [
        (
            None,
            None,
            f"{', '.join(jostle.Side.__members__)}; a world without a container has no sides",
        ),
        (jostle.Circle((0, 0), 50), [MIN_X, MAX_X], "MIN_X, MAX_X; a Circle has one side, RIM"),
        (jostle.Circle((0, 0), 50), [MAX_Y], "MAX_Y; a Circle has one side, RIM"),
    ],
)
def test_sides_that_a_container_does_not_have_are_refused(
    container: Any, sides: Any, rule: str
) -> None:
    """At the construction, when forces are set, and when the container changes."""
    message = f"^{re.escape('forces[1] is ThermalWalls of ' + rule)}$"
    forces = [jostle.Thermostat(1.0, 0.5), jostle.ThermalWalls(1.0, sides=sides)]
    disc = {"positions": [(20, 20)], "velocities": [(0, 0)], "radii": 1.0}
    with pytest.raises(ValueError, match=message):
        jostle.World(**disc, container=container, forces=forces)
    world = jostle.World(**disc, container=container)
    with pytest.raises(ValueError, match=message):
        world.forces = forces
    assert world.forces == ()
    box = jostle.Box(-50, -50, 50, 50)
    world = jostle.World(**disc, container=box, forces=forces)
    with pytest.raises(ValueError, match=message):
        world.container = container
    assert world.container == box and world.forces == tuple(forces)
    world.forces = ()
    world.container = container


def test_all_sides_are_the_wall_of_a_circle_and_walls_need_no_container() -> None:
    disc = {"positions": [(20, 20)], "velocities": [(0, 0)], "radii": 1.0}
    round_wall = [jostle.ThermalWalls(1.0)]
    world = jostle.World(**disc, container=jostle.Box(0, 0, 50, 50), forces=round_wall)
    world.container = jostle.Circle((20, 20), 50)
    world.forces = [jostle.ThermalWalls(1.0, sides=[jostle.Side.RIM])]
    with pytest.raises(ValueError, match="of RIM; a Box has no RIM"):
        world.container = jostle.Box(0, 0, 50, 50)
    plate = [jostle.ThermalWalls(1.0, walls=[0])]
    for period in (None, 50):
        walls = [((0, 0), (5, 0))]
        assert jostle.World(**disc, period=period, walls=walls, forces=plate).forces
    with pytest.raises(ValueError, match="of MIN_Y; a periodic world has no sides"):
        jostle.World(**disc, period=50, forces=[jostle.ThermalWalls(1.0, sides=[MIN_Y])])


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: jostle.ThermalWalls(0), ValueError, "temperature is 0; it must be above 0"),
        (lambda: jostle.ThermalWalls(-1), ValueError, "temperature is -1; it must be finite and"),
        (lambda: jostle.ThermalWalls(1, sides=[]), ValueError, "sides is (); at least one side"),
        (lambda: jostle.ThermalWalls(1, sides=[MIN_X, 4]), ValueError, "sides[1] is 4; a side of"),
        (lambda: jostle.ThermalWalls(1, sides=-1), ValueError, "sides is -1; a side of a"),
        (lambda: jostle.ThermalWalls(1, walls=[]), ValueError, "sides is (); at least one side or"),
        (lambda: jostle.ThermalWalls(1, walls=[3, 3]), ValueError, "walls[1] is 3; it is given"),
        (lambda: jostle.ThermalWalls(1, walls=[-1]), ValueError, "walls[0] is -1; no wall has"),
        (lambda: jostle.ThermalWalls(1, walls=0.5), TypeError, "walls must hold integers"),
        (lambda: gas([jostle.ThermalWalls(1, walls=[0])]), ValueError, "forces[0] is ThermalWalls"),
        (
            lambda: jostle.ThermalWalls(1, sides=[MIN_Y, MIN_Y]),
            ValueError,
            "sides[1] is MIN_Y; it is",
        ),
        (lambda: jostle.ThermalWalls(1, seed=2**32), ValueError, "seed is 4294967296; it must"),
        (lambda: jostle.ThermalWalls("hot"), TypeError, "temperature must be a number"),  # type: ignore[arg-type]
        (lambda: jostle.AndersenThermostat(1, -1), ValueError, "rate is -1; it must be finite"),
        (lambda: gas([jostle.ThermalWalls(1)] * 2), ValueError, "forces[1] is another Thermal"),
        (lambda: gas([jostle.AndersenThermostat(1, 1)] * 2), ValueError, "forces[1] is another An"),
    ],
)
def test_wrong_ones_are_refused(make: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=f"^{re.escape(message)}"):
        make()
