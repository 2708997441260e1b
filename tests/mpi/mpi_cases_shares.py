"""Random worlds with random shares, and particles with many contacts, compared with one process."""

from typing import Any

import numpy as np
from mpi_checks import check_touches, expected_now, refuse, step_alike
from mpi_worlds import comm, up_to

import jostle
import jostle.mpi

#: Columns that a rank may leave out if its particles have the default value.
DEFAULTS: dict[str, Any] = {
    **{"restitution": 1.0, "friction": 0.0, "movable": True, "sensors": False},
    **{"angles": 0.0, "angular_velocities": 0.0, "categories": 1, "masks": 0xFFFFFFFF},
}

H = 1 / 60


def default_masses(radii: np.ndarray) -> np.ndarray:
    return (radii.astype(np.float32) ** 2).astype(np.float32)


def shares(rng: np.random.Generator, n: int) -> slice:
    """This rank's rows if the ranks have random shares, of which some are empty."""
    cuts = rng.choice([0, n, *rng.integers(0, n + 1, 2)], comm().size - 1)
    ends = [0, *sorted(cuts), n]
    return slice(ends[comm().rank], ends[comm().rank + 1])


def share_of(
    rng: np.random.Generator, columns: dict[str, Any], settings: dict[str, Any]
) -> jostle.mpi.World:
    """A distributed world; each rank leaves out columns if it can."""
    mine = shares(rng, len(columns["positions"]))
    own = {name: column[mine] for name, column in columns.items()}
    random = np.random.default_rng(comm().rank)
    for name, default in {**DEFAULTS, "masses": default_masses(own["radii"])}.items():
        if name in own and (own[name] == default).all() and random.random() < 0.7:
            del own[name]
    positions, velocities, radii = (own.pop(name) for name in ("positions", "velocities", "radii"))
    ours = jostle.mpi.World(comm(), positions, radii, velocities=velocities, **own, **settings)
    ours._core._rebalance_every(2)
    return ours


def random_world(seed: int) -> tuple[dict[str, Any], dict[str, Any]]:
    """Columns and settings. Speeds are up to 1,000 radii in a step."""
    rng = np.random.default_rng(seed)

    def maybe(chance: float = 0.5) -> bool:
        return rng.random() < chance

    n = int(rng.choice([0, 1, 2, 5, 20, 60, 120], p=[0.05, 0.05, 0.05, 0.15, 0.2, 0.3, 0.2]))
    side = float(rng.uniform(2, 5)) * np.sqrt(n + 1.0)
    radii = rng.uniform(0.3, 1.0, n) if maybe() else np.ones(n)
    if n and maybe(0.2):
        radii[rng.integers(n)] = 0.3 * side
    speed = 60 * 10 ** rng.uniform(-2, 3)
    fast = rng.random(n) < rng.choice([0.02, 0.2, 1.0])
    velocities = rng.normal(0, 1, (n, 2)) * np.where(fast, speed, 1.0)[:, None]
    if len(velocities):
        velocities *= min(1.0, 60_000 / np.abs(velocities).max())
    # Many rows have the default values, so that a rank may have no others.
    some = np.arange(n) >= rng.integers(0, n + 1)

    def column(default: Any, given: Any) -> np.ndarray:
        values: np.ndarray = np.where(some, given, default)
        return values

    columns: dict[str, Any] = {
        "positions": rng.uniform(0, side, (n, 2)),
        "velocities": velocities,
        "radii": radii,
    }
    defaults = {**DEFAULTS, "masses": default_masses(radii)}
    choices = {
        "restitution": rng.choice([0.0, 0.5, 0.9], n),
        "friction": rng.uniform(0, 1, n),
        "masses": 10 ** rng.uniform(-2, 2, n),
        "movable": rng.random(n) < 0.7,
        "sensors": rng.random(n) < 0.3,
        "angles": rng.uniform(-3, 3, n),
        "angular_velocities": rng.normal(0, 5, n),
        "categories": 1 << rng.integers(0, 3, n),
        "masks": rng.integers(1, 8, n),
    }
    for name, values in choices.items():
        if maybe(0.4):
            columns[name] = column(defaults[name], values)
    settings: dict[str, Any] = {"on_touch": rng.choice(["bounce"] * 5 + ["merge", "ignore"])}
    if settings["on_touch"] == "merge":
        columns.pop("sensors", None)
    regions: tuple[dict[str, Any], ...] = (
        {},
        {"container": jostle.Box(0, 0, side, side)},
        {"period": (side, side)},
    )
    settings |= regions[rng.integers(3)]
    if "restitution" not in columns and maybe():
        columns["restitution"] = np.full(n, rng.choice([0.0, 0.6]), np.float32)
    if maybe(0.6):
        settings["gravity"] = (0.0, float(rng.choice([-10.0, 300.0])))
    if maybe(0.3):
        settings["walls"] = rng.uniform(0, side, (2, 2, 2))
    if maybe(0.2):
        settings["substeps"] = int(rng.integers(1, 4))
    if maybe(0.3):
        settings["track_events"] = True
    if maybe(0.2):
        settings["drag"] = 0.3
    return columns, settings


