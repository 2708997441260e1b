//! `jostle.Grab`.

use jostle_world::forces::Grab;
use pyo3::prelude::*;

use super::arguments::{arguments, plain_arguments};
use super::{one_id, real, real_or, valid};
use crate::arrays::{Given, point};

/// A force that brings a particle to a point, as the mouse does when it drags a body.
///
/// It is a critically damped spring from the centre of the particle to the point: the particle
/// arrives without overshooting, at any length of a step. On its way it collides like any other,
/// and `max_force` decides what it can push or lift. On a torus the force is towards the nearest
/// image of the point.
///
/// Parameters
/// ----------
/// id : int
///     Id of the particle. It stays awake; if it is removed, so is the force.
/// point : array_like, shape (2,)
///     Where the particle is brought, in units of length.
/// rate : float
///     Per second: how fast. From rest at the distance d, the particle is at the distance
///     ``d * (1 + rate * t) * exp(-rate * t)`` after t seconds.
/// max_force : float, default inf
///     Limit of the force, in units of mass times length per second squared.
///
/// Raises
/// ------
/// TypeError
///     If an argument has the wrong type.
/// ValueError
///     If a number is out of range. When it is assigned to `World.forces`, also if there is no such
///     particle.
///
/// See Also
/// --------
/// Attractor : A force on all particles.
/// World.quadtree : Finds the particle under the mouse.
///
/// Notes
/// -----
/// Assign `World.forces` with a new `Grab` in each frame: where only grabs change, nothing wakes but
/// the particle that is grabbed, and resting contacts keep their impulses. The force does not hold
/// the weight of the particle, which hangs below the point by ``g / rate**2`` under gravity g.
/// Immovable particles do not follow.
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
        signature = (id, point, *, rate, max_force=Given::NOTHING),
        text_signature = "(id, point, *, rate, max_force=math.inf)"
    )]
    fn new(
        id: &Bound<'_, PyAny>,
        point: &Bound<'_, PyAny>,
        rate: &Bound<'_, PyAny>,
        max_force: Given<'_>,
    ) -> PyResult<Self> {
        let grab = Grab {
            id: one_id("id", id)?,
            point: self::point("point", point)?,
            rate: real("rate", rate)?,
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
