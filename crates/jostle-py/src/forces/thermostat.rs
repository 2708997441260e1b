//! `jostle.Thermostat`.

use jostle_world::forces;
use pyo3::prelude::*;

use crate::arrays::{decimal, number};
use crate::error::refused;

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
/// >>> world = jostle.World([(5, 5)], [(1, 0)], radii=1.0, container=box, forces=[warm])
/// >>> world.step(0.1, steps=60)  # it bounces off the right wall after four seconds
/// >>> world.velocities
/// array([[-2.,  0.]], dtype=float32)
#[pyclass(module = "jostle", name = "Thermostat", frozen, eq)]
#[derive(PartialEq)]
pub struct PyThermostat(pub forces::Thermostat);

#[pymethods]
impl PyThermostat {
    #[classattr]
    #[pyo3(name = "__match_args__")]
    const MATCH_ARGS: (&str, &str) = ("speed", "rate");

    #[new]
    fn new(speed: &Bound<'_, PyAny>, rate: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (speed, rate) = (number("speed", speed)? as f32, number("rate", rate)? as f32);
        let thermostat = forces::Thermostat { speed, rate };
        thermostat.validate().map_err(refused)?;
        Ok(Self(thermostat))
    }

    /// The target speed.
    #[getter]
    fn speed(&self) -> f64 {
        decimal(self.0.speed)
    }

    /// Relative change by one bounce, 0 to 1.
    #[getter]
    fn rate(&self) -> f64 {
        decimal(self.0.rate)
    }

    fn __getnewargs__(&self) -> (f64, f64) {
        (self.speed(), self.rate())
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        self.__getnewargs__().into_pyobject(py)?.hash()
    }

    fn __repr__(&self) -> String {
        format!("Thermostat({:?}, {:?})", self.speed(), self.rate())
    }
}
