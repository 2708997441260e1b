//! Waking: islands that something touches, or that a change concerns, return to the columns that a
//! step works on.
//!
//! A step that would touch sleeping islands is undone, they wake, and it is made anew. So no
//! particle ever meets a sleeping one, and a step does not know about sleeping. What would touch
//! follows from the bounds with which a part of a step begins, and from the histories of
//! the particles that leave them.

use std::cmp::Ordering;

use super::World;
use super::bounds::rounding;
use super::discs::Discs;
use crate::contacts::Contact;
use crate::error::Result;
use crate::forces;
use crate::pairs::JoinScratch;
use crate::quadtree::Quadtree;
use crate::shapes::{Shapes, fill_filters};
use crate::table::Table;

/// Scratch.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    join: JoinScratch,
    shapes: Shapes<f32>,
    tree: Quadtree<f32>,
    /// The place of each row, as far as it is needed.
    places: Vec<u32>,
}

/// Stands for no place.
const NONE: u32 = u32::MAX;

impl World {
    /// Whether particles sleep and all others are static, so that a step changes nothing.
    pub(super) fn is_still(&self) -> bool {
        !self.asleep.is_empty()
            && forces::motors(&self.forces).next().is_none()
            && (0..self.rows.len()).all(|at| self.particles.is_static(at))
    }

    /// Whether the bounds of moving particles overlap sleeping ones; lists the islands of these.
    pub(super) fn is_near_sleepers(&mut self) -> Result<bool> {
        if self.asleep.is_empty() {
            return Ok(false);
        }
        let Self { asleep, particles, memory, settings, .. } = self;
        let moves = |place: u32| !particles.is_static(place as usize);
        let scratch = (&mut memory.waking.join, &mut memory.touched);
        asleep.touched(&memory.tree, moves, settings, scratch)?;
        Ok(!memory.touched.is_empty())
    }

    /// The same at the end of a part of a step, with circles around the particles that have left
    /// their bounds, in the order of time or by position correction.
    pub(super) fn has_left_bounds_to_sleepers(&mut self) -> Result<bool> {
        let Self { asleep, particles, memory, settings, .. } = self;
        let outside_limits = &mut memory.events.outside_limits;
        for (place, &limit) in memory.limits.iter().enumerate() {
            let ([x, y], [u, v]) =
                (memory.motions.position(place as u32), particles.positions[place]);
            let distance = f64::from(x - u).hypot(f64::from(y - v));
            if distance > f64::from(limit) {
                outside_limits.push((place as u32, distance));
            }
        }
        if outside_limits.is_empty() {
            return Ok(false);
        }
        let super::waking::Scratch { join, shapes, tree, .. } = &mut memory.waking;
        let place = |&(place, _): &(u32, f64)| place as usize;
        shapes.centers.clear();
        shapes.centers.extend(outside_limits.iter().map(|of| particles.positions[place(of)]));
        let radii = shapes.radii.rows_mut();
        radii.clear();
        radii.extend(outside_limits.iter().map(|of| {
            let rounding = rounding(particles.positions[place(of)], &settings.container);
            particles.radii[place(of)] + of.1 as f32 * 1.000_01 + rounding
        }));
        let filters = if particles.filters.is_empty() { &[][..] } else { &outside_limits[..] };
        let filters = filters.iter().map(|of| particles.filter(place(of)));
        fill_filters(filters, &mut shapes.filters);
        tree.rebuild_unchecked(shapes, settings.tree, &|_, _| Ordering::Equal)?;
        asleep.touched(tree, |_| true, settings, (join, &mut memory.touched))?;
        Ok(!memory.touched.is_empty())
    }

    /// Wakes islands.
    pub(super) fn wake(&mut self, islands: &[u32]) {
        if islands.is_empty() {
            return;
        }
        let total = self.len();
        let woken = self.asleep.wake(islands);
        let first = self.rows.len();
        let Discs { particles, rows, persistent } = &woken.discs;
        let len = first + rows.len();
        self.particles.extend(particles);
        self.rows.extend_from_slice(rows);
        self.persistent.append(first, persistent, rows.len());
        self.forget_places();
        self.wall_impulses.extend_from_slice(&woken.wall_impulses);
        self.wall_impulses.sort_by_key(|of| (of.row, of.wall));
        // Contacts are with each other or with immovable particles.
        let (rows, movable) = (&self.rows, &self.particles.movable);
        let named = || (0..len).filter(|&place| place >= first || !movable[place]);
        let places = &mut self.memory.waking.places;
        places.resize(total.max(places.len()), NONE);
        named().for_each(|place| places[rows[place] as usize] = place as u32);
        let contacts = woken.contacts.iter().map(|contact| Contact {
            places: contact.places.map(|row| places[row as usize]),
            ..*contact
        });
        self.contacts.insert(contacts, len);
        named().for_each(|place| places[rows[place] as usize] = NONE);
    }

    /// Wakes all islands.
    pub(super) fn wake_all(&mut self) {
        let all: Vec<u32> = self.asleep.islands().collect();
        self.wake_to_stay(&all);
    }

    /// Wakes the islands that touch one of some rows: immovable particles of which only the velocities have
    /// changed.
    pub(super) fn wake_driven(&mut self, rows: &mut [u32]) {
        if self.asleep.is_empty() || rows.is_empty() {
            return;
        }
        rows.sort_unstable();
        let islands = self.asleep.islands_touching(rows);
        self.wake_to_stay(&islands);
    }

    /// Wakes the islands of some rows; all if one of these is immovable.
    pub(super) fn wake_changed(&mut self, rows: &[u32]) {
        if self.asleep.is_empty() {
            return;
        }
        let (places, awake) = (self.places_of(rows), self.rows.len());
        let movable = &self.particles.movable;
        if places.iter().any(|&place| movable.get(place as usize) == Some(&false)) {
            return self.wake_all();
        }
        let indices = places.iter().filter_map(|&place| (place as usize).checked_sub(awake));
        let islands = self.asleep.islands_of(indices);
        self.wake_to_stay(&islands);
    }

    /// Wakes islands between two steps.
    fn wake_to_stay(&mut self, islands: &[u32]) {
        self.wake(islands);
        self.forget_woken();
    }

    /// Makes waking final.
    pub(super) fn forget_woken(&mut self) {
        self.asleep.forget_woken();
        self.forget_places();
    }

    /// Removes the impulses of walls on some rows.
    pub(super) fn drop_wall_impulses(&mut self, mut rows: Vec<u32>) {
        rows.sort_unstable();
        self.wall_impulses.retain(|of| rows.binary_search(&of.row).is_err());
    }

    /// Puts the islands to sleep again that were woken for a step that failed; `awake` is the
    /// number of particles that were awake before.
    pub(super) fn cancel_waking(&mut self, awake: usize) {
        if self.rows.len() == awake {
            return;
        }
        let rows = self.rows[awake..].to_vec();
        self.drop_wall_impulses(rows);
        let keep: Vec<bool> = (0..self.rows.len()).map(|place| place < awake).collect();
        self.keep(&keep);
        self.asleep.cancel_waking();
        self.forget_places();
    }
}
