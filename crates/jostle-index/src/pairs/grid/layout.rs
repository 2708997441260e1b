//! The cells of a grid.

use crate::geometry::Scalar;
use crate::quadtree::nearest_integer;
use crate::quadtree::partition::KEY_BITS;

/// Cells are larger than the distance at which shapes overlap by this factor, which is much larger
/// than all rounding errors.
pub(super) const SLACK: f64 = 1.0 + 1.0 / 64.0;

/// Maximum number of cells for each shape: more take time and memory.
const MAX_CELLS: f64 = 8.0;

/// Maximum height of a cell, as a multiple of the least: otherwise shapes in clusters would be
/// tested against many that they do not overlap.
const MAX_HEIGHT: f64 = 2.0;

/// Maximum width of a cell, as a multiple of the least.
const MAX_WIDTH: f64 = 4.0;

/// Minimum distance at which shapes overlap: the reciprocal of a smaller one may be infinite.
const MIN_DISTANCE: f64 = 1e-290;

/// Approximate number of shapes in a band.
const BAND: f64 = 4096.0;

/// Maximum number of leading bits that define a band.
const MAX_BAND_BITS: u32 = 10;

/// A grid of cells in rows. Shapes that overlap are in the same cell or in neighbouring ones. Some
/// adjacent rows form a band.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    /// The axis along a row, that along which the centres extend less. So rows are short.
    pub(super) axis: usize,
    /// The smallest coordinates along a row and across it.
    start: [f64; 2],
    /// Cells for each unit along a row and across it.
    per_unit: [f64; 2],
    /// Number of cells of a row, and number of rows.
    cells: [u32; 2],
    /// From one row to the next, with an empty cell between them.
    pub(super) stride: u32,
    /// Rows of a band as a power of two.
    pub(super) row_bits: u32,
    /// Leading bits of a key, the number of its band.
    pub(super) bits: u32,
    /// Number of bands.
    pub(super) bands: usize,
}

impl Layout {
    /// A grid for `len` shapes between `min` and `max` that overlap only within a distance along
    /// each axis; None if the tree is faster, because most cells would be empty, or if there are
    /// too many cells. If there are `large` shapes, their keys are those of one more band.
    pub(super) fn over<T: Scalar>(
        [min, max]: [[T; 2]; 2],
        distance: [f64; 2],
        len: usize,
        large: bool,
    ) -> Option<Self> {
        let extent = [0, 1].map(|axis| max[axis].to_f64() - min[axis].to_f64());
        // Short rows: the row above is still in the cache when its shapes are tested, and bands can
        // be cut more finely.
        let axis = usize::from(extent[1] < extent[0]);
        let (start, [along, across]) = ([axis, 1 - axis], [extent[axis], extent[1 - axis]]);
        let least = start.map(|axis| distance[axis] * SLACK);
        let usable = |least: f64| least > MIN_DISTANCE && least.is_finite();
        if !(usable(least[0]) && usable(least[1]) && across.is_finite()) {
            return None;
        }
        // Cells of the least size for each shape.
        let cells = (along / least[0] + 1.0) * (across / least[1] + 1.0) / len as f64;
        // Sparse shapes get larger cells, so that there are at most eight for each shape. First
        // wider: the cells of a row are one range, so width costs tests only. Height adds tests in
        // three rows of clusters. With up to eight cells for a shape instead of four, 2 % of the
        // area covered takes 18 instead of 27 ns a shape.
        let width = cells.clamp(1.0, MAX_WIDTH);
        let height = (cells / width / MAX_CELLS).clamp(1.0, MAX_HEIGHT);
        if cells > width * height * MAX_CELLS {
            return None;
        }
        let per_unit = [1.0 / (least[0] * width), 1.0 / (least[1] * height)];
        // A coordinate is rounded to the nearest cell, so the last index is up to one above the
        // integer part.
        let columns = (along * per_unit[0]) as usize + 2;
        let rows = (across * per_unit[1]) as usize + 2;
        // About 4,096 shapes in a band, whose columns fit into the second-level cache together with
        // its cells.
        let row_bits = ((rows as f64 * BAND / len as f64) as usize).max(1).ilog2();
        let row_bits = row_bits.min(rows.next_power_of_two().ilog2());
        // Not more bands than the partition can write to at once, see `sort`.
        let row_bits = row_bits.max(rows.div_ceil(1 << MAX_BAND_BITS).next_power_of_two().ilog2());
        let bands = rows.div_ceil(1 << row_bits);
        let bits = (bands + usize::from(large)).next_power_of_two().ilog2();
        let stride = columns as u32 + 1;
        // The number of a cell in its band needs the bits that the number of the band leaves.
        let fits = u64::from(stride) << row_bits < 1 << (KEY_BITS - bits);
        let start = start.map(|axis| min[axis].to_f64());
        let cells = [columns as u32, rows as u32];
        fits.then_some(Self { axis, start, per_unit, cells, stride, row_bits, bits, bands })
    }

