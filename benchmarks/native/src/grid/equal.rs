//! Discs of one size: cells at least as wide and as high as a disc, and a look at half of
//! the neighbours, the rest of the own row and three cells of the row below.

use super::frame::{CellSize, Frame};
use super::sorted::Sorted;
use crate::rivals::Pair;
use crate::scenes::Shapes;
use crate::simd::{Lanes, Level, Output, Work};

/// Cells are larger than discs by more than float32 can be wrong about 32,768 of them.
const SLACK: f32 = 1.0 + 1.0 / 64.0;

pub fn pairs(shapes: &Shapes, cell: CellSize, level: Level) -> Vec<Pair> {
    level.run(Equal { shapes, cell })
}

struct Equal<'a> {
    shapes: &'a Shapes,
    cell: CellSize,
}

impl Work for Equal<'_> {
    type Outcome = Vec<Pair>;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Vec<Pair> {
        let Self { shapes, cell } = self;
        let reach = shapes.radius[0] + shapes.radius[0];
        let least = reach * SLACK;
        let cell = CellSize { width: cell.width.max(least), height: cell.height.max(least) };
        let sorted = Sorted::new(shapes, Frame::over(shapes, cell), false);
        let mut output = Output::new(shapes.len());
        for row in 0..sorted.frame.y.cells {
            output = in_row(&sorted, row, reach * reach, lanes, output);
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
    let x = columns.x();
    for disc in own[0] as usize..below[0] as usize {
        let cell = frame.x.cell(x[disc]) as usize;
        // Its cell is `cell + 1` of the row, for the empty one before; two on, the next ends.
        let own_end = if cell + 3 < stride { own[cell + 3] } else { below[0] };
        let strips = [disc + 1..own_end as usize, below[cell] as usize..below[cell + 3] as usize];
        output = lanes.two_strips(columns, disc, strips, reach_squared, output);
    }
    output
}
