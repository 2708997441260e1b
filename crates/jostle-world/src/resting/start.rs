//! Which contacts of two particles rest in a sub-step, and how they begin it.
//!
//! This is [`Surfaces::start`](super::Surfaces::start) for sixteen contacts at a time.

use super::pairs::Block;
use super::{FARTHEST, TOUCHING, friction};
use crate::contacts;
use crate::motion::{Motions, Vectors};
use crate::trajectory::rest_speeds;
use jostle_simd::{LANES, Number, PairIndices, Simd, Work, for_each_lane};

/// What the contacts of a [`Block`] have in all sub-steps of a step, and the sums of their impulses.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))] // Each column in a cache line of its own.
pub struct Limits {
    /// See [`rest_speeds`].
    rest_speeds: [[f32; LANES]; 2],
    /// Along the normal, of all sub-steps.
    totals: [f32; LANES],
    /// A bit for each contact that has pushed.
    pushed: u32,
}

impl Limits {
    /// Those of some contacts; if `lossy` is not empty, only of particles for which it is true.
    pub fn new(of: &contacts::Block, lossy: &[bool]) -> Self {
        let zeros = [0.0; LANES];
        let mut limits = Self { rest_speeds: [zeros; 2], totals: zeros, pushed: 0 };
        let mut last = (f32::NAN, [0.0; 2]);
        of.each_lane(|lane| {
            let mut both = [0, 1].map(|k| of.indices.of(k)[lane] as usize).into_iter();
            if !lossy.is_empty() && !both.any(|index| lossy[index]) {
                return;
            }
            let restitution = of.restitutions[lane];
            // Most contacts have the same.
            if restitution != last.0 {
                last = (restitution, rest_speeds(f64::from(restitution)).map(|v| v as f32));
            }
            [limits.rest_speeds[0][lane], limits.rest_speeds[1][lane]] = last.1;
        });
        limits
    }

    /// Adds the impulses of a sub-step.
    #[inline(always)]
    fn count<S: Simd<f32>>(&mut self, simd: S, block: &Block) {
        if block.resting == 0 {
            return;
        }
        let [impact, rest] = [simd.load(&block.impulses[0]), simd.load(&block.impulses[1])];
        let sum = simd.add(simd.load(&self.totals), simd.add(impact, rest));
        simd.store(sum, &mut self.totals);
        let zero = simd.splat(0.0);
        self.pushed |= simd.less(zero, impact) | simd.less(zero, rest);
    }

    /// Stores the impulses in the contacts.
    pub fn store(&self, block: &Block, to: &mut contacts::Block) {
        to.impulses = [block.impulses[1], [0.0; LANES]];
        to.totals[0] = self.totals;
        to.touched |= self.pushed;
    }
}

/// Counts the impulses of the sub-step before, and finds the contacts that rest.
pub struct Starts<'a> {
    pub of: &'a [contacts::Block],
    pub limits: &'a mut [Limits],
    pub blocks: &'a mut [Block],
    /// The friction of each block; empty if there is none.
    pub frictions: &'a mut [friction::Block],
    /// The state of all particles at the beginning of the sub-step.
    pub positions: &'a Vectors,
    pub velocities: &'a Vectors,
    pub motions: &'a Motions,
    pub radii: &'a [f32],
    /// The speeds that gravity and forces give to them in the sub-step, and 0.
    pub speeds: &'a Vectors,
    /// That speed if it is the same for all that move.
    pub speed_of_all: Option<f32>,
    /// Seconds of the sub-step.
    pub duration: f32,
}

impl Starts<'_> {
    /// Does it with the widest instructions of the machine. Returns whether any surfaces touch and
    /// approach too fast to rest.
    pub fn run(self) -> bool {
        f32::with_widest(self)
    }
}

impl Work<f32> for Starts<'_> {
    type Out = bool;

    #[inline(always)]
    fn run<S: Simd<f32>>(self, simd: S) -> bool {
        let mut is_fast = false;
        let mut frictions = self.frictions.iter_mut();
        for ((block, limits), of) in self.blocks.iter_mut().zip(&mut *self.limits).zip(self.of) {
            // The impulses of the sub-step before, which are in the cache now.
            limits.count(simd, block);
            let has_rested = block.resting != 0;
            let all = All {
                positions: self.positions,
                velocities: self.velocities,
                motions: self.motions,
                radii: self.radii,
                speeds: self.speeds,
                speed_of_all: self.speed_of_all,
                duration: self.duration,
            };
            is_fast |= start(simd, block, limits, of, &all);
            if let Some(friction) = frictions.next() {
                if has_rested {
                    friction.count(simd);
                }
                friction.begin(simd, block.resting);
            }
        }
        is_fast
    }
}

/// The columns of [`Starts`].
struct All<'a> {
    positions: &'a Vectors,
    velocities: &'a Vectors,
    motions: &'a Motions,
    radii: &'a [f32],
    speeds: &'a Vectors,
    speed_of_all: Option<f32>,
    duration: f32,
}

