"""The run without a window: a video of the scene, and a picture of its last frame."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from jostle import interrupt
from jostle.app.draw.camera import Camera, Size
from jostle.app.draw.formatting import video_name
from jostle.app.draw.picture import Picture
from jostle.app.draw.readout import SPACE, Readout
from jostle.app.draw.software import SoftwarePainter
from jostle.app.draw.view_options import TreeView, ViewOptions
from jostle.app.simulate.engine import Engine
from jostle.app.simulate.simulation import Simulation
from jostle.app.storage.paths import free_name
from jostle.app.storage.video_writer import VideoWriter, save_png

SIZE = (1280, 720)
FRAME_RATE = 30
DEFAULT_SECONDS = 10


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

    Parameters
    ----------
    simulation
        Recorded from its present state.
    steps
        Number of steps.
    out
        An existing folder; the files are named after the scene and the method. A number is
        added to the name if the file exists.
    console
        Output of the progress bar.
    size
        Size of the video in pixels.
    options
        What to draw; if None, the tree is drawn in the second half only.
    """
    name = free_name(out, video_name(simulation.scene, simulation.method), ".mp4", ".png")
    video, still = out / f"{name}.mp4", out / f"{name}.png"
    engine, painter = Engine(simulation, synchronous=True), SoftwarePainter(size)
    changing, options = options is None, options or ViewOptions()
    camera, picture, readout = Camera(size, simulation.view, left=SPACE), Picture(), Readout()
    stride = max(round(1 / FRAME_RATE / simulation.time_step), 1)
    spent, frames = 0.0, 0

    def draw(step: int, now: float) -> None:
        if changing:
            options.tree = TreeView.OUTLINE if step > steps // 2 else TreeView.OFF
        if engine.request != picture.request(options):
            engine.request = picture.request(options)
            engine.refresh()
        start = time.perf_counter()
        picture.draw(painter, engine.frame, camera, options)
        rate = step / spent if spent else None
        readout.draw(painter, engine, rate, now)
        readout.measure(draw=(time.perf_counter() - start) * 1e3)

    with VideoWriter(video, size, FRAME_RATE) as recorder, _progress(console) as progress:
        task = progress.add_task(f"recording {name}", total=steps)
        for step in range(steps + 1):
            interrupt.check()
            if step:
                engine.step()
                spent += engine.last_seconds
                readout.measure(**engine.frame.stats.stage_times)
                progress.advance(task)
            if step % stride == 0:
                draw(step, step * simulation.time_step)
                recorder.add(painter.canvas())
                frames += 1
    draw(steps, now=math.inf)  # the numbers of the last step, as in the table
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
