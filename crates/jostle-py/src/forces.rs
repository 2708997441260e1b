//! The forces of a world: reading and showing them; the files in this folder have a class each.

mod andersen;
mod arguments;
mod attractor;
mod flocking;
mod gravitation;
mod motor;
mod pair;
mod springs;
mod thermal_walls;
mod thermostat;

use jostle_base::error::{Error, Result, counted};
use jostle_world::{Influence, World};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arrays::{Given, count, number};
use crate::error::{refused, type_error, value_error};
pub use andersen::PyAndersenThermostat;
pub use attractor::PyAttractor;
pub use flocking::PyFlocking;
pub use gravitation::PyGravitation;
pub use motor::PyMotor;
pub use pair::PyPairForce;
pub use springs::PySprings;
pub use thermal_walls::PyThermalWalls;
pub use thermostat::PyThermostat;

/// Forces as Python has them: each `PairForce` with the kinds of all particles.
#[derive(Default)]
pub struct Forces {
    all: Vec<Influence>,
    /// The kinds of each `PairForce`, with its index.
    kinds: Vec<(usize, Vec<u8>)>,
}

impl Forces {
    /// Reads a sequence of Python objects.
    pub fn read(value: &Bound<'_, PyAny>) -> PyResult<Self> {
        let rule = "a sequence of forces";
        let items = value.try_iter().map_err(|_| type_error("forces", rule, value))?;
        let mut forces = Self::default();
        for (index, item) in items.enumerate() {
            let item = item?;
            forces.all.push(read_one(index, &item)?);
            if let Ok(pair) = item.cast::<PyPairForce>() {
                forces.kinds.push((index, pair.get().1.clone()));
            }
        }
        Ok(forces)
    }

    /// Replaces the forces of a world, and the kinds of its particles if there is a `PairForce`.
    pub fn assign(mut self, world: &mut World) -> Result<()> {
        for (index, kinds) in &self.kinds {
            if kinds.len() != world.len() {
                let value = format!("a PairForce of {}", counted(kinds.len(), "kind"));
                let particles = counted(world.len(), "particle");
                let rule = format!("a PairForce needs one for each of {particles}");
                return Err(Error::at("forces", *index, value, &rule));
            }
            let (first, expected) = &self.kinds[0];
            if kinds != expected {
                let rule = format!("its kinds must be those of forces[{first}]");
                return Err(Error::at("forces", *index, "another PairForce", &rule));
            }
        }
        match self.kinds.pop() {
            Some((_, kinds)) => world.set_forces_and_kinds(self.all, kinds),
            None => world.set_forces(self.all),
        }
    }
}

/// Declares the class of each influence, a struct of it and of other values.
macro_rules! classes {
    ($kinds:ident: $($name:ident as $class:ident($($other:expr)?);)*) => {
        fn read_one(index: usize, value: &Bound<'_, PyAny>) -> PyResult<Influence> {
            $(if let Ok(found) = value.cast::<$class>() {
                return Ok(found.get().0.clone().into());
            })*
            let rule = "a jostle.Attractor, jostle.Gravitation, jostle.Springs, jostle.Thermostat, \
                        jostle.ThermalWalls, jostle.AndersenThermostat, jostle.Motor, \
                        jostle.PairForce or jostle.Flocking";
            Err(type_error(&format!("forces[{index}]"), rule, value))
        }

        /// The Python objects for forces of the core, in a world with particles of these kinds.
        pub fn show<'py>(
            py: Python<'py>,
            forces: Vec<Influence>,
            $kinds: &[u8],
        ) -> PyResult<Bound<'py, PyTuple>> {
            let one = |force| -> PyResult<Py<PyAny>> {
                Ok(match force {
                    $(Influence::$name(own) => Py::new(py, $class(own, $($other)?))?.into_any(),)*
                })
            };
            PyTuple::new(py, forces.into_iter().map(one).collect::<PyResult<Vec<_>>>()?)
        }
    };
}
classes! { kinds:
    Attractor as PyAttractor();
    Gravitation as PyGravitation();
    Pair as PyPairForce(kinds.to_vec());
    Flocking as PyFlocking();
    Springs as PySprings();
    Motor as PyMotor();
    Thermostat as PyThermostat();
    ThermalWalls as PyThermalWalls();
    Andersen as PyAndersenThermostat();
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
fn read_seed(given: &Given<'_>) -> PyResult<u32> {
    let seed = given.value().map_or(Ok(0), |value| count("seed", value, 0))?;
    u32::try_from(seed).map_err(|_| value_error("seed", seed, "below 4294967296"))
}
