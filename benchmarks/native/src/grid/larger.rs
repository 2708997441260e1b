//! Shapes of different sizes. Each is tested against smaller ones, within the distance at which
//! they can overlap. So the search is short for small shapes, and long for few large ones.

use std::ops::Range;

use super::frame::CellSize;
use super::sorted::Sorted;
use super::{Sort, in_bands};
use crate::rivals::Pair;
use crate::scenes::Shapes;
use crate::simd::{BOXES, DISCS, Kind, Lanes, Level, Output, Work};

pub fn pairs(shapes: &Shapes, cell: CellSize, level: Level, threads: usize) -> Vec<Pair> {
    let sorted = level.run(Sort { shapes, cell, sized: true });
    in_bands(shapes.len(), threads, |rows| {
        if shapes.has_boxes() {
            level.run(Join::<BOXES> { sorted: &sorted, rows })
        } else {
            level.run(Join::<DISCS> { sorted: &sorted, rows })
        }
    })
}

/// The pairs of some of the sorted shapes with smaller ones.
struct Join<'a, const KIND: Kind> {
    sorted: &'a Sorted,
    rows: Range<usize>,
}

impl<const KIND: Kind> Work for Join<'_, KIND> {
    type Outcome = Vec<Pair>;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Vec<Pair> {
        let mut output = Output::new(self.rows.len());
        for row in self.rows {
            output = around::<KIND, L>(self.sorted, row, lanes, output);
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
    // Slightly larger than the distance, because of rounding.
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
