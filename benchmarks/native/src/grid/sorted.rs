//! Shapes in the order of their cells, by two counting sorts: first into blocks of neighbouring
//! cells, then within each block. So neither pass writes to the whole memory at random.

use super::frame::Frame;
use crate::scenes::Shapes;
use crate::simd::{Columns, SPARE};

/// Approximate number of shapes in a block; with the cells they fit into the second-level cache.
const BLOCK: usize = 4096;

/// Sorted shapes, and the start of each cell; the cell after the last one starts at the end.
#[derive(Debug)]
pub struct Sorted {
    /// The cells of the grid.
    pub frame: Frame,
    /// The start of each cell.
    pub starts: Vec<u32>,
    /// The shapes.
    pub columns: Columns,
}

impl Sorted {
    /// Sorts `shapes`; sizes are kept if `sized`. A size is a disc's radius or the longer half
    /// side of a rectangle.
    #[inline(always)]
    pub fn new(shapes: &Shapes, frame: Frame, sized: bool) -> Self {
        let records = in_blocks(shapes, &frame);
        let (starts, x, y, id) = in_cells(&records, frame.cells());
        let ids = &id[..shapes.len()];
        let gather = |column: &[f32]| column_of(ids, |row| column[row]);
        let [w, h] = &shapes.half;
        let (size, half) = if shapes.has_boxes() {
            (column_of(ids, |row| w[row].max(h[row])), [gather(w), gather(h)])
        } else {
            let size = if sized { gather(&shapes.radius) } else { Vec::new() };
            (size, [Vec::new(), Vec::new()])
        };
        Self { frame, starts, columns: Columns::new(x, y, id, size, half) }
    }
}

#[inline(always)]
fn column_of(ids: &[u32], value: impl Fn(usize) -> f32) -> Vec<f32> {
    let mut column = Vec::with_capacity(ids.len() + SPARE);
    column.extend(ids.iter().map(|&id| value(id as usize)));
    column.resize(ids.len() + SPARE, 0.0);
    column
}

/// A shape during the sort: bits of x and y, cell, row.
type Record = [u32; 4];

/// The shapes, grouped by blocks of neighbouring cells.
#[inline(always)]
fn in_blocks(shapes: &Shapes, frame: &Frame) -> Vec<Record> {
    let shift = block_shift(shapes.len(), frame.cells());
    let places = shapes.x.iter().zip(&shapes.y);
    let cells: Vec<u32> = places.clone().map(|(&x, &y)| frame.cell(x, y)).collect();
    let mut next = vec![0u32; (frame.cells() >> shift) + 2];
    for &cell in &cells {
        next[(cell >> shift) as usize + 1] += 1;
    }
    for block in 1..next.len() {
        next[block] += next[block - 1];
    }
    let mut records = vec![[0; 4]; shapes.len()];
    for (row, (&cell, (&x, &y))) in cells.iter().zip(places).enumerate() {
        let place = &mut next[(cell >> shift) as usize];
        records[*place as usize] = [x.to_bits(), y.to_bits(), cell, row as u32];
        *place += 1;
    }
    records
}

/// Cells of a block as a power of two.
fn block_shift(len: usize, cells: usize) -> u32 {
    let blocks = len.div_ceil(BLOCK);
    cells.div_ceil(blocks).next_power_of_two().ilog2()
}

/// The start of each cell, and the columns x, y and id in the order of cells.
#[inline(always)]
fn in_cells(records: &[Record], cells: usize) -> (Vec<u32>, Vec<f32>, Vec<f32>, Vec<u32>) {
    // During the sort the count of a cell is two places further, its next free place one.
    let mut starts = vec![0u32; cells + 2];
    for record in records {
        starts[record[2] as usize + 2] += 1;
    }
    let mut sum = 0;
    for start in &mut starts {
        sum += *start;
        *start = sum;
    }
    let len = records.len() + SPARE;
    let (mut x, mut y, mut id) = (vec![0.0; len], vec![0.0; len], vec![0; len]);
    for &[bits_x, bits_y, cell, row] in records {
        let next = &mut starts[cell as usize + 1];
        let place = *next as usize;
        x[place] = f32::from_bits(bits_x);
        y[place] = f32::from_bits(bits_y);
        id[place] = row;
        *next += 1;
    }
    starts.pop();
    (starts, x, y, id)
}
