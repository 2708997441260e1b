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
from jostle_lab.simulate.settings import Settings
from jostle_lab.simulate.start import start
from jostle_lab.storage.encoder import Encoder

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


def test_an_interrupted_film_still_plays_and_one_without_a_frame_leaves_no_file(
    tmp_path: Path,
) -> None:
    canvas = pygame.Surface(SIZE, 0, 32, (0xFF0000, 0xFF00, 0xFF, 0))
    with pytest.raises(KeyboardInterrupt), Encoder(tmp_path / "film.mp4", SIZE) as recorder:
        for _ in range(3):
            recorder.draw(canvas)
        raise KeyboardInterrupt
    assert len(frames_of(tmp_path / "film.mp4")) == 3
    with pytest.raises(KeyboardInterrupt), Encoder(tmp_path / "none.mp4", SIZE):
        raise KeyboardInterrupt
    assert [path.name for path in tmp_path.iterdir()] == ["film.mp4"]


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
    limits = {"BRUTE_LIMIT": 20, "BRUTE_SAMPLE": 10, "ARTICLE_LIMIT": 15}
    for name, value in limits.items():
        monkeypatch.setattr(headless, name, value)
    table = table_of(Settings("gas", 50), tmp_path, console)
    assert "scaled from 10" in table and "with only 15 particles" in table
