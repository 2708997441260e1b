//! The best uniform grid we can build: the honest rival of every tree.
//!
//! Shapes are sorted by counting into cells that lie row after row, so that neighbouring
//! cells of a row are one range of the columns. Each shape is kept once, in the cell of its
//! centre, so that no pair comes up twice. Where sizes differ, the larger of two shapes looks
//! for the smaller, which need not look as far as the largest shape there is: that made it
//! many times as fast as registering shapes in every cell that they touch.

mod equal;
mod frame;
mod larger;
mod sorted;

pub use frame::CellSize;

use crate::rivals::Pair;
use crate::scenes::Shapes;
use crate::simd::Level;

/// Whether all shapes are discs of one size.
pub fn are_equal_discs(shapes: &Shapes) -> bool {
    !shapes.has_boxes() && shapes.radius.iter().all(|&radius| radius == shapes.radius[0])
}

/// All overlapping pairs, rows `i < j`. The size of cells is the caller's to tune; it is made
/// larger where the answer would not be exact otherwise.
pub fn pairs(shapes: &Shapes, cell: CellSize, level: Level) -> Vec<Pair> {
    if shapes.len() < 2 {
        Vec::new()
    } else if are_equal_discs(shapes) {
        equal::pairs(shapes, cell, level)
    } else {
        larger::pairs(shapes, cell, level)
    }
}
