//! An allocator that refuses some large allocations while it is armed.

use std::alloc::{GlobalAlloc, Layout, System};
use std::backtrace::Backtrace;
use std::cell::Cell;
use std::ptr;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};

/// Bytes from which on an allocation is large. Smaller ones may abort the process (`jostle_base::memory`).
const LARGE: usize = 1 << 14;

/// Which of the large allocations are refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refused {
    /// The k-th alone, from 1 on.
    One(usize),
    /// All from the k-th on.
    From(usize),
}

/// Large allocations that are still granted; those that are refused then. `NONE` disarms.
static GRANTED: AtomicUsize = AtomicUsize::new(NONE);
static REFUSES_ALL: AtomicBool = AtomicBool::new(false);
static REFUSED: AtomicUsize = AtomicUsize::new(0);
const NONE: usize = usize::MAX;

thread_local! {
    static IS_PRINTING: Cell<bool> = const { Cell::new(false) };
}

/// What `call` returns while some large allocations are refused, and how many were.
pub fn refusing<R>(which: Refused, call: impl FnOnce() -> R) -> (R, usize) {
    let (Refused::One(k) | Refused::From(k)) = which;
    REFUSED.store(0, Relaxed);
    REFUSES_ALL.store(matches!(which, Refused::From(_)), Relaxed);
    GRANTED.store(k - 1, Relaxed);
    let result = call();
    GRANTED.store(NONE, Relaxed);
    (result, REFUSED.load(Relaxed))
}

/// How many large allocations a call makes.
pub fn large_allocations(call: impl FnOnce()) -> usize {
    GRANTED.store(NONE - 1, Relaxed);
    call();
    NONE - 1 - GRANTED.swap(NONE, Relaxed)
}

fn is_refused(size: usize) -> bool {
    if size < LARGE || IS_PRINTING.get() {
        return false;
    }
    let next = |granted: usize| match granted {
        NONE => None,
        0 => Some(if REFUSES_ALL.load(Relaxed) { 0 } else { NONE }),
        _ => Some(granted - 1),
    };
    let is_refused = GRANTED.fetch_update(Relaxed, Relaxed, next) == Ok(0);
    if is_refused {
        REFUSED.fetch_add(1, Relaxed);
        if std::env::var_os("JOSTLE_TRACE").is_some() {
            IS_PRINTING.set(true);
            eprintln!("{}", Backtrace::force_capture());
            IS_PRINTING.set(false);
        }
    }
    is_refused
}

pub struct Refusing;

#[allow(unsafe_code, reason = "an allocator is unsafe to implement")]
// SAFETY: every call is passed on to the system's allocator, or refused without an effect.
unsafe impl GlobalAlloc for Refusing {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if is_refused(layout.size()) { ptr::null_mut() } else { unsafe { System.alloc(layout) } }
    }

    // `memory::zeroed` tests the same size before: the standard library has no zeroed vector that may fail.
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // A vector that becomes smaller keeps its place.
        if size > layout.size() && is_refused(size) {
            return ptr::null_mut();
        }
        unsafe { System.realloc(pointer, layout, size) }
    }
}
