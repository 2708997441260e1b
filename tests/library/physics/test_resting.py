"""Inelastic collisions and resting contacts, against theory and the event-driven reference."""

import math

import event_driven
import numpy as np
import pytest
import random_scenes
from numpy.typing import NDArray

import jostle
from jostle import scenes

G = 9.8
BOX = jostle.Box(-50, 0, 50, 100)


def falling(positions: object, velocities: object = None, **settings: object) -> jostle.World:
    """Discs of radius 1 under gravity in a box, at rest unless they have velocities."""
    velocities = np.zeros((len(positions), 2)) if velocities is None else velocities
    settings = {"radii": 1, "gravity": (0, -G), "container": BOX} | settings
    return jostle.World(positions, velocities=velocities, **settings)


def gas(
    n: int, covered: float, seed: int
) -> tuple[NDArray[np.float32], NDArray[np.float32], float]:
    """Discs of radius 1 on a lattice in a box: positions, velocities, side of the box."""
    rng = np.random.default_rng(seed)
    side, columns = math.sqrt(n * math.pi / covered), math.ceil(math.sqrt(n))
    grid = np.stack(np.meshgrid(np.arange(columns), np.arange(columns)), -1).reshape(-1, 2)[:n]
    positions = (grid + 0.5) * side / columns
    return positions.astype(np.float32), rng.normal(size=(n, 2)).astype(np.float32), side


@pytest.mark.parametrize(
    ("n", "restitution", "time"), [(100, 0.9, 5.0), (100, 0.5, 2.0), (300, 0.95, 2.0)]
)
def test_one_long_step_of_an_inelastic_gas(n: int, restitution: float, time: float) -> None:
    positions, velocities, side = gas(n, 0.3, 0)
    settings = {"restitution": restitution, "container": jostle.Box(0, 0, side, side)}
    expected = event_driven.simulate(positions, velocities, 1, 1, time, **settings)
    world = jostle.World(positions, 1, velocities=velocities, **settings)
    world.step(time)
    assert world.velocities == pytest.approx(expected.velocities, abs=0.01)
    assert world.positions == pytest.approx(expected.positions, abs=0.01)
    assert world.last_step.unresolved == 0


@pytest.mark.parametrize("dt", [0.1, 1.0, 4.0])
def test_a_cooling_gas_obeys_haffs_law(dt: float) -> None:
    """The energy falls as 1/(1 + t/τ)²: 1/√energy grows in proportion to time."""
    positions, velocities, side = gas(2000, 0.2, 1)
    world = jostle.World(positions, 1, velocities=velocities, restitution=0.95, period=(side, side))
    root = []
    for _ in range(5):
        root.append(1 / math.sqrt(world.kinetic_energy()))
        world.step(dt, steps=round(8 / dt))
    growth = np.diff(root)
    assert growth == pytest.approx(growth.mean(), rel=0.06)
    # Rate of collisions from Enskog's theory in two dimensions.
    contact = (1 - 7 * 0.2 / 16) / (1 - 0.2) ** 2
    density, diameter = 0.2 / math.pi, 2
    rate = 2 * math.sqrt(math.pi) * density * diameter * contact
    tau = 4 / (rate * (1 - 0.95**2))
    assert growth.mean() / root[0] * tau / 8 == pytest.approx(1, rel=0.1)


@pytest.mark.parametrize("restitution", [0.3, 0.5, 0.8, 0.9])
@pytest.mark.parametrize(("dt", "substeps"), [(1 / 60, None), (1 / 60, 1), (0.2, 1)])
def test_a_ball_bounces_to_rest(restitution: float, dt: float, substeps: int | None) -> None:
    height = 10.0
    world = falling([(0, height + 1)], restitution=restitution, substeps=substeps)
    fall = math.sqrt(2 * height / G)

    def expected(t: float) -> float:
        if t < fall:
            return height - G * t * t / 2
        start, speed = fall, restitution * G * fall
        while speed > 1e-6:
            duration = 2 * speed / G
            if t < start + duration:
                return speed * (t - start) - G * (t - start) ** 2 / 2
            start, speed = start + duration, speed * restitution
        return 0.0

    rest = fall * (1 + restitution) / (1 - restitution)
    for _ in range(math.ceil((rest + 1) / dt)):
        world.step(dt)
        # The last bounces, which would all end within a sub-step, are left out.
        assert world.positions[0, 1] - 1 == pytest.approx(expected(world.time), abs=0.05)
    assert world.positions[0, 1] == 1
    assert world.velocities.tolist() == [[0, 0]]


