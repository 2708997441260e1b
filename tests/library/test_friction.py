"""Friction and spin of `jostle.World`, against an event-driven reference and analytic answers."""

import math
from typing import Any

import numpy as np
import pytest
from event_driven import Floats, simulate
from gases import lattice, random_velocities
from tilted_pile import TiltedPile

import jostle

G = 9.8


def wrapped(angles: Floats) -> Floats:
    """Return the same angles between -π and π."""
    inside: Floats = (angles + np.pi) % (2 * np.pi) - np.pi
    return inside


def test_friction_and_rotation_are_columns() -> None:
    world = jostle.World(
        [(0, 0), (9, 0), (18, 0)],
        [1, 2, 1],
        friction=0.5,
        angles=[0, 1, -1],
        angular_velocities=[2, 0, 3],
        movable=[True, True, False],
    )
    assert world.friction.tolist() == [0.5, 0.5, 0.5]
    assert world.angles.tolist() == [0, 1, -1]
    assert world.angular_velocities.tolist() == [2, 0, 3]  # the last is immovable
    assert world.kinetic_energy() == 0.5 * (1 * 1**2 / 2) * 2**2
    ids = world.add([(30, 0), (40, 0)], 1, friction=[1, 2], angular_velocities=-1)
    assert world.friction[ids].tolist() == [1, 2]
    assert world.angular_velocities[ids].tolist() == [-1, -1]
    world.set(1, friction=0.25, angles=0.75)
    world.remove(0)
    assert world.friction.tolist() == [0.25, 0.5, 1, 2]
    assert world.angles.tolist() == [0.75, -1, 0, 0]
    world.step(0.5)
    assert world.angles.tolist() == [0.75, 0.5, -0.5, -0.5]


@pytest.mark.parametrize("angle", [0, 3, -np.pi, np.pi, 4, -4, 100, 1e6])
def test_angles_are_wrapped(angle: float) -> None:
    world = jostle.World([(0, 0)], 1, angles=angle)
    given = float(np.float32(angle))
    assert -np.float32(np.pi) <= world.angles[0] < np.float32(np.pi)
    np.testing.assert_allclose(np.exp(1j * world.angles), np.exp(1j * given), atol=1e-6)


def test_slow_rotation_is_not_lost() -> None:
    """float32 alone would lose 1e-8 radians a step beside an angle of 3."""
    world = jostle.World([(0, 0)], 1, angles=3, angular_velocities=1e-6)
    world.step(0.01, steps=10_000)
    np.testing.assert_allclose(world.angles, 3.0001, atol=3e-7)


@pytest.mark.parametrize("box", [False, True])
@pytest.mark.parametrize("restitution", [1.0, 0.8])
@pytest.mark.parametrize("friction", [0.1, 0.7])
def test_a_gas_with_friction_agrees_with_the_reference(
    friction: float, restitution: float, box: bool
) -> None:
    """Few discs and short times, so that rounding does not grow to the size of the answer."""
    rng = np.random.default_rng(4)
    n, side = 24, 24.0
    region = {"container": jostle.Box(0, 0, side, side)} if box else {"period": (side, side)}
    positions = (lattice(n, side - 3, side - 3) + 1.5).astype(np.float32)
    velocities = random_velocities(n, rng).astype(np.float32)
    turning = rng.normal(size=n).astype(np.float32)
    coefficients = (friction * rng.uniform(0.5, 1.5, n)).astype(np.float32)
    settings: dict[str, Any] = {"restitution": restitution} | region
    spins = {"friction": coefficients, "angular_velocities": turning}
    expected = simulate(positions, velocities, 1.0, 1.0, 6.0, **settings, **spins)
    assert expected.collisions.sum() > 20
    world = jostle.World(positions, 1.0, velocities=velocities, masses=1.0, **settings, **spins)
    world.step(1.5, steps=4)
    np.testing.assert_allclose(world.velocities, expected.velocities, atol=2e-4)
    np.testing.assert_allclose(world.angular_velocities, expected.angular_velocities, atol=2e-4)
    difference = wrapped(world.angles - expected.angles)
    np.testing.assert_allclose(difference, 0, atol=5e-4)


