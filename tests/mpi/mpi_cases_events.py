"""Pairs that touch and particles that merge, of different ranks."""

from pathlib import Path
from typing import Any

import numpy as np
from mpi_checks import check_asleep, check_asleep_now, check_events, check_saved, step_all
from mpi_worlds import (
    REST,
    comm,
    evenly,
    gas,
    of_rank,
    on_last,
    scattered,
    unevenly,
    up_to,
    with_folder,
)

import jostle
import jostle.mpi


def test_events() -> None:
    """All ranks together have the events of one process, also of pairs that move to other ranks."""
    kinds = np.arange(400) % 5
    categories = 1 + np.arange(400) % 6
    options: dict[str, Any] = {"track_events": True, "container": "torus", "categories": categories}
    still: dict[str, Any] = {"movable": kinds > 1, "sensors": kinds < 2}
    for name, world, steps in (
        ("gas", gas(400, cover=0.6, **options), 3),
        ("sensors", gas(400, **still, **options), 4),
        ("ignore", gas(400, on_touch="ignore", **options), 2),
        ("rest", gas(40, track_events=True, categories=categories[:40], **REST), 1),
    ):
        ours = scattered(world, unevenly, every=3)
        seen = 0
        for call in range(8):
            if call == 5:
                # Events have the new categories, unless a pair has touched only before.
                changed, new = world.ids[::3], np.arange(len(world))[::3] % 5 + 8
                world.set(changed, categories=new)
                ours.set(of_rank(changed), categories=of_rank(new))
                gone = world.ids[1::40]
                world.remove(gone)
                ours.remove(of_rank(gone))
            step_all((world, ours), 1 / 60, steps)
            seen += check_events(name, ours, world)
        assert seen > 0, name
    for kind in ("events", "wall_events"):
        untracked = scattered(gas(9), evenly)
        try:
            getattr(untracked, kind)
        except RuntimeError as error:
            assert "track_events=True" in str(error)
        else:
            raise AssertionError(kind)


def fenced(**options: Any) -> jostle.World:
    """A gas with walls, of which every second one is a sensor, some of which move."""
    draw = np.random.default_rng(3)
    world = gas(300, cover=0.4, track_events=True, categories=1 + np.arange(300) % 4, **options)
    (left, bottom), (right, top) = world.positions.min(axis=0), world.positions.max(axis=0)
    starts = draw.uniform((left, bottom), (right, top), (24, 2))
    segments = np.stack([starts, starts + draw.normal(0, 6, (24, 2))], axis=1)
    velocities = np.where(np.arange(24)[:, None] % 4 > 1, (3.0, 1.0), (0.0, 0.0))
    sensors, categories = np.arange(24) % 2 == 0, 1 + np.arange(24) % 3
    world.walls.add(segments, velocities=velocities, sensors=sensors, categories=categories)
    return world


def test_wall_events() -> None:
    """Sensors and solid walls, also of particles that cross a sensor within one step, that move to
    other ranks meanwhile, and that are removed, as walls are."""
    for name, world, dt, steps in (
        ("fences", fenced(), 1 / 60, 3),
        ("torus", fenced(container="torus"), 1 / 60, 3),
        ("long steps", fenced(container="torus", on_touch="ignore"), 0.5, 1),
        ("rest", fenced(**REST), 1 / 60, 2),
    ):
        ours = scattered(world, unevenly, every=2)
        crossed, sides = 0, 0
        for call in range(6):
            step_all((world, ours), dt, steps)
            check_events(name, ours, world)
            events = world.wall_events
            ways = set(map(tuple, events.entered)) & set(map(tuple, events.exited))
            crossed += sum(wall % 2 == 0 and wall >= 0 for _, wall in ways)
            sides += int((events.entered[:, 1] < 0).sum())
            if call == 3:
                gone = world.ids[[0, 7, 150, 299]]
                world.remove(gone)
                ours.remove(of_rank(gone))
                for one in (world, ours):
                    one.walls.remove([0, 5])
        centers = world.positions[::10]
        rays = {"origin": centers, "direction": (3.0, 1.0), "max_distance": 20.0}
        for query in ("raycast", "shape_cast"):
            found = [getattr(of.walls, query)(**rays) for of in (world, ours)]
            assert found[0] == found[1] and (found[0].ids >= 0).any(), query
        assert world.walls.nearest(centers) == ours.walls.nearest(centers)
        assert world.state_hash() == ours.state_hash(), name
        assert crossed > 0 or name != "long steps"
        assert sides > 0 or world.container is None


def check_merged(name: str, ours: jostle.mpi.World, world: jostle.World) -> None:
    """The same state, ids, new ids, contacts with walls and events."""
    check_asleep(name, ours, world)
    assert ours.total == len(world), name
    found, expected = ours.renumbered, world.renumbered
    assert (found is None) == (expected is None), name
    if found is not None and expected is not None:
        assert np.array_equal(found, expected), name
    if world.track_events:
        check_events(name, ours, world)


@up_to(3)
@with_folder
def test_merging(folder: Path) -> None:
    """Particles of different ranks that touch merge."""
    rows = np.arange(400)
    bits = 1 << rows % 9
    table = np.random.default_rng(4).normal(0, 60, (3, 3, 12))
    rolling = {"friction": 0.3, "angular_velocities": 2.0, "restitution": 0.5 + rows % 3 * 0.2}
    walls = jostle.polyline([(0, 30), (25, 36), (50, 20)])
    options: dict[str, dict[str, Any]] = {
        "box": {"gravity": (0.0, 30.0), "walls": walls, "track_events": True, "categories": bits},
        "plane": {"container": None, "masses": np.where(rows % 7, 1.0, 3e29)},
        "torus": {"container": "torus", "track_events": True, **rolling},
        "forces": {"forces": [jostle.PairForce(table, 6.0)], "kinds": rows % 3, "substeps": 2},
        "obstacles": {"movable": rows % 11 > 0, "sensors": rows % 13 == 0, "track_events": True},
        "filters": {"categories": 1 << rows % 3, "masks": 7 ^ (1 << rows % 3)},
        "long steps": {"container": "torus"},
    }
    # With more ranks than cores each message takes long.
    some = list(options.items())[: len(options) if comm().size < 3 else 3]
    for number, (name, rules) in enumerate(some):
        world = gas(400, cover=0.3, on_touch="merge", **rules)
        ours = scattered(world, (evenly, unevenly, on_last)[number % 3], every=3)
        for steps in (1, 2, 3):
            dt = 0.4 if name == "long steps" else 1 / 60
            step_all((world, ours), dt, steps)
            check_merged(name, ours, world)
        assert 5 < ours.total < 395, (name, ours.total)
        new, gone = np.array([(3.0, 3.0), (4.0, 3.0)]), world.ids[[1, 5]]
        for one, own in ((world, lambda rows: rows), (ours, of_rank)):
            one.remove(own(gone))
            if name != "forces":
                radii = own(np.array([0.5, 0.7]))
                # Of worlds without friction and with elastic collisions they are so, too.
                is_rolling = name == "torus"
                given = {"friction": 0.2 * is_rolling, "restitution": 1 - 0.1 * is_rolling}
                given["masses"] = 1.0
                one.add(own(new), radii, velocities=own(new), **given)
        check_asleep_now(f"{name}, changed", ours, world)
        check_saved(folder / f"merging-{number}", ours, world, 5)
        for one in (world, ours):
            one.on_touch = "bounce"
            one.step(1 / 60)
            one.on_touch = "merge"
            one.step(1 / 60, 2)
        check_asleep_now(name, ours, world)
