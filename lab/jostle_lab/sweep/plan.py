"""The plan of a sweep: its runs, from settings with their values."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import jostle
from jostle_lab.schema import SCALARS, kind_of, unknown, wrong

#: Settings without effect on the results, or with an option of their own.
NOT_SWEPT = {"seed", "threads", "time_scale", "wall_friction"}

#: The settings that a sweep varies: those that are one number, and the factor of all initial
#: velocities.
SETTINGS = (
    *(name for name in SCALARS if "number" in kind_of(name) and name not in NOT_SWEPT),
    "speed",
)

#: Those of them that are whole numbers.
WHOLE = {name for name in SCALARS if kind_of(name) == "whole number"}

#: Values of one setting at most.
_MOST_VALUES = 100_000


class PlanError(ValueError):
    """A setting that is not understood."""


@dataclass(frozen=True)
class Run:
    """A world of a scene with a seed and settings, and how long it is simulated."""

    scene: str
    n: int
    seed: int
    steps: int
    warm_up: int
    settings: tuple[tuple[str, float], ...]
    measures: tuple[str, ...]

    @property
    def key(self) -> dict[str, str]:
        """The columns of the table that identify the run."""
        given = {name: repr(value) for name, value in self.settings if name != "n"}
        own = {"scene": self.scene, "n": self.n, "seed": self.seed, "steps": self.steps}
        return {**{name: str(value) for name, value in own.items()}, **given}


def parse(text: str) -> tuple[str, list[float]]:
    """Read ``name=first:last:count`` or ``name=value,value``.

    Returns
    -------
    tuple
        The name and the values; those of a range include both ends.
    """
    name, equals, given = text.partition("=")
    if not equals:
        raise PlanError(f"--set is {text!r}; it must be NAME=VALUES")
    if name not in SETTINGS:
        raise PlanError(f"--set is {text!r}; {name} {unknown(name, 'a number to vary', SETTINGS)}")
    try:
        if ":" in given:
            first, last, count = given.split(":")
            values = _between(float(first), float(last), int(count))
        else:
            values = [float(value) for value in given.split(",")]
    except ValueError:
        rule = "the values are FIRST:LAST:COUNT, or numbers with commas between them"
        raise PlanError(f"--set is {text!r}; {rule}") from None
    if name in WHOLE and all(value.is_integer() for value in values):
        values = [int(value) for value in values]
    for value in values:
        why = _not_finite(value) if name == "speed" else wrong(name, value)
        if why:
            raise PlanError(f"--set is {text!r}; {why}")
    return name, values


def _not_finite(value: float) -> str | None:
    return None if math.isfinite(value) else f"speed is {value}; it must be finite"


def _between(first: float, last: float, count: int) -> list[float]:
    if not 2 <= count <= _MOST_VALUES:
        raise ValueError
    # So that 0.5:1.0:6 has 0.7 and not 0.7000000000000001.
    return [float(f"{first + (last - first) * k / (count - 1):.12g}") for k in range(count)]


def plan(
    scene: str,
    n: int | None,
    ranges: Sequence[str],
    seeds: int,
    steps: int,
    warm_up: int,
    measures: Sequence[str],
) -> list[Run]:
    """List all runs: each combination of values with each seed."""
    names, values = [], []
    for name, own in map(parse, ranges):
        if name in names:
            raise PlanError(f"--set {name} is given twice")
        names.append(name)
        values.append(own)
    count = n if n is not None else jostle.scenes.default_count(scene)
    combinations = [dict(zip(names, each, strict=True)) for each in itertools.product(*values)]
    return [
        Run(
            *(scene, int(settings.get("n", count)), seed, steps, warm_up),
            settings=tuple(settings.items()),
            measures=tuple(measures),
        )
        for settings in combinations
        for seed in range(seeds)
    ]
