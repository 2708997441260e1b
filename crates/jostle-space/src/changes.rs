//! The slots that changed since the last update.

use super::layers::Layers;
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_index::geometry::Scalar;

/// Slots that changed since the last update, and memory for their pairs.
#[derive(Clone, Debug, Default)]
pub(super) struct Changes {
    pub(super) slots: Vec<u32>,
    /// Whether each slot is in `slots`.
    pub(super) changed: Vec<bool>,
    /// Slots that are removed and still in a pair of the last update.
    pub(super) leaving: Vec<u32>,
    /// Number of updates.
    pub(super) updates: u64,
    /// Memory for the pairs that are found.
    pub(super) found: Vec<[u32; 2]>,
}

impl Changes {
    /// Increases the number of slots to `slots`.
    pub(super) fn widen(&mut self, slots: usize) -> Result<()> {
        memory::lengthen(&mut self.changed, slots, false)
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

    /// The changed slots with a shape, if `any_removed`; otherwise all changed slots.
    pub(super) fn present<T: Scalar>(
        &self,
        layers: &Layers<T>,
        any_removed: bool,
    ) -> Result<Vec<u32>> {
        if !any_removed {
            return memory::collect(self.slots.iter().copied());
        }
        let mut present = memory::with_capacity(self.slots.len())?;
        present.extend(self.slots.iter().copied().filter(|&slot| layers.has(slot)));
        Ok(present)
    }

    /// Begins a new update.
    pub(super) fn clear(&mut self) {
        if self.slots.len() == self.changed.len() {
            self.changed.fill(false);
        } else {
            self.slots.iter().for_each(|&slot| self.changed[slot as usize] = false);
        }
        self.slots.clear();
        self.updates += 1;
    }

    /// Allocated bytes, used or not.
    pub(super) fn memory_bytes(&self) -> usize {
        let words = self.slots.capacity() + self.leaving.capacity();
        4 * (words + 2 * self.found.capacity()) + self.changed.capacity()
    }
}
