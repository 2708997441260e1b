"""`jostle.separate` against brute force, theory and its promises."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from oracle import open_overlap

import jostle


def count(centers, radii, halves, gap=0.0):
    """Overlapping pairs, by the exact formula, in the precision of the arrays."""
    i, j = np.triu_indices(len(centers), 1)
    d = np.abs(centers[i] - centers[j]) - (halves[i] + halves[j])
    return int(open_overlap(d, radii[i] + radii[j] + centers.dtype.type(gap)).sum())


NUMBERS = [0.0, -0.0, 1e-30, 1e6, -1e6, 7.0, 7.0 + 1e-9]


@st.composite
def problems(draw):
    """Coincident, collinear, nested, huge, tiny and touching shapes."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    n = int(rng.choice([0, 1, 2, 5, 40]))
    centers = rng.uniform(-30, 30, (n, 2))
    special = rng.random((n, 2)) < rng.choice([0.0, 0.2])
    centers = np.where(special, rng.choice(NUMBERS, (n, 2)), centers)
    centers = centers.round(int(rng.choice([0, 1, 9])))
    centers *= rng.choice([0, 1, 1], 2)
    sizes = rng.uniform(0, 8, (n, 3)).round(int(rng.choice([0, 9])))
    sizes[rng.random((n, 3)) < 0.1] = rng.choice([0.0, 1e-6, 20.0])
    kind = rng.choice(["discs", "boxes", "rounded"])
    radii = sizes[:, 0] * (kind != "boxes")
    return centers, radii, sizes[:, 1:] * (kind != "discs")


@given(problems(), st.sampled_from([None, 0, 1]), st.sampled_from([0.0, 0.5]), st.booleans())
@example((np.zeros((30, 2)), np.ones(30), np.zeros((30, 2))), None, 0.0, False)
@example((np.zeros((30, 2)), np.zeros(30), np.ones((30, 2))), None, 0.5, True)
def test_nothing_overlaps_afterwards(problem, axis, gap, single) -> None:
    centers, radii, halves = problem
    if single:
        centers, radii, halves = (a.astype("f4") for a in problem)
    apart = jostle.separate(centers, radii, halves, axis=axis, gap=gap)
    assert apart.positions.dtype == centers.dtype
    assert apart.overlaps == count(apart.positions, radii, halves, gap)
    near = np.abs(centers).max(initial=0) < 1e4 and not single
    if near:  # elsewhere the spacing of numbers may be larger than the tolerance
        assert apart.overlaps == 0
    if axis is not None:
        np.testing.assert_array_equal(apart.positions[:, 1 - axis], centers[:, 1 - axis])


@given(problems())
def test_what_does_not_overlap_does_not_move(problem) -> None:
    centers, radii, halves = problem
    apart = jostle.separate(centers, radii, halves)
    if apart.overlaps == 0:
        again = jostle.separate(apart.positions, radii, halves)
        np.testing.assert_array_equal(again.positions, apart.positions)
        assert again.rounds == 1


@pytest.mark.parametrize("axis", [None, 0, 1])
@pytest.mark.parametrize("n", [300, 6000])
def test_threads_and_order_change_nothing(axis: int | None, n: int) -> None:
    rng = np.random.default_rng(n)
    centers = rng.normal(0, 2 * np.sqrt(n), (n, 2))
    columns = {"half_sizes": rng.uniform(0, 2, (n, 2)), "radii": rng.uniform(0.1, 1, n)}
    fixed = rng.random(n) < 0.02
    columns |= {"weights": rng.uniform(0.5, 2, n), "movable": ~fixed}
    one = jostle.separate(centers, **columns, axis=axis, threads=1)
    order = rng.permutation(n)
    ordered = {name: column[order] for name, column in columns.items()}
    many = jostle.separate(centers[order], **ordered, axis=axis, threads=2)
    np.testing.assert_array_equal(one.positions[order], many.positions)
    assert (one.rounds, one.overlaps) == (many.rounds, many.overlaps)
    np.testing.assert_array_equal(one.positions[fixed], centers[fixed])


