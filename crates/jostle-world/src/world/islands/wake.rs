//! Waking: islands that something touches, or that a change concerns, return to the columns that a
//! step works on.
//!
//! A step that would touch sleeping islands is undone, they wake, and it is made anew. What would touch
//! follows from the bounds with which a part of a step begins, and from the histories of
//! the particles that leave them.

use std::cmp::Ordering;

use super::{Islands, NONE};
use crate::contacts::{Contact, Contacts};
use crate::forces::Influences;
use crate::halo::Halo;
use crate::world::bodies::Bodies;
use crate::world::bodies::asleep::Sleepers;
use crate::world::bodies::discs::Discs;
use crate::world::distribution::Distribution;
use crate::world::reach::{FreeReaches, ROUNDED_UP, rounding};
use crate::world::{StepScratch, World};
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::table::Table;
use jostle_base::{memory, reserve};
use jostle_index::shapes::fill_filters;

/// Whether particles sleep and all others are static, so that a step changes nothing.
pub(crate) fn is_still(bodies: &Bodies, influences: &Influences) -> bool {
    !bodies.asleep.is_empty()
        && influences.motors().next().is_none()
        && (0..bodies.awake.rows.len()).all(|at| bodies.awake.particles.is_static(at))
}

/// Whether any particle sleeps, on any process.
pub(crate) fn any_sleeps(bodies: &Bodies, halo: &dyn Distribution) -> bool {
    !bodies.asleep.is_empty() || halo.agreed().is_some_and(|agreed| agreed.any_sleeps)
}

/// Lists the islands that moving particles may touch by themselves in `dt` seconds. Returns whether
/// there are any on any process: all processes must call it. The bounds are larger, and depend on
/// other particles.
pub(crate) fn find_touched_on_all(world: &mut World, dt: f32) -> Result<bool> {
    let World { bodies, halo, islands, scratch, settings, .. } = world;
    if !any_sleeps(bodies, &**halo) {
        return Ok(false);
    }
    let Bodies { awake: Discs { particles, rows, .. }, asleep, .. } = bodies;
    let own = halo.own_rows();
    let free = FreeReaches::new(settings, &scratch.forces, dt);
    // Where bounds are made for the whole step, the radius depends on the particle alone, and not
    // on the speeds of others. Where they end at a horizon it is at most their reach, because the
    // tree has no larger circles; what gets farther is found at the end of the part. Static
    // particles and ghosts touch nothing here: ghosts are tested by their own ranks.
    let radius = |index: u32| {
        let at = index as usize;
        let moves = !particles.is_static(at) && rows[at] < own;
        let most = scratch.reaches[at];
        let rounding = rounding(particles.positions[at], particles.radii[at], &settings.container);
        moves.then(|| particles.radii[at] + free.within(particles, at, most) + rounding)
    };
    let Islands { join, touched, .. } = islands;
    asleep.touched(&scratch.tree, radius, settings, (join, touched))?;
    let of_others = halo.touch_others(&scratch.tree, &radius, settings, join)?;
    islands.any_touched_on_all(&**halo, of_others)
}

/// Lists, at the end of a part of a step, the islands that particles may have touched which got beyond
/// their watched reaches, in the order of time or by position correction. Returns whether there are
/// any on any process: all processes must call it.
pub(crate) fn find_touched_beyond_reach_on_all(world: &mut World) -> Result<bool> {
    if !any_sleeps(&world.bodies, &*world.halo) {
        return Ok(false);
    }
    let any_outside = find_circles_beyond_reach(world)?;
    let World { bodies: Bodies { asleep, .. }, halo, islands, settings, .. } = world;
    if !any_outside {
        return islands.any_touched_on_all(&**halo, false);
    }
    let Islands { join, touched, tree, .. } = islands;
    // The tree has circles of the right size, so every overlap counts.
    let radius = |_| Some(f32::INFINITY);
    asleep.touched(tree, radius, settings, (join, touched))?;
    let of_others = halo.touch_others(tree, &radius, settings, join)?;
    islands.any_touched_on_all(&**halo, of_others)
}

