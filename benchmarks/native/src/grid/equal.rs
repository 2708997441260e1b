//! Discs of one size. Cells are at least as wide and as high as a disc. Each disc is tested
//! against half of the neighbouring cells: the rest of its own row and three cells of the row
//! below.

use std::ops::Range;

use super::frame::CellSize;
use super::sorted::Sorted;
use super::{Sort, in_bands};
use crate::rivals::Pair;
use crate::scenes::Shapes;
use crate::simd::{Lanes, Level, Output, Work};

/// Cells are larger than discs by more than the rounding error of float32 over 32,768 cells.
const SLACK: f32 = 1.0 + 1.0 / 64.0;

pub fn pairs(shapes: &Shapes, cell: CellSize, level: Level, threads: usize) -> Vec<Pair> {
    let reach = shapes.radius[0] + shapes.radius[0];
    let least = reach * SLACK;
    let cell = CellSize { width: cell.width.max(least), height: cell.height.max(least) };
    let sorted = level.run(Sort { shapes, cell, sized: false });
    let rows = sorted.frame.y.cells;
    in_bands(rows, threads, |rows| {
        level.run(Join { sorted: &sorted, rows, squared: reach * reach })
    })
}

/// The pairs of the discs in some rows of cells.
struct Join<'a> {
    sorted: &'a Sorted,
    rows: Range<usize>,
    squared: f32,
}

impl Work for Join<'_> {
    type Outcome = Vec<Pair>;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Vec<Pair> {
        let Self { sorted, rows, squared } = self;
        let stride = sorted.frame.stride();
        let [first, last] = [rows.start, rows.end].map(|row| sorted.starts[row * stride] as usize);
        let mut output = Output::new(last - first);
        for row in rows {
            output = in_row(sorted, row, squared, lanes, output);
        }
        output.finish()
    }
}

/// The pairs of the discs in one row of cells.
#[inline(always)]
fn in_row<L: Lanes>(
    sorted: &Sorted,
    row: usize,
    reach_squared: f32,
    lanes: L,
    mut output: Output,
) -> Output {
    let Sorted { frame, starts, columns } = sorted;
    let stride = frame.stride();
    let (own, below) = starts[row * stride..].split_at(stride);
    let below = &below[..=stride];
    let discs = own[0] as usize..below[0] as usize;
    for (disc, &x) in discs.clone().zip(&columns.x()[discs]) {
        let cell = frame.x.cell(x) as usize;
        // Its cell is `cell + 1` of the row, for the empty one before; two on, the next ends.
        let own_end = if cell + 3 < stride { own[cell + 3] } else { below[0] };
        let strips = [disc + 1..own_end as usize, below[cell] as usize..below[cell + 3] as usize];
        output = lanes.two_strips(columns, disc, strips, reach_squared, output);
    }
    output
}
