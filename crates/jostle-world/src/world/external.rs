//! Accelerations and forces that callers compute themselves. They act until they are replaced. In a distributed
//! world all processes make the same calls, each for its own particles, and there are no ghosts.

use super::World;
use super::bodies::Bodies;
use super::bodies::ids::retain_unless;
use super::distribution::Distribution;
use crate::forces::Influences;
use crate::halo::Halo;
use crate::particles::{Particles, check_vectors};
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::memory::{self, copy_option};
use jostle_base::saved;

/// The external accelerations, by row.
#[derive(Debug, Default)]
pub(crate) struct External {
    /// None if there are none on any process.
    pub(crate) accelerations: Option<Vec<[f32; 2]>>,
    /// Those before the attempt at a step.
    before: Option<Vec<[f32; 2]>>,
}

saved! { struct External { accelerations; before } }

impl External {
    /// Whether there are any, on any process.
    pub(crate) fn act(&self) -> bool {
        self.accelerations.is_some()
    }

    /// Those of all rows; empty if there are none.
    pub(crate) fn all(&self) -> &[[f32; 2]] {
        self.accelerations.as_deref().unwrap_or_default()
    }

    /// That of a row.
    pub(crate) fn of(&self, row: u32) -> [f32; 2] {
        self.all().get(row as usize).copied().unwrap_or_default()
    }

    /// Begins an attempt at a step, which [`External::undo`] takes back.
    pub(crate) fn begin_attempt(&mut self) -> Result<()> {
        copy_option(&mut self.before, self.accelerations.as_deref())
    }

    /// Restores what there was before the attempt.
    pub(crate) fn undo(&mut self) {
        std::mem::swap(&mut self.accelerations, &mut self.before);
    }

    /// Changes the number of rows; new ones have no acceleration.
    /// Reserves memory for `len` rows.
    pub(crate) fn reserve(&mut self, len: usize) -> Result<()> {
        self.accelerations.iter_mut().try_for_each(|all| memory::reserve_len(all, len))
    }

    pub(crate) fn resize(&mut self, len: usize) {
        self.accelerations.iter_mut().for_each(|all| all.resize(len, [0.0; 2]));
    }

    /// Removes some rows.
    pub(crate) fn remove(&mut self, gone: &[bool]) {
        self.accelerations.iter_mut().for_each(|all| retain_unless(all, gone));
    }

    /// Sets that of a row, if there are any.
    pub(crate) fn set(&mut self, row: u32, acceleration: [f32; 2]) {
        if let Some(all) = &mut self.accelerations {
            all[row as usize] = acceleration;
        }
    }

    /// Removes all if they are 0 for all particles of all processes.
    pub(crate) fn end_if_zero(&mut self, halo: &dyn Halo) -> Result<()> {
        let acts = self.all().iter().any(|external| *external != [0.0; 2]);
        if self.act() && !halo.any(acts)? {
            self.accelerations = None;
        }
        Ok(())
    }

    /// Adds the external acceleration of each particle to others, which are by index.
    pub(crate) fn add_to(&self, accelerations: &mut [[f32; 2]], rows: &[u32]) {
        let Some(external) = &self.accelerations else { return };
        for (sum, &row) in accelerations.iter_mut().zip(rows) {
            let own = external[row as usize];
            *sum = [0, 1].map(|k| sum[k] + own[k]);
        }
    }

    /// Gives the smallest row of merging particles the sum of the forces on them over their mass.
    pub(crate) fn merge(&mut self, particles: &Particles, rows: &[u32], indices: &[usize]) {
        let own = |&index: &usize| (particles.masses[index], self.of(rows[index]));
        let joint = joint_acceleration(indices.iter().map(own));
        let first = indices.iter().map(|&index| rows[index]).fold(u32::MAX, u32::min);
        self.set(first, joint);
    }

    /// The accelerations with those by some more forces.
    fn with_forces(
        &self,
        bodies: &Bodies,
        halo: &dyn Distribution,
        (ids, newtons): (&[Id], &[[f32; 2]]),
    ) -> Result<Vec<[f32; 2]>> {
        let rows = bodies.rows_of(ids)?;
        check_vectors("forces", newtons)?;
        // Sums are in float64, so that several forces on one particle are rounded once.
        let mut sums: Vec<[f64; 2]> = memory::with_capacity(bodies.len())?;
        sums.extend(self.all().iter().map(|own| own.map(f64::from)));
        sums.resize(bodies.len(), [0.0; 2]);
        let indices = bodies.indices()?;
        for (&row, force) in rows.iter().zip(newtons) {
            let row = row as usize;
            let (all, at) = bodies.disc_at(indices[row] as usize);
            let mass = f64::from(all.masses[at]);
            sums[row] = [0, 1].map(|k| sums[row][k] + f64::from(force[k]) / mass);
        }
        let sums = memory::collect(sums.into_iter().map(|sum| sum.map(|a| a as f32)))?;
        // Forces in range may add up to an acceleration out of range, for instance of a small mass.
        if let Some(index) =
            rows.iter().position(|&row| check_vectors("forces", &[sums[row as usize]]).is_err())
        {
            let what = "acceleration";
            return Err(too_large(bodies, halo, "forces", (index, newtons), rows[index], what));
        }
        Ok(sums)
    }
}

