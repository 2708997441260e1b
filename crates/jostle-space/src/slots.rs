//! A slot map (generational indices): shapes in slots, and their ids.
//!
//! An id contains the slot of its shape in the low bits and the slot's generation above them. So
//! the shape is found directly, and when a slot is used again, its id is new.

use super::saved::Saved;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::memory;
use jostle_index::geometry::{Core, Scalar, Shape, middle};
use jostle_index::shapes::{
    DEFAULT_CATEGORY, DEFAULT_MASK, Each, MAX_ROWS, ShapeColumns, Shapes, corners, middle_of,
};

/// The bit of a slot's generation that marks a vacant slot. No id has the bit, so no id refers to a
/// vacant slot.
pub(super) const VACANT: u32 = 1 << 31;

/// The columns of the shapes, and the generation of each slot.
///
/// Columns with the same value for every slot are empty, as in `Columns`.
#[derive(Clone, Debug, Default)]
pub(super) struct Slots<T> {
    /// `min` of the shapes: the centres, unless they are given as boxes.
    mins: Vec<[T; 2]>,
    /// `max` of the shapes; empty until one is given as a box.
    maxes: Vec<[T; 2]>,
    radii: Vec<T>,
    /// Empty until a shape has half sizes.
    half_sizes: Vec<[T; 2]>,
    /// What each core is within its box; empty until one is a segment.
    cores: Vec<Core>,
    /// Categories and masks; empty until a shape has others than the defaults.
    filters: Vec<[u32; 2]>,
    generations: Vec<u32>,
    /// Slots to be used again, the last one first.
    free: Vec<u32>,
    /// The last call of [`Slots::find`] that was given each slot.
    last_call: Vec<u32>,
    call: u32,
    len: usize,
    /// Whether a slot has been freed.
    freed: bool,
}

impl<T: Scalar> Slots<T> {
    /// Number of shapes.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Number of slots, vacant ones too.
    pub(super) fn count(&self) -> usize {
        self.generations.len()
    }

    /// The id of the shape that is, or was last, in `slot`.
    pub(super) fn id(&self, slot: u32) -> Id {
        Id::from(self.generations[slot as usize] & !VACANT) << 32 | Id::from(slot)
    }

    /// Whether every id is the same number as its slot.
    pub(super) fn are_ids(&self) -> bool {
        !self.freed
    }

    /// The slot of the shape with this id, if there is one.
    pub(super) fn slot(&self, id: Id) -> Option<u32> {
        let (slot, generation) = parts(id)?;
        let found = *self.generations.get(slot as usize)?;
        // One comparison tests all: that the slot exists, has a shape, and that it is still the
        // same one. A vacant slot has a bit that no id has.
        (found == generation).then_some(slot)
    }

    /// The slots with shapes.
    pub(super) fn present(&self) -> impl Iterator<Item = u32> {
        (0..).zip(&self.generations).filter(|(_, g)| **g & VACANT == 0).map(|(slot, _)| slot)
    }

    /// The columns as plain lists.
    pub(super) fn save(&self) -> Result<Saved<T>> {
        let corners = self.mins.iter().enumerate().map(|(slot, min)| {
            let max = self.maxes.get(slot).unwrap_or(min);
            [min[0], min[1], max[0], max[1]]
        });
        Ok(Saved {
            corners: memory::collect(corners)?,
            radii: memory::collect(self.radii.iter().copied())?,
            half_sizes: memory::collect(self.half_sizes.iter().copied())?,
            cores: memory::collect(self.cores.iter().copied())?,
            filters: memory::collect(self.filters.iter().copied())?,
            generations: memory::collect(self.generations.iter().copied())?,
            free: memory::collect(self.free.iter().copied())?,
            ..Saved::default()
        })
    }

