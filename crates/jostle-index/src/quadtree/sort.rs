//! Sorting of shapes by the Morton keys of their centres: a parallel radix sort, most significant
//! bits first.
//!
//! The shapes are partitioned into blocks by the leading bits of the keys. Each block, which fits
//! into the second-level cache, is then gathered from all chunks and sorted by the following bits.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use super::partition::{Item, KEY_BITS, Partition, Source, leading};
use jostle_base::error::Result;
use jostle_base::interrupt::{Pulse, Stop};
use jostle_base::memory;
use jostle_base::parallel::{self, locked};
use jostle_base::sorting::counting_sort;

/// Up to this number of shapes a comparison sort is faster.
const SMALL: usize = 256;

/// Approximate number of shapes in a block.
const BLOCK: usize = 1 << 12;

/// Maximum number of leading bits that define a block.
const MAX_BLOCK_BITS: u32 = 10;

/// Minimum number of leading bits that define a block: enough blocks for several threads.
const MIN_BLOCK_BITS: u32 = 4;

/// Blocks of more shapes than this are sorted in several passes.
const LARGE_BLOCK: usize = 1 << 15;

/// Maximum number of tasks for the blocks.
const MAX_TASKS: usize = 64;

/// How far to sort.
#[derive(Clone, Copy, Debug)]
pub(super) enum Precision {
    /// By key, then by row.
    Full,
    /// Groups of at most `max` items that share leading bits may be in the order of their rows.
    Groups {
        /// Maximum number of items in an unsorted group.
        max: usize,
        /// Approximate fraction of the values of the leading bits that occur.
        occupied: f64,
    },
}

/// Maximum mean size of a group, as a fraction of the largest size that is allowed.
const MEAN_GROUP: f64 = 0.8;

impl Precision {
    /// Number of leading bits that define a group.
    fn bits(self, len: usize) -> u32 {
        match self {
            Self::Full => KEY_BITS,
            Self::Groups { max, occupied } => {
                // With evenly spread shapes the groups vary around their mean. Groups above `max`
                // are sorted in full. A larger mean makes more of these, a smaller one makes more
                // groups than the tree has leaves. That a leaf is sorted no further takes the tree
                // from 16 to 8.5 ns a shape (docs/benchmarks-notes.md).
                let groups = len as f64 / (MEAN_GROUP * max as f64 * occupied);
                // Two bits for each subdivision.
                let suffices = |bits: &u32| f64::from(1 << bits) >= groups;
                (0..KEY_BITS - 2).step_by(2).find(suffices).unwrap_or(KEY_BITS)
            }
        }
    }

    /// Whether a group of `len` items may be in the order of their rows.
    fn accepts(self, len: usize) -> bool {
        match self {
            Self::Full => len < 2,
            Self::Groups { max, .. } => len <= max,
        }
    }
}

/// The first index of each block or group, whose items share leading bits.
#[derive(Clone, Debug, Default)]
pub(super) struct BlockStarts {
    bits: u32,
    /// One more than the number of blocks or groups.
    starts: Vec<u32>,
}

impl BlockStarts {
    /// Index of the first of the sorted `items` whose key is at least `bound`.
    pub(super) fn first_at_least<T>(&self, items: &[Item<T>], bound: u32) -> usize {
        let known = match self.bits {
            0 => 0..items.len(),
            bits => {
                // All keys of the parts before this one are below `bound`, those of later parts
                // above. So at most one part is searched, and none if the bound is where a part
                // begins.
                //
                // A part whose items are not sorted is never searched: it fits into a leaf, and
                // only the ends of quarters of larger nodes are asked for, which are ends of parts
                // then.
                let part = (bound >> (KEY_BITS - bits)) as usize;
                if bound << bits == 0 {
                    return self.starts[part] as usize;
                }
                self.starts[part] as usize..self.starts[part + 1] as usize
            }
        };
        known.start + items[known].partition_point(|item| item.key < bound)
    }

    /// Removes all blocks.
    pub(super) fn clear(&mut self) {
        self.bits = 0;
        self.starts.clear();
    }
}

