//! The allocator of the extension module.
//!
//! A small allocation that fails ends the process. Near the limit of memory it may fail only because
//! another thread holds, for a moment, a large allocation that it is about to refuse (see
//! `jostle::memory`). So small allocations wait for that thread.
//!
//! Large allocations ask for huge pages, as NumPy does for its arrays: a search among millions of shapes
//! then takes fewer page faults, and fewer reads of page tables.

use std::alloc::{GlobalAlloc, Layout, System};
use std::ptr;
use std::thread;
use std::time::Duration;

/// Larger allocations fail at once: the core makes an error of the failure.
const SMALL: usize = 1 << 16;

/// Times that a small allocation is tried again, and the time between them.
const TRIES: usize = 100;
const WAIT: Duration = Duration::from_millis(1);

/// Allocations of at least so many bytes ask for huge pages.
const LARGE: usize = 1 << 22;

/// The size of a huge page, or a multiple of a page on systems where it is another.
#[cfg(target_os = "linux")]
const HUGE_PAGE: usize = 1 << 21;

/// The system's allocator. Small allocations that fail are tried again.
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

/// Asks for huge pages in a new allocation. If the system has none, nothing changes.
#[cfg(target_os = "linux")]
#[cold]
#[allow(unsafe_code, reason = "a call of the system")]
fn advise(pointer: *mut u8, bytes: usize) {
    let skipped = pointer.align_offset(HUGE_PAGE);
    let length = bytes.saturating_sub(skipped) / HUGE_PAGE * HUGE_PAGE;
    if length > 0 {
        // SAFETY: the range lies within the allocation, and the advice does not change its contents.
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
