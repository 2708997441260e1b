"""Refused and interrupted steps of `World`: the world keeps its state."""

from __future__ import annotations

import _thread
import re
import signal
import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import jostle

FLOAT = np.float32


@pytest.fixture
def ctrl_c() -> Iterator[None]:
    """Python's own handler: a background job begins with SIGINT ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def overflowing() -> jostle.World:
    return jostle.World(
        [(0, 0), (3, 0), (6, 0)],
        1.0,
        masses=1e26,
        gravity=(0, 10),
        drag=1e3,
        container=jostle.Box(-20, -20, 20, 20),
        forces=[jostle.Gravitation(1, 0.1)],
        restitution=0.5,
        substeps=1,
    )


def test_a_step_that_overflows_names_the_id_where_it_is_not_the_row() -> None:
    world = overflowing()
    world.remove(world.add((-15, 0), 0.1, masses=1.0))
    ids = world.add([(10, 0), (13, 0), (16, 0)], 1.0, masses=1e26, restitution=0.5)
    world.remove([0, 1, 2])
    with pytest.raises(ValueError, match="would make") as error:
        world.step(0.01, 1000)
    found = re.match(r"the step would make \w+\[(\d)\] of particle (\d) ", str(error.value))
    assert found is not None
    row, id = map(int, found.groups())
    assert world.ids[row] == id == ids[row]


def test_a_step_that_overflows_names_the_particle_and_changes_nothing() -> None:
    world = overflowing()
    before = world.snapshot()
    with pytest.raises(ValueError, match=r"the step would make \w+\[\d\] .*not finite"):
        for _ in range(1000):
            before = world.snapshot()
            world.step(0.01)
    assert world.snapshot() == before
    assert jostle.World.restore(before).snapshot() == before
    assert np.isfinite(world.velocities).all()
    # The steps before it stay, in one call too.
    other = overflowing()
    with pytest.raises(ValueError, match="not finite"):
        other.step(0.01, steps=1000)
    assert other.snapshot() == before
    world.masses, world.forces = 1, ()
    world.step(0.01, steps=3)


numbers = st.one_of(
    st.sampled_from([0.0, 1.0, -1.0, 1e-30, 1e18, -1e18, 1e9, -1e9]),
    st.floats(-1e18, 1e18),
    st.floats(-10, 10),
)
positive = st.one_of(st.sampled_from([1e-30, 1e-3, 1.0, 1e6, 1e18]), st.floats(1e-6, 100))
shares = st.floats(0, 1)
sizes = st.one_of(st.just(0.0), positive)


@st.composite
def forces(draw: st.DrawFn, n: int) -> list[jostle.Force]:
    """Any forces on n particles."""
    found: list[jostle.Force] = []
    if draw(st.booleans()):
        found.append(jostle.Gravitation(draw(numbers), draw(sizes), draw(shares)))
    if n and draw(st.booleans()):
        law = draw(st.sampled_from(["harmonic", "inverse_square"]))
        particle = draw(st.integers(0, n - 1))
        found.append(jostle.Attractor(particle=particle, strength=draw(numbers), law=law))
    if n > 1 and draw(st.booleans()):
        pairs = draw(st.lists(st.permutations(range(n)).map(lambda p: p[:2]), max_size=3))
        ends = np.array(pairs, int).reshape(-1, 2)
        stretch = draw(st.one_of(st.none(), sizes))
        found.append(
            jostle.Springs(ends, draw(sizes), draw(sizes), damping=draw(sizes), max_stretch=stretch)
        )
    if draw(st.booleans()):
        found.append(jostle.Thermostat(draw(sizes), draw(shares)))
    return found


@st.composite
def worlds(draw: st.DrawFn) -> jostle.World:
    """Any world of a few particles that can be made: its numbers may be extreme."""
    n = draw(st.integers(0, 5))

    def column(of: st.SearchStrategy[float]) -> list[float]:
        return draw(st.lists(of, min_size=n, max_size=n))

    def vectors() -> np.ndarray:
        return np.array([column(numbers), column(numbers)], FLOAT).T.reshape(n, 2)

    container = draw(
        st.one_of(
            st.none(),
            st.builds(lambda x, w: jostle.Box(x, x, FLOAT(x) + w, FLOAT(x) + w), numbers, positive),
            st.builds(lambda x, r: jostle.Circle((x, x), r), numbers, positive),
            st.tuples(positive, positive),
        )
    )
    return jostle.World(
        vectors(),
        column(sizes),
        velocities=vectors(),
        masses=column(positive.filter(lambda m: m <= 1e30)),
        movable=draw(st.lists(st.booleans(), min_size=n, max_size=n)),
        gravity=(draw(numbers), draw(numbers)),
        drag=draw(sizes),
        restitution=column(shares) if draw(st.booleans()) else draw(shares),
        **({"period": container} if isinstance(container, tuple) else {"container": container}),
        forces=draw(forces(n)),
        on_touch=draw(st.sampled_from(["bounce", "merge", "ignore"])),
        substeps=draw(st.integers(1, 4)),
        threads=1,
    )


@given(st.data())
def test_what_was_saved_can_be_loaded(data: st.DataObject) -> None:
    try:
        world = data.draw(worlds())
    except ValueError:
        return  # There is no such world.
    for act in data.draw(st.lists(st.sampled_from(["step", "remove", "set"]), max_size=6)):
        before = world.snapshot()
        try:
            if act == "step":
                world.step(data.draw(st.sampled_from([1e-6, 1 / 60, 1.0, 1e9])))
            elif act == "remove" and len(world):
                world.remove([data.draw(st.integers(0, len(world) - 1))])
            elif len(world):
                world.set([0], velocities=[(data.draw(numbers), 0)], radii=data.draw(sizes))
        except ValueError:
            assert world.snapshot() == before
        again = jostle.World.restore(world.snapshot())
        assert again.snapshot() == world.snapshot()
        assert again.state_hash() == world.state_hash()


def long_step() -> tuple[jostle.World, float]:
    """A world of which one step takes seconds, and its time of step."""
    rng = np.random.default_rng(2)
    positions = rng.uniform(0, 300, (20_000, 2))
    world = jostle.World(
        positions, 1.0, velocities=rng.normal(size=(20_000, 2)), substeps=1000, threads=1
    )
    return world, 1 / 60


@pytest.mark.usefixtures("ctrl_c")
def test_one_long_step_is_interrupted_and_undone() -> None:
    world, dt = long_step()
    before = world.snapshot()
    pressed: list[float] = []

    def press() -> None:
        pressed.append(time.perf_counter())
        _thread.interrupt_main()

    timer = threading.Timer(0.2, press)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        world.step(dt)
    assert time.perf_counter() - pressed[0] < 2
    assert world.snapshot() == before
    assert world.time == 0
    timer.join()
    world.substeps = 1
    world.step(dt)  # and it is still usable
    assert world.time == dt


@pytest.mark.usefixtures("ctrl_c")
def test_a_handler_that_uses_the_world_during_a_step_is_told_why_it_cannot() -> None:
    world, dt = long_step()
    before = world.snapshot()
    signal.signal(signal.SIGINT, lambda *_: world.time)
    timer = threading.Timer(0.1, _thread.interrupt_main)
    timer.start()
    with pytest.raises(RuntimeError, match="this world is in use: a signal handler cannot use"):
        world.step(dt)
    timer.join()
    assert world.snapshot() == before


def test_a_particle_without_radius_needs_a_mass() -> None:
    sentence = r"radii\[1\] is 0; its mass, the square of the radius, would be 0e0, but must"
    with pytest.raises(ValueError, match=sentence):
        jostle.World([(0, 0), (1, 1)], [1, 0])
    assert len(jostle.World([(0, 0), (1, 1)], [1, 0], masses=1)) == 2
