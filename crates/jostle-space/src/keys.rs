//! Pairs of slots as single numbers, which are sorted and compared in lists.

use jostle_base::error::Result;
use jostle_base::interrupt::Pulse;
use jostle_base::memory;
use jostle_base::sorting;

/// A pair of slots: the smaller one in the upper half, the larger one in the lower. A slot has
/// 31 bits, so no key is negative.
pub(super) type Key = i64;

/// Pairs read between two checks for an interruption.
const CHUNK: usize = 1 << 14;

/// Pairs compared at a time; what is found fits into the first-level cache.
const STEPS: usize = 1 << 9;

/// If there are more slots per pair than this, counting the pairs of each slot takes longer than
/// sorting by comparison.
const SLOTS_PER_PAIR: usize = 16;

/// The key of two slots in either order.
#[inline(always)]
pub(super) fn key_of([a, b]: [u32; 2]) -> Key {
    Key::from(a.min(b)) << 32 | Key::from(a.max(b))
}

/// Both slots of a key, the smaller first.
#[inline(always)]
pub(super) fn slots_of(key: Key) -> [u32; 2] {
    [(key >> 32) as u32, key as u32]
}

/// The keys of `pairs`, ascending, in the memory of `keys`. All slots are less than `slots`;
/// `starts` is scratch.
pub(super) fn sorted(
    pairs: &[[u32; 2]],
    slots: usize,
    starts: &mut Vec<u32>,
    mut keys: Vec<Key>,
) -> Result<Vec<Key>> {
    let mut pulse = Pulse::current();
    // Few pairs in a large space: counters for all slots would take longer than the pairs.
    if pairs.len() < slots / SLOTS_PER_PAIR {
        keys.clear();
        memory::reserve(&mut keys, pairs.len())?;
        keys.extend(pairs.iter().map(|&pair| key_of(pair)));
        sorting::sort(&mut keys, &mut pulse)?;
        return Ok(keys);
    }
    starts.clear();
    memory::resize(starts, slots, 0)?;
    for some in pairs.chunks(CHUNK) {
        pulse.check(some.len())?;
        some.iter().for_each(|&[a, b]| starts[a.min(b) as usize] += 1);
    }
    // The end of each slot's keys, not the start: filled downwards, the counter becomes the start,
    // which is needed for the repair below.
    let mut sum = 0;
    for some in starts.chunks_mut(CHUNK) {
        pulse.check(some.len())?;
        for start in some {
            sum += *start;
            *start = sum;
        }
    }
    memory::resize(&mut keys, pairs.len(), 0)?;
    keys.truncate(pairs.len());
    // `starts` now has the end of the keys of each slot; each key is written before those already
    // written.
    for some in pairs.chunks(CHUNK) {
        pulse.check(some.len())?;
        for &pair in some {
            let key = key_of(pair);
            let start = &mut starts[(key >> 32) as usize];
            *start -= 1;
            keys[*start as usize] = key;
        }
    }
    // Most slots have few pairs, in any order. Two passes that move the larger of two neighbours
    // ahead, without branches, sort up to three; the rest is rare enough for branches.
    for _ in 0..2 {
        pulse.check(keys.len())?;
        move_larger_ahead(&mut keys);
    }
    for start in (1..keys.len()).step_by(CHUNK) {
        pulse.check(CHUNK)?;
        for at in start..keys.len().min(start + CHUNK) {
            // Only neighbours of one slot can be in the wrong order, since counting has sorted by
            // the first slot. All keys of that slot are sorted, so what follows is in order again.
            if keys[at] < keys[at - 1] {
                let slot = (keys[at] >> 32) as usize;
                let behind = starts.get(slot + 1).map_or(keys.len(), |&start| start as usize);
                sorting::sort(&mut keys[starts[slot] as usize..behind], &mut pulse)?;
            }
        }
    }
    Ok(keys)
}

/// Exchanges each key with the next one if that is smaller, from the first to the last.
fn move_larger_ahead(keys: &mut [Key]) {
    let Some(&first) = keys.first() else { return };
    let mut larger = first;
    for at in 1..keys.len() {
        let next = keys[at];
        // One pass of bubble sort, with a minimum and a maximum instead of a branch on random data.
        keys[at - 1] = larger.min(next);
        larger = larger.max(next);
    }
    keys[keys.len() - 1] = larger;
}

