"""Settings that change while a scene runs: number, walls, size and rules."""

import numpy as np
import pytest

import jostle
from jostle_lab.schema import Group, Polyline, Settings
from jostle_lab.simulate.containers import InitialRegion, bounds, moved_inside
from jostle_lab.simulate.region import Torus, container_of, set_container
from jostle_lab.simulate.simulation import MOST_AT_ONCE, Simulation
from jostle_lab.simulate.start import start

CONTAINERS = [jostle.Box(-10, 0, 90, 50), jostle.Circle((40, 25), 30), Torus(100, 50), None]


def gas(n: int = 200, **settings) -> Simulation:
    simulation = start(Settings("gas", n, **settings))
    assert isinstance(simulation, Simulation)
    return simulation


def is_inside(simulation: Simulation) -> bool:
    frame = simulation.frame()
    radii = frame.radii.astype(np.float64)
    places = frame.positions.astype(np.float64)
    return bool(np.allclose(moved_inside(places, radii, frame.container), places, atol=1e-3))


def test_more_particles_are_copies_that_touch_nothing() -> None:
    simulation = gas(200, world_size=1.5)
    before = simulation.frame()
    assert simulation.adjust("n", 240) is None
    frame = simulation.frame()
    assert len(frame) == 240 and simulation.settings.n == 240
    assert (frame.positions[:200] == before.positions).all()
    assert (frame.tags == np.arange(240)).all()
    assert len(jostle.find_pairs(frame.positions[200:], frame.radii[200:])) == 0
    new = jostle.Quadtree(frame.positions[200:], frame.radii[200:])
    assert len(new.pairs(jostle.Quadtree(before.positions, before.radii))) == 0
    assert np.isin(frame.velocities[200:, 0], before.velocities[:, 0]).all()
    assert is_inside(simulation)


def test_more_particles_have_the_filters_of_those_that_they_copy_and_are_sensors_like_them() -> (
    None
):
    simulation = gas(200, world_size=1.5)
    simulation.change(np.arange(200), categories=2, masks=5)
    assert simulation.adjust("n", 210) is None
    frame = simulation.frame()
    assert frame.categories.tolist() == [2] * 210 and frame.masks.tolist() == [5] * 210
    sensors = Group(200, radius=(0.2, 0.2), sensor=True)
    simulation = start(Settings("gas", 0, particles=(sensors,)))
    assert simulation.adjust("n", 210) is None
    frame = simulation.frame()
    assert len(frame) == 210 and frame.sensors is not None and (frame.sensors > 0).all()


def test_the_last_particles_go_first() -> None:
    simulation = gas(200)
    simulation.step()
    before = simulation.frame()
    assert simulation.adjust("n", 150) is None
    frame = simulation.frame()
    assert (frame.tags == np.arange(150)).all()
    assert (frame.positions == before.positions[:150]).all()
    simulation.adjust("n", 0)
    assert len(simulation) == 0
    simulation.step()
    assert "no room" in simulation.adjust("n", 5)  # nothing to copy


def test_the_same_slider_gives_the_same_world() -> None:
    first, second = gas(100, world_size=1.5), gas(100, world_size=1.5)
    for simulation in (first, second):
        for n in (120, 90, 110):
            simulation.adjust("n", n)
        simulation.step()
    assert first.world.state_hash() == second.world.state_hash()


def test_walls_are_not_counted_and_stay() -> None:
    simulation = start(Settings("galton", 300))
    fixed = int((~simulation.frame().movable).sum())
    assert fixed > 0
    for n in (350, 100):
        simulation.adjust("n", n)
        movable = simulation.frame().movable
        assert movable.sum() == n and (~movable).sum() == fixed


@pytest.mark.parametrize("n", [5_000, 300 + MOST_AT_ONCE])
def test_what_there_is_no_room_for_and_what_the_library_refuses_is_said_and_changes_nothing(
    n: int,
) -> None:
    simulation = gas(200)
    before = simulation.world.state_hash()
    assert simulation.adjust("n", n) == f"There is no room for {n - 200:,} more particles."
    assert simulation.world.state_hash() == before and simulation.settings.n == 200
    said = simulation.adjust("leaf_capacity", 0)
    assert "leaf_capacity" in said and simulation.settings.leaf_capacity is None
    simulation.step()


