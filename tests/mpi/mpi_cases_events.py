"""Pairs that touch and particles that merge, of different ranks."""

from pathlib import Path
from typing import Any

import numpy as np
from mpi_checks import check_asleep, check_asleep_now, check_events, check_saved, step_all
from mpi_worlds import REST, evenly, gas, of_rank, on_last, scattered, unevenly, up_to, with_folder

import jostle
import jostle.mpi


def test_events() -> None:
    """All ranks together have the events of one process, also of pairs that move to other ranks."""
    kinds = np.arange(400) % 5
    options: dict[str, Any] = {"track_events": True, "container": "torus"}
    still = {"movable": kinds > 1, "sensors": kinds < 2}
    for name, world, steps in (
        ("gas", gas(400, cover=0.6, **options), 3),
        ("sensors", gas(400, **still, **options), 4),
        ("ignore", gas(400, on_touch="ignore", **options), 2),
        ("rest", gas(40, track_events=True, **REST), 1),
    ):
        ours = scattered(world, unevenly, every=3)
        seen = 0
        for _ in range(8):
            step_all((world, ours), 1 / 60, steps)
            seen += check_events(name, ours, world)
        assert seen > 0, name
    try:
        _ = scattered(gas(9), evenly).events
    except RuntimeError as error:
        assert "track_events=True" in str(error)


def check_merged(name: str, ours: jostle.mpi.World, world: jostle.World) -> None:
    """The same state, ids, new ids, contacts with walls and events."""
    check_asleep(name, ours, world)
    assert ours.total == len(world), name
    found, expected = ours.renumbered, world.renumbered
    assert (found is None) == (expected is None), name
    assert found is None or np.array_equal(found, expected), name
    if world.track_events:
        check_events(name, ours, world)


@up_to(3)
@with_folder
def test_merging(folder: Path) -> None:
    """Particles of different ranks that touch merge."""
    rows = np.arange(400)
    table = np.random.default_rng(4).normal(0, 60, (3, 3, 12))
    rolling = {"friction": 0.3, "angular_velocities": 2.0, "restitution": 0.5 + rows % 3 * 0.2}
    walls = jostle.polyline([(0, 30), (25, 36), (50, 20)])
    options: dict[str, dict[str, Any]] = {
        "box": {"gravity": (0.0, 30.0), "walls": walls, "track_events": True},
        "plane": {"container": None, "masses": np.where(rows % 7, 1.0, 3e29)},
        "torus": {"container": "torus", "track_events": True, **rolling},
        "forces": {"forces": [jostle.PairForce(rows % 3, table, 6.0)], "substeps": 2},
        "obstacles": {"movable": rows % 11 > 0, "sensors": rows % 13 == 0, "track_events": True},
        "filters": {"categories": 1 << rows % 3, "masks": 7 ^ (1 << rows % 3)},
        "long steps": {"container": "torus"},
    }
    for number, (name, rules) in enumerate(options.items()):
        world = gas(400, cover=0.3, on_touch="merge", **rules)
        ours = scattered(world, (evenly, unevenly, on_last)[number % 3], every=3)
        for steps in (1, 2, 8):
            dt = 0.4 if name == "long steps" else 1 / 60
            step_all((world, ours), dt, steps)
            check_merged(name, ours, world)
        assert 5 < ours.total < 390, (name, ours.total)
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