/// Scratch for sorting.
#[derive(Debug, Default)]
pub(super) struct Sorter<T> {
    partition: Partition<T>,
    /// The first index of each block in the sorted items.
    starts: Vec<u32>,
    scratch: Mutex<Vec<Scratch<T>>>,
}

/// Some adjacent blocks and their ranges of the sorted items.
struct Task<'a, T> {
    blocks: Range<usize>,
    items: &'a mut [Item<T>],
    /// The ends of the parts of the blocks, an output.
    ends: &'a mut [u32],
    /// Index of the first of the items among all.
    start: usize,
}

impl<T> Clone for Sorter<T> {
    /// A sorter without scratch: it has no other state.
    fn clone(&self) -> Self {
        Self { partition: Partition::default(), starts: Vec::new(), scratch: Mutex::default() }
    }
}

impl<T: Copy + Default + Send + Sync> Sorter<T> {
    /// Allocated bytes, used or not.
    pub(super) fn memory_bytes(&self) -> usize {
        let scratch: usize = locked(&self.scratch).iter().map(Scratch::memory_bytes).sum();
        scratch + self.partition.memory_bytes() + self.starts.capacity() * size_of::<u32>()
    }

    /// Fills `items` from `source`, sorts them to the given precision, and lists the ranges of
    /// sorted items that share a key in `equal`.
    pub(super) fn sort(
        &mut self,
        threads: Option<usize>,
        precision: Precision,
        source: &impl Source<T>,
        items: &mut Vec<Item<T>>,
        parts: &mut BlockStarts,
        equal: &mut Vec<Range<usize>>,
    ) -> Result<()> {
        parts.clear();
        equal.clear();
        let len = source.len();
        memory::resize(items, len, Item::default())?;
        // No partition: its counters and blocks cost the same for two shapes as for a thousand. A
        // space builds trees of a few shapes in each update. `benchmarks/small.py` measures such
        // calls.
        if len <= SMALL {
            memory::resize(&mut self.partition.keys, len, 0)?;
            let keys = &mut self.partition.keys[..len];
            source.keys(0..len, keys);
            for (index, (item, &key)) in items.iter_mut().zip(&*keys).enumerate() {
                *item = source.item(index, key);
            }
            if precision.accepts(len) {
                return Ok(());
            }
            items.sort_unstable_by_key(Item::rank);
            return equal_keys(items, 0, equal);
        }
        // Blocks of about 4,096 items, so that a block with its counters fits into the second-level
        // cache. With half of that a tree of a million shapes takes 21.9 instead of 17.4 ns a
        // shape.
        let bits = (len / BLOCK).next_power_of_two().trailing_zeros();
        // At most 1,024 blocks: the partition writes to as many places in turn, and the processor
        // keeps only a limited number of lines and pages at hand. At least 16, so that several
        // threads have work.
        let bits = bits.clamp(MIN_BLOCK_BITS, MAX_BLOCK_BITS);
        self.partition.fill(threads, source, bits)?;
        self.sort_blocks(threads, precision, items, bits, parts, equal)
    }

