//! Threads that run the same work together and wait for each other between its stages.

use std::ops::Range;

/// One of the threads.
pub struct Member<'a> {
    pub(super) index: usize,
    pub(super) threads: usize,
    pub(super) wait: &'a dyn Fn(),
}

impl Member<'_> {
    /// Whether it is the first one.
    pub fn is_first(&self) -> bool {
        self.index == 0
    }

    /// Its share of `len` items.
    pub fn share(&self, len: usize) -> Range<usize> {
        len * self.index / self.threads..len * (self.index + 1) / self.threads
    }

    /// Waits until all have called it as often as this one.
    pub fn wait(&self) {
        (self.wait)();
    }
}
