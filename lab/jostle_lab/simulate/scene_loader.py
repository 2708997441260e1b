"""New simulations, made on a worker thread while the present one is shown."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from functools import partial

from jostle_lab.simulate.engine import REFUSALS, Then, message_of
from jostle_lab.simulate.frame import Frame, FrameRequest
from jostle_lab.simulate.settings import Settings
from jostle_lab.simulate.simulation import Simulation
from jostle_lab.simulate.worker import Worker

Create = Callable[[], Simulation]

MESSAGE_DELAY = 0.3  # seconds after which a message is shown


@dataclass(frozen=True)
class LoadedScene:
    """A simulation in its initial state, with its first frame and its state as bytes."""

    simulation: Simulation
    frame: Frame
    state: bytes


class SceneLoader:
    """Makes one simulation at a time."""

    def __init__(self, *, synchronous: bool = False) -> None:
        # Those of the simulation in progress, unless it is read from a file.
        self.settings: Settings | None = None
        self._message, self._began = "", 0.0
        self._then: Then | None = None
        self._worker = Worker("jostle-load", synchronous=synchronous)
        self._job: Future[LoadedScene] | None = None

    @property
    def message(self) -> str:
        """Return the message to show meanwhile, or an empty string."""
        late = time.perf_counter() - self._began >= MESSAGE_DELAY
        return self._message if self._job is not None and late else ""

    def start(
        self,
        create: Create,
        request: FrameRequest,
        message: str,
        settings: Settings | None = None,
        then: Then | None = None,
    ) -> None:
        """Begin to make a simulation; one in progress is cancelled.

        `then` is called after it has replaced the present one.
        """
        self.cancel()
        self.settings, self._then = settings, then
        self._message, self._began = message, time.perf_counter()
        self._job = self._worker.submit(partial(load, create, request))

    def cancel(self) -> None:
        """Discard the simulation in progress; its thread ends by itself."""
        if self._job is not None and not (self._job.done() or self._job.cancel()):
            self._worker.abandon()
        self._job = self.settings = self._then = None

    def take(self) -> tuple[LoadedScene, Then | None] | str | None:
        """Return a finished simulation, or an error message, once; None if there is none."""
        if self._job is None or not self._job.done():
            return None
        job, then = self._job, self._then
        self.cancel()
        try:
            return job.result(), then
        except REFUSALS as error:
            return message_of(error)

    def wait(self) -> None:
        if self._job is not None:
            self._job.exception()


def load(create: Create, request: FrameRequest) -> LoadedScene:
    simulation = create()
    return LoadedScene(simulation, simulation.frame(request), simulation.save())


def expected(settings: Settings) -> int:
    """Return the number of particles that the settings name; the defaults of scenes are small."""
    return (settings.n or 0) + sum(group.count for group in settings.particles)
