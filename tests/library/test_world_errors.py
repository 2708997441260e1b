"""Arguments that `jostle.World` refuses, with the messages; nothing changes."""

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from worlds import SETTINGS, three

import jostle

NOTHING_CHANGED: list[tuple[Callable[[Any], Any], type[Exception], str]] = [
    (lambda w: w.step(0), ValueError, "dt is 0; it must be finite and above 0"),
    (lambda w: w.step(-0.1), ValueError, "dt is -0.1; it must be finite and above 0"),
    (lambda w: w.step(1e-300), ValueError,
     "dt is 1e-300; it must be finite and above 0 in float32"),
    (lambda w: w.step(-1.5e300), ValueError, "dt is -1.5e300; it must be finite and above 0"),
    (lambda w: w.step(np.nan, 0), ValueError, "dt is NaN; it must be finite and above 0"),
    (lambda w: w.step("1"), TypeError, "dt must be a number, not str"),
    (lambda w: w.step(0.1, -1), ValueError, "steps is -1; it must be at least 0"),
    (lambda w: w.step(0.1, 1.5), TypeError, "steps must be an integer, not float"),
    (lambda w: w.add((0, np.nan), (0, 0), 1), ValueError, "positions is (0, NaN); both"),
    (lambda w: w.add((0, 1), [(0, 0)], 1), ValueError,
     "velocities has shape (1, 2); it must be (2"),
    (lambda w: w.add([(0, 1)], (0, 0), 1), ValueError, "velocities has shape (2,); it must be (1"),
    (lambda w: w.add((0, 1, 2), (0, 0), 1), ValueError,
     "positions has shape (3,); it must be (2,)"),
    (lambda w: w.add((0, 1), (0, 0), [1, 2]), ValueError, "radii has shape (2,); it must be a num"),
    (lambda w: w.add((0, 1), (0, 0), -1), ValueError, "radii is -1; a radius must be finite"),
    (lambda w: w.add((0, 1), (0, 0), 0), ValueError, "radii is 0; its mass, density times radius"),
    (lambda w: w.add((0, 1), (0, 0)), TypeError, "add needs radii: no number was given for all"),
    (lambda w: w.remove([3]), ValueError, "ids[0] is 3; no particle has this id; ids are below 3"),
    (lambda w: w.remove([0, 1, 0]), ValueError, "ids[2] is 0; it is given twice"),
    (lambda w: w.remove([0, -1]), ValueError, "ids[1] is -1; no particle has this id"),
    (lambda w: w.remove(-1), ValueError, "ids is -1; no particle has this id"),
    (lambda w: w.remove(3), ValueError, "ids is 3; no particle has this id; ids are below 3"),
    (lambda w: w.remove(2**70), ValueError, "ids is 1180591620717411303424; no particle has"),
    (lambda w: w.remove(True), TypeError, "ids must hold integers, not bool"),
    (lambda w: w.remove(1.0), TypeError, "ids must hold integers, not float"),
    (lambda w: w.remove([[0, 1]]), ValueError, "ids has shape (1, 2); it must be an integer or"),
    (lambda w: w.set(1, positions=[(1, 2)]), ValueError, "positions has shape (1, 2); it must be"),
    (lambda w: w.set(1, velocities=(0, np.nan)), ValueError, "velocities is (0, NaN); both"),
    (lambda w: w.remove([0.5]), TypeError, "ids must hold integers, not float64"),
    (lambda w: w.remove([True, False, True]), TypeError, "ids must hold integers, not bool"),
    (lambda w: w.set([1, 7], radii=1), ValueError, "ids[1] is 7; no particle has this id"),
    (lambda w: w.set([1, 1], radii=1), ValueError, "ids[1] is 1; it is given twice"),
    (lambda w: w.set([1], radii=[1, 2]), ValueError, "radii has shape (2,); it must be a number"),
    (lambda w: w.set([1], positions=(1, 2)), ValueError, "positions has shape (2,); it must be (1"),
    (lambda w: w.set([1, 0], radii=[1, -2]), ValueError, "radii[1] is -2; a radius must be finite"),
    (lambda w: w.set([1], radii=np.inf), ValueError, "radii is inf; a radius must be finite"),
    (lambda w: w.set([1], velocities=[(0, np.nan)]), ValueError, "velocities[0] is (0, NaN); both"),
    (lambda w: w.set([1], movable=[1]), TypeError, "movable must hold booleans, not int64"),
    (lambda w: w.set([1], masses=-1), ValueError, "masses is -1; a mass must lie between"),
    (lambda w: w.set([1], radii=1, restitutions=2), ValueError,
     "restitutions is 2; a restitution must lie between 0 and 1"),
    (lambda w: w.set(1, friction=-1), ValueError, "friction is -1; a coefficient of friction must"),
    (lambda w: w.set([1, 0], friction=[1, np.inf]), ValueError,
     "friction[1] is inf; a coefficient of friction must be finite and at least 0"),
    (lambda w: setattr(w, "angles", np.nan), ValueError, "angles is NaN; an angle must be finite"),
    (lambda w: setattr(w, "angular_velocities", [0, 1e30, 0]), ValueError,
     "angular_velocities[1] is 1e30; an angular velocity must be finite and lie within ±1e18"),
    (lambda w: w.add([(1, 1)], [(0, 0)], -1), ValueError, "radii is -1; a radius must be finite"),
    (lambda w: w.add([(1, 1)], [(0, 0)], 0), ValueError, "radii[0] is 0; its mass, density times"),
    (lambda w: w.add([(1, 1)], [], 1), ValueError, "velocities has shape (0,); it must be (1, 2)"),
    (lambda w: w.add([(1, 1)], [(0, 0)], 1, densities=0), ValueError,
     "densities is 0; a density must be finite and above 0"),
    (lambda w: w.add([(1, 1)] * 2, [(0, 0)] * 2, 1, densities=[1, np.nan]), ValueError,
     "densities[1] is NaN; a density must be finite and above 0"),
    (lambda w: w.add([(0, 1e30)], [(0, 0)], 1), ValueError, "positions[0] is (0"),
    (lambda w: setattr(w, "positions", [(0, 0)]), ValueError,
     "positions has shape (1, 2); it must"),
    (lambda w: setattr(w, "radii", [1, 2, -3]), ValueError, "radii[2] is -3; a radius must be"),
    (lambda w: setattr(w, "radii", None), TypeError, "radii must hold real numbers, not NoneType"),
    (lambda w: setattr(w, "movable", [1, 0, 1]), TypeError, "movable must hold booleans, not int"),
    (lambda w: setattr(w, "gravity", 9.81), ValueError, "gravity has shape (); it must be (2,)"),
    (lambda w: setattr(w, "gravity", (0, np.inf)), ValueError, "gravity is (0, inf); both"),
    (lambda w: setattr(w, "drag", -1), ValueError, "drag is -1; it must be finite and at least 0"),
    (lambda w: setattr(w, "drag", None), TypeError, "drag must be a number, not NoneType"),
    (lambda w: setattr(w, "restitution", 1.5), ValueError, "restitution is 1.5; it must lie"),
    (lambda w: setattr(w, "restitution", [1] * 3), TypeError, "restitution must be a number, not"),
    (lambda w: setattr(w, "method", "auto"), ValueError, "method is 'auto'; it must be 'quadtree'"),
    (lambda w: setattr(w, "method", None), TypeError, "method must be 'quadtree' or 'brute', not"),
    (lambda w: setattr(w, "on_touch", "stick"), ValueError, "on_touch is 'stick'; it must be 'bo"),
    (lambda w: setattr(w, "on_touch", 1), TypeError, "on_touch must be 'bounce', 'merge' or 'ign"),
    (lambda w: setattr(w, "threads", 0), ValueError, "threads is 0; it must be at least 1"),
    (lambda w: setattr(w, "leaf_capacity", 0), ValueError, "leaf_capacity is 0; it must be at"),
    (lambda w: setattr(w, "max_depth", -1), ValueError, "max_depth is -1; it must be at least 0"),
    (lambda w: setattr(w, "substeps", 0), ValueError, "substeps is 0; it must be at least 1"),
    (lambda w: setattr(w, "substeps", 9999), ValueError, "substeps is 9999; it must lie between"),
    (lambda w: setattr(w, "container", "box"), TypeError,
     "container must be a jostle.Box, jostle.Circle, jostle.Torus or None, not str"),
    (lambda w: setattr(w, "container", jostle.Box(0, 0, 4, 4)), ValueError,
     "radii[2] is 3; it must fit between the walls (at most 2)"),
    (lambda w: setattr(w, "time", 1), AttributeError, "attribute 'time' of 'jostle.World'"),
    (lambda w: setattr(w, "own", 1), AttributeError, "'jostle.World' object has no attribute"),
]  # fmt: skip


