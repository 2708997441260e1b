"""`Pump`: what is in a drain starts again from a nozzle."""

import copy
import math
import pickle
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import jostle

DRAIN = (0, 0, 100, 10)


def pump(**changes: Any) -> jostle.Pump:
    """A pump that takes everything at once, unless a rate is given."""
    given: dict[str, Any] = {"drain": DRAIN, "position": (50, 50), "velocity": (0, 20), "rate": 1e9}
    return jostle.Pump(**given | changes)


def pool(n: int, **rules: Any) -> jostle.World:
    """Discs at rest in the drain, so small that they do not touch."""
    at = np.random.default_rng(1).uniform((1, 1), (99, 9), (n, 2))
    return jostle.World(at, 1e-4, masses=1.0, **{"on_touch": "ignore"} | rules)


def test_they_are_values() -> None:
    one = pump(rate=2, width=3, spread=1, seed=5)
    assert repr(one) == (
        "Pump((0.0, 0.0, 100.0, 10.0), (50.0, 50.0), (0.0, 20.0), rate=2.0, width=3.0, spread=1.0, "
        "seed=5)"
    )
    assert (one.drain, one.position, one.velocity) == (DRAIN, (50, 50), (0, 20))
    assert (one.rate, one.width, one.spread, one.seed) == (2, 3, 1, 5)
    assert pump(drain=jostle.Box(*DRAIN)) == pump() != pump(seed=1)
    world = pool(3, forces=[one, pump()])
    for same in (copy.copy(one), pickle.loads(pickle.dumps(one)), world.forces[0],
                 jostle.World.restore(world.snapshot()).forces[0]):  # fmt: skip
        assert same == one and hash(same) == hash(one)


def test_only_movable_particles_in_the_drain_are_taken() -> None:
    world = jostle.World(
        [(5, 5), (50, 10.5), (20, 5), (100, 10)], 0.01, masses=[1, 2, 3, 4],
        movable=[True, True, False, True], angular_velocities=3, categories=7,
        forces=[pump(velocity=(6, 8), width=4, spread=0.5)],
    )  # fmt: skip
    world.step(0.1)
    assert world.positions[1:3].tolist() == [[50, 10.5], [20, 5]]
    for id in (0, 3):
        one = world.get(id)
        assert (one.masses, one.angular_velocities, one.categories) == (id + 1, 3, 7)
        assert np.hypot(*(one.velocities - (6, 8))) <= 0.5 + 1e-6
        # It has left the line of the nozzle at some time of the step before this one began.
        along, across = (
            np.array(way) @ (one.positions - (50, 50)) for way in ((0.6, 0.8), (-0.8, 0.6))
        )
        assert 1.0 - 0.2 <= along <= 2.0 + 0.2 and abs(across) <= 2 + 0.1
    world.step(0.1)
    assert world.time == 0.2 and world.ids.tolist() == [0, 1, 2, 3]


@pytest.mark.parametrize("steps", [1, 8, 120])
def test_the_rate_does_not_depend_on_the_length_of_steps(steps: int) -> None:
    n, rate, seconds = 4000, 0.6, 1.0
    world = pool(n, forces=[pump(rate=rate)])
    world.step(seconds / steps, steps)
    taken = (world.velocities[:, 1] > 0).sum()
    share = 1 - math.exp(-rate * seconds)
    assert abs(taken - n * share) < 4 * math.sqrt(n * share * (1 - share))
    # Those in the jet are spread over what it flies in this time, denser at its beginning.
    height = np.sort(world.positions[world.velocities[:, 1] > 0, 1] - 50)
    if steps > 1:
        expected = -np.log(1 - np.linspace(0, share, len(height))) / rate  # seconds when taken
        flown = np.sort(20 * (seconds - expected))
        assert abs(height - flown).max() < 20 * (0.05 + 1 / steps)
    else:
        assert np.quantile(height, [0.25, 0.5, 0.75]) == pytest.approx([25, 30, 35], abs=1)


def test_places_and_velocities_at_the_nozzle() -> None:
    world = pool(20_000, forces=[pump(width=8, spread=3)])
    world.step(1e-6)
    aside = world.positions[:, 0] - 50
    assert np.quantile(aside, [0, 0.25, 0.5, 0.75, 1]) == pytest.approx([-4, -2, 0, 2, 4], abs=0.15)
    deviations = np.hypot(*(world.velocities - (0, 20)).T) / 3
    assert deviations.max() <= 1 + 1e-6
    assert np.quantile(deviations, [0.25, 0.5, 0.75]) == pytest.approx(
        [0.5, 0.707, 0.866], abs=0.02
    )
    still = pool(100, forces=[pump(velocity=(0, 0), width=8)])
    still.step(1.0)
    assert np.ptp(still.positions[:, 0]) > 6 and (still.positions[:, 1] == 50).all()


