"""A worker thread that runs one job at a time, or none in synchronous mode."""

from __future__ import annotations

import sys
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

T = TypeVar("T")

SWITCH_INTERVAL = 0.001  # seconds after which a thread releases the interpreter


class Worker:
    """Runs jobs on a thread, which is started by the first of them.

    In synchronous mode `submit` runs the job itself.
    """

    def __init__(self, name: str, *, synchronous: bool = False) -> None:
        self._name, self._synchronous = name, synchronous
        self._pool: ThreadPoolExecutor | None = None

    def submit(self, job: Callable[[], T]) -> Future[T]:
        """Run a job; return its future, which is done in synchronous mode."""
        if not self._synchronous:
            if self._pool is None:
                # The UI thread waits for the interpreter several times per frame.
                sys.setswitchinterval(SWITCH_INTERVAL)
                self._pool = ThreadPoolExecutor(1, self._name)
            return self._pool.submit(job)
        future: Future[T] = Future()
        try:
            future.set_result(job())
        except Exception as error:
            future.set_exception(error)
        return future

    def abandon(self) -> None:
        """Let a job in progress end by itself; later jobs run on another thread."""
        if self._pool is not None:
            self._pool.shutdown(wait=False)
            self._pool = None

    def close(self) -> None:
        """Wait for all jobs, and end the thread."""
        if self._pool is not None:
            self._pool.shutdown()
            self._pool = None
