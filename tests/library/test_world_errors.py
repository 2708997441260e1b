"""Arguments that `jostle.World` refuses, with the messages; nothing changes."""

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from worlds import SETTINGS, three

import jostle

Act = Callable[[Any], Any]


def setting(name: str, value: object) -> Act:
    """Return the assignment of an attribute of a world."""
    return lambda world: setattr(world, name, value)


NOTHING_CHANGED: dict[type[Exception], list[tuple[Act, str]]] = {
    ValueError: [
        (lambda w: w.step(0), "dt is 0; it must be finite and above 0"),
        (lambda w: w.step(-0.1), "dt is -0.1; it must be finite and above 0"),
        (lambda w: w.step(1e-300), "dt is 1e-300; it must be finite and above 0 in float32"),
        (lambda w: w.step(-1.5e300), "dt is -1.5e300; it must be finite and above 0"),
        (lambda w: w.step(np.nan, 0), "dt is NaN; it must be finite and above 0"),
        (lambda w: w.step(0.1, -1), "steps is -1; it must be at least 0"),
        (lambda w: w.add((0, np.nan), 1), "positions is (0, NaN); both"),
        (
            lambda w: w.add((0, 1), 1, velocities=[(0, 0)]),
            "velocities has shape (1, 2); it must be (2",
        ),
        (
            lambda w: w.add([(0, 1)], 1, velocities=[0] * 3),
            "velocities has shape (3,); it must be (2,) or (1",
        ),
        (lambda w: w.add((0, 1, 2), 1), "positions has shape (3,); it must be (2,)"),
        (lambda w: w.add((0, 1), [1, 2]), "radii has shape (2,); it must be a num"),
        (lambda w: w.add((0, 1), -1), "radii is -1; a radius must be finite"),
        (lambda w: w.add((0, 1), 0), "radii is 0; its mass, the square of the"),
        (lambda w: w.remove([3]), "ids[0] is 3; no particle has this id; ids are below 3"),
        (lambda w: w.remove([0, 1, 0]), "ids[2] is 0; it is given twice"),
        (lambda w: w.remove([0, -1]), "ids[1] is -1; no particle has this id"),
        (lambda w: w.remove(-1), "ids is -1; no particle has this id"),
        (lambda w: w.remove(3), "ids is 3; no particle has this id; ids are below 3"),
        (lambda w: w.remove(2**70), "ids is 1180591620717411303424; no particle has"),
        (lambda w: w.remove([[0, 1]]), "ids has shape (1, 2); it must be an integer or"),
        (lambda w: w.set(1, positions=[(1, 2)]), "positions has shape (1, 2); it must be"),
        (lambda w: w.set(1, velocities=(0, np.nan)), "velocities is (0, NaN); both"),
        (lambda w: w.set([1, 7], radii=1), "ids[1] is 7; no particle has this id"),
        (lambda w: w.set([1, 1], radii=1), "ids[1] is 1; it is given twice"),
        (lambda w: w.set([1], radii=[1, 2]), "radii has shape (2,); it must be a number"),
        (lambda w: w.set([1], positions=(1, 2)), "positions has shape (2,); it must be (1"),
        (lambda w: w.set([1, 0], radii=[1, -2]), "radii[1] is -2; a radius must be finite"),
        (lambda w: w.set([1], radii=np.inf), "radii is inf; a radius must be finite"),
        (lambda w: w.set([1], velocities=[(0, np.nan)]), "velocities[0] is (0, NaN); both"),
        (lambda w: w.set([1], masses=-1), "masses is -1; a mass must lie between"),
        (
            lambda w: w.set([1], radii=1, restitution=2),
            "restitution is 2; a restitution must lie between 0 and 1",
        ),
        (lambda w: w.set(1, friction=-1), "friction is -1; a coefficient of friction must"),
        (
            lambda w: w.set([1, 0], friction=[1, np.inf]),
            "friction[1] is inf; a coefficient of friction must be finite and at least 0",
        ),
        (setting("angles", np.nan), "angles is NaN; an angle must be finite"),
        (
            setting("angular_velocities", [0, 1e30, 0]),
            "angular_velocities[1] is 1e30; an angular velocity must be finite and lie within",
        ),
        (lambda w: w.add([(1, 1)], -1), "radii is -1; a radius must be finite"),
        (lambda w: w.add([(1, 1)], 0), "radii[0] is 0; its mass, the square of"),
        (
            lambda w: w.add([(1, 1)], 1, velocities=[]),
            "velocities has shape (0,); it must be (2,) or (1, 2)",
        ),
        (lambda w: w.add([(0, 1e30)], 1), "positions[0] is (0"),
        (setting("positions", [(0, 0)]), "positions has shape (1, 2); it must"),
        (setting("radii", [1, 2, -3]), "radii[2] is -3; a radius must be"),
        (setting("gravity", 9.81), "gravity is 9.81; it must be two numbers, such as (0, 9.81)"),
        (setting("gravity", (0, np.inf)), "gravity is (0, inf); both"),
        (setting("drag", -1), "drag is -1; it must be finite and at least 0"),
        (setting("restitution", 1.5), "restitution is 1.5; a restitution must lie"),
        (setting("method", "auto"), "method is 'auto'; it must be 'quadtree'"),
        (setting("on_touch", "stick"), "on_touch is 'stick'; it must be 'bo"),
        (setting("threads", 0), "threads is 0; it must be at least 1"),
        (setting("leaf_capacity", 0), "leaf_capacity is 0; it must be at"),
        (setting("max_depth", -1), "max_depth is -1; it must be at least 0"),
        (setting("substeps", 0), "substeps is 0; it must be at least 1"),
        (setting("substeps", 9999), "substeps is 9999; it must lie between"),
        (
            setting("container", jostle.Box(0, 0, 4, 4)),
            "radii[2] is 3; it must fit between the walls (at most 2)",
        ),
    ],
    TypeError: [
        (lambda w: w.step("1"), "dt must be a number, not str"),
        (lambda w: w.step(0.1, 1.5), "steps must be an integer, not float"),
        (lambda w: w.add((0, 1)), "World.add() is missing the argument 'radii'"),
        (
            lambda w: w.add((0, 1), 1, restitutions=1),
            "World.add() got an unexpected keyword argument 'restitutions'; did you mean 'rest",
        ),
        (
            lambda w: w.set(0, densities=1),
            "World.set() got an unexpected keyword argument 'densities'",
        ),
        (lambda w: w.remove(True), "ids must hold integers, not bool"),
        (lambda w: w.remove(1.0), "ids must hold integers, not float"),
        (lambda w: w.remove([0.5]), "ids must hold integers, not float64"),
        (lambda w: w.remove([True, False, True]), "ids must hold integers, not bool"),
        (lambda w: w.set([1], movable=[1]), "movable must hold booleans, not int64"),
        (setting("radii", None), "radii must hold real numbers, not NoneType"),
        (setting("movable", [1, 0, 1]), "movable must hold booleans, not int"),
        (setting("drag", None), "drag must be a number, not NoneType"),
        (setting("method", None), "method must be 'quadtree' or 'brute', not"),
        (setting("on_touch", 1), "on_touch must be 'bounce', 'merge' or 'ign"),
        (
            setting("container", "box"),
            "container must be a jostle.Box, jostle.Circle or None, not str",
        ),
    ],
    AttributeError: [
        (setting("time", 1), "attribute 'time' of 'jostle.World'"),
        (setting("own", 1), "'jostle.World' object has no attribute"),
    ],
}