def test_a_session_begins_anew_where_there_is_no_room(open_session) -> None:
    session = open_session("gas", 200)
    session.engine.step()
    session.runner.adjust("n", 190)
    assert len(session.frame) == 190 and session.frame.stats.time > 0
    session.runner.adjust("n", 2_000)
    assert len(session.frame) == session.settings.n == 2_000
    assert session.frame.stats.time == 0 and "begins anew" in session.message


@pytest.mark.parametrize("container", CONTAINERS, ids=str)
@pytest.mark.parametrize("kind", ["box", "circle", "torus", "none"])
def test_walls_of_another_kind_have_the_same_room(container, kind: str) -> None:
    view = bounds(container) or (0.0, 0.0, 100.0, 50.0)
    fitted, seen = InitialRegion.of(container, view, None).fitted(kind, 1.0)
    assert (kind == "none") == (fitted is None)

    def area(walls) -> float:
        if isinstance(walls, jostle.Circle):
            return np.pi * walls.radius**2
        low_x, low_y, high_x, high_y = bounds(walls) or view
        return (high_x - low_x) * (high_y - low_y)

    if fitted is not None and container is not None:
        assert area(fitted) == pytest.approx(area(container), rel=1e-5)
    walls = bounds(fitted)
    if walls is not None:
        assert np.array(seen) == pytest.approx(np.array(walls), rel=1e-5)
    back, _ = InitialRegion.of(container, view, None).fitted(None, 1.0)
    assert bounds(back) == pytest.approx(bounds(container)) if container else back is None


@pytest.mark.parametrize("container", CONTAINERS, ids=str)
def test_what_is_outside_comes_in_and_what_is_inside_stays(container) -> None:
    places = np.random.default_rng(0).uniform(-100, 200, (500, 2))
    inside = moved_inside(places, np.full(500, 2.0), container)
    assert moved_inside(inside, np.full(500, 2.0), container) == pytest.approx(inside)
    unmoved = (inside == places).all(axis=1)
    assert unmoved.any() and (container is None or not unmoved.all())


@pytest.mark.parametrize("kind", ["box", "circle", "torus", "none"])
@pytest.mark.parametrize("scene", ["gas", "orbit", "stars"])
def test_nothing_is_lost_when_walls_change(kind: str, scene: str) -> None:
    simulation = start(Settings(scene, 150))
    simulation.step()
    count = len(simulation)
    assert simulation.adjust("container", kind) is None
    assert simulation.settings.container == kind and len(simulation) == count
    if kind != "none":
        assert type(simulation.frame().container).__name__.lower() == kind
    assert is_inside(simulation)
    for _ in range(5):
        simulation.step()
    assert np.isfinite(simulation.frame().positions).all()


@pytest.mark.parametrize("size", [0.7, 1.0, 2.5])
def test_the_world_grows_and_shrinks_about_its_middle(size: float) -> None:
    simulation = gas(100)
    first, view = bounds(simulation.frame().container), simulation.view
    simulation.adjust("world_size", 3.0)
    assert simulation.adjust("world_size", size) is None  # of the scene's own, not of the last
    low_x, low_y, high_x, high_y = bounds(simulation.frame().container)
    assert high_x - low_x == pytest.approx(size * (first[2] - first[0]), rel=1e-5)
    assert (low_x + high_x, low_y + high_y) == pytest.approx(
        (first[0] + first[2], first[1] + first[3]), rel=1e-4
    )
    assert simulation.view[2] - simulation.view[0] == pytest.approx(size * (view[2] - view[0]))
    assert is_inside(simulation) and len(simulation) == 100


def test_a_scene_begins_in_the_world_of_its_settings() -> None:
    simulation = gas(100, world_size=2.0, container="circle")
    plain = gas(100)
    assert isinstance(simulation.world.container, jostle.Circle)
    side = plain.view[2] - plain.view[0]
    assert np.pi * simulation.world.container.radius**2 == pytest.approx(4 * side**2, rel=1e-4)


def test_walls_are_the_same_after_going_back_to_a_state() -> None:
    simulation = gas(100)
    simulation.adjust("world_size", 2.0)
    state = simulation.save()
    simulation.adjust("world_size", 0.8)
    simulation.load(state)
    simulation.adjust("world_size", 1.0)
    assert bounds(simulation.frame().container) == pytest.approx(bounds(gas(100).frame().container))


def test_the_camera_shows_the_world_that_has_grown(open_session) -> None:
    session = open_session("gas", 100)
    scale = session.camera.scale
    session.runner.paused = True
    session.runner.adjust("world_size", 2.0)
    session.advance(0.0)
    assert session.camera.scale == pytest.approx(scale / 2)
    session.camera.zoom_at((400, 300), 2.0)
    zoomed = session.camera.scale
    session.runner.adjust("world_size", 1.0)
    session.advance(0.0)
    assert session.camera.scale == zoomed  # who looks closely goes on looking there


