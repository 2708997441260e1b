//! Adding, removing and changing particles of a distributed world. All ranks make the same calls.

use super::domain::Domain;
use super::domain::{domain_of, domain_of_mut};
use super::migration::{append_records, drop_ghosts};
use super::read_records;
use crate::world::World;
use crate::world::bodies::ids::Ids;
use crate::world::edits::{Removal, take_out};
use crate::world::islands::wake::{wake_all, wake_to_stay};
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::parallel::locked;

/// What a rank tells the others of its changes: whether all islands wake, the immovable particles of
/// which only the velocities change, and the names of islands that wake.
#[derive(Debug, Default, PartialEq)]
struct Changed {
    wakes_all: bool,
    driven: Vec<Id>,
    names: Vec<Id>,
}

impl Changed {
    fn words(&self) -> Vec<u8> {
        let head = [Id::from(self.wakes_all), self.driven.len() as Id, self.names.len() as Id];
        let all = head.iter().chain(&self.driven).chain(&self.names);
        all.flat_map(|word| word.to_le_bytes()).collect()
    }

    /// Joins those of all ranks.
    fn join(all: &[Vec<u8>]) -> Self {
        let mut joined = Self::default();
        for bytes in all {
            let (words, _) = bytes.as_chunks::<8>();
            let words: Vec<Id> = words.iter().map(|word| Id::from_le_bytes(*word)).collect();
            // The words come from other ranks of the same program, not from a file, so they are
            // trusted.
            let [wakes_all, driven, _] = [words[0], words[1], words[2]];
            let (driven, names) = words[3..].split_at(driven as usize);
            joined.wakes_all |= wakes_all > 0;
            joined.driven.extend_from_slice(driven);
            joined.names.extend_from_slice(names);
        }
        joined.driven.sort_unstable();
        joined
    }
}

impl Domain {
    /// The names of islands that touch one of some particles, which are sorted.
    fn islands_touching(&self, ids: &[Id]) -> Vec<Id> {
        let is_one = |id: &Id| ids.binary_search(id).is_ok();
        let touch = self.sleeping.iter().filter(|of| of.ids.iter().any(is_one));
        touch.map(|of| of.island).collect()
    }
}

/// Wakes the islands that changes of any rank concern: `driven` are rows of immovable particles of
/// which only the velocities change, `changed` those of other changes.
pub(super) fn wake_edited(world: &mut World, driven: &[u32], changed: &[u32]) -> Result<()> {
    let Some(domain) = domain_of(world) else { return Ok(()) };
    let indices = world.bodies.indices_of(changed)?;
    let islands = world.bodies.islands_of(&indices)?;
    let own = Changed {
        wakes_all: indices.iter().any(|&index| world.bodies.is_immovable(index)),
        driven: driven.iter().map(|&row| domain.id(row)).collect(),
        names: world.bodies.asleep.names(&islands).collect(),
    };
    // A message of all ranks in any case: this rank cannot know whether others have changes.
    let Changed { wakes_all, driven, mut names } =
        Changed::join(&locked(&domain.group).share(&own.words())?);
    // All ranks have the same `driven`, so all enter here or none. The contacts of a sleeping
    // island are on several ranks, of which each knows some that touch.
    if !driven.is_empty() && !wakes_all {
        let names_only = Changed { names: domain.islands_touching(&driven), ..Changed::default() };
        let all = locked(&domain.group).share(&names_only.words())?;
        names.extend(Changed::join(&all).names);
    }
    names.sort_unstable();
    let islands = if wakes_all {
        world.bodies.asleep.islands().collect()
    } else {
        world.bodies.asleep.named(&names)?
    };
    wake_to_stay(world, &islands)
}

/// Adds particles to this rank, with ids among the particles of all ranks, which are above all ids
/// before; `count` are added on all ranks.
pub fn add(world: &mut World, records: Vec<u8>, ids: &[Id], count: usize) -> Result<()> {
    drop_ghosts(world);
    // As in one process: steps do not test immovable particles against sleeping ones.
    let is_fixed = !read_records(&records).0.movable.iter().all(|&movable| movable);
    if world.halo().any(is_fixed)? {
        wake_all(world)?;
    }
    let Some(domain) = domain_of(world) else { return Ok(()) };
    let first = domain.own;
    append_records(world, &[records], true);
    let domain = domain_of_mut(world);
    // The ids in the records are those of the caller; ids of the whole world replace them.
    domain.ids[first..].copy_from_slice(ids);
    domain.total += count;
    domain.next += count as Id;
    // New particles are on any rank. The next step moves them to their domains.
    domain.is_stale = true;
    Ok(())
}

/// Removes the particles with some ids, which all ranks give, each once. The islands of removed
/// particles wake; all wake if an immovable one is removed.
pub fn remove(world: &mut World, ids: &[Id]) -> Result<()> {
    drop_ghosts(world);
    let Some(domain) = domain_of(world) else { return Ok(()) };
    let mut ids = ids.to_vec();
    ids.sort_unstable();
    let is_gone = |id: &Id| ids.binary_search(id).is_ok();
    let gone: Vec<bool> = domain.ids.iter().map(is_gone).collect();
    let rows: Vec<u32> = (0..).zip(&gone).filter(|(_, gone)| **gone).map(|of| of.0).collect();
    // While the rows still have their old meaning.
    wake_edited(world, &[], &rows)?;
    let removal = Removal::new(world, gone)?;
    let Removal { gone, shifted, .. } = take_out(world, removal);
    let domain = domain_of_mut(world);
    crate::world::bodies::ids::retain_unless(&mut domain.ids, &gone);
    domain.own = domain.ids.len();
    domain.total -= ids.len();
    domain.resting.retain_mut(|of| {
        // `NONE` stays what it is, because it is no index of the list.
        of.rows = of.rows.map(|row| shifted.get(row as usize).copied().unwrap_or(row));
        !of.ids.iter().any(is_gone)
    });
    world.bodies.ids = Ids::of_rows(world.halo.own_rows() as usize);
    // Their pairs are reported as `left` at the end of the record, so they are kept apart.
    world.record.pairs.set_apart(|pair| pair.iter().any(is_gone));
    world.record.walls.set_apart(|[id, _]| is_gone(&id));
    world.external.end_if_zero(&*world.halo)
}

/// The ids of the particles of this rank, and the id that is given next.
pub fn own_ids(world: &World) -> Result<(Vec<Id>, Id)> {
    Ok(match domain_of(world) {
        Some(domain) => (domain.ids[..domain.own].to_vec(), domain.next),
        None => (world.bodies.ids()?, world.bodies.ids.parts().1),
    })
}

/// Replaces the ids of all rows, ascending, and the id that is given next; in a distributed world those
/// of this rank. Refuses ids that no world can have.
pub fn set_ids(world: &mut World, ids: &[Id], next: Id) -> Result<()> {
    if !world.halo.is_whole() {
        domain_of_mut(world).next = next;
        return Ok(());
    }
    let has_gaps = !ids.iter().copied().eq(0..next);
    world.bodies.ids = Ids::read(has_gaps.then(|| ids.to_vec()), world.len(), next)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_of_ranks_are_joined() {
        let one = Changed { wakes_all: false, driven: vec![9, 4], names: vec![7] };
        let other = Changed { wakes_all: true, driven: vec![5], names: vec![2, 8] };
        let joined = Changed::join(&[one.words(), Changed::default().words(), other.words()]);
        assert_eq!(
            joined,
            Changed { wakes_all: true, driven: vec![4, 5, 9], names: vec![7, 2, 8] }
        );
    }
}
