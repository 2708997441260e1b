//! The cells of the grid: the cell of a point, without a branch.

use crate::scenes::Shapes;

/// Width and height of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellSize {
    /// Along a row.
    pub width: f32,
    /// From row to row.
    pub height: f32,
}

/// Maximum number of cells along an axis; coordinates of cells are exact in float32.
const MOST_CELLS: f32 = 32_768.0;

/// Added to a number below 2²², this leaves it rounded to a whole number in the last bits.
const ROUNDING: f32 = 8_388_608.0;

/// One axis of the grid.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    start: f32,
    per_unit: f32,
    /// Number of cells.
    pub cells: usize,
}

impl Axis {
    /// Cells of `size` or more over all coordinates.
    #[inline(always)]
    fn over(coordinates: &[f32], size: f32) -> Self {
        let (start, end) = range(coordinates);
        let size = size.max((end - start) / MOST_CELLS).max(f32::MIN_POSITIVE);
        let mut axis = Self { start, per_unit: 1.0 / size, cells: 1 };
        axis.cells = axis.cell(end) as usize + 1;
        axis
    }

    /// The cell of a coordinate. Rounding is monotone, so two coordinates that differ by
    /// less than a cell, and some of float32's error, are at most one cell apart.
    #[inline(always)]
    pub fn cell(&self, coordinate: f32) -> u32 {
        let place = (coordinate - self.start) * self.per_unit + ROUNDING;
        place.to_bits().wrapping_sub(ROUNDING.to_bits())
    }

    /// The cell of a coordinate that may be outside.
    #[inline(always)]
    pub fn cell_clamped(&self, coordinate: f32) -> usize {
        let place = ((coordinate - self.start) * self.per_unit).clamp(0.0, MOST_CELLS);
        let place = (place + ROUNDING).to_bits().wrapping_sub(ROUNDING.to_bits());
        (place as usize).min(self.cells - 1)
    }
}

/// The minimum and the maximum, in several streams, so that vectors can be used.
#[inline(always)]
fn range(coordinates: &[f32]) -> (f32, f32) {
    const STREAMS: usize = 32;
    let less = |a: f32, b: f32| if a < b { a } else { b };
    let more = |a: f32, b: f32| if a > b { a } else { b };
    let (chunks, rest) = coordinates.as_chunks::<STREAMS>();
    let (mut low, mut high) = ([f32::INFINITY; STREAMS], [f32::NEG_INFINITY; STREAMS]);
    for chunk in chunks {
        for lane in 0..STREAMS {
            low[lane] = less(chunk[lane], low[lane]);
            high[lane] = more(chunk[lane], high[lane]);
        }
    }
    let low = low.iter().chain(rest).copied().fold(f32::INFINITY, less);
    (low, high.iter().chain(rest).copied().fold(f32::NEG_INFINITY, more))
}

/// Cells in rows. There is an empty cell before and after each row, and an empty row after the
/// last, so that the neighbours of a cell are always adjacent.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Along a row.
    pub x: Axis,
    /// From row to row.
    pub y: Axis,
}

impl Frame {
    /// Cells over the centres of all shapes.
    #[inline(always)]
    pub fn over(shapes: &Shapes, cell: CellSize) -> Self {
        Self { x: Axis::over(&shapes.x, cell.width), y: Axis::over(&shapes.y, cell.height) }
    }

    /// Cells from one row to the next.
    #[inline(always)]
    pub fn stride(&self) -> usize {
        self.x.cells + 2
    }

    /// Total number of cells.
    pub fn cells(&self) -> usize {
        self.stride() * (self.y.cells + 1)
    }

    /// The cell of a point.
    #[inline(always)]
    pub fn cell(&self, x: f32, y: f32) -> u32 {
        self.y.cell(y) * self.stride() as u32 + self.x.cell(x) + 1
    }
}
