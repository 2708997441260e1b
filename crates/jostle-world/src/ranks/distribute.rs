//! Makes a world the part of a distributed world that a rank has, and writes its own particles as records.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::Mutex;

use super::domain::Domain;
use super::domain::{domain_of, domain_of_mut};
use super::{Communicator, Group, RECORD, Traffic, put_record, read_records};
use crate::forces::{Influence, Role};
use crate::world::World;
use crate::world::bodies::asleep::Asleep;
use crate::world::islands::wake::wake_all;
use crate::world::plan::are_own_lossless;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::parallel::locked;

/// The particles of a rank.
#[derive(Debug)]
pub struct OwnParticles {
    /// Their number, which is that of the first rows.
    pub own: usize,
    /// The ids of all rows.
    pub ids: Vec<Id>,
    /// The number of particles of all ranks.
    pub total: usize,
    /// What this rank has sent.
    pub traffic: Traffic,
    /// Steps that were repeated because ghosts were missing.
    pub repeats: u64,
    /// How often domains were chosen.
    pub rebalances: u64,
}

/// Makes a world a part of a larger one, of which each rank has a part. All ranks have the same
/// settings, walls and forces, and this rank's particles have these ids in the whole, ascending.
pub fn distribute(
    world: &mut World,
    communicator: Box<dyn Communicator>,
    ids: Vec<Id>,
) -> Result<()> {
    check_distributable(world)?;
    // Sleeping islands of one process have no names, by which ranks know them.
    wake_all(world)?;
    let mut group = Group::new(communicator);
    let mut total = [ids.len() as u64];
    group.sum(&mut total)?;
    let (ranks, [total]) = (group.size(), total.map(|total| total as usize));
    world.halo = Box::new(Domain {
        group: Mutex::new(group),
        ranks,
        own: ids.len(),
        ids,
        next: total as Id,
        total,
        awake: total,
        asleep: 0,
        is_still: false,
        sleeping: Vec::new(),
        foreign: Asleep::default(),
        touched: Vec::new(),
        announced_reaches: Vec::new(),
        is_lossless: are_own_lossless(world),
        has_friction: true,
        scales: Default::default(),
        extent: None,
        announced: Vec::new(),
        sent: Vec::new(),
        received: Vec::new(),
        has_contacts: false,
        resting: Vec::new(),
        kept: 0,
        has_all: false,
        before: None,
        sent_indices: Vec::new(),
        ghost_indices: Vec::new(),
        ghost_ranks: Vec::new(),
        ghost_pairs: Vec::new(),
        own_pairs: HashMap::new(),
        digests: Vec::new(),
        may_meet: Vec::new(),
        is_sent: Vec::new(),
        is_own: Vec::new(),
        shared: Vec::new(),
        far: Vec::new(),
        steps: 0,
        repeats: 0,
        widening: 1.0,
        widened: 1.0,
        further: HashMap::new(),
        is_static: false,
        work: 1.0,
        rebalance_every: None,
        is_stale: true,
        chosen: 0,
        rebalances: 0,
        usual_ghosts: 0.0,
    });
    Ok(())
}

/// Refuses what a distributed world cannot do.
pub fn check_distributable(world: &World) -> Result<()> {
    // A rank knows only particles near its own ones. A force of all particles needs all, and the
    // ends of springs and what a motor drives may be on other ranks.
    let is_local = |influence: &Influence| match influence.role() {
        Role::Force(force) => force.partners().cutoff().is_some(),
        Role::Springs(_) | Role::Motor(_) => false,
        Role::Thermostat(_) | Role::ThermalWalls(_) | Role::Andersen(_) | Role::Pump(_) => true,
    };
    let influences = world.influences.list();
    let Some(index) = influences.iter().position(|influence| !is_local(influence)) else {
        return Ok(());
    };
    let rule = "a distributed world has PairForce, Flocking, Thermostat, ThermalWalls, \
                AndersenThermostat and Pump only";
    Err(Error::at("forces", index, influences[index].noun(), rule))
}

/// The particles of this rank; None if the world is not distributed.
pub fn own_particles(world: &World) -> Option<OwnParticles> {
    domain_of(world).map(|domain| OwnParticles {
        own: domain.own,
        ids: domain.ids.clone(),
        total: domain.total,
        traffic: locked(&domain.group).traffic,
        repeats: domain.repeats,
        rebalances: domain.rebalances,
    })
}

/// The number of own particles, and that of all ranks.
pub fn own_and_all(world: &World) -> (usize, usize) {
    match domain_of(world) {
        None => (world.len(), world.len()),
        Some(domain) => (domain.own, domain.total),
    }
}

/// The number of own particles that are awake.
pub fn own_awake(world: &World) -> usize {
    own_and_all(world).0 - world.bodies.asleep.len()
}

/// The own particles as records, see [`read_records`]; all with their rows as ids, if the world is not
/// distributed.
pub fn own_records(world: &World) -> Result<Vec<u8>> {
    let Some(domain) = domain_of(world) else { return records_of(world, 0..world.len()) };
    let mut bytes = Vec::with_capacity(domain.own * RECORD);
    for (index, &row) in
        world.bodies.awake.rows.iter().enumerate().filter(|(_, row)| domain.owns(**row))
    {
        put_record(&mut bytes, domain.id(row), &world.bodies.awake.particles, index);
    }
    let discs = &world.bodies.asleep.sleepers().discs;
    for at in world.bodies.asleep.indices() {
        put_record(&mut bytes, domain.id(discs.rows[at]), &discs.particles, at);
    }
    Ok(bytes)
}

/// A world with the particles in some rows of another, and the settings, walls, forces and time.
pub fn part(world: &World, rows: Range<usize>) -> Result<World> {
    of_records(world, &records_of(world, rows)?)
}

fn records_of(world: &World, rows: Range<usize>) -> Result<Vec<u8>> {
    let (all, mut bytes) = (world.bodies.particles()?, Vec::new());
    rows.for_each(|row| put_record(&mut bytes, row as Id, &all, row));
    Ok(bytes)
}

/// A world with the settings, walls, forces, attachment and time of another, and the particles of some records.
pub fn of_records(like: &World, bytes: &[u8]) -> Result<World> {
    let (particles, _) = read_records(bytes);
    // The setters check everything again, because records of a file may be forged.
    let mut world = World::new(particles, like.settings)?;
    world.copy_walls(like)?;
    world.set_forces(like.forces()?)?;
    world.attachment.clone_from(&like.attachment);
    world.time = like.time;
    Ok(world)
}

/// Tells how much time this rank needs for each of its particles, from which the next domains
/// follow. Results do not depend on it.
pub fn set_work(world: &mut World, work: f64) {
    // Measured times differ from run to run. They decide who computes a particle, never what is
    // computed.
    if !world.halo.is_whole() && work > 0.0 && work.is_finite() {
        domain_of_mut(world).work = work;
    }
}

/// Chooses domains anew after so many steps, the same number on all ranks, whatever the imbalance.
pub fn rebalance_every(world: &mut World, steps: u64) {
    if !world.halo.is_whole() {
        domain_of_mut(world).rebalance_every = Some(steps.max(1));
    }
}
