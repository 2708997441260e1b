"""The run over ranks: steps, a video, checkpoints, and one progress bar."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mpi4py import MPI
from rich.console import Console

import jostle.mpi
from jostle._core import create_scene_part
from jostle.mpi.exchange import together
from jostle.mpi.interrupts import held
from jostle.mpi.scenes import part_of
from jostle_lab import interrupt
from jostle_lab.draw.camera import Size
from jostle_lab.draw.text import SMALL, TITLE, plural, scientific
from jostle_lab.headless import (
    DEFAULT_SECONDS,
    EDGE,
    FRAME_RATE,
    SPACE,
    Row,
    progress_bar,
    sheet_of,
)
from jostle_lab.simulate.containers import bounds
from jostle_lab.simulate.frame import Rect
from jostle_lab.simulate.settings import Settings
from jostle_lab.simulate.simulation import TIME_STEP, Simulation
from jostle_lab.simulate.start import start
from jostle_lab.storage.encoder import Encoder, write_png
from jostle_lab.storage.exports import free_name
from ranks_old.composite import Composite
from ranks_old.stages import StageTimes, report

PATIENCE = 20.0  # seconds from the error of one rank until all have ended
DEFAULT_STEPS = round(DEFAULT_SECONDS / TIME_STEP)


@dataclass(frozen=True)
class Plan:
    """What to run."""

    settings: Settings
    steps: int  # from the beginning of the scene, those of an earlier run included
    out: Path
    checkpoint: int | None  # steps between checkpoints
    resume: Path | None  # the checkpoint to continue
    size: Size


class Stopped(Exception):
    """Ctrl-C was pressed; the message says what there is."""


def run(comm: MPI.Intracomm, plan: Plan, console: Console) -> None:
    """Run a scene on all ranks; the first writes the video and prints.

    Raises `Stopped` on all ranks after Ctrl-C, and `RankError` on those that did not fail
    themselves.
    """
    # All ranks handle signals at the same place, so that none waits for another.
    with interrupt.raised(), held() as run_handlers:
        world, view = _world(comm, plan)
        film = _Film(comm, plan, world, _name_of(comm, plan, world), view)
        try:
            with film:
                film.steps(world, console, run_handlers)
        except BaseException as error:
            if isinstance(error, KeyboardInterrupt) or "KeyboardInterrupt" in str(error):
                raise Stopped(film.remains()) from None
            raise
        table = report(comm, film.title, world, film.times)
    if comm.rank == 0:
        console.print(table)
        console.print(film.written(), highlight=False, soft_wrap=True)


def leave_together(comm: MPI.Intracomm) -> None:
    """Wait until all ranks end, so that the launcher ends none of them before it has printed.

    Ranks that wait for another one in a call are ended.
    """
    request, limit = comm.Ibarrier(), time.monotonic() + PATIENCE
    while not request.Test():
        if time.monotonic() > limit:
            comm.Abort(1)
        time.sleep(0.01)


def _steps_of(world: jostle.mpi.World) -> int:
    """Return the number of steps that a world has made."""
    return round(world.time / TIME_STEP)


def _name_of(comm: MPI.Intracomm, plan: Plan, world: jostle.mpi.World) -> str:
    """Return the name of the video and the picture; refuse a run that is complete."""
    name = ""
    with together(comm):
        done = _steps_of(world)
        if done >= plan.steps:
            raise ValueError(f"steps is {plan.steps}, and {plan.resume} has {done} already")
        if comm.rank == 0:
            plan.out.mkdir(parents=True, exist_ok=True)
            name = free_name(plan.out, plan.settings.scene, ".mp4", ".png")
    return str(comm.bcast(name))


def _world(comm: MPI.Intracomm, plan: Plan) -> tuple[jostle.mpi.World, Rect]:
    """Return the world and the part of the plane that is drawn."""
    settings, threads = plan.settings, plan.settings.threads or 1
    if plan.resume is not None:
        world = jostle.mpi.World.load(comm, plan.resume, threads=threads)
        view = jostle.scenes.view(settings.scene, settings.n or world.total)
        if settings.world_size != 1.0 or settings.container is not None:
            view = bounds(world.container) or view
        return world, view
    view = jostle.scenes.view(settings.scene, settings.n)

    def part(rank: int, size: int) -> Any:
        nonlocal view
        if settings.particles:  # their positions depend on all others
            whole: Any = start(settings)
            core, view = part_of(whole.world, rank, size), whole.view
        else:
            own = create_scene_part(settings.scene, settings.n, settings.seed, rank, size)
            simulation = Simulation(settings, view, own)
            simulation.add_own_walls(settings.walls)
            core, view = simulation.world, simulation.view
        core.threads = threads
        return core

    return jostle.mpi.World.of_parts(comm, part), view


class _Film:
    """The video of a run; only rank 0 has an encoder and a progress bar."""

    def __init__(
        self, comm: MPI.Intracomm, plan: Plan, world: jostle.mpi.World, name: str, view: Rect
    ) -> None:
        self._comm, self._plan, self._name = comm, plan, name
        self._video, self._still = plan.out / f"{name}.mp4", plan.out / f"{name}.png"
        self._checkpoint = plan.out / f"{plan.settings.scene}.checkpoint"
        self._composite = Composite(comm, plan.size, view, left=SPACE)
        self._stack = contextlib.ExitStack()
        self._recorder: Encoder | None = None
        self.times = StageTimes(world)
        self.title = f"{plan.settings.scene}, {plural(comm.size, 'rank')}"
        self._saved: int | None = None  # the steps that the last checkpoint has

    def __enter__(self) -> _Film:
        with together(self._comm):
            if self._comm.rank == 0:
                encoder = Encoder(self._video, self._plan.size, FRAME_RATE)
                self._recorder = self._stack.enter_context(encoder)
        return self

    def __exit__(self, *error: Any) -> None:
        self._stack.__exit__(*error)

    def remains(self) -> str:
        """Return what there is after the run has been stopped."""
        if self._saved is None:
            return f"Stopped. The video so far, if any, is in {self._plan.out}."
        return f"Stopped. {self._checkpoint} has the state after {plural(self._saved, 'step')}."

    def written(self) -> str:
        """Return the files of a complete run."""
        lines = [f"video       {self._video}", f"picture     {self._still}"]
        if self._saved is not None:
            lines.append(f"checkpoint  {self._checkpoint}, after {plural(self._saved, 'step')}")
        return "\n".join(lines)

    def steps(
        self, world: jostle.mpi.World, console: Console, run_handlers: Callable[[], None]
    ) -> None:
        """Make all steps after those that are done."""
        plan, done = self._plan, _steps_of(world)
        stride = max(round(1 / FRAME_RATE / TIME_STEP), 1)
        with self._progress(console, done) as advance:
            for step in range(done, plan.steps + 1):
                if step > done:
                    start = time.perf_counter()
                    world.step(TIME_STEP)
                    self.times.add(time.perf_counter() - start)
                    advance()
                if step % stride == 0 or step == plan.steps:
                    self._draw(world, step, records=step % stride == 0)
                if plan.checkpoint and step > done and step % plan.checkpoint == 0:
                    world.save(self._checkpoint)
                    self._saved = step
                with together(self._comm):
                    run_handlers()

    @contextlib.contextmanager
    def _progress(self, console: Console, done: int) -> Iterator[Any]:
        if self._comm.rank > 0:
            yield lambda: None
            return
        with progress_bar(console) as progress:
            task = progress.add_task(
                f"recording {self._name}", total=self._plan.steps, completed=done
            )
            yield lambda: progress.advance(task)

    def _draw(self, world: jostle.mpi.World, step: int, records: bool) -> None:
        self._composite.draw(world)
        rows = self._rows(world)
        with together(self._comm):
            if self._recorder is not None:
                painter = self._composite.painter
                painter.sheet(sheet_of(rows), (EDGE, EDGE))
                if records:
                    self._recorder.draw(painter.canvas())
                if step == self._plan.steps:
                    write_png(painter.canvas(), self._still)

    def _rows(self, world: jostle.mpi.World) -> list[Row | None]:
        """Return the lines of the panel of numbers."""
        spans = self.times.of_ranks(self._comm)
        longest = max((span.mean for span in spans.values()), default=0.0) or 1.0
        rate = self.times.rate
        return [
            Row(self._plan.settings.scene, size=TITLE),
            Row(f"{world.total:,} particles · {plural(self._comm.size, 'rank')}"),
            None,
            Row("steps/s", "–" if rate is None else f"{rate:,.1f}"),
            None,
            Row("mean of ranks", "ms per step", SMALL),
            *(
                Row(name.split(",")[0], f"{span.mean:.2f}", bar=span.mean / longest)
                for name, span in spans.items()
            ),
            None,
            Row("time", f"{world.time:.2f} s"),
            Row("kinetic energy", scientific(world.kinetic_energy)),
        ]
