"""Every example runs without a display, draws something, is short, and is in the gallery."""

import ast
import re
import runpy
import sys
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pygame
import pytest
from signals import printed_by

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "examples"
PICTURES = ROOT / "docs" / "pictures"
EXAMPLES = sorted(FOLDER.glob("[0-9][0-9]_*.py"))
ALLOWED = {"jostle", "matplotlib", "numpy", "pygame", "pytmx", "show", *sys.stdlib_module_names}
# Frames until there is something to see: the spirals of bullets need a while. A step of the ten
# thousand balls takes up to a second while they still overlap from their placement.
FRAMES = {"02_ten_thousand_balls": "3", "03_bullet_hell": "90", "24_suika": "100"}
each_example = pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)


def pixels(picture: Path) -> np.ndarray:
    """Colours, shape (width, height, 3)."""
    return pygame.surfarray.array3d(pygame.image.load(picture).convert(24))


@pytest.fixture
def run_example(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., None]]:
    """Provide a call that runs an example, without a display, errors and warnings."""

    def run(example: Path, *arguments: str) -> None:
        monkeypatch.setattr(sys, "argv", [str(example), *arguments])
        with warnings.catch_warnings():
            warnings.filterwarnings("error", category=DeprecationWarning, module="__main__")
            runpy.run_path(str(example), run_name="__main__")

    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    monkeypatch.delitem(sys.modules, "show", raising=False)  # it reads the arguments
    pygame.quit()
    yield run
    pygame.quit()
    sys.modules.pop("show", None)


def test_the_numbers_have_no_gap() -> None:
    assert [int(path.stem[:2]) for path in EXAMPLES] == list(range(1, len(EXAMPLES) + 1))
    assert EXAMPLES


@each_example
def test_draws_a_picture_without_a_display(
    example: Path, run_example: Callable[..., None], tmp_path: Path
) -> None:
    picture = tmp_path / "picture.png"
    run_example(example, "--picture", str(picture), "--frames", FRAMES.get(example.stem, "10"))
    drawn = pixels(picture)
    assert drawn.shape == (800, 500, 3)
    drawn = drawn[:, :450]  # without the line at the bottom
    ground = (drawn == np.array([0x10, 0x14, 0x1A])).all(axis=2)
    assert ground.mean() < 0.998


def test_ends_when_its_window_is_closed(run_example: Callable[..., None]) -> None:
    """A QUIT comes a while after the window has opened; the title is that of no picture."""
    pygame.init()
    pygame.time.set_timer(pygame.QUIT, 200, loops=1)
    run_example(FOLDER / "05_nearest_enemy.py")


@pytest.mark.parametrize("path", [*EXAMPLES, FOLDER / "show.py"], ids=lambda path: path.stem)
def test_imports_nothing_that_readers_do_not_have(path: Path) -> None:
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found.add((node.module or "").split(".")[0])
    assert found <= ALLOWED - ({"jostle"} if path.stem == "show" else set())


@each_example
def test_is_short_and_its_picture_and_its_words_are_in_the_documents(example: Path) -> None:
    code = example.read_text(encoding="utf-8")
    assert len(code.splitlines()) <= 40
    words = ast.get_docstring(ast.parse(code)) or ""
    assert 1 <= len(re.findall(r"[.!?](?:\s|$)", words)) <= 2
    picture = PICTURES / f"example-{example.stem.replace('_', '-')}.png"
    assert pixels(picture).shape == (800, 500, 3)
    assert picture.stat().st_size < 150_000
    text = (FOLDER / "README.md").read_text(encoding="utf-8")
    assert example.name in text
    assert f"../docs/pictures/{picture.name}" in text
    assert words in text


def test_examples_with_processes_are_short_and_report_each_value() -> None:
    for name, lines in (("sweep", 40), ("film_over_ranks", 80)):
        assert len((FOLDER / f"{name}.py").read_text(encoding="utf-8").splitlines()) <= lines
    said = printed_by(FOLDER / "sweep.py", timeout=120)
    left = [float(line.split()[1]) for line in said.splitlines()[1:]]
    assert len(left) == 4 and left == sorted(left) and left[-1] == 1.0
