"""The threads of the window: jobs, edits, loading, their order, and real time to whole steps."""

import threading
import time
from collections.abc import Callable

import pygame
import pytest
from lab_interaction import Driver, gate_steps, world_of

import jostle
from jostle_lab.act.interaction import DragTool
from jostle_lab.schema import Settings
from jostle_lab.simulate import engine, start
from jostle_lab.simulate.engine import LONGEST, MAX_STEPS, Engine, FixedTimestep
from jostle_lab.simulate.simulation import Inputs, Simulation

MANY = 200_000
STEP = 1 / 60
TWO = [(200, 250), (600, 250)]


def held_up(driver: Driver) -> Callable[[], None]:
    """Continue until a step is in progress, which waits until the returned function is called."""
    begun, release = gate_steps(driver.session.engine.simulation)
    for _ in range(3_000):
        driver.frames(1)
        if begun.wait(0.01):
            break
    assert driver.session.engine.busy
    return release


def settled(driver: Driver) -> None:
    """Wait for the current jobs, and show their results."""
    driver.session.engine.wait_for_loading()
    driver.frames(1, 0.0)
    driver.session.engine.wait()


def test_a_throw_has_the_speed_of_its_release_and_the_next_grab_holds() -> None:
    driver = Driver(world_of(TWO), synchronous=False)
    release = held_up(driver)
    driver.down(TWO[0])
    for x in range(210, 310, 10):
        driver.move(driver.pixel((x, 250)))
        driver.frames(1)
    pygame.event.post(
        pygame.event.Event(pygame.MOUSEBUTTONUP, pos=driver.pixel((300, 250)), button=1, mod=0)
    )
    driver.frames(1, 0.0)
    driver.down(TWO[1])
    for _ in range(30):
        driver.frames(1)
    assert driver.session.interaction.drag_tool.held == 1
    release()
    driver.session.runner.paused = True
    driver.session.engine.wait()
    assert driver.session.interaction.drag_tool.held == 1
    assert driver.world.velocities[0, 0] > 200


def test_the_drag_state_of_a_step_never_changes() -> None:
    drag_tool = DragTool()
    drag_tool.grab(3, (0.0, 0.0), 0.0)
    before = drag_tool.state
    drag_tool.follow((10.0, 0.0), 0.02)
    assert before is not None and before.point == (0.0, 0.0) and before.velocity == (0.0, 0.0)
    assert drag_tool.state.velocity[0] == pytest.approx(500.0)
    thrown = drag_tool.release()
    drag_tool.grab(4, (50.0, 0.0), 0.03)
    assert thrown.tag == 3 and drag_tool.state.tag == 4


def test_a_drag_in_a_pause_leaves_one_edit_waiting(monkeypatch) -> None:
    driver = Driver(world_of(TWO), synchronous=False, paused=True)
    gate = threading.Event()
    driver.session.engine.edit(lambda simulation: gate.wait(30) and None)
    driver.down(TWO[0])
    for x in (220, 240, 260):
        driver.move(driver.pixel((x, 250)))
        driver.frames(3)
    moved, change = [], Simulation.change
    monkeypatch.setattr(
        Simulation, "change", lambda *what, **named: moved.append(change(*what, **named))
    )
    gate.set()
    driver.session.engine.wait()
    assert len(moved) == 1
    assert driver.world.positions[0] == pytest.approx((260, 250), abs=2)


def refusing(driver: Driver) -> Simulation:
    """Let steps be refused while there is gravity."""
    simulation = driver.session.engine.simulation
    step = simulation.step

    def refused(inputs: Inputs) -> None:
        if tuple(simulation.world.gravity) != (0.0, 0.0):
            raise ValueError("That is too fast.")
        step(inputs)

    simulation.step = refused
    return simulation


