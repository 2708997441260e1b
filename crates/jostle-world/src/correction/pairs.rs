//! Moving the pairs of a colour apart, sixteen at a time.

use super::{DIRECTIONS, MOST, NEAR, OVERLAP, SLOP, SOFTNESS};
use crate::contacts::Block;
use crate::motion::{Motions, Scalars, Vectors};
use crate::trajectory::Vector;
use jostle_simd::{LANES, Number, Simd, Work, for_each_lane};

/// A disc acts near a much smaller one like a disc of this share of the smaller diameter, so that
/// float32 is fine enough.
const LARGEST: f32 = 64.0;

impl Block {
    /// Sums of the radii, at most [`LARGEST`] of the smaller diameter.
    #[inline(always)]
    fn limited_distances<S: Simd<f32>>(&self, simd: S) -> S::Block {
        let most = simd.mul(simd.splat(LARGEST), simd.load(&self.sizes));
        simd.min(simd.load(&self.contact_distances), most)
    }

    /// Updates the offsets to the positions, and which pairs are near.
    #[inline(always)]
    fn update_offsets<S: Simd<f32>>(&mut self, simd: S, motions: &Motions, radii: &[f32]) {
        let Motions { positions, residuals, .. } = motions;
        let [ax, ay] = simd.gather(positions.words(), &self.indices, 0);
        let [bx, by] = simd.gather(positions.words(), &self.indices, 1);
        // Positions and residuals are subtracted apart. The difference of near positions in float32
        // has hardly any error, and the residuals add what is below their spacing. So float32 is
        // enough far from the origin, too.
        let [cx, cy] = simd.gather(residuals.words(), &self.indices, 0);
        let [dx, dy] = simd.gather(residuals.words(), &self.indices, 1);
        let [mut x, mut y] = [simd.sub(bx, ax), simd.sub(by, ay)];
        if self.has_images {
            x = simd.add(x, simd.load(&self.images[0]));
            y = simd.add(y, simd.load(&self.images[1]));
        }
        let [x, y] = [simd.add(x, simd.sub(dx, cx)), simd.add(y, simd.sub(dy, cy))];
        let square = simd.add(simd.mul(x, x), simd.mul(y, y));
        let contact_distance = self.limited_distances(simd);
        let before = self.overlapped;
        // The bit stays for the step: the contact is reported also if it is corrected and apart at
        // the end.
        self.overlapped |= simd.less(square, simd.mul(contact_distance, contact_distance));
        let far = simd.mul(simd.splat(1.0 + NEAR), contact_distance);
        // Pairs a little apart are kept, because the correction of their neighbours may push them
        // together. Others are skipped in all iterations.
        self.near = simd.less(square, simd.mul(far, far));
        simd.store(x, &mut self.offset[0]);
        simd.store(y, &mut self.offset[1]);
        if self.uneven_sizes != 0 {
            let at = |index| motions.exact(index);
            self.measure_exactly(before, |block, lane| block.measure(lane, radii, at));
        }
    }

    /// Measures the contacts that are too uneven for float32; `before` are those that overlapped in
    /// earlier sub-steps. Near the small disc the large one is replaced by a smaller one with the
    /// same surface there.
    #[cold]
    fn measure_exactly(
        &mut self,
        before: u32,
        contact: impl Fn(&Self, usize) -> (Option<Vector>, f64),
    ) {
        for_each_lane(self.uneven_sizes, |lane| {
            let lane = lane % LANES;
            let (Some(normal), gap) = contact(self, lane) else { return };
            let most = LARGEST * self.sizes[lane];
            let contact_distance = f64::from(self.contact_distances[lane].min(most));
            // A disc deep inside the other is moved out of it all the same.
            // The sum of radii is limited to 64 diameters of the small disc, with the same surface
            // at that place. In float32 the overlap then has enough digits.
            let length = (contact_distance + gap).max(f64::from(SLOP * self.sizes[lane]));
            for k in [0, 1] {
                self.offset[k][lane] = (normal[k] * length) as f32;
            }
            let bit = 1 << lane;
            let set = |bits: u32, is_set: bool| bits & !bit | if is_set { bit } else { 0 };
            self.overlapped = set(self.overlapped, before & bit != 0 || gap < 0.0);
            self.near = set(self.near, gap < f64::from(NEAR) * contact_distance);
        });
    }

