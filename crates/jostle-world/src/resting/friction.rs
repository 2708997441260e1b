//! Friction of the resting contacts of two particles, in the same blocks as the contacts.
//!
//! The impulse along the surfaces makes them stick, and is at most μ times the impulse along the
//! normal at that moment.

use super::pairs::{self, Pass, Phase};
use crate::contacts;
use crate::motion::Scalars;
use jostle_simd::{LANES, Simd};

/// The friction of the pairs of a block, one column for each quantity. Unused lanes have no
/// friction.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    friction: [f32; LANES],
    /// Change of the surface speed by an impulse along the surface: r²/I, 0 for points.
    softness: [[f32; LANES]; 2],
    /// Impulse for a change of the sliding speed by one.
    effective_masses: [f32; LANES],
    /// Impulses of the impacts and of the resting contacts.
    impulses: [[f32; LANES]; 2],
    /// Sums of the impulses of all sub-steps.
    totals: [f32; LANES],
}

impl Block {
    /// The friction of some contacts, with the impulses of the step before.
    pub fn new(of: &contacts::Block, radii: &[f32]) -> Self {
        let zeros = [0.0; LANES];
        let mut block = Self {
            friction: of.frictions,
            softness: [zeros; 2],
            effective_masses: zeros,
            impulses: [zeros, of.impulses[1]],
            totals: zeros,
        };
        of.each_lane(|lane| {
            let masses = [0, 1].map(|k| of.inverse_masses[k][lane]);
            let softness = [0, 1].map(|k| {
                let is_point = radii[of.indices.of(k)[lane] as usize] == 0.0;
                if is_point { 0.0 } else { 2.0 * masses[k] }
            });
            [block.softness[0][lane], block.softness[1][lane]] = softness;
            let flying = masses[0] + masses[1];
            block.effective_masses[lane] = 1.0 / (flying + (softness[0] + softness[1]));
        });
        block
    }

    /// Begins a sub-step in which some contacts rest.
    #[inline(always)]
    pub fn begin<S: Simd<f32>>(&mut self, simd: S, resting: u32) {
        let zero = simd.splat(0.0);
        let [impacts, impulses] = &mut self.impulses;
        simd.store(zero, impacts);
        simd.store(simd.choose(resting, simd.load(impulses), zero), impulses);
    }

    /// Adds the impulses of a sub-step to the sums.
    #[inline(always)]
    pub fn count<S: Simd<f32>>(&mut self, simd: S) {
        let [impact, rest] = [simd.load(&self.impulses[0]), simd.load(&self.impulses[1])];
        let sum = simd.add(simd.load(&self.totals), simd.add(impact, rest));
        simd.store(sum, &mut self.totals);
    }

    /// Stores the impulses in the contacts.
    pub fn store(&self, to: &mut contacts::Block) {
        to.impulses[1] = self.impulses[Phase::Rest as usize];
        to.totals[1] = self.totals;
    }

    /// Corrects the impulses of friction, or only applies those that they have. Returns the new
    /// velocities.
    #[inline(always)]
    pub fn solve<S: Simd<f32>>(
        &mut self,
        simd: S,
        pairs: &pairs::Block,
        velocities: [S::Block; 4],
        surface_speeds: &Scalars,
        pass: Pass,
    ) -> [S::Block; 4] {
        let phase = pass.phase() as usize;
        let [au, zero] = simd.gather(surface_speeds.words(), &pairs.indices, 0);
        let [bu, _] = simd.gather(surface_speeds.words(), &pairs.indices, 1);
        let [ax, ay, bx, by] = velocities;
        let tx = simd.sub(simd.splat(-0.0), simd.load(&pairs.normal[1]));
        let ty = simd.load(&pairs.normal[0]);
        let impulses = &mut self.impulses[phase];
        let old = simd.load(impulses);
        let change = if pass == Pass::Start {
            old
        } else {
            let x = simd.mul(tx, simd.sub(bx, ax));
            let passing = simd.add(x, simd.mul(ty, simd.sub(by, ay)));
            let sliding = simd.sub(passing, simd.add(au, bu));
            let wanted = simd.sub(old, simd.mul(sliding, simd.load(&self.effective_masses)));
            let most = simd.mul(simd.load(&self.friction), simd.load(&pairs.impulses[phase]));
            let least = simd.sub(simd.splat(0.0), most);
            let new = simd.max(simd.min(wanted, most), least);
            simd.store(new, impulses);
            // A change that is not finite would reach particles that do not move.
            let most = simd.splat(f32::MAX);
            simd.max(simd.min(simd.sub(new, old), most), simd.splat(f32::MIN))
        };
        let au = simd.sub(au, simd.mul(change, simd.load(&self.softness[0])));
        let bu = simd.sub(bu, simd.mul(change, simd.load(&self.softness[1])));
        simd.scatter([au, zero], surface_speeds.words(), &pairs.indices, 0);
        simd.scatter([bu, zero], surface_speeds.words(), &pairs.indices, 1);
        pairs.pushed(simd, velocities, [tx, ty], change)
    }
}