@pytest.mark.parametrize("synchronous", [True, False])
def test_a_refused_step_pauses_and_another_setting_goes_on(synchronous: bool) -> None:
    driver = Driver(world_of(TWO), synchronous=synchronous)
    session = driver.session
    refusing(driver)
    session.runner.adjust("gravity", (0.0, 100.0))
    session.engine.wait()
    for _ in range(3):
        driver.frames(1)
        session.engine.wait()
    driver.frames(1)
    assert session.runner.paused and session.message == "That is too fast."
    assert session.engine.steps == 0
    session.runner.single_step()
    session.engine.wait()
    driver.frames(1)
    assert session.runner.paused and session.engine.steps == 0
    session.runner.adjust("gravity", (0.0, 0.0))
    session.engine.wait()
    session.runner.toggle_pause()
    for _ in range(3):
        driver.frames(1)
        session.engine.wait()
    assert session.engine.steps > 0 and not session.runner.paused


def test_an_absurd_gravity_of_a_torus_is_refused_and_can_be_gone_back_from() -> None:
    driver = Driver(world_of(TWO, period=(800.0, 500.0)))
    driver.frames(5)
    steps, session = driver.session.engine.steps, driver.session
    session.runner.adjust("gravity", (0.0, 1e9))
    driver.frames(20)
    assert session.runner.paused and session.message
    session.runner.step_back()
    assert tuple(driver.world.gravity) == (0.0, 0.0)
    session.runner.toggle_pause()
    driver.frames(5)
    assert session.engine.steps > steps and not session.runner.paused


def test_a_run_without_a_window_hears_of_a_refusal() -> None:
    simulation = world_of(TWO, period=(800.0, 500.0), gravity=(0.0, 1e12))
    engine = Engine(simulation, synchronous=True)
    with pytest.raises(ValueError, match=r"\w"):
        for _ in range(100):
            engine.step()


def test_what_fails_in_closing_leaves_nothing_open(monkeypatch) -> None:
    driver = Driver(world_of(TWO))
    closed: list[str] = []

    def fail() -> None:
        closed.append("engine")
        raise RuntimeError("lost")

    monkeypatch.setattr(driver.session.engine, "close", fail)
    for name, part in [
        ("files", driver.session.files),
        ("screen", driver.window.screen),
    ]:
        close = part.close
        monkeypatch.setattr(
            part, "close", lambda name=name, close=close: (closed.append(name), close())
        )
    with pytest.raises(RuntimeError, match="lost"):
        driver.window.close()
    assert closed == ["files", "engine", "screen"]


def test_drift_begins_again_when_the_new_gravity_is_there() -> None:
    driver = Driver(world_of(TWO), synchronous=False)
    session = driver.session
    session.runner.paused = True
    driver.frames(2)
    session.engine.wait()
    driver.frames(2)
    beginning = session.runner.statistics.reference
    assert beginning is not None
    gate = threading.Event()
    session.engine.edit(lambda simulation: gate.wait(30) and None)
    session.runner.adjust("gravity", (0.0, 100.0))
    driver.frames(5)
    assert session.runner.statistics.reference is beginning  # nothing has changed yet
    gate.set()
    session.engine.wait()
    for _ in range(3):
        driver.frames(1)
        session.engine.wait()
    driver.frames(1)
    assert session.runner.statistics.reference.energies.potential != beginning.energies.potential
    assert session.runner.statistics.energy_drift == 0


def test_no_wall_is_lost() -> None:
    driver = Driver(world_of(TWO), synchronous=False)
    session = driver.session
    for y in (50, 100, 150):
        session.interaction.commands.wall((100, y), (160, y))
        driver.frames(1)
    session.engine.wait()
    driver.frames(1)
    assert session.interaction.commands.drawn_walls.tolist() == [0, 1, 2]


def test_a_slider_of_numbers_leaves_only_its_last_value_waiting(monkeypatch) -> None:
    driver = Driver(Simulation.of_scene(Settings("gas", 20)), synchronous=False)
    session = driver.session
    session.runner.paused = True
    gate, asked = threading.Event(), []
    adjust = Simulation.adjust
    monkeypatch.setattr(
        Simulation,
        "adjust",
        lambda simulation, name, value: asked.append(value) or adjust(simulation, name, value),
    )
    session.engine.edit(lambda simulation: gate.wait(30) and None)
    for n in (19, 18, 17):
        session.runner.adjust("n", n)
        driver.frames(1)
    gate.set()
    session.engine.wait()
    assert asked == [17] and len(session.frame) == 17


