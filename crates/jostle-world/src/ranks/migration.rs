//! Migration: particles move to the ranks in whose domains they are, with what the solver keeps of them. Ghosts
//! are added and removed here too.

use std::collections::HashMap;
use std::sync::Mutex;

use super::carried::{NONE, Resting, put_kept, put_push};
use super::carried::{keep_resting, take_kept_of};
use super::domain::Domain;
use super::domain::{domain_of, domain_of_mut};
use super::reductions::sum_up;
use super::{
    Group, Scale, cuts, key, put_record, read_records, read_samples, sample, sample_positions,
};
use crate::world::World;
use crate::world::bodies::Bodies;
use crate::world::bodies::discs::Discs;
use crate::world::bodies::ids::Ids;
use crate::world::boundaries::Boundaries;
use jostle_base::bytes::{Plain, append, read_all};
use jostle_base::error::Result;
use jostle_base::parallel::locked;
use jostle_base::table::Table;
use jostle_index::period::Period;

/// What leaves this rank for each other one, as bytes.
#[derive(Debug)]
struct Leaving {
    records: Vec<Vec<u8>>,
    kept: Vec<Vec<u8>>,
    resting: Vec<Vec<u8>>,
    pushes: Vec<Vec<u8>>,
    /// External accelerations, if there are any.
    external: Vec<Vec<u8>>,
    /// The rank of each row that leaves.
    destinations: HashMap<u32, usize>,
}

/// Removes the ghosts.
pub fn drop_ghosts(world: &mut World) {
    // While the rows of ghosts still name them.
    keep_resting(world);
    if world.halo.is_whole() {
        return;
    }
    let World {
        bodies: Bodies { awake: Discs { particles, rows, persistent }, ids, .. },
        halo,
        contacts,
        external,
        ..
    } = world;
    let impulses = &mut world.boundaries.impulses;
    let domain = Domain::of_mut(&mut **halo);
    let own = domain.own;
    // A step sorts own particles and ghosts together. The gaps are filled from the end: the tree of
    // the next step sorts again, so this order decides nothing.
    if domain.has_ghosts() {
        let awake = rows.iter().filter(|&&row| domain.owns(row)).count();
        let mut end = rows.len();
        for index in 0..awake {
            if domain.owns(rows[index]) {
                continue;
            }
            // The last entries move to the indices of ghosts.
            end -= 1;
            while !domain.owns(rows[end]) {
                end -= 1;
            }
            particles.move_row(end, index);
            persistent.move_row(end, index);
            rows[index] = rows[end];
        }
        particles.resize(awake);
        persistent.resize(awake);
        rows.truncate(awake);
        domain.ids.truncate(own);
        external.resize(own);
        impulses.retain(|of| (of.row as usize) < own);
        *ids = Ids::of_rows(own);
    }
    // They name indices of ghosts; what is needed of them is kept by ids.
    contacts.forget();
    world.bodies.forget_indices();
}

/// Adds particles of other ranks after the own ones, as own ones or as ghosts.
pub(super) fn append_records(world: &mut World, bytes: &[Vec<u8>], are_own: bool) {
    let World {
        bodies: Bodies { awake: Discs { particles, rows, persistent }, ids, .. },
        halo,
        external,
        ..
    } = world;
    let domain = Domain::of_mut(&mut **halo);
    let first = domain.ids.len();
    for bytes in bytes {
        let (new, new_ids) = read_records(bytes);
        particles.extend(&new);
        domain.ids.extend(new_ids);
    }
    let len = domain.ids.len();
    rows.extend(first as u32..len as u32);
    persistent.resize(rows.len());
    external.resize(len);
    *ids = Ids::of_rows(len);
    if are_own {
        domain.own = len;
    }
    world.bodies.forget_indices();
}

/// Moves particles to the ranks of their domains, if it is time, and finds out what their properties
/// require. There must be no ghosts.
pub(super) fn move_to_domains(world: &mut World) -> Result<()> {
    let is_due = domain_of(world).is_some_and(|domain| domain.is_due());
    if is_due {
        // Particles change their rank only here, every few steps. In between they may leave the
        // domain: a rank computes its own particles wherever they are, and the halo finds their
        // neighbours. So the domains decide how much is sent, and never the result.
        rebalance(world)?;
    }
    sum_up(world)?;
    // All ranks have done it, or none.
    if is_due {
        let domain = domain_of_mut(world);
        (domain.is_stale, domain.chosen, domain.usual_ghosts) = (false, domain.steps, 0.0);
        domain.rebalances += 1;
    }
    Ok(())
}

