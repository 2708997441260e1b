"""Sweeps: plans, tables that are continued, and the same rows for every number of processes."""

import contextlib
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from lab_command import Command
from outputs import rows

import jostle
from jostle_lab.schema import Settings
from jostle_lab.sweep.measures import MEASURES
from jostle_lab.sweep.plan import SETTINGS, PlanError, parse, plan
from jostle_lab.sweep.run import do, world_of
from jostle_lab.sweep.table import Table, TableError

OPTIONS = ["gas", "-n", "60", "--set", "restitution=0.8:1.0:3", "--seeds", "2", "--steps", "20"]


@pytest.fixture
def sweep(jostle_command: Command) -> Callable[..., tuple[int, str, str]]:
    """Provide the command with options; it returns the exit code and both outputs."""
    return partial(jostle_command.run, "sweep", *OPTIONS, "--out")


def test_ranges_include_both_ends() -> None:
    assert parse("restitution=0.5:1.0:6") == ("restitution", [0.5, 0.6, 0.7, 0.8, 0.9, 1.0])
    assert parse("n=100,200") == ("n", [100, 200])
    assert parse("drag=0") == ("drag", [0.0])


@pytest.mark.parametrize(
    "text",
    [
        *("restitution", "weight=1", "drag=", "drag=1:2", "drag=0:1:1", "drag=a,b", "drag=-1"),
        *("restitution=2", "friction=-1", "gravity=inf", "speed=nan"),
        *("n=1.5", "n=inf", "n=1000000000", "substeps=nan", "substeps=1e20"),
    ],
)
def test_settings_that_are_not_understood_are_refused(text: str) -> None:
    with pytest.raises(PlanError, match="--set is"):
        parse(text)
    with pytest.raises(PlanError, match="twice"):
        plan("gas", 10, ["drag=1", "drag=2"], 1, 1, 0, ["energy"])


def test_gravity_is_that_of_the_command_and_of_files_and_every_number_is_swept() -> None:
    assert {"leaf_capacity", "world_size", "container_restitution"} <= set(SETTINGS)
    (run,) = plan("gas", 20, ["gravity=90", "world_size=2", "speed=0"], 1, 0, 0, [])
    world = world_of(run)
    assert world.gravity.tolist() == list(Settings(gravity=90).gravity) == [0, 90]
    assert not world.velocities.any() and world.threads == 1
    assert world.container != jostle.scenes.create("gas", n=20).container


def test_a_plan_has_each_combination_with_each_seed() -> None:
    runs = plan("gas", None, ["n=50,60", "drag=0:1:3"], 4, 10, 0, ["energy"])
    assert len(runs) == 2 * 3 * 4 == len({tuple(run.key.items()) for run in runs})
    assert {run.n for run in runs} == {50, 60}


def test_measures_are_right() -> None:
    names = ["energy", "pressure", "height", "hexatic", "cluster", "collisions"]
    (run,) = plan("gas", 400, [], 1, 100, 0, names)
    row = do(run)
    found = {name: float(row[name]) for name in names}
    # An ideal gas has p A = N kT, with the mean energy kT in two dimensions; discs have more.
    world = jostle.scenes.create("gas", n=400, seed=0)
    box = world.container
    area = (box.max_x - box.min_x) * (box.max_y - box.min_y)
    assert 1 < found["pressure"] * area / (400 * found["energy"]) < 3
    assert found["energy"] == pytest.approx(world.kinetic_energy() / 400, rel=1e-5)
    assert box.min_y < found["height"] < box.max_y
    assert 0 < found["hexatic"] < 0.5 and 0 < found["cluster"] < 1 and found["collisions"] > 0
    assert row["hash"] == do(run)["hash"]


def test_measures_are_of_movable_particles_across_periods() -> None:
    places = [(50, 90), (52, 90), (54, 90), (1, 10), (99.5, 10), (30, 40), (60, 60)]
    moving = np.arange(7) > 2
    world = jostle.World(places, 1.0, movable=moving, period=(100, 100))
    found = {name: MEASURES[name][0](world, 1 / 60) for name in ("height", "hexatic", "cluster")}
    few = jostle.World(world.positions[moving], 1.0, period=(100, 100))
    alone = MEASURES["hexatic"][0](few, 1 / 60)
    assert found == {"height": 30, "hexatic": pytest.approx(alone), "cluster": 0.5}


