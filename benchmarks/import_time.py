"""Time of `import jostle` beyond that of NumPy: `.venv/bin/python benchmarks/import_time.py`.

Each run is a new process, which imports NumPy before the clock starts. Runs of jostle and of an
empty module take turns, so that other processes of the machine slow both down.
"""

from __future__ import annotations

import statistics
import subprocess
import sys

RUNS = 20
CODE = (
    "import numpy, time; start = time.perf_counter(); import {}; print(time.perf_counter() - start)"
)


def milliseconds(module: str) -> float:
    """Return the time in which a new process imports a module after NumPy."""
    command = [sys.executable, "-c", CODE.format(module)]
    child = subprocess.run(command, check=True, capture_output=True, text=True)
    return 1e3 * float(child.stdout)


def main() -> None:
    """Print medians and minima."""
    times: dict[str, list[float]] = {"jostle": [], "numpy.typing": []}
    for _ in range(RUNS + 1):
        for module, found in times.items():
            found.append(milliseconds(module))
    for module, found in times.items():
        found = found[1:]  # the first one writes bytecode
        median, least = statistics.median(found), min(found)
        print(f"import {module:13} {median:6.2f} ms, at least {least:6.2f} ms, {RUNS} runs")


if __name__ == "__main__":
    main()