@pytest.mark.parametrize(
    ("restitution", "time", "substeps"),
    [(0.5, 1.0, None), (0.9, 1.5, None), (0.5, 0.5, 1), (0.9, 0.5, 1), (0.9, 1.5, 1)],
)
def test_a_ball_that_begins_slowly_bounces_in_one_step(
    restitution: float, time: float, substeps: int | None
) -> None:
    """It does not rest, although it is slow at first and reaches the floor within a sub-step."""
    world = falling([(0, 2)], restitution=restitution, substeps=substeps)
    world.step(time)
    fall = math.sqrt(2 / G)
    speed = restitution * G * fall
    left = time - fall
    while left > 2 * speed / G:
        left, speed = left - 2 * speed / G, restitution * speed
    assert world.positions[0, 1] == pytest.approx(1 + speed * left - G * left**2 / 2, abs=1e-4)
    assert world.velocities[0, 1] == pytest.approx(speed - G * left, abs=1e-4)


@pytest.mark.parametrize("time", [0.5, 1.0, 2.0])
def test_two_discs_do_not_gain_energy_in_a_long_step(time: float) -> None:
    def discs() -> jostle.World:
        velocities = [(1.1, -0.5), (0.9, -1.1)]
        box = jostle.Box(0, 0, 8, 40)
        return falling([(3.09, 2), (5.36, 2)], velocities, restitution=0.9, container=box)

    one, many = discs(), discs()
    one.step(time)
    many.step(time / 1000, steps=1000)
    assert one.positions == pytest.approx(many.positions, abs=0.01)
    assert one.velocities == pytest.approx(many.velocities, abs=0.01)


def test_a_disc_does_not_rest_at_the_ceiling() -> None:
    world = falling([(3, 2)], [(0, 1)], restitution=0, container=jostle.Box(0, 0, 8, 40))
    world.step(100, steps=3)
    assert world.positions.tolist() == [[3, 1]]


def test_friction_brings_elastic_discs_to_rest() -> None:
    """Otherwise their collisions would become ever more frequent while the energy falls."""
    rng = np.random.default_rng(1)
    grid = np.stack(np.meshgrid(np.arange(10), np.arange(10)), -1).reshape(-1, 2)
    places = grid * 2.2 + 2 + rng.uniform(-0.09, 0.09, grid.shape)
    world = falling(places, friction=0.5, container=jostle.Box(0, 0, 26, 100))
    begun = world.kinetic_energy() + world.masses @ world.positions[:, 1] * G
    most = 0
    for _ in range(40):
        world.step(1 / 60, steps=30)
        most = max(most, world.last_call.collisions)
        assert world.last_step.unresolved == 0
    assert most < 100 * len(world)
    assert world.kinetic_energy() < 1e-4 * begun


def seconds_on_a_disc(
    dt: float, restitution: float, unit: float = 1.0, second: float = 1.0
) -> float:
    """When a disc released 30° off the top of a fixed one is .001 radii above it."""
    x, y = math.sin(math.radians(30)), math.cos(math.radians(30))
    world = jostle.World(
        np.array([(0, 0), (2 * x, 2 * y)]) * unit,
        unit,
        gravity=(0, -G * unit / second**2),
        restitution=restitution,
    )
    world.set([0], movable=False)
    while world.time < 2 * second:
        world.step(dt * second)
        if np.hypot(*(world.positions[1] - world.positions[0])) > 2.001 * unit:
            return world.time / second
    return math.inf


