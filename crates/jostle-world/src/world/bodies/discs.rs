//! The columns of the particles by indices, each declared once. What a step computes anew is in `StepScratch`.

use crate::particles::Particles;
use jostle_base::{plain, table};
use jostle_index::period::Turns;

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
        pub(crate) recent_motions: sparse RecentMotion,
        /// How many periods each particle has travelled along each axis since its position was set.
        pub(crate) turns: sparse Turns,
    }
}

/// How a particle moved in the previous quarter of a second and in this one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RecentMotion {
    /// Displacement of the particle and of its surface in the previous quarter; infinite if it was
    /// too fast.
    pub(crate) before: [f32; 3],
    /// Displacement of both in this quarter so far; infinite if it was too fast.
    pub(crate) now: [f32; 3],
}

impl RecentMotion {
    /// Of a particle that has not been observed for a whole quarter.
    pub(crate) const UNKNOWN: Self = Self { before: [f32::INFINITY; 3], now: [f32::INFINITY; 3] };
}

impl Default for RecentMotion {
    fn default() -> Self {
        Self::UNKNOWN
    }
}

plain! { RecentMotion { before, now } }