    /// The slots of consistent columns.
    pub(super) fn restore(saved: Saved<T>) -> Result<Self> {
        let Saved { corners: boxes, radii, half_sizes, cores, filters, generations, free, .. } =
            saved;
        let len = generations.iter().filter(|generation| **generation & VACANT == 0).count();
        let freed = generations.iter().any(|generation| *generation & !VACANT != 0);
        let has_boxes = boxes.iter().any(|one| corners(one)[0] != corners(one)[1]);
        let mut maxes = Vec::new();
        if has_boxes {
            maxes = memory::collect(boxes.iter().map(|one| corners(one)[1]))?;
        }
        let mins = memory::collect(boxes.iter().map(|one| corners(one)[0]))?;
        let last_call = memory::filled(generations.len(), 0)?;
        let call = 0;
        Ok(Self {
            mins,
            maxes,
            radii,
            half_sizes,
            cores,
            filters,
            generations,
            free,
            last_call,
            call,
            len,
            freed,
        })
    }

    /// Reserves memory for `more` shapes.
    pub(super) fn reserve(&mut self, shapes: &Shapes<T>) -> Result<()> {
        let more = shapes.len();
        memory::reserve(&mut self.mins, more)?;
        memory::reserve(&mut self.maxes, more)?;
        memory::reserve(&mut self.radii, more)?;
        memory::reserve(&mut self.generations, more)?;
        memory::reserve(&mut self.last_call, more)?;
        let (half_sizes, filters) = (shapes.half_sizes().is_some(), shapes.has_filters());
        self.reserve_columns(more, [half_sizes, filters, shapes.cores().is_some()])
    }

    /// Reserves memory for the columns that are present only if a value differs from the
    /// default: half sizes, filters, cores.
    pub(super) fn reserve_columns(&mut self, more: usize, wanted: [bool; 3]) -> Result<()> {
        let count = self.count() + more;
        if wanted[0] || !self.half_sizes.is_empty() {
            let missing = count - self.half_sizes.len();
            memory::reserve(&mut self.half_sizes, missing)?;
        }
        if wanted[1] || !self.filters.is_empty() {
            let missing = count - self.filters.len();
            memory::reserve(&mut self.filters, missing)?;
        }
        if wanted[2] || !self.cores.is_empty() {
            let missing = count - self.cores.len();
            memory::reserve(&mut self.cores, missing)?;
        }
        Ok(())
    }

    /// Reserves memory for the slots of `more` removed shapes.
    pub(super) fn reserve_free(&mut self, more: usize) -> Result<()> {
        memory::reserve(&mut self.free, more)
    }

    /// The slots of `ids`. Refuses ids that do not exist, and ids given twice.
    pub(super) fn find(&mut self, ids: &[Id]) -> Result<Vec<u32>> {
        // Each call has a number, and `last_call` has that of the last call that found each slot. So the
        // ids found before need no clearing, except once in four billion calls.
        if self.call == u32::MAX {
            self.last_call.fill(0);
            self.call = 0;
        }
        self.call += 1;
        let mut slots = memory::with_capacity(ids.len())?;
        for (index, &id) in ids.iter().enumerate() {
            let Some(slot) = self.slot(id) else {
                return Err(Error::missing("ids", index, id, self.why_unknown(id)));
            };
            // Of two values for one shape in a call none is the right one.
            if std::mem::replace(&mut self.last_call[slot as usize], self.call) == self.call {
                return Err(Error::at("ids", index, id, "it is given twice"));
            }
            slots.push(slot);
        }
        Ok(slots)
    }

    /// The slots of `ids`, which may contain an id more than once.
    pub(super) fn look_up(&self, ids: &[Id]) -> Result<Vec<u32>> {
        let mut slots = memory::with_capacity(ids.len())?;
        for (index, &id) in ids.iter().enumerate() {
            let slot = self.slot(id);
            slots.push(slot.ok_or_else(|| Error::missing("ids", index, id, self.why_unknown(id)))?);
        }
        Ok(slots)
    }