@pytest.mark.parametrize(
    ("error", "act", "message"),
    [(error, *case) for error, cases in NOTHING_CHANGED.items() for case in cases],
)
def test_refused_and_nothing_changed(error: type[Exception], act: Act, message: str) -> None:
    world = three(container=jostle.Box(-100, -100, 100, 100))
    world.step(0.01)
    names = [*SETTINGS, "gravity"]
    state, settings = world.state_hash(), {name: str(getattr(world, name)) for name in names}
    with pytest.raises(error, match=f"^{re.escape(message)}"):
        act(world)
    assert len(world) == 3
    assert world.state_hash() == state
    assert {name: str(getattr(world, name)) for name in names} == settings
    assert world.time == 0.01


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (
            {"positions": np.zeros((3, 3))},
            ValueError,
            "positions has shape (3, 3); it must be (2,)",
        ),
        ({"positions": [(0, 0)]}, ValueError, "velocities has shape (3, 2); it must be (2,) or (1"),
        (
            {"velocities": [0] * 3},
            ValueError,
            "velocities has shape (3,); it must be (2,) or (3, 2)",
        ),
        ({"radii": [1, 2]}, ValueError, "radii has shape (2,); it must be a number or (3,)"),
        ({"masses": [1]}, ValueError, "masses has shape (1,); it must be a number or (3,)"),
        ({"movable": [True]}, ValueError, "movable has shape (1,); it must be True or False or"),
        ({"restitution": [1]}, ValueError, "restitution has shape (1,); it must be a number or"),
        ({"restitution": [1, 1, -1]}, ValueError, "restitution[2] is -1; a restitution must"),
        ({"friction": [1]}, ValueError, "friction has shape (1,); it must be a number or (3,)"),
        ({"friction": [1, 1, -1]}, ValueError, "friction[2] is -1; a coefficient of friction"),
        ({"friction": "much"}, TypeError, "friction must hold real numbers, not str"),
        ({"angular_velocities": [0, np.inf, 0]}, ValueError, "angular_velocities[1] is inf; an"),
        ({"restitution": -1}, ValueError, "restitution is -1; a restitution must lie between 0"),
        ({"positions": [(0, 0), (np.inf, 0), (1, 1)]}, ValueError, "positions[1] is (inf, 0)"),
        ({"velocities": [(0, 0), (0, 0), (1, np.nan)]}, ValueError, "velocities[2] is (1, NaN)"),
        ({"radii": [1, -1, 1]}, ValueError, "radii[1] is -1; a radius must be finite and at"),
        ({"masses": [1, 2, 0]}, ValueError, "masses[2] is 0; a mass must lie between"),
        ({"container": jostle.Circle((0, 0), 2.5)}, ValueError, "radii[2] is 3; it must fit into"),
        ({"period": 9}, ValueError, "radii[2] is 3; it may be at most a quarter of the shorter"),
        ({"method": "tree"}, ValueError, "method is 'tree'; it must be 'quadtree' or 'brute'"),
        ({"positions": "here"}, TypeError, "positions must hold real numbers, not str"),
        ({"radii": True}, TypeError, "radii must hold real numbers, not bool"),
        ({"masses": [1j, 2, 3]}, TypeError, "masses must hold real numbers, not complex128"),
        ({"movable": [0, 1, 1]}, TypeError, "movable must hold booleans, not int64"),
        ({"gravity": None}, TypeError, "gravity must hold real numbers, not NoneType"),
        ({"drag": "much"}, TypeError, "drag must be a number, not str"),
        ({"substeps": 1.5}, TypeError, "substeps must be an integer, not float"),
    ],
)
def test_a_wrong_world(arguments: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=f"^{re.escape(message)}"):
        three(**arguments)
