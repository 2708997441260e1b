"""The run without a screen: the same picture as a film, and a still of its end."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from jostle import interrupt
from jostle.app.draw.camera import Camera, Size
from jostle.app.draw.picture import Picture
from jostle.app.draw.readout import SPACE, Readout
from jostle.app.draw.shown import Shown, TreeView
from jostle.app.draw.software import SoftwarePainter
from jostle.app.draw.words import film_name
from jostle.app.keep.paths import free_name
from jostle.app.keep.recorder import Recorder, save_png
from jostle.app.simulate.engine import Engine
from jostle.app.simulate.simulation import Simulation

SIZE = (1280, 720)
FRAMES_A_SECOND = 30
DEFAULT_SECONDS = 10


@dataclass(frozen=True)
class Film:
    """What a run without a screen leaves behind."""

    video: Path
    still: Path
    steps: int
    frames: int
    step_seconds: float  # spent in the simulation alone


def default_steps(simulation: Simulation) -> int:
    """Return the steps of a ten-second film."""
    return round(DEFAULT_SECONDS / simulation.time_step)


def make_film(
    simulation: Simulation,
    steps: int,
    out: Path,
    console: Console,
    size: Size = SIZE,
    shown: Shown | None = None,
) -> Film:
    """Step the simulation, record every thirtieth of a second, and save the last picture.

    Parameters
    ----------
    simulation
        What to film, from its present state.
    steps
        How many steps to go on by.
    out
        A folder that exists; the files are named for the scene and the method. A number is
        added to the name if there is such a file already.
    console
        Where the progress bar goes.
    size
        Of the film in pixels.
    shown
        What to show; if None, the scene alone first, and the tree over it in the second half.
    """
    name = free_name(out, film_name(simulation.scene, simulation.method), ".mp4", ".png")
    video, still = out / f"{name}.mp4", out / f"{name}.png"
    engine, painter = Engine(simulation), SoftwarePainter(size)
    changing, shown = shown is None, shown or Shown()
    camera, picture, readout = Camera(size, simulation.view, left=SPACE), Picture(), Readout()
    stride = max(round(1 / FRAMES_A_SECOND / simulation.time_step), 1)
    spent, frames = 0.0, 0

    def draw(step: int, now: float) -> None:
        if changing:
            shown.tree = TreeView.OUTLINE if step > steps // 2 else TreeView.OFF
        if engine.wants != picture.wants(shown):
            engine.wants = picture.wants(shown)
            engine.look()
        start = time.perf_counter()
        picture.draw(painter, engine.frame, camera, shown)
        rate = step / spent if spent else None
        readout.draw(painter, engine, ("steps a second", rate), now)
        readout.measure(draw=(time.perf_counter() - start) * 1e3)

    with Recorder(video, size, FRAMES_A_SECOND) as recorder, _progress(console) as progress:
        task = progress.add_task(f"filming {name}", total=steps)
        for step in range(steps + 1):
            interrupt.check()
            if step:
                engine.step()
                spent += engine.last_seconds
                readout.measure(**engine.frame.facts.stage_times)
                progress.advance(task)
            if step % stride == 0:
                draw(step, step * simulation.time_step)
                recorder.add(painter.canvas())
                frames += 1
    draw(steps, now=math.inf)  # so that the numbers are those of the last step, as in the table
    save_png(painter.canvas(), still)
    return Film(video, still, steps, frames, spent)


def _progress(console: Console) -> Progress:
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed:,}/{task.total:,} steps"),
        TimeRemainingColumn(),
        console=console,
    )
