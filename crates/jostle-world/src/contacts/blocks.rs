//! The contacts of a step in blocks for vector instructions.

use std::ops::Range;

use super::{COLOURS, Contact, FAR_KIND, KINDS, NEAR_KIND, UNEVEN_KIND};
use crate::particles::Particles;
use crate::tolerance::{are_uneven, gap, size_of};
use crate::trajectory::{Vector, rest_speeds, vector};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_simd::{LANES, PairIndices, for_each_lane};

/// Relaxation factor of a contact of equal masses, or with something that does not move. In a pile of n
/// layers the number of iterations grows with n² at 1, and with n at the best factor, which is near 2
/// (D. M. Young, 1971).
pub const RELAXATION: f32 = 1.9;

/// Relaxation factor of a contact whose one particle is much lighter than the other. A light particle between heavy
/// ones gets large velocities if the impulses are not exact, so its factor is smaller.
const LEAST_RELAXATION: f32 = 1.7;

/// The relaxation factor of a contact of particles with these inverse masses.
fn relaxation([a, b]: [f32; 2]) -> f32 {
    // Between the two factors, linearly in the ratio of inverse masses. `docs/benchmarks-notes.md`
    // has the overlap of piles with masses 100:1 for other factors.
    let (small, large) = (a.min(b), a.max(b));
    // With something that does not move there is no ratio: it gets the factor of equal masses.
    let ratio = if small == 0.0 { 1.0 } else { small / large };
    LEAST_RELAXATION + (RELAXATION - LEAST_RELAXATION) * ratio
}

/// Up to [`LANES`] contacts of one colour, one column for each quantity, from the candidate pairs of a
/// step until [`Contact`] keeps what lasts. Resting, friction and position correction share the
/// columns. Unused lanes have the index behind those of all particles, and no impulses.
///
/// Each column is in a cache line of its own. Those that the iterations over resting contacts read
/// come last, one after the other, so that these iterations load no others.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Block {
    /// Offsets from the first to the second when position correction begins.
    pub offset: [[f32; LANES]; 2],
    /// The smaller diameters.
    pub sizes: [f32; LANES],
    /// Sums of the radii.
    pub contact_distances: [f32; LANES],
    /// Offsets that are added to the second (torus).
    pub images: [[f32; LANES]; 2],
    /// Coefficients of restitution.
    pub restitutions: [f32; LANES],
    /// See [`rest_speeds`]; 0 for contacts that cannot rest.
    pub rest_speeds: [[f32; LANES]; 2],
    /// Sums of the impulses along the normal and of friction in the sub-steps that have ended.
    pub totals: [[f32; LANES]; 2],
    /// Coefficients of friction.
    pub frictions: [f32; LANES],
    /// Change of the surface speed by an impulse along the surface: r²/I, 0 for points.
    pub softness: [[f32; LANES]; 2],
    /// Impulse along the surfaces for a change of the sliding speed by one.
    pub sliding_masses: [f32; LANES],
    /// Impulses of friction on the second along the normal after a quarter turn, see `impulses`.
    pub friction_impulses: [[f32; LANES]; 2],
    /// Impulses along the normal: of the impacts at the beginning of the sub-step, and at rest. Those
    /// at rest begin a sub-step as those of the sub-step before, or of the step before.
    pub impulses: [[f32; LANES]; 2],
    /// Minimum normal speeds after the impacts, and at the end of the sub-step.
    pub least_speeds: [[f32; LANES]; 2],
    /// Impulse along the normal for a change of the normal speed by one: 1 / (1/m₁ + 1/m₂).
    pub effective_masses: [f32; LANES],
    /// The effective mass times the factor of over-relaxation.
    pub relaxed_masses: [f32; LANES],
    /// One over the masses; 0 for particles that do not move in the step.
    pub inverse_masses: [[f32; LANES]; 2],
    /// Unit vectors from the first to the second as the sub-step begins.
    pub normal: [[f32; LANES]; 2],
    /// The indices of the first and of the second particles.
    pub indices: PairIndices,
    /// A bit for each contact that rests in this sub-step. The others have no impulses.
    pub resting: u32,
    /// A bit for each lane in use.
    pub lanes: u32,
    /// A bit for each contact whose radii are so different that float32 is too coarse for the gap.
    pub uneven_sizes: u32,
    /// A bit for each pair whose first, and whose second does not move.
    pub fixed: [u32; 2],
    /// A bit for each pair that is near enough for position correction.
    pub near: u32,
    /// A bit for each pair that has overlapped at the end of a flight of this step.
    pub overlapped: u32,
    /// Whether any pair touches across the boundary of a torus.
    pub has_images: bool,
}

