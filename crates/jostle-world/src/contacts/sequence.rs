//! Contacts for which there is no colour, because a particle has many. They are solved one after
//! the other: first those of particles that have contacts of uneven masses, then the others, each
//! in canonical order.
//!
//! The processes of a distributed world solve them in rounds, see [`crate::ranks`]. One process
//! has one round.

use jostle_base::error::Result;
use jostle_base::{memory, reserve};

use super::blocks::Blocks;
use super::{COLOURS, NEAR_KIND, UNEVEN_KIND, UNSOLVED};

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
    /// Whether there was a contact without a colour.
    is_any: bool,
}

impl Sequence {
    /// Lists the contacts for which there is no colour, in one round.
    pub fn list(
        &mut self,
        lists: &[([f32; 2], Vec<[u32; 2]>)],
        colours: &[u8],
        kinds: &[u8],
    ) -> Result<()> {
        let contacts = &mut self.contacts;
        contacts.clear();
        // A fold without an early end, which the compiler turns into vector instructions. Nearly
        // all worlds end here.
        self.is_any = colours.iter().fold(false, |any, &colour| any | (colour == COLOURS as u8));
        if !self.is_any {
            return Ok(());
        }
        let pairs = (0..)
            .zip(lists)
            .flat_map(|(image, (_, pairs))| pairs.iter().map(move |&indices| (image, indices)));
        for (((image, indices), at), (&colour, &kind)) in
            pairs.zip(0..).zip(colours.iter().zip(kinds))
        {
            // A particle with more than 64 contacts is a large one among many small ones. In
            // sequence each correction sees the last one, as with a colour for each contact.
            if usize::from(colour) == COLOURS && kind != UNSOLVED {
                let is_uneven = kind == UNEVEN_KIND as u8;
                memory::push(contacts, Sequential { indices, image, is_uneven, at, round: 0 })?;
            }
        }
        // Uneven ones first, so that the further iterations visit a prefix of the round.
        contacts.sort_unstable_by_key(|of| (!of.is_uneven, of.at));
        Ok(())
    }

    /// The contacts, of which some may be removed before [`Sequence::arrange`].
    pub fn contacts(&mut self) -> &mut Vec<Sequential> {
        &mut self.contacts
    }

    /// Whether any have been listed.
    pub fn is_any(&self) -> bool {
        self.is_any
    }

    /// Puts the contacts in the order in which they are solved. Writes the kind of each, and that
    /// of the pairs that have been removed; returns the numbers of contacts of each round.
    pub fn arrange(
        &mut self,
        rounds: usize,
        colours: &[u8],
        kinds: &mut [u8],
    ) -> Result<&[[usize; 2]]> {
        let Self { contacts, rounds: counts, places, is_any } = self;
        reserve!(rounds; *counts);
        reserve!(contacts.len(); *places);
        counts.clear();
        counts.resize(rounds, [0; 2]);
        places.clear();
        if !*is_any {
            return Ok(counts);
        }
        for (kind, &colour) in kinds.iter_mut().zip(colours) {
            *kind = if usize::from(colour) < COLOURS { *kind } else { UNSOLVED };
        }
        contacts.sort_unstable_by_key(|of| (of.round, !of.is_uneven, of.at));
        for (place, of) in (0..).zip(&*contacts) {
            counts[of.round as usize][usize::from(!of.is_uneven)] += 1;
            kinds[of.at as usize] = if of.is_uneven { UNEVEN_KIND } else { NEAR_KIND } as u8;
            places.push([of.at, place]);
        }
        // Blocks are filled in canonical order, and lie in the order of solving. The places map one
        // to the other.
        places.sort_unstable();
        Ok(counts)
    }

    /// The block of each contact in canonical order.
    pub fn blocks(&self, all: &Blocks) -> impl Iterator<Item = usize> + use<'_> {
        let first = all.list.len() - self.contacts.len();
        self.places.iter().map(move |&[_, place]| first + place as usize)
    }
}
