//! A force that brings one particle to a point, as a hand or the mouse does.

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
        let (middle, velocity) = (bodies.positions[index], bodies.velocities[index]);
        let offset = [0, 1].map(|k| self.point[k] - middle[k]);
        let offset = bodies.container.period().minimum_image(offset);
        // The velocity at the end of the time h follows from the force at the end: v' = v + h (ω² (d − h v') − 2 ω v'),
        // with the offset d at its beginning. So a large ω h leads to no oscillation that grows. The offset here is
        // that after half of a free flight, d − h v / 2.
        let (rate, share) =
            (f64::from(self.rate), f64::from(self.rate) * f64::from(bodies.seconds));
        let divisor = (1.0 + share) * (1.0 + share);
        let pull = [0, 1].map(|k| {
            let (offset, velocity) = (f64::from(offset[k]), f64::from(velocity[k]));
            rate * (rate * offset - (2.0 + 0.5 * share) * velocity) / divisor
        });
        let most = f64::from(self.max_force) / f64::from(bodies.masses[index]);
        let size = (pull[0] * pull[0] + pull[1] * pull[1]).sqrt();
        let factor = if size > most { most / size } else { 1.0 };
        pull.map(|a| (a * factor) as f32)
    }
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