@pytest.mark.parametrize("steps", [1, 7, 500])
def test_a_ball_thrown_along_a_floor_begins_to_roll(steps: int) -> None:
    """It conserves angular momentum about the point of contact: it keeps 2/3 of its speed."""
    world = jostle.World(
        [(0, 2)],
        1,
        velocities=[(3, 0)],
        gravity=(0, -10),
        friction=0.3,
        container=jostle.Box(-99, 0, 99, 99),
    )
    world.step(20 / steps, steps=steps)
    np.testing.assert_allclose(world.velocities[0, 0], 2, rtol=1e-5)
    np.testing.assert_allclose(world.angular_velocities, -2, rtol=1e-5)
    assert world.positions[0, 1] > 1


def on_an_incline(angle: float, friction: float, speed: float = 0.0) -> jostle.World:
    """Return a disc of radius 1 on a floor that falls towards +x."""
    return jostle.World(
        [(0, 1)],
        1,
        velocities=[(speed, 0)],
        gravity=(G * math.sin(angle), -G * math.cos(angle)),
        restitution=0.5,
        friction=friction,
        container=jostle.Box(-1000, 0, 1000, 100),
    )


@pytest.mark.parametrize("degrees", [5, 20, 40])
@pytest.mark.parametrize("friction", [0.05, 0.2, 0.5])
def test_acceleration_down_an_incline(degrees: float, friction: float) -> None:
    """A disc slides if tan a > 3 μ, and otherwise rolls: m r²/2 takes a third of the pull."""
    angle = math.radians(degrees)
    world = on_an_incline(angle, friction)
    world.step(1 / 60, steps=300)
    pull, pressure = G * math.sin(angle), G * math.cos(angle)
    slides = math.tan(angle) > 3 * friction
    expected = pull - friction * pressure if slides else 2 / 3 * pull
    assert world.velocities[0, 0] / world.time == pytest.approx(expected, rel=1e-3)
    assert 2 * world.positions[0, 0] / world.time**2 == pytest.approx(expected, rel=0.01)
    turning = 2 * friction * pressure if slides else expected
    assert world.angular_velocities[0] / world.time == pytest.approx(-turning, rel=1e-3)


def test_impulses_of_a_bounce() -> None:
    """Masses 1 and 3, restitution 0.5: the textbook formula."""
    world = jostle.World(
        [(0, 0), (3, 0)], 1, velocities=[(4, 0), (0, 0)], masses=[1, 3], restitution=0.5
    )
    world.step(1)
    contacts = world.last_step.contacts
    assert isinstance(contacts, jostle.WorldContacts)
    assert contacts.pairs.tolist() == [[0, 1]]
    np.testing.assert_allclose(contacts.normal_impulses, 1.5 * 4 / (1 / 1 + 1 / 3), rtol=1e-6)
    assert contacts.friction_impulses.tolist() == [0]
    world.step(1)
    assert len(world.last_step.contacts.pairs) == 0


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_the_walls_carry_the_weight(friction: float) -> None:
    world = jostle.scenes.create("pile", n=500)
    world.friction = friction
    world.sleeping = False  # asleep it has the impulses of the step in which it fell asleep
    world.step(1 / 60, steps=480)
    weight = world.masses.sum(dtype=float) * world.gravity[1]
    pushes = []
    for _ in range(20):
        momentum = world.momentum()[1]
        world.step(1 / 60)
        contacts = world.last_step.wall_contacts
        assert isinstance(contacts, jostle.WallContacts)
        assert (contacts.normal_impulses > 0).all()
        # With friction the side walls carry a part (Janssen, 1895).
        x, y = contacts.normals.T
        upwards = -(contacts.normal_impulses * y + contacts.friction_impulses * x)
        pushes.append(upwards.sum(dtype=float) * 60)
        # What the walls do not carry changes the momentum.
        change = 60 * (world.momentum()[1] - momentum)
        assert pushes[-1] == pytest.approx(weight - change, rel=1e-4)
    assert np.mean(pushes) == pytest.approx(weight, rel=1e-3)
    floor = contacts.walls == jostle.Side.MAX_Y  # y grows downwards in scenes
    assert (contacts.normals[floor] == (0, -1)).all()
    # Their friction also bounds the difference (Coulomb).
    on_floor = contacts.normal_impulses[floor].sum() * 60
    on_sides = contacts.normal_impulses[~floor].sum() * 60
    assert on_sides > 0.05 * weight
    assert abs(on_floor - pushes[-1]) <= friction * on_sides + 1e-5 * weight
    assert (np.diff(contacts.ids) >= 0).all()
    assert (contacts.friction_impulses != 0).any() == (friction > 0)


