//! Waking: islands that something touches, or that a change concerns, return to the columns that a
//! step works on.
//!
//! A step that would touch sleeping islands is undone, they wake, and it is made anew. So no
//! particle ever meets a sleeping one, and a step does not know about sleeping. What would touch
//! follows from the bounds with which a part of a step begins, and from the histories of
//! the particles that leave them.

use std::cmp::Ordering;

use super::World;
use super::bodies::discs::Discs;
use super::bounds::{FreeDisplacements, rounding};
use crate::contacts::Contact;
use crate::world::bodies::Bodies;
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::table::Table;
use jostle_index::pairs::JoinScratch;
use jostle_index::quadtree::Quadtree;
use jostle_index::shapes::{Shapes, fill_filters};

/// Scratch.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    join: JoinScratch,
    shapes: Shapes<f32>,
    tree: Quadtree<f32>,
    /// The index of each row, as far as it is needed.
    indices: Vec<u32>,
}

/// Stands for no index.
const NONE: u32 = u32::MAX;

impl World {
    /// Whether particles sleep and all others are static, so that a step changes nothing.
    pub(crate) fn is_still(&self) -> bool {
        !self.bodies.asleep.is_empty()
            && self.influences.motors().next().is_none()
            && (0..self.bodies.awake.rows.len()).all(|at| self.bodies.awake.particles.is_static(at))
    }

    /// Whether any particle sleeps, on any process.
    pub(crate) fn any_sleeps(&self) -> bool {
        !self.bodies.asleep.is_empty() || self.halo.agreed().is_some_and(|agreed| agreed.any_sleeps)
    }

    /// Whether moving particles may meet sleeping ones by themselves in `dt` seconds, on any process;
    /// lists the islands of these. The bounds are larger, and depend on other particles.
    pub(crate) fn is_near_sleepers(&mut self, dt: f32) -> Result<bool> {
        if !self.any_sleeps() {
            return Ok(false);
        }
        let Self {
            bodies: Bodies { awake: Discs { particles, rows, .. }, asleep, .. },
            halo,
            scratch,
            settings,
            ..
        } = self;
        let own = halo.own_rows();
        let free = FreeDisplacements::new(settings, &scratch.forces, dt);
        // The radius depends on the particle alone, and not on the speeds of others. Static
        // particles and ghosts touch nothing here: ghosts are tested by their own ranks.
        let radius = |index: u32| {
            let at = index as usize;
            let moves = !particles.is_static(at) && rows[at] < own;
            let most = scratch.max_displacements[at];
            let rounding =
                rounding(particles.positions[at], particles.radii[at], &settings.container);
            moves.then(|| particles.radii[at] + free.within(particles, at, most) + rounding)
        };
        let shared = (&mut scratch.waking.join, &mut scratch.touched);
        asleep.touched(&scratch.tree, radius, settings, shared)?;
        let join = &mut scratch.waking.join;
        let of_others = halo.touch_others(&scratch.tree, &radius, settings, join)?;
        self.note_touched(of_others)
    }

    /// The same at the end of a part of a step, with circles around the particles that have left
    /// their bounds, in the order of time or by position correction.
    pub(crate) fn has_left_bounds_to_sleepers(&mut self) -> Result<bool> {
        if !self.any_sleeps() {
            return Ok(false);
        }
        if !self.find_circles_outside_limits()? {
            return self.note_touched(false);
        }
        let Self { bodies: Bodies { asleep, .. }, halo, scratch, settings, .. } = self;
        let mut tree = std::mem::take(&mut scratch.waking.tree);
        let shared = (&mut scratch.waking.join, &mut scratch.touched);
        // The tree holds the right circles already, so every overlap counts.
        let radius = |_| Some(f32::INFINITY);
        let done = asleep.touched(&tree, radius, settings, shared);
        let join = &mut scratch.waking.join;
        let of_others = done.and_then(|()| halo.touch_others(&tree, &radius, settings, join));
        std::mem::swap(&mut scratch.waking.tree, &mut tree);
        self.note_touched(of_others?)
    }

