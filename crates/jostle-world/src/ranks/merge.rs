//! Merging of particles that touch in a distributed world.
//!
//! An island of touching particles may be on several ranks. All ranks get the groups of touching particles
//! that other ranks may have a part of, and join them. The members of an island go to the rank of the
//! smallest id, which merges them in the order in which one process has them.

use std::collections::HashMap;

use super::carried::Push;
use super::domain::{domain_of, domain_of_mut};
use super::reductions::sum_up;
use super::{RECORD, put_record, read_records};
use crate::particles::Particles;
use crate::world::bodies::Bodies;
use crate::world::bodies::discs::Discs;
use crate::world::bodies::ids::Ids;
use crate::world::bodies::ids::{renumber, retain_unless};
use crate::world::boundaries::Boundaries;
use crate::world::edits::{Removal, take_out};
use crate::world::external::joint_acceleration;
use crate::world::merge::union;
use crate::world::{StepScratch, World};
use jostle_base::bytes::{Reader, Saved, Writer};
use jostle_base::disjoint_sets::DisjointSets;
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::parallel::locked;
use jostle_base::saved;
use jostle_base::table::Table;
use jostle_index::quadtree::Quadtree;
use jostle_index::shapes::{Each, Shapes};

/// An own particle of an island that may merge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Member {
    index: u32,
    /// The smallest id of the island, which the merged particle has.
    island: Id,
    /// The rank of the particle with this id.
    rank: usize,
}

/// What is sent of a member to the rank that merges its island, beside the states of the member.
#[derive(Clone, Debug, PartialEq)]
struct Details {
    island: Id,
    /// The rank of the member.
    rank: usize,
    external: [f32; 3],
    is_exhausted: bool,
    /// The impulses of walls in the step.
    pushes: Vec<Push>,
}

// The receiver knows whose message it is.
saved! { struct Details { island, external, is_exhausted, pushes; rank } }

/// Members from all ranks, in the order in which one process has them.
struct Arrived {
    /// Their states at the beginning of the part of the step, and at its end.
    states: [Particles; 2],
    details: Vec<Details>,
    /// The order of all.
    order: Vec<usize>,
}

/// A merged particle.
struct Merged {
    island: Id,
    particle: Particles,
    external: [f32; 3],
    is_exhausted: bool,
    pushes: Vec<Push>,
    /// The index of the first member among those that have arrived.
    first: usize,
}

/// Own particles of islands of touching particles, in the order of indices.
pub(super) fn members_of_islands(world: &World, touching: &[[u32; 2]]) -> Result<Vec<Member>> {
    let Some(domain) = domain_of(world) else { return Ok(Vec::new()) };
    let is_sent = |row: u32| domain.is_sent.get(row as usize).is_some_and(|&is_sent| is_sent);
    let mut groups = DisjointSets::default();
    groups.reset(world.bodies.awake.rows.len())?;
    touching.iter().for_each(|&[a, b]| groups.join(a, b));
    let mut indices: Vec<[u32; 2]> =
        touching.iter().flatten().map(|&index| [groups.root(index), index]).collect();
    indices.sort_unstable();
    indices.dedup();
    let rank = locked(&domain.group).rank();
    let (mut own, mut words, mut shared) = (Vec::new(), Vec::new(), Vec::new());
    for group in indices.chunk_by(|a, b| a[0] == b[0]) {
        let rows = group.iter().map(|&[_, index]| world.bodies.awake.rows[index as usize]);
        // A group without ghosts, and without particles that are ghosts elsewhere, is a whole
        // island. Others are sent to all ranks, which join them.
        if rows.clone().any(|row| !domain.owns(row) || is_sent(row)) {
            // A particle near immovable ones of other ranks need not be a ghost there.
            let indices = group.iter().map(|&[_, index]| index);
            shared
                .extend(indices.filter(|&index| !is_sent(world.bodies.awake.rows[index as usize])));
            words.push(group.len() as u64);
            words.extend(rows.flat_map(|row| [domain.id(row) as u64, domain.rank_of(row) as u64]));
        } else {
            let island = rows.map(|row| domain.id(row)).min().unwrap_or_default();
            own.extend(group.iter().map(|&[_, index]| Member { index, island, rank }));
        }
    }
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    let all = locked(&domain.group).share(&bytes)?.concat();
    let islands = join(&all)?;
    // Another rank may have found that an own particle touches one of its own. This rank then has
    // the particle in no group of its own.
    let sent = (0..).zip(&world.bodies.awake.rows).filter(|&(_, &row)| is_sent(row));
    let shared = shared.into_iter().chain(sent.map(|(index, _)| index));
    own.extend(shared.filter_map(|index| {
        let row = world.bodies.awake.rows[index as usize];
        let &(island, rank) = islands.get(&domain.id(row)).filter(|_| domain.owns(row))?;
        Some(Member { index, island, rank })
    }));
    own.sort_unstable_by_key(|of| of.index);
    Ok(own)
}