/// Cuts the Morton curve anew, and moves particles to the ranks of their domains.
pub(super) fn rebalance(world: &mut World) -> Result<()> {
    let World { bodies: Bodies { awake: Discs { particles, .. }, .. }, halo, settings, .. } = world;
    let domain = Domain::of_mut(&mut **halo);
    if locked(&domain.group).size() < 2 {
        renumber(world);
        return Ok(());
    }
    let container = settings.container;
    let wrapped: Vec<_> =
        particles.positions.iter().map(|&at| container.period().wrap(at)).collect();
    // First scales, then keys on these scales, then cuts of the sorted keys. With quantiles as
    // scales, dense regions have as many cells as thin ones, and domains stay compact.
    domain.scales = scales_of_all(&domain.group, &wrapped, container.period())?;
    let keys: Vec<u64> = wrapped.iter().map(|&at| key(&domain.scales, at)).collect();
    let cuts = cuts_of_all(&domain.group, &keys, domain.work)?;
    let leaving = leaving(world, &keys, &cuts);
    let Some(domain) = domain_of(world) else { return Ok(()) };
    // After a failed exchange the other ranks make no further one.
    let has_external = world.external.act();
    let (records, kept, resting, pushes, external) = {
        let mut group = locked(&domain.group);
        let records = group.exchange(&leaving.records)?;
        let kept = group.exchange(&leaving.kept)?.concat();
        let resting = group.exchange(&leaving.resting)?.concat();
        let pushes = group.exchange(&leaving.pushes)?.concat();
        let external =
            if has_external { group.exchange(&leaving.external)?.concat() } else { vec![] };
        (records, kept, resting, pushes, external)
    };
    let first = leave(world, &leaving.destinations);
    append_records(world, &records, true);
    if let Some(all) = &mut world.external.accelerations {
        let new = external.chunks_exact(<[f32; 3]>::SIZE).map(<[f32; 3]>::load);
        all[first..].iter_mut().zip(new).for_each(|(to, new)| *to = new);
    }
    let Some(domain) = domain_of(world) else { return Ok(()) };
    // New particles are in the last rows.
    let rows = domain.ids[first..].iter().copied().zip(first as u32..).collect();
    let resting = read_all::<Resting>(&resting).collect();
    take_kept_of(world, &rows, [&kept, &pushes], resting)?;
    renumber(world);
    Ok(())
}

/// Gives the rows the order of the columns, so that what is stored by rows is near in memory to what is
/// stored by indices.
fn renumber(world: &mut World) {
    let World {
        bodies: Bodies { awake: Discs { rows, .. }, asleep, .. },
        halo,
        boundaries: Boundaries { impulses, .. },
        external,
        ..
    } = world;
    let domain = Domain::of_mut(&mut **halo);
    let mut new = vec![0; domain.own];
    let old: Vec<u32> = rows.iter().copied().chain(asleep.rows()).collect();
    (0..).zip(&old).for_each(|(index, &row)| new[row as usize] = index);
    if let Some(external) = &mut external.accelerations {
        *external = old.iter().map(|&row| external[row as usize]).collect();
    }
    domain.ids = old.iter().map(|&row| domain.ids[row as usize]).collect();
    asleep.renumber(&new);
    for of in &mut domain.resting {
        of.rows = of.rows.map(|row| new.get(row as usize).copied().unwrap_or(NONE));
    }
    impulses.iter_mut().for_each(|of| of.row = new[of.row as usize]);
    impulses.sort_by_key(|of| (of.row, of.wall));
    (0..).zip(rows).for_each(|(index, row)| *row = index);
    world.bodies.forget_indices();
}

