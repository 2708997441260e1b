"""Switching between the rules of jostle and of the article, with the same particles."""

from __future__ import annotations

import numpy as np

from jostle.app.simulate.settings import Settings
from jostle.app.simulate.simulation import Frame, Rect, Simulation
from jostle.app.simulate.start import start

ARTICLE_LIMIT = 4_000  # particles; with more the article's programs take seconds per frame


def switch_rules(settings: Settings, frame: Frame, view: Rect) -> Simulation:
    """Return the simulation of other settings, in the state of a frame if possible.

    If particles were added or removed, the scene begins anew. The article's display is at the
    origin, so positions are shifted by the corner of the view.

    Raises
    ------
    ValueError
        If there are too many particles for the article's rules.
    """
    if settings.by_article and len(frame) > ARTICLE_LIMIT:
        raise ValueError(
            f"With {len(frame):,} particles a frame of the article's rules would take seconds; "
            f"choose {ARTICLE_LIMIT:,} or fewer."
        )
    simulation = start(settings)
    if np.array_equal(simulation.frame().tags, frame.tags):
        corner = np.array(simulation.view[:2]) - np.array(view[:2])
        simulation.change(
            frame.tags, positions=frame.positions + corner, velocities=frame.velocities
        )
    return simulation