/// Builds the tree of circles around the particles of this process that got beyond their watched reaches; returns
/// whether there are any.
fn find_circles_beyond_reach(world: &mut World) -> Result<bool> {
    let World { bodies, scratch, settings, halo, islands, .. } = world;
    let Discs { particles, rows, .. } = &bodies.awake;
    let StepScratch { events, watched_reaches, motions, .. } = scratch;
    let own = halo.own_rows();
    let beyond_reach = &mut events.beyond_reach;
    beyond_reach.retain(|&(index, _)| rows[index as usize] < own);
    // Position correction moves particles without an event, so the last positions are tested,
    // too.
    for (index, &reach) in watched_reaches.iter().enumerate() {
        let ([x, y], [u, v]) = (motions.position(index as u32), particles.positions[index]);
        let [x, y] = [x - u, y - v].map(f64::from);
        let distance = (x * x + y * y).sqrt();
        if distance > f64::from(reach) {
            memory::push(beyond_reach, (index as u32, distance))?;
        }
    }
    if beyond_reach.is_empty() {
        return Ok(false);
    }
    let Islands { shapes, tree, .. } = islands;
    let index = |&(index, _): &(u32, f64)| index as usize;
    let columns = shapes.columns_mut();
    columns.centers.clear();
    let places = beyond_reach.iter().map(|outside| particles.positions[index(outside)]);
    memory::extend(columns.centers, places)?;
    let radii = columns.radii.rows_mut();
    radii.clear();
    let larger = beyond_reach.iter().map(|outside| {
        let (position, radius) =
            (particles.positions[index(outside)], particles.radii[index(outside)]);
        let rounding = rounding(position, radius, &settings.container);
        radius + outside.1 as f32 * ROUNDED_UP as f32 + rounding
    });
    memory::extend(radii, larger)?;
    let filters = if particles.filters.is_empty() { &[][..] } else { &beyond_reach[..] };
    let filters = filters.iter().map(|outside| particles.filter(index(outside)));
    fill_filters(filters, columns.filters)?;
    tree.rebuild_unchecked(shapes, settings.tree, &|_, _| Ordering::Equal)?;
    Ok(true)
}

impl Islands {
    /// Whether the attempt would touch any islands of any process: those listed, or some `of_others`.
    /// All processes must call it.
    fn any_touched_on_all(&self, halo: &dyn Halo, of_others: bool) -> Result<bool> {
        // All ranks must repeat the attempt, also those that meet no sleeper.
        halo.any(of_others || !self.touched.is_empty())
    }
}

/// Wakes the islands that an attempt has touched, or all.
pub(crate) fn wake_touched(world: &mut World, all: bool) -> Result<()> {
    let mut touched = std::mem::take(&mut world.islands.touched);
    world.halo.protocol().wake_touched(world, &touched, all)?;
    touched.clear();
    world.islands.touched = touched;
    Ok(())
}

/// Wakes islands. A step that fails takes that back with [`cancel_waking`]; [`forget_woken`] makes it final.
pub(crate) fn wake(world: &mut World, islands: &[u32]) -> Result<()> {
    if islands.is_empty() {
        return Ok(());
    }
    // First the memory, also for `cancel_waking`; then nothing can fail.
    let total = world.bodies.len();
    world.bodies.asleep.reserve_waking(islands.len())?;
    world.halo.protocol().recall_contacts(world, islands)?;
    let World { bodies, contacts, boundaries, islands: scratch, .. } = world;
    let Islands { indices, woken_rows, keep, .. } = scratch;
    let woken = bodies.asleep.select(islands.iter().copied())?;
    bodies.awake.reserve(&woken.discs, total)?;
    reserve!(total; *woken_rows, *keep);
    memory::lengthen(indices, total, NONE)?;
    memory::reserve(&mut boundaries.impulses, woken.wall_impulses.len())?;
    contacts.reserve_insert(woken.contacts.len(), total)?;
    bodies.asleep.wake(islands);
    boundaries.insert(&woken.wall_impulses);
    append(&woken, bodies, contacts, indices);
    Ok(())
}

