//! `jostle.Pump`.

use jostle_world::forces::Pump;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arguments::{arguments, plain_arguments};
use super::{read_seed, real, real_or, valid};
use crate::arrays::point;
use crate::keywords::Keywords;
use crate::queries::one_rect;

/// A drain and a nozzle, as of a fountain: what is in the drain starts again from the nozzle.
///
/// At the beginning of each step a movable particle whose centre is in the drain is taken with the
/// probability 1 - exp(-rate dt). It keeps its id and all columns but position and velocity. It starts
/// somewhere along the width of the nozzle, and from there it has already flown for a random part of
/// the step, so a jet is as even with long steps as with short ones. The random numbers are functions
/// of `seed`, the particle's state and the time, so results have the same bits for every number of
/// threads and every order of adding.
///
/// Parameters
/// ----------
/// drain : array_like, shape (4,), or Box
///     Sides min_x, min_y, max_x, max_y of the drain, in units of length.
/// position : array_like, shape (2,)
///     Centre of the nozzle, in units of length.
/// velocity : array_like, shape (2,)
///     Mean velocity of what leaves it, in units of length per second.
/// rate : float
///     Mean number of times per second at which a particle in the drain is taken, at least 0. The
///     number of particles in the drain times this leaves the nozzle per second.
/// width : float, default 0.0
///     Length of the line on which particles start, perpendicular to the velocity.
/// spread : float, default 0.0
///     Maximum random addition to the velocity, in any direction, in units of length per second.
/// seed : int, default 0
///     Seed of the random numbers, below 2³².
///
/// Raises
/// ------
/// TypeError
///     If an argument has the wrong type.
/// ValueError
///     If a number is out of range, or a min of the drain is not below its max.
///
/// See Also
/// --------
/// World.add, World.remove : Particles that come and go.
///
/// Notes
/// -----
/// A pump adds energy and momentum. The nozzle does not look for room: particles that overlap there
/// are pushed apart, without a change of their velocities, as everywhere. A world with pumps does not
/// sleep. Of several pumps whose drains have a particle in common, the first one that takes it counts.
///
/// Examples
/// --------
/// A jet that falls back into its basin:
///
/// >>> import jostle
/// >>> box = jostle.Box(0, 0, 40, 60)
/// >>> water = [(x, y) for x in range(1, 40, 2) for y in (1, 3, 5)]
/// >>> world = jostle.World(water, 0.8, gravity=(0, -10), restitution=0.3, container=box)
/// >>> world.forces = [jostle.Pump((0, 0, 40, 4), (20, 10), (0, 25), rate=0.5, width=4, spread=1)]
/// >>> world.step(1 / 60, steps=120)
/// >>> bool(world.positions[:, 1].max() > 30), len(world)
/// (True, 60)
#[pyclass(module = "jostle", name = "Pump", frozen, eq)]
#[derive(PartialEq)]
pub struct PyPump(pub Pump);

#[pymethods]
impl PyPump {
    #[new]
    #[pyo3(
        signature = (*arguments, **keywords),
        text_signature = "(drain, position, velocity, *, rate, width=0.0, spread=0.0, seed=0)"
    )]
    fn new(arguments: &Bound<'_, PyTuple>, keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let names = ["drain", "position", "velocity"];
        let mut given = Keywords::of_all("Pump()", &names, arguments, keywords)?;
        let [drain, position, velocity, rate] =
            given.require(["drain", "position", "velocity", "rate"])?;
        let [width, spread, seed] = ["width", "spread", "seed"].map(|name| given.given(name));
        given.end()?;
        let pump = Pump {
            drain: one_rect("drain", &drain)?,
            position: point("position", &position)?,
            velocity: point("velocity", &velocity)?,
            rate: real("rate", &rate)?,
            width: real_or("width", &width, 0.0)?,
            spread: real_or("spread", &spread, 0.0)?,
            seed: read_seed(&seed)?,
        };
        Ok(Self(valid(pump, Pump::validate)?))
    }
}

arguments! {
    PyPump {
        /// Sides of the drain, (min_x, min_y, max_x, max_y).
        drain: |own| own.0.drain;
        /// Centre of the nozzle, (x, y).
        position: |own| own.0.position;
        /// Mean velocity of what leaves it, (x, y).
        velocity: |own| own.0.velocity;
    }
    keywords {
        /// How often a particle in the drain is taken, per second.
        rate: |own| own.0.rate;
        /// Length of the line on which particles start.
        width: |own| own.0.width;
        /// Maximum random addition to the velocity.
        spread: |own| own.0.spread;
        /// The seed of the random numbers.
        seed: |own| own.0.seed;
    }
}
plain_arguments!(PyPump);
