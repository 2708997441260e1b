"""The results, in tables and sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator

from rich import box
from rich.table import Table

from jostle_lab.tune.candidates import Method, Setting
from jostle_lab.tune.findings import (
    FRAME,
    Curve,
    crossing,
    curve,
    particles_within,
    size_gain,
    two_digits,
)
from jostle_lab.tune.sweep import (
    ARTICLE_CAPACITY,
    ARTICLE_DEPTH,
    COUNT_METHODS,
    WORLD_SIZES,
    Tuning,
)
from jostle_lab.tune.timing import FEWEST, Outcome, Ratio

WORK_NAMES = {"pairs": "building the tree and finding all pairs", "step": "one step of the world"}
DEFAULT_TAKES = "default,\nratio"
COUNT_NAMES: dict[Method, str] = {
    "quadtree": "tree",
    "brute force": "brute force",
    "article's tree": "article,\nwhole frame",
}
MARKS = {"≈": "≈ not significant", "?": "? too few rounds"}
WORTH = 1.05  # relative time; less is not worth a change


def title(tuning: Tuning) -> str:
    """Return a description of the tuning, in one line."""
    threads = "all cores" if tuning.threads is None else f"{tuning.threads} threads"
    threads = "1 thread" if tuning.threads == 1 else threads
    return f"{tuning.scene}, {tuning.n:,} particles, {WORK_NAMES[tuning.work]}, {threads}"


def report(tuning: Tuning) -> Iterator[Table | str]:
    """Return tables and sentences in reading order, the advice last."""
    found = any(outcome.rounds for outcome in tuning.settings.values())
    if found:
        yield _settings_table(tuning)
        yield verdict(tuning)
    if any(outcome.rounds for outcome in tuning.sizes.values()):
        yield _sizes_table(tuning)
    if any(outcome.rounds for outcome in tuning.counts.values()):
        yield _counts_table(tuning)
        yield _counts_sentence(tuning)
    if found or tuning.one_leaf():
        yield f"[bold]{advice(tuning)}[/]"


def verdict(tuning: Tuning) -> str:
    """Return the gain of the best setting over the default, and whether it is significant."""
    best, gain = tuning.best(), tuning.gain()
    if best == tuning.default:
        words = "No setting is faster than the default."
    elif gain.too_few:
        words = (
            f"{describe(tuning, best).capitalize()} is the fastest; there were too few rounds to "
            f"say whether the default is slower."
        )
    elif gain.within_noise:
        words = (
            f"{describe(tuning, best).capitalize()} is the fastest, but the default takes "
            f"{_times(gain)} as long, which is not significant."
        )
    else:
        words = f"With {describe(tuning, best)} the default takes {_times(gain)} as long."
    return f"{words} {_equals_sentence(tuning)}"


def _equals_sentence(tuning: Tuning) -> str:
    best = tuning.best()
    measured = [setting for setting, outcome in tuning.settings.items() if outcome.rounds]
    others = sum(1 for setting in measured if setting != best and tuning.is_as_good(setting))
    if tuning.too_few():
        words = f"{len(measured)} different trees were timed, in too few rounds for a comparison"
    else:
        words = f"Of {len(measured)} different trees {others or 'no'} "
        words += f"other{' is' if others == 1 else 's are'} not significantly slower than "
        words += "the default" if best == tuning.default else "this one"
        words = words.replace("no others are not", "no other is not")
    left_out = len(tuning.settings) - len(measured)
    return words + (f"; {left_out} were omitted as too slow." if left_out else ".")


def advice(tuning: Tuning) -> str:
    """Return the advice: a line of code to copy, or that the default is best."""
    best, gain = tuning.best(), tuning.gain()
    if tuning.one_leaf() and not tuning.settings:
        most = tuning.default.leaf_capacity
        return f"All particles fit into one leaf of up to {most}; there is nothing to tune."
    if gain.too_few:
        return "Too few rounds for advice."
    if best == tuning.default or gain.within_noise:
        return "Nothing to change: no setting is significantly faster than the default."
    if gain.median < WORTH:
        return f"Nothing to change: a gain of {_factor(gain.median)} × is too small."
    return f"To use it: {code(tuning, best)}"


def code(tuning: Tuning, setting: Setting) -> str:
    """Return a setting as a line of code."""
    options = f"leaf_capacity={setting.leaf_capacity}"
    if setting.max_depth != tuning.default.max_depth:
        options += f", max_depth={setting.max_depth}"
    if tuning.threads is not None:
        options += f", threads={tuning.threads}"
    if tuning.work == "step":
        return f"jostle.World(positions, velocities, radii, {options})"
    return f"jostle.Quadtree(centers, radii, {options}).pairs()"


def describe(tuning: Tuning, setting: Setting) -> str:
    """Return a description of a setting."""
    return f"leaf capacity {setting.leaf_capacity}, {_depth(tuning, setting)}"


def _depth(tuning: Tuning, setting: Setting) -> str:
    free = setting.max_depth == tuning.default.max_depth
    return "depth not limited" if free else f"depth at most {setting.max_depth}"


def _settings_table(tuning: Tuning) -> Table:
    table = _table("Leaf capacity and depth")
    _columns(table, "", "leaf\ncapacity", "maximum\ndepth", "time", "spread", DEFAULT_TAKES)
    measured = {s: o for s, o in tuning.settings.items() if o.rounds}
    worst = max(measured, key=lambda setting: measured[setting].median)
    article = tuning.cell(ARTICLE_CAPACITY, ARTICLE_DEPTH)
    for name, setting in (
        ("best", tuning.best()),
        ("default", tuning.default),
        ("article", article),
        ("slowest", worst),
    ):
        outcome = tuning.outcome(setting)
        limit = "none" if setting.max_depth == tuning.default.max_depth else f"{setting.max_depth}"
        if setting == article:
            limit = f"{ARTICLE_DEPTH}"
        if not outcome.rounds:
            table.add_row(name, f"{setting.leaf_capacity}", limit, outcome.status, "", "")
            continue
        table.add_row(
            name,
            f"{setting.leaf_capacity}",
            limit,
            in_ms(outcome.median),
            _spread(outcome),
            _gain(tuning.default_over(setting), setting == tuning.default),
            style="bold" if name == "best" else None,
        )
    return _noted(table)


def _sizes_table(tuning: Tuning) -> Table:
    table = _table("World size: the same particles in a smaller or larger world")
    _columns(table, "world", "time of\nthe default", "best leaf\ncapacity", DEFAULT_TAKES)
    for size in WORLD_SIZES:
        if (found := size_gain(tuning, size)) is None:
            continue
        default, best, gain = found
        stays = best == tuning.default.leaf_capacity
        table.add_row(f"× {size:g}", in_ms(default.median), f"{best}", _gain(gain, stays))
    return _noted(table)


def _counts_table(tuning: Tuning) -> Table:
    table = _table("Number of particles")
    names = (COUNT_NAMES[method] for method in COUNT_METHODS)
    _columns(table, "particles", *names, "tree per\nparticle", "brute force\nratio")
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
    what = "pairs" if tuning.work == "pairs" else "a step"
    words = f"Particles within 1/60 s: {ours} with the tree, {brute} by brute force "
    words += f"({what} in float32), {old} with the article's tree (a whole frame in Python)."
    if "more than" in ours + brute:
        words += ' "More than" means that the sweep ends there.'
    if (n := crossing(counts)) is not None:
        words += f" The tree is faster than brute force from about {two_digits(n):,} particles."
    return words


def _fits(points: Curve) -> str:
    if not points or points[0][1] > FRAME:
        return "none of those measured"
    found = particles_within(points)
    return f"more than {points[-1][0]:,}" if found is None else f"about {two_digits(found):,}"


def _table(name: str) -> Table:
    return Table(
        title=name,
        header_style="dim",
        box=box.SIMPLE_HEAD,
        padding=(0, 1),
    )


def _columns(table: Table, *names: str) -> None:
    """Add columns of numbers, which are not truncated."""
    for name in names:
        table.add_column(name, justify="right" if name else "left", no_wrap=True)


def _noted(table: Table) -> Table:
    """Add a caption with the marks in a table."""
    cells = [f"{cell}" for column in table.columns for cell in column.cells]
    notes = [words for mark, words in MARKS.items() if any(cell.startswith(mark) for cell in cells)]
    table.caption = "; ".join(notes) or None
    return table


def in_ms(seconds: float) -> str:
    """Return milliseconds with three significant digits."""
    value = 1e3 * seconds
    digits = max(2 - math.floor(math.log10(value)), 0) if value > 0 else 0
    return f"{value:,.{digits}f} ms"


def _spread(outcome: Outcome) -> str:
    if len(outcome.rounds) < FEWEST:
        return "–"
    low, high = outcome.quartiles
    return f"± {50 * (high - low) / outcome.median:.0f} %"


def _gain(ratio: Ratio, same: bool) -> str:
    if same:
        return "1.00 ×"
    mark = "?" if ratio.too_few else "≈" if ratio.within_noise else ""
    return f"{mark} {_factor(ratio.median)} ×".strip()


def _times(ratio: Ratio) -> str:
    return f"{_factor(ratio.median)} times ({_factor(ratio.low)} to {_factor(ratio.high)})"


def _factor(value: float) -> str:
    return f"{value:.2g}" if value < 0.1 else f"{value:.2f}" if value < 9.95 else f"{value:,.0f}"
