"""Motion, containers, forces and settings of distributed worlds, compared with one process."""

from functools import partial
from typing import Any

import numpy as np
from mpi_checks import check, check_events, refuse, step_alike, step_all
from mpi_worlds import REST, comm, evenly, gas, on_first, on_last, scattered, unevenly, up_to

import jostle
import jostle.mpi


@up_to(4)
def test_gas() -> None:
    check("gas", gas(), 1 / 60, 50)
    # The first step moves all particles to the same domains, wherever they were.
    for where in (on_first, on_last, unevenly):
        check("gas", gas(), 1 / 60, 10, where)


def check_scenes(n: int, steps: int) -> None:
    """Compare all scenes that are not refused."""
    done = []
    for name in jostle.scenes.names():
        world = jostle.scenes.create(name, n=n, seed=3)
        world.sleeping = False
        try:
            scattered(world, evenly)
        except ValueError:
            continue
        check(name, world, 1 / 60, steps, unevenly)
        done.append(name)
    assert {"gas", "pile"} <= set(done), done


@up_to(3)
def test_scenes() -> None:
    check_scenes(60, 3)


def test_piles() -> None:
    rest = REST
    check("pile", gas(150, **rest), 1 / 60, 25)
    check("pile", gas(150, **rest), 1 / 60, 5, on_first)
    check("friction", gas(120, friction=0.5, **rest), 1 / 60, 15)
    for heaviest in (30.0, 300.0):  # 4 sub-steps, and up to 12
        masses = np.where(np.arange(120) % 5 == 0, heaviest, 1.0)
        check("uneven masses", gas(120, masses=masses, **rest), 1 / 60, 15)
    walls = jostle.polyline([(0, 20), (12, 25), (24, 15)])
    check("walls", gas(120, walls=walls, friction=0.3, **rest), 1 / 60, 15)


@up_to(3)
def test_obstacles() -> None:
    """Two discs of different ranks rest on an immovable one of a third."""
    movable = np.arange(120) % 9 > 0
    still = gas(120, movable=movable, velocities=np.zeros((120, 2)), **REST)
    check("obstacles", still, 1 / 60, 25)


def test_refined() -> None:
    """More sub-steps in the steps in which heavy discs rest."""
    masses = np.where(np.arange(60) % 5 == 0, 300.0, 1.0)
    world = gas(60, masses=masses, **REST)
    ours = scattered(world, unevenly, every=4)
    counts = []
    for step in range(7):
        step_alike("refined", ours, world, 0.2)
        assert ours.last_step.substeps == world.last_step.substeps, step
        counts.append(world.last_step.substeps)
    # With masses of 1 each step has 4.
    assert min(counts) == 4 and max(counts) >= 12, counts


def test_long() -> None:
    """300 steps of all scenes, and of a larger gas and a larger pile."""
    check_scenes(40, 300)
    check("gas", jostle.scenes.create("gas", n=1000, seed=3), 1 / 60, 300)
    pile = jostle.scenes.create("pile", n=120, seed=3)
    pile.sleeping = False
    check("pile", pile, 1 / 60, 300)


@up_to(3)
def test_torus() -> None:
    """Domains that are neighbours across the sides of a torus."""
    check("torus", gas(container="torus"), 1 / 20, 50)
    # Steps so long that they are divided, and trajectories around the torus.
    check("long steps on a torus", gas(200, container="torus"), 0.5, 5)


def test_containers() -> None:
    check("plane", gas(container=None), 1 / 20, 40)
    check("circle", gas(container=jostle.Circle((22, 22), 40)), 1 / 20, 50)
    check("long steps", gas(200, cover=0.05), 0.5, 10)
    walls = jostle.polyline([(5, 5), (20, 25), (30, 10)])
    check("walls", gas(walls=walls), 1 / 20, 50)


def test_rules() -> None:
    # A granular gas with friction: it cools down and forms clusters.
    cooling = gas(restitution=0.8, friction=0.3, angular_velocities=2.0, container="torus")
    check("granular gas", cooling, 1 / 20, 100)
    check("gravity, elastic", gas(gravity=(0, 30)), 1 / 20, 50)
    check("damping and sub-steps", gas(drag=0.5, substeps=3), 1 / 20, 50)
    check("ignore", gas(on_touch="ignore"), 1 / 20, 40)
    hot = jostle.ThermalWalls(400.0, seed=3)
    check("thermal walls", gas(forces=[hot]), 1 / 20, 50)
    check("thermostat", gas(forces=[jostle.Thermostat(30.0, 0.5)]), 1 / 20, 50)
    bath = jostle.AndersenThermostat(400.0, 2.0, seed=3)
    check("bath", gas(forces=[bath], container="torus"), 1 / 20, 50)
    kinds = np.arange(600) % 3
    check("filters", gas(categories=1 << kinds, masks=7 ^ (1 << kinds)), 1 / 20, 50)
    check("sensors", gas(sensors=kinds == 0), 1 / 20, 50)
    movable = np.arange(600) % 7 > 0
    check("kinematic", gas(movable=movable, container="torus"), 1 / 60, 20)


