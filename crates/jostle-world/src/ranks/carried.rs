//! Serialization of what the solver keeps of particles from step to step, for a distributed world: the impulses for
//! warm starting, how each particle has moved, and which sleep.

use std::collections::HashMap;

use super::domain::{domain_of, domain_of_mut};
use super::islands::SleepingContact;
use crate::contacts::Contact;
use crate::resting::WallImpulse;
use crate::world::World;
use crate::world::bodies::Bodies;
use crate::world::bodies::asleep::Sleepers;
use crate::world::bodies::discs::Discs;
use crate::world::bodies::discs::Persistent;
use crate::world::islands::sleep::{kept_awake, remove_sleepers};
use crate::world::touches::{Touch, touch_of};
use jostle_base::bytes::{Plain, Reader, append, damaged, read_all};
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::memory;
use jostle_base::plain;
use jostle_base::table::{Declared, Table, Value, Visitor, VisitorMut, sparse_value};

/// Stands for no own row.
pub(crate) const NONE: u32 = u32::MAX;

/// The impulses of a contact at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Resting {
    /// The ids of both. The first is movable; if both are, it is the smaller one.
    pub(crate) ids: [Id; 2],
    /// Their rows, [`NONE`] if this rank does not know them as own ones.
    pub(crate) rows: [u32; 2],
    /// Along the normal, and of friction.
    pub(crate) impulses: [f32; 2],
}

// Other ranks have other rows.
plain! { Resting { ids, impulses; rows } }

/// Bytes of what is kept of a particle: its id and its row of [`Persistent`].
pub(crate) const KEPT: usize = Id::SIZE + Persistent::ROW_SIZE;

/// Appends what is kept of the particle at an index, if it differs from that of a new particle.
pub(crate) fn put_kept(to: &mut Vec<u8>, id: Id, persistent: &Persistent, index: usize) {
    let start = to.len();
    append(to, id);
    let mut row = PutRow { to, row: index, is_default: true };
    persistent.visit(&mut row);
    // Most particles keep nothing. Then the receiver has the default, too, and nothing is sent.
    if row.is_default {
        to.truncate(start);
    }
}

/// Appends a row of all columns.
struct PutRow<'a> {
    to: &'a mut Vec<u8>,
    row: usize,
    is_default: bool,
}

impl Visitor for PutRow<'_> {
    fn column<V: Value>(&mut self, _about: Declared, column: &[V]) {
        let value = sparse_value(column, self.row);
        self.is_default &= value == V::default();
        append(self.to, value);
    }
}

/// Reads a row of all columns, which have `len` rows or are empty.
struct GetRow<'a, 'b> {
    from: &'a mut Reader<'b>,
    row: usize,
    len: usize,
}

impl VisitorMut for GetRow<'_, '_> {
    fn column<V: Value>(&mut self, _about: Declared, column: &mut Vec<V>) -> Result<()> {
        let value: V = self.from.get()?;
        if value != V::default() {
            column.resize(self.len, V::default());
            column[self.row] = value;
        }
        Ok(())
    }
}

/// The impulses of a wall on a particle, with its id.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Push {
    pub(crate) id: Id,
    pub(crate) wall: u32,
    /// As in [`WallImpulse`].
    pub(crate) impulses: [f32; 2],
    pub(crate) pushes: [f32; 2],
}

plain! { Push { id, wall, impulses, pushes } }

impl Push {
    /// Those of a wall.
    pub(crate) fn new(id: Id, &WallImpulse { wall, impulses, pushes, .. }: &WallImpulse) -> Self {
        Self { id, wall, impulses, pushes }
    }

    /// The impulses of the wall on the particle in a row.
    pub(crate) fn of_row(&self, row: u32) -> WallImpulse {
        let Self { wall, impulses, pushes, .. } = *self;
        WallImpulse { row, wall, impulses, pushes }
    }
}

/// The id of a sleeping particle and the name of its island.
pub(crate) type Member = [Id; 2];

/// What is kept of particles, as bytes: [`KEPT`], [`Resting`], [`Push`], members of sleeping islands,
/// [`SleepingContact`].
pub(crate) type Parts<'a> = [&'a [u8]; 5];

/// Keeps the impulses of the contacts at rest of own particles, before ghosts are removed.
pub(super) fn keep_resting(world: &mut World) {
    // Contacts with ghosts are kept by ids, which only rows that are still there have.
    if domain_of(world).is_some_and(|domain| domain.has_contacts) {
        let resting = resting_of_own(world);
        let domain = domain_of_mut(world);
        (domain.resting, domain.has_contacts) = (resting, false);
    }
}

