"""Rewind and scrub: what is shown has really been, bit for bit, whatever was done in between."""

import math
from pathlib import Path

import numpy as np
import pytest
from lab_scenes import in_many_scenes

from jostle_lab.schema import Settings
from jostle_lab.session import Session
from jostle_lab.simulate.frame import Attractor
from jostle_lab.simulate.history import History
from jostle_lab.simulate.simulation import Held, Inputs
from jostle_lab.simulate.start import start


def fingerprint(session: Session) -> object:
    return session.engine.simulation.world.state_hash(), session.frame.tags.tobytes()


@pytest.fixture(autouse=True)
def _patience(monkeypatch: pytest.MonkeyPatch) -> None:
    """Compute every state again that has no snapshot, also on a machine that is busy."""
    monkeypatch.setattr("jostle_lab.simulate.history.PATIENCE", 1e9)


def session_of(settings: Settings, stride: int = 1) -> Session:
    session = Session(start(settings), (640, 360), synchronous=True)
    session.runner.history.stride = stride
    return session


def run(session: Session, steps: int) -> list[object]:
    """Step; return the fingerprints of the state before and after each."""
    prints = [fingerprint(session)]
    for _ in range(steps):
        session.engine.step()
        prints.append(fingerprint(session))
    return prints


@pytest.mark.parametrize("stride", [1, 8])
@in_many_scenes
def test_scrubbing_shows_the_same_states(settings: Settings, stride: int) -> None:
    session = session_of(settings, stride)
    prints = run(session, 20)
    step = session.engine.time_step
    for ago in (0, 1, 20, 7, 8, 13, 3):
        session.runner.rewind(ago * step)
        assert fingerprint(session) == prints[20 - ago], ago
    assert session.runner.paused
    session.runner.rewind(1000.0)
    assert fingerprint(session) == prints[0]


@in_many_scenes
def test_stepping_back_and_on_again_is_the_same_way(settings: Settings) -> None:
    session = session_of(settings, stride=4)
    prints = run(session, 11)
    for before in reversed(prints[-5:-1]):
        session.runner.step_back()
        assert fingerprint(session) == before
    assert run(session, 4)[1:] == prints[-4:]
    assert len(session.runner.history.moments) == 12  # the old future has gone


def test_stepping_back_ends_at_the_beginning_and_beginning_anew_forgets() -> None:
    session = session_of(Settings("gas", 20))
    (first, _) = run(session, 1)
    for _ in range(3):
        session.runner.step_back()
    assert fingerprint(session) == first
    run(session, 5)
    session.runner.restart()
    assert (session.runner.history.span, len(session.runner.history.moments)) == (0.0, 1)
    np.testing.assert_array_equal(session.frame.tags, np.arange(20))


@pytest.mark.parametrize("stride", [1, 5])
def test_acts_of_a_person_are_shown_as_they_were(stride: int) -> None:
    """Edits, a drag over several steps, and Space."""
    session = session_of(Settings("gas", 100), stride)
    engine, prints = session.engine, {}

    def go(steps: int) -> None:
        for _ in range(steps):
            engine.step()
            prints[len(prints) + 1] = fingerprint(session)

    go(7)
    engine.edit(lambda simulation: simulation.remove([3, 4]))
    go(3)
    engine.hold(Inputs(grab=Held(7, (100.0, 100.0), (0.0, 0.0))))
    go(7)
    engine.hold(Inputs())
    go(3)
    engine.hold(Inputs(attract=Attractor(8.0, (50.0, 50.0), passing=True)))
    go(2)
    engine.hold(Inputs())
    session.runner.adjust("gravity", (0.0, 50.0))
    go(9)
    history = session.runner.history
    times = [moment.time for moment in history.moments]
    assert len(times) > 31 / 2
    if stride == 1:
        assert len(times) == 32
    for index, time in reversed(list(enumerate(times))):
        session.runner.rewind(history.moments[-1].time - time)
        assert history.at == index
        step = round(time / engine.time_step)
        assert step == 0 or fingerprint(session) == prints[step]
        assert (100 in (len(session.frame),)) == (step <= 7)
    assert session.settings.gravity is None  # the slider goes back as well


