"""The statistics: ring buffers, requests for sums, and the change of energy."""

from dataclasses import replace
from time import sleep

import numpy as np
import pytest
from lab_overlays import frame_of

import jostle
from jostle_lab.measure import EVERY, Series, Statistics, Traces
from jostle_lab.schema import Settings
from jostle_lab.session import Session
from jostle_lab.simulate.frame import Energies, Frame, StepStats
from jostle_lab.simulate.start import start

FRAME = 1 / 60


def state(
    time: float, kinetic: float, potential: float = 0.0, momentum: tuple[float, float] = (0, 0)
) -> Frame:
    """Two discs of mass 1 with sums as a test likes them."""
    stages = {"build": 2.0, "pairs": 3}
    stats = StepStats(time=time, pairs_tested=7, touching=3, stage_times=stages)
    energies = Energies(kinetic, potential, momentum)
    return replace(frame_of([(0, 0), (0, 0)], 1.0), stats=stats, energies=energies)


def seen(*states: Frame) -> Statistics:
    statistics = Statistics()
    for k, frame in enumerate(states):
        statistics.follow(frame, k * EVERY, EVERY, running=True)
    return statistics


def test_a_series_keeps_its_newest_rows_in_order() -> None:
    series = Series(("a", "b"), 3)
    assert series["a"].tolist() == []
    for k in range(8):
        series.add(k, -k)
        assert series["a"].tolist() == list(range(max(0, k - 2), k + 1))
    assert series.table.tolist() == [[5, 6, 7], [-5, -6, -7]]
    assert series["a"].flags.c_contiguous


@pytest.mark.parametrize("written", range(2, 9))
def test_rows_can_be_dropped_and_written_again(written: int) -> None:
    series = Series(("a",), 4)
    for k in range(written):
        series.add(k)
    series.drop(2)
    series.add(100)
    kept = list(range(max(0, written - 4), written - 2))
    assert series["a"].tolist() == [*kept, 100]
    series.drop(50)
    assert len(series) == 0


def test_every_state_with_sums_gets_one_row_until_time_is_turned_back() -> None:
    first = state(0.0, 10.0, -4.0, (1, 2))
    statistics = seen(first, first, state(0.1, 9.0, -3.0))
    rows = statistics.sums
    assert rows["time"].tolist() == [0.0, 0.1]
    assert rows["total"].tolist() == [6.0, 6.0]
    assert rows["momentum_y"].tolist() == [2.0, 0.0]
    assert rows["pairs_tested"].tolist() == [7.0, 7.0]
    assert len(seen(replace(first, energies=None)).sums) == 0
    statistics = seen(*(state(k / 10, 10.0 + k) for k in range(5)), state(0.2, 77.0))
    assert statistics.sums["time"].tolist() == [0.0, 0.1, 0.2]
    assert statistics.sums["kinetic"].tolist() == [10.0, 11.0, 77.0]


def test_energy_that_doubles_has_drifted_by_all_of_it_and_rest_by_nothing() -> None:
    statistics = seen(state(0, 50.0), state(0.1, 75.0), state(0.2, 100.0))
    assert statistics.sums["drift"].tolist() == [0.0, 50.0, 100.0]
    assert statistics.energy_drift == pytest.approx(1.0)
    statistics = seen(state(0, 0.0), state(0.1, 0.0))
    assert statistics.energy_drift == 0 and statistics.momentum_drift == 0


def test_drift_does_not_depend_on_the_zero_of_height_and_momentum_is_that_of_all_one_way() -> None:
    for zero in (0.0, -1e6, 25.0):
        falling = [state(0, 0, zero), state(0.1, 20, zero - 20), state(0.2, 20, zero - 40)]
        assert seen(*falling).energy_drift == pytest.approx(-0.5)
    statistics = seen(state(0, 4.0, momentum=(1, 0)), state(0.1, 4.0, momentum=(1, 2)))
    assert statistics.momentum_drift == pytest.approx(0.5)


