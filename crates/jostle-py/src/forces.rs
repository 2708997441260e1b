//! The forces of a world: reading and showing them; the files in this folder have a class each.

mod andersen;
mod arguments;
mod attractor;
mod flocking;
mod grab;
mod gravitation;
mod motor;
mod pair;
mod pump;
mod springs;
mod thermal_walls;
mod thermostat;

use jostle_base::error::Result;
use jostle_world::Influence;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arrays::{Given, count, number};
use crate::error::{refused, type_error, value_error};
pub use andersen::PyAndersenThermostat;
pub use attractor::PyAttractor;
pub use flocking::PyFlocking;
pub use grab::PyGrab;
pub use gravitation::PyGravitation;
pub use motor::PyMotor;
pub use pair::PyPairForce;
pub use pump::PyPump;
pub use springs::PySprings;
pub use thermal_walls::PyThermalWalls;
pub use thermostat::PyThermostat;

/// Reads a sequence of Python objects.
pub fn read(value: &Bound<'_, PyAny>) -> PyResult<Vec<Influence>> {
    let items = value.try_iter();
    let items = items.map_err(|_| type_error("forces", "a sequence of forces", value))?;
    items.enumerate().map(|(index, item)| read_one(index, &item?)).collect()
}

/// Declares the class of each influence, a struct of it.
macro_rules! classes {
    ($($name:ident as $class:ident;)*) => {
        fn read_one(index: usize, value: &Bound<'_, PyAny>) -> PyResult<Influence> {
            $(if let Ok(found) = value.cast::<$class>() {
                return Ok(found.get().0.clone().into());
            })*
            let rule = "a jostle.Attractor, jostle.Gravitation, jostle.Springs, jostle.Thermostat, \
                        jostle.ThermalWalls, jostle.AndersenThermostat, jostle.Motor, jostle.Grab, \
                        jostle.PairForce, jostle.Flocking or jostle.Pump";
            Err(type_error(&format!("forces[{index}]"), rule, value))
        }

        /// The Python objects for forces of the core.
        pub fn show(py: Python<'_>, forces: Vec<Influence>) -> PyResult<Bound<'_, PyTuple>> {
            let one = |force| -> PyResult<Py<PyAny>> {
                Ok(match force {
                    $(Influence::$name(own) => Py::new(py, $class(own))?.into_any(),)*
                })
            };
            PyTuple::new(py, forces.into_iter().map(one).collect::<PyResult<Vec<_>>>()?)
        }
    };
}
classes! {
    Attractor as PyAttractor;
    Gravitation as PyGravitation;
    Pair as PyPairForce;
    Flocking as PyFlocking;
    Grab as PyGrab;
    Springs as PySprings;
    Motor as PyMotor;
    Thermostat as PyThermostat;
    ThermalWalls as PyThermalWalls;
    Andersen as PyAndersenThermostat;
    Pump as PyPump;
}

/// Refuses what is out of range.
fn valid<V>(own: V, validate: fn(&V) -> Result<()>) -> PyResult<V> {
    validate(&own).map_err(refused)?;
    Ok(own)
}

/// A real number.
fn real(name: &str, value: &Bound<'_, PyAny>) -> PyResult<f32> {
    number(name, value).map(|value| value as f32)
}

/// A real number, or its default.
fn real_or(name: &str, given: &Given<'_>, default: f32) -> PyResult<f32> {
    given.value().map_or(Ok(default), |value| real(name, value))
}

/// The seed of random numbers.
pub fn read_seed(given: &Given<'_>) -> PyResult<u32> {
    let seed = given.value().map_or(Ok(0), |value| count("seed", value, 0))?;
    u32::try_from(seed).map_err(|_| value_error("seed", seed, "below 4294967296"))
}
