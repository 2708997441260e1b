//! All pairs of circles of one radius, by a uniform grid.
//!
//! A cell is at least as wide and as high as a circle. So a circle overlaps only those of its own
//! cell, of the cell after it and of three cells of the row before, and of others that find the pair
//! themselves. These are two ranges of adjacent circles, which are tested at once.
//!
//! The circles are partitioned into bands of adjacent rows. Each band, which fits into the
//! second-level cache, is then sorted into its cells and searched. No more of the grid is stored.

mod band;
mod layout;

use std::ops::Range;
use std::sync::Mutex;

use super::Found;
use super::output::{Budget, Output, PairScratch};
use super::unchanged;
use crate::error::Result;
use crate::geometry::Scalar;
use crate::parallel::{self, locked};
use crate::quadtree::extent_of;
use crate::quadtree::partition::Partition;
use crate::shapes::Shapes;
use crate::simd::{HALF, LANES, Simd, Work, block, first_lanes};
use band::Band;
use layout::{Centers, Layout, distance_of};

/// For fewer circles the tree is faster. Measured with AVX-512; the same for all processors, because the
/// order of the pairs depends on it.
const MIN_CIRCLES: usize = 300;

/// Maximum number of tasks for several threads. A task sorts the band before its first one too.
const MAX_TASKS: usize = 16;

/// Minimum number of bands of a task.
const MIN_BANDS: usize = 4;

/// Number of circles that are tested between two checks of the output.
const AT_A_TIME: usize = 32;

/// Circles with more candidates than this are tested one by one, with more checks.
const FEW: usize = 64;

/// Number of circles that one with many candidates is tested against between two checks.
const ROW_TESTS: usize = 1 << 12;

/// Scratch, kept between calls.
#[derive(Debug)]
pub(super) struct Grid<T> {
    partition: Partition<T>,
    bands: Mutex<Vec<[Band<T>; 2]>>,
}

impl<T> Default for Grid<T> {
    fn default() -> Self {
        Self { partition: Partition::default(), bands: Mutex::default() }
    }
}

impl<T: Scalar> Grid<T> {
    /// All overlapping pairs of rows, `i < j`; None if the shapes are not circles of one radius, or
    /// so few or so sparse that a tree is faster.
    pub(super) fn find(
        &mut self,
        shapes: &Shapes<T>,
        threads: Option<usize>,
        max_pairs: usize,
        scratch: &mut PairScratch,
    ) -> Option<Result<Found>> {
        let distance = distance_of(shapes)?;
        let centers = &shapes.centers[..];
        if centers.len() < MIN_CIRCLES {
            return None;
        }
        let layout = Layout::over(extent_of(centers), distance.to_f64(), centers.len())?;
        let threads = parallel::worthwhile(threads, centers.len());
        let _awake = parallel::keep_awake(threads, centers.len(), parallel::WORTH_WAKING);
        let source = Centers { layout, centers };
        if let Err(error) = self.partition.fill(threads, &source, layout.bits) {
            return Some(Err(error));
        }
        let squared = distance * distance;
        let tasks = (layout.bands / MIN_BANDS).clamp(1, MAX_TASKS);
        let tasks = if parallel::is_parallel(threads) { tasks } else { 1 };
        Some(Budget::new(max_pairs).find(threads, tasks, &unchanged, scratch, |task, output| {
            let of = |task: usize| layout.bands * task / tasks;
            let mut bands = locked(&self.bands).pop().unwrap_or_default();
            self.search(&layout, squared, of(task)..of(task + 1), &mut bands, output);
            locked(&self.bands).push(bands);
        }))
    }

    /// Finds the pairs of the circles in some bands, with those of the row before them.
    fn search(
        &self,
        layout: &Layout,
        squared: T,
        bands: Range<usize>,
        scratch: &mut [Band<T>; 2],
        output: &mut Output<'_>,
    ) {
        scratch.iter_mut().for_each(Band::clear);
        for band in bands.start.saturating_sub(1)..bands.end {
            scratch.swap(0, 1);
            let [last, current] = scratch;
            let pieces = self.partition.pieces(band);
            if let Err(error) = current.fill(layout, last, pieces) {
                return output.fail(error);
            }
            if output.is_over(current.indices().len()) {
                return;
            }
            if band >= bands.start {
                let stride = layout.stride as usize;
                T::with_widest(Search { band: current, stride, squared, output });
            }
        }
    }

    /// Allocated bytes, used or not.
    pub(super) fn memory_bytes(&self) -> usize {
        let bands: usize = locked(&self.bands).iter().flatten().map(Band::memory_bytes).sum();
        self.partition.memory_bytes() + bands
    }
}

/// The search for the pairs of the circles of a band.
struct Search<'a, 'b, T> {
    band: &'a Band<T>,
    stride: usize,
    /// The square of the distance below which they overlap.
    squared: T,
    output: &'a mut Output<'b>,
}

