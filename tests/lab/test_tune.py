"""`jostle tune`: the protocol with a simulated clock, then the command with minimal work."""

from __future__ import annotations

import csv
import math
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread
from rich.console import Console

import jostle
from jostle_lab import cli, tables
from jostle_lab.tune import (
    candidates,
    command,
    findings,
    pictures,
    records,
    report,
    sweep,
)
from jostle_lab.tune.candidates import Setting, candidate, defaults
from jostle_lab.tune.sample import Sample
from jostle_lab.tune.sweep import Effort, Tuner, Tuning
from jostle_lab.tune.timing import Candidate, InterleavedTiming, Outcome, compare

TINY = Effort(rounds=2, seconds=60.0, limit=0.5, most=100)


# ---- the protocol --------------------------------------------------------------------------------


class FalseTime:
    """A clock that advances only by the durations of the calls."""

    def __init__(self) -> None:
        self.now = 0.0
        self.log: list[str] = []

    def __call__(self) -> float:
        return self.now

    def takes(self, name: str, *seconds: float, **options: object) -> Candidate:
        """A call with given durations at its first, second … and every later call."""
        left = list(seconds)

        def call() -> None:
            self.log.append(name)
            self.now += left.pop(0) if len(left) > 1 else left[0]

        return Candidate(call, **options)


def test_every_round_times_each_once_in_an_order_of_its_own() -> None:
    clock = FalseTime()
    names = "abcdefgh"
    timing = InterleavedTiming({name: clock.takes(name, 1.0) for name in names}, clock=clock)
    timing.run(4)
    rounds = [clock.log[k : k + 8] for k in range(0, len(clock.log), 8)]
    assert len(rounds) == 5  # the first only tries
    assert all(sorted(one) == list(names) for one in rounds)
    assert len({tuple(one) for one in rounds}) > 1
    assert all(outcome.rounds == [1.0] * 4 for outcome in timing.outcomes.values())


def test_preparing_is_outside_the_clock() -> None:
    clock = FalseTime()

    def prepare() -> None:
        clock.now += 100.0

    timing = InterleavedTiming({"a": clock.takes("a", 1.0, prepare=prepare)}, clock=clock)
    timing.run(3)
    assert timing.outcomes["a"].rounds == [1.0] * 3


def test_short_calls_are_repeated_within_a_measurement() -> None:
    clock = FalseTime()
    timing = InterleavedTiming(
        {"short": clock.takes("short", 0.75e-3), "long": clock.takes("long", 1.0)}, clock=clock
    )
    timing.run(1)
    assert clock.log.count("short") == 1 + 7 and clock.log.count("long") == 1 + 1
    assert timing.outcomes["short"].median == pytest.approx(0.75e-3)


def test_a_measurement_is_the_median_of_its_calls() -> None:
    clock = FalseTime()
    calls = (1e-3, *(1e-3, 50.0, 1e-3, 1e-3, 1e-3))
    timing = InterleavedTiming({"a": clock.takes("a", *calls)}, clock=clock)
    timing.run(1)
    assert timing.outcomes["a"].median == pytest.approx(1e-3)


def test_what_is_expected_to_be_slow_is_never_called() -> None:
    clock = FalseTime()
    hopeless = clock.takes("hopeless", 1e9, expect=lambda: 11.0)
    timing = InterleavedTiming(
        {"hopeless": hopeless, "quick": clock.takes("quick", 1.0)}, 10.0, clock
    )
    timing.run(3)
    assert "hopeless" not in clock.log
    assert timing.outcomes["hopeless"].status == "too slow"
    assert timing.outcomes["hopeless"].median == math.inf
    assert timing.outcomes["quick"].status == "measured"


def test_what_turns_out_slow_is_called_once() -> None:
    clock = FalseTime()
    timing = InterleavedTiming(
        {"slow": clock.takes("slow", 60.0), "quick": clock.takes("quick", 1.0)}, 10.0, clock
    )
    timing.run(3)
    assert clock.log.count("slow") == 1
    assert timing.outcomes["slow"].status == "too slow"


def test_after_a_stall_there_is_a_second_chance() -> None:
    clock = FalseTime()
    timing = InterleavedTiming({"a": clock.takes("a", 12.0, 1.0)}, 10.0, clock)
    timing.run(3)
    assert timing.outcomes["a"].rounds == [1.0] * 3


