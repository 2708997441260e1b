//! Sorts all columns into the canonical order, that of the tree.

use super::bodies::discs::Discs;
use super::force_step::{awake_springs, find_indices};
use super::{StepScratch, World};
use jostle_base::error::Result;
use jostle_base::table::Table;
use jostle_base::{parallel, reserve};

/// Reorders all columns into the order of the tree. The first part of a step keeps the old
/// order for [`undo`](super::undo::undo).
pub(crate) fn reorder(world: &mut World, threads: Option<usize>) -> Result<()> {
    let World { bodies, scratch, contacts, influences, external, settings, .. } = world;
    let StepScratch { tree, before, spare, forces, .. } = scratch;
    let order = tree.rows();
    // The first reordering writes into the spare columns of `before` and exchanges them. So
    // `before` has the old state without a copy. Later parts of the step must not overwrite it.
    let spare = if before.is_reordered { spare } else { &mut before.discs };
    spare.reserve(&bodies.awake, order.len())?;
    reserve!(order.len(); scratch.old_reaches, forces.old_accelerations);
    let Discs { particles, rows, persistent } = spare;
    particles.gather(&bodies.awake.particles, order, threads);
    std::mem::swap(particles, &mut bodies.awake.particles);
    gather(rows, &mut bodies.awake.rows, order, threads);
    persistent.gather(&bodies.awake.persistent, order, threads);
    std::mem::swap(persistent, &mut bodies.awake.persistent);
    gather(&mut scratch.old_reaches, &mut scratch.reaches, order, threads);
    bodies.forget_indices();
    // The contacts of the previous step are kept, too. A step has several parts only if particles merge, which have no
    // contacts.
    if !before.is_reordered {
        contacts.exchange(&mut before.contacts);
        before.is_reordered = true;
    }
    if influences.is_empty() && !external.act() {
        return Ok(());
    }
    if !forces.accelerations.is_empty() {
        gather(&mut forces.old_accelerations, &mut forces.accelerations, order, threads);
    }
    // Springs name rows, so they are prepared for the new indices.
    let Discs { particles, rows, .. } = &bodies.awake;
    find_indices(influences, rows, bodies.asleep.len(), &mut forces.indices)?;
    let all = awake_springs(influences, &forces.indices);
    let inverse_mass = |index: usize| particles.inverse_mass(index);
    forces.sprung.prepare(all, &forces.indices, settings.container, rows.len(), inverse_mass)
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