    /// Gathers every block from all chunks and sorts it.
    fn sort_blocks(
        &mut self,
        threads: Option<usize>,
        precision: Precision,
        items: &mut [Item<T>],
        bits: u32,
        parts: &mut BlockStarts,
        equal: &mut Vec<Range<usize>>,
    ) -> Result<()> {
        let stop = Stop::current();
        let len = items.len();
        let Self { partition, starts, scratch: spare } = self;
        partition.find_starts(starts)?;
        let source = Blocks(partition);
        // Two bits for each subdivision; blocks may have an odd number of bits.
        // At least the bits of a block: blocks are gathered one by one, so no group has items of
        // two.
        let group_bits = precision.bits(len).max(bits + bits % 2);
        // The starts of groups are listed, because they are found by the way. The builder then
        // needs no binary search for the ends of its upper nodes: 8.8 → 5.9 ns on two threads. A
        // full sort has no groups.
        parts.bits = if group_bits < KEY_BITS { group_bits } else { bits };
        memory::resize(&mut parts.starts, (1 << parts.bits) + 1, 0)?;
        let how = BlockSort { bits, group_bits, listed: parts.bits - bits, precision };
        let tasks = source.tasks(items, starts, &mut parts.starts[1..]);
        let failed = Mutex::new(Ok(()));
        let make = || locked(spare).pop().unwrap_or_default();
        let sort = |task, scratch: &mut Scratch<T>| {
            if let Err(error) = source.sort(task, how, &stop, scratch) {
                // Any of the errors will do: each is a failed allocation or the interruption.
                *locked(&failed) = Err(error);
            }
        };
        let mut result = Ok(());
        parallel::for_each_with(threads, tasks, make, sort, |mut scratch| {
            // The lists of all threads are joined here, on the caller, one after the other.
            match memory::reserve(equal, scratch.equal.len()) {
                Ok(()) => equal.append(&mut scratch.equal),
                Err(error) => result = Err(error),
            }
            locked(spare).push(scratch);
        });
        stop.check()?;
        failed.into_inner().unwrap_or_else(PoisonError::into_inner).and(result)?;
        // The order of the threads is not defined.
        equal.sort_unstable_by_key(|range| range.start);
        Ok(())
    }
}

/// How to sort a block.
#[derive(Clone, Copy)]
struct BlockSort {
    /// Leading bits that define a block.
    bits: u32,
    /// Leading bits that define a group, at least `bits`.
    group_bits: u32,
    /// Bits after `bits` that define the listed parts of a block.
    listed: u32,
    precision: Precision,
}

/// The blocks to be sorted.
struct Blocks<'a, T>(&'a Partition<T>);

impl<T: Copy + Default> Blocks<'_, T> {
    /// Gathers and sorts the blocks of a task; lists the ranges that share a key in `scratch`.
    fn sort(
        &self,
        task: Task<'_, T>,
        how: BlockSort,
        stop: &Stop,
        scratch: &mut Scratch<T>,
    ) -> Result<()> {
        let mut from = 0;
        let mut pulse = Pulse::of(stop);
        let mut ends = task.ends.chunks_mut(1 << how.listed);
        for block in task.blocks {
            let len = self.0.pieces(block).map(<[Item<T>]>::len).sum::<usize>();
            pulse.check(len)?;
            let sorted = &mut task.items[from..from + len];
            let start = task.start + from;
            self.sort_block(block, sorted, start, how, scratch)?;
            let ends = ends.next().expect("ends for each block");
            ends.fill(0);
            // Counted again, not taken from the counters of the sort: these may have fewer bits
            // than are listed, or there are none if the block was large.
            sorted.iter().for_each(|item| ends[leading(item.key, how.bits, how.listed)] += 1);
            let mut end = start as u32;
            for sum in ends {
                end += *sum;
                *sum = end;
            }
            from += len;
        }
        Ok(())
    }

    fn sort_block(
        &self,
        block: usize,
        sorted: &mut [Item<T>],
        start: usize,
        how: BlockSort,
        scratch: &mut Scratch<T>,
    ) -> Result<()> {
        let BlockSort { bits, group_bits, precision, .. } = how;
        // Most of the shapes are in a small part of the plane. One pass by counting would leave
        // groups of thousands to the comparison sort; passes over all bits take a time that is
        // proportional to the number.
        if sorted.len() > LARGE_BLOCK {
            scratch.collected.clear();
            memory::reserve(&mut scratch.collected, sorted.len())?;
            self.0.pieces(block).for_each(|piece| scratch.collected.extend_from_slice(piece));
            radix_sort(&mut scratch.collected, &mut scratch.spare)?;
            sorted.copy_from_slice(&scratch.collected);
            return equal_keys(sorted, start, &mut scratch.equal);
        }
        // At most four counters for each item: a sparse block would spend its time on clearing
        // empty counters.
        let max_bits = (2 * sorted.len()).next_power_of_two().trailing_zeros();
        let next = (group_bits - bits).min(max_bits);
        // The counters do not reach the bits of a group. Then what they separate are several
        // groups, which need to be in their order among each other.
        let precision = if bits + next < group_bits { Precision::Full } else { precision };
        let ends = &mut scratch.counts;
        memory::resize(ends, 1 << next, 0)?;
        let items = self.0.pieces(block).flatten();
        // Stable, and the pieces come in the order of the source. So items of one group stay in
        // ascending order of their rows, which is the order that `Precision` promises.
        counting_sort(items, |item| leading(item.key, bits, next), |item| *item, ends, sorted);
        let mut from = 0;
        for &end in &*ends {
            let end = end as usize;
            if !precision.accepts(end - from) {
                let group = &mut sorted[from..end];
                // By far the most frequent length; the call of the library's sort costs more than
                // the comparison.
                if let [a, b] = group {
                    if a.rank() > b.rank() {
                        std::mem::swap(a, b);
                    }
                } else {
                    group.sort_unstable_by_key(Item::rank);
                }
                equal_keys(group, start + from, &mut scratch.equal)?;
            }
            from = end;
        }
        Ok(())
    }

    /// All blocks, divided into tasks of about equal size, and the `ends` divided in the same way.
    fn tasks<'a>(
        &self,
        mut items: &'a mut [Item<T>],
        starts: &'a [u32],
        mut ends: &'a mut [u32],
    ) -> impl Iterator<Item = Task<'a, T>> + use<'a, T> {
        const EXPECT: &str = "the sizes add up";
        let (min_size, blocks) = (items.len().div_ceil(MAX_TASKS), self.0.blocks());
        let listed = ends.len() / blocks;
        let (mut first, mut start) = (0, 0);
        (1..=blocks).filter_map(move |end| {
            let size = starts[end] as usize - start;
            // Blocks are joined until a task is large enough. Borders depend on the sizes of blocks
            // only, so tasks are the same on each number of threads. The last task may be small.
            if size < min_size && end < blocks {
                return None;
            }
            let items = items.split_off_mut(..size).expect(EXPECT);
            let ends = ends.split_off_mut(..(end - first) * listed).expect(EXPECT);
            let task = Task { blocks: first..end, items, ends, start };
            (first, start) = (end, start + size);
            Some(task)
        })
    }
}

