//! The pairs of the last update, stored so that those of one shape are found directly.
//!
//! Each pair is a record in two doubly linked lists, one for each of its shapes.

use crate::error::Result;
use crate::interrupt::{self, Pulse, Stop};
use crate::memory;

/// No record, or no slot.
pub(super) const NONE: u32 = u32::MAX;

/// Most pairs of the shapes that change at a time: half of what numbers of records can tell
/// apart, so that as many others fit beside them.
pub(super) const MOST_RECORDS: usize = 1 << 31;

/// Fewer records than this are never moved together.
const FEW: usize = 1024;

/// Changes of fewer pairs take less than 0.1 s and are not interrupted.
const MANY: usize = 1 << 20;

/// Values that are copied between two checks for an interruption.
const COPIED: usize = 1 << 16;

/// Approximate number of values read, not adjacent in memory, when a record changes.
const RECORD_WORK: usize = 16;

/// Two slots, and the neighbours of the record in the list of either.
#[derive(Clone, Copy, Debug)]
struct Record {
    slots: [u32; 2],
    next: [u32; 2],
    back: [u32; 2],
}

/// Pairs of slots.
#[derive(Clone, Debug, Default)]
pub(super) struct Touching {
    records: Vec<Record>,
    /// Records that hold no pair.
    free: Vec<u32>,
    /// The first record in the list of each slot.
    heads: Vec<u32>,
}

impl Touching {
    /// Makes room for pairs of so many slots.
    pub(super) fn widen(&mut self, slots: usize) -> Result<()> {
        memory::lengthen(&mut self.heads, slots, NONE)
    }

    /// Removes the records `left` and adds the pairs `entered`. After an error, which may be an
    /// interruption, all is as before: changes that take long are made to a copy.
    pub(super) fn change(&mut self, left: &[u32], entered: &[[u32; 2]]) -> Result<()> {
        interrupt::check()?;
        let len = self.len() + entered.len() - left.len();
        let moved = if self.is_wasteful(len) { len } else { 0 };
        if left.len() + entered.len() + moved < MANY {
            self.reserve(entered.len(), left.len())?;
            return self.apply(left, entered, &mut Pulse::of(&Stop::default()));
        }
        let mut pulse = Pulse::current();
        let mut changed = Self {
            records: copied(&self.records, &mut pulse)?,
            free: copied(&self.free, &mut pulse)?,
            heads: copied(&self.heads, &mut pulse)?,
        };
        changed.reserve(entered.len(), left.len())?;
        changed.apply(left, entered, &mut pulse)?;
        *self = changed;
        Ok(())
    }

    /// Reserves memory for numbers of added and of removed pairs.
    fn reserve(&mut self, come: usize, go: usize) -> Result<()> {
        memory::reserve(&mut self.records, come.saturating_sub(self.free.len()))?;
        memory::reserve(&mut self.free, go)
    }

    /// As [`change`](Self::change), in place; there is memory for it.
    fn apply(&mut self, left: &[u32], entered: &[[u32; 2]], pulse: &mut Pulse) -> Result<()> {
        for &record in left {
            pulse.check(RECORD_WORK)?;
            self.unlink(record);
        }
        for &pair in entered {
            pulse.check(RECORD_WORK)?;
            self.link(pair);
        }
        self.tidy(pulse)
    }

    /// Number of pairs.
    pub(super) fn len(&self) -> usize {
        self.records.len() - self.free.len()
    }

    /// Whether a slot is in any pair.
    pub(super) fn has(&self, slot: u32) -> bool {
        self.heads[slot as usize] != NONE
    }

    /// The records of a slot, each with the slot on its other side.
    pub(super) fn of(&self, slot: u32) -> impl Iterator<Item = (u32, u32)> {
        let mut at = self.heads[slot as usize];
        std::iter::from_fn(move || {
            let record = self.records.get(at as usize)?;
            let side = record.side(slot);
            let this = (at, record.slots[1 - side]);
            at = record.next[side];
            Some(this)
        })
    }

    /// All pairs, in no promised order.
    pub(super) fn pairs(&self) -> impl Iterator<Item = [u32; 2]> {
        self.records.iter().map(|record| record.slots).filter(|slots| slots[0] != NONE)
    }

    /// Both slots of a record.
    pub(super) fn pair(&self, record: u32) -> [u32; 2] {
        self.records[record as usize].slots
    }

    /// Adds a pair that is not there.
    fn link(&mut self, slots: [u32; 2]) {
        let next = slots.map(|slot| self.heads[slot as usize]);
        let record = Record { slots, next, back: [NONE; 2] };
        let index = if let Some(index) = self.free.pop() {
            self.records[index as usize] = record;
            index
        } else {
            self.records.push(record);
            self.records.len() as u32 - 1
        };
        for (slot, next) in slots.into_iter().zip(next) {
            self.heads[slot as usize] = index;
            if let Some(next) = self.records.get_mut(next as usize) {
                next.back[next.side(slot)] = index;
            }
        }
    }

