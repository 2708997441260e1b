//! Collection of the pairs of all tasks, with a common limit.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use super::Found;
use jostle_base::error::{Error, Result};
use jostle_base::interrupt::{Pulse, Stop};
use jostle_base::memory;
use jostle_base::parallel::{self, locked};
use jostle_simd::LANES;

/// A thread adds its new pairs to the common count in portions of this size.
const REPORTED: usize = 1 << 16;

/// Two indices, or two rows.
pub(super) type Pair = [u32; 2];

/// Number of pairs of a task that copies pairs to the result.
const COPIED: usize = 1 << 18;

/// Pairs are converted in portions of this size, which fit into the first-level cache.
const CONVERTED: usize = 1 << 10;

/// Converts pairs of indices in place; the results are at the beginning. Returns their number.
///
/// A trait object that is called for many pairs at a time, so that the kernels are compiled once.
pub(super) type MapPairs<'a> = dyn Fn(&mut [Pair]) -> usize + Sync + 'a;

/// Replaces each pair by the result of `map`; returns the number of pairs.
pub(super) fn map_each(pairs: &mut [Pair], map: impl Fn(Pair) -> Pair) -> usize {
    pairs.iter_mut().for_each(|pair| *pair = map(*pair));
    pairs.len()
}

/// Replaces pairs by the results of `map`, without those that are None; returns their number.
pub(super) fn filter_map(pairs: &mut [Pair], map: impl Fn(Pair) -> Option<Pair>) -> usize {
    let mut kept = 0;
    for index in 0..pairs.len() {
        if let Some(pair) = map(pairs[index]) {
            pairs[kept] = pair;
            kept += 1;
        }
    }
    kept
}

/// The common limit of all tasks of a search, and whether to stop.
pub(super) struct Budget {
    max_pairs: usize,
    count: AtomicUsize,
    /// Whether a task has failed; then the others stop.
    failed: AtomicBool,
    stop: Stop,
}

impl Budget {
    pub(super) fn new(max_pairs: usize) -> Self {
        let (count, failed) = (AtomicUsize::new(0), AtomicBool::new(false));
        Self { max_pairs, count, failed, stop: Stop::current() }
    }

    /// Returns an error if there are more than `max_pairs` pairs; `count` is the number of those in
    /// memory.
    fn check(&self, count: usize) -> Result<()> {
        // Relaxed, as all atomics here: the count and the flag only end a search early. Which error
        // is returned is decided afterwards, from what each thread has found.
        if self.count.load(Ordering::Relaxed).max(count) > self.max_pairs {
            return Err(Error::TooManyPairs { max_pairs: self.max_pairs });
        }
        Ok(())
    }

    /// Runs `work` for each of `tasks`. Each thread collects the pairs of its tasks in one vector;
    /// finally all are combined in the order of the tasks.
    pub(super) fn find<'a>(
        &'a self,
        threads: Option<usize>,
        tasks: usize,
        map: &'a MapPairs<'a>,
        scratch: &mut PairScratch,
        work: impl Fn(usize, &mut Output<'a>) + Sync + Send,
    ) -> Result<Found> {
        let PairScratch { result, parts } = scratch;
        if !parallel::is_parallel(threads) {
            // One thread writes straight into the memory of the result, so nothing is copied at the
            // end.
            let part =
                ThreadPairs { pairs: std::mem::take(result), ..parts.pop().unwrap_or_default() };
            let mut output = Output::new(self, map, part);
            (0..tasks).for_each(|task| work(task, &mut output));
            output.convert();
            return self.accept(output, parts);
        }
        let unused = Mutex::new(std::mem::take(parts));
        // A list for each thread, not for each task: with one for each task half of the calls of
        // the system were those of threads that waited for the memory allocator
        // (docs/benchmarks-notes.md).
        let make = || Output::new(self, map, locked(&unused).pop().unwrap_or_default());
        let mut outputs = parallel::for_tasks_with(threads, tasks, make, |task, output| {
            if !self.failed.load(Ordering::Relaxed) {
                work(task, output);
                output.end_task(task);
            }
        });
        *parts = unused.into_inner().unwrap_or_else(PoisonError::into_inner);
        // One thread has done all tasks in their order: its list is the result.
        let in_order = outputs.len() == 1 && outputs[0].part.tasks.len() < 2;
        if let Some(only) = outputs.pop_if(|_| in_order) {
            return self.accept(only, parts);
        }
        let tests = outputs.iter().map(|output| output.tests).sum();
        let count = outputs.iter().map(|output| output.count).sum();
        self.check(count)?;
        let used =
            outputs.into_iter().map(Output::into_part).collect::<Result<Vec<ThreadPairs>>>()?;
        let pairs = self.in_order(threads, &used, count, std::mem::take(result))?;
        parts.extend(used);
        Ok(Found { pairs, tests })
    }

