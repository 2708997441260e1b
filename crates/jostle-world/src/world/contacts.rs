//! Makes contacts of candidate pairs: the lists of neighbours for the events, and the contacts that are coloured
//! and solved in the sub-steps.

use std::cell::Cell;

use super::plan::Plan;
use super::reach::{FreeReaches, rest_distance};
use super::refinement::own_refinement;
use super::search::Lists;
use super::{OnTouch, StepScratch, World, merge};
use crate::contacts::Materials;
use crate::correction::OVERLAP;
use crate::halo::Halo;
use crate::motion::exact;
use crate::particles::Particles;
use crate::tolerance::{gap, size_of};
use crate::trajectory::vector;
use crate::world::bodies::Bodies;
use crate::world::bodies::discs::Discs;
use jostle_base::error::Result;
use jostle_base::interrupt;
use jostle_base::{memory, parallel};

/// Relative error of the square of a distance in float32, with a reserve.
const APART: f32 = 1e-5;

/// Candidate pairs that one thread tests for overlap at a time.
const FILTERED: usize = 1 << 14;

impl World {
    /// Finds the neighbours of all particles from the candidate pairs, and the contacts whose
    /// positions may have to be corrected or that may rest: of a world in which something may rest,
    /// the pairs that may come near each other by themselves, and else those that overlap. Which
    /// pairs these are depends on the state of the two alone, not on the candidates, which are
    /// more.
    ///
    /// Returns how many times the usual number of sub-steps the contacts need, on all processes.
    pub(crate) fn make_contacts(&mut self, plan: &Plan) -> Result<usize> {
        let threads = plan.threads;
        // What passes through others has neither contacts nor impacts, so its pairs leave the lists
        // first.
        self.take_pairs_that_pass()?;
        let is_mixed = self.find_lossy(plan.is_lossless)?;
        let Self {
            bodies: Bodies { awake: Discs { particles, .. }, .. }, settings, scratch, ..
        } = self;
        let StepScratch { pairs, events, .. } = scratch;
        events.take_pairs(particles.len(), pairs, threads)?;
        let StepScratch { contact_pairs, contact_pair_parts, rest_distances, forces, .. } = scratch;
        let to = (&mut *contact_pairs, contact_pair_parts);
        // Which pairs become contacts must follow from the state of the two. Candidate pairs are
        // more where bounds are larger, and bounds depend on the speeds of all particles. If all
        // candidates became contacts, a fast particle far away would change the colours, and with
        // them the order of solving and the bits of a pile.
        if plan.may_rest {
            let free = FreeReaches::new(settings, forces, plan.dt);
            rest_distances.clear();
            let all = particles.radii.iter().enumerate();
            let all = all.map(|(index, &radius)| rest_distance(free.of(particles, index), radius));
            memory::extend(rest_distances, all)?;
            let rest_distances = &rest_distances[..];
            let is_near = |pair, image| is_near(particles, rest_distances, pair, image);
            find_pairs(pairs, to, threads, is_near)?;
            if is_mixed {
                self.leave_out_elastic()?;
            }
        } else {
            find_pairs(pairs, to, threads, |pair, image| overlap(particles, pair, image))?;
        }
        interrupt::check()?;
        let Self {
            bodies: Bodies { awake: Discs { particles, .. }, .. }, scratch, contacts, ..
        } = self;
        contacts.colour(&scratch.contact_pairs, particles, threads)?;
        interrupt::check()?;
        // Ranks solve colour after colour together, with an exchange of ghosts between. So all need
        // the same number of colours and rounds, and the same number of sub-steps.
        let (shape, refinement) = (self.contacts.shape(), own_refinement(self, plan));
        let (shape, refinement) = self.halo.protocol().agree_on_order(self, shape, refinement)?;
        let Self {
            bodies: Bodies { awake: Discs { particles, .. }, .. }, scratch, contacts, ..
        } = self;
        let lists = &scratch.contact_pairs;
        // The rows of the tree are the indices that the particles had in the last step. By these
        // the impulses for warm starting are found.
        let before = scratch.tree.rows();
        let StepScratch { lossy, .. } = &*scratch;
        let materials = Materials { particles, lossy };
        contacts.collect(lists, &materials, before, shape.rounds, threads)?;
        scratch.contact_shape = shape;
        Ok(refinement)
    }

    /// Finds the particles that lose energy, if some do and others do not; returns whether this is
    /// so.
    fn find_lossy(&mut self, is_lossless: bool) -> Result<bool> {
        let Self {
            bodies: Bodies { awake: Discs { particles, .. }, .. },
            scratch,
            boundaries,
            halo,
            ..
        } = self;
        scratch.lossy.clear();
        // Contacts of stiff springs are solved as resting ones, also where nothing loses energy.
        if is_lossless || !boundaries.walls.are_elastic() || scratch.forces.are_springs_stiff {
            return Ok(false);
        }
        let all = (0..particles.len()).map(|index| loses_energy(particles, index));
        memory::extend(&mut scratch.lossy, all)?;
        // An empty list means that there is nothing to distinguish. Other ranks may have elastic
        // particles, so one rank cannot decide this by itself.
        if halo.is_alone() && scratch.lossy.iter().all(|&lossy| lossy) {
            scratch.lossy.clear();
            return Ok(false);
        }
        Ok(true)
    }

