//! Shapes in the order of their cells, by counting.

use super::frame::Frame;
use crate::scenes::Shapes;
use crate::simd::{Columns, SPARE};

/// Sorted shapes, and where each cell begins; the cell behind the last begins at the end.
#[derive(Debug)]
pub struct Sorted {
    /// Where the cells lie.
    pub frame: Frame,
    /// Where each cell begins.
    pub starts: Vec<u32>,
    /// The shapes.
    pub columns: Columns,
}

impl Sorted {
    /// Sorts `shapes`; sizes are kept where `sized`. A size is a disc's radius or the longer
    /// half side of a rectangle.
    #[inline(always)]
    pub fn new(shapes: &Shapes, frame: Frame, sized: bool) -> Self {
        let cells: Vec<u32> =
            shapes.x.iter().zip(&shapes.y).map(|(&x, &y)| frame.cell(x, y)).collect();
        let (starts, places) = count(&cells, frame.cells());
        let columns = Columns::new(
            scatter(&shapes.x, &places),
            scatter(&shapes.y, &places),
            scatter_rows(&places),
            if sized { scatter(&sizes(shapes), &places) } else { Vec::new() },
            shapes.half.each_ref().map(|half| scatter(half, &places)),
        );
        Self { frame, starts, columns }
    }
}

fn sizes(shapes: &Shapes) -> Vec<f32> {
    if !shapes.has_boxes() {
        return shapes.radius.clone();
    }
    let [w, h] = &shapes.half;
    w.iter().zip(h).map(|(w, h)| w.max(*h)).collect()
}

/// Where each cell begins, and the place of each row.
#[inline(always)]
fn count(cells: &[u32], all: usize) -> (Vec<u32>, Vec<u32>) {
    // While placing, the count of a cell stands two further on, its next free place one.
    let mut starts = vec![0u32; all + 2];
    for &cell in cells {
        starts[cell as usize + 2] += 1;
    }
    let mut sum = 0;
    for start in &mut starts {
        sum += *start;
        *start = sum;
    }
    let place = |&cell: &u32| {
        let next = &mut starts[cell as usize + 1];
        *next += 1;
        *next - 1
    };
    let places = cells.iter().map(place).collect();
    starts.pop();
    (starts, places)
}

#[inline(always)]
fn scatter(column: &[f32], places: &[u32]) -> Vec<f32> {
    if column.is_empty() {
        return Vec::new();
    }
    let mut sorted = vec![0.0; column.len() + SPARE];
    for (&value, &place) in column.iter().zip(places) {
        sorted[place as usize] = value;
    }
    sorted
}

#[inline(always)]
fn scatter_rows(places: &[u32]) -> Vec<u32> {
    let mut sorted = vec![0; places.len() + SPARE];
    for (row, &place) in places.iter().enumerate() {
        sorted[place as usize] = row as u32;
    }
    sorted
}
