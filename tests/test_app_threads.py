"""What the window leaves to other threads, and that neither disturbs the other."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator

import pytest

pygame = pytest.importorskip("pygame")

from app_hands import Hands, world_of  # noqa: E402

import jostle  # noqa: E402
from jostle.app.act.hand import Hand  # noqa: E402
from jostle.app.keep import files  # noqa: E402
from jostle.app.simulate import engine as stepping  # noqa: E402
from jostle.app.simulate import making, start  # noqa: E402
from jostle.app.simulate.engine import Engine  # noqa: E402
from jostle.app.simulate.settings import Settings  # noqa: E402
from jostle.app.simulate.world_simulation import WorldSimulation  # noqa: E402

MANY = 200_000
TWO = [(200, 250), (600, 250)]


@pytest.fixture(autouse=True)
def closed() -> Iterator[None]:
    yield
    pygame.display.quit()


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let two particles count as very many."""
    monkeypatch.setattr(stepping, "FEW", 1)


def held_up(hands: Hands) -> Callable[[], None]:
    """Go on until a step is under way, which waits until the answer is called."""
    simulation = hands.session.engine.simulation
    gate, begun, step = threading.Event(), threading.Event(), simulation.step

    def waiting() -> None:
        begun.set()
        gate.wait(30)
        step()

    simulation.step = waiting
    for _ in range(3_000):
        hands.frames(1)
        if begun.wait(0.01):
            break
    assert hands.session.engine.busy
    return gate.set


def settled(hands: Hands) -> None:
    """Wait for what is under way, and show it."""
    hands.session._maker.wait()
    hands.frames(1, 0.0)
    hands.session.engine.wait()


# ---- a hand while a step is under way ------------------------------------------------------------


def test_a_throw_has_the_speed_of_its_release_and_the_next_grab_holds(few) -> None:
    hands = Hands(world_of(TWO))
    release = held_up(hands)
    hands.down(TWO[0])
    for x in range(210, 310, 10):
        hands.move(hands.pixel((x, 250)))
        hands.frames(1)
    pygame.event.post(
        pygame.event.Event(pygame.MOUSEBUTTONUP, pos=hands.pixel((300, 250)), button=1, mod=0)
    )
    hands.frames(1, 0.0)
    hands.down(TWO[1])
    for _ in range(30):
        hands.frames(1)
    assert hands.session.hand.held == 1
    release()
    hands.session.paused = True
    hands.session.engine.wait()
    assert hands.session.hand.held == 1
    assert hands.world.velocities[0, 0] > 200
    hands.window.close()


def test_what_a_step_feels_of_a_hand_never_changes() -> None:
    hand = Hand()
    hand.grab(3, (0.0, 0.0), 0.0)
    before = hand.grip
    hand.follow((10.0, 0.0), 0.02)
    assert before is not None and before.point == (0.0, 0.0) and before.velocity == (0.0, 0.0)
    assert hand.grip.velocity[0] == pytest.approx(500.0)
    thrown = hand.release()
    hand.grab(4, (50.0, 0.0), 0.03)
    assert thrown.tag == 3 and hand.grip.tag == 4


def test_a_hand_in_a_pause_leaves_one_edit_waiting(few) -> None:
    hands = Hands(world_of(TWO))
    hands.session.paused = True
    gate = threading.Event()
    hands.session.engine.edit(lambda simulation: gate.wait(30) and None)
    hands.down(TWO[0])
    for x in (220, 240, 260):
        hands.move(hands.pixel((x, 250)))
        hands.frames(3)
    assert len(hands.session.engine._edits) == 1
    gate.set()
    hands.session.engine.wait()
    assert hands.world.positions[0] == pytest.approx((260, 250), abs=2)
    hands.window.close()


# ---- refusals ------------------------------------------------------------------------------------


def refusing(hands: Hands) -> WorldSimulation:
    """Let steps be refused while there is gravity."""
    simulation = hands.session.engine.simulation
    step = simulation.step

    def refused() -> None:
        if simulation.world.gravity != (0.0, 0.0):
            raise ValueError("That is too fast.")
        step()

    simulation.step = refused
    return simulation


@pytest.mark.parametrize("beside", [False, True])
def test_a_refused_step_pauses_and_another_setting_goes_on(beside: bool, monkeypatch) -> None:
    monkeypatch.setattr(stepping, "FEW", 1 if beside else 10)
    hands = Hands(world_of(TWO))
    session = hands.session
    refusing(hands)
    session.adjust("gravity", (0.0, 100.0))
    session.engine.wait()
    for _ in range(3):
        hands.frames(1)
        session.engine.wait()
    hands.frames(1)
    assert session.paused and session.notice == "That is too fast."
    assert session.engine.steps == 0
    session.single_step()
    session.engine.wait()
    hands.frames(1)
    assert session.paused and session.engine.steps == 0
    session.adjust("gravity", (0.0, 0.0))
    session.engine.wait()
    session.toggle_pause()
    for _ in range(3):
        hands.frames(1)
        session.engine.wait()
    assert session.engine.steps > 0 and not session.paused
    hands.window.close()


