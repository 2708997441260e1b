//! The contacts of a step in blocks for vector instructions.

use std::ops::Range;

use super::{COLOURS, Contact};
use crate::simd::{LANES, PairPlaces, first_lanes};

/// Up to [`LANES`] contacts of one colour, one column for each quantity, which do not change during
/// the step. Unused lanes have the place behind those of all particles, and zeros.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))] // Each column in a cache line of its own.
pub struct Block {
    /// Offsets that are added to the second (torus).
    pub images: [[f32; LANES]; 2],
    /// Sums of the radii.
    pub reaches: [f32; LANES],
    /// The places of the first and of the second particles.
    pub places: PairPlaces,
    /// The index of the first contact; those of the others follow.
    first: u32,
    /// The number of contacts.
    len: u32,
}

impl Block {
    fn new(first: usize, contacts: &[Contact], spare: u32) -> Self {
        let mut places = [[spare; LANES]; 2];
        for (lane, contact) in contacts.iter().enumerate() {
            [places[0][lane], places[1][lane]] = contact.places;
        }
        let mut block = Self {
            places: PairPlaces::new(places),
            images: [[0.0; LANES]; 2],
            reaches: [0.0; LANES],
            first: first as u32,
            len: contacts.len() as u32,
        };
        for (lane, contact) in contacts.iter().enumerate() {
            for k in [0, 1] {
                block.images[k][lane] = contact.image[k];
            }
            block.reaches[lane] = contact.reach;
        }
        block
    }

    /// A bit for each lane in use.
    pub fn lanes(&self) -> u32 {
        first_lanes(self.len as usize)
    }

    /// Where in the list the contacts stand.
    pub fn range(&self) -> Range<usize> {
        let first = self.first as usize;
        first..first + self.len as usize
    }
}

/// The blocks of a colour.
#[derive(Clone, Copy, Debug)]
pub struct Colour {
    start: usize,
    uneven_end: usize,
    end: usize,
    /// Whether contacts share particles, so that they are solved in sequence.
    pub is_serial: bool,
}

impl Colour {
    /// All blocks.
    pub fn all(&self) -> Range<usize> {
        self.start..self.end
    }

    /// Those of particles that have contacts of uneven masses.
    pub fn uneven(&self) -> Range<usize> {
        self.start..self.uneven_end
    }
}

/// All blocks of a step.
#[derive(Clone, Debug, Default)]
pub struct Blocks {
    /// Colour by colour.
    pub list: Vec<Block>,
    /// The colours in use.
    pub colours: Vec<Colour>,
}

impl Blocks {
    /// Removes all blocks.
    pub fn clear(&mut self) {
        self.list.clear();
        self.colours.clear();
    }

    /// Makes the blocks of contacts that are sorted by colour, in each those of particles with
    /// contacts of uneven masses first. `ends` gives where these end, and where all of a colour
    /// end. `spare` is a place without a particle.
    pub fn fill(&mut self, contacts: &[Contact], ends: &[[usize; 2]], spare: u32) {
        self.clear();
        let mut first = 0;
        for (colour, &[uneven_end, end]) in ends.iter().enumerate() {
            let (start, is_serial) = (self.list.len(), colour == COLOURS);
            let most = if is_serial { 1 } else { LANES };
            self.add(contacts, std::mem::replace(&mut first, uneven_end)..uneven_end, most, spare);
            let uneven_end = self.list.len();
            self.add(contacts, std::mem::replace(&mut first, end)..end, most, spare);
            let end = self.list.len();
            if start < end {
                self.colours.push(Colour { start, uneven_end, end, is_serial });
            }
        }
    }

    /// Appends blocks of at most a number of contacts.
    fn add(&mut self, contacts: &[Contact], range: Range<usize>, most: usize, spare: u32) {
        let starts = range.clone().step_by(most);
        self.list.extend(starts.map(|start| {
            let end = range.end.min(start + most);
            Block::new(start, &contacts[start..end], spare)
        }));
    }
}
