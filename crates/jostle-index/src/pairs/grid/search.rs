//! The search for the pairs of the shapes of a band.

use std::ops::Range;

use super::band::Band;
use super::large::Large;
use super::layout::Layout;
use super::sizes::{CIRCLES, EQUAL, RECTANGLES};
use crate::geometry::{Scalar, lanes};
use crate::pairs::output::Output;
use crate::quadtree::partition::Item;
use jostle_simd::{HALF, LANES, Simd, Work, block, first_lanes};

/// Number of shapes that are tested between two checks of the output.
const AT_A_TIME: usize = 32;

/// Shapes with more candidates than this are tested one by one, with more checks.
const FEW: usize = 64;

/// Number of shapes that one with many candidates is tested against between two checks.
const ROW_TESTS: usize = 1 << 12;

/// Maximum number of blocks with overlaps that are collected.
const MAX_HITS: usize = 512;

/// Number of blocks that [`FEW`] candidates in two ranges may have.
const FEW_BLOCKS: usize = FEW / LANES + 1;

/// The search for the pairs of the shapes of a band.
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

impl<T: Scalar, const SIZES: usize> Work<T> for Search<'_, '_, T, SIZES> {
    type Out = ();

    #[inline(always)]
    fn run<S: Simd<T>>(self, simd: S) {
        let Self { band, layout, number, large, squared, output } = self;
        let tester = Tester { simd, band, squared };
        let stride = layout.stride as usize;
        let indices = band.indices();
        let mut hits = Hits { list: [[0; 3]; MAX_HITS], count: 0 };
        let mut first = indices.start;
        while first < indices.end {
            if output.is_over(AT_A_TIME * LANES) {
                return;
            }
            first = tester.test_some(stride, first..indices.end, &mut hits, output);
        }
        if SIZES == EQUAL || indices.is_empty() {
            return;
        }
        for (item, &[columns, rows]) in large.of_band(number) {
            let cells = tester.rows(layout, number, columns, rows);
            tester.test_large(item, cells, &mut hits, output);
            if output.is_over(LANES) {
                return;
            }
        }
    }
}

/// Blocks with overlaps: the row of the caller of one shape, the first index of the block, and a
/// bit for each of its shapes that overlaps the one.
struct Hits {
    list: [[u32; 3]; MAX_HITS],
    count: usize,
}

impl Hits {
    /// Adds a block if a bit is set. No branch depends on it.
    #[inline(always)]
    fn add(&mut self, row: u32, start: usize, bits: u32) {
        self.list[self.count % MAX_HITS] = [row, start as u32, bits];
        self.count += usize::from(bits != 0);
    }
}

/// Others in registers.
struct Loaded<B, const SIZES: usize> {
    x: B,
    y: B,
    sizes: [B; SIZES],
}

/// Tests shapes against those of a band.
struct Tester<'a, T, S, const SIZES: usize> {
    simd: S,
    band: &'a Band<T, SIZES>,
    squared: T,
}

