"""The table after a run without a window: steps and times, and those of the other methods."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Literal

from rich.table import Table

import jostle
from jostle.app.draw.text import pairs_of, plural, share
from jostle.app.headless import Film
from jostle.app.simulate.article_simulation import article_of
from jostle.app.simulate.settings import METHODS, Settings
from jostle.app.simulate.simulation import Frame, Rect, Simulation
from jostle.app.simulate.world_simulation import TIME_STEP, WorldSimulation

Row = tuple[str, str, str]  # what, how much, remark

PATIENCE = 1.0  # seconds of measuring for each method
BRUTE_LIMIT = 20_000  # particles; above, brute force is timed with fewer and scaled by n²
BRUTE_SAMPLE = 10_000
ARTICLE_LIMIT = 10_000  # particles; above, the article's tree is timed with so many


def film_report(simulation: Simulation, film: Film, settings: Settings) -> Table:
    """Time the methods at the last state, and return all numbers as a table.

    This steps `simulation`.
    """
    n, state = len(simulation), simulation.frame()
    facts = state.stats
    every_pair = pairs_of(n)
    if isinstance(simulation, WorldSimulation):
        simulation.world.sleeping = False  # the time of a step in which all are awake
    own = _milliseconds(simulation.step)  # without an encoder that uses the processor
    table = Table(title=f"{simulation.scene}, {METHODS[simulation.method]}", title_style="bold")
    table.show_header = False
    table.add_column()
    table.add_column(justify="right")
    table.add_column(style="dim")
    recorded = f"{film.steps / film.step_seconds:,.0f} while recording"
    part = f"{share(facts.pairs_tested, every_pair)} of n(n−1)/2 = {every_pair:,}"
    rows: list[Row] = [
        ("particles", f"{n:,}", ""),
        ("steps", f"{film.steps:,}", plural(film.frames, "frame")),
        ("steps/s", f"{1e3 / own:,.0f}", f"alone; {recorded}"),
        ("pairs tested", f"{facts.pairs_tested:,}", part),
        ("touching", f"{facts.touching:,}", "pairs, in the last step"),
    ]
    if facts.asleep:
        rows.append(("asleep", f"{facts.asleep:,}", "awake for the times of this table"))
    nothing: list[Row] = [("other methods", "–", "no pairs, so nothing to compare")]
    others = _comparison(simulation, state, settings) if every_pair else nothing
    for part_of_table in (rows, others):
        table.add_section()
        for row in part_of_table:
            table.add_row(*row)
    return table


def _comparison(simulation: Simulation, state: Frame, settings: Settings) -> list[Row]:
    """Return a row for each method, all at the same state."""
    view = simulation.view
    if not isinstance(simulation, WorldSimulation):
        settings = replace(settings, method="quadtree", sleeping=False)
        simulation = WorldSimulation.of_scene(settings)
    world = simulation.world
    ours, our_pairs = _time_world(world, "quadtree")
    return [
        ("quadtree, per step", _ms(ours), f"{_ms(our_pairs)} of it for the pairs"),
        _brute_row(world, settings, ours, our_pairs),
        _article_row(state, view, settings, ours),
    ]


def _brute_row(world: jostle.World, settings: Settings, ours: float, our_pairs: float) -> Row:
    n, remark, about, scale = len(world), "", "", 1.0
    if n > BRUTE_LIMIT:
        world = jostle.scenes.create(settings.scene, n=BRUTE_SAMPLE, seed=settings.seed)
        world.sleeping = False
        remark, about, scale = f" (scaled from {BRUTE_SAMPLE:,})", "≈ ", (n / BRUTE_SAMPLE) ** 2
    step, pairs = (value * scale for value in _time_world(world, "brute"))
    remark = f"{_times(step, ours)}, the pairs {_times(pairs, our_pairs)}{remark}"
    return "brute force, per step", about + _ms(step), remark


def _article_row(state: Frame, view: Rect, settings: Settings, ours: float) -> Row:
    name = "article's tree, per frame"
    if len(state.radii) > ARTICLE_LIMIT:
        sample = WorldSimulation.of_scene(replace(settings, method="quadtree", n=ARTICLE_LIMIT))
        needed = _milliseconds(article_of(sample.frame(), sample.view, "quadtree").frame)
        return name, _ms(needed), f"with only {ARTICLE_LIMIT:,} particles"
    needed = _milliseconds(article_of(state, view, "quadtree").frame)
    return name, _ms(needed), f"{_times(needed, ours)}, in plain Python"


def _time_world(world: jostle.World, method: Literal["quadtree", "brute"]) -> tuple[float, float]:
    """Return the milliseconds per step, and the time of the pairs in the last step."""
    world.method = method
    step = _milliseconds(lambda: world.step(TIME_STEP))
    return step, world.profile["build"] + world.profile["pairs"]


def _milliseconds(step: Callable[[], None]) -> float:
    """Return the mean time of a step over at most `PATIENCE` seconds, after one to warm up."""
    step()
    start, count = time.perf_counter(), 0
    while ((spent := time.perf_counter() - start) < PATIENCE and count < 100) or count == 0:
        step()
        count += 1
    return spent / count * 1e3


def _ms(value: float) -> str:
    """Return milliseconds with three significant digits, never as a power of ten."""
    digits = max(2 - math.floor(math.log10(value)), 0) if value > 0 else 0
    return f"{value:,.{digits}f} ms"


def _times(other: float, ours: float) -> str:
    return f"{other / ours:,.1f} ×" if ours > 0 else "–"