    fn why_unknown(&self, id: Id) -> &'static str {
        let past = parts(id).is_some_and(|(slot, generation)| {
            let found = self.generations.get(slot as usize);
            found.is_some_and(|found| {
                // Past generations, or the present one of a slot whose shape is removed and not yet
                // freed.
                generation < found & !VACANT || generation | VACANT == *found && self.was_used(slot)
            })
        });
        if past { "its shape has been removed" } else { "no shape has this id" }
    }

    /// Whether a vacant slot still has the generation of its last shape: it is freed later.
    fn was_used(&self, slot: u32) -> bool {
        // A search through the list, for the text of an error only.
        !self.free.contains(&slot)
    }

    /// Refuses more shapes than the maximum.
    pub(super) fn check_room(&self, more: usize) -> Result<()> {
        if more <= self.free.len() || self.count() + (more - self.free.len()) <= MAX_ROWS {
            return Ok(());
        }
        Err(Error::of("positions", more, "a space has room for 2147483647 shapes in all"))
    }

    /// A slot for one more shape.
    pub(super) fn put(&mut self, shape: &Shape<T>) -> u32 {
        self.len += 1;
        // The last slot freed first: its columns are most likely in the cache.
        if let Some(slot) = self.free.pop() {
            self.generations[slot as usize] &= !VACANT;
            self.set_corners(slot, [shape.min, shape.max]);
            self.set_radius(slot, shape.radius);
            self.set_half_size(slot, shape.half_size);
            self.set_core(slot, shape.core);
            self.set_filter(slot, [shape.category, shape.mask]);
            return slot;
        }
        let slot = self.count() as u32;
        self.generations.push(0);
        self.last_call.push(0);
        self.mins.push(shape.min);
        self.radii.push(shape.radius);
        if !self.maxes.is_empty() {
            self.maxes.push(shape.max);
        }
        if !self.half_sizes.is_empty() {
            self.half_sizes.push([T::ZERO; 2]);
        }
        if !self.cores.is_empty() {
            self.cores.push(Core::Box);
        }
        if !self.filters.is_empty() {
            self.filters.push([DEFAULT_CATEGORY, DEFAULT_MASK]);
        }
        self.set_corners(slot, [shape.min, shape.max]);
        self.set_half_size(slot, shape.half_size);
        self.set_core(slot, shape.core);
        self.set_filter(slot, [shape.category, shape.mask]);
        slot
    }

    /// Removes the shape in `slot`; the slot keeps its generation until it is freed.
    pub(super) fn remove(&mut self, slot: u32) {
        self.len -= 1;
        self.generations[slot as usize] |= VACANT;
    }

    /// Frees a vacant slot, so that it is used again with the next generation; after the last
    /// generation a slot is not used again.
    pub(super) fn free(&mut self, slot: u32) {
        let generation = (self.generations[slot as usize] & !VACANT) + 1;
        // 2³¹ shapes have had this slot. With one more an old id would name a new shape, so the
        // slot is given up.
        if generation == VACANT {
            return;
        }
        self.generations[slot as usize] = generation | VACANT;
        self.freed = true;
        self.free.push(slot);
    }

    /// Moves a shape; returns whether that changes it. A shape given as a box is stored as its
    /// centre and half its size from then on, a segment as two other ends.
    pub(super) fn set_center(&mut self, slot: u32, center: [T; 2]) -> bool {
        if !self.is_box(slot) {
            return self.set_corners(slot, [center; 2]);
        }
        let shape = self.shape(slot);
        // Setting the present centre is no change, so a box keeps its exact sides.
        if shape.center() == center {
            return false;
        }
        if shape.core != Core::Box {
            let [hx, hy] = shape.core_half_size();
            let [x, y] = center;
            return self.set_corners(slot, [[x - hx, y - hy], [x + hx, y + hy]]);
        }
        self.set_corners(slot, [center; 2]);
        self.set_half_size(slot, shape.core_half_size());
        true
    }

    /// Sets the core of a shape to a box and keeps its radius; returns whether that changes
    /// it.
    pub(super) fn set_box(&mut self, slot: u32, corners: [[T; 2]; 2]) -> bool {
        let shape = self.shape(slot);
        // Setting the present bounding box is no change, so a segment stays one.
        if shape.core != Core::Box && [shape.min, shape.max] == corners {
            return false;
        }
        self.set_core_within(slot, corners, Core::Box)
    }

    /// Sets the core of a shape to a segment, a diagonal of a box, and keeps its radius; returns
    /// whether that changes it.
    pub(super) fn set_core_within(&mut self, slot: u32, corners: [[T; 2]; 2], core: Core) -> bool {
        let moved = self.set_corners(slot, corners);
        let resized = self.set_half_size(slot, [T::ZERO; 2]);
        self.set_core(slot, core) || moved || resized
    }

    /// Sets the half sizes of a shape; returns whether that changes it.
    pub(super) fn resize(&mut self, slot: u32, half_size: [T; 2]) -> bool {
        if !self.is_box(slot) {
            let changed = self.set_half_size(slot, half_size);
            if changed {
                // A segment of no length becomes a box, as any other segment does.
                self.set_core(slot, Core::Box);
            }
            return changed;
        }
        let shape = self.shape(slot);
        if shape.core_half_size() == half_size {
            return false;
        }
        self.set_core(slot, Core::Box);
        self.set_corners(slot, [shape.center(); 2]);
        self.set_half_size(slot, half_size);
        true
    }

    fn is_box(&self, slot: u32) -> bool {
        let slot = slot as usize;
        self.maxes.get(slot).is_some_and(|max| *max != self.mins[slot])
    }

    fn set_corners(&mut self, slot: u32, [min, max]: [[T; 2]; 2]) -> bool {
        if self.maxes.is_empty() && max != min {
            // The first box of the space. Until then upper corners are the centres, and their
            // column does not exist.
            self.maxes.clone_from(&self.mins);
        }
        let index = slot as usize;
        let mut changed = std::mem::replace(&mut self.mins[index], min) != min;
        if let Some(old) = self.maxes.get_mut(index) {
            changed |= std::mem::replace(old, max) != max;
        }
        changed
    }

    /// Sets the radius of a shape; returns whether that changes it.
    pub(super) fn set_radius(&mut self, slot: u32, radius: T) -> bool {
        std::mem::replace(&mut self.radii[slot as usize], radius) != radius
    }

    fn set_half_size(&mut self, slot: u32, half_size: [T; 2]) -> bool {
        if self.half_sizes.is_empty() {
            if half_size == [T::ZERO; 2] {
                return false;
            }
            self.half_sizes.resize(self.count(), [T::ZERO; 2]);
        }
        std::mem::replace(&mut self.half_sizes[slot as usize], half_size) != half_size
    }

    fn set_core(&mut self, slot: u32, core: Core) -> bool {
        if self.cores.is_empty() {
            if core == Core::Box {
                return false;
            }
            self.cores.resize(self.count(), Core::Box);
        }
        std::mem::replace(&mut self.cores[slot as usize], core) != core
    }

    /// Whether a core may be something else than its box.
    pub(super) fn has_cores(&self) -> bool {
        !self.cores.is_empty()
    }

    /// Sets the category and mask of a shape; returns whether that changes it.
    pub(super) fn set_filter(&mut self, slot: u32, filter: [u32; 2]) -> bool {
        if self.filters.is_empty() {
            if filter == [DEFAULT_CATEGORY, DEFAULT_MASK] {
                return false;
            }
            self.filters.resize(self.count(), [DEFAULT_CATEGORY, DEFAULT_MASK]);
        }
        std::mem::replace(&mut self.filters[slot as usize], filter) != filter
    }

    /// The centre of the shape in `slot`.
    pub(super) fn center(&self, slot: u32) -> [T; 2] {
        let min = self.mins[slot as usize];
        let max = self.maxes.get(slot as usize).copied().unwrap_or(min);
        [0, 1].map(|axis| middle(min[axis], max[axis]))
    }

    /// Whether a shape has, or had, another filter than the default.
    pub(super) fn has_filters(&self) -> bool {
        !self.filters.is_empty()
    }

    /// The category of the shape in `slot`.
    pub(super) fn category(&self, slot: u32) -> u32 {
        self.filters.get(slot as usize).map_or(DEFAULT_CATEGORY, |[category, _]| *category)
    }

    /// The shape in `slot`.
    pub(super) fn shape(&self, slot: u32) -> Shape<T> {
        let slot = slot as usize;
        let [category, mask] =
            self.filters.get(slot).copied().unwrap_or([DEFAULT_CATEGORY, DEFAULT_MASK]);
        Shape {
            min: self.mins[slot],
            max: self.maxes.get(slot).copied().unwrap_or(self.mins[slot]),
            half_size: self.half_sizes.get(slot).copied().unwrap_or([T::ZERO; 2]),
            radius: self.radii[slot],
            category,
            mask,
            core: self.cores.get(slot).copied().unwrap_or_default(),
        }
    }

    /// Replaces the contents of `shapes` by the shapes in `slots`, in that order. A value that all
    /// have in common is stored once, so that a tree does not have to sort a column.
    pub(super) fn gather(&self, slots: &[u32], shapes: &mut Shapes<T>) -> Result<()> {
        let ShapeColumns { centers, radii, half_sizes, boxes, cores, filters } =
            shapes.columns_mut();
        let each = || slots.iter().map(|&slot| slot as usize);
        centers.clear();
        memory::reserve(centers, slots.len())?;
        let mut all = boxes.take().unwrap_or_default();
        let core_of = |slot: usize| self.cores.get(slot).copied().unwrap_or_default();
        let has_cores = !self.cores.is_empty() && each().any(|slot| core_of(slot) != Core::Box);
        if has_cores || slots.iter().any(|&slot| self.is_box(slot)) {
            let max = |slot: usize| self.maxes.get(slot).copied().unwrap_or(self.mins[slot]);
            let sides = |slot: usize| (self.mins[slot], max(slot));
            all.clear();
            memory::reserve(&mut all, slots.len())?;
            all.extend(each().map(sides).map(|(min, max)| [min[0], min[1], max[0], max[1]]));
            centers.extend(all.iter().map(middle_of));
            *boxes = Some(all);
        } else {
            centers.extend(each().map(|slot| self.mins[slot]));
        }
        let mut kept = cores.take().unwrap_or_default();
        if has_cores {
            kept.clear();
            memory::reserve(&mut kept, slots.len())?;
            kept.extend(each().map(core_of));
            *cores = Some(kept);
        }
        put(radii, each().map(|slot| self.radii[slot]))?;
        let mut halves = half_sizes.take().unwrap_or_default();
        if !self.half_sizes.is_empty() {
            put(&mut halves, each().map(|slot| self.half_sizes[slot]))?;
            // A column of zeros would choose the slower kernel for boxes.
            *half_sizes = (halves != Each::One([T::ZERO; 2])).then_some(halves);
        }
        let [mut categories, mut masks] = filters.take().unwrap_or_default();
        if !self.filters.is_empty() {
            put(&mut categories, each().map(|slot| self.filters[slot][0]))?;
            put(&mut masks, each().map(|slot| self.filters[slot][1]))?;
            let open =
                (&categories, &masks) == (&Each::One(DEFAULT_CATEGORY), &Each::One(DEFAULT_MASK));
            *filters = (!open).then_some([categories, masks]);
        }
        Ok(())
    }

    /// Allocated bytes, used or not.
    pub(super) fn memory_bytes(&self) -> usize {
        let corners = self.mins.capacity() + self.maxes.capacity();
        let numbers = 2 * corners + self.radii.capacity();
        let halves = 2 * self.half_sizes.capacity();
        let cores = self.cores.capacity() * size_of::<Core>();
        let words = self.generations.capacity() + self.last_call.capacity() + self.free.capacity();
        (numbers + halves) * size_of::<T>()
            + (words + 2 * self.filters.capacity()) * size_of::<u32>()
            + cores
    }
}

