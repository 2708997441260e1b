"""Growth of time and memory of `find_pairs` with the number of discs.

The memory is the peak resident set of a separate process during the call, minus that before the
call. So it includes the answer, but not the arrays of the scene.
"""

from __future__ import annotations

import gc
import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np
import shapes
from machine import Row
from numpy.typing import NDArray
from timing import interleaved

import jostle

COUNTS = (1_000, 3_000, 10_000, 30_000, 100_000, 300_000, 1_000_000, 3_000_000, 10_000_000)
THREADS = (1, 2)


def arrays(count: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return centres and radii of discs over 40 % of the area."""
    scene = shapes.create("discs", count)
    return scene.centers.astype(np.float32), scene.column().astype(np.float32)


def race(rounds: int, largest: int, told: Callable[[str], None]) -> Iterator[list[Row]]:
    """Yield a row for each size and number of threads."""
    for count in (count for count in COUNTS if count <= largest):
        told(f"{count:,}")
        centers, radii = arrays(count)
        calls = [partial(jostle.find_pairs, centers, radii, threads=number) for number in THREADS]
        answer = calls[0]().nbytes
        timings = interleaved(calls, rounds)
        yield [
            {
                "count": count,
                "version": jostle.__version__,
                "threads": number,
                **timing.columns(),
                "peak_bytes": peak(count, number),
                "answer_bytes": answer,
            }
            for number, timing in zip(THREADS, timings, strict=True)
        ]


def peak(count: int, threads: int) -> int:
    """Return the bytes that a separate process needs for the call."""
    command = [sys.executable, __file__, str(count), str(threads)]
    return int(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def measure(count: int, threads: int) -> int:
    """Return the growth of the resident set during the call."""
    jostle.find_pairs(*arrays(1_000), threads=threads)  # loads the code and starts the threads
    centers, radii = arrays(count)
    gc.collect()
    before = resident_now()
    answer = jostle.find_pairs(centers, radii, threads=threads)
    highest = resident_highest()
    del answer
    return max(0, highest - before)


def resident_now() -> int:
    """Return the resident set, and reset its peak to it."""
    clear = Path("/proc/self/clear_refs")
    if not clear.exists():
        return resident_highest()  # the peak so far: the growth is then too small, never too large
    clear.write_text("5")
    return of_status("VmRSS")


def resident_highest() -> int:
    """Return the peak of the resident set."""
    if Path("/proc/self/status").exists():
        return of_status("VmHWM")
    import resource

    kilobyte = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * kilobyte


def of_status(name: str) -> int:
    """Return a value of the status of this process (Linux), in bytes."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) * 1024 for line in lines if line.startswith(name))


if __name__ == "__main__":
    print(measure(int(sys.argv[1]), int(sys.argv[2])))