    /// Takes a pair out.
    fn unlink(&mut self, index: u32) {
        let Record { slots, next, back } = self.records[index as usize];
        for side in 0..2 {
            let slot = slots[side];
            match self.records.get_mut(back[side] as usize) {
                None => self.heads[slot as usize] = next[side],
                Some(before) => before.next[before.side(slot)] = next[side],
            }
            if let Some(after) = self.records.get_mut(next[side] as usize) {
                after.back[after.side(slot)] = back[side];
            }
        }
        self.records[index as usize].slots = [NONE; 2];
        self.free.push(index);
    }

    /// Whether most of the records are unused if there are `len` pairs.
    fn is_wasteful(&self, len: usize) -> bool {
        self.records.len() >= FEW && len <= self.records.len() / 4
    }

    /// Frees memory if most of it is unused and there is enough memory for that.
    fn tidy(&mut self, pulse: &mut Pulse) -> Result<()> {
        if !self.is_wasteful(self.len()) {
            return Ok(());
        }
        let (Ok(mut pairs), Ok(records)) =
            (memory::with_room(self.len()), memory::with_room(2 * self.len()))
        else {
            return Ok(());
        };
        for pair in self.pairs() {
            pulse.check(1)?;
            pairs.push(pair);
        }
        for slot in pairs.as_flattened() {
            pulse.check(1)?;
            self.heads[*slot as usize] = NONE;
        }
        self.records = records;
        self.free = Vec::new();
        for pair in pairs {
            pulse.check(RECORD_WORK)?;
            self.link(pair);
        }
        Ok(())
    }

    /// Bytes of memory that they keep, used or not.
    pub(super) fn kept_bytes(&self) -> usize {
        let words = self.free.capacity() + self.heads.capacity();
        self.records.capacity() * size_of::<Record>() + words * size_of::<u32>()
    }
}

impl Record {
    /// Where in the record a slot stands.
    fn side(&self, slot: u32) -> usize {
        usize::from(self.slots[1] == slot)
    }
}

/// A copy that can be interrupted.
fn copied<V: Copy>(values: &[V], pulse: &mut Pulse) -> Result<Vec<V>> {
    let mut copy = memory::with_room(values.len())?;
    for some in values.chunks(COPIED) {
        pulse.check(some.len())?;
        copy.extend_from_slice(some);
    }
    Ok(copy)
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;
    use crate::error::Error;

    fn of(touching: &Touching, slot: u32) -> Vec<u32> {
        let mut others: Vec<u32> = touching.of(slot).map(|(_, other)| other).collect();
        others.sort_unstable();
        others
    }

    #[test]
    fn every_shape_finds_its_own_pairs() {
        let mut touching = Touching::default();
        touching.widen(5).unwrap();
        for pair in [[0, 1], [2, 0], [0, 3], [3, 1]] {
            touching.link(pair);
        }
        assert_eq!(of(&touching, 0), [1, 2, 3]);
        assert_eq!(of(&touching, 1), [0, 3]);
        assert!(!touching.has(4));
        // The middle, the last and the first of a list.
        for (slot, other, rest) in [(0, 2, vec![1, 3]), (0, 1, vec![3]), (3, 1, vec![0])] {
            let (record, _) = touching.of(slot).find(|found| found.1 == other).unwrap();
            touching.unlink(record);
            assert_eq!(of(&touching, slot), rest);
        }
        assert_eq!(touching.pairs().collect::<Vec<_>>(), [[0, 3]]);
    }

    #[test]
    fn memory_is_given_back() {
        let mut touching = Touching::default();
        touching.widen(10_000).unwrap();
        (0..9_999).for_each(|slot| touching.link([slot, slot + 1]));
        let full = touching.kept_bytes();
        for slot in 0..9_900 {
            let (record, _) = touching.of(slot).next().unwrap();
            touching.unlink(record);
        }
        touching.tidy(&mut Pulse::current()).unwrap();
        assert!(touching.kept_bytes() < full / 4);
        assert_eq!(touching.len(), 99);
        assert_eq!(of(&touching, 9_950), [9_949, 9_951]);
    }

    #[test]
    fn an_interrupted_change_changes_nothing() {
        thread_local! {
            static POLLS: Cell<u32> = const { Cell::new(0) };
        }
        fn third_time() -> bool {
            POLLS.set(POLLS.get() + 1);
            POLLS.get() >= 3
        }
        let mut touching = Touching::default();
        touching.widen(MANY + 1).unwrap();
        touching.link([0, 7]);
        touching.link([3, 7]);
        let entered: Vec<[u32; 2]> = (0..MANY as u32).map(|slot| [slot, slot + 1]).collect();
        let stopped = interrupt::watch(third_time, || touching.change(&[0], &entered));
        assert_eq!(stopped, Err(Error::Interrupted));
        assert_eq!((of(&touching, 7), touching.len()), (vec![0, 3], 2));
        touching.change(&[0], &entered).unwrap();
        assert_eq!((of(&touching, 7), touching.len()), (vec![3, 6, 8], MANY + 1));
    }
}
