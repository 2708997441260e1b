//! The record of a world, and the narrow phase at its end: the pairs that touch then.

use std::cmp::Ordering;

use super::World;
use super::bodies::Bodies;
use super::bodies::discs::Discs;
use super::reach::rounding;
use super::record::{self, Record, TouchEvents, Touched, touched_walls};
use super::search::{self, ListScratch, Lists};
use super::settings::WorldSettings;
use crate::contacts::Contact;
use crate::motion::exact;
use crate::particles::Particles;
use crate::tolerance::{COARSE, Tolerance, gap, size_of};
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::memory;
use jostle_index::quadtree::Quadtree;
use jostle_index::shapes::{Shapes, fill_filters};

/// Scratch.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    shapes: Shapes<f32>,
    tree: Quadtree<f32>,
    listing: ListScratch,
    lists: Lists,
}

impl World {
    /// What happened since the last call of [`World::begin_record`].
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// Begins a new record, which contains no collisions and no merged particles. The pairs that touch at its
    /// beginning are those at the end of the record before. If its first step fails, the record is as before.
    pub fn begin_record(&mut self) -> Result<()> {
        // In a distributed world, pairs of removed particles are apart.
        let (ids, is_whole) = (&self.bodies.ids, self.halo.is_whole());
        let is_there = |id| !is_whole || ids.row(id).is_some();
        let is_wall = |wall| wall < 0 || self.boundaries.ids.row(wall).is_some();
        self.record.begin([&is_there, &is_wall])
    }

    /// Finds the pairs that touch at the end of the record, if events are tracked. The record may be
    /// continued.
    pub fn end_record(&mut self) -> Result<()> {
        if self.settings.track_events && self.record.is_open {
            let touching = [touching(self)?, touching_walls(self)?];
            self.record.end(touching);
        }
        Ok(())
    }

    /// The pairs of particles, and of particles and walls, that began and ceased to touch between the beginning and the
    /// end of the record; None if events are not tracked.
    pub fn events(&self) -> Result<Option<[TouchEvents; 2]>> {
        self.settings.track_events.then(|| self.record.events()).transpose()
    }
}

/// The pairs of ids that touch now, sorted: those with a small gap, and those that resting
/// contacts press together.
pub(crate) fn touching(world: &mut World) -> Result<Vec<Touched>> {
    let mut all = world.halo.protocol().touching_asleep(world)?;
    let World { bodies, contacts, record, halo, settings, scratch, .. } = world;
    let is_asleep_known = record.knows_sleepers || !halo.is_whole();
    let rows = find_touching(bodies, is_asleep_known, settings, &mut scratch.touching)?;
    let is_pressed = |contact: &&Contact| contact.presses();
    let awake = contacts.lasting().filter(is_pressed);
    let awake = awake.map(|contact| contact.indices.map(|index| bodies.awake.rows[index as usize]));
    let asleep = bodies.asleep.contacts().filter(is_pressed).map(|contact| contact.indices);
    let rows = rows.into_iter().chain(awake).chain(asleep);
    let category = bodies.categories()?;
    let touched = |rows: [u32; 2]| halo.known_pair(&bodies.ids, rows, rows.map(&category));
    memory::extend(&mut all, rows.filter_map(touched))?;
    record::sort(&mut all);
    Ok(all)
}

/// The ids of particles and of walls or sides that touch now, sorted: those with a small gap, and those that resting
/// contacts press together.
fn touching_walls(world: &mut World) -> Result<Vec<Touched>> {
    let World { bodies, boundaries, halo, settings, .. } = world;
    // After a refused step the tree may be that of its walls.
    boundaries.walls.begin_part(settings.tree, 0.0)?;
    let (particles, rows) = (&bodies.awake.particles, &bodies.awake.rows);
    let awake = boundaries.walls.touching(particles, 0..particles.len())?.into_iter();
    let awake = awake.map(|[index, wall]| [rows[index as usize], wall]);
    let Discs { particles, rows, .. } = &bodies.asleep.sleepers().discs;
    let asleep = boundaries.walls.touching(particles, bodies.asleep.indices())?.into_iter();
    let asleep = asleep.map(|[index, wall]| [rows[index as usize], wall]);
    let impulses = boundaries.impulses.iter().chain(bodies.asleep.wall_impulses());
    let pressed = impulses.filter(|of| of.pushes[0] > 0.0).map(|of| [of.row, of.wall]);
    let all = awake.chain(asleep).chain(pressed).filter(|[row, _]| *row < halo.own_rows());
    let mut found = Vec::new();
    memory::extend(&mut found, all.map(touched_walls(bodies, boundaries, &**halo)?))?;
    record::sort(&mut found);
    Ok(found)
}

