//! What the solver keeps from step to step beside the particles, for a distributed world: the impulses of
//! resting contacts, and those of walls.

use std::collections::HashMap;

use super::World;
use super::touches::WallImpulse;
use crate::bytes::Plain;
use crate::contacts::Contact;
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
        let Self { domain, contacts, rows, .. } = self;
        let Some(domain) = domain else { return };
        if !std::mem::take(&mut domain.has_contacts) {
            return;
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
        domain.resting = contacts.lasting().filter_map(resting).collect();
    }

    /// Gives the contacts at rest their impulses of the step before, when the ghosts are there.
    pub(super) fn recall_resting(&mut self) {
        let Some(domain) = &self.domain else { return };
        if domain.resting.is_empty() {
            return;
        }
        let ghosts = (domain.own as u32..).zip(&domain.ids[domain.own..]);
        let rows_of: HashMap<Id, u32> = ghosts.map(|(row, &id)| (id, row)).collect();
        let places = self.places();
        let contact = |of: &Resting| {
            let row = |k: usize| match of.rows[k] {
                NONE => rows_of.get(&of.ids[k]).copied(),
                row => Some(row),
            };
            let places = [row(0)?, row(1)?].map(|row| places[row as usize]);
            let [impulse, friction_impulse] = of.impulses;
            Some(Contact { places, impulse, friction_impulse, ..Contact::default() })
        };
        let all: Vec<Contact> = domain.resting.iter().filter_map(contact).collect();
        self.contacts.insert(all.into_iter(), self.rows.len());
    }
}
