"""Running a test on all numbers of ranks in one start of four processes.

All four have the test first, then three of them beside a single one, then two.
"""

import os
import sys
import time
import traceback
from collections.abc import Callable

from mpi4py import MPI

ALL = MPI.COMM_WORLD
GROUPS = ((0, 0, 0, 0), (0, 0, 0, 1), (0, 0, None, None))  # of four ranks, one after another


POLLS = 4  # before the first pause
PAUSE = 1e-5  # seconds; the system's timers make it about 6e-5


class PausingComm(MPI.Intracomm):
    """A communicator whose ranks pause while they wait.

    MPI's own waiting polls without a pause. If there are more ranks than cores, or other processes,
    a rank that is awaited then runs only when the time of a polling one is over: a call takes
    milliseconds.
    """

    def Dup(self) -> "PausingComm":
        return PausingComm(super().Dup())

    def Split(self, *arguments: int) -> "PausingComm":
        return PausingComm(super().Split(*arguments))

    def Allgather(self, *buffers: object) -> None:
        pause_until(self.Iallgather(*buffers))

    def Allgatherv(self, *buffers: object) -> None:
        pause_until(self.Iallgatherv(*buffers))

    def Allreduce(self, *arguments: object, **options: object) -> None:
        pause_until(self.Iallreduce(*arguments, **options))

    def Alltoall(self, *buffers: object) -> None:
        pause_until(self.Ialltoall(*buffers))

    def Alltoallv(self, *buffers: object) -> None:
        pause_until(self.Ialltoallv(*buffers))


def pause_until(request: MPI.Request) -> None:
    """Wait for a request."""
    polls = 0
    while not request.Test():
        polls += 1
        if polls >= POLLS:
            time.sleep(PAUSE)


def wait_for_all(comm: MPI.Comm = ALL) -> None:
    """Wait for all processes of a communicator."""
    pause_until(comm.Ibarrier())


def on_each_number_of_ranks(act: Callable[[MPI.Comm], object]) -> None:
    """Call `act` in each group with its communicator; in a group of all, unless there are four."""
    for colours in GROUPS if ALL.size == 4 else ((0,) * ALL.size,):
        colour = colours[ALL.rank]
        comm = ALL.Split(MPI.UNDEFINED if colour is None else colour)
        if comm != MPI.COMM_NULL:
            act(PausingComm(comm) if ALL.size > (os.cpu_count() or 1) else comm)
            comm.Free()
        wait_for_all()


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
