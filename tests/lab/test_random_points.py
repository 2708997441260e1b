"""Random points of a disc, and random directions."""

import numpy as np
import pytest

from jostle_lab.simulate.containers import directions, random_in_disc


def test_points_are_spread_evenly_over_a_disc() -> None:
    points = random_in_disc(np.random.default_rng(1), 40_000)
    distances = np.sqrt((points**2).sum(axis=1))
    assert distances.max() <= 1
    assert np.quantile(distances, [0.25, 0.5, 0.75]) == pytest.approx([0.5, 0.707, 0.866], abs=0.01)
    quadrants = np.bincount((points[:, 0] > 0) + 2 * (points[:, 1] > 0), minlength=4)
    assert quadrants / 40_000 == pytest.approx([0.25] * 4, abs=0.01)


def test_directions_have_length_one_and_go_all_ways() -> None:
    ways = directions(np.random.default_rng(2), 40_000)
    assert (ways**2).sum(axis=1) == pytest.approx(1.0)
    assert ways.mean(axis=0) == pytest.approx([0, 0], abs=0.02)
    sectors = np.bincount(np.floor(np.arctan2(*ways.T) / (np.pi / 6)).astype(int) + 6, minlength=12)
    assert sectors[:12] / 40_000 == pytest.approx([1 / 12] * 12, abs=0.01)
