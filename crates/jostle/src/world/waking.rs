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
use super::sleeping::Drift;
use crate::contacts::Contact;
use crate::container::MAX_WALLS;
use crate::error::Result;
use crate::forces;
use crate::pairs::JoinScratch;
use crate::quadtree::Quadtree;
use crate::shapes::{Shapes, fill_filters};

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
        let join = &mut memory.waking.join;
        memory.touched = asleep.touched(&memory.tree, moves, settings, join)?;
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
        memory.touched = asleep.touched(tree, |_| true, settings, join)?;
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
        let len = first + woken.rows.len();
        self.particles.extend(&woken.particles);
        self.rows.extend_from_slice(&woken.rows);
        self.wall_pushes.extend_from_slice(&woken.wall_pushes);
        let has_friction = woken.wall_frictions.iter().any(|of| *of != [0.0; MAX_WALLS]);
        if has_friction || !self.wall_frictions.is_empty() {
            self.wall_frictions.resize(first, [0.0; MAX_WALLS]);
            self.wall_frictions.extend_from_slice(&woken.wall_frictions);
        }
        if !self.drifts.is_empty() {
            self.drifts.resize(len, Drift::UNKNOWN);
        }
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
        self.wake(&all);
        self.asleep.forget_woken();
    }

    /// Wakes the islands that touch a marked row: an immovable particle of which only the
    /// velocities have changed.
    pub(super) fn wake_driven(&mut self, marked: &[bool]) {
        if self.asleep.is_empty() || !marked.contains(&true) {
            return;
        }
        let islands = self.asleep.islands_touching(marked);
        self.wake(&islands);
        self.asleep.forget_woken();
    }

    /// Wakes the islands of which a row is marked; all if an immovable particle is.
    pub(super) fn wake_changed(&mut self, marked: &[bool]) {
        if self.asleep.is_empty() {
            return;
        }
        let mut awake = self.rows.iter().zip(&self.particles.movable);
        if awake.any(|(&row, &movable)| marked[row as usize] && !movable) {
            return self.wake_all();
        }
        let islands = self.asleep.islands_of(marked);
        self.wake(&islands);
        self.asleep.forget_woken();
    }

    /// Removes the impulses of walls on some rows.
    pub(super) fn drop_wall_impulses(&mut self, mut rows: Vec<u32>) {
        rows.sort_unstable();
        self.wall_impulses.retain(|of| rows.binary_search(&of.row).is_err());
    }

    /// Puts the islands to sleep again that were woken for a step that failed; `awake` is the
    /// number of particles that were awake before, and `had_friction` whether the walls gave
    /// friction.
    pub(super) fn cancel_waking(&mut self, awake: usize, had_friction: bool) {
        if self.rows.len() == awake {
            return;
        }
        let rows = self.rows[awake..].to_vec();
        self.drop_wall_impulses(rows);
        let keep: Vec<bool> = (0..self.rows.len()).map(|place| place < awake).collect();
        self.keep(&keep);
        if !had_friction {
            self.wall_frictions.clear();
        }
        self.asleep.cancel_waking();
    }
}
