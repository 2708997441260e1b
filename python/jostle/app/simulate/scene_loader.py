"""New simulations, made on a worker thread while the present one is shown."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass

from jostle.app.simulate import engine
from jostle.app.simulate.engine import REFUSALS, Then, message_of
from jostle.app.simulate.settings import Settings
from jostle.app.simulate.simulation import Frame, FrameRequest, Simulation

Create = Callable[[], Simulation]


@dataclass(frozen=True)
class LoadedScene:
    """A simulation in its initial state, with its first frame."""

    simulation: Simulation
    frame: Frame
    state: bytes


class SceneLoader:
    """Makes one simulation at a time.

    Attributes
    ----------
    settings
        Of the simulation in progress; None if there is none, or if it is read from a file.
    message
        To show meanwhile; empty if there is none.
    """

    def __init__(self) -> None:
        self.settings: Settings | None = None
        self.message = ""
        self._then: Then | None = None
        self._worker: ThreadPoolExecutor | None = None
        self._job: Future[LoadedScene] | None = None

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
        if self._worker is None:
            self._worker = ThreadPoolExecutor(1, "jostle-make")
        self.settings, self.message, self._then = settings, message, then
        self._job = self._worker.submit(load, create, request)

    def cancel(self) -> None:
        """Discard the simulation in progress; its thread ends by itself."""
        job = self._job
        if self._worker is not None and job is not None and not (job.done() or job.cancel()):
            self._worker.shutdown(wait=False)
            self._worker = None
        self._job = self.settings = self._then = None
        self.message = ""

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
        """Wait for the simulation in progress."""
        if self._job is not None:
            self._job.exception()


def load(create: Create, request: FrameRequest) -> LoadedScene:
    """Make a simulation and its first frame."""
    simulation = create()
    return LoadedScene(simulation, simulation.frame(request), simulation.save())


def expected(settings: Settings) -> int:
    """Return the number of particles that the settings name; the defaults of scenes are small."""
    return (settings.n or 0) + sum(group.count for group in settings.particles)


def is_long(settings: Settings) -> bool:
    """Return whether making it would block the window."""
    return expected(settings) > engine.FEW
