"""Helpers for tests of signals and processes."""

import contextlib
import gc
import itertools
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest


def reaction_to_ctrl_c(call: Callable[[], object], after: float = 0.15) -> float:
    """Send SIGINT after `after` seconds; return the time until `call` ends.

    The handler is set here: SIGINT is ignored in background jobs. Callbacks of the garbage
    collector, of which Hypothesis has one, would lose an exception that is raised in them.
    """
    sent = 0.0
    main = threading.get_ident()

    def send() -> None:
        nonlocal sent
        sent = time.perf_counter()
        signal.pthread_kill(main, signal.SIGINT)

    ended = False
    timer = threading.Timer(after, send)
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    callbacks, gc.callbacks[:] = gc.callbacks[:], []
    try:
        with pytest.raises(KeyboardInterrupt):
            timer.start()
            call()
            ended = True
            time.sleep(60)  # the signal comes here
        took = time.perf_counter() - sent
    finally:
        timer.join()
        signal.signal(signal.SIGINT, handler)
        gc.callbacks[:] = callbacks
    assert not ended, "the call ended before it was interrupted; give it more to do"
    return took


def lets_others_run(call: Callable[[], object]) -> bool:
    """Whether another thread never waits for half of a call, in one of ten calls."""
    return any(_longest_pause(call) < 0.5 for _ in range(10))


def _longest_pause(call: Callable[[], object]) -> float:
    """The longest time that another thread has to wait, as a share of that of a call."""
    ticks: list[float] = []
    done = threading.Event()

    def tick() -> None:
        while not done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    time.sleep(0.02)
    start = time.perf_counter()
    try:
        call()
    finally:
        end = time.perf_counter()
        done.set()
        thread.join()
    assert end - start > 0.03, "too quick to tell"
    seen = [start, *(t for t in ticks if start < t < end), end]
    return max(after - before for before, after in itertools.pairwise(seen)) / (end - start)


def limit_memory(beyond: int) -> None:
    """Limit the address space to `beyond` bytes more than now, until `lift_limit`."""
    import resource

    with open("/proc/self/statm", encoding="ascii") as file:
        pages = int(file.read().split()[0])
    most = pages * os.sysconf("SC_PAGE_SIZE") + beyond
    _, largest = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (most, largest))


def lift_limit() -> None:
    """End the limit of `limit_memory`."""
    import resource

    _, largest = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (largest, largest))


@contextlib.contextmanager
def full_disk(most: int = 200) -> Iterator[None]:
    """Let no file become larger than so many bytes, as on a full disk."""
    import resource

    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    sys.dont_write_bytecode, before = True, sys.dont_write_bytecode  # it would be truncated
    resource.setrlimit(resource.RLIMIT_FSIZE, (most, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        sys.dont_write_bytecode = before
        signal.signal(signal.SIGXFSZ, handler)


def limit_threads() -> None:
    """Forbid more threads. The superuser has no limit, so the process gets the user nobody."""
    import resource

    if os.getuid() == 0:
        os.setuid(65534)
    resource.setrlimit(resource.RLIMIT_NPROC, (1, 1))


def printed_by(*arguments: str | Path, timeout: float = 60, **options: Any) -> str:
    """Run Python with these arguments in a separate process; return its output."""
    child = subprocess.run(
        [sys.executable, *arguments], capture_output=True, text=True, timeout=timeout, **options
    )
    assert child.returncode == 0, child.stderr[-2000:]
    printed: str = child.stdout
    return printed


def run_child(code: str, timeout: float = 60) -> str:
    """Run Python `code` that uses jostle and these helpers; return its output."""
    tests = os.path.dirname(__file__)
    begin = f"import sys; sys.path.insert(0, {tests!r})\nimport numpy as np, jostle\n"
    begin += "jostle._core.wake_threads_always(True)\n"
    return printed_by("-c", begin + code, timeout=timeout)