    /// Builds the tree of circles around the particles of this process that have left their bounds; returns
    /// whether there are any.
    fn find_circles_outside_limits(&mut self) -> Result<bool> {
        let Self {
            bodies: Bodies { awake: Discs { particles, rows, .. }, .. },
            scratch,
            settings,
            halo,
            ..
        } = self;
        let own = halo.own_rows();
        let outside_limits = &mut scratch.events.outside_limits;
        outside_limits.retain(|&(index, _)| rows[index as usize] < own);
        // Position correction moves particles without an event, so the last positions are tested,
        // too.
        for (index, &limit) in scratch.limits.iter().enumerate() {
            let ([x, y], [u, v]) =
                (scratch.motions.position(index as u32), particles.positions[index]);
            let [x, y] = [x - u, y - v].map(f64::from);
            let distance = (x * x + y * y).sqrt();
            if distance > f64::from(limit) {
                outside_limits.push((index as u32, distance));
            }
        }
        if outside_limits.is_empty() {
            return Ok(false);
        }
        let Scratch { shapes, tree, .. } = &mut scratch.waking;
        let index = |&(index, _): &(u32, f64)| index as usize;
        let columns = shapes.columns_mut();
        columns.centers.clear();
        columns.centers.extend(outside_limits.iter().map(|of| particles.positions[index(of)]));
        let radii = columns.radii.rows_mut();
        radii.clear();
        // The distance is rounded to float32; the factor is a reserve for that.
        radii.extend(outside_limits.iter().map(|of| {
            let (position, radius) = (particles.positions[index(of)], particles.radii[index(of)]);
            let rounding = rounding(position, radius, &settings.container);
            radius + of.1 as f32 * 1.000_01 + rounding
        }));
        let filters = if particles.filters.is_empty() { &[][..] } else { &outside_limits[..] };
        let filters = filters.iter().map(|of| particles.filter(index(of)));
        fill_filters(filters, columns.filters);
        tree.rebuild_unchecked(shapes, settings.tree, &|_, _| Ordering::Equal)?;
        Ok(true)
    }

    /// Notes whether the step would touch any islands of any process: those listed, or some `of_others`.
    fn note_touched(&mut self, of_others: bool) -> Result<bool> {
        // All ranks must repeat the attempt, also those that meet no sleeper.
        let any = of_others || !self.scratch.touched.is_empty();
        self.scratch.meets_sleepers = self.halo().any(any)?;
        Ok(self.scratch.meets_sleepers)
    }

    /// Wakes islands.
    pub(crate) fn wake(&mut self, islands: &[u32]) {
        if islands.is_empty() {
            return;
        }
        let total = self.len();
        self.halo.protocol().recall_contacts(self, islands);
        let woken = self.bodies.asleep.wake(islands);
        let first = self.bodies.awake.rows.len();
        let Discs { particles, rows, persistent } = &woken.discs;
        let len = first + rows.len();
        // At the end of the columns: the tree of the next attempt sorts them, so no result depends
        // on it.
        self.bodies.awake.particles.extend(particles);
        self.bodies.awake.rows.extend_from_slice(rows);
        self.bodies.awake.persistent.append(first, persistent, rows.len());
        self.bodies.forget_indices();
        self.wall_impulses.extend_from_slice(&woken.wall_impulses);
        self.wall_impulses.sort_by_key(|of| (of.row, of.wall));
        // Contacts are with each other or with immovable particles.
        let (rows, movable) = (&self.bodies.awake.rows, &self.bodies.awake.particles.movable);
        let named = || (0..len).filter(|&index| index >= first || !movable[index]);
        let indices = &mut self.scratch.waking.indices;
        indices.resize(total.max(indices.len()), NONE);
        named().for_each(|index| indices[rows[index] as usize] = index as u32);
        let contacts = woken.contacts.iter().map(|contact| Contact {
            indices: contact.indices.map(|row| indices[row as usize]),
            ..*contact
        });
        self.contacts.insert(contacts, len);
        named().for_each(|index| indices[rows[index] as usize] = NONE);
    }

