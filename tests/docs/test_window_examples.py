"""The programs in examples/ run and draw something for a few frames, without a display."""

import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"


def picture(name: str, folder: Path, before: tuple[str, ...] = ()) -> Path:
    """Runs an example for five frames; skips if it can open no window."""
    out = folder / f"{name}.png"
    command = [*before, sys.executable, str(EXAMPLES / f"{name}.py")]
    command += ["--frames", "5", "--out", str(out)]
    run = subprocess.run(command, capture_output=True, text=True, timeout=120)
    said = run.stdout + run.stderr
    if run.returncode and any(
        word in said for word in ("EGL", "GLX", "GLFW", "NoSuchDisplay", "ContextException")
    ):
        pytest.skip(f"no OpenGL to draw with: {said.strip().splitlines()[-1]}")
    assert run.returncode == 0, said
    return out


def test_pyglet(tmp_path: Path) -> None:
    if not importlib.util.find_spec("pyglet"):
        pytest.skip("pyglet is not installed here; it comes with arcade")
    drawn = picture("pyglet_balls", tmp_path)
    assert drawn.stat().st_size > 20_000


def test_raylib(tmp_path: Path) -> None:
    if not importlib.util.find_spec("raylib"):
        pytest.skip("raylib is not installed here; it is tested beside arcade")
    display = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if not display and not shutil.which("xvfb-run"):
        pytest.skip("raylib needs a display, and there is neither one nor xvfb-run")
    drawn = picture("raylib_net", tmp_path, () if display else ("xvfb-run", "-a"))
    assert drawn.stat().st_size > 20_000
