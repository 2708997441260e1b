//! A force that brings one particle to a point, such as that of the mouse.

use super::record::record;
use super::{ASLEEP, Force, ForceInput, Partners, Scratch, check_number, check_pair};
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;

record! {
    /// A critically damped spring from a particle to a point, with a force of at most a limit.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Grab {
        /// The particle. It stays awake.
        pub id: Id,
        /// Where it is brought.
        pub point: [f32; 2],
        /// Per second: a particle at rest at the distance d is at d (1 + rate t) e^(−rate t) after t seconds.
        pub rate: f32,
        /// Limit of the force; may be infinite.
        pub max_force: f32,
    }
}

impl Grab {
    /// Refuses numbers out of range.
    pub fn validate(&self) -> Result<()> {
        check_pair("point", self.point)?;
        check_number("rate", self.rate, 0.0)?;
        if self.max_force.is_nan() || self.max_force < 0.0 {
            return Err(Error::of("max_force", self.max_force, "it must be at least 0"));
        }
        Ok(())
    }

    /// The acceleration of the body at an index.
    fn pull(&self, bodies: &ForceInput<'_>, index: usize) -> [f32; 2] {
        let (middle, velocity) = (bodies.positions[index], bodies.velocities[index].map(f64::from));
        let left = [0, 1].map(|k| self.point[k] - middle[k]);
        let left = bodies.container.period().minimum_image(left).map(f64::from);
        let h = f64::from(bodies.seconds);
        // Positions are those after half of a free flight.
        let way = [0, 1].map(|k| left[k] + 0.5 * h * velocity[k]);
        let pull = [0, 1].map(|k| acceleration([way[k], velocity[k]], f64::from(self.rate), h));
        let most = f64::from(self.max_force) / f64::from(bodies.masses[index]);
        let size = (pull[0] * pull[0] + pull[1] * pull[1]).sqrt();
        let factor = if size > most { most / size } else { 1.0 };
        pull.map(|a| (a * factor) as f32)
    }
}

/// The acceleration in a sub-step of `h` seconds without a limit; `way` is the offset to the point.
///
/// Let ω be the rate, u the velocity and c the offset. A sub-step changes the velocity u by Δ and c by −h (u + Δ/2),
/// because half of a kick comes before the flight. With Δ = α c/h − β u this is a linear map of (c, u h). Both of its
/// eigenvalues are q if α = (1 − q)² and β = (1 − q)(3 + q)/2. A double real eigenvalue is critical damping, of the
/// sub-steps themselves: a particle at rest does not move beyond the point, however large ω h is. q = 1/(1 + ω h) tends
/// to exp(−ω h) for short sub-steps.
fn acceleration([way, velocity]: [f64; 2], rate: f64, h: f64) -> f64 {
    let q = 1.0 / (1.0 + rate * h);
    // (1 − q)/h, without a division by h, which is 0 where forces are computed outside of a step.
    let r = rate * q;
    r * r * way - 0.5 * r * (3.0 + q) * velocity
}

impl Force for Grab {
    fn accelerate(
        &self,
        bodies: &ForceInput<'_>,
        _: &mut Scratch,
        sums: &mut [[f32; 2]],
    ) -> Result<()> {
        let index = bodies.indices[self.id as usize];
        if index != ASLEEP {
            let pull = self.pull(bodies, index as usize);
            let sum = &mut sums[index as usize];
            *sum = [0, 1].map(|k| sum[k] + pull[k]);
        }
        Ok(())
    }

    fn limit(&self, _: &ForceInput<'_>, _: &mut [[f32; 2]]) {}

    /// It takes energy away, so it has no potential.
    fn energy(&self, _: &ForceInput<'_>) -> Result<f64> {
        Ok(0.0)
    }

    fn partners(&self) -> Partners {
        Partners::One(self.id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sub_steps_are_critically_damped_at_every_rate() {
        for rate in [0.01, 1.0, 30.0, 1e4, 1e9] {
            let h = 1.0 / 240.0;
            let q = 1.0 / (1.0 + rate * h);
            let (mut way, mut velocity) = (1.0, 0.0);
            for n in 1..=60 {
                let change = h * acceleration([way, velocity], rate, h);
                way -= h * (velocity + 0.5 * change);
                velocity += change;
                // The solution of the recurrence with the double eigenvalue q that begins at rest.
                let first = 1.0 - 0.5 * (1.0 - q) * (1.0 - q);
                let right = f64::powi(q, n - 1) * (q + f64::from(n) * (first - q));
                assert!((way - right).abs() < 1e-9 && way > -1e-9, "{rate} {n}: {way} {right}");
            }
        }
    }
}
