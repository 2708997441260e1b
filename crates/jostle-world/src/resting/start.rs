//! Which contacts of two particles rest in a sub-step, and how they begin it, sixteen at a time.

use super::rule::Surfaces;
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
    let zero = simd.splat(0.0);
    // Resting contacts use the float32 part of positions. Uneven contacts, for which it is not
    // enough, are measured below.
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
    // The whole relative speed, not only the normal part: it tells how far the normal turns.
    let speed = simd.sqrt(simd.add(simd.mul(u, u), simd.mul(v, v)));
    let [a, b] = [0, 1].map(|k| match all.speed_of_all {
        Some(speed) => {
            // Gravity does not act on what cannot move, so its speed is 0.
            let moves = simd.less(zero, simd.load(&block.inverse_masses[k]));
            simd.choose(moves, simd.splat(speed), zero)
        }
        None => simd.gather(all.speeds.words(), &block.indices, k)[0],
    });
    // The rule is written once, for one contact, in plain Rust. Through these columns the compiler
    // makes vector instructions of it.
    let mut columns = [[0.0; LANES]; 5];
    simd.store(gap, &mut columns[0]);
    simd.store(speed, &mut columns[1]);
    simd.store(normal_speed, &mut columns[2]);
    simd.store(a, &mut columns[3]);
    simd.store(b, &mut columns[4]);
    simd.store(nx, &mut block.normal[0]);
    simd.store(ny, &mut block.normal[1]);
    block.begin(&columns, all.duration)
}

impl Block {
    /// Begins a sub-step of `h` seconds with the contacts that rest in it. The columns are the gaps, the
    /// relative speeds, those along the normals, and those that gravity and forces give to the
    /// two. Returns whether any contact is too fast.
    #[inline(always)]
    fn begin(&mut self, [gaps, speeds, normal_speeds, a, b]: &[[f32; LANES]; 5], h: f32) -> bool {
        let (mut resting, mut fast) = (0, false);
        for lane in 0..LANES {
            let start = Surfaces {
                gap: gaps[lane],
                size: self.sizes[lane],
                curve: self.contact_distances[lane],
                speed: speeds[lane],
                normal_speed: normal_speeds[lane],
                restitution: self.restitutions[lane],
                rest_speeds: [self.rest_speeds[0][lane], self.rest_speeds[1][lane]],
                speeds: [a[lane], b[lane]],
                has_pushed: self.impulses[1][lane] > 0.0,
            }
            .start(h);
            let rests = start.rests;
            resting |= u32::from(rests) << lane;
            fast |= start.is_fast;
            self.least_speeds[0][lane] = if rests { start.bounce } else { f32::MIN };
            self.least_speeds[1][lane] = if rests { -start.closing_speed } else { f32::MIN };
            self.impulses[0][lane] = 0.0;
            // Warm starting: the impulse of the last sub-step is the first guess of this one.
            // Weight passes from layer to layer in the iterations, so without the guess ten of them
            // carry a few layers only.
            self.impulses[1][lane] = if rests { self.impulses[1][lane] } else { 0.0 };
        }
        self.resting = resting;
        fast
    }
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
