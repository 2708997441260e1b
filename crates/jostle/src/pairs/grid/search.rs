//! The search for the pairs of the shapes of a band.

use std::ops::Range;

use super::band::Band;
use super::large::Large;
use super::layout::Layout;
use super::sizes::{CIRCLES, EQUAL, RECTANGLES};
use crate::geometry::Scalar;
use crate::pairs::output::Output;
use crate::quadtree::partition::Item;
use crate::simd::{HALF, LANES, Simd, Work, block, first_lanes};

/// Number of shapes that are tested between two checks of the output.
const AT_A_TIME: usize = 32;

/// Shapes with more candidates than this are tested one by one, with more checks.
const FEW: usize = 64;

/// Number of shapes that one with many candidates is tested against between two checks.
const ROW_TESTS: usize = 1 << 12;

/// Number of tests for each shape and for each pair of a band after which the tree is used instead.
const MAX_TESTS: u64 = 128;

/// Number of tests that a band may have in any case.
const FREE_TESTS: u64 = 1 << 16;

/// The search for the pairs of the shapes of a band. The result is whether it is not slower than the tree,
/// in which it may end early.
pub(super) struct Search<'a, 'b, T, const SIZES: usize> {
    pub(super) band: &'a Band<T, SIZES>,
    pub(super) layout: &'a Layout,
    /// The number of the band.
    pub(super) number: usize,
    pub(super) large: &'a Large<T, SIZES>,
    /// The square of the distance below which circles of one radius overlap.
    pub(super) squared: T,
    pub(super) output: &'a mut Output<'b>,
}

/// Numbers of tests and of pairs of a band, and of shapes that were tested.
#[derive(Clone, Copy, Default)]
struct Counts {
    shapes: u64,
    tests: u64,
    pairs: u64,
}

impl Counts {
    /// Whether there are too many tests.
    #[inline(always)]
    fn is_slow(&self) -> bool {
        self.tests > MAX_TESTS * (self.shapes + self.pairs) + FREE_TESTS
    }
}

impl<T: Scalar, const SIZES: usize> Work<T> for Search<'_, '_, T, SIZES> {
    type Out = bool;

    #[inline(always)]
    fn run<S: Simd<T>>(self, simd: S) -> bool {
        let Self { band, layout, number, large, squared, output } = self;
        let tester = Tester { simd, band, squared };
        let stride = layout.stride as usize;
        let places = band.places();
        let mut counts = Counts::default();
        for first in places.clone().step_by(AT_A_TIME) {
            let some = first..places.end.min(first + AT_A_TIME);
            if output.is_over(AT_A_TIME * LANES) {
                return true;
            }
            tester.test_some(stride, some, &mut counts, output);
            if SIZES != EQUAL && counts.is_slow() {
                return false;
            }
        }
        if SIZES != EQUAL && !places.is_empty() {
            for (item, &[columns, rows]) in large.of_band(number) {
                tester.test_large(layout, number, item, columns, rows, &mut counts, output);
                if output.is_over(LANES) {
                    return true;
                }
                if counts.is_slow() {
                    return false;
                }
            }
        }
        output.tests += counts.tests;
        true
    }
}

/// Tests shapes against those of a band.
struct Tester<'a, T, S, const SIZES: usize> {
    simd: S,
    band: &'a Band<T, SIZES>,
    squared: T,
}