/// The items that are only in `old`, and those that are only in `new`. Both are ascending without
/// duplicates, those of `old` by `key`.
#[inline(always)]
pub(super) fn difference<V: Copy + Default>(
    old: &[V],
    key: impl Fn(&V) -> Key,
    new: &[Key],
) -> Result<(Vec<V>, Vec<Key>)> {
    let mut pulse = Pulse::current();
    let (mut left, mut entered) = (Vec::new(), Vec::new());
    let (mut some_left, mut some_entered) = ([V::default(); STEPS], [0; STEPS]);
    let [mut at_old, mut at_new] = [0; 2];
    loop {
        let steps = STEPS.min(old.len() - at_old).min(new.len() - at_new);
        if steps == 0 {
            break;
        }
        pulse.check(steps)?;
        // Without branches, because the processor cannot predict which pairs stay.
        let [mut left_len, mut entered_len] = [0; 2];
        for _ in 0..steps {
            // Both are written to their lists in each step and counted only if they are there
            // alone. In an update of moving shapes which pairs stay is random, and a branch would
            // be predicted wrongly in a large part of the steps.
            let (value, next) = (old[at_old], new[at_new]);
            let first = key(&value);
            some_left[left_len] = value;
            some_entered[entered_len] = next;
            left_len += usize::from(first < next);
            entered_len += usize::from(next < first);
            at_old += usize::from(first <= next);
            at_new += usize::from(next <= first);
        }
        append(&mut left, &some_left[..left_len])?;
        append(&mut entered, &some_entered[..entered_len])?;
    }
    append(&mut left, &old[at_old..])?;
    append(&mut entered, &new[at_new..])?;
    Ok((left, entered))
}

fn append<V: Copy>(values: &mut Vec<V>, more: &[V]) -> Result<()> {
    memory::reserve(values, more.len())?;
    values.extend_from_slice(more);
    Ok(())
}

/// Merges two ascending lists without common keys.
pub(super) fn merged(a: &[Key], b: &[Key]) -> Result<Vec<Key>> {
    let mut pulse = Pulse::current();
    let mut all = memory::with_capacity(a.len() + b.len())?;
    let [mut at_a, mut at_b] = [0; 2];
    loop {
        let steps = CHUNK.min(a.len() - at_a).min(b.len() - at_b);
        if steps == 0 {
            break;
        }
        pulse.check(steps)?;
        // As many steps as both lists have left at least, so that the loop needs no test of their
        // ends.
        for _ in 0..steps {
            let (first, second) = (a[at_a], b[at_b]);
            all.push(first.min(second));
            at_a += usize::from(first < second);
            at_b += usize::from(second < first);
        }
    }
    all.extend_from_slice(&a[at_a..]);
    all.extend_from_slice(&b[at_b..]);
    Ok(all)
}

/// The keys of which a slot `is_changed`, and the others.
pub(super) fn parted(keys: &[Key], is_changed: &[bool]) -> Result<[Vec<Key>; 2]> {
    let mut pulse = Pulse::current();
    let mut parts = [memory::with_capacity(keys.len())?, memory::with_capacity(keys.len())?];
    for some in keys.chunks(CHUNK) {
        pulse.check(some.len())?;
        for &key in some {
            let [a, b] = slots_of(key);
            let changed = is_changed[a as usize] || is_changed[b as usize];
            parts[usize::from(!changed)].push(key);
        }
    }
    Ok(parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys(pairs: &[[u32; 2]]) -> Vec<Key> {
        pairs.iter().map(|&pair| key_of(pair)).collect()
    }

    #[test]
    fn few_and_many_pairs_are_sorted_alike() {
        let pairs: Vec<[u32; 2]> =
            (0..900).map(|i| [i * 7 % 90 + 10 * (i / 90), i * 7 % 90]).collect();
        let pairs: Vec<[u32; 2]> = pairs.into_iter().filter(|[a, b]| a != b).collect();
        let mut expected = keys(&pairs);
        expected.sort_unstable();
        for slots in [200, 100_000] {
            let sorted = sorted(&pairs, slots, &mut vec![7; 3], vec![9; 2000]).unwrap();
            assert_eq!(sorted, expected);
        }
        assert_eq!(sorted(&[], 5, &mut Vec::new(), vec![1]).unwrap(), []);
    }

    #[test]
    fn two_lists_are_compared() {
        let cases: [[&[Key]; 4]; 5] = [
            [&[], &[], &[], &[]],
            [&[1, 2], &[], &[1, 2], &[]],
            [&[], &[3], &[], &[3]],
            [&[1, 3, 5, 8, 9], &[2, 3, 4, 8], &[1, 5, 9], &[2, 4]],
            [&[4, 5], &[1, 2, 4, 5, 6], &[], &[1, 2, 6]],
        ];
        for [old, new, left, entered] in cases {
            let found = difference(old, |key| *key, new).unwrap();
            assert_eq!(found, (left.to_vec(), entered.to_vec()));
            let mut all = [left, new].concat();
            all.sort_unstable();
            assert_eq!(merged(left, new).unwrap(), all);
        }
    }

    #[test]
    fn pairs_of_changed_slots_are_parted_from_others() {
        let all = keys(&[[0, 1], [0, 2], [1, 3], [2, 3]]);
        let parts = parted(&all, &[false, true, false, false]).unwrap();
        assert_eq!(parts, [keys(&[[0, 1], [1, 3]]), keys(&[[0, 2], [2, 3]])]);
    }
}
