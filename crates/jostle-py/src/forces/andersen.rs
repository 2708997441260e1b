//! `jostle.AndersenThermostat`.

use jostle_world::forces::Andersen;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arguments::{arguments, plain_arguments};
use super::{read_seed, real, valid};
use crate::keywords::Keywords;

/// A heat bath that gives each particle a new velocity at random times.
///
/// At the end of each step a particle gets a new velocity with the probability 1 - exp(-rate dt).
/// Each component of it is normally distributed with the variance kT/m. So the particles reach the
/// Maxwell distribution at this temperature (canonical ensemble); momentum and energy are not
/// conserved. The random numbers are functions of `seed`, the particle's state and the time, so
/// results have the same bits for every number of threads and every order of adding.
///
/// Parameters
/// ----------
/// temperature : float
///     Boltzmann's constant times the temperature, kT, above 0: the mean kinetic energy of a
///     particle, in units of mass times length² per second².
/// rate : float
///     Mean number of new velocities of a particle per second, at least 0.
/// seed : int, default 0
///     Seed of the random numbers, below 2³².
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
///
/// Notes
/// -----
/// A world has at most one. Angular velocities and immovable particles are not changed.
///
/// References
/// ----------
/// H. C. Andersen, *Molecular dynamics simulations at constant pressure and/or temperature*,
/// Journal of Chemical Physics 72, 2384 (1980).
///
/// Examples
/// --------
/// >>> import jostle
/// >>> world = jostle.scenes.create("gas", n=1000)
/// >>> world.forces = [jostle.AndersenThermostat(temperature=2.0, rate=5.0)]
/// >>> world.step(1 / 60, steps=300)
/// >>> abs(world.kinetic_energy() / 1000 - 2.0) < 0.3
/// True
#[pyclass(module = "jostle", name = "AndersenThermostat", frozen, eq)]
#[derive(PartialEq)]
pub struct PyAndersenThermostat(pub Andersen);

#[pymethods]
impl PyAndersenThermostat {
    #[new]
    #[pyo3(
        signature = (*arguments, **keywords),
        text_signature = "(temperature, rate, seed=0)"
    )]
    fn new(arguments: &Bound<'_, PyTuple>, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let names = ["temperature", "rate", "seed"];
        let mut given = Keywords::of_all("AndersenThermostat()", &names, arguments, keywords)?;
        let [temperature, rate] = given.require(["temperature", "rate"])?;
        let seed = given.given("seed");
        given.end()?;
        let temperature = real("temperature", &temperature)?;
        let (rate, seed) = (real("rate", &rate)?, read_seed(&seed)?);
        Ok(Self(valid(Andersen { temperature, rate, seed }, Andersen::validate)?))
    }
}

arguments! { PyAndersenThermostat {
    /// Boltzmann's constant times the temperature.
    temperature: |own| own.0.temperature;
    /// Mean number of new velocities of a particle per second.
    rate: |own| own.0.rate;
    /// The seed of the random numbers.
    seed: |own| own.0.seed;
}}
plain_arguments!(PyAndersenThermostat);
