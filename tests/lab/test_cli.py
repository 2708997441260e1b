"""The command, with the arguments of a user."""

import os
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import moderngl
import pygame
import pytest

import jostle
from jostle_lab import cli, headless


def command(*arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {name: value for name, value in os.environ.items() if "DISPLAY" not in name}
    return subprocess.run(
        [sys.executable, "-m", "jostle_lab", *arguments],
        capture_output=True,
        text=True,
        encoding="utf-8",
        env={**environment, "PYTHONIOENCODING": "utf-8", "COLUMNS": "100"},
        timeout=120,
    )


def test_run_without_a_display_makes_a_film_and_a_table(tmp_path: Path) -> None:
    out = tmp_path / "new" / "folder"
    done = command("run", "gas", "-n", "40", "--steps", "6", "--out", str(out))
    assert done.returncode == 0, done.stderr
    assert sorted(path.name for path in out.iterdir()) == ["gas.mp4", "gas.png"]
    for words in ("no display", "6 steps", "100%", "particles", "780", "brute force", "gas.mp4"):
        assert words in done.stdout


def test_an_ascii_terminal_gets_what_it_can_show() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "jostle_lab", "scenes"],
        capture_output=True,
        env={**os.environ, "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONIOENCODING": "ascii"},
    )
    assert done.returncode == 0 and not done.stderr
    assert all(name.encode() in done.stdout for name in jostle.scenes.names())
    assert done.stdout.isascii()


def test_the_version_is_that_of_both_packages(jostle_command) -> None:
    assert jostle_command.run("--version") == (0, f"jostle {jostle.__version__}\n", "")
    assert jostle.__version__ == metadata.version("jostle") == metadata.version("jostle-lab")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["run", "nowhere"], "nowhere is not a scene; there are article, "),
        (["run", "-n", "-1"], "-n is -1; it must be at least 0"),
        (["run", "-n", "many"], "-n is 'many'; it must be a whole number"),
        (["run", "--method", "magic"], "--method is 'magic'"),
        (["run", "--steps", "0"], "Invalid value for '--steps'"),
        (["run", "--seed", "-4"], "--seed is -4"),
        (["run", "--leaf-capacity", "0"], "--leaf-capacity is 0"),
        (["run", "--max-depth", "-1"], "--max-depth is -1"),
        (["run", "--speed", "3"], "--speed"),
        (["tune", "gas", "-n", "0"], "Invalid value for '-n'"),
        (["tune", "--out", "t.xyz"], "--out is 't.xyz'; the picture's name must end with .png or"),
        (["tune", "gass"], "gass is not a scene; did you mean gas?"),
        (["tour"], "tour"),
        (["dance"], "dance"),
    ],
)
def test_bad_input_gets_one_sentence(jostle_command, arguments, words) -> None:
    assert words in jostle_command.refuses(*arguments)


def test_without_opengl_a_video_is_recorded(monkeypatch, jostle_command, tmp_path) -> None:
    def fail() -> None:
        raise moderngl.Error("no card")

    monkeypatch.setattr(moderngl, "init_context", fail)
    monkeypatch.setattr(cli.runs, "has_display", lambda: True)
    arguments = "run", "gas", "-n", "20", "--steps", "2", "--out", str(tmp_path)
    words = " ".join(jostle_command.run(*arguments)[1].split())
    assert "No window (there is no OpenGL 3.3 here: no card; Mesa has one" in words
    assert (tmp_path / "gas.mp4").exists()


def test_a_folder_that_cannot_be_had_is_refused(jostle_command, tmp_path) -> None:
    file = tmp_path / "file"
    file.touch()
    sentence = jostle_command.refuses("run", "--headless", "--out", str(file / "out"))
    assert "no file can be written" in sentence


def test_the_commands_are_those_of_the_documents() -> None:
    names = {command.callback.__name__ for command in cli.commands.app.registered_commands}
    assert names == {"run", "scenes", "sweep", "tune"}


def test_the_version_is_printed_without_the_imports_of_the_commands() -> None:
    code = (
        "import sys; sys.argv[1:] = ['--version']; from jostle_lab.__main__ import main; main();"
        "print(*sorted({'numpy', 'typer', 'rich', 'pygame', 'jostle'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == (f"jostle {jostle.__version__}\n\n", "")


def test_the_display_decides(monkeypatch) -> None:
    monkeypatch.setattr(sys, "platform", "linux")
    for name in ("SDL_VIDEODRIVER", "DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    assert not cli.runs.has_display()
    monkeypatch.setenv("DISPLAY", ":0")
    assert cli.runs.has_display()
    monkeypatch.setenv("SDL_VIDEODRIVER", "offscreen")
    assert not cli.runs.has_display()


def test_without_a_window_a_run_becomes_a_film(monkeypatch, jostle_command, tmp_path) -> None:
    def refuse(*arguments: object, **options: object) -> None:
        raise pygame.error("no video device")

    monkeypatch.setattr(headless, "PATIENCE", 0.01)
    monkeypatch.setattr(cli.runs, "has_display", lambda: True)
    monkeypatch.setattr(pygame.display, "set_mode", refuse)
    code, printed, _ = jostle_command.run("run", "gas", "-n", 5, "--steps", 2, "--out", tmp_path)
    assert code == 0 and "no video device" in printed
    assert (tmp_path / "gas.mp4").exists()


EXAMPLE = Path(__file__).parents[2] / "examples" / "scene.toml"


def test_a_file_describes_a_run_and_options_override_it(
    monkeypatch, jostle_command, tmp_path
) -> None:
    monkeypatch.setattr(headless, "PATIENCE", 0.01)
    options = ["-n", "40", "--method", "brute", "--steps", "2", "--headless", "--out"]
    code, printed, _ = jostle_command.run("run", EXAMPLE, *options, tmp_path)
    assert code == 0 and (tmp_path / "gas-brute.mp4").stat().st_size
    assert "gas, brute force" in printed
    assert f"{40 + 12 + 4}" in printed


def test_a_file_that_is_wrong_or_missing_or_refused_by_the_library_gets_one_sentence(
    jostle_command, tmp_path: Path
) -> None:
    (tmp_path / "scene.toml").write_text("gravitas = 1")
    sentence = jostle_command.refuses("run", tmp_path / "scene.toml")
    assert "scene.toml: gravitas is not a setting; did you mean gravity?" in sentence
    assert "cannot be read" in jostle_command.refuses("run", "nowhere.toml")
    (tmp_path / "small.toml").write_text('scene = "gas"\nn = 30\nworld_size = 0.01\n')
    wrong = ("--headless", str(tmp_path / "small.toml"), "--out", str(tmp_path))
    sentence = jostle_command.refuses("run", *wrong)
    assert sentence.startswith("jostle: small.toml: The container would have an area of")


def test_a_world_of_the_library_is_a_file_to_run(jostle_command, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(headless, "PATIENCE", 0.01)
    jostle.World([(0, 0), (9, 1)], radii=[2, 3]).save(tmp_path / "own.jostle")
    options = "--steps", "2", "--gravity", "7", "--headless", "--out", tmp_path
    code, _, said = jostle_command.run("run", tmp_path / "own.jostle", *options)
    assert code == 0 and (tmp_path / "own.mp4").exists(), said
    why = jostle_command.refuses("run", tmp_path / "own.jostle", "--seed", "3", *options)
    assert "seed cannot be changed in a saved scene" in why
