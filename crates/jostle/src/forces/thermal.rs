//! Thermal walls and Andersen's thermostat, which both sample the canonical ensemble.

use super::chance::Chance;
use super::check_number;
use crate::container::MAX_WALLS;
use crate::error::{Error, Result};
use crate::particles::FARTHEST;

/// Maximum standard deviation of a velocity, so that velocities are within the limits of a world.
const LARGEST: f64 = FARTHEST as f64 / 16.0;

/// Sides of the container with a temperature. A disc leaves such a side with the velocity of a
/// particle that enters through it from an ideal gas: p(v) ∝ v e^(−m v²/2kT) along the normal, and
/// a normal distribution along the wall (R. Tehver et al., *Thermal walls in computer simulations*,
/// Phys. Rev. E 57, R17, 1998).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThermalWalls {
    /// Boltzmann's constant times the temperature: the mean kinetic energy of a disc.
    pub temperature: f32,
    /// Whether each side has the temperature: min x, max x, min y, max y; a circle uses the first.
    pub sides: [bool; MAX_WALLS],
    /// Seed of the random numbers.
    pub seed: u32,
}

impl ThermalWalls {
    /// Refuses numbers out of range.
    pub fn validate(&self) -> Result<()> {
        check_temperature(self.temperature)?;
        if self.sides.contains(&true) {
            return Ok(());
        }
        Err(Error::of("sides", "()", "at least one side must have the temperature"))
    }
}

/// A heat bath that gives each disc a new, normally distributed velocity at random times (H. C.
/// Andersen, *Molecular dynamics simulations at constant pressure and/or temperature*, J. Chem.
/// Phys. 72, 2384, 1980).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Andersen {
    /// Boltzmann's constant times the temperature.
    pub temperature: f32,
    /// Mean number of new velocities of a disc per second.
    pub rate: f32,
    /// Seed of the random numbers.
    pub seed: u32,
}

impl Andersen {
    /// Refuses numbers out of range.
    pub fn validate(&self) -> Result<()> {
        check_temperature(self.temperature)?;
        check_number("rate", self.rate, 0.0)
    }

    /// The new velocity of a disc in a step of `dt` seconds, or None. The random numbers depend on
    /// the seed and `state`.
    pub fn velocity(&self, mass: f32, dt: f32, state: &[f64]) -> Option<[f32; 2]> {
        let mut chance = Chance::of(self.seed, state);
        // The time until the next one is exponentially distributed.
        if chance.exponential() >= f64::from(self.rate) * f64::from(dt) {
            return None;
        }
        let speed = thermal_speed(self.temperature, 1.0 / f64::from(mass));
        Some(chance.normal().map(|v| (v * speed) as f32))
    }
}

/// The sides of the container that have a temperature, in one step.
#[derive(Clone, Copy, Debug)]
pub struct ThermalSides {
    /// Temperature and seed of each side; None if it has no temperature.
    sides: [Option<(f32, u32)>; MAX_WALLS],
    /// Time at the beginning of the step.
    time: f64,
}

impl ThermalSides {
    /// The sides that have a temperature; None if no side has one.
    pub fn of(all: impl Iterator<Item = ThermalWalls>, time: f64) -> Option<Self> {
        let mut sides = [None; MAX_WALLS];
        for walls in all {
            for (side, is_hot) in sides.iter_mut().zip(walls.sides) {
                if is_hot {
                    *side = Some((walls.temperature, walls.seed));
                }
            }
        }
        sides.iter().any(Option::is_some).then_some(Self { sides, time })
    }

    /// The velocity of a disc after an impact on a wall at `time`: the components along the normal
    /// and along the wall; None if the wall has no temperature. The random numbers depend on the
    /// seed, the position and velocity at the impact, and the time.
    pub fn speeds(
        &self,
        wall: u32,
        inverse_mass: f64,
        time: f64,
        [[x, y], [u, v]]: [[f64; 2]; 2],
    ) -> Option<[f64; 2]> {
        let (temperature, seed) = (*self.sides.get(wall as usize)?)?;
        let mut chance = Chance::of(seed, &[x, y, u, v, f64::from(wall), time, self.time]);
        let speed = thermal_speed(temperature, inverse_mass);
        let [along, _] = chance.normal();
        Some([chance.flux() * speed, along * speed])
    }
}

/// The standard deviation of each component of the velocity, √(kT/m).
fn thermal_speed(temperature: f32, inverse_mass: f64) -> f64 {
    (f64::from(temperature) * inverse_mass).sqrt().min(LARGEST)
}

fn check_temperature(temperature: f32) -> Result<()> {
    check_number("temperature", temperature, 0.0)?;
    if temperature > 0.0 {
        return Ok(());
    }
    Err(Error::of("temperature", temperature, "it must be above 0"))
}