    /// Leaves out pairs that cannot come to rest, in a world in which some particles lose energy and
    /// others do not. Marks the particles that may touch one that loses energy as lossy, too. Of two
    /// particles without a mark only pairs that overlap are kept, as in a world in which nothing loses
    /// energy.
    fn leave_out_elastic(&mut self) -> Result<()> {
        let Self { bodies: Bodies { awake: Discs { particles, .. }, .. }, scratch, halo, .. } =
            self;
        let StepScratch { lossy, contact_pairs, .. } = scratch;
        let own = |index: usize| loses_energy(particles, index);
        // The test reads the particles and not the list that it writes. So only direct neighbours
        // are added, and the order of the pairs changes nothing.
        for pair in contact_pairs.iter().flat_map(|(_, pairs)| pairs) {
            let [a, b] = pair.map(|index| index as usize);
            lossy[a] |= own(b);
            lossy[b] |= own(a);
        }
        // Only its own process has all that a particle may touch.
        let halo: &dyn Halo = &**halo;
        let cells = Cell::from_mut(&mut lossy[..]).as_slice_of_cells();
        halo.wait()?;
        halo.refresh(
            |index| [f32::from(u8::from(cells[index as usize].get()))],
            |index, [is_lossy]| cells[index as usize].set(is_lossy > 0.0),
        )?;
        for (image, pairs) in contact_pairs.iter_mut() {
            let is_any = |pair: [u32; 2]| pair.iter().any(|&index| lossy[index as usize]);
            pairs.retain(|&pair| is_any(pair) || overlap(particles, pair, *image));
        }
        Ok(())
    }

    /// Moves the pairs that do not push each other to lists of their own: those with sensors, and all
    /// if particles merge.
    fn take_pairs_that_pass(&mut self) -> Result<()> {
        let Self {
            bodies: Bodies { awake: Discs { particles, .. }, .. },
            scratch: StepScratch { pairs, sensed, candidate_merges, .. },
            ..
        } = self;
        if !particles.sensors.is_empty() {
            let is_sensor = |index: u32| particles.is_sensor(index as usize);
            take(pairs, sensed, |[a, b]| is_sensor(a) || is_sensor(b))?;
        }
        candidate_merges.clear();
        if self.settings.on_touch == OnTouch::Merge {
            merge::list_candidates(pairs, particles, candidate_merges)?;
            pairs.clear();
        }
        Ok(())
    }
}

/// Whether the collisions of a particle lose energy by its own coefficients.
pub(crate) fn loses_energy(particles: &Particles, index: usize) -> bool {
    particles.restitution[index] < 1.0 || particles.spin(index).friction > 0.0
}

/// Lists the pairs for which `is_listed` is true, sorted; the scratch keeps the lists of threads.
fn find_pairs(
    pairs: &Lists,
    (contact_pairs, scratch): (&mut Lists, &mut Vec<Vec<[u32; 2]>>),
    threads: Option<usize>,
    is_listed: impl Fn([u32; 2], [f32; 2]) -> bool + Sync + Send,
) -> Result<()> {
    memory::resize_default(contact_pairs, pairs.len())?;
    for ((image, pairs), (image_of_list, list)) in pairs.iter().zip(contact_pairs.iter_mut()) {
        *image_of_list = *image;
        // Parts have a fixed size, and are joined in their order: the list is the same for every
        // number of threads.
        let count = pairs.len().div_ceil(FILTERED);
        memory::resize_default(scratch, scratch.len().max(count))?;
        let parts = scratch.iter_mut().zip(pairs.chunks(FILTERED));
        parallel::try_for_each(threads, parts, |(part, pairs)| {
            part.clear();
            memory::extend(part, pairs.iter().copied().filter(|&pair| is_listed(pair, *image)))
        })?;
        list.clear();
        for part in &scratch[..count] {
            memory::append(list, part)?;
        }
        // Candidates are sorted only where something may rest. The contacts of other worlds need an
        // order that follows from the state, too.
        if !list.is_sorted() {
            list.sort_unstable();
        }
    }
    Ok(())
}

/// Whether two particles may come near each other by themselves, the second moved by `image`.
#[inline(always)]
fn is_near(
    particles: &Particles,
    rest_distances: &[f32],
    [a, b]: [u32; 2],
    image: [f32; 2],
) -> bool {
    let [a, b] = [a, b].map(|index| index as usize);
    let (p, q) = (particles.positions[a], particles.positions[b]);
    let [x, y] = [0, 1].map(|k| q[k] - p[k] + image[k]);
    let limit = (particles.radii[a] + particles.radii[b]) + (rest_distances[a] + rest_distances[b]);
    x * x + y * y < limit * limit
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
fn take(from: &mut Lists, to: &mut Lists, is_taken: impl Fn([u32; 2]) -> bool) -> Result<()> {
    for (image, pairs) in from {
        let mut taken = Vec::new();
        memory::extend(&mut taken, pairs.iter().copied().filter(|&pair| is_taken(pair)))?;
        pairs.retain(|&pair| !is_taken(pair));
        memory::push(to, (*image, taken))?;
    }
    Ok(())
}