/// The contacts at rest that own particles had after the last step.
fn resting_of_own(world: &World) -> Vec<Resting> {
    let World { bodies: Bodies { awake: Discs { particles, rows, .. }, .. }, contacts, .. } = world;
    let Some(domain) = domain_of(world) else { return Vec::new() };
    if !domain.has_contacts {
        return domain.resting.clone();
    }
    let ids = &domain.ids;
    let resting = |contact: &Contact| {
        // Impulses across the sides of a torus are not kept.
        if !contact.presses() || contact.image != [0.0; 2] {
            return None;
        }
        let mut indices = contact.indices.map(|index| index as usize);
        // The first particle says on which rank a contact is counted, so all ranks must choose the
        // same one.
        indices.sort_unstable_by_key(|&at| (!particles.movable[at], ids[rows[at] as usize]));
        let both = indices.map(|at| rows[at]);
        // The rank of an immovable particle may lack neighbours of the movable one. Then its
        // impulse of this contact is not the right one.
        let both_move = particles.movable[indices[1]];
        let is_known = domain.owns(both[0]) || both_move && domain.owns(both[1]);
        is_known.then(|| Resting {
            ids: both.map(|row| ids[row as usize]),
            rows: both.map(|row| if domain.owns(row) { row } else { NONE }),
            impulses: [contact.impulse, contact.friction_impulse],
        })
    };
    contacts.lasting().filter_map(resting).collect()
}

/// What is kept of own particles, as bytes: of each particle; contacts at rest, each on the rank of its
/// first particle; the pushes of walls; which sleep; and the contacts of these.
pub fn own_kept(world: &World) -> [Vec<u8>; 5] {
    let mut bytes = [vec![], vec![], vec![], vec![], vec![]];
    let Some(domain) = domain_of(world) else { return bytes };
    let [kept, resting, pushes, members, touches] = &mut bytes;
    for (index, &row) in
        world.bodies.awake.rows.iter().enumerate().filter(|(_, row)| domain.owns(**row))
    {
        put_kept(kept, domain.id(row), &world.bodies.awake.persistent, index);
    }
    let all = resting_of_own(world);
    // Both ranks of a pair know the contact. The rank of the first particle writes it.
    all.iter().filter(|of| of.rows[0] != NONE).for_each(|of| append(resting, *of));
    for of in world.boundaries.impulses.iter().filter(|of| domain.owns(of.row)) {
        put_push(pushes, domain.id(of.row), of);
    }
    let Sleepers { discs, islands, .. } = world.bodies.asleep.sleepers();
    for island in world.bodies.asleep.islands().map(|number| &islands[number as usize]) {
        for at in island.particles.clone().map(|at| at as usize) {
            let id = domain.id(discs.rows[at]);
            put_kept(kept, id, &discs.persistent, at);
            append::<Member>(members, [id, island.name]);
        }
    }
    for of in world.bodies.asleep.wall_impulses() {
        append(pushes, Push::new(domain.id(of.row), of));
    }
    own_sleeping_contacts(world).for_each(|of| append(touches, *of));
    bytes
}

/// The contacts of sleeping particles of which the first is an own one.
pub(super) fn own_sleeping_contacts(world: &World) -> impl Iterator<Item = &SleepingContact> {
    let domain = domain_of(world);
    let id = |row: u32| domain.map_or(0, |domain| domain.id(row));
    // Rows of sleeping particles differ from rank to rank, so contacts are found by ids.
    let mut ids: Vec<Id> = world.bodies.asleep.rows().map(id).collect();
    ids.sort_unstable();
    let all = domain.map_or(&[][..], |domain| &domain.sleeping);
    all.iter().filter(move |of| ids.binary_search(&of.ids[0]).is_ok())
}

/// Of a distributed world: the pairs of sleeping islands, as in the last step in which these were awake,
/// with the ids among the particles of all ranks. Each is on one rank.
pub fn own_touches_asleep(world: &World) -> Vec<Touch> {
    let touched = own_sleeping_contacts(world).filter(|of| of.contact.touched);
    touched.map(|of| touch_of(&of.contact, of.ids, of.categories)).collect()
}

