//! Contacts for which there is no colour, because a particle has many. They are solved one after the other: first
//! those of particles that have contacts of uneven masses, then the others, each in canonical order.
//!
//! The ranks of a distributed world solve them in rounds, see [`crate::decomposition`]. One process has one round.

use super::blocks::Blocks;
use super::{COLOURS, NEAR_KIND, UNEVEN_KIND, UNSOLVED};
use crate::error::Result;

/// A contact that is solved in sequence.
#[derive(Clone, Copy, Debug)]
pub struct Sequential {
    /// The indices of its particles.
    pub indices: [u32; 2],
    /// The number of the torus image.
    pub image: u32,
    /// Whether it is solved before the others of its round.
    is_uneven: bool,
    /// Its place among all pairs.
    at: u32,
    /// The round in which it is solved.
    pub round: u32,
}

/// Scratch.
#[derive(Clone, Debug, Default)]
pub struct Sequence {
    /// In the order in which they are solved.
    contacts: Vec<Sequential>,
    /// The number of those of uneven masses, and of the others, in each round.
    rounds: Vec<[usize; 2]>,
    /// The place of each contact in canonical order, among all that are solved in sequence.
    places: Vec<[u32; 2]>,
}

impl Sequence {
    /// Lists the contacts for which there is no colour. `divide` writes their rounds and returns how many there
    /// are; it may remove contacts, which are then not solved. Returns the numbers of contacts of each round.
    pub fn arrange(
        &mut self,
        lists: &[([f32; 2], Vec<[u32; 2]>)],
        colours: &[u8],
        kinds: &mut [u8],
        divide: impl FnOnce(&mut Vec<Sequential>) -> Result<usize>,
    ) -> Result<&[[usize; 2]]> {
        let Self { contacts, rounds, places } = self;
        contacts.clear();
        rounds.clear();
        places.clear();
        let is_any = colours.iter().fold(false, |any, &colour| any | (colour == COLOURS as u8));
        let lists = if is_any { lists } else { &[] };
        let mut first = 0;
        for (image, (_, pairs)) in (0..).zip(lists) {
            let colours = colours[first as usize..].iter().zip(&mut kinds[first as usize..]);
            for ((&indices, (&colour, kind)), at) in pairs.iter().zip(colours).zip(first..) {
                if usize::from(colour) < COLOURS || *kind == UNSOLVED {
                    continue;
                }
                let is_uneven = *kind == UNEVEN_KIND as u8;
                contacts.push(Sequential { indices, image, is_uneven, at, round: 0 });
                *kind = UNSOLVED;
            }
            first += pairs.len() as u32;
        }
        contacts.sort_unstable_by_key(|of| (!of.is_uneven, of.at));
        rounds.resize(divide(contacts)?, [0; 2]);
        contacts.sort_unstable_by_key(|of| (of.round, !of.is_uneven, of.at));
        for (place, of) in (0..).zip(&*contacts) {
            rounds[of.round as usize][usize::from(!of.is_uneven)] += 1;
            kinds[of.at as usize] = if of.is_uneven { UNEVEN_KIND } else { NEAR_KIND } as u8;
            places.push([of.at, place]);
        }
        places.sort_unstable();
        Ok(rounds)
    }

    /// The block of each contact in canonical order.
    pub fn blocks(&self, all: &Blocks) -> impl Iterator<Item = usize> + use<'_> {
        let first = all.list.len() - self.contacts.len();
        self.places.iter().map(move |&[_, place]| first + place as usize)
    }
}