def test_time_bounds_the_rounds_and_then_the_trial() -> None:
    clock = FalseTime()
    timing = InterleavedTiming({name: clock.takes(name, 1.0) for name in "abcd"}, clock=clock)
    done = []
    timing.run(100, seconds=17.0, advance=done.append)
    assert {len(outcome.rounds) for outcome in timing.outcomes.values()} == {3}
    assert clock.now == 16.0 and sum(done) == 4 * 101

    clock = FalseTime()
    timing = InterleavedTiming({name: clock.takes(name, 1.0) for name in "abcd"}, clock=clock)
    timing.run(5, seconds=1.5)
    states = [outcome.status for outcome in timing.outcomes.values()]
    assert sorted(states) == ["measured", "measured", "not reached", "not reached"]


def test_a_round_that_is_broken_off_leaves_no_trace() -> None:
    clock = FalseTime()

    def interrupt() -> None:
        if clock.log.count("b") == 3:
            raise KeyboardInterrupt

    timing = InterleavedTiming(
        {"a": clock.takes("a", 1.0), "b": clock.takes("b", 1.0, prepare=interrupt)}, clock=clock
    )
    with pytest.raises(KeyboardInterrupt):
        timing.run(9)
    assert [len(outcome.rounds) for outcome in timing.outcomes.values()] == [2, 2]


def test_a_ratio_within_the_noise_says_so() -> None:
    noise = [1.0, 1.2, 0.9, 1.1, 1.3, 0.8, 1.0, 1.1, 0.9, 1.2]
    drifting = Outcome([(k + 1) * 1.1 for k in range(10)])
    steady = Outcome([k + 1.0 for k in range(10)])
    # In every round one is a tenth slower, though both vary by a factor of ten.
    assert not compare(drifting, steady).within_noise
    assert compare(drifting, steady).median == pytest.approx(1.1)
    assert compare(Outcome(noise), Outcome(noise[::-1])).within_noise
    assert compare(Outcome(), steady).within_noise


def test_below_six_rounds_nothing_is_certain() -> None:
    slow, quick = Outcome([9.0] * 6), Outcome([1.0] * 6)
    assert not compare(slow, quick).within_noise and not compare(slow, quick).too_few
    few = compare(Outcome([9.0] * 5), quick)
    assert few.within_noise and few.too_few and few.median == 9.0


def test_the_range_of_a_median_holds_it_as_often_as_it_says() -> None:
    random = np.random.default_rng(0)
    one = Outcome([1.0] * 15)
    held = [
        compare(Outcome(random.lognormal(0, 0.3, 15).tolist()), one).within_noise
        for _ in range(1000)
    ]
    assert 0.95 <= np.mean(held) <= 0.98  # 15 rounds: ranks 4 to 12, 96.5 %


# ---- candidates ---------------------------------------------------------------------------------


def test_a_world_of_another_size_has_the_same_particles_further_apart() -> None:
    sample = Sample.of("gas", 50)
    wide = sample.resized(2.0)
    assert np.allclose(wide.positions, 2 * sample.positions)
    assert np.array_equal(wide.radii, sample.radii)
    assert wide.world.container.max_x == pytest.approx(2 * sample.world.container.max_x)
    assert np.array_equal(wide.world.positions, wide.positions)


@pytest.mark.parametrize("scene", jostle.scenes.names())
def test_every_scene_fits_into_worlds_of_other_sizes(scene: str) -> None:
    sample = Sample.of(scene, 40)
    for size in sweep.WORLD_SIZES:
        resized = sample.resized(size)
        assert len(resized) == len(sample)
        if size >= 1:  # closer together they are timed without their world
            resized.world.step(1 / 60)


def test_each_step_starts_from_the_same_state() -> None:
    sample = Sample.of("gas", 60)
    step = candidate(sample, Setting(60, 1.0, *defaults()), "step", 1)
    states = []
    for _ in range(3):
        step.prepare()
        step.call()
        states.append(sample.world.positions)
    assert np.array_equal(states[0], states[2])
    assert not np.array_equal(states[0], sample.positions)


def test_a_depth_that_cuts_the_tree_short_is_expected_to_take_longer(monkeypatch) -> None:
    monkeypatch.setattr(candidates, "seconds_a_test", lambda threads: 1.0)
    sample = Sample.of("gas", 400)
    expected = [
        candidate(sample, Setting(400, 1.0, 4, depth), "pairs", 1).expect() for depth in (0, 1, 2)
    ]
    assert expected[0] == 400 * 399 / 2
    assert expected[0] > 1.2 * expected[1] > 2 * expected[2]
    brute = candidate(sample, Setting(400, 1.0, 0, 0, "brute force"), "pairs", 1)
    assert brute.expect() == 400 * 399 / 2


