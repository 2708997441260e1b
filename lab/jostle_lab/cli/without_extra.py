"""The command without the packages of the extra `app`: the version, and a short help."""

from __future__ import annotations

import sys

from jostle import __version__
from jostle_lab.extras import remedy

HELP = """\
Usage: jostle COMMAND [OPTIONS]

A quadtree that finds every touching pair, and a particle simulator.

Commands:
  scenes  List the scenes.
  run     Run a scene in a window, or record a video if there is no display.
  tour    Make pictures and short videos of the simulator, without a display.
  tune    Find the best settings for a scene.
  bench   Compare jostle with other installed libraries on this machine.
  sweep   Simulate a scene with all combinations of settings and seeds.

The commands need packages that are not installed here: {}.
The library, `import jostle`, works without them."""


def answer(arguments: list[str], missing: str | None) -> None:
    """Print the version or the help, or end with a sentence."""
    if arguments == ["--version"]:
        print(f"jostle {__version__}")
    elif not arguments or "--help" in arguments:
        print(HELP.format(remedy("app")))
    else:
        why = f"the command needs {missing}, which is not installed"
        print(f"jostle: {why}; {remedy('app')}", file=sys.stderr)
        raise SystemExit(2)
