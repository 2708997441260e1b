//! What happened since a record began: the number of collisions, and, if that is wanted, which pairs
//! began and ceased to touch.

use std::cmp::Ordering;

use super::World;
use jostle_base::error::Result;
use jostle_base::ids::Id;

/// Pairs in the list of those that touched before doubles are removed for the first time.
const FEW: usize = 1024;

/// Impacts with an impulse, in the order of time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Collisions {
    /// Those of two particles.
    pub pairs: u64,
    /// Those of a particle and a wall or the container.
    pub walls: u64,
}

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

/// The record of a world. All lists are of pairs of ids, the smaller first.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Record {
    pub(crate) collisions: Collisions,
    /// The pairs that touched at the end of the record before, sorted.
    pub(crate) before: Vec<[Id; 2]>,
    /// The pairs that touched in a step of this record; some may be listed twice.
    pub(crate) during: Vec<[Id; 2]>,
    /// Those that touched at the end of this record, sorted.
    pub(crate) at_end: Vec<[Id; 2]>,
    /// In a distributed world, those of them of which a particle was removed since.
    pub(crate) gone: Vec<[Id; 2]>,
    /// The length of `during` when doubles were removed.
    pub(crate) distinct: usize,
    /// Whether there was a step after the end of the record.
    pub(crate) is_open: bool,
    /// Whether no particle has fallen asleep since `at_end` was computed.
    pub(crate) knows_sleepers: bool,
}

impl Record {
    /// Removes doubles from the pairs that touched if there may be many.
    fn shorten(&mut self) {
        if self.during.len() > 2 * self.distinct.max(FEW) {
            self.sort();
        }
    }

    fn sort(&mut self) {
        self.during.sort_unstable();
        self.during.dedup();
        self.distinct = self.during.len();
    }

    /// Forgets all pairs.
    pub(crate) fn forget_pairs(&mut self) {
        *self = Self { collisions: self.collisions, ..Self::default() };
    }

    fn events(&self) -> TouchEvents {
        let mut during = self.during.clone();
        during.sort_unstable();
        let touched = union(&self.at_end, &during);
        TouchEvents {
            entered: split(&touched, &self.before).0,
            stayed: split(&self.before, &self.at_end).1,
            left: split(&union(&self.before, &touched), &self.at_end).0,
        }
    }
}

impl World {
    /// Begins a new record, which contains no collisions. The pairs that touch at its beginning
    /// are those at the end of the record before. [`World::renumbered`] begins anew, too. If its first
    /// step fails, both are as before.
    pub fn begin_record(&mut self) {
        let old = std::mem::take(&mut self.record);
        // In a distributed world, pairs of removed particles are apart.
        let is_whole = self.halo.is_whole();
        let is_there = |pair: &[Id; 2]| !is_whole || pair.iter().all(|&id| self.contains(id));
        self.record = Record {
            before: union(&old.at_end, &old.gone),
            at_end: old.at_end.iter().copied().filter(is_there).collect(),
            is_open: old.is_open,
            knows_sleepers: old.knows_sleepers,
            ..Record::default()
        };
        self.scratch.record_before = Some((old, self.renumbered.take()));
    }

    /// Finds the pairs that touch at the end of the record, if events are tracked. The record may be
    /// continued.
    pub fn end_record(&mut self) -> Result<()> {
        if self.settings.track_events && self.record.is_open {
            self.record.at_end = self.touching()?;
            self.record.is_open = false;
            self.record.knows_sleepers = true;
        }
        Ok(())
    }

    /// The number of collisions since the record began.
    pub fn collisions(&self) -> Collisions {
        self.record.collisions
    }

    /// The pairs that began and ceased to touch between the beginning and the end of the record;
    /// None if events are not tracked.
    pub fn events(&self) -> Option<TouchEvents> {
        self.settings.track_events.then(|| self.record.events())
    }

    /// Of a distributed world: the pairs with own particles that touched at the end of the record before,
    /// that touched in a step of this one, and that touch at its end. Several processes may have the same pair.
    pub fn own_touches(&self) -> [Vec<[Id; 2]>; 3] {
        let Record { before, during, at_end, gone, .. } = &self.record;
        [before.clone(), during.clone(), union(at_end, gone)]
    }

    /// Adds the pairs that touched in a step that is complete, apart from `fall_asleep`.
    pub(crate) fn record_touching(&mut self) {
        if !self.settings.track_events {
            return;
        }
        let indices: Vec<[u32; 2]> =
            self.contacts.touching().map(|contact| contact.indices).collect();
        self.record_pairs(&indices);
    }

    /// Adds pairs of indices that touched in the step, if events are tracked.
    pub(crate) fn record_pairs(&mut self, indices: &[[u32; 2]]) {
        if !self.settings.track_events {
            return;
        }
        let rows = |indices: &[u32; 2]| indices.map(|index| self.rows[index as usize]);
        let pairs = indices.iter().map(rows).filter_map(|rows| self.known_pair(rows));
        let pairs: Vec<[Id; 2]> = pairs.collect();
        self.record.during.extend(pairs);
    }

    /// The ids of two rows, the smaller first; none of two ghosts, whose own processes know them.
    pub(crate) fn known_pair(&self, rows: [u32; 2]) -> Option<[Id; 2]> {
        let is_known = rows.iter().any(|&row| row < self.halo.own_rows());
        let [a, b] = rows.map(|row| self.id_among_all(row));
        is_known.then_some([a.min(b), a.max(b)])
    }

    /// Makes what a step has recorded final.
    pub(crate) fn close_step(&mut self) {
        let Collisions { pairs, walls } = self.scratch.collisions;
        let all = &mut self.record.collisions;
        all.pairs = all.pairs.saturating_add(pairs);
        all.walls = all.walls.saturating_add(walls);
        self.record.is_open = true;
        self.record.shorten();
    }
}

/// The pairs of two sorted lists, without doubles.
fn union(a: &[[Id; 2]], b: &[[Id; 2]]) -> Vec<[Id; 2]> {
    let mut all = [a, b].concat();
    all.sort();
    all.dedup();
    all
}

/// The pairs of a sorted list that are not in another, and those that are.
fn split(all: &[[Id; 2]], other: &[[Id; 2]]) -> (Vec<[Id; 2]>, Vec<[Id; 2]>) {
    let mut rest = other;
    all.iter().partition(|pair| {
        while let Some((first, others)) = rest.split_first()
            && first.cmp(pair) == Ordering::Less
        {
            rest = others;
        }
        rest.first() != Some(pair)
    })
}
