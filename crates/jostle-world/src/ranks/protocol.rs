//! What ranks do together in a step.
//!
//! Each rank computes a step of its own particles and of ghosts: copies of the particles of other ranks
//! near them. A rank announces in which cells its particles may be during the step, and gets all
//! particles of others that may be there.
//!
//! Contacts are solved colour by colour, and between two colours ghosts get the velocities, or in position
//! correction the displacements, that their own ranks have computed. So an own particle needs no
//! more than the particles that it touches.
//!
//! Collisions in the order of time have chains that may be long. So ranks compare the trajectories of
//! ghosts that may meet own particles with those that their own ranks have computed. If all are
//! equal, every own particle has met the same particles, on the same trajectories, as in one process:
//! each pair is computed by a rank that has the true trajectory of both, and a history without
//! contradictions is unique. The colours of contacts are compared, too. Otherwise, or if a particle
//! got further than announced, all ranks repeat the step with a wider halo.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use super::carried::recall_resting;
use super::domain::Domain;
use super::domain::{domain_of, domain_of_mut};
use super::edits::wake_edited;
use super::ghosts::{exchange_ghosts, exchange_static_ghosts, renew_ghosts};
use super::islands::{drop_contacts_of_woken, join_islands, keep_pairs_of_sleepers};
use super::merge::{members_of_islands, merge_members};
use super::migration::{drop_ghosts, move_to_domains};
use super::waking::{recall_contacts_of_woken, wake_touched};
use crate::contacts::ContactShape;
use crate::halo::{Halo, digest, digest_all};
use crate::motion::exact;
use crate::world::bodies::Bodies;
use crate::world::bodies::discs::Discs;
use crate::world::distribution::{Agreement, Protocol};
use crate::world::external::has_accelerations;
use crate::world::reach::ROUNDED_UP;
use crate::world::record::Touched;
use crate::world::substeps::too_many_collisions;
use crate::world::{OnTouch, Stats, World};
use jostle_base::error::{Error, Result};
use jostle_base::parallel::locked;

/// Factor of the margin after each step that was not repeated.
/// What one step needed, the next ones need, too. The factor of the margin halves in about 70
/// steps.
const NARROWING: f64 = 0.99;

/// Factor of the margin with which a step begins, at most.
const MAX_WIDENING: f64 = 8.0;

/// What ranks do together.
pub(crate) struct Ranks;

impl Protocol for Ranks {
    /// Also reports a panic to the other ranks.
    fn guard(
        &self,
        world: &mut World,
        step: &mut dyn FnMut(&mut World) -> Result<()>,
    ) -> Result<()> {
        // A rank that panics would leave the others in a message that never ends.
        let done = catch_unwind(AssertUnwindSafe(|| step(world)));
        // The others know of an error that came from another rank.
        let is_cause = !matches!(done, Ok(Ok(()) | Err(Error::OtherRank { .. })));
        if is_cause {
            world.halo.fail();
        }
        done.unwrap_or_else(|panic| resume_unwind(panic))
    }

    fn begin_step(&self, world: &mut World) {
        drop_ghosts(world);
    }

    fn migrate(&self, world: &mut World) -> Result<bool> {
        move_to_domains(world)?;
        let domain = domain_of_mut(world);
        // All ranks have learned in `sum_up` that nothing moves, so none waits for this one.
        if domain.is_still {
            domain.steps += 1;
            world.boundaries.impulses.clear();
            world.stats = Stats::default();
            return Ok(false);
        }
        // A step that fails must not keep contacts that waking has added.
        domain.kept = domain.resting.len();
        domain.widened = domain.widening;
        domain.further.clear();
        Ok(true)
    }

    fn gather(&self, world: &mut World, dt: f32) -> Result<()> {
        domain_of_mut(world).before = None;
        let has_all = exchange_ghosts(world, dt)?;
        domain_of_mut(world).has_all = has_all;
        // Contacts with ghosts can be found only when the ghosts are there.
        recall_resting(world)
    }

    fn renew(&self, world: &mut World, dt: f32) -> Result<()> {
        renew_ghosts(world, dt)
    }

    fn begin_part(&self, world: &mut World) {
        // Particles merge in the order that they have now.
        if world.settings.on_touch == OnTouch::Merge {
            world.scratch.starts.clone_from(&world.bodies.awake.particles);
        }
        find_shared(world);
    }

    fn share_accelerations(&self, world: &mut World) -> Result<()> {
        share_accelerations(world)
    }

    fn agree_on_order(
        &self,
        world: &mut World,
        own: ContactShape,
        refinement: usize,
    ) -> Result<(ContactShape, usize)> {
        let World {
            bodies: Bodies { awake: Discs { particles, rows, .. }, .. },
            scratch,
            contacts,
            halo,
            ..
        } = world;
        let domain = Domain::of_mut(&mut **halo);
        // Before `divide`, which removes the contacts that other ranks solve.
        let of_pairs = domain.digest_colours(contacts, &scratch.contact_pairs, particles, rows);
        let (mut shape, refinement) = domain.shape_of_all(own, refinement)?;
        domain.add_pair_digests(of_pairs);
        if shape.rounds > 0 {
            shape.rounds = domain.divide(contacts.sequential(), &particles.movable, rows)?;
        }
        Ok((shape, refinement))
    }

