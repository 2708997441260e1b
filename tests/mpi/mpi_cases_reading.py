"""What ranks read: particles of any rank, sums over all, and answers to questions."""

from typing import Any

import numpy as np
from mpi_checks import fail_by_the_last_rank, refuse
from mpi_worlds import comm, evenly, gas, scattered, sleepers, unevenly, up_to

import jostle
import jostle.mpi


def gathered(ours: jostle.mpi.World) -> jostle.World:
    """A world of all particles on every rank."""
    world: jostle.World = comm().bcast(ours.gather())
    return world


def check_sums(name: str, ours: jostle.mpi.World, world: jostle.World) -> None:
    """Sums over all particles, and the forces on each."""
    for sum_of in ("total_energy", "angular_momentum", "temperature", "momentum"):
        found, one = (np.asarray(getattr(of, sum_of)()) for of in (ours, world))
        scale = abs(world.kinetic_energy()) + abs(world.potential_energy()) + 1
        assert np.allclose(found, one, rtol=1e-12, atol=1e-11 * scale, equal_nan=True), (
            name,
            sum_of,
        )
        assert len(set(map(bytes, comm().allgather(found)))) == 1, (name, sum_of)
    about = (3.1, -2.0)
    found, one = (of.angular_momentum(about) for of in (ours, world))
    assert abs(found - one) <= 1e-11 * abs(one) + 1e-9, name
    assert np.array_equal(ours.net_forces(), world.net_forces()[world.rows(ours.ids)]), name


def test_sums() -> None:
    """Also with sleeping particles, given accelerations, forces between kinds and few discs."""
    table = np.random.default_rng(4).normal(0, 60, (3, 3, 12))
    kinds = np.arange(300) % 3
    pairs: dict[str, Any] = {"forces": [jostle.PairForce(table, 6.0, damping=0.5)], "kinds": kinds}
    flock = [jostle.Flocking(8.0, max_speed=30, separation=20, alignment=2, cohesion=1)]
    falling = {"gravity": (1.0, 9.0), "drag": 0.1, "movable": np.arange(300) % 9 > 0}
    for name, world, steps in (
        ("box", gas(300, friction=0.4, **falling), 5),
        ("kinds", gas(300, container="torus", **pairs), 3),
        ("flock", gas(300, forces=flock), 3),
        ("asleep", sleepers(4), 150),
        ("one", gas(1), 1),
        ("none", gas(0), 1),
    ):
        ours = scattered(world, unevenly, every=2)
        ours.step(1 / 60, steps)
        assert any(comm().allgather(ours.asleep.any())) == (name == "asleep")
        check_sums(name, ours, gathered(ours))
        ours.accelerations = ours.positions * 2.0 - 1.0
        check_sums(f"{name}, pushed", ours, gathered(ours))
    last = comm().rank == comm().size - 1
    fail_by_the_last_rank(
        lambda: ours.angular_momentum("a" if last else (0, 0)), TypeError, "about"
    )
    if comm().size > 1:
        refuse(lambda: ours.angular_momentum((comm().rank, 0)), "about is not the same")


@up_to(3)
def test_get() -> None:
    """Each rank reads particles of any rank, some twice, one, or none."""
    ours = scattered(gas(90, friction=0.3, kinds=np.arange(90) % 5), evenly, every=2)
    ours.step(1 / 60, 5)
    ours.remove([3, 50] if comm().rank == 0 else [])
    world = gathered(ours)
    some = np.random.default_rng(comm().rank).choice(world.ids, 20 + comm().rank)
    assert ours.get(some) == world.get(some)
    alone = comm().rank == 0
    found = ours.get(7 if alone else [])
    assert found == world.get(7 if alone else [])
    assert isinstance(found, jostle.Particle if alone else jostle.Particles)
    assert np.array_equal(ours.kinds, world.kinds[world.rows(ours.ids)])
    for shape in ((-1,), (-1, 1)):
        ids = ours.ids.reshape(shape)
        assert np.array_equal(ours.rows(ids), np.arange(len(ours)).reshape(shape))
    assert len(ours) == 0 or ours.rows(int(ours.ids[0])) == 0
    other = np.setdiff1d(world.ids, ours.ids)[:1]
    for missing, name in ((ours.rows, other), (ours.rows, [3]), (ours.get, [3])):
        if len(name):
            refuse(lambda missing=missing, name=name: missing(name), f"{name[0]}; no particle")
    last = comm().rank == comm().size - 1
    fail_by_the_last_rank(lambda: ours.get([0.5] if last else [0]), TypeError, "ids")