/// Replaces the contents of `to`, by one value if all are equal.
fn put<V: Copy + PartialEq>(
    to: &mut Each<V>,
    mut values: impl ExactSizeIterator<Item = V> + Clone,
) -> Result<()> {
    let all = values.clone();
    if let Some(first) = values.next()
        && values.all(|value| value == first)
    {
        *to = Each::One(first);
        return Ok(());
    }
    let rows = to.rows_mut();
    rows.clear();
    memory::reserve(rows, all.len())?;
    rows.extend(all);
    Ok(())
}

/// Slot and generation of an id; None for a negative number.
fn parts(id: Id) -> Option<(u32, u32)> {
    (id >= 0).then_some((id as u32, (id >> 32) as u32))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn disc(x: f64) -> Shape<f64> {
        let center = [x, 0.0];
        let half_size = [0.0; 2];
        Shape {
            min: center,
            max: center,
            half_size,
            radius: 1.0,
            category: 1,
            mask: u32::MAX,
            core: jostle_index::Core::Box,
        }
    }

    #[test]
    fn a_slot_is_used_again_by_another_id() {
        let mut slots = Slots::default();
        let (first, second) = (slots.put(&disc(0.0)), slots.put(&disc(1.0)));
        assert_eq!([slots.id(first), slots.id(second)], [0, 1]);
        slots.remove(first);
        assert_eq!((slots.slot(0), slots.id(first), slots.len()), (None, 0, 1));
        assert!(slots.are_ids());
        slots.free(first);
        assert!(!slots.are_ids());
        let third = slots.put(&disc(2.0));
        assert_eq!((third, slots.id(third), slots.slot(0)), (first, 1 << 32, None));
    }

    #[test]
    fn a_slot_that_has_run_out_of_ids_is_never_used_again() {
        let mut slots = Slots::default();
        let slot = slots.put(&disc(0.0));
        slots.generations[slot as usize] = VACANT - 1;
        assert_eq!(slots.slot(i64::MAX - i64::from(u32::MAX)), Some(slot));
        slots.remove(slot);
        slots.free(slot);
        assert_eq!(slots.put(&disc(0.0)), 1);
    }

    #[test]
    fn nothing_else_is_an_id() {
        let mut slots = Slots::default();
        let slot = slots.put(&disc(0.0));
        slots.remove(slot);
        for id in [-1, i64::MIN, i64::MAX, 0, 1, 1 << 32] {
            assert_eq!(slots.slot(id), None, "{id}");
        }
    }

    #[test]
    fn a_refusal_tells_what_is_gone_from_what_never_was() {
        let mut slots = Slots::default();
        let slot = slots.put(&disc(0.0));
        assert!(slots.find(&[0, 0]).unwrap_err().to_string().contains("ids[1] is 0; it is given"));
        let told = |slots: &mut Slots<f64>, id| slots.find(&[id]).unwrap_err().to_string();
        assert_eq!(told(&mut slots, 1), "ids[0] is 1; no shape has this id");
        slots.remove(slot);
        assert_eq!(told(&mut slots, 0), "ids[0] is 0; its shape has been removed");
        slots.free(slot);
        assert_eq!(told(&mut slots, 0), "ids[0] is 0; its shape has been removed");
        assert_eq!(told(&mut slots, 1 << 32), "ids[0] is 4294967296; no shape has this id");
    }
}
