//! Friction of the resting contacts of two particles, in the same blocks as the contacts.
//!
//! The impulse along the surfaces makes them stick, and is at most μ times the impulse along the
//! normal at that moment.

use super::pairs::{self, Pair, Phase};
use crate::contacts::Contact;
use crate::motion::{Scalars, Vectors};
use crate::simd::{LANES, Number, Simd, Work};

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

    /// Corrects the impulses of friction, or only applies those that they have.
    #[inline(always)]
    fn sweep<S: Simd<f32>>(&mut self, simd: S, pairs: &pairs::Block, of: &Sweep<'_>) {
        let phase = of.phase as usize;
        // x, y and surface speed of the first, then of the second.
        let mut both = [[0.0; LANES]; 6];
        for k in [0, 1] {
            for (lane, &place) in pairs.places[k].iter().enumerate() {
                let [x, y] = of.velocities.get(place);
                (both[3 * k][lane], both[3 * k + 1][lane]) = (x, y);
                both[3 * k + 2][lane] = of.surface_speeds.get(place);
            }
        }
        let [ax, ay, au, bx, by, bu] = both.map(|column| simd.load(&column));
        let [tx, ty] = [pairs.normal[1].map(|y| -y), pairs.normal[0]].map(|t| simd.load(&t));
        let impulses = &mut self.impulses[phase];
        let old = simd.load(impulses);
        let change = if of.only_apply {
            old
        } else {
            let x = simd.mul(tx, simd.sub(bx, ax));
            let passing = simd.add(x, simd.mul(ty, simd.sub(by, ay)));
            let sliding = simd.sub(passing, simd.add(au, bu));
            let wanted = simd.sub(old, simd.mul(sliding, simd.load(&self.effective_masses)));
            let most = simd.mul(simd.load(&self.friction), simd.load(&pairs.impulses[phase]));
            let least = simd.sub(simd.splat(0.0), most);
            let new = simd.most(simd.least(wanted, most), least);
            simd.store(new, impulses);
            // A change that is not finite would reach particles that do not move.
            let most = simd.splat(f32::MAX);
            simd.most(simd.least(simd.sub(new, old), most), simd.splat(f32::MIN))
        };
        let [a, b] = pairs.inverse_masses.map(|column| simd.mul(change, simd.load(&column)));
        let [c, d] = self.softness.map(|column| simd.mul(change, simd.load(&column)));
        simd.store(simd.sub(ax, simd.mul(tx, a)), &mut both[0]);
        simd.store(simd.sub(ay, simd.mul(ty, a)), &mut both[1]);
        simd.store(simd.sub(au, c), &mut both[2]);
        simd.store(simd.add(bx, simd.mul(tx, b)), &mut both[3]);
        simd.store(simd.add(by, simd.mul(ty, b)), &mut both[4]);
        simd.store(simd.sub(bu, d), &mut both[5]);
        // Particles that do not move get what they had, as in the sweep over the normals.
        for k in [0, 1] {
            for (lane, &place) in pairs.places[k].iter().enumerate() {
                of.velocities.set(place, [both[3 * k][lane], both[3 * k + 1][lane]]);
                of.surface_speeds.set(place, both[3 * k + 2][lane]);
            }
        }
    }
}

/// What a pass over the friction of the blocks of a colour reads, and what it changes for all
/// particles.
#[derive(Clone, Copy)]
pub struct Sweep<'a> {
    /// The velocities of all particles.
    pub velocities: &'a Vectors,
    /// Angular velocity times radius of all particles.
    pub surface_speeds: &'a Scalars,
    /// Which impulses.
    pub phase: Phase,
    /// Whether the impulses are applied as they are.
    pub only_apply: bool,
}

impl Sweep<'_> {
    /// Does the pass with the widest instructions of the machine.
    pub fn run(self, pairs: &[pairs::Block], blocks: &mut [Block]) {
        f32::with_widest(Pass { sweep: self, pairs, blocks });
    }
}

struct Pass<'a> {
    sweep: Sweep<'a>,
    pairs: &'a [pairs::Block],
    blocks: &'a mut [Block],
}

impl Work<f32> for Pass<'_> {
    type Out = ();

    #[inline(always)]
    fn run<S: Simd<f32>>(self, simd: S) {
        for (block, pairs) in self.blocks.iter_mut().zip(self.pairs) {
            block.sweep(simd, pairs, &self.sweep);
        }
    }
}
