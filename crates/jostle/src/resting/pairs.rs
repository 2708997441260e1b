//! Resting contacts of two particles, in blocks of contacts that share no particle that moves.

use super::{Support, Surfaces, friction, relaxation};
use crate::contacts::Contact;
use crate::flow::Kick;
use crate::motion::{Scalars, Vectors};
use crate::simd::{LANES, Number, Simd, Work};

/// Two particles whose contact rests.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    /// Whether they touch and approach too fast to rest.
    pub is_fast: bool,
    pub places: [u32; 2],
    normal: [f32; 2],
    pub inverse_masses: [f32; 2],
    /// Speed at which the gap may close.
    closing_speed: f32,
    /// Speed at which the two separate at least after the impact at the beginning.
    bounce: f32,
    impulse: f32,
    /// Coefficient of friction.
    pub friction: f32,
    /// Impulse of friction in the sub-step before.
    pub friction_impulse: f32,
    /// The index of the contact.
    contact: u32,
}

impl Pair {
    /// The pair, if its contact may rest in this sub-step. The contact is up to date with the
    /// positions.
    #[inline(always)]
    pub fn of(contact: &Contact, index: u32, scene: &Support<'_>, kicks: &[Kick]) -> Option<Self> {
        let h = scene.flow.duration as f32;
        let places = contact.places;
        let [a, b] = places.map(|place| scene.velocity(place as usize));
        let relative = [b[0] - a[0], b[1] - a[1]];
        let surfaces = Surfaces {
            gap: contact.gap,
            reach: contact.reach,
            normal_speed: dot(contact.normal, relative),
            restitution: contact.restitution,
            speeds: places.map(|place| kicks[place as usize].speed),
            has_pushed: contact.impulse > 0.0,
        };
        let start = surfaces.start(h)?;
        // The normal is taken as constant.
        if dot(relative, relative).sqrt() * h > 0.5 * contact.reach {
            return None;
        }
        Some(Self {
            is_fast: start.is_fast,
            places,
            normal: contact.normal,
            inverse_masses: contact.inverse_masses,
            closing_speed: start.closing_speed,
            bounce: start.bounce,
            impulse: contact.impulse,
            friction: contact.friction,
            friction_impulse: contact.friction_impulse,
            contact: index,
        })
    }
}

/// Up to [`LANES`] pairs of one colour, one column for each quantity. Unused lanes have impulses of
/// 0 and the place `spare`.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    len: usize,
    pub places: [[u32; LANES]; 2],
    pub normal: [[f32; LANES]; 2],
    pub inverse_masses: [[f32; LANES]; 2],
    /// Impulse for a change of the normal speed by one: 1 / (1/m₁ + 1/m₂).
    effective_masses: [f32; LANES],
    /// The same times the relaxation factor.
    relaxed_masses: [f32; LANES],
    /// Minimum normal speeds after the impacts, and at the end of the sub-step.
    least_speeds: [[f32; LANES]; 2],
    /// Impulses of the impacts and of the resting contacts.
    pub impulses: [[f32; LANES]; 2],
    contacts: [u32; LANES],
}

/// What the impulses of a sweep belong to: the first or the second of [`Block::impulses`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// The impacts at the beginning of the sub-step.
    Impact,
    /// The contacts at its end.
    Rest,
}

/// What a pass over all contacts does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pass {
    /// Corrects the impulses of the impacts.
    Impact,
    /// Applies the impulses of the sub-step before to the resting contacts.
    Start,
    /// Corrects the impulses of the resting contacts with over-relaxation.
    Relaxed,
    /// Corrects them without.
    Exact,
}

impl Pass {
    /// The phase whose impulses it applies.
    pub fn phase(self) -> Phase {
        if self == Self::Impact { Phase::Impact } else { Phase::Rest }
    }
}

impl Block {
    /// A block without pairs; `spare` is a place without a particle.
    pub fn new(spare: u32) -> Self {
        Self {
            len: 0,
            places: [[spare; LANES]; 2],
            normal: [[0.0; LANES]; 2],
            inverse_masses: [[0.0; LANES]; 2],
            effective_masses: [0.0; LANES],
            relaxed_masses: [0.0; LANES],
            least_speeds: [[0.0; LANES]; 2],
            impulses: [[0.0; LANES]; 2],
            contacts: [0; LANES],
        }
    }

    /// Adds a pair.
    pub fn push(&mut self, pair: &Pair) {
        let lane = self.len;
        self.len += 1;
        for k in [0, 1] {
            self.places[k][lane] = pair.places[k];
            self.normal[k][lane] = pair.normal[k];
            self.inverse_masses[k][lane] = pair.inverse_masses[k];
        }
        let effective_mass = 1.0 / (pair.inverse_masses[0] + pair.inverse_masses[1]);
        self.effective_masses[lane] = effective_mass;
        self.relaxed_masses[lane] = effective_mass * relaxation(pair.inverse_masses);
        self.least_speeds[Phase::Impact as usize][lane] = pair.bounce;
        self.least_speeds[Phase::Rest as usize][lane] = -pair.closing_speed;
        self.impulses[Phase::Rest as usize][lane] = pair.impulse;
        self.contacts[lane] = pair.contact;
    }

