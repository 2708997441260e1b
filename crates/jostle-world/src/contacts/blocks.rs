//! The contacts of a step in blocks for vector instructions.

use std::ops::Range;

use super::{COLOURS, Contact, FAR_KIND, KINDS, NEAR_KIND, UNEVEN_KIND};
use crate::tolerance::{are_uneven, gap};
use crate::trajectory::{Vector, vector};
use jostle_simd::{LANES, PairIndices, for_each_lane};

/// Up to [`LANES`] contacts of one colour, one column for each quantity. Unused lanes have the index
/// behind those of all particles.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))] // Each column in a cache line of its own.
pub struct Block {
    /// Offsets that are added to the second (torus).
    pub images: [[f32; LANES]; 2],
    /// Sums of the radii.
    pub contact_distances: [f32; LANES],
    /// The smaller diameters.
    pub sizes: [f32; LANES],
    /// One over the masses; 0 for particles that do not move in the step.
    pub inverse_masses: [[f32; LANES]; 2],
    /// Coefficients of restitution.
    pub restitutions: [f32; LANES],
    /// Coefficients of friction.
    pub frictions: [f32; LANES],
    /// Impulses at rest, along the normal and of friction: those of the step before, and from the end
    /// of the sub-steps on those of the last.
    pub impulses: [[f32; LANES]; 2],
    /// Sums of the impulses of this step, likewise.
    pub totals: [[f32; LANES]; 2],
    /// The indices of the first and of the second particles.
    pub indices: PairIndices,
    /// A bit for each lane in use.
    pub lanes: u32,
    /// A bit for each contact whose radii are so different that float32 is too coarse for the gap.
    pub uneven_sizes: u32,
    /// A bit for each contact whose particles touched or pushed each other during this step.
    pub touched: u32,
}

impl Default for Block {
    fn default() -> Self {
        let zeros = [0.0; LANES];
        Self {
            images: [zeros; 2],
            contact_distances: zeros,
            sizes: zeros,
            // Not 0, so that effective masses are finite.
            inverse_masses: [[1.0; LANES]; 2],
            restitutions: zeros,
            frictions: zeros,
            impulses: [zeros; 2],
            totals: [zeros; 2],
            indices: PairIndices::new([[0; LANES]; 2]),
            lanes: 0,
            uneven_sizes: 0,
            touched: 0,
        }
    }
}

impl Block {
    /// Replaces all contacts; `get` gives that of each lane.
    pub fn fill(&mut self, spare: u32, get: impl Fn(usize) -> Option<Contact>) {
        *self = Self::default();
        let mut indices = [[spare; LANES]; 2];
        for (lane, contact) in (0..LANES).filter_map(|lane| Some((lane, get(lane)?))) {
            [indices[0][lane], indices[1][lane]] = contact.indices;
            for k in [0, 1] {
                self.images[k][lane] = contact.image[k];
                self.inverse_masses[k][lane] = contact.inverse_masses[k];
            }
            self.contact_distances[lane] = contact.contact_distance;
            self.sizes[lane] = contact.size;
            let is_uneven = are_uneven(contact.size, contact.contact_distance);
            self.uneven_sizes |= u32::from(is_uneven) << lane;
            self.restitutions[lane] = contact.restitution;
            self.frictions[lane] = contact.friction;
            self.impulses[0][lane] = contact.impulse;
            self.impulses[1][lane] = contact.friction_impulse;
            self.lanes |= 1 << lane;
        }
        self.indices = PairIndices::new(indices);
    }

    /// The contact of a lane, if its particles touched or it has an impulse.
    #[inline(always)]
    pub fn lasting(&self, lane: usize) -> Option<Contact> {
        let touched = self.touched >> lane & 1 == 1;
        (touched || self.impulses[0][lane] > 0.0).then(|| Contact {
            indices: [0, 1].map(|k| self.indices.of(k)[lane]),
            image: [0, 1].map(|k| self.images[k][lane]),
            contact_distance: self.contact_distances[lane],
            size: self.sizes[lane],
            inverse_masses: [0, 1].map(|k| self.inverse_masses[k][lane]),
            restitution: self.restitutions[lane],
            friction: self.frictions[lane],
            impulse: self.impulses[0][lane],
            friction_impulse: self.impulses[1][lane],
            totals: [0, 1].map(|k| self.totals[k][lane]),
            touched,
            ..Contact::default()
        })
    }

    /// Unit vector and gap of the contact of a lane, in float64; `exact` gives positions.
    pub fn measure(
        &self,
        lane: usize,
        radii: &[f32],
        exact: impl Fn(u32) -> Vector,
    ) -> (Option<Vector>, f64) {
        let pair = [0, 1].map(|k| self.indices.of(k)[lane]);
        let [p, q] = pair.map(exact);
        let offset = vector(|k| q[k] - p[k] + f64::from(self.images[k][lane]));
        let [r, s] = pair.map(|index| f64::from(radii[index as usize]));
        gap(offset, r + s)
    }

    /// Calls `act` with each lane in use.
    #[inline(always)]
    pub fn each_lane(&self, mut act: impl FnMut(usize)) {
        for_each_lane(self.lanes, |lane| act(lane % LANES));
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

/// The lane of the next contact of each kind of each colour, counted over all blocks.
pub struct Lanes([[usize; KINDS]; COLOURS]);

impl Lanes {
    /// A lane for a contact.
    #[inline(always)]
    pub fn take(&mut self, [colour, kind]: [u8; 2]) -> usize {
        let lane = &mut self.0[usize::from(colour)][usize::from(kind)];
        std::mem::replace(lane, *lane + 1)
    }
}

impl Blocks {
    /// Removes all blocks.
    pub fn clear(&mut self) {
        self.list.clear();
        self.colours.clear();
    }

    /// Reserves memory for the contacts of each kind of each colour. Contacts of particles with
    /// contacts of uneven masses have blocks of their own, and those in sequence one each: `rounds`
    /// has how many contacts of uneven masses, and how many others, are in each round.
    pub fn arrange(&mut self, counts: &[[usize; KINDS]], rounds: &[[usize; 2]]) -> Lanes {
        self.colours.clear();
        let mut lanes = Lanes([[0; KINDS]; COLOURS]);
        let mut end = 0;
        for (kinds, lanes) in counts.iter().zip(&mut lanes.0) {
            let start = end;
            let first = |block: usize| block * LANES;
            let uneven_end = start + kinds[UNEVEN_KIND].div_ceil(LANES);
            lanes[UNEVEN_KIND] = first(start);
            lanes[NEAR_KIND] = first(uneven_end);
            lanes[FAR_KIND] = first(uneven_end) + kinds[NEAR_KIND];
            end = uneven_end + (kinds[NEAR_KIND] + kinds[FAR_KIND]).div_ceil(LANES);
            if start < end {
                self.colours.push(Colour { start, uneven_end, end, is_serial: false });
            }
        }
        for [uneven, others] in rounds {
            let (start, uneven_end) = (end, end + uneven);
            end = uneven_end + others;
            self.colours.push(Colour { start, uneven_end, end, is_serial: true });
        }
        self.list.resize(end, Block::default());
        lanes
    }
}
