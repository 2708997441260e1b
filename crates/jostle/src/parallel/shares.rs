//! Tasks divided among threads.
//!
//! Each thread has a share, a range of tasks, and does these first: the same share in each stage,
//! so that it finds the memory that it used before in its own cache. Then it takes tasks of others.

use super::sync::{AtomicUsize, Ordering};

/// The next task of each share.
#[derive(Debug)]
pub struct Shares {
    count: usize,
    next: Vec<AtomicUsize>,
}

impl Shares {
    /// `count` tasks for `threads` threads.
    pub fn new(count: usize, threads: usize) -> Self {
        let next = (0..threads).map(|thread| AtomicUsize::new(count * thread / threads));
        Self { count, next: next.collect() }
    }

    /// A task for `thread`, which nobody else gets; none if no task is left.
    pub fn take(&self, thread: usize) -> Option<usize> {
        let threads = self.next.len();
        (0..threads).find_map(|other| self.take_from((thread + other) % threads))
    }

    /// A task of one share, the first that is left.
    fn take_from(&self, share: usize) -> Option<usize> {
        let end = self.count * (share + 1) / self.next.len();
        let is_left = |&task: &usize| task < end;
        // Without this, counters of finished shares would grow at each attempt.
        is_left(&self.next[share].load(Ordering::Relaxed)).then_some(())?;
        Some(self.next[share].fetch_add(1, Ordering::Relaxed)).filter(is_left)
    }
}
