//! Where shapes were before they moved, so that a shape that slides meets obstacles along the
//! motions that they have made since its own last motion, and not only where they are.
//!
//! Each shape has one record: its centre before its first motion after a call of
//! [`Space::move_and_slide`](super::Space::move_and_slide), and the number of that call. Motions
//! between two calls count as one.

use std::mem;

use super::saved::Saved;
use super::slots::Slots;
use jostle_base::error::{Error, Result};
use jostle_base::memory;
use jostle_index::geometry::{Core, Scalar, Shape};
use jostle_index::period::Period;
use jostle_index::shapes::check_finite;

/// The number of a call of `move_and_slide`, from 1; 0 is before all.
pub(crate) type CallNumber = i64;

/// The records of all slots. Columns may be shorter than the number of slots; the rest is 0.
#[derive(Clone, Debug)]
pub(crate) struct Traces<T> {
    /// The number of the next call.
    next: CallNumber,
    /// For each slot, the call after that in which its shape slid last, or before which it was
    /// added.
    slid: Vec<CallNumber>,
    /// For each slot, the call before which, or in which, its recorded motion began; 0 if it has
    /// none.
    moved: Vec<CallNumber>,
    /// For each slot, the centre before the recorded motion.
    before: Vec<[T; 2]>,
    /// The slots in the order of `moved`; those that have moved again since are out of date.
    log: Vec<(CallNumber, u32)>,
}

impl<T> Default for Traces<T> {
    fn default() -> Self {
        let (slid, moved, before, log) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { next: 1, slid, moved, before, log }
    }
}

impl<T: Scalar> Traces<T> {
    /// Reserves memory for `more` motions of shapes in `count` slots.
    pub(crate) fn reserve(&mut self, more: usize, count: usize) -> Result<()> {
        memory::lengthen(&mut self.moved, count, 0)?;
        memory::lengthen(&mut self.before, count, [T::ZERO; 2])?;
        // At most one entry of each slot is current, so without the others at most half of the
        // limit is left. So a removal comes once in as many motions as it has entries to visit, up
        // to a constant.
        if self.log.len() + more > 2 * count {
            let moved = &self.moved;
            self.log.retain(|&(call, slot)| moved[slot as usize] == call);
        }
        memory::reserve(&mut self.log, more)
    }

    /// Records that a shape moves, if it has not moved since the last call; `before` is its centre.
    #[inline(always)]
    pub(crate) fn note(&mut self, slot: u32, before: impl FnOnce() -> [T; 2]) {
        let moved = &mut self.moved[slot as usize];
        // Only the first motion after a call is recorded: all motions until the next call count as
        // one, from the first place to the last.
        if *moved != self.next {
            *moved = self.next;
            self.before[slot as usize] = before();
            self.log.push((self.next, slot));
        }
    }

    /// Deletes what is known of the shape that was in a slot before.
    pub(crate) fn start(&mut self, slot: u32) {
        if let Some(moved) = self.moved.get_mut(slot as usize) {
            *moved = 0;
        }
        if let Some(slid) = self.slid.get_mut(slot as usize) {
            *slid = self.next;
        }
    }

    /// Reserves memory for a call.
    pub(crate) fn begin_call(&mut self, walkers: usize, count: usize) -> Result<()> {
        memory::lengthen(&mut self.slid, count, 0)?;
        self.reserve(walkers, count)
    }

    /// Ends a call in which these shapes have slid; their motions are recorded.
    pub(crate) fn end_call(&mut self, walkers: &[u32]) {
        self.next += 1;
        walkers.iter().for_each(|&slot| self.slid[slot as usize] = self.next);
    }

    /// The call after that in which a shape slid last.
    pub(crate) fn since(&self, slot: u32) -> CallNumber {
        self.slid[slot as usize]
    }

