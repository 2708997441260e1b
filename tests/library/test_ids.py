"""The ids of a world: against a plain dictionary, through random histories."""

import random
from typing import Any

import numpy as np
import pytest
from copies import WAYS
from hypothesis import given
from hypothesis import strategies as st

import jostle

SIDE = 12.0


class History:
    """A world, and what a dictionary by id says that is in it.

    Masses are the marks of particles: a step does not change them, and mergers add them up.
    """

    def __init__(self, seed: int, on_touch: str) -> None:
        self.random = random.Random(seed)
        self.world = jostle.World(
            np.empty((0, 2)),
            0.4,
            velocities=np.empty((0, 2)),
            gravity=(0, 3),
            restitution=0.5,
            container=jostle.Box(0, 0, SIDE, SIDE),
            on_touch=on_touch,
        )
        self.masses: dict[int, float] = {}
        self.springs: list[tuple[int, int]] = []
        self.attractors: list[int] = []
        self.given = 0

    def some(self) -> list[int]:
        """Return some ids, in any order."""
        return self.random.sample(sorted(self.masses), self.random.randint(0, len(self.masses)))

    def add(self) -> None:
        count = self.random.randint(0, 6)
        places = [[self.random.uniform(1, SIDE - 1) for _ in "xy"] for _ in range(count)]
        speeds = [[self.random.uniform(-9, 9) for _ in "xy"] for _ in range(count)]
        masses = [float(np.float32(self.random.uniform(1, 9))) for _ in range(count)]
        if count == 1:
            one = self.world.add(tuple(places[0]), 0.4, velocities=speeds[0], masses=masses[0])
            assert type(one) is int
            ids = [one]
        else:
            ids = self.world.add(places, 0.4, velocities=speeds, masses=masses).tolist()
        assert ids == list(range(self.given, self.given + count))
        self.given += count
        self.masses.update(zip(ids, masses, strict=True))

    def remove(self) -> None:
        gone = self.some()[:4]
        self.world.remove(gone[0] if len(gone) == 1 else gone)
        for id in gone:
            del self.masses[id]
        self.springs = [pair for pair in self.springs if not {*pair} & {*gone}]
        self.attractors = [id for id in self.attractors if id not in gone]

    def set(self) -> None:
        ids = self.some()
        masses = [float(np.float32(self.random.uniform(1, 9))) for _ in ids]
        if len(ids) == 1:
            self.world.set(ids[0], masses=masses[0], velocities=(0, 1))
        else:
            self.world.set(ids, masses=masses)
        self.masses.update(zip(ids, masses, strict=True))

    def tie(self) -> None:
        """Replace the forces."""
        ids = self.some()
        self.springs = list(zip(ids[::2], ids[1::2], strict=False))
        self.attractors = ids[:1]
        springs = [jostle.Springs(self.springs, 1.0, 1.0)] if self.springs else []
        pulls = [jostle.Attractor(particle=id, strength=0.5) for id in self.attractors]
        self.world.forces = [*springs, *pulls]

    def step(self) -> None:
        self.world.step(1 / 60, self.random.randint(0, 3))
        new = self.world.renumbered
        if new is None:
            return
        assert (len(new), new.dtype, new.flags.writeable) == (self.given, np.int64, False)
        assert [id for id in range(self.given) if new[id] >= 0] == sorted(self.masses)
        masses: dict[int, float] = {}
        for id, mass in sorted(self.masses.items()):
            heir = int(new[id])
            assert heir <= id
            assert new[heir] == heir
            masses[heir] = masses.get(heir, 0.0) + mass
        self.masses = masses
        springs = [(int(new[i]), int(new[j])) for i, j in self.springs]
        self.springs = [(i, j) for i, j in springs if i != j]
        self.attractors = [int(new[id]) for id in self.attractors]

    def copy(self) -> None:
        ways = [lambda world: jostle.World.restore(world.snapshot()), *WAYS]
        self.world = self.random.choice(ways)(self.world)

    def ask_for_what_is_gone(self) -> None:
        gone = sorted({*range(self.given)} - {*self.masses})
        if not gone:
            return
        before, some, id = self.world.snapshot(), self.some(), self.random.choice(gone)
        assert id not in self.world
        message = rf"^ids\[{len(some)}\] is {id}; no particle has this id any more"
        with pytest.raises(ValueError, match=message):
            self.world.remove([*some, id])
        with pytest.raises(ValueError, match=message):
            self.world.set([*some, id], radii=1.0)
        with pytest.raises(ValueError, match=f"^ids is {id}; no particle has this id any more"):
            self.world.set(id, masses=1.0)
        with pytest.raises(ValueError, match=message):
            self.world.rows([*some, id])
        with pytest.raises(ValueError, match=f"^ids is {id}; no particle has this id any more"):
            self.world.rows(id)
        with pytest.raises(ValueError, match=rf"^forces\[0\] is a force on particle {id}; no part"):
            self.world.forces = [jostle.Attractor(particle=id, strength=1.0)]
        assert self.world.snapshot() == before

    def check(self) -> None:
        world = self.world
        ids = sorted(self.masses)
        assert world.ids.tolist() == ids
        assert len(world) == len(world.positions) == len(ids)
        np.testing.assert_allclose(world.masses, [self.masses[id] for id in ids], rtol=1e-5)
        self.masses = dict(zip(ids, world.masses.tolist(), strict=True))
        assert all(id in world for id in ids)
        some = self.some()
        assert world.ids[world.rows(some)].tolist() == some
        if some:
            row = world.rows(some[0])
            assert (type(row), ids[row]) == (int, some[0])
        pairs = [force.pairs for force in world.forces if isinstance(force, jostle.Springs)]
        assert [tuple(pair) for table in pairs for pair in table.tolist()] == self.springs
        poles = [force.particle for force in world.forces if isinstance(force, jostle.Attractor)]
        assert poles == self.attractors
        self.check_contacts()

    def check_contacts(self) -> None:
        """Check that the ids of contacts are those of discs that nearly touch."""
        world = self.world
        row = {int(id): row for row, id in enumerate(world.ids)}
        positions, radii = world.positions, world.radii
        contacts = world.last_step.contacts
        for (i, j), depth in zip(contacts.pairs, contacts.depths, strict=True):
            a, b = row[int(i)], row[int(j)]
            distance = np.hypot(*(positions[a] - positions[b]))
            assert abs(radii[a] + radii[b] - distance - depth) < 0.5
        for id, depth in zip(
            world.last_step.wall_contacts.ids, world.last_step.wall_contacts.depths, strict=True
        ):
            x, y = positions[row[int(id)]]
            gap = min(x, y, SIDE - x, SIDE - y) - radii[row[int(id)]]
            assert abs(gap + depth) < 0.5


