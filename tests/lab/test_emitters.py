"""The app's emitters add due drops, remove the oldest ones, and are reproducible."""

from dataclasses import replace

import numpy as np
import pytest

import jostle
from jostle_lab.simulate.containers import TRIES, directions, in_disc
from jostle_lab.simulate.emitters import Emitters
from jostle_lab.simulate.settings import Settings
from jostle_lab.simulate.start import start

STEP = 1 / 60
N = 300


def drops(world: jostle.World) -> np.ndarray:
    return np.flatnonzero(world.movable)


def run(world: jostle.World, emitters: Emitters, steps: int) -> None:
    for _ in range(steps):
        world.step(STEP)
        emitters.step(world, STEP)


def empty() -> jostle.World:
    return jostle.World(np.empty((0, 2)), 1.0, gravity=(0, 900))


def test_as_many_come_as_are_due() -> None:
    emitters, world = Emitters(N), empty()
    rate = sum(nozzle.drops_per_second for nozzle in jostle.scenes.fountains(N))
    for step in range(1, 121):
        assert emitters.step(world, STEP) is None
        assert emitters.emitted == len(world)
        assert emitters.emitted + emitters.debt == pytest.approx(rate * STEP * step)
        assert 0 <= emitters.debt < 1


def test_the_cap_holds_and_the_oldest_go_first() -> None:
    world, emitters = jostle.scenes.create("emitters", N), Emitters(N)
    beads = len(world) - len(drops(world))
    oldest = drops(world)[0]
    assert oldest == beads  # the beads stay, and stay first
    removed = 0
    for _ in range(1500):
        world.step(STEP)
        before, radii = len(drops(world)), world.radii
        gone = emitters.step(world, STEP)
        assert len(drops(world)) <= N
        assert len(world) - len(drops(world)) == beads
        if gone is not None:
            assert gone.tolist() == list(range(beads, beads + len(gone)))
            kept = world.radii[: beads + before - len(gone)]
            np.testing.assert_array_equal(kept, np.delete(radii, gone))
            removed += len(gone)
    assert len(drops(world)) == N
    assert removed > N


def test_drops_come_out_of_the_nozzles() -> None:
    emitters, world = Emitters(N, seed=3), empty()
    nozzles = jostle.scenes.fountains(N)
    for _ in range(60):
        before = len(world)
        emitters.step(world, STEP)
        rows = slice(before, None)
        densities = world.masses[rows] / world.radii[rows] ** 2
        for nozzle in nozzles:
            mine = np.isclose(densities, nozzle.density)
            aside = world.positions[rows][mine] - nozzle.position
            reach = (np.hypot(*nozzle.velocity) + nozzle.spread) * STEP + nozzle.width
            assert (np.hypot(*aside.T) <= reach).all()
            change = world.velocities[rows][mine] - nozzle.velocity
            assert (np.hypot(*change.T) <= nozzle.spread + 900 * STEP + 1e-3).all()
            radii = world.radii[rows][mine]
            assert (radii >= np.float32(nozzle.radii[0])).all()
            assert (radii <= np.float32(nozzle.radii[1])).all()
    share = [np.isclose(world.masses / world.radii**2, n.density).mean() for n in nozzles]
    assert share == pytest.approx([1 / 3] * 3, abs=0.08)


def test_the_seed_decides_and_only_it() -> None:
    worlds = []
    for seed in (1, 1, 2):
        world, emitters = jostle.scenes.create("emitters", N), Emitters(N, seed)
        run(world, emitters, 60)
        worlds.append(world.state_hash())
    assert worlds[0] == worlds[1] != worlds[2]


@pytest.mark.parametrize("n", [0, 1, 2])
def test_small_caps(n: int) -> None:
    world, emitters = jostle.scenes.create("emitters", n), Emitters(n)
    run(world, emitters, 300)
    assert len(drops(world)) <= n
    assert np.isfinite(world.positions).all()


def test_a_long_step_emits_no_more_than_the_cap() -> None:
    emitters, world = Emitters(N), empty()
    emitters.step(world, 1000.0)
    assert len(world) == N
    assert emitters.emitted > 10 * N


def test_points_are_spread_evenly_over_a_disc() -> None:
    points = in_disc(np.random.default_rng(1).random((40_000, TRIES, 2)))
    distances = np.sqrt((points**2).sum(axis=1))
    assert distances.max() <= 1
    assert np.quantile(distances, [0.25, 0.5, 0.75]) == pytest.approx([0.5, 0.707, 0.866], abs=0.01)
    quadrants = np.bincount((points[:, 0] > 0) + 2 * (points[:, 1] > 0), minlength=4)
    assert quadrants / 40_000 == pytest.approx([0.25] * 4, abs=0.01)


def test_a_point_that_is_never_in_the_disc_is_moved_inside() -> None:
    assert in_disc(np.ones((1, TRIES, 2))).tolist() == [[0.5, 0.5]]


def test_directions_have_length_one_and_go_all_ways() -> None:
    ways = directions(np.random.default_rng(2), 40_000)
    assert (ways**2).sum(axis=1) == pytest.approx(1.0)
    assert ways.mean(axis=0) == pytest.approx([0, 0], abs=0.02)
    sectors = np.bincount(np.floor(np.arctan2(*ways.T) / (np.pi / 6)).astype(int) + 6, minlength=12)
    assert sectors[:12] / 40_000 == pytest.approx([1 / 12] * 12, abs=0.01)


def test_there_is_a_direction_also_in_the_very_middle() -> None:
    class Middle:
        def random(self, shape: tuple[int, ...]) -> np.ndarray:
            return np.full(shape, 0.5)

    assert directions(Middle(), 2).tolist() == [[1, 0], [1, 0]]


def test_drops_bounce_and_rub_like_the_others() -> None:
    for settings in (Settings("emitters", 50), Settings("emitters", 50, restitution=0.6)):
        simulation = start(replace(settings, friction=0.25))
        restitution = settings.restitution or simulation.world.restitution[0]
        world, began = simulation.world, len(simulation)
        simulation.adjust("n", 5)
        for _ in range(60):
            simulation.step()
        assert world.ids[-1] > began + 5 == len(drops(world)) + began  # all drops have been added
        assert (world.restitution == np.float32(restitution)).all()
        assert (world.friction == 0.25).all()
