"""Start the command `jostle`.

Importing `jostle` takes time, and Ctrl-C during an import would print a traceback. So this module
handles Ctrl-C before it imports anything else.
"""

# The module `signal` imports many others, and Ctrl-C may come during that time.
import _signal as signal  # type: ignore[import-not-found]
import os
import sys


def main() -> None:
    """Run `jostle_lab.cli.command`."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, lambda number, frame: os._exit(130))
    if sys.argv[1:] == ["--version"]:  # without the imports of all commands
        from importlib.metadata import version

        print(f"jostle {version('jostle')}")
        return
    from jostle_lab import cli

    cli.command()


if __name__ == "__main__":
    main()