/// Appends islands that wake to the columns, with their contacts. `indices` has [`NONE`] for each row, before and
/// after.
fn append(woken: &Sleepers, bodies: &mut Bodies, contacts: &mut Contacts, indices: &mut [u32]) {
    let Discs { particles, rows, persistent } = &woken.discs;
    let first = bodies.awake.rows.len();
    let len = first + rows.len();
    // At the end of the columns: the tree of the next attempt sorts them, so no result depends
    // on it.
    bodies.awake.particles.extend(particles);
    bodies.awake.rows.extend_from_slice(rows);
    bodies.awake.persistent.append(first, persistent, rows.len());
    bodies.forget_indices();
    // Contacts are with each other or with immovable particles.
    let (rows, movable) = (&bodies.awake.rows, &bodies.awake.particles.movable);
    let named = || (0..len).filter(|&index| index >= first || !movable[index]);
    named().for_each(|index| indices[rows[index] as usize] = index as u32);
    let new = woken.contacts.iter().map(|contact| Contact {
        indices: contact.indices.map(|row| indices[row as usize]),
        ..*contact
    });
    contacts.insert(new, len);
    named().for_each(|index| indices[rows[index] as usize] = NONE);
}

/// Wakes all islands.
pub(crate) fn wake_all(world: &mut World) -> Result<()> {
    wake_every_island(world)?;
    forget_woken(world);
    Ok(())
}

/// Wakes all islands in a step, which takes it back if it fails.
pub(crate) fn wake_every_island(world: &mut World) -> Result<()> {
    let mut all = Vec::new();
    memory::extend(&mut all, world.bodies.asleep.islands())?;
    wake(world, &all)
}

/// Wakes the islands that touch one of some rows or have a spring to it: immovable particles of
/// which only the velocities have changed.
pub(crate) fn wake_driven(world: &mut World, rows: &mut [u32]) -> Result<()> {
    let World { bodies, influences, .. } = &*world;
    if bodies.asleep.is_empty() || rows.is_empty() {
        return Ok(());
    }
    rows.sort_unstable();
    let mut islands = bodies.asleep.islands_touching(rows)?;
    let is_driven = |row: &Id| rows.binary_search(&(*row as u32)).is_ok();
    let all = influences.springs().flat_map(|springs| &springs.0);
    let tied = all.map(|spring| spring.pair).filter(|pair| pair.iter().any(is_driven));
    let mut ends = Vec::new();
    memory::extend(&mut ends, tied.flatten().map(|row| row as u32))?;
    memory::append(&mut islands, &bodies.islands_of(&bodies.indices_of(&ends)?)?)?;
    islands.sort_unstable();
    islands.dedup();
    wake(world, &islands)
}

/// Wakes the islands of some rows; all if one of these is immovable.
pub(crate) fn wake_changed(world: &mut World, rows: &[u32]) -> Result<()> {
    let bodies = &world.bodies;
    if bodies.asleep.is_empty() {
        return Ok(());
    }
    let indices = bodies.indices_of(rows)?;
    // It is not known which islands rest on an immovable particle, or will overlap it where it
    // goes.
    if indices.iter().any(|&index| bodies.is_immovable(index)) {
        return wake_every_island(world);
    }
    let islands = bodies.islands_of(&indices)?;
    wake(world, &islands)
}

/// Wakes islands between two steps.
pub(crate) fn wake_to_stay(world: &mut World, islands: &[u32]) -> Result<()> {
    wake(world, islands)?;
    forget_woken(world);
    Ok(())
}

/// Makes waking final.
pub(crate) fn forget_woken(world: &mut World) {
    world.bodies.asleep.forget_woken();
    world.halo.protocol().drop_contacts(world);
    world.bodies.forget_indices();
}

/// Puts the islands to sleep again that were woken for a step that failed.
pub(crate) fn cancel_waking(world: &mut World) {
    let World { bodies, contacts, boundaries, islands, .. } = world;
    let Islands { woken_rows: woken, keep, .. } = islands;
    woken.clear();
    woken.extend(bodies.asleep.woken_rows());
    if woken.is_empty() {
        return;
    }
    woken.sort_unstable();
    keep.clear();
    keep.extend(bodies.awake.rows.iter().map(|row| woken.binary_search(row).is_err()));
    boundaries.drop_rows(woken);
    bodies.keep(keep);
    contacts.retain(keep);
    bodies.asleep.cancel_waking();
    bodies.forget_indices();
}
