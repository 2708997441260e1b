//! Friction of the resting contacts of two particles, in the same blocks as the contacts.
//!
//! The impulse along the surfaces makes them stick, and is at most μ times the impulse along the
//! normal at that moment.

use super::pairs::{self, Pair, Pass, Phase};
use crate::contacts::Contact;
use crate::motion::Scalars;
use crate::simd::{LANES, Simd};

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
}

impl Default for Block {
    fn default() -> Self {
        Self {
            friction: [0.0; LANES],
            softness: [[0.0; LANES]; 2],
            effective_masses: [0.0; LANES],
            impulses: [[0.0; LANES]; 2],
        }
    }
}

impl Block {
    /// Writes the friction of the pair in a lane.
    pub fn put(&mut self, lane: usize, pair: &Pair, radii: &[f32]) {
        let softness = [0, 1].map(|k| {
            let is_point = radii[pair.places[k] as usize] == 0.0;
            if is_point { 0.0 } else { 2.0 * pair.inverse_masses[k] }
        });
        let flying = pair.inverse_masses[0] + pair.inverse_masses[1];
        self.friction[lane] = pair.friction;
        self.softness[0][lane] = softness[0];
        self.softness[1][lane] = softness[1];
        self.effective_masses[lane] = 1.0 / (flying + (softness[0] + softness[1]));
        self.impulses[Phase::Rest as usize][lane] = pair.friction_impulse;
    }

    /// Stores the impulses in the contacts.
    pub fn store(&self, pairs: &pairs::Block, contacts: &mut [Contact]) {
        for (lane, &at) in pairs.contacts().iter().enumerate() {
            let [impact, rest] = self.impulses.map(|impulses| impulses[lane]);
            let contact = &mut contacts[at as usize];
            contact.friction_impulse = rest;
            contact.count([0.0, impact + rest]);
        }
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
        let mut both = [[0.0; LANES]; 2];
        for (speeds, places) in both.iter_mut().zip(&pairs.places) {
            for (speed, &place) in speeds.iter_mut().zip(places) {
                *speed = surface_speeds.get(place);
            }
        }
        let [au, bu] = both.map(|column| simd.load(&column));
        let [ax, ay, bx, by] = velocities;
        let [tx, ty] = [pairs.normal[1].map(|y| -y), pairs.normal[0]].map(|t| simd.load(&t));
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
        for (k, (speed, softness)) in [au, bu].into_iter().zip(&self.softness).enumerate() {
            simd.store(simd.sub(speed, simd.mul(change, simd.load(softness))), &mut both[k]);
        }
        for (speeds, places) in both.iter().zip(&pairs.places) {
            for (&speed, &place) in speeds.iter().zip(places) {
                surface_speeds.set(place, speed);
            }
        }
        pairs.pushed(simd, velocities, [tx, ty], change)
    }
}