def test_equal_shapes_at_one_place_can_be_exchanged() -> None:
    centers = np.array([[0.0, 0.0]] * 5 + [[0.5, 0.0], [9.0, 9.0]])
    apart = jostle.separate(centers, 1.0).positions
    order = np.array([3, 6, 0, 5, 1, 4, 2])
    other = jostle.separate(centers[order], 1.0).positions
    as_set = lambda rows: sorted(map(tuple, rows.tolist()))  # noqa: E731
    assert as_set(apart) == as_set(other)


def test_two_discs_share_the_motion_by_weight() -> None:
    apart = jostle.separate([(0, 0), (1, 0)], 1.0, weights=[1.0, 3.0]).positions
    moved = np.abs(apart - [(0, 0), (1, 0)])
    assert moved[0, 0] == pytest.approx(3 * moved[1, 0])
    assert 2 <= apart[1, 0] - apart[0, 0] <= 2.1
    assert (moved[:, 1] == 0).all()


def test_a_pair_moves_by_no_more_than_needed() -> None:
    """Two discs that overlap by a depth move by half of it each, and the tolerance."""
    rng = np.random.default_rng(4)
    for _ in range(50):
        centers, radii = rng.normal(0, 1, (2, 2)), rng.uniform(0.5, 3, 2)
        depth = radii.sum() - np.linalg.norm(centers[1] - centers[0])
        apart = jostle.separate(centers, radii, tolerance=0.001).positions
        moved = np.linalg.norm(apart - centers, axis=1)
        if depth > 0:
            assert moved == pytest.approx([depth / 2] * 2, abs=0.003)
        else:
            assert (moved == 0).all()


def test_fixed_shapes_stay_and_push_others_away() -> None:
    rng = np.random.default_rng(3)
    centers = np.concatenate([[(0.0, 0.0)], rng.normal(0, 10, (400, 2))])
    radii = np.concatenate([[15.0], np.full(400, 1.0)])
    fixed = np.arange(401) == 0
    apart = jostle.separate(centers, radii, movable=~fixed)
    assert apart.overlaps == 0
    assert tuple(apart.positions[0]) == (0, 0)
    assert (np.linalg.norm(apart.positions[1:], axis=1) >= 16).all()
    both = jostle.separate([(0, 0), (1, 0)], 1.0, movable=[False, False])
    assert both.overlaps == 0
    np.testing.assert_array_equal(both.positions, [(0, 0), (1, 0)])


def test_bounds_hold_everything_that_fits() -> None:
    rng = np.random.default_rng(5)
    centers = rng.normal(0, 200, (300, 2))
    halves = rng.uniform(0.5, 2, (300, 2))
    bounds = (-40, -30, 40, 30)
    apart = jostle.separate(centers, 0.25, halves, bounds=bounds)
    reach = halves + 0.25
    assert (apart.positions - reach >= np.array(bounds[:2]) - 1e-9).all()
    assert (apart.positions + reach <= np.array(bounds[2:]) + 1e-9).all()
    assert apart.overlaps == 0


def test_bounds_that_are_too_small_are_reported() -> None:
    apart = jostle.separate(np.zeros((50, 2)), 1.0, bounds=(-3, -3, 3, 3))
    assert apart.overlaps > 0
    assert apart.overlaps == count(apart.positions, np.ones(50), np.zeros((50, 2)))
    assert (np.abs(apart.positions) <= 2).all()


def test_rounds_end_soon_if_nothing_gets_better() -> None:
    """Fewer than ten overlaps that nothing can remove."""
    apart = jostle.separate([(0, 0), (0.1, 0), (0, 0.1)], 1.0, bounds=(-1.5, -1.5, 1.5, 1.5))
    assert apart.overlaps > 0 and apart.rounds < 200


def test_bounds_along_an_axis() -> None:
    # Wider than the bounds, but moved along y alone.
    wide = jostle.separate([(0, 9), (1, 9)], half_sizes=(5, 1), axis=1, bounds=(-1, -4, 1, 4))
    assert wide.overlaps == 0 and wide.positions[:, 0].tolist() == [0, 1]
    assert (np.abs(wide.positions[:, 1]) <= 3).all()
    # Too little room: all are inside nevertheless.
    crowd = jostle.separate(np.tile((0.0, 50.0), (40, 1)), 1.0, axis=1, bounds=(-1, -4, 1, 4))
    assert crowd.overlaps > 0 and (np.abs(crowd.positions[:, 1]) <= 3).all()


