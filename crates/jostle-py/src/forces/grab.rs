//! `jostle.Grab`.

use jostle_world::forces::Grab;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arguments::{arguments, plain_arguments};
use super::{real, real_or, valid};
use crate::arrays::point;
use crate::ids::one_id;
use crate::keywords::Keywords;

/// A force that pulls a particle to a point, for instance to the mouse.
///
/// It is a critically damped spring from the centre of the particle to the point. A particle at rest
/// does not move beyond the point, at any length of a step. One that has a velocity, or whose force is
/// limited by `max_force`, may. The particle collides as others do; `max_force` limits what it can push
/// or lift. In a periodic world the force is towards the nearest image of the point.
///
/// Parameters
/// ----------
/// id : int
///     Id of the particle. It stays awake; if it is removed, so is the force.
/// point : array_like, shape (2,)
///     Where the particle is pulled to, in units of length.
/// rate : float
///     Speed of the approach, per second, at least 0. For short sub-steps a particle that starts at
///     rest at the distance d is at the distance ``d * (1 + rate * t) * exp(-rate * t)`` after t
///     seconds.
/// max_force : float, default inf
///     Limit of the force, at least 0, in units of mass times length per second squared.
///
/// Raises
/// ------
/// TypeError
///     If an argument has the wrong type.
/// ValueError
///     If a number is out of range.
/// IdError
///     When it is assigned to `World.forces`, if no particle has the id.
///
/// See Also
/// --------
/// Attractor : A force on all particles.
/// World.query_point : Finds the particle under the mouse.
///
/// Notes
/// -----
/// Assign a new `Grab` to `World.forces` in each frame. If only grabs change, only the islands of the
/// grabbed particles wake, and resting contacts keep their impulses. Under gravity g the particle
/// rests below the point by ``g * (1 + rate * h)**2 / rate**2``, where h is the length of a sub-step.
/// Immovable particles do not move.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> world = jostle.World([(0, 0)], 1.0)
/// >>> world.forces = [jostle.Grab(0, (4, 0), rate=20)]
/// >>> world.step(1 / 60, steps=60)
/// >>> world.positions.round(3)
/// array([[4., 0.]], dtype=float32)
/// >>> world.forces = []  # it is released
#[pyclass(module = "jostle", name = "Grab", frozen, eq)]
#[derive(PartialEq)]
pub struct PyGrab(pub Grab);

#[pymethods]
impl PyGrab {
    #[new]
    #[pyo3(
        signature = (*arguments, **keywords),
        text_signature = "(id, point, *, rate, max_force=math.inf)"
    )]
    fn new(arguments: &Bound<'_, PyTuple>, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let mut given = Keywords::of_all("Grab()", &["id", "point"], arguments, keywords)?;
        let [id, point, rate] = given.require(["id", "point", "rate"])?;
        let max_force = given.given("max_force");
        given.end()?;
        let grab = Grab {
            id: one_id("id", &id, "particle")?,
            point: self::point("point", &point)?,
            rate: real("rate", &rate)?,
            max_force: real_or("max_force", &max_force, f32::INFINITY)?,
        };
        Ok(Self(valid(grab, Grab::validate)?))
    }
}

arguments! {
    PyGrab {
        /// Id of the particle.
        id: |own| own.0.id;
        /// Where it is brought, (x, y).
        point: |own| own.0.point;
    }
    keywords {
        /// How fast, per second.
        rate: |own| own.0.rate;
        /// Limit of the force.
        max_force: |own| own.0.max_force;
    }
}
plain_arguments!(PyGrab);
