"""Worlds whose particles are distributed over ranks."""

from __future__ import annotations

import hashlib
import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import ArrayLike, NDArray

import jostle

from . import edits, state
from .attributes import Column, Setting
from .events import events_of, new_ids
from .exchange import duplicate_of, first_id, from_all, joined, passed_on, together, totals
from .interrupts import collective, held
from .messages import Messages
from .storage import read, write
from .walls import Walls

#: Share of the last step in the mean time that a rank needs for a particle.
_SMOOTHING = 0.1

#: Settings that must be the same on all ranks.
_SETTINGS = (
    *("gravity", "drag", "container", "period", "walls"),
    *("forces", "on_touch", "substeps", "sleeping", "track_events"),
)


def _bytes_of(setting: object) -> bytes:
    """All of a setting; the text of a long array would be shortened."""
    if isinstance(setting, np.ndarray):
        return repr((setting.shape, setting.dtype)).encode() + setting.tobytes()
    if isinstance(setting, list | tuple):
        return b"".join(map(_bytes_of, setting))
    if isinstance(setting, jostle.Walls):
        columns = setting.get(setting.ids).to_dict()
        return _bytes_of([setting.ids, *columns.values()])
    if isinstance(setting, jostle.PairForce):  # whose repr does not show the table
        return _bytes_of(setting.table) + _bytes_of((setting.cutoff, setting.damping))
    return repr(setting).encode() + b";"


