"""Geometry of scenes that a program reads."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jostle.results.base import Result


class GaltonBoard(Result):
    """Geometry of the board in the scene `galton`; y grows downwards.

    Attributes
    ----------
    rows : int
        Rows of pegs. A ball that turns right at k of them ends in bin k, counted from 0 on the
        left; k has a binomial distribution of `rows` trials with probability 1/2.
    bin_edges : ndarray of float32, shape (rows + 2,)
        Edges of the bins along x, ascending.
    bin_top : float
        The y of the open top of the bins.
    floor : float
        The y of the bottom of the bins.
    ball_radius : float
        Radius of the balls.

    See Also
    --------
    jostle.scenes.galton_board : Returns it.
    """

    __slots__ = ("rows", "bin_edges", "bin_top", "floor", "ball_radius")

    rows: int
    bin_edges: NDArray[np.float32]
    bin_top: float
    floor: float
    ball_radius: float


class Nozzle(Result):
    """A source of drops in the scene `emitters`.

    Attributes
    ----------
    position : tuple of float
        Centre of the source, x and y.
    velocity : tuple of float
        Velocity of the drops, in pixels per second.
    width : float
        Drops start at random on a line of this length, perpendicular to the velocity.
    spread : float
        Maximum random addition to the velocity, in any direction, in pixels per second.
    radii : tuple of float
        The smallest and the largest radius.
    density : float
        Mass divided by the squared radius.
    drops_per_second : float
        Number of drops per second.

    See Also
    --------
    jostle.scenes.fountains : Returns a list of them.
    """

    __slots__ = ("position", "velocity", "width", "spread", "radii", "density", "drops_per_second")

    position: tuple[float, float]
    velocity: tuple[float, float]
    width: float
    spread: float
    radii: tuple[float, float]
    density: float
    drops_per_second: float
