//! What happened since a record began: sums over its steps, and, if that is wanted, which pairs
//! began and ceased to touch.

use std::cmp::Ordering;

use super::bodies::Bodies;
use super::distribution::Distribution;
use super::totals::{Collisions, StepSums, Totals};
use jostle_base::bytes::{Reader, Saved, Writer, damaged};
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::memory::{self, copy_option};

/// Pairs in the list of those that touched before doubles are removed for the first time.
const FEW: usize = 1024;

/// Pairs of ids, the smaller first, sorted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TouchEvents {
    /// Those that did not touch when the record began, and touched later.
    pub entered: Vec<[Id; 2]>,
    /// Those that touched when it began, and touch at its end.
    pub stayed: Vec<[Id; 2]>,
    /// Those that touched when it began or later, and do not touch at its end.
    pub left: Vec<[Id; 2]>,
}

/// What happened in the steps since the record began.
///
/// A step adds to it as it is computed, and [`Record::undo`] takes that away again if the step is repeated or
/// refused. All lists of pairs are of ids, the smaller first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    pub(super) totals: Totals,
    /// The pairs that touched at the end of the record before, sorted.
    pub(crate) before: Vec<[Id; 2]>,
    /// The pairs that touched in a step of this record; some may be listed twice.
    during: Vec<[Id; 2]>,
    /// Those that touched at the end of this record, sorted.
    pub(crate) at_end: Vec<[Id; 2]>,
    /// In a distributed world, those of them of which a particle was removed since.
    pub(crate) gone: Vec<[Id; 2]>,
    /// The old and the new id of each particle that became part of another, by old ids; None if none did.
    merged: Option<Vec<[Id; 2]>>,
    /// The length of `during` when doubles were removed.
    distinct: usize,
    /// Whether there was a step after the end of the record.
    pub(crate) is_open: bool,
    /// Whether no particle has fallen asleep since `at_end` was computed.
    pub(crate) knows_sleepers: bool,
    /// What the step that is computed adds to the totals.
    pub(super) of_step: StepSums,
    /// The length of `during`, and what had merged, when the step began.
    at_begin: (usize, Option<Vec<[Id; 2]>>),
    /// The record before, until a step of this one is complete.
    previous: Option<Box<Record>>,
}

impl Saved for Record {
    fn put(&self, to: &mut Writer) {
        self.totals.put(to);
        // The order of `during` is not that of the state.
        self.before.put(to);
        match self.sorted() {
            Ok(during) => during.put(to),
            Err(error) => to.fail(error),
        }
        self.at_end.put(to);
    }

    fn get(from: &mut Reader<'_>) -> Result<Self> {
        let totals = Saved::get(from)?;
        let [before, during, at_end] = [Saved::get(from)?, Saved::get(from)?, Saved::get(from)?];
        Ok(Self { totals, before, during, at_end, ..Self::default() })
    }
}

impl Record {
    /// Refuses pairs that no record of particles with ids below `next` can have, and sums of more than so many walls.
    pub(crate) fn check(&self, next: Id, track_events: bool, walls: usize) -> Result<()> {
        self.totals.check(walls)?;
        let lists = [&self.before, &self.during, &self.at_end];
        let is_pair = |&[a, b]: &[Id; 2]| 0 <= a && a < b && b < next;
        let is_right =
            |list: &Vec<[Id; 2]>| list.iter().all(is_pair) && list.is_sorted_by(|a, b| a < b);
        if !lists.iter().all(|list| is_right(list)) {
            return Err(damaged("two particles that touched have no ids"));
        }
        if !track_events && lists.iter().any(|list| !list.is_empty()) {
            return Err(damaged("it has events, but tracks none"));
        }
        Ok(())
    }

    /// Sums over its steps.
    pub fn totals(&self) -> &Totals {
        &self.totals
    }

    /// The pairs that touched at the end of the record before, that touched in a step of this one, and that touch at
    /// its end. Several processes of a distributed world may have the same pair.
    pub fn touches(&self) -> Result<[Vec<[Id; 2]>; 3]> {
        let at_end = union(&self.at_end, &self.gone)?;
        Ok([memory::copy(&self.before)?, memory::copy(&self.during)?, at_end])
    }

    /// The old and the new id of particles that became part of others; in a distributed world of those that were
    /// own ones then. The new one may have merged since, on another process.
    pub fn merged(&self) -> Option<&[[Id; 2]]> {
        self.merged.as_deref()
    }

    /// The pairs that began and ceased to touch.
    pub(crate) fn events(&self) -> Result<TouchEvents> {
        // With B before, D during and E at the end: entered = (D ∪ E) \ B, stayed = B ∩ E and left
        // = (B ∪ D) \ E. A pair that has touched in between is both in `entered` and in `left`.
        let during = self.sorted()?;
        let touched = union(&self.at_end, &during)?;
        let [entered, _] = split(&touched, &self.before)?;
        let [_, stayed] = split(&self.before, &self.at_end)?;
        let [left, _] = split(&union(&self.before, &touched)?, &self.at_end)?;
        Ok(TouchEvents { entered, stayed, left })
    }

    /// The pairs that touched in a step, sorted, without doubles.
    pub(crate) fn sorted(&self) -> Result<Vec<[Id; 2]>> {
        let mut during = memory::copy(&self.during)?;
        during.sort_unstable();
        during.dedup();
        Ok(during)
    }

