//! How every particle moves during one sub-step, open to all threads.

use std::sync::atomic::{AtomicU32, Ordering};

/// One particle's way through a sub-step of length h.
///
/// After its last bounce at `since` it is on a straight line: at time t it is at
/// `position + travel − velocity · (h − t)`. A bounce at t that changes the
/// velocity by Δv therefore changes `travel` by Δv · (h − t).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Where it was at the start of the sub-step.
    pub position: [f32; 2],
    /// World units a second, now.
    pub velocity: [f32; 2],
    /// What the whole sub-step will add to the position.
    pub travel: [f32; 2],
    /// When the current line began, seconds into the sub-step.
    pub since: f32,
}

const WORDS: usize = 8;

/// The motions of all particles. Contacts of one colour share no movable
/// particle, so plain (relaxed) loads and stores are enough, and safe.
#[derive(Debug, Default)]
pub struct Motions(Vec<[AtomicU32; WORDS]>);

impl Motions {
    /// Makes room for `len` motions; what is in them is unspecified.
    pub fn resize(&mut self, len: usize) {
        self.0.resize_with(len, Default::default);
    }

    /// The motion of the particle at `place`.
    #[inline(always)]
    pub fn get(&self, place: u32) -> Motion {
        let words = &self.0[place as usize];
        let word = |k: usize| f32::from_bits(words[k].load(Ordering::Relaxed));
        Motion {
            position: [word(0), word(1)],
            velocity: [word(2), word(3)],
            travel: [word(4), word(5)],
            since: word(6),
        }
    }

    /// Replaces the motion of the particle at `place`.
    #[inline(always)]
    pub fn set(&self, place: u32, motion: Motion) {
        let words = &self.0[place as usize];
        let put = |k: usize, v: f32| words[k].store(v.to_bits(), Ordering::Relaxed);
        put(0, motion.position[0]);
        put(1, motion.position[1]);
        put(2, motion.velocity[0]);
        put(3, motion.velocity[1]);
        put(4, motion.travel[0]);
        put(5, motion.travel[1]);
        put(6, motion.since);
    }
}
