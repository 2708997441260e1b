//! Where kernels write pairs: a vector that they fill through a pointer.

use crate::rivals::Pair;

/// Pairs that may be stored behind the last one before it is known how many of them count.
const STORED_AT_ONCE: usize = 16;

/// A vector of pairs taken apart, passed by value so that its parts stay in registers.
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

    /// With room for `more` pairs and a whole store behind them.
    #[inline(always)]
    pub(super) fn with_room(mut self, more: usize) -> Self {
        if self.capacity - self.len < more + STORED_AT_ONCE {
            (self.start, self.capacity) = grown(self.start, self.len, self.capacity, more);
        }
        self
    }

    /// Where the next pair goes; room was made by [`Output::with_room`].
    #[inline(always)]
    pub(super) fn next(&self) -> *mut Pair {
        // SAFETY: `len` is at most `capacity`.
        unsafe { self.start.add(self.len) }
    }

    /// # Safety
    ///
    /// `written` pairs stand behind the last one, within the capacity.
    #[inline(always)]
    pub(super) unsafe fn advance(mut self, written: usize) -> Self {
        self.len += written;
        self
    }
}

/// Start and capacity of a vector that was taken apart, with room for `more`. Takes and gives
/// single numbers: a whole [`Output`] would be forced out of its registers.
#[cold]
#[inline(never)]
fn grown(start: *mut Pair, len: usize, capacity: usize, more: usize) -> (*mut Pair, usize) {
    let mut pairs = Output { start, len, capacity }.finish();
    pairs.reserve(more + STORED_AT_ONCE);
    let Output { start, capacity, .. } = Output::from(pairs);
    (start, capacity)
}
