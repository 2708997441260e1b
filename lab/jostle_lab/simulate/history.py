"""Rewinding: snapshots of the last 30 s within a memory budget, and the steps between them.

A *moment* is the state after a step. Some moments have a snapshot; the others are re-simulated
from the snapshot before them, which gives the same bits. After an edit by the user that is not
possible, so these moments have a snapshot or are not stored.
"""

from bisect import bisect_right
from dataclasses import dataclass

from jostle_lab.simulate.simulation import Simulation

SECONDS = 30.0
BUDGET = 256 * 2**20  # bytes of snapshots
MOST_STRIDE = 64  # steps between two snapshots at most
PATIENCE = 0.25  # seconds of re-simulation; beyond, the snapshot before is shown


@dataclass
class Moment:
    """The state after a step."""

    time: float  # simulated seconds since the history began
    free: bool  # whether it can be re-simulated from the moment before: no edit in between
    state: bytes | None = None


class History:
    """Records every step, and restores moments. Only the thread that steps uses it.

    It begins with the present state, and covers `seconds` of simulated time. If the snapshots have
    more than `budget` bytes, only every second, fourth … step has one; if that is not enough, the
    history is shorter.
    """

    def __init__(
        self, simulation: Simulation, *, seconds: float = SECONDS, budget: int = BUDGET
    ) -> None:
        self.seconds, self.budget = seconds, budget
        self.moments: list[Moment] = []  # from the oldest to the latest
        self.at = 0  # index of the present one, unless the simulation has changed since
        self.bytes = 0  # of all snapshots
        self.span = 0.0  # seconds from the oldest to the latest moment
        self.back = 0.0  # seconds from the present to the latest one
        self.stride = 1  # steps between two snapshots
        self._time = 0.0
        self._since = 0  # steps since the last snapshot
        self._changed = False  # by the user, since the last step
        self._adrift = False  # whether moments were omitted since the last stored one
        self._keep(Moment(0.0, False, simulation.save()))
        whole = self.bytes * seconds / simulation.time_step
        while self.stride < MOST_STRIDE and whole > budget * self.stride:
            self.stride *= 2

    @property
    def can_go_back(self) -> bool:
        """Whether there is an earlier moment, or an edit to undo."""
        return self.at > 0 or self._changed

    # Recording

    def touch(self) -> None:
        """Note that the user edits the simulation before its next step."""
        self._drop_future()
        self._changed = True

    def after(self, simulation: Simulation) -> None:
        """Store the moment after a step, with a snapshot if needed."""
        self._drop_future()
        self._time += simulation.time_step
        self._since += 1
        changed, self._changed = self._changed, False
        due = self._since >= self.stride
        if not changed and not self._adrift:
            self._keep(Moment(self._time, True, simulation.save() if due else None))
        elif due or not changed:
            self._keep(Moment(self._time, False, simulation.save()))
        else:  # a long drag must not fill the memory
            self._adrift = True

    # Restoring

    def show(self, simulation: Simulation, index: int, step_seconds: float = 0.0) -> None:
        """Restore a moment; `index` is clamped to the range of `moments`.

        If re-simulation with steps of `step_seconds` would take too long, the snapshot before is
        shown.
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
        """Store the present state, if it is not a moment yet."""
        if self._changed or self._adrift:
            self._keep(Moment(self._time, False, simulation.save()))
            self._changed = False

    def index_of(self, seconds_ago: float) -> int:
        """Return the last moment at least `seconds_ago` before the latest."""
        latest = self.moments[-1].time - seconds_ago + 1e-9
        return max(bisect_right(self.moments, latest, key=lambda moment: moment.time) - 1, 0)

    # Memory

    def _keep(self, moment: Moment) -> None:
        self.moments.append(moment)
        if moment.state is not None:
            self.bytes += len(moment.state)
            self._since, self._adrift = 0, False
        self._trim()

    def _trim(self) -> None:
        """Remove moments that are too old or exceed the budget."""
        end = self._first_part()
        while end and self.moments[-1].time - self.moments[end].time >= self.seconds:
            self._drop(0, end)
            end = self._first_part()
        while self.bytes > self.budget and (end := self._first_part()):
            if self.stride >= MOST_STRIDE or not self._thin():
                self._drop(0, end)
        self._go(len(self.moments) - 1)

    def _first_part(self) -> int:
        """Return the index of the second snapshot; 0 if there is none."""
        for index in range(1, len(self.moments)):
            if self.moments[index].state is not None:
                return index
        return 0

    def _thin(self) -> bool:
        """Remove every second of the snapshots that can be re-simulated."""
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

    def _go(self, index: int) -> None:
        self.at = index
        self.span = self.moments[-1].time - self.moments[0].time
        self.back = self.moments[-1].time - self.moments[index].time
