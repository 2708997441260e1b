//! What happened since a record began: sums over its steps, and, if that is wanted, which pairs
//! began and ceased to touch.

use std::cmp::Ordering;

use super::bodies::Bodies;
use super::bodies::discs::Discs;
use super::boundaries::Boundaries;
use super::distribution::Distribution;
use super::totals::{Collisions, StepSums, Totals};
use crate::container::FIRST_SIDE;
use crate::surface::MAX_SIDES;
use jostle_base::bytes::{Reader, Saved, Writer, damaged};
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::memory::{self, copy_option};
use jostle_base::plain;

/// No wall has this id; those of sides are below.
const NO_WALL: Id = -1;

/// The least id of a side: that of a round container.
const LAST_SIDE: Id = FIRST_SIDE - MAX_SIDES as Id;

/// Pairs in the list of those that touched before doubles are removed for the first time.
const FEW: usize = 1024;

/// Two things that touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Touched {
    /// Their ids: of two particles, the smaller first, or of a particle and a wall or side.
    pub pair: [Id; 2],
    /// The categories of both, as they were then. One that was removed since has no others.
    pub categories: [u32; 2],
}

plain! { Touched { pair, categories } }

impl Touched {
    /// Two particles in any order.
    pub(crate) fn ascending([a, b]: [Id; 2], [of_a, of_b]: [u32; 2]) -> Self {
        let (pair, categories) =
            if a < b { ([a, b], [of_a, of_b]) } else { ([b, a], [of_b, of_a]) };
        Self { pair, categories }
    }
}

/// Sorted pairs of ids: of two particles, the smaller first, or of a particle and a wall or side.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TouchEvents {
    /// Those that did not touch when the record began, and touched later.
    pub entered: Vec<[Id; 2]>,
    /// Those that touched when it began, and touch at its end.
    pub stayed: Vec<[Id; 2]>,
    /// Those that touched when it began or later, and do not touch at its end.
    pub left: Vec<[Id; 2]>,
    /// The categories of the pairs of each list, in the same order, when they touched last.
    pub categories: [Vec<[u32; 2]>; 3],
}

impl TouchEvents {
    fn new(entered: Vec<Touched>, stayed: Vec<Touched>, left: Vec<Touched>) -> Result<Self> {
        let all = [entered, stayed, left];
        let pairs = |at: usize| memory::collect(all[at].iter().map(|of| of.pair));
        let categories = |at: usize| memory::collect(all[at].iter().map(|of| of.categories));
        Ok(Self {
            entered: pairs(0)?,
            stayed: pairs(1)?,
            left: pairs(2)?,
            categories: [categories(0)?, categories(1)?, categories(2)?],
        })
    }
}

/// What happened in the steps since the record began.
///
/// A step adds to it as it is computed, and [`Record::undo`] takes that away again if the step is repeated or
/// refused.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    pub(super) totals: Totals,
    /// The pairs of particles, of ids, the smaller first.
    pub(crate) pairs: Pairs,
    /// The pairs of a particle and a wall or side, of their ids.
    pub(crate) walls: Pairs,
    /// The old and the new id of each particle that became part of another, by old ids; None if none did.
    merged: Option<Vec<[Id; 2]>>,
    /// Whether there was a step after the end of the record.
    pub(crate) is_open: bool,
    /// Whether no particle has fallen asleep since `at_end` was computed.
    pub(crate) knows_sleepers: bool,
    /// What the step that is computed adds to the totals.
    pub(super) of_step: StepSums,
    /// What had merged when the step began.
    merged_at_begin: Option<Vec<[Id; 2]>>,
    /// The record before, until a step of this one is complete.
    previous: Option<Box<Record>>,
}

/// The pairs that touched.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Pairs {
    /// Those that touched at the end of the record before, sorted, each once.
    before: Vec<Touched>,
    /// Those that touched in a step of this record; some may be listed twice.
    during: Vec<Touched>,
    /// Those that touched at the end of this record, sorted, each once.
    pub(crate) at_end: Vec<Touched>,
    /// In a distributed world, those of them of which a particle was removed since.
    gone: Vec<Touched>,
    /// The length of `during` when doubles were removed.
    distinct: usize,
    /// The length of `during` when the step began.
    len_at_begin: usize,
}

impl Saved for Pairs {
    fn put(&self, to: &mut Writer) {
        // The order of `during` is not that of the state.
        self.before.put(to);
        match self.sorted() {
            Ok(during) => during.put(to),
            Err(error) => to.fail(error),
        }
        self.at_end.put(to);
    }

    fn get(from: &mut Reader<'_>) -> Result<Self> {
        let [before, during, at_end] = [Saved::get(from)?, Saved::get(from)?, Saved::get(from)?];
        Ok(Self { before, during, at_end, ..Self::default() })
    }
}

