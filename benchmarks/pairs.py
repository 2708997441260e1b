"""Comparison of the search for all overlapping pairs: same arrays, same answers, then times."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import shapes as scenes
from machine import Row, version_of
from numpy.typing import NDArray
from pair_rivals import RIVALS, Pairs, Rival, Unable
from shapes import Shapes
from timing import THREADS, Effort, Timing, clock, interleaved

__all__ = ["Disagreement", "compare", "installed"]


SWEEP_MOST = 30_000
"""Settings are compared on scenes up to this size; larger scenes use the best of these."""

ONCE = 4
"""Times the patience: a slower library is not tried."""

SLACK = 1e-6
"""Relative tolerance, about the precision of float32: pairs with a smaller gap may differ."""


class Disagreement(Exception):
    """Two libraries find different pairs."""


@dataclass
class Entrant:
    """A rival with a number of threads, and its results so far in a scene."""

    rival: Rival
    threads: int
    setting: Mapping[str, Any]
    seconds_a_shape: float = 0.0

    @property
    def name(self) -> str:
        """The rival's name, with the threads where they are not one."""
        return self.rival.name + (f", {self.threads} threads" if self.threads > 1 else "")

    def call(self, shapes: Shapes) -> Callable[[], Pairs]:
        """Return its search as a function to be timed."""
        return partial(self.rival.find, shapes, self.threads, **self.setting)


def installed() -> list[Rival]:
    """Return the rivals whose packages are installed."""
    return [rival for rival in RIVALS if version_of(rival.package) is not None]


def compare(
    scene: str,
    counts: Sequence[int],
    effort: Effort = Effort(),  # noqa: B008 (it is frozen)
    rivals: Sequence[Rival] | None = None,
) -> Iterator[list[Row]]:
    """Compare and time every rival on one scene, and yield the rows of each size.

    Parameters
    ----------
    scene : str
        One of `shapes.SCENES`.
    counts : sequence of int
        Numbers of shapes, ascending.
    effort : Effort
        Rivals slower than its patience by a factor of `ONCE` are omitted.
    rivals : sequence of Rival, optional
        All installed ones if not given; the first is the reference.
    """
    entrants = [
        Entrant(rival, number, rival.settings[0])
        for rival in (installed() if rivals is None else rivals)
        for number in sorted({min(number, max(rival.threads)) for number in THREADS})
    ]
    for entrant in entrants:
        warm(entrant, scene)
    for count in counts:
        shapes = scenes.create(scene, count)
        expected = keys(entrants[0].call(shapes)(), count)
        rows, timed, calls = [], [], []
        for entrant in entrants:
            row = begin(entrant, shapes, len(expected))
            rows.append(row)
            effort.report(f"{scene}, {count:,}: {entrant.name}")
            if (
                entrant.seconds_a_shape * count > ONCE * effort.patience
                or count > entrant.rival.most
            ):
                row["note"] = "not tried at this size"
                continue
            try:
                took = check(entrant, shapes, expected)
                sweep(entrant, shapes)
            except (Unable, MemoryError) as reason:
                row["note"] = str(reason) or "not enough memory"
                continue
            row["setting"] = written(entrant.setting)
            entrant.seconds_a_shape = took / count
            if took > effort.patience:
                row |= Timing((took,)).columns()
            else:
                timed.append((entrant, row))
                calls.append(entrant.call(shapes))
        effort.report(f"{scene}, {count:,}: {effort.rounds} rounds of {len(calls)}")
        for (entrant, row), timing in zip(timed, interleaved(calls, effort.rounds), strict=True):
            row |= timing.columns()
            entrant.seconds_a_shape = timing.median / count
        yield rows


def warm(entrant: Entrant, scene: str) -> None:
    """Let a rival import its library."""
    with suppress(Unable):
        entrant.call(scenes.create(scene, 20))()


def begin(entrant: Entrant, shapes: Shapes, pairs: int) -> Row:
    """Return the row of a rival before timing."""
    return {
        "scene": shapes.scene,
        "count": len(shapes),
        "pairs": pairs,
        "name": entrant.rival.name,
        "version": version_of(entrant.rival.package),
        "threads": entrant.threads,
        "manner": entrant.rival.manner,
        "setting": "",
        "rounds": 0,
        "median_s": "",
        "low_s": "",
        "high_s": "",
        "note": "",
    }


def check(entrant: Entrant, shapes: Shapes, expected: NDArray[np.int64]) -> float:
    """Raise an exception unless the answer is the expected set; return its time."""
    answer: list[Pairs] = []
    took = clock(lambda: answer.append(entrant.call(shapes)()))
    found = keys(answer[0], len(shapes))
    if np.array_equal(found, expected):
        return took
    differing = np.setxor1d(found, expected)
    i, j = np.divmod(differing, len(shapes))
    apart = np.abs(shapes.centers[i] - shapes.centers[j])
    if shapes.half_sizes is not None:
        gaps = np.max(apart - shapes.half_sizes[i] - shapes.half_sizes[j], axis=1)
    else:
        gaps = np.hypot(*apart.T) - shapes.column()[i] - shapes.column()[j]
    slack = SLACK * float(np.max(np.abs(shapes.boxes())))
    if len(np.unique(found)) < len(found) or np.any(np.abs(gaps) > slack):
        raise Disagreement(
            f"{entrant.name} finds {len(found):,} pairs of {len(shapes):,} {shapes.scene}, "
            f"not the {len(expected):,} that were expected"
        )
    return took


def keys(pairs: Pairs, count: int) -> NDArray[np.int64]:
    """Return one number for each pair, sorted."""
    whole = np.asarray(pairs).reshape(-1, 2).astype(np.int64)
    return np.sort(whole.min(axis=1) * count + whole.max(axis=1))


def sweep(entrant: Entrant, shapes: Shapes) -> None:
    """Choose the best setting for these shapes."""
    if len(entrant.rival.settings) == 1 or len(shapes) > SWEEP_MOST:
        return
    tried = [
        Entrant(entrant.rival, entrant.threads, setting).call(shapes)
        for setting in entrant.rival.settings
    ]
    timings = interleaved(tried, 3)
    best = min(range(len(tried)), key=lambda number: timings[number].median)
    entrant.setting = entrant.rival.settings[best]


def written(setting: Mapping[str, Any]) -> str:
    """Return a setting as the arguments of a call."""
    return ", ".join(f"{name}={value}" for name, value in setting.items())
