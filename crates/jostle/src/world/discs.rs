//! The columns of the particles by indices, each declared once. What a step computes anew is in `StepScratch`.

use super::sleeping::Drift;
use crate::container::MAX_WALLS;
use crate::particles::Particles;
use crate::table;

table! {
    /// All columns by indices: those that a step reorders, and that sleeping particles keep.
    #[derive(Clone, Debug, Default)]
    pub(super) struct Discs {
        pub(super) particles: nested Particles,
        /// The row of each particle in the order of adding.
        pub(super) rows: dense u32,
        pub(super) persistent: nested Persistent,
    }
}

table! {
    /// What is kept of each particle from step to step, beside its own state. Default values stand for
    /// no contact and an unknown motion.
    #[derive(Clone, Debug, Default)]
    pub(super) struct Persistent {
        /// Warm starting: impulse over mass along the normal that each side of the container gave in the last
        /// sub-step, at rest; empty if nothing can rest.
        pub(super) wall_pushes: sparse [f32; MAX_WALLS],
        /// The same of friction; empty if no particle has friction.
        pub(super) wall_frictions: sparse [f32; MAX_WALLS],
        /// Sleeping: how each particle moved in the last quarters of a second; empty if nothing may fall
        /// asleep.
        pub(super) drifts: sparse Drift,
    }
}

impl Persistent {
    /// Removes the impulses of the sides of the container.
    pub(super) fn forget_sides(&mut self) {
        self.wall_pushes.clear();
        self.wall_frictions.clear();
    }

    /// The same for one index.
    pub(super) fn forget_sides_of(&mut self, index: usize) {
        for column in [&mut self.wall_pushes, &mut self.wall_frictions] {
            if let Some(pushes) = column.get_mut(index) {
                *pushes = [0.0; MAX_WALLS];
            }
        }
    }
}
