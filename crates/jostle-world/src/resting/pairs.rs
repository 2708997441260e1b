//! Impulses of resting contacts of two particles, in blocks of contacts that share no particle that
//! moves. Impulses are mass times speed, and those of one sub-step. So the impulses of a sub-step are a
//! good start for the next one if both have the same length.

use crate::contacts::Block;
use crate::forces::springs::Push;
use crate::motion::{Scalars, Vectors};
use jostle_simd::{Number, Simd, Work};

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
    /// The contact of a lane, as springs see it.
    pub fn push(&self, lane: usize) -> Push {
        Push {
            normal: self.normal.map(|of| of[lane]),
            least_speed: self.least_speeds[Phase::Rest as usize][lane],
            impulse: self.impulses[Phase::Rest as usize][lane],
        }
    }

    /// Leaves out the impact of a lane.
    pub fn forgo_impact(&mut self, lane: usize) {
        self.least_speeds[Phase::Impact as usize][lane] = f32::MIN;
    }

    /// The velocities of the first and of the second particles: x and y of each.
    #[inline(always)]
    fn velocities<S: Simd<f32>>(&self, simd: S, of: &Vectors) -> [S::Block; 4] {
        // Velocities stay in one array for all contacts, and each block gathers and scatters them.
        // Copies in blocks would have to be exchanged after each colour.
        let [ax, ay] = simd.gather(of.words(), &self.indices, 0);
        let [bx, by] = simd.gather(of.words(), &self.indices, 1);
        [ax, ay, bx, by]
    }

    /// Writes the velocities. Particles that do not move get the velocity that they had: finite
    /// impulses times 0. Several threads may write the same value.
    #[inline(always)]
    fn set_velocities<S: Simd<f32>>(&self, simd: S, [ax, ay, bx, by]: [S::Block; 4], of: &Vectors) {
        // Movable particles are in one lane of one block of a colour, so no scatter overwrites
        // another's result.
        simd.scatter([ax, ay], of.words(), &self.indices, 0);
        simd.scatter([bx, by], of.words(), &self.indices, 1);
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
        let [nx, ny] = [simd.load(&self.normal[0]), simd.load(&self.normal[1])];
        let impulses = &mut self.impulses[phase];
        let old = simd.load(impulses);
        let change = if pass == Pass::Start {
            // Warm starting. The velocities do not yet contain the impulses: each sub-step begins from
            // the velocities before them, and the impulses of a pile are nearly those of the sub-step before.
            old
        } else {
            // Products and sums are separate instructions. A fused multiply-add rounds once, so
            // processors with and without it would give other bits.
            let x = simd.mul(nx, simd.sub(bx, ax));
            let normal_speed = simd.add(x, simd.mul(ny, simd.sub(by, ay)));
            let missing = simd.sub(simd.load(&self.least_speeds[phase]), normal_speed);
            // The mass is the only difference between the two passes. Float32 is enough in all of
            // this: the iteration ends with an error far above its rounding. A register holds twice
            // as many numbers as in float64.
            let is_relaxed = pass == Pass::Relaxed;
            let masses = if is_relaxed { &self.relaxed_masses } else { &self.effective_masses };
            let wanted = simd.add(old, simd.mul(missing, simd.load(masses)));
            // The sum of all corrections must not pull, one correction may: if only corrections of at
            // least 0 were allowed, an impulse that has become too large would stay (Catto 2005).
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
        let [a, b] = &self.inverse_masses;
        let (a, b) = (simd.mul(impulse, simd.load(a)), simd.mul(impulse, simd.load(b)));
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
    /// The velocities of all particles.
    pub velocities: &'a Vectors,
    /// Angular velocity times radius of all particles; empty if there is no friction.
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
        let has_friction = !self.surface_speeds.words().is_empty();
        // Blocks in which nothing rests cost one load. Lanes that do not rest have a least speed of
        // −∞ in effect, and get no impulse.
        for block in self.blocks.iter_mut().filter(|block| block.resting != 0) {
            let mut velocities = block.velocities(simd, self.velocities);
            velocities = block.solve(simd, velocities, self.pass);
            if has_friction {
                velocities = block.rub(simd, velocities, self.surface_speeds, self.pass);
            }
            block.set_velocities(simd, velocities, self.velocities);
        }
    }
}
