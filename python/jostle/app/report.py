"""The table after a film: what was done, and what the other methods would have needed."""

from __future__ import annotations

import time
from collections.abc import Callable

from rich.table import Table

import jostle
from jostle.app.article_simulation import article_of
from jostle.app.headless import Film
from jostle.app.readout import method_name, pairs_of, share
from jostle.app.simulation import Frame, Rect, Simulation
from jostle.app.start import Options
from jostle.app.world_simulation import TIME_STEP, WorldSimulation

PATIENCE = 1.0  # seconds of measuring for each method
BRUTE_LIMIT = 20_000  # particles; above, brute force is timed with fewer and scaled by n²
BRUTE_SAMPLE = 10_000
ARTICLE_LIMIT = 2_000  # particles; above, the article's tree is timed with so many


def report(simulation: Simulation, film: Film, options: Options) -> Table:
    """Time the other methods at the film's last state, and lay all numbers out.

    Steps `simulation` on, so take pictures before.
    """
    n, facts = len(simulation), simulation.facts()
    every_pair = pairs_of(n)
    table = Table(title=f"{simulation.scene}, {method_name(simulation.method)}", title_style="bold")
    table.add_column("")
    table.add_column("", justify="right")
    table.add_column("", style="dim")
    table.show_header = False
    table.add_row("particles", f"{n:,}", "")
    table.add_row("steps", f"{film.steps:,}", f"{film.frames:,} pictures")
    table.add_row("steps a second", f"{film.steps / film.step_seconds:,.0f}", "simulation alone")
    table.add_row(
        "pairs tested", f"{facts.pairs_tested:,}",
        f"{share(facts.pairs_tested, every_pair)} of n(n−1)/2 = {every_pair:,}",
    )  # fmt: skip
    table.add_row("touching", f"{facts.touching:,}", "pairs, in the last step")
    table.add_section()
    for row in _comparison(simulation, options):
        table.add_row(*row)
    return table


def _comparison(simulation: Simulation, options: Options) -> list[tuple[str, str, str]]:
    """Return a row for each method: name, milliseconds a step, remark."""
    if not isinstance(simulation, WorldSimulation):
        simulation = WorldSimulation(options.scene, options.n, seed=options.seed)
    world, frame = simulation.world, simulation.frame()
    world.method = "quadtree"
    ours = _milliseconds(lambda: world.step(TIME_STEP))
    rows = [("a step with the quadtree", f"{ours:,.3g} ms", "this library")]
    rows.append(_brute_row(world, options, ours))
    rows.append(_article_row(frame, simulation.view, options, ours))
    return rows


def _brute_row(world: jostle.World, options: Options, ours: float) -> tuple[str, str, str]:
    name, n = "a step with brute force", len(world)
    if n <= BRUTE_LIMIT:
        world.method = "brute"
        time_needed = _milliseconds(lambda: world.step(TIME_STEP))
        return name, f"{time_needed:,.3g} ms", _times(time_needed, ours)
    sample = jostle.scenes.create(options.scene, n=BRUTE_SAMPLE, seed=options.seed)
    sample.method = "brute"
    time_needed = _milliseconds(lambda: sample.step(TIME_STEP)) * (n / BRUTE_SAMPLE) ** 2
    remark = f"{_times(time_needed, ours)}; timed with {BRUTE_SAMPLE:,}, scaled by n²"
    return name, f"≈ {time_needed:,.0f} ms", remark


def _article_row(frame: Frame, view: Rect, options: Options, ours: float) -> tuple[str, str, str]:
    name, n = "a frame with the article's tree", len(frame.radii)
    if n > ARTICLE_LIMIT:
        sample = WorldSimulation(options.scene, ARTICLE_LIMIT, seed=options.seed)
        program = article_of(sample.frame(), sample.view, "quadtree")
        time_needed = _milliseconds(program.frame)
        remark = f"with {ARTICLE_LIMIT:,} particles only: it is plain Python"
        return name, f"{time_needed:,.3g} ms", remark
    time_needed = _milliseconds(article_of(frame, view, "quadtree").frame)
    return name, f"{time_needed:,.3g} ms", f"{_times(time_needed, ours)}; plain Python"


def _milliseconds(step: Callable[[], None]) -> float:
    """Return the mean time of a step, over as many as fit into `PATIENCE`, after one to warm up."""
    step()
    start, count = time.perf_counter(), 0
    while ((spent := time.perf_counter() - start) < PATIENCE and count < 100) or count == 0:
        step()
        count += 1
    return spent / count * 1e3


def _times(other: float, ours: float) -> str:
    return f"{other / ours:,.1f} × the quadtree's time" if ours > 0 else ""
