"""Commands by keys and mouse: the state of the world afterwards."""

import threading
import time

import numpy as np
import pygame
import pytest
from lab_interaction import FRAME, VIEW, Driver, tags, world_of

import jostle
from jostle_lab.act.commands import scatter, usual
from jostle_lab.schema import Settings
from jostle_lab.simulate.frame import Attractor, FrameRequest
from jostle_lab.simulate.region import Torus
from jostle_lab.simulate.simulation import Held, Inputs, Simulation
from jostle_lab.simulate.start import start


def test_a_held_particle_that_vanishes_is_dropped() -> None:
    driver = Driver(world_of([(200, 250), (600, 250)]))
    driver.down((200, 250))
    assert driver.session.interaction.drag_tool.held == 0
    driver.session.engine.edit(lambda simulation: simulation.remove([0]))
    driver.session.engine.step()  # before the session is notified
    driver.frames(1)
    assert driver.session.interaction.drag_tool.held is None
    driver.up((300, 250))
    assert len(driver.session.frame) == 1


def test_a_heavy_particle_follows_the_cursor_more_slowly_and_none_overshoots() -> None:
    places = [(100, 100), (100, 300), (600, 100), (600, 300), (600, 400)]
    gone = []
    for tag, y in enumerate((100, 300)):
        driver = Driver(world_of(places, radii=[10, 50, 10, 10, 10]))
        driver.down((100, y))
        for x in (115, 130, 145, 160):
            driver.move(driver.pixel((x, y)))
            driver.frames(1)
        gone.append(float(driver.world.positions[tag, 0]) - 100)
    assert 5 < gone[1] < 0.8 * gone[0] < 60
    driver = Driver(world_of([(100, 100)]))
    driver.down((100, 100))
    furthest = 0.0
    for x in [*range(120, 620, 20), *[600] * 30]:
        driver.move(driver.pixel((x, 100)))
        driver.frames(1)
        furthest = max(furthest, float(driver.world.positions[0, 0]))
    assert furthest < 625 and driver.world.positions[0, 0] == pytest.approx(600, abs=1)


def test_what_cannot_move_holds_up_what_is_held() -> None:
    driver = Driver(world_of([(200, 250), (400, 250)], movable=[True, False]))
    driver.down((200, 250))
    driver.point_at((400, 252))
    driver.frames(120)
    gap = np.hypot(*(driver.world.positions[0] - driver.world.positions[1]))
    assert gap > 19 and driver.world.positions[1].tolist() == [400, 250]


def test_in_a_pause_a_held_particle_is_moved_to_the_cursor() -> None:
    driver = Driver(world_of([(200, 250)]))
    driver.key(pygame.K_p)
    driver.down((200, 250))
    driver.point_at((500, 300))
    driver.frames(2)
    driver.up((500, 300))
    assert driver.world.positions[0] == pytest.approx((500, 300), abs=1)
    assert driver.world.velocities[0].tolist() == [0, 0] and driver.world.time == 0


def test_space_attracts_all_by_distance_and_stops_on_release() -> None:
    driver = Driver(world_of([(200, 100), (300, 100), (500, 100)]))
    still = Driver(world_of([(200, 100), (300, 100), (500, 100)]))
    driver.point_at((600, 100))
    driver.key(pygame.K_SPACE, up=False)
    driver.frames(2)
    still.frames(2)
    gained = (driver.session.frame.velocities - still.session.frame.velocities)[:, 0]
    assert gained[0] / gained[2] == pytest.approx(4, rel=0.05)
    assert gained[1] / gained[2] == pytest.approx(3, rel=0.05)
    driver.key_up(pygame.K_SPACE)
    assert driver.session.frame.attractors == ()
    speeds = driver.session.frame.velocities[:, 0].copy()
    driver.frames(2)
    assert (driver.session.frame.velocities[:, 0] <= speeds + 1e-4).all()


