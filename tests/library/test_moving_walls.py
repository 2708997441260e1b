"""Walls with velocities, and a piston that compresses a gas."""

import pickle

import numpy as np
import pytest
from gases import henderson
from numpy.typing import ArrayLike

import jostle

WALLS = jostle.polyline([(0, 0), (4, 0), (4, 3)])


def test_velocities_are_given_for_all_or_one_each() -> None:
    world = jostle.World(walls={"segments": WALLS, "velocities": (1, 2)})
    walls = world.walls
    assert walls.velocities.dtype == np.float32
    assert walls.velocities.tolist() == [[1, 2], [1, 2]]
    world.step(0.5, steps=4)
    np.testing.assert_array_equal(walls.segments, np.add(WALLS, (2, 4)))
    walls.velocities = [(1, 0), (0, 0)]
    walls.segments = WALLS
    assert walls.velocities.tolist() == [[1, 0], [0, 0]]
    walls.velocities = np.array([3.0, 0.0])
    assert walls.velocities.tolist() == [[3, 0], [3, 0]]


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (5, r"velocities.* has shape \(\).*\(2,\) or \(2, 2\)"),
        ([(1, 2)] * 3, r"velocities.* has shape \(3, 2\)"),
        ([(1, 2), (np.nan, 0)], r"velocities.*\[1\] is \(NaN, 0\)"),
        ([(1, 2), (1e19, 0)], r"velocities.*\[1\]"),
    ],
)
def test_wrong_velocities_are_refused(value: ArrayLike, message: str) -> None:
    world = jostle.World(walls={"segments": WALLS, "velocities": (1, 2)})
    with pytest.raises(ValueError, match=message):
        world.walls.velocities = value  # type: ignore[assignment]
    assert world.walls.velocities.tolist() == [[1, 2], [1, 2]]
    with pytest.raises(ValueError, match=message):
        jostle.World(walls={"segments": WALLS, "velocities": value})


def test_a_snapshot_keeps_what_rounding_removed() -> None:
    def make() -> jostle.World:
        return jostle.World(
            [(30, 1)],
            1,
            velocities=[(-1, 0)],
            walls={"segments": [((1000.1, -2), (1000.1, 4))], "velocities": (-1 / 3, 0)},
        )

    world = make()
    world.step(0.1, steps=1000)
    halfway = make()
    halfway.step(0.1, steps=500)
    again = pickle.loads(pickle.dumps(halfway))
    again.step(0.1, steps=500)
    np.testing.assert_array_equal(again.walls.segments, world.walls.segments)
    expected = np.float32(1000.1) + 100 * np.float64(np.float32(-1 / 3))
    np.testing.assert_allclose(world.walls.segments[0, 0, 0], expected, rtol=1e-7)


def compression(n: int, ratio: float, speed: float, seed: int) -> tuple[float, float]:
    """Return the ratio of temperatures after a piston makes a box smaller, and that of theory.

    Without exchange of heat dE = −p dA with E = N kT, so that ln T grows by the integral of Z/A
    over the area A that is lost. The centres of discs of radius r can be in an area that is smaller
    than the box by r on each side, which the walls press on.
    """
    rng = np.random.default_rng(seed)
    side, radius = 100.0, 0.5
    cells = int(np.ceil(np.sqrt(n)))
    at = (np.stack(np.divmod(np.arange(n), cells), 1) + 0.5) * (side / cells)
    world = jostle.World(
        at,
        radius,
        velocities=rng.normal(size=(n, 2)) * 10,
        masses=1.0,
        container=jostle.Box(0, 0, side, side),
        walls=[((side, -1), (side, side + 1))],
    )
    world.step(1.0, steps=5)
    before = world.kinetic_energy()
    world.walls.velocities = (-speed, 0)
    seconds = side * (1 - ratio) / speed
    world.step(seconds / 200, steps=200)
    assert world.positions[:, 0].max() < side * ratio - 0.99 * radius
    widths = np.linspace(side * ratio, side, 10_001) - 2 * radius
    height = side - 2 * radius
    z = henderson(n * np.pi * radius**2 / (widths * height))
    exponent = np.sum((z / widths)[1:] + (z / widths)[:-1]) / 2 * (widths[1] - widths[0])
    return world.kinetic_energy() / before, float(np.exp(exponent))


@pytest.mark.usefixtures("usual_threads")
def test_a_piston_compresses_a_gas_adiabatically() -> None:
    measured = [compression(1000, 0.6, 0.5, seed) for seed in range(2)]
    found, expected = np.mean(measured, axis=0)
    assert found == pytest.approx(expected, rel=0.01)


def main() -> None:
    """Print the ratios of temperatures for some speeds of the piston."""
    for n in (500, 1000, 3000):
        for speed in (2.0, 1.0, 0.5, 0.25):
            measured = np.array([compression(n, 0.6, speed, seed) for seed in range(8)])
            ratio = measured[:, 0] / measured[:, 1]
            error = ratio.std(ddof=1) / np.sqrt(len(ratio))
            print(f"{n:5} discs, {speed:4} of 10: T/theory {ratio.mean():.4f} ± {error:.4f}")


if __name__ == "__main__":
    main()
