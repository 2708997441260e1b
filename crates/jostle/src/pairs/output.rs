//! Collecting pairs from many tasks, within one limit.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::Found;
use crate::error::{Error, Result};
use crate::parallel;
use crate::simd::for_each_lane;

/// New pairs are reported to the common count in portions of this size.
const PORTION: usize = 1 << 16;

/// What becomes of a pair of places before it is handed out; nothing if it is not wanted.
pub(super) trait Finish: Fn(u32, u32) -> Option<[u32; 2]> + Sync + Send {}
impl<F: Fn(u32, u32) -> Option<[u32; 2]> + Sync + Send> Finish for F {}

/// How many pairs all tasks together may still find.
pub(super) struct Budget {
    max_pairs: usize,
    count: AtomicUsize,
}

impl Budget {
    pub(super) fn new(max_pairs: usize) -> Self {
        Self { max_pairs, count: AtomicUsize::new(0) }
    }

    /// Puts the parts together, in their order.
    pub(super) fn collect(&self, threads: Option<usize>, mut parts: Vec<Found>) -> Result<Found> {
        let count: usize = parts.iter().map(|part| part.pairs.len()).sum();
        if count > self.max_pairs || self.count.load(Ordering::Relaxed) > self.max_pairs {
            return Err(Error::TooManyPairs { max_pairs: self.max_pairs });
        }
        let tests = parts.iter().map(|part| part.tests).sum();
        if parts.len() <= 1 {
            return Ok(parts.pop().unwrap_or_default());
        }
        let mut pairs = vec![[0; 2]; count];
        let mut rest = pairs.as_mut_slice();
        let targets = parts.iter().map(|part| {
            let (target, behind) = std::mem::take(&mut rest).split_at_mut(part.pairs.len());
            rest = behind;
            (target, &part.pairs)
        });
        let mut targets: Vec<_> = targets.collect();
        parallel::for_each(threads, &mut targets, |(target, source)| {
            target.copy_from_slice(source);
        });
        Ok(Found { pairs, tests })
    }
}

/// Rows that a kernel may test against a block before it settles what it found.
pub(super) const NOTES: usize = 64;

/// What one task has found so far.
pub(super) struct Output<'a, F> {
    pairs: Vec<[u32; 2]>,
    pub(super) tests: u64,
    /// Which of some rows overlaps which lanes of a block.
    pub(super) notes: [(u32, u32); NOTES],
    finish: F,
    budget: &'a Budget,
    reported: usize,
    full: bool,
}

impl<'a, F: Finish> Output<'a, F> {
    pub(super) fn new(budget: &'a Budget, finish: F) -> Self {
        Self {
            pairs: Vec::new(),
            tests: 0,
            notes: [(0, 0); NOTES],
            finish,
            budget,
            reported: 0,
            full: false,
        }
    }

    /// Makes pairs of the first `count` notes; `first` and `second` tell the places of
    /// a row and of a lane.
    #[inline(always)]
    pub(super) fn settle(
        &mut self,
        count: usize,
        first: impl Fn(u32) -> u32,
        second: impl Fn(usize) -> u32,
    ) {
        for &(row, bits) in &self.notes[..count.min(NOTES)] {
            let first = first(row);
            for_each_lane(bits, |lane| self.pairs.extend((self.finish)(first, second(lane))));
        }
        if self.pairs.len() - self.reported >= PORTION.min(self.budget.max_pairs) {
            self.report();
        }
    }

    #[cold]
    fn report(&mut self) {
        let new = self.pairs.len() - self.reported;
        let before = self.budget.count.fetch_add(new, Ordering::Relaxed);
        self.reported = self.pairs.len();
        self.full = before + new > self.budget.max_pairs;
    }

    /// Whether there is no point in going on.
    #[inline(always)]
    pub(super) fn is_full(&self) -> bool {
        self.full
    }

    pub(super) fn into_found(self) -> Found {
        Found { pairs: self.pairs, tests: self.tests }
    }
}
