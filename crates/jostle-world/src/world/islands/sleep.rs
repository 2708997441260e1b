//! Falling asleep: islands that rest are taken out of the columns that a step works on.
//!
//! At the end of each quarter of a second, an island falls asleep if each of its members rests on a particle or a
//! wall or has a spring, at least one of them rests on a wall or a static particle or has a spring to a static one,
//! if each has been slow in this quarter and in the previous one, if the largest mean speed has not grown from one
//! to the other, and if the mean velocity of the island has hardly changed. Discs that begin to
//! topple move slowly for longer, but faster and faster; a disc that reverses its direction on a slope is slow
//! for a while, but its velocity changes steadily.

use super::groups::is_member;
use super::motion::{note_motions, quarter};
use super::{Islands, NONE};
use crate::contacts::{Contact, Contacts};
use crate::forces::{Influence, Influences, Partners, Role};
use crate::walls::Walls;
use crate::world::bodies::asleep::{Island, Sleepers};
use crate::world::bodies::discs::{Discs, RecentMotion};
use crate::world::force_step::awake_springs;
use crate::world::plan::Plan;
use crate::world::settings::{OnTouch, WorldSettings};
use crate::world::{StepScratch, World};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_base::table::{Table, dense};

/// Whether anything may fall asleep with these settings, forces and walls.
pub(crate) fn may_sleep(settings: &WorldSettings, influences: &Influences, walls: &Walls) -> bool {
    // A force that acts at a distance would have to wake what it moves. Springs connect
    // particles of one island, or an island and an immovable particle. What is grabbed stays awake.
    let lets_rest = |influence: &Influence| match influence.role() {
        Role::Springs(_) | Role::Motor(_) | Role::Thermostat(_) => true,
        Role::Force(force) => matches!(force.partners(), Partners::One(_)),
        Role::ThermalWalls(_) | Role::Andersen(_) | Role::Pump(_) => false,
    };
    settings.sleeping
        && settings.on_touch == OnTouch::Bounce
        && settings.gravity != [0.0; 2]
        && influences.list().iter().all(lets_rest)
        && !walls.move_any()
}

/// Puts the islands to sleep that rest at the end of a step of `dt` seconds. If there is an
/// error, the step can be undone.
pub(crate) fn fall_asleep(world: &mut World, plan: &Plan, dt: f64) -> Result<()> {
    let World { bodies, settings, influences, boundaries, external, scratch, .. } = world;
    let discs = &mut bodies.awake;
    if plan.is_lossless || !may_sleep(settings, influences, &boundaries.walls) {
        discs.persistent.recent_motions.clear();
        return Ok(());
    }
    note_motions(
        discs,
        settings,
        &scratch.exhausted,
        external.accelerations.as_deref(),
        dt,
        plan.threads,
    )?;
    // A grabbed particle may be released or moved in the next frame, so its rest does not count.
    for row in influences.grabbed() {
        let index = scratch.forces.indices[row as usize];
        if let Some(recent) = discs.persistent.recent_motions.get_mut(index as usize) {
            *recent = RecentMotion::UNKNOWN;
        }
    }
    if quarter(world.time) == quarter(world.time + dt) {
        return Ok(());
    }
    world.islands.end_quarter(discs, settings.gravity)?;
    if list_sleepers(world)? {
        let World { bodies, contacts, boundaries, halo, islands, .. } = &mut *world;
        let mut sleepers = islands.take(&bodies.awake)?;
        let lasting = islands.contacts_of_sleepers(contacts)?;
        let rows = &bodies.awake.rows;
        // Those of a distributed world are kept with ids.
        if !halo.keep_contacts(&sleepers, &lasting, &bodies.awake)? {
            let by_rows = |(island, contact): (u32, Contact)| {
                let indices = contact.indices.map(|index| rows[index as usize]);
                (island, Contact { indices, ..contact })
            };
            sleepers.set_contacts(memory::collect(lasting.into_iter().map(by_rows))?)?;
        }
        boundaries.copy_to(&mut sleepers)?;
        put_to_sleep(world, sleepers)?;
    }
    Ok(())
}

/// Lists the members of the islands that fall asleep; returns false if there are none
/// on any process.
fn list_sleepers(world: &mut World) -> Result<bool> {
    let own = world.halo.own_rows();
    world.islands.members.clear();
    // Most quarters end without a slow particle. Then this question is all that ranks exchange.
    let may_sleep = world.islands.any_is_slow(&world.bodies.awake, own);
    if !world.halo().any(may_sleep)? {
        return Ok(false);
    }
    find_islands(world, own)?;
    world.halo.protocol().join_islands(world)?;
    let World { bodies, islands: Islands { first, motions, members, .. }, .. } = &mut *world;
    let Discs { particles, rows, .. } = &bodies.awake;
    for (index, &first) in (0..).zip(&*first) {
        let is_at_rest = motions[first as usize].is_at_rest();
        if is_at_rest && is_member(particles, index) && rows[index as usize] < own {
            memory::push(members, [first, index])?;
        }
    }
    members.sort_unstable();
    // Other ranks wait for this one in what follows, also if it has no member.
    Ok(!world.halo.is_alone() || !world.islands.members.is_empty())
}

