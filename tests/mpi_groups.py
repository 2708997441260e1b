"""Running a test on all numbers of ranks in one start of four processes.

All four have the test first, then three of them beside a single one, then two.
"""

import sys
import time
import traceback
from collections.abc import Callable

from mpi4py import MPI

ALL = MPI.COMM_WORLD
GROUPS = ((0, 0, 0, 0), (0, 0, 0, 1), (0, 0, None, None))  # of four ranks, one after another


def on_each_number_of_ranks(act: Callable[[MPI.Comm], object]) -> None:
    """Call `act` in each group with its communicator; in a group of all, unless there are four."""
    for colours in GROUPS if ALL.size == 4 else ((0,) * ALL.size,):
        colour = colours[ALL.rank]
        comm = ALL.Split(MPI.UNDEFINED if colour is None else colour)
        if comm != MPI.COMM_NULL:
            act(comm)
            comm.Free()
        wait_for_all()


def wait_for_all() -> None:
    """A barrier whose waiting ranks leave the cores to the others; `Barrier` polls all the time."""
    request = ALL.Ibarrier()
    while not request.Test():
        time.sleep(0.002)


def run(test: Callable[[], object], message: str) -> None:
    """Run a test and print a message, or end all ranks with the error of one."""
    try:
        test()
    except BaseException:
        traceback.print_exc()
        sys.stderr.flush()
        ALL.Abort(1)
    if ALL.rank == 0:
        print(message)