    /// Rows of a band, except the last one.
    pub(super) fn rows(&self) -> usize {
        1 << self.row_bits
    }

    /// Rows of the band with some number.
    pub(super) fn rows_of(&self, band: usize) -> usize {
        self.rows().min(self.cells[1] as usize - (band << self.row_bits))
    }

    /// Width and height of a cell.
    pub(super) fn cell_size(&self) -> [f64; 2] {
        let [along, across] = self.per_unit.map(|per_unit| 1.0 / per_unit);
        if self.axis == 0 { [along, across] } else { [across, along] }
    }

    /// The keys of some centres: the leading bits are the number of the band, the others that of
    /// the cell in it. Rounding is monotone, so centres that differ by less than a cell are in the
    /// same one or in neighbouring ones.
    #[inline(always)]
    pub(super) fn keys<const COUNT: usize>(
        &self,
        along: &[f64; COUNT],
        across: &[f64; COUNT],
    ) -> [u32; COUNT] {
        let mut keys = [0; COUNT];
        let shift = KEY_BITS - self.bits;
        for lane in 0..COUNT {
            let cell = |at: f64, k: usize| nearest_integer((at - self.start[k]) * self.per_unit[k]);
            let (column, row) = (cell(along[lane], 0), cell(across[lane], 1));
            let in_band = (row & ((1 << self.row_bits) - 1)) * self.stride + column;
            // In 64 bits, because a shift by 32 is possible: with a single band no bits are left
            // for its number.
            let band = u64::from(row >> self.row_bits) << shift;
            keys[lane] = band as u32 | in_band;
        }
        keys
    }

    /// The key of large shapes, for which there is a band after the last one.
    #[inline(always)]
    pub(super) fn key_of_large(&self) -> u32 {
        ((self.bands as u64) << (KEY_BITS - self.bits)) as u32
    }

    /// The cell in its band.
    #[inline(always)]
    pub(super) fn cell(&self, key: u32) -> usize {
        (u64::from(key) & ((1 << (KEY_BITS - self.bits)) - 1)) as usize
    }

    /// The columns and the rows, the last one included, of all centres within a distance along each
    /// axis of a center.
    #[inline(always)]
    pub(super) fn around(&self, center: [f64; 2], distance: [f64; 2]) -> [[u32; 2]; 2] {
        [self.axis, 1 - self.axis].map(|axis| {
            let k = usize::from(axis != self.axis);
            let cell = |at: f64| {
                let along = (at - self.start[k]) * self.per_unit[k];
                // A large shape may reach beyond the grid, where there are no cells.
                nearest_integer(along.clamp(0.0, f64::from(self.cells[k] - 1)))
            };
            [cell(center[axis] - distance[axis]), cell(center[axis] + distance[axis])]
        })
    }
}
