"""The benchmark compares before it times, and times what it says. No test depends on a time."""

import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import bandwidth
import defaults
import held
import matplotlib
import numpy as np
import pairs
import plot
import pytest
import run
import shapes
import step_rivals
import steps
import tables
from machine import Results, describe, slug, version_of
from outputs import table
from pair_rivals import RIVALS, Rival, Unable
from ratios import compare, crossing
from timing import Effort, Timing, interleaved

import jostle

SCENES = list(shapes.SCENES)
BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.mark.parametrize("scene", SCENES)
def test_a_scene_is_seeded_and_made_of_float32_numbers(scene: str) -> None:
    made, again = shapes.create(scene, 200), shapes.create(scene, 200)
    assert np.array_equal(made.centers, again.centers)
    assert not np.array_equal(made.centers, shapes.create(scene, 200, seed=1).centers)
    for column in (made.centers, made.column(), made.half_sizes):
        if column is not None:
            assert column.dtype == np.float64
            assert np.array_equal(column, column.astype(np.float32))


@pytest.mark.parametrize("scene", ["discs", "mixed", "rectangles"])
def test_shapes_cover_forty_per_cent(scene: str) -> None:
    made = shapes.create(scene, 4_000)
    halves = made.half_sizes
    covered = np.pi * made.column() ** 2 if halves is None else 4 * np.prod(halves, axis=1)
    side = np.ptp(made.centers, axis=0)
    assert covered.sum() / np.prod(side) == pytest.approx(0.4, rel=0.05)


def test_mixed_has_radii_a_hundred_to_one_and_mostly_small() -> None:
    radii = shapes.create("mixed", 20_000).column()
    assert radii.min() == pytest.approx(1, rel=0.01) and 60 < radii.max() <= 100
    assert np.median(radii) < 2


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("rival", RIVALS, ids=lambda rival: rival.name)
def test_every_rival_that_is_installed_finds_the_same_pairs(rival: Rival, scene: str) -> None:
    if version_of(rival.package) is None:
        pytest.skip(f"{rival.package} is not installed")
    made = shapes.create(scene, 120)
    expected = jostle.find_pairs(made.centers, made.radii, made.half_sizes, method="brute")
    assert len(expected) > 10
    for setting in rival.settings:
        for threads in rival.threads:
            entrant = pairs.Entrant(rival, threads, setting)
            try:
                pairs.check(entrant, made, pairs.keys(expected, len(made)))
            except Unable as reason:
                assert str(reason)


def ours(**changes: object) -> Rival:
    return replace(RIVALS[0], threads=(1,), **changes)  # type: ignore[arg-type]


def test_a_race_yields_a_row_for_each_rival_and_size() -> None:
    scipy = [rival for rival in pairs.installed() if rival.name == "SciPy cKDTree"]
    groups = list(pairs.compare("discs", (20, 50), Effort(2), [ours(), *scipy]))
    assert [[row["count"] for row in rows] for rows in groups] == [[20] * 2, [50] * 2]
    for row in groups[1]:
        assert row["rounds"] == 2 and row["version"] and float(str(row["median_s"])) > 0
    assert "leafsize=" in str(groups[1][1]["setting"])


@pytest.mark.parametrize(
    "wrong",
    [
        lambda found: found[1:],
        lambda found: np.vstack([found, found[:1]]),
        lambda found: np.vstack([found, [[0, len(found)]]]),
    ],
    ids=["one missing", "one twice", "one too many"],
)
def test_a_wrong_answer_stops_the_race(wrong) -> None:
    def right(made: shapes.Shapes, threads: int):
        return jostle.find_pairs(made.centers, made.radii, sort=True)

    liar = ours(name="liar", find=lambda made, threads: wrong(right(made, threads)))
    with pytest.raises(pairs.Disagreement, match="liar finds"):
        list(pairs.compare("discs", (100,), Effort(1), [ours(), liar]))


def test_what_cannot_be_done_or_is_slow_gets_a_row_with_the_reason() -> None:
    def refuse(made: shapes.Shapes, threads: int) -> None:
        raise Unable("never")

    (rows,) = pairs.compare("discs", (20,), Effort(1), [ours(), ours(name="no", find=refuse)])
    assert rows[1]["note"] == "never" and rows[1]["rounds"] == 0 and rows[1]["median_s"] == ""
    small, large = pairs.compare("discs", (20, 40), Effort(3, patience=1e-9), [ours()])
    assert small[0]["rounds"] == 1 and small[0]["median_s"]
    assert large[0]["rounds"] == 0 and large[0]["note"]


