"""Switching between the rules of jostle and of the article, with the same particles."""

from __future__ import annotations

import numpy as np

from jostle.app.simulate.settings import Settings, too_slow
from jostle.app.simulate.simulation import Frame, Rect, Simulation
from jostle.app.simulate.start import start


def switch_rules(settings: Settings, frame: Frame, view: Rect) -> Simulation:
    """Return the simulation of other settings, in the state of a frame if possible.

    If particles were added or removed, the scene begins anew. The article's display is at the
    origin, so positions are shifted by the corner of the view.

    Raises
    ------
    ValueError
        If there are too many particles for the method.
    """
    if reason := too_slow(settings.method, len(frame)):
        raise ValueError(reason)
    simulation = start(settings)
    if np.array_equal(simulation.frame().tags, frame.tags):
        corner = np.array(simulation.view[:2]) - np.array(view[:2])
        simulation.change(
            frame.tags, positions=frame.positions + corner, velocities=frame.velocities
        )
    return simulation