@pytest.mark.parametrize("restitution", [0.0, 0.3, 0.9])
def test_a_disc_slides_off_another_as_theory_says(restitution: float) -> None:
    """It leaves at cos θ = 2/3 cos 30° after .5633 s; the gap is .001 after .6154 s."""
    assert seconds_on_a_disc(1 / 240, restitution) == pytest.approx(0.6154, abs=1 / 240 + 0.003)


def test_results_scale_with_the_units_of_time_and_length() -> None:
    expected = seconds_on_a_disc(1 / 60, 0.3)
    for unit, second in [(64.0, 1.0), (1.0, 16.0), (1 / 64, 1 / 16)]:
        assert seconds_on_a_disc(1 / 60, 0.3, unit, second) == expected


def test_two_discs_stacked_off_axis_topple() -> None:
    world = falling([(0, 1), (0.05, 2.99)], restitution=0)
    world.step(1 / 60, steps=300)
    assert world.positions[:, 1].tolist() == [1, 1]


@pytest.mark.parametrize("substeps", [4, 32])
def test_a_pyramid_without_friction_becomes_flat(substeps: int) -> None:
    """It takes 6.6 to 7.1 s with 4 to 256 sub-steps, and 6.3 to 7.5 s in pymunk."""
    centers = [
        (2 * i + row - 9, 1 + row * math.sqrt(3)) for row in range(10) for i in range(10 - row)
    ]
    wide = jostle.Box(-100, 0, 100, 100)
    world = falling(centers, restitution=0, container=wide, substeps=substeps)
    world.step(1 / 60, steps=480)
    assert world.positions[:, 1].max() < 1.01


def shaft(rows: int, restitution: float, substeps: int | None) -> jostle.World:
    """Rows of 20 discs that fall into a shaft."""
    rng = np.random.default_rng(1)
    grid = np.stack(np.meshgrid(np.arange(20), np.arange(rows)), -1).reshape(-1, 2)
    places = grid * [4.9, 5] + [3.5, 10] + rng.uniform(-0.4, 0.4, grid.shape)
    settings = {"container": jostle.Box(0, 0, 100, 1000), "gravity": (0, -980), "radii": 2}
    return falling(places, restitution=restitution, substeps=substeps, **settings)


@pytest.mark.parametrize("restitution", [0.0, 0.3, 0.9])
def test_no_disc_hangs_in_a_shaft(restitution: float) -> None:
    """A disc that is held in the air has a velocity that grows with the time."""
    world = shaft(8, restitution, 1)
    unresolved = 0
    for _ in range(240):
        world.step(1 / 60)
        unresolved += world.last_step.unresolved
    # Some discs of low restitution collide very often when they land.
    assert unresolved < 240 * len(world) / 200
    assert world.last_step.unresolved == 0
    # Some discs still bounce, so one step says little. A disc that hangs for a second would be
    # hundreds of radii behind its velocity.
    before, expected = world.positions, np.zeros_like(world.positions)
    for _ in range(60):
        world.step(1 / 60)
        expected += world.velocities / 60
    # Overlap is corrected without velocity.
    assert np.hypot(*(world.positions - before - expected).T).max() < 2 * 2
    assert np.hypot(*world.velocities.T).max() < 3 * 980 / 60


@pytest.mark.parametrize("width", [9.048052168165501, 9.03675981536937])
def test_a_light_disc_between_a_wall_and_a_heavy_disc_comes_to_rest(width: float) -> None:
    """It gains no energy from impacts at the beginning of sub-steps."""
    discs: dict[str, object] = {"radii": [4, 1], "masses": [64, 1], "restitution": 0.97}
    box = jostle.Box(0, 0, width, 100)
    places = [(4.02, 4.5), (width - 1, 1.2)]
    world = falling(places, **discs, gravity=(0, -160), substeps=1, container=box)
    world.step(1 / 60, steps=3000)
    assert rms_speed(world) < 0.01 * 160 / 60


