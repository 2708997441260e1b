//! Pairs of slots, stored so that those of one slot are found directly.
//!
//! Each pair is a record in two doubly linked lists, one for each of its slots.

use super::keys::{Key, key_of, slots_of};
use jostle_base::error::Result;
use jostle_base::interrupt::Pulse;
use jostle_base::memory;
use jostle_base::sorting;

/// No record, or no slot.
const NONE: u32 = u32::MAX;

/// Fewer records than this do not take much memory, even if most of them are unused.
const FEW: usize = 1024;

/// Approximate number of values read, not adjacent in memory, for a record.
const RECORD_WORK: usize = 16;

/// Two slots, and the neighbours of the record in the list of either.
#[derive(Clone, Copy, Debug)]
struct Link {
    slots: [u32; 2],
    next: [u32; 2],
    back: [u32; 2],
}

/// Pairs of slots in linked lists.
#[derive(Clone, Debug, Default)]
pub(super) struct Links {
    records: Vec<Link>,
    /// Records that hold no pair.
    free: Vec<u32>,
    /// The first record in the list of each slot.
    heads: Vec<u32>,
}

impl Links {
    /// Links the pairs of a list; all slots are less than `slots`.
    pub(super) fn of(list: &[Key], slots: usize) -> Result<Self> {
        let mut pulse = Pulse::current();
        let (records, heads) = (memory::with_capacity(list.len())?, memory::filled(slots, NONE)?);
        let mut links = Self { records, free: Vec::new(), heads };
        for &key in list {
            pulse.check(RECORD_WORK)?;
            links.link(slots_of(key));
        }
        Ok(links)
    }

    /// The keys of all pairs, ascending.
    pub(super) fn list(&self) -> Result<Vec<Key>> {
        let mut pulse = Pulse::current();
        let mut list = memory::with_capacity(self.len())?;
        for pair in self.pairs() {
            pulse.check(1)?;
            list.push(key_of(pair));
        }
        sorting::sort(&mut list, &mut pulse)?;
        Ok(list)
    }

    /// Increases the number of slots to `slots`.
    pub(super) fn widen(&mut self, slots: usize) -> Result<()> {
        memory::lengthen(&mut self.heads, slots, NONE)
    }

    /// Key and record of each pair with a slot that changed, ascending; none if there are more
    /// than `most`.
    pub(super) fn of_changed(
        &self,
        slots: &[u32],
        is_changed: &[bool],
        most: usize,
    ) -> Result<Option<Vec<[i64; 2]>>> {
        let mut pulse = Pulse::current();
        let mut found = Vec::new();
        for &slot in slots {
            pulse.check(RECORD_WORK)?;
            for (record, other) in self.of_slot(slot) {
                pulse.check(RECORD_WORK)?;
                // A pair of two changed slots is met from both; it is listed from the smaller one.
                if slot < other || !is_changed[other as usize] {
                    if found.len() == most {
                        return Ok(None);
                    }
                    memory::push(&mut found, [key_of([slot, other]), i64::from(record)])?;
                }
            }
        }
        sorting::sort(&mut found, &mut pulse)?;
        Ok(Some(found))
    }

    /// Reserves memory for numbers of added and of removed pairs.
    pub(super) fn reserve(&mut self, come: usize, go: usize) -> Result<()> {
        // `change` removes before it adds, so even more records may be free by then: this is an
        // upper bound.
        memory::reserve(&mut self.records, come.saturating_sub(self.free.len()))?;
        memory::reserve(&mut self.free, go)
    }

    /// Removes the records `left` and adds the pairs `entered`; there is memory for it.
    pub(super) fn change(&mut self, left: &[[i64; 2]], entered: &[Key]) {
        left.iter().for_each(|&[_, record]| self.unlink(record as u32));
        entered.iter().for_each(|&key| self.link(slots_of(key)));
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
    fn of_slot(&self, slot: u32) -> impl Iterator<Item = (u32, u32)> {
        let mut at = self.heads[slot as usize];
        std::iter::from_fn(move || {
            let record = self.records.get(at as usize)?;
            let side = record.side(slot);
            let this = (at, record.slots[1 - side]);
            at = record.next[side];
            Some(this)
        })
    }

    /// All pairs, in unspecified order.
    fn pairs(&self) -> impl Iterator<Item = [u32; 2]> {
        self.records.iter().map(|record| record.slots).filter(|slots| slots[0] != NONE)
    }

    /// Adds a pair that is not linked yet.
    fn link(&mut self, slots: [u32; 2]) {
        // At the head of both lists: no list has an order, so nothing has to be searched.
        let next = slots.map(|slot| self.heads[slot as usize]);
        let record = Link { slots, next, back: [NONE; 2] };
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

    /// Removes the pair of a record.
    fn unlink(&mut self, index: u32) {
        let Link { slots, next, back } = self.records[index as usize];
        for side in 0..2 {
            let slot = slots[side];
            // `NONE` is an index beyond all records, so "no record before" is a failed lookup,
            // without a test of its own.
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

    /// Whether most of the records are unused.
    pub(super) fn is_wasteful(&self) -> bool {
        // Records are never moved, because others refer to them by index. If most are unused, the
        // caller makes a list of the rest and begins anew.
        self.records.len() >= FEW && self.len() <= self.records.len() / 4
    }

    /// Allocated bytes, used or not.
    pub(super) fn memory_bytes(&self) -> usize {
        let words = self.free.capacity() + self.heads.capacity();
        self.records.capacity() * size_of::<Link>() + words * size_of::<u32>()
    }
}

impl Link {
    /// The position of a slot in the record.
    fn side(&self, slot: u32) -> usize {
        usize::from(self.slots[1] == slot)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(links: &Links, slot: u32) -> Vec<u32> {
        let mut others: Vec<u32> = links.of_slot(slot).map(|(_, other)| other).collect();
        others.sort_unstable();
        others
    }

    #[test]
    fn every_slot_finds_its_own_pairs() {
        let list = [[0, 1], [0, 2], [0, 3], [1, 3]].map(key_of);
        let mut links = Links::of(&list, 5).unwrap();
        assert_eq!(links.list().unwrap(), list);
        assert_eq!(of(&links, 0), [1, 2, 3]);
        assert_eq!(of(&links, 1), [0, 3]);
        assert!(!links.has(4));
        // The middle, the last and the first of a list.
        for (slot, other, rest) in [(0, 2, vec![1, 3]), (0, 1, vec![3]), (3, 1, vec![0])] {
            let (record, _) = links.of_slot(slot).find(|found| found.1 == other).unwrap();
            links.change(&[[0, i64::from(record)]], &[]);
            assert_eq!(of(&links, slot), rest);
        }
        assert_eq!(links.list().unwrap(), [key_of([0, 3])]);
        links.change(&[], &[key_of([3, 4])]);
        assert_eq!((of(&links, 3), links.records.len()), (vec![0, 4], 4));
    }

    #[test]
    fn pairs_of_changed_slots_are_found_once() {
        let list = [[0, 1], [0, 2], [1, 2], [2, 3]].map(key_of);
        let links = Links::of(&list, 4).unwrap();
        let found = |most| links.of_changed(&[1, 0], &[true, true, false, false], most).unwrap();
        assert_eq!(found(3).unwrap().iter().map(|found| found[0]).collect::<Vec<_>>(), list[..3]);
        assert_eq!(found(2), None);
    }
}
