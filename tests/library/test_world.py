"""`jostle.World` as an object: its settings, steps and results.

The physics is tested in test_exact_step.py, test_resting.py, test_gas.py and in crates/jostle.
"""

import inspect
import threading
import time
from typing import Any

import numpy as np
import pytest
from results import fields
from signals import reaction_to_ctrl_c
from worlds import COLUMNS, NEW, SETTINGS, gas, three

import jostle


def test_settings_and_their_defaults() -> None:
    world = three()
    found = {name: getattr(world, name) for name in SETTINGS}
    assert found == {name: default for name, (default, _) in SETTINGS.items()}
    signature = inspect.signature(jostle.World)
    for name, value in found.items():
        assert signature.parameters[name].default == value


@pytest.mark.parametrize("name", SETTINGS)
def test_settings_may_be_given_or_assigned(name: str) -> None:
    default, value = SETTINGS[name]
    assert getattr(three(**{name: value}), name) == value
    world = three()
    setattr(world, name, value)
    assert getattr(world, name) == value
    others = {other for other in SETTINGS if other != name}
    assert all(getattr(world, other) == SETTINGS[other][0] for other in others)
    setattr(world, name, default)
    assert getattr(world, name) == default


def test_time_passes() -> None:
    world = three()
    world.step(0.25, steps=3)
    assert world.time == 0.75
    world.step(np.float32(0.25))
    world.step(1, 0)
    assert world.time == 1
    assert repr(world) == "<jostle.World of 3 particles after 1.000 s>"
    assert world.positions[0].tolist() == pytest.approx([1, 0])


@pytest.mark.parametrize("method", ["quadtree", "brute"])
def test_what_a_step_leaves_behind(method: Any) -> None:
    world = gas(method=method)
    assert world.stats == jostle.Stats(0, 0, 0, 0)
    assert len(world.last_step.contacts.pairs) == 0
    assert world.profile == dict.fromkeys(STAGES, 0.0)
    world.step(1 / 60, steps=2)
    contacts, stats = world.last_step.contacts, world.stats
    assert isinstance(contacts, jostle.WorldContacts)
    assert isinstance(stats, jostle.Stats)
    pairs, normals, depths, *_ = fields(contacts)
    assert len(pairs) > 0
    assert (pairs.dtype, normals.dtype, depths.dtype) == (np.int64, np.float32, np.float32)
    assert (pairs[:, 0] < pairs[:, 1]).all()
    assert (pairs < len(world)).all()
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, rtol=1e-5)
    offset = world.positions[pairs[:, 1]] - world.positions[pairs[:, 0]]
    assert ((offset * normals).sum(axis=1) > 0).all()
    everything = len(world) * (len(world) - 1) // 2
    assert len(pairs) <= stats.tests
    assert stats.tests == everything if method == "brute" else stats.tests < everything / 4
    assert list(world.profile) == STAGES
    assert all(isinstance(time, float) and time >= 0 for time in world.profile.values())
    assert sum(world.profile.values()) > 0


STAGES = ["bounds", "build", "pairs", "contacts", "resting", "events", "correction", "store"]


def test_the_profile_is_of_the_last_step() -> None:
    world = gas(4000)
    start = time.perf_counter()
    world.step(1 / 60, steps=50)
    taken = 1000 * (time.perf_counter() - start)
    assert 0 < sum(world.profile.values()) < taken / 5
    before = world.profile
    world.step(1 / 60, steps=0)
    assert world.profile == before


def test_forces_have_a_stage_of_their_own() -> None:
    world = gas(4000, forces=[jostle.Gravitation(0.1)])
    assert world.profile == dict.fromkeys([*STAGES, "forces"], 0.0)
    world.step(1 / 60)
    # Nothing rests in an elastic gas.
    assert all((time > 0) == (stage != "resting") for stage, time in world.profile.items())
    world.forces = ()
    assert list(world.profile) == STAGES


def test_sums() -> None:
    world = three(gravity=np.array([0, 10]))
    assert world.gravity.tolist() == [0, 10] and not world.gravity.flags.writeable
    assert world.momentum().tolist() == [1, 8]
    assert world.angular_momentum() == 80 and world.angular_momentum((10, 0)) == 0
    assert world.temperature() == pytest.approx(2)  # around (0.2, 1.6)
    assert world.kinetic_energy() == 0.5 * 1 * 1 + 0.5 * 4 * 4
    assert world.potential_energy() == 0  # only the immovable one is off the line y = 0
    world.positions = [(0, -2), (10, 0), (20, 5)]
    assert world.potential_energy() == 20
    assert world.total_energy() == 20 + world.kinetic_energy()


def test_the_hash_is_of_the_state() -> None:
    world = three()
    assert 0 <= world.state_hash() < 2**64
    assert world.state_hash() == three().state_hash()
    for name in COLUMNS:
        other = three()
        setattr(other, name, NEW[name])
        assert other.state_hash() != world.state_hash()


def test_ids_are_followed_through_long_calls() -> None:
    world = gas(3000, on_touch="merge")
    masses = world.masses
    world.step(1 / 600, steps=300)  # the call checks for it in between
    ids = world.renumbered
    assert ids is not None
    assert 0 < len(world) < 1000
    assert (np.unique(ids) == world.ids).all()
    sums = np.bincount(ids, weights=masses)[world.ids]
    np.testing.assert_allclose(world.masses, sums, rtol=1e-5)
    world.step(1 / 600, steps=0)
    assert world.renumbered is None


def test_what_touches_may_be_ignored() -> None:
    world = jostle.World([(0, 0), (3, 0)], 1.0, velocities=[(1, 0), (-1, 0)], on_touch="ignore")
    world.step(0.1, steps=10)
    pairs, normals, depths, *_ = fields(world.last_step.contacts)
    assert (pairs.tolist(), normals.tolist()) == ([[0, 1]], [[1, 0]])
    np.testing.assert_allclose(depths, [1], rtol=1e-5)
    world.step(0.1, steps=10)
    np.testing.assert_allclose(world.positions[:, 0], [2, 1], rtol=1e-5)


def test_other_threads_see_the_world_between_steps() -> None:
    world = gas(2000)
    seen: list[float] = []
    done = threading.Event()

    def look() -> None:
        while not done.is_set():
            moment, positions = world.time, world.positions
            assert np.isfinite(positions).all()
            seen.append(moment)
            time.sleep(0.001)

    thread = threading.Thread(target=look)
    thread.start()
    end = time.perf_counter() + 10
    while len({*seen}) < 4 and time.perf_counter() < end:
        world.step(1 / 60, steps=100)
    done.set()
    thread.join()
    assert len({*seen}) >= 4


def test_a_long_call_can_be_interrupted() -> None:
    world = gas(50)
    assert reaction_to_ctrl_c(lambda: world.step(1 / 60, steps=10**7)) < 1
    assert world.time > 0
    world.step(1 / 60)  # and it is still usable


def test_new_positions_have_no_residual() -> None:
    world = jostle.World([(0, 0), (3, 0)], 1.0, velocities=[(0.1, 0), (0, 0)])
    world.step(1 / 60, steps=7)
    positions, velocities = world.positions, world.velocities
    same = jostle.World(positions, 1.0, velocities=velocities)
    assert world.state_hash() != same.state_hash()
    world.positions = positions + 1
    world.positions = positions
    assert world.state_hash() == same.state_hash()
    world.step(1 / 60, steps=7)
    same.step(1 / 60, steps=7)
    assert world.state_hash() == same.state_hash()
