"""Particle life: matrices with interesting results, for `PairForce.particle_life`.

``matrix[a, b]`` is the attraction of kind a by kind b, from -1 to 1. The pictures of docs/life.md
show what each of `MATRICES` leads to.

Examples
--------
>>> import jostle, jostle.life
>>> list(jostle.life.MATRICES)[:3]
['dragons', 'caterpillars', 'flowers']
>>> kinds = np.arange(600) % 6
>>> force = jostle.PairForce.particle_life(kinds, jostle.life.MATRICES["dragons"], cutoff=40.0)
>>> bool(np.allclose(jostle.life.matrix_of(force), jostle.life.MATRICES["dragons"]))
True
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from jostle._core import PairForce

__all__ = ["MATRICES", "core_of", "matrix_of", "random_matrix"]

MATRICES: dict[str, tuple[tuple[float, ...], ...]] = {
    "dragons": (
        (0.7, 0.4, -0.6, -0.7, -0.2, 0.5),
        (0.5, 0.7, 0.4, -0.6, -0.7, -0.2),
        (-0.2, 0.5, 0.7, 0.4, -0.6, -0.7),
        (-0.7, -0.2, 0.5, 0.7, 0.4, -0.6),
        (-0.6, -0.7, -0.2, 0.5, 0.7, 0.4),
        (0.4, -0.6, -0.7, -0.2, 0.5, 0.7),
    ),
    "caterpillars": (
        (-0.4, -0.6, -0.6, 0.7, 0.7, -0.8),
        (-0.8, -0.4, -0.6, -0.6, 0.7, 0.7),
        (0.7, -0.8, -0.4, -0.6, -0.6, 0.7),
        (0.7, 0.7, -0.8, -0.4, -0.6, -0.6),
        (-0.6, 0.7, 0.7, -0.8, -0.4, -0.6),
        (-0.6, -0.6, 0.7, 0.7, -0.8, -0.4),
    ),
    "flowers": (
        (1.0, 0.2, 0.0, 0.0, 0.0, 0.0),
        (0.0, 1.0, 0.2, 0.0, 0.0, 0.0),
        (0.0, 0.0, 1.0, 0.2, 0.0, 0.0),
        (0.0, 0.0, 0.0, 1.0, 0.2, 0.0),
        (0.0, 0.0, 0.0, 0.0, 1.0, 0.2),
        (0.2, 0.0, 0.0, 0.0, 0.0, 1.0),
    ),
    "ribbons": (
        (1.0, 0.2, -1.0, -1.0, -1.0, 0.2),
        (0.2, 1.0, 0.2, -1.0, -1.0, -1.0),
        (-1.0, 0.2, 1.0, 0.2, -1.0, -1.0),
        (-1.0, -1.0, 0.2, 1.0, 0.2, -1.0),
        (-1.0, -1.0, -1.0, 0.2, 1.0, 0.2),
        (0.2, -1.0, -1.0, -1.0, 0.2, 1.0),
    ),
    "wheels": (
        (-0.6, 0.2, 0.8, 0.2, 0.8, 0.2),
        (0.2, -0.6, 0.2, 0.8, 0.2, 0.8),
        (0.8, 0.2, -0.6, 0.2, 0.8, 0.2),
        (0.2, 0.8, 0.2, -0.6, 0.2, 0.8),
        (0.8, 0.2, 0.8, 0.2, -0.6, 0.2),
        (0.2, 0.8, 0.2, 0.8, 0.2, -0.6),
    ),
    "insects": (
        (0.9, 0.0, 1.0, -0.8, 0.2, -0.2),
        (0.6, -0.7, 0.7, 0.1, 0.8, 0.0),
        (-0.1, 0.6, 1.0, -0.3, 0.9, 0.9),
        (-0.6, 0.2, 0.4, 0.9, 0.3, -0.7),
        (0.0, 0.0, 0.0, 0.9, -0.3, -0.6),
        (0.0, 0.3, 0.9, 0.2, -0.5, 0.9),
    ),
    "cells": (
        (0.9, -0.6, 0.7, -0.7, 0.0, -0.7),
        (0.4, 0.7, -0.1, 0.9, 0.7, -0.3),
        (0.2, 0.5, 0.7, 0.9, -0.7, 0.5),
        (-0.7, 0.8, -0.5, 0.7, -0.4, 0.9),
        (0.0, -0.4, -0.4, 0.2, -0.3, 0.4),
        (-0.7, -0.5, 0.7, 0.2, -0.5, -0.7),
    ),
    "comets": (
        (0.3, -0.5, -0.9, -1.0, 0.6, 0.8),
        (0.2, 0.5, 0.1, 0.9, 0.6, -1.0),
        (0.7, -0.9, 0.5, -0.6, 0.7, 0.1),
        (-0.4, -0.2, -0.9, -0.8, 0.3, 0.3),
        (0.2, -0.2, 1.0, 1.0, 0.4, 0.3),
        (0.4, -0.2, -0.7, 0.4, 0.1, -0.4),
    ),
}


def random_matrix(
    rng: np.random.Generator, kinds: int = 6, *, symmetric: bool = False
) -> NDArray[np.float64]:
    """Return a random matrix.

    Parameters
    ----------
    rng : numpy.random.Generator
        The source of random numbers.
    kinds : int, default 6
        Number of kinds K.
    symmetric : bool, default False
        Whether all kinds attract each other mutually. Then everything comes to rest.

    Returns
    -------
    ndarray of float64, shape (K, K)
        Numbers from -1 to 1, in steps of 0.1.

    Examples
    --------
    >>> import jostle.life
    >>> jostle.life.random_matrix(np.random.default_rng(1), kinds=2)
    array([[ 0. ,  0.9],
           [-0.7,  0.9]])
    """
    matrix = np.round(rng.uniform(-1, 1, (kinds, kinds)), 1) + 0.0
    if symmetric:
        upper = np.triu(matrix)
        matrix = upper + np.triu(matrix, 1).T
    return matrix


def core_of(force: PairForce) -> float:
    """Return the argument `core` of a force that `PairForce.particle_life` made.

    Parameters
    ----------
    force : PairForce
        A force of particle life.

    Returns
    -------
    float
        The share of the cutoff within which all particles repel each other.

    Examples
    --------
    >>> import jostle, jostle.life
    >>> jostle.life.core_of(jostle.PairForce.particle_life([0], [[1]], 5.0, core=0.25))
    0.25
    """
    first = force.table[0, 0].astype(np.float64)
    return round(float(first[0] / (first[0] - first[1]) / (len(first) - 1)), 6)


def matrix_of(force: PairForce) -> NDArray[np.float64] | None:
    """Return the matrix of a force that `PairForce.particle_life` made; None for other forces.

    Parameters
    ----------
    force : PairForce
        A force between kinds.

    Returns
    -------
    ndarray of float64, shape (K, K), or None
        Attraction of kind a (row) by kind b (column).

    Examples
    --------
    >>> import jostle, jostle.life
    >>> jostle.life.matrix_of(jostle.PairForce.particle_life([0, 1], [[1, 0], [-0.5, 1]], 5.0))
    array([[ 1. ,  0. ],
           [-0.5,  1. ]])
    """
    table = force.table.astype(np.float64)
    strength = table[0, 0, 0]
    if not strength > table[0, 0, 1] or force.damping:
        return None
    core = core_of(force)
    if not 0 < core < 1:
        return None
    share = round((0.5 + 0.5 * core) * (table.shape[2] - 1)) / (table.shape[2] - 1)
    height = 1 - abs(2 * share - 1 - core) / (1 - core)
    if not height > 0:
        return None
    peaks = table[:, :, round(share * (table.shape[2] - 1))]
    matrix = np.round(-peaks / (strength * height), 4) + 0.0
    same = PairForce.particle_life(
        force.kinds, matrix, force.cutoff, core, strength=float(strength)
    ).table
    alike = same.shape == table.shape and np.allclose(same, table, rtol=1e-3, atol=1e-3 * strength)
    return matrix if alike else None
