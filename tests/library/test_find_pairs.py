"""`jostle.find_pairs` against brute force in NumPy and SciPy's tree, and its errors."""

import inspect
import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from oracle import DTYPES, Shapes, any_shapes, by_row, pairs_within, uniform
from scipy.spatial import cKDTree
from signals import lets_others_run

import jostle

METHODS = ["auto", "brute", "quadtree"]


@given(any_shapes(), st.sampled_from(METHODS))
def test_equals_brute_force_in_numpy(shapes: Shapes, method: Any) -> None:
    expected = pairs_within(shapes)
    found = jostle.find_pairs(*shapes, method=method)
    np.testing.assert_array_equal(by_row(found), expected)
    sorted_ones = jostle.find_pairs(*shapes, method=method, sort=True)
    np.testing.assert_array_equal(sorted_ones, expected)


@given(any_shapes(dtype=np.float64, boxes=False), st.just(0.0) | st.floats(1e-150, 10))
def test_equals_the_tree_of_scipy(shapes: Shapes, radius: float) -> None:
    """SciPy counts touching as overlapping and rounds otherwise: leaves out such pairs."""
    centers = shapes.centers[np.abs(shapes.centers).max(axis=1, initial=0) < 1e6]

    def clear(pairs: NDArray[Any]) -> NDArray[Any]:
        distances = np.linalg.norm(centers[pairs[:, 0]] - centers[pairs[:, 1]], axis=1)
        return by_row(pairs[np.abs(distances - 2 * radius) > 1e-9])

    found = jostle.find_pairs(centers, radius)
    expected = np.empty((0, 2), np.intp)
    if len(centers):
        expected = cKDTree(centers).query_pairs(2 * radius, output_type="ndarray")
    np.testing.assert_array_equal(clear(found), clear(expected))


@pytest.mark.parametrize("dtype", DTYPES)
def test_a_crowd_against_scipy(dtype: Any) -> None:
    centers = uniform(20_000, dtype)
    expected = cKDTree(centers.astype(np.float64)).query_pairs(1.0, output_type="ndarray")
    found = jostle.find_pairs(centers, 0.5, sort=True)
    different = {*map(tuple, found.tolist())} ^ {*map(tuple, expected.tolist())}
    rows = np.array([*different], np.intp).reshape(-1, 2)
    distances = np.linalg.norm(centers[rows[:, 0]] - centers[rows[:, 1]], axis=1)
    np.testing.assert_allclose(distances, 1.0, atol=1e-4)  # float32 at the border
    assert len(different) <= (2 if dtype is np.float32 else 0)
    assert len(found) > 10_000


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("n", [0, 1, 2, 500])
def test_the_answer_is_a_plain_array(n: int, method: Any) -> None:
    pairs = jostle.find_pairs(uniform(n), 0.5, method=method)
    assert pairs.dtype == np.int64
    assert pairs.ndim == 2
    assert pairs.shape[1] == 2
    assert pairs.flags.c_contiguous
    assert pairs.flags.writeable
    assert (pairs[:, 0] < pairs[:, 1]).all()


@pytest.mark.parametrize("nothing", [[], np.empty((0, 2)), np.empty((0, 2), np.float32)])
@pytest.mark.parametrize("method", METHODS)
def test_nothing_has_no_pairs(nothing: Any, method: Any) -> None:
    assert jostle.find_pairs(nothing, method=method).shape == (0, 2)
    assert jostle.find_pairs(nothing, [], [], method=method).shape == (0, 2)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("method", METHODS)
def test_touching_is_not_overlapping(dtype: Any, method: Any) -> None:
    circles = np.array([(0, 0), (2, 0), (0, 2)], dtype)
    assert len(jostle.find_pairs(circles, 1.0, method=method)) == 0
    closer = np.array([(0, 0), (1.999, 0), (0, 2)], dtype)
    assert jostle.find_pairs(closer, 1.0, method=method).tolist() == [[0, 1]]
    # Rectangles side by side, a circle beside a rectangle, and one off its corner by (3, 4).
    assert len(jostle.find_pairs(circles, 0.0, 1.0, method=method)) == 0
    assert len(jostle.find_pairs(circles[:2], [1.0, 0.0], [(0, 0), (1, 1)], method=method)) == 0
    corner = np.array([(0, 0), (4, 5)], dtype)
    assert len(jostle.find_pairs(corner, [5.0, 0.0], [(0, 0), (1, 1)], method=method)) == 0
    assert len(jostle.find_pairs(corner, [5.001, 0.0], [(0, 0), (1, 1)], method=method)) == 1