ACTS = ("add", "add", "remove", "set", "tie", "step", "step", "copy", "ask_for_what_is_gone")


@given(
    st.integers(0, 2**32),
    st.sampled_from(["bounce", "merge", "ignore"]),
    st.lists(st.sampled_from(ACTS), min_size=3, max_size=25),
)
def test_ids_stay_through_every_history(seed: int, on_touch: str, acts: list[str]) -> None:
    history = History(seed, on_touch)
    for act in ["add", *acts]:
        getattr(history, act)()
        history.check()


def made_anew(world: jostle.World, on_touch: str) -> jostle.World:
    """Return a world of the same particles and forces, of which none was ever removed."""
    rows = {int(id): row for row, id in enumerate(world.ids)}
    forces: list[Any] = []
    for force in world.forces:
        if isinstance(force, jostle.Springs):
            pairs = [[rows[id] for id in pair] for pair in force.pairs.tolist()]
            forces.append(jostle.Springs(pairs, force.lengths, force.stiffness))
        elif isinstance(force, jostle.Attractor) and force.particle is not None:
            forces.append(jostle.Attractor(particle=rows[force.particle], strength=0.5))
    return jostle.World(
        world.positions,
        world.radii,
        velocities=world.velocities,
        masses=world.masses,
        gravity=(0, 3),
        restitution=world.restitution,
        container=world.container,
        on_touch=on_touch,
        forces=forces,
    )


@given(
    st.integers(0, 2**32),
    st.sampled_from(["bounce", "merge", "ignore"]),
    st.lists(st.sampled_from(("add", "remove", "set", "tie")), min_size=3, max_size=12),
)
def test_removed_particles_leave_no_trace(seed: int, on_touch: str, acts: list[str]) -> None:
    history = History(seed, on_touch)
    for act in ["add", "add", *acts]:
        getattr(history, act)()
    world = history.world
    ids, fresh = world.ids, made_anew(world, on_touch)
    for _ in range(5):
        for each in (world, fresh):
            each.step(1 / 60, steps=4)
        assert world.state_hash() == fresh.state_hash()
        assert (world.positions == fresh.positions).all()
        assert (world.ids == ids[fresh.ids]).all()
        assert (world.last_step.contacts.pairs == ids[fresh.last_step.contacts.pairs]).all()
        assert (
            world.last_step.contacts.normal_impulses == fresh.last_step.contacts.normal_impulses
        ).all()
        assert (world.last_step.wall_contacts.ids == ids[fresh.last_step.wall_contacts.ids]).all()


def test_rows_may_be_asked_for_twice() -> None:
    world = jostle.World([(0, 0), (5, 0), (9, 0)], 1.0)
    world.remove(0)
    rows = world.rows([2, 1, 2])
    assert (rows.dtype, rows.tolist()) == (np.int64, [1, 0, 1])
    assert world.rows([]).shape == (0,)


def test_in_takes_one_id() -> None:
    world = jostle.World([(0, 0), (5, 0)], 1.0)
    world.remove(0)
    assert 1 in world
    assert np.int64(1) in world
    for other in (0, 2, -1, 2**70, True, 1.0, "1", None):
        assert other not in world
    with pytest.raises(TypeError, match=r"one id; np\.isin"):
        assert [1] in world


def test_ids_of_forces_may_be_large() -> None:
    pull = jostle.Attractor(particle=2**40, strength=1.0)
    assert pull.particle == 2**40
    assert jostle.Springs([(2**40, 1)], 1.0, 1.0).pairs.tolist() == [[2**40, 1]]
    world = jostle.World([(0, 0)], 1.0)
    with pytest.raises(ValueError, match=f"^forces.0. is a force on particle {2**40}; no particle"):
        world.forces = [pull]
    with pytest.raises(ValueError, match=r"^pairs\[1\] is -1; it must be the id of a particle"):
        jostle.Springs([(0, 1), (2, -1)], 1.0, 1.0)
