"""The run without a window: a video with numbers, a picture of its end, and a table after it."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import pygame
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

import jostle
from jostle import record
from jostle_lab import interrupt
from jostle_lab.draw import text
from jostle_lab.draw.camera import Camera, Size
from jostle_lab.draw.painter import Painter
from jostle_lab.draw.palette import ACCENT, PANEL_EDGE, TEXT_SOFT
from jostle_lab.draw.picture import Picture
from jostle_lab.draw.software import SoftwarePainter
from jostle_lab.draw.view_options import TreeView, ViewOptions
from jostle_lab.race import article_of
from jostle_lab.schema import METHODS
from jostle_lab.simulate.engine import Engine
from jostle_lab.simulate.simulation import Simulation
from jostle_lab.storage.files import free_name
from jostle_lab.storage.recording import pixels

SIZE = (1280, 720)
FRAME_RATE = 30
DEFAULT_SECONDS = 10
# The panel of numbers, in pixels
WIDTH = 248
EDGE = 12  # pixels between the panel and the edge of the screen
SPACE = WIDTH + 2 * EDGE  # margin of the scene
PAD = 14
RULE = 11  # the height of a line between two parts
BAR = 44  # length of the longest bar of a stage
SMOOTH = 0.1  # weight of a new measurement
EVERY = 0.2  # seconds between updates


class Readout:
    """Collects measurements every frame, and redraws its panel a few times per second."""

    def __init__(self) -> None:
        self._times: dict[str, float] = {}
        self._sheet: pygame.Surface | None = None
        self._due = 0.0

    def measure(self, **milliseconds: float) -> None:
        """Add one measurement for each named stage."""
        for stage, value in milliseconds.items():
            shown = self._times.get(stage, value)
            self._times[stage] = shown + SMOOTH * (value - shown)

    def draw(self, painter: Painter, engine: Engine, rate: float, now: float) -> None:
        """Draw the panel; `rate` is the number of steps per second."""
        if self._sheet is None or now >= self._due:
            self._sheet, self._due = self._draw(engine, rate), now + EVERY
        painter.sheet(self._sheet, (EDGE, EDGE))

    def _draw(self, engine: Engine, rate: float) -> pygame.Surface:
        facts, n = engine.frame.stats, len(engine.frame)
        every_pair, longest = text.pairs_of(n), max(self._times.values(), default=0.0) or 1.0
        # Drawing is last, in the order of work.
        stages = sorted(self._times.items(), key=lambda entry: entry[0] == "draw")
        parts = [
            [(engine.scene, METHODS[engine.settings.method]), ("particles", f"{n:,}")],
            [("steps/s", f"{rate:,.0f}" if rate else "–")],
            [("stage", "ms per step"), *((name, f"{ms:.2f}") for name, ms in stages)],
            [
                ("pairs tested", f"{facts.pairs_tested:,}"),
                ("of n(n−1)/2", f"{every_pair:,}"),
                ("tested, % of all pairs", text.share(facts.pairs_tested, every_pair)),
                ("touching", f"{facts.touching:,}"),
                ("asleep", f"{facts.asleep:,}"),
                ("kinetic energy", text.scientific(facts.kinetic_energy)),
            ],
        ]
        line = text.font(text.BODY).get_linesize() + 3
        height = sum(len(part) * line + RULE for part in parts) - RULE
        sheet, y, right = text.panel((WIDTH, 2 * PAD + height)), PAD, WIDTH - PAD
        for part in parts:
            if y > PAD:
                pygame.draw.line(sheet, PANEL_EDGE, (PAD, y + 4), (right, y + 4))
                y += RULE
            for name, value in part:
                text.write(sheet, (PAD, y), name, TEXT_SOFT)
                text.write(sheet, (right, y), value, flush_right=True)
                if name in self._times:
                    length = max(round(BAR * self._times[name] / longest), 1)
                    pygame.draw.rect(
                        sheet, ACCENT, (right - 62 - BAR, y + line // 2 - 3, length, 4)
                    )
                y += line
        return sheet


@dataclass(frozen=True)
class Film:
    """The result of a run without a window."""

    video: Path
    still: Path
    steps: int
    frames: int
    step_seconds: float  # spent in the simulation alone


def default_steps(simulation: Simulation) -> int:
    """Return the number of steps of a ten-second video."""
    return round(DEFAULT_SECONDS / simulation.time_step)


def make_film(
    simulation: Simulation,
    steps: int,
    out: Path,
    console: Console,
    size: Size = SIZE,
    options: ViewOptions | None = None,
) -> Film:
    """Step the simulation, record 30 frames per second, and save the last one.

    The files in the folder `out` are named after the scene and the method, with a number if the
    name exists. Without `options` the tree is drawn in the second half only.
    """
    settings = simulation.settings
    scene, method = settings.scene, settings.method
    stem = scene if method == "quadtree" else f"{scene}-{method}"
    name = free_name(out, stem, ".mp4", ".png")
    video, still = out / f"{name}.mp4", out / f"{name}.png"
    engine, painter = Engine(simulation, synchronous=True), SoftwarePainter(size)
    changing, options = options is None, options or ViewOptions()
    camera, picture, readout = Camera(size, simulation.view, left=SPACE), Picture(), Readout()
    stride = max(round(1 / FRAME_RATE / simulation.time_step), 1)
    spent = 0.0

    def draw(step: int, now: float) -> None:
        if changing:
            options.tree = TreeView.OUTLINE if step > steps // 2 else TreeView.OFF
        if engine.request != picture.request(options):
            engine.request = picture.request(options)
            engine.refresh()
        start = time.perf_counter()
        picture.draw(painter, engine.frame, camera, options)
        readout.draw(painter, engine, step / spent if spent else 0.0, now)
        readout.measure(draw=(time.perf_counter() - start) * 1e3)

    with record.Film(video, size, FRAME_RATE) as recorder, Progress(console=console) as progress:
        task = progress.add_task(f"recording {name}, {steps:,} steps", total=steps)
        for step in range(steps + 1):
            interrupt.check()
            if step:
                engine.step()
                spent += engine.last_seconds
                readout.measure(**engine.frame.stats.stage_times)
                progress.advance(task)
            if step % stride == 0:
                draw(step, step * simulation.time_step)
                recorder.add(pixels(painter.canvas()))
    draw(steps, now=math.inf)  # the numbers of the last step, as in the table
    record.write_png(still, pixels(painter.canvas()))
    return Film(video, still, steps, recorder.frames, spent)


# The table

PATIENCE = 1.0  # seconds of measuring for each method
LIMITS = {"brute": 20_000, "article": 10_000}  # particles; with more a method is not timed
METHODS_TIMED = {
    "quadtree": "quadtree, per step",
    "brute": "brute force, per step",
    "article": "article's tree, per frame",
}


def film_report(simulation: Simulation, film: Film) -> Table:
    """Return the numbers of the film, and the times of all methods at its last state.

    This steps `simulation`.
    """
    settings, n, state = simulation.settings, len(simulation), simulation.frame()
    facts, every_pair, world = state.stats, text.pairs_of(n), simulation.world
    world.sleeping = False  # the time of a step in which all are awake
    table = Table(title=f"{settings.scene}, {METHODS[settings.method]}", title_style="bold")
    table.show_header = False
    table.add_column()
    table.add_column(justify="right")
    table.add_column(style="dim")
    part = f"{text.share(facts.pairs_tested, every_pair)} of n(n−1)/2 = {every_pair:,}"
    table.add_row("particles", f"{n:,}")
    table.add_row("steps", f"{film.steps:,}", text.plural(film.frames, "frame"))
    table.add_row("steps/s", f"{film.steps / film.step_seconds:,.0f}", "while recording")
    table.add_row("pairs tested", f"{facts.pairs_tested:,}", part)
    table.add_row("touching", f"{facts.touching:,}", "pairs, in the last step")
    if facts.asleep:
        table.add_row("asleep", f"{facts.asleep:,}", "awake for the times of this table")
    table.add_section()
    saved, ours = world.snapshot(), 0.0
    for method, name in METHODS_TIMED.items() if every_pair else ():
        if n > LIMITS.get(method, n):
            table.add_row(name, "–", f"not timed with more than {LIMITS[method]:,} particles")
            continue
        if method == "article":
            took = _milliseconds(article_of(state, simulation.view, "quadtree").frame)
        else:
            world = jostle.World.restore(saved)
            world.method = method  # type: ignore[assignment]
            took = _milliseconds(partial(world.step, simulation.time_step))
        ours = ours or took
        remark = f"{took / ours:,.1f} ×" if method != "quadtree" else f"{1e3 / took:,.0f} steps/s"
        table.add_row(name, _ms(took), remark + ", in plain Python" * (method == "article"))
    if not every_pair:
        table.add_row("methods", "–", "no pairs, so nothing to compare")
    return table


def _milliseconds(step: Callable[[], object]) -> float:
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