    /// The result if one thread has found all pairs.
    fn accept(&self, output: Output<'_>, parts: &mut Vec<ThreadPairs>) -> Result<Found> {
        self.check(output.count)?;
        let tests = output.tests;
        let mut part = output.into_part()?;
        let pairs = std::mem::take(&mut part.pairs);
        parts.push(part);
        Ok(Found { pairs, tests })
    }

    /// The pairs of all parts in the order of their tasks.
    fn in_order(
        &self,
        threads: Option<usize>,
        parts: &[ThreadPairs],
        count: usize,
        mut pairs: Vec<Pair>,
    ) -> Result<Vec<Pair>> {
        let pieces = parts.iter().flat_map(|ThreadPairs { pairs, tasks, .. }| {
            tasks.iter().map(|(tasks, range)| (tasks.start, &pairs[range.clone()]))
        });
        let mut pieces: Vec<(usize, &[Pair])> = pieces.collect();
        // Canonical order: by the number of the task, whoever has run it. A thread that ran
        // adjacent tasks has one piece for all of them. Numbers differ, so an unstable sort has one
        // result.
        pieces.sort_unstable_by_key(|piece| piece.0);
        if pairs.capacity() < count {
            // The system maps a zeroed page when it is first written, here by the thread that
            // copies to it. Filled with zeros by one thread, the pages would take longer than the
            // copies.
            pairs = memory::zeroed(count)?;
        }
        pairs.resize(count, [0; 2]);
        let mut rest = pairs.as_mut_slice();
        let targets = pieces.into_iter().flat_map(|(_, piece)| {
            let target = rest.split_off_mut(..piece.len()).expect("the sizes add up");
            target.chunks_mut(COPIED).zip(piece.chunks(COPIED))
        });
        parallel::for_each(threads, targets, |(target, source)| {
            if !self.stop.is_set() {
                target.copy_from_slice(source);
            }
        });
        self.stop.check()?;
        Ok(pairs)
    }
}

/// Scratch of [`Budget::find`], kept between calls.
#[derive(Clone, Debug, Default)]
pub(super) struct PairScratch {
    /// Memory for the result.
    pub(super) result: Vec<Pair>,
    /// Memory for each thread.
    parts: Vec<ThreadPairs>,
}

impl PairScratch {
    /// Allocated bytes of pairs, used or not.
    pub(super) fn memory_bytes(&self) -> usize {
        let parts: usize = self.parts.iter().map(|part| part.pairs.capacity()).sum();
        (self.result.capacity() + parts) * size_of::<Pair>()
    }
}

/// The pairs of one thread.
#[derive(Clone, Debug, Default)]
struct ThreadPairs {
    pairs: Vec<Pair>,
    /// Ranges of the tasks of this thread, and the range of the pairs of each.
    tasks: Vec<(Range<usize>, Range<usize>)>,
    stack: Vec<Pair>,
}

/// The output of one thread.
pub(super) struct Output<'a> {
    part: ThreadPairs,
    /// Number of pairs; the vector is longer.
    count: usize,
    pub(super) tests: u64,
    map: &'a MapPairs<'a>,
    converted: usize,
    budget: &'a Budget,
    reported: usize,
    pulse: Pulse,
    /// The reason to stop, if any.
    over: Option<Over>,
}

/// Why a task ends early.
enum Over {
    /// There are more pairs than allowed.
    TooMany,
    Failed(Error),
}

impl<'a> Output<'a> {
    /// An output that uses the memory of `part`.
    fn new(budget: &'a Budget, map: &'a MapPairs<'a>, mut part: ThreadPairs) -> Self {
        part.tasks.clear();
        Self {
            part,
            count: 0,
            tests: 0,
            map,
            converted: 0,
            budget,
            reported: 0,
            pulse: Pulse::of(&budget.stop),
            over: None,
        }
    }

