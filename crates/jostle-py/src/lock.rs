//! A lock that returns an error instead of waiting forever.

use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, TryLockError};
use std::thread;
use std::time::Duration;

use jostle_base::parallel::forks;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::sync::MutexExt;

/// A value that one thread at a time uses.
pub struct Shared<T> {
    value: Mutex<T>,
    /// The thread that has the lock; 0 if none has it.
    user: AtomicU64,
    /// For error messages: what the value is, and how to get another one.
    noun: &'static str,
    remedy: &'static str,
}

/// A number for the current thread of the current process, never 0.
fn current_user() -> u64 {
    static THREADS: AtomicU64 = AtomicU64::new(1);
    thread_local! {
        // Relaxed: each addition gives another number, in whatever order threads see them.
        static THREAD: u64 = THREADS.fetch_add(1, Ordering::Relaxed);
    }
    (forks() as u64) << 48 | THREAD.with(|thread| *thread)
}

/// The process of a user, as the number of forks.
fn process_of(user: u64) -> u64 {
    user >> 48
}

/// Milliseconds that a forked process waits for a thread that may not exist in it.
const MAX_WAIT: u32 = 100;

impl<T> Shared<T> {
    /// `noun` names the value in errors, `remedy` says how to get another one.
    pub fn new(value: T, noun: &'static str, remedy: &'static str) -> Self {
        Self { value: Mutex::new(value), user: AtomicU64::new(0), noun, remedy }
    }

    /// Waits for the value. The caller must have released the GIL.
    pub fn lock(&self) -> PyResult<Guard<'_, T>> {
        let value = self.try_lock()?.map_or_else(|| self.value.lock().ok(), Some);
        value.map(|value| self.used(value)).ok_or_else(|| self.broken())
    }

    /// Waits for the value, with the GIL held while the value is used.
    pub fn lock_attached(&self, py: Python<'_>) -> PyResult<Guard<'_, T>> {
        let value = self.try_lock()?.map_or_else(|| self.value.lock_py_attached(py).ok(), Some);
        value.map(|value| self.used(value)).ok_or_else(|| self.broken())
    }

    fn used<'a>(&'a self, value: MutexGuard<'a, T>) -> Guard<'a, T> {
        // Relaxed, here and below: only the thread that stores its own number relies on it, and a thread sees its own
        // writes. For others it only decides how long they wait; the mutex orders the accesses to the value.
        self.user.store(current_user(), Ordering::Relaxed);
        Guard { value, user: &self.user }
    }

    /// None if a thread of this process uses the value. Returns an error if the value is used
    /// by a call that this one interrupted, or by a thread that does not exist here.
    fn try_lock(&self) -> PyResult<Option<MutexGuard<'_, T>>> {
        for _ in 0..MAX_WAIT {
            match self.value.try_lock() {
                Ok(value) => return Ok(Some(value)),
                Err(TryLockError::Poisoned(_)) => return Err(self.broken()),
                Err(TryLockError::WouldBlock) => {}
            }
            // Relaxed: an old number of another thread costs another turn at most, see `used`.
            let user = self.user.load(Ordering::Relaxed);
            if user == current_user() {
                return Err(self.busy());
            }
            if forks() == 0 || user != 0 && process_of(user) == process_of(current_user()) {
                return Ok(None);
            }
            // Locked either by a thread of this process just now, or by one of the parent process.
            thread::sleep(Duration::from_millis(1));
        }
        Err(self.left_behind())
    }

    fn busy(&self) -> PyErr {
        PyRuntimeError::new_err(format!(
            "this {} is in use: a signal handler cannot use it before the call that it has \
             interrupted ends",
            self.noun
        ))
    }

    fn left_behind(&self) -> PyErr {
        PyRuntimeError::new_err(format!(
            "another thread was using this {} when this process was forked, so it cannot be used \
             here; {}, or fork while no other thread uses it",
            self.noun, self.remedy
        ))
    }

    fn broken(&self) -> PyErr {
        PyRuntimeError::new_err(format!(
            "an earlier call failed and left this {} in an unknown state; {}",
            self.noun, self.remedy
        ))
    }
}

/// The locked value.
pub struct Guard<'a, T> {
    value: MutexGuard<'a, T>,
    user: &'a AtomicU64,
}

impl<T> Drop for Guard<'_, T> {
    fn drop(&mut self) {
        // Relaxed: the mutex is unlocked after this, with Release, when `value` is dropped.
        self.user.store(0, Ordering::Relaxed);
    }
}

impl<T> Deref for Guard<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T> DerefMut for Guard<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        &mut self.value
    }
}
