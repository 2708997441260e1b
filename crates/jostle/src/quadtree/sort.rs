//! Sorting rows by their keys.
//!
//! First every chunk of the rows is parted by the leading bits of the keys, which
//! stays inside the processor's caches; then each part is collected from all chunks
//! and sorted by the bits that follow. Chunks and parts are worked on by all threads.

use std::ops::Range;

use crate::parallel;

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
type Item = u64;

/// Memory for sorting.
#[derive(Clone, Debug, Default)]
pub struct Sorter {
    items: Vec<Item>,
    spare: Vec<Item>,
    /// For each chunk the end of each part in it.
    ends: Vec<u32>,
}

/// Some adjacent parts and where their rows go.
struct Task<'a> {
    parts: Range<usize>,
    items: &'a mut [Item],
    rows: &'a mut [u32],
    keys: &'a mut [u32],
    /// Place of the first row.
    start: usize,
    equal: Vec<Range<usize>>,
}

impl Sorter {
    /// Sorts `rows` by `key`, then by row; fills `keys` and returns the ranges that
    /// share a key.
    pub fn sort(
        &mut self,
        threads: Option<usize>,
        rows: &mut [u32],
        keys: &mut [u32],
        key: impl Fn(&[u32], &mut [Item]) + Sync + Send,
    ) -> Vec<Range<usize>> {
        self.items.resize(rows.len(), 0);
        if rows.len() <= SMALL {
            key(rows, &mut self.items);
            self.items.sort_unstable();
            return write(&self.items, rows, keys, 0);
        }
        self.spare.resize(rows.len(), 0);
        let bits = (rows.len() / PART).next_power_of_two().trailing_zeros().min(MOST_BITS);
        self.part_chunks(threads, rows, key, bits);
        self.sort_parts(threads, rows, keys, bits)
    }

    /// Fills `items` with every chunk's rows, parted by their leading bits.
    fn part_chunks(
        &mut self,
        threads: Option<usize>,
        rows: &[u32],
        key: impl Fn(&[u32], &mut [Item]) + Sync + Send,
        bits: u32,
    ) {
        let Self { items, spare, ends } = self;
        let parts = 1 << bits;
        ends.clear();
        ends.resize(rows.len().div_ceil(CHUNK) * parts, 0);
        let chunks = rows.chunks(CHUNK).zip(spare.chunks_mut(CHUNK)).zip(items.chunks_mut(CHUNK));
        let mut tasks: Vec<_> = chunks.zip(ends.chunks_mut(parts)).collect();
        parallel::for_each(threads, &mut tasks, |(((rows, given), parted), ends)| {
            key(rows, given);
            let part = |item: Item| (item >> (Item::BITS - bits)) as usize;
            counting_sort(given, parted, ends, part);
        });
    }

    /// Collects every part from all chunks and sorts it.
    fn sort_parts(
        &mut self,
        threads: Option<usize>,
        rows: &mut [u32],
        keys: &mut [u32],
        bits: u32,
    ) -> Vec<Range<usize>> {
        let Self { items, spare, ends } = self;
        let source = Parted { items, ends, parts: 1 << bits };
        let mut tasks = source.tasks(spare, rows, keys);
        parallel::for_each(threads, &mut tasks, |task| {
            let mut scratch = Scratch::default();
            let mut from = 0;
            for part in task.parts.clone() {
                scratch.collected.clear();
                source.pieces(part).for_each(|piece| scratch.collected.extend_from_slice(piece));
                let to = from + scratch.collected.len();
                scratch.sort_into(&mut task.items[from..to], bits);
                from = to;
            }
            task.equal = write(task.items, task.rows, task.keys, task.start);
        });
        tasks.into_iter().flat_map(|task| task.equal).collect()
    }
}

/// Chunks that are parted.
struct Parted<'a> {
    items: &'a [Item],
    ends: &'a [u32],
    parts: usize,
}

