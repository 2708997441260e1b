//! `jostle.ThermalWalls`.

use jostle_base::Error;
use jostle_world::forces::{ThermalWalls, WallIds};
use pyo3::prelude::*;

use super::arguments::{Numbers, arguments, plain_arguments};
use super::{read_seed, real, valid};
use crate::arrays::{Given, long_ids};
use crate::error::refused;

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
/// sides : array_like of int, shape (k,), optional
///     Numbers of the sides: 0 to 3 at min x, max x, min y and max y.
///     The wall of a `Circle` is given by 0, or by all four. If omitted, all sides, or none if `walls`
///     is given.
/// seed : int, default 0
///     Seed of the random numbers, below 2³².
/// walls : array_like of int, shape (m,), optional
///     Ids of line segments of `World.walls`, which have the temperature on both sides. At a wall
///     that moves, the velocities are relative to it.
///
/// Raises
/// ------
/// TypeError
///     If an argument has the wrong type.
/// ValueError
///     If a number is out of range, or a side or a wall is given twice. When it is assigned to
///     `World.forces`, also if a wall does not exist, or has a temperature already, or the container does
///     not have a side. A change of `World.container` to one without it is refused, too.
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
/// >>> hot, cold = jostle.ThermalWalls(4.0, sides=[0]), jostle.ThermalWalls(1.0, sides=[1], seed=1)
/// >>> world = jostle.scenes.create("gas", n=100)
/// >>> world.forces = [hot, cold]
/// >>> world.step(1 / 60, steps=10)
/// >>> hot
/// ThermalWalls(4.0, (0,), 0)
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
        signature = (temperature, sides=None, seed=Given::NOTHING, *, walls=None),
        text_signature = "(temperature, sides=None, seed=0, *, walls=None)"
    )]
    fn new(
        temperature: &Bound<'_, PyAny>,
        sides: Option<&Bound<'_, PyAny>>,
        seed: Given<'_>,
        walls: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let temperature = real("temperature", temperature)?;
        let sides = sides.map_or(Ok([walls.is_none(); 4]), self::sides)?;
        let walls = walls.map(|value| long_ids("walls", value, "wall")).transpose()?;
        let walls = WallIds(walls.map_or(Vec::new(), |ids| ids.rows(1)));
        let seed = read_seed(&seed)?;
        Ok(Self(valid(ThermalWalls { temperature, sides, walls, seed }, ThermalWalls::validate)?))
    }
}

arguments! {
    PyThermalWalls {
        /// Boltzmann's constant times the temperature.
        temperature: |own| own.0.temperature;
        /// The sides of the container that have it: a tuple of int, ascending.
        sides: |own| Numbers((0..4).filter(|&side| own.0.sides[side as usize]).collect());
        /// The seed of the random numbers.
        seed: |own| own.0.seed;
    }
    keywords {
        /// The ids of the walls that have it: a tuple of int.
        walls: |own| Numbers(own.0.walls.0.clone());
    }
}
plain_arguments!(PyThermalWalls);

/// The sides of the container with the numbers in an array.
fn sides(value: &Bound<'_, PyAny>) -> PyResult<[bool; 4]> {
    let numbers = long_ids("sides", value, "side")?.rows(1);
    let mut sides = [false; 4];
    for (index, number) in numbers.into_iter().enumerate() {
        let side = usize::try_from(number).ok().and_then(|side| sides.get_mut(side));
        match side {
            None => {
                let rule = "the sides of a container are 0 to 3";
                return Err(refused(Error::at("sides", index, number, rule)));
            }
            Some(true) => {
                return Err(refused(Error::at("sides", index, number, "it is given twice")));
            }
            Some(side) => *side = true,
        }
    }
    Ok(sides)
}
