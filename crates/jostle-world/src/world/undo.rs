//! Rollback: restores the state before a step that is refused or interrupted.

use super::bodies::discs::Discs;
use super::bodies::ids::Ids;
use super::{Stats, World};
use crate::contacts::Contacts;
use crate::forces::Influences;
use crate::motion;
use crate::particles::Particles;

/// The world before the current step. The first part of a step moves the old columns and contacts
/// here and writes new ones, so almost nothing is copied.
#[derive(Debug, Default)]
pub(crate) struct Before {
    /// Whether the old columns and contacts are here.
    pub(crate) is_reordered: bool,
    pub(crate) discs: Discs,
    pub(crate) contacts: Contacts,
    /// Positions and residuals as they were, if some were outside the torus.
    unwrapped: Option<[Vec<[f32; 2]>; 2]>,
    influences: Influences,
    stats: Stats,
    /// Those before the first merger of the step.
    pub(crate) ids: Option<Ids>,
}

/// Begins an attempt at a step, which [`undo`] takes back.
pub(crate) fn begin_attempt(world: &mut World) {
    // `reorder` writes new columns beside the old ones, so these need no copy. Only what a step
    // changes in place is copied here.
    let before = &mut world.scratch.before;
    before.is_reordered = false;
    before.influences.clone_from(&world.influences);
    world.external.begin_attempt();
    world.boundaries.begin_attempt();
    before.stats = world.stats;
    world.record.begin_attempt();
    before.ids = None;
    // Callers may set positions outside of the torus. Undo must restore their bits.
    let period = world.settings.container.period();
    let Particles { positions, residuals, .. } = &mut world.bodies.awake.particles;
    let outside = |position: &[f32; 2]| period.wrap(*position) != *position;
    let is_any_outside = !period.is_none() && positions.iter().any(outside);
    before.unwrapped = is_any_outside.then(|| [positions.clone(), residuals.clone()]);
    if is_any_outside {
        for (position, residual) in positions.iter_mut().zip(residuals) {
            (*position, *residual) = motion::wrapped(*position, *residual, &period);
        }
    }
}

/// Restores the state before the attempt.
pub(crate) fn undo(world: &mut World) {
    let before = &mut world.scratch.before;
    // An attempt that ended before it reordered has left the columns as they were.
    if before.is_reordered {
        let Discs { particles, rows, persistent } = &mut before.discs;
        std::mem::swap(&mut world.bodies.awake.particles, particles);
        std::mem::swap(&mut world.bodies.awake.rows, rows);
        std::mem::swap(&mut world.bodies.awake.persistent, persistent);
        world.contacts.exchange(&mut before.contacts);
        world.contacts.remember(world.bodies.awake.rows.len());
        world.bodies.forget_indices();
    }
    // After the exchange of columns, because these positions are in the old order.
    if let Some([positions, residuals]) = before.unwrapped.take() {
        (world.bodies.awake.particles.positions, world.bodies.awake.particles.residuals) =
            (positions, residuals);
    }
    std::mem::swap(&mut world.influences, &mut before.influences);
    world.external.undo();
    world.boundaries.undo();
    world.stats = before.stats;
    world.record.undo();
    if let Some(ids) = before.ids.take() {
        world.bodies.ids = ids;
    }
}