/// A contact with impulses at rest in a step.
pub struct Rested {
    /// The indices of its particles.
    pub pair: [u32; 2],
    /// The sum of their radii.
    pub contact_distance: f32,
    /// Unit vector from the first to the second in the last sub-step.
    pub normal: [f32; 2],
    /// The sums over the sub-steps of the impulses along the normal and of friction.
    pub impulses: [f32; 2],
}

impl Default for Block {
    fn default() -> Self {
        let zeros = [0.0; LANES];
        Self {
            offset: [zeros; 2],
            sizes: zeros,
            contact_distances: zeros,
            images: [zeros; 2],
            restitutions: zeros,
            rest_speeds: [zeros; 2],
            totals: [zeros; 2],
            frictions: zeros,
            softness: [zeros; 2],
            sliding_masses: zeros,
            friction_impulses: [zeros; 2],
            impulses: [zeros; 2],
            least_speeds: [[f32::MIN; LANES]; 2],
            effective_masses: zeros,
            relaxed_masses: zeros,
            // Not 0, so that effective masses of unused lanes are finite.
            inverse_masses: [[1.0; LANES]; 2],
            // That of coincident centres.
            normal: [[1.0; LANES], zeros],
            indices: PairIndices::new([[0; LANES]; 2]),
            resting: 0,
            lanes: 0,
            uneven_sizes: 0,
            fixed: [0; 2],
            near: 0,
            overlapped: 0,
            has_images: false,
        }
    }
}

/// What the contacts of a step are made from.
pub struct Materials<'a> {
    pub particles: &'a Particles,
    /// Which of them may rest, of a world in which some may not; else empty.
    pub lossy: &'a [bool],
}

impl Block {
    /// Replaces all contacts; `get` gives the pair of each lane, the offset of its second, and the
    /// impulses at rest of the step before.
    pub fn fill(
        &mut self,
        of: &Materials<'_>,
        get: impl Fn(usize) -> Option<([u32; 2], [f32; 2], [f32; 2])>,
    ) {
        let Materials { particles, lossy } = *of;
        // Unused lanes keep values with which all formulas stay finite, so kernels compute all
        // sixteen without a mask.
        *self = Self::default();
        // Unused lanes read and write the spare row behind all particles.
        let mut indices = [[particles.len() as u32; LANES]; 2];
        let mut last = (f32::NAN, [0.0; 2]);
        let used = (0..LANES).filter_map(|lane| Some((lane, get(lane)?)));
        for (lane, (pair, image, impulses)) in used {
            let [i, j] = pair.map(|index| index as usize);
            let radii = [particles.radii[i], particles.radii[j]];
            for (k, index) in [i, j].into_iter().enumerate() {
                indices[k][lane] = pair[k];
                self.images[k][lane] = image[k];
                let inverse_mass = particles.inverse_mass(index);
                self.inverse_masses[k][lane] = inverse_mass;
                self.fixed[k] |= u32::from(inverse_mass == 0.0) << lane;
                // r²/I = 2/m of a disc; a point cannot turn.
                self.softness[k][lane] = if radii[k] == 0.0 { 0.0 } else { 2.0 * inverse_mass };
            }
            self.has_images |= image != [0.0; 2];
            self.contact_distances[lane] = radii[0] + radii[1];
            self.sizes[lane] = size_of(radii[0], radii[1]);
            let is_uneven = are_uneven(self.sizes[lane], self.contact_distances[lane]);
            self.uneven_sizes |= u32::from(is_uneven) << lane;
            let restitution = particles.pair_restitution(i, j);
            self.restitutions[lane] = restitution;
            if lossy.is_empty() || lossy[i] || lossy[j] {
                // Most contacts have the same.
                if restitution != last.0 {
                    last = (restitution, rest_speeds(f64::from(restitution)).map(|v| v as f32));
                }
                [self.rest_speeds[0][lane], self.rest_speeds[1][lane]] = last.1;
            }
            self.frictions[lane] = particles.pair_friction(i, j);
            self.impulses[1][lane] = impulses[0];
            self.friction_impulses[1][lane] = impulses[1];
            self.lanes |= 1 << lane;
        }
        self.indices = PairIndices::new(indices);
        for lane in 0..LANES {
            let masses = [self.inverse_masses[0][lane], self.inverse_masses[1][lane]];
            let softness = self.softness[0][lane] + self.softness[1][lane];
            // Divisions are made once a step; the iterations multiply.
            self.effective_masses[lane] = 1.0 / (masses[0] + masses[1]);
            self.relaxed_masses[lane] = self.effective_masses[lane] * relaxation(masses);
            self.sliding_masses[lane] = 1.0 / ((masses[0] + masses[1]) + softness);
        }
    }

