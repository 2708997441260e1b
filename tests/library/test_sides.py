"""`World.container_restitution`."""

import re
from typing import Any

import numpy as np
import pytest

import jostle

BOX, CIRCLE = jostle.Box(0, 0, 10, 10), jostle.Circle((5, 5), 5)


def test_each_side_has_the_number_of_its_wall() -> None:
    """Four discs fly to the four sides; the impulses say with which coefficient."""
    world = jostle.World(
        [(5, 5)] * 4,
        [(-5, 0), (5, 0), (0, -5), (0, 5)],
        1.0,
        masks=0,
        container=BOX,
        container_restitution=[0.5, 0.25, 0.75, 0],
    )
    world.step(1.0)
    assert world.wall_contacts.walls.tolist() == [0, 1, 2, 3]
    np.testing.assert_allclose(world.wall_contacts.normal_impulses, [7.5, 6.25, 8.75, 5])
    np.testing.assert_allclose(world.velocities, [(2.5, 0), (-1.25, 0), (0, 3.75), (0, 0)])


def test_it_is_a_setting() -> None:
    world = jostle.World([(5, 5)], [(1, 0)], 1.0, container=BOX)
    assert world.container_restitution.tolist() == [1, 1, 1, 1]
    world.container_restitution = [1, 0.5, 0.25, 0]
    again = jostle.World.restore(world.snapshot())
    assert again.container_restitution.tolist() == [1, 0.5, 0.25, 0]
    assert again.container_restitution.dtype == np.float32
    again.container_restitution = 0.5
    again.container = CIRCLE
    again.step(1.0, steps=25)
    assert again.velocities[0, 0] == pytest.approx(0.25)


@pytest.mark.parametrize(
    ("container", "value", "message"),
    [
        (BOX, 2, "container_restitution is 2; it must lie between 0 and 1"),
        (BOX, [1, 1, np.nan, 1], "container_restitution[2] is NaN; it must lie between 0 and 1"),
        (BOX, [1, 1], "container_restitution has shape (2,); it must be"),
        (CIRCLE, [1, 1, 0, 1], "container_restitution[2] is 0; a circle has one wall"),
    ],
)
def test_wrong_ones_are_refused(container: Any, value: Any, message: str) -> None:
    start = f"^{re.escape(message)}"
    with pytest.raises(ValueError, match=start):
        jostle.World([(5, 5)], [(1, 0)], 1.0, container=container, container_restitution=value)
    world = jostle.World([(5, 5)], [(1, 0)], 1.0, container=container)
    with pytest.raises(ValueError, match=start):
        world.container_restitution = value
    assert world.container_restitution.tolist() == [1, 1, 1, 1]