    /// Moves the pairs apart that overlap. Returns a bit for each of them.
    #[inline(always)]
    fn separate<S: Simd<f32>>(
        &self,
        simd: S,
        displacements: &Vectors,
        free_squares: Option<&Scalars>,
        inside: &impl Fn(u32, [f32; 2]) -> [f32; 2],
    ) -> u32 {
        let indices = &self.indices;
        let [ax, ay] = simd.gather(displacements.words(), indices, 0);
        let [bx, by] = simd.gather(displacements.words(), indices, 1);
        // Displacements are small, so float32 has enough digits for them also far from the origin. They
        // are added to the positions once, after all iterations.
        let x = simd.add(simd.load(&self.offset[0]), simd.sub(bx, ax));
        let y = simd.add(simd.load(&self.offset[1]), simd.sub(by, ay));
        let square = simd.add(simd.mul(x, x), simd.mul(y, y));
        let (contact_distance, size) = (self.limited_distances(simd), simd.load(&self.sizes));
        // Correction begins a little above the overlap at which it ends. Otherwise each resting
        // contact would be moved by a tiny amount in each sub-step.
        let least = simd.sub(contact_distance, simd.mul(simd.splat(OVERLAP), size));
        let overlapping = self.near & simd.less(square, simd.mul(least, least));
        if overlapping == 0 {
            return 0;
        }
        let length = simd.sqrt(square);
        let coincident = overlapping & !simd.less(simd.splat(0.0), length);
        let [mut nx, mut ny] = [simd.div(x, length), simd.div(y, length)];
        if coincident != 0 {
            let mut normal = [[0.0; LANES]; 2];
            simd.store(nx, &mut normal[0]);
            simd.store(ny, &mut normal[1]);
            for_each_lane(coincident, |lane| {
                let [a, b] = [indices.of(0)[lane % LANES], indices.of(1)[lane % LANES]];
                // Indices follow Morton order, that is, the state, so the direction does not depend
                // on the order of adding. Different directions keep a heap of coincident discs from
                // one line.
                let direction = DIRECTIONS[a.abs_diff(b) as usize % DIRECTIONS.len()];
                [normal[0][lane % LANES], normal[1][lane % LANES]] = direction;
            });
            [nx, ny] = [simd.load(&normal[0]), simd.load(&normal[1])];
        }
        // A little overlap remains, so that resting contacts persist from step to step.
        let target = simd.sub(contact_distance, simd.mul(simd.splat(SLOP), size));
        let zero = simd.splat(0.0);
        // A share of the overlap, because several contacts of a particle push at once. See
        // `SOFTNESS`.
        let softened = simd.mul(simd.splat(SOFTNESS), simd.max(simd.sub(target, length), zero));
        let most = simd.mul(simd.splat(MOST), size);
        // The shares of each in the displacement.
        let [a, b] = [[0, 1], [1, 0]].map(|[own, other]| {
            let (one, half) = (simd.splat(1.0), simd.splat(0.5));
            let share = simd.choose(self.fixed[other], one, half);
            let share = simd.choose(self.fixed[own], zero, share);
            simd.min(simd.mul(softened, share), most)
        });
        let ends = [
            ([ax, ay], [simd.sub(ax, simd.mul(a, nx)), simd.sub(ay, simd.mul(a, ny))], a),
            ([bx, by], [simd.add(bx, simd.mul(b, nx)), simd.add(by, simd.mul(b, ny))], b),
        ];
        for (k, (old, new, length)) in ends.into_iter().enumerate() {
            let moved = overlapping & simd.less(zero, length);
            let mut free = 0;
            // Where the walls certainly allow the displacement, all lanes are written at once. The
            // others need the walls, one by one.
            if let Some(squares) = free_squares {
                let [allowed, _] = simd.gather(squares.words(), indices, k);
                let square = simd.add(simd.mul(new[0], new[0]), simd.mul(new[1], new[1]));
                free = moved & simd.less(square, allowed);
                // The others keep theirs: of one colour, no other lane moves the same particle.
                let all = [0, 1].map(|axis| simd.choose(free, new[axis], old[axis]));
                simd.scatter(all, displacements.words(), indices, k);
            }
            if moved & !free == 0 {
                continue;
            }
            let mut columns = [[0.0; LANES]; 2];
            simd.store(new[0], &mut columns[0]);
            simd.store(new[1], &mut columns[1]);
            for_each_lane(moved & !free, |lane| {
                let lane = lane % LANES;
                let index = indices.of(k)[lane];
                displacements.set(index, inside(index, [columns[0][lane], columns[1][lane]]));
            });
        }
        overlapping
    }
}

/// Updates the offsets of pairs, and which are near.
pub struct Measure<'a> {
    pub blocks: &'a mut [Block],
    pub motions: &'a Motions,
    pub radii: &'a [f32],
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
        for block in self.blocks {
            block.update_offsets(simd, self.motions, self.radii);
        }
    }
}

/// An iteration over pairs of one colour.
pub struct Separate<'a, I> {
    pub blocks: &'a [Block],
    /// The displacements of all particles by the correction.
    pub displacements: &'a Vectors,
    /// Squares of displacements that walls certainly allow, if these are known.
    pub free_squares: Option<&'a Scalars>,
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
        for block in self.blocks {
            if block.near != 0 {
                let Self { displacements, free_squares, inside, .. } = self;
                let moved = block.separate(simd, displacements, free_squares, inside);
                count += moved.count_ones() as usize;
            }
        }
        count
    }
}
