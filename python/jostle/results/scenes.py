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