def test_space_follows_the_cursor_spares_what_was_placed_and_ends_without_the_keys() -> None:
    driver = Driver(world_of([(200, 100)]))
    driver.session.interaction.attractors.place((10, 10))
    driver.key(pygame.K_SPACE, up=False)
    for point in [(300, 300), (500, 200)]:
        driver.point_at(point)
        driver.frames(2)
        assert driver.session.frame.attractors[-1].point == pytest.approx(point, abs=1)
    driver.key_up(pygame.K_SPACE)
    assert [pull.point for pull in driver.session.frame.attractors] == [(10, 10)]
    driver = Driver(world_of([(200, 100)]))
    driver.key(pygame.K_SPACE, up=False)
    driver.frames(2)
    assert driver.session.frame.attractors
    pygame.event.post(pygame.event.Event(pygame.WINDOWFOCUSLOST))
    driver.frames(1)
    assert not driver.session.frame.attractors


def test_a_adds_a_particle_of_the_usual_size_at_the_cursor_the_median_of_what_moves() -> None:
    driver = Driver(world_of([(200, 100), (300, 100)]), paused=True)
    driver.point_at((500, 300))
    driver.key(pygame.K_a)
    frame = driver.session.frame
    assert len(frame) == 3 and frame.positions[2] == pytest.approx((500, 300), abs=1)
    assert frame.radii[2] == 10 and frame.densities[2] == 1
    movable = [True] * 3 + [False] * 2
    assert usual(world_of([(0, 0)] * 5, radii=[1, 2, 3, 50, 50], movable=movable).frame()) == (2, 1)
    assert usual(world_of([]).frame()) == (10, 1)


@pytest.mark.parametrize("key", [pygame.K_DELETE, pygame.K_BACKSPACE])
def test_delete_deletes_the_selection_or_what_is_under_the_cursor(key: int) -> None:
    driver = Driver(world_of([(100, 100), (200, 100), (300, 100), (400, 100)]), paused=True)
    driver.point_at((300, 100))
    driver.key(key)
    assert tags(driver.session.frame.tags) == [0, 1, 3]
    driver.drag((50, 50), (250, 150))
    driver.key(key)
    assert tags(driver.session.frame.tags) == [3]
    driver.point_at((700, 400))
    driver.key(key)
    assert tags(driver.session.frame.tags) == [3]


def test_d_clones_next_to_the_original_with_its_velocity() -> None:
    driver = Driver(world_of([(100, 100), (750, 300)]), paused=True)
    driver.session.engine.edit(lambda simulation: simulation.change([0, 1], velocities=(30, 0)))
    for x, y in [(100, 100), (750, 300)]:
        driver.point_at((x, y))
        driver.key(pygame.K_d)
    frame = driver.session.frame
    assert frame.positions[2:] == pytest.approx(np.array([(121, 100), (729, 300)]))
    assert frame.velocities[2:] == pytest.approx(np.array([(30, 0), (30, 0)]))
    assert (frame.radii == 10).all() and (frame.densities == 1).all()


def test_clones_of_a_wide_selection_stay_between_the_walls_and_inside_a_circle() -> None:
    places = [(x, y) for x in range(40, 800, 80) for y in range(40, 500, 80)]
    driver = Driver(world_of(places), paused=True)
    driver.session.interaction.commands.clone(driver.session.frame.tags)
    driver.frames(1)
    now = driver.world.positions
    assert len(now) == 2 * len(places)
    assert (now > 9.99).all() and (now < np.array([790.01, 490.01])).all()
    assert len(jostle.find_pairs(now, 10.0)) == 0
    places = [(400 + x, 250 + y) for x, y in ((0, 180), (0, -180), (130, 130), (-185, 0), (20, 0))]
    driver = Driver(world_of(places, container=jostle.Circle((400, 250), 200)), paused=True)
    driver.session.interaction.commands.clone(driver.session.frame.tags)
    driver.frames(1)
    now = driver.world.positions.astype(float) - (400, 250)
    assert len(now) == 2 * len(places)
    assert (np.hypot(*now.T) < 190.01).all()


