"""Particle life: matrices with interesting results, for `PairForce.particle_life`.

``matrix[a, b]`` is the attraction of kind a by kind b, from -1 to 1. The pictures of docs/life.md
show what each of `MATRICES` leads to.

Examples
--------
>>> import jostle, jostle.life
>>> list(jostle.life.MATRICES)[:3]
['dragons', 'caterpillars', 'flowers']
>>> force = jostle.PairForce.particle_life(jostle.life.MATRICES["dragons"], cutoff=40.0)
>>> bool(np.allclose(jostle.life.matrix_of(force), jostle.life.MATRICES["dragons"]))
True
"""

from __future__ import annotations

import operator

import numpy as np
from numpy.typing import NDArray

from jostle._core import PairForce

#: The largest number of kinds of a `PairForce`.
MOST_KINDS = 64

__all__ = ["MATRICES", "core_of", "matrix_of", "random_matrix"]


def _cyclic(*first: float) -> tuple[tuple[float, ...], ...]:
    """Return a matrix from its first row: each further row is the one before, moved by one column.

    So the attraction of one kind by another depends on the difference of their numbers alone.
    """
    count = len(first)
    return tuple(first[count - row :] + first[: count - row] for row in range(count))


MATRICES: dict[str, tuple[tuple[float, ...], ...]] = {
    "dragons": _cyclic(0.7, 0.4, -0.6, -0.7, -0.2, 0.5),
    "caterpillars": _cyclic(-0.4, -0.6, -0.6, 0.7, 0.7, -0.8),
    "flowers": _cyclic(1.0, 0.2, 0.0, 0.0, 0.0, 0.0),
    "ribbons": _cyclic(1.0, 0.2, -1.0, -1.0, -1.0, 0.2),
    "wheels": _cyclic(-0.6, 0.2, 0.8, 0.2, 0.8, 0.2),
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
        Number of kinds K, at most 64.
    symmetric : bool, default False
        Whether all kinds attract each other mutually. Then everything comes to rest.

    Returns
    -------
    ndarray of float64, shape (K, K)
        Numbers from -1 to 1, in steps of 0.1.

    Raises
    ------
    TypeError
        If an argument has the wrong type.
    ValueError
        If the number of kinds is out of range.

    See Also
    --------
    jostle.PairForce.particle_life : Makes a force of a matrix.

    Examples
    --------
    >>> import jostle.life
    >>> jostle.life.random_matrix(np.random.default_rng(1), kinds=2)
    array([[ 0. ,  0.9],
           [-0.7,  0.9]])
    """
    if not isinstance(rng, np.random.Generator):
        raise TypeError(f"rng must be a numpy.random.Generator, not {type(rng).__name__}")
    try:
        count = operator.index(kinds)
    except TypeError:
        raise TypeError(f"kinds must be an integer, not {type(kinds).__name__}") from None
    if not 1 <= count <= MOST_KINDS:
        raise ValueError(f"kinds is {count}; it must be between 1 and {MOST_KINDS}")
    matrix = np.round(rng.uniform(-1, 1, (count, count)), 1) + 0.0
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

    Raises
    ------
    TypeError
        If it is no `PairForce`.
    ValueError
        If it is another force than that of particle life.

    See Also
    --------
    matrix_of : The matrix of the force.

    Examples
    --------
    >>> import jostle, jostle.life
    >>> jostle.life.core_of(jostle.PairForce.particle_life([[1]], 5.0, core=0.25))
    0.25
    """
    core = _core(force)
    if core is None:
        raise ValueError(f"force is {force!r}; it must be a force of particle life")
    return core


def _core(force: PairForce) -> float | None:
    """Where the repulsion at short distance ends, as a share of the cutoff, or None."""
    if not isinstance(force, PairForce):
        raise TypeError(f"force must be a PairForce, not {type(force).__name__}")
    first = force.table[0, 0].astype(np.float64)
    if not first[0] > first[1] or force.damping:
        return None
    core = round(float(first[0] / (first[0] - first[1]) / (len(first) - 1)), 6)
    return core if 0 < core < 1 else None


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

    See Also
    --------
    core_of : The argument `core` of the force.

    Examples
    --------
    >>> import jostle, jostle.life
    >>> jostle.life.matrix_of(jostle.PairForce.particle_life([[1, 0], [-0.5, 1]], 5.0))
    array([[ 1. ,  0. ],
           [-0.5,  1. ]])
    """
    core = _core(force)
    if core is None:
        return None
    table = force.table.astype(np.float64)
    strength = table[0, 0, 0]
    share = round((0.5 + 0.5 * core) * (table.shape[2] - 1)) / (table.shape[2] - 1)
    height = 1 - abs(2 * share - 1 - core) / (1 - core)
    if not height > 0:
        return None
    peaks = table[:, :, round(share * (table.shape[2] - 1))]
    matrix = np.round(-peaks / (strength * height), 4) + 0.0
    same = PairForce.particle_life(matrix, force.cutoff, core, strength=float(strength)).table
    alike = same.shape == table.shape and np.allclose(same, table, rtol=1e-3, atol=1e-3 * strength)
    return matrix if alike else None
