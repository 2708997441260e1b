//! The allocator of the extension module.
//!
//! A failed small allocation aborts the process. Near the limit of memory it may fail only because
//! another thread briefly has a large allocation that it will free (see `jostle::memory`). So small
//! allocations are retried.

use std::alloc::{GlobalAlloc, Layout, System};
use std::ptr;
use std::thread;
use std::time::Duration;

/// Larger allocations are not retried: the core returns an error if they fail.
const SMALL: usize = 1 << 16;

/// Number of retries of a small allocation, and the time between them.
const TRIES: usize = 100;
const WAIT: Duration = Duration::from_millis(1);

/// The system's allocator with retries of small allocations.
struct Retrying;

#[global_allocator]
static ALLOCATOR: Retrying = Retrying;

#[cold]
fn try_again(bytes: usize, allocate: impl Fn() -> *mut u8) -> *mut u8 {
    let tries = if bytes <= SMALL { TRIES } else { 0 };
    let mut attempts = (0..tries).map(|_| {
        thread::sleep(WAIT);
        allocate()
    });
    attempts.find(|pointer| !pointer.is_null()).unwrap_or(ptr::null_mut())
}

#[inline(always)]
fn allocate(bytes: usize, allocate: impl Fn() -> *mut u8) -> *mut u8 {
    let pointer = allocate();
    if pointer.is_null() { try_again(bytes, allocate) } else { pointer }
}

#[allow(unsafe_code, reason = "an allocator is unsafe to implement")]
// SAFETY: every call is passed on to the system's allocator; one that failed has changed nothing.
unsafe impl GlobalAlloc for Retrying {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        allocate(layout.size(), || unsafe { System.alloc(layout) })
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        allocate(layout.size(), || unsafe { System.alloc_zeroed(layout) })
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        allocate(size, || unsafe { System.realloc(pointer, layout, size) })
    }
}
