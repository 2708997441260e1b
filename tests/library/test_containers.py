"""`jostle.Box` and `jostle.Circle`: values that describe the region of a world; and its period."""

import inspect
import re
from typing import Any

import numpy as np
import pytest
from copies import WAYS
from hypothesis import given
from hypothesis import strategies as st

import jostle

BOX = jostle.Box(-1, 0.1, 800, 500)
CIRCLE = jostle.Circle((400, 250), 240.5)
SIDES = jostle.Box(0, 0, 4, 3, restitution=[None, 0.1, 1, 0], friction=0.5)
ROUND = jostle.Circle((1, 2), 3, restitution=0.25)
ALL = [BOX, CIRCLE, SIDES, ROUND]
finite = st.floats(-1e15, 1e15)
positive = st.floats(1e-15, 1e15)


def test_attributes_are_the_arguments() -> None:
    assert (BOX.min_x, BOX.min_y, BOX.max_x, BOX.max_y) == (-1, 0.1, 800, 500)
    assert (CIRCLE.center.tolist(), CIRCLE.radius) == ([400, 250], 240.5)
    assert (BOX.restitution, BOX.friction, ROUND.restitution) == (None, None, 0.25)
    assert (SIDES.restitution, SIDES.friction) == ((None, 0.1, 1, 0), 0.5)
    assert jostle.Box(0, 0, 1, 1, restitution=[0.5] * 4).restitution == 0.5
    assert jostle.Box(0, 0, 1, 1, friction=np.array([np.nan] * 4)).friction is None
    assert jostle.Box(min_x=0, min_y=1, max_x=2, max_y=3) == jostle.Box(0, 1, 2, 3)
    assert jostle.Circle(center=np.array([1, 2]), radius=np.float32(3)).center.tolist() == [1, 2]


def test_representations() -> None:
    assert repr(BOX) == "Box(-1.0, 0.1, 800.0, 500.0)"
    assert repr(CIRCLE) == "Circle((400.0, 250.0), 240.5)"
    sides = "restitution=(None, 0.1, 1.0, 0.0), friction=0.5"
    assert repr(SIDES) == f"Box(0.0, 0.0, 4.0, 3.0, {sides})"
    assert repr(ROUND) == "Circle((1.0, 2.0), 3.0, restitution=0.25)"


@given(finite, finite, positive, positive)
def test_a_representation_evaluates_to_the_same(x: float, y: float, w: float, h: float) -> None:
    made: list[Any] = [jostle.Circle((x, y), w)]
    if np.float32(x) < np.float32(x + w) and np.float32(y) < np.float32(y + h):
        made.append(jostle.Box(x, y, x + w, y + h))
    for container in made:
        again = eval(repr(container), vars(jostle))
        assert again == container
        assert repr(again) == repr(container)


@pytest.mark.parametrize("container", ALL, ids=repr)
def test_equal_by_value(container: Any) -> None:
    for same in (eval(repr(container), vars(jostle)), *(way(container) for way in WAYS)):
        assert same == container
        assert hash(same) == hash(container)
        assert (same != container) is False
        assert len({container, same, *ALL}) == 4
    assert all(other != container for other in ALL if other is not container)
    assert container != repr(container)


def test_zero_has_one_sign() -> None:
    boxes = jostle.Box(-0.0, 0, 1, 1), jostle.Box(0, -0.0, 1, 1)
    assert boxes[0] == boxes[1]
    assert hash(boxes[0]) == hash(boxes[1])


@pytest.mark.parametrize("container", ALL, ids=repr)
def test_frozen(container: Any) -> None:
    for name in [*inspect.signature(type(container)).parameters, "own"]:
        with pytest.raises(AttributeError):
            setattr(container, name, 1)
    with pytest.raises(ValueError, match="read-only"):
        container.bounds[0] = 1


def test_pattern_matching() -> None:
    match BOX:
        case jostle.Box(min_x, _, max_x, _):
            assert (min_x, max_x) == (-1, 800)
    match CIRCLE:
        case jostle.Circle(center, radius):
            assert (center[0], radius) == (400, 240.5)


@pytest.mark.parametrize("container", ALL, ids=repr)
def test_a_world_gives_back_what_it_was_given(container: Any) -> None:
    world = jostle.World([], [], velocities=[], container=container)
    assert world.container == container
    assert type(world.container) is type(container)
    assert jostle.World.restore(world.snapshot()).container == container
    world.container = None
    assert world.container is None


NAN, INF = np.nan, np.inf
BOX_RULE = "its corners must be finite and min below max"
CIRCLE_RULE = "its centre must be finite and its radius finite and above 0"