def test_drift_can_be_measured_from_now_on_and_begins_anew_after_going_back() -> None:
    statistics = seen(state(0, 50.0), state(0.1, 75.0))
    statistics.reset_reference()
    statistics.follow(state(0.2, 75.0), 1.0, FRAME, running=True)
    assert statistics.energy_drift == 0.0
    statistics = seen(*(state(k / 10, 10.0) for k in range(5)))
    statistics.reset_reference()
    statistics.follow(state(0.5, 20.0), 1.0, FRAME, running=True)
    statistics.follow(state(0.2, 10.0), 1.1, FRAME, running=True)
    assert statistics.reference.time == statistics.origin.time == pytest.approx(0.2)
    assert statistics.energy_drift == 0.0


def with_tags(frame: Frame, *tags: int) -> Frame:
    return replace(frame, tags=np.array(tags))


def test_drift_begins_anew_when_particles_come_or_go() -> None:
    before, after = state(0.1, 50.0, -100.0), with_tags(state(0.2, 90.0, -10.0), 0, 2)
    statistics = seen(state(0.0, 50.0, -100.0), before, after)
    assert statistics.changing and statistics.energy_drift == 0.0
    assert statistics.sums["total"].tolist() == [-50, -50, 80], "the sums themselves go on"
    for time in (1.0, 1.3):
        statistics.follow(with_tags(state(time, 99.0, -10.0), 0, 2), time, EVERY, running=True)
        assert statistics.changing == (time - 0.2 < 1)
    assert statistics.energy_drift == pytest.approx(0.1)
    assert statistics.measured == pytest.approx(1.1)


def test_times_have_a_row_a_frame() -> None:
    statistics = Statistics()
    statistics.measure(draw=4.0, panels=1.0)
    statistics.follow(state(0, 1.0), 0.5, 0.016, running=True)
    statistics.follow(state(0, 1.0), 0.6, 0.1, running=False)
    assert statistics.stages == ("build", "pairs", "draw", "panels")
    assert statistics.times["frame"].tolist() == pytest.approx([16.0, 100.0])
    assert statistics.times.table[2:].T.tolist() == [[2, 3, 4, 1], [0, 0, 4, 1]]


def test_sums_are_asked_for_ten_times_a_second_at_most(open_session) -> None:
    session, asked = open_session("gas", 100), 0
    for _ in range(60):
        run(session, FRAME)
        asked += session.engine.request.energies
    assert 5 <= asked <= 11


def test_no_picture_is_taken_just_to_begin_drift_again(open_session, monkeypatch) -> None:
    session = open_session("gas", 100)
    run(session, 0.2)
    looks = []
    monkeypatch.setattr(session.engine, "refresh", lambda: looks.append(1))
    for k in range(5):
        session.runner.adjust("gravity", (0.0, 10.0 * k))
        run(session, FRAME)
    assert not looks
    assert session.runner.statistics.reference is not None


def test_drift_begins_again_also_in_a_pause(open_session) -> None:
    session = open_session("pile", 100)
    run(session, 0.5)
    session.runner.paused = True
    assert session.runner.statistics.energy_drift != 0
    session.runner.statistics.reset_reference()
    run(session, FRAME)
    assert session.runner.statistics.energy_drift == 0


def test_slow_steps_are_summed_up_less_often_and_recording_is_a_part_of_them(
    open_session, monkeypatch
) -> None:
    statistics = Statistics()
    statistics.follow(state(0, 1.0), 0.0, 0.3, running=True, step_seconds=0.3)
    assert not statistics.energies_due(0.8)
    assert statistics.energies_due(0.95)
    session = open_session("gas", 100)
    monkeypatch.setattr(session.runner.history, "after", lambda _: sleep(0.1))
    run(session, FRAME)
    assert session.engine.whole_seconds >= 0.1 + session.engine.step_seconds
    assert not session.runner.statistics.energies_due(session.messages.now + 0.29)


def test_lines_are_renewed_a_few_times_a_second(open_session) -> None:
    session = open_session("gas", 100)
    traces, renewed = session.traces, 0
    for _ in range(120):
        before = traces.frames.copy()
        run(session, FRAME)
        traces.refresh(session.frame, session.messages.now)
        renewed += not np.array_equal(before, traces.frames)
    assert 8 <= renewed <= 15


