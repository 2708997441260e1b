//! `jostle.Flocking`.

use jostle_world::forces::Flocking;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arguments::{arguments, plain_arguments};
use super::{real, real_or, valid};
use crate::keywords::Keywords;

/// Flocking: separation, alignment and cohesion.
///
/// The neighbours of a particle are those nearer than `cutoff`. Its acceleration is the mean over
/// these of ``separation * (1 - d / cutoff)`` away from each, ``alignment`` times the difference of
/// velocities, and ``cohesion`` times the offset. Forces keep the speed within limits.
///
/// Parameters
/// ----------
/// cutoff : float
///     Distance below which particles are neighbours, in units of length. On a torus at most half of
///     each side.
/// separation : float
///     Acceleration away from a neighbour at distance 0, at least 0.
/// alignment : float
///     Rate at which velocities become equal, per second, at least 0.
/// cohesion : float
///     Acceleration towards a neighbour per unit of distance, at least 0.
/// max_speed : float
///     Limit of the speed, in units of length per second; may be infinite.
/// min_speed : float, default 0.0
///     Lower limit of the speed of particles that move.
///
/// Raises
/// ------
/// TypeError
///     If an argument is not a number.
/// ValueError
///     If a number is out of range. When it is assigned to `World.forces`, also if the cutoff is too
///     large for the torus.
///
/// See Also
/// --------
/// PairForce : Forces between kinds of particles.
///
/// Notes
/// -----
/// The limits of the speed hold for the sum of all accelerations but gravity. Momentum and energy
/// are not conserved.
///
/// References
/// ----------
/// C. W. Reynolds, *Flocks, herds and schools: a distributed behavioral model*, SIGGRAPH (1987).
///
/// Examples
/// --------
/// >>> import jostle
/// >>> birds = jostle.Flocking(5.0, separation=0.0, alignment=2.0, cohesion=0.0, max_speed=9.0)
/// >>> world = jostle.World([(0, 0), (0, 2)], 0.1, velocities=[(1, 0), (3, 0)], forces=[birds])
/// >>> world.step(0.1, steps=100)
/// >>> world.velocities.round(3)
/// array([[2., 0.],
///        [2., 0.]], dtype=float32)
#[pyclass(module = "jostle", name = "Flocking", frozen, eq)]
#[derive(PartialEq)]
pub struct PyFlocking(pub Flocking);

#[pymethods]
impl PyFlocking {
    #[new]
    #[pyo3(
        signature = (*arguments, **keywords),
        text_signature = "(cutoff, separation, alignment, cohesion, max_speed, min_speed=0.0)"
    )]
    fn new(arguments: &Bound<'_, PyTuple>, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let names = ["cutoff", "separation", "alignment", "cohesion", "max_speed", "min_speed"];
        let mut given = Keywords::of_all("Flocking()", &names, arguments, keywords)?;
        let [cutoff, separation, alignment, cohesion, max_speed] =
            given.require(["cutoff", "separation", "alignment", "cohesion", "max_speed"])?;
        let min_speed = given.given("min_speed");
        given.end()?;
        let all = Flocking {
            cutoff: real("cutoff", &cutoff)?,
            separation: real("separation", &separation)?,
            alignment: real("alignment", &alignment)?,
            cohesion: real("cohesion", &cohesion)?,
            max_speed: real("max_speed", &max_speed)?,
            min_speed: real_or("min_speed", &min_speed, 0.0)?,
        };
        Ok(Self(valid(all, Flocking::validate)?))
    }
}

arguments! { PyFlocking {
    /// Distance below which particles are neighbours, in units of length.
    cutoff: |own| own.0.cutoff;
    /// Acceleration away from a neighbour at distance 0.
    separation: |own| own.0.separation;
    /// Rate at which velocities become equal, per second.
    alignment: |own| own.0.alignment;
    /// Acceleration towards a neighbour per unit of distance.
    cohesion: |own| own.0.cohesion;
    /// Limit of the speed.
    max_speed: |own| own.0.max_speed;
    /// Lower limit of the speed of particles that move.
    min_speed: |own| own.0.min_speed;
}}
plain_arguments!(PyFlocking);
