"""Walls of a new world, `polyline` and the sides of containers."""

import re
from typing import Any

import numpy as np
import pytest

import jostle

BOX = jostle.Box(0, 0, 10, 10)
ONE: dict[str, Any] = {"segments": [[(0, 0), (0, 1)]]}


def test_a_polyline_is_closed_by_keyword() -> None:
    with pytest.raises(TypeError, match="1 positional argument but 2 were given"):
        jostle.polyline([(0, 0), (1, 0)], True)  # type: ignore[misc]


def test_polyline_joins_points() -> None:
    points = [(0, 0), (4, 0), (4, 0), (4, 3)]
    assert jostle.polyline(points).tolist() == [[[0, 0], [4, 0]], [[4, 0], [4, 3]]]
    assert jostle.polyline(points, closed=True)[-1].tolist() == [[4, 3], [0, 0]]
    assert jostle.polyline([]).shape == jostle.polyline([(1, 2)], closed=True).shape == (0, 2, 2)
    assert jostle.polyline([(0, 0.7), (4, 0.7)]).dtype == np.float64
    assert jostle.polyline(np.asarray(points, np.float32)).dtype == np.float32
    with pytest.raises(ValueError, match=re.escape("points has shape (3,); it must be (n, 2)")):
        jostle.polyline([1, 2, 3])
    with pytest.raises(ValueError, match=re.escape("points[1] is (nan, 0.0); both")):
        jostle.polyline([(0, 0), (np.nan, 0)])


def test_walls_are_a_column() -> None:
    walls = jostle.polyline([(-5, 0), (0, 0), (5, 0)])
    columns = {"segments": walls, "restitution": [0.5, 1], "velocities": (0, 1)}
    world = jostle.World([(0, 3)], 1.0, walls=columns)
    np.testing.assert_array_equal(world.walls.segments, walls)
    assert world.walls.segments.dtype == np.float32
    assert not world.walls.segments.flags.writeable
    assert world.walls.restitution.tolist() == [0.5, 1]
    assert world.walls.velocities.tolist() == [[0, 1], [0, 1]]
    assert np.isnan(world.walls.friction).all()
    world.walls.friction = 0.25
    world.walls.add(((0, 9), (1, 9)))
    np.testing.assert_array_equal(world.walls.restitution, [0.5, 1, np.nan])
    np.testing.assert_array_equal(world.walls.friction, [0.25, 0.25, np.nan])
    world.walls.friction = None
    world.walls.restitution = 0.5
    assert np.isnan(world.walls.friction).all() and (world.walls.restitution == 0.5).all()
    copied = jostle.World(walls=world.walls.get(world.walls.ids).to_dict())
    assert copied.walls.get([0, 1, 2]) == world.walls.get([0, 1, 2])
    world.walls.remove(world.walls.ids)
    assert world.walls.segments.shape == (0, 2, 2)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"walls": [(0, 0), (1, 0)]}, "walls has shape (2, 2); it must be (m, 2, 2)"),
        ({"walls": [[(0, 0), (0, 0)]]}, "walls[0] is ((0, 0), (0, 0)); its ends must differ"),
        ({"walls": [[(0, 0), (0, np.inf)]]}, "walls[0] is ((0, 0), (0, inf)); its coordinates"),
        ({"walls": {**ONE, "restitution": 1.5}}, "walls['restitution'][0] is 1.5; it"),
        ({"walls": {**ONE, "restitution": [-1]}}, "walls['restitution'][0] is -1; it"),
        ({"walls": {**ONE, "friction": -1}}, "walls['friction'][0] is -1; it must be"),
        ({"walls": {**ONE, "velocities": [(0, np.nan)]}}, "walls['velocities'][0] is (0, NaN)"),
        ({"walls": {**ONE, "velocities": 3}}, "walls['velocities'] has shape ()"),
        ({"walls": {"segments": [(0, 0)]}}, "walls['segments'] has shape (1, 2)"),
        ({"walls": {"segments": [[(1, 2)] * 2]}}, "walls['segments'][0] is ((1, 2), (1, 2))"),
        (
            {"walls": [[(0, 0), (0, 9.5)]], "period": 9},
            "walls[0] is ((0, 0), (0, 9.5)); in a periodic world a wall may extend over each side",
        ),
    ],
)
def test_invalid_walls_are_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}"):
        jostle.World([(3, 3)], 1.0, **arguments)


def test_a_refused_change_leaves_the_walls() -> None:
    walls = jostle.polyline([(-5, 0), (5, 0)])
    world = jostle.World([(0, 3)], 1.0, walls=walls)
    with pytest.raises(ValueError, match="its ends must differ"):
        world.walls.segments = np.zeros((1, 2, 2))
    np.testing.assert_array_equal(world.walls.segments, walls)
    with pytest.raises(AttributeError, match="walls"):
        world.walls = walls  # type: ignore[misc, assignment]
    for columns, text in (({"friction": 1}, "no 'segments'"), ({**ONE, "masses": 1}, "'masks'")):
        with pytest.raises(TypeError, match=text):
            jostle.World(walls=columns)


def test_each_side_of_a_container_has_a_number_and_a_restitution() -> None:
    """Four discs fly to the four sides; the impulses say with which coefficient."""
    world = jostle.World(
        [(5, 5)] * 4,
        1.0,
        velocities=[(-5, 0), (5, 0), (0, -5), (0, 5)],
        masks=0,
        container=jostle.Box(0, 0, 10, 10, restitution=[0.25, 0.0625, 0.5625, 0]),
    )
    world.step(1.0)
    assert world.last_step.wall_contacts.walls.tolist() == [-2, -3, -4, -5]
    np.testing.assert_allclose(world.last_step.wall_contacts.normal_impulses, [7.5, 6.25, 8.75, 5])
    np.testing.assert_allclose(world.velocities, [(2.5, 0), (-1.25, 0), (0, 3.75), (0, 0)])


def test_the_coefficients_of_sides_belong_to_the_container() -> None:
    world = jostle.World([(5, 5)], 1.0, velocities=[(1, 0)], container=BOX)
    world.container = jostle.Circle((5, 5), 5, restitution=0.25)
    world.step(1.0, steps=25)
    assert world.velocities[0, 0] == pytest.approx(0.25)


@pytest.mark.parametrize(("own", "of_side", "expected"), [(0.5, 0.32, 0.4), (0.5, None, 0.5)])
def test_friction_of_a_side_is_the_mean_of_both(own: float, of_side: Any, expected: float) -> None:
    """A disc that slides without rolling loses μ g t, as long as it slides."""
    floor = jostle.Box(-99, 0, 99, 99, friction=of_side)
    world = jostle.World(
        [(0, 1)], 1.0, velocities=[(30, 0)], gravity=(0, -10), restitution=0, friction=own,
        container=floor,
    )  # fmt: skip
    world.step(1 / 60, steps=30)
    np.testing.assert_allclose(world.velocities[0, 0], 30 - expected * 10 * 0.5, rtol=1e-5)