def test_a_new_scene_of_many_is_prepared_while_the_old_one_is_shown(monkeypatch) -> None:
    monkeypatch.setattr(engine, "MESSAGE_DELAY", 0)
    driver = Driver(Simulation.of_scene(Settings("gas", 20)), synchronous=False)
    session, gate = driver.session, threading.Event()
    make = engine.load

    def slowly(create, request):
        gate.wait(30)
        return make(create, request)

    monkeypatch.setattr(engine, "load", slowly)
    session.runner.begin(Settings("pile", 30))
    driver.frames(2)
    assert session.message == "Preparing 30 particles …" and session.engine.scene == "gas"
    session.runner.begin(Settings("gas", 40))  # the first one is cancelled
    session.runner.adjust("leaf_capacity", 7)
    gate.set()
    settled(driver)
    assert session.engine.scene == "gas" and len(session.frame) == 40
    assert not session.message.startswith("Preparing")


def test_what_cannot_be_prepared_leaves_the_old_scene() -> None:
    driver = Driver(Simulation.of_scene(Settings("gas", 20)), synchronous=False)
    driver.session.runner.begin(Settings("no such scene", 30))
    settled(driver)
    assert driver.session.engine.scene == "gas" and "no such scene" in driver.session.message


def test_a_large_file_is_loaded_while_the_old_scene_is_shown(monkeypatch, tmp_path) -> None:
    monkeypatch.setattr(engine, "MESSAGE_DELAY", 0)
    driver = Driver(Simulation.of_scene(Settings("gas", 20)), synchronous=False)
    session = driver.session
    session.files.folder = tmp_path
    session.files.save()
    settled(driver)
    (path,) = session.files.scenes()
    session.runner.begin(Settings("pile", 30))
    settled(driver)
    session.files.load(path)
    assert session.message == f"Loading {path.name} …" and session.engine.scene == "pile"
    settled(driver)
    assert session.message == f"Loaded {path.name}"
    assert session.engine.scene == "gas" and len(session.frame) == 20
    path.write_bytes(b"nothing")
    session.files.load(path)
    settled(driver)
    assert session.message.startswith(f"{path.name} holds 7 bytes of something")
    assert len(session.frame) == 20


def test_a_loaded_scene_runs_alone_and_a_restart_goes_on_in_a_race(tmp_path) -> None:
    driver = Driver(Simulation.of_scene(Settings("gas", 20)))
    session = driver.session
    session.files.folder = tmp_path
    session.files.save()
    session.runner.toggle_race("brute")
    session.runner.restart()
    assert session.runner.race is not None
    session.files.load(*session.files.scenes())
    assert session.runner.race is None and len(session.frame) == 20


def test_a_restart_does_not_wait_for_a_step_and_the_step_leaves_no_trace() -> None:
    before = threading.enumerate()
    driver = Driver(Simulation.of_scene(Settings("gas", 20)), synchronous=False)
    session, old = driver.session, driver.session.engine.simulation
    release = held_up(driver)
    new = (thread for thread in threading.enumerate() if thread not in before)
    abandoned = [thread for thread in new if thread.name.startswith("jostle-step")]
    assert abandoned
    history = session.runner.history
    session.runner.restart()
    session.engine.wait_for_loading()
    session.runner.paused = True
    driver.frames(1)
    assert session.engine.simulation is not old and not session.engine.busy
    release()
    for thread in abandoned:
        thread.join(30)
    driver.frames(2)
    assert session.engine.steps == 0 and session.frame.stats.time == 0
    assert len(session.runner.history.moments) == 1 < len(history.moments)


