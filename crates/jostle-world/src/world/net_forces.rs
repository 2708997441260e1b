//! The forces on particles at the present state, without those of contacts.

use super::World;
use super::force_step::force_input;
use crate::forces::{self, ForceInput, Springs, Virial, product, sum_of};
use crate::particles::Particles;
use jostle_base::error::Result;
use jostle_base::interrupt;
use jostle_base::memory;

impl World {
    /// The sum of the forces on each particle, in the order of adding: gravity, drag, forces, springs, and what
    /// callers give for the next call of `step`. Contacts are left out, and so are the speed limits of flocks. Those
    /// of immovable particles are 0.
    pub fn net_forces(&self) -> Result<Vec<[f64; 2]>> {
        let all = self.bodies.particles()?;
        let mut sums = self.sums_of_accelerations(&all)?;
        let (gravity, drag) = (self.settings.gravity.map(f64::from), f64::from(self.settings.drag));
        for (at, sum) in sums.iter_mut().enumerate() {
            let mass = f64::from(all.masses[at]);
            let velocity = all.velocities[at].map(f64::from);
            *sum = [0, 1].map(|k| mass * (sum[k] + gravity[k] - drag * velocity[k]));
        }
        self.with_all(&all, |bodies| {
            for springs in self.influences.springs() {
                for ([a, b], _, force) in pulls(springs, bodies) {
                    sums[a] = [0, 1].map(|k| sums[a][k] - force[k]);
                    sums[b] = [0, 1].map(|k| sums[b][k] + force[k]);
                }
            }
            Ok(())
        })?;
        let immovable = all.movable.iter().zip(&mut sums).filter(|(movable, _)| !**movable);
        immovable.for_each(|(_, sum)| *sum = [0.0; 2]);
        Ok(sums)
    }

    /// The sum of the tensor products of offset and force over all pairs: forces between kinds, gravitation, springs.
    /// The first index is that of the offset from one particle to the other, whose nearest images count, the second
    /// that of the force on the other.
    pub fn force_virial(&self) -> Result<Virial> {
        let all = self.bodies.particles()?;
        self.with_all(&all, |bodies| {
            let mut virial = Virial::default();
            for force in self.influences.forces() {
                virial = sum_of(virial, force.virial(bodies)?);
                interrupt::check()?;
            }
            for springs in self.influences.springs() {
                let products =
                    pulls(springs, bodies).map(|(_, offset, force)| product(offset, force));
                virial = products.fold(virial, sum_of);
            }
            Ok(virial)
        })
    }

    /// The accelerations by forces and by the caller, by rows.
    fn sums_of_accelerations(&self, all: &Particles) -> Result<Vec<[f64; 2]>> {
        let mut found = Vec::new();
        self.with_all(all, |bodies| {
            self.influences.sum(bodies, &mut forces::Scratch::default(), &mut found)
        })?;
        interrupt::check()?;
        let rows = 0..found.len() as u32;
        memory::collect(found.iter().zip(rows).map(|(own, row)| {
            let given = self.external.of(row).map(f64::from);
            [0, 1].map(|k| f64::from(own[k]) + given[k])
        }))
    }

    /// Calls `act` with all particles, those that sleep included, by rows.
    fn with_all<V>(
        &self,
        all: &Particles,
        act: impl FnOnce(&ForceInput<'_>) -> Result<V>,
    ) -> Result<V> {
        let period = self.settings.container.period();
        let positions = memory::collect(all.positions.iter().map(|&there| period.wrap(there)))?;
        let rows = memory::collect(0..all.len() as u32)?;
        act(&force_input(all, &positions, (&rows, &rows), &self.settings))
    }
}

/// Offsets and forces of springs, by rows.
fn pulls<'a>(
    springs: &'a Springs,
    bodies: &'a ForceInput<'_>,
) -> impl Iterator<Item = ([usize; 2], [f64; 2], [f64; 2])> + 'a {
    springs.pulls(bodies.positions, bodies.velocities, &bodies.container)
}
