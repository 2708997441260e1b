"""Rewinding and undo: snapshots of the last 30 s, and of the states before edits.

A *moment* is the state after a step. Some moments have a snapshot; the others are re-simulated
from the snapshot before them, which gives the same bits. After an edit by the user that is not
possible, so these moments have a snapshot or are not stored. Undo is independent of moments.
"""

import time
from bisect import bisect_right
from dataclasses import dataclass, field

from jostle_lab.simulate.simulation import Simulation

SECONDS = 30.0
BUDGET = 256 * 2**20  # bytes of snapshots
UNDO_BUDGET = 128 * 2**20  # bytes of the states before edits
ONE_EDIT = 1.0  # seconds; edits of the same key with shorter pauses are one
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

    def present(self, simulation: Simulation) -> bytes:
        """Return the present state; it is not copied again if this moment has a snapshot."""
        known = None if self._changed or self._adrift else self.moments[self.at].state
        return simulation.save() if known is None else known

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


@dataclass
class Undo:
    """The states before the edits of the user, and those that undo has left.

    Edits with the same key and short pauses, such as those of a slider or of a drag, are one.
    """

    past: list[bytes] = field(default_factory=list)
    future: list[bytes] = field(default_factory=list)
    edits: int = 0  # that were ever recorded, undone or redone: whether a file is up to date
    _last: tuple[str, float] = "", 0.0  # key and time of the last edit

    def copy(self) -> "Undo":
        return Undo([*self.past], [*self.future], self.edits)

    def record(self, key: str, simulation: Simulation, history: History | None = None) -> None:
        """Store the state before an edit; states beyond the budget are dropped, oldest first."""
        now = time.perf_counter()
        last, then = self._last
        self._last = key, now
        if key and key == last and now - then < ONE_EDIT:
            return
        self.past.append(history.present(simulation) if history else simulation.save())
        while len(self.past) > 1 and sum(map(len, self.past)) > UNDO_BUDGET:
            del self.past[0]
        self.future.clear()
        self.edits += 1

    def undo(self, simulation: Simulation, history: History) -> str:
        """Restore the state before the last edit; return a message."""
        return self._move(simulation, history, self.past, self.future, "undo")

    def redo(self, simulation: Simulation, history: History) -> str:
        """Restore the state that the last undo has left; return a message."""
        return self._move(simulation, history, self.future, self.past, "redo")

    def _move(
        self, simulation: Simulation, history: History, source: list[bytes], to: list[bytes],
        what: str,
    ) -> str:  # fmt: skip
        if not source:
            return f"There is nothing to {what}."
        to.append(history.present(simulation))
        history.touch()
        simulation.load(source.pop())
        self._last, self.edits = ("", 0.0), self.edits + 1
        return f"{what.capitalize()}: {len(source)} more"