/// Finds which particles belong together, because they touched in the step, may come near each
/// other by themselves or a spring connects them, what each rests on, and how the islands move. Candidate pairs do not
/// count: which there are depends on the speeds of all particles.
fn find_islands(world: &mut World, own: u32) -> Result<()> {
    let World { bodies, contacts, boundaries, scratch, influences, islands, .. } = world;
    let StepScratch { contact_pairs, events, forces, .. } = scratch;
    let indices = &forces.indices;
    let tied = awake_springs(influences, indices)
        .map(|spring| spring.pair.map(|row| indices[row as usize]));
    // Three reasons join two particles: they may have come near each other by themselves in the
    // step, they touched in it, or a spring connects them.
    let touching = contacts.touching().map(|contact| contact.indices);
    let near = contact_pairs.iter().flat_map(|(_, pairs)| pairs).chain(&events.sensed);
    islands.group(&bodies.awake, own, near.copied().chain(touching).chain(tied.clone()))?;
    islands.find_rests(&bodies.awake, contacts, &boundaries.impulses, tied)?;
    islands.sum_motions(&bodies.awake, own)
}

impl Islands {
    /// The islands that fall asleep, at rest, without their contacts. They are still among the others,
    /// too.
    pub(crate) fn take(&mut self, discs: &Discs) -> Result<Sleepers> {
        let Discs { particles, rows, persistent } = discs;
        let Self { members, island_of, names, .. } = self;
        let mut new = Sleepers::default();
        new.discs.reserve(discs, members.len())?;
        let order = memory::collect(members.iter().map(|&[_, index]| index))?;
        let discs = &mut new.discs;
        discs.particles.gather(particles, &order, Some(1));
        discs.particles.velocities.fill([0.0; 2]);
        discs.particles.spins.iter_mut().for_each(|spin| spin.velocity = 0.0);
        discs.particles.simplify();
        dense::gather(&mut discs.rows, rows, &order, Some(1));
        discs.persistent.gather(persistent, &order, Some(1));
        // After waking, an island is observed for two whole quarters again.
        discs.persistent.recent_motions.clear();
        island_of.clear();
        memory::resize(island_of, rows.len(), NONE)?;
        let mut start = 0;
        for (island, members) in (0..).zip(members.chunk_by(|a, b| a[0] == b[0])) {
            members.iter().for_each(|&[_, index]| island_of[index as usize] = island);
            let particles = start..start + members.len() as u32;
            start = particles.end;
            let name = names.get(members[0][0] as usize).copied().unwrap_or_default();
            memory::push(&mut new.islands, Island { particles, name, ..Island::default() })?;
        }
        Ok(new)
    }

    /// The contacts of islands that fall asleep, each with the number of its island, sorted by these.
    fn contacts_of_sleepers(&self, contacts: &Contacts) -> Result<Vec<(u32, Contact)>> {
        let lasting = contacts.lasting().filter_map(|contact| {
            // Neither a static particle nor one that stays awake is in a new island. A kinematic
            // one keeps its island awake.
            let islands = contact.indices.map(|index| self.island_of[index as usize]);
            // `NONE` is the largest number, so the smaller one is an island if there is one.
            let island = islands.into_iter().min().filter(|&island| island != NONE);
            island.map(|island| (island, *contact))
        });
        let mut all = Vec::new();
        memory::extend(&mut all, lasting)?;
        // The contacts of an island keep the canonical order.
        all.sort_unstable_by(|(a, own), (b, other)| a.cmp(b).then_with(|| own.compare(other)));
        Ok(all)
    }
}

/// Which particles stay awake, with memory to remove the others.
pub(crate) fn kept_awake(world: &mut World) -> Result<Vec<bool>> {
    let keep = memory::collect(world.islands.island_of.iter().map(|&island| island == NONE))?;
    world.contacts.reserve_retain(keep.len())?;
    Ok(keep)
}

/// Moves islands to the sleeping ones. If there is an error on any process, nothing changes.
fn put_to_sleep(world: &mut World, sleepers: Sleepers) -> Result<()> {
    // The tree, the pairs and the messages may fail on any process. All processes exchange their
    // errors first. Only then particles leave the columns, so an error leaves all where they are.
    let count = sleepers.islands.len();
    // What removes them from the columns must not fail.
    let keep = kept_awake(world)?;
    let done = match count {
        0 => Ok(()),
        _ => world.bodies.asleep.append(&sleepers, world.settings.tree),
    };
    let is_appended = done.is_ok();
    let done = done.and_then(|()| world.halo.protocol().keep_pairs(world));
    let done = done.and_then(|()| world.halo().wait());
    if done.is_err() {
        if is_appended {
            world.bodies.asleep.withdraw(count);
        }
        world.halo.protocol().drop_contacts(world);
        return done;
    }
    world.record.knows_sleepers = false;
    remove_sleepers(world, sleepers, &keep);
    Ok(())
}

/// Removes particles that sleep now from those that are awake.
pub(crate) fn remove_sleepers(world: &mut World, mut sleepers: Sleepers, keep: &[bool]) {
    sleepers.discs.rows.sort_unstable();
    world.boundaries.drop_rows(&sleepers.discs.rows);
    world.bodies.keep(keep);
    world.contacts.retain(keep);
}