def test_clones_are_sensors_and_immovable_if_the_originals_are() -> None:
    # Two sensors touch: in frames they have the number 2 then.
    places = [(100, 100), (105, 100), (400, 100), (600, 100)]
    sensors, movable = [True, False, True, False], [True, True, False, False]
    driver = Driver(world_of(places, sensors=sensors, movable=movable))
    driver.session.engine.step()
    driver.session.interaction.commands.clone(driver.session.frame.tags)
    assert driver.world.sensors.tolist() == sensors * 2
    assert driver.session.frame.movable.tolist() == movable * 2


def test_what_is_removed_takes_its_attraction_with_it_and_scenes_keep_their_forces() -> None:
    spring = jostle.Springs([(1, 2)], 20.0, 100.0)
    simulation = world_of([(100, 100), (200, 100), (220, 100), (500, 300)], forces=[spring])
    simulation.attract((Attractor(4.0, tag=3), Attractor(4.0, (0.0, 0.0)), Attractor(2.0, tag=0)))
    simulation.remove([0])
    assert simulation.frame().attractors == (Attractor(4.0, tag=3), Attractor(4.0, (0.0, 0.0)))
    springs, first, second = simulation.world.forces
    assert springs.pairs.tolist() == [[1, 2]] and first.particle == 3 and second.particle is None
    simulation.change([2], velocities=(5, 0))
    assert simulation.frame().velocities[1].tolist() == [5, 0]
    simulation.attract(())
    assert len(simulation.world.forces) == 1
    simulation.remove([1])  # the spring goes with its end
    simulation.attract((Attractor(4.0, (0.0, 0.0)),))
    springs, pull = simulation.world.forces
    assert len(springs) == 0 and pull.point == (0, 0)


def test_frames_name_contacts_and_springs_by_rows() -> None:
    spring = jostle.Springs([(1, 2)], 20.0, 100.0)
    simulation = world_of([(100, 100), (300, 100), (315, 100)], forces=[spring])
    simulation.remove([0])
    simulation.step()
    frame = simulation.frame(FrameRequest(contacts=True))
    assert tags(frame.tags) == [1, 2] and frame.springs is not None and frame.contacts is not None
    assert frame.springs.tolist() == frame.contacts.pairs.tolist() == [[0, 1]]


def test_a_held_particle_is_found_after_others_are_removed_and_pulled_no_more_when_let_go() -> None:
    simulation = world_of([(100, 100), (300, 100), (500, 100)])
    simulation.remove([0])
    simulation.step(Inputs(Held(2, (520.0, 100.0), (0.0, 0.0))))
    speeds = simulation.frame().velocities[:, 0]
    assert speeds[0] == 0 and speeds[1] > 0
    simulation.remove([2])
    assert simulation.world.forces == ()
    simulation = world_of([(100, 100), (300, 100)])
    simulation.step(Inputs(Held(1, (320.0, 100.0), (0.0, 0.0))))
    state = simulation.save()
    simulation.hold(Inputs())
    assert simulation.world.forces == ()
    simulation.load(state)
    assert simulation.world.forces == ()


def test_particles_that_merge_keep_the_tag_and_the_attraction_of_the_oldest() -> None:
    simulation = world_of([(100, 100), (300, 100), (315, 100), (600, 100)], on_touch="merge")
    simulation.attract((Attractor(4.0, tag=2), Attractor(4.0, tag=3)))
    simulation.step()
    frame, attracting = simulation.frame(), (Attractor(4.0, tag=1), Attractor(4.0, tag=3))
    assert tags(frame.tags) == [0, 1, 3] and len(frame.born) == len(frame.radii) == 3
    assert frame.radii[1] > 10 and frame.attractors == attracting
    assert [force.particle for force in simulation.world.forces] == [1, 3]
    simulation.attract((*simulation.attractors, Attractor(4.0, tag=2)))  # it exists no more
    assert simulation.frame().attractors == attracting
    assert len(simulation.world.forces) == 2
    simulation.attract(())
    assert simulation.world.forces == () and simulation.frame().attractors == ()


