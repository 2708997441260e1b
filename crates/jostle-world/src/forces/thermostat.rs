//! The article's thermostat: walls change the speed of particles that bounce off them.

use super::check_number;
use super::record::record;
use jostle_base::error::{Error, Result};

record! {
    /// Every bounce off a wall changes the speed s to s + rate · (speed − s), as in the
    /// article.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Thermostat {
        /// The target speed.
        pub speed: f32,
        /// Relative change by one bounce, 0 to 1.
        pub rate: f32,
    }
}

impl Thermostat {
    /// Refuses numbers out of range.
    pub fn validate(&self) -> Result<()> {
        check_number("speed", self.speed, 0.0)?;
        if (0.0..=1.0).contains(&self.rate) {
            return Ok(());
        }
        Err(Error::of("rate", self.rate, "it must lie between 0 and 1"))
    }

    /// The velocity after a bounce off a wall, from the velocity without the thermostat.
    pub fn bounced(&self, velocity: [f64; 2]) -> [f64; 2] {
        let [x, y] = velocity;
        let speed = (x * x + y * y).sqrt();
        // A particle without a velocity has no direction.
        if speed == 0.0 {
            return velocity;
        }
        let new = speed + f64::from(self.rate) * (f64::from(self.speed) - speed);
        velocity.map(|v| v * (new / speed))
    }
}
