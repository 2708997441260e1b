"""Two groups of sprites that all move: `jostle.pygame` beside pygame-ce and fastquadtree.

    python benchmarks/sprites.py           this part alone, about two minutes
    python benchmarks/run.py sprites       the same, into the folder of the results

Sprites of 6 by 6 pixels move in a window of 1280 by 720. All of them move before every call, which
is not timed. The time includes every update that a library needs: jostle reads the rects,
fastquadtree updates its group by the faster of its two methods, with the best of some capacities.
All libraries get the same groups. Answers are compared before timing: those of jostle with pygame's
in their order, those of fastquadtree as sets.
"""

from __future__ import annotations

import argparse
import math
import os
import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from machine import Results, Row, describe, slug, version_of
from timing import Timing, clock

os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")

WIDTH, HEIGHT, SIDE = 1280, 720, 6
COUNTS = (100, 1_000, 5_000, 10_000)
CAPACITIES = (8, 16, 32, 64)
PATIENCE = 6.0
"""Seconds; slower answers are omitted."""

LEAST_SECONDS = 0.05
"""Seconds; faster calls are repeated within a round, so that noise affects all equally."""

Call = Callable[[], Any]


class Crowd:
    """Two groups of sprites that move."""

    def __init__(self, count: int, seed: int = 1) -> None:
        import pygame

        draw = random.Random(seed)
        self.a, self.b = pygame.sprite.Group(), pygame.sprite.Group()
        self.speeds: list[list[Any]] = []
        for group in (self.a, self.b):
            for _ in range(count):
                sprite: Any = pygame.sprite.Sprite(group)
                place = draw.randrange(WIDTH - SIDE), draw.randrange(HEIGHT - SIDE)
                sprite.rect = pygame.Rect(*place, SIDE, SIDE)
                speed = [draw.choice([-2, -1, 1, 2]), draw.choice([-2, -1, 1, 2])]
                self.speeds.append([sprite.rect, *speed])

    def move(self) -> None:
        """Move all by one frame; they bounce off the sides of the window."""
        for mover in self.speeds:
            rect, dx, dy = mover
            rect.x += dx
            rect.y += dy
            if not 0 <= rect.x <= WIDTH - SIDE:
                mover[1] = -dx
            if not 0 <= rect.y <= HEIGHT - SIDE:
                mover[2] = -dy


@dataclass
class Entrant:
    """A library and its call."""

    name: str
    package: str
    manner: str
    call: Call
    ordered: bool = True


def groupcollides(crowd: Crowd, rule: Any) -> Iterator[Entrant]:
    """Yield the libraries for `groupcollide`."""
    import pygame

    import jostle.pygame

    a, b = crowd.a, crowd.b
    ours, theirs = jostle.pygame.groupcollide, pygame.sprite.groupcollide
    yield Entrant("jostle", "jostle", "", lambda: ours(a, b, False, False, rule))
    yield Entrant("pygame-ce", "pygame-ce", "", lambda: theirs(a, b, False, False, rule))
    if rule is None and version_of("fastquadtree"):
        yield fastquadtree(crowd)


def fastquadtree(crowd: Crowd) -> Entrant:
    """Return the fastest method of fastquadtree, by three frames of each."""
    import fastquadtree.pygame as fast

    def entrants(capacity: int) -> Iterator[Entrant]:
        group = fast.Group(crowd.b.sprites(), bounds=(-9, -9, 1300, 740), capacity=capacity)

        def rebuilt() -> Any:
            group.rebuild()
            return fast.groupcollide(crowd.a, group, False, False, sync=False)

        def synced() -> Any:
            return fast.groupcollide(crowd.a, group, False, False)

        for manner, call in (("rebuilt", rebuilt), ("synced", synced)):
            yield Entrant(
                "fastquadtree", "fastquadtree", f"{manner}, capacity {capacity}", call, False
            )

    every = [entrant for capacity in CAPACITIES for entrant in entrants(capacity)]
    return min(
        every, key=lambda entrant: min(moved_and_timed(crowd, entrant.call) for _ in range(3))
    )