    /// Wakes all islands.
    pub(crate) fn wake_all(&mut self) {
        self.wake_every_island();
        self.forget_woken();
    }

    /// The same, in a step that may fail.
    pub(crate) fn wake_every_island(&mut self) {
        let all: Vec<u32> = self.bodies.asleep.islands().collect();
        self.wake(&all);
    }

    /// Wakes the islands that touch one of some rows or have a spring to it: immovable particles of
    /// which only the velocities have changed.
    pub(crate) fn wake_driven(&mut self, rows: &mut [u32]) {
        if self.bodies.asleep.is_empty() || rows.is_empty() {
            return;
        }
        rows.sort_unstable();
        let mut islands = self.bodies.asleep.islands_touching(rows);
        let is_driven = |row: &Id| rows.binary_search(&(*row as u32)).is_ok();
        let all = self.influences.springs().flat_map(|springs| &springs.0);
        let tied = all.map(|spring| spring.pair).filter(|pair| pair.iter().any(is_driven));
        let tied: Vec<u32> = tied.flatten().map(|row| row as u32).collect();
        let awake = self.bodies.awake.rows.len();
        let sleeping = self.bodies.indices_of(&tied);
        // The indices of sleeping particles come after those of all that are awake.
        let sleeping = sleeping.iter().filter_map(|&index| (index as usize).checked_sub(awake));
        islands.extend(self.bodies.asleep.islands_of(sleeping));
        islands.sort_unstable();
        islands.dedup();
        self.wake_to_stay(&islands);
    }

    /// Wakes the islands of some rows; all if one of these is immovable.
    pub(crate) fn wake_changed(&mut self, rows: &[u32]) {
        if self.bodies.asleep.is_empty() {
            return;
        }
        let (indices, awake) = (self.bodies.indices_of(rows), self.bodies.awake.rows.len());
        let movable = &self.bodies.awake.particles.movable;
        // It is not known which islands rest on an immovable particle, or will overlap it where it
        // goes.
        if indices.iter().any(|&index| movable.get(index as usize) == Some(&false)) {
            return self.wake_all();
        }
        let sleeping = indices.iter().filter_map(|&index| (index as usize).checked_sub(awake));
        let islands = self.bodies.asleep.islands_of(sleeping);
        self.wake_to_stay(&islands);
    }

    /// Wakes islands between two steps.
    pub(crate) fn wake_to_stay(&mut self, islands: &[u32]) {
        self.wake(islands);
        self.forget_woken();
    }

    /// Makes waking final.
    pub(crate) fn forget_woken(&mut self) {
        self.bodies.asleep.forget_woken();
        self.halo.protocol().drop_contacts(self);
        self.bodies.forget_indices();
    }

    /// Removes the impulses of walls on some rows.
    pub(crate) fn drop_wall_impulses(&mut self, mut rows: Vec<u32>) {
        rows.sort_unstable();
        self.wall_impulses.retain(|of| rows.binary_search(&of.row).is_err());
    }

    /// Puts the islands to sleep again that were woken for a step that failed.
    pub(crate) fn cancel_waking(&mut self) {
        let woken = self.bodies.asleep.woken_rows();
        if woken.is_empty() {
            return;
        }
        let is_asleep = |row: &u32| woken.binary_search(row).is_ok();
        let keep: Vec<bool> = self.bodies.awake.rows.iter().map(|row| !is_asleep(row)).collect();
        self.drop_wall_impulses(woken);
        self.keep(&keep);
        self.bodies.asleep.cancel_waking();
        self.bodies.forget_indices();
    }
}
