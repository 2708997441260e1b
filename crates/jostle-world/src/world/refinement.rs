//! More sub-steps where heavy particles press on light ones.
//!
//! The impulses of resting contacts are found by iterations. Their error grows with the ratio of the
//! masses of a heavy particle and a light one on which it rests, and falls with the length of a
//! sub-step, because each sub-step begins with the impulses of the one before. So the number of
//! sub-steps grows with that ratio.

use super::World;
use super::bodies::discs::Discs;
use super::plan::Plan;
use crate::particles::Particles;
use crate::resting::are_touching;
use crate::tolerance::{gap, size_of};

/// Ratio of masses up to which [`DEFAULT_SUBSTEPS`](super::settings::DEFAULT_SUBSTEPS) are enough.
/// With radii 25:1, so masses 625:1, the largest overlap is 17 % with 4 sub-steps, 3.9 % with 16
/// and 1.1 % with 32 (docs/benchmarks-notes.md, piles of uneven discs).
const RATIO_OF_A_REFINEMENT: f32 = 128.0;

/// The largest factor of that number.
/// A step of that pile takes 7.2 ms with 4 sub-steps and 26 ms with 32.
const MAX_REFINEMENT: usize = 8;

/// Ratio of masses above which the heavier particle has no effect on the number. Programs give such
/// masses to bodies that they move themselves and that nothing should slow down.
const LARGEST_RATIO: f32 = 10_000.0;

/// How many times the usual number of sub-steps the contacts of this step need. It follows from
/// the particles that touch as the part begins. Two ghosts do not count: their states may be
/// wrong in later parts of a step, and the process of one of them has the pair too.
pub(crate) fn own_refinement(world: &World, plan: &Plan) -> usize {
    let World { settings, contacts, scratch, bodies, halo, .. } = world;
    // The number that a caller has set is used as it is.
    let is_free = settings.substeps.is_none() && plan.may_rest;
    // Colouring has found whether any masses differ much. Most worlds need no search.
    if !is_free || !contacts.has_uneven() {
        return 1;
    }
    let Discs { particles, rows, .. } = &bodies.awake;
    let own = halo.own_rows();
    let is_known = |pair: &[u32; 2]| pair.iter().any(|&index| rows[index as usize] < own);
    let acceleration = |index: usize| {
        let by_forces = scratch.forces.accelerations.get(index).copied().unwrap_or_default();
        [0, 1].map(|k| settings.gravity[k] + by_forces[k])
    };
    let ratios = scratch.pairs.iter().flat_map(|(image, pairs)| {
        let ratio = |&pair| ratio_under_load(particles, acceleration, pair, *image);
        pairs.iter().filter(|pair| is_known(pair)).filter_map(ratio)
    });
    let largest = ratios.fold(0.0, f32::max);
    ((largest / RATIO_OF_A_REFINEMENT).ceil() as usize).clamp(1, MAX_REFINEMENT)
}

/// The mass of the heavier particle over that of the lighter, if they touch and the heavier
/// presses on the lighter: gravity and forces accelerate it towards the lighter.
fn ratio_under_load(
    particles: &Particles,
    acceleration: impl Fn(usize) -> [f32; 2],
    pair: [u32; 2],
    image: [f32; 2],
) -> Option<f32> {
    let Particles { positions, masses, radii, movable, .. } = particles;
    let [a, b] = pair.map(|index| index as usize);
    let ratio = masses[a] / masses[b];
    let ratio = ratio.max(1.0 / ratio);
    let is_counted = RATIO_OF_A_REFINEMENT < ratio && ratio <= LARGEST_RATIO;
    if !(is_counted && movable[a] && movable[b]) {
        return None;
    }
    let offset = [0, 1].map(|k| positions[b][k] - positions[a][k] + image[k]);
    let contact_distance = f64::from(radii[a]) + f64::from(radii[b]);
    let (_, gap) = gap(offset.map(f64::from), contact_distance);
    if !are_touching(gap as f32, size_of(radii[a], radii[b])) {
        return None;
    }
    let (heavier, sign) = if masses[a] > masses[b] { (a, 1.0) } else { (b, -1.0) };
    let [x, y] = acceleration(heavier);
    (sign * (x * offset[0] + y * offset[1]) > 0.0).then_some(ratio)
}
