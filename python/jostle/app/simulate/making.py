"""New simulations of very many particles, made by a worker thread while the old one is shown."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass

from jostle.app.simulate import engine
from jostle.app.simulate.engine import REFUSALS, Then, sentence
from jostle.app.simulate.settings import Settings
from jostle.app.simulate.simulation import Frame, Simulation, Wants

Create = Callable[[], Simulation]


@dataclass(frozen=True)
class Made:
    """A simulation in its first state, with all that its session needs of it."""

    simulation: Simulation
    frame: Frame
    state: bytes


class Maker:
    """Makes one simulation at a time.

    Attributes
    ----------
    settings
        Of the one that is being made; None while there is none, or a file tells them.
    notice
        What to say meanwhile; empty while nothing is made.
    """

    def __init__(self) -> None:
        self.settings: Settings | None = None
        self.notice = ""
        self._then: Then | None = None
        self._worker: ThreadPoolExecutor | None = None
        self._job: Future[Made] | None = None

    def start(
        self,
        create: Create,
        wants: Wants,
        notice: str,
        settings: Settings | None = None,
        then: Then | None = None,
    ) -> None:
        """Begin to make a simulation; one that is under way is given up.

        `then` is what its session does after taking it.
        """
        self.give_up()
        if self._worker is None:
            self._worker = ThreadPoolExecutor(1, "jostle-make")
        self.settings, self.notice, self._then = settings, notice, then
        self._job = self._worker.submit(made, create, wants)

    def give_up(self) -> None:
        """Forget what is under way; it ends by itself."""
        job = self._job
        if self._worker is not None and job is not None and not (job.done() or job.cancel()):
            self._worker.shutdown(wait=False)
            self._worker = None
        self._job = self.settings = self._then = None
        self.notice = ""

    def take(self) -> tuple[Made, Then | None] | str | None:
        """Return what has been made, or why it was refused, once; None if there is nothing yet."""
        if self._job is None or not self._job.done():
            return None
        job, then = self._job, self._then
        self.give_up()
        try:
            return job.result(), then
        except REFUSALS as error:
            return sentence(error)

    def wait(self) -> None:
        """Wait until what is under way can be taken."""
        if self._job is not None:
            self._job.exception()


def made(create: Create, wants: Wants) -> Made:
    """Make a simulation at once."""
    simulation = create()
    return Made(simulation, simulation.frame(wants), simulation.save())


def expected(settings: Settings) -> int:
    """Return how many particles settings ask for, as far as they say; scenes' own are few."""
    return (settings.n or 0) + sum(group.count for group in settings.particles)


def is_long(settings: Settings) -> bool:
    """Tell whether to make it would hold up the window."""
    return expected(settings) > engine.FEW
