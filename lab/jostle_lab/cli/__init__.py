"""The command: `jostle run`, `scenes`, `sweep` and `tune`.

refusals  checks of arguments
runs      the ways to run a scene
commands  the commands and their options
"""

import io
import os
import sys

import typer

from jostle_lab import interrupt

from .commands import app
from .refusals import tell


def main() -> None:
    """Run the command; an error in its arguments becomes a message and exit code 2."""
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # characters that it cannot encode become "?"
            stream.reconfigure(errors="replace")
    with interrupt.handled():
        code = _exit_code()
    sys.exit(code)


def command() -> None:
    """Run `main` as a process; after Ctrl-C it ends without waiting for threads."""
    try:
        main()
    except SystemExit as end:
        if end.code == interrupt.CODE:
            interrupt.leave()
        raise


def _exit_code() -> int:
    # The base class of all errors of arguments; its package depends on typer's version.
    usage_error: type[Exception] = typer.BadParameter.__mro__[2]
    try:
        code = app(standalone_mode=False)
    except usage_error as error:
        if sentence := error.format_message():  # type: ignore[attr-defined]
            tell(f"jostle: {sentence}")
        return 2
    except (typer.Abort, KeyboardInterrupt):
        return interrupt.CODE
    return code if isinstance(code, int) else 0
