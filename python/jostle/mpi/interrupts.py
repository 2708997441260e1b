"""Signal handlers during calls that communicate: they run when all ranks can raise together."""

from __future__ import annotations

import functools
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Any, Concatenate, ParamSpec, TypeVar

from .exchange import together

Subject = TypeVar("Subject")
Parameters = ParamSpec("Parameters")
Result = TypeVar("Result")

#: Signals whose handlers may be functions of Python. Some are missing on some systems.
_NUMBERS = [
    getattr(signal, name)
    for name in (
        *("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGBREAK", "SIGUSR1", "SIGUSR2", "SIGXCPU"),
        *("SIGALRM", "SIGVTALRM", "SIGPROF", "SIGCHLD", "SIGCONT", "SIGWINCH"),
    )
    if hasattr(signal, name)
]


@contextmanager
def held() -> Iterator[Callable[[], None]]:
    """Delay the signal handlers of Python in this block; provides a function that runs them.

    It runs those of the signals so far. Those of later signals run after the block. Without effect
    outside of the main thread, where no handler runs.
    """
    if threading.current_thread() is not threading.main_thread():
        yield lambda: None
        return
    found = {number: signal.getsignal(number) for number in _NUMBERS}
    handlers: dict[int, Any] = {number: of for number, of in found.items() if callable(of)}
    received: list[int] = []

    def run() -> None:
        # A stack calls all of them, even if one raises.
        with ExitStack() as stack:
            while received:
                number = received.pop()
                stack.callback(handlers[number], number, None)

    for number in handlers:
        signal.signal(number, lambda number, _: received.append(number))
    try:
        yield run
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
        run()


def collective(
    call: Callable[Concatenate[Subject, Parameters], Result],
) -> Callable[Concatenate[Subject, Parameters], Result]:
    """Let no signal handler interrupt a call of all ranks; if one raises after it, all ranks raise.

    The first argument is a communicator, or an object with one as `_comm`.
    """

    @functools.wraps(call)
    def whole(
        subject: Subject, /, *arguments: Parameters.args, **named: Parameters.kwargs
    ) -> Result:
        with held() as run:
            result = call(subject, *arguments, **named)
            comm: Any = getattr(subject, "_comm", subject)
            with together(comm):
                run()
        return result

    return whole