def test_hopeless_settings_are_left_out_and_shown_as_such(monkeypatch, tmp_path) -> None:
    monkeypatch.setattr(candidates, "seconds_a_test", lambda threads: 1.0)  # one second!
    tuner = Tuner("gas", 300, effort=TINY, threads=1)
    tuner.settings(lambda *_: None)
    assert {outcome.status for outcome in tuner.tuning.settings.values()} == {"too slow"}
    assert not list(report.report(tuner.tuning))
    assert not pictures.settings(tuner.tuning, tmp_path / "none.png")


# ---- a whole tuning ------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def tuned() -> Tuning:
    tuner = Tuner("clusters", 100, effort=TINY, threads=1)
    for part in (tuner.settings, tuner.final, tuner.sizes, tuner.counts):
        part(lambda *_: None)
    return tuner.tuning


def test_the_defaults_are_those_of_the_library(tuned) -> None:
    world = jostle.scenes.create("billiards")
    assert defaults() == (world.leaf_capacity, world.max_depth)
    assert (tuned.default.leaf_capacity, tuned.default.max_depth) == defaults()
    assert tuned.default in tuned.settings and tuned.default in tuned.final


def test_the_same_tree_is_timed_once(tuned) -> None:
    limit = tuned.default.max_depth
    depth = tuned.tree_depths[8]
    assert tuned.cell(8, depth) == tuned.cell(8, depth + 3) == tuned.cell(8, limit)
    assert tuned.cell(8, depth - 1).max_depth == depth - 1
    assert {tuned.cell(c, d) for c in tuned.tree_depths for d in (*sweep.DEPTHS, limit)} == set(
        tuned.settings
    )


def test_the_csv_has_a_line_for_each_setting(tuned, tmp_path: Path) -> None:
    records.write(tuned, tmp_path / "t.csv")
    with (tmp_path / "t.csv").open(newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file)
        lines = list(reader)
    assert tuple(reader.fieldnames) == records.COLUMNS
    assert len(lines) == sum(len(outcomes) for _, outcomes in tuned.sweeps())
    assert {line["sweep"] for line in lines} == {"settings", "final", "world size", "particles"}
    for line in lines:
        assert (line["scene"], line["threads"], line["status"]) == ("clusters", "1", "measured")
        assert 0 < float(line["low_s"]) <= float(line["median_s"]) <= float(line["high_s"])
        assert (line["leaf_capacity"] == "") == (line["method"] != "quadtree")


@pytest.mark.parametrize("draw", [pictures.settings, pictures.curves])
def test_pictures_show_something(tuned, draw, tmp_path: Path) -> None:
    assert draw(tuned, tmp_path / "p.png")
    image = imread(tmp_path / "p.png")
    assert image.shape[0] > 500 and image.shape[1] > 900
    colours = (255 * image[..., :3]).astype(np.uint32) @ np.array([65536, 256, 1], np.uint32)
    assert (colours < 0xFCFCFC).mean() > 0.01
    assert len(np.unique(colours)) > 50


@pytest.mark.parametrize(
    ("best", "rounds", "words"),
    [
        (64, 9, ["", " (default)", " (best at ×1)"]),
        (defaults()[0], 9, ["", " (default = best)"]),
        (64, 5, ["", " (default)"]),
    ],
)
def test_the_worlds_are_drawn_for_three_leaf_capacities(best, rounds, words) -> None:
    tuning = made_up(c8=[1.0])
    for capacity in {*sweep.SIZE_CAPACITIES, defaults()[0]}:
        setting = Setting(10, 1.0, capacity, defaults()[1])
        tuning.sizes[setting] = Outcome([1.0 if capacity == best else 1.5] * rounds)
    shown = pictures._shown_sizes(tuning)
    assert [word for word, _ in shown.values()] == words
    assert best in shown or rounds < 6


def test_nothing_measured_makes_no_picture(tmp_path: Path) -> None:
    nothing = Tuning("gas", 1000, "pairs", None, Setting(1000, 1.0, *defaults()))
    assert not pictures.settings(nothing, tmp_path / "p.png")
    assert not pictures.curves(nothing, tmp_path / "p.png")
    assert not list(report.report(nothing))
    records.write(nothing, tmp_path / "p.csv")
    assert (tmp_path / "p.csv").read_text().count("\n") == 1


def made_up(**times: list[float]) -> Tuning:
    """A tuning of leaf capacities (c8=…) that took these times, round by round."""
    limit = defaults()[1]
    tuning = Tuning("gas", 10, "pairs", 1, Setting(10, 1.0, *defaults()))
    for name, rounds in times.items():
        tuning.settings[Setting(10, 1.0, int(name[1:]), limit)] = Outcome(rounds)
    tuning.tree_depths = {setting.leaf_capacity: 2 for setting in tuning.settings}
    return tuning


