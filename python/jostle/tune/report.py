"""What came of it, in tables and sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator

from rich.table import Table

from jostle.tune.contenders import Setting
from jostle.tune.findings import (
    FRAME,
    Curve,
    crossing,
    curve,
    particles_within,
    size_gain,
    two_digits,
)
from jostle.tune.sweep import (
    ARTICLE_CAPACITY,
    ARTICLE_DEPTH,
    COUNT_METHODS,
    WORLD_SIZES,
    Tuning,
)
from jostle.tune.timing import Outcome, Ratio

WORK_NAMES = {"pairs": "building the tree and finding all pairs", "step": "one step of the world"}


def title(tuning: Tuning) -> str:
    """Return what was tuned, in a line."""
    threads = "all cores" if tuning.threads is None else f"{tuning.threads} threads"
    threads = "1 thread" if tuning.threads == 1 else threads
    return f"{tuning.scene}, {tuning.n:,} particles, {WORK_NAMES[tuning.work]}, {threads}"


def report(tuning: Tuning) -> Iterator[Table | str]:
    """Return tables and sentences in the order to be read."""
    if any(outcome.rounds for outcome in tuning.settings.values()):
        yield _settings_table(tuning)
        yield verdict(tuning)
    if any(outcome.rounds for outcome in tuning.sizes.values()):
        yield _sizes_table(tuning)
    if any(outcome.rounds for outcome in tuning.counts.values()):
        yield _counts_table(tuning)
        yield _counts_sentence(tuning)


def verdict(tuning: Tuning) -> str:
    """Say what the best setting gains over the default, and whether that is more than noise."""
    best, gain = tuning.best(), tuning.gain()
    if best == tuning.default:
        words = "The default is the best of all settings tried."
    elif gain.within_noise:
        words = (
            f"The default stands: {describe(tuning, best)} came out first, but its lead, "
            f"{_times(gain)}, is within the noise."
        )
    else:
        words = f"The best is {describe(tuning, best)}: the default takes {_times(gain)} as long."
    equal = [s for s, o in tuning.settings.items() if o.rounds and tuning.is_as_good(s)]
    trees = sum(1 for outcome in tuning.settings.values() if outcome.rounds)
    left_out = len(tuning.settings) - trees
    words += f" Of {trees} different trees {len(equal)} cannot be told apart from the quickest"
    return words + (f"; {left_out} were left out as too slow." if left_out else ".")


def describe(tuning: Tuning, setting: Setting) -> str:
    """Return a setting in words."""
    return f"leaf capacity {setting.leaf_capacity}, {_depth(tuning, setting)}"


def _depth(tuning: Tuning, setting: Setting) -> str:
    free = setting.max_depth == tuning.default.max_depth
    return "depth not limited" if free else f"depth at most {setting.max_depth}"


def _settings_table(tuning: Tuning) -> Table:
    table = _table("Leaf capacity and depth")
    for name in ("", "leaf capacity", "maximum depth", "time", "spread", "against the default"):
        table.add_column(name, justify="left" if not name else "right")
    measured = {s: o for s, o in tuning.settings.items() if o.rounds}
    worst = max(measured, key=lambda setting: measured[setting].median)
    article = tuning.cell(ARTICLE_CAPACITY, ARTICLE_DEPTH)
    for name, setting in (
        ("best", tuning.best()),
        ("default", tuning.default),
        ("the article's", article),
        ("slowest", worst),
    ):
        outcome = tuning.outcome(setting)
        limit = "none" if setting.max_depth == tuning.default.max_depth else f"{setting.max_depth}"
        if setting == article:
            limit = f"{ARTICLE_DEPTH}"
        if not outcome.rounds:
            table.add_row(name, f"{setting.leaf_capacity}", limit, outcome.status, "", "")
            continue
        against = tuning.against_default(setting)
        table.add_row(
            name,
            f"{setting.leaf_capacity}",
            limit,
            in_ms(outcome.median),
            _spread(outcome),
            "" if setting == tuning.default else _against(against),
            style="bold" if name == "best" else None,
        )
    return table


def _sizes_table(tuning: Tuning) -> Table:
    table = _table("World size: the same particles, closer together or further apart")
    for name in ("world", "time of the default", "best leaf capacity", "the default takes"):
        table.add_column(name, justify="right")
    for size in WORLD_SIZES:
        if (found := size_gain(tuning, size)) is None:
            continue
        default, best, gain = found
        stays = best == tuning.default.leaf_capacity
        table.add_row(
            f"× {size:g}", in_ms(default.median), f"{best}", "" if stays else _against(gain)
        )
    return table


def _counts_table(tuning: Tuning) -> Table:
    table = _table("Number of particles")
    table.add_column("particles", justify="right")
    for method in COUNT_METHODS:
        table.add_column(method, justify="right")
    table.add_column("tree, a particle", justify="right")
    table.add_column("brute force takes", justify="right")
    by_key = {(setting.n, setting.method): o for setting, o in tuning.counts.items()}
    for n in sorted({setting.n for setting in tuning.counts}):
        found = [by_key.get((n, method), Outcome()) for method in COUNT_METHODS]
        if not any(outcome.rounds or outcome.too_slow for outcome in found):
            continue
        ours, brute, _ = found
        both = ours.rounds and brute.rounds
        table.add_row(
            f"{n:,}",
            *(in_ms(o.median) if o.rounds else o.status if o.too_slow else "–" for o in found),
            f"{1e9 * ours.median / n:,.0f} ns" if ours.rounds else "",
            f"{brute.median / ours.median:,.1f} ×" if both else "",
        )
    return table


def _counts_sentence(tuning: Tuning) -> str:
    counts = tuning.counts
    ours, brute, old = (_fits(curve(counts, method)) for method in COUNT_METHODS)
    words = f"A 60th of a second is enough for {ours} particles"
    words += f" with the tree, {brute} by brute force, and {old} with the article's tree."
    if (n := crossing(counts)) is not None:
        words += f" The tree overtakes brute force at about {two_digits(n):,} particles."
    return words


def _fits(points: Curve) -> str:
    if not points or points[0][1] > FRAME:
        return "no measured number of"
    found = particles_within(points)
    return f"more than {points[-1][0]:,}" if found is None else f"about {two_digits(found):,}"


def _table(name: str) -> Table:
    return Table(title=name, title_style="bold", title_justify="left", header_style="dim")


def in_ms(seconds: float) -> str:
    """Return milliseconds in three digits that tell."""
    value = 1e3 * seconds
    digits = max(2 - math.floor(math.log10(value)), 0) if value > 0 else 0
    return f"{value:,.{digits}f} ms"


def _spread(outcome: Outcome) -> str:
    low, high = outcome.quartiles
    return f"± {50 * (high - low) / outcome.median:.0f} %"


def _against(ratio: Ratio) -> str:
    return f"{_factor(ratio.median)} ×" + (", within the noise" if ratio.within_noise else "")


def _times(ratio: Ratio) -> str:
    return f"{_factor(ratio.median)} times ({_factor(ratio.low)} to {_factor(ratio.high)})"


def _factor(value: float) -> str:
    return f"{value:.2f}" if value < 9.95 else f"{value:,.0f}"
