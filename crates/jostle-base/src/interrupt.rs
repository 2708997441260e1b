//! Interruption of long calls.
//!
//! [`watch`] runs a function and calls `poll` at intervals, only on the caller's thread. When
//! `poll` returns true, all tasks of this call, on all threads, return
//! [`Error::Interrupted`]. Outside of [`watch`] nothing is polled.

use std::cell::RefCell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::error::{Error, Result};

/// A function that returns whether to stop the call.
pub type Poll = fn() -> bool;

/// The call to which the current thread belongs.
struct Watch {
    stop: Stop,
    /// Set only on the thread that called [`watch`]; None while `poll` itself runs.
    poll: Option<Poll>,
}

thread_local! {
    static CURRENT: RefCell<Option<Watch>> = const { RefCell::new(None) };
}

/// Runs `work` and calls `poll` at intervals; if `poll` returns true, `work` is interrupted.
pub fn watch<R>(poll: Poll, work: impl FnOnce() -> R) -> R {
    let stop = Stop(Some(Arc::default()));
    with(Watch { stop, poll: Some(poll) }, work)
}

/// Runs `work` as a task of the call of `stop`, on a thread other than the caller's.
pub fn under<R>(stop: Stop, work: impl FnOnce() -> R) -> R {
    with(Watch { stop, poll: None }, work)
}

/// Runs `work` to completion, even if the current call is interrupted.
pub fn unwatched<R>(work: impl FnOnce() -> R) -> R {
    under(Stop::default(), work)
}

fn with<R>(watch: Watch, work: impl FnOnce() -> R) -> R {
    /// Restores the previous watch of the thread, also after a panic.
    struct Before(Option<Watch>);
    // A guard and not a line after `work()`: the binding turns a panic into an exception, and the
    // thread goes on. Without the guard a later call on it would poll for a call that no longer
    // exists.
    impl Drop for Before {
        fn drop(&mut self) {
            CURRENT.set(self.0.take());
        }
    }
    let _before = Before(CURRENT.replace(Some(watch)));
    work()
}

/// Returns an error if the current call is interrupted. For loops with few long iterations;
/// other loops use a [`Pulse`].
pub fn check() -> Result<()> {
    Stop::current().check()
}

/// A flag shared by all threads of a call: whether the call is interrupted.
#[derive(Clone, Debug, Default)]
pub struct Stop(Option<Arc<AtomicBool>>);

impl Stop {
    /// The flag of the current thread's call; outside of [`watch`] it is never set. Tasks on
    /// other threads use a clone.
    pub fn current() -> Self {
        CURRENT
            .with_borrow(|watch| watch.as_ref().map(|watch| watch.stop.clone()).unwrap_or_default())
    }

    /// Whether a poll has returned true.
    fn was_polled(&self) -> bool {
        // Relaxed, here and below: the flag publishes no other data. A task that reads it late does
        // a little more work, whose result is dropped with those of the others.
        self.0.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// Whether the call is interrupted. Polls if the current thread is the caller's.
    pub fn is_set(&self) -> bool {
        // Each way out before the poll is one read. Only the thread that called `watch` has a
        // `poll`, which may use what belongs to that thread.
        let Some(flag) = &self.0 else { return false };
        if flag.load(Ordering::Relaxed) {
            return true;
        }
        // Taken out while it runs, because `poll` itself may call `watch`.
        let poll = CURRENT.with_borrow_mut(|watch| {
            let own = watch.as_mut()?;
            // A `Stop` of an outer call may be read inside of an inner one. Then the inner poll
            // must not be asked: its answer would interrupt a call that it does not belong to.
            let same = own.stop.0.as_ref().is_some_and(|own| Arc::ptr_eq(own, flag));
            if same { own.poll.take() } else { None }
        });
        let Some(poll) = poll else { return false };
        let stopped = poll();
        CURRENT.with_borrow_mut(|watch| {
            // No borrow was held during `poll`, so it may replace the watch itself; `with` has
            // restored the one of this thread since, and the poll goes back into it.
            if let Some(watch) = watch {
                watch.poll = Some(poll);
            }
        });
        if stopped {
            flag.store(true, Ordering::Relaxed);
        }
        stopped
    }

    /// Returns an error if the call is interrupted.
    pub fn check(&self) -> Result<()> {
        if self.is_set() { Err(Error::Interrupted) } else { Ok(()) }
    }
}

/// Work between two checks of a [`Stop`], as the number of values read: tens of microseconds to
/// a few milliseconds.
const WORK_PER_CHECK: usize = 1 << 18;

/// Counts the work of one task and checks its [`Stop`] at regular intervals.
#[derive(Clone, Debug)]
pub struct Pulse {
    stop: Stop,
    left: usize,
    stopped: bool,
}

impl Pulse {
    /// A counter for a task of the call of `stop`.
    pub fn of(stop: &Stop) -> Self {
        Self { stop: stop.clone(), left: WORK_PER_CHECK, stopped: stop.was_polled() }
    }

