//! Sorting rows by their keys.
//!
//! First every chunk of the rows is parted by the leading bits of the keys, which
//! stays inside the processor's caches; then each part is collected from all chunks
//! and sorted by the bits that follow. Chunks and parts are worked on by all threads.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use crate::error::Result;
use crate::interrupt::{Pulse, Stop};
use crate::memory;
use crate::parallel::{self, locked};

/// Below this many keys a comparison sort is faster.
const SMALL: usize = 1024;

/// Rows of a chunk: what is parted at once fits into a second-level cache.
const CHUNK: usize = 1 << 15;

/// Rows of a part, about; what is sorted at once fits into a first-level cache.
const PART: usize = 512;

/// Leading bits that parts differ in, at most.
const MOST_BITS: u32 = 12;

/// Bits of a key.
const KEY_BITS: u32 = u32::BITS;

/// Tasks that the parts are divided into.
const TASKS: usize = 64;

/// A key above its row: sorted by key, then by row.
pub type Item = u64;

/// The key of an item.
#[inline(always)]
pub fn key_of(item: Item) -> u32 {
    (item >> 32) as u32
}

/// Where items with certain leading bits begin.
#[derive(Clone, Debug, Default)]
pub struct Parts {
    bits: u32,
    /// One more than there are parts.
    starts: Vec<u32>,
}

impl Parts {
    /// Index of the first of the sorted `items` whose key is at least `bound`.
    pub fn first_at_least(&self, items: &[Item], bound: u32) -> usize {
        let known = match self.bits {
            0 => 0..items.len(),
            bits => {
                let part = (bound >> (KEY_BITS - bits)) as usize;
                self.starts[part] as usize..self.starts[part + 1] as usize
            }
        };
        known.start + items[known].partition_point(|&item| key_of(item) < bound)
    }

    /// Forgets all parts.
    pub fn clear(&mut self) {
        self.bits = 0;
        self.starts.clear();
    }
}

/// Memory for sorting.
#[derive(Debug, Default)]
pub struct Sorter {
    parted: Vec<Item>,
    /// For each chunk the end of each part in it.
    ends: Vec<u32>,
    scratch: Mutex<Vec<Scratch>>,
}

/// Makes the items of a range of rows. It is called for many at a time, so the sorting does
/// not depend on its type and is compiled once.
pub type FillKeys<'a> = dyn Fn(Range<usize>, &mut [Item]) + Sync + 'a;

/// Some adjacent parts and where their rows go.
struct Task<'a> {
    parts: Range<usize>,
    items: &'a mut [Item],
    /// Where they stand among all.
    start: usize,
}

impl Clone for Sorter {
    /// A sorter without memory: it has no other state.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Sorter {
    /// Bytes of memory that it keeps, used or not.
    pub fn kept_bytes(&self) -> usize {
        let of_scratch = |scratch: &Scratch| {
            (scratch.collected.capacity() + scratch.spare.capacity()) * size_of::<Item>()
                + scratch.counts.capacity() * size_of::<u32>()
                + scratch.equal.capacity() * size_of::<Range<usize>>()
        };
        let scratch: usize = locked(&self.scratch).iter().map(of_scratch).sum();
        scratch
            + self.parted.capacity() * size_of::<Item>()
            + self.ends.capacity() * size_of::<u32>()
    }

    /// Fills `items` and sorts them; lists the ranges that share a key in `equal`. `key` makes
    /// the items of a range.
    pub fn sort(
        &mut self,
        threads: Option<usize>,
        items: &mut [Item],
        parts: &mut Parts,
        key: &FillKeys<'_>,
        equal: &mut Vec<Range<usize>>,
    ) -> Result<()> {
        parts.clear();
        equal.clear();
        if items.len() <= SMALL {
            key(0..items.len(), items);
            items.sort_unstable();
            return equal_keys(items, 0, equal);
        }
        let bits = (items.len() / PART).next_power_of_two().trailing_zeros().min(MOST_BITS);
        self.part_chunks(threads, items, key, bits)?;
        self.sort_parts(threads, items, bits, parts, equal)
    }

    /// Makes the items of every chunk and parts them by their leading bits.
    fn part_chunks(
        &mut self,
        threads: Option<usize>,
        items: &mut [Item],
        key: &FillKeys<'_>,
        bits: u32,
    ) -> Result<()> {
        let stop = Stop::current();
        let Self { parted, ends, .. } = self;
        let parts = 1 << bits;
        memory::resize(parted, items.len(), 0)?;
        ends.clear();
        memory::resize(ends, items.len().div_ceil(CHUNK) * parts, 0)?;
        let chunks = items.chunks_mut(CHUNK).zip(parted.chunks_mut(CHUNK));
        let tasks = chunks.zip(ends.chunks_mut(parts)).enumerate();
        parallel::for_each(threads, tasks, |(chunk, ((given, parted), ends))| {
            if stop.is_set() {
                return;
            }
            let start = chunk * CHUNK;
            key(start..start + given.len(), given);
            counting_sort(given, parted, ends, |item| (item >> (Item::BITS - bits)) as usize);
        });
        stop.check()
    }

