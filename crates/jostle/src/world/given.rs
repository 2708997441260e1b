//! Accelerations that callers give, by forces of their own. They act until they are replaced.

use super::World;
use crate::error::{Error, Result};
use crate::forces;
use crate::particles::check_vectors;
use crate::space::Id;

impl World {
    /// The given accelerations in the order of adding; empty if there are none.
    pub fn given_accelerations(&self) -> &[[f32; 2]] {
        &self.given
    }

    /// Gives each particle an acceleration, beside those of forces and gravity, in place of what was
    /// given before. Particles that are accelerated wake.
    pub fn set_accelerations(&mut self, accelerations: Vec<[f32; 2]>) -> Result<()> {
        let (found, expected) = (accelerations.len(), self.len());
        if found != expected {
            return Err(Error::Length { argument: "accelerations", found, expected });
        }
        check_vectors("accelerations", &accelerations)?;
        self.replace_given(accelerations);
        Ok(())
    }

    /// Ends all given accelerations.
    pub fn clear_accelerations(&mut self) {
        self.given.clear();
    }

    /// Adds forces on some particles to what was given.
    pub fn add_forces(&mut self, ids: &[Id], newtons: &[[f32; 2]]) -> Result<()> {
        let rows = self.rows_of(ids)?;
        check_vectors("forces", newtons)?;
        let mut sums: Vec<[f64; 2]> = self.given.iter().map(|given| given.map(f64::from)).collect();
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
            let rule = "the acceleration of the particle would be too large";
            return Err(Error::at("forces", index, format!("({x}, {y})"), rule));
        }
        self.replace_given(sums);
        Ok(())
    }

    /// Replaces what was given; nothing accelerates immovable particles.
    fn replace_given(&mut self, mut accelerations: Vec<[f32; 2]>) {
        for (given, movable) in accelerations.iter_mut().zip(self.movable()) {
            *given = if movable { *given } else { [0.0; 2] };
        }
        let acts = (0..).zip(&accelerations).filter(|(_, given)| **given != [0.0; 2]);
        let rows: Vec<u32> = acts.map(|(row, _)| row).collect();
        if rows.is_empty() {
            self.given.clear();
        } else {
            self.wake_changed(&rows);
            self.given = accelerations;
        }
    }

    /// Ends the given accelerations if they accelerate no particle, of any rank.
    pub(super) fn end_given_of_none(&mut self) -> Result<()> {
        let is_given = self.given.iter().any(|given| *given != [0.0; 2]);
        if !self.given.is_empty() && !self.any_of_all(is_given)? {
            self.given.clear();
        }
        Ok(())
    }

    /// Whether anything accelerates particles, apart from gravity and springs.
    pub(super) fn has_accelerations(&self) -> bool {
        !self.given.is_empty() || forces::pull(&self.forces)
    }
}

/// Adds given accelerations to those at each place.
pub(super) fn add_given(accelerations: &mut [[f32; 2]], rows: &[u32], given: &[[f32; 2]]) {
    if given.is_empty() {
        return;
    }
    for (sum, &row) in accelerations.iter_mut().zip(rows) {
        let own = given[row as usize];
        *sum = [0, 1].map(|k| sum[k] + own[k]);
    }
}