impl Pairs {
    /// Refuses lists of pairs of which one cannot be, and pairs if no events are tracked.
    fn check(&self, track_events: bool, may_be: impl Fn([Id; 2]) -> bool) -> Result<()> {
        let lists = [&self.before, &self.during, &self.at_end];
        let is_right = |list: &Vec<Touched>| {
            list.iter().all(|of| may_be(of.pair)) && list.is_sorted_by(|a, b| a.pair < b.pair)
        };
        if !lists.iter().all(|list| is_right(list)) {
            return Err(damaged("two things that touched have no ids"));
        }
        if !track_events && lists.iter().any(|list| !list.is_empty()) {
            return Err(damaged("it has events, but tracks none"));
        }
        Ok(())
    }

    /// Those with which the next record begins: those at the end of this one. Until it ends they are those at its end,
    /// too, without those of which one is gone.
    fn next(&self, is_there: impl Fn([Id; 2]) -> bool) -> Result<Self> {
        let (before, mut at_end) = (union(&self.at_end, &self.gone)?, memory::copy(&self.at_end)?);
        at_end.retain(|of| is_there(of.pair));
        Ok(Self { before, at_end, ..Self::default() })
    }

    /// Keeps pairs of which a particle is removed apart.
    pub(crate) fn set_apart(&mut self, is_gone: impl Fn([Id; 2]) -> bool) {
        self.gone.extend(self.at_end.extract_if(.., |of| is_gone(of.pair)));
    }

    /// Adds some that touched in the step.
    pub(crate) fn add(&mut self, pairs: impl Iterator<Item = Touched>) -> Result<()> {
        memory::extend(&mut self.during, pairs)
    }

    /// Ends a step.
    fn end_step(&mut self) {
        // Only a long list is sorted, so that a step costs as much as it adds.
        // Without memory for the copy it stays as it is.
        if self.during.len() > 2 * self.distinct.max(FEW)
            && let Ok(sorted) = self.sorted()
        {
            self.during = sorted;
            self.distinct = self.during.len();
        }
    }

    /// Those that touched in a step, sorted, each once.
    fn sorted(&self) -> Result<Vec<Touched>> {
        let mut during = memory::copy(&self.during)?;
        sort(&mut during);
        Ok(during)
    }

    /// Those at the end of the record before, in a step of this one, and at its end. Several processes of a distributed
    /// world may have the same pair.
    fn touches(&self) -> Result<[Vec<Touched>; 3]> {
        let at_end = union(&self.at_end, &self.gone)?;
        Ok([memory::copy(&self.before)?, memory::copy(&self.during)?, at_end])
    }

    /// Those that began and ceased to touch.
    fn events(&self) -> Result<TouchEvents> {
        // With B before, D during and E at the end: entered = (D ∪ E) \ B, stayed = B ∩ E and left
        // = (B ∪ D) \ E. A pair that has touched in between is both in `entered` and in `left`.
        let during = self.sorted()?;
        let touched = union(&self.at_end, &during)?;
        let [entered, _] = split(&touched, &self.before)?;
        let [_, stayed] = split(&self.at_end, &self.before)?;
        // Of a pair that touched again the categories are those of then.
        let [untouched, _] = split(&self.before, &touched)?;
        let [left, _] = split(&union(&untouched, &touched)?, &self.at_end)?;
        TouchEvents::new(entered, stayed, left)
    }
}

impl Saved for Record {
    fn put(&self, to: &mut Writer) {
        self.totals.put(to);
        self.pairs.put(to);
        self.walls.put(to);
    }

    fn get(from: &mut Reader<'_>) -> Result<Self> {
        let (totals, pairs, walls) = (Saved::get(from)?, Saved::get(from)?, Saved::get(from)?);
        Ok(Self { totals, pairs, walls, ..Self::default() })
    }
}

impl Record {
    /// Refuses pairs that no record of particles and walls with ids below `next` can have, and sums of more than so
    /// many walls.
    pub(crate) fn check(&self, next: [Id; 2], track_events: bool, walls: usize) -> Result<()> {
        self.totals.check(walls)?;
        let [end, end_of_walls] = next;
        let is_wall = |wall| wall < end_of_walls && wall != NO_WALL && wall >= LAST_SIDE;
        self.pairs.check(track_events, |[a, b]| 0 <= a && a < b && b < end)?;
        self.walls.check(track_events, |[a, wall]| 0 <= a && a < end && is_wall(wall))
    }

    /// Sums over its steps.
    pub fn totals(&self) -> &Totals {
        &self.totals
    }

    /// The pairs that touched at the end of the record before, that touched in a step of this one, and that touch at
    /// its end: of particles, and of particles and walls. Several processes of a distributed world may have the same
    /// pair.
    pub fn touches(&self) -> Result<[[Vec<Touched>; 3]; 2]> {
        Ok([self.pairs.touches()?, self.walls.touches()?])
    }

    /// The old and the new id of particles that became part of others; in a distributed world of those that were
    /// own ones then. The new one may have merged since, on another process.
    pub fn merged(&self) -> Option<&[[Id; 2]]> {
        self.merged.as_deref()
    }