WRONG = {
    ValueError: [
        (jostle.Box, (1, 0, 0, 1), f"Box(1, 0, 0, 1): {BOX_RULE}"),
        (jostle.Box, (0, 1, 1, 1), f"Box(0, 1, 1, 1): {BOX_RULE}"),
        (jostle.Box, (NAN, 0, 1, 1), f"Box(NaN, 0, 1, 1): {BOX_RULE}"),
        (jostle.Box, (0, 0, INF, 1), f"Box(0, 0, inf, 1): {BOX_RULE}"),
        (jostle.Box, (2**24, 0, 2**24 + 1, 1), "Box(16777216, 0, 16777216, 1): its"),
        (jostle.Circle, ((0, 0), 0), f"Circle((0, 0), 0): {CIRCLE_RULE}"),
        (jostle.Circle, ((0, 0), -1), f"Circle((0, 0), -1): {CIRCLE_RULE}"),
        (jostle.Circle, ((0, NAN), 1), f"Circle((0, NaN), 1): {CIRCLE_RULE}"),
        (jostle.Circle, ((0, 0), INF), f"Circle((0, 0), inf): {CIRCLE_RULE}"),
        (jostle.Circle, (0, 1), "center is 0; it must be two numbers, such as (0, 0)"),
        (jostle.Circle, ((1, 2, 3), 1), "center has shape (3,); it must be (2,)"),
    ],
    TypeError: [
        (jostle.Box, ("0", 0, 1, 1), "min_x must be a number, not str"),
        (jostle.Box, (0, 0, 1, None), "max_y must be a number, not NoneType"),
        (jostle.Circle, ("ab", 1), "center must hold real numbers, not str"),
        (jostle.Circle, ((0, 0), [1]), "radius must be a number, not list"),
    ],
}


@pytest.mark.parametrize(
    ("error", "kind", "arguments", "message"),
    [(error, *case) for error in WRONG for case in WRONG[error]],
)
def test_wrong_arguments(error: Any, kind: Any, arguments: tuple[Any, ...], message: str) -> None:
    end = "$" if error is TypeError else ""
    with pytest.raises(error, match=f"^{re.escape(message)}{end}"):
        kind(*arguments)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: jostle.Box(0, 0, 1, 1, restitution=2), "restitution[0] is 2; it must lie"),
        (
            lambda: jostle.Box(0, 0, 1, 1, restitution=[1, 1, -1, 1]),
            "restitution[2] is -1; it must",
        ),
        (lambda: jostle.Box(0, 0, 1, 1, friction=[0, np.inf, 0, 0]), "friction[1] is inf; it must"),
        (lambda: jostle.Box(0, 0, 1, 1, restitution=[1, 1]), "restitution has shape (2,); it must"),
        (
            lambda: jostle.Circle((0, 0), 1, restitution=[1, 1, 0, 1]),
            "sides is side 2; a circle has",
        ),
        (lambda: BOX.clip([(0, 0)], margin=-1), "margin is -1; it must be finite and at least 0"),
        (lambda: BOX.contains([1, 2, 3]), "points has shape (3,); it must be (2,) or (k, 2)"),
    ],
)
def test_wrong_coefficients_and_points(make: Any, message: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}"):
        make()


def test_measures_of_a_region() -> None:
    assert SIDES.bounds.tolist() == [0, 0, 4, 3] and SIDES.area == 12
    assert ROUND.bounds.tolist() == [-2, -1, 4, 5] and ROUND.area == pytest.approx(9 * np.pi)
    rng = np.random.default_rng(1)
    points = rng.uniform(-3, 6, (500, 2))
    in_box = ((points >= 0) & (points <= (4, 3))).all(axis=1)
    in_circle = np.hypot(*(points - (1, 2)).T) <= 3
    for region, inside in ((SIDES, in_box), (ROUND, in_circle)):
        np.testing.assert_array_equal(region.contains(points), inside)
        assert region.contains(points[0]) is bool(inside[0])
        clipped = region.clip(points)
        np.testing.assert_array_equal(clipped[inside], points[inside])
        assert region.contains(region.clip(points, 0.001)).all()
    np.testing.assert_array_equal(SIDES.clip(points, 0.5), np.clip(points, 0.5, (3.5, 2.5)))
    assert SIDES.clip((9, 9), 2).tolist() == [2, 1.5]  # the middle, where there is no room
    np.testing.assert_allclose(ROUND.clip((1, 9), 1), (1, 4))


def test_a_world_has_a_container_or_a_period() -> None:
    world = jostle.World([(9, 5)], 1.0, velocities=[(3, 0)], period=(10, 12))
    assert world.period.tolist() == [10, 12] and world.container is None
    world.container = None  # as it was
    world.step(1.0)
    assert world.positions.tolist() == [[2, 5]]
    assert jostle.World.restore(world.snapshot()).period.tolist() == [10, 12]
    for refused in (
        lambda: setattr(world, "container", BOX),
        lambda: jostle.World(container=BOX, period=1),
    ):
        with pytest.raises(ValueError, match="a world has a container or a period, not both"):
            refused()
    world.period = None
    world.container = BOX
    with pytest.raises(ValueError, match="a world has a container or a period, not both"):
        world.period = 5
    world.period = None
    assert world.container == BOX and world.period is None
    with pytest.raises(ValueError, match=r"period is \(0, 1\)"):
        jostle.World(period=(0, 1))
    assert jostle.World(period=7).period.tolist() == [7, 7]