def spritecollides(crowd: Crowd, rule: Any) -> Iterator[Entrant]:
    """Yield the libraries for `spritecollide`."""
    import pygame

    import jostle.pygame

    one, b = crowd.a.sprites()[0], crowd.b
    ours, theirs = jostle.pygame.spritecollide, pygame.sprite.spritecollide
    yield Entrant("jostle", "jostle", "", lambda: {one: ours(one, b, False, rule)})
    yield Entrant("pygame-ce", "pygame-ce", "", lambda: {one: theirs(one, b, False, rule)})


def tasks() -> dict[str, tuple[Callable[[Crowd, Any], Iterator[Entrant]], Any]]:
    """Return the tasks."""
    from pygame.sprite import collide_circle, collide_rect_ratio

    return {
        "groupcollide": (groupcollides, None),
        "groupcollide, rects × 1.5": (groupcollides, collide_rect_ratio(1.5)),
        "groupcollide, circles": (groupcollides, collide_circle),
        "spritecollide": (spritecollides, None),
        "spritecollide, circles": (spritecollides, collide_circle),
    }


def moved_and_timed(crowd: Crowd, call: Call) -> float:
    """Move the sprites, and time one call."""
    crowd.move()
    return clock(call)


def compare(entrants: list[Entrant]) -> None:
    """Raise an exception if two answers differ."""
    ours = entrants[0].call()
    for entrant in entrants[1:]:
        found = entrant.call()
        same = found == ours and list(found) == list(ours)
        if not entrant.ordered:
            same = {s: set(hits) for s, hits in found.items()} == {
                s: set(hits) for s, hits in ours.items()
            }
        if not same:
            raise SystemExit(f"{entrant.name} finds other sprites than jostle")


def race(rounds: int, largest: int) -> Iterator[list[Row]]:
    """Yield the rows of each task and size; a library that is too slow is omitted from then on."""
    for task, (entrants_of, rule) in tasks().items():
        slow: dict[str, float] = {}
        for count in (count for count in COUNTS if count <= largest):
            crowd = Crowd(count)
            growth = 2 if entrants_of is groupcollides else 1
            entrants = list(entrants_of(crowd, rule))
            entrants = [w for w in entrants if slow.get(w.name, 0) * count**growth <= PATIENCE]
            compare(entrants)
            once = [moved_and_timed(crowd, entrant.call) for entrant in entrants]
            repeats = [min(200, math.ceil(LEAST_SECONDS / seconds)) for seconds in once]
            times: list[list[float]] = [[] for _ in entrants]
            for _ in range(rounds):
                for own, entrant, count_of in zip(times, entrants, repeats, strict=True):
                    calls = [moved_and_timed(crowd, entrant.call) for _ in range(count_of)]
                    own.append(sum(calls) / count_of)
            timings = [Timing(tuple(own)) for own in times]
            for entrant, timing in zip(entrants, timings, strict=True):
                slow[entrant.name] = timing.median / count**growth
            yield [
                row(task, count, entrant, timing, timings[0])
                for entrant, timing in zip(entrants, timings, strict=True)
            ]


def row(task: str, count: int, entrant: Entrant, timing: Timing, ours: Timing) -> Row:
    """Return a row of the results."""
    return {
        "task": task,
        "count": count,
        "name": entrant.name,
        "version": version_of(entrant.package),
        "manner": entrant.manner,
        **timing.columns(),
        "times_jostle": f"{timing.median / ours.median:.3g}",
    }


def main() -> None:
    """Run this part."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--largest", type=int, default=COUNTS[-1], help="sprites in each group")
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "results")
    options = parser.parse_args()
    print(describe())
    results = Results(options.out / f"sprites-{slug()}.csv")
    for rows in race(options.rounds, options.largest):
        results.add(rows)
        for each in rows:
            print("  " + "  ".join(str(value) for value in each.values() if value != ""))


if __name__ == "__main__":
    main()
