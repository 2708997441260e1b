//! The columns of the particles by indices, each declared once. What a step computes anew is in `StepScratch`.

use crate::particles::Particles;
use crate::world::sleeping::Drift;
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
        /// Sleeping: how each particle moved in the last quarters of a second; empty if nothing may fall
        /// asleep.
        pub(crate) drifts: sparse Drift,
    }
}