    /// A counter for one of many tasks, each of which may have less work than there is between two
    /// checks. So all but the first check at once.
    pub fn of_task(stop: &Stop, number: usize) -> Self {
        let mut pulse = Self::of(stop);
        // Task 0 is left out, so that a call with a single short task never polls at all.
        pulse.stopped |= number > 0 && stop.is_set();
        pulse
    }

    /// A counter for work on the current thread.
    pub fn current() -> Self {
        Self::of(&Stop::current())
    }

    /// Adds `work`, the approximate number of values read; returns whether to stop.
    #[inline(always)]
    pub fn stops(&mut self, work: usize) -> bool {
        // The common way is one subtraction and one comparison, because loops over shapes call this
        // for each few shapes. A poll takes far longer than both, so it is behind a cold call.
        if self.left > work {
            self.left -= work;
            return self.stopped;
        }
        self.check_stop()
    }

    /// As [`stops`](Self::stops), as an error.
    #[inline(always)]
    pub fn check(&mut self, work: usize) -> Result<()> {
        if self.stops(work) { Err(Error::Interrupted) } else { Ok(()) }
    }

    #[cold]
    fn check_stop(&mut self) -> bool {
        self.left = WORK_PER_CHECK;
        // Once true it stays true, without further polls. Every later call returns it, so the loops
        // around the one that stopped first end as well.
        self.stopped = self.stopped || self.stop.is_set();
        self.stopped
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    thread_local! {
        static POLLS: Cell<u32> = const { Cell::new(0) };
    }

    fn third_time() -> bool {
        POLLS.set(POLLS.get() + 1);
        POLLS.get() >= 3
    }

    #[test]
    fn nothing_stops_without_a_watch() {
        assert_eq!(check(), Ok(()));
        assert!(Stop::current().0.is_none());
    }

    #[test]
    fn all_tasks_of_a_call_stop_when_poll_returns_true() {
        POLLS.set(0);
        let stop = watch(third_time, || {
            assert_eq!([check(), check()], [Ok(()), Ok(())]);
            assert_eq!([check(), check()], [Err(Error::Interrupted), Err(Error::Interrupted)]);
            Stop::current()
        });
        assert_eq!(POLLS.get(), 3);
        assert!(stop.is_set() && Stop::current().0.is_none());
    }

    #[test]
    fn a_watch_within_another_has_a_stop_of_its_own() {
        watch(
            || false,
            || {
                watch(|| true, || assert_eq!(check(), Err(Error::Interrupted)));
                assert_eq!(check(), Ok(()));
            },
        );
    }

    #[test]
    fn a_poll_may_work_under_a_watch_itself() {
        fn poll() -> bool {
            watch(|| true, || check().is_err())
        }
        watch(poll, || assert_eq!(check(), Err(Error::Interrupted)));
    }
}
