"""Programs started on several ranks: pairs, the example that films a scene, and the command."""

from pathlib import Path

import numpy as np
import pytest
from mpi_ranks import HERE, needs_mpi, run_ranks
from outputs import frames_of, rows
from signals import printed_by

import jostle

pytestmark = [pytest.mark.ranks, needs_mpi]

EXAMPLE = Path(__file__).parents[2] / "examples" / "film_over_ranks.py"
GROUND = (0x10, 0x14, 0x1A)
RANKS = ((0xE2, 0xC6, 0x7C), (0x6F, 0xB0, 0xA2), (0xC9, 0x68, 0x6A))  # their colours


def test_one_to_four_ranks_find_the_pairs_of_one_process() -> None:
    assert "all pairs are right" in run_ranks(4, HERE / "mpi_pairs.py")


def share(picture: np.ndarray, colour: tuple[int, int, int]) -> float:
    """The share of the pixels that have about a colour."""
    return float((np.abs(picture.astype(int) - colour).max(axis=2) < 40).mean())


@pytest.mark.parametrize("ranks", [1, 3])
def test_the_example_films_the_scene_of_one_process(ranks: int, tmp_path: Path) -> None:
    out = tmp_path / "gas.mp4"
    printed = run_ranks(ranks, EXAMPLE, "gas", "-n", "300", "--frames", "8", "--out", out)
    world = jostle.scenes.create("gas", n=300)
    world.step(1 / 60, 8)
    assert printed.count("state") == 1 and f"{world.state_hash():016x}" in printed
    film = frames_of(out)
    assert len(film) == 8 and not np.array_equal(film[0], film[-1])
    # Each rank has discs, which together cover what the discs of the scene cover.
    shares = [share(film[0], colour) for colour in RANKS]
    assert all(found > 0.01 for found in shares[:ranks]) and max(shares[ranks:], default=0) < 1e-3
    min_x, min_y, max_x, max_y = jostle.scenes.view("gas", 300)
    area = np.pi * (world.radii.astype(float) ** 2).sum() / ((max_x - min_x) * (max_y - min_y))
    assert 1 - share(film[0], GROUND) == pytest.approx(area, rel=0.1)


def test_an_error_of_the_first_rank_ends_all(tmp_path: Path) -> None:
    out = tmp_path / "nowhere" / "gas.mp4"
    options = ("gas", "-n", "50", "--frames", "200", "--out", out)
    run_ranks(2, EXAMPLE, *options, is_right=False, seconds=120)


def test_a_window_or_film_of_one_scene_is_refused_with_one_message(tmp_path: Path) -> None:
    command = ("-m", "jostle_lab", "run", "gas", "--headless", "--out", tmp_path / "out")
    printed = run_ranks(2, *command, is_right=False)
    lines = [line for line in printed.splitlines() if line.startswith("jostle: ")]
    assert len(lines) == 1 and "examples/film_over_ranks.py" in lines[0], printed
    assert "Traceback" not in printed and not (tmp_path / "out").exists()


def test_ranks_write_the_rows_of_a_sweep_in_one_process(tmp_path: Path) -> None:
    options = ["gas", "-n", "60", "--set", "restitution=0.8:1.0:3", "--seeds", "2", "--steps", "20"]
    sweep = ["-m", "jostle_lab", "sweep", *options, "--out"]
    one, many = tmp_path / "one.csv", tmp_path / "ranks.csv"
    printed_by(*sweep, one, "--workers", "1")
    run_ranks(3, *sweep, many)
    assert len(rows(many)) == 6 and rows(many) == rows(one)
