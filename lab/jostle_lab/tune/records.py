"""The measurements as a CSV file: one line for each setting of each sweep."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

import jostle
from jostle.writing import NewFile
from jostle_lab.tune.sweep import Tuning

COLUMNS = (
    *("scene", "sweep", "work", "method", "n", "world_size", "leaf_capacity", "max_depth"),
    *("threads", "status", "rounds", "median_s", "low_s", "high_s", "version"),
)


def rows(tuning: Tuning) -> Iterator[dict[str, object]]:
    """Return the lines, by column; low and high are quartiles."""
    for sweep, outcomes in tuning.sweeps():
        for setting, outcome in outcomes.items():
            ours = setting.method == "quadtree"
            values = (outcome.median, *outcome.quartiles)
            yield {
                "scene": tuning.scene,
                "sweep": sweep,
                "work": tuning.work,
                "method": setting.method,
                "n": setting.n,
                "world_size": setting.world_size,
                "leaf_capacity": setting.leaf_capacity if ours else "",
                "max_depth": setting.max_depth if ours else "",
                "threads": "all" if tuning.threads is None else tuning.threads,
                "status": outcome.status,
                "rounds": len(outcome.rounds),
                **{
                    name: f"{value:.6g}" if outcome.rounds else ""
                    for name, value in zip(COLUMNS[-4:-1], values, strict=True)
                },
                "version": jostle.__version__,
            }


def write(tuning: Tuning, path: Path) -> None:
    """Write the file."""
    with NewFile(path) as new, new.path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows(tuning))
