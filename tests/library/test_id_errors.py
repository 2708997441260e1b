"""`IdError`: each call that takes ids raises it for a missing id, and for nothing else."""

import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import jostle

SEGMENTS = [((0, -9), (9, -9)), ((9, -9), (9, 9)), ((0, 9), (9, 9))]


def space() -> jostle.Space:
    shapes = jostle.Space()
    shapes.add([(0, 0), (5, 0), (9, 0)], radii=1.0)
    shapes.remove(1)
    return shapes


def world() -> jostle.World:
    particles = jostle.World([(0, 0), (5, 0), (9, 0)], 1.0, walls=SEGMENTS)
    particles.remove(1)
    particles.walls.remove(1)
    return particles


#: A function that makes what has ids, and the call with some ids.
CALLS: dict[str, tuple[Callable[[], Any], Callable[[Any, Any], object]]] = {
    "Space.get": (space, lambda space, ids: space.get(ids)),
    "Space.rows": (space, lambda space, ids: space.rows(ids)),
    "Space.set": (space, lambda space, ids: space.set(ids, radii=2.0)),
    "Space.remove": (space, lambda space, ids: space.remove(ids)),
    "Space.move_and_slide": (
        space,
        lambda space, ids: space.move_and_slide(ids, np.ones((*np.shape(ids), 2))),
    ),
    "World.get": (world, lambda world, ids: world.get(ids)),
    "World.rows": (world, lambda world, ids: world.rows(ids)),
    "World.set": (world, lambda world, ids: world.set(ids, radii=2.0)),
    "World.remove": (world, lambda world, ids: world.remove(ids)),
    "Walls.get": (world, lambda world, ids: world.walls.get(ids)),
    "Walls.rows": (world, lambda world, ids: world.walls.rows(ids)),
    "Walls.set": (world, lambda world, ids: world.walls.set(ids, friction=0.5)),
    "Walls.remove": (world, lambda world, ids: world.walls.remove(ids)),
}


@pytest.mark.parametrize("name", CALLS)
@pytest.mark.parametrize(
    ("ids", "start"),
    [
        (1, "ids is 1; "),
        (7, "ids is 7; "),
        (-1, "ids is -1; "),
        (2**70, f"ids is {2**70}; "),
        ([0, 1], "ids[1] is 1; "),
        ([0, 2, 7], "ids[2] is 7; "),
        (np.array([0, 2**63], np.uint64), f"ids[1] is {2**63}; "),
    ],
)
def test_a_missing_id_is_an_id_error_with_a_plain_sentence(name: str, ids: Any, start: str) -> None:
    make, call = CALLS[name]
    owner = make()
    before = pickle.dumps(owner)
    with pytest.raises(jostle.IdError) as caught:
        call(owner, ids)
    text = str(caught.value)
    assert text.startswith(start) and "'" not in text and '"' not in text
    assert pickle.dumps(owner) == before


@pytest.mark.parametrize("kind", [KeyError, ValueError])
def test_an_id_error_is_caught_as_a_key_error_and_as_a_value_error(kind: type[Exception]) -> None:
    for make, call in CALLS.values():
        with pytest.raises(kind):
            call(make(), 1)


@pytest.mark.parametrize(
    "name", [name for name in CALLS if name.endswith(("set", "remove", "slide"))]
)
def test_an_id_given_twice_is_no_id_error(name: str) -> None:
    make, call = CALLS[name]
    with pytest.raises(ValueError, match="given twice") as caught:
        call(make(), [0, 0])
    assert not isinstance(caught.value, jostle.IdError)


@pytest.mark.parametrize("name", CALLS)
def test_what_is_no_integer_is_a_type_error(name: str) -> None:
    make, call = CALLS[name]
    with pytest.raises(TypeError):
        call(make(), 0.5)


@pytest.mark.parametrize(
    ("force", "text"),
    [
        (
            lambda: jostle.Attractor(particle=1, strength=1.0),
            "forces[0] is a force on particle 1; no",
        ),
        (
            lambda: jostle.ThermalWalls(1.0, walls=[1]),
            "forces[0] is ThermalWalls of wall 1; no wall",
        ),
    ],
)
def test_forces_on_what_is_missing_are_id_errors(force: Callable[[], Any], text: str) -> None:
    changed = world()
    with pytest.raises(jostle.IdError) as caught:
        changed.forces = [force()]
    assert str(caught.value).startswith(text) and changed.forces == ()


def test_an_id_error_is_pickled() -> None:
    error = pickle.loads(pickle.dumps(jostle.IdError("ids is 3; no shape has this id")))
    assert type(error) is jostle.IdError and str(error) == "ids is 3; no shape has this id"