@pytest.mark.parametrize(("act", "error", "message"), NOTHING_CHANGED)
def test_refused_and_nothing_changed(
    act: Callable[[jostle.World], Any], error: type[Exception], message: str
) -> None:
    world = three(container=jostle.Box(-100, -100, 100, 100))
    world.step(0.01)
    state, settings = world.state_hash(), {name: getattr(world, name) for name in SETTINGS}
    with pytest.raises(error, match=f"^{re.escape(message)}"):
        act(world)
    assert len(world) == 3
    assert world.state_hash() == state
    assert {name: getattr(world, name) for name in SETTINGS} == settings
    assert world.time == 0.01


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"positions": np.zeros((3, 3))}, ValueError, "positions has shape (3, 3); it must be (n"),
        ({"positions": [(0, 0)]}, ValueError, "velocities has shape (3, 2); it must be (1, 2)"),
        ({"velocities": (0, 0)}, ValueError, "velocities has shape (2,); it must be (3, 2)"),
        ({"radii": [1, 2]}, ValueError, "radii has shape (2,); it must be a number or (3,)"),
        ({"masses": [1]}, ValueError, "masses has shape (1,); it must be a number or (3,)"),
        ({"densities": [1]}, ValueError, "densities has shape (1,); it must be a number or (3,)"),
        ({"movable": [True]}, ValueError, "movable has shape (1,); it must be True or False or"),
        ({"restitution": [1]}, ValueError, "restitution has shape (1,); it must be a number or"),
        ({"restitution": [1, 1, -1]}, ValueError, "restitutions[2] is -1; a restitution must"),
        ({"friction": [1]}, ValueError, "friction has shape (1,); it must be a number or (3,)"),
        ({"friction": [1, 1, -1]}, ValueError, "friction[2] is -1; a coefficient of friction"),
        ({"friction": "much"}, TypeError, "friction must hold real numbers, not str"),
        ({"angular_velocities": [0, np.inf, 0]}, ValueError, "angular_velocities[1] is inf; an"),
        ({"restitution": -1}, ValueError, "restitution is -1; it must lie between 0 and 1"),
        ({"positions": [(0, 0), (np.inf, 0), (1, 1)]}, ValueError, "positions[1] is (inf, 0)"),
        ({"velocities": [(0, 0), (0, 0), (1, np.nan)]}, ValueError, "velocities[2] is (1, NaN)"),
        ({"radii": [1, -1, 1]}, ValueError, "radii[1] is -1; a radius must be finite and at"),
        ({"masses": [1, 2, 0]}, ValueError, "masses[2] is 0; a mass must lie between"),
        ({"container": jostle.Circle((0, 0), 2.5)}, ValueError, "radii[2] is 3; it must fit into"),
        ({"container": jostle.Torus(9, 9)}, ValueError, "radii[2] is 3; on a torus it may be at"),
        ({"method": "tree"}, ValueError, "method is 'tree'; it must be 'quadtree' or 'brute'"),
        ({"positions": "here"}, TypeError, "positions must hold real numbers, not str"),
        ({"velocities": None}, TypeError, "velocities must hold real numbers, not NoneType"),
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