def test_the_window_does_no_long_work_on_many_particles_itself(monkeypatch, tmp_path) -> None:
    monkeypatch.setattr(engine, "MESSAGE_DELAY", 0)
    driver = Driver(start.start(Settings("gas", MANY)), synchronous=False)
    session, window = driver.session, threading.current_thread()
    session.files.folder = tmp_path
    calls: list[tuple[str, bool]] = []

    def watch(owner: object, name: str) -> None:
        original = getattr(owner, name)

        def watched(*given, **named):
            calls.append((name, threading.current_thread() is window))
            return original(*given, **named)

        monkeypatch.setattr(owner, name, watched)

    for name in ("step", "frame", "save", "adjust", "change", "attract"):
        watch(Simulation, name)
    watch(jostle.scenes, "create")

    def rest() -> None:
        """Wait for the current jobs, without applying their results."""
        session.engine.wait_for_loading()
        while session.engine.busy:
            time.sleep(0.001)
        driver.frames(2)

    driver.frames(3)
    driver.down((100, 100))
    driver.move((300, 300))
    driver.frames(2)
    driver.up((200, 200))
    rest()
    driver.key(pygame.K_SPACE, up=False)
    driver.frames(2)
    driver.key_up(pygame.K_SPACE)
    rest()
    driver.key(pygame.K_p)
    assert session.runner.paused
    driver.key(pygame.K_o)
    driver.frames(2)
    rest()
    rest()
    session.runner.adjust("n", MANY + 10)
    rest()
    rest()
    assert len(session.frame) == MANY + 10
    session.files.screenshot()
    driver.key(pygame.K_r)
    assert session.message.startswith("Preparing")
    before = session.engine.simulation
    rest()
    assert session.engine.simulation is not before
    in_the_window = [name for name, here in calls if here]
    assert in_the_window == []
    assert {"step", "frame", "adjust", "create"} <= {name for name, _ in calls}
    driver.window.close()
    assert list(tmp_path.glob("*.png"))


def count(pace: FixedTimestep, elapsed: float, speed: float = 1.0) -> int:
    pace.add(elapsed, speed)
    due = pace.due
    pace.take(due)
    return due


def test_a_screen_of_any_speed_gives_sixty_steps_a_second_if_they_are_not_slow() -> None:
    for screen in (30, 60, 75, 144):
        pace = FixedTimestep(STEP)
        steps = sum(count(pace, 1 / screen) for _ in range(2 * screen))
        assert steps == pytest.approx(120, abs=1)


def test_slow_steps_end_a_job_after_its_budget(monkeypatch) -> None:
    engine_ = Engine(world_of(TWO), synchronous=True)
    step = engine_.simulation.step
    monkeypatch.setattr(engine_.simulation, "step", lambda inputs: time.sleep(0.02) or step(inputs))
    assert engine_.advance(0.02, Inputs(), paused=True) == 0
    engine_.advance(0.02, Inputs())
    engine_._timestep.add(0.05)
    assert engine_.advance(0.02, Inputs()) == 2


def test_a_slow_machine_slows_simulated_time_and_one_near_sixty_hertz_does_not() -> None:
    pace = FixedTimestep(STEP)
    assert [count(pace, 1 / 59.94), count(pace, 0.017), count(pace, 0.016)] == [1, 1, 1]
    assert count(pace, 10.0) == round(LONGEST / STEP)
    for _ in range(10):
        pace.add(STEP)
    assert pace.due == MAX_STEPS
    pace.take(MAX_STEPS)
    assert count(pace, 0.0) == 0
    assert count(pace, STEP) == 1


def test_eight_times_real_time_is_eight_steps_a_frame() -> None:
    pace = FixedTimestep(STEP)
    assert sum(count(pace, STEP, 8.0) for _ in range(60)) == 480
    driver = Driver(world_of(TWO))
    driver.session.runner.scale_time(8.0)
    driver.frames(120)
    assert driver.session.engine.steps == pytest.approx(8 * 120, abs=8)
    assert driver.session.rate == pytest.approx(8.0, rel=0.05)