    /// Collects every part from all chunks and sorts it.
    fn sort_parts(
        &self,
        threads: Option<usize>,
        items: &mut [Item],
        bits: u32,
        parts: &mut Parts,
        equal: &mut Vec<Range<usize>>,
    ) -> Result<()> {
        let stop = Stop::current();
        let source = Parted { items: &self.parted, ends: &self.ends, parts: 1 << bits };
        parts.bits = bits;
        source.find_starts(&mut parts.starts)?;
        let all = Mutex::new((&mut *equal, Ok(())));
        parallel::for_each(threads, source.tasks(items, &parts.starts), |task| {
            let mut scratch = locked(&self.scratch).pop().unwrap_or_default();
            let sorted = source.sort(task, bits, &stop, &mut scratch);
            let (equal, result) = &mut *locked(&all);
            let kept = sorted.and_then(|()| memory::reserve(equal, scratch.equal.len()));
            match kept {
                Ok(()) => equal.append(&mut scratch.equal),
                Err(error) => *result = Err(error),
            }
            locked(&self.scratch).push(scratch);
        });
        stop.check()?;
        all.into_inner().unwrap_or_else(PoisonError::into_inner).1?;
        // Threads end in any order.
        equal.sort_unstable_by_key(|range| range.start);
        Ok(())
    }
}

/// Chunks that are parted.
struct Parted<'a> {
    items: &'a [Item],
    ends: &'a [u32],
    parts: usize,
}

impl Parted<'_> {
    /// Collects and sorts the parts of a task; lists the ranges that share a key in `scratch`.
    fn sort(&self, task: Task<'_>, bits: u32, stop: &Stop, scratch: &mut Scratch) -> Result<()> {
        let mut from = 0;
        let mut pulse = Pulse::of(stop);
        for part in task.parts {
            scratch.collected.clear();
            for piece in self.pieces(part) {
                memory::reserve(&mut scratch.collected, piece.len())?;
                scratch.collected.extend_from_slice(piece);
            }
            let to = from + scratch.collected.len();
            pulse.check(to - from)?;
            scratch.sort_into(&mut task.items[from..to], bits)?;
            from = to;
        }
        scratch.equal.clear();
        equal_keys(task.items, task.start, &mut scratch.equal)
    }

    /// What each chunk has of a part.
    fn pieces(&self, part: usize) -> impl Iterator<Item = &[Item]> {
        let chunks = self.items.chunks(CHUNK).zip(self.ends.chunks(self.parts));
        chunks.map(move |(items, ends)| {
            let start = if part == 0 { 0 } else { ends[part - 1] };
            &items[start as usize..ends[part] as usize]
        })
    }

    /// Where each part begins once all are sorted, and where the last one ends.
    fn find_starts(&self, starts: &mut Vec<u32>) -> Result<()> {
        starts.clear();
        memory::resize(starts, self.parts + 1, 0)?;
        // A chunk's end of a part counts everything before it too.
        for ends in self.ends.chunks(self.parts) {
            for (start, &end) in starts[1..].iter_mut().zip(ends) {
                *start += end;
            }
        }
        Ok(())
    }

    /// All parts, divided into tasks of about equal size.
    fn tasks<'a>(
        &self,
        mut items: &'a mut [Item],
        starts: &'a [u32],
    ) -> impl Iterator<Item = Task<'a>> + use<'a> {
        let enough = items.len().div_ceil(TASKS);
        let (mut first, mut start) = (0, 0);
        (1..=self.parts).filter_map(move |end| {
            let size = starts[end] as usize - start;
            if size < enough && end + 1 < starts.len() {
                return None;
            }
            let items = items.split_off_mut(..size).expect("the sizes add up");
            let task = Task { parts: first..end, items, start };
            (first, start) = (end, start + size);
            Some(task)
        })
    }
}

/// Memory for the sorting of one part after the other.
#[derive(Debug, Default)]
struct Scratch {
    collected: Vec<Item>,
    spare: Vec<Item>,
    counts: Vec<u32>,
    equal: Vec<Range<usize>>,
}