def test_friction_of_walls_is_that_of_drawn_ones_and_is_saved() -> None:
    """Walls of the file keep theirs."""
    line = Polyline(((0.0, 1.0), (9.0, 1.0)), friction=0.1)
    simulation = gas(20, friction=0.5, walls=(line,), gravity=(0.0, 50.0))
    assert simulation.effective_settings.wall_friction == 0.5  # that of the particles
    simulation.add_wall(Polyline(((0.0, 5.0), (9.0, 5.0))))
    assert simulation.adjust("wall_friction", 0.75) is None
    simulation.add_wall(Polyline(((0.0, 8.0), (9.0, 8.0))))
    expected = np.float32([0.1, 0.75, 0.75])
    np.testing.assert_array_equal(simulation.world.walls.friction, expected)
    again = Simulation.resume(simulation.save())
    assert again.effective_settings.wall_friction == 0.75
    np.testing.assert_array_equal(again.world.walls.friction, expected)
    again.remove_walls([0])
    again.add_wall(Polyline(((0.0, 2.0), (9.0, 2.0))))
    assert again.world.walls.friction.tolist() == [0.75] * 3
    assert "wall_friction is -1.0" in str(simulation.adjust("wall_friction", -1.0))
    assert simulation.settings.wall_friction == 0.75


def test_friction_is_that_of_all_particles_also_of_new_ones() -> None:
    simulation = gas(50)
    assert simulation.frame().angles is None
    assert simulation.adjust("friction", 0.5) is None
    simulation.add([(1.0, 1.0)], (0.0, 0.0), 0.5)
    assert (simulation.world.friction == 0.5).all()
    for _ in range(60):
        simulation.step()
    assert (simulation.world.angular_velocities != 0).any()
    again = Simulation.resume(simulation.save())
    assert again.settings.friction == 0.5
    np.testing.assert_array_equal(again.frame().angles, simulation.frame().angles)
    assert "friction" in str(simulation.adjust("friction", -1.0))
    assert gas(20, friction=0.25).world.friction.tolist() == [0.25] * 20


def test_restitution_is_that_of_all_particles_also_of_new_ones() -> None:
    simulation = gas(50)
    assert simulation.effective_settings.restitution == 1.0
    simulation.world.restitution = 0.25
    simulation = Simulation(Settings("gas"), simulation.view, simulation.world)
    simulation.add([(1.0, 1.0)], (0.0, 0.0), 0.5)
    assert (simulation.world.restitution == 0.25).all()
    assert simulation.effective_settings.restitution == 0.25
    assert simulation.adjust("restitution", 0.5) is None
    assert simulation.adjust("n", 55) is None
    assert simulation.world.restitution.tolist() == [0.5] * 55
    assert "restitution" in str(simulation.adjust("restitution", -1.0))
    simulation.remove(simulation.world.ids)
    simulation.add([(1.0, 1.0)], (0.0, 0.0), 0.5)
    assert simulation.world.restitution.tolist() == [0.5]


def test_a_container_that_is_refused_changes_nothing() -> None:
    world = jostle.World([(5, 5)], 1.0, period=(10, 20))
    with pytest.raises(ValueError, match="radii"):
        set_container(world, jostle.Box(0, 0, 1, 1))
    assert container_of(world) == Torus(10, 20)
    box = jostle.Box(0, 0, 40, 40)
    world = jostle.World([(5, 5)], 1.0, container=box, walls=[((0, 0), (30, 0))])
    with pytest.raises(ValueError, match="walls"):
        set_container(world, Torus(10, 20))
    assert container_of(world) == box


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("gravity", (0.0, 50.0)),
        ("drag", 0.25),
        ("restitution", 0.5),
        ("substeps", 2),
        ("leaf_capacity", 7),
        ("max_depth", 3),
        ("on_touch", "merge"),
        ("threads", 1),
    ],
)
def test_rules_change_without_a_new_beginning(open_session, name: str, value: object) -> None:
    session = open_session("gas", 50)
    session.engine.step()
    time = session.frame.stats.time
    session.runner.adjust(name, value)
    world = session.engine.simulation.world
    assert np.all(getattr(world, name) == value) and getattr(session.settings, name) == value
    assert session.frame.stats.time == time
