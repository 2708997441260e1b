//! The order of adding: the ids of all shapes, and the row of each in it.

use super::slots::Slots;
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::memory;
use jostle_index::geometry::Scalar;

/// The row of a slot without a shape.
const NONE: u32 = u32::MAX;

/// So few ids of removed shapes may stay whatever the number of shapes.
const FEW: usize = 64;

/// The ids of shapes in the order of adding. Ids of removed shapes stay until the next reading, or until they are more
/// than half of all; then all ids are visited once, so many removals in turn cost no more than one.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    ids: Vec<Id>,
    /// Whether some ids are those of removed shapes.
    is_stale: bool,
    /// The row of the shape in each slot, or of the first slots; computed when it is asked for.
    rows: Vec<u32>,
}

impl Rows {
    /// The order of restored shapes. `ids` are those of all shapes, in any order.
    pub(super) fn of(ids: Vec<Id>) -> Self {
        Self { ids, ..Self::default() }
    }

    /// Reserves memory for `more` shapes.
    pub(super) fn reserve<T: Scalar>(&mut self, more: usize, slots: &Slots<T>) -> Result<()> {
        // Without this a program that adds and removes shapes, and never reads a column, would keep all ids.
        if self.ids.len() > 2 * slots.len() + FEW {
            self.ids(slots);
        }
        memory::reserve(&mut self.ids, more)
    }

    /// Appends a shape. Memory is reserved.
    pub(super) fn push(&mut self, id: Id) {
        self.ids.push(id);
        self.rows.clear();
    }

    /// Notes that shapes have been removed.
    pub(super) fn remove_some(&mut self) {
        self.is_stale = true;
        self.rows.clear();
    }

    /// The ids of all shapes, in the order of adding.
    pub(super) fn ids<T: Scalar>(&mut self, slots: &Slots<T>) -> &[Id] {
        if self.is_stale {
            // The id of a removed shape is never used again, so it is found in no slot.
            self.ids.retain(|&id| slots.slot(id).is_some());
            self.is_stale = false;
        }
        &self.ids
    }

    /// The row of each of these ids. Refuses ids that no shape has.
    pub(super) fn rows_of<T: Scalar>(&mut self, ids: &[Id], slots: &Slots<T>) -> Result<Vec<i64>> {
        let asked = slots.look_up(ids)?;
        self.ids(slots);
        if self.rows.is_empty() {
            memory::resize(&mut self.rows, slots.count(), NONE)?;
            for (row, &id) in (0..).zip(&self.ids) {
                // The low bits of an id are its slot.
                self.rows[id as u32 as usize] = row;
            }
        }
        memory::collect(asked.into_iter().map(|slot| i64::from(self.rows[slot as usize])))
    }

    /// Allocated bytes, used or not.
    pub(super) fn memory_bytes(&self) -> usize {
        self.ids.capacity() * size_of::<Id>() + self.rows.capacity() * size_of::<u32>()
    }
}