    /// The centre that a shape had at the beginning of this call, if it has moved since.
    #[inline(always)]
    pub(crate) fn before(&self, slot: u32, since: CallNumber) -> Option<[T; 2]> {
        let moved = *self.moved.get(slot as usize)?;
        (moved >= since && moved > 0).then(|| self.before[slot as usize])
    }

    /// The slots that have moved since the beginning of a call.
    pub(crate) fn moved_since(&self, since: CallNumber) -> impl Iterator<Item = u32> {
        // Calls are logged in ascending order, so those since any call are the end of the log.
        // Walkers that move in each call never look further back than one call, however long the
        // log is.
        let first = self.log.partition_point(|&(call, _)| call < since);
        let current = |&&(call, slot): &&(CallNumber, u32)| self.moved[slot as usize] == call;
        self.log[first..].iter().filter(current).map(|&(_, slot)| slot)
    }

    /// Allocated bytes, used or not.
    pub(crate) fn memory_bytes(&self) -> usize {
        (self.slid.capacity() + self.moved.capacity()) * size_of::<CallNumber>()
            + self.before.capacity() * size_of::<[T; 2]>()
            + self.log.capacity() * size_of::<(CallNumber, u32)>()
    }

    /// Copies the records into saved contents.
    pub(crate) fn save(&self, saved: &mut Saved<T>) -> Result<()> {
        saved.calls = self.next;
        saved.slid = memory::collect(self.slid.iter().copied())?;
        saved.moved = memory::collect(self.moved.iter().copied())?;
        saved.before = memory::collect(self.before.iter().copied())?;
        Ok(())
    }

    /// The records from the result of [`save`](Self::save). Refuses what no space can have.
    pub(crate) fn restore(saved: &mut Saved<T>, count: usize) -> Result<Self> {
        let next = saved.calls;
        let fits = |calls: &[CallNumber]| {
            calls.len() <= count && calls.iter().all(|call| (0..=next).contains(call))
        };
        if next < 1
            || !fits(&saved.slid)
            || !fits(&saved.moved)
            || saved.before.len() != saved.moved.len()
        {
            let rule = "it must be the state of a space, as pickle stores it";
            return Err(Error::of("state", "inconsistent", rule));
        }
        check_finite("state", &saved.before)?;
        let mut log = memory::with_capacity(saved.moved.len())?;
        log.extend(saved.moved.iter().copied().zip(0..).filter(|&(call, _)| call > 0));
        log.sort_unstable();
        let (slid, moved) = (mem::take(&mut saved.slid), mem::take(&mut saved.moved));
        Ok(Self { next, slid, moved, before: mem::take(&mut saved.before), log })
    }
}

/// A box around all positions of a shape during a motion that has brought it to where it is.
pub(crate) fn swept<T: Scalar>(slots: &Slots<T>, slot: u32, motion: [T; 2]) -> Shape<T> {
    let shape = slots.shape(slot);
    let extent = |axis: usize| shape.half_size[axis] + shape.radius;
    let low = |axis: usize| shape.min[axis] - extent(axis) - motion[axis].max(T::ZERO);
    let high = |axis: usize| shape.max[axis] + extent(axis) - motion[axis].min(T::ZERO);
    let (min, max) = ([low(0), low(1)], [high(0), high(1)]);
    let core = Core::Box;
    Shape { min, max, half_size: [T::ZERO; 2], radius: T::ZERO, core, ..shape }
}

/// The motion that has brought a shape from one centre to another: the minimum image of their
/// difference; 0 if that is longer than any displacement of a call may be.
pub(crate) fn motion<T: Scalar>(period: &Period<T>, before: [T; 2], now: [T; 2]) -> [T; 2] {
    let [x, y] = period.minimum_image([now[0] - before[0], now[1] - before[1]]);
    // A shape that has been put somewhere else across the world has not swept what is between.
    let most = T::RADII[1];
    if x.abs() <= most && y.abs() <= most { [x, y] } else { [T::ZERO; 2] }
}
