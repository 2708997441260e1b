//! `jostle.Thermostat`.

use jostle_world::forces::Thermostat;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arguments::{arguments, plain_arguments};
use super::{real, valid};
use crate::keywords::Keywords;

/// Walls that heat or cool the particles that bounce off them.
///
/// Every bounce off a wall changes a particle's speed s to s + rate (speed - s), as in
/// the article's lesson about gases. A world has at most one `Thermostat`. The speeds do not reach
/// the Maxwell distribution, see `ThermalWalls`.
///
/// Parameters
/// ----------
/// speed : float
///     Target speed in units of length per second, at least 0.
/// rate : float
///     Relative change by one bounce, 0 to 1; with 1 particles leave the walls with `speed`.
///
/// Raises
/// ------
/// TypeError
///     If an argument is not a number.
/// ValueError
///     If a number is out of range.
///
/// See Also
/// --------
/// ThermalWalls : Sides of the container with a temperature.
/// AndersenThermostat : A heat bath for all particles.
///
/// Examples
/// --------
/// >>> import jostle
/// >>> warm = jostle.Thermostat(speed=3.0, rate=0.5)
/// >>> box = jostle.Box(0, 0, 10, 10)
/// >>> world = jostle.World([(5, 5)], 1.0, velocities=[(1, 0)], container=box, forces=[warm])
/// >>> world.step(0.1, steps=60)  # it bounces off the right wall after four seconds
/// >>> world.velocities
/// array([[-2.,  0.]], dtype=float32)
#[pyclass(module = "jostle", name = "Thermostat", frozen, eq)]
#[derive(PartialEq)]
pub struct PyThermostat(pub Thermostat);

#[pymethods]
impl PyThermostat {
    #[new]
    #[pyo3(signature = (*arguments, **keywords), text_signature = "(speed, rate)")]
    fn new(arguments: &Bound<'_, PyTuple>, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let names = ["speed", "rate"];
        let mut given = Keywords::of_all("Thermostat()", &names, arguments, keywords)?;
        let [speed, rate] = given.require(names)?;
        given.end()?;
        let (speed, rate) = (real("speed", &speed)?, real("rate", &rate)?);
        Ok(Self(valid(Thermostat { speed, rate }, Thermostat::validate)?))
    }
}

arguments! { PyThermostat {
    /// The target speed.
    speed: |own| own.0.speed;
    /// Relative change by one bounce, 0 to 1.
    rate: |own| own.0.rate;
}}
plain_arguments!(PyThermostat);
