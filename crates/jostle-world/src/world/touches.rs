//! What touched during the last step, and with which impulses.

use super::bodies::Bodies;
use super::bodies::discs::Discs;
use super::record::{Touched, record_pairs, record_walls};
use super::search::{Overlap, overlapping};
use super::settings::{OnTouch, WorldSettings};
use super::{StepScratch, World};
use crate::contacts::{Block, Contact, Contacts};
use crate::events::{Bounce, Events, WALL};
use crate::motion::{Motions, exact};
use crate::particles::Particles;
use crate::resting::WallImpulse;
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::interrupt;
use jostle_base::memory;
use jostle_index::period::Period;

/// Two particles that touched during the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Their ids, the smaller first.
    pub pair: [Id; 2],
    /// Unit vector from the first to the second.
    pub normal: [f32; 2],
    /// Penetration at the end of the step; negative if they had separated.
    pub depth: f32,
    /// Sum of the impulses of the step on the second along the normal.
    pub normal_impulse: f32,
    /// Sum of those along the normal after a quarter turn from +x to +y.
    pub friction_impulse: f32,
    /// The present categories of both.
    pub categories: [u32; 2],
}

/// A particle and a wall that gave it an impulse during the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallTouch {
    /// The id of the particle.
    pub id: Id,
    /// The wall k of [`World::walls`]; of a side of the container, below −1, see
    /// [`Container::side_id`](crate::Container::side_id).
    pub wall: i64,
    /// Unit vector from the wall into the container.
    pub normal: [f32; 2],
    /// Penetration at the end of the step; negative if they had separated.
    pub depth: f32,
    /// As for [`Touch`], on the particle.
    pub normal_impulse: f32,
    /// As for [`Touch`], on the particle.
    pub friction_impulse: f32,
    /// The present categories of the particle and of the wall; that of a side is the usual one.
    pub categories: [u32; 2],
}

/// What callers see of the contact of two particles with these ids and categories.
pub(crate) fn touch_of(contact: &Contact, ids: [Id; 2], categories: [u32; 2]) -> Touch {
    let sign = if ids[0] < ids[1] { 1.0 } else { -1.0 };
    let Touched { pair, categories } = Touched::ascending(ids, categories);
    let normal = contact.normal.map(|v| v * sign);
    // If the two are exchanged, normal and impulse change their signs, and the sums do not.
    let [normal_impulse, friction_impulse] = contact.totals;
    Touch { pair, normal, depth: -contact.gap, normal_impulse, friction_impulse, categories }
}

/// Collects what touched in a part of a step, and with which impulses, from the results of the
/// sub-steps.
pub(crate) fn collect_touches(world: &mut World, threads: Option<usize>) -> Result<()> {
    list_exhausted(world)?;
    let World { bodies, scratch, boundaries, record, halo, settings, contacts, .. } = world;
    let Discs { particles, rows, .. } = &bodies.awake;
    let Events { bounced, sensed, at_walls, .. } = &mut scratch.events;
    if !bounced.is_sorted_by(|a, b| a.order(b).is_le()) {
        bounced.sort_unstable_by(Bounce::order);
    }
    // A pair belongs to the process of the smaller index that is movable: that of an immovable particle may not have
    // ghosts of all that touch it.
    let is_own = |[a, b]: [u32; 2]| {
        let (first, second) = (a.min(b), a.max(b));
        let is_first = second == WALL || particles.movable[first as usize];
        rows[if is_first { first } else { second } as usize] < halo.own_rows()
    };
    let sums = &mut record.of_step;
    for bounce in bounced.iter().filter(|bounce| is_own(bounce.pair)) {
        let radius = |index: u32| f64::from(particles.radii[index as usize]);
        let [a, b] = bounce.pair;
        let contact_distance = if b == WALL { 0.0 } else { radius(a) + radius(b) };
        sums.add_bounce(bounce, contact_distance, &settings.container)?;
    }
    for rested in contacts.blocks().iter().flat_map(Block::rested) {
        if is_own(rested.pair) {
            let (distance, normal) = (rested.contact_distance.into(), rested.normal.map(f64::from));
            sums.add_contact(distance, normal, rested.impulses);
        }
    }
    boundaries.collect(bounced, rows, (sums, &settings.container, halo.own_rows()))?;
    let at_walls = at_walls.iter().map(|&[index, wall]| [rows[index as usize], wall]);
    record_walls(record, (bodies, boundaries), &**halo, at_walls)?;
    sensed.iter_mut().for_each(|[a, b]| (*a, *b) = ((*a).min(*b), (*a).max(*b)));
    sensed.sort_unstable();
    sensed.dedup();
    if settings.on_touch == OnTouch::Bounce {
        let period = settings.container.period().exact();
        update_contacts(contacts, particles, &scratch.motions, &period, (bounced, sensed), threads)
    } else if settings.track_events {
        record_pairs(record, bodies, &**halo, sensed.iter().copied())
    } else {
        Ok(())
    }
}

/// Lists the rows that were exhausted, and counts those whose collisions became elastic.
fn list_exhausted(world: &mut World) -> Result<()> {
    let World { bodies, scratch: StepScratch { exhausted, events, .. }, stats, halo, .. } = world;
    let rows = &bodies.awake.rows;
    memory::extend(exhausted, events.exhausted.iter().map(|&index| rows[index as usize]))?;
    exhausted.sort_unstable();
    exhausted.dedup();
    stats.unresolved = exhausted.len() as u64;
    let is_own = |index: u32| rows[index as usize] < halo.own_rows();
    let collapsed = events.collapsed.iter().filter(|&&index| is_own(index));
    stats.collapsed += collapsed.count() as u64;
    Ok(())
}