/// Scratch for sorting one block.
#[derive(Debug, Default)]
struct Scratch<T> {
    collected: Vec<Item<T>>,
    spare: Vec<Item<T>>,
    counts: Vec<u32>,
    equal: Vec<Range<usize>>,
}

impl<T> Scratch<T> {
    fn memory_bytes(&self) -> usize {
        (self.collected.capacity() + self.spare.capacity()) * size_of::<Item<T>>()
            + self.counts.capacity() * size_of::<u32>()
            + self.equal.capacity() * size_of::<Range<usize>>()
    }
}

/// Sorts by key in three passes of 11 bits, least significant first, for blocks in which many items
/// share leading bits. The rows must be ascending.
fn radix_sort<T: Copy + Default>(items: &mut Vec<Item<T>>, spare: &mut Vec<Item<T>>) -> Result<()> {
    const BITS: u32 = 11;
    spare.clear();
    memory::resize(spare, items.len(), Item::default())?;
    // Three passes of 11 bits cover the 32 of a key; two of 16 would need counters that exceed the
    // first-level cache. Each pass is stable, so equal keys stay in ascending order of their rows.
    for pass in 0..3 {
        let digit = |item: &Item<T>| (item.key >> (pass * BITS)) as usize & ((1 << BITS) - 1);
        let mut ends = [0; 1 << BITS];
        counting_sort(items.iter(), |item| digit(item), |item| *item, &mut ends, spare);
        std::mem::swap(items, spare);
    }
    Ok(())
}