/// Merges islands. Returns whether particles of any rank merged; if so, all ghosts have been removed.
pub(super) fn merge_members(world: &mut World, members: &[Member]) -> Result<bool> {
    let to = put_members(world, members)?;
    let Some(domain) = domain_of(world) else { return Ok(false) };
    // Members travel to the rank of the smallest id. The names of the islands that have merged
    // travel back, because `union` may refuse an island, and its members stay then.
    let arrived = locked(&domain.group).exchange(&to)?;
    let arrived = read_members(world, &arrived)?;
    let merged = unions(world, &arrived);
    let Some(domain) = domain_of(world) else { return Ok(false) };
    let mut names = vec![Vec::new(); to.len()];
    let islands: HashMap<Id, ()> = merged.iter().map(|of| (of.island, ())).collect();
    for of in arrived.details.iter().filter(|of| islands.contains_key(&of.island)) {
        names[of.rank].extend((of.island as u64).to_le_bytes());
    }
    let names = locked(&domain.group).exchange(&names)?.concat();
    let (names, _) = names.as_chunks::<8>();
    let mut names: Vec<Id> = names.iter().map(|name| Id::from_le_bytes(*name)).collect();
    names.sort_unstable();
    let has_merged = |of: &&Member| names.binary_search(&of.island).is_ok();
    let members: Vec<Member> = members.iter().filter(has_merged).copied().collect();
    // All ranks must know whether anything has merged, because all repeat the search for overlaps
    // then.
    let gone = members.iter().filter(|of| id_of_index(world, of.index) != of.island).count();
    let [gone] = world.halo().sum([gone as u64])?;
    if gone == 0 {
        return Ok(false);
    }
    let before = &mut world.scratch.before;
    before.ids.get_or_insert_with(|| world.bodies.ids.clone());
    let domain = domain_of_mut(world);
    if domain.before.is_none() {
        domain.before = Some(domain.count());
    }
    write_merged(world, &members, &merged, &arrived.states[0]);
    remove_members(world, &members)?;
    domain_of_mut(world).total -= gone as usize;
    sum_up(world)?;
    world.external.end_if_zero(&*world.halo)?;
    Ok(true)
}

fn id_of_index(world: &World, index: u32) -> Id {
    world.halo.id_among_all(&world.bodies.ids, world.bodies.awake.rows[index as usize])
}

/// Members as bytes, for the ranks that merge them.
fn put_members(world: &World, members: &[Member]) -> Result<Vec<Vec<u8>>> {
    let Some(domain) = domain_of(world) else { return Ok(Vec::new()) };
    let mut to = vec![Vec::new(); locked(&domain.group).size()];
    let mut pushes: HashMap<u32, Vec<Push>> = HashMap::new();
    for of in &world.boundaries.impulses {
        pushes.entry(of.row).or_default().push(Push::new(0, of));
    }
    for &Member { index, island, rank } in members {
        let (at, row) = (index as usize, world.bodies.awake.rows[index as usize]);
        let to = &mut to[rank];
        put_record(to, domain.id(row), &world.scratch.starts, at);
        put_record(to, domain.id(row), &world.bodies.awake.particles, at);
        let external = world.external.of(row);
        let is_exhausted = world.scratch.exhausted.binary_search(&row).is_ok();
        let pushes = pushes.remove(&row).unwrap_or_default();
        let mut details = Writer::default();
        Details { island, rank, external, is_exhausted, pushes }.put(&mut details);
        to.extend(details.into_bytes()?);
    }
    Ok(to)
}

/// Reads members, and puts them in order.
fn read_members(world: &World, from: &[Vec<u8>]) -> Result<Arrived> {
    let (mut starts, mut ends, mut details) = (Vec::new(), Vec::new(), Vec::new());
    for (rank, bytes) in from.iter().enumerate() {
        let mut from = Reader::without_head(bytes);
        while !from.is_empty() {
            for records in [&mut starts, &mut ends] {
                records.extend(from.get::<[u8; RECORD]>()?);
            }
            details.push(Details { rank, ..Saved::get(&mut from)? });
        }
    }
    let (starts, ids) = read_records(&starts);
    // The order of one process: that of its tree over the positions at the beginning of the part,
    // with the extent of all ranks, ties by state and id. Sums in `union` have the same bits then.
    let tie = |a: usize, b: usize| starts.compare(a, b).then_with(|| ids[a].cmp(&ids[b]));
    let centers = starts.positions.clone();
    let shapes = Shapes::circles(centers, Each::One(0.0))?;
    let mut tree = Quadtree::default();
    tree.set_extent(world.scratch.tree.extent());
    tree.set_nested();
    tree.rebuild_unchecked(&shapes, world.settings.tree, &tie)?;
    let order = tree.rows().iter().map(|&row| row as usize).collect();
    Ok(Arrived { states: [starts, read_records(&ends).0], details, order })
}

