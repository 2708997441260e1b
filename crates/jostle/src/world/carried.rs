//! What the solver keeps from step to step beside the particles, for a distributed world: the impulses of
//! resting contacts, and those of walls.

use std::collections::HashMap;

use super::World;
use super::touches::WallImpulse;
use crate::bytes::{Plain, damaged};
use crate::contacts::Contact;
use crate::container::MAX_WALLS;
use crate::error::Result;
use crate::space::Id;

/// Stands for no own row.
pub(super) const NONE: u32 = u32::MAX;

/// The impulses of a contact at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Resting {
    /// The ids of both, the smaller first.
    pub(super) ids: [Id; 2],
    /// Their rows, [`NONE`] for particles of other ranks.
    pub(super) rows: [u32; 2],
    /// Along the normal, and of friction.
    pub(super) impulses: [f32; 2],
}

impl Resting {
    /// Bytes of a contact.
    pub(super) const SIZE: usize = 24;

    /// Appends the contact without its rows.
    pub(super) fn put(&self, to: &mut Vec<u8>) {
        let start = to.len();
        to.resize(start + Self::SIZE, 0);
        self.ids.map(|id| id as u64).store(&mut to[start..start + 16]);
        self.impulses.store(&mut to[start + 16..]);
    }

    /// Reads one.
    pub(super) fn get(from: &[u8]) -> Self {
        let ids = <[u64; 2]>::load(&from[..16]).map(|id| id as Id);
        Self { ids, rows: [NONE; 2], impulses: <[f32; 2]>::load(&from[16..]) }
    }
}

/// The impulses of the sides of the container on a particle, with its id.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sides {
    pub(super) id: Id,
    /// Impulses over mass along the normals, and of friction.
    pub(super) impulses: [[f32; MAX_WALLS]; 2],
}

impl Sides {
    /// Bytes of the impulses.
    pub(super) const SIZE: usize = 40;

    /// Appends them.
    pub(super) fn put(&self, to: &mut Vec<u8>) {
        let start = to.len();
        to.resize(start + Self::SIZE, 0);
        (self.id as u64).store(&mut to[start..start + 8]);
        self.impulses.store(&mut to[start + 8..]);
    }

    /// Reads them.
    pub(super) fn get(from: &[u8]) -> Self {
        Self { id: u64::load(&from[..8]) as Id, impulses: Plain::load(&from[8..]) }
    }
}

/// A push of a wall on a particle, with its id.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Push {
    pub(super) id: Id,
    pub(super) wall: u32,
    pub(super) pushes: [f32; 2],
}

impl Push {
    /// Bytes of a push.
    pub(super) const SIZE: usize = 20;

    /// Appends the push.
    pub(super) fn put(&self, to: &mut Vec<u8>) {
        let start = to.len();
        to.resize(start + Self::SIZE, 0);
        (self.id as u64).store(&mut to[start..start + 8]);
        self.wall.store(&mut to[start + 8..start + 12]);
        self.pushes.store(&mut to[start + 12..]);
    }

    /// Reads one.
    pub(super) fn get(from: &[u8]) -> Self {
        let (id, wall) = (u64::load(&from[..8]) as Id, u32::load(&from[8..12]));
        Self { id, wall, pushes: <[f32; 2]>::load(&from[12..]) }
    }

    /// The impulse with this push, of the particle in a row.
    pub(super) fn of_row(&self, row: u32) -> WallImpulse {
        let Self { wall, pushes, .. } = *self;
        WallImpulse { row, wall, impulses: [0.0; 2], pushes }
    }
}

impl World {
    /// Keeps the impulses of the contacts at rest of own particles, before ghosts are removed.
    pub(super) fn keep_resting(&mut self) {
        if self.domain.as_ref().is_some_and(|domain| domain.has_contacts) {
            let resting = self.resting_of_own();
            if let Some(domain) = &mut self.domain {
                (domain.resting, domain.has_contacts) = (resting, false);
            }
        }
    }

    /// The contacts at rest that own particles had after the last step.
    fn resting_of_own(&self) -> Vec<Resting> {
        let Self { domain, contacts, rows, .. } = self;
        let Some(domain) = domain else { return Vec::new() };
        if !domain.has_contacts {
            return domain.resting.clone();
        }
        let ids = &domain.ids;
        let resting = |contact: &Contact| {
            // Impulses across the sides of a torus are not kept.
            let is_kept = contact.impulse > 0.0 && contact.image == [0.0; 2];
            let mut both = contact.places.map(|place| rows[place as usize]);
            both.sort_unstable_by_key(|&row| ids[row as usize]);
            let is_own = both.iter().any(|&row| domain.owns(row));
            (is_kept && is_own).then(|| Resting {
                ids: both.map(|row| ids[row as usize]),
                rows: both.map(|row| if domain.owns(row) { row } else { NONE }),
                impulses: [contact.impulse, contact.friction_impulse],
            })
        };
        contacts.lasting().filter_map(resting).collect()
    }

    /// What the solver keeps of own particles, as bytes: the impulses of sides, of contacts at rest, each on
    /// the rank of the smaller id, and of walls.
    pub fn own_impulses(&self) -> [Vec<u8>; 3] {
        let mut bytes = [vec![], vec![], vec![]];
        let Some(domain) = &self.domain else { return bytes };
        let [sides, resting, pushes] = &mut bytes;
        for (place, &row) in self.rows.iter().enumerate().filter(|(_, row)| domain.owns(**row)) {
            self.put_sides(sides, domain.id(row), place);
        }
        let all = self.resting_of_own();
        all.iter().filter(|of| of.rows[0] != NONE).for_each(|of| of.put(resting));
        for of in self.wall_impulses.iter().filter(|of| domain.owns(of.row)) {
            put_push(pushes, domain.id(of.row), of);
        }
        bytes
    }

