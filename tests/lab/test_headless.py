"""A run without a window: a playable video, a picture and a table."""

import io
from pathlib import Path

import numpy as np
import pygame
import pytest
import rich.console as rich_console
from outputs import frames_of

from jostle_lab import headless
from jostle_lab.draw.palette import GROUND
from jostle_lab.headless import default_steps, make_film
from jostle_lab.schema import Settings
from jostle_lab.simulate.start import start

SIZE = (640, 360)


@pytest.fixture
def console():
    return rich_console.Console(file=io.StringIO(), width=100)


@pytest.mark.parametrize(("method", "name"), [("quadtree", "article"), ("brute", "article-brute")])
def test_film_plays_and_has_a_frame_for_every_thirtieth_of_a_second(
    tmp_path: Path, console, method: str, name: str
) -> None:
    simulation = start(Settings("article", 60, method=method))
    film = make_film(simulation, 10, tmp_path, console, SIZE)
    assert (film.video, film.still) == (tmp_path / f"{name}.mp4", tmp_path / f"{name}.png")
    pictures = frames_of(film.video)
    assert len(pictures) == film.frames == 6
    assert {picture.shape for picture in pictures} == {(360, 640, 3)}
    assert (pictures[0] != pictures[-1]).any()
    corner = pictures[0][-4:, -4:].reshape(-1, 3).mean(axis=0)
    assert corner == pytest.approx(GROUND, abs=4)  # the film keeps the colours
    still = pygame.image.load(film.still)
    assert still.get_size() == SIZE
    assert len(np.unique(pygame.surfarray.array2d(still))) > 50


def test_a_film_takes_ten_seconds_or_as_asked_and_never_replaces_a_file(
    tmp_path: Path, console
) -> None:
    (tmp_path / "pile.mp4").write_bytes(b"first")
    (tmp_path / "pile-2.png").write_bytes(b"second")
    film = make_film(start(Settings("pile", 0)), 1, tmp_path, console, SIZE)
    assert (film.video, film.still) == (tmp_path / "pile-3.mp4", tmp_path / "pile-3.png")
    assert film.frames == len(frames_of(film.video)) == 1 and film.still.exists()
    assert (tmp_path / "pile.mp4").read_bytes() == b"first"
    assert (tmp_path / "pile-2.png").read_bytes() == b"second"
    assert default_steps(start(Settings("article", 5))) == 600


def table_of(settings: Settings, tmp_path: Path, console) -> str:
    simulation = start(settings)
    film = make_film(simulation, 2, tmp_path, console, SIZE)
    console.file = io.StringIO()
    console.print(headless.film_report(simulation, film))
    return console.file.getvalue()


@pytest.mark.parametrize("method", ["quadtree", "brute"])
def test_table_sets_the_methods_side_by_side(tmp_path, console, monkeypatch, method: str) -> None:
    monkeypatch.setattr(headless, "PATIENCE", 0.01)
    table = table_of(Settings("article", 50, method=method), tmp_path, console)
    numbers = ("particles", "50", "steps/s", "1,225", "touching")
    for words in (*numbers, "quadtree", "brute force", "article's tree", "×"):
        assert words in table


def test_table_says_when_nothing_is_compared_or_a_method_was_not_timed_in_full(
    tmp_path: Path, console, monkeypatch
) -> None:
    monkeypatch.setattr(headless, "PATIENCE", 0.01)
    table = table_of(Settings("gas", 0), tmp_path, console)
    assert "nothing to compare" in table and "×" not in table
    monkeypatch.setattr(headless, "LIMITS", {"brute": 20, "article": 15})
    table = table_of(Settings("gas", 50), tmp_path, console)
    assert "more than 20 particles" in table and "more than 15 particles" in table