/// Takes what [`own_kept`] returned for the particles of a world, in any order. Returns an
/// error if it is of other particles or walls.
pub fn take_kept(world: &mut World, bytes: Parts<'_>) -> Result<()> {
    let ids: Vec<Id> = match domain_of(world) {
        Some(domain) => domain.ids[..domain.own].to_vec(),
        None => world.bodies.ids()?,
    };
    let rows: HashMap<Id, u32> = ids.into_iter().zip(0..).collect();
    let [kept, resting, pushes, members, touches] = bytes;
    let members: HashMap<Id, Id> = read_all::<Member>(members).map(Into::into).collect();
    // The contacts of sleeping particles are among `touches`.
    let is_awake = |of: &Resting| !of.ids.iter().any(|id| members.contains_key(id));
    let resting = read_all::<Resting>(resting).filter(is_awake);
    take_kept_of(world, &rows, [kept, pushes], resting.collect())?;
    restore_sleepers(world, &rows, &members, read_all(touches).collect())
}

/// Adds what is kept of the particles with these ids, in these rows: of each, of walls, and contacts at
/// rest.
pub(super) fn take_kept_of(
    world: &mut World,
    rows: &HashMap<Id, u32>,
    [kept, pushes]: [&[u8]; 2],
    resting: Vec<Resting>,
) -> Result<()> {
    let unknown = || damaged("an impulse is on no particle");
    let row_of = |id: Id| rows.get(&id).copied().ok_or_else(unknown);
    let count = world.bodies.awake.rows.len();
    let indices = memory::copy(world.bodies.indices()?)?;
    // Bytes of a file are not trusted: an unknown id is an error, and no index.
    for of in kept.chunks_exact(KEPT) {
        let mut from = Reader::without_head(of);
        let row = row_of(from.get()?)?;
        let index = indices[row as usize] as usize;
        world.bodies.awake.persistent.visit_mut(&mut GetRow {
            from: &mut from,
            row: index,
            len: count,
        })?;
    }
    let pushes = read_all::<Push>(pushes).map(|push| Ok(push.of_row(row_of(push.id)?)));
    let pushes = pushes.collect::<Result<Vec<_>>>()?;
    memory::reserve(&mut world.boundaries.impulses, pushes.len())?;
    world.boundaries.insert(&pushes);
    take_resting(world, rows, resting.into_iter())
}

/// Puts particles to sleep that slept when they were written; `members` has the island of each.
fn restore_sleepers(
    world: &mut World,
    rows: &HashMap<Id, u32>,
    members: &HashMap<Id, Id>,
    touches: Vec<SleepingContact>,
) -> Result<()> {
    let row_of = |id: Id| rows.get(&id).copied();
    let indices = world.bodies.indices()?;
    let index = |(&id, &island): (&Id, &Id)| Some((island, indices[row_of(id)? as usize]));
    let mut all: Vec<(Id, u32)> = members.iter().filter_map(index).collect();
    all.sort_unstable();
    // A file may be forged. Immovable particles never sleep, and the steps rely on it.
    if all.len() < members.len()
        || all.iter().any(|of| !world.bodies.awake.particles.movable[of.1 as usize])
    {
        return Err(damaged("no such particle sleeps"));
    }
    // The lists are filled as if the islands fell asleep now, so that the same functions take them
    // out of the columns.
    let islands = &mut world.islands;
    islands.members.clear();
    islands.names.clear();
    islands.names.resize(world.bodies.awake.rows.len(), 0);
    for island in all.chunk_by(|a, b| a.0 == b.0) {
        let (name, first) = island[0];
        islands.members.extend(island.iter().map(|&(_, index)| [first, index]));
        islands.names[first as usize] = name;
    }
    islands.members.sort_unstable();
    let mut new = islands.take(&world.bodies.awake)?;
    world.boundaries.copy_to(&mut new)?;
    if world.halo.is_whole() {
        new.set_contacts(contacts_of_rows(&new, &touches, row_of)?)?;
    } else {
        domain_of_mut(world).sleeping = touches;
    }
    if new.islands.is_empty() {
        return Ok(());
    }
    let keep = kept_awake(world)?;
    world.bodies.asleep.append(&new, world.settings.tree)?;
    remove_sleepers(world, new, &keep);
    Ok(())
}

