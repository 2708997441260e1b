"""Times whole frames of the simulator's window: `python benchmarks/frames.py`.

One line for each number of particles: FPS, milliseconds per frame, and their parts on
the UI thread: simulation, scene, panels. No display is needed. Steps and slow frames are computed
on worker threads, so the longest frame shows how responsive the window is.
"""

from __future__ import annotations

import argparse
import os
import statistics
import time

os.environ.setdefault("SDL_VIDEODRIVER", "offscreen")
os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")

from jostle_lab.schema import Settings
from jostle_lab.simulate.start import start
from jostle_lab.window import Window

FRAME = 1 / 60
COLUMNS = (
    "n",
    "FPS",
    "median ms",
    "longest ms",
    "step ms",
    "scene ms",
    "panels ms",
)


def measure(scene: str, n: int, seconds: float) -> list[str]:
    """Return one line of the table."""
    window = Window(start(Settings(scene, n)))
    parts: dict[str, float] = {"step": 0.0, "scene": 0.0, "panels": 0.0}
    timed(window.session, "advance", parts, "step")
    timed(window.session, "draw", parts, "scene")
    timed(window, "_draw_panels", parts, "panels")
    for _ in range(5):
        window.frame(FRAME)  # stamps and letters are made
    parts.update(dict.fromkeys(parts, 0.0))
    frames, end = [], time.perf_counter() + seconds
    last = time.perf_counter()
    while last < end or len(frames) < 3:
        window.frame(FRAME)
        now = time.perf_counter()
        frames.append((now - last) * 1e3)
        last = now
    window.close()
    means = [f"{parts[name] / len(frames) * 1e3:.1f}" for name in parts]
    spent = sum(frames) / 1e3
    middle, longest = statistics.median(frames), max(frames)
    return [
        *(f"{n:,}", f"{len(frames) / spent:.0f}"),
        *(f"{middle:.1f}", f"{longest:.1f}", *means),
    ]


def timed(owner: object, name: str, parts: dict[str, float], part: str) -> None:
    """Count the time of a method under a name."""
    method = getattr(owner, name)

    def counted(*arguments: object) -> object:
        began = time.perf_counter()
        try:
            return method(*arguments)
        finally:
            parts[part] += time.perf_counter() - began

    setattr(owner, name, counted)


def main() -> None:
    """Print the table."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--scene", default="gas")
    options.add_argument("--n", type=int, nargs="+", default=[0, 2_000, 10_000, 20_000, 1_000_000])
    options.add_argument("--seconds", type=float, default=4.0, help="of each line")
    asked = options.parse_args()
    print(*(f"{title:>10}" for title in COLUMNS))
    for n in asked.n:
        print(*(f"{cell:>10}" for cell in measure(asked.scene, n, asked.seconds)), flush=True)


if __name__ == "__main__":
    main()
