//! Which contacts of two particles rest in a sub-step, and how they begin it.
//!
//! This is [`Surfaces::start`](super::Surfaces::start) for sixteen contacts at a time.

use super::{FARTHEST, TOUCHING};
use crate::contacts::Block;
use crate::motion::{Motions, Vectors};
use jostle_simd::{LANES, Number, PairIndices, Simd, Work, for_each_lane};

/// Counts the impulses of the sub-step before, and finds the contacts that rest.
#[derive(Clone, Copy)]
pub struct Starts<'a> {
    /// The state of all particles at the beginning of the sub-step.
    pub velocities: &'a Vectors,
    pub motions: &'a Motions,
    pub radii: &'a [f32],
    /// The speeds that gravity and forces give to them in the sub-step, and 0.
    pub speeds: &'a Vectors,
    /// That speed if it is the same for all that move.
    pub speed_of_all: Option<f32>,
    /// Seconds of the sub-step.
    pub duration: f32,
    /// Whether there is friction.
    pub has_friction: bool,
}

impl Starts<'_> {
    /// Does it for some blocks, with the widest instructions of the machine. Returns whether any
    /// surfaces touch and approach too fast to rest.
    pub fn run(self, blocks: &mut [Block]) -> bool {
        f32::with_widest(StartsOfBlocks(self, blocks))
    }
}

struct StartsOfBlocks<'a>(Starts<'a>, &'a mut [Block]);

impl Work<f32> for StartsOfBlocks<'_> {
    type Out = bool;

    #[inline(always)]
    fn run<S: Simd<f32>>(self, simd: S) -> bool {
        let Self(all, blocks) = self;
        let mut is_fast = false;
        for block in blocks {
            // The impulses of the sub-step before, which are in the cache now.
            block.count(all.has_friction);
            is_fast |= start(simd, block, &all);
            if all.has_friction {
                block.begin_friction(simd);
            }
        }
        is_fast
    }
}

/// Finds the contacts of a block that rest. Returns whether any of them is too fast.
#[inline(always)]
fn start<S: Simd<f32>>(simd: S, block: &mut Block, all: &Starts<'_>) -> bool {
    let h = simd.splat(all.duration);
    let zero = simd.splat(0.0);
    let [x, y] = difference(simd, &all.motions.positions, &block.indices);
    let x = simd.add(x, simd.load(&block.images[0]));
    let y = simd.add(y, simd.load(&block.images[1]));
    let length = simd.sqrt(simd.add(simd.mul(x, x), simd.mul(y, y)));
    // Coincident centres keep their normal.
    let is_apart = simd.less(zero, length) & simd.less(length, simd.splat(f32::INFINITY));
    let mut nx = simd.choose(is_apart, simd.div(x, length), simd.load(&block.normal[0]));
    let mut ny = simd.choose(is_apart, simd.div(y, length), simd.load(&block.normal[1]));
    let contact_distance = simd.load(&block.contact_distances);
    let mut gap = simd.sub(length, contact_distance);
    if block.uneven_sizes != 0 {
        let mut columns = [[0.0; LANES]; 3];
        // Without closures, in which vector instructions would become calls.
        simd.store(nx, &mut columns[0]);
        simd.store(ny, &mut columns[1]);
        simd.store(gap, &mut columns[2]);
        measure_exactly(block, all, &mut columns);
        nx = simd.load(&columns[0]);
        ny = simd.load(&columns[1]);
        gap = simd.load(&columns[2]);
    }

    let [u, v] = difference(simd, all.velocities, &block.indices);
    let normal_speed = simd.add(simd.mul(nx, u), simd.mul(ny, v));
    let [a, b] = [0, 1].map(|k| match all.speed_of_all {
        Some(speed) => {
            let moves = simd.less(zero, simd.load(&block.inverse_masses[k]));
            simd.choose(moves, simd.splat(speed), zero)
        }
        None => simd.gather(all.speeds.words(), &block.indices, k)[0],
    });
    let most = simd.max(a, b);
    let approach = simd.mul(simd.load(&block.rest_speeds[0]), most);
    let separation = simd.mul(simd.load(&block.rest_speeds[1]), most);
    let minus_approach = simd.sub(simd.splat(-0.0), approach);

    let farthest = simd.mul(simd.mul(simd.splat(FARTHEST), most), h);
    let closing_speed = simd.div(simd.max(gap, zero), h);
    let is_near = simd.at_most(gap, farthest)
        & simd.at_most(closing_speed, simd.add(simd.add(approach, a), b));
    let is_touching = simd.at_most(gap, simd.mul(simd.splat(TOUCHING), simd.load(&block.sizes)));
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
        & block.lanes;

    let fast = resting & is_touching & simd.less(normal_speed, minus_approach);
    let minus_restitution = simd.sub(simd.splat(-0.0), simd.load(&block.restitutions));
    let slow_bounce = simd.choose(is_touching, simd.min(normal_speed, zero), simd.splat(f32::MIN));
    let bounce = simd.choose(fast, simd.mul(minus_restitution, normal_speed), slow_bounce);
    let least_speeds = [bounce, simd.sub(simd.splat(-0.0), closing_speed)];
    block.begin(simd, [nx, ny], least_speeds, resting);
    fast != 0
}

/// Writes the normals and gaps of the contacts that are too uneven for float32.
#[cold]
fn measure_exactly(of: &Block, all: &Starts<'_>, columns: &mut [[f32; LANES]; 3]) {
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
