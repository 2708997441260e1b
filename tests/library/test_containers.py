"""`jostle.Box`, `jostle.Circle`, `jostle.Torus`: values that describe the region of a world."""

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
TORUS = jostle.Torus(800, 1 / 3)
ALL = [BOX, CIRCLE, TORUS]
finite = st.floats(-1e15, 1e15)
positive = st.floats(1e-15, 1e15)


def test_attributes_are_the_arguments() -> None:
    assert (BOX.min_x, BOX.min_y, BOX.max_x, BOX.max_y) == (-1, 0.1, 800, 500)
    assert (CIRCLE.center, CIRCLE.radius) == ((400, 250), 240.5)
    assert (TORUS.width, TORUS.height) == pytest.approx((800, 1 / 3))
    assert jostle.Box(min_x=0, min_y=1, max_x=2, max_y=3) == jostle.Box(0, 1, 2, 3)
    assert jostle.Circle(center=np.array([1, 2]), radius=np.float32(3)).center == (1, 2)
    assert jostle.Torus(width=1, height=2).height == 2


def test_representations() -> None:
    assert repr(BOX) == "Box(-1.0, 0.1, 800.0, 500.0)"
    assert repr(CIRCLE) == "Circle((400.0, 250.0), 240.5)"
    assert repr(TORUS) == "Torus(800.0, 0.33333334)"


@given(finite, finite, positive, positive)
def test_a_representation_evaluates_to_the_same(x: float, y: float, w: float, h: float) -> None:
    made: list[Any] = [jostle.Torus(w, h), jostle.Circle((x, y), w)]
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
        assert len({container, same, *ALL}) == 3
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


def test_pattern_matching() -> None:
    match BOX:
        case jostle.Box(min_x, _, max_x, _):
            assert (min_x, max_x) == (-1, 800)
    match CIRCLE:
        case jostle.Circle((x, _), radius):
            assert (x, radius) == (400, 240.5)


@pytest.mark.parametrize("container", ALL, ids=repr)
def test_a_world_gives_back_what_it_was_given(container: Any) -> None:
    world = jostle.World([], [], velocities=[], container=container)
    assert world.container == container
    assert type(world.container) is type(container)


NAN, INF = np.nan, np.inf
BOX_RULE = "its corners must be finite and min below max"
CIRCLE_RULE = "its centre must be finite and its radius finite and above 0"
TORUS_RULE = "its sides must be finite and above 0"


WRONG = {
    ValueError: [
        (jostle.Box, (1, 0, 0, 1), f"container is Box(1, 0, 0, 1); {BOX_RULE}"),
        (jostle.Box, (0, 1, 1, 1), f"container is Box(0, 1, 1, 1); {BOX_RULE}"),
        (jostle.Box, (NAN, 0, 1, 1), f"container is Box(NaN, 0, 1, 1); {BOX_RULE}"),
        (jostle.Box, (0, 0, INF, 1), f"container is Box(0, 0, inf, 1); {BOX_RULE}"),
        (jostle.Box, (2**24, 0, 2**24 + 1, 1), "container is Box(16777216, 0, 16777216, 1)"),
        (jostle.Circle, ((0, 0), 0), f"container is Circle((0, 0), 0); {CIRCLE_RULE}"),
        (jostle.Circle, ((0, 0), -1), f"container is Circle((0, 0), -1); {CIRCLE_RULE}"),
        (jostle.Circle, ((0, NAN), 1), f"container is Circle((0, NaN), 1); {CIRCLE_RULE}"),
        (jostle.Circle, ((0, 0), INF), f"container is Circle((0, 0), inf); {CIRCLE_RULE}"),
        (jostle.Circle, (0, 1), "center has shape (); it must be (2,)"),
        (jostle.Circle, ((1, 2, 3), 1), "center has shape (3,); it must be (2,)"),
        (jostle.Torus, (0, 1), f"container is Torus(0, 1); {TORUS_RULE}"),
        (jostle.Torus, (1, -1), f"container is Torus(1, -1); {TORUS_RULE}"),
        (jostle.Torus, (INF, 1), f"container is Torus(inf, 1); {TORUS_RULE}"),
    ],
    TypeError: [
        (jostle.Box, ("0", 0, 1, 1), "min_x must be a number, not str"),
        (jostle.Box, (0, 0, 1, None), "max_y must be a number, not NoneType"),
        (jostle.Circle, ("ab", 1), "center must hold real numbers, not str"),
        (jostle.Circle, ((0, 0), [1]), "radius must be a number, not list"),
        (jostle.Torus, (True, 1), "width must be a number, not bool"),
        (jostle.Torus, (1, 1j), "height must be a number, not complex"),
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