@pytest.mark.parametrize("scene", steps.SCENES)
def test_simulations_begin_alike_and_are_compared_before_they_are_timed(scene: str) -> None:
    (rows,) = steps.compare(scene, (30,), Effort(2, patience=30))
    names = {row["name"] for row in rows}
    assert {"jostle", "jostle, brute force"} <= names
    for package in ("pymunk", "pyb2d3"):
        assert (package in names) == (version_of(package) is not None)
    speeds = {row["name"]: float(str(row["rms_speed"])) for row in rows if row["rms_speed"]}
    for row in rows:
        assert row["rounds"] == 2 and float(str(row["median_s"])) > 0
        if scene == "gas" and row["rms_speed"]:  # the energy stays, but Box2D loses some
            tolerance = 0.4 if str(row["name"]).startswith("pyb2d3") else 0.05
            assert speeds[str(row["name"])] == pytest.approx(speeds["jostle"], rel=tolerance)
            assert ("energy" in str(row["note"])) == (tolerance == 0.4)


def test_a_pile_comes_to_rest_and_is_not_waited_for_if_slow() -> None:
    pile = step_rivals.pile(40)
    assert pile is not None and step_rivals.speed(pile.velocities) < step_rivals.SETTLED
    assert step_rivals.pile(41, 1e-9) is None


@pytest.mark.parametrize("manner", ["body by body", "batch"])
def test_pymunk_answers_in_the_order_of_the_beginning(manner: str) -> None:
    pytest.importorskip("pymunk")
    start = step_rivals.gas(25)
    running = step_rivals.pymunk_space(start, 1)
    positions = running.frames[manner]()
    assert np.allclose(positions, running.state()[0])
    assert np.abs(positions - start.positions).max() < 120 * step_rivals.FRAME * 1.5


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("pixels", [1.0, 10.0])
def test_box2d_answers_in_the_order_of_the_beginning(pixels: float, threads: int) -> None:
    pytest.importorskip("pyb2d3")
    start = step_rivals.gas(25)
    running = step_rivals.box2d_world(start, threads, pixels)
    positions, velocities = running.state()
    assert np.allclose(positions, start.positions) and np.allclose(velocities, start.velocities)
    positions = np.asarray(running.frames["batch"]())
    assert np.array_equal(positions, running.state()[0])
    assert np.abs(positions - start.positions).max() < 120 * step_rivals.FRAME * 1.5
    # Discs that collide with nothing in this frame move as in our world.
    ours = np.asarray(step_rivals.jostle_world(start, 1).frames["positions"]())
    assert np.count_nonzero(np.abs(positions - ours).max(axis=1) < 1e-3) >= 5


@pytest.mark.parametrize("substeps", [1, 4])
@pytest.mark.parametrize("pixels", [1.0, 10.0])
def test_a_single_collision_in_box2d_is_elastic(pixels: float, substeps: int) -> None:
    pytest.importorskip("pyb2d3")
    two = np.array([(30, 50), (70, 54)], np.float32), np.array([(80, 0), (0, 0)], np.float32)
    sizes = np.array([5, 6], np.float32), np.array([20, 70], np.float32)
    start = step_rivals.InitialState(*two, *sizes, (0, 0, 100, 100), (0, 0), 1.0, substeps)
    running = step_rivals.box2d_world(start, 1, pixels)
    for _ in range(40):
        running.frames["batch"]()
    positions, velocities = running.state()
    assert velocities[1, 0] > 10  # they have met
    assert np.allclose(start.masses @ velocities, start.masses @ start.velocities, atol=0.1)
    assert not list(steps.faults(start, positions, velocities))


def test_box2d_has_the_gravity_and_the_walls_of_the_beginning() -> None:
    pytest.importorskip("pyb2d3")
    start = step_rivals.pile(40)
    assert start is not None
    running = step_rivals.box2d_world(start, 1)
    for _ in range(60):
        running.frames["batch"]()
    positions, velocities = running.state()
    assert np.abs(positions - start.positions).max() < start.radii.max()
    assert not list(steps.faults(start, positions, velocities))


