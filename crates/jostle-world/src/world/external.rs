//! Accelerations and forces that callers compute themselves. They act until they are replaced. In a distributed
//! world all processes make the same calls, each for its own particles, and there are no ghosts.

use super::World;
use crate::particles::check_vectors;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;

impl World {
    /// The external accelerations in the order of adding; empty if there are none.
    pub fn external_accelerations(&self) -> &[[f32; 2]] {
        self.external.as_deref().unwrap_or_default()
    }

    /// Gives each particle an acceleration, beside those of forces and gravity, in place of what was
    /// given before. Particles that are accelerated wake.
    pub fn set_accelerations(&mut self, accelerations: Vec<[f32; 2]>) -> Result<()> {
        let (found, expected) = (accelerations.len(), self.len());
        let checked = if found == expected {
            check_vectors("accelerations", &accelerations)
        } else {
            Err(Error::Length { argument: "accelerations", found, expected })
        };
        self.tell_error(checked)?;
        self.replace_external(accelerations)
    }

    /// Ends all external accelerations.
    pub fn clear_accelerations(&mut self) {
        self.external = None;
    }

    /// Adds forces on some particles to the external ones.
    pub fn add_forces(&mut self, ids: &[Id], newtons: &[[f32; 2]]) -> Result<()> {
        let sums = self.with_forces(ids, newtons);
        let sums = self.tell_error(sums)?;
        self.replace_external(sums)
    }

    /// The external accelerations with those by some forces.
    fn with_forces(&self, ids: &[Id], newtons: &[[f32; 2]]) -> Result<Vec<[f32; 2]>> {
        let rows = self.bodies.rows_of(ids)?;
        check_vectors("forces", newtons)?;
        let external = self.external_accelerations();
        // Sums are in float64, so that several forces on one particle are rounded once.
        let mut sums: Vec<[f64; 2]> =
            external.iter().map(|external| external.map(f64::from)).collect();
        sums.resize(self.len(), [0.0; 2]);
        let masses = self.bodies.masses();
        for (&row, force) in rows.iter().zip(newtons) {
            let row = row as usize;
            let mass = f64::from(masses[row]);
            sums[row] = [0, 1].map(|k| sums[row][k] + f64::from(force[k]) / mass);
        }
        let sums: Vec<[f32; 2]> = sums.into_iter().map(|sum| sum.map(|a| a as f32)).collect();
        // Forces in range may add up to an acceleration out of range, for instance of a small mass.
        if let Some(index) =
            rows.iter().position(|&row| check_vectors("forces", &[sums[row as usize]]).is_err())
        {
            let [x, y] = newtons[index];
            let id = self.id_among_all(rows[index]);
            let rule = format!("the acceleration of particle {id} would be too large");
            let value = format!("({x}, {y})");
            // In a distributed world `newtons` is not the argument of the caller.
            return Err(match self.halo.is_whole() {
                true => Error::at("forces", index, value, &rule),
                false => Error::of("forces", value, &rule),
            });
        }
        Ok(sums)
    }

    /// Tells the other processes of an error, so that their next call returns one, too.
    fn tell_error<V>(&self, checked: Result<V>) -> Result<V> {
        if checked.is_err() {
            self.halo.fail();
        }
        checked
    }

    /// Replaces the external accelerations; nothing accelerates immovable particles.
    fn replace_external(&mut self, mut accelerations: Vec<[f32; 2]>) -> Result<()> {
        for (external, movable) in accelerations.iter_mut().zip(self.bodies.movable()) {
            *external = if movable { *external } else { [0.0; 2] };
        }
        let acts = (0..).zip(&accelerations).filter(|(_, external)| **external != [0.0; 2]);
        let rows: Vec<u32> = acts.map(|(row, _)| row).collect();
        // All ranks must make the same stages of a step, so all have external accelerations or
        // none.
        let acts = self.halo().any(!rows.is_empty())?;
        if acts {
            self.halo.protocol().wake_edited(self, &mut [], &rows)?;
        }
        self.external = acts.then_some(accelerations);
        Ok(())
    }

    /// Removes the external accelerations if they are 0 for all particles of all processes.
    pub(crate) fn end_external_of_none(&mut self) -> Result<()> {
        let acts = self.external_accelerations().iter().any(|external| *external != [0.0; 2]);
        if self.external.is_some() && !self.halo().any(acts)? {
            self.external = None;
        }
        Ok(())
    }

    /// Whether anything accelerates particles, apart from gravity and springs.
    pub(crate) fn has_accelerations(&self) -> bool {
        self.external.is_some() || self.influences.has_forces()
    }
}

/// Adds the external acceleration of each particle. `accelerations` and `rows` are by index, `external` by row.
pub(crate) fn add_external(
    accelerations: &mut [[f32; 2]],
    rows: &[u32],
    external: Option<&[[f32; 2]]>,
) {
    let Some(external) = external else { return };
    for (sum, &row) in accelerations.iter_mut().zip(rows) {
        let own = external[row as usize];
        *sum = [0, 1].map(|k| sum[k] + own[k]);
    }
}