class World:
    """Particles that are distributed over the ranks of a communicator.

    Methods are collective: all ranks call them in the same order. So are `kinetic_energy`,
    `potential_energy`, `momentum`, `events`, `wall_events`, `renumbered` and `last_call`. The
    particles of all ranks have the same states, in bits, as those of one `jostle.World` with all of
    them, whatever the number of ranks and the distribution.

    Parameters
    ----------
    comm : mpi4py.MPI.Intracomm
        The ranks. All worlds of a communicator share one duplicate of it, which is freed with it,
        so they are used from one thread at a time, and not after the communicator is freed.
    positions : array_like, shape (n, 2)
        Those of this rank's share, at any positions; n may be 0. The ids count the particles of
        rank 0 first, then those of rank 1, and so on.
    radii : array_like, a number or shape (n,)
        As for `jostle.World`.
    threads : int, default 1
        Number of threads of each rank; None for all cores.
    **options
        The other arguments of `jostle.World`; arrays have a row for each particle of this rank.
        Settings are the same on all ranks. A rank may leave out columns that others give.

    Raises
    ------
    TypeError, ValueError
        As by `jostle.World`, for what is not supported (see Notes), or if settings of ranks differ.
    RankError
        If another rank raises one of these.

    See Also
    --------
    jostle.World : The same in one process.
    jostle.mpi.find_pairs : Pairs of shapes without a world.

    Notes
    -----
    Not supported are forces other than `PairForce`, `Flocking`, `Thermostat`, `ThermalWalls`,
    `AndersenThermostat` and `Pump`. They are refused. There are no queries, such as `nearest` and
    `raycast`: use `jostle.mpi.find_pairs`, or ask a `jostle.Quadtree` of the rank's columns on each
    rank and combine the answers, for instance by ``comm.allgather``.

    `free_positions`, `net_forces` and `force_virial` depend on the particles of all ranks; the
    world that `gather` returns has these methods.

    `free_positions`, `net_forces` and `force_virial` depend on the particles of all ranks; the
    world that `gather` returns has these methods.

    Each rank has the particles of a range of the Morton curve, and copies of those near them. If
    some ranks need more time than others, or have many copies, the ranges are chosen again, and
    particles move to other ranks; sleeping ones stay where they are until they wake.

    Settings such as `gravity` can be assigned, and `walls` edited, in collective calls. Contacts
    are empty after that, and after `add`, `remove`, `apply_force` and `apply_impulse`, until the
    next step.

    Examples
    --------
    >>> from mpi4py import MPI
    >>> import jostle.mpi
    >>> world = jostle.mpi.World(MPI.COMM_SELF, [(0, 0), (3, 0)], 1.0, velocities=[(1, 0), (0, 0)])
    >>> world.step(0.1, steps=20)
    >>> world.velocities
    array([[0., 0.],
           [1., 0.]], dtype=float32)
    """

    # An attribute that does not exist, such as a misspelt setting, cannot be assigned.
    __slots__ = ("_comm", "_core", "_messages", "_work")

    def __init__(
        self,
        comm: MPI.Intracomm,
        positions: ArrayLike,
        radii: ArrayLike,
        *,
        threads: int | None = 1,
        **options: Any,
    ) -> None:
        def part(*_: int) -> Any:
            places = edits.rows_of(positions)
            return jostle.World(places, radii, threads=threads, **options)

        self._begin(comm)
        self._distribute(part)

    @classmethod
    def of_parts(cls, comm: MPI.Intracomm, part: Callable[[int, int], Any]) -> World:
        """Make a world of which each rank makes its part.

        Parameters
        ----------
        comm : mpi4py.MPI.Intracomm
            The ranks.
        part : callable
            Takes the number of the rank and that of all ranks. Returns a `jostle.World` with this
            rank's particles, which is used up.

        Returns
        -------
        World
            Its ids count the particles of rank 0 first, then those of rank 1, and so on.

        Raises
        ------
        TypeError, ValueError
            Those of `part`, for what is not supported, or if settings of ranks differ.
        RankError
            If another rank raises one of these.

        See Also
        --------
        jostle.mpi.create_scene : Makes the world of a scene.
        """
        world = cls.__new__(cls)
        world._begin(comm)
        world._distribute(part)
        return world

    def _begin(self, comm: MPI.Intracomm) -> None:
        self._comm = duplicate_of(comm)
        self._messages = Messages(self._comm)
        self._work: float | None = None

    @collective
    def _distribute(self, part: Callable[[int, int], Any]) -> None:
        """Make the worlds of all ranks one, with ids in the order of ranks."""
        with together(self._comm):
            core = part(self._comm.rank, self._comm.size)
            core._check_distributable()
        self._core: Any = core
        self._check_settings(core, _SETTINGS)
        ids = first_id(self._comm, len(core)) + np.arange(len(core))
        core._distribute(self._messages, ids)
        core._agree_on_losses()

    def _check_settings(self, core: Any, names: tuple[str, ...]) -> None:
        """Refuse settings that differ between ranks."""
        values = {name: getattr(core, name) for name in names}
        if "substeps" in values:
            # The automatic number depends on the particles of all ranks.
            values["substeps"] = core._given_substeps()
        self._check_same(**values)

    def _check_same(self, **values: object) -> None:
        """Refuse values that differ between ranks."""
        digests = [hashlib.sha256(_bytes_of(value)).digest() for value in values.values()]
        own = np.frombuffer(b"".join(digests), np.uint8).reshape(len(values), -1)
        everything = from_all(self._comm, own)
        differ = (everything != everything[0]).any(axis=(0, 2))
        for at, (name, value) in enumerate(values.items()):
            if differ[at]:
                raise ValueError(f"{name} is not the same on all ranks: here it is {value!r}")

    @collective
    def _assign(self, name: str, value: object) -> None:
        """Change a setting on all ranks. All islands wake."""
        with together(self._comm):
            trial: Any = self._core._of_records(self._core._own_records())
            setattr(trial, name, value)
            trial._check_distributable()
        self._check_settings(trial, (name,))
        self._core._drop_ghosts()
        setattr(self._core, name, value)
        self._core._agree_on_losses()

    @collective
    def _edit_walls(self, edit: Callable[[jostle.Walls], Any]) -> Any:
        """Change the walls of all ranks alike. All islands wake."""
        with together(self._comm):
            trial: Any = self._core._of_records(b"")
            edit(trial.walls)
            trial._check_distributable()
        self._check_settings(trial, ("walls",))
        self._core._drop_ghosts()
        found = edit(self._core.walls)
        self._core._agree_on_losses()
        return found

    def step(self, dt: float, steps: int = 1) -> None:
        """Advance the world.

        Parameters
        ----------
        dt : float
            Duration of a step, in seconds; the same on all ranks.
        steps : int, default 1
            Number of steps.

        Raises
        ------
        ValueError
            If the step is refused, as by `jostle.World.step`, or if `dt` or `steps` is not the same
            on all ranks. Then the world is as before this step, on all ranks.
        RankError
            If another rank cannot do the step, or if a signal handler raises there.

        Notes
        -----
        Signal handlers, such as that of Ctrl-C, run after the current step. If one raises on any
        rank, no rank makes a further step.
        """
        with held() as run_handlers:
            with together(self._comm):
                dt, steps = self._core._arguments_of_step(dt, steps)
            self._check_same(dt=dt, steps=steps)
            with together(self._comm):
                self._core._begin_steps(dt)
            for _ in range(steps):
                self._step(dt)
                with together(self._comm):
                    run_handlers()
            self._core._end_steps()

    def _step(self, dt: float) -> None:
        start, waited = time.perf_counter(), self._messages.seconds
        with passed_on(self._comm):
            self._core._step_distributed(dt)
        busy = time.perf_counter() - start - (self._messages.seconds - waited)
        work = busy / max(self._core._counts()[2], 1)
        # One step may be disturbed by other processes.
        self._work = work if self._work is None else self._work + _SMOOTHING * (work - self._work)
        self._core._set_work(self._work)

    @collective
    def add(
        self,
        /,
        positions: ArrayLike,
        radii: ArrayLike,
        **columns: Any,
    ) -> NDArray[np.int64]:
        """Add particles.

        Parameters
        ----------
        positions : array_like, shape (k, 2)
            Those that this rank adds, at any positions; k may be 0.
        radii : array_like, a number or shape (k,)
            In units of length.
        **columns
            The other arguments of `jostle.World.add`.

        Returns
        -------
        ndarray of int64, shape (k,)
            Their ids, above all ids before; those of rank 0 first, then those of rank 1, and so on.

        Raises
        ------
        TypeError, ValueError
            As by `jostle.World.add`; then no rank adds any.
        RankError
            If another rank raises one of these.

        See Also
        --------
        remove : Remove particles.
        set : Change particles.
        """
        places = edits.rows_of(positions)
        return edits.add(self._comm, self._core, places, radii, **columns)

    @collective
    def remove(self, ids: ArrayLike) -> None:
        """Remove particles of any rank. Their ids are never used again.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            Those that this rank gives, of particles of any rank; k may be 0. Each particle is
            given at most once by all ranks together.

        Raises
        ------
        IdError, TypeError, ValueError
            As by `jostle.World.remove`; then none is removed on any rank.
        RankError
            If another rank raises one of these.

        See Also
        --------
        add : Add particles.
        """
        edits.remove(self._comm, self._core, ids)

    @collective
    def set(self, /, ids: ArrayLike, **columns: Any) -> None:
        """Change some columns of some particles of any rank.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            Those that this rank gives, of particles of any rank; k may be 0. Each particle is
            given at most once by all ranks together.
        **columns
            The columns of `jostle.World.set`, the same ones on all ranks.

        Raises
        ------
        IdError, TypeError, ValueError
            As by `jostle.World.set`, or if the columns are not the same on all ranks; then nothing
            changes on any rank.
        RankError
            If another rank raises one of these.

        See Also
        --------
        add : Add particles.
        """
        edits.change(self._comm, self._core, ids, **columns)

    @collective
    def apply_force(
        self, /, ids: ArrayLike, forces: ArrayLike, points: ArrayLike | None = None
    ) -> None:
        """Add given forces on some particles of any rank, for the next call of `step`.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            Those that this rank gives, of particles of any rank; k may be 0. A call equals one of
            `jostle.World.apply_force` with the ids of rank 0, then those of rank 1, and so on.
        forces : array_like, shape (k, 2), or (2,) for one id or as one for all
            In units of mass times length per second², see `jostle.World.apply_force`.
        points : array_like, shape (k, 2), or (2,) for one id or as one for all, optional
            Where each acts. All ranks that give ids give points, or none does.

        Raises
        ------
        IdError, TypeError, ValueError
            As by `jostle.World.apply_force`, or if only some ranks give points; then nothing
            changes on any rank.
        RankError
            If another rank raises one of these.

        See Also
        --------
        accelerations : Those of all particles.
        """
        edits.push(self._comm, self._core, ids, forces, points)

    @collective
    def apply_impulse(
        self, /, ids: ArrayLike, impulses: ArrayLike, points: ArrayLike | None = None
    ) -> None:
        """Give impulses to some particles of any rank, at once.

        Parameters
        ----------
        ids : int or array_like of int, shape (k,)
            Those that this rank gives, of particles of any rank; k may be 0. A call equals one of
            `jostle.World.apply_impulse` with the ids of rank 0, then those of rank 1, and so on.
        impulses : array_like, shape (k, 2), or (2,) for one id or as one for all
            In units of mass times length per second, see `jostle.World.apply_impulse`.
        points : array_like, shape (k, 2), or (2,) for one id or as one for all, optional
            Where each acts. All ranks that give ids give points, or none does.

        Raises
        ------
        IdError, TypeError, ValueError
            As by `jostle.World.apply_impulse`, or if only some ranks give points; then nothing
            changes on any rank.
        RankError
            If another rank raises one of these.

        See Also
        --------
        apply_force : Forces during the next call of `step`.
        """
        edits.hit(self._comm, self._core, ids, impulses, points)

    @property
    def accelerations(self) -> NDArray[np.float32]:
        """Given accelerations in the next call of `step`: ndarray of float32, shape (n, 2).

        They are in the order of `ids`. Assigning an array of this shape, one vector for all of this
        rank, or None for zeros, is a collective call, which replaces what was given before; see
        `jostle.World.accelerations`.
        """
        given: NDArray[np.float32] = self._core.accelerations
        return given[: len(self)]

    @accelerations.setter
    def accelerations(self, value: ArrayLike | None) -> None:
        self._accelerate(value)

    @collective
    def _accelerate(self, accelerations: ArrayLike | None) -> None:
        edits.accelerate(self._comm, self._core, accelerations)

    def __len__(self) -> int:
        """Number of particles of this rank."""
        return int(self._core._counts()[0])

    def __repr__(self) -> str:
        return (
            f"<jostle.mpi.World of {self.total} particles after {self.time:.3f} s, "
            f"{len(self)} of them on rank {self._comm.rank} of {self._comm.size}>"
        )

    def _own(self) -> tuple[int, NDArray[np.int64], list[int]]:
        own: tuple[int, NDArray[np.int64], list[int]] = self._core._own()
        return own

    positions = Column("Centres: ndarray of float32, shape (n, 2), in the order of `ids`.")
    velocities = Column("Velocities: ndarray of float32, shape (n, 2), in the order of `ids`.")
    radii = Column("Radii: ndarray of float32, shape (n,), in the order of `ids`.")
    masses = Column("Masses: ndarray of float32, shape (n,), in the order of `ids`.")
    restitution = Column(
        "Coefficients of restitution: ndarray of float32, shape (n,), in the order of `ids`."
    )
    movable = Column(
        "Which particles are movable: ndarray of bool, shape (n,), in the order of `ids`."
    )
    friction = Column(
        "Coefficients of friction: ndarray of float32, shape (n,), in the order of `ids`."
    )
    angles = Column("Angles in radians: ndarray of float32, shape (n,), in the order of `ids`.")
    angular_velocities = Column(
        "Angular velocities: ndarray of float32, shape (n,), in the order of `ids`."
    )
    categories = Column("Categories: ndarray of uint32, shape (n,), in the order of `ids`.")
    unwrapped_positions = Column(
        "Positions with the periods that were travelled: ndarray of float64, shape (n, 2), in the "
        "order of `ids`."
    )
    masks = Column("Masks: ndarray of uint32, shape (n,), in the order of `ids`.")
    sensors = Column(
        "Which particles are sensors: ndarray of bool, shape (n,), in the order of `ids`."
    )
    asleep = Column(
        "Which particles are asleep: ndarray of bool, shape (n,), in the order of `ids`."
    )

    @property
    def total(self) -> int:
        """Number of particles of all ranks."""
        return int(self._core._counts()[1])

    @property
    def ghosts(self) -> int:
        """Number of copies of particles of other ranks in the last step."""
        count, ids, *_ = self._own()
        return len(ids) - count

    @property
    def time(self) -> float:
        """Simulated time in seconds."""
        return float(self._core.time)

    @property
    def ids(self) -> NDArray[np.int64]:
        """Ids of this rank's particles: ndarray of int64, shape (n,), in the order of columns."""
        return self._own()[1][: len(self)]

    @property
    def traffic(self) -> dict[str, float]:
        """What this rank has sent so far.

        A dict of `calls` in which all ranks take part, `messages` and `bytes` with particles and
        hashes, `repeats`, the number of steps that were repeated, `rebalances`, how often domains
        were chosen, and `seconds` of waiting and communication.
        """
        names = ("calls", "messages", "bytes", "repeats", "rebalances")
        counts = dict(zip(names, self._own()[2], strict=True))
        return {**counts, "seconds": self._messages.seconds}

    gravity = Setting[NDArray[np.float64]]("Acceleration of gravity: ndarray, shape (2,).")
    drag = Setting[float]("Linear damping per second, see `jostle.World.drag`.")
    container = Setting[jostle.Box | jostle.Circle | None](
        "The region of the particles, see `jostle.World.container`."
    )
    period = Setting[Any]("Width and height of a periodic plane, see `jostle.World.period`.")

    @property
    def walls(self) -> Walls:
        """The walls: a `jostle.mpi.Walls`, which shows and changes those of all ranks."""
        return Walls(self)

    forces = Setting[list[Any]]("The forces, see `jostle.World.forces`.")
    on_touch = Setting[str]("What happens to particles that touch, see `jostle.World.on_touch`.")
    substeps = Setting[int | None](
        "Sub-steps of a step, see `jostle.World.substeps`. The automatic number is that of the "
        "particles of all ranks."
    )
    sleeping = Setting[bool]("Whether islands that rest may fall asleep.")
    track_events = Setting[bool]("Whether `events` are tracked, see `jostle.World.track_events`.")
    method = Setting[str]('How pairs are found: "quadtree" or "brute".')
    leaf_capacity = Setting[int]("Maximum number of particles of a leaf of the tree.")
    max_depth = Setting[int]("Maximum depth of the tree.")

    @property
    def threads(self) -> int | None:
        """Number of threads of this rank; None for all cores. Not collective."""
        threads: int | None = self._core.threads
        return threads

    @threads.setter
    def threads(self, value: int | None) -> None:
        self._core.threads = value

    @property
    def stats(self) -> jostle.Stats:
        """Size of the tree of this rank's particles and ghosts, and tests in the last step."""
        stats: jostle.Stats = self._core.stats
        return stats

    @property
    def profile(self) -> dict[str, float]:
        """Milliseconds of each stage of the last step on this rank, see `jostle.World.profile`."""
        return dict(self._core.profile)

    @collective
    def kinetic_energy(self) -> float:
        """Sum of ½ m v² + ½ I ω² of the movable particles of all ranks, with I = m r²/2.

        The exact sum, rounded once, so it is the same for every number of ranks. That of
        `jostle.World` is rounded after each addition and may differ in the last digits.

        Returns
        -------
        float
            In units of mass times length squared per second squared.

        See Also
        --------
        potential_energy : Of gravity and forces.
        """
        return state.kinetic_energy(self._comm, self._core)

    @collective
    def potential_energy(self) -> float:
        """Energy of the movable particles of all ranks in gravity and forces between kinds.

        It counts each `PairForce` that has a potential, and may differ from
        `jostle.World.potential_energy` in the last digits.

        Returns
        -------
        float
            In units of mass times length squared per second squared.

        See Also
        --------
        kinetic_energy : Of motion.
        """
        return state.potential_energy(self._comm, self._core, self._messages)

    @collective
    def momentum(self) -> NDArray[np.float64]:
        """Sum of mass times velocity of all movable particles, rounded once.

        Returns
        -------
        ndarray of float64, shape (2,)
            In units of mass times length per second.

        See Also
        --------
        kinetic_energy : The energy of this motion, among others.
        """
        return state.momentum(self._comm, self._core)

    @property
    def last_step(self) -> jostle.LastStep:
        """What the last step found on this rank, see `jostle.World.last_step`.

        Not collective. Each pair that touched is on one rank, and particles at walls are those of
        this rank.
        """
        found = self._core.last_step
        fields = found.to_dict()
        fields["contacts"] = self._contacts(found.contacts)
        fields["wall_contacts"] = self._wall_contacts(found.wall_contacts)
        return jostle.LastStep(**fields)

    @property
    @collective
    def last_call(self) -> jostle.LastCall:
        """Sums over the last call of `step` and the particles of all ranks.

        See `jostle.World.last_call`. Impulses and the virial may differ in the last digits from
        those of one process, because each rank rounds its part.
        """
        found = self._core.last_call
        fields = found.to_dict()
        for name in ("collision_virial", "wall_impulses", "side_impulses"):
            fields[name] = from_all(self._comm, fields[name]).sum(axis=0)
        counts = np.array([found.collisions, found.wall_collisions], np.int64)
        pairs, walls = map(int, totals(self._comm, counts))
        return jostle.LastCall(**fields | {"collisions": pairs, "wall_collisions": walls})

    def _contacts(self, found: jostle.WorldContacts) -> jostle.WorldContacts:
        """Return those that belong to this rank, with ids among all particles."""
        count, ids, _ = self._own()
        movable, pairs = self._core.movable[found.pairs], ids[found.pairs]
        is_reversed = pairs[:, 0] > pairs[:, 1]
        # A pair belongs to the rank of the movable particle, of two to that of the smaller id.
        are_alike = movable[:, 0] == movable[:, 1]
        is_second = np.where(are_alike, is_reversed, movable[:, 1])
        owner = np.where(is_second, found.pairs[:, 1], found.pairs[:, 0])
        pairs = np.sort(pairs, axis=1)
        is_own = owner < count
        normals = np.where(is_reversed[:, None], -found.normals, found.normals)
        turned = found.categories[:, ::-1]
        categories = np.where(is_reversed[:, None], turned, found.categories)
        awake = found.to_dict() | {"pairs": pairs, "normals": normals, "categories": categories}
        asleep = self._core._own_touches_asleep().to_dict()
        columns = {name: np.concatenate([awake[name][is_own], asleep[name]]) for name in awake}
        order = np.lexsort(columns["pairs"].T[::-1])
        return jostle.WorldContacts(**{name: column[order] for name, column in columns.items()})

    def _wall_contacts(self, found: jostle.WallContacts) -> jostle.WallContacts:
        """Return those of particles of this rank, with ids among all particles."""
        count, ids, *_ = self._own()
        own = np.flatnonzero(found.ids < count)
        own = own[np.lexsort((found.walls[own], ids[found.ids[own]]))]
        columns = {name: column[own] for name, column in found.to_dict().items()}
        return jostle.WallContacts(**columns | {"ids": ids[columns["ids"]]})

    @property
    @collective
    def events(self) -> jostle.WorldEvents:
        """The pairs that began and ceased to touch in the last call of `step`, each on one rank.

        The pairs are of ids, sorted; see `jostle.World.events`. After `load` no pair touches before
        the first step.
        """
        return jostle.WorldEvents(**self._events(at_walls=False))

    @property
    @collective
    def wall_events(self) -> jostle.WallEvents:
        """The particles and walls that began and ceased to touch in the last call of `step`.

        Each pair is on one rank; see `jostle.World.wall_events`. After `load` nothing touches
        before the first step.
        """
        return jostle.WallEvents(**self._events(at_walls=True))

    def _events(self, *, at_walls: bool) -> dict[str, NDArray[Any]]:
        with together(self._comm):
            if not self._core.track_events:
                raise RuntimeError("events are not tracked; make the world with track_events=True")
        return events_of(self._comm, self._core._own_touches(at_walls))

    @property
    @collective
    def renumbered(self) -> NDArray[np.int64] | None:
        """The new id of each id after the last call of `step`, the same on all ranks.

        None if no particles merged; see `jostle.World.renumbered`. Each rank gets the whole array,
        with a number for each id that was ever given.
        """
        pairs = joined(self._comm, self._core._own_renumbering().reshape(-1)).reshape(-1, 2)
        return new_ids(self._comm, pairs, *self._core._own_ids()) if len(pairs) else None

    @collective
    def state_hash(self) -> int:
        """Return the hash of all particles, the same on all ranks.

        Returns
        -------
        int
            That of `jostle.World.state_hash` with the same particles in the order of ids.
        """
        return state.state_hash(self._comm, self._core)

    @collective
    def gather(self, root: int = 0) -> jostle.World | None:
        """Bring all particles to one rank.

        Parameters
        ----------
        root : int, default 0
            The rank.

        Returns
        -------
        jostle.World or None
            On `root` a world of all particles in the order of ids, which continues with the same
            bits; None on other ranks. It has no contacts, events and collisions before its first
            step.

        Raises
        ------
        ValueError
            If there is no rank `root`.
        """
        with together(self._comm):
            if not 0 <= root < self._comm.size:
                raise ValueError(f"root is {root}; it must be from 0 to {self._comm.size - 1}")
        return state.gathered(self._comm, self._core, root)

    @collective
    def save(self, path: str | bytes | os.PathLike[str]) -> None:
        """Write the world into one file, in which each rank writes a part.

        Parameters
        ----------
        path : str, bytes or os.PathLike
            An existing file is replaced when the new one is complete.

        Raises
        ------
        OSError
            If the file cannot be written; then an existing one is unchanged.

        See Also
        --------
        load : Reads the file, on any number of ranks.
        jostle.World.load : Reads the file in one process.
        """
        settings = self._core._of_records(b"").snapshot()
        end, parts = self._core._own_ids()[1], state.parts_of(self._core)
        write(self._comm, Path(os.fsdecode(path)), settings, end, parts)

    @classmethod
    def load(
        cls, comm: MPI.Intracomm, path: str | bytes | os.PathLike[str], *, threads: int | None = 1
    ) -> World:
        """Read a world from a file that `save` has written, on any number of ranks.

        Parameters
        ----------
        comm : mpi4py.MPI.Intracomm
            The ranks.
        path : str, bytes or os.PathLike
            The file.
        threads : int, default 1
            Number of threads of each rank.

        Returns
        -------
        World
            A world that continues with the same bits.

        Raises
        ------
        OSError
            If the file cannot be read.
        ValueError
            If it does not contain a distributed world, or is truncated or damaged.

        See Also
        --------
        save : Writes the file.
        """
        world = cls.__new__(cls)
        world._begin(comm)
        world._load(Path(os.fsdecode(path)), threads)
        return world

    @collective
    def _load(self, path: Path, threads: int | None) -> None:
        settings, end, parts = read(self._comm, path)
        records, *kept = (rows.tobytes() for rows in parts)
        with together(self._comm):
            empty: Any = jostle.World.restore(settings)
            core = empty._of_records(records)
            core.threads = threads
        self._core = core
        core._distribute(self._messages, parts[0]["id"].copy())
        core._agree_on_losses()
        core._set_ids(parts[0]["id"].copy(), end)
        core._take_kept(*kept)
