//! More sub-steps where heavy particles press on light ones.
//!
//! The impulses of resting contacts are found by iterations. Their error grows with the ratio of the
//! masses of a heavy particle and a light one on which it rests, and falls with the length of a
//! sub-step, because each sub-step begins with the impulses of the one before. So the number of
//! sub-steps grows with that ratio.

use super::World;
use super::plan::Plan;
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

impl World {
    /// How many times the usual number of sub-steps the contacts of this step need. It follows from
    /// the particles that touch as the part begins. Two ghosts do not count: their states may be
    /// wrong in later parts of a step, and the process of one of them has the pair too.
    pub(crate) fn own_refinement(&self, plan: &Plan) -> usize {
        // The number that a caller has set is used as it is.
        let is_free = self.settings.substeps.is_none() && plan.may_rest;
        // Colouring has found whether any masses differ much. Most worlds need no search.
        if !is_free || !self.contacts.has_uneven() {
            return 1;
        }
        let all = self.scratch.pairs.iter();
        let ratios = all.flat_map(|(image, pairs)| {
            pairs.iter().filter_map(|&pair| self.ratio_under_load(pair, *image))
        });
        let largest = ratios.fold(0.0, f32::max);
        ((largest / RATIO_OF_A_REFINEMENT).ceil() as usize).clamp(1, MAX_REFINEMENT)
    }

    /// The mass of the heavier particle over that of the lighter, if they touch and the heavier
    /// presses on the lighter: gravity and forces accelerate it towards the lighter.
    fn ratio_under_load(&self, pair: [u32; 2], image: [f32; 2]) -> Option<f32> {
        let own = self.halo.own_rows();
        if !pair.iter().any(|&index| self.bodies.awake.rows[index as usize] < own) {
            return None;
        }
        let particles = &self.bodies.awake.particles;
        let [a, b] = pair.map(|index| index as usize);
        let ratio = particles.masses[a] / particles.masses[b];
        let ratio = ratio.max(1.0 / ratio);
        let is_counted = RATIO_OF_A_REFINEMENT < ratio && ratio <= LARGEST_RATIO;
        if !(is_counted
            && self.bodies.awake.particles.movable[a]
            && self.bodies.awake.particles.movable[b])
        {
            return None;
        }
        let [p, q] = [a, b].map(|index| particles.positions[index]);
        let offset = [0, 1].map(|k| q[k] - p[k] + image[k]);
        let radii = [a, b].map(|index| particles.radii[index]);
        let contact_distance = f64::from(radii[0]) + f64::from(radii[1]);
        let (_, gap) = gap(offset.map(f64::from), contact_distance);
        if !are_touching(gap as f32, size_of(radii[0], radii[1])) {
            return None;
        }
        let (heavier, sign) =
            if particles.masses[a] > particles.masses[b] { (a, 1.0) } else { (b, -1.0) };
        let by_forces = self.scratch.forces.accelerations.get(heavier).copied().unwrap_or_default();
        let acceleration = [0, 1].map(|k| self.settings.gravity[k] + by_forces[k]);
        let towards = sign * (acceleration[0] * offset[0] + acceleration[1] * offset[1]);
        (towards > 0.0).then_some(ratio)
    }
}
