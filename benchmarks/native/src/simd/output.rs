//! The output of the kernels: a vector that is filled through a pointer.

use crate::rivals::Pair;

/// Maximum number of pairs that a store writes after the last pair.
const STORED_AT_ONCE: usize = 16;

/// The parts of a vector of pairs, passed by value so that they stay in registers.
#[derive(Debug)]
pub struct Output {
    start: *mut Pair,
    len: usize,
    capacity: usize,
}

impl Output {
    /// Empty, with room for about `expected` pairs.
    pub fn new(expected: usize) -> Self {
        Self::from(Vec::with_capacity(expected + STORED_AT_ONCE))
    }

    fn from(pairs: Vec<Pair>) -> Self {
        let mut pairs = std::mem::ManuallyDrop::new(pairs);
        Self { start: pairs.as_mut_ptr(), len: pairs.len(), capacity: pairs.capacity() }
    }

    /// The pairs.
    pub fn finish(self) -> Vec<Pair> {
        // SAFETY: `from` took these parts from a vector, and `advance` says that the first
        // `len` pairs are written.
        unsafe { Vec::from_raw_parts(self.start, self.len, self.capacity) }
    }

    /// With space for `more` pairs and a whole store after them.
    #[inline(always)]
    pub(super) fn with_room(mut self, more: usize) -> Self {
        if self.capacity - self.len < more + STORED_AT_ONCE {
            (self.start, self.capacity) = grown(self.start, self.len, self.capacity, more);
        }
        self
    }

    /// The place of the next pair; [`Output::with_room`] has allocated it.
    #[inline(always)]
    pub(super) fn next(&self) -> *mut Pair {
        // SAFETY: `len` is at most `capacity`.
        unsafe { self.start.add(self.len) }
    }

    /// # Safety
    ///
    /// `written` pairs are stored after the last one, within the capacity.
    #[inline(always)]
    pub(super) unsafe fn advance(mut self, written: usize) -> Self {
        self.len += written;
        self
    }
}

/// Start and capacity of the parts of a vector, with space for `more`. Takes and returns single
/// numbers, because a whole [`Output`] would not stay in registers.
#[cold]
#[inline(never)]
fn grown(start: *mut Pair, len: usize, capacity: usize, more: usize) -> (*mut Pair, usize) {
    let mut pairs = Output { start, len, capacity }.finish();
    pairs.reserve(more + STORED_AT_ONCE);
    let Output { start, capacity, .. } = Output::from(pairs);
    (start, capacity)
}