impl Parted<'_> {
    /// What each chunk has of a part.
    fn pieces(&self, part: usize) -> impl Iterator<Item = &[Item]> {
        let chunks = self.items.chunks(CHUNK).zip(self.ends.chunks(self.parts));
        chunks.map(move |(items, ends)| {
            let start = if part == 0 { 0 } else { ends[part - 1] };
            &items[start as usize..ends[part] as usize]
        })
    }

    /// All parts, divided into tasks of about equal size.
    fn tasks<'a>(
        &self,
        mut items: &'a mut [Item],
        mut rows: &'a mut [u32],
        mut keys: &'a mut [u32],
    ) -> Vec<Task<'a>> {
        let enough = items.len().div_ceil(TASKS);
        let mut sizes = vec![0; self.parts];
        for ends in self.ends.chunks(self.parts) {
            let mut start = 0;
            for (size, &end) in sizes.iter_mut().zip(ends) {
                *size += (end - start) as usize;
                start = end;
            }
        }
        let mut tasks = Vec::with_capacity(TASKS);
        let (mut first, mut size, mut start) = (0, 0, 0);
        for (part, &more) in sizes.iter().enumerate() {
            size += more;
            if size < enough && part + 1 < self.parts {
                continue;
            }
            tasks.push(Task {
                parts: first..part + 1,
                items: items.split_off_mut(..size).expect("the sizes add up"),
                rows: rows.split_off_mut(..size).expect("the sizes add up"),
                keys: keys.split_off_mut(..size).expect("the sizes add up"),
                start,
                equal: Vec::new(),
            });
            (first, start, size) = (part + 1, start + size, 0);
        }
        tasks
    }
}

/// Memory for the sorting of one part after the other.
#[derive(Default)]
struct Scratch {
    collected: Vec<Item>,
    spare: Vec<Item>,
    counts: Vec<u32>,
}

impl Scratch {
    /// Sorts what was collected; all of it agrees in the `known` leading bits.
    fn sort_into(&mut self, sorted: &mut [Item], known: u32) {
        if sorted.len() > 16 * PART {
            radix_sort(&mut self.collected, &mut self.spare);
            return sorted.copy_from_slice(&self.collected);
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
    }
}

/// Sorts by `digit`, keeping the order of equals. `ends` comes in as zeros, one for each
/// digit, and leaves with the place behind each digit's items.
#[inline(always)]
fn counting_sort(
    from: &[Item],
    to: &mut [Item],
    ends: &mut [u32],
    digit: impl Fn(Item) -> usize,
) {
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
fn radix_sort(items: &mut Vec<Item>, spare: &mut Vec<Item>) {
    const BITS: u32 = 11;
    spare.clear();
    spare.resize(items.len(), 0);
    for pass in 0..3 {
        let mut counts = [0; 1 << BITS];
        let digit = |item: Item| (item >> (32 + pass * BITS)) as usize & ((1 << BITS) - 1);
        counting_sort(items, spare, &mut counts, digit);
        std::mem::swap(items, spare);
    }
}

/// Takes sorted items apart and returns the ranges of places that share a key; the first
/// item's place is `start`.
fn write(items: &[Item], rows: &mut [u32], keys: &mut [u32], start: usize) -> Vec<Range<usize>> {
    for ((&item, row), key) in items.iter().zip(rows).zip(keys.iter_mut()) {
        (*row, *key) = (item as u32, (item >> 32) as u32);
    }
    let mut equal: Vec<Range<usize>> = Vec::new();
    for (index, pair) in keys.windows(2).enumerate() {
        if pair[0] == pair[1] {
            let at = start + index;
            match equal.last_mut() {
                Some(last) if last.end == at + 1 => last.end += 1,
                _ => equal.push(at..at + 2),
            }
        }
    }
    equal
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
        let mut expected: Vec<(u32, u32)> = (0..len).map(|row| (key(kind, row), row)).collect();
        expected.sort_unstable();
        let mut rows: Vec<u32> = (0..len).collect();
        let mut keys = vec![0; rows.len()];
        let items = |rows: &[u32], items: &mut [Item]| {
            for (&row, item) in rows.iter().zip(items) {
                *item = u64::from(key(kind, row)) << 32 | u64::from(row);
            }
        };
        let equal = Sorter::default().sort(Some(threads), &mut rows, &mut keys, items);
        let sorted: Vec<(u32, u32)> = keys.iter().copied().zip(rows).collect();
        assert_eq!(sorted, expected);
        for at in 1..keys.len() {
            let together = equal.iter().any(|range| range.contains(&at) && range.contains(&(at - 1)));
            assert_eq!(together, keys[at] == keys[at - 1], "{len} {kind} {at}");
            if at > 100 && kind == 1 {
                break;
            }
        }
    }
}