def test_an_absurd_gravity_of_a_torus_is_refused_and_can_be_gone_back_from() -> None:
    hands = Hands(world_of(TWO, container=jostle.Torus(800.0, 500.0)))
    hands.frames(5)
    steps, session = hands.session.engine.steps, hands.session
    session.adjust("gravity", (0.0, 1e9))
    hands.frames(20)
    assert session.paused and session.notice
    session.step_back()
    assert hands.world.gravity == (0.0, 0.0)
    session.toggle_pause()
    hands.frames(5)
    assert session.engine.steps > steps and not session.paused


def test_a_run_without_a_window_hears_of_a_refusal() -> None:
    simulation = world_of(TWO, container=jostle.Torus(800.0, 500.0), gravity=(0.0, 1e12))
    engine = Engine(simulation)
    with pytest.raises(ValueError, match=r"\w"):
        for _ in range(100):
            engine.step()


# ---- closing -------------------------------------------------------------------------------------


def test_what_fails_in_closing_leaves_nothing_open(monkeypatch) -> None:
    hands = Hands(world_of(TWO))
    closed: list[str] = []

    def fail() -> None:
        closed.append("engine")
        raise RuntimeError("lost")

    monkeypatch.setattr(hands.session.engine, "close", fail)
    for name, part in [
        ("files", hands.session.files),
        ("backdrop", hands.window._backdrop),
        ("screen", hands.window.screen),
    ]:
        close = part.close
        monkeypatch.setattr(
            part, "close", lambda name=name, close=close: (closed.append(name), close())
        )
    with pytest.raises(RuntimeError, match="lost"):
        hands.window.close()
    assert closed == ["files", "engine", "backdrop", "screen"]


# ---- edits that are shown later ------------------------------------------------------------------


def test_drift_begins_again_when_the_new_gravity_is_there(few) -> None:
    hands = Hands(world_of(TWO))
    session = hands.session
    session.paused = True
    hands.frames(2)
    session.engine.wait()
    hands.frames(2)
    beginning = session.statistics.beginning
    assert beginning is not None
    gate = threading.Event()
    session.engine.edit(lambda simulation: gate.wait(30) and None)
    session.adjust("gravity", (0.0, 100.0))
    hands.frames(5)
    assert session.statistics.beginning is beginning  # nothing has changed yet
    gate.set()
    session.engine.wait()
    for _ in range(3):
        hands.frames(1)
        session.engine.wait()
    hands.frames(1)
    assert session.statistics.beginning.energies.potential != beginning.energies.potential
    assert session.statistics.energy_drift == 0


def test_no_wall_is_lost(few) -> None:
    hands = Hands(world_of(TWO))
    session = hands.session
    for y in (50, 100, 150):
        session.deeds.wall((100, y), (160, y))
        hands.frames(1)
    session.engine.wait()
    hands.frames(1)
    assert session.deeds.drawn_walls.tolist() == [0, 1, 2]


def test_a_slider_of_numbers_leaves_only_its_last_wish_waiting(few) -> None:
    hands = Hands(WorldSimulation.of_scene(Settings("gas", 20)))
    session = hands.session
    session.paused = True
    gate, asked = threading.Event(), []
    adjust = session.engine.simulation.adjust
    session.engine.simulation.adjust = lambda name, value: (
        asked.append(value),
        adjust(name, value),
    )[1]
    session.engine.edit(lambda simulation: gate.wait(30) and None)
    for n in (19, 18, 17):
        session.adjust("n", n)
        hands.frames(1)
    gate.set()
    session.engine.wait()
    assert asked == [17] and len(session.frame) == 17
    hands.window.close()


# ---- another simulation --------------------------------------------------------------------------


def test_a_new_scene_of_many_is_prepared_while_the_old_one_is_shown(few, monkeypatch) -> None:
    hands = Hands(WorldSimulation.of_scene(Settings("gas", 20)))
    session, gate = hands.session, threading.Event()
    make = making.made

    def slowly(create, wants):
        gate.wait(30)
        return make(create, wants)

    monkeypatch.setattr(making, "made", slowly)
    session.begin(Settings("pile", 30))
    hands.frames(2)
    assert session.notice == "Preparing 30 particles …" and session.engine.scene == "gas"
    session.begin(Settings("gas", 40))  # the first wish is given up
    session.adjust("leaf_capacity", 7)
    gate.set()
    settled(hands)
    assert session.engine.scene == "gas" and len(session.frame) == 40
    assert not session.notice.startswith("Preparing")
    hands.window.close()


