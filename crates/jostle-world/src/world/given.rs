//! Accelerations and forces that callers compute themselves. They act until they are replaced. In a distributed
//! world all processes make the same calls, each for its own particles, and there are no ghosts.

use super::World;
use crate::particles::check_vectors;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;

impl World {
    /// The given accelerations in the order of adding; empty if there are none.
    pub fn given_accelerations(&self) -> &[[f32; 2]] {
        self.given.as_deref().unwrap_or_default()
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
        self.replace_given(accelerations)
    }

    /// Ends all given accelerations.
    pub fn clear_accelerations(&mut self) {
        self.given = None;
    }

    /// Adds forces on some particles to what was given.
    pub fn add_forces(&mut self, ids: &[Id], newtons: &[[f32; 2]]) -> Result<()> {
        let sums = self.with_forces(ids, newtons);
        let sums = self.tell_error(sums)?;
        self.replace_given(sums)
    }

    /// The given accelerations with those by some forces.
    fn with_forces(&self, ids: &[Id], newtons: &[[f32; 2]]) -> Result<Vec<[f32; 2]>> {
        let rows = self.rows_of(ids)?;
        check_vectors("forces", newtons)?;
        let given = self.given_accelerations();
        let mut sums: Vec<[f64; 2]> = given.iter().map(|given| given.map(f64::from)).collect();
        sums.resize(self.len(), [0.0; 2]);
        let masses = self.masses();
        for (&row, force) in rows.iter().zip(newtons) {
            let row = row as usize;
            let mass = f64::from(masses[row]);
            sums[row] = [0, 1].map(|k| sums[row][k] + f64::from(force[k]) / mass);
        }
        let sums: Vec<[f32; 2]> = sums.into_iter().map(|sum| sum.map(|a| a as f32)).collect();
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

    /// Replaces what was given; nothing accelerates immovable particles.
    fn replace_given(&mut self, mut accelerations: Vec<[f32; 2]>) -> Result<()> {
        for (given, movable) in accelerations.iter_mut().zip(self.movable()) {
            *given = if movable { *given } else { [0.0; 2] };
        }
        let acts = (0..).zip(&accelerations).filter(|(_, given)| **given != [0.0; 2]);
        let rows: Vec<u32> = acts.map(|(row, _)| row).collect();
        let acts = self.halo().any(!rows.is_empty())?;
        if acts {
            self.halo.protocol().wake_edited(self, &mut [], &rows)?;
        }
        self.given = acts.then_some(accelerations);
        Ok(())
    }

    /// Removes the given accelerations if they are 0 for all particles of all processes.
    pub(crate) fn end_given_of_none(&mut self) -> Result<()> {
        let acts = self.given_accelerations().iter().any(|given| *given != [0.0; 2]);
        if self.given.is_some() && !self.halo().any(acts)? {
            self.given = None;
        }
        Ok(())
    }

    /// Whether anything accelerates particles, apart from gravity and springs.
    pub(crate) fn has_accelerations(&self) -> bool {
        self.given.is_some() || self.influences.has_forces()
    }
}

/// Adds the given acceleration of each particle. `accelerations` and `rows` are by index, `given` by row.
pub(crate) fn add_given(accelerations: &mut [[f32; 2]], rows: &[u32], given: Option<&[[f32; 2]]>) {
    let Some(given) = given else { return };
    for (sum, &row) in accelerations.iter_mut().zip(rows) {
        let own = given[row as usize];
        *sum = [0, 1].map(|k| sum[k] + own[k]);
    }
}