def test_no_disc_hangs_in_random_scenes() -> None:
    """`make search` looks at more of them."""
    for seed in range(9):
        faults, _ = random_scenes.find_faults(seed)
        assert not faults


def rms_speed(world: jostle.World) -> float:
    return math.sqrt((np.hypot(*world.velocities.T) ** 2).mean())


def a_pile(kind: str, friction: float, n: int, seed: int = 0) -> jostle.World:
    """Discs that fall into a box: of the scene, or with other radii or masses."""
    world = scenes.create("pile", n=n, seed=seed)
    world.friction, world.sleeping = friction, False
    if kind == "masses 100:1":
        world.set(range(0, n, 2), masses=100 * world.masses[::2])
    elif kind.startswith("radii"):
        radii = np.where(np.arange(n) % 50 == 0, 10, 10 / float(kind[6:-2]))
        world.set(range(n), radii=radii, masses=math.pi * radii**2)
    return world


def deepest_overlap(world: jostle.World) -> float:
    """The largest depth of a contact over the smaller radius."""
    contacts = world.last_step.contacts
    smaller = world.radii[contacts.pairs].min(axis=1)
    return float((contacts.depths / smaller).max())


@pytest.mark.parametrize(("friction", "most"), [(0, 1.0), (0.3, 0.2), (1.0, 0.2)])
def test_a_pile_comes_to_rest_in_five_seconds(friction: float, most: float) -> None:
    world = a_pile("as in the scene", friction, 1000)
    world.step(1 / 60, steps=300)
    assert rms_speed(world) <= most
    assert np.abs(world.angular_velocities * world.radii).max() < 5
    assert deepest_overlap(world) <= 0.01


@pytest.mark.parametrize(
    ("kind", "n", "dt", "friction"),
    [
        ("as in the scene", 2000, 1 / 60, 0.0),
        ("as in the scene", 1000, 1 / 30, 0.5),
        ("masses 100:1", 300, 1 / 60, 0.0),
        ("masses 100:1", 300, 1 / 60, 0.5),
        ("radii 10:1", 300, 1 / 60, 0.0),
        ("radii 25:1", 300, 1 / 60, 0.0),
    ],
)
def test_overlaps_in_piles_are_small(kind: str, n: int, dt: float, friction: float) -> None:
    """With half as many sub-steps they are two to ten times as large."""
    world = a_pile(kind, friction, n)
    world.step(dt, steps=round(5 / dt))
    assert deepest_overlap(world) <= 0.01


def stack(lower: float, upper: float, **settings: object) -> jostle.World:
    """Two discs of radius 1 with these masses, one on the other, and both on a floor."""
    places = [(0, 1), (0.5, 1 + math.sqrt(3.75))]
    return falling(places, masses=[lower, upper], **{"restitution": 0.0, **settings})


@pytest.mark.parametrize(
    ("world", "expected"),
    [
        (stack(1, 100), 4),
        (stack(1, 625), 20),
        (stack(1, 1e4), 32),
        (stack(1, 1e6), 4),
        (stack(1e6, 1), 4),
        (stack(1, 625, substeps=4), 4),
        (stack(1, 625, restitution=1.0), 1),
        (stack(1, 625, gravity=(-G, 0)), 20),
        (stack(1, 625, gravity=(G, 0)), 4),
        (stack(1, 625, gravity=(0, 0)), 1),
    ],
    ids=lambda value: str(value) if isinstance(value, int) else "",
)
def test_heavy_discs_that_press_light_ones_take_more_substeps(
    world: jostle.World, expected: int
) -> None:
    assert world.last_step.substeps == 0
    world.step(1 / 60)
    assert world.last_step.substeps == expected


