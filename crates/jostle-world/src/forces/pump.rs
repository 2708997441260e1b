//! Pumps: they take particles out of a drain, and let them start again at a nozzle.
//!
//! The number of particles stays the same, and so do their ids. What a pump does with a particle follows from the state
//! of this particle, the seed and the time alone: it depends on no index, no thread and no other particle.

use super::chance::Chance;
use super::record::record;
use super::{check_number, check_pair};
use jostle_base::error::{Error, Result};

record! {
    /// A drain and a nozzle. Movable particles whose centre is in the drain are taken at random times, at the
    /// beginning of a step. They start from the nozzle as if they had left it during that step.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Pump {
        /// The drain: min x, min y, max x, max y.
        pub drain: [f32; 4],
        /// Centre of the nozzle.
        pub position: [f32; 2],
        /// Mean velocity of what leaves it.
        pub velocity: [f32; 2],
        /// Mean number of times per second at which a particle in the drain is taken.
        pub rate: f32,
        /// Particles start on a line of this length, perpendicular to the velocity.
        pub width: f32,
        /// Maximum deviation of the velocity, in any direction.
        pub spread: f32,
        /// Seed of the random numbers.
        pub seed: u32,
    }
}

impl Pump {
    /// Refuses numbers out of range.
    pub fn validate(&self) -> Result<()> {
        let [min_x, min_y, max_x, max_y] = self.drain;
        check_pair("drain", [min_x, min_y])?;
        check_pair("drain", [max_x, max_y])?;
        if !(min_x < max_x && min_y < max_y) {
            let value = format!("({min_x}, {min_y}, {max_x}, {max_y})");
            return Err(Error::of("drain", value, "its min must be below its max"));
        }
        check_pair("position", self.position)?;
        check_pair("velocity", self.velocity)?;
        check_number("rate", self.rate, 0.0)?;
        check_number("width", self.width, 0.0)?;
        check_number("spread", self.spread, 0.0)
    }

    /// Position and velocity with which a particle at a place starts again in a step of `dt` seconds; None if it is
    /// not taken. The random numbers depend on the seed and `state`.
    pub fn start(&self, place: [f64; 2], dt: f64, state: &[f64]) -> Option<[[f64; 2]; 2]> {
        let [min_x, min_y, max_x, max_y] = self.drain.map(f64::from);
        let [x, y] = place;
        if !(min_x <= x && x <= max_x && min_y <= y && y <= max_y) {
            return None;
        }
        let mut chance = Chance::of(self.seed, state);
        // The time until it is taken is exponentially distributed.
        if chance.exponential() >= f64::from(self.rate) * dt {
            return None;
        }
        let [u, v] = self.velocity.map(f64::from);
        let speed = (u * u + v * v).sqrt();
        let across = if speed > 0.0 { [-v / speed, u / speed] } else { [1.0, 0.0] };
        let aside = (chance.unit() - 0.5) * f64::from(self.width);
        // Those of many steps have even distances on average, whatever the length of a step.
        let age = chance.unit() * dt;
        let [a, b] = in_disc(&mut chance).map(|w| w * f64::from(self.spread));
        let velocity = [u + a, v + b];
        let start =
            [0, 1].map(|k| f64::from(self.position[k]) + across[k] * aside + velocity[k] * age);
        Some([start, velocity])
    }
}

/// A random point in the unit disc.
fn in_disc(chance: &mut Chance) -> [f64; 2] {
    loop {
        let [x, y] = [0, 1].map(|_| 2.0 * chance.unit() - 1.0);
        if x * x + y * y <= 1.0 {
            return [x, y];
        }
    }
}