def test_the_attraction_of_what_has_merged_can_be_stopped() -> None:
    places = [(300, 100), (315, 100), (600, 100)]
    session = Driver(world_of(places, on_touch="merge")).session
    session.interaction.attractors.set_attracting(np.array([1]), True)
    for _ in range(3):
        session.engine.step()
    session.advance(FRAME)
    attracts = session.interaction.attractors.attracts
    assert attracts(0) and not attracts(1)
    session.interaction.attractors.stop()
    assert session.engine.simulation.world.forces == ()
    session.close()


CONTAINERS = [jostle.Box(*VIEW), jostle.Circle((400, 250), 200.0), Torus(800.0, 500.0), None]


@pytest.mark.parametrize("container", CONTAINERS, ids=lambda walls: type(walls).__name__)
def test_random_positions_are_inside_the_container(container: object) -> None:
    chance = np.random.default_rng(1)
    radii = np.linspace(1, 40, 500)
    places = scatter(chance, container, VIEW, radii)
    if isinstance(container, jostle.Circle):
        assert (np.hypot(*(places - (400, 250)).T) <= 200 - radii + 1e-9).all()
    else:
        assert (places >= radii[:, None] - 1e-9).all()
        assert (places <= np.array([800, 500]) - radii[:, None] + 1e-9).all()
    assert np.ptp(places, axis=0).min() > 200


@pytest.mark.parametrize("scene", ["article", "gas", "pile", "orbit", "springs", "sand", "galton"])
def test_scramble_and_randomise_go_on_in_every_scene(scene: str) -> None:
    driver = Driver(start(Settings(scene, 120)))
    before = driver.session.frame
    driver.session.interaction.commands.scramble()
    driver.session.engine.wait()
    scrambled = driver.session.frame
    moving = before.movable
    assert (scrambled.positions[moving] != before.positions[moving]).any(axis=1).all()
    assert (scrambled.positions[~moving] == before.positions[~moving]).all()
    driver.frames(5)
    driver.session.interaction.commands.randomise()
    driver.session.engine.wait()
    frame = driver.session.frame
    assert np.unique(frame.densities[frame.movable]).size > 10
    assert np.hypot(*frame.velocities[frame.movable].T).max() > 0
    driver.frames(10)
    assert np.isfinite(driver.session.frame.positions).all() and not driver.session.runner.paused


def test_the_keys_of_gravity() -> None:
    driver = Driver(world_of([(200, 100)], gravity=(0.0, 100.0)))
    world = driver.world
    for key, expected in [
        (pygame.K_PLUS, (0, 150)),
        (pygame.K_KP_MINUS, (0, 100)),
        (pygame.K_i, (0, -100)),
        (pygame.K_g, (100, 0)),
        (pygame.K_g, (0, 100)),
        (pygame.K_0, (0, 0)),
        (pygame.K_MINUS, (0, 0)),
    ]:
        driver.key(key)
        assert tuple(world.gravity) == pytest.approx(expected), pygame.key.name(key)
        assert "ravity" in driver.session.message
    driver.key(pygame.K_g)
    assert world.gravity[1] > 100
    assert driver.session.interaction.gravity.value == tuple(world.gravity)
    driver.frames(10)
    assert driver.world is world and world.velocities[0, 1] > 0


def test_time_goes_slower_and_faster() -> None:
    driver = Driver(world_of([(200, 100)]))
    for key, steps in [(pygame.K_COMMA, 0.5), (pygame.K_PERIOD, 1.0), (pygame.K_PERIOD, 2.0)]:
        driver.key(key)
        assert driver.session.settings.time_scale == steps
        before = driver.session.engine.steps
        driver.frames(60)
        real = 60 * FRAME / driver.session.engine.time_step
        assert driver.session.engine.steps - before == pytest.approx(real * steps, abs=1.5)


