"""A program of test_mpi_programs: compares the pairs of all ranks with those of one process."""

from functools import partial
from typing import Any

import numpy as np
from mpi4py import MPI
from mpi_checks import fail_by_the_last_rank
from mpi_groups import on_each_number_of_ranks, run
from mpi_worlds import Distribution, comm, evenly, on_last, parts, use

import jostle
import jostle.mpi

RNG = np.random.default_rng(5)

Shapes = dict[str, Any]


def discs(n: int, side: float = 30.0) -> Shapes:
    return {"positions": RNG.uniform(0, side, (n, 2)), "radii": RNG.uniform(0.2, 1.0, n)}


def split(rows: Shapes, where: Distribution) -> Shapes:
    """This rank's share."""
    mine = parts(len(rows["positions"]), where)
    return {name: column[mine] for name, column in rows.items()}


def check(rows: Shapes, where: Distribution = evenly, **options: Any) -> None:
    expected = jostle.find_pairs(**rows, **options, sort=True)
    share = split(rows, where)
    found = jostle.mpi.find_pairs(comm(), **share, **options, sort=True)
    assert found.dtype == np.int64 and found.shape[1:] == (2,)
    assert np.array_equal(found, found[np.lexsort((found[:, 1], found[:, 0]))])
    everything = np.concatenate(comm().allgather(found))
    everything = everything[np.lexsort((everything[:, 1], everything[:, 0]))]
    assert np.array_equal(everything, expected), (len(everything), len(expected))


def check_all(ranks: MPI.Intracomm) -> None:
    global RNG
    RNG = np.random.default_rng(5)
    use(ranks)
    check(discs(3000))
    check(discs(3000), on_last)
    check(discs(3000), distance=0.7)
    rows = discs(2000)
    check({name: column.astype(np.float32) for name, column in rows.items()})
    check(discs(2000), period=30.0)
    check(discs(2000), period=(30.0, None), distance=0.3)
    # Far outside of the first period.
    rows = discs(1000)
    rows["positions"] += RNG.integers(-3, 4, (1000, 2)) * 30.0
    check(rows, period=30.0)
    # A period that is not much longer than the shapes.
    check({"positions": RNG.uniform(0, 4, (60, 2)), "radii": np.full(60, 0.9)}, period=4.0)
    # Boxes, and shapes that are boxes or discs.
    rows = discs(2000) | {"half_sizes": RNG.uniform(0, 0.8, (2000, 2))}
    check(rows)
    # Coincident shapes, at the point where a plane of two ranks is divided.
    rows = discs(900)
    rows["positions"][::3] = 15.0
    check(rows)
    check({"positions": np.full((200, 2), 7.0), "radii": np.full(200, 1.0)})
    # A giant shape across all ranks, and one shape that is far away.
    rows = discs(3000)
    rows["radii"][1234] = 40.0
    check(rows)
    rows["positions"][77] = (1e9, -1e7)
    check(rows)
    rows["positions"][78:81] = [(1e300, 1e300), (-1e300, 0.0), (1e300, 1e300)]
    check(rows)
    # In float32, where the largest coordinates are not exact.
    rows = {name: column.astype(np.float32) for name, column in discs(2000).items()}
    rows["positions"][::100] += np.float32(3e8)
    check(rows)
    # Few large shapes among many points.
    rows = discs(4000)
    rows["radii"] = np.where(np.arange(4000) % 40 == 0, 3.0, 0.0)
    check(rows)
    # Sizes over many orders of magnitude.
    rows = discs(1500, 100.0)
    rows["radii"] = np.exp(RNG.uniform(-12, 3, 1500))
    check(rows)
    # Fewer shapes than ranks, none, and all on one line.
    check(discs(2, 0.5))
    check(discs(1))
    check({"positions": np.zeros((0, 2)), "radii": np.zeros(0)})
    rows = discs(800, 200.0)
    rows["positions"][:, 1] = 3.0
    check(rows)
    # Categories and masks.
    rows = discs(2000)
    rows["categories"] = 1 << RNG.integers(0, 3, 2000).astype(np.uint32)
    rows["masks"] = RNG.integers(0, 8, 2000).astype(np.uint32)
    check(rows)
    # Two clusters far from each other.
    rows = discs(2000)
    rows["positions"][::2] += 1e7
    check(rows)
    # A plain number for all, in the precision of the arrays.
    points = split({"positions": RNG.uniform(0, 20, (500, 2)).astype(np.float32)}, evenly)[
        "positions"
    ]
    found = jostle.mpi.find_pairs(comm(), points, 0.3, (0.2, 0.1))
    whole = np.concatenate(comm().allgather(points))
    assert sum(comm().allgather(len(found))) == len(jostle.find_pairs(whole, 0.3, (0.2, 0.1)))
    # Plain lists, and an empty share, whose half sizes have no rows.
    boxes = discs(40, 8.0) | {"half_sizes": RNG.uniform(0.1, 0.8, (40, 2))}
    share = split(boxes, lambda n: np.minimum(evenly(n), max(comm().size - 2, 0)))
    share = {name: column.tolist() for name, column in share.items()}
    found = jostle.mpi.find_pairs(comm(), **share)
    assert sum(comm().allgather(len(found))) == len(jostle.find_pairs(**boxes))
    check_shares()
    check_errors()


def check_shares() -> None:
    """All ranks find about as many pairs, wherever the shapes are, even if one is far away."""
    share = split(discs(8000, 80.0), on_last)
    for far in ((40.0, 40.0), (1e12, -1e11), (-1e300, 1e-300)):
        if len(share["positions"]):
            share["positions"][1234] = far
        counts = comm().allgather(len(jostle.mpi.find_pairs(comm(), **share)))
        assert max(counts) < 2 * sum(counts) / comm().size + 10, (far, counts)


def check_errors() -> None:
    radii = np.ones(4)
    if comm().rank == comm().size - 1:
        radii[2] = -0.5
    find = partial(jostle.mpi.find_pairs, comm(), np.zeros((4, 2)), radii)
    fail_by_the_last_rank(find, ValueError, "radii[2] is -0.5")


run(lambda: on_each_number_of_ranks(check_all), "all pairs are right")
