//! Moving the pairs of a colour apart, sixteen at a time.

use super::{DIRECTIONS, MOST, NEAR, SLOP, SOFTNESS, TOLERANCE};
use crate::contacts;
use crate::motion::Vectors;
use crate::simd::{LANES, Number, Simd, Work, for_each_lane};

/// The contacts of a [`contacts::Block`] in the same lanes, one column for each quantity.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))] // Each column in a cache line of its own.
pub struct Block {
    /// Offsets from the first to the second, before the correction.
    offset: [[f32; LANES]; 2],
    /// The squares of the distances below which the two are moved apart; 0 if they are not near.
    least_squares: [f32; LANES],
    /// The same in this step if they are near.
    near_squares: [f32; LANES],
    /// Distances to which they are moved.
    targets: [f32; LANES],
    /// The longest displacements in one iteration.
    most: [f32; LANES],
    /// The shares of each in the displacement.
    shares: [[f32; LANES]; 2],
    /// A bit for each pair that is near.
    near: u32,
    /// A bit for each pair that has overlapped in the step.
    overlapped: u32,
}

impl Block {
    /// The constants of some contacts.
    pub fn new(of: &contacts::Block, radii: &[f32]) -> Self {
        let zeros = [0.0; LANES];
        let mut block = Self {
            offset: [zeros; 2],
            least_squares: zeros,
            near_squares: zeros,
            targets: zeros,
            most: zeros,
            shares: [zeros; 2],
            near: 0,
            overlapped: 0,
        };
        of.each_lane(|lane| {
            let [p, q] = [0, 1].map(|k| radii[of.places.of(k)[lane] as usize]);
            // Points have no size: that of the other particle counts.
            let smaller = if p.min(q) > 0.0 { p.min(q) } else { p.max(q) };
            let diameter = 2.0 * smaller;
            let least = of.reaches[lane] - (SLOP + TOLERANCE) * diameter;
            block.near_squares[lane] = least * least;
            block.targets[lane] = of.reaches[lane] - SLOP * diameter;
            block.most[lane] = MOST * diameter;
            let inverse_masses = [0, 1].map(|k| of.inverse_masses[k][lane]);
            [block.shares[0][lane], block.shares[1][lane]] = match inverse_masses {
                [0.0, _] => [0.0, 1.0],
                [_, 0.0] => [1.0, 0.0],
                _ => [0.5, 0.5],
            };
        });
        block
    }

    /// Notes in the contacts which overlapped.
    pub fn store(&self, to: &mut contacts::Block) {
        to.touched |= self.overlapped;
    }

    /// Updates the offsets to the positions, and which pairs are near.
    #[inline(always)]
    fn measure<S: Simd<f32>>(
        &mut self,
        simd: S,
        of: &contacts::Block,
        positions: &Vectors,
        residuals: &Vectors,
    ) {
        let [ax, ay] = simd.gather(positions.words(), &of.places, 0);
        let [bx, by] = simd.gather(positions.words(), &of.places, 1);
        let [cx, cy] = simd.gather(residuals.words(), &of.places, 0);
        let [dx, dy] = simd.gather(residuals.words(), &of.places, 1);
        let x = simd.add(simd.sub(bx, ax), simd.load(&of.images[0]));
        let y = simd.add(simd.sub(by, ay), simd.load(&of.images[1]));
        let [x, y] = [simd.add(x, simd.sub(dx, cx)), simd.add(y, simd.sub(dy, cy))];
        let square = simd.add(simd.mul(x, x), simd.mul(y, y));
        let reach = simd.load(&of.reaches);
        self.overlapped |= simd.less(square, simd.mul(reach, reach));
        let far = simd.mul(simd.splat(1.0 + NEAR), reach);
        self.near = simd.less(square, simd.mul(far, far));
        let least = simd.choose(self.near, simd.load(&self.near_squares), simd.splat(0.0));
        simd.store(least, &mut self.least_squares);
        simd.store(x, &mut self.offset[0]);
        simd.store(y, &mut self.offset[1]);
    }