def test_what_is_wrong_with_a_state_is_noted() -> None:
    start = step_rivals.gas(25)
    assert not list(steps.faults(start, start.positions, start.velocities))
    lost, slow = start.positions - [10_000, 0], 0.5 * start.velocities
    outside, weak = steps.faults(start, lost, slow)
    assert (outside, weak) == ("25 discs are outside the box", "25 % of the energy is left")


def test_a_simulation_that_stands_still_is_not_timed() -> None:
    start = step_rivals.gas(25)
    moved = start.positions + start.velocities * step_rivals.FRAME

    def running(positions: np.ndarray) -> step_rivals.RunningSimulation:
        return step_rivals.RunningSimulation({}, lambda: (positions, start.velocities))

    assert steps.stands_still(running(start.positions), start)
    assert not steps.stands_still(running(moved), start)


@pytest.mark.parametrize("guess", [100, 10_000, 9_000_000])
@pytest.mark.parametrize("end", [50, 100, 12_345, 300_000, 10**9])
def test_the_search_finds_the_end_of_what_holds(end: int, guess: int) -> None:
    asked: list[int] = []

    def holds(count: int) -> bool:
        asked.append(count)
        return count <= end

    expected = max((count for count in held.LADDER if count <= end), default=0)
    assert held.largest(holds, guess) == expected
    assert len(asked) == len(set(asked)) < 30


def test_the_ladder_rises_by_a_tenth_or_so() -> None:
    ratios = np.divide(held.LADDER[1:], held.LADDER[:-1])
    assert ratios.min() > 1.05 and ratios.max() < 1.2


def test_rounds_are_interleaved() -> None:
    order: list[str] = []

    def slow(name: str) -> None:
        order.append(name)
        sum(range(200_000))

    interleaved([lambda: slow("a"), lambda: slow("b")], 3)
    assert order == ["a", "b"] + ["a", "a", "b", "b"] * 3


def test_results_grow_row_by_row_and_say_on_what_machine(tmp_path: Path) -> None:
    path = tmp_path / "new" / "file.csv"
    path.parent.mkdir()
    path.write_text("an earlier run")
    results = Results(path)
    assert path.read_text() == "an earlier run"
    for count in (1, 2):
        results.add([{"count": count}])
        rows = table(path)
        assert [row["count"] for row in rows] == [str(n) for n in range(1, count + 1)]
        assert rows[-1]["machine"] == describe()
    assert slug() == slug().lower() and " " not in slug() and "core" in slug()