@up_to(3)
def test_chains() -> None:
    """Impacts that go through the domains of several ranks, and fewer particles than ranks."""
    for n in (0, 1, 2, 3, 5):
        check(f"{n} particles", gas(n), 1 / 60, 20)
    # Simultaneous impacts along a line and in a rack of discs that touch.
    row = np.column_stack([np.arange(40) * 2.0, np.zeros(40)])
    velocities = np.zeros((40, 2))
    velocities[0, 0] = 30.0
    row[0, 0] = -5.0
    check("a line", jostle.World(row, 1.0, velocities=velocities), 1 / 60, 60, unevenly)
    lattice = np.stack(np.meshgrid(np.arange(12.0), np.arange(12.0)), -1).reshape(-1, 2)
    lattice[:, 0] += 0.5 * (np.arange(144) // 12 % 2)
    lattice[:, 1] *= np.sqrt(0.75)
    velocities = np.zeros((144, 2))
    velocities[:12] = (0.0, 9.0)
    check("a rack", jostle.World(lattice * 2, 1.0, velocities=velocities), 1 / 60, 60)


def test_nasty() -> None:
    # Discs that overlap at the beginning, and coincident ones.
    rng = np.random.default_rng(2)
    heap = rng.uniform(0, 20, (70, 2))
    heap[:10] = 10.0
    overlapping = jostle.World(heap, 1.0, velocities=rng.normal(0, 5, (70, 2)), period=(20, 20))
    check("overlaps", overlapping, 1 / 60, 20)
    # One disc that is much larger than the others, one that is much faster, and one far away.
    world = gas(500)
    velocities = world.velocities.copy()
    velocities[3] = (5000.0, 3000.0)
    world.velocities = velocities
    check("a fast disc", world, 1 / 60, 100)
    positions, radii = gas(500).positions.copy(), gas(500).radii.copy()
    positions[7], radii[7] = (22, 22), 15.0
    far = np.hypot(*(positions - positions[7]).T) > 16.5
    far[7] = True
    count = int(far.sum())
    options = {"radii": radii[far], "period": (60, 60)}
    giant = jostle.World(positions[far], velocities=rng.normal(0, 20, (count, 2)), **options)
    check("a giant", giant, 1 / 20, 50)
    positions = gas(300).positions.copy()
    positions[5] = (3e5, -2e5)
    check(
        "far away", jostle.World(positions, 0.5, velocities=rng.normal(0, 20, (300, 2))), 1 / 60, 60
    )


def test_forces() -> None:
    """Forces between neighbours, whose particles have neighbours on other ranks."""
    for name in ("life", "fluid", "flock"):
        check(name, jostle.scenes.create(name, n=300, seed=2), 1 / 60, 40, unevenly)
    kinds = np.arange(400) % 3
    table = np.random.default_rng(4).normal(0, 300, (3, 3, 12))
    long = jostle.PairForce(table, 11.0, damping=3.0)
    other = jostle.PairForce(-table, 4.0)
    flocking = jostle.Flocking(6.0, 40.0, 1.0, 0.5, max_speed=60.0)
    world = gas(400, kinds=kinds, forces=[long, flocking, other], container="torus", substeps=3)
    ours = check("three forces", world, 1 / 60, 25)
    alone = ours.gather()
    assert alone is None or np.array_equal(alone.kinds, kinds)
    world.step(1 / 60, 25)
    step_alike("three forces", ours, world, 1 / 60, 5, gathers=True)
    ours = jostle.mpi.create_scene(comm(), "life", n=100, seed=3)
    assert ours.state_hash() == jostle.scenes.create("life", n=100, seed=3).state_hash()
    if comm().size > 1:
        force = jostle.PairForce(table * (1 + comm().rank), 4.0)
        make = partial(jostle.mpi.World, comm(), [], [], forces=[force])
        refuse(make, "forces is not the same")


def test_given() -> None:
    """Accelerations and forces that the caller gives move with particles to other ranks."""
    rest = {**REST, "sleeping": True}
    for name, world in (
        ("gas", gas(200)),
        ("pile", gas(150, **rest)),
        ("rough", gas(150, friction=0.5, **rest)),
        ("merging", gas(200, on_touch="merge", movable=np.arange(200) % 9 > 0)),
    ):
        ours = scattered(world, unevenly, every=3)
        ours.substeps = None  # given accelerations need more
        for call in range(4):
            by_id = np.random.default_rng(call).normal(0, 300, (int(world.ids.max()) + 1, 2))
            by_id[:: call + 2] = 0.0
            world.accelerations = by_id[world.ids]
            ours.accelerations = by_id[ours.ids]
            expected = by_id[ours.ids].astype(np.float32) * ours.movable[:, None]
            assert np.array_equal(ours.accelerations, expected)
            # Each rank gives forces on particles of any rank, some of them twice.
            ids = world.ids[np.arange(30) * 7 % 20]
            own = ids[comm().rank :: comm().size]
            all_ids = np.concatenate([ids[rank :: comm().size] for rank in range(comm().size)])
            # Torques move with the particles, too.
            points = np.random.default_rng(call).uniform(0, 40, by_id.shape)
            at, of = (None, {}) if call == 2 else (points[all_ids], {"points": points[own]})
            world.apply_force(all_ids, by_id[all_ids], at)
            ours.apply_force(own, by_id[own], **of)
            step_alike(name, ours, world, 1 / 60, 5, gathers=call == 1)
            assert not ours.accelerations.any()
        step_alike(name, ours, world, 1 / 60, 5)
    is_last = comm().rank == comm().size - 1
    refuse(
        lambda: setattr(ours, "accelerations", np.zeros((1, 2))), "accelerations has shape (1, 2)"
    )
    wrong = np.full((len(ours), 2), np.nan if is_last else 0.0)
    refuse(lambda: setattr(ours, "accelerations", wrong), "accelerations[0] is (nan, nan)")
    refuse(lambda: ours.apply_force(10**6 if is_last else [], (0, 1) if is_last else []), "1000000")
    first = int(comm().bcast(ours.ids[ours.movable][0] if comm().rank == 0 else None))
    refuse(
        lambda: ours.apply_force([first] * 99, [(1e18, 0)] * 99), f"of particle {first} would be"
    )
    assert not ours.accelerations.any()
    step_alike("after what is refused", ours, world, 1 / 60)


def test_energy() -> None:
    """The potential energy of gravity and of forces between kinds."""
    for name in ("fluid", "pile"):
        world = jostle.scenes.create(name, n=250, seed=2)
        ours = scattered(world, unevenly)
        for _ in range(3):
            step_all((world, ours), 1 / 60, 2)
            energy = world.potential_energy()
            assert energy != 0.0
            assert abs(ours.potential_energy() - energy) <= 1e-10 * abs(energy), name
            # It does not change the world.
            assert ours.state_hash() == world.state_hash()
            ghosts = ours.ghosts
            assert len(ours.last_step.contacts.pairs) == 0 or comm().size == 1 or ghosts > 0
    table = np.ones((1, 1, 20))
    movable = np.arange(300) % 5 > 0
    for container in ("box", "torus", None):
        options: dict[str, Any] = {} if container == "box" else {"container": container}
        world = gas(300, forces=[jostle.PairForce(table, 9.0)], movable=movable, **options)
        found = scattered(world, evenly).potential_energy()
        assert abs(found - world.potential_energy()) <= 1e-10 * abs(found)


def test_rest_that_is_interrupted() -> None:
    """Overlapping discs keep their impulses at rest through steps in which nothing can rest."""
    world = gas(150, cover=0.8, **REST)
    ours = scattered(world, unevenly, every=4)
    ours.substeps = None  # fewer without gravity
    for gravity, steps in ((30.0, 40), (0.0, 2), (30.0, 3), (0.0, 1), (30.0, 3)):
        ours.gravity = world.gravity = (0.0, gravity)
        step_alike("gravity", ours, world, 1 / 60, steps, gathers=True)


@up_to(3)
def test_immovable() -> None:
    """Particles keep impulses on immovable ones, also when they move to the ranks of these."""
    world = jostle.scenes.create("heap", n=60, seed=3)
    world.sleeping = False
    ours = scattered(world, unevenly, every=3)
    for step in range(12):
        step_alike("heap", ours, world, 1 / 60, gathers=step % 5 == 0)


def test_settings() -> None:
    """Settings of the search do not change results; events can be tracked from now on."""
    world = gas(300, cover=0.6, gravity=(0.0, 20.0))
    ours = scattered(world, unevenly)
    for name, value in (
        ("method", "brute"),
        ("leaf_capacity", 8),
        ("method", "quadtree"),
        ("max_depth", 3),
        ("threads", 2),
        ("track_events", True),
        ("on_touch", "ignore"),
        ("track_events", False),
    ):
        for one in (world, ours):
            setattr(one, name, value)
            assert getattr(one, name) == value
        step_alike(name, ours, world, 1 / 60, 3)
        if world.track_events:
            assert check_events(name, ours, world) > 0
    assert sum(comm().allgather(ours.stats.leaves)) >= world.stats.leaves
    if comm().size > 1:
        refuse(lambda: setattr(ours, "max_depth", 3 + comm().rank), "max_depth is not the same")
    refuse(lambda: setattr(ours, "leaf_capacity", 0), "leaf_capacity")


@up_to(3)
def test_parts() -> None:
    """Scenes that are made in parts have the particles of one process."""
    for name in ("gas", "pile", "thermostat", "mixed", "clusters"):
        for n in (0, 1, 2, 7, 200):
            whole = jostle.scenes.create(name, n=n, seed=4)
            ours = jostle.mpi.create_scene(comm(), name, n=n, seed=4, sleeping=False)
            assert ours.state_hash() == whole.state_hash(), (name, n)
            assert ours.total == len(whole) and len(ours) <= len(whole) // comm().size + 1
    for _ in range(2):
        step_alike("clusters", ours, whole, 1 / 60, 10)
    refuse(lambda: jostle.mpi.create_scene(comm(), "nothing"), "nothing")
    refuse(lambda: jostle.mpi.create_scene(comm(), "stars", n=10), "")


@up_to(3)
def test_impulses() -> None:
    """Impulses of any rank on particles of any rank, at once, some of them twice."""
    for name, world in (("gas", gas(150)), ("spins", gas(150, friction=0.3, container="torus"))):
        ours = scattered(world, unevenly, every=3)
        for call in range(4):
            step_alike(name, ours, world, 1 / 60, 3)
            rng = np.random.default_rng(call)
            ids = world.ids[rng.integers(0, len(world), 40)]
            impulses, points = rng.normal(0, 9, (40, 2)), rng.uniform(0, 30, (40, 2))
            order = np.concatenate(
                [np.arange(40)[rank :: comm().size] for rank in range(comm().size)]
            )
            own = np.arange(40)[comm().rank :: comm().size]
            if call == 3:  # only the first rank gives any, at the centres
                order, own = np.arange(40), np.arange(40 if comm().rank == 0 else 0)
            of = {} if call == 3 else {"points": points[own]}
            world.apply_impulse(ids[order], impulses[order], None if call == 3 else points[order])
            ours.apply_impulse(ids[own], impulses[own], **of)
            assert ours.state_hash() == world.state_hash(), f"{name}: {call}"
        step_alike(name, ours, world, 1 / 60, 3)
    is_last = comm().rank == comm().size - 1
    refuse(
        lambda: ours.apply_impulse(10**6 if is_last else [], (0, 1) if is_last else []), "1000000"
    )
    first = int(comm().bcast(ours.ids[ours.movable][0] if comm().rank == 0 else None))
    refuse(
        lambda: ours.apply_impulse([first] * 2, [(1e18, 0)] * 2),
        f"of particle {first} would be too large",
    )
    if comm().size > 1:
        some = (0, 0) if is_last else None
        refuse(
            lambda: ours.apply_impulse(first, (0, 1), some), "points are given by some ranks only"
        )
    step_alike("after what is refused", ours, world, 1 / 60)


@up_to(3)
def test_unwrapped_positions() -> None:
    """Periods travelled go with particles to other ranks, into files and back."""
    world = gas(150, container="torus", velocities=np.random.default_rng(5).normal(0, 90, (150, 2)))
    ours = scattered(world, unevenly, every=3)
    for _ in range(4):
        step_all([world, ours], 1 / 30, 10)
        ids, found = (
            np.concatenate(comm().allgather(of)) for of in (ours.ids, ours.unwrapped_positions)
        )
        assert np.array_equal(found[np.argsort(ids)], world.unwrapped_positions)
    assert world.period is not None
    assert np.abs(world.unwrapped_positions - world.positions).max() > 2 * world.period.max()
    alone = ours.gather()
    if alone is not None:
        assert np.array_equal(alone.unwrapped_positions, world.unwrapped_positions)
