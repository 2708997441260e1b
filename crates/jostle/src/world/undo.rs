//! Restores the state before a step that is refused or interrupted.

use super::{Stats, World};
use crate::contacts::Contacts;
use crate::container::MAX_WALLS;
use crate::forces::Force;
use crate::particles::Particles;

/// The columns that a step reorders.
#[derive(Debug, Default)]
pub(super) struct Ordered {
    pub(super) particles: Particles,
    pub(super) rows: Vec<u32>,
    pub(super) wall_pushes: Vec<[f32; MAX_WALLS]>,
}

/// The world before the current step. The first part of a step moves the old columns and contacts
/// here and writes new ones, so almost nothing is copied.
#[derive(Debug, Default)]
pub(super) struct Before {
    /// Whether the old columns and contacts are here.
    pub(super) arranged: bool,
    pub(super) ordered: Ordered,
    pub(super) contacts: Contacts,
    /// Positions as the caller gave them, if some were outside the torus.
    unwrapped: Option<Vec<[f32; 2]>>,
    forces: Vec<Force>,
    stats: Stats,
    renumbered: Option<Vec<Option<u32>>>,
}

impl World {
    /// Begins a step.
    pub(super) fn begin(&mut self) {
        let before = &mut self.memory.before;
        before.arranged = false;
        before.forces.clone_from(&self.forces);
        before.stats = self.stats;
        before.renumbered.clone_from(&self.renumbered);
        let container = self.settings.container;
        let positions = &mut self.particles.positions;
        let outside = |position: &[f32; 2]| container.wrap(*position) != *position;
        before.unwrapped = positions.iter().any(outside).then(|| positions.clone());
        if before.unwrapped.is_some() {
            positions.iter_mut().for_each(|position| *position = container.wrap(*position));
        }
    }

    /// Restores the state at the beginning of the step.
    pub(super) fn undo(&mut self) {
        let before = &mut self.memory.before;
        if before.arranged {
            let Ordered { particles, rows, wall_pushes } = &mut before.ordered;
            std::mem::swap(&mut self.particles, particles);
            std::mem::swap(&mut self.rows, rows);
            std::mem::swap(&mut self.wall_pushes, wall_pushes);
            self.contacts.exchange(&mut before.contacts);
            self.contacts.remember(self.rows.len());
        }
        if let Some(positions) = before.unwrapped.take() {
            self.particles.positions = positions;
        }
        std::mem::swap(&mut self.forces, &mut before.forces);
        self.stats = before.stats;
        self.renumbered = before.renumbered.take();
    }
}