@pytest.mark.parametrize("pull", [(0.0, 0.0), (3.0, -2.0)])
def test_the_number_of_substeps_may_be_chosen_or_found(pull: tuple[float, float]) -> None:
    """Attractors act as if the number had been known when the step began."""
    worlds = [stack(1, 625), stack(1, 625, substeps=20)]
    for world in worlds:
        world.forces = [jostle.Attractor((0, -3), strength=5.0)]
        world.accelerations = np.full((2, 2), pull)
        for _ in range(5):
            world.step(1 / 60)
            assert world.last_step.substeps == 20
    assert worlds[0].positions.tolist() == worlds[1].positions.tolist()
    assert worlds[0].velocities.tolist() == worlds[1].velocities.tolist()


@pytest.mark.threads
def test_more_substeps_do_not_depend_on_threads_method_or_order() -> None:
    pile = a_pile("radii 25:1", 0.1, 200)
    pile.step(1 / 60, steps=90)
    columns = ("positions", "velocities", "radii", "masses", "friction")
    results, most = set(), 0
    for order, settings in [
        (np.arange(200), {"threads": 1}),
        (np.arange(200), {"threads": 2}),
        (np.arange(200)[::-1], {"method": "brute"}),
    ]:
        world = jostle.World(
            **{name: getattr(pile, name)[order] for name in columns},
            gravity=pile.gravity,
            restitution=pile.restitution,
            container=pile.container,
            **settings,
        )
        for _ in range(30):
            world.step(1 / 60)
            most = max(most, world.last_step.substeps)
        states = np.column_stack([world.positions, world.velocities])[np.argsort(order)]
        results.add(states.tobytes())
    assert most == 20
    assert len(results) == 1


def measure_speeds(friction: float, count: int) -> None:
    """Print the rms speeds of piles of 1,000 discs, from as many seeds."""
    worlds = [a_pile("as in the scene", friction, 1000, seed) for seed in range(count)]
    for seconds, steps in (5, 300), (6, 60):
        for world in worlds:
            world.step(1 / 60, steps=steps)
        speeds = np.array([rms_speed(world) for world in worlds])
        mean = np.exp(np.log(speeds).mean())
        above = (speeds > 1).sum()
        overlap = 100 * max(map(deepest_overlap, worlds))
        print(
            f"μ = {friction}, {seconds} s: {mean:.2f} px/s (geometric mean), {above} of {count} "
            f"above 1, deepest overlap {overlap:.1f} %",
            flush=True,
        )


def measure_overlaps() -> None:
    """Print the overlaps in piles after 5 seconds."""
    cases = [
        ("as in the scene", 4_000, 1 / 60),
        ("as in the scene", 20_000, 1 / 60),
        ("as in the scene", 1_000, 1 / 30),
        ("masses 100:1", 1_000, 1 / 60),
        ("radii 10:1", 1_000, 1 / 60),
        ("radii 25:1", 1_000, 1 / 60),
    ]
    for kind, n, dt in cases:
        for friction in (0, 0.1, 0.5):
            overlaps = []
            for seed in range(1 if n > 4000 else 4):
                world = a_pile(kind, friction, n, seed)
                world.step(dt, steps=round(5 / dt))
                overlaps.append(f"{100 * deepest_overlap(world):.1f}")
            print(
                f"{n} discs, {kind}, steps of {dt:.3f} s, μ = {friction}: overlap "
                f"{' '.join(overlaps)} %, {rms_speed(world):.2f} px/s",
                flush=True,
            )


def measure_shaft() -> None:
    """Print in how many steps discs that fall into a shaft are exhausted, and how many at most."""
    for substeps, restitution in (1, 0.5), (None, 0.5), (None, 0.9):
        world = shaft(50, restitution, substeps)
        counts = []
        for _ in range(360):
            world.step(1 / 60)
            counts.append(world.last_step.unresolved)
        print(
            f"1,000 discs in a shaft, e = {restitution}, substeps={substeps}: exhausted discs in "
            f"{np.count_nonzero(counts)} of 360 steps, at most {max(counts)}",
            flush=True,
        )


if __name__ == "__main__":
    measure_shaft()
    for friction in (0, 0.3, 0.6, 1):
        measure_speeds(friction, 16)
    measure_overlaps()