/// Keeps the contacts that last, adds the pairs that bounced in the step and those that passed
/// through each other (`sensed`), and measures all.
fn update_contacts(
    contacts: &mut Contacts,
    particles: &Particles,
    motions: &Motions,
    period: &Period<f64>,
    (bounced, sensed): (&[Bounce], &[[u32; 2]]),
    threads: Option<usize>,
) -> Result<()> {
    let bounced = bounced.iter().filter(|bounce| bounce.pair[1] != WALL);
    let bounced = bounced.map(|bounce| (bounce.pair, bounce.impulses));
    let sensed = sensed.iter().map(|&pair| (pair, [0.0; 2]));
    let touched = bounced.chain(sensed).map(|([a, b], impulses)| {
        let pair = [a.min(b), a.max(b)];
        // Trajectories are not wrapped within a step, so the two may be in different copies of
        // the torus.
        let mut image = [0.0; 2];
        if !period.is_none() {
            let [p, q] = pair.map(|index| motions.position(index).map(f64::from));
            let offset = [0, 1].map(|k| q[k] - p[k]);
            let nearest = period.minimum_image(offset);
            image = [0, 1].map(|k| (nearest[k] - offset[k]) as f32);
        }
        (pair, image, impulses)
    });
    contacts.keep_lasting(touched, particles, particles.len())?;
    contacts.each(threads, |contact| contact.measure(motions, &particles.radii));
    Ok(())
}

/// The overlapping pairs by id, as callers see them.
fn overlaps(bodies: &Bodies, settings: &WorldSettings) -> Result<Vec<Touch>> {
    let Discs { particles, rows, .. } = &bodies.awake;
    let touch = |Overlap { indices, offset, radius_sum }: Overlap| {
        let categories = indices.map(|index| particles.filter(index as usize).category);
        let ids = indices.map(|index| bodies.ids.of(rows[index as usize]));
        let length = (offset[0] * offset[0] + offset[1] * offset[1]).sqrt();
        let sign = if ids[0] < ids[1] { 1.0 } else { -1.0 };
        // The normal of coincident centres is +x.
        let normal = if length > 0.0 { offset.map(|v| v * sign / length) } else { [1.0, 0.0] };
        let (normal_impulse, friction_impulse) = (0.0, 0.0);
        let Touched { pair, categories } = Touched::ascending(ids, categories);
        let depth = radius_sum - length;
        Touch { pair, normal, depth, normal_impulse, friction_impulse, categories }
    };
    let mut touches = memory::collect(overlapping(particles, settings)?.0.into_iter().map(touch))?;
    interrupt::check()?;
    touches.sort_unstable_by_key(|touch| touch.pair);
    interrupt::check()?;
    Ok(touches)
}

impl World {
    /// The pairs that touched during the last step, in canonical order. Then the pairs of sleeping
    /// islands, as in the last step in which these were awake, in the order in which they fell
    /// asleep. If nothing bounces, those that overlap now; an error if there are too many.
    pub fn contacts(&self) -> Result<Vec<Touch>> {
        if self.settings.on_touch != OnTouch::Bounce {
            return overlaps(&self.bodies, &self.settings);
        }
        let (id, category) = (|row: u32| self.bodies.ids.of(row), self.bodies.categories()?);
        let touch = |contact: &Contact, rows: [u32; 2]| {
            touch_of(contact, rows.map(id), rows.map(&category))
        };
        let row = |index: u32| self.bodies.awake.rows[index as usize];
        let awake = self.contacts.touching().map(|of| touch(of, of.indices.map(row)));
        let asleep = self.bodies.asleep.contacts().filter(|contact| contact.touched);
        let mut all = Vec::new();
        memory::extend(&mut all, awake)?;
        memory::extend(&mut all, asleep.map(|of| touch(of, of.indices)))?;
        Ok(all)
    }

    /// The particles to which walls gave an impulse during the last step, by id; sleeping ones as
    /// in the last step in which they were awake.
    pub fn wall_contacts(&self) -> Result<Vec<WallTouch>> {
        let indices = self.bodies.indices()?;
        let touch = |&WallImpulse { row, wall, impulses, .. }: &WallImpulse| {
            // One that is only kept for warm starting, in a world of particles of other ones.
            if impulses[0] <= 0.0 {
                return None;
            }
            let index = indices[row as usize] as usize;
            let (all, index) = self.bodies.disc_at(index);
            let position = exact(all.positions[index], all.residuals[index]);
            let radius = f64::from(all.radii[index]);
            let contact =
                self.boundaries.walls.nearest_contact(wall, position, [0.0; 2], radius)?;
            let (normal, depth) = (contact.normal.map(|v| v as f32), -contact.gap as f32);
            let [normal_impulse, friction_impulse] = impulses;
            let categories = [all.filter(index).category, self.boundaries.category_of(wall)];
            Some(WallTouch {
                id: self.bodies.ids.of(row),
                wall: self.boundaries.id_of(wall),
                normal,
                depth,
                normal_impulse,
                friction_impulse,
                categories,
            })
        };
        let all = self.boundaries.impulses.iter().chain(self.bodies.asleep.wall_impulses());
        let mut found: Vec<WallTouch> = Vec::new();
        memory::extend(&mut found, all.filter_map(touch))?;
        // Of each particle and wall there is one.
        found.sort_unstable_by_key(|touch| (touch.id, touch.wall));
        Ok(found)
    }
}
