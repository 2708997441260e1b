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
        pub(super) warm_start: nested WarmStart,
        /// Sleeping: how each particle moved in the last quarters of a second; empty if nothing may fall
        /// asleep.
        pub(super) drifts: sparse Drift,
    }
}

table! {
    /// Warm starting: impulses over mass that each side of the container gave in the last sub-step, at rest.
    /// Those of other walls are in `World::wall_impulses`, those between particles in `World::contacts`.
    #[derive(Clone, Debug, Default)]
    pub(super) struct WarmStart {
        /// Along the normals; empty if nothing can rest.
        pub(super) normal: sparse [f32; MAX_WALLS],
        /// Of friction; empty if no particle has friction.
        pub(super) friction: sparse [f32; MAX_WALLS],
    }
}

impl WarmStart {
    /// Removes all impulses.
    pub(super) fn clear(&mut self) {
        self.normal.clear();
        self.friction.clear();
    }

    /// Removes those of one index.
    pub(super) fn clear_one(&mut self, index: usize) {
        for column in [&mut self.normal, &mut self.friction] {
            column.get_mut(index).into_iter().for_each(|own| *own = Default::default());
        }
    }
}
