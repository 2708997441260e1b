"""The history of the last half minute: snapshots within a budget of memory, and the steps between.

A *moment* is the state after a step. Some moments hold a snapshot; the others are made again from
the snapshot before them, which gives the same bits, unless a person has acted in between. Moments
that could not be made again are not kept at all, so what is shown has really been.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass

from jostle.app.simulate.simulation import Simulation

SECONDS = 30.0
BUDGET = 256 * 2**20  # bytes of snapshots
MOST_STRIDE = 64  # steps between two snapshots; more would take too long to make again
PATIENCE = 0.25  # seconds of making steps again; beyond, the snapshot before is shown


@dataclass
class Moment:
    """The state after a step."""

    time: float  # simulated seconds since the history began
    free: bool  # whether it follows from the moment before, with no act of a person between
    state: bytes | None = None


class History:
    """Takes note of every step, and brings moments back. The thread that steps uses it.

    Parameters
    ----------
    seconds
        How far it reaches back, in simulated time.
    budget
        Bytes that its snapshots may take. Where they would be more, only every second, fourth …
        step has one; where that is not enough, it does not reach back so far.

    Attributes
    ----------
    moments
        From the oldest to the youngest.
    at
        Which of them the simulation is at, unless it has changed since.
    span, back
        Seconds from the oldest to the youngest moment, and from there back to the present one.
    stride
        Steps between two snapshots.
    bytes
        Of all snapshots.
    """

    def __init__(self, seconds: float = SECONDS, budget: int = BUDGET) -> None:
        self.seconds, self.budget = seconds, budget
        self.moments: list[Moment] = []
        self._changed = False
        self.at = self.bytes = 0
        self.span = self.back = 0.0
        self.stride = 1

    def restart(self, simulation: Simulation, state: bytes | None = None) -> None:
        """Forget everything, and begin with the present state, which may be saved already."""
        self.moments, self.bytes, self.stride, self._time = [], 0, 1, 0.0
        self._changed = False  # since the last step, by a person
        self._adrift = False  # whether moments were left out since the last one kept
        self._keep(Moment(0.0, False, state or simulation.save()))
        whole = self.bytes * self.seconds / simulation.time_step
        while self.stride < MOST_STRIDE and whole > self.budget * self.stride:
            self.stride *= 2
        self._since = 0  # steps since the last snapshot

    @property
    def can_go_back(self) -> bool:
        """Whether there is a moment before this one, or an act to be undone."""
        return self.at > 0 or self._changed

    # Taking note

    def touch(self, simulation: Simulation | None = None) -> None:
        """Know that a person acts on the simulation before its next step."""
        self._drop_future()
        self._changed = True

    def after(self, simulation: Simulation) -> None:
        """After a step: keep the moment, with its snapshot, or without if it can do without."""
        self._drop_future()
        self._time += simulation.time_step
        self._since += 1
        changed, self._changed = self._changed, False
        due = self._since >= self.stride
        if not changed and not self._adrift:
            self._keep(Moment(self._time, True, simulation.save() if due else None))
        elif due or not changed:
            self._keep(Moment(self._time, False, simulation.save()))
        else:  # a hand that holds on for seconds does not fill the memory
            self._adrift = True

    # Going back

    def show(self, simulation: Simulation, index: int, step_seconds: float = 0.0) -> None:
        """Bring a moment back.

        Parameters
        ----------
        index
            In `moments`; what lies beyond is taken to the nearest end.
        step_seconds
            What a step takes; where making the moment again would take too long, the nearest
            snapshot before it is shown.
        """
        self.hold(simulation)
        index = min(max(index, 0), len(self.moments) - 1)
        base = index
        while (state := self.moments[base].state) is None:
            base -= 1
        if (index - base) * step_seconds > PATIENCE:
            index = base
        simulation.load(state)
        for _ in range(index - base):
            simulation.step()
        self._time, self._since = self.moments[index].time, self.stride
        self._go(index)

    def hold(self, simulation: Simulation) -> None:
        """Keep the present state, if no moment is like it."""
        if self._changed or self._adrift:
            self._keep(Moment(self._time, False, simulation.save()))
            self._changed = False

    def index_of(self, seconds_ago: float) -> int:
        """Return the last moment that is at least so long before the youngest."""
        times = [moment.time for moment in self.moments]
        return max(bisect_right(times, times[-1] - seconds_ago + 1e-9) - 1, 0)

    # Memory

    def _keep(self, moment: Moment) -> None:
        self.moments.append(moment)
        if moment.state is not None:
            self.bytes += len(moment.state)
            self._since, self._adrift = 0, False
        self._at_last()
        self._trim()

    def _trim(self) -> None:
        """Let go of what is too old, and of what is too much."""
        end = self._first_part()
        while end and self.moments[-1].time - self.moments[end].time >= self.seconds:
            self._drop(0, end)
            end = self._first_part()
        while self.bytes > self.budget and (end := self._first_part()):
            if self.stride >= MOST_STRIDE or not self._thin():
                self._drop(0, end)
        self._at_last()

    def _first_part(self) -> int:
        """Return where the second snapshot is; 0 if there is none."""
        for index in range(1, len(self.moments)):
            if self.moments[index].state is not None:
                return index
        return 0

    def _thin(self) -> bool:
        """Take their snapshots from every second of those that can do without."""
        kept = dropped = 0
        for moment in self.moments[:-1]:
            if moment.state is None:
                continue
            if moment.free and kept > dropped:
                self.bytes -= len(moment.state)
                moment.state = None
                dropped += 1
            else:
                kept += 1
        self.stride *= 2
        return dropped > 0

    def _drop_future(self) -> None:
        self._drop(self.at + 1, len(self.moments))

    def _drop(self, begin: int, end: int) -> None:
        self.bytes -= sum(len(moment.state or b"") for moment in self.moments[begin:end])
        del self.moments[begin:end]

    def _at_last(self) -> None:
        self._go(len(self.moments) - 1)

    def _go(self, index: int) -> None:
        self.at = index
        self.span = self.moments[-1].time - self.moments[0].time
        self.back = self.moments[-1].time - self.moments[index].time
