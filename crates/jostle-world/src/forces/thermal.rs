//! Thermal walls and Andersen's thermostat, which both sample the canonical ensemble.

use super::chance::Chance;
use super::check_number;
use super::record::{WallIds, record};
use crate::container::{Container, FIRST_SIDE, KNOWN_SIDES, SIDE_NAMES};
use crate::particles::FARTHEST;
use crate::walls::number_of;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;

/// Maximum standard deviation of a velocity, so that velocities are within the limits of a world.
const LARGEST: f64 = FARTHEST as f64 / 16.0;

record! {
    /// Sides of the container, and walls, with a temperature. A disc leaves such a wall with the
    /// velocity of a particle that enters through it from an ideal gas: p(v) ∝ v e^(−m v²/2kT) along
    /// the normal, and a normal distribution along the wall (R. Tehver et al., *Thermal walls in
    /// computer simulations*, Phys. Rev. E 57, R17, 1998).
    #[derive(Clone, Debug, PartialEq)]
    pub struct ThermalWalls {
        /// Boltzmann's constant times the temperature: the mean kinetic energy of a disc.
        pub temperature: f32,
        /// Whether each side has the temperature: min x, max x, min y, max y, and the rim of a circle. If all have it,
        /// those of any container do.
        pub sides: [bool; KNOWN_SIDES],
        /// The ids of the walls that have the temperature, on both sides.
        pub walls: WallIds,
        /// Seed of the random numbers.
        pub seed: u32,
    }
}

impl ThermalWalls {
    /// The numbers of its sides in a container; the rim is the first side of a round one.
    pub fn side_numbers(&self) -> impl Iterator<Item = u32> + use<> {
        let [first, b, c, d, rim] = self.sides;
        (0..).zip([first || rim, b, c, d]).filter_map(|(side, has_it)| has_it.then_some(side))
    }

    /// The public ids of its sides.
    pub fn side_ids(&self) -> impl Iterator<Item = Id> + use<> {
        (0..).zip(self.sides).filter(|(_, has_it)| *has_it).map(|(side, _)| FIRST_SIDE - side)
    }

    /// The names of its sides.
    pub fn side_names(&self) -> Vec<&'static str> {
        SIDE_NAMES.into_iter().zip(self.sides).filter_map(|(of, has)| has.then_some(of)).collect()
    }

    /// Whether a side or a wall has the temperature.
    pub(super) fn has_any(&self) -> bool {
        self.sides.contains(&true) || !self.walls.0.is_empty()
    }

    /// Refuses numbers out of range, and a wall that is named twice.
    pub fn validate(&self) -> Result<()> {
        check_temperature(self.temperature)?;
        self.walls.validate()?;
        if self.has_any() {
            return Ok(());
        }
        Err(Error::of("sides", "()", "at least one side or wall must have the temperature"))
    }

    /// Why a container does not have its sides; None if it has them.
    pub(super) fn misfit(&self, container: Container) -> Option<&'static str> {
        let [flat @ .., rim] = self.sides;
        let any = rim || flat.contains(&true);
        let (is_wrong, rule) = match container {
            Container::Box { .. } => (rim, "a Box has no RIM"),
            Container::Circle { .. } => (flat.contains(&true), "a Circle has one side, RIM"),
            Container::Torus { .. } => (any, "a periodic world has no sides"),
            Container::None => (any, "a world without a container has no sides"),
        };
        let is_all = self.sides == [true; KNOWN_SIDES] && container.has_sides();
        (is_wrong && !is_all).then_some(rule)
    }
}

record! {
    /// A thermostat that gives each disc a new, normally distributed velocity at random times (H. C.
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

/// The sides of the container and the walls that have a temperature, in one step.
#[derive(Debug, Default)]
pub struct WallTemperatures {
    /// Temperature and seed of the wall with each number; None if it has no temperature. Empty if
    /// no wall has one.
    all: Vec<Option<(f32, u32)>>,
    /// Time at the beginning of the step.
    time: f64,
}

impl WallTemperatures {
    /// Lists the walls that have a temperature in a step that begins at `time`. `row` has the row of a wall.
    pub fn fill<'a>(
        &mut self,
        forces: impl Iterator<Item = &'a ThermalWalls>,
        row: impl Fn(Id) -> Option<u32>,
        time: f64,
    ) {
        self.all.clear();
        self.time = time;
        for walls in forces {
            let rows = walls.walls.0.iter().filter_map(|&wall| row(wall));
            for number in walls.side_numbers().chain(rows.map(number_of)) {
                // The later of two walls with a number would win, but two are refused before.
                let number = number as usize;
                self.all.resize(self.all.len().max(number + 1), None);
                self.all[number] = Some((walls.temperature, walls.seed));
            }
        }
    }

    /// Whether no wall has a temperature.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// The velocity of a disc against a wall after an impact on it at `time`: the components along
    /// the normal and along the wall; None if the wall has no temperature. The random numbers
    /// depend on the seed, the position and velocity at the impact, and the time.
    pub fn speeds(
        &self,
        wall: u32,
        inverse_mass: f64,
        time: f64,
        [[x, y], [u, v]]: [[f64; 2]; 2],
    ) -> Option<[f64; 2]> {
        let (temperature, seed) = (*self.all.get(wall as usize)?)?;
        // The state just before the impact, the wall and the time decide. So other particles,
        // threads and the order of events have no influence, and two impacts of a particle have
        // different numbers.
        let mut chance = Chance::of(seed, &[x, y, u, v, f64::from(wall), time, self.time]);
        let speed = thermal_speed(temperature, inverse_mass);
        // Through a wall of a gas come fast particles more often than slow ones: the component
        // along the normal has the distribution of a flux, the other one that of the gas.
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