def test_rectangles_overlap_by_their_insides() -> None:
    inside = [(0, 0), (0.5, 0.5)]
    assert jostle.find_pairs(inside, half_sizes=[(5, 5), (1, 1)]).tolist() == [[0, 1]]
    cross = [(0, 0), (0, 0)]
    assert jostle.find_pairs(cross, half_sizes=[(5, 1), (1, 5)]).tolist() == [[0, 1]]
    flat = [(0, 0), (1, 0)]  # on the same line, so neither has an interior
    assert len(jostle.find_pairs(flat, half_sizes=(5, 0))) == 0


POINTS = np.array([(0, 0), (3, 0), (4, 0), (4, 1), (-7, 2)])
EXPECTED = [[1, 2], [1, 3], [2, 3]]


def unaligned(array: NDArray[Any]) -> NDArray[Any]:
    memory = np.zeros(array.nbytes + 1, np.uint8)
    view: NDArray[Any] = memory[1:].view(array.dtype).reshape(array.shape)
    view[:] = array
    return view


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    array = array.copy()
    array.flags.writeable = False
    return array


LAYOUTS = {
    "list": lambda a: a.tolist(),
    "tuple": lambda a: tuple(a.tolist()),
    "list of arrays": list,
    "Fortran": np.asfortranarray,
    "every other row": lambda a: np.repeat(a, 2, axis=0)[::2],
    "backwards": lambda a: a[::-1].copy()[::-1],
    "some columns": lambda a: np.hstack([a, a, a])[:, ::2][:, [0, 2]] if a.ndim > 1 else a,
    "mirrored": lambda a: a[..., ::-1].copy()[..., ::-1],
    "read-only": read_only,
    "unaligned": unaligned,
    "other byte order": lambda a: a.astype(a.dtype.newbyteorder()),
    "broadcast": lambda a: np.broadcast_to(a, a.shape),
    "matrix of a subclass": lambda a: a.view(type("Own", (np.ndarray,), {})),
}


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("dtype", ["f4", "f8"])
def test_any_layout_is_read(layout: str, dtype: str) -> None:
    lay = LAYOUTS[layout]
    centers, radii = lay(POINTS.astype(dtype)), lay(np.ones(5, dtype))
    assert jostle.find_pairs(centers, radii, sort=True).tolist() == EXPECTED
    half_sizes = lay(np.full((5, 2), 0.75, dtype))
    assert jostle.find_pairs(centers, 0.0, half_sizes, sort=True).tolist() == EXPECTED


@pytest.mark.parametrize("dtype", ["i1", "i2", "i4", "i8", "f2", "f4", "f8", "g"])
def test_any_real_type_is_read(dtype: str) -> None:
    assert jostle.find_pairs(POINTS.astype(dtype), 1.0, sort=True).tolist() == EXPECTED
    unsigned = dtype.replace("i", "u")
    assert jostle.find_pairs((POINTS + 9).astype(unsigned), 1, sort=True).tolist() == EXPECTED


@pytest.mark.parametrize("radius", [1, 1.0, np.float32(1), np.float64(1), np.int8(1), np.array(1)])
def test_any_number_is_a_radius(radius: Any) -> None:
    assert jostle.find_pairs(POINTS, radius, sort=True).tolist() == EXPECTED
    assert jostle.find_pairs(POINTS, 0, 0.75 * radius, sort=True).tolist() == EXPECTED


@pytest.mark.parametrize("half_sizes", [0.75, (0.75, 0.75), [(0.75, 0.75)] * 5])
def test_half_sizes_for_all_or_each(half_sizes: Any) -> None:
    assert jostle.find_pairs(POINTS, half_sizes=half_sizes, sort=True).tolist() == EXPECTED


def test_wide_and_high_are_not_confused() -> None:
    assert jostle.find_pairs([(0, 0), (3, 0)], half_sizes=(2, 0.1)).tolist() == [[0, 1]]
    assert jostle.find_pairs([(0, 0), (0, 3)], half_sizes=(0.1, 2)).tolist() == [[0, 1]]
    # Two half sizes for two shapes are a pair for both.
    for pair in ((2, 0.1), [2, 0.1]):
        assert len(jostle.find_pairs([(0, 0), (0, 3)], half_sizes=pair)) == 0


