//! Changes of the pairs since the last update.
//!
//! Only pairs with a shape that changed can have entered or left. The pairs of the last update
//! are in the lists of these shapes, the current ones come from a join of their layer with all.
//! Each pair is compared once, at its *owner*, the changed one of its shapes.

use super::Space;
use super::layers::Layers;
use super::slots::Id;
use super::touching::{MOST_RECORDS, NONE, Touching};
use crate::error::{Error, Result};
use crate::geometry::Scalar;
use crate::interrupt::Pulse;
use crate::memory;
use crate::sorting;

/// Approximate number of values read, not adjacent in memory, when a pair is compared.
const RECORD_WORK: usize = 16;

/// Pairs of ids, the smaller first, sorted by first, then by second.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Events {
    /// Those that overlap and did not at the update before.
    pub entered: Vec<[Id; 2]>,
    /// Those that overlapped at the update before and do not any more, or have lost a shape.
    pub left: Vec<[Id; 2]>,
    /// Which update of its space it was.
    update: u64,
}

/// Slots that changed since the last update, and memory for comparing.
#[derive(Clone, Debug, Default)]
pub(super) struct Changes {
    slots: Vec<u32>,
    /// Whether a slot is among them.
    changed: Vec<bool>,
    /// Slots that are removed and still in a pair of the last update.
    pub(super) leaving: Vec<u32>,
    /// Updates so far.
    updates: u64,
    /// The first of the new pairs that each slot owns.
    firsts: Vec<u32>,
    /// The record of the pair of an owner and this slot, while the owner is looked at.
    records: Vec<u32>,
}

/// Changes to be made to the pairs of the last update.
#[derive(Default)]
struct Difference {
    entered: Vec<[u32; 2]>,
    /// Records.
    left: Vec<u32>,
}

impl<T: Scalar> Space<T> {
    /// The pairs that entered and left since the last update. If the shapes that changed have
    /// more than `max_pairs` pairs, nothing is done.
    pub fn update(&mut self, max_pairs: usize) -> Result<Events> {
        let max_pairs = max_pairs.min(MOST_RECORDS);
        let present = self.changes.present(&self.layers)?;
        let front = match self.layers.layer_of(&present) {
            Some(layer) => Some(layer),
            None => {
                // Fresh shapes have changed; usually they are all that have.
                if self.layers.fresh_len() < present.len() {
                    self.layers.reserve_fresh(present.len())?;
                    present.iter().for_each(|&slot| self.layers.freshen(slot));
                }
                self.layers.fold(&self.slots, self.settings)?
            }
        };
        let found = match self.pairs_with_changed(front, max_pairs) {
            Err(Error::TooManyPairs { .. }) => {
                // Dead or unchanged shapes may have been counted; they are excluded here.
                let front = self.layers.part(&present, &self.slots, self.settings)?;
                self.pairs_with_changed(front, max_pairs)?
            }
            found => found?,
        };
        let difference = self.changes.compare(&found, &self.touching)?;
        drop(found);
        self.take_over(&difference)
    }

    /// Overlapping pairs of slots, at least one of which changed. All of those are in `front`.
    fn pairs_with_changed(&self, front: Option<usize>, most: usize) -> Result<Vec<[u32; 2]>> {
        let mut found = Vec::new();
        let Some(front) = front else { return Ok(found) };
        let changed = &self.changes.changed;
        let wanted = |[a, b]: [u32; 2]| changed[a as usize] || changed[b as usize];
        for other in self.layers.indices() {
            self.layers.join([front, other], None, wanted, most, &mut found)?;
        }
        Ok(found)
    }

    /// Stores the current pairs as those of the last update. Everything that can fail comes first.
    fn take_over(&mut self, difference: &Difference) -> Result<Events> {
        let update = self.changes.updates + 1;
        let left = difference.left.iter().map(|&record| self.touching.pair(record));
        let (left, entered) =
            (self.sorted_ids(left)?, self.sorted_ids(difference.entered.iter().copied())?);
        self.slots.reserve_free(self.changes.leaving.len())?;
        self.touching.change(&difference.left, &difference.entered)?;
        self.changes.leaving.drain(..).for_each(|slot| self.slots.free(slot));
        self.changes.clear();
        Ok(Events { entered, left, update })
    }

    fn sorted_ids(&self, pairs: impl ExactSizeIterator<Item = [u32; 2]>) -> Result<Vec<[Id; 2]>> {
        let mut pulse = Pulse::current();
        let mut ids = memory::with_room(pairs.len())?;
        for pair in pairs {
            pulse.check(1)?;
            ids.push(self.pair_of_ids(pair));
        }
        sorting::sort(&mut ids, &mut pulse)?;
        Ok(ids)
    }

