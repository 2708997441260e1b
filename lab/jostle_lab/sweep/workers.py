"""The processes of a sweep: those of this machine, or the ranks that mpirun has started."""

import gc
import multiprocessing
import os
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
from typing import Any

from jostle_lab.launcher import is_started_by_mpi

from .plan import Run
from .run import do

#: Runs that wait for each process, so that none is idle.
_AHEAD = 2


@contextmanager
def executor(workers: int | None) -> Iterator[tuple[Executor, int] | None]:
    """Provide an executor and its number of processes; None on ranks that work for another."""
    if is_started_by_mpi():
        from mpi4py import MPI
        from mpi4py.futures import MPICommExecutor

        with MPICommExecutor(MPI.COMM_WORLD, root=0) as ranks:
            first: Any = ranks
            yield None if ranks is None else (first, MPI.COMM_WORLD.size - 1)
        return
    count = workers or os.cpu_count() or 1
    # A forked process would have no threads for steps, and could inherit locked locks.
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(count, context)
    try:
        yield pool, count
    finally:
        # After Ctrl-C they are in the middle of runs whose rows are not written.
        for process in multiprocessing.active_children():
            process.terminate()
        pool.shutdown(cancel_futures=True)
        del pool
        gc.collect()  # the locks of the pool; otherwise Python prints a warning when it ends


def results(pool: Executor, count: int, runs: list[Run]) -> Iterator[dict[str, str]]:
    """Yield the rows of runs as they are completed."""
    todo = iter(runs)
    pending: set[Future[dict[str, str]]] = set()
    while True:
        while len(pending) < _AHEAD * count and (run := next(todo, None)) is not None:
            pending.add(pool.submit(do, run))
        if not pending:
            return
        done, pending = wait(pending, return_when=FIRST_COMPLETED)
        for future in done:
            yield future.result()