    fn limit(&self, world: &mut World) -> Result<()> {
        let World {
            bodies: Bodies { awake: Discs { particles, rows, .. }, .. },
            scratch,
            settings,
            halo,
            ..
        } = world;
        Domain::of_mut(&mut **halo).limit(particles, rows, &settings.container, scratch);
        Ok(())
    }

    fn end_part(&self, world: &mut World) {
        digest_shared(world);
    }

    fn merge_islands(&self, world: &mut World, touching: &[[u32; 2]]) -> Result<bool> {
        let members = members_of_islands(world, touching)?;
        merge_members(world, &members)
    }

    fn gather_near(&self, world: &mut World) -> Result<()> {
        exchange_static_ghosts(world)
    }

    fn compare(&self, world: &mut World, meets_sleepers: bool) -> Result<Agreement> {
        compare_with_other_ranks(world, meets_sleepers)
    }

    fn end_step(&self, world: &mut World) {
        let has_contacts = world.contacts.has_impulses();
        let domain = domain_of_mut(world);
        domain.steps += 1;
        // The next steps need about as much.
        domain.widening = (domain.widened * NARROWING).clamp(1.0, MAX_WIDENING);
        domain.has_contacts = has_contacts;
        if !has_contacts {
            domain.resting.clear();
        }
    }

    fn undo(&self, world: &mut World) {
        let domain = domain_of_mut(world);
        // What this attempt has found out about distances is needed by the next one.
        domain.note_further();
        if let Some(count) = domain.before.take() {
            domain.restore(count);
        }
        drop_ghosts(world);
    }

    fn widen(&self, world: &mut World, agreement: Agreement, dt: f64) -> Result<()> {
        let domain = domain_of_mut(world);
        // With all particles on each rank every rank computes the same step. A difference is an
        // error of the program, and must not repeat for ever.
        if agreement == Agreement::Different && domain.has_all {
            let rule = "the ranks do not agree on the step; please report it";
            return Err(Error::of("dt", dt, rule));
        }
        // Doubling reaches all particles after at most 30 attempts, so the loop of attempts ends.
        domain.widened *= 2.0;
        domain.repeats += 1;
        Ok(())
    }

    fn give_up(&self, world: &mut World) {
        drop_ghosts(world);
        let domain = domain_of_mut(world);
        domain.resting.truncate(domain.kept);
    }

    fn wake_touched(&self, world: &mut World, touched: &[u32], all: bool) -> Result<()> {
        wake_touched(world, touched, all)
    }

    fn wake_edited(&self, world: &mut World, driven: &mut [u32], changed: &[u32]) -> Result<()> {
        wake_edited(world, driven, changed)
    }

    fn recall_contacts(&self, world: &mut World, islands: &[u32]) -> Result<()> {
        recall_contacts_of_woken(world, islands);
        Ok(())
    }

    fn drop_contacts(&self, world: &mut World) {
        drop_contacts_of_woken(world);
    }

    fn join_islands(&self, world: &mut World) -> Result<()> {
        join_islands(world)
    }

    fn keep_pairs(&self, world: &mut World) -> Result<()> {
        keep_pairs_of_sleepers(world)
    }

    fn touching_asleep(&self, world: &World) -> Result<Vec<Touched>> {
        let all = domain_of(world).map_or(&[][..], |domain| &domain.sleeping);
        let touch = all.iter().filter(|of| of.is_near || of.contact.presses());
        Ok(touch.map(|of| Touched::ascending(of.ids, of.categories)).collect())
    }
}

/// Lists the particles that other ranks have too, by their new indices.
pub(super) fn find_shared(world: &mut World) {
    let World { bodies: Bodies { awake: Discs { rows, .. }, .. }, halo, .. } = world;
    Domain::of_mut(&mut **halo).list_indices(rows);
}

/// Adds what happened to shared particles in a part of the step to their hashes, and finds those that
/// got further than announced.
pub(super) fn digest_shared(world: &mut World) {
    let World {
        bodies: Bodies { awake: Discs { rows, particles, .. }, .. }, halo, scratch, ..
    } = world;
    let domain = Domain::of_mut(&mut **halo);
    let events = &scratch.events;
    for (at, &index) in domain.shared.iter().enumerate() {
        let row = rows[index as usize] as usize;
        let motion = scratch.motions.get(index);
        let [x, y] = exact(motion.position, motion.residual);
        let [u, v] = motion.velocity.map(f64::from);
        // Motion and history together: two histories may end at the same place, and a neighbour may
        // have met only one of them.
        let mut hash = digest_all(domain.digests[row], [x, y, u, v]);
        hash = digest(hash, events.digests.get(at).copied().unwrap_or(0));
        if !scratch.spins.is_empty() {
            hash = digest_all(hash, [f64::from(scratch.spins.velocity(index))]);
        }
        domain.digests[row] = hash;
        domain.may_meet[row] |= events.may_meet.get(at).is_some_and(|&may_meet| may_meet);
    }
    // Two ways to get too far: in a history of collisions, and by the motion as a whole, which
    // contains position correction.
    for &(index, distance) in &events.beyond_reach {
        let reach = domain.announced_reaches.get(index as usize).copied();
        if distance > f64::from(reach.unwrap_or(f32::INFINITY)) {
            domain.far.push((rows[index as usize], distance as f32));
        }
    }
    for (index, &reach) in domain.announced_reaches.iter().enumerate() {
        let ([x, y], [u, v]) = (scratch.motions.position(index as u32), particles.positions[index]);
        let square = (x - u) * (x - u) + (y - v) * (y - v);
        if square > reach * reach {
            domain.far.push((rows[index], square.sqrt()));
        }
    }
}