/// What leaves this rank.
fn leaving(world: &World, keys: &[u64], cuts: &[u64]) -> Leaving {
    let none = || vec![Vec::new(); cuts.len() + 1];
    let mut leaving = Leaving {
        records: none(),
        kept: none(),
        resting: none(),
        pushes: none(),
        external: none(),
        destinations: HashMap::new(),
    };
    let Some(domain) = domain_of(world) else { return leaving };
    let rank = locked(&domain.group).rank();
    // Only particles that are awake have keys. Sleeping ones stay on the rank where they fell
    // asleep: they cost no time.
    for (index, key) in keys.iter().enumerate() {
        let destination = cuts.partition_point(|cut| cut <= key);
        if destination == rank {
            continue;
        }
        let row = world.bodies.awake.rows[index];
        let id = domain.id(row);
        put_record(&mut leaving.records[destination], id, &world.bodies.awake.particles, index);
        put_kept(&mut leaving.kept[destination], id, &world.bodies.awake.persistent, index);
        if let Some(external) = &world.external.accelerations {
            let bytes = external[row as usize].iter().flat_map(|a| a.to_le_bytes());
            leaving.external[destination].extend(bytes);
        }
        leaving.destinations.insert(row, destination);
    }
    for of in &domain.resting {
        let mut destinations = of.rows.map(|row| leaving.destinations.get(&row).copied());
        // Two particles that leave together take their contact once.
        if destinations[0] == destinations[1] {
            destinations[1] = None;
        }
        for destination in destinations.into_iter().flatten() {
            append(&mut leaving.resting[destination], *of);
        }
    }
    for of in &world.boundaries.impulses {
        if let Some(&destination) = leaving.destinations.get(&of.row) {
            put_push(&mut leaving.pushes[destination], domain.id(of.row), of);
        }
    }
    leaving
}

/// Removes the rows that leave; returns how many are left.
fn leave(world: &mut World, destinations: &HashMap<u32, usize>) -> usize {
    let stays: Vec<bool> =
        world.bodies.awake.rows.iter().map(|row| !destinations.contains_key(row)).collect();
    let mut left = 0;
    let own = domain_of(world).map_or(0, |domain| domain.own);
    let shifted: Vec<u32> = (0..own as u32)
        .map(|row| {
            let is_gone = destinations.contains_key(&row);
            left += u32::from(!is_gone);
            if is_gone { NONE } else { left - 1 }
        })
        .collect();
    world.bodies.keep(&stays);
    world.contacts.retain(&stays);
    let gone: Vec<bool> = shifted.iter().map(|&row| row == NONE).collect();
    world.external.remove(&gone);
    world.bodies.awake.rows.iter_mut().for_each(|row| *row = shifted[*row as usize]);
    world.bodies.asleep.renumber(&shifted);
    world.boundaries.impulses.retain_mut(|of| {
        of.row = shifted[of.row as usize];
        of.row != NONE
    });
    let domain = domain_of_mut(world);
    let ids = domain.ids.iter().zip(&shifted).filter(|(_, row)| **row != NONE);
    domain.ids = ids.map(|(id, _)| *id).collect();
    domain.own = domain.ids.len();
    for of in &mut domain.resting {
        of.rows = of.rows.map(|row| shifted.get(row as usize).copied().unwrap_or(NONE));
    }
    left as usize
}

/// The keys at which the domains of all ranks but the first begin.
fn cuts_of_all(group: &Mutex<Group>, keys: &[u64], work: f64) -> Result<Vec<u64>> {
    let mut group = locked(group);
    // All ranks gather the same samples and compute the same cuts, so no rank needs to tell the
    // others.
    let samples = sample(&mut keys.to_vec());
    let samples: Vec<u8> = samples.iter().flat_map(|key| key.to_le_bytes()).collect();
    let amounts = group.gather([(work * keys.len() as f64).to_bits()])?;
    let all = group.share(&samples)?;
    let ranks = all.iter().zip(amounts).map(|(bytes, [work])| {
        let (keys, _) = bytes.as_chunks::<8>();
        (keys.iter().map(|key| u64::from_le_bytes(*key)).collect(), f64::from_bits(work))
    });
    Ok(cuts(&ranks.collect::<Vec<_>>()))
}

/// Quantiles of the coordinates of the particles of all ranks along each axis.
fn scales_of_all(
    group: &Mutex<Group>,
    positions: &[[f32; 2]],
    period: Period<f32>,
) -> Result<[Scale; 2]> {
    let mut group = locked(group);
    let own = sample_positions(positions, group.size());
    let amounts = group.gather([positions.len() as u64])?;
    let all = group.share(&own)?;
    let ranks = all.iter().zip(amounts).map(|(bytes, [count])| (&bytes[..], count as f64));
    let samples = read_samples(ranks);
    let side = |k: usize| period.is_along(k).then(|| period.exact().sides()[k]);
    Ok([0, 1].map(|k| Scale::new(&samples[k], side(k))))
}
