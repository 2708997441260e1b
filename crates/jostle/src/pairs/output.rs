//! Collecting pairs from many tasks, within one limit.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::Found;
use crate::error::{Error, Result};

/// New pairs are reported to the common count in portions of this size.
const PORTION: usize = 1 << 16;

/// How many pairs all tasks together may still find.
pub(super) struct Budget {
    max_pairs: usize,
    count: AtomicUsize,
}

impl Budget {
    pub(super) fn new(max_pairs: usize) -> Self {
        Self { max_pairs, count: AtomicUsize::new(0) }
    }

    pub(super) fn collect(&self, parts: Vec<Found>) -> Result<Found> {
        let count: usize = parts.iter().map(|part| part.pairs.len()).sum();
        if count > self.max_pairs || self.count.load(Ordering::Relaxed) > self.max_pairs {
            return Err(Error::TooManyPairs { max_pairs: self.max_pairs });
        }
        let mut parts = parts.into_iter();
        let mut all = parts.next().unwrap_or_default();
        all.pairs.reserve(count - all.pairs.len());
        for part in parts {
            all.pairs.extend_from_slice(&part.pairs);
            all.tests += part.tests;
        }
        Ok(all)
    }
}

/// What one task has found so far.
pub(super) struct Output<'a> {
    pairs: Vec<[u32; 2]>,
    pub(super) tests: u64,
    budget: &'a Budget,
    reported: usize,
    /// Pairs at which the next portion is reported.
    report_at: usize,
    full: bool,
}

impl<'a> Output<'a> {
    pub(super) fn new(budget: &'a Budget) -> Self {
        let report_at = PORTION.min(budget.max_pairs.saturating_add(1));
        Self { pairs: Vec::new(), tests: 0, budget, reported: 0, report_at, full: false }
    }

    #[inline(always)]
    pub(super) fn push(&mut self, pair: [u32; 2]) {
        self.pairs.push(pair);
        if self.pairs.len() >= self.report_at {
            self.report();
        }
    }

    #[cold]
    fn report(&mut self) {
        let new = self.pairs.len() - self.reported;
        let before = self.budget.count.fetch_add(new, Ordering::Relaxed);
        self.reported = self.pairs.len();
        self.report_at = self.reported + PORTION;
        self.full = before + new > self.budget.max_pairs;
    }

    /// Whether there is no point in going on.
    pub(super) fn is_full(&self) -> bool {
        self.full
    }

    pub(super) fn finish(self) -> Found {
        Found { pairs: self.pairs, tests: self.tests }
    }
}