def test_float32_computes_in_float32() -> None:
    """0.1 + 0.2 is more than 0.3 in float64, and equal to it in float32."""
    centers, radii = np.array([(0, 0), (0.3, 0)]), np.array([0.1, 0.2])
    assert len(jostle.find_pairs(centers, radii)) == 1
    assert len(jostle.find_pairs(centers.tolist(), radii.tolist())) == 1
    assert len(jostle.find_pairs(centers.astype("f4"), radii.astype("f4"))) == 0
    assert len(jostle.find_pairs(centers.astype(">f4"), radii.astype("<f4"))) == 0


def test_the_input_stays_as_it_was() -> None:
    centers, radii = uniform(300), np.full(300, 0.5)
    before = centers.copy(), radii.copy()
    jostle.find_pairs(centers, radii)
    np.testing.assert_array_equal(centers, before[0])
    np.testing.assert_array_equal(radii, before[1])


TWO = [(0, 0), (1, 1)]
WRONG_VALUES = [
    ({"positions": np.zeros((3, 3))}, "positions has shape (3, 3); it must be (n, 2)"),
    ({"positions": [1, 2]}, "positions has shape (2,); it must be (n, 2)"),
    ({"positions": 1.5}, "positions has shape (); it must be (n, 2)"),
    ({"positions": np.zeros((2, 2, 2))}, "positions has shape (2, 2, 2); it must be (n, 2)"),
    ({"positions": np.zeros((0, 3))}, "positions has shape (0, 3); it must be (n, 2)"),
    ({"positions": [(0, 0), (np.nan, 1)]}, "positions[1] is (NaN, 1); both coordinates must be"),
    ({"positions": [(1, 2), (3,)]}, "positions cannot be read as an array: "),
    ({"radii": [1, 2, 3]}, "radii has shape (3,); it must be a number or (2,)"),
    ({"radii": [[1], [2]]}, "radii has shape (2, 1); it must be a number or (2,)"),
    ({"radii": []}, "radii has shape (0,); it must be a number or (2,)"),
    ({"radii": -0.5}, "radii is -0.5; a radius must be finite and at least 0"),
    ({"radii": [0, -0.5]}, "radii[1] is -0.5; a radius must be finite and at least 0"),
    ({"radii": [0, 1e308]}, "radii[1] is 1"),
    ({"positions": [], "radii": -1}, "radii is -1; a radius must be finite and at least 0"),
    ({"half_sizes": [1, 2, 3]}, "half_sizes has shape (3,); it must be a number, (2,) or (2, 2)"),
    ({"half_sizes": np.ones((3, 2))}, "half_sizes has shape (3, 2); it must be a number"),
    ({"half_sizes": -1}, "half_sizes is -1; a half size must be finite and at least 0"),
    ({"half_sizes": (1, -2)}, "half_sizes is -2; a half size must be finite and at least 0"),
    ({"half_sizes": [(1, 1), (1, -2)]}, "half_sizes[1] is -2; a half size must be"),
    ({"method": "tree"}, "method is 'tree'; it must be 'auto', 'brute' or 'quadtree'"),
    ({"threads": 0}, "threads is 0; it must be at least 1"),
    ({"threads": -3}, "threads is -3; it must be at least 1"),
    ({"threads": 5000}, "threads is 5000; it must be between 1 and 1024"),
    ({"max_pairs": -1}, "max_pairs is -1; it must be at least 0"),
    ({"max_pairs": 2**80}, f"max_pairs is {2**80}; it must be at most"),
]
WRONG_TYPES = [
    (
        {"positions": None},
        "positions, boxes or segments must be given: positions of shape (n, 2), boxes of shape "
        "(n, 4), which are min_x, min_y, max_x, max_y, or segments of shape (n, 2, 2)",
    ),
    ({"positions": "here"}, "positions must hold real numbers, not str"),
    ({"positions": [("0", "1")]}, "positions must hold real numbers, not <U1"),
    ({"positions": [(True, False)]}, "positions must hold real numbers, not bool"),
    ({"positions": [(1j, 0)]}, "positions must hold real numbers, not complex128"),
    ({"positions": [(0, 0), (None, 1)]}, "positions must hold real numbers, not object"),
    (
        {"positions": np.zeros((2, 2), "M8[s]")},
        "positions must hold real numbers, not datetime64[s]",
    ),
    ({"radii": None}, "radii must hold real numbers, not NoneType"),
    ({"radii": True}, "radii must hold real numbers, not bool"),
    ({"radii": {1, 2}}, "radii must be an ordered list or array, not set"),
    ({"half_sizes": "wide"}, "half_sizes must hold real numbers, not str"),
    ({"half_sizes": np.ones((2, 2), bool)}, "half_sizes must hold real numbers, not bool"),
    ({"method": 3}, "method must be 'auto', 'brute' or 'quadtree', not int"),
    ({"method": None}, "method must be 'auto', 'brute' or 'quadtree', not NoneType"),
    ({"sort": 1}, "sort must be True or False, not int"),
    ({"max_pairs": 1.5}, "max_pairs must be an integer, not float"),
    ({"max_pairs": None}, "max_pairs must be an integer, not NoneType"),
    ({"max_pairs": True}, "max_pairs must be an integer, not bool"),
    ({"threads": "all"}, "threads must be an integer, not str"),
]