    /// The pairs that overlapped at this update and at the one before, sorted; none once
    /// there has been another update.
    pub fn stayed(&self, events: &Events) -> Result<Option<Vec<[Id; 2]>>> {
        if events.update != self.changes.updates {
            return Ok(None);
        }
        let mut pulse = Pulse::current();
        let mut pairs = memory::with_room(self.touching.len())?;
        for pair in self.touching.pairs() {
            pulse.check(1)?;
            pairs.push(self.pair_of_ids(pair));
        }
        sorting::sort(&mut pairs, &mut pulse)?;
        let mut entered = events.entered.iter().peekable();
        pairs.retain(|pair| !pulse.stops(1) && entered.next_if_eq(&pair).is_none());
        pulse.check(0)?;
        Ok(Some(pairs))
    }
}

impl Changes {
    /// Makes room for so many slots.
    pub(super) fn widen(&mut self, slots: usize) -> Result<()> {
        memory::lengthen(&mut self.changed, slots, false)?;
        memory::lengthen(&mut self.firsts, slots, NONE)?;
        memory::lengthen(&mut self.records, slots, NONE)
    }

    /// Reserves memory for `more` changed slots.
    pub(super) fn reserve(&mut self, more: usize) -> Result<()> {
        memory::reserve(&mut self.slots, more)?;
        memory::reserve(&mut self.leaving, more)
    }

    /// Records a slot whose shape was added, removed or changed.
    pub(super) fn note(&mut self, slot: u32) {
        if !std::mem::replace(&mut self.changed[slot as usize], true) {
            self.slots.push(slot);
        }
    }

    /// Those in which there is a shape.
    fn present<T: Scalar>(&self, layers: &Layers<T>) -> Result<Vec<u32>> {
        let mut present = memory::with_room(self.slots.len())?;
        present.extend(self.slots.iter().copied().filter(|&slot| layers.has(slot)));
        Ok(present)
    }

    /// The slot that owns a pair, and the other one.
    fn owned(&self, [a, b]: [u32; 2]) -> [u32; 2] {
        let owner_is_a = self.changed[a as usize] && (a < b || !self.changed[b as usize]);
        if owner_is_a { [a, b] } else { [b, a] }
    }

    /// Compares the pairs of now with those of the last update, one owner after the other, in
    /// time that grows with their number and no faster.
    fn compare(&mut self, found: &[[u32; 2]], touching: &Touching) -> Result<Difference> {
        let difference = self.compare_all(found, touching);
        if difference.is_err() {
            self.firsts.fill(NONE);
            self.records.fill(NONE);
        }
        difference
    }

    fn compare_all(&mut self, found: &[[u32; 2]], touching: &Touching) -> Result<Difference> {
        let mut difference = Difference::default();
        let mut pulse = Pulse::current();
        let mut nexts = memory::filled(found.len(), NONE)?;
        for (index, &pair) in found.iter().enumerate() {
            pulse.check(RECORD_WORK)?;
            let [owner, _] = self.owned(pair);
            nexts[index] = std::mem::replace(&mut self.firsts[owner as usize], index as u32);
        }
        for index in 0..self.slots.len() {
            let owner = self.slots[index];
            self.compare_owner(owner, found, &nexts, touching, &mut difference, &mut pulse)?;
        }
        Ok(difference)
    }

    fn compare_owner(
        &mut self,
        owner: u32,
        found: &[[u32; 2]],
        nexts: &[u32],
        touching: &Touching,
        difference: &mut Difference,
        pulse: &mut Pulse,
    ) -> Result<()> {
        let mut own = std::mem::replace(&mut self.firsts[owner as usize], NONE);
        let mut gone = 0;
        for (record, other) in touching.of(owner) {
            pulse.check(RECORD_WORK)?;
            if self.owned([owner, other])[0] == owner {
                self.records[other as usize] = record;
                gone += 1;
            }
        }
        while own != NONE {
            pulse.check(RECORD_WORK)?;
            let pair = self.owned(found[own as usize]);
            if std::mem::replace(&mut self.records[pair[1] as usize], NONE) == NONE {
                memory::push(&mut difference.entered, pair)?;
            } else {
                gone -= 1;
            }
            own = nexts[own as usize];
        }
        if gone == 0 {
            return Ok(());
        }
        for (record, other) in touching.of(owner) {
            pulse.check(RECORD_WORK)?;
            if std::mem::replace(&mut self.records[other as usize], NONE) == record {
                memory::push(&mut difference.left, record)?;
            }
        }
        Ok(())
    }

    fn clear(&mut self) {
        self.slots.iter().for_each(|&slot| self.changed[slot as usize] = false);
        self.slots.clear();
        self.updates += 1;
    }

    /// Bytes of memory that they keep, used or not.
    pub(super) fn kept_bytes(&self) -> usize {
        let words = [&self.slots, &self.leaving, &self.firsts, &self.records];
        let bytes: usize = words.iter().map(|column| 4 * column.capacity()).sum();
        bytes + self.changed.capacity()
    }
}
