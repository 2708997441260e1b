//! Collecting pairs from many tasks, within one limit.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use super::Found;
use crate::error::{Error, Result};
use crate::interrupt::{Pulse, Stop};
use crate::memory;
use crate::parallel;
use crate::simd::{LANES, for_each_lane};

/// New pairs are reported to the common count in portions of this size.
const PORTION: usize = 1 << 16;

/// Two places.
type Pair = [u32; 2];

/// Pairs per copy.
const COPIED: usize = 1 << 18;

/// Pairs are converted in portions of this size, which fit into the first-level cache.
const UNFINISHED: usize = 1 << 10;

/// Converts new pairs of places, the last ones of a vector, into results; may remove some
/// with [`keep`].
///
/// It is called for many pairs at a time, so the kernels do not depend on its type and are
/// compiled once.
pub(super) type Finish<'a> = dyn Fn(&mut Vec<[u32; 2]>, Range<usize>) + Sync + 'a;

/// Replaces the pairs of `range`, the last ones of a vector, by the results of `map`.
pub(super) fn keep(
    pairs: &mut Vec<[u32; 2]>,
    range: Range<usize>,
    map: impl Fn([u32; 2]) -> Option<[u32; 2]>,
) {
    let mut end = range.start;
    for index in range {
        if let Some(pair) = map(pairs[index]) {
            pairs[end] = pair;
            end += 1;
        }
    }
    pairs.truncate(end);
}

/// The number of pairs that all tasks together may still find, and whether to stop.
pub(super) struct Budget {
    max_pairs: usize,
    count: AtomicUsize,
    /// A task has failed, so the others stop.
    failed: AtomicBool,
    stop: Stop,
}

impl Budget {
    pub(super) fn new(max_pairs: usize) -> Self {
        let (count, failed) = (AtomicUsize::new(0), AtomicBool::new(false));
        Self { max_pairs, count, failed, stop: Stop::current() }
    }

    /// Returns an error if there are more than the allowed number of pairs; `count` is the number
    /// of those that are in memory.
    fn check(&self, count: usize) -> Result<()> {
        if self.count.load(Ordering::Relaxed).max(count) > self.max_pairs {
            return Err(Error::TooManyPairs { max_pairs: self.max_pairs });
        }
        Ok(())
    }

    /// The pairs of the only task.
    pub(super) fn accept(&self, found: Result<Found>) -> Result<Found> {
        self.check(found.as_ref().map_or(0, |found| found.pairs.len()))?;
        found
    }

    /// Puts the parts together, in their order.
    pub(super) fn collect(
        &self,
        threads: Option<usize>,
        parts: Vec<Result<Found>>,
    ) -> Result<Found> {
        let parts = parts.into_iter().collect::<Result<Vec<Found>>>();
        let count = parts.iter().flatten().map(|part| part.pairs.len()).sum();
        self.check(count)?;
        let parts = parts?;
        let tests = parts.iter().map(|part| part.tests).sum();
        let mut pairs = memory::zeroed(count)?;
        let mut rest = pairs.as_mut_slice();
        let targets = parts.iter().flat_map(|part| {
            let target = rest.split_off_mut(..part.pairs.len()).expect("the sizes add up");
            target.chunks_mut(COPIED).zip(part.pairs.chunks(COPIED))
        });
        parallel::for_each(threads, targets, |(target, source)| {
            if !self.stop.is_set() {
                target.copy_from_slice(source);
            }
        });
        self.stop.check()?;
        Ok(Found { pairs, tests })
    }
}

/// Rows that a kernel may test against a block before it settles what it found.
pub(super) const NOTES: usize = 64;

/// What one task has found so far.
pub(super) struct Output<'a> {
    pairs: Vec<[u32; 2]>,
    pub(super) tests: u64,
    /// Which of some rows overlaps which lanes of a block.
    pub(super) notes: [(u32, u32); NOTES],
    finish: &'a Finish<'a>,
    finished: usize,
    budget: &'a Budget,
    reported: usize,
    pulse: Pulse,
    /// The reason to stop.
    over: Option<Over>,
}

/// Why a task ends early.
enum Over {
    /// There are more pairs than allowed, or another task has failed.
    Enough,
    Failed(Error),
}

impl<'a> Output<'a> {
    /// Collects pairs in the memory of `pairs`.
    pub(super) fn new(budget: &'a Budget, finish: &'a Finish<'a>, mut pairs: Vec<Pair>) -> Self {
        pairs.clear();
        Self {
            pairs,
            tests: 0,
            notes: [(0, 0); NOTES],
            finish,
            finished: 0,
            budget,
            reported: 0,
            pulse: Pulse::of(&budget.stop),
            over: None,
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
        let count = count.min(NOTES);
        if self.pairs.capacity() - self.pairs.len() < count * LANES && !self.grow(count * LANES) {
            return;
        }
        for &(row, bits) in &self.notes[..count] {
            let first = first(row);
            for_each_lane(bits, |lane| self.pairs.push([first, second(lane)]));
        }
        if self.pairs.len() - self.finished >= UNFINISHED.min(self.budget.max_pairs) {
            self.finish();
        }
    }

    /// Converts the new pairs, and counts them if there are many.
    #[cold]
    fn finish(&mut self) {
        let new = self.finished..self.pairs.len();
        (self.finish)(&mut self.pairs, new);
        self.finished = self.pairs.len();
        if self.finished - self.reported >= PORTION.min(self.budget.max_pairs) {
            self.report();
        }
    }

    /// Reserves memory for more pairs; returns whether that succeeded.
    #[cold]
    fn grow(&mut self, more: usize) -> bool {
        let reserved = memory::reserve(&mut self.pairs, more);
        reserved.map_err(|error| self.fail(error.in_all(self.bytes_of_all(more)))).is_ok()
    }

    /// Bytes of `more` pairs and of those that all tasks have found so far.
    fn bytes_of_all(&self, more: usize) -> usize {
        let new = self.pairs.len() - self.reported;
        (self.budget.count.load(Ordering::Relaxed) + new + more) * size_of::<Pair>()
    }

    fn report(&mut self) {
        let new = self.pairs.len() - self.reported;
        let before = self.budget.count.fetch_add(new, Ordering::Relaxed);
        self.reported = self.pairs.len();
        if before + new > self.budget.max_pairs {
            self.over = Some(Over::Enough);
        }
    }

    #[cold]
    fn fail(&mut self, error: Error) {
        self.budget.failed.store(true, Ordering::Relaxed);
        self.over = Some(Over::Failed(error));
    }

    /// Whether to stop, after about `work` more numbers have been read.
    #[inline(always)]
    pub(super) fn is_over(&mut self, work: usize) -> bool {
        if self.pulse.stops(work) && self.over.is_none() {
            self.fail(Error::Interrupted);
        }
        self.over.is_some()
    }

    pub(super) fn into_found(mut self) -> Result<Found> {
        self.finish();
        match self.over {
            Some(Over::Failed(error)) => Err(error),
            _ => Ok(Found { pairs: self.pairs, tests: self.tests }),
        }
    }
}
