"""The simulator: a window, or a video if there is no display.

The packages and modules form layers. Each uses only those above it:

======================= ========================================================================
simulate                simulations, the engine that steps them, history
draw                    painters, and the layers of a frame
measure                 times, pairs, energy and momentum over time
act                     user actions: mouse, tools, commands on particles
race                    comparison of two methods on the same scene
runner                  scenes, settings and time of a session
storage                 scene files, videos, tables, TOML
session                 everything between the window and the simulation
gui                     the host of ImGui; the keymap and the input of the window
panels                  panels and menus, built with ImGui
window                  the interactive loop
headless                the run without a window, and its table
sweep                   runs of a scene with many settings and seeds
tune                    a map of the times of the search over leaf capacity and depth
cli                     the command `jostle`
======================= ========================================================================

Below all of them are `schema` (the settings), `interrupt` (Ctrl-C), `launcher` (the number of
ranks) and `article` (the programs of 2015). `pyproject.toml` of the repository has these rules, and
`make lint` checks them.

Drawing reads frames, which are copies of a simulation's columns, and never the simulation. The user
changes it through `Engine.edit`. The library never imports this package.

`show` opens the window on a world of one's own.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jostle import World

__all__ = ["show"]


def show(
    world: World,
    *,
    name: str = "world",
    size: tuple[int, int] = (1280, 720),
    steps: int | None = None,
) -> World:
    """Show a world in the window of the simulator, until the window is closed.

    The window works on a copy: `world` itself does not change.

    Parameters
    ----------
    world : jostle.World
        The world to begin with.
    name : str, default "world"
        What the window and the names of its files call the world.
    size : (int, int), default (1280, 720)
        Width and height of the window, in points of the screen.
    steps : int, optional
        Close the window after this number of steps of 1/60 s.

    Returns
    -------
    jostle.World
        The world as it was when the window was closed.

    Raises
    ------
    TypeError
        If `world` is not a `jostle.World`.
    RuntimeError
        If no window can be opened: without a display, without OpenGL 3.3, or before Python 3.11.
        `jostle.record` writes films without any of them.

    Examples
    --------
    >>> world = jostle.World([(0, 0), (9, 1)], radii=2, gravity=(0, 100))
    >>> later = jostle_lab.show(world)  # doctest: +SKIP
    """
    import os

    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    import jostle
    from jostle_lab import interrupt
    from jostle_lab.cli.runs import Opened, open_window
    from jostle_lab.simulate.simulation import Simulation

    if not isinstance(world, jostle.World):
        raise TypeError(f"world is a {type(world).__name__}; it must be a jostle.World")
    copy = jostle.World.restore(world.snapshot())
    with interrupt.handled(), interrupt.raised():
        window = open_window(Opened(Simulation.of_own(copy, name), size), steps)
        if isinstance(window, str):
            raise RuntimeError(f"no window can be opened: {window}; jostle.record writes films")
        window.run()
        return window.session.engine.simulation.world
