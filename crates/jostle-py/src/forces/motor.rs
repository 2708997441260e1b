//! `jostle.Motor`.

use jostle_base::{Error, Id};
use jostle_world::forces::{Motor, WallIds};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arguments::arguments;
use super::{real, real_or, valid};
use crate::arrays::{long_ids, point};
use crate::error::refused;
use crate::keywords::Keywords;

/// A prescribed motion of immovable particles and walls.
///
/// They rotate about a pivot and move with a velocity, for example as the paddles of a mill, the
/// flippers of a pinball table or a piston. With a `cycle` the motion is reversed in its second
/// half. They push other particles and are not pushed. A motor is one of the `World.forces`.
///
/// Parameters
/// ----------
/// ids : array_like of int, shape (k,), optional
///     Ids of the immovable particles; if one is removed, the motor drives the others.
/// walls : array_like of int, shape (m,), optional
///     Ids of the walls. Walls do not rotate.
/// pivot : array_like, shape (2,), optional
///     The centre of the rotation, in units of length. It moves with `velocity`. A motor that only
///     moves needs none.
/// angular_velocity : float, default 0.0
///     In radians per second, positive from +x to +y.
/// velocity : array_like, shape (2,), default (0.0, 0.0)
///     In units of length per second.
/// cycle : float, optional
///     Seconds of the motion there and back, above 0. If omitted, the motion is not reversed.
///
/// Raises
/// ------
/// TypeError
///     If an argument has the wrong type.
/// ValueError
///     If a number is out of range, a particle or a wall is given twice, or `angular_velocity` is
///     not 0 for walls or without a `pivot`. When it is assigned to `World.forces`, also if a
///     particle is movable, or another motor drives the same particle or wall.
/// IdError
///     When it is assigned to `World.forces`, if a particle or a wall does not exist.
///
/// See Also
/// --------
/// World.walls : The walls, with their ids.
///
/// Notes
/// -----
/// The motion is a function of `World.time`. At the beginning of each step the motor sets the
/// velocities that lead to the position at its end. On a circle a step is a chord, so the angle per
/// step should be small. Particles and walls that are moved between calls continue from their new
/// position.
///
/// The time is that of the world, not that since the motor was assigned: with a `cycle` one that is
/// assigned at the time t begins in the phase ``t % cycle``. Particles and walls keep the velocity of
/// the last step when their motor is taken out of `World.forces`; set their velocities to 0 to stop
/// them.
///
/// Examples
/// --------
/// A paddle of four discs that rotates twice per second:
///
/// >>> import jostle, math
/// >>> world = jostle.World([(x, 1) for x in (2, 3, 4, 5)], 0.5, movable=False)
/// >>> world.forces = [jostle.Motor(world.ids, pivot=(1, 1), angular_velocity=4 * math.pi)]
/// >>> world.step(1 / 80, steps=10)
/// >>> world.positions[3].round(4).tolist()
/// [1.0, 5.0]
///
/// A piston that moves to the right for two seconds, then back:
///
/// >>> world = jostle.World([(5, 5)], 1.0, walls=[((1, 0), (1, 10))])
/// >>> world.forces = [jostle.Motor(walls=[0], velocity=(0.5, 0), cycle=4)]
/// >>> world.step(1 / 60, steps=120)
/// >>> world.walls.get(0).segments.round(4).tolist()
/// [[2.0, 0.0], [2.0, 10.0]]
#[pyclass(module = "jostle", name = "Motor", frozen, eq)]
#[derive(PartialEq)]
pub struct PyMotor(pub Motor);

#[pymethods]
impl PyMotor {
    #[new]
    #[pyo3(
        signature = (*arguments, **keywords),
        text_signature = "(ids=None, *, walls=None, pivot=None, angular_velocity=0.0, \
                          velocity=(0.0, 0.0), cycle=None)"
    )]
    fn new(arguments: &Bound<'_, PyTuple>, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let mut given = Keywords::of_all("Motor()", &["ids"], arguments, keywords)?;
        let [ids, walls, pivot, cycle] = given.take_all(["ids", "walls", "pivot", "cycle"]);
        let [angular_velocity, velocity] =
            ["angular_velocity", "velocity"].map(|name| given.given(name));
        given.end()?;
        let all = |name, value: Option<_>, of| -> PyResult<Vec<Id>> {
            value.map_or(Ok(Vec::new()), |value| Ok(long_ids(name, value, of)?.rows(1)))
        };
        let pair = |name, value: Option<_>| value.map_or(Ok([0.0; 2]), |value| point(name, value));
        let motor = Motor {
            ids: all("ids", ids.as_ref(), "particle")?,
            walls: WallIds(all("walls", walls.as_ref(), "wall")?),
            pivot: pair("pivot", pivot.as_ref())?,
            angular_velocity: real_or("angular_velocity", &angular_velocity, 0.0)?,
            velocity: pair("velocity", velocity.value())?,
            cycle: cycle.as_ref().map_or(Ok(f32::INFINITY), |value| real("cycle", value))?,
        };
        if pivot.is_none() && motor.angular_velocity != 0.0 {
            let rule = "a motor with an angular_velocity needs the centre of the rotation";
            return Err(refused(Error::of("pivot", "None", rule)));
        }
        Ok(Self(valid(motor, Motor::validate)?))
    }

    fn __repr__(&self) -> String {
        let (particles, walls) = (self.0.ids.len(), self.0.walls.0.len());
        format!("<jostle.Motor of {particles} particles and {walls} walls>")
    }
}

arguments! {
    PyMotor {
        /// Ids of the particles that it drives: read-only ndarray of int64, shape (k,).
        ids: |own| own.0.ids.clone();
    }
    keywords {
        /// Ids of the walls that it drives: read-only ndarray of int64, shape (m,).
        walls: |own| own.0.walls.0.clone();
        /// The centre of the rotation at time 0, (x, y).
        pivot: |own| own.0.pivot;
        /// In radians per second.
        angular_velocity: |own| own.0.angular_velocity;
        /// In units of length per second, (x, y).
        velocity: |own| own.0.velocity;
        /// Seconds of the motion there and back; None if it is not reversed.
        cycle: |own| Some(own.0.cycle).filter(|cycle| cycle.is_finite());
    }
}
