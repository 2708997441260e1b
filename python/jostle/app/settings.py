"""What to simulate: the settings that the command, a file and the sliders have in common."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

METHODS = ("quadtree", "brute", "article-quadtree", "article-brute")
RENDERERS = ("auto", "opengl", "software")

OnTouch = Literal["bounce", "merge", "ignore"]


@dataclass
class Settings:
    """A scene and how it runs; None leaves a choice to the scene or the library."""

    scene: str = "mixed"
    n: int | None = None
    seed: int = 0
    method: str = "quadtree"
    leaf_capacity: int | None = None
    max_depth: int | None = None
    world_size: float = 1.0  # the container's sides, as a multiple of the scene's own
    container: Literal["box", "circle", "torus", "none"] | None = None
    gravity: tuple[float, float] | None = None  # world units a second squared
    drag: float | None = None  # 1/s
    restitution: float | None = None
    substeps: int | None = None
    threads: int | None = None
    on_touch: OnTouch | None = None
    time_scale: float = 1.0  # simulated seconds a second

    @property
    def by_article(self) -> bool:
        """Whether the article's rules hold."""
        return self.method.startswith("article-")
