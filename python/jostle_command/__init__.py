"""Starts the command `jostle`.

Importing it takes a moment, and Ctrl-C during an import would print a traceback. So this package
stands outside `jostle` and imports nothing before Ctrl-C ends the process quietly.
"""

# The module `signal` imports much, and Ctrl-C could come meanwhile.
import _signal as signal  # type: ignore[import-not-found]
import os


def main() -> None:
    """Run `jostle.cli.command`."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, lambda number, frame: os._exit(130))
    from jostle import cli

    cli.command()
