"""Switching between the rules of jostle and of the article, with the same particles."""

from __future__ import annotations

import numpy as np

from jostle.app.simulate.settings import Settings
from jostle.app.simulate.simulation import Frame, Rect, Simulation
from jostle.app.simulate.start import start

ARTICLE_LIMIT = 4_000  # above it the article's own programs take seconds for a frame


def carry_over(settings: Settings, frame: Frame, view: Rect) -> Simulation:
    """Return the simulation of other settings, in the state of a frame where it fits.

    It fits as long as nobody added or removed particles; else the scene begins anew. The article
    has its display at the origin, so places move with the corner of the view.

    Raises
    ------
    ValueError
        Where there are too many particles for the article's rules.
    """
    if settings.by_article and len(frame) > ARTICLE_LIMIT:
        raise ValueError(
            f"The article's rules would take seconds a frame with {len(frame):,} particles; "
            f"choose {ARTICLE_LIMIT:,} or fewer."
        )
    simulation = start(settings)
    if np.array_equal(simulation.frame().tags, frame.tags):
        corner = np.array(simulation.view[:2]) - np.array(view[:2])
        simulation.change(
            frame.tags, positions=frame.positions + corner, velocities=frame.velocities
        )
    return simulation