@pytest.fixture
def run_benchmarks(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[..., str]:
    """Provide a call that runs parts of the benchmarks, and returns what is printed."""

    def run_parts(*arguments: str | Path) -> str:
        monkeypatch.setattr(sys, "argv", ["run.py", *map(str, arguments)])
        run.main()
        return capsys.readouterr().out

    return run_parts


@pytest.fixture
def own_style() -> Iterator[None]:
    """Keep the style of pictures from other tests."""
    with matplotlib.rc_context():
        yield


def test_the_runner_writes_results_and_fills_the_page(
    run_benchmarks: Callable[..., str], tmp_path: Path
) -> None:
    parts, results = ["pairs", "small", "share", "hard-cases"], tmp_path / "results"
    said = run_benchmarks(*parts, "--largest", "100", "--rounds", "2", "--out", results)
    for words in (describe().split(",")[0], "discs, ns per shape", "jostle, 2 threads", "(×1)"):
        assert words in said
    assert "…" not in said
    assert {path.name for path in results.iterdir()} == {f"{part}-{slug()}.csv" for part in parts}

    page = tmp_path / "page.md"
    page.write_text("before\n<!-- table: small -->\nold\n<!-- end -->\nafter\n")
    tables.write_all(results, page)
    written = page.read_text()
    assert "old" not in written and "Worst ratio" in written
    assert written.startswith("before\n") and written.endswith("after\n")


@pytest.mark.usefixtures("own_style")
def test_the_limits_of_the_memory_are_computed_and_drawn(tmp_path: Path) -> None:
    rows = bandwidth.rows([1000, 20.0, 10.0, 800], 1e10, 3)
    least = sum(float(row["input_output_bytes"]) for row in rows)
    assert least == 8 + 8 * 0.8  # a centre read, 0.8 pairs written
    assert all(float(row["passes_bytes"]) > float(row["input_output_bytes"]) for row in rows)
    assert [float(row["ns"]) for row in rows] == [20.0, 10.0]
    as_text = [{name: str(value) for name, value in row.items()} for row in rows]
    picture = tmp_path / "picture.png"
    plot.draw_bandwidth([{**row, "machine": ""} for row in as_text], picture)
    assert picture.stat().st_size > 10_000


@pytest.mark.usefixtures("own_style")
def test_the_times_of_stages_are_measured_and_drawn(
    run_benchmarks: Callable[..., str], tmp_path: Path
) -> None:
    options = ["--largest", "60", "--rounds", "3", "--out", tmp_path]
    run_benchmarks("stage-times", "plot", *options)
    results = tmp_path / f"stage-times-{slug()}.csv"
    rows = table(results)
    scenes = {row["scene"] for row in rows}
    assert scenes == {"elastic gas", "falling gas", "settling balls", "pile"}
    for scene in scenes:
        own = {row["stage"]: float(row["median_s"]) for row in rows if row["scene"] == scene}
        assert {"bounds", "build", "pairs", "contacts", "events", "store"} <= set(own)
        assert 0 < sum(own.values()) < 0.1

    picture = tmp_path / "bench-stage-times.png"
    drawn = picture.read_bytes()
    (tmp_path / f"before-{results.name}").write_text(results.read_text())
    run_benchmarks("plot", *options)
    assert picture.read_bytes() != drawn  # the bars of the earlier version


def test_stages_have_the_colours_of_the_simulator() -> None:
    pytest.importorskip("imgui_bundle")
    from jostle_lab.panels.statistics_panel import STAGES

    for stage, colour in plot.STAGES.items():
        assert bytes.fromhex(colour[1:]) == bytes(STAGES[stage]), stage


def test_only_what_measures_the_simulator_imports_it() -> None:
    importers = {
        path.name
        for path in BENCHMARKS.glob("*.py")
        if re.search(r"^ *(?:from|import) jostle_lab", path.read_text(), re.MULTILINE)
    }
    assert importers == {"frames.py", "step_rivals.py", "defaults.py"}


def test_a_summary_has_times_per_shape_and_ratios_to_the_first_row() -> None:
    def row(name: str, count: int, rounds: int, seconds: float) -> dict[str, object]:
        same = {"scene": "discs", "manner": "", "threads": 1}
        return {**same, "name": name, "count": count, "rounds": rounds, "median_s": seconds}

    rows = [row("a", 10, 2, 1e-7), row("b", 10, 2, 2e-6), row("a", 20, 2, 4e-7), row("b", 20, 0, 0)]
    shown = run.summary(rows)
    assert [list(column.cells) for column in shown.columns] == [
        ["a", "b"],
        ["10 (×1)", "200 (×20)"],
        ["20 (×1)", "–"],
    ]


def test_a_timing_has_quartiles_and_a_ratio_the_confidence_interval_of_its_median() -> None:
    slow = Timing(tuple(2.0 + 0.01 * k for k in range(21)))
    ratio = compare(slow, Timing((1.0,) * 21))
    assert (ratio.median, ratio.low, ratio.high) == pytest.approx((2.10, 2.05, 2.15))
    assert not ratio.within_noise and compare(slow, slow).within_noise
    few = compare(Timing((2.0,) * 5), Timing((1.0,) * 5))
    assert (few.median, few.low, few.high) == (2.0, 0.0, np.inf)
    columns = Timing((5.0, 1.0, 2.0, 3.0, 4.0)).columns()
    assert columns == {"rounds": 5, "median_s": "3", "low_s": "2", "high_s": "4"}


def test_a_crossing_lies_between_the_last_counts_of_both_kinds() -> None:
    assert crossing([100, 400], [2.0, 0.5]) == pytest.approx(200)
    assert crossing([50, 100, 200, 400], [0.9, 4.0, 1.0, 0.5]) == pytest.approx(200)
    assert crossing([100, 400], [2.0, 1.5]) is None


def test_the_defaults_are_compared_with_the_best_settings(tmp_path: Path) -> None:
    found = defaults.tune("gas", 200, 3, 1)
    (row,) = defaults.verdicts([found])
    assert row["verdict"] in ("pass", "fail", "open") and float(row["default_over_best"]) > 0
    assert {row["leaf_capacity"] for row in defaults.settings(found)} == set(found.map.depths)
    assert "| 96 |" in defaults.capacities_table(defaults.capacities([found]))
    defaults.write(tmp_path, "defaults", [row])
    assert "default_over_best" in (tmp_path / f"defaults-{slug()}.csv").read_text()