    /// Memory for the stack of a task; empty between tasks.
    pub(super) fn stack(&mut self) -> &mut Vec<Pair> {
        &mut self.part.stack
    }

    /// Memory for `more` pairs and a spare block of [`LANES`]; None if the allocation fails.
    #[inline(always)]
    pub(super) fn spare(&mut self, more: usize) -> Option<&mut [Pair]> {
        // Kernels write whole blocks and accept only the pairs at their beginning. So there has to
        // be space for a block that is written and not accepted.
        let end = self.count + more + LANES;
        if end > self.part.pairs.len() && !self.grow(end) {
            return None;
        }
        Some(&mut self.part.pairs[self.count..])
    }

    /// Appends the first `count` pairs in [`spare`](Self::spare); converts new pairs if there are
    /// enough.
    #[inline(always)]
    pub(super) fn accept(&mut self, count: usize) {
        self.count += count;
        // The minimum makes a limit below a portion stop the search as early as a large one.
        if self.count - self.converted >= CONVERTED.min(self.budget.max_pairs) {
            self.convert();
        }
    }

    /// Converts the new pairs, and adds them to the common count if there are many.
    #[cold]
    fn convert(&mut self) {
        let kept = (self.map)(&mut self.part.pairs[self.converted..self.count]);
        self.count = self.converted + kept;
        self.converted = self.count;
        // A common counter that each task increments for each block would be in the cache of
        // another core most of the time. With portions it is touched once for 65,536 pairs.
        if self.converted - self.reported >= REPORTED.min(self.budget.max_pairs) {
            self.report();
        }
    }

    /// Reserves memory for at least `end` pairs; returns whether the allocation succeeded.
    #[cold]
    fn grow(&mut self, end: usize) -> bool {
        let pairs = &mut self.part.pairs;
        // The length grows to the capacity at once: kernels write to slices that must exist, and to
        // lengthen the vector for each block would cost a call for each.
        let len = end.max(pairs.capacity()).max(2 * pairs.len()).max(CONVERTED);
        let grown = memory::resize(pairs, len, [0; 2]);
        grown.map_err(|error| self.fail(error.in_all(self.bytes_of_all()))).is_ok()
    }

    /// Bytes of the pairs of all tasks so far, with twice the pairs of this thread.
    fn bytes_of_all(&self) -> usize {
        let new = 2 * self.count - self.reported;
        (self.budget.count.load(Ordering::Relaxed) + new) * size_of::<Pair>()
    }

    fn report(&mut self) {
        let new = self.converted - self.reported;
        let before = self.budget.count.fetch_add(new, Ordering::Relaxed);
        self.reported = self.converted;
        // Noticed by whichever thread reports last. The others find out at their own next report:
        // at most 65,536 pairs each beyond the limit are in memory.
        if before + new > self.budget.max_pairs {
            self.over = Some(Over::TooMany);
        }
    }

    #[cold]
    pub(super) fn fail(&mut self, error: Error) {
        self.budget.failed.store(true, Ordering::Relaxed);
        self.over = Some(Over::Failed(error));
    }

    /// Whether to stop; `work` is the approximate number of values read since the last call.
    #[inline(always)]
    pub(super) fn is_over(&mut self, work: usize) -> bool {
        if self.pulse.stops(work) && self.over.is_none() {
            self.fail(Error::Interrupted);
        }
        self.over.is_some()
    }

    /// Records that the new pairs are those of a task that has ended.
    fn end_task(&mut self, task: usize) {
        self.convert();
        let end = self.count;
        match self.part.tasks.last_mut() {
            // Adjacent tasks become one piece, so the list of pieces stays short.
            Some((tasks, range)) if tasks.end == task => (tasks.end, range.end) = (task + 1, end),
            last => {
                let start = last.map_or(0, |(_, range)| range.end);
                self.part.tasks.push((task..task + 1, start..end));
            }
        }
    }

    /// The pairs, or the error of this thread.
    fn into_part(mut self) -> Result<ThreadPairs> {
        self.part.pairs.truncate(self.count);
        match self.over {
            Some(Over::Failed(error)) => Err(error),
            _ => Ok(self.part),
        }
    }
}
