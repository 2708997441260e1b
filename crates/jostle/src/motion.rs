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
        Motion {
            position: self.position(place),
            velocity: self.velocity(place),
            travel: self.travel(place),
            since: self.word(place, 6),
        }
    }

    /// Replaces the motion of the particle at `place`.
    #[inline(always)]
    pub fn set(&self, place: u32, motion: Motion) {
        self.set_position(place, motion.position);
        self.set_velocity(place, motion.velocity);
        self.set_travel(place, motion.travel);
        self.put(place, 6, motion.since);
    }

    /// Its position alone.
    #[inline(always)]
    pub fn position(&self, place: u32) -> [f32; 2] {
        [self.word(place, 0), self.word(place, 1)]
    }

    /// Its velocity alone.
    #[inline(always)]
    pub fn velocity(&self, place: u32) -> [f32; 2] {
        [self.word(place, 2), self.word(place, 3)]
    }

    /// Its way alone.
    #[inline(always)]
    pub fn travel(&self, place: u32) -> [f32; 2] {
        [self.word(place, 4), self.word(place, 5)]
    }

    /// Replaces its position alone.
    #[inline(always)]
    pub fn set_position(&self, place: u32, [x, y]: [f32; 2]) {
        self.put(place, 0, x);
        self.put(place, 1, y);
    }

    /// Replaces its velocity alone.
    #[inline(always)]
    pub fn set_velocity(&self, place: u32, [x, y]: [f32; 2]) {
        self.put(place, 2, x);
        self.put(place, 3, y);
    }

    /// Replaces its way alone.
    #[inline(always)]
    pub fn set_travel(&self, place: u32, [x, y]: [f32; 2]) {
        self.put(place, 4, x);
        self.put(place, 5, y);
    }

    #[inline(always)]
    fn word(&self, place: u32, which: usize) -> f32 {
        f32::from_bits(self.0[place as usize][which].load(Ordering::Relaxed))
    }

    #[inline(always)]
    fn put(&self, place: u32, which: usize, value: f32) {
        self.0[place as usize][which].store(value.to_bits(), Ordering::Relaxed);
    }
}
