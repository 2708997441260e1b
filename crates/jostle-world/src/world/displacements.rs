//! How far particles would travel in a step without collisions: refuses steps in which this is too far, and divides
//! those of particles that merge on a torus.

use super::reductions::largest;
use super::{OnTouch, World};
use crate::container::MAX_TOURS;
use crate::particles::FARTHEST;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;

impl World {
    /// The smallest id of a particle with this `number`, for an error.
    pub(crate) fn id_of(&self, number: f32, of: impl Fn(usize) -> f32) -> Id {
        // The number comes from the same function, so equality finds its particle. Of several it is
        // the smallest id, which depends on no order.
        let indices = (0..self.bodies.awake.rows.len()).filter(|&index| of(index) == number);
        indices.map(|index| self.id_among_all(self.bodies.awake.rows[index])).min().unwrap_or(0)
    }

    /// The longer side of the box of a particle's displacement without collisions in `dt` seconds,
    /// or more.
    fn displacement(&self, index: usize, dt: f32) -> f32 {
        let (gravity, v) = (self.settings.gravity, self.bodies.awake.particles.velocities[index]);
        let along = |k: usize| (v[k].abs() + gravity[k].abs() * dt) * dt;
        along(0).max(along(1))
    }

    /// The largest of these displacements.
    fn longest_displacement(&self, dt: f32) -> f32 {
        largest((0..self.bodies.awake.rows.len()).map(|index| self.displacement(index, dt)))
    }

    /// Refuses a step in which a particle would move too far.
    pub(crate) fn check_displacements(&self, dt: f32) -> Result<()> {
        let longest = self.longest_displacement(dt);
        let tours = longest / self.settings.container.period().shortest();
        if longest <= FARTHEST && tours <= MAX_TOURS {
            return Ok(());
        }
        let id = self.id_of(longest, |index| self.displacement(index, dt));
        let rule = if longest > FARTHEST {
            let most = FARTHEST;
            format!("particle {id} would move by {longest:e}, more than {most:e}")
        } else {
            format!("particle {id} would circle the torus {tours} times; take smaller steps")
        };
        Err(Error::of("dt", dt, &rule))
    }

    /// The number of parts of a step of `dt` seconds: one, unless particles merge on a torus. These
    /// touch only their nearest images.
    pub(crate) fn parts(&self, dt: f32) -> Result<usize> {
        if self.settings.on_touch != OnTouch::Merge {
            return Ok(1);
        }
        // The longest of all ranks, because all must make the same number of parts.
        let [longest] = self.halo().largest([f64::from(self.longest_displacement(dt))])?;
        let parts = longest as f32 / self.settings.container.max_displacement();
        Ok(parts.ceil().max(1.0) as usize)
    }
}
