//! The allocator of the extension module.
//!
//! A failed small allocation aborts the process. Near the limit of memory it may fail only because
//! another thread briefly has a large allocation that it will free (see `jostle_base::memory`). So small
//! allocations are retried.
//!
//! Large allocations request huge pages, as NumPy does for its arrays. A search among millions of
//! shapes then has fewer page faults and fewer TLB misses.

use std::alloc::{GlobalAlloc, Layout, System};
use std::ptr;
use std::thread;
use std::time::Duration;

/// Larger allocations are not retried: the core returns an error if they fail.
const SMALL: usize = 1 << 16;

/// Number of retries of a small allocation, and the time between them.
const TRIES: usize = 100;
const WAIT: Duration = Duration::from_millis(1);

/// Allocations of at least this number of bytes request huge pages.
const LARGE: usize = 1 << 22;

/// The size of a huge page; on systems with another size, a multiple of the page size.
#[cfg(target_os = "linux")]
const HUGE_PAGE: usize = 1 << 21;

/// The system's allocator with retries of small allocations, and huge pages for large ones.
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
    if pointer.is_null() {
        return try_again(bytes, allocate);
    }
    if bytes >= LARGE {
        advise(pointer, bytes);
    }
    pointer
}

/// Requests huge pages for a new allocation. Without effect if the system has none.
#[cfg(target_os = "linux")]
#[cold]
#[allow(unsafe_code, reason = "a call of the system")]
fn advise(pointer: *mut u8, bytes: usize) {
    let skipped = pointer.align_offset(HUGE_PAGE);
    let length = bytes.saturating_sub(skipped) / HUGE_PAGE * HUGE_PAGE;
    if length > 0 {
        // SAFETY: the range lies within the allocation, and the advice does not change its
        // contents.
        unsafe { libc::madvise(pointer.add(skipped).cast(), length, libc::MADV_HUGEPAGE) };
    }
}

#[cfg(not(target_os = "linux"))]
fn advise(_pointer: *mut u8, _bytes: usize) {}

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
