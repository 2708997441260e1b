//! Distributed connected components: islands whose particles may be on several ranks.
//!
//! Each rank groups its particles and the ghosts that touch them. The groups with ghosts go to all ranks,
//! with the groups that the ghosts have on their own ranks. So all ranks join the same groups, and decide
//! the same.

use std::collections::{BTreeMap, HashMap};

use super::domain::Domain;
use crate::contacts::Contact;
use crate::halo::Halo;
use crate::world::World;
use crate::world::bodies::Bodies;
use crate::world::bodies::discs::Discs;
use crate::world::islands::motion::IslandMotion;
use crate::world::islands::{Islands, NONE};
use crate::world::touching::find_touching_of;

use jostle_base::bytes::{Reader, Saved, Writer};
use jostle_base::disjoint_sets::DisjointSets;
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::parallel::locked;
use jostle_base::{plain, saved};

/// Stands for no name.
const NO_NAME: Id = Id::MAX;

/// A contact of a sleeping particle, which may be with a particle of another rank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SleepingContact {
    /// The name of the island.
    pub(crate) island: Id,
    /// The ids of both. The first sleeps; if both do, it is the smaller one.
    pub(crate) ids: [Id; 2],
    /// The categories of both, which cannot change while the island sleeps.
    pub(crate) categories: [u32; 2],
    /// The contact in the last step in which the island was awake. Its indices have no meaning.
    pub(crate) contact: Contact,
    /// Whether their surfaces touched at the end of that step, as far as this is wanted.
    pub(crate) is_near: bool,
}

plain! { SleepingContact { ids, island, categories, contact, is_near } }

impl SleepingContact {
    /// A contact whose indices have these ids and categories.
    pub(crate) fn new(
        island: Id,
        [a, b]: [Id; 2],
        categories: [u32; 2],
        contact: &Contact,
    ) -> Self {
        let is_first = match contact.inverse_masses.map(|inverse| inverse > 0.0) {
            [true, true] => a < b,
            [is_first, _] => is_first,
        };
        let (ids, indices) = if is_first { ([a, b], [0, 1]) } else { ([b, a], [1, 0]) };
        let contact = Contact { indices, ..*contact }.ascending();
        let categories = indices.map(|at| categories[at as usize]);
        Self { island, ids, categories, contact, is_near: false }
    }
}

/// A group of particles of one rank that touch ghosts.
struct Group {
    /// The smallest id of its own particles.
    label: Id,
    motion: IslandMotion,
    /// The labels of the groups of its ghosts on their own ranks.
    others: Vec<Id>,
}

saved! { struct Group { label, motion, others } }

/// Joins groups to islands: the name of each and how it moves, by the labels of its groups.
fn join(groups: &[Group]) -> Result<HashMap<Id, (Id, IslandMotion)>> {
    let labels = |of: &Group| [&[of.label], &of.others[..]].concat();
    let mut all: Vec<Id> = groups.iter().flat_map(labels).collect();
    all.sort_unstable();
    all.dedup();
    let number = |label: &Id| all.partition_point(|of| of < label) as u32;
    let mut sets = DisjointSets::default();
    sets.reset(all.len())?;
    for of in groups {
        of.others.iter().for_each(|other| sets.join(number(&of.label), number(other)));
    }
    let mut motions = vec![IslandMotion::default(); all.len()];
    for of in groups {
        motions[sets.root(number(&of.label)) as usize].join(&of.motion);
    }
    let island = |label: &Id| {
        let root = sets.root(number(label)) as usize;
        (*label, (all[root], motions[root]))
    };
    Ok(all.iter().map(island).collect())
}

/// Gives the islands of this rank's particles their names, and how all their members on all ranks have
/// moved.
pub(super) fn join_islands(world: &mut World) -> Result<()> {
    let World { bodies: Bodies { awake: Discs { rows, .. }, .. }, halo, islands, .. } = world;
    let domain = Domain::of_mut(&mut **halo);
    let Islands { first, motions, names, .. } = islands;
    names.clear();
    names.resize(rows.len(), NO_NAME);
    // The smallest id of its own particles names a group. It depends on no rows.
    for (&first, &row) in first.iter().zip(&*rows).filter(|(_, row)| domain.owns(**row)) {
        let name = &mut names[first as usize];
        *name = (*name).min(domain.id(row));
    }
    if locked(&domain.group).size() < 2 {
        return Ok(());
    }
    // Only groups with ghosts can be parts of larger islands. Others keep their names and their
    // motion.
    let own = groups_with_ghosts(domain, (first, names), motions)?;
    let mut to = Writer::default();
    to.put_count(own.len());
    own.values().for_each(|group| group.put(&mut to));
    let mut groups: Vec<Group> = Vec::new();
    // Every rank reads the groups in the order of ranks and joins them in the same way.
    for bytes in locked(&domain.group).share(&to.into_bytes()?)? {
        groups.append(&mut Saved::get(&mut Reader::without_head(&bytes))?);
    }
    let islands = join(&groups)?;
    for (first, group) in own {
        (names[first as usize], motions[first as usize]) = islands[&group.label];
    }
    Ok(())
}