/// The pairs of sleeping particles that touched when they were recorded.
pub(crate) fn known_touches_asleep(bodies: &Bodies, record: &Record) -> Result<Vec<Touched>> {
    let mut all = Vec::new();
    if !record.knows_sleepers || bodies.asleep.is_empty() {
        return Ok(all);
    }
    let mut asleep = memory::filled(bodies.len(), false)?;
    bodies.asleep.rows().for_each(|row| asleep[row as usize] = true);
    let sleeps = |&id: &Id| bodies.ids.row(id).is_some_and(|row| asleep[row as usize]);
    let known = record.pairs.at_end.iter().filter(|of| of.pair.iter().any(sleeps));
    let known = known.filter(|of| of.pair.iter().all(|&id| bodies.contains(id)));
    memory::extend(&mut all, known.copied())?;
    Ok(all)
}

/// The pairs of rows with a small gap. Sleeping ones are left out if their pairs are known.
fn find_touching(
    bodies: &Bodies,
    is_asleep_known: bool,
    settings: &WorldSettings,
    scratch: &mut Scratch,
) -> Result<Vec<[u32; 2]>> {
    if !is_asleep_known && !bodies.asleep.is_empty() {
        let all = bodies.particles()?;
        let mut found = Vec::new();
        memory::extend(&mut found, find_touching_of(&all, settings, scratch)?)?;
        return Ok(found);
    }
    let Discs { particles, rows, .. } = &bodies.awake;
    let pairs = find_touching_of(particles, settings, scratch)?;
    let mut found = Vec::new();
    memory::extend(&mut found, pairs.map(|pair| pair.map(|index| rows[index as usize])))?;
    Ok(found)
}

/// The pairs of indices of some particles with a small gap.
pub(crate) fn find_touching_of<'a>(
    all: &'a Particles,
    settings: &WorldSettings,
    scratch: &'a mut Scratch,
) -> Result<impl Iterator<Item = [u32; 2]> + use<'a>> {
    let container = settings.container;
    let Scratch { shapes, tree, listing, lists } = scratch;
    let columns = shapes.columns_mut();
    columns.centers.clear();
    let places = all.positions.iter().map(|&position| container.period().wrap(position));
    memory::extend(columns.centers, places)?;
    let radii = columns.radii.rows_mut();
    radii.clear();
    // The circles contain every gap that may count as touching: that is at most `COARSE` of the
    // size.
    let larger = all.radii.iter().zip(&all.positions).map(|(&radius, &position)| {
        radius * (1.0 + 2.0 * COARSE as f32) + 2.0 * rounding(position, radius, &container)
    });
    memory::extend(radii, larger)?;
    fill_filters(all.filters.iter().copied(), columns.filters)?;
    tree.rebuild_unchecked(shapes, settings.tree, &|_, _| Ordering::Equal)?;
    search::list(tree, settings, false, listing, lists)?;
    let touch = move |[a, b]: [u32; 2]| {
        let [a, b] = [a, b].map(|index| index as usize);
        if !all.may_touch(a, b) {
            return false;
        }
        let [p, q] = [a, b].map(|at| exact(all.positions[at], all.residuals[at]));
        let contact_distance = f64::from(all.radii[a]) + f64::from(all.radii[b]);
        let [x, y] = container.period().exact().minimum_image([q[0] - p[0], q[1] - p[1]]);
        let [r, s] = [all.radii[a], all.radii[b]];
        // The tolerance is that at the centre of the smaller disc. Of two equal discs the
        // larger tolerance counts, so that their order does not matter.
        let near = |place| Tolerance::of(f64::from(size_of(r, s)), place).rounding();
        let near = match r.total_cmp(&s) {
            Ordering::Less => near(p),
            Ordering::Greater => near(q),
            Ordering::Equal => near(p).max(near(q)),
        };
        gap([x, y], contact_distance).1 <= near
    };
    let (tree, lists) = (&*tree, &*lists);
    let pairs = lists.iter().flat_map(|(_, pairs)| pairs);
    let pairs = pairs.map(|pair| pair.map(|index| tree.rows()[index as usize]));
    Ok(pairs.filter(move |&pair| touch(pair)))
}
