"""Ctrl-C during calls that communicate: it is delayed until all ranks can be told."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def held() -> Iterator[Callable[[], bool]]:
    """Delay Ctrl-C in this block; provides a function that says whether it was pressed.

    Ctrl-C that is pressed after the last call of this function is handled after the block. Without
    effect if Ctrl-C is ignored, or outside of the main thread, where no signal is handled.
    """
    before = signal.getsignal(signal.SIGINT)
    is_main = threading.current_thread() is threading.main_thread()
    if not is_main or not callable(before):
        yield lambda: False
        return
    pressed = False

    def press(*_: object) -> None:
        nonlocal pressed
        pressed = True

    def was_pressed() -> bool:
        nonlocal pressed
        was, pressed = pressed, False
        return was

    signal.signal(signal.SIGINT, press)
    try:
        yield was_pressed
    finally:
        signal.signal(signal.SIGINT, before)
        if pressed:
            signal.raise_signal(signal.SIGINT)
