"""Handling of Ctrl-C: the command ends with exit code 130 and without a traceback.

By default, Ctrl-C ends the process at once. Within `raised` it raises KeyboardInterrupt, so that
files and threads are closed, and a second Ctrl-C ends the process. Within `held`, where an
exception would leave a library in an invalid state, KeyboardInterrupt is delayed until the end of
the block. A process that was started with Ctrl-C ignored (`nohup`, a background job) ignores it.
"""

import contextlib
import os
import signal
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from types import FrameType
from typing import NoReturn

CODE = 130  # exit code after Ctrl-C, by the convention of shells


@dataclass
class _State:
    """State of the process; only the main thread uses it."""

    pressed: bool = False
    raises: bool = False
    held: int = 0


_state = _State()


@contextlib.contextmanager
def handled() -> Iterator[None]:
    """Handle Ctrl-C, unless it is ignored or this is not the main thread."""
    global _state
    _state = _State()
    before, hook = signal.getsignal(signal.SIGINT), sys.unraisablehook
    if before is not signal.SIG_IGN:
        with contextlib.suppress(ValueError):  # in a thread that is not the main one
            signal.signal(signal.SIGINT, _press)
    sys.unraisablehook = _unraisable
    try:
        yield
    finally:
        sys.unraisablehook = hook
        _state = _State()  # later calls of `check` do not raise
        if signal.getsignal(signal.SIGINT) is _press:
            signal.signal(signal.SIGINT, before)


@contextlib.contextmanager
def raised() -> Iterator[None]:
    """Raise KeyboardInterrupt on Ctrl-C within this block."""
    _state.raises = True
    try:
        yield
        check()
    finally:
        _state.raises = False


@contextlib.contextmanager
def held() -> Iterator[None]:
    """Delay KeyboardInterrupt until the end of this block."""
    _state.held += 1
    try:
        yield
    finally:
        _state.held -= 1
    check()


def check() -> None:
    """Raise KeyboardInterrupt if Ctrl-C was pressed. For loops, as some libraries suppress it."""
    if _state.pressed and not _state.held:
        raise KeyboardInterrupt


def leave() -> NoReturn:
    """End the process without waiting for its threads."""
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(Exception):
            if stream.isatty():
                stream.write("\x1b[?25h")  # a progress bar hides the cursor
            stream.flush()
    os._exit(CODE)


def _press(number: int, frame: FrameType | None) -> None:
    again, _state.pressed = _state.pressed, True
    if again or not _state.raises:
        leave()
    if not _state.held:
        raise KeyboardInterrupt


def _unraisable(what: "sys.UnraisableHookArgs") -> None:
    """Print nothing if a finaliser suppresses KeyboardInterrupt; `check` raises it again."""
    if what.exc_type is not KeyboardInterrupt:
        sys.__unraisablehook__(what)
