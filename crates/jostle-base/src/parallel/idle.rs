//! How many worker threads are idle, as a count that callers and workers share.
//!
//! An idle worker polls for work in a loop. A caller reserves workers before it spawns work, and a
//! worker leaves the loop only after it has reserved itself. So work is never spawned for a
//! thread that has left the loop.

use super::sync::{AtomicUsize, Ordering};

/// The idle workers of one pool of threads.
#[derive(Debug, Default)]
pub(super) struct Idle {
    /// Workers in their loop that are not reserved.
    count: AtomicUsize,
}

impl Idle {
    /// Adds the current thread, at the start of its loop or at the end of some work.
    pub(super) fn enter(&self) {
        // Release, with the Acquire of `reserve`: what the worker did before is done for the caller
        // that reserves it. The work itself is handed over by rayon's queue, with its own
        // synchronization.
        self.count.fetch_add(1, Ordering::Release);
    }

    /// Reserves at most `max` workers; returns how many. Each of them will take work.
    pub(super) fn reserve(&self, max: usize) -> usize {
        let reserved =
            |ready: usize| ready.checked_sub(ready.min(max)).filter(|&left| left < ready);
        // One atomic update, not a read and a subtraction: two callers may reserve at the same
        // time, and each worker must be promised to one of them only. Relaxed if it fails: then no
        // worker is reserved, and nothing that it wrote is read.
        let before = self.count.fetch_update(Ordering::Acquire, Ordering::Relaxed, reserved);
        before.map_or(0, |ready| ready.min(max))
    }

    /// Whether `count` workers are idle.
    pub(super) fn has(&self, count: usize) -> bool {
        // A hint about whom to wake. If it is out of date, a caller wakes workers in vain or works
        // alone.
        self.count.load(Ordering::Relaxed) >= count
    }

    /// Removes the current worker, unless all are reserved; returns whether it may leave.
    pub(super) fn leave(&self) -> bool {
        // A worker that leaves competes with callers for the same count. If callers have reserved
        // all that are idle, one of them has promised work to this worker, so it stays in its loop
        // until the work comes. With a plain decrement the work would wait in the queue until
        // something else woke the worker.
        self.reserve(1) == 1
    }
}
