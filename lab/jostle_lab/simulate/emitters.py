"""Emitters that add particles to a world, and a limit above which the oldest are removed."""

import numpy as np
from numpy.typing import NDArray

import jostle
from jostle_lab.simulate.containers import TRIES, in_disc
from jostle_lab.simulate.settings import PARTICLES
from jostle_lab.simulate.validation import COUNT, Rule, real

Floats = NDArray[np.floating]

# The fractional parts of its multiples are distributed evenly over 0..1.
GOLDEN = 0.6180339887498949
STREAMS = 2 + 2 * TRIES  # random numbers per drop
State = tuple[int, int, float]
_PARTS = PARTICLES, COUNT, real(0, 1)
STATE = Rule(
    "[cap, emitted, debt], two whole numbers and one from 0 to 1",
    lambda value: (
        isinstance(value, list)
        and len(value) == len(_PARTS)
        and all(rule.fits(one) for rule, one in zip(_PARTS, value, strict=True))
    ),
)


class Emitters:
    """The nozzles of the scene `emitters`, with at most `n` drops.

    The drops depend on the seed and on the number of drops so far, not on the lengths of the steps.
    `state` is the whole state.
    """

    def __init__(self, n: int | None = None, seed: int = 0, state: State | None = None) -> None:
        self.cap = jostle.scenes.default_count("emitters") if n is None else n
        self.emitted = 0  # number of drops so far
        self.debt = 0.0  # fraction of the next drop that is due, 0 to 1
        if state is not None:
            self.cap, self.emitted, self.debt = state
        self._seed = seed
        nozzles = jostle.scenes.fountains(n)
        rates = np.array([nozzle.drops_per_second for nozzle in nozzles])
        self._rate = float(rates.sum())
        self._shares = np.cumsum(rates) / max(self._rate, 1e-9)
        self._nozzles = {
            name: np.array([getattr(nozzle, name) for nozzle in nozzles])
            for name in ("position", "velocity", "width", "spread", "radii", "density")
        }

    @property
    def state(self) -> State:
        """Return the state: the cap, `emitted` and `debt`."""
        return self.cap, self.emitted, self.debt

    def step(
        self, world: jostle.World, dt: float, friction: float = 0.0, restitution: float = 1.0
    ) -> NDArray[np.int64] | None:
        """Add the drops of the last `dt` seconds, and remove the oldest above the cap.

        The movable particles of the world are the drops, and the lowest rows are the oldest.
        Returns the removed rows, ascending, as before the call, or None; the new drops are the last
        rows.
        """
        due = self.debt + self._rate * dt
        count = int(due)
        # The first of them is the oldest.
        ages: Floats = (due - np.arange(1, count + 1, dtype=np.float64)) / max(self._rate, 1e-9)
        self.debt = due - count
        count = min(count, self.cap)
        first = self.emitted + len(ages) - count
        self.emitted += len(ages)
        drops = np.flatnonzero(world.movable)
        gone = drops[: max(len(drops) + count - self.cap, 0)]
        if len(gone):
            world.remove(world.ids[gone])
        if count:
            numbers = np.arange(first, first + count)
            columns = self._new(world, numbers, ages[len(ages) - count :])
            world.add(**columns, friction=friction, restitution=restitution)
        return gone if len(gone) else None

    def _new(
        self, world: jostle.World, numbers: NDArray[np.int64], ages: Floats
    ) -> dict[str, Floats]:
        """Return the columns of new drops."""
        across, size, *tries = self._random(numbers)
        nozzle = np.searchsorted(self._shares, (numbers + 0.5) * GOLDEN % 1, side="right")
        nozzle = np.minimum(nozzle, len(self._shares) - 1)
        mine = {name: column[nozzle] for name, column in self._nozzles.items()}
        straight = mine["velocity"]
        sideways = straight[:, ::-1] * (-1, 1) / np.linalg.norm(straight, axis=1, keepdims=True)
        places = mine["position"] + sideways * ((across - 0.5) * mine["width"])[:, None]
        aside = in_disc(np.column_stack(tries).reshape(-1, TRIES, 2))
        velocities = straight + aside * mine["spread"][:, None]
        gravity, age = world.gravity, ages[:, None]
        smallest, largest = mine["radii"].T
        radii = smallest + (largest - smallest) * size
        return {
            "positions": places + velocities * age + gravity * age**2 / 2,
            "radii": radii,
            "velocities": velocities + gravity * age,
            "masses": mine["density"] * radii**2,
        }

    def _random(self, numbers: NDArray[np.int64]) -> Floats:
        """Return numbers in 0..1 that depend only on the seed and the drops' numbers."""
        streams = np.arange(STREAMS, dtype=np.uint64)[:, None]
        keys = np.random.SeedSequence(self._seed).generate_state(1, np.uint64)
        state = keys + numbers.astype(np.uint64) * np.uint64(STREAMS) + streams
        return _mixed(state) / 2.0**64


def _mixed(state: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Mix the bits (SplitMix64)."""
    state = state * np.uint64(0x9E3779B97F4A7C15)
    state = (state ^ state >> np.uint64(30)) * np.uint64(0xBF58476D1CE4E5B9)
    state = (state ^ state >> np.uint64(27)) * np.uint64(0x94D049BB133111EB)
    return state ^ state >> np.uint64(31)
