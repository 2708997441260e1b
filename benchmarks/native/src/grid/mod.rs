//! A uniform grid, the fastest that we could write, to compare trees with.
//!
//! Shapes are sorted by counting into cells in rows, so that neighbouring cells of a row are one
//! range of the columns. Each shape is stored once, in the cell of its centre, so no pair is found
//! twice. If sizes differ, a pair is found from its larger shape. So the search of a small shape
//! does not depend on the largest one, and no shape is stored in every cell that it touches.

mod equal;
mod frame;
mod larger;
mod sorted;
#[cfg(test)]
mod tests;

pub use frame::CellSize;

use std::ops::Range;

use rayon::prelude::*;

use crate::rivals::Pair;
use crate::scenes::Shapes;
use crate::simd::{Lanes, Level, Work};
use frame::Frame;
use sorted::Sorted;

/// Bands of rows for each thread, so that a delayed thread does less.
const BANDS_EACH: usize = 4;

/// Whether all shapes are discs of one size.
pub fn are_equal_discs(shapes: &Shapes) -> bool {
    !shapes.has_boxes() && shapes.radius.iter().all(|&radius| radius == shapes.radius[0])
}

/// All overlapping pairs, rows `i < j`. The caller chooses the size of cells; it is increased if
/// the answer would not be exact otherwise. One thread sorts, all search.
pub fn pairs(shapes: &Shapes, cell: CellSize, level: Level, threads: usize) -> Vec<Pair> {
    if shapes.len() < 2 {
        Vec::new()
    } else if are_equal_discs(shapes) {
        equal::pairs(shapes, cell, level, threads)
    } else {
        larger::pairs(shapes, cell, level, threads)
    }
}

struct Sort<'a> {
    shapes: &'a Shapes,
    cell: CellSize,
    sized: bool,
}

impl Work for Sort<'_> {
    type Outcome = Sorted;

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> Sorted {
        Sorted::new(self.shapes, Frame::over(self.shapes, self.cell), self.sized)
    }
}

/// The pairs of `0..all`, in one band for one thread, in several for more threads.
fn in_bands(
    all: usize,
    threads: usize,
    join: impl Fn(Range<usize>) -> Vec<Pair> + Sync,
) -> Vec<Pair> {
    if threads == 1 {
        return join(0..all);
    }
    let bands = threads * BANDS_EACH;
    let band = |number| all * number / bands..all * (number + 1) / bands;
    let parts: Vec<_> = (0..bands).into_par_iter().map(|number| join(band(number))).collect();
    parts.concat()
}