@pytest.mark.usefixtures("usual_threads")
def test_a_tilted_pile_flows_at_the_angle_of_an_avalanche() -> None:
    """`python tests/tilted_pile.py` measures the angles in the scene of a published simulation."""
    pile = TiltedPile(1000, 60.0, seed=0)
    level = pile.angle()
    pile.tilt_by(0.02, 650)
    assert pile.angle() == pytest.approx(13 + level, abs=1)
    before, after = pile.avalanche(0.02)
    assert 17 < before < 26
    assert 13 < after < before


@pytest.mark.parametrize("degrees", [10, 50])
def test_the_force_of_an_incline(degrees: float) -> None:
    """Rolling, friction is a third of the pull; sliding, it is μ times the pressure."""
    angle = math.radians(degrees)
    world = on_an_incline(angle, 0.2)
    world.step(1 / 60, steps=60)
    normal = world.last_step.wall_contacts.normal_impulses * 60
    friction = world.last_step.wall_contacts.friction_impulses * 60
    pull, pressure = G * math.sin(angle), G * math.cos(angle)
    assert normal == pytest.approx(pressure, rel=1e-4)
    # The normal is +y, so the tangent is -x.
    assert friction == pytest.approx(pull / 3 if degrees == 10 else 0.2 * pressure, rel=1e-3)


def test_a_round_wall() -> None:
    world = jostle.World(
        [(0, -4)], 1, gravity=(0, -G), restitution=0, container=jostle.Circle((0, 0), 5)
    )
    world.step(1 / 60)
    contacts = world.last_step.wall_contacts
    assert (contacts.ids.tolist(), contacts.walls.tolist()) == ([0], [jostle.Side.RIM])
    assert contacts.normals.tolist() == [[0, 1]]
    assert contacts.normal_impulses * 60 == pytest.approx(G, rel=1e-4)


@pytest.mark.parametrize("friction", [1e20, 1e30, 3.4e38])
def test_a_coefficient_as_large_as_it_may_be_prevents_sliding_and_nothing_else(
    friction: float,
) -> None:
    def heap(friction: float) -> jostle.World:
        rng = np.random.default_rng(3)
        places = np.stack(np.meshgrid(np.arange(8), np.arange(6)), -1).reshape(-1, 2) * 2.3 + 3
        world = jostle.World(
            places,
            1.0,
            velocities=rng.normal(0, 5, (48, 2)),
            masses=10 ** rng.uniform(-3, 3, 48),
            gravity=(0, -9.8),
            restitution=0.5,
            friction=friction,
            container=jostle.Box(0, 0, 30, 30),
            walls={"segments": [((20, 0), (30, 8))], "friction": friction},
        )
        world.step(1 / 60, steps=120)
        return world

    world, rough = heap(friction), heap(1e15)
    assert (world.positions == rough.positions).all()
    assert (world.angular_velocities == rough.angular_velocities).all()
    assert (
        world.last_step.contacts.friction_impulses == rough.last_step.contacts.friction_impulses
    ).all()
    assert np.isfinite(world.last_step.wall_contacts.friction_impulses).all()
