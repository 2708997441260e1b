//! Halo exchange: each rank gets ghosts, copies of the particles of other ranks near its own ones.

use super::domain::{Announced, Domain};
use super::domain::{domain_of, domain_of_mut};
use super::migration::{append_records, drop_ghosts};
use super::protocol::find_shared;
use super::waking::islands_of_circles;
use super::{CircleBlocks, Grid, Near, RECORD, put_record};
use crate::halo::Halo;
use crate::world::World;
use crate::world::bodies::Bodies;
use crate::world::bodies::asleep::Asleep;
use crate::world::bodies::discs::Discs;
use crate::world::reach::{ROUNDED_UP, SLACK, distance_at, distance_of_fall, rounding};
use jostle_base::error::Result;
use jostle_base::parallel::locked;

/// Width of the margin around each particle, in mean radii.
/// A wider margin sends more ghosts, a narrower one repeats more steps;
/// [`OwnParticles`](super::OwnParticles) counts both.
const MARGIN: f64 = 3.0;

/// With this factor of the margin, or a larger one, each rank gets all particles. It doubles with each
/// repetition.
const ALL: f64 = (1u64 << 30) as f64;

/// For ghosts near the present positions, the circle of a particle is larger by this fraction of its radius. It
/// includes the gap at which two surfaces count as touching.
const NEAR: f32 = 0.01;

// Ghosts include all with which a contact may be made, whatever the speeds.
const _: () = assert!(SLACK < NEAR);

/// Announces where own particles may be in `dt` seconds, and gets the ghosts that may be there. Returns
/// whether the margin is so wide that each rank has all particles.
pub(super) fn exchange_ghosts(world: &mut World, dt: f32) -> Result<bool> {
    let domain = domain_of_mut(world);
    (domain.foreign, domain.is_static) = (Asleep::default(), false);
    if world.halo.is_alone() {
        return Ok(true);
    }
    // A circle is announced before the step is computed, so it is a guess of how far a particle
    // gets. If it is too small, other ranks may lack the particle as a ghost, and the step is
    // repeated. The guess decides how much is sent and how often steps are repeated, and never the
    // result.
    let (margin, extent) = margin_and_extent(world, dt)?;
    let fall = distance_of_fall(world.settings.gravity, dt);
    let Some(domain) = domain_of(world) else { return Ok(true) };
    let distance = |(index, &row): (usize, &u32)| {
        // Bounds as in a step: velocity, gravity and forces of the caller. Collisions and
        // other forces are covered by the margin.
        let own = distance_at(world.bodies.awake.particles.velocities[index], dt);
        let [x, y, _] = world.external.of(row);
        let pulled = fall + distance_of_fall([x, y], dt);
        let usual = own + if world.bodies.awake.particles.movable[index] { pulled } else { 0.0 };
        let known =
            if domain.further.is_empty() { None } else { domain.further.get(&domain.id(row)) };
        // What got too far in an attempt before is announced by that much further.
        known.map_or(usual, |known| known.max(usual)) + margin as f32
    };
    let distances: Vec<f32> = world.bodies.awake.rows.iter().enumerate().map(distance).collect();
    exchange_within(world, &distances)?;
    Ok(margin >= extent)
}

/// Gets the particles of other ranks that are near the present positions of own ones. Ghosts must have been
/// dropped before.
pub(super) fn exchange_static_ghosts(world: &mut World) -> Result<()> {
    domain_of_mut(world).is_static = true;
    if world.halo.is_alone() {
        return Ok(());
    }
    let distances: Vec<f32> =
        world.bodies.awake.particles.radii.iter().map(|radius| radius * NEAR).collect();
    exchange_within(world, &distances)
}

/// Gets the neighbours of own particles in forces between kinds. There must be no ghosts.
pub(super) fn exchange_neighbors(world: &mut World) -> Result<()> {
    if world.halo.is_alone() {
        return Ok(());
    }
    let half = 0.5 * world.influences.largest_cutoff();
    exchange_within(world, &vec![half; world.bodies.awake.rows.len()])
}

/// Gets ghosts for the rest of a step, if the present ones are only those near own particles.
pub(super) fn renew_ghosts(world: &mut World, dt: f32) -> Result<()> {
    if !domain_of(world).is_some_and(|domain| domain.is_static) {
        return Ok(());
    }
    drop_ghosts(world);
    // Lists by rows lose what belongs to ghosts that are gone.
    let own = world.halo.own_rows();
    world.boundaries.pushes.retain(|of| of.row < own);
    world.scratch.exhausted.retain(|&row| row < own);
    exchange_ghosts(world, dt)?;
    let exhausted = std::mem::take(&mut world.scratch.exhausted);
    // All ranks take part in the next exchange, or none.
    let any = world.halo().any(!exhausted.is_empty())?;
    world.scratch.exhausted = exhausted;
    if any && !world.halo.is_alone() { share_exhausted(world) } else { Ok(()) }
}

