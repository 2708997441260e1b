//! Shapes of different sizes: each looks for those that are smaller than itself, as far as
//! such a one can be away. Small ones look near, few large ones far.

use super::frame::{CellSize, Frame};
use super::sorted::Sorted;
use crate::rivals::Pair;
use crate::scenes::Shapes;
use crate::simd::{BOXES, DISCS, Kind, Lanes, Level, Output, Work};

pub fn pairs(shapes: &Shapes, cell: CellSize, level: Level) -> Vec<Pair> {
    if shapes.has_boxes() {
        level.run(Larger::<BOXES> { shapes, cell })
    } else {
        level.run(Larger::<DISCS> { shapes, cell })
    }
}

struct Larger<'a, const KIND: Kind> {
    shapes: &'a Shapes,
    cell: CellSize,
}

impl<const KIND: Kind> Work for Larger<'_, KIND> {
    type Outcome = Vec<Pair>;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Vec<Pair> {
        let sorted = Sorted::new(self.shapes, Frame::over(self.shapes, self.cell), true);
        let mut output = Output::new(self.shapes.len());
        for row in 0..sorted.columns.len() {
            output = around::<KIND, L>(&sorted, row, lanes, output);
        }
        output.finish()
    }
}

/// The pairs of the shape in `row` with smaller ones.
#[inline(always)]
fn around<const KIND: Kind, L: Lanes>(
    sorted: &Sorted,
    row: usize,
    lanes: L,
    mut output: Output,
) -> Output {
    let Sorted { frame, starts, columns } = sorted;
    let (x, y, size) = (columns.x()[row], columns.y()[row], columns.size()[row]);
    let [width, height] = columns.half().map_or([size; 2], |half| half.map(|half| half[row]));
    // A little more than the reach, so that rounding cannot hide a neighbour.
    let reach = |half: f32, center: f32| half + size + 1e-6 * (half + size + center.abs());
    let (reach_x, reach_y) = (reach(width, x), reach(height, y));
    let columns_of = frame.x.cell_clamped(x - reach_x)..frame.x.cell_clamped(x + reach_x) + 1;
    let rows_of = frame.y.cell_clamped(y - reach_y)..=frame.y.cell_clamped(y + reach_y);
    for cells in rows_of {
        // The first cell of a row is the empty one.
        let first = cells * frame.stride() + 1;
        let start = starts[first + columns_of.start] as usize;
        let end = starts[first + columns_of.end] as usize;
        output = lanes.strip::<KIND>(columns, row, start..end, 0.0, output);
    }
    output
}