impl World {
    /// The external accelerations in the order of adding; empty if there are none.
    pub fn external_accelerations(&self) -> &[[f32; 2]] {
        self.external.all()
    }

    /// Gives each particle an acceleration, beside those of forces and gravity, in place of the external one
    /// before. Particles that are accelerated wake.
    pub fn set_accelerations(&mut self, accelerations: Vec<[f32; 2]>) -> Result<()> {
        let (found, expected) = (accelerations.len(), self.len());
        let checked = if found == expected {
            check_vectors("accelerations", &accelerations)
        } else {
            Err(Error::Length { argument: "accelerations", found, expected })
        };
        tell_error(&*self.halo, checked)?;
        replace(self, accelerations)
    }

    /// Ends all external accelerations.
    pub fn clear_accelerations(&mut self) {
        self.external.accelerations = None;
    }

    /// Adds forces on some particles to the external ones.
    pub fn add_forces(&mut self, ids: &[Id], newtons: &[[f32; 2]]) -> Result<()> {
        let sums = self.external.with_forces(&self.bodies, &*self.halo, (ids, newtons));
        let sums = tell_error(&*self.halo, sums)?;
        replace(self, sums)
    }
}

/// The error for a vector of an argument by which a particle would leave the range of numbers.
pub(crate) fn too_large(
    bodies: &Bodies,
    halo: &dyn Distribution,
    argument: &'static str,
    (index, vectors): (usize, &[[f32; 2]]),
    row: u32,
    what: &str,
) -> Error {
    let [x, y] = vectors[index];
    let id = halo.id_among_all(&bodies.ids, row);
    let rule = format!("the {what} of particle {id} would be too large");
    let value = format!("({x}, {y})");
    // In a distributed world the vectors are not the argument of the caller.
    match halo.is_whole() {
        true => Error::at(argument, index, value, &rule),
        false => Error::of(argument, value, &rule),
    }
}

/// Tells the other processes of an error, so that their next call returns one, too.
pub(crate) fn tell_error<V>(halo: &dyn Distribution, checked: Result<V>) -> Result<V> {
    if checked.is_err() {
        halo.fail();
    }
    checked
}

/// Replaces the external accelerations; nothing accelerates immovable particles. Those that are accelerated wake.
fn replace(world: &mut World, mut accelerations: Vec<[f32; 2]>) -> Result<()> {
    for (row, index) in world.bodies.rows_and_indices() {
        if world.bodies.is_immovable(index) {
            accelerations[row as usize] = [0.0; 2];
        }
    }
    let acts = (0..).zip(&accelerations).filter(|(_, external)| **external != [0.0; 2]);
    let mut rows: Vec<u32> = Vec::new();
    let listed = memory::extend(&mut rows, acts.map(|(row, _)| row));
    tell_error(&*world.halo, listed)?;
    // All ranks must make the same stages of a step, so all have external accelerations or
    // none.
    let acts = world.halo().any(!rows.is_empty())?;
    if acts {
        world.halo.protocol().wake_edited(world, &mut [], &rows)?;
    }
    world.external.accelerations = acts.then_some(accelerations);
    Ok(())
}

/// Whether anything accelerates particles, apart from gravity and springs.
pub(crate) fn has_accelerations(external: &External, influences: &Influences) -> bool {
    external.act() || influences.has_forces()
}

/// The sum of the external forces on merging particles over their mass, from masses and accelerations.
pub(crate) fn joint_acceleration(all: impl Iterator<Item = (f32, [f32; 2])>) -> [f32; 2] {
    let (mut mass, mut sum) = (0.0, [0.0; 2]);
    for (own, external) in all {
        let own = f64::from(own);
        mass += own;
        sum = [0, 1].map(|k| sum[k] + own * f64::from(external[k]));
    }
    sum.map(|force| (force / mass) as f32)
}