def test_attractors_and_selection_do_not_survive_another_scene() -> None:
    driver = Driver(Simulation.of_scene(Settings("gas", 30)))
    driver.session.interaction.attractors.place((0.0, 0.0))
    driver.session.interaction.commands.wall((10, 10), (40, 10))
    driver.key(pygame.K_RIGHTBRACKET)
    assert driver.session.engine.scene == "pile"
    assert len(driver.session.interaction.commands.drawn_walls) == 0
    driver.frames(2)
    assert driver.session.frame.attractors == () == driver.session.interaction.attractors.placed
    driver.key(pygame.K_LEFTBRACKET)
    assert driver.session.engine.scene == "gas"


def test_edits_are_made_on_the_worker_thread() -> None:
    driver = Driver(world_of([(200, 100), (300, 100)]), synchronous=False, paused=True)
    engine = driver.session.engine
    gate = threading.Event()
    engine.edit(lambda simulation: gate.wait(10) and None)
    assert engine.busy  # and yet the window goes on:
    driver.session.interaction.commands.create((500.0, 300.0))
    driver.frames(2)
    assert len(driver.session.frame) == 2
    driver.session.interaction.gravity.set((0.0, 50.0))
    gate.set()
    engine.wait()
    driver.frames(1)
    assert len(driver.session.frame) == 3 and driver.session.interaction.gravity.value == (0, 50)


@pytest.mark.parametrize("paused", [True, False])
def test_an_edit_on_the_worker_thread_shows_without_another(paused: bool) -> None:
    driver = Driver(world_of([(200, 100), (300, 100)]), synchronous=False)
    driver.session.runner.paused = paused
    driver.session.interaction.commands.delete(np.array([1]))
    while driver.session.engine.busy:
        time.sleep(0.001)
    driver.frames(1)
    assert len(driver.session.frame) == 1


def test_a_key_held_without_end_and_points_outside_the_walls_or_the_world_are_no_error() -> None:
    session = Driver(world_of([(200, 250), (600, 250)])).session
    for _ in range(900):
        session.interaction.gravity.scale(3.0)
    session.advance(0.0)
    assert "gravity" in session.message
    for point in ((1e300, -1e300), (0.0, 1e19)):
        session.interaction.commands.create(point)
        session.interaction.commands.wall((0.0, 0.0), point)
        session.interaction.attractors.place(point)
        session.interaction.attractors.attract_to_cursor(point)
        session.advance(FRAME)
    assert len(session.interaction.attractors.placed) == 2
    assert (abs(session.frame.positions) <= 1e18).all()
    driver = Driver(world_of([(200, 100)]))
    driver.session.interaction.commands.create((-5000.0, 100.0))
    driver.frames(2)
    assert (driver.world.positions[:, 0] >= 0).all()


def test_the_app_writes_into_no_column_that_a_world_returns() -> None:
    """They are copies, and may be read-only."""
    world = jostle.scenes.create("gas", n=5)
    world.track_events = True  # or they cannot be read
    columns = [name for name in dir(type(world)) if isinstance(getattr(world, name), np.ndarray)]
    assert {"positions", "radii"} <= set(columns)

    class ReadOnly:
        def __getattr__(self, name: str) -> object:
            value = getattr(world, name)
            if isinstance(value, np.ndarray):
                value.flags.writeable = False
            return value

        def __setattr__(self, name: str, value: object) -> None:
            setattr(world, name, value)

        def __len__(self) -> int:
            return len(world)

    simulation = Simulation(Settings("gas", 5), VIEW, ReadOnly())
    session = Driver(simulation).session
    session.interaction.commands.create((50.0, 50.0))
    session.interaction.commands.clone(session.frame.tags[:2])
    session.interaction.commands.stop(session.frame.tags[:1])
    session.interaction.commands.fix(session.frame.tags[1:2], movable=False)
    session.runner.adjust("world_size", 1.5)
    session.runner.adjust("n", 3)
    session.interaction.commands.scramble()
    session.interaction.commands.randomise()
    for _ in range(3):
        session.advance(FRAME)
    assert "read-only" not in session.message and len(session.frame) == 4
