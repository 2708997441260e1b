//! Sorting that can be interrupted.
//!
//! [`sort`] is an in-place radix sort, most significant byte first (American flag sort: P. M.
//! McIlroy, K. Bostic and M. D. McIlroy, *Engineering Radix Sort*, Computing Systems 6, 1993);
//! short lists are sorted by comparison. [`counting_sort`] sorts by small integer keys.

use std::ops::AddAssign;

use crate::error::Result;
use crate::interrupt::Pulse;
use crate::memory;

/// Lists of at most this length are sorted by comparison, which takes a few milliseconds.
const SHORT: usize = 1 << 16;

/// Items whose order is that of their bytes.
pub trait Bytes: Copy + Ord {
    /// Number of bytes.
    const COUNT: usize;
    /// Byte `at`; byte 0 is the most significant.
    fn byte(&self, at: usize) -> u8;
}

impl Bytes for u32 {
    const COUNT: usize = 4;

    #[inline(always)]
    fn byte(&self, at: usize) -> u8 {
        (self >> (24 - 8 * at)) as u8
    }
}

impl Bytes for i64 {
    const COUNT: usize = 8;

    #[inline(always)]
    fn byte(&self, at: usize) -> u8 {
        // With the sign bit flipped, negative numbers come first.
        ((self ^ i64::MIN) >> (56 - 8 * at)) as u8
    }
}

impl<V: Bytes> Bytes for [V; 2] {
    const COUNT: usize = 2 * V::COUNT;

    #[inline(always)]
    fn byte(&self, at: usize) -> u8 {
        self[at / V::COUNT].byte(at % V::COUNT)
    }
}

/// Sorts `items`. After an interruption their order is unspecified.
pub fn sort<V: Bytes>(items: &mut [V], pulse: &mut Pulse) -> Result<()> {
    if items.len() <= SHORT {
        pulse.check(items.len())?;
        items.sort_unstable();
        return Ok(());
    }
    // A list of open parts instead of recursion, each level of which would keep the 256 ends of its
    // parts on the stack.
    let mut open = memory::with_capacity(1)?;
    open.push((items, 0));
    while let Some((items, at)) = open.pop() {
        // A long part polls in `partition`; a short one is sorted by one call of the library, which
        // cannot be interrupted. `SHORT` limits that call to a few milliseconds.
        pulse.check(items.len().min(SHORT))?;
        if items.len() <= SHORT {
            items.sort_unstable();
        // Items that agree in all bytes are equal, because the order of the type is that of its
        // bytes. So a part that is left after the last byte is sorted.
        } else if at < V::COUNT {
            let ends = partition(items, at, pulse)?;
            let (mut rest, mut start) = (items, 0);
            for end in ends {
                let (first, tail) = rest.split_at_mut(end - start);
                (rest, start) = (tail, end);
                if first.len() > 1 {
                    memory::push(&mut open, (first, at + 1))?;
                }
            }
        }
    }
    Ok(())
}

/// Partitions items by one byte, in place; returns the end of the items of each byte value.
fn partition<V: Bytes>(items: &mut [V], at: usize, pulse: &mut Pulse) -> Result<[usize; 256]> {
    let mut counts = [0; 256];
    for chunk in items.chunks(SHORT) {
        pulse.check(chunk.len())?;
        chunk.iter().for_each(|item| counts[usize::from(item.byte(at))] += 1);
    }
    let (mut nexts, mut ends, mut sum) = ([0; 256], [0; 256], 0);
    for value in 0..256 {
        nexts[value] = sum;
        sum += counts[value];
        ends[value] = sum;
    }
    // All items have the same byte, as the high bytes of small numbers do. The loop below would
    // visit every item and move none.
    if counts.contains(&items.len()) {
        return Ok(ends);
    }
    for value in 0..256 {
        // Invariant: the items from the start of each part to its `nexts` have the byte of the
        // part. Every iteration puts one more item into its part, so there are as many iterations
        // as items. The swap brings an item of unknown byte to `index`, which is examined next.
        while nexts[value] < ends[value] {
            pulse.check(4)?;
            let index = nexts[value];
            let target = usize::from(items[index].byte(at));
            if target != value {
                // `nexts[target]` is below `ends[target]`: the counts say that an item of this byte
                // is still missing there. So the swap never leaves the slice.
                items.swap(index, nexts[target]);
            }
            nexts[target] += 1;
        }
    }
    Ok(ends)
}

/// Replaces each count by the sum of the counts before it (exclusive prefix sum).
pub fn prefix_sum<N: Copy + Default + AddAssign>(counts: &mut [N]) {
    let mut sum = N::default();
    for count in counts {
        sum += std::mem::replace(count, sum);
    }
}

/// Writes the values of `items` into `to` in ascending order of their keys, stable. Keys are below
/// `ends.len()`; the end of the values of each key is written into `ends`. Values of key 0 begin at
/// 0, those of another key at the end of the key before it (compressed sparse rows).
#[inline]
pub fn counting_sort<I, V>(
    items: impl Iterator<Item = I> + Clone,
    key: impl Fn(&I) -> usize,
    value: impl Fn(I) -> V,
    ends: &mut [u32],
    to: &mut [V],
) {
    ends.fill(0);
    items.clone().for_each(|item| ends[key(&item)] += 1);
    prefix_sum(ends);
    // `ends` holds the next free place of each key now, and is the end of the key's values when all
    // are written. So no second array of starts is needed. Equal keys keep their order, because the
    // places of a key are filled upwards.
    items.for_each(|item| {
        let next = &mut ends[key(&item)];
        to[*next as usize] = value(item);
        *next += 1;
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use crate::interrupt;

    fn mixed(row: u32) -> u32 {
        row.wrapping_mul(0x9e37_79b9).rotate_left(7).wrapping_mul(0x85eb_ca6b)
    }

    #[test]
    fn long_lists_are_sorted_by_all_their_bytes() {
        let len = 3 * SHORT as u32;
        let make = |pair: fn(u32) -> [u32; 2]| (0..len).map(|row| pair(mixed(row))).collect();
        let all: [Vec<[u32; 2]>; 4] = [
            make(|v| [v, v ^ 77]),
            make(|v| [v % 3, v]),
            make(|v| [7, v % 1000]),
            make(|v| [v >> 31, v % 2]),
        ];
        for mut pairs in all {
            let mut expected = pairs.clone();
            expected.sort_unstable();
            sort(&mut pairs, &mut Pulse::current()).unwrap();
            assert!(pairs == expected);
        }
        let mut ids: Vec<i64> = (0..len).map(|row| i64::from(mixed(row)) - (1 << 31)).collect();
        let mut expected = ids.clone();
        expected.sort_unstable();
        sort(&mut ids, &mut Pulse::current()).unwrap();
        assert!(ids == expected);
    }

    #[test]
    fn counting_sort_is_stable() {
        let items = [[3, 0], [1, 1], [3, 2], [0, 3], [1, 4]];
        let (mut ends, mut sorted) = ([9; 5], [0; 5]);
        counting_sort(items.iter(), |item| item[0], |item| item[1], &mut ends, &mut sorted);
        assert_eq!(sorted, [3, 1, 4, 0, 2]);
        assert_eq!(ends, [1, 3, 3, 5, 5]);
    }

    #[test]
    fn sorting_stops() {
        let mut items: Vec<u32> = (0..2 * SHORT as u32).map(mixed).collect();
        let stopped = interrupt::watch(|| true, || sort(&mut items, &mut Pulse::current()));
        assert_eq!(stopped, Err(Error::Interrupted));
    }
}
