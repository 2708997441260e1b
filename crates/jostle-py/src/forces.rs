//! The forces of a world: reading and showing them; the files in this folder have a class each.

mod andersen;
mod attractor;
mod flocking;
mod gravitation;
mod motor;
mod pair;
mod springs;
mod thermal_walls;
mod thermostat;

use jostle_base::error::{Error, Result, counted};
use jostle_world::{Force, World};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arrays::{Given, count, number};
use crate::error::{type_error, value_error};
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
    all: Vec<Force>,
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
                forces.kinds.push((index, pair.get().kinds.clone()));
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

fn read_one(index: usize, value: &Bound<'_, PyAny>) -> PyResult<Force> {
    if let Ok(found) = value.cast::<PyAttractor>() {
        Ok(Force::Attractor(found.get().0))
    } else if let Ok(found) = value.cast::<PyGravitation>() {
        Ok(Force::Gravitation(found.get().0))
    } else if let Ok(found) = value.cast::<PySprings>() {
        Ok(Force::Springs(found.get().0.clone()))
    } else if let Ok(found) = value.cast::<PyThermostat>() {
        Ok(Force::Thermostat(found.get().0))
    } else if let Ok(found) = value.cast::<PyThermalWalls>() {
        Ok(Force::ThermalWalls(found.get().0.clone()))
    } else if let Ok(found) = value.cast::<PyAndersenThermostat>() {
        Ok(Force::Andersen(found.get().0))
    } else if let Ok(found) = value.cast::<PyMotor>() {
        Ok(Force::Motor(found.get().0.clone()))
    } else if let Ok(found) = value.cast::<PyPairForce>() {
        Ok(Force::Pair(found.get().force.clone()))
    } else if let Ok(found) = value.cast::<PyFlocking>() {
        Ok(Force::Flocking(found.get().0))
    } else {
        let rule = "a jostle.Attractor, jostle.Gravitation, jostle.Springs, jostle.Thermostat, \
                    jostle.ThermalWalls, jostle.AndersenThermostat, jostle.Motor, \
                    jostle.PairForce or jostle.Flocking";
        Err(type_error(&format!("forces[{index}]"), rule, value))
    }
}

/// The Python objects for forces of the core, in a world with particles of these kinds.
pub fn show<'py>(
    py: Python<'py>,
    forces: Vec<Force>,
    kinds: &[u8],
) -> PyResult<Bound<'py, PyTuple>> {
    let one = |force| -> PyResult<Py<PyAny>> {
        Ok(match force {
            Force::Attractor(attractor) => Py::new(py, PyAttractor(attractor))?.into_any(),
            Force::Gravitation(gravitation) => Py::new(py, PyGravitation(gravitation))?.into_any(),
            Force::Springs(springs) => Py::new(py, PySprings(springs))?.into_any(),
            Force::Thermostat(thermostat) => Py::new(py, PyThermostat(thermostat))?.into_any(),
            Force::ThermalWalls(walls) => Py::new(py, PyThermalWalls(walls))?.into_any(),
            Force::Andersen(bath) => Py::new(py, PyAndersenThermostat(bath))?.into_any(),
            Force::Motor(motor) => Py::new(py, PyMotor(motor))?.into_any(),
            Force::Pair(force) => {
                Py::new(py, PyPairForce { kinds: kinds.to_vec(), force })?.into_any()
            }
            Force::Flocking(flocking) => Py::new(py, PyFlocking(flocking))?.into_any(),
        })
    };
    PyTuple::new(py, forces.into_iter().map(one).collect::<PyResult<Vec<_>>>()?)
}

/// A real number, or its default.
fn real_or(name: &str, given: &Given<'_>, default: f32) -> PyResult<f32> {
    given.value().map_or(Ok(default), |value| number(name, value).map(|v| v as f32))
}

/// The seed of random numbers.
fn read_seed(given: &Given<'_>) -> PyResult<u32> {
    let seed = given.value().map_or(Ok(0), |value| count("seed", value, 0))?;
    u32::try_from(seed).map_err(|_| value_error("seed", seed, "below 4294967296"))
}
