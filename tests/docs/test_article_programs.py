"""The article's two programs run without a display, and write a film of what they do."""

import os
import runpy
import sys
from pathlib import Path

import pygame
import pytest
from article import window
from outputs import frames_of
from signals import printed_by

from jostle_lab.article import HEIGHT, WIDTH, Particle, Simulation

FOLDER = Path(__file__).parents[2] / "examples" / "article"
PROGRAMS = ["brute_force", "quadtree"]


def run(program: str, *options: str, folder: Path) -> str:
    """Run a program without a display; return what it prints."""
    environment = {name: value for name, value in os.environ.items() if "DISPLAY" not in name}
    environment["SDL_VIDEODRIVER"] = "dummy"
    command = ["-W", "error::DeprecationWarning:__main__", FOLDER / f"{program}.py", *options]
    return printed_by(*command, cwd=folder, env=environment)


@pytest.mark.parametrize("program", PROGRAMS)
def test_without_a_display_a_program_writes_a_film(program: str, tmp_path: Path) -> None:
    said = run(program, "--frames", "6", folder=tmp_path)
    assert f"{program}.mp4: 6 frames" in said
    pictures = frames_of(tmp_path / "out" / f"{program}.mp4")
    assert len(pictures) == 6 and pictures[0].shape == (HEIGHT, WIDTH, 3)
    assert (pictures[0] != pictures[-1]).any()
    red = [(picture[:, :, 0] > picture[:, :, 2].astype(int) + 20).mean() for picture in pictures]
    assert max(red[:3]) < 0.01  # the boxes are in the second half of the film
    assert (min(red[3:]) > 0.5) == (program == "quadtree")


def test_the_options_set_the_film_the_number_and_the_seed(tmp_path: Path) -> None:
    films = []
    for name, seed in [("a.mp4", "1"), ("b.mp4", "1"), ("c.mp4", "2")]:
        options = f"-n 40 --seed {seed} --film {name} --frames 2"
        run("brute_force", *options.split(), folder=tmp_path)
        films.append(frames_of(tmp_path / name)[-1][40:])  # without the milliseconds
    assert (films[0] == films[1]).all() and (films[0] != films[2]).any()


@pytest.mark.parametrize("program", PROGRAMS)
def test_a_window_passes_the_mouse_on_until_it_is_closed(program: str, monkeypatch) -> None:
    monkeypatch.setattr(sys, "argv", [f"{program}.py", "-n", "20"])
    monkeypatch.setattr(sys, "path", [str(FOLDER), *sys.path])
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    monkeypatch.setattr("jostle_lab.cli.runs.has_display", lambda: True)
    pygame.display.init()
    pygame.event.clear()
    pygame.event.post(pygame.event.Event(pygame.QUIT))
    runpy.run_path(str(FOLDER / f"{program}.py"))
    pygame.display.quit()


def test_the_mouse_throws_a_ball_and_t_shows_the_boxes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    pygame.display.init()
    simulation = Simulation.of([Particle(100, 250, 10, 1)])
    frames = window.window_frames(simulation)
    pygame.event.clear()
    _, boxes = next(frames)
    assert not boxes
    pygame.event.post(pygame.event.Event(pygame.MOUSEBUTTONDOWN, pos=(105, 250), button=1))
    pygame.event.post(pygame.event.Event(pygame.MOUSEMOTION, pos=(300, 250)))
    pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=pygame.K_t))
    _, boxes = next(frames)
    ball = simulation.particles[0]
    assert boxes and ball.speed == pytest.approx(20)
    simulation.frame()
    assert (ball.x, ball.y) == pytest.approx((120, 250.5))  # gravity still acts
    pygame.event.post(pygame.event.Event(pygame.MOUSEBUTTONUP, pos=(300, 250), button=1))
    pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=pygame.K_t))
    speed = ball.speed
    assert not next(frames)[1] and ball.speed == speed
    pygame.event.post(pygame.event.Event(pygame.QUIT))
    assert next(frames, None) is None
    pygame.display.quit()


def test_the_first_ball_under_the_cursor_is_held() -> None:
    first, second = Particle(100, 250, 10, 1), Particle(110, 250, 10, 1)
    mouse = window.Mouse()
    for x, held in ((105, first), (115, second), (121, None)):
        mouse.press([first, second], x, 250)
        assert mouse.held is held


def test_a_box_is_redder_at_each_level_and_a_dense_ball_darker() -> None:
    screen = pygame.Surface((40, 40), depth=32)
    colours = []
    for level in range(6):
        window.draw_box(screen, (0, 0, 40, 40, level))
        colours.append(tuple(screen.get_at((20, 20)))[:3])
    assert colours == [(255, 255 - 30 * level, 255 - 30 * level) for level in range(6)]
    for density, light in [(1, 190), (20, 0)]:
        window.draw_ball(screen, Particle(20, 20, 10, density))
        assert tuple(screen.get_at((20, 20)))[:3] == (light, light, 255)
