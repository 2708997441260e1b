"""Running a test on all numbers of ranks in one start of four processes.

All four have the test first, then three of them, two, and one.
"""

import sys
import time
import traceback
from collections.abc import Callable
from typing import Any

from mpi4py import MPI

ALL = MPI.COMM_WORLD


def on_each_number_of_ranks(act: Callable[[MPI.Intracomm], object]) -> None:
    """Call `act` with communicators of 4, 3, 2 and 1 ranks; of all ranks, unless there are four."""
    for size in range(4, 0, -1) if ALL.size == 4 else (ALL.size,):
        comm: Any = ALL.Split(0 if ALL.rank < size else MPI.UNDEFINED)
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
