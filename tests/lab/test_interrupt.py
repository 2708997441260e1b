"""Ctrl-C: the command always ends with exit code 130 and without a traceback."""

import contextlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from outputs import frames_of

from jostle_lab import interrupt

if sys.platform == "win32":
    pytest.skip("there is no SIGINT to send to one process", allow_module_level=True)

# SDL takes the first driver of such a list, while a single "offscreen" means a film.
A_DISPLAY = {"SDL_VIDEODRIVER": "offscreen,dummy", "DISPLAY": ":0"}


class LeftError(Exception):
    """Replaces the end of the process."""


@pytest.fixture
def handled(monkeypatch):
    """Handle Ctrl-C as the command does; where the process would end, there is a LeftError."""

    def leave() -> None:
        raise LeftError

    monkeypatch.setattr(interrupt, "leave", leave)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    with interrupt.handled():
        yield
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    signal.signal(signal.SIGINT, before)


def press() -> None:
    signal.raise_signal(signal.SIGINT)


def test_a_block_of_raised_is_interrupted_once_and_without_one_the_process_ends(handled) -> None:
    with pytest.raises(KeyboardInterrupt), interrupt.raised():
        try:
            press()
        finally:
            with pytest.raises(LeftError):
                press()
    with pytest.raises(LeftError):
        press()


def test_an_interrupt_is_delayed_until_the_end_of_a_block_of_held(handled) -> None:
    done = []
    with pytest.raises(KeyboardInterrupt), interrupt.raised(), interrupt.held():
        with interrupt.held():
            press()
        done.append("inner")
    assert done == ["inner"]


def test_an_interrupt_that_a_library_suppresses_is_raised_again(handled) -> None:
    with pytest.raises(KeyboardInterrupt), interrupt.raised():
        with contextlib.suppress(BaseException):
            press()
        interrupt.check()


def test_a_finaliser_that_suppresses_an_interrupt_prints_nothing(handled, capsys) -> None:
    class Pressed:
        def __del__(self) -> None:
            press()

    with pytest.raises(KeyboardInterrupt), interrupt.raised():
        Pressed()
    assert not capsys.readouterr().err


def test_a_process_that_ignores_interrupts_continues_to_ignore_them(handled) -> None:
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    with interrupt.handled(), interrupt.raised():
        press()
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize("moment", ["begin", "build", "end", "step", "draw"])
def test_a_window_closes_without_errors_at_any_moment_of_a_frame(
    handled, monkeypatch, moment: str
) -> None:
    pytest.importorskip("imgui_bundle")
    from jostle_lab import window as windows
    from jostle_lab.panels import widgets
    from jostle_lab.schema import Settings
    from jostle_lab.simulate.start import start
    from jostle_lab.window import Window

    window = Window(start(Settings("gas", 5)), (640, 360), synchronous=True)
    window.session.view_options.panels = True
    frames, closed = [], []
    close = window.close
    monkeypatch.setattr(window, "close", lambda: closed.append(close()))

    def pressing(act):
        def pressed(*arguments: object, **options: object) -> object:
            result = act(*arguments, **options)
            frames.append(1)
            if len(frames) == 3:
                press()
            return result

        return pressed

    if moment in ("begin", "end"):
        monkeypatch.setattr(window.gui, moment, pressing(getattr(window.gui, moment)))
    elif moment == "build":
        monkeypatch.setattr(widgets, "slider", pressing(widgets.slider))
    elif moment == "step":
        simulation = window.session.engine.simulation
        monkeypatch.setattr(simulation, "step", pressing(simulation.step))
    else:
        monkeypatch.setattr(windows, "draw_selection", pressing(windows.draw_selection))
    with pytest.raises(KeyboardInterrupt), interrupt.raised():
        window.run()
    assert len(closed) == 1


# The command; it prints a line after each change of the handler of Ctrl-C.
CHILD = """
import _signal
set_handler = _signal.signal
def signal_(*arguments):
    before = set_handler(*arguments)
    print("handled", flush=True)
    return before
_signal.signal = signal_
from jostle_lab.__main__ import main
main()
"""


@pytest.fixture
def command() -> Iterator[Callable[..., subprocess.Popen[str]]]:
    """Start the command where Ctrl-C is not ignored; processes that still run are killed."""
    started = []

    def start(*arguments: str, **options: object) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [sys.executable, "-c", CHILD, *arguments],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
            **options,
        )
        started.append(process)
        return process

    yield start
    for process in started:
        process.kill()
        process.communicate()


@pytest.mark.parametrize("moments", [[(1, 0.0), (1, 0.05), (1, 0.2)], [(2, 0.0), (2, 0.3)]])
def test_the_command_ends_without_output_during_imports_and_in_a_window(
    command: Callable[..., subprocess.Popen[str]], moments: list[tuple[int, float]]
) -> None:
    """A moment is a number of changes of the handler, and seconds after the last of them."""
    environment = {**os.environ, **A_DISPLAY}
    processes = [command("run", "gas", "-n", "50", env=environment) for _ in moments]
    for process, (lines, seconds) in zip(processes, moments, strict=True):
        for _ in range(lines):
            assert process.stdout.readline() == "handled\n"
        time.sleep(seconds)
        process.send_signal(signal.SIGINT)
    for process in processes:
        said, _ = process.communicate(timeout=60)
        assert process.returncode == 130
        assert said.replace("handled\n", "") == ""


def test_a_film_that_is_stopped_can_be_played(command, tmp_path: Path) -> None:
    options = ("--headless", "--steps", "1000000")  # so many that it never ends by itself
    process = command("run", "gas", "-n", "20", *options, cwd=tmp_path)
    film, patience = tmp_path / "out" / "gas.mp4", time.monotonic() + 60
    # ffmpeg has got frames
    while not any(path.stat().st_size for path in film.parent.glob(".jostle.*")):
        assert process.poll() is None and time.monotonic() < patience
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    said, _ = process.communicate(timeout=60)
    assert process.returncode == 130 and "Traceback" not in said, said
    assert "Stopped." in said
    assert [*film.parent.iterdir()] == [film]
    assert {frame.shape for frame in frames_of(film)} == {(720, 1280, 3)}