/// Adds contacts at rest.
fn take_resting(
    world: &mut World,
    rows: &HashMap<Id, u32>,
    new: impl Iterator<Item = Resting>,
) -> Result<()> {
    let known = |of: Resting| {
        let rows = [0, 1].map(|k| rows.get(&of.ids[k]).copied().unwrap_or(NONE));
        Resting { rows, ..of }
    };
    if world.halo.is_whole() {
        let all: Vec<Resting> = new.map(known).collect();
        if all.iter().any(|of| of.rows.contains(&NONE)) {
            return Err(damaged("an impulse is on no particle"));
        }
        return insert_resting(world, &all, |_| None);
    }
    let domain = domain_of_mut(world);
    domain.resting.extend(new.map(known));
    let mut unknown: HashMap<Id, u32> = HashMap::new();
    for of in &domain.resting {
        let missing = of.rows.iter().zip(of.ids).filter(|(row, _)| **row == NONE);
        unknown.extend(missing.map(|(_, id)| (id, NONE)));
    }
    // An immovable particle may have been on this rank when it did not know the other one.
    for (id, row) in domain.ids[..domain.own].iter().zip(0..) {
        unknown.entry(*id).and_modify(|known| *known = row);
    }
    for of in &mut domain.resting {
        for (row, id) in of.rows.iter_mut().zip(of.ids) {
            *row = unknown.get(&id).copied().unwrap_or(*row);
        }
    }
    // A contact that this rank had before knows both rows.
    let unknown = |of: &Resting| of.rows.iter().filter(|&&row| row == NONE).count();
    // Both ranks of a pair may send its contact to the same rank. One of them is kept.
    domain.resting.sort_by_key(|of| (of.ids, unknown(of)));
    domain.resting.dedup_by_key(|of| of.ids);
    // Without a particle of this rank the contact has no use here.
    domain.resting.retain(|of| unknown(of) < 2);
    Ok(())
}

/// Gives the contacts at rest their impulses of the step before, when the ghosts are there.
pub(super) fn recall_resting(world: &mut World) -> Result<()> {
    let Some(domain) = domain_of(world) else { return Ok(()) };
    if domain.resting.is_empty() {
        return Ok(());
    }
    // Own rows are known already. Those of ghosts change with each exchange.
    let ghosts = (domain.own as u32..).zip(&domain.ids[domain.own..]);
    let rows_of: HashMap<Id, u32> = ghosts.map(|(row, &id)| (id, row)).collect();
    let resting = domain.resting.clone();
    insert_resting(world, &resting, |id| rows_of.get(&id).copied())
}

/// Adds contacts with their impulses; `row_of` has the rows that they do not know.
fn insert_resting(
    world: &mut World,
    all: &[Resting],
    row_of: impl Fn(Id) -> Option<u32>,
) -> Result<()> {
    let indices = world.bodies.indices()?;
    let contact = |of: &Resting| {
        let row = |k: usize| match of.rows[k] {
            NONE => row_of(of.ids[k]),
            row => Some(row),
        };
        let indices = [row(0)?, row(1)?].map(|row| indices[row as usize]);
        let [impulse, friction_impulse] = of.impulses;
        Some(Contact { indices, impulse, friction_impulse, ..Contact::default() })
    };
    let all: Vec<Contact> = all.iter().filter_map(contact).collect();
    let count = world.bodies.awake.rows.len();
    world.contacts.reserve_insert(all.len(), count)?;
    world.contacts.insert(all.into_iter(), count);
    Ok(())
}

/// Appends the pushes of a wall on a particle, if there are any.
pub(crate) fn put_push(to: &mut Vec<u8>, id: Id, of: &WallImpulse) {
    if of.pushes[0] > 0.0 {
        append(to, Push { impulses: [0.0; 2], ..Push::new(id, of) });
    }
}

/// The contacts of sleeping islands with rows in place of ids, and the number of the island of each.
fn contacts_of_rows(
    new: &Sleepers,
    touches: &[SleepingContact],
    row_of: impl Fn(Id) -> Option<u32>,
) -> Result<Vec<(u32, Contact)>> {
    let numbers: HashMap<Id, u32> = new.islands.iter().map(|of| of.name).zip(0..).collect();
    let mut all = Vec::new();
    for of in touches {
        let indices = of.ids.map(&row_of);
        let ([Some(a), Some(b)], Some(&number)) = (indices, numbers.get(&of.island)) else {
            return Err(damaged("no such particle sleeps"));
        };
        // Pairs that only touch have no contact.
        if of.contact.touched || of.contact.presses() {
            all.push((number, Contact { indices: [a, b], ..of.contact }));
        }
    }
    all.sort_by_key(|&(number, _)| number);
    Ok(all)
}
