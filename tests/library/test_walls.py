"""`World.walls`, `wall_restitution`, `wall_friction` and `polyline`."""

import re
from typing import Any

import numpy as np
import pytest

import jostle


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
    world = jostle.World([(0, 3)], [(0, 0)], 1.0, walls=walls, wall_restitution=[0.5, 1])
    np.testing.assert_array_equal(world.walls, walls)
    assert world.walls.dtype == np.float32 and not world.walls.flags.writeable
    assert world.wall_restitution.tolist() == [0.5, 1]
    assert np.isnan(world.wall_friction).all()
    world.wall_friction = 0.25
    world.walls = [*walls, ((0, 9), (1, 9))]
    assert world.wall_restitution.tolist() == [0.5, 1, 1]
    np.testing.assert_array_equal(world.wall_friction, [0.25, 0.25, np.nan])
    world.wall_friction = None
    world.wall_restitution = 0.5
    assert np.isnan(world.wall_friction).all() and (world.wall_restitution == 0.5).all()
    again = jostle.World.restore(world.snapshot())
    np.testing.assert_array_equal(again.walls, world.walls)
    np.testing.assert_array_equal(again.wall_restitution, world.wall_restitution)
    world.walls = None
    assert world.walls.shape == (0, 2, 2)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"walls": [(0, 0), (1, 0)]}, "walls has shape (2, 2); it must be (m, 2, 2)"),
        ({"walls": [[(0, 0), (0, 0)]]}, "walls[0] is ((0, 0), (0, 0)); its ends must differ"),
        ({"walls": [[(0, 0), (0, np.inf)]]}, "walls[0] is ((0, 0), (0, inf)); its coordinates"),
        ({"walls": [[(0, 0), (0, 1)]], "wall_restitution": 1.5}, "wall_restitution is 1.5; it"),
        ({"walls": [[(0, 0), (0, 1)]], "wall_restitution": [-1]}, "wall_restitution[0] is -1; it"),
        ({"walls": [[(0, 0), (0, 1)]], "wall_friction": -1}, "wall_friction is -1; it must be"),
        (
            {"walls": [[(0, 0), (0, 9.5)]], "container": jostle.Torus(9, 9)},
            "walls[0] is ((0, 0), (0, 9.5)); on a torus a wall may extend over each side once",
        ),
    ],
)
def test_invalid_walls_are_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}"):
        jostle.World([(3, 3)], [(0, 0)], 1.0, **arguments)


def test_a_refused_change_leaves_the_walls() -> None:
    walls = jostle.polyline([(-5, 0), (5, 0)])
    world = jostle.World([(0, 3)], [(0, 0)], 1.0, walls=walls)
    with pytest.raises(ValueError, match="its ends must differ"):
        world.walls = np.zeros((1, 2, 2))
    np.testing.assert_array_equal(world.walls, walls)