def test_the_verdict_names_a_real_gain_and_no_other() -> None:
    default = f"c{defaults()[0]}"
    slower, noisy = [1.5] * 9, [0.9, 1.2, 0.9, 1.2, 0.9, 1.2, 0.9, 1.2, 0.9]
    verdict = report.verdict(made_up(**{default: slower, "c100": [1.0] * 9}))
    assert "1.50 times" in verdict and "Of 2 different trees no other is not" in verdict
    assert "not significant" in report.verdict(made_up(**{default: [1.0] * 9, "c100": noisy}))
    stands = report.verdict(made_up(**{default: [1.0] * 9, "c100": slower}))
    assert "No setting is faster than the default" in stands
    few = report.verdict(made_up(**{default: [1.5] * 2, "c100": [1.0] * 2}))
    assert "too few rounds to say" in few


def test_the_last_words_say_what_to_do() -> None:
    default = f"c{defaults()[0]}"

    def advice(default_takes: float, rounds: int = 9) -> str:
        tuning = made_up(**{default: [default_takes] * rounds, "c100": [1.0] * rounds})
        return report.advice(tuning)

    assert "jostle.Quadtree(centers, radii, leaf_capacity=100, threads=1).pairs()" in advice(1.5)
    assert "is too small" in advice(1.04) and "no setting is significantly faster" in advice(0.9)
    assert all("Too few rounds" in advice(takes, rounds=5) for takes in (1.5, 1.0, 0.5))


def test_a_line_of_code_runs() -> None:
    tuning = made_up(c8=[1.0] * 9)
    names = dict.fromkeys(("centers", "positions", "velocities"), np.zeros((3, 2)))
    for tuning.work in ("pairs", "step"):
        line = report.code(tuning, Setting(10, 1.0, 8, 5))
        exec(line, {"jostle": jostle, **names, "radii": np.ones(3)})


def test_the_final_decides_who_is_as_good_and_the_best_always_is() -> None:
    tuning = made_up(c8=[1.0] * 9, c16=[1.1] * 9, c100=[1.2] * 9)
    c8, c16, c100 = tuning.settings
    assert [tuning.is_as_good(s) for s in (c8, c16, c100)] == [True, False, False]
    tuning.final = {c8: Outcome([1.0, 1.2] * 9), c16: Outcome([1.2, 0.9] * 9)}
    assert tuning.best() == c16
    assert [tuning.is_as_good(s) for s in (c8, c16, c100)] == [True, True, False]


def test_the_best_gains_nothing_over_itself() -> None:
    tuning = made_up(**{f"c{defaults()[0]}": [1.0] * 9, "c100": [1.5] * 9})
    table = next(iter(report.report(tuning)))
    assert list(table.columns[-1].cells)[:2] == ["1.00 ×", "1.00 ×"]


@pytest.mark.parametrize("width", [40, 80])
def test_figures_are_whole_on_a_narrow_console(tuned, capsys, width) -> None:
    console = Console(width=width)
    for part in report.report(tuned):
        if not isinstance(part, str):
            tables.print_whole(part, console)
    printed = capsys.readouterr().out
    assert "…" not in printed and " ms" in printed and "100" in printed
    if width == 80:
        assert all(len(line) <= 80 for line in printed.splitlines())


def test_of_equals_the_one_without_a_limit_is_best() -> None:
    tuning = made_up(c100=[1.0, 1.01] * 5)
    tuning.settings[Setting(10, 1.0, 4, 1)] = Outcome([1.01, 0.98] * 5)
    assert tuning.best().leaf_capacity == 100
    tuning.settings[Setting(10, 1.0, 4, 1)] = Outcome([0.5] * 10)
    assert tuning.best().leaf_capacity == 4


def test_findings_lie_between_the_measured_points() -> None:
    def of(method: str, *times: float) -> dict:
        return {
            Setting(n, 1.0, 0, 0, method): Outcome([t])
            for n, t in zip((100, 1_000, 10_000), times, strict=True)
        }

    counts = {**of("quadtree", 2e-3, 1e-2, 1e-1), **of("brute force", 1e-3, 2e-2, 2.0)}
    assert findings.crossing(counts) == pytest.approx(10**2.5)
    assert findings.particles_within(findings.curve(counts, "quadtree"), 1e-2) == pytest.approx(1e3)
    assert findings.particles_within(findings.curve(counts, "quadtree"), 1.0) is None
    assert findings.two_digits(12_345) == 12_000 and findings.two_digits(7) == 7


# ---- the command ---------------------------------------------------------------------------------