    /// The number of pairs.
    pub fn len(&self) -> usize {
        self.len
    }

    /// The contacts of the pairs.
    pub fn contacts(&self) -> &[u32] {
        &self.contacts[..self.len]
    }

    /// Stores the impulses in the contacts.
    pub fn store(&self, contacts: &mut [Contact]) {
        for lane in 0..self.len {
            let [impact, rest] = self.impulses.map(|impulses| impulses[lane]);
            let contact = &mut contacts[self.contacts[lane] as usize];
            contact.impulse = rest;
            contact.count([impact + rest, 0.0]);
            contact.touched |= rest > 0.0 || impact > 0.0;
        }
    }

    /// The velocities of the first and of the second particles: x and y of each.
    #[inline(always)]
    fn velocities<S: Simd<f32>>(&self, simd: S, of: &Vectors) -> [S::Block; 4] {
        let mut both = [[0.0; LANES]; 4];
        for k in [0, 1] {
            for (lane, &place) in self.places[k].iter().enumerate() {
                [both[2 * k][lane], both[2 * k + 1][lane]] = of.get(place);
            }
        }
        both.map(|column| simd.load(&column))
    }

    /// Writes the velocities. Particles that do not move get the velocity that they had: finite
    /// impulses times 0. Several threads may write the same value.
    #[inline(always)]
    fn set_velocities<S: Simd<f32>>(&self, simd: S, blocks: [S::Block; 4], of: &Vectors) {
        let mut both = [[0.0; LANES]; 4];
        for (column, block) in both.iter_mut().zip(blocks) {
            simd.store(block, column);
        }
        for k in [0, 1] {
            for (lane, &place) in self.places[k].iter().enumerate() {
                of.set(place, [both[2 * k][lane], both[2 * k + 1][lane]]);
            }
        }
    }

    /// Corrects the impulses so that the pairs separate with their least speeds, or only applies
    /// those that they have. Returns the new velocities.
    #[inline(always)]
    fn solve<S: Simd<f32>>(
        &mut self,
        simd: S,
        [ax, ay, bx, by]: [S::Block; 4],
        pass: Pass,
    ) -> [S::Block; 4] {
        let phase = pass.phase() as usize;
        let [nx, ny] = self.normal.map(|column| simd.load(&column));
        let impulses = &mut self.impulses[phase];
        let old = simd.load(impulses);
        let change = if pass == Pass::Start {
            old
        } else {
            let x = simd.mul(nx, simd.sub(bx, ax));
            let normal_speed = simd.add(x, simd.mul(ny, simd.sub(by, ay)));
            let missing = simd.sub(simd.load(&self.least_speeds[phase]), normal_speed);
            let is_relaxed = pass == Pass::Relaxed;
            let masses = if is_relaxed { &self.relaxed_masses } else { &self.effective_masses };
            let wanted = simd.add(old, simd.mul(missing, simd.load(masses)));
            let new = simd.max(wanted, simd.splat(0.0));
            simd.store(new, impulses);
            // A change that is not finite would reach particles that do not move: ∞ · 0 is no number.
            let most = simd.splat(f32::MAX);
            simd.min(simd.sub(new, old), most)
        };
        self.pushed(simd, [ax, ay, bx, by], [nx, ny], change)
    }

    /// The velocities after impulses along a direction on the second particles, and against it on the
    /// first.
    #[inline(always)]
    pub fn pushed<S: Simd<f32>>(
        &self,
        simd: S,
        [ax, ay, bx, by]: [S::Block; 4],
        [x, y]: [S::Block; 2],
        impulse: S::Block,
    ) -> [S::Block; 4] {
        let [a, b] = self.inverse_masses.map(|column| simd.mul(impulse, simd.load(&column)));
        [
            simd.sub(ax, simd.mul(x, a)),
            simd.sub(ay, simd.mul(y, a)),
            simd.add(bx, simd.mul(x, b)),
            simd.add(by, simd.mul(y, b)),
        ]
    }
}

/// A pass over the blocks of a colour.
pub struct Sweep<'a> {
    /// The blocks.
    pub blocks: &'a mut [Block],
    /// The friction of each block; empty if there is none.
    pub frictions: &'a mut [friction::Block],
    /// The velocities of all particles.
    pub velocities: &'a Vectors,
    /// Angular velocity times radius of all particles.
    pub surface_speeds: &'a Scalars,
    /// What it does.
    pub pass: Pass,
}

impl Sweep<'_> {
    /// Does the pass with the widest instructions of the machine.
    pub fn run(self) {
        f32::with_widest(self);
    }
}

impl Work<f32> for Sweep<'_> {
    type Out = ();

    #[inline(always)]
    fn run<S: Simd<f32>>(self, simd: S) {
        let mut frictions = self.frictions.iter_mut();
        for block in self.blocks {
            let mut velocities = block.velocities(simd, self.velocities);
            velocities = block.solve(simd, velocities, self.pass);
            if let Some(friction) = frictions.next() {
                velocities =
                    friction.solve(simd, block, velocities, self.surface_speeds, self.pass);
            }
            block.set_velocities(simd, velocities, self.velocities);
        }
    }
}

fn dot(a: [f32; 2], b: [f32; 2]) -> f32 {
    a[0] * b[0] + a[1] * b[1]
}
