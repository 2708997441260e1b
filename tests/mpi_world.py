"""A program of test_mpi_world: compares the hashes of distributed worlds with one process.

`mpiexec -n 4 python mpi_world.py CASE` calls `test_CASE` of the modules `mpi_cases_*`.
"""

import sys

import mpi_cases_errors
import mpi_cases_events
import mpi_cases_files
import mpi_cases_motion
import mpi_cases_sleeping
import mpi_cases_work
import mpi_worlds
from mpi4py import MPI
from mpi_groups import on_each_number_of_ranks, run

MODULES = (
    mpi_cases_motion,
    mpi_cases_events,
    mpi_cases_sleeping,
    mpi_cases_files,
    mpi_cases_errors,
    mpi_cases_work,
)


def main(case: str) -> None:
    (test,) = (vars(of)[f"test_{case}"] for of in MODULES if f"test_{case}" in vars(of))

    def act(ranks: MPI.Intracomm) -> None:
        mpi_worlds.use(ranks)
        test()

    run(lambda: on_each_number_of_ranks(act), "all bits are right")


main(sys.argv[1])
