"""Calls with wrong arguments: the error names the call as written, and suggests the right word."""

import inspect
import re
from collections.abc import Callable
from typing import Any

import pytest

import jostle

CLASSES = [
    jostle.Quadtree,
    jostle.Space,
    jostle.World,
    jostle.Box,
    jostle.Circle,
    jostle.Attractor,
    jostle.Gravitation,
    jostle.Flocking,
    jostle.Thermostat,
    jostle.AndersenThermostat,
    jostle.Grab,
    jostle.Motor,
    jostle.Springs,
    jostle.ThermalWalls,
    jostle.PairForce,
    jostle.Pump,
]


def calls() -> dict[str, Callable[..., Any]]:
    """All that take keywords, by the name in errors."""
    found: dict[str, Callable[..., Any]] = {made.__name__: made for made in CLASSES}
    found["find_pairs"], found["separate"] = jostle.find_pairs, jostle.separate
    found["create"] = jostle.scenes.create
    for name in ("particle_life", "lennard_jones", "soft_discs"):
        found[f"PairForce.{name}"] = getattr(jostle.PairForce, name)
    space = jostle.Space()
    tree = jostle.Quadtree([(0, 0)])
    world = jostle.World(walls=[((0, 0), (1, 0))])
    at_points = ("query_rect", "query_circle", "query_point", "query_polygon")
    along_rays = ("nearest", "raycast", "raycast_all", "shape_cast")
    of_all = ("pairs", "contacts", "neighbors")
    methods = {
        space: ("add", "set", "move_and_slide", "update", *of_all, *at_points, *along_rays),
        tree: (*of_all, *at_points, *along_rays),
        world: (
            *("add", "set", "step", "free_positions", "apply_impulse", "angular_momentum"),
            *(*of_all, *at_points, *along_rays),
        ),
        world.walls: ("add", "set", *at_points, *along_rays),
    }
    for owner, names in methods.items():
        for name in names:
            found[f"{type(owner).__name__}.{name}"] = getattr(owner, name)
    return found


def with_required(call: Callable[..., Any], **keywords: Any) -> Any:
    """Call with a value for each argument that must be given, and some keywords."""
    values = {"segments": ((0, 0), (1, 0))}
    needed = [
        one for one in inspect.signature(call).parameters.values() if one.default is one.empty
    ]
    given = {one.name: values.get(one.name, 0) for one in needed}
    return call(**given | keywords)


@pytest.mark.parametrize("name", calls())
def test_a_misspelt_keyword_is_refused_with_the_right_one(name: str) -> None:
    call = calls()[name]
    keywords = [
        one.name
        for one in inspect.signature(call).parameters.values()
        if one.default is not one.empty and len(one.name) > 2
    ]
    for keyword in keywords:
        misspelt = keyword[:2] + "q" + keyword[2:]
        with pytest.raises(TypeError) as caught:
            with_required(call, **{misspelt: 1})
        text = (
            f"{name}() got an unexpected keyword argument '{misspelt}'; did you mean '{keyword}'?"
        )
        assert str(caught.value) == text


@pytest.mark.parametrize("shown", [*calls(), *(made.__name__ for made in CLASSES)])
def test_a_misspelt_argument_that_must_be_given_is_suggested(shown: str) -> None:
    call = calls().get(shown) or getattr(jostle, shown)
    needed = [
        name for name, one in inspect.signature(call).parameters.items() if one.default is one.empty
    ]
    # No short name is near to another one.
    for name in (name for name in needed if len(name) > 2):
        others = {other: 0 for other in needed if other != name}
        with pytest.raises(TypeError, match=rf"^{shown}\(\) is missing the argument '{name}'$"):
            call(**others)
        misspelt = name[:2] + "q" + name[2:]
        hint = f"unexpected keyword argument '{misspelt}'; did you mean '{name}'\\?$"
        with pytest.raises(TypeError, match=rf"^{shown}\(\) got an {hint}"):
            call(**others, **{misspelt: 0})


@pytest.mark.parametrize("name", calls())
def test_a_keyword_that_is_near_to_none_has_no_hint(name: str) -> None:
    call = calls()[name]
    with pytest.raises(TypeError, match=f"^{re.escape(name)}\\(\\) got .* argument 'zzzzzz'$"):
        with_required(call, zzzzzz=1)


@pytest.mark.parametrize("made", CLASSES)
def test_a_constructor_is_named_as_its_class(made: Callable[..., Any]) -> None:
    name = made.__name__
    names = list(inspect.signature(made).parameters)
    with pytest.raises(
        TypeError, match=rf"^{name}\(\) takes at most \d+ positional arguments?, not 40$"
    ):
        made(*range(40))
    first = inspect.signature(made).parameters[names[0]]
    if first.default is first.empty:
        with pytest.raises(TypeError, match=rf"^{name}\(\) is missing the argument '{names[0]}'$"):
            made()
        with pytest.raises(
            TypeError, match=rf"^{name}\(\) got two values for argument '{names[0]}'$"
        ):
            made(0, **{names[0]: 1})


def test_a_number_in_place_of_a_vector_says_what_to_write() -> None:
    with pytest.raises(
        ValueError, match=r"^gravity is 9.8; it must be two numbers, such as \(0, 9.8\)$"
    ):
        jostle.World(gravity=9.8)


@pytest.mark.parametrize(
    ("word", "meant"),
    [("mass", "masses"), ("kind", "kinds"), ("category", "categories"), ("restit", "restitution")],
)
def test_the_beginning_of_a_word_means_this_word(word: str, meant: str) -> None:
    with pytest.raises(TypeError, match=f"'{word}'; did you mean '{meant}'\\?$"):
        jostle.World([(0, 0)], 1.0, **{word: 1})
