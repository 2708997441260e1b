//! How many helper threads are ready to work, as a count that callers and helpers share.
//!
//! A helper is a thread that looks for work in a loop. A caller reserves helpers before it gives
//! them work, and a helper leaves the loop only after it has reserved itself. So work never
//! waits for a thread that has left.

use super::sync::{AtomicUsize, Ordering};

/// The helpers of one pool of threads.
#[derive(Debug, Default)]
pub struct Crew {
    /// Helpers that look for work and that nobody has reserved.
    ready: AtomicUsize,
}

impl Crew {
    /// Adds the current thread, at the start of its loop or at the end of some work.
    pub fn enter(&self) {
        self.ready.fetch_add(1, Ordering::Release);
    }

    /// Reserves helpers, at most `most`; returns how many. Each of them will come to work.
    pub fn reserve(&self, most: usize) -> usize {
        let reserved =
            |ready: usize| ready.checked_sub(ready.min(most)).filter(|&left| left < ready);
        let before = self.ready.fetch_update(Ordering::Acquire, Ordering::Relaxed, reserved);
        before.map_or(0, |ready| ready.min(most))
    }

    /// Whether `count` helpers are ready.
    pub fn has(&self, count: usize) -> bool {
        self.ready.load(Ordering::Relaxed) >= count
    }

    /// Removes the current helper, unless all helpers are reserved; returns whether it may leave.
    pub fn leave(&self) -> bool {
        self.reserve(1) == 1
    }
}
