//! Sorts all columns into the canonical order, that of the tree.

use super::World;
use super::bodies::discs::Discs;
use super::force_step::{awake_springs, find_indices};
use jostle_base::parallel;
use jostle_base::table::Table;

impl World {
    /// Reorders all columns into the order of the tree. The first part of a step keeps the old
    /// order for [`World::undo`].
    pub(crate) fn reorder(&mut self, threads: Option<usize>) {
        let scratch = &mut self.scratch;
        let order = scratch.tree.rows();
        let before = &mut scratch.before;
        // The first reordering writes into the spare columns of `before` and exchanges them. So
        // `before` has the old state without a copy. Later parts of the step must not overwrite it.
        let spare = if before.is_reordered { &mut scratch.spare } else { &mut before.discs };
        let Discs { particles, rows, persistent } = spare;
        particles.gather(&self.bodies.awake.particles, order, threads);
        std::mem::swap(particles, &mut self.bodies.awake.particles);
        gather(rows, &mut self.bodies.awake.rows, order, threads);
        persistent.gather(&self.bodies.awake.persistent, order, threads);
        std::mem::swap(persistent, &mut self.bodies.awake.persistent);
        gather(&mut scratch.old_max_displacements, &mut scratch.max_displacements, order, threads);
        self.bodies.forget_indices();
        self.set_contacts_aside();
        self.reorder_forces(threads);
    }

    /// Keeps the contacts of the previous step for [`World::undo`]. A step has several parts only
    /// if particles merge, which have no contacts.
    fn set_contacts_aside(&mut self) {
        let before = &mut self.scratch.before;
        if !before.is_reordered {
            self.contacts.exchange(&mut before.contacts);
            before.is_reordered = true;
        }
    }

    /// Reorders the accelerations, and prepares the springs for the new indices.
    fn reorder_forces(&mut self, threads: Option<usize>) {
        if self.influences.is_empty() && self.external.is_none() {
            return;
        }
        let (order, forces) = (self.scratch.tree.rows(), &mut self.scratch.forces);
        if !forces.accelerations.is_empty() {
            gather(&mut forces.old_accelerations, &mut forces.accelerations, order, threads);
        }
        find_indices(
            &self.influences,
            &self.bodies.awake.rows,
            self.bodies.asleep.len(),
            &mut forces.indices,
        );
        let all = awake_springs(&self.influences, &forces.indices);
        let (container, len) = (self.settings.container, self.bodies.awake.rows.len());
        let inverse_mass = |index: usize| self.bodies.awake.particles.inverse_mass(index);
        forces.sprung.prepare(all, &forces.indices, container, len, inverse_mass);
    }
}

/// Reorders a column into its spare and swaps the two.
fn gather<V: Copy + Default + Send + Sync>(
    spare: &mut Vec<V>,
    column: &mut Vec<V>,
    order: &[u32],
    threads: Option<usize>,
) {
    parallel::gather(threads, spare, column, order);
    std::mem::swap(spare, column);
}