/// Appends the ranges of sorted items that share a key; `start` is the index of the first item.
fn equal_keys<T>(items: &[Item<T>], start: usize, equal: &mut Vec<Range<usize>>) -> Result<()> {
    for (index, pair) in items.windows(2).enumerate() {
        if pair[0].key == pair[1].key {
            let at = start + index;
            match equal.last_mut() {
                // The run before this pair ends with its first item, so the pair lengthens it.
                Some(last) if last.end == at + 1 => last.end += 1,
                _ => memory::push(equal, at..at + 2)?,
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::partition::MIN_CHUNK;
    use super::*;

    /// Keys of many kinds: uniform, few different ones, small ones, all equal.
    fn key(kind: u32, row: u32) -> u32 {
        let mixed = row.wrapping_mul(0x9e37_79b9).rotate_left(7).wrapping_mul(0x85eb_ca6b);
        match kind {
            0 => mixed,
            1 => mixed % 5,
            2 => mixed >> 20,
            3 => mixed & 0xfff0_0000,
            _ => 7,
        }
    }

    #[test]
    fn every_size_and_kind_of_keys_is_sorted_by_key_then_row() {
        for len in [0, 1, 2, SMALL, SMALL + 1, MIN_CHUNK - 1, MIN_CHUNK + 1, 9 * MIN_CHUNK + 3] {
            for kind in 0..5 {
                for threads in [1, 2] {
                    check(len as u32, kind, threads);
                }
            }
        }
    }

    /// Items with keys of one kind; the centre is the row.
    struct Rows {
        len: usize,
        kind: u32,
    }

    impl Source<f64> for Rows {
        fn len(&self) -> usize {
            self.len
        }
        fn keys(&self, range: Range<usize>, keys: &mut [u32]) {
            for (row, to) in range.zip(keys) {
                *to = key(self.kind, row as u32);
            }
        }
        fn item(&self, index: usize, key: u32) -> Item<f64> {
            Item { key, row: index as u32, center: [index as f64; 2], sizes: [] }
        }
    }

    fn check(len: u32, kind: u32, threads: usize) {
        let mut expected: Vec<u64> =
            (0..len).map(|row| u64::from(key(kind, row)) << 32 | u64::from(row)).collect();
        expected.sort_unstable();
        let (mut sorter, mut parts) = (Sorter::default(), BlockStarts::default());
        let (mut items, mut equal) = (Vec::new(), Vec::new());
        let source = Rows { len: len as usize, kind };
        let threads = Some(threads);
        sorter.sort(threads, Precision::Full, &source, &mut items, &mut parts, &mut equal).unwrap();
        assert!(items.iter().map(Item::rank).eq(expected));
        assert!(items.iter().all(|item| item.center[0] == f64::from(item.row)));
        let mut together = vec![false; items.len()];
        equal.iter().for_each(|range| together[range.start + 1..range.end].fill(true));
        for at in 1..items.len() {
            let same = items[at].key == items[at - 1].key;
            assert_eq!(together[at], same, "{len} {kind} {at}");
        }
        for bound in [0, 1, 3, 7, 8, 1 << 11, 1 << 20, 1 << 31, u32::MAX] {
            let first = items.partition_point(|item| item.key < bound);
            assert_eq!(parts.first_at_least(&items, bound), first, "{len} {kind} {bound}");
        }
        let precision = Precision::Groups { max: 50, occupied: 0.7 };
        sorter.sort(threads, precision, &source, &mut items, &mut parts, &mut equal).unwrap();
        check_groups(&items, &parts, precision.bits(items.len()));
    }

    /// Groups are in order; those of more than 50 are sorted, and the others by row.
    fn check_groups(items: &[Item<f64>], parts: &BlockStarts, bits: u32) {
        let group = |item: &Item<f64>| leading(item.key, 0, bits);
        for group in items.chunk_by(|a, b| group(a) == group(b)) {
            let by_row = group.is_sorted_by_key(|item| item.row);
            assert!(group.is_sorted_by_key(Item::rank) || by_row && group.len() <= 50);
        }
        assert!(items.is_sorted_by_key(group));
        for index in (0..items.len()).step_by(7) {
            let bound = items[index].key >> (KEY_BITS - bits.max(1)) << (KEY_BITS - bits.max(1));
            let first = items.partition_point(|item| item.key < bound);
            assert_eq!(parts.first_at_least(items, bound), first);
        }
    }
}
