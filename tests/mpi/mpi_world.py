"""A program of test_mpi_world: compares distributed worlds with those of one process.

`mpiexec -n 4 python mpi_world.py NAME...` calls `test_NAME` of a module `mpi_cases_*`, or all tests
of the module NAME, on each number of ranks up to the largest on which a test differs.
"""

import importlib
import sys
import time
from collections.abc import Callable, Iterator

import mpi_worlds
from mpi4py import MPI
from mpi_groups import ALL, on_each_number_of_ranks, run
from mpi_worlds import most_ranks

#: Cases that have a number of ranks of their own.
ALONE = ("killed", "long", "many")

Test = Callable[[], None]


def tests_of(module: str) -> dict[str, Test]:
    """The tests of a module by the names of their cases."""
    start = "test_"
    found = vars(importlib.import_module(module))
    return {name.removeprefix(start): of for name, of in found.items() if name.startswith(start)}


def chosen(names: list[str], modules: dict[str, dict[str, Test]]) -> Iterator[tuple[str, Test]]:
    """The cases with these names, or of the modules with these names."""
    for name in names:
        if name in modules:
            yield from ((case, of) for case, of in modules[name].items() if case not in ALONE)
        else:
            [test] = (tests[name] for tests in modules.values() if name in tests)
            yield name, test


def main() -> None:
    def act(ranks: MPI.Intracomm) -> None:
        mpi_worlds.use(ranks)
        for case, test in tests:
            if ranks.size > most_ranks(test) and ALL.size == 4:
                continue
            if ranks.rank == 0:
                print(f"{case} on {ranks.size}", end="", flush=True)
            start = time.perf_counter()
            test()
            if ranks.rank == 0:
                print(f": {time.perf_counter() - start:.1f} s", flush=True)

    # In one order on all ranks.
    modules = {name: tests_of(name) for name in mpi_worlds.CASES}
    tests = list(chosen(sys.argv[1:], modules))
    assert tests, "no case is named"
    on_each_number_of_ranks(act)


run(main, "all bits are right")