def test_a_drag_before_a_refused_step_is_not_forgotten(monkeypatch) -> None:
    session = session_of(Settings("gas", 50), stride=8)
    engine = session.engine
    run(session, 1)

    engine.hold(Inputs(grab=Held(0, (3.0, 4.0), (0.0, 0.0))))

    def refused(inputs: Inputs) -> None:
        engine.simulation.hold(inputs)
        raise ValueError("too fast")

    with monkeypatch.context() as patch:
        patch.setattr(engine.simulation, "step", refused)
        engine.request_step()
        assert engine.take_error() == "too fast"
    engine.hold(Inputs())
    prints = run(session, 2)
    session.runner.rewind(0.0)
    assert fingerprint(session) == prints[-1]


def test_an_edit_in_a_pause_is_undone_by_a_step_back_and_in_the_past_ends_the_old_future() -> None:
    session = session_of(Settings("gas", 50))
    run(session, 3)
    before = fingerprint(session)
    session.engine.edit(lambda simulation: simulation.remove([0]))
    edited = fingerprint(session)
    session.runner.step_back()
    assert fingerprint(session) == before and len(session.frame) == 50
    session.runner.rewind(0.0)
    assert fingerprint(session) == edited and len(session.frame) == 49
    run(session, 10)
    session.runner.rewind(5 * session.engine.time_step)
    session.engine.edit(lambda simulation: simulation.remove([1]))
    session.runner.rewind(0.0)
    assert len(session.frame) == 48
    assert session.runner.history.span == pytest.approx(8 * session.engine.time_step)


def test_what_changes_nothing_leaves_the_future_alone(tmp_path: Path) -> None:
    session = session_of(Settings("gas", 50))
    prints = run(session, 10)
    session.runner.rewind(5 * session.engine.time_step)
    session.interaction.press()  # on the ground, or on a particle that is let go where it was
    session.interaction.cancel()
    session.interaction.drag_tool.drop()
    session.interaction.release(throw=not session.runner.paused)
    session.runner.adjust("time_scale", 0.5)
    session.files.folder = tmp_path
    session.files.save()
    session.files.export_gsd()
    for _ in range(3):
        session.advance(1 / 60)
    session.runner.rewind(0.0)
    assert fingerprint(session) == prints[-1]
    session.close()


@pytest.mark.parametrize("seconds", [0.5, 2.0])
def test_it_reaches_back_as_far_as_it_says(seconds: float) -> None:
    simulation = start(Settings("gas", 10))
    history = History(simulation, seconds=seconds)
    for _ in range(200):
        simulation.step()
        history.after(simulation)
    assert history.span == pytest.approx(seconds, abs=1.5 * simulation.time_step)


def test_memory_stays_within_the_budget_and_a_larger_world_keeps_one_snapshot() -> None:
    simulation = start(Settings("gas", 100))
    budget = 12 * len(simulation.save())
    history, prints = History(simulation, seconds=1e9, budget=budget), {}
    history.stride = 1
    for step in range(1, 301):
        if step % 70 == 0:
            simulation.change([step % 100], velocities=(3.0, 4.0))
            history.touch()
        simulation.step()
        history.after(simulation)
        prints[step] = simulation.world.state_hash()
        assert history.bytes <= budget
        assert history.bytes == sum(len(m.state) for m in history.moments if m.state)
    assert history.stride > 4 and history.span > 200 / 60
    for index in range(len(history.moments) - 1, -1, -7):
        history.show(simulation, index)
        step = round(history.moments[index].time * 60)
        assert step == 0 or simulation.world.state_hash() == prints[step]
    simulation = start(Settings("gas", 100))
    history = History(simulation, budget=1)
    for _ in range(200):
        simulation.step()
        history.after(simulation)
    assert sum(moment.state is not None for moment in history.moments) == 1
    last = simulation.world.state_hash()
    history.show(simulation, len(history.moments))
    assert simulation.world.state_hash() == last


def test_where_steps_are_slow_a_snapshot_is_shown_instead() -> None:
    session = session_of(Settings("gas", 50), stride=8)
    prints = run(session, 20)
    session.engine.last_seconds = math.inf
    session.runner.rewind(5 / 60)
    assert session.runner.history.at == 8
    assert fingerprint(session) == prints[8]