/// Finds the contacts of a block that rest. Returns whether any of them is too fast.
#[inline(always)]
fn start<S: Simd<f32>>(
    simd: S,
    block: &mut Block,
    limits: &Limits,
    of: &contacts::Block,
    all: &All<'_>,
) -> bool {
    let h = simd.splat(all.duration);
    let zero = simd.splat(0.0);
    let [x, y] = difference(simd, all.positions, &of.indices);
    let x = simd.add(x, simd.load(&of.images[0]));
    let y = simd.add(y, simd.load(&of.images[1]));
    let length = simd.sqrt(simd.add(simd.mul(x, x), simd.mul(y, y)));
    // Coincident centres keep their normal.
    let is_apart = simd.less(zero, length) & simd.less(length, simd.splat(f32::INFINITY));
    let mut nx = simd.choose(is_apart, simd.div(x, length), simd.load(&block.normal[0]));
    let mut ny = simd.choose(is_apart, simd.div(y, length), simd.load(&block.normal[1]));
    let contact_distance = simd.load(&of.contact_distances);
    let mut gap = simd.sub(length, contact_distance);
    if of.uneven_sizes != 0 {
        let mut columns = [[0.0; LANES]; 3];
        // Without closures, in which vector instructions would become calls.
        simd.store(nx, &mut columns[0]);
        simd.store(ny, &mut columns[1]);
        simd.store(gap, &mut columns[2]);
        measure_exactly(of, all, &mut columns);
        nx = simd.load(&columns[0]);
        ny = simd.load(&columns[1]);
        gap = simd.load(&columns[2]);
    }

    let [u, v] = difference(simd, all.velocities, &of.indices);
    let normal_speed = simd.add(simd.mul(nx, u), simd.mul(ny, v));
    let [a, b] = [0, 1].map(|k| match all.speed_of_all {
        Some(speed) => {
            let moves = simd.less(zero, simd.load(&of.inverse_masses[k]));
            simd.choose(moves, simd.splat(speed), zero)
        }
        None => simd.gather(all.speeds.words(), &of.indices, k)[0],
    });
    let most = simd.max(a, b);
    let approach = simd.mul(simd.load(&limits.rest_speeds[0]), most);
    let separation = simd.mul(simd.load(&limits.rest_speeds[1]), most);
    let minus_approach = simd.sub(simd.splat(-0.0), approach);

    let farthest = simd.mul(simd.mul(simd.splat(FARTHEST), most), h);
    let closing_speed = simd.div(simd.max(gap, zero), h);
    let is_near = simd.at_most(gap, farthest)
        & simd.at_most(closing_speed, simd.add(simd.add(approach, a), b));
    let is_touching = simd.at_most(gap, simd.mul(simd.splat(TOUCHING), simd.load(&of.sizes)));
    let has_pushed = simd.less(zero, simd.load(&block.impulses[1]));
    let is_slow = simd.at_most(minus_approach, normal_speed)
        & (simd.at_most(normal_speed, separation) | has_pushed);
    let fallen = simd.mul(simd.mul(simd.splat(2.0), most), closing_speed);
    let impact = simd.add(simd.mul(normal_speed, normal_speed), fallen);
    let limit = simd.choose(has_pushed, simd.max(approach, most), approach);
    let is_low = simd.at_most(impact, simd.mul(limit, limit));
    // The normal is taken as constant.
    let speed = simd.sqrt(simd.add(simd.mul(u, u), simd.mul(v, v)));
    let is_steady = simd.at_most(simd.mul(speed, h), simd.mul(simd.splat(0.5), contact_distance));
    let resting = is_near
        & (is_touching | is_slow & is_low)
        & is_steady
        & simd.less(zero, approach)
        & of.lanes;

    let fast = resting & is_touching & simd.less(normal_speed, minus_approach);
    let minus_restitution = simd.sub(simd.splat(-0.0), simd.load(&of.restitutions));
    let slow_bounce = simd.choose(is_touching, simd.min(normal_speed, zero), simd.splat(f32::MIN));
    let bounce = simd.choose(fast, simd.mul(minus_restitution, normal_speed), slow_bounce);
    let least_speeds = [bounce, simd.sub(simd.splat(-0.0), closing_speed)];
    block.begin(simd, [nx, ny], least_speeds, resting);
    fast != 0
}

/// Writes the normals and gaps of the contacts that are too uneven for float32.
#[cold]
fn measure_exactly(of: &contacts::Block, all: &All<'_>, columns: &mut [[f32; LANES]; 3]) {
    for_each_lane(of.uneven_sizes, |lane| {
        let lane = lane % LANES;
        let (normal, gap) = of.measure(lane, all.radii, |index| all.motions.exact(index));
        if let Some(normal) = normal {
            (columns[0][lane], columns[1][lane]) = (normal[0] as f32, normal[1] as f32);
        }
        columns[2][lane] = gap as f32;
    });
}

/// Vectors of the second particles minus those of the first.
#[inline(always)]
fn difference<S: Simd<f32>>(simd: S, of: &Vectors, indices: &PairIndices) -> [S::Block; 2] {
    let [ax, ay] = simd.gather(of.words(), indices, 0);
    let [bx, by] = simd.gather(of.words(), indices, 1);
    [simd.sub(bx, ax), simd.sub(by, ay)]
}

/// Adds the impulses of a sub-step to the sums of the step.
pub struct Counts<'a> {
    pub limits: &'a mut [Limits],
    pub blocks: &'a [Block],
    /// The friction of each block; empty if there is none.
    pub frictions: &'a mut [friction::Block],
}

impl Counts<'_> {
    /// Does it with the widest instructions of the machine.
    pub fn run(self) {
        f32::with_widest(self);
    }
}

impl Work<f32> for Counts<'_> {
    type Out = ();

    #[inline(always)]
    fn run<S: Simd<f32>>(self, simd: S) {
        for (limits, block) in self.limits.iter_mut().zip(self.blocks) {
            limits.count(simd, block);
        }
        for (friction, block) in self.frictions.iter_mut().zip(self.blocks) {
            if block.resting != 0 {
                friction.count(simd);
            }
        }
    }
}