    /// Begins a new record. The pairs at its beginning are those at the end of this one. Until it ends they are those at
    /// its end, too, without the pairs of which a particle is gone.
    pub(crate) fn begin(&mut self, is_there: impl Fn(&[Id; 2]) -> bool) -> Result<()> {
        let (before, mut at_end) = (union(&self.at_end, &self.gone)?, memory::copy(&self.at_end)?);
        at_end.retain(is_there);
        // Of several records without a step, only the last may be as before.
        let old = Self { previous: None, ..std::mem::take(self) };
        *self = Self {
            before,
            at_end,
            is_open: old.is_open,
            knows_sleepers: old.knows_sleepers,
            previous: Some(Box::new(old)),
            ..Self::default()
        };
        Ok(())
    }

    /// Ends it with the pairs that touch now.
    pub(crate) fn end(&mut self, touching: Vec<[Id; 2]>) {
        self.at_end = touching;
        self.is_open = false;
        self.knows_sleepers = true;
    }

    /// Forgets all pairs.
    pub(crate) fn forget_pairs(&mut self) {
        let (totals, merged) = (std::mem::take(&mut self.totals), self.merged.take());
        *self = Self { totals, merged, ..Self::default() };
    }

    /// Begins an attempt at a step.
    pub(crate) fn begin_attempt(&mut self) -> Result<()> {
        copy_option(&mut self.at_begin.1, self.merged.as_deref())?;
        self.of_step.clear();
        // A step only appends pairs, so their number is enough to remove them again.
        self.at_begin.0 = self.during.len();
        Ok(())
    }

    /// Removes what the attempt has added.
    pub(crate) fn undo(&mut self) {
        self.during.truncate(self.at_begin.0);
        self.merged = self.at_begin.1.take();
    }

    /// Makes room for what the attempt has added, so that [`Record::end_step`] cannot fail.
    pub(crate) fn make_room(&mut self) -> Result<()> {
        self.totals.make_room(&self.of_step)
    }

    /// Ends a step: makes what its last attempt has added final.
    pub(crate) fn end_step(&mut self) {
        self.totals.add(&self.of_step);
        self.is_open = true;
        // Only a long list is sorted, so that a step costs as much as it adds.
        // Without memory for the copy it stays as it is.
        if self.during.len() > 2 * self.distinct.max(FEW)
            && let Ok(sorted) = self.sorted()
        {
            self.during = sorted;
            self.distinct = self.during.len();
        }
    }

    /// Ends a step in which nothing moved. Pairs of particles that fell asleep since `at_end` are not in it.
    pub(crate) fn skip_step(&mut self) {
        self.is_open |= !self.knows_sleepers;
    }

    /// Called after each step of `dt` seconds: if the first one of this record fails, the record is as before it began.
    pub(crate) fn keep_or_cancel(&mut self, is_done: bool, dt: f64) {
        if is_done {
            self.totals.duration += dt;
            self.totals.steps = self.totals.steps.saturating_add(1);
        }
        if let Some(previous) = self.previous.take()
            && !is_done
        {
            *self = *previous;
        }
    }

    /// Adds pairs that touched in the step.
    pub(crate) fn add_pairs(&mut self, pairs: impl Iterator<Item = [Id; 2]>) -> Result<()> {
        memory::extend(&mut self.during, pairs)
    }

    /// Collisions of the step that is computed.
    pub(crate) fn of_step(&self) -> Collisions {
        self.of_step.collisions
    }

    /// Adds that particles merged: the old id and the new one of each, by old ids.
    pub(crate) fn add_merged(&mut self, new: Vec<[Id; 2]>) -> Result<()> {
        let all = self.merged.get_or_insert_default();
        memory::reserve(all, new.len())?;
        // What had become part of a particle that merged now is part of its heir.
        for [_, heir] in &mut *all {
            if let Ok(at) = new.binary_search_by_key(heir, |&[old, _]| old) {
                *heir = new[at][1];
            }
        }
        all.extend(new);
        Ok(())
    }

    /// Removes what merged particles became if that is removed.
    pub(crate) fn drop_merged(&mut self, is_there: impl Fn(Id) -> bool) {
        if let Some(all) = &mut self.merged {
            all.retain(|&[_, heir]| is_there(heir));
        }
    }
}

/// Adds pairs of indices that touched in the step to the record, if events are tracked.
pub(crate) fn record_pairs(
    record: &mut Record,
    bodies: &Bodies,
    halo: &dyn Distribution,
    indices: impl Iterator<Item = [u32; 2]>,
) -> Result<()> {
    let rows = |indices: [u32; 2]| indices.map(|index| bodies.awake.rows[index as usize]);
    record.add_pairs(indices.map(rows).filter_map(|rows| halo.known_pair(&bodies.ids, rows)))
}

/// The pairs of two sorted lists, without doubles.
fn union(a: &[[Id; 2]], b: &[[Id; 2]]) -> Result<Vec<[Id; 2]>> {
    let mut all = memory::with_capacity(a.len() + b.len())?;
    all.extend_from_slice(a);
    all.extend_from_slice(b);
    all.sort_unstable();
    all.dedup();
    Ok(all)
}

/// The pairs of a sorted list that are not in another, and those that are.
fn split(all: &[[Id; 2]], other: &[[Id; 2]]) -> Result<[Vec<[Id; 2]>; 2]> {
    // Both lists are sorted, so one pass over them is enough.
    let (mut rest, mut apart, mut common) = (other, Vec::new(), Vec::new());
    for pair in all {
        while let Some((first, others)) = rest.split_first()
            && first.cmp(pair) == Ordering::Less
        {
            rest = others;
        }
        let is_common = rest.first() == Some(pair);
        memory::push(if is_common { &mut common } else { &mut apart }, *pair)?;
    }
    Ok([apart, common])
}
