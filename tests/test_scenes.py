"""`jostle.scenes`: every scene by name, at every size."""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np
import pytest

import jostle
from jostle import scenes

NAMES = ["article", "gas", "pile", "rain", "mixed", "clusters", "shots", "billiards", "orbit"]


def test_the_names() -> None:
    assert scenes.names() == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_a_description_is_two_sentences(name: str) -> None:
    text = scenes.describe(name)
    assert text.count(". ") == 1
    assert text.endswith(".")
    assert "\n" not in text
    assert "  " not in text


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("n", [0, 1, 2, 3, 17, 400])
def test_any_number_of_particles(name: str, n: int) -> None:
    world = scenes.create(name, n=n)
    assert isinstance(world, jostle.World)
    assert len(world) == n
    world.step(1 / 60, steps=3)
    assert np.isfinite(world.positions).all()
    assert np.isfinite(world.velocities).all()


@pytest.mark.parametrize("name", NAMES)
def test_the_seed_decides_the_start(name: str) -> None:
    hashes = [scenes.create(name, 300, seed).state_hash() for seed in (0, 0, 1, 2**63)]
    assert hashes[0] == hashes[1] == scenes.create(name, n=300).state_hash()
    assert len({*hashes}) == 3


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("n", [None, 1, 5000])
def test_the_view_shows_something(name: str, n: int | None) -> None:
    min_x, min_y, max_x, max_y = scenes.view(name, n)
    assert min_x < max_x
    assert min_y < max_y
    world = scenes.create(name, n)
    x, y = world.positions.T
    # Rain and piles begin above what is shown and fall into it.
    assert (x >= min_x).all()
    assert (x <= max_x).all()
    assert (y <= max_y).all()


def test_the_scene_of_the_article() -> None:
    world = scenes.create("article")
    assert len(world) == 500
    assert world.container == jostle.Box(0, 0, 800, 500)
    assert scenes.view("article") == (0, 0, 800, 500)
    radii = world.radii
    assert {*radii.tolist()} == {5, 6, 7, 8, 9, 10}
    densities = world.masses / radii**2
    np.testing.assert_allclose(densities, densities.round())
    assert {*densities.round().tolist()} == {*range(1, 21)}


def test_the_gas_covers_two_fifths_of_its_box() -> None:
    world = scenes.create("gas", n=2000)
    box = world.container
    assert isinstance(box, jostle.Box)
    area = (box.max_x - box.min_x) * (box.max_y - box.min_y)
    assert np.pi * (world.radii.astype(float) ** 2).sum() / area == pytest.approx(0.4, rel=0.01)
    assert world.restitution == 1
    assert world.gravity == (0, 0)


def test_the_other_scenes_have_what_makes_them() -> None:
    assert isinstance(scenes.create("orbit").container, jostle.Circle)
    mixed = scenes.create("mixed").radii
    assert mixed.max() / mixed.min() == pytest.approx(100, rel=0.1)
    assert not scenes.create("shots").movable.all()
    assert scenes.create("pile").gravity[1] == 900
    assert len(scenes.create("billiards")) == 16


NO_SCENE = (
    "name is 'chess'; the scenes are article, gas, pile, rain, mixed, clusters, shots, "
    "billiards, orbit"
)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: scenes.create("chess"), ValueError, NO_SCENE),
        (lambda: scenes.describe("chess"), ValueError, NO_SCENE),
        (lambda: scenes.view("chess"), ValueError, NO_SCENE),
        (lambda: scenes.create("gas", n=-1), ValueError, "n is -1; it must be at least 0"),
        (lambda: scenes.create("gas", n=10**12), ValueError, "n is 1000000000000; a scene holds"),
        (lambda: scenes.view("gas", n=10**12), ValueError, "n is 1000000000000; a scene holds"),
        (lambda: scenes.create("gas", seed=-1), ValueError, "seed is -1; it must be at least 0"),
        (lambda: scenes.create("gas", seed=2**64), ValueError, f"seed is {2**64}; it must be at"),
        (lambda: scenes.create(3), TypeError, "name must be the name of a scene, not int"),
        (lambda: scenes.describe(None), TypeError, "name must be the name of a scene, not None"),
        (lambda: scenes.create("gas", n=1.5), TypeError, "n must be an integer, not float"),
        (lambda: scenes.view("gas", n="all"), TypeError, "n must be an integer, not str"),
        (lambda: scenes.create("gas", seed="x"), TypeError, "seed must be an integer, not str"),
        (lambda: scenes.create("gas", seed=None), TypeError, "seed must be an integer, not None"),
    ],
)
def test_refused(call: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=f"^{message}"):
        call()


def test_signatures() -> None:
    assert str(inspect.signature(scenes.names)) == "()"
    assert str(inspect.signature(scenes.describe)) == "(name)"
    assert str(inspect.signature(scenes.create)) == "(name, n=None, seed=0)"
    assert str(inspect.signature(scenes.view)) == "(name, n=None)"
    assert scenes.create.__name__ == "create"