    /// Appends the impulses of the sides on a particle, if there are any.
    pub(super) fn put_sides(&self, to: &mut Vec<u8>, id: Id, place: usize) {
        let pushes = self.persistent.wall_pushes[place];
        let frictions = self.persistent.wall_frictions.get(place).copied().unwrap_or_default();
        let impulses = [pushes, frictions];
        if impulses != [[0.0; MAX_WALLS]; 2] {
            Sides { id, impulses }.put(to);
        }
    }

    /// Takes what [`World::own_impulses`] returned for the particles of this world, in any order. Returns an
    /// error if it is of other particles or walls.
    pub fn take_impulses(&mut self, bytes: [&[u8]; 3]) -> Result<()> {
        let ids: Vec<Id> = match &self.domain {
            Some(domain) => domain.ids[..domain.own].to_vec(),
            None => (0..self.rows.len() as Id).collect(),
        };
        let rows: HashMap<Id, u32> = ids.into_iter().zip(0..).collect();
        self.take_impulses_of(&rows, bytes)
    }

    /// Adds the impulses of sides, contacts and walls on the particles with these ids, in these rows.
    pub(super) fn take_impulses_of(
        &mut self,
        rows: &HashMap<Id, u32>,
        [sides, resting, pushes]: [&[u8]; 3],
    ) -> Result<()> {
        let unknown = || damaged("an impulse is on no particle");
        let row_of = |id: Id| rows.get(&id).copied().ok_or_else(unknown);
        let count = self.rows.len();
        let places = self.places().to_vec();
        for of in sides.chunks_exact(Sides::SIZE).map(Sides::get) {
            let place = places[row_of(of.id)? as usize] as usize;
            let [pushes, frictions] = of.impulses;
            self.persistent.wall_pushes[place] = pushes;
            if frictions != [0.0; MAX_WALLS] {
                self.persistent.wall_frictions.resize(count, Default::default());
                self.persistent.wall_frictions[place] = frictions;
            }
        }
        for push in pushes.chunks_exact(Push::SIZE).map(Push::get) {
            self.wall_impulses.push(push.of_row(row_of(push.id)?));
        }
        self.wall_impulses.sort_by_key(|of| (of.row, of.wall));
        let resting = resting.chunks_exact(Resting::SIZE).map(Resting::get);
        self.take_resting(rows, resting)
    }

    /// Adds contacts at rest.
    fn take_resting(
        &mut self,
        rows: &HashMap<Id, u32>,
        new: impl Iterator<Item = Resting>,
    ) -> Result<()> {
        let known = |of: Resting| {
            let rows = [0, 1].map(|k| rows.get(&of.ids[k]).copied().unwrap_or(NONE));
            Resting { rows, ..of }
        };
        let Some(domain) = &mut self.domain else {
            let all: Vec<Resting> = new.map(known).collect();
            if all.iter().any(|of| of.rows.contains(&NONE)) {
                return Err(damaged("an impulse is on no particle"));
            }
            self.insert_resting(&all, |_| None);
            return Ok(());
        };
        domain.resting.extend(new.map(known));
        for of in &mut domain.resting {
            for (row, id) in of.rows.iter_mut().zip(of.ids) {
                if *row == NONE {
                    *row = rows.get(&id).copied().unwrap_or(NONE);
                }
            }
        }
        // A contact that this rank had before knows both rows.
        let unknown = |of: &Resting| of.rows.iter().filter(|&&row| row == NONE).count();
        domain.resting.sort_by_key(|of| (of.ids, unknown(of)));
        domain.resting.dedup_by_key(|of| of.ids);
        domain.resting.retain(|of| unknown(of) < 2);
        Ok(())
    }

    /// Gives the contacts at rest their impulses of the step before, when the ghosts are there.
    pub(super) fn recall_resting(&mut self) {
        let Some(domain) = &self.domain else { return };
        if domain.resting.is_empty() {
            return;
        }
        let ghosts = (domain.own as u32..).zip(&domain.ids[domain.own..]);
        let rows_of: HashMap<Id, u32> = ghosts.map(|(row, &id)| (id, row)).collect();
        let resting = domain.resting.clone();
        self.insert_resting(&resting, |id| rows_of.get(&id).copied());
    }

    /// Adds contacts with their impulses; `row_of` has the rows that they do not know.
    fn insert_resting(&mut self, all: &[Resting], row_of: impl Fn(Id) -> Option<u32>) {
        let places = self.places();
        let contact = |of: &Resting| {
            let row = |k: usize| match of.rows[k] {
                NONE => row_of(of.ids[k]),
                row => Some(row),
            };
            let places = [row(0)?, row(1)?].map(|row| places[row as usize]);
            let [impulse, friction_impulse] = of.impulses;
            Some(Contact { places, impulse, friction_impulse, ..Contact::default() })
        };
        let all: Vec<Contact> = all.iter().filter_map(contact).collect();
        self.contacts.insert(all.into_iter(), self.rows.len());
    }
}

/// Appends the pushes of a wall on a particle, if there are any.
pub(super) fn put_push(to: &mut Vec<u8>, id: Id, of: &WallImpulse) {
    if of.pushes[0] > 0.0 {
        Push { id, wall: of.wall, pushes: of.pushes }.put(to);
    }
}
