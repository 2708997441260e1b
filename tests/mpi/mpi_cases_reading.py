"""What ranks read: particles of any rank, sums over all, and results of queries."""

from copy import copy
from functools import partial
from itertools import permutations
from typing import Any

import numpy as np
from mpi_cases_events import fenced
from mpi_checks import fail_by_the_last_rank, refuse
from mpi_worlds import comm, evenly, gas, scattered, sleepers, unevenly, up_to

import jostle
import jostle.mpi
from jostle.mpi.queries import _first as first_hit


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
    about_it, of_one = (of.angular_momentum(about) for of in (ours, world))
    assert abs(about_it - of_one) <= 1e-11 * abs(of_one) + 1e-9, name
    assert np.array_equal(ours.net_forces(), world.net_forces()[world.rows(ours.ids)]), name


def test_sums() -> None:
    """Also with sleeping particles, given accelerations, forces between kinds and few discs."""
    table = np.random.default_rng(4).normal(0, 60, (3, 3, 12))
    kinds = np.arange(300) % 3
    pairs: dict[str, Any] = {"forces": [jostle.PairForce(table, 6.0, damping=0.5)], "kinds": kinds}
    flock = [jostle.Flocking(8.0, max_speed=30, separation=20, alignment=2, cohesion=1)]
    falling: dict[str, Any] = {
        "gravity": (1.0, 9.0),
        "drag": 0.1,
        "movable": np.arange(300) % 9 > 0,
    }
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
            refuse(partial(missing, name), f"{name[0]}; no particle")
    last = comm().rank == comm().size - 1
    fail_by_the_last_rank(lambda: ours.get([0.5] if last else [0]), TypeError, "ids")


def queries(world: jostle.World, count: int, seed: int) -> list[tuple[str, dict[str, Any]]]:
    """All queries with so many points near the particles, and one of each alone."""
    draw = np.random.default_rng(seed)
    low, high = world.positions.min(axis=0) - 2, world.positions.max(axis=0) + 2
    points = draw.uniform(low, high, (count, 2)).astype(np.float32)
    # Some where a particle is, and some between two.
    points[::3] = world.positions[draw.integers(0, len(world), len(points[::3]))]
    far = points + draw.uniform(0, 9, (count, 2))
    aims = {"origin": points, "direction": draw.normal(0, 1, (count, 2))}
    limits = {"max_distance": draw.uniform(0, 30, count), "mask": 5}
    some = {"exclude": world.ids[draw.integers(0, len(world), count)]}
    corners = points[:, None] + np.array([(0, 0), (7, 1), (2, 8)])
    sizes = {"radii": 0.3, "half_sizes": (0.5, 0.2), "max_distance": 30.0}
    many: list[tuple[str, dict[str, Any]]] = [
        ("query_point", {"point": points}),
        ("query_rect", {"rect": np.concatenate([points, far], axis=1), "mask": 6}),
        ("query_circle", {"center": points, "radius": draw.uniform(0, 9, count), **some}),
        ("query_polygon", {"vertices": corners}),
        ("nearest", {"point": points, "k": 3}),
        ("nearest", {"point": points, "k": 400, **limits, **some}),
        ("raycast", aims | limits | some),
        ("raycast", aims | {"max_distance": 90.0}),
        ("shape_cast", aims | sizes | some),
        ("raycast_all", aims | {"max_distance": 40.0} | some),
        ("raycast_all", aims | limits),
    ]
    if count == 0:
        return many * 2
    for query, given in many[:]:
        arrays = {name for name, of in given.items() if np.ndim(of) > 0 and len(of) == count}
        many.append((query, {name: of[0] if name in arrays else of for name, of in given.items()}))
    return many


@up_to(1)
def test_of_two_hits_at_the_same_distance_a_particle_with_the_smaller_id_is_first() -> None:
    both = jostle.World([(5, 0), (5, 0)], 1.0, walls=[((4, -9), (4, 9))])
    hits = []
    for removed in ([1], [0], [0, 1]):
        world = copy(both)
        world.remove(removed)
        hits.append(world.raycast((0, 0), (1, 0)))
    assert [hit.distance for hit in hits] == [4.0] * 3
    assert [hit.id for hit in hits] == [0, 1, -1]
    for order in permutations(hits):
        assert first_hit(order) == hits[0]
    assert first_hit(hits[:0:-1]) == hits[1]


@up_to(3)
def test_queries() -> None:
    """Each rank has its own queries, the last one none, with the results of one process."""
    rows = np.arange(240)
    filters: dict[str, Any] = {"categories": 1 << rows % 3, "movable": rows % 11 > 0}
    grid = np.column_stack([rows % 16, rows // 16]) * 2.0
    worlds = {
        "fences": fenced(),
        "grid": jostle.World(grid, 1.0, period=(32, 30)),
        "torus": gas(240, container="torus", **filters),
        "round": gas(240, container=jostle.Circle((20, 20), 90), **filters),
    }
    # With more ranks than cores each message takes long.
    for name, world in list(worlds.items())[: 4 if comm().size < 3 else 2]:
        ours = scattered(world, unevenly, every=2)
        for steps in (0, 3):
            ours.step(1 / 60, steps)
            whole = gathered(ours)
            count = 0 if comm().rank == comm().size - 1 > 0 else 25 + comm().rank
            for query, given in queries(whole, count, comm().rank):
                found, one = (getattr(of, query)(**given) for of in (ours, whole))
                same = np.array_equal(found, one) if isinstance(one, np.ndarray) else found == one
                assert same, (name, query, given, found, one)
        moved = ours.ids[:3]
        ours.set(moved, positions=ours.positions[:3] + 0.1)
        ours.remove(ours.ids[-1:])
        ours.walls.add(((0, 0), (30, 30)))
        whole, origin = gathered(ours), ours.positions[:1]
        aim: dict[str, Any] = {"direction": (0.3, 1.0), "max_distance": 60.0}
        assert ours.raycast_all(origin, **aim) == whole.raycast_all(origin, **aim), name
    assert list(ours.query_circle([], 1.0)) == [] == list(ours.raycast([], []).ids)
    last = comm().rank == comm().size - 1
    fail_by_the_last_rank(lambda: ours.nearest((1, 2), k=0 if last else 1), ValueError, "k is 0")
    fail_by_the_last_rank(lambda: ours.query_rect("a" if last else (1, 2, 3, 4)), TypeError, "rect")