/// Merges the islands whose members have arrived. Those that cannot merge are left out.
fn unions(world: &World, arrived: &Arrived) -> Vec<Merged> {
    let Arrived { states: [_, ends], details, order } = arrived;
    let mut all = order.clone();
    all.sort_by_key(|&at| details[at].island);
    // The sort by islands is stable, so members keep this order.
    let islands = all.chunk_by(|&a, &b| details[a].island == details[b].island);
    let merge = |members: &[usize]| {
        let particle = union(ends, members, &world.settings.container)?;
        let external =
            members.iter().map(|&at| ([ends.masses[at], ends.radii[at]], details[at].external));
        Some(Merged {
            island: details[members[0]].island,
            particle,
            external: joint_acceleration(external),
            is_exhausted: members.iter().any(|&at| details[at].is_exhausted),
            pushes: members.iter().flat_map(|&at| details[at].pushes.clone()).collect(),
            first: members[0],
        })
    };
    islands.filter_map(merge).collect()
}

/// Writes merged particles over those of their members that keep their ids, and gives them what has been
/// recorded of all in this step: the impulses of walls, and that one was exhausted. Their
/// resting impulses begin with 0.
fn write_merged(world: &mut World, members: &[Member], merged: &[Merged], starts: &Particles) {
    let rows: Vec<u32> =
        members.iter().map(|of| world.bodies.awake.rows[of.index as usize]).collect();
    let mut has_merged = vec![false; world.bodies.awake.rows.len()];
    rows.iter().for_each(|&row| has_merged[row as usize] = true);
    let heirs: HashMap<Id, u32> = members
        .iter()
        .filter(|of| id_of_index(world, of.index) == of.island)
        .map(|of| (of.island, of.index))
        .collect();
    let World {
        bodies: Bodies { awake: Discs { particles, .. }, .. }, scratch, boundaries, ..
    } = world;
    let StepScratch { exhausted, starts: own_starts, .. } = scratch;
    let Boundaries { impulses, pushes, .. } = boundaries;
    // What belonged to members comes back with the merged particle, from all ranks.
    impulses.retain(|of| !has_merged[of.row as usize]);
    pushes.retain(|of| !has_merged[of.row as usize]);
    exhausted.retain(|&row| !has_merged[row as usize]);
    for of in merged {
        let Some(&index) = heirs.get(&of.island) else { continue };
        let (len, at, row) = (
            world.bodies.awake.rows.len(),
            index as usize,
            world.bodies.awake.rows[index as usize],
        );
        particles.put(len, at, &of.particle, 0);
        own_starts.put(len, at, starts, of.first);
        impulses.extend(of.pushes.iter().map(|push| push.of_row(row)));
        exhausted.extend(of.is_exhausted.then_some(row));
        world.external.set(row, of.external);
    }
    exhausted.sort_unstable();
}

/// Removes the members that are part of others now, and all ghosts.
fn remove_members(world: &mut World, members: &[Member]) -> Result<()> {
    let Some(domain) = domain_of(world) else { return Ok(()) };
    let mut gone: Vec<bool> =
        (0..world.bodies.awake.rows.len() as u32).map(|row| !domain.owns(row)).collect();
    let mut merged = Vec::new();
    for of in members {
        let row = world.bodies.awake.rows[of.index as usize];
        if domain.id(row) != of.island {
            gone[row as usize] = true;
            merged.push([domain.id(row), of.island]);
        }
    }
    merged.sort_unstable();
    let keep: Vec<bool> = world.bodies.awake.rows.iter().map(|&row| !gone[row as usize]).collect();
    world.scratch.starts.keep(&keep);
    let removal = Removal::new(world, gone)?;
    let Removal { gone, shifted, .. } = take_out(world, removal);
    world.boundaries.renumber_pushes(&gone, &shifted);
    renumber(&mut world.scratch.exhausted, |row| row, (&gone, &shifted));
    world.bodies.ids = Ids::of_rows(world.bodies.awake.rows.len());
    let domain = domain_of_mut(world);
    retain_unless(&mut domain.ids, &gone);
    domain.own = domain.ids.len();
    if !merged.is_empty() {
        world.record.add_merged(merged)?;
    }
    Ok(())
}

/// Joins groups of all ranks to islands: the smallest id and its rank, by the ids of members. A group is its
/// length, then the id and the rank of each member.
fn join(bytes: &[u8]) -> Result<HashMap<Id, (Id, usize)>> {
    let (words, _) = bytes.as_chunks::<8>();
    let mut words = words.iter().map(|word| u64::from_le_bytes(*word));
    let mut groups: Vec<Vec<(Id, usize)>> = Vec::new();
    while let Some(len) = words.next() {
        let mut next = || words.next().unwrap_or_default();
        groups.push((0..len).map(|_| (next() as Id, next() as usize)).collect());
    }
    let mut all: Vec<(Id, usize)> = groups.iter().flatten().copied().collect();
    all.sort_unstable();
    all.dedup();
    let number = |of: &(Id, usize)| all.partition_point(|other| other < of) as u32;
    let mut sets = DisjointSets::default();
    sets.reset(all.len())?;
    for group in &groups {
        group.iter().for_each(|of| sets.join(number(&group[0]), number(of)));
    }
    let island = |of: &(Id, usize)| (of.0, all[sets.root(number(of)) as usize]);
    Ok(all.iter().map(island).collect())
}