    /// Moves the pairs apart that overlap. Returns a bit for each of them.
    #[inline(always)]
    fn separate<S: Simd<f32>>(
        &self,
        simd: S,
        of: &contacts::Block,
        displacements: &Vectors,
        inside: &impl Fn(u32, [f32; 2]) -> [f32; 2],
    ) -> u32 {
        let [ax, ay] = simd.gather(displacements.words(), &of.places, 0);
        let [bx, by] = simd.gather(displacements.words(), &of.places, 1);
        let x = simd.add(simd.load(&self.offset[0]), simd.sub(bx, ax));
        let y = simd.add(simd.load(&self.offset[1]), simd.sub(by, ay));
        let square = simd.add(simd.mul(x, x), simd.mul(y, y));
        let overlapping = simd.less(square, simd.load(&self.least_squares));
        if overlapping == 0 {
            return 0;
        }
        let length = simd.sqrt(square);
        let apart = simd.less(simd.splat(0.0), length);
        let mut normal = [[0.0; LANES]; 2];
        simd.store(simd.div(x, length), &mut normal[0]);
        simd.store(simd.div(y, length), &mut normal[1]);
        for_each_lane(overlapping & !apart, |lane| {
            let [a, b] = [of.places.of(0)[lane % LANES], of.places.of(1)[lane % LANES]];
            let direction = DIRECTIONS[a.abs_diff(b) as usize % DIRECTIONS.len()];
            [normal[0][lane % LANES], normal[1][lane % LANES]] = direction;
        });
        let [nx, ny] = [simd.load(&normal[0]), simd.load(&normal[1])];
        let excess = simd.sub(simd.load(&self.targets), length);
        let softened = simd.mul(simd.splat(SOFTNESS), simd.max(excess, simd.splat(0.0)));
        let most = simd.load(&self.most);
        let a = simd.min(simd.mul(softened, simd.load(&self.shares[0])), most);
        let b = simd.min(simd.mul(softened, simd.load(&self.shares[1])), most);
        let mut lengths = [[0.0; LANES]; 2];
        simd.store(a, &mut lengths[0]);
        simd.store(b, &mut lengths[1]);
        let mut new = [[[0.0; LANES]; 2]; 2];
        simd.store(simd.sub(ax, simd.mul(a, nx)), &mut new[0][0]);
        simd.store(simd.sub(ay, simd.mul(a, ny)), &mut new[0][1]);
        simd.store(simd.add(bx, simd.mul(b, nx)), &mut new[1][0]);
        simd.store(simd.add(by, simd.mul(b, ny)), &mut new[1][1]);
        for_each_lane(overlapping, |lane| {
            let lane = lane % LANES;
            for k in [0, 1] {
                if lengths[k][lane] != 0.0 {
                    let place = of.places.of(k)[lane];
                    displacements.set(place, inside(place, [new[k][0][lane], new[k][1][lane]]));
                }
            }
        });
        overlapping
    }
}

/// Updates the offsets of pairs, and which are near.
pub struct Measure<'a> {
    pub of: &'a [contacts::Block],
    pub blocks: &'a mut [Block],
    /// The state of all particles.
    pub positions: &'a Vectors,
    pub residuals: &'a Vectors,
}

impl Measure<'_> {
    /// Does it with the widest instructions of the machine.
    pub fn run(self) {
        f32::with_widest(self);
    }
}

impl Work<f32> for Measure<'_> {
    type Out = ();

    #[inline(always)]
    fn run<S: Simd<f32>>(self, simd: S) {
        for (block, of) in self.blocks.iter_mut().zip(self.of) {
            block.measure(simd, of, self.positions, self.residuals);
        }
    }
}

/// An iteration over pairs of one colour.
pub struct Separate<'a, I> {
    pub of: &'a [contacts::Block],
    pub blocks: &'a [Block],
    /// The displacements of all particles by the correction.
    pub displacements: &'a Vectors,
    /// The displacement of a particle that the walls allow.
    pub inside: &'a I,
}

impl<I: Fn(u32, [f32; 2]) -> [f32; 2]> Separate<'_, I> {
    /// Does it with the widest instructions of the machine. Returns how many pairs overlap.
    pub fn run(self) -> usize {
        f32::with_widest(self)
    }
}

impl<I: Fn(u32, [f32; 2]) -> [f32; 2]> Work<f32> for Separate<'_, I> {
    type Out = usize;

    #[inline(always)]
    fn run<S: Simd<f32>>(self, simd: S) -> usize {
        let mut count = 0;
        for (block, of) in self.blocks.iter().zip(self.of) {
            if block.near != 0 {
                let moved = block.separate(simd, of, self.displacements, self.inside);
                count += moved.count_ones() as usize;
            }
        }
        count
    }
}