def test_a_shape_that_is_pushed_far_in_one_round_is_found() -> None:
    """Far beyond the margin of the lists: onto one that was not near."""
    centers = np.array([(0, 0), (0.5, 0), (60.0, 0), *[(300.0 + 3 * k, 0) for k in range(50)]])
    radii = np.concatenate([[50, 1, 1], np.ones(50)])
    for rounds in range(6):
        apart = jostle.separate(centers, radii, movable=np.arange(53) != 0, max_rounds=rounds)
        assert apart.overlaps == count(apart.positions, radii, np.zeros((53, 2)))


def test_a_heap_of_labels() -> None:
    rng = np.random.default_rng(6)
    n = 10_000
    halves = np.stack([rng.uniform(15, 45, n), np.full(n, 6.0)], 1)
    for spread in (0.0, 200.0, 700.0):
        apart = jostle.separate(rng.normal(0, spread, (n, 2)), 0.0, halves)
        assert apart.overlaps == 0
        assert len(jostle.find_pairs(apart.positions, 0.0, halves)) == 0


def test_a_swarm_is_as_high_as_it_must_be() -> None:
    rng = np.random.default_rng(7)
    x = rng.normal(0, 300, 10_000)
    swarm = jostle.separate(np.stack([x, 0 * x], 1), 2.0, axis=1)
    assert swarm.overlaps == 0
    # Discs of 4 x 4 in a column of width 4: where they are densest they need this height.
    needed = 4 * np.histogram(x, np.arange(-1200, 1200, 4))[0].max()
    height = np.ptp(swarm.positions[:, 1])
    assert 0.5 * needed < height < 1.6 * needed
    np.testing.assert_array_equal(swarm.positions[:, 0], x)


def test_few_rounds_make_things_better_but_not_good() -> None:
    rng = np.random.default_rng(8)
    centers = rng.uniform(0, 60, (1000, 2))
    overlaps = [jostle.separate(centers, 1.0, max_rounds=k).overlaps for k in (0, 3, 1000)]
    assert overlaps[0] == len(jostle.find_pairs(centers, 1.0))
    assert overlaps[0] > overlaps[1] > overlaps[2] == 0


def test_a_gap_is_kept() -> None:
    rng = np.random.default_rng(9)
    centers, halves = rng.uniform(0, 20, (60, 2)), rng.uniform(0, 2, (60, 2))
    apart = jostle.separate(centers, 0.5, halves, gap=1.5)
    assert apart.overlaps == 0
    assert count(apart.positions, np.full(60, 0.5), halves, 1.5 - 1e-9) == 0


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"movable": [1, 0]}, TypeError, "movable must hold booleans"),
        ({"gap": "1"}, TypeError, "gap must be a number"),
        ({"weights": [1, 0]}, ValueError, r"weights\[1\] is 0"),
        ({"weights": -1.0}, ValueError, "weights is -1"),
        ({"weights": [1, 2, 3]}, ValueError, r"weights has shape \(3,\)"),
        ({"movable": [True]}, ValueError, r"movable has shape \(1,\)"),
        ({"gap": -1}, ValueError, "gap is -1"),
        ({"gap": float("nan")}, ValueError, "gap is NaN"),
        ({"tolerance": 2}, ValueError, "tolerance is 2; it must be between 0 and 1"),
        ({"axis": 2}, ValueError, "axis is 2; it must be 0 or 1"),
        ({"bounds": (0, 0, -1, 1)}, ValueError, "bounds is"),
        ({"bounds": (0, 0, 1, 1)}, ValueError, "shape 0 is larger"),
        ({"bounds": [(0, 0, 9, 9)]}, ValueError, r"bounds has shape \(1, 4\)"),
        ({"radii": [1, float("inf")]}, ValueError, r"radii\[1\] is inf"),
        ({"max_rounds": -1}, ValueError, "max_rounds is -1"),
        ({"threads": 0}, ValueError, "threads is 0"),
    ],
)
def test_bad_arguments(arguments, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        jostle.separate([(0, 0), (1, 1)], **{"radii": 1.0, **arguments})