impl<T: Scalar> Work<T> for Search<'_, '_, T> {
    type Out = ();

    #[inline(always)]
    fn run<S: Simd<T>>(self, simd: S) {
        let Self { band, stride, squared, output } = self;
        let indices = band.indices();
        for first in indices.clone().step_by(AT_A_TIME) {
            let some = first..indices.end.min(first + AT_A_TIME);
            if output.is_over(AT_A_TIME * LANES) {
                return;
            }
            test_some(simd, band, stride, squared, some, output);
        }
    }
}

/// Tests at most [`AT_A_TIME`] circles against those that may overlap them.
#[inline(always)]
fn test_some<T: Scalar, S: Simd<T>>(
    simd: S,
    band: &Band<T>,
    stride: usize,
    squared: T,
    indices: Range<usize>,
    output: &mut Output<'_>,
) {
    let Some(mut spare) = output.spare(AT_A_TIME * FEW) else { return };
    let (mut count, mut tests) = (0, 0);
    let cells = &band.cells[indices.clone()];
    for (index, &cell) in indices.zip(cells) {
        let cell = cell as usize;
        let start = |cell: usize| band.starts[cell] as usize;
        let ahead = index + 1..start(cell + 2);
        let above = start(cell - stride - 1)..start(cell - stride + 2);
        let candidates = ahead.len() + above.len();
        tests += candidates;
        if ahead.len().max(above.len()) <= HALF {
            let lanes = first_lanes(ahead.len()) | first_lanes(above.len()) << HALF;
            let [x, y] = [&band.x, &band.y];
            let x = simd.load_halves(half(x, ahead.start), half(x, above.start));
            let y = simd.load_halves(half(y, ahead.start), half(y, above.start));
            let bits = near(simd, band, index, squared, [x, y]) & lanes;
            let others = [half(&band.ids, ahead.start), half(&band.ids, above.start)];
            let to = spare[count..].first_chunk_mut().expect("there is spare");
            simd.ordered_pairs(band.ids[index], others, bits, to);
            count += bits.count_ones() as usize;
        } else if candidates <= FEW {
            count += test_blocks(simd, band, index, squared, ahead, &mut spare[count..]);
            count += test_blocks(simd, band, index, squared, above, &mut spare[count..]);
        } else {
            output.accept(count);
            test_long(simd, band, index, squared, ahead, output);
            test_long(simd, band, index, squared, above, output);
            if output.is_over(0) {
                return;
            }
            count = 0;
            let Some(more) = output.spare(AT_A_TIME * FEW) else { return };
            spare = more;
        }
    }
    output.tests += tests as u64;
    output.accept(count);
}

/// Tests a circle against many.
#[inline(always)]
fn test_long<T: Scalar, S: Simd<T>>(
    simd: S,
    band: &Band<T>,
    index: usize,
    squared: T,
    others: Range<usize>,
    output: &mut Output<'_>,
) {
    for first in others.clone().step_by(ROW_TESTS) {
        let some = first..others.end.min(first + ROW_TESTS);
        if output.is_over(some.len()) {
            return;
        }
        let Some(spare) = output.spare(some.len()) else { return };
        let count = test_blocks(simd, band, index, squared, some, spare);
        output.accept(count);
    }
}

/// Tests a circle against others; returns the number of pairs. The output has capacity for all, and a block.
#[inline(always)]
fn test_blocks<T: Scalar, S: Simd<T>>(
    simd: S,
    band: &Band<T>,
    index: usize,
    squared: T,
    others: Range<usize>,
    spare: &mut [[u32; 2]],
) -> usize {
    let mut count = 0;
    for start in others.clone().step_by(LANES) {
        let centers = [simd.load(block(&band.x, start)), simd.load(block(&band.y, start))];
        let bits = near(simd, band, index, squared, centers) & first_lanes(others.end - start);
        let ids = [half(&band.ids, start), half(&band.ids, start + HALF)];
        let to = spare[count..].first_chunk_mut().expect("there is spare");
        simd.ordered_pairs(band.ids[index], ids, bits, to);
        count += bits.count_ones() as usize;
    }
    count
}

/// A bit for each of some centres that is near the one at an index.
#[inline(always)]
fn near<T: Scalar, S: Simd<T>>(
    simd: S,
    band: &Band<T>,
    index: usize,
    squared: T,
    [x, y]: [S::Block; 2],
) -> u32 {
    let dx = simd.sub(simd.splat(band.x[index]), x);
    let dy = simd.sub(simd.splat(band.y[index]), y);
    simd.less(simd.add(simd.mul(dx, dx), simd.mul(dy, dy)), simd.splat(squared))
}

/// Half a block of a column.
#[inline(always)]
fn half<V>(column: &[V], start: usize) -> &[V; HALF] {
    column[start..].first_chunk().expect("columns carry spare rows")
}
