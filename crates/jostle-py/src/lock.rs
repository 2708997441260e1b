//! What one thread at a time works on: a lock that says so where it could never be had.

use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, TryLockError};
use std::thread;
use std::time::Duration;

use jostle::parallel::forks;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::sync::MutexExt;

/// A value that one thread at a time uses.
pub struct Shared<T> {
    value: Mutex<T>,
    /// Who uses it; 0 for nobody.
    user: AtomicU64,
    /// What it is, and how to get another one, for errors.
    noun: &'static str,
    remedy: &'static str,
}

/// The present thread of the present process, never 0.
fn present() -> u64 {
    static THREADS: AtomicU64 = AtomicU64::new(1);
    thread_local! {
        static THREAD: u64 = THREADS.fetch_add(1, Ordering::Relaxed);
    }
    (forks() as u64) << 48 | THREAD.with(|thread| *thread)
}

/// In which process a user was.
fn era(user: u64) -> u64 {
    user >> 48
}

/// Turns that a forked process waits for a thread that may not be there, of a millisecond.
const PATIENCE: u32 = 100;

impl<T> Shared<T> {
    /// `noun` names the value in errors, `remedy` says how to get another one.
    pub fn new(value: T, noun: &'static str, remedy: &'static str) -> Self {
        Self { value: Mutex::new(value), user: AtomicU64::new(0), noun, remedy }
    }

    /// Waits for the value. The interpreter must be free for other threads.
    pub fn lock(&self) -> PyResult<Guard<'_, T>> {
        let value = self.try_lock()?.map_or_else(|| self.value.lock().ok(), Some);
        value.map(|value| self.used(value)).ok_or_else(|| self.broken())
    }

    /// Waits for the value, for a glance.
    pub fn lock_attached(&self, py: Python<'_>) -> PyResult<Guard<'_, T>> {
        let value = self.try_lock()?.map_or_else(|| self.value.lock_py_attached(py).ok(), Some);
        value.map(|value| self.used(value)).ok_or_else(|| self.broken())
    }

    fn used<'a>(&'a self, value: MutexGuard<'a, T>) -> Guard<'a, T> {
        self.user.store(present(), Ordering::Relaxed);
        Guard { value, user: &self.user }
    }

    /// None where a thread has it that will be done. Refuses to wait for any other.
    fn try_lock(&self) -> PyResult<Option<MutexGuard<'_, T>>> {
        for _ in 0..PATIENCE {
            match self.value.try_lock() {
                Ok(value) => return Ok(Some(value)),
                Err(TryLockError::Poisoned(_)) => return Err(self.broken()),
                Err(TryLockError::WouldBlock) => {}
            }
            let user = self.user.load(Ordering::Relaxed);
            if user == present() {
                return Err(self.busy());
            }
            if forks() == 0 || user != 0 && era(user) == era(present()) {
                return Ok(None);
            }
            // Either it has just been taken, or by a thread that did not come along.
            thread::sleep(Duration::from_millis(1));
        }
        Err(self.left_behind())
    }

    fn busy(&self) -> PyErr {
        PyRuntimeError::new_err(format!(
            "this {} is at work: a signal handler cannot use it before the call that it has \
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

/// The value, as long as the present thread uses it.
pub struct Guard<'a, T> {
    value: MutexGuard<'a, T>,
    user: &'a AtomicU64,
}

impl<T> Drop for Guard<'_, T> {
    fn drop(&mut self) {
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