def test_what_cannot_be_prepared_leaves_the_old_scene(few) -> None:
    hands = Hands(WorldSimulation.of_scene(Settings("gas", 20)))
    hands.session.begin(Settings("no such scene", 30))
    settled(hands)
    assert hands.session.engine.scene == "gas" and "no such scene" in hands.session.notice
    hands.window.close()


def test_a_large_file_is_loaded_while_the_old_scene_is_shown(monkeypatch, tmp_path) -> None:
    monkeypatch.setattr(files, "LARGE", 1)
    hands = Hands(WorldSimulation.of_scene(Settings("gas", 20)))
    session, path = hands.session, tmp_path / "saved.jostle"
    session.save(path)
    session.camera.zoom_at((300, 300), 2.0)
    session.begin(Settings("pile", 30))
    session.load(path)
    assert session.notice == "Loading saved.jostle …" and session.engine.scene == "pile"
    settled(hands)
    assert session.notice == "Loaded saved.jostle"
    assert session.engine.scene == "gas" and len(session.frame) == 20
    path.write_bytes(b"nothing")
    session.load(path)
    settled(hands)
    assert session.notice.startswith("saved.jostle is not") and len(session.frame) == 20


def test_a_loaded_scene_runs_alone_and_a_restart_goes_on_in_a_race(tmp_path) -> None:
    hands = Hands(WorldSimulation.of_scene(Settings("gas", 20)))
    session, path = hands.session, tmp_path / "saved.jostle"
    session.save(path)
    session.toggle_race("brute")
    session.restart()
    assert session.race is not None
    session.load(path)
    assert session.race is None and len(session.frame) == 20
    hands.window.close()


def test_a_restart_does_not_wait_for_a_step_and_the_step_leaves_no_trace(few) -> None:
    hands = Hands(WorldSimulation.of_scene(Settings("gas", 20)))
    session, old = hands.session, hands.session.engine.simulation
    release = held_up(hands)
    abandoned = session.engine._job
    history = session.history
    session.restart()
    session._maker.wait()
    session.paused = True
    hands.frames(1)
    assert session.engine.simulation is not old and not session.engine.busy
    release()
    abandoned.result(30)
    hands.frames(2)
    assert session.engine.steps == 0 and session.frame.facts.time == 0
    assert len(session.history.moments) == 1 and len(history.moments) == 2
    hands.window.close()


# ---- a window on very many -----------------------------------------------------------------------


def test_the_window_does_no_long_work_on_many_particles_itself(monkeypatch, tmp_path) -> None:
    hands = Hands(start.start(Settings("gas", MANY)))
    session, window = hands.session, threading.current_thread()
    session.files.folder = tmp_path
    calls: list[tuple[str, bool]] = []

    def watch(owner: object, name: str) -> None:
        original = getattr(owner, name)

        def watched(*given, **named):
            calls.append((name, threading.current_thread() is window))
            return original(*given, **named)

        monkeypatch.setattr(owner, name, watched)

    for name in ("step", "frame", "save", "adjust", "change", "attract"):
        watch(WorldSimulation, name)
    watch(jostle.scenes, "create")

    def rest() -> None:
        """Let what is under way end, without doing anything of it here."""
        for job in (session._maker._job, session.engine._job, hands.window._backdrop._job):
            if job is not None:
                job.exception(60)
        hands.frames(2)

    hands.frames(3)
    hands.down((100, 100))
    hands.move((300, 300))
    hands.frames(2)
    hands.up((200, 200))
    rest()
    hands.key(pygame.K_SPACE, up=False)
    hands.frames(2)
    hands.key_up(pygame.K_SPACE)
    rest()
    hands.key(pygame.K_p)
    assert session.paused
    hands.key(pygame.K_o)
    hands.frames(2)
    rest()
    rest()
    session.adjust("n", MANY + 10)
    rest()
    rest()
    assert len(session.frame) == MANY + 10
    session.screenshot()
    hands.key(pygame.K_r)
    assert session.notice.startswith("Preparing")
    before = session.engine.simulation
    rest()
    assert session.engine.simulation is not before
    in_the_window = [name for name, here in calls if here]
    assert in_the_window == []
    assert {"step", "frame", "adjust", "create"} <= {name for name, _ in calls}
    hands.window.close()
    assert list(tmp_path.glob("*.png"))
