"""`jostle run` over ranks: video, picture, table, checkpoints, and how it ends."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pygame
import pytest
from mpi_ranks import ENVIRONMENT, LAUNCHER, needs_mpi, run_ranks

import jostle
from jostle_lab.simulate.start import start
from jostle_lab.storage.config import read_config

RUN = ("-m", "jostle_lab", "run")
GAS = ("gas", "-n", "300")

pytestmark = needs_mpi


def hash_of(output: str) -> int:
    return int(re.search(r"state hash\W+([0-9a-f]{16})", output)[1], 16)


def expected(steps: int) -> int:
    world = jostle.scenes.create("gas", n=300)
    world.step(1 / 60, steps)
    return world.state_hash()


def test_ranks_record_a_video_and_continue_from_a_checkpoint(tmp_path: Path) -> None:
    out = tmp_path / "three"
    options = (*RUN, *GAS, "--steps", "20", "--checkpoint", "8", "--out", out)
    printed = run_ranks(3, *options)
    assert hash_of(printed) == expected(20)
    assert printed.count("state hash") == printed.count("video  ") == 1
    assert "3 ranks" in printed and "waiting, communication, ms" in printed
    assert {path.name for path in out.iterdir()} == {"gas.mp4", "gas.png", "gas.checkpoint"}
    world = jostle.World.load(out / "gas.checkpoint")
    assert round(world.time * 60) == 16 and world.state_hash() == expected(16)
    again = (*RUN, *GAS, "--steps", "20", "--resume", out / "gas.checkpoint", "--out", out)
    assert hash_of(run_ranks(2, *again)) == expected(20)
    alone = (*RUN, "--mpi", *GAS, "--steps", "20", "--out", tmp_path / "one")
    assert hash_of(run_ranks(1, *alone)) == expected(20)
    # The pictures differ in the panel, and where discs of different ranks share a pixel.
    pictures = [
        pygame.surfarray.array3d(pygame.image.load(path))[300:].astype(int)
        for path in (out / "gas.png", tmp_path / "one" / "gas.png")
    ]
    differ = np.abs(pictures[0] - pictures[1]).max(axis=2) > 0
    is_disc = np.abs(pictures[1] - pictures[1][20, 20]).max(axis=2) > 60
    assert is_disc.mean() > 0.1 and differ.mean() < 0.01, (is_disc.mean(), differ.mean())
    printed = run_ranks(2, *again[:-2], "--steps", "16", "--out", out, is_right=False)
    assert printed.count("steps is 16") == 1, printed


CONFIG = """
scene = "pile"
n = 25
friction = 0.4
world_size = 1.2
[[walls]]
points = [[100, 300], [300, 350]]
"""
GROUP = """
[[particles]]
count = 3
radius = 5
"""


@pytest.mark.parametrize("config", [CONFIG, CONFIG + GROUP], ids=["settings", "particles"])
def test_ranks_run_a_configuration_file_as_one_process_does(tmp_path: Path, config: str) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(config)
    simulation = start(read_config(path).settings)
    assert simulation.world.sleeping
    for _ in range(5):
        simulation.step()
    options = (*RUN, "--config", path, "--steps", "5", "--out", tmp_path)
    assert hash_of(run_ranks(2, *options)) == simulation.world.state_hash()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("piston", "-n", "50"), "forces[0]"),
        (("stars", "-n", "50"), "forces[0]"),
        (("gas", "--resume", "nowhere"), "nowhere"),
        (("nothing",), "there is no scene 'nothing'"),
        (("gas", "--checkpoint", "0"), "--checkpoint is 0"),
    ],
)
def test_ranks_refuse_with_one_message(
    tmp_path: Path, options: tuple[str, ...], message: str
) -> None:
    printed = run_ranks(2, *RUN, *options, "--out", tmp_path, is_right=False)
    lines = [line for line in printed.splitlines() if line.startswith("jostle: ")]
    assert len(lines) == 1 and message in lines[0], printed
    assert "Traceback" not in printed


def test_a_run_without_ranks_has_no_checkpoints(tmp_path: Path) -> None:
    command = [sys.executable, *RUN, *GAS, "--checkpoint", "5", "--out", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "--checkpoint is for runs over ranks" in done.stderr


def test_ctrl_c_on_one_rank_stops_all_and_leaves_a_whole_checkpoint(tmp_path: Path) -> None:
    out = tmp_path / "out"
    options = (*RUN, *GAS, "--steps", "100000", "--checkpoint", "5", "--out", str(out))
    command = [LAUNCHER, "-n", "2", sys.executable, *options]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    with subprocess.Popen(command, env={**os.environ, **ENVIRONMENT}, **pipes) as running:
        checkpoint = out / "gas.checkpoint"
        limit = time.monotonic() + 120
        while not checkpoint.exists():
            assert time.monotonic() < limit and running.poll() is None
            time.sleep(0.05)
        os.kill(one_rank_of(running.pid), signal.SIGINT)
        printed = running.communicate(timeout=120)[0]
    assert running.returncode != 0
    assert printed.count("Stopped.") == 1 and "gas.checkpoint has the state after" in printed
    assert "Traceback" not in printed, printed
    steps = round(jostle.World.load(checkpoint).time * 60)
    assert steps % 5 == 0 and f"after {steps} steps" in printed
    assert (out / "gas.mp4").stat().st_size > 0


def one_rank_of(launcher: int) -> int:
    """The process of the last rank."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            words = (process / "cmdline").read_bytes().split(b"\0")
            parents = ancestors(int(process.name))
        except OSError:
            continue
        if b"jostle_lab" in words and words[0] == sys.executable.encode():
            found += [int(process.name)] * (launcher in parents)
    return max(found)


def ancestors(process: int) -> list[int]:
    found = []
    while process > 1:
        stat = Path(f"/proc/{process}/stat").read_text()
        process = int(stat.rpartition(")")[2].split()[1])
        found.append(process)
    return found
