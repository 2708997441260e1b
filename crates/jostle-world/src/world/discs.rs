//! The columns of the particles by indices, each declared once. What a step computes anew is in `StepScratch`.

use super::sleeping::Drift;
use crate::container::MAX_WALLS;
use crate::particles::Particles;
use jostle_base::table;

table! {
    /// All columns by indices: those that a step reorders, and that sleeping particles keep.
    #[derive(Clone, Debug, Default)]
    pub(crate) struct Discs {
        pub(crate) particles: nested Particles,
        /// The row of each particle in the order of adding.
        pub(crate) rows: dense u32,
        pub(crate) persistent: nested Persistent,
    }
}

table! {
    /// What is kept of each particle from step to step, beside its own state. Default values stand for
    /// no contact and an unknown motion.
    #[derive(Clone, Debug, Default)]
    pub(crate) struct Persistent {
        pub(crate) warm_start: nested WarmStart,
        /// Sleeping: how each particle moved in the last quarters of a second; empty if nothing may fall
        /// asleep.
        pub(crate) drifts: sparse Drift,
    }
}

table! {
    /// Warm starting: impulses over mass that each side of the container gave in the last sub-step, at rest.
    /// Those of other walls are in `World::wall_impulses`, those between particles in `World::contacts`.
    #[derive(Clone, Debug, Default)]
    pub(crate) struct WarmStart {
        /// Along the normals; empty if nothing can rest.
        pub(crate) normal: sparse [f32; MAX_WALLS],
        /// Of friction; empty if no particle has friction.
        pub(crate) friction: sparse [f32; MAX_WALLS],
    }
}

impl WarmStart {
    /// Removes all impulses.
    pub(crate) fn clear(&mut self) {
        self.normal.clear();
        self.friction.clear();
    }

    /// Removes those of one index.
    pub(crate) fn clear_one(&mut self, index: usize) {
        for column in [&mut self.normal, &mut self.friction] {
            column.get_mut(index).into_iter().for_each(|own| *own = Default::default());
        }
    }
}