/// Finds out which ghosts were exhausted in the step.
fn share_exhausted(world: &mut World) -> Result<()> {
    find_shared(world);
    let World { bodies: Bodies { awake: Discs { rows, .. }, .. }, halo, scratch, .. } = world;
    let (halo, exhausted): (&dyn Halo, _) = (&**halo, &mut scratch.exhausted);
    let is_one = |index: u32| exhausted.binary_search(&rows[index as usize]).is_ok();
    let all = halo.labels(|index| u64::from(is_one(index)))?;
    let ghosts = all.into_iter().filter(|&(_, is_one)| is_one > 0);
    exhausted.extend(ghosts.map(|(index, _)| rows[index as usize]));
    exhausted.sort_unstable();
    Ok(())
}

/// Announces circles around own particles, with these distances beyond the radius, by index, and
/// gets all particles of other ranks whose circles may overlap them.
fn exchange_within(world: &mut World, distances: &[f32]) -> Result<()> {
    let World {
        bodies: Bodies { awake: Discs { particles, rows, .. }, asleep, .. },
        halo,
        settings,
        ..
    } = world;
    let domain = Domain::of_mut(&mut **halo);
    let (awake, has_sleepers) = (domain.awake, domain.asleep > 0);
    let Domain { group, ids, own, scales, announced, sent, is_sent, foreign, .. } = domain;
    let grid = Grid::new(&settings.container, scales, awake);
    let mut group = locked(group);
    announced.resize(*own, Announced::default());
    sent.resize(group.size(), Vec::new());
    sent.iter_mut().for_each(Vec::clear);
    is_sent.clear();
    is_sent.resize(*own, false);
    for ((&row, &position), &distance) in rows.iter().zip(&particles.positions).zip(distances) {
        announced[row as usize] = Announced { position, reach: distance };
    }
    let circle = |index: usize| {
        let center = settings.container.period().wrap(particles.positions[index]);
        let radius = f64::from(particles.radii[index]) + f64::from(distances[index]);
        let rounding = f64::from(rounding(
            particles.positions[index],
            particles.radii[index],
            &settings.container,
        ));
        // Immovable particles need ghosts only if events are tracked or if they may wake others.
        let wakes = has_sleepers && !particles.is_static(index);
        let needs_ghosts = particles.movable[index] || settings.track_events || wakes;
        (center, radius * ROUNDED_UP + rounding, needs_ghosts)
    };
    // Three messages. All ranks get the cells near particles that need ghosts. Each sends its
    // particles whose circles overlap cells of another rank to that rank. The circles of sleeping
    // particles go the same way, so that the ranks of moving particles find what they would touch.
    let circles = CircleBlocks::new(&grid, rows.len(), circle);
    let near = Near::new(&grid, &group.share(&circles.marks().runs())?, group.rank());
    let mut to = vec![Vec::new(); group.size()];
    circles.each_near(&near, |index, ranks| {
        let row = rows[index] as usize;
        is_sent[row] = true;
        for &rank in ranks {
            put_record(&mut to[rank as usize], ids[row], particles, index);
            sent[rank as usize].push(row as u32);
        }
    });
    let arrived = group.exchange(&to)?;
    if has_sleepers {
        let circles = asleep.circles_near(&grid, &near, &settings.container, group.size());
        let circles = group.exchange(&circles)?.concat();
        *foreign = islands_of_circles(&circles, settings.tree)?;
    }
    // The lock is released before the domain changes.
    drop(group);
    let received = arrived.iter().map(|bytes| bytes.len() / RECORD).collect();
    append_records(world, &arrived, false);
    domain_of_mut(world).note_received(received);
    Ok(())
}

/// The margin around each particle, and the longer side of the AABB of all positions.
fn margin_and_extent(world: &mut World, dt: f32) -> Result<(f64, f64)> {
    let World {
        bodies: Bodies { awake: Discs { particles, .. }, .. },
        halo,
        settings,
        scratch,
        ..
    } = world;
    let domain = Domain::of_mut(&mut **halo);
    // There are no ghosts yet.
    let wrapped = particles.positions.iter().map(|&at| settings.container.period().wrap(at));
    let own = wrapped.fold([f32::MIN; 4], |most, [x, y]| {
        [most[0].max(x), most[1].max(y), most[2].max(-x), most[3].max(-y)]
    });
    let own = own.map(f64::from);
    let radii: f64 = particles.radii.iter().map(|&radius| f64::from(radius)).sum();
    let numbers = [own[0], own[1], own[2], own[3], radii].map(f64::to_bits);
    let all = locked(&domain.group).gather(numbers)?;
    let number = |k: usize| all.iter().map(move |of| f64::from_bits(of[k]));
    let [right, bottom, left, top] = [0, 1, 2, 3].map(|k| number(k).fold(f64::MIN, f64::max));
    // In the order of ranks, so that all have the same sum.
    let radius = number(4).sum::<f64>() / domain.awake.max(1) as f64;
    // The first step moves particles that are outside of a torus.
    let is_torus = !settings.container.period().is_none();
    let area = [[-left, -top], [right, bottom]].map(|at| at.map(|v| v as f32));
    domain.extent = (!is_torus).then_some(area);
    let extent = (right + left).max(bottom + top).max(0.0);
    let usual = f64::from(scratch.horizon.usual_speed) * f64::from(dt);
    // Half of the cutoff for each of two circles: they overlap if the particles are neighbours.
    let of_forces = 0.5 * f64::from(world.influences.largest_cutoff());
    let margin = (MARGIN * radius + usual) * domain.widened + of_forces;
    Ok((if domain.widened < ALL { margin } else { margin.max(extent) }, extent))
}
