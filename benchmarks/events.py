"""Time of a step with `track_events` over that without: `python benchmarks/events.py`.

The processor's time of single steps in one thread, in rounds of both worlds; the least of all.
"""

from __future__ import annotations

import time

import jostle


def step_time(world: jostle.World) -> float:
    """Seconds of the processor for a step."""
    start = time.process_time()
    world.step(1 / 60)
    return time.process_time() - start


def main() -> None:
    """Print a line for each scene and number of discs."""
    for scene, n, rounds in (("gas", 10_000, 300), ("pile", 10_000, 100), ("gas", 100_000, 40)):
        worlds = [jostle.scenes.create(scene, n) for _ in range(2)]
        for world, tracked in zip(worlds, (False, True), strict=True):
            world.track_events, world.threads = tracked, 1
            world.step(1 / 60, 60)
        times = [[step_time(world) for world in worlds] for _ in range(rounds)]
        without, tracked = map(min, zip(*times, strict=True))
        print(f"{scene}, {n:,} discs: {1e3 * without:.2f} ms, with events {tracked / without:.2f}")


if __name__ == "__main__":
    main()