def fountain(order: np.ndarray | None = None, **rules: Any) -> jostle.World:
    """A small basin with friction and two pumps, whose drains overlap."""
    at = np.mgrid[0:30, 0:12].reshape(2, -1).T * 2.05 + 1.1
    order = np.arange(len(at)) if order is None else order
    radii = np.random.default_rng(3).uniform(0.8, 1.0, len(at))
    return jostle.World(
        at[order], radii[order], gravity=(0, -10), restitution=0.3, friction=0.2,
        container=jostle.Box(0, 0, 62, 80), track_events=True,
        forces=[
            pump(drain=(0, 0, 40, 5), position=(15, 30), velocity=(6, 20), rate=2, width=3),
            pump(drain=(30, 0, 62, 5), position=(45, 30), velocity=(-6, 20), rate=2, spread=1),
        ],
        **rules,
    )  # fmt: skip


def test_the_bits_do_not_depend_on_threads_order_and_method() -> None:
    order = np.random.default_rng(2).permutation(360)
    worlds = [fountain(threads=1), fountain(threads=2), fountain(method="brute"), fountain(order)]
    for world in worlds:
        world.step(1 / 60, 60)
    assert len({world.state_hash() for world in worlds[:3]}) == 1
    assert (worlds[3].positions == worlds[0].positions[order]).all()
    again = jostle.World.restore(worlds[0].snapshot())
    for world in (worlds[0], again):
        world.step(1 / 60, 30)
    assert again.state_hash() == worlds[0].state_hash() and again.events == worlds[0].events
    assert not worlds[0].asleep.any()


def test_a_pair_that_a_pump_parts_ceases_to_touch() -> None:
    world = jostle.World(
        [(5, 5), (7, 5)], 1.0, track_events=True, forces=[pump(drain=(0, 0, 6, 9), rate=0.0)]
    )
    world.step(0.1)
    assert world.events.entered.tolist() == [[0, 1]]
    world.forces = [pump(drain=(0, 0, 6, 9))]
    world.step(0.1)
    assert world.events.exited.tolist() == [[0, 1]] and world.positions[0, 1] > 49


def test_a_refused_step_leaves_all_where_it_was() -> None:
    world = pool(50, forces=[pump(velocity=(1e18, 0))], period=200)
    before, unwrapped = world.state_hash(), world.unwrapped_positions
    with pytest.raises(ValueError, match=r"^dt is 1000000; particle .* would "):
        world.step(1e6)
    assert world.state_hash() == before and world.time == 0
    assert (world.unwrapped_positions == unwrapped).all()
    assert sorted(world.query_rect((0, 0, 100, 10)).tolist()) == list(range(50))
    world.forces = [pump(position=(199, 50), velocity=(20, 0))]
    world.step(0.5)
    # Paths begin anew at the nozzle.
    periods = (world.unwrapped_positions - world.positions)[:, 0] / 200
    assert abs(periods - periods.round()).max() < 1e-6
    assert (world.unwrapped_positions[:, 0] > 199).all()


WRONG: list[tuple[Callable[[], Any], type[Exception], str]] = [
    (lambda: pump(drain=(0, 0, 0, 1)), ValueError, "drain is (0, 0, 0, 1); its min must be below"),
    (lambda: pump(drain=(0, 0, 1)), ValueError, "drain has shape (3,)"),
    (lambda: pump(drain=[(0, 0, 1, 1)]), ValueError, "drain has shape (1, 4); it must be (4,)"),
    (lambda: pump(drain=(0, 0, math.inf, 1)), ValueError, "drain is (inf, 1); both"),
    (lambda: pump(position=(0, math.nan)), ValueError, "position is (0, NaN); both"),
    (lambda: pump(velocity=3), ValueError, "velocity is 3; it must be two numbers"),
    (lambda: pump(rate=-1), ValueError, "rate is -1; it must be finite and"),
    (lambda: pump(rate=math.inf), ValueError, "rate is inf; it must be finite and"),
    (lambda: pump(width=-1), ValueError, "width is -1; it must be finite and"),
    (lambda: pump(spread="a"), TypeError, "spread must be a number, not str"),
    (lambda: pump(seed=-1), ValueError, "seed is -1; it must be at least 0"),
    (lambda: jostle.Pump(DRAIN, (0, 0)), TypeError, ""),  # type: ignore[call-arg]
]


@pytest.mark.parametrize(("make", "error", "message"), WRONG)
def test_wrong_ones_are_refused(
    make: Callable[[], Any], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=f"^{re.escape(message)}"):
        make()
