//! A barrier: threads that work together wait for each other.

use super::sync::{AtomicUsize, Ordering};

/// Added to the arrivals of a barrier at which no thread waits any more.
const OPEN: usize = 1 << (usize::BITS - 1);

/// Where `threads` threads wait for each other, any number of times.
#[derive(Debug)]
pub struct Barrier {
    threads: usize,
    /// Arrivals of all threads together.
    arrived: AtomicUsize,
}

impl Barrier {
    /// A barrier at which no thread has arrived.
    pub fn new(threads: usize) -> Self {
        Self { threads, arrived: AtomicUsize::new(0) }
    }

    /// Waits until every thread has arrived `times` times, this call of the current thread included.
    /// `pause` is called while it waits.
    pub fn wait(&self, times: usize, mut pause: impl FnMut()) {
        self.arrived.fetch_add(1, Ordering::AcqRel);
        while self.arrived.load(Ordering::Acquire) < times * self.threads {
            pause();
        }
    }

    /// Lets all threads pass from now on, because one of them will not arrive.
    pub fn open(&self) {
        self.arrived.fetch_or(OPEN, Ordering::AcqRel);
    }
}
