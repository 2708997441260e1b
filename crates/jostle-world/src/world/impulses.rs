//! Impulses that callers give to particles.

use super::World;
use super::edits::set_rows;
use super::external::{change_by, tell_error, too_large};
use crate::particles::{Changes, Particles, check_vectors};
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::memory;
use jostle_index::shapes::Each;

/// New velocities of particles, in float64.
struct Pushed {
    rows: Vec<u32>,
    velocities: Vec<[f64; 2]>,
    angular_velocities: Vec<f64>,
}

impl World {
    /// Gives impulses to some particles, at once: each adds up to the velocity of its particle, and, at a point
    /// outside of the centre, to its angular velocity. One may be given more than once. Immovable particles do not
    /// change, particles of radius 0 do not begin to rotate. Those that change wake.
    pub fn apply_impulses(
        &mut self,
        ids: &[Id],
        impulses: &[[f32; 2]],
        points: Option<&[[f32; 2]]>,
    ) -> Result<()> {
        let changes = self.pushed(ids, impulses, points);
        let (rows, changes) = tell_error(&*self.halo, changes)?;
        set_rows(self, &rows, &changes)
    }

    /// The rows that change, and their new velocities, each rounded once.
    fn pushed(
        &self,
        ids: &[Id],
        impulses: &[[f32; 2]],
        points: Option<&[[f32; 2]]>,
    ) -> Result<(Vec<u32>, Changes)> {
        let given = self.bodies.rows_of(ids)?;
        check_vectors("impulses", impulses)?;
        check_vectors("points", points.unwrap_or_default())?;
        let mut rows = memory::copy(&given)?;
        rows.sort_unstable();
        rows.dedup();
        let all = self.bodies.particles_in(&rows)?;
        let mut pushed = Pushed {
            velocities: memory::collect(all.velocities.iter().map(|v| v.map(f64::from)))?,
            angular_velocities: memory::collect(
                (0..all.len()).map(|at| f64::from(all.spin(at).velocity)),
            )?,
            rows,
        };
        for (nth, (row, &impulse)) in given.iter().zip(impulses).enumerate() {
            let Ok(at) = pushed.rows.binary_search(row) else { continue };
            self.push(&all, at, impulse, points.map(|points| points[nth]), &mut pushed);
        }
        let is_wrong = |at: usize| {
            let [u, v] = pushed.velocities[at].map(|of| of as f32);
            let turning = pushed.angular_velocities[at] as f32;
            check_vectors("impulses", &[[u, v], [turning, 0.0]]).is_err()
        };
        if let Some(nth) =
            given.iter().position(|row| pushed.rows.binary_search(row).is_ok_and(is_wrong))
        {
            let what = "velocity";
            return Err(too_large(
                &self.bodies,
                &*self.halo,
                "impulses",
                (nth, impulses),
                given[nth],
                what,
            ));
        }
        let velocities = pushed.velocities.iter().map(|v| v.map(|of| of as f32));
        let turning = pushed.angular_velocities.iter().map(|&of| of as f32);
        let changes = Changes {
            velocities: Some(Each::Rows(memory::collect(velocities)?)),
            angular_velocities: match points {
                Some(_) => Some(Each::Rows(memory::collect(turning)?)),
                None => None,
            },
            ..Changes::default()
        };
        Ok((pushed.rows, changes))
    }

    /// Adds an impulse to the velocities of a particle.
    fn push(
        &self,
        all: &Particles,
        at: usize,
        impulse: [f32; 2],
        point: Option<[f32; 2]>,
        pushed: &mut Pushed,
    ) {
        if !all.movable[at] {
            return;
        }
        let period = self.settings.container.period().exact();
        let [x, y, turn] = change_by(all, at, (impulse, point), &period);
        let [u, v] = pushed.velocities[at];
        pushed.velocities[at] = [u + x, v + y];
        pushed.angular_velocities[at] += turn;
    }
}