impl<T: Scalar, S: Simd<T>, const SIZES: usize> Tester<'_, T, S, SIZES> {
    /// Tests [`AT_A_TIME`] shapes, and the others of the last one's cell, against those that may
    /// overlap them. Returns the next index.
    #[inline(always)]
    fn test_some(
        &self,
        stride: usize,
        indices: Range<usize>,
        hits: &mut Hits,
        output: &mut Output<'_>,
    ) -> usize {
        let Self { simd, band, .. } = *self;
        let Some(mut spare) = output.spare(AT_A_TIME * LANES) else { return indices.end };
        let end = indices.end.min(indices.start + AT_A_TIME);
        let (mut count, mut tests) = (0, 0);
        let mut index = indices.start;
        while index < end {
            let cell = band.cells[index] as usize;
            let start = |cell: usize| band.starts[cell] as usize;
            let ahead = index + 1..start(cell + 2);
            // Half of the neighbourhood: later shapes of the own cell, the next cell, and three
            // cells of the row above. For the other half this shape is among the candidates of the
            // other. So each pair is tested once.
            //
            // Cells of a row are contiguous, so the candidates are two ranges. The empty cell
            // between rows is the neighbour of both ends, so no row needs a case of its own.
            let above = start(cell - stride - 1)..start(cell - stride + 2);
            // The usual case: both ranges are loaded into the halves of one block, for one test. No
            // branch depends on how many candidates there are.
            if ahead.len().max(above.len()) <= HALF {
                tests += (ahead.len() + above.len()) as u64;
                let lanes = first_lanes(ahead.len()) | first_lanes(above.len()) << HALF;
                let one = self.one(index);
                let bits = self.near(&one, &self.load_halves([ahead.start, above.start])) & lanes;
                let others = [half(&band.ids, ahead.start), half(&band.ids, above.start)];
                let to = spare[count..].first_chunk_mut().expect("reserved above");
                simd.ordered_pairs(one.row, others, bits, to);
                count += bits.count_ones() as usize;
                index += 1;
                continue;
            }
            // The others of a cell have the same candidates.
            let cell = index..start(cell + 1);
            // Pairs so far are accepted first, because the methods below reserve memory of their
            // own.
            output.accept(count);
            count = 0;
            // At most 65 shapes of the cell and 5 blocks of candidates, so at most 325 hits: below
            // `MAX_HITS`, and the list needs no check.
            if ahead.len() + above.len() <= FEW {
                tests += (cell.len() * (ahead.len() + above.len() + 1)) as u64;
                tests -= (cell.len() * (cell.len() + 1) / 2) as u64;
                self.test_cell(cell.clone(), ahead.end, above, hits, output);
            } else {
                // Only for these is the output checked at each shape. When it was for all, discs
                // that cover 3.14 times the area took 48 instead of 36 ns each
                // (docs/benchmarks-notes.md).
                for index in cell.clone() {
                    let one = self.one(index);
                    tests += (ahead.end - index - 1 + above.len()) as u64;
                    self.test_long(&one, index + 1..ahead.end, output);
                    self.test_long(&one, above.clone(), output);
                    // A cell with thousands of shapes has millions of pairs. Each row counts as
                    // work in `test_long`.
                    if output.is_over(0) {
                        return indices.end;
                    }
                }
            }
            index = cell.end;
            let Some(more) = output.spare(AT_A_TIME * LANES) else { return indices.end };
            spare = more;
        }
        output.tests += tests;
        output.accept(count);
        index
    }

    /// Tests the shapes of a cell against later ones up to `end`, and against those of a range
    /// before.
    #[inline(always)]
    fn test_cell(
        &self,
        cell: Range<usize>,
        end: usize,
        above: Range<usize>,
        hits: &mut Hits,
        output: &mut Output<'_>,
    ) {
        for start in above.clone().step_by(LANES) {
            let others = self.load_block(start);
            let lanes = first_lanes(above.end - start);
            for index in cell.clone() {
                let one = self.one(index);
                hits.add(one.row, start, self.near(&one, &others) & lanes);
            }
        }
        for start in (cell.start..end).step_by(LANES) {
            let others = self.load_block(start);
            let lanes = first_lanes(end - start);
            for index in cell.clone() {
                let one = self.one(index);
                // A block may begin before the shape. Earlier lanes are pairs that the earlier
                // shape finds.
                let later = u32::MAX << (index + 1).saturating_sub(start).min(31);
                hits.add(one.row, start, self.near(&one, &others) & lanes & later);
            }
        }
        self.emit(hits, output);
    }

    /// Writes the pairs of all hits, and removes these.
    #[inline(always)]
    fn emit(&self, hits: &mut Hits, output: &mut Output<'_>) {
        let Self { simd, band, .. } = *self;
        let some = &hits.list[..hits.count.min(MAX_HITS)];
        hits.count = 0;
        let Some(spare) = output.spare(some.len() * LANES) else { return };
        let mut count = 0;
        for &[row, start, bits] in some {
            let start = start as usize;
            let ids = [half(&band.ids, start), half(&band.ids, start + HALF)];
            let to = spare[count..].first_chunk_mut().expect("reserved above");
            simd.ordered_pairs(row, ids, bits, to);
            count += bits.count_ones() as usize;
        }
        output.accept(count);
    }

    /// For each row of the band that a large shape may reach, its first cell and the one after its
    /// last.
    #[inline(always)]
    fn rows(
        &self,
        layout: &Layout,
        number: usize,
        columns: [u32; 2],
        rows: [u32; 2],
    ) -> impl Iterator<Item = [usize; 2]> {
        let first = number << layout.row_bits;
        let first_row = (rows[0] as usize).max(first) - first;
        let last_row = (rows[1] as usize).min(first + layout.rows() - 1) - first;
        let stride = layout.stride as usize;
        (first_row..=last_row).map(move |row| {
            let cells = 1 + (row + 1) * stride;
            [cells + columns[0] as usize, cells + columns[1] as usize + 1]
        })
    }

    /// Tests a large shape against those of some ranges of cells.
    #[inline(always)]
    fn test_large(
        &self,
        one: &Item<T, SIZES>,
        rows: impl Iterator<Item = [usize; 2]>,
        hits: &mut Hits,
        output: &mut Output<'_>,
    ) {
        for cells in rows {
            let [start, end] = cells.map(|cell| self.band.starts[cell] as usize);
            output.tests += (end - start) as u64;
            if end - start > FEW {
                self.test_long(one, start..end, output);
                continue;
            }
            for start in (start..end).step_by(LANES) {
                let others = self.load_block(start);
                hits.add(one.row, start, self.near(one, &others) & first_lanes(end - start));
            }
            // The next range may add as many as `FEW_BLOCKS`; if there are more hits already, they
            // are written first.
            if hits.count > MAX_HITS - FEW_BLOCKS {
                self.emit(hits, output);
            }
        }
        self.emit(hits, output);
    }

    /// The shape at an index.
    #[inline(always)]
    fn one(&self, index: usize) -> Item<T, SIZES> {
        let band = self.band;
        let mut sizes = [T::ZERO; SIZES];
        for (size, column) in sizes.iter_mut().zip(&band.sizes) {
            *size = column[index];
        }
        Item { key: 0, row: band.ids[index], center: [band.x[index], band.y[index]], sizes }
    }

    /// Tests a shape against many.
    #[inline(always)]
    fn test_long(&self, one: &Item<T, SIZES>, others: Range<usize>, output: &mut Output<'_>) {
        for first in others.clone().step_by(ROW_TESTS) {
            let some = first..others.end.min(first + ROW_TESTS);
            if output.is_over(some.len()) {
                return;
            }
            let Some(spare) = output.spare(some.len()) else { return };
            let count = self.test_blocks(one, some, spare);
            output.accept(count);
        }
    }

    /// Tests a shape against others; returns the number of pairs. `spare` has capacity for all and
    /// one more block.
    #[inline(always)]
    fn test_blocks(
        &self,
        one: &Item<T, SIZES>,
        others: Range<usize>,
        spare: &mut [[u32; 2]],
    ) -> usize {
        let Self { simd, band, .. } = *self;
        let mut count = 0;
        for start in others.clone().step_by(LANES) {
            let bits = self.near(one, &self.load_block(start)) & first_lanes(others.end - start);
            let ids = [half(&band.ids, start), half(&band.ids, start + HALF)];
            let to = spare[count..].first_chunk_mut().expect("reserved above");
            simd.ordered_pairs(one.row, ids, bits, to);
            count += bits.count_ones() as usize;
        }
        count
    }

    /// A bit for each of `others`, set if it overlaps `one`.
    #[inline(always)]
    fn near(&self, one: &Item<T, SIZES>, others: &Loaded<S::Block, SIZES>) -> u32 {
        let Self { simd, squared, .. } = *self;
        let [x, y] = [simd.splat(one.center[0]), simd.splat(one.center[1])];
        if SIZES == EQUAL || SIZES == CIRCLES {
            let offsets = [simd.sub(x, others.x), simd.sub(y, others.y)];
            if SIZES == EQUAL {
                return simd.less(lanes::square(simd, offsets), simd.splat(squared));
            }
            return lanes::discs_overlap(simd, offsets, self.radius_sum(one, others));
        }
        let dx = simd.sub(simd.distance(x, others.x), self.sum(one, others, 0));
        let dy = simd.sub(simd.distance(y, others.y), self.sum(one, others, 1));
        // Without radii, squares below 0 do not exist: only the inner part of the formula is left.
        if SIZES == RECTANGLES {
            return simd.both_negative(dx, dy);
        }
        lanes::overlap_by_centers(simd, [dx, dy], self.radius_sum(one, others))
    }

    /// The sums of a size of one shape and of those of others.
    #[inline(always)]
    fn sum(&self, one: &Item<T, SIZES>, others: &Loaded<S::Block, SIZES>, k: usize) -> S::Block {
        self.simd.add(self.simd.splat(one.sizes[k]), others.sizes[k])
    }

    /// The sums of the radii.
    #[inline(always)]
    fn radius_sum(&self, one: &Item<T, SIZES>, others: &Loaded<S::Block, SIZES>) -> S::Block {
        // The radius is the last size of each kind.
        self.sum(one, others, SIZES.saturating_sub(1))
    }

    /// The block of shapes from an index.
    #[inline(always)]
    fn load_block(&self, start: usize) -> Loaded<S::Block, SIZES> {
        let Self { simd, band, .. } = *self;
        let mut sizes = [simd.splat(T::ZERO); SIZES];
        for (size, column) in sizes.iter_mut().zip(&band.sizes) {
            *size = simd.load(block(column, start));
        }
        let (x, y) = (simd.load(block(&band.x, start)), simd.load(block(&band.y, start)));
        Loaded { x, y, sizes }
    }

    /// Half a block of shapes from each of two indices.
    #[inline(always)]
    fn load_halves(&self, [low, high]: [usize; 2]) -> Loaded<S::Block, SIZES> {
        let Self { simd, band, .. } = *self;
        let mut sizes = [simd.splat(T::ZERO); SIZES];
        for (size, column) in sizes.iter_mut().zip(&band.sizes) {
            *size = simd.load_halves(half(column, low), half(column, high));
        }
        let x = simd.load_halves(half(&band.x, low), half(&band.x, high));
        let y = simd.load_halves(half(&band.y, low), half(&band.y, high));
        Loaded { x, y, sizes }
    }
}

/// Half a block of a column.
#[inline(always)]
fn half<V>(column: &[V], start: usize) -> &[V; HALF] {
    column[start..].first_chunk().expect("columns carry spare rows")
}
