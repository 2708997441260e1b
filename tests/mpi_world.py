"""A program of test_mpi_world: compares distributed worlds with those of one process.

`mpiexec -n 4 python mpi_world.py CASE...` calls `test_CASE` of the modules `mpi_cases_*`. The name of a
module stands for all of its tests that begin on any number of ranks.
"""

import importlib
import sys
import time
from collections.abc import Callable, Iterator

import mpi_worlds
from mpi4py import MPI
from mpi_groups import on_each_number_of_ranks, run

MODULES = ("motion", "events", "sleeping", "files", "errors", "work")

#: Cases that have a number of ranks of their own.
ALONE = ("killed", "long", "many")

Test = Callable[[], None]


def tests_of(module: str) -> dict[str, Test]:
    """The tests of a module by the names of their cases."""
    found = vars(importlib.import_module(f"mpi_cases_{module}"))
    start = "test_"
    return {name.removeprefix(start): of for name, of in found.items() if name.startswith(start)}


def chosen(names: list[str]) -> Iterator[tuple[str, Test]]:
    """The cases with these names, or of the modules with these names."""
    everything = {case: of for module in MODULES for case, of in tests_of(module).items()}
    for name in names:
        if name in MODULES:
            yield from ((case, of) for case, of in tests_of(name).items() if case not in ALONE)
        else:
            yield name, everything[name]


def main() -> None:
    def act(ranks: MPI.Intracomm) -> None:
        mpi_worlds.use(ranks)
        for case, test in tests:
            start = time.perf_counter()
            test()
            if ranks.rank == 0:
                print(f"{case} on {ranks.size}: {time.perf_counter() - start:.1f} s", flush=True)

    # In one order on all ranks.
    tests = list(chosen(sys.argv[1:]))
    on_each_number_of_ranks(act)


run(main, "all bits are right")