/// Gives ghosts the accelerations that their own ranks have computed, from neighbours that this rank
/// need not have. Particles whose neighbours other ranks have not announced are noted as far.
pub(super) fn share_accelerations(world: &mut World) -> Result<()> {
    let has_accelerations = has_accelerations(&world.external, &world.influences);
    let World {
        bodies: Bodies { awake: Discs { rows, .. }, .. },
        halo,
        scratch,
        settings,
        influences,
        ..
    } = world;
    let domain = Domain::of_mut(&mut **halo);
    if locked(&domain.group).size() < 2 || !has_accelerations {
        return Ok(());
    }
    // The forces of the first sub-step come before the columns are sorted, so the indices are not
    // those that `begin_part` lists.
    domain.list_indices(rows);
    let halo: &dyn Halo = domain;
    let force = &mut scratch.forces;
    let accelerations = Cell::from_mut(&mut force.accelerations[..]).as_slice_of_cells();
    halo.wait()?;
    halo.refresh(
        |index| accelerations[index as usize].get(),
        |index, acceleration| accelerations[index as usize].set(acceleration),
    )?;
    // Neighbours within the cutoff are known if the circles with half of it are within those
    // announced.
    let half_cutoff = 0.5 * influences.largest_cutoff();
    for (&position, &row) in force.halfway.iter().zip(&*rows) {
        let Some(of) = domain.announced.get(row as usize) else { continue };
        let offset = [0, 1].map(|k| f64::from(position[k]) - f64::from(of.position[k]));
        let [x, y] = settings.container.period().exact().minimum_image(offset);
        let distance = (x * x + y * y).sqrt() as f32 * ROUNDED_UP as f32 + half_cutoff;
        if distance > of.reach {
            domain.far.push((row, distance));
        }
    }
    Ok(())
}

/// Compares the hashes of all ghosts that may meet own particles with those of their own ranks,
/// on all ranks. Refuses, on all ranks, a step that is the same on all and in which a particle
/// has too many collisions.
pub(super) fn compare_with_other_ranks(world: &World, meets_sleepers: bool) -> Result<Agreement> {
    let Some(domain) = domain_of(world) else { return Ok(Agreement::Same) };
    let halo: &dyn Halo = domain;
    if halo.is_alone() {
        return Ok(Agreement::Same);
    }
    // If a particle got too far, ghosts are missing, and the hashes mean nothing.
    if halo.any(!domain.far.is_empty())? {
        return Ok(Agreement::Further);
    }
    // A hash of the motion alone is not enough: colours decide the order of solving, and follow
    // from contacts that the other rank may not have.
    let hash = |row: u32, rank: u32| {
        let pairs = domain.own_pairs.get(&(row, rank)).copied().unwrap_or(0);
        digest(domain.digests[row as usize], pairs)
    };
    let sent = (0..).zip(&domain.sent);
    let hashes = sent.flat_map(|(rank, rows)| rows.iter().map(move |&row| hash(row, rank)));
    let to: Vec<u8> = hashes.flat_map(u64::to_le_bytes).collect();
    let sent: Vec<usize> = domain.sent.iter().map(|rows| rows.len() * 8).collect();
    let received: Vec<usize> = domain.received.iter().map(|count| count * 8).collect();
    let all = locked(&domain.group).exchange_known(&to, &sent, &received)?;
    let (all, _) = all.as_chunks::<8>();
    let differ = (domain.own..domain.ids.len()).zip(all).filter(|(row, theirs)| {
        let own = digest(domain.digests[*row], domain.ghost_pairs[*row]);
        domain.may_meet[*row] && own != u64::from_le_bytes(**theirs)
    });
    // A step that ended early, or that differs, is repeated.
    let is_refused = !meets_sleepers && world.scratch.events.has_too_many();
    // All ranks must return the same, so the numbers are added up even where this rank knows its
    // answer.
    let [different, refused] = halo.sum([differ.count() as u64, u64::from(is_refused)])?;
    if different > 0 {
        return Ok(Agreement::Different);
    }
    if is_refused {
        return Err(too_many_collisions(world));
    }
    if refused > 0 {
        // The ranks that refuse it report this now.
        halo.wait()?;
    }
    Ok(Agreement::Same)
}
