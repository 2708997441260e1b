//! `jostle.ThermalWalls`.

use jostle_base::Error;
use jostle_index::Each;
use jostle_world::container::{FIRST_SIDE, KNOWN_SIDES, SIDE_NAMES};
use jostle_world::forces::{ThermalWalls, WallIds};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arguments::{Numbers, Sides, arguments, plain_arguments};
use super::{read_seed, real, valid};
use crate::arrays::long_ids;
use crate::error::refused;
use crate::keywords::Keywords;

/// Sides of the container, and walls, with a temperature.
///
/// A particle that hits such a wall leaves it with the velocity of a particle that enters through
/// it from a gas in equilibrium: the speed along the normal has the density ∝ v exp(-m v²/2kT), the
/// velocity along the wall is normally distributed with the variance kT/m. A gas between such walls
/// reaches their temperature and the Maxwell distribution; between different temperatures there is
/// a heat flow. The random numbers are functions of `seed`, the particle's state at the impact and
/// the time, so results have the same bits for every number of threads and every order of adding.
///
/// Parameters
/// ----------
/// temperature : float
///     Boltzmann's constant times the temperature, kT, above 0: the mean kinetic energy of a
///     particle, in units of mass times length² per second².
/// sides : Side or array_like of Side, shape (k,), optional
///     Sides of the container. If omitted, or all of `Side`, those that it has; if omitted and `walls` is
///     given, none.
/// walls : int or array_like of int, shape (m,), optional
///     Ids of line segments of `World.walls`, which have the temperature on both sides. At a wall
///     that moves, the velocities are relative to it.
/// seed : int, default 0
///     Seed of the random numbers, below 2³².
///
/// Raises
/// ------
/// TypeError
///     If an argument has the wrong type.
/// ValueError
///     If a number is out of range, or a side or a wall is given twice. When it is assigned to
///     `World.forces`, also if a wall has a temperature already, or the container does not have a
///     side. A change of `World.container` to one without it is refused, too.
/// IdError
///     When it is assigned to `World.forces`, if a wall does not exist.
///
/// See Also
/// --------
/// AndersenThermostat : A heat bath for all particles.
/// Thermostat : The article's rule, which does not lead to the Maxwell distribution.
///
/// Notes
/// -----
/// Several of them may have different sides and walls. Angular velocities, and particles that rest on a wall,
/// are not heated: use coefficients of restitution of 1. `World.last_step` includes the change
/// along the normal.
///
/// References
/// ----------
/// R. Tehver, F. Toigo, J. Koplik and J. R. Banavar, *Thermal walls in computer simulations*,
/// Physical Review E 57, R17 (1998).
///
/// Examples
/// --------
/// >>> import jostle
/// >>> hot = jostle.ThermalWalls(4.0, sides=jostle.Side.MIN_X)
/// >>> cold = jostle.ThermalWalls(1.0, sides=jostle.Side.MAX_X, seed=1)
/// >>> world = jostle.scenes.create("gas", n=100)
/// >>> world.forces = [hot, cold]
/// >>> world.step(1 / 60, steps=10)
/// >>> hot
/// ThermalWalls(4.0, sides=(Side.MIN_X,), seed=0)
///
/// A hot plate in the middle of the box:
///
/// >>> plate = world.walls.add(((5, 10), (15, 10)))
/// >>> world.forces = [jostle.ThermalWalls(9.0, walls=[plate])]
/// >>> world.step(1 / 60, steps=10)
#[pyclass(module = "jostle", name = "ThermalWalls", frozen, eq)]
#[derive(PartialEq)]
pub struct PyThermalWalls(pub ThermalWalls);

#[pymethods]
impl PyThermalWalls {
    #[new]
    #[pyo3(
        signature = (*arguments, **keywords),
        text_signature = "(temperature, *, sides=None, walls=None, seed=0)"
    )]
    fn new(arguments: &Bound<'_, PyTuple>, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let names = ["temperature"];
        let mut given = Keywords::of_all("ThermalWalls()", &names, arguments, keywords)?;
        let [temperature] = given.require(names)?;
        let [sides, walls] = given.take_all(["sides", "walls"]);
        let seed = given.given("seed");
        given.end()?;
        let temperature = real("temperature", &temperature)?;
        let sides = sides.as_ref().map_or(Ok([walls.is_none(); KNOWN_SIDES]), self::sides)?;
        let walls = walls.as_ref().map(|value| long_ids("walls", value, "wall")).transpose()?;
        let walls = WallIds(walls.map_or(Vec::new(), |ids| ids.rows(1)));
        let seed = read_seed(&seed)?;
        Ok(Self(valid(ThermalWalls { temperature, sides, walls, seed }, ThermalWalls::validate)?))
    }
}

arguments! {
    PyThermalWalls {
        /// Boltzmann's constant times the temperature.
        temperature: |own| own.0.temperature;
    }
    keywords {
        /// The sides of the container that have it: a tuple of `Side`. All of them stand for those that the
        /// container has.
        sides: |own| Sides(own.0.side_ids().collect());
        /// The ids of the walls that have it: a tuple of int.
        walls: |own| Numbers(own.0.walls.0.clone());
        /// The seed of the random numbers.
        seed: |own| own.0.seed;
    }
}
plain_arguments!(PyThermalWalls);

/// One side of the container, or those in an array.
fn sides(value: &Bound<'_, PyAny>) -> PyResult<[bool; KNOWN_SIDES]> {
    let ids = long_ids("sides", value, "side")?;
    let is_single = matches!(ids, Each::One(_));
    let mut sides = [false; KNOWN_SIDES];
    for (index, id) in ids.rows(1).into_iter().enumerate() {
        let side = FIRST_SIDE.checked_sub(id).and_then(|side| usize::try_from(side).ok());
        let rule = match side.and_then(|side| sides.get_mut(side)) {
            Some(side) if !*side => {
                *side = true;
                continue;
            }
            Some(_) => "it is given twice",
            None => "a side of a container is one of jostle.Side, MIN_X = -2 to RIM = -6",
        };
        let id =
            side.and_then(|side| SIDE_NAMES.get(side)).map_or(id.to_string(), ToString::to_string);
        let error = if is_single {
            Error::of("sides", id, rule)
        } else {
            Error::at("sides", index, id, rule)
        };
        return Err(refused(error));
    }
    Ok(sides)
}