impl Scratch {
    /// Sorts what was collected; all of it agrees in the `known` leading bits.
    fn sort_into(&mut self, sorted: &mut [Item], known: u32) -> Result<()> {
        if sorted.len() > 16 * PART {
            radix_sort(&mut self.collected, &mut self.spare)?;
            sorted.copy_from_slice(&self.collected);
            return Ok(());
        }
        let bits = (2 * sorted.len()).next_power_of_two().trailing_zeros().min(KEY_BITS - known);
        self.counts.clear();
        self.counts.resize(1 << bits, 0);
        let shift = Item::BITS - known - bits;
        let mask = (1 << bits) - 1;
        counting_sort(&self.collected, sorted, &mut self.counts, |item| {
            (item >> shift) as usize & mask
        });
        let mut start = 0;
        for &end in &self.counts {
            let end = end as usize;
            match end - start {
                0 | 1 => {}
                2 => {
                    let (a, b) = (sorted[start], sorted[start + 1]);
                    (sorted[start], sorted[start + 1]) = (a.min(b), a.max(b));
                }
                _ => sorted[start..end].sort_unstable(),
            }
            start = end;
        }
        Ok(())
    }
}

/// Sorts by `digit`, keeping the order of equals. `ends` comes in as zeros, one for each
/// digit, and leaves with the place behind each digit's items.
#[inline(always)]
fn counting_sort(from: &[Item], to: &mut [Item], ends: &mut [u32], digit: impl Fn(Item) -> usize) {
    for &item in from {
        ends[digit(item)] += 1;
    }
    let mut sum = 0;
    for end in ends.iter_mut() {
        sum += std::mem::replace(end, sum);
    }
    for &item in from {
        let place = &mut ends[digit(item)];
        to[*place as usize] = item;
        *place += 1;
    }
}

/// Sorts by key in three passes of 11 bits, for parts in which many share leading bits.
/// The rows must ascend to begin with where ties matter.
fn radix_sort(items: &mut Vec<Item>, spare: &mut Vec<Item>) -> Result<()> {
    const BITS: u32 = 11;
    spare.clear();
    memory::resize(spare, items.len(), 0)?;
    for pass in 0..3 {
        let mut counts = [0; 1 << BITS];
        let digit = |item: Item| (item >> (32 + pass * BITS)) as usize & ((1 << BITS) - 1);
        counting_sort(items, spare, &mut counts, digit);
        std::mem::swap(items, spare);
    }
    Ok(())
}

/// Appends the ranges of sorted items that share a key; the first item stands at `start`.
fn equal_keys(items: &[Item], start: usize, equal: &mut Vec<Range<usize>>) -> Result<()> {
    for (index, pair) in items.windows(2).enumerate() {
        if key_of(pair[0]) == key_of(pair[1]) {
            let at = start + index;
            match equal.last_mut() {
                Some(last) if last.end == at + 1 => last.end += 1,
                _ => memory::push(equal, at..at + 2)?,
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Keys of many kinds: spread out, few, crowded at one end, all the same.
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
        for len in [0, 1, 2, SMALL, SMALL + 1, CHUNK - 1, CHUNK + 1, 5 * CHUNK + 3] {
            for kind in 0..5 {
                for threads in [1, 2] {
                    check(len as u32, kind, threads);
                }
            }
        }
    }

    fn check(len: u32, kind: u32, threads: usize) {
        let item = |row: u32| Item::from(key(kind, row)) << 32 | Item::from(row);
        let mut expected: Vec<Item> = (0..len).map(item).collect();
        expected.sort_unstable();
        let mut items = vec![0; expected.len()];
        let (mut sorter, mut parts) = (Sorter::default(), Parts::default());
        let mut equal = Vec::new();
        let sorted = sorter.sort(
            Some(threads),
            &mut items,
            &mut parts,
            &|range: Range<usize>, items: &mut [Item]| {
                for (row, to) in range.zip(items) {
                    *to = item(row as u32);
                }
            },
            &mut equal,
        );
        sorted.unwrap();
        assert_eq!(items, expected);
        let mut together = vec![false; items.len()];
        equal.iter().for_each(|range| together[range.start + 1..range.end].fill(true));
        for at in 1..items.len() {
            let same = key_of(items[at]) == key_of(items[at - 1]);
            assert_eq!(together[at], same, "{len} {kind} {at}");
        }
        for bound in [0, 1, 3, 7, 8, 1 << 11, 1 << 20, 1 << 31, u32::MAX] {
            let first = items.partition_point(|&item| key_of(item) < bound);
            assert_eq!(parts.first_at_least(&items, bound), first, "{len} {kind} {bound}");
        }
    }
}
