//! Makes contacts of candidate pairs: the lists of neighbours for the events, and the contacts that are coloured
//! and solved in the sub-steps.

use super::search::Lists;
use super::{OnTouch, StepScratch, World, merge};
use crate::error::Result;
use crate::interrupt;
use crate::motion::exact;
use crate::parallel;
use crate::particles::Particles;
use crate::tolerance::{gap, size_of};
use crate::trajectory::vector;

/// Overlap, as a share of the size, from which positions are corrected where nothing rests.
const OVERLAP: f32 = 0.0024;

/// Relative error of the square of a distance in float32, with a reserve.
const APART: f32 = 1e-5;

/// Candidate pairs that one thread tests for overlap at a time.
const FILTERED: usize = 1 << 14;

impl World {
    /// Finds the neighbours of all particles from the candidate pairs, and the contacts whose positions
    /// may have to be corrected or that may rest.
    pub(super) fn make_contacts(&mut self) -> Result<()> {
        let (threads, may_rest) = (self.threads(), self.may_rest());
        self.take_pairs_that_pass();
        let Self { particles, scratch, contacts, .. } = self;
        let StepScratch { pairs, events, .. } = scratch;
        events.take_pairs(particles.len(), pairs, threads);
        if !may_rest {
            let StepScratch { overlaps, overlap_parts, .. } = scratch;
            find_overlapping(particles, pairs, (overlaps, overlap_parts), threads);
        }
        interrupt::check()?;
        let lists = if may_rest { pairs } else { &scratch.overlaps };
        contacts.colour(lists, particles, threads);
        interrupt::check()?;
        let (mut shape, mut refinement) = (self.contacts.shape(), self.own_refinement());
        let Self { particles, settings, scratch, contacts, domain, rows, .. } = self;
        let lists = if may_rest { &scratch.pairs } else { &scratch.overlaps };
        if let Some(domain) = domain {
            let of_pairs = domain.digest_colours(contacts, lists, particles, rows);
            (shape, refinement) = domain.shape_of_all(shape, refinement)?;
            domain.add_pair_digests(of_pairs);
            if shape.rounds > 0 {
                shape.rounds = domain.divide(contacts.sequential(), &particles.movable, rows)?;
            }
        }
        let before = scratch.tree.rows();
        contacts.collect(lists, particles, settings.restitution, before, shape.rounds, threads);
        (scratch.contact_shape, scratch.refinement) = (shape, refinement);
        Ok(())
    }

    /// Moves the pairs that do not push each other to lists of their own: those with sensors, and all
    /// if particles merge.
    fn take_pairs_that_pass(&mut self) {
        let Self {
            particles, scratch: StepScratch { pairs, sensed, candidate_merges, .. }, ..
        } = self;
        if !particles.sensors.is_empty() {
            let is_sensor = |index: u32| particles.is_sensor(index as usize);
            take(pairs, sensed, |[a, b]| is_sensor(a) || is_sensor(b));
        }
        candidate_merges.clear();
        if self.settings.on_touch == OnTouch::Merge {
            merge::list_candidates(pairs, particles, candidate_merges);
            pairs.clear();
        }
    }
}

/// Lists the pairs that overlap by more than [`OVERLAP`], sorted; the scratch keeps the lists of threads.
fn find_overlapping(
    particles: &Particles,
    pairs: &Lists,
    (overlaps, scratch): (&mut Lists, &mut Vec<Vec<[u32; 2]>>),
    threads: Option<usize>,
) {
    overlaps.resize_with(pairs.len(), Default::default);
    for ((image, pairs), (image_of_list, list)) in pairs.iter().zip(overlaps.iter_mut()) {
        *image_of_list = *image;
        let count = pairs.len().div_ceil(FILTERED);
        scratch.resize_with(scratch.len().max(count), Vec::new);
        let parts = scratch.iter_mut().zip(pairs.chunks(FILTERED));
        parallel::for_each(threads, parts, |(part, pairs)| {
            part.clear();
            part.extend(pairs.iter().filter(|&&pair| overlap(particles, pair, *image)));
        });
        list.clear();
        list.extend(scratch[..count].iter().flatten());
        list.sort_unstable();
    }
}

/// Whether two particles overlap by more than [`OVERLAP`], the second moved by `image`.
#[inline(always)]
fn overlap(particles: &Particles, [a, b]: [u32; 2], image: [f32; 2]) -> bool {
    let [p, q] = [a, b].map(|index| particles.positions[index as usize]);
    let [c, d] = [a, b].map(|index| particles.residuals[index as usize]);
    let [x, y] = [0, 1].map(|k| (q[k] - p[k] + image[k]) + (d[k] - c[k]));
    let contact_distance = particles.radii[a as usize] + particles.radii[b as usize];
    // Most pairs are apart, also if float32 is coarse for them.
    x * x + y * y < contact_distance * contact_distance * (1.0 + APART)
        && overlap_much(particles, [a, b], image)
}

/// The exact test, which few pairs need.
#[inline(never)]
fn overlap_much(particles: &Particles, pair: [u32; 2], image: [f32; 2]) -> bool {
    let [a, b] = pair.map(|index| index as usize);
    let [p, q] = [a, b].map(|at| exact(particles.positions[at], particles.residuals[at]));
    let (r, s) = (particles.radii[a], particles.radii[b]);
    let offset = vector(|k| q[k] - p[k] + f64::from(image[k]));
    gap(offset, f64::from(r) + f64::from(s)).1 < f64::from(-OVERLAP * size_of(r, s))
}

/// Moves some pairs from lists to others, which are empty.
fn take(from: &mut Lists, to: &mut Lists, is_taken: impl Fn([u32; 2]) -> bool) {
    to.extend(from.iter_mut().map(|(image, pairs)| {
        let taken = pairs.iter().copied().filter(|&pair| is_taken(pair)).collect();
        pairs.retain(|&pair| !is_taken(pair));
        (*image, taken)
    }));
}