@pytest.mark.parametrize(
    ("error", "arguments", "message"),
    [(ValueError, *case) for case in WRONG_VALUES] + [(TypeError, *case) for case in WRONG_TYPES],
)
def test_wrong_arguments(error: Any, arguments: dict[str, Any], message: str) -> None:
    """A tree refuses the same arguments."""
    end = "$" if error is TypeError else ""
    is_for_trees = arguments.keys() <= inspect.signature(jostle.Quadtree).parameters.keys()
    for call in (jostle.find_pairs, *[jostle.Quadtree] * is_for_trees):
        with pytest.raises(error, match=f"^{re.escape(message)}{end}"):
            call(**{"positions": TWO, **arguments})


@given(
    any_shapes(boxes=True),
    st.sampled_from(["centers", "radii", "half_sizes"]),
    st.sampled_from([np.nan, np.inf, -np.inf]),
    st.sampled_from(METHODS),
    st.data(),
)
def test_what_is_not_finite_is_refused_by_name_and_index(
    shapes: Shapes, name: str, value: float, method: Any, data: st.DataObject
) -> None:
    column = getattr(shapes, name).copy()
    if len(column) == 0:
        return
    index = data.draw(st.integers(0, len(column) - 1))
    column[index if column.ndim == 1 else (index, data.draw(st.integers(0, 1)))] = value
    argument = name.replace("centers", "positions")
    with pytest.raises(ValueError, match=rf"^{argument}\[{index}\] is .*; .* must be finite"):
        jostle.find_pairs(*shapes._replace(**{name: column}), method=method)


def test_too_many_pairs_stop_the_search() -> None:
    same = np.zeros((20_000, 2))  # 200 million pairs
    message = "more than max_pairs = 1000 pairs overlap; raise max_pairs if"
    for method in METHODS:
        with pytest.raises(ValueError, match=message):
            jostle.find_pairs(same, 1.0, method=method, max_pairs=1000)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("n", [2, 40, 3000])
def test_max_pairs_is_exact(method: Any, threads: int, n: int) -> None:
    centers = uniform(n) / 4
    count = len(jostle.find_pairs(centers, 0.5, method=method))
    limited = jostle.find_pairs(centers, 0.5, method=method, max_pairs=count, threads=threads)
    assert len(limited) == count > 0
    with pytest.raises(ValueError, match="max_pairs"):
        jostle.find_pairs(centers, 0.5, method=method, max_pairs=count - 1, threads=threads)


def test_no_pairs_need_no_room() -> None:
    assert jostle.find_pairs([(0, 0), (9, 9)], 1.0, max_pairs=0).shape == (0, 2)


@pytest.mark.parametrize("method", ["brute", "quadtree"])
def test_other_threads_run_meanwhile(method: Any) -> None:
    centers = uniform(50_000 if method == "brute" else 2_000_000)
    assert lets_others_run(lambda: jostle.find_pairs(centers, 0.5, method=method, threads=1))


def test_the_defaults_of_its_signature_are_its_defaults() -> None:
    parameters = inspect.signature(jostle.find_pairs).parameters
    defaults = {name: p.default for name, p in parameters.items()}
    assert defaults.pop("positions") is None
    assert defaults == {
        "boxes": None, "segments": None, "categories": None, "masks": None, "radii": 0.0,
        "half_sizes": None, "method": "auto", "sort": False, "max_pairs": 2**27, "threads": None,
        "distance": 0.0, "period": None,
    }  # fmt: skip
    assert jostle.find_pairs(POINTS, **defaults).tolist() == jostle.find_pairs(POINTS).tolist()
