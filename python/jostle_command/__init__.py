"""Start the command `jostle`.

Importing `jostle` takes time, and Ctrl-C during an import would print a traceback. So this package
is outside `jostle` and handles Ctrl-C before it imports anything else.
"""

# The module `signal` imports many others, and Ctrl-C may come during that time.
import _signal as signal  # type: ignore[import-not-found]
import os


def main() -> None:
    """Run `jostle.cli.command`."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, lambda number, frame: os._exit(130))
    from jostle import cli

    cli.command()
