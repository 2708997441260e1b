//! Where shapes were at the last update, if they have moved since.

use super::saved::Saved;
use super::slots::Slots;
use jostle_base::error::{Error, Result};
use jostle_base::memory;
use jostle_index::geometry::{Scalar, Shape};
use jostle_index::period::Period;
use jostle_index::shapes::check_finite;

use super::traces::motion;

/// The centre of each shape at the last update, or where it was added since. Only shapes that have moved have one:
/// the others are where they were.
#[derive(Clone, Debug, Default)]
pub(super) struct Starts<T> {
    /// For each slot whether its centre is recorded; may be shorter than the number of slots.
    recorded: Vec<bool>,
    centers: Vec<[T; 2]>,
}

impl<T: Scalar> Starts<T> {
    /// Reserves memory for the motions of shapes in `count` slots.
    pub(super) fn reserve(&mut self, count: usize) -> Result<()> {
        memory::lengthen(&mut self.recorded, count, false)?;
        memory::lengthen(&mut self.centers, count, [T::ZERO; 2])
    }

    /// Records that a shape moves, if it has not moved since the last update; `before` is its centre.
    #[inline(always)]
    pub(super) fn note(&mut self, slot: u32, before: impl FnOnce() -> [T; 2]) {
        // A shape that is set to where it is may keep its record until a later update: as long as it does not
        // move, the record is right.
        if !std::mem::replace(&mut self.recorded[slot as usize], true) {
            self.centers[slot as usize] = before();
        }
    }

    /// Forgets the shape that was in a slot before.
    pub(super) fn start(&mut self, slot: u32) {
        if let Some(recorded) = self.recorded.get_mut(slot as usize) {
            *recorded = false;
        }
    }

    /// Begins the paths of all shapes where they are. `changed` are the slots whose shapes have changed since the
    /// last update, among them all that have moved.
    pub(super) fn clear(&mut self, changed: &[u32]) {
        if changed.len() >= self.recorded.len() {
            self.recorded.fill(false);
        } else {
            changed.iter().for_each(|&slot| self.start(slot));
        }
    }

    /// The centre at which the path of a shape began; None if it has not moved. With a period the centre is that
    /// from which the shortest way leads to the present one, so it may lie outside of the first period.
    pub(super) fn of(&self, slot: u32, slots: &Slots<T>, period: &Period<T>) -> Option<[T; 2]> {
        if self.recorded.get(slot as usize) != Some(&true) {
            return None;
        }
        let (start, now) = (self.centers[slot as usize], slots.center(slot));
        let direct = [0, 1].map(|axis| now[axis] - start[axis]);
        let path = motion(period, start, now);
        // On an axis without a change of period this is the recorded number, to the last bit.
        let first = [0, 1].map(|axis| {
            if path[axis] == direct[axis] { start[axis] } else { now[axis] - path[axis] }
        });
        (first != now).then_some(first)
    }

    /// Allocated bytes, used or not.
    pub(super) fn memory_bytes(&self) -> usize {
        self.recorded.capacity() + self.centers.capacity() * size_of::<[T; 2]>()
    }

    /// Copies the records into saved contents.
    pub(super) fn save(&self, saved: &mut Saved<T>) -> Result<()> {
        let recorded = || (0..).zip(&self.recorded).filter(|(_, recorded)| **recorded);
        saved.moved_since = memory::with_capacity(recorded().count())?;
        saved.moved_since.extend(recorded().map(|(slot, _)| slot));
        saved.starts = memory::with_capacity(saved.moved_since.len())?;
        saved.starts.extend(recorded().map(|(slot, _)| self.centers[slot as usize]));
        Ok(())
    }

    /// The records from the result of [`save`](Self::save). Refuses what no space can have.
    pub(super) fn restore(saved: &Saved<T>, count: usize) -> Result<Self> {
        let exists = |&slot: &u32| (slot as usize) < count;
        if saved.starts.len() != saved.moved_since.len() || !saved.moved_since.iter().all(exists) {
            let rule = "it must be the state of a space, as pickle stores it";
            return Err(Error::of("state", "inconsistent", rule));
        }
        check_finite("state", &saved.starts)?;
        let mut all = Self::default();
        if !saved.starts.is_empty() {
            all.reserve(count)?;
        }
        for (&slot, &start) in saved.moved_since.iter().zip(&saved.starts) {
            all.note(slot, || start);
        }
        Ok(all)
    }
}

/// The shape with its centre somewhere else.
pub(super) fn at<T: Scalar>(shape: &Shape<T>, center: [T; 2]) -> Shape<T> {
    if shape.min == shape.max {
        return Shape { min: center, max: center, ..*shape };
    }
    let now = shape.center();
    shape.moved([0, 1].map(|axis| now[axis] - center[axis]))
}
