//! A barrier: threads that work together wait for each other.

use super::sync::{AtomicUsize, Ordering};

/// Added to the arrivals of a barrier at which no thread waits any more.
const OPEN: usize = 1 << (usize::BITS - 1);

/// Where `threads` threads wait for each other, any number of times.
#[derive(Debug)]
pub(super) struct Barrier {
    threads: usize,
    /// Arrivals of all threads together.
    arrived: AtomicUsize,
}

impl Barrier {
    /// A barrier at which no thread has arrived.
    pub(super) fn new(threads: usize) -> Self {
        Self { threads, arrived: AtomicUsize::new(0) }
    }

    /// Waits until every thread has arrived `times` times, this call of the current thread included.
    /// `pause` is called while it waits.
    pub(super) fn wait(&self, times: usize, mut pause: impl FnMut()) {
        // The counter is never set back. If it were, a thread still on its way out of one wait
        // could miss that it was open, because a faster thread has begun the next wait. With a
        // growing counter a wait that is open once stays open.
        //
        // The Release of AcqRel, with the Acquire below: whatever a thread wrote before the barrier
        // is seen by every thread after it. All arrivals are read-modify-writes of one counter, so a
        // load that sees the last arrival also sees what came before all earlier ones. Release would
        // be enough, because every thread loads the counter with Acquire before it goes on.
        self.arrived.fetch_add(1, Ordering::AcqRel);
        // `times` is counted by the thread itself. A count shared by all would need a second
        // barrier.
        while self.arrived.load(Ordering::Acquire) < times * self.threads {
            pause();
        }
    }

    /// Lets all threads pass from now on, because one of them will not arrive.
    pub(super) fn open(&self) {
        // The highest bit makes the counter larger than any number of arrivals, now and at every
        // later wait. Nothing resets it: the group of threads ends with the panic that opened it.
        // The order is that of an arrival, so that the threads that pass see what this one wrote.
        self.arrived.fetch_or(OPEN, Ordering::AcqRel);
    }
}