def test_a_sweep_writes_one_row_for_each_run_and_continues_its_table(sweep, tmp_path: Path) -> None:
    out = tmp_path / "one.csv"
    code, _, complaint = sweep(out, "--workers", "1")
    assert code == 0, complaint
    table, lines = rows(out), out.read_text(encoding="utf-8").splitlines(keepends=True)
    assert len(table) == 6
    columns = ("scene", "n", "seed", "steps", "restitution", "energy", "pressure", "hash")
    assert tuple(table[0]) == columns
    assert sweep(tmp_path / "two.csv", "--workers", "2")[0] == 0
    assert rows(tmp_path / "two.csv") == table
    # As if it had been killed while it wrote the fourth row.
    out.write_text("".join(lines[:3]) + lines[3][:7], encoding="utf-8")
    code, printed, _ = sweep(out, "--workers", "1")
    assert code == 0 and "2 of 6 runs are in" in " ".join(printed.split())
    before = out.read_text(encoding="utf-8")
    assert before.startswith("".join(lines[:3])) and rows(out) == table
    assert sweep(out)[0] == 0  # nothing is left to do
    assert out.read_text(encoding="utf-8") == before


def test_a_table_of_another_sweep_is_refused(sweep, tmp_path: Path) -> None:
    out = tmp_path / "table.csv"
    out.write_text("a,b\n1,2\n", encoding="utf-8")
    with pytest.raises(TableError, match="other columns"):
        Table(out, plan("gas", 10, [], 1, 1, 0, ["energy"]))
    code, _, complaint = sweep(out)
    assert code == 2 and "other columns" in complaint
    assert out.read_text(encoding="utf-8") == "a,b\n1,2\n"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--measure", "colour"], "--measure colour is not a measure"),
        (["--set", "weight=1"], "--set is 'weight=1'"),
        (["--set", "drg=1"], "--set is 'drg=1'; drg is not a number to vary; did you mean drag?"),
        (["--set", "drag=0,-1"], "--set is 'drag=0,-1'; drag is -1.0; it must be"),
        (["--seeds", "0"], "Invalid value for '--seeds'"),
        (["--workers", "0"], "Invalid value for '--workers'"),
    ],
)
def test_wrong_options_are_refused(sweep, tmp_path: Path, options, message: str) -> None:
    code, _, complaint = sweep(tmp_path / "table.csv", *options)
    assert code == 2 and message in complaint
    assert not (tmp_path / "table.csv").exists()


def test_a_run_that_fails_ends_the_sweep_with_its_message(sweep, tmp_path: Path) -> None:
    """One disc may have such a velocity, but not a disc of the scene."""
    code, _, complaint = sweep(tmp_path / "table.csv", "--set", "speed=9e17", "--workers", "1")
    assert code == 2 and "a run failed: velocities" in complaint


@pytest.mark.skipif(sys.platform != "linux", reason="it reads /proc")
def test_ctrl_c_ends_the_processes_of_a_sweep(tmp_path: Path) -> None:
    """Also if the signal reaches the first process alone, as from `kill -INT`."""
    out, said = tmp_path / "out.csv", tmp_path / "said"
    command = [sys.executable, "-m", "jostle_lab", "sweep", "gas", "-n", "100"]
    with said.open("w") as file:
        process = subprocess.Popen(
            [*command, "--steps", "1000000", "--workers", "2", "--out", str(out)],
            stdout=file,
            stderr=file,
            start_new_session=True,
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
        )
    patience = time.monotonic() + 60
    while not out.exists() or count_of_group(process.pid) < 3:  # a worker and another process
        assert process.poll() is None and time.monotonic() < patience
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    assert process.wait(60) == 130
    while count_of_group(process.pid):
        assert time.monotonic() < patience
        time.sleep(0.05)
    assert "Stopped." in said.read_text() and "leaked" not in said.read_text()


def count_of_group(group: int) -> int:
    """Return the number of processes of a group that run."""
    count = 0
    for place in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            state, _, found = place.read_text().rpartition(")")[2].split()[:3]
            count += int(found) == group and state != "Z"
    return count