    /// The pairs of particles, and of particles and walls, that began and ceased to touch.
    pub(crate) fn events(&self) -> Result<[TouchEvents; 2]> {
        Ok([self.pairs.events()?, self.walls.events()?])
    }

    /// Begins a new record. The pairs at its beginning are those at the end of this one. `is_there` returns
    /// whether a particle exists, `is_wall` whether a wall or side does.
    pub(crate) fn begin(&mut self, [is_there, is_wall]: [&dyn Fn(Id) -> bool; 2]) -> Result<()> {
        let pairs = self.pairs.next(|pair| pair.iter().all(|&id| is_there(id)))?;
        let walls = self.walls.next(|[id, wall]| is_there(id) && is_wall(wall))?;
        // Of several records without a step, only the last may be as before.
        let old = Self { previous: None, ..std::mem::take(self) };
        *self = Self {
            pairs,
            walls,
            is_open: old.is_open,
            knows_sleepers: old.knows_sleepers,
            previous: Some(Box::new(old)),
            ..Self::default()
        };
        Ok(())
    }

    /// Ends it with the pairs of particles, and of particles and walls, that touch now.
    pub(crate) fn end(&mut self, [pairs, walls]: [Vec<Touched>; 2]) {
        (self.pairs.at_end, self.walls.at_end) = (pairs, walls);
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
        copy_option(&mut self.merged_at_begin, self.merged.as_deref())?;
        self.of_step.clear();
        // A step only appends pairs, so their number is enough to remove them again.
        for of in [&mut self.pairs, &mut self.walls] {
            of.len_at_begin = of.during.len();
        }
        Ok(())
    }

    /// Removes what the attempt has added.
    pub(crate) fn undo(&mut self) {
        for of in [&mut self.pairs, &mut self.walls] {
            of.during.truncate(of.len_at_begin);
        }
        self.merged = self.merged_at_begin.take();
    }

    /// Makes room for what the attempt has added, so that [`Record::end_step`] cannot fail.
    pub(crate) fn make_room(&mut self) -> Result<()> {
        self.totals.make_room(&self.of_step)
    }

    /// Ends a step: makes what its last attempt has added final.
    pub(crate) fn end_step(&mut self) {
        self.totals.add(&self.of_step);
        self.is_open = true;
        self.pairs.end_step();
        self.walls.end_step();
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
    let Discs { particles, rows, .. } = &bodies.awake;
    let touched = |indices: [u32; 2]| {
        let indices = indices.map(|index| index as usize);
        let categories = indices.map(|index| particles.filter(index).category);
        halo.known_pair(&bodies.ids, indices.map(|index| rows[index]), categories)
    };
    record.pairs.add(indices.filter_map(touched))
}

/// Adds rows of particles and numbers of walls that touched in the step to the record.
pub(crate) fn record_walls(
    record: &mut Record,
    (bodies, boundaries): (&Bodies, &Boundaries),
    halo: &dyn Distribution,
    touched: impl Iterator<Item = [u32; 2]>,
) -> Result<()> {
    let own = touched.filter(|[row, _]| *row < halo.own_rows());
    record.walls.add(own.map(touched_walls(bodies, boundaries, halo)?))
}

/// What a row of a particle and the number of a wall are as a pair that touched.
pub(crate) fn touched_walls(
    bodies: &Bodies,
    boundaries: &Boundaries,
    halo: &dyn Distribution,
) -> Result<impl Fn([u32; 2]) -> Touched> {
    let category = bodies.categories()?;
    Ok(move |[row, wall]: [u32; 2]| Touched {
        pair: [halo.id_among_all(&bodies.ids, row), boundaries.id_of(wall)],
        categories: [category(row), boundaries.category_of(wall)],
    })
}

/// Sorts pairs, each once. The categories change within a record only if particles merge, and then to a union: the
/// largest are the last ones.
pub(crate) fn sort(all: &mut Vec<Touched>) {
    all.sort_unstable_by(|a, b| b.cmp(a));
    all.dedup_by_key(|of| of.pair);
    all.reverse();
}

/// The pairs of two lists, sorted, each once.
fn union(a: &[Touched], b: &[Touched]) -> Result<Vec<Touched>> {
    let mut all = memory::with_capacity(a.len() + b.len())?;
    all.extend_from_slice(a);
    all.extend_from_slice(b);
    sort(&mut all);
    Ok(all)
}

/// The pairs of a sorted list that are not in another, and those that are.
fn split(all: &[Touched], other: &[Touched]) -> Result<[Vec<Touched>; 2]> {
    // Both lists are sorted, so one pass over them is enough.
    let (mut rest, mut apart, mut common) = (other, Vec::new(), Vec::new());
    for touched in all {
        while let Some((first, others)) = rest.split_first()
            && first.pair.cmp(&touched.pair) == Ordering::Less
        {
            rest = others;
        }
        let is_common = rest.first().is_some_and(|first| first.pair == touched.pair);
        memory::push(if is_common { &mut common } else { &mut apart }, *touched)?;
    }
    Ok([apart, common])
}