/// Keeps the pairs of islands that fall asleep whose surfaces touch, if events are tracked.
pub(super) fn keep_pairs_of_sleepers(world: &mut World) -> Result<()> {
    if !world.settings.track_events {
        return Ok(());
    }
    // Ghosts are still there, so pairs of two ranks are found, too.
    let particles = &world.bodies.awake.particles;
    let scratch = &mut world.scratch.touching;
    let pairs: Vec<[u32; 2]> = find_touching_of(particles, &world.settings, scratch)?.collect();
    let World {
        bodies: Bodies { awake: Discs { particles, rows, .. }, .. }, halo, islands, ..
    } = world;
    let domain = Domain::of_mut(&mut **halo);
    let Islands { island_of, first, names, .. } = islands;
    for pair in pairs {
        let sleeps = |&index: &u32| island_of[index as usize] != NONE;
        let Some(index) = pair.into_iter().find(sleeps) else { continue };
        let island = names[first[index as usize] as usize];
        let ids = pair.map(|index| domain.id(rows[index as usize]));
        let inverse_masses = pair.map(|index| particles.inverse_mass(index as usize));
        let contact = Contact { inverse_masses, ..Contact::default() };
        let categories = pair.map(|index| particles.filter(index as usize).category);
        let new = SleepingContact::new(island, ids, categories, &contact);
        domain.sleeping.push(SleepingContact { is_near: true, ..new });
    }
    Ok(())
}

/// Removes the contacts of islands that do not sleep.
pub(super) fn drop_contacts_of_woken(world: &mut World) {
    let World { bodies: Bodies { asleep, .. }, halo, .. } = world;
    let domain = Domain::of_mut(&mut **halo);
    if domain.sleeping.is_empty() {
        return;
    }
    let islands: Vec<u32> = asleep.islands().collect();
    let mut names: Vec<Id> = asleep.names(&islands).collect();
    names.sort_unstable();
    domain.sleeping.retain(|of| names.binary_search(&of.island).is_ok());
}

/// The groups of own particles with ghosts, by their first indices.
fn groups_with_ghosts(
    domain: &Domain,
    (first, names): (&[u32], &[Id]),
    motions: &[IslandMotion],
) -> Result<BTreeMap<u32, Group>> {
    let label = |index: u32| names[first[index as usize] as usize];
    let mut groups = BTreeMap::new();
    // Each ghost brings the label of its group on its own rank. That is the edge between two
    // groups.
    let ghosts = (domain as &dyn Halo).labels(|index| label(index) as u64)?;
    for (index, other) in ghosts {
        // A ghost that touches no own particle is in no group of this rank.
        if label(index) == NO_NAME {
            continue;
        }
        let first = first[index as usize];
        let (label, motion) = (label(index), motions[first as usize]);
        let new = || Group { label, motion, others: Vec::new() };
        groups.entry(first).or_insert_with(new).others.push(other as Id);
    }
    for group in groups.values_mut() {
        group.others.sort_unstable();
        group.others.dedup();
    }
    Ok(groups)
}

#[cfg(test)]
mod tests {
    use super::*;
    use jostle_base::bytes::{append, read_all};

    fn group(label: Id, others: &[Id], square: f32) -> Group {
        let motion = IslandMotion { squares: [square, 0.5], count: 2, ..IslandMotion::default() };
        Group { label, motion, others: others.to_vec() }
    }

    #[test]
    fn groups_of_a_chain_of_ranks_are_one_island() {
        let groups = [
            group(9, &[4], 0.1),
            group(4, &[9, 7], 0.3),
            group(7, &[4], 0.2),
            group(5, &[6], 0.0),
            group(6, &[5], 0.0),
        ];
        let islands = join(&groups).unwrap();
        for label in [9, 4, 7] {
            let (name, motion) = islands[&label];
            assert_eq!((name, motion.squares, motion.count), (4, [0.3, 0.5], 6));
        }
        assert_eq!((islands[&6].0, islands[&6].1.count, islands[&5].0), (5, 4, 5));
    }

    #[test]
    fn groups_and_contacts_are_read_as_they_were_written() {
        let mut of = group(3, &[1, 2], 0.25);
        of.motion = IslandMotion { is_supported: true, change: [-5, 0, 1 << 40], ..of.motion };
        let mut to = Writer::default();
        of.put(&mut to);
        of.put(&mut to);
        let bytes = to.into_bytes().unwrap();
        let mut from = Reader::without_head(&bytes);
        for _ in 0..2 {
            let found = Group::get(&mut from).unwrap();
            assert_eq!((found.label, found.motion, found.others), (3, of.motion, vec![1, 2]));
        }
        from.close().unwrap();
        let contact = Contact {
            indices: [0, 1],
            image: [1.0, 2.0],
            normal: [0.6, 0.8],
            gap: -0.25,
            impulse: 3.0,
            friction_impulse: -4.0,
            totals: [5.0, 6.0],
            touched: true,
            ..Contact::default()
        };
        let (ids, categories) = ([9, 1 << 40], [7, 1 << 31]);
        let of = SleepingContact { island: 8, ids, categories, contact, is_near: true };
        let mut bytes = Vec::new();
        append(&mut bytes, of);
        assert_eq!(read_all::<SleepingContact>(&bytes).collect::<Vec<_>>(), [of]);
    }

    #[test]
    fn the_first_particle_of_a_sleeping_contact_is_movable() {
        let of = |inverse_masses: [f32; 2], ids: [Id; 2]| {
            let contact = Contact { normal: [0.0, 1.0], inverse_masses, ..Contact::default() };
            let kept = SleepingContact::new(0, ids, ids.map(|id| id as u32), &contact);
            assert_eq!(kept.categories, kept.ids.map(|id| id as u32));
            (kept.ids, kept.contact.normal)
        };
        assert_eq!(of([1.0, 1.0], [5, 2]), ([2, 5], [0.0, -1.0]));
        assert_eq!(of([1.0, 0.0], [5, 2]), ([5, 2], [0.0, 1.0]));
        assert_eq!(of([0.0, 1.0], [2, 5]), ([5, 2], [0.0, -1.0]));
    }
}