impl<T: Scalar, S: Simd<T>, const SIZES: usize> Tester<'_, T, S, SIZES> {
    /// Tests at most [`AT_A_TIME`] shapes against those that may overlap them.
    #[inline(always)]
    fn test_some(
        &self,
        stride: usize,
        places: Range<usize>,
        counts: &mut Counts,
        output: &mut Output<'_>,
    ) {
        let Self { simd, band, .. } = *self;
        let Some(mut room) = output.room(AT_A_TIME * FEW) else { return };
        counts.shapes += places.len() as u64;
        let (mut count, mut tests) = (0, 0);
        let cells = &band.cells[places.clone()];
        for (place, &cell) in places.zip(cells) {
            let cell = cell as usize;
            let start = |cell: usize| band.starts[cell] as usize;
            let ahead = place + 1..start(cell + 2);
            let above = start(cell - stride - 1)..start(cell - stride + 2);
            let candidates = ahead.len() + above.len();
            tests += candidates as u64;
            let one = self.one(place);
            if ahead.len().max(above.len()) <= HALF {
                let lanes = first_lanes(ahead.len()) | first_lanes(above.len()) << HALF;
                let bits = self.near::<false>(&one, [ahead.start, above.start]) & lanes;
                let others = [half(&band.ids, ahead.start), half(&band.ids, above.start)];
                let to = room[count..].first_chunk_mut().expect("there is room");
                simd.ordered_pairs(one.row, others, bits, to);
                count += bits.count_ones() as usize;
            } else if candidates <= FEW {
                count += self.test_blocks(&one, ahead, &mut room[count..]);
                count += self.test_blocks(&one, above, &mut room[count..]);
            } else {
                output.accept(count);
                counts.pairs += count as u64;
                self.test_long(&one, ahead, counts, output);
                self.test_long(&one, above, counts, output);
                if output.is_over(0) {
                    return;
                }
                count = 0;
                let Some(more) = output.room(AT_A_TIME * FEW) else { return };
                room = more;
            }
        }
        counts.tests += tests;
        counts.pairs += count as u64;
        output.accept(count);
    }

    /// Tests a large shape against those of the rows of the band that it may reach.
    #[allow(clippy::too_many_arguments, reason = "a part of a loop, inlined")]
    #[inline(always)]
    fn test_large(
        &self,
        layout: &Layout,
        number: usize,
        item: &Item<T, SIZES>,
        columns: [u32; 2],
        rows: [u32; 2],
        counts: &mut Counts,
        output: &mut Output<'_>,
    ) {
        let first = number << layout.row_bits;
        let first_row = (rows[0] as usize).max(first) - first;
        let last_row = (rows[1] as usize).min(first + layout.rows() - 1) - first;
        let stride = layout.stride as usize;
        counts.shapes += 1;
        for row in first_row..=last_row {
            let cells = 1 + (row + 1) * stride;
            let start = self.band.starts[cells + columns[0] as usize] as usize;
            let end = self.band.starts[cells + columns[1] as usize + 1] as usize;
            counts.tests += (end - start) as u64;
            if end - start <= FEW {
                let Some(room) = output.room(FEW) else { return };
                let count = self.test_blocks(item, start..end, room);
                counts.pairs += count as u64;
                output.accept(count);
            } else {
                self.test_long(item, start..end, counts, output);
            }
        }
    }

    /// The shape at a place.
    #[inline(always)]
    fn one(&self, place: usize) -> Item<T, SIZES> {
        let band = self.band;
        let mut sizes = [T::ZERO; SIZES];
        for k in 0..SIZES {
            sizes[k] = band.sizes[k][place];
        }
        Item { key: 0, row: band.ids[place], center: [band.x[place], band.y[place]], sizes }
    }

    /// Tests a shape against many.
    #[inline(always)]
    fn test_long(
        &self,
        one: &Item<T, SIZES>,
        others: Range<usize>,
        counts: &mut Counts,
        output: &mut Output<'_>,
    ) {
        for first in others.clone().step_by(ROW_TESTS) {
            let some = first..others.end.min(first + ROW_TESTS);
            if output.is_over(some.len()) {
                return;
            }
            let Some(room) = output.room(some.len()) else { return };
            let count = self.test_blocks(one, some, room);
            counts.pairs += count as u64;
            output.accept(count);
        }
    }

    /// Tests a shape against others; returns the number of pairs. There is room for all, and a block.
    #[inline(always)]
    fn test_blocks(
        &self,
        one: &Item<T, SIZES>,
        others: Range<usize>,
        room: &mut [[u32; 2]],
    ) -> usize {
        let Self { simd, band, .. } = *self;
        let mut count = 0;
        for start in others.clone().step_by(LANES) {
            let bits = self.near::<true>(one, [start; 2]) & first_lanes(others.end - start);
            let ids = [half(&band.ids, start), half(&band.ids, start + HALF)];
            let to = room[count..].first_chunk_mut().expect("there is room");
            simd.ordered_pairs(one.row, ids, bits, to);
            count += bits.count_ones() as usize;
        }
        count
    }

    /// A bit for each of some others that overlaps one. They are two halves from two places, or a whole
    /// block.
    #[inline(always)]
    fn near<const WHOLE: bool>(&self, one: &Item<T, SIZES>, starts: [usize; 2]) -> u32 {
        let Self { simd, band, squared } = *self;
        let [x, y] = [self.load::<WHOLE>(&band.x, starts), self.load::<WHOLE>(&band.y, starts)];
        let [one_x, one_y] = [simd.splat(one.center[0]), simd.splat(one.center[1])];
        if SIZES == EQUAL || SIZES == CIRCLES {
            let (dx, dy) = (simd.sub(one_x, x), simd.sub(one_y, y));
            let distance = simd.add(simd.mul(dx, dx), simd.mul(dy, dy));
            if SIZES == EQUAL {
                return simd.less(distance, simd.splat(squared));
            }
            return simd.less(distance, self.squared_sum::<WHOLE>(one, starts));
        }
        let dx = simd.sub(simd.distance(one_x, x), self.sum::<WHOLE>(one, 0, starts));
        let dy = simd.sub(simd.distance(one_y, y), self.sum::<WHOLE>(one, 1, starts));
        let overlap = simd.both_negative(dx, dy);
        if SIZES == RECTANGLES {
            return overlap;
        }
        let zero = simd.splat(T::ZERO);
        let (ex, ey) = (simd.max(dx, zero), simd.max(dy, zero));
        let distance = simd.add(simd.mul(ex, ex), simd.mul(ey, ey));
        overlap | simd.less(distance, self.squared_sum::<WHOLE>(one, starts))
    }

    /// The sums of a size of one shape and of those of others.
    #[inline(always)]
    fn sum<const WHOLE: bool>(&self, one: &Item<T, SIZES>, k: usize, starts: [usize; 2]) -> S::Block {
        let simd = self.simd;
        simd.add(simd.splat(one.sizes[k]), self.load::<WHOLE>(&self.band.sizes[k], starts))
    }

    /// The squares of the sums of the radii.
    #[inline(always)]
    fn squared_sum<const WHOLE: bool>(&self, one: &Item<T, SIZES>, starts: [usize; 2]) -> S::Block {
        let sum = self.sum::<WHOLE>(one, SIZES.saturating_sub(1), starts);
        self.simd.mul(sum, sum)
    }

    /// The numbers of a column of some others.
    #[inline(always)]
    fn load<const WHOLE: bool>(&self, column: &[T], starts: [usize; 2]) -> S::Block {
        let simd = self.simd;
        if WHOLE {
            return simd.load(block(column, starts[0]));
        }
        simd.load_halves(half(column, starts[0]), half(column, starts[1]))
    }
}

/// Half a block of a column.
#[inline(always)]
fn half<V>(column: &[V], start: usize) -> &[V; HALF] {
    column[start..].first_chunk().expect("columns carry spare rows")
}