def run(monkeypatch, *arguments: str) -> int:
    monkeypatch.setattr(sys, "argv", ["jostle", "tune", *arguments])
    with pytest.raises(SystemExit) as exit_:
        cli.main()
    return exit_.value.code


@pytest.fixture
def hasty(monkeypatch) -> None:
    monkeypatch.setattr(command, "QUICK", TINY)


@pytest.mark.parametrize(("options", "stem"), [((), "orbit"), (("--step",), "orbit-step")])
def test_tune_leaves_tables_csv_and_pictures(
    monkeypatch, capsys, tmp_path: Path, hasty, options, stem
) -> None:
    out = tmp_path / "new"
    monkeypatch.setattr(cli.commands, "console", Console(width=120))
    code = run(
        monkeypatch, "orbit", "--n", "150", "--quick", "--rounds", "1", "--out", str(out), *options
    )
    printed = capsys.readouterr().out
    assert code == 0
    assert sorted(path.name for path in out.iterdir()) == [
        f"tune-{stem}-particles.png",
        f"tune-{stem}-settings.png",
        f"tune-{stem}.csv",
    ]
    for words in ("default", "capacity", "brute force", "whole frame", f"tune-{stem}.csv"):
        assert words in printed


def test_interrupted_it_leaves_what_was_measured(monkeypatch, capsys, tmp_path, hasty) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Tuner, "sizes", interrupt)
    assert run(monkeypatch, "gas", "--n", "150", "--quick", "--out", str(tmp_path)) == 130
    assert "Stopped" in capsys.readouterr().out
    assert {path.name for path in tmp_path.iterdir()} == {"tune-gas.csv", "tune-gas-settings.png"}
    lines = (tmp_path / "tune-gas.csv").read_text().splitlines()
    assert any(",settings," in line for line in lines)
    assert not any(",world size," in line for line in lines)


@pytest.mark.parametrize("at", ["__init__", "settings"])
def test_interrupted_at_once_it_leaves_no_folder(monkeypatch, capsys, tmp_path, hasty, at) -> None:
    def interrupt(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Tuner, at, interrupt)
    out = tmp_path / "new" / "folder"
    assert run(monkeypatch, "gas", "--n", "150", "--quick", "--out", str(out)) == 130
    assert "before anything was measured" in capsys.readouterr().out
    assert not out.parent.exists()


@pytest.mark.parametrize("n", ["1", str(defaults()[0])])
def test_what_fits_one_leaf_is_not_tuned(monkeypatch, capsys, tmp_path, hasty, n) -> None:
    assert run(monkeypatch, "gas", "--n", n, "--quick", "--out", str(tmp_path)) == 0
    printed = capsys.readouterr().out
    assert "nothing to tune" in printed and "World size" not in printed
    assert not (tmp_path / "tune-gas-settings.png").exists()


@pytest.mark.parametrize("name", ["tune-gas.csv", "tune-gas-particles.png"])
def test_a_folder_in_the_place_of_a_file_is_refused_first(
    monkeypatch, capsys, tmp_path, name
) -> None:
    (tmp_path / name).mkdir()
    assert run(monkeypatch, "gas", "--out", str(tmp_path)) == 2
    printed = capsys.readouterr()
    assert not printed.out and name in printed.err and printed.err.count("\n") == 1


def test_a_file_that_cannot_be_written_is_one_sentence(
    monkeypatch, capsys, tmp_path, hasty
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(records, "write", full)
    assert run(monkeypatch, "gas", "--n", "20", "--quick", "--out", str(tmp_path)) == 2
    sentence = capsys.readouterr().err
    assert "No space left" in sentence and sentence.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere"], "there is no scene 'nowhere'; the scenes are article, gas"),
        (["gas", "--n", "0"], "-n is 0; it must be a whole number from 1 to 2,000,000"),
        (["gas", "--n", "3000000"], "-n is 3000000; it must be a whole number from 1"),
        (["gas", "--n", "few"], "Invalid value for '-n'"),
        (["gas", "--rounds", "0"], "--rounds is 0"),
        (["gas", "--threads", "0"], "--threads is 0"),
        (["gas", "--seed", "-1"], "--seed is -1"),
        (["gas", "--out", "/dev/null/out"], "--out is '/dev/null/out'"),
        ([], "Missing argument"),
    ],
)
def test_bad_input_gets_one_sentence(monkeypatch, capsys, arguments, words) -> None:
    assert run(monkeypatch, *arguments) == 2
    printed = capsys.readouterr()
    assert not printed.out and printed.err.count("\n") == 1
    assert printed.err.startswith("jostle: ") and words in printed.err