def test_the_stack_of_times_adds_up() -> None:
    statistics = Statistics()
    traces = Traces(statistics)
    statistics.measure(draw=4.0, panels=1.0)
    for k in range(60):
        statistics.follow(state(k / 60, 1.0), k / 60, 0.016, running=True)
    traces.refresh(state(1.0, 1.0), 59 / 60)
    assert traces.stacked[:, -1].tolist() == pytest.approx([0, 2, 5, 9, 10])
    assert (np.diff(traces.stacked, axis=0) >= 0).all()
    assert traces.stacked[-1, :50].tolist() == [0.0] * 50, "there was nothing yet"
    assert traces.top == 20.0 and traces.means["pairs"] == pytest.approx(3.0)


def test_one_hitch_does_not_set_the_scale_of_times() -> None:
    statistics = Statistics()
    traces = Traces(statistics)
    for k in range(300):
        elapsed = 0.4 if k == 200 else 0.016
        statistics.follow(state(k / 60, 1.0), k / 60, elapsed, running=True)
    traces.refresh(state(5.0, 1.0), 299 / 60)
    assert traces.frames.max() > 90.0 and traces.top == 20.0
    slow = Statistics()
    for k in range(12):
        slow.follow(state(k / 3, 1.0), k / 3, 0.4, running=True)
    traces = Traces(slow)
    traces.refresh(state(4.0, 1.0), 11 / 3)
    assert traces.top == 500.0, "where all are slow, the scale says so"


def test_lines_of_energy_begin_where_the_rules_changed() -> None:
    statistics = seen(state(0.0, 5.0, -100.0), state(0.1, 5.0, -100.0))
    traces = Traces(statistics)
    traces.refresh(state(0.1, 5.0), 0.1)
    assert traces.energies[:, -1].tolist() == [0.1, 5.0, 5.0, 0.0]
    statistics.reset_reference()
    traces.refresh(state(0.1, 5.0), 5.0)
    assert traces.energies.shape == (4, 2), "the old lines stay until there is a new sum"
    statistics.follow(state(0.2, 5.0, 7000.0), 5.1, FRAME, running=True)
    for now in (5.2, 5.4, 5.6, 5.8, 6.0):
        traces.refresh(state(0.2, 5.0), now)
    assert traces.energies.T.tolist() == [[0.2, 5.0, 5.0, 0.0]]
    assert traces.momenta.shape == (3, 1)


def run(session: Session, seconds: float) -> None:
    for _ in range(round(seconds / FRAME)):
        session.messages.now += FRAME
        session.advance(FRAME)


def test_a_gas_keeps_its_energy_and_a_new_beginning_starts_the_statistics_afresh(
    open_session,
) -> None:
    session = open_session("gas", 200)
    run(session, 1.0)
    statistics = session.runner.statistics
    assert statistics.sums["time"][0] == 0.0, "drift begins with the first state"
    assert statistics.sums["time"][-1] > 0.8
    assert abs(statistics.energy_drift) < 1e-3
    session.runner.choose_scene("pile")
    assert session.runner.statistics.sums["time"].tolist() == [0.0]
    run(session, 0.3)
    sums = session.runner.statistics.sums
    assert sums["time"][0] == 0.0 and len(sums) > 1


def test_merging_is_no_drift(open_session) -> None:
    session = open_session("stars", 300)
    before = len(session.frame)
    for _ in range(20):
        run(session, 0.25)
        assert abs(session.runner.statistics.energy_drift) < 0.02
    assert len(session.frame) < before


def test_scenes_follow_each_other_in_a_circle(open_session) -> None:
    session = open_session("article", 20, method="brute")
    session.runner.next_scene(-1)
    assert session.engine.scene == jostle.scenes.names()[-1]
    session.runner.next_scene()
    assert session.engine.scene == "article"
    assert session.settings.n is None and session.settings.method == "brute"


def test_open_choices_are_filled_in_with_what_holds() -> None:
    pile = start(Settings("pile", 50))
    assert pile.settings.gravity is None
    assert pile.effective_settings.gravity == (0.0, 900.0)
    pile.step()
    assert pile.settings.substeps is None and pile.effective_settings.substeps == 4