def compare(seed: int, steps: int = 3) -> None:
    """Compare a random world with one process."""
    columns, settings = random_world(seed)
    try:
        world = jostle.World(**columns, **settings)
    except ValueError:
        refuse(lambda: share_of(np.random.default_rng(seed), columns, settings), "")
        return
    ours = share_of(np.random.default_rng(seed), columns, settings)
    for step in range(steps):
        try:
            world.step(H)
        except ValueError:
            refuse(lambda: ours.step(H), "")
        else:
            ours.step(H)
            check_touches(f"seed {seed}", ours, expected_now(world, []))
            assert ours.last_step.substeps == world.last_step.substeps or not len(world), (
                seed,
                step,
            )
        assert ours.state_hash() == world.state_hash(), (seed, step)


@up_to(3)
def test_random_shares() -> None:
    # With more ranks than cores each message takes long.
    for seed in range(16 if comm().size < 3 else 4):
        compare(seed)


@up_to(3)
def test_substeps_are_decided_by_all_ranks() -> None:
    """The only particles with friction, or that lose energy, are on one rank."""
    n = 40
    positions = np.column_stack([np.arange(n) * 2.5, np.zeros(n)])
    columns: dict[str, Any] = {"positions": positions, "radii": np.ones(n)}
    columns["velocities"] = np.zeros((n, 2))
    gravity: dict[str, Any] = {"gravity": (0.0, -9.8), "container": jostle.Box(-2, -2, 100, 40)}
    for name, value in (("friction", 0.3), ("restitution", 0.5)):
        for first in (0, n - 1):
            column: Any = np.full(n, DEFAULTS[name])
            column[first:] = value
            world = jostle.World(**columns, **{name: column}, **gravity)
            mine = np.arange(n) < first if comm().rank else np.arange(n) >= first
            if comm().rank > 1:
                mine[:] = False
            if first and comm().size > 1:
                order = np.r_[n - 1, : n - 1]  # ids are in the order of ranks
                ordered: dict[str, Any] = {
                    key: of[order] for key, of in {**columns, name: column}.items()
                }
                world = jostle.World(**ordered, **gravity)
            elif comm().size == 1:
                mine[:] = True
            own = {key: of[mine] for key, of in columns.items()}
            if len(own["radii"]) and (column[mine] != DEFAULTS[name]).any():
                own[name] = column[mine]
            ours = jostle.mpi.World(comm(), **own, **gravity)
            step_alike(name, ours, world, H, 5)
            assert ours.last_step.substeps == world.last_step.substeps == 4
            ids = ours.ids
            for one, rows in ((world, np.arange(n)), (ours, ids)):
                one.set(rows, **{name: DEFAULTS[name]})
            step_alike(name, ours, world, H, 1)
            assert ours.last_step.substeps == world.last_step.substeps == 1
            ours.substeps = world.substeps = 3
            step_alike(name, ours, world, H, 1)
            assert ours.last_step.substeps == world.last_step.substeps == 3
            ours.substeps = world.substeps = None
            step_alike(name, ours, world, H, 1)
            assert ours.last_step.substeps == world.last_step.substeps == 1
    if comm().size > 1:
        given = {} if comm().rank else {"substeps": 4}
        refuse(lambda: jostle.mpi.World(comm(), **own, **gravity, **given), "substeps is not the")


def check_shared(columns: dict[str, Any], settings: dict[str, Any], steps: int) -> None:
    """Compare a world, with random shares, with one process."""
    world = jostle.World(**columns, **settings)
    ours = share_of(np.random.default_rng(1), columns, settings)
    step_alike("many contacts", ours, world, H, steps)
    check_touches("many contacts", ours, expected_now(world, []))


def test_fast_discs() -> None:
    """Discs over a quarter of the area that move by 12 radii a step, and some by 1,000."""
    rng = np.random.default_rng(3)
    n = 5000
    side = int(np.ceil(np.sqrt(n)))
    cells = rng.permutation(side * side)[:n]
    positions = (np.column_stack([cells % side, cells // side]) + 0.5) * np.sqrt(4 * np.pi)
    angles = rng.uniform(0, 2 * np.pi, n)
    speeds = 1.6 / H * rng.lognormal(0, 2, n)
    velocities = speeds[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    columns = {"positions": positions, "velocities": velocities, "radii": np.ones(n)}
    width = side * float(np.sqrt(4 * np.pi))
    settings = {"gravity": (0.0, -10.0), "restitution": 0.9, "friction": 0.2}
    check_shared(columns, {"container": jostle.Box(0, 0, width, width), **settings}, 1)


def test_a_large_disc_on_small_ones() -> None:
    rng = np.random.default_rng(4)
    n = 1000
    small = np.column_stack([np.arange(n) % 200 * 0.21, np.arange(n) // 200 * 0.21]) + 0.12
    positions = np.vstack([small, [(21, 101.2)]])
    velocities = np.vstack([rng.normal(0, 0.05, (n, 2)), [(0, -60)]])
    columns = {
        **{"positions": positions, "velocities": velocities, "radii": np.r_[np.full(n, 0.1), 100]},
        "friction": np.full(n + 1, 0.4),
    }
    settings = {"gravity": (0.0, -10.0), "container": jostle.Box(-80, 0, 122, 400)}
    check_shared(columns, {"restitution": 0.3, **settings}, 1)
