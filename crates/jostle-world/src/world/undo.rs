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
    external: Option<Vec<[f32; 2]>>,
    stats: Stats,
    /// Those before the first merger of the step.
    pub(crate) ids: Option<Ids>,
}

impl World {
    /// Begins a step.
    pub(crate) fn begin(&mut self) {
        // `reorder` writes new columns beside the old ones, so these need no copy. Only what a step
        // changes in place is copied here.
        let before = &mut self.scratch.before;
        before.is_reordered = false;
        before.influences.clone_from(&self.influences);
        before.external.clone_from(&self.external);
        self.boundaries.begin_attempt();
        before.stats = self.stats;
        self.record.begin_step();
        before.ids = None;
        // Callers may set positions outside of the torus. Undo must restore their bits.
        let period = self.settings.container.period();
        let Particles { positions, residuals, .. } = &mut self.bodies.awake.particles;
        let outside = |position: &[f32; 2]| period.wrap(*position) != *position;
        let is_any_outside = !period.is_none() && positions.iter().any(outside);
        before.unwrapped = is_any_outside.then(|| [positions.clone(), residuals.clone()]);
        if is_any_outside {
            for (position, residual) in positions.iter_mut().zip(residuals) {
                (*position, *residual) = motion::wrapped(*position, *residual, &period);
            }
        }
    }

    /// Restores the state at the beginning of the step.
    pub(crate) fn undo(&mut self) {
        let before = &mut self.scratch.before;
        // An attempt that ended before it reordered has left the columns as they were.
        if before.is_reordered {
            let Discs { particles, rows, persistent } = &mut before.discs;
            std::mem::swap(&mut self.bodies.awake.particles, particles);
            std::mem::swap(&mut self.bodies.awake.rows, rows);
            std::mem::swap(&mut self.bodies.awake.persistent, persistent);
            self.contacts.exchange(&mut before.contacts);
            self.contacts.remember(self.bodies.awake.rows.len());
            self.bodies.forget_indices();
        }
        // After the exchange of columns, because these positions are in the old order.
        if let Some([positions, residuals]) = before.unwrapped.take() {
            (self.bodies.awake.particles.positions, self.bodies.awake.particles.residuals) =
                (positions, residuals);
        }
        std::mem::swap(&mut self.influences, &mut before.influences);
        std::mem::swap(&mut self.external, &mut before.external);
        self.boundaries.undo();
        self.stats = before.stats;
        self.record.undo_step();
        if let Some(ids) = before.ids.take() {
            self.bodies.ids = ids;
        }
    }
}
