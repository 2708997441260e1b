//! Tasks divided among threads.
//!
//! Each thread has a share, a range of tasks, and does these first: the same share in each stage,
//! so that it finds the memory that it used before in its own cache. Then it takes tasks of others,
//! from the end of their shares.

use super::sync::{AtomicU64, Ordering};

/// The tasks that are left of each share: its first task and, in the upper half, where it ends.
#[derive(Debug)]
pub struct Shares(Vec<AtomicU64>);

impl Shares {
    /// `count` tasks for `threads` threads.
    pub fn new(count: usize, threads: usize) -> Self {
        let edge = |thread: usize| (count * thread / threads) as u64;
        let share = |thread: usize| AtomicU64::new(edge(thread) | (edge(thread + 1) << 32));
        Self((0..threads).map(share).collect())
    }

    /// A task for `thread`, which nobody else gets; none if no task is left.
    pub fn take(&self, thread: usize) -> Option<usize> {
        let first = |start: u64, end: u64| (start, (start + 1) | (end << 32));
        let last = |start: u64, end: u64| (end - 1, start | ((end - 1) << 32));
        let others = (1..self.0.len()).map(|next| (thread + next) % self.0.len());
        let own = self.take_from(thread, first);
        own.or_else(|| others.into_iter().find_map(|other| self.take_from(other, last)))
    }

    /// A task of one share; `choose` tells which one and what is left.
    fn take_from(&self, thread: usize, choose: impl Fn(u64, u64) -> (u64, u64)) -> Option<usize> {
        let share = &self.0[thread];
        let mut left = share.load(Ordering::Relaxed);
        loop {
            let (start, end) = (left & u64::from(u32::MAX), left >> 32);
            if start >= end {
                return None;
            }
            let (task, rest) = choose(start, end);
            let order = Ordering::Relaxed;
            match share.compare_exchange_weak(left, rest, order, order) {
                Ok(_) => return Some(task as usize),
                Err(now) => left = now,
            }
        }
    }
}
