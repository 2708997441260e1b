//! Division of tasks among threads, with work stealing.
//!
//! Each thread has a share, a range of tasks, which it runs first. The share is the same in each
//! stage, so its data is in the cache of the core. Then the thread takes tasks of other shares.

use super::sync::{AtomicUsize, Ordering};

/// The next task of each share.
#[derive(Debug)]
pub(super) struct Shares {
    count: usize,
    next: Vec<AtomicUsize>,
}

impl Shares {
    /// `count` tasks for `threads` threads.
    pub(super) fn new(count: usize, threads: usize) -> Self {
        // Boundaries depend on `count` and `threads` alone: in each stage with as many tasks a
        // thread begins with the same ones. On two cores without a shared cache of the second level
        // this makes the join of leaves 1.5 instead of 1.2 times as fast as on one thread
        // (docs/benchmarks-notes.md).
        let next = (0..threads).map(|thread| AtomicUsize::new(count * thread / threads));
        Self { count, next: next.collect() }
    }

    /// A task for `thread` alone; None if no task is left.
    pub(super) fn take(&self, thread: usize) -> Option<usize> {
        let threads = self.next.len();
        // Own share first, then those of the next threads in turn. Threads that have finished begin
        // to steal at different shares, so they seldom meet at one counter.
        (0..threads).find_map(|other| self.take_from((thread + other) % threads))
    }

    /// The first remaining task of one share.
    fn take_from(&self, share: usize) -> Option<usize> {
        let end = self.count * (share + 1) / self.next.len();
        let is_left = |&task: &usize| task < end;
        // Otherwise the counters of finished shares would grow with each attempt.
        is_left(&self.next[share].load(Ordering::Relaxed)).then_some(())?;
        // The addition alone decides who gets a task: each number is returned once, whatever the
        // check before it saw. Relaxed is enough, because it hands out only a number. What tasks
        // read was written before the team began, and what they write is read after all have ended;
        // `team` orders both.
        Some(self.next[share].fetch_add(1, Ordering::Relaxed)).filter(is_left)
    }
}
