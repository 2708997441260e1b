"""From settings to a simulation in its first state."""

from __future__ import annotations

from jostle.app.article_simulation import ArticleSimulation
from jostle.app.settings import Settings
from jostle.app.simulation import Simulation
from jostle.app.world_simulation import WorldSimulation


def start(settings: Settings) -> Simulation:
    """Return the simulation that the settings describe."""
    if settings.by_article:
        return ArticleSimulation(settings)
    return WorldSimulation.of_scene(settings)