    /// Adds the impulses of a sub-step to the sums of the step.
    #[inline(always)]
    pub fn count(&mut self, has_friction: bool) {
        if self.resting == 0 {
            return;
        }
        let Self { totals, impulses, friction_impulses, .. } = self;
        for lane in 0..LANES {
            // Over all lanes without a mask, so that the compiler uses one vector instruction.
            // Lanes that do not rest have impulses of 0.
            totals[0][lane] += impulses[0][lane] + impulses[1][lane];
        }
        if has_friction {
            for lane in 0..LANES {
                totals[1][lane] += friction_impulses[0][lane] + friction_impulses[1][lane];
            }
        }
    }

    /// The contacts with impulses at rest in this step.
    pub fn rested(&self) -> impl Iterator<Item = Rested> {
        let lanes = (0..LANES).filter(|&lane| self.totals[0][lane] > 0.0);
        lanes.map(|lane| Rested {
            pair: [0, 1].map(|k| self.indices.of(k)[lane]),
            contact_distance: self.contact_distances[lane],
            normal: [0, 1].map(|k| self.normal[k][lane]),
            impulses: [0, 1].map(|k| self.totals[k][lane]),
        })
    }

    /// The contact of a lane, if its particles overlapped or an impulse pushed them in this step, or if
    /// the next step begins with an impulse.
    #[inline(always)]
    pub fn lasting(&self, lane: usize) -> Option<Contact> {
        let touched = self.overlapped >> lane & 1 == 1 || self.totals[0][lane] > 0.0;
        (touched || self.impulses[1][lane] > 0.0).then(|| Contact {
            indices: [0, 1].map(|k| self.indices.of(k)[lane]),
            image: [0, 1].map(|k| self.images[k][lane]),
            inverse_masses: [0, 1].map(|k| self.inverse_masses[k][lane]),
            impulse: self.impulses[1][lane],
            friction_impulse: self.friction_impulses[1][lane],
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
        // The gap is a small difference of the length and the sum of radii. If the radii are very
        // different, float32 has no digits for it.
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
    pub fn arrange(&mut self, counts: &[[usize; KINDS]], rounds: &[[usize; 2]]) -> Result<Lanes> {
        self.colours.clear();
        memory::reserve(&mut self.colours, counts.len() + rounds.len())?;
        let mut lanes = Lanes([[0; KINDS]; COLOURS]);
        let mut end = 0;
        for (kinds, lanes) in counts.iter().zip(&mut lanes.0) {
            let start = end;
            let first = |block: usize| block * LANES;
            // Uneven contacts have blocks of their own, because further iterations visit only
            // these. The others share blocks, near ones first.
            let uneven_end = start + kinds[UNEVEN_KIND].div_ceil(LANES);
            lanes[UNEVEN_KIND] = first(start);
            lanes[NEAR_KIND] = first(uneven_end);
            lanes[FAR_KIND] = first(uneven_end) + kinds[NEAR_KIND];
            end = uneven_end + (kinds[NEAR_KIND] + kinds[FAR_KIND]).div_ceil(LANES);
            if start < end {
                self.colours.push(Colour { start, uneven_end, end, is_serial: false });
            }
        }
        // A block for each: two contacts in one block are solved at the same time, and these share
        // particles.
        for [uneven, others] in rounds {
            let (start, uneven_end) = (end, end + uneven);
            end = uneven_end + others;
            self.colours.push(Colour { start, uneven_end, end, is_serial: true });
        }
        memory::resize(&mut self.list, end, Block::default())?;
        Ok(lanes)
    }
}
