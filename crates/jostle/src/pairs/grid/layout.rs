//! The cells of a grid.

use std::ops::Range;

use crate::geometry::Scalar;
use crate::quadtree::nearest_integer;
use crate::quadtree::partition::{Item, KEY_BITS, Source};
use crate::shapes::{Each, Shapes};
use crate::simd::{LANES, Simd, Work};

/// Cells are larger than the distance at which circles overlap by this factor, which is much larger
/// than all rounding errors.
const SLACK: f64 = 1.0 + 1.0 / 64.0;

/// Maximum number of cells for each circle: more take time and memory.
const MAX_CELLS: f64 = 8.0;

/// Maximum height of a cell, as a multiple of the least: otherwise circles in clusters would be
/// tested against many that they do not overlap.
const MAX_HEIGHT: f64 = 2.0;

/// Maximum width of a cell, as a multiple of the least.
const MAX_WIDTH: f64 = 4.0;

/// Approximate number of circles in a band.
const BAND: f64 = 4096.0;

/// Maximum number of leading bits that define a band.
const MAX_BAND_BITS: u32 = 10;

/// A grid of cells in rows. Circles that overlap are in the same cell or in neighbouring ones. Some
/// adjacent rows form a band.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    /// The axis along a row, that along which the centres extend less. So rows are short.
    axis: usize,
    /// The smallest coordinates along a row and across it.
    start: [f64; 2],
    /// Cells for each unit along a row and across it.
    per_unit: [f64; 2],
    /// From one row to the next, with an empty cell between them.
    pub(super) stride: u32,
    /// Rows of a band as a power of two.
    row_bits: u32,
    /// Leading bits of a key, the number of its band.
    pub(super) bits: u32,
    /// Number of bands.
    pub(super) bands: usize,
}

impl Layout {
    /// A grid for `len` circles that overlap within a distance; None if the tree is faster, because
    /// most cells would be empty, or if there are too many cells.
    pub(super) fn over<T: Scalar>(
        [min, max]: [[T; 2]; 2],
        distance: f64,
        len: usize,
    ) -> Option<Self> {
        let extent = [0, 1].map(|axis| max[axis].to_f64() - min[axis].to_f64());
        let axis = usize::from(extent[1] < extent[0]);
        let (start, [along, across]) = ([axis, 1 - axis], [extent[axis], extent[1 - axis]]);
        let least = distance * SLACK;
        if !(least > 0.0 && across.is_finite()) {
            return None;
        }
        // Cells of the least size for each circle.
        let cells = (along / least + 1.0) * (across / least + 1.0) / len as f64;
        let width = cells.clamp(1.0, MAX_WIDTH);
        let height = (cells / width / MAX_CELLS).clamp(1.0, MAX_HEIGHT);
        if cells > width * height * MAX_CELLS {
            return None;
        }
        let per_unit = [1.0 / (least * width), 1.0 / (least * height)];
        let columns = (along * per_unit[0]) as usize + 2;
        let rows = (across * per_unit[1]) as usize + 2;
        let row_bits = (rows as f64 * BAND / len as f64).max(1.0).log2() as u32;
        let row_bits = row_bits.min(rows.next_power_of_two().ilog2());
        let row_bits = row_bits.max(rows.div_ceil(1 << MAX_BAND_BITS).next_power_of_two().ilog2());
        let bands = rows.div_ceil(1 << row_bits);
        let bits = bands.next_power_of_two().ilog2();
        let stride = columns as u32 + 1;
        let fits = u64::from(stride) << row_bits < 1 << (KEY_BITS - bits);
        let start = start.map(|axis| min[axis].to_f64());
        fits.then_some(Self { axis, start, per_unit, stride, row_bits, bits, bands })
    }

    /// Rows of a band.
    pub(super) fn rows(&self) -> usize {
        1 << self.row_bits
    }

    /// The keys of some centres: the leading bits are the number of the band, the others that of the
    /// cell in it. Rounding is monotone, so centres that differ by less than a cell are in the same
    /// one or in neighbouring ones.
    #[inline(always)]
    fn keys<const COUNT: usize>(
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
            let band = u64::from(row >> self.row_bits) << shift;
            keys[lane] = band as u32 | in_band;
        }
        keys
    }

    /// The cell in its band.
    #[inline(always)]
    pub(super) fn cell(&self, key: u32) -> usize {
        (u64::from(key) & ((1 << (KEY_BITS - self.bits)) - 1)) as usize
    }
}

/// The centres of circles of one radius, as a source of items.
pub(super) struct Centers<'a, T> {
    pub(super) layout: Layout,
    pub(super) centers: &'a [[T; 2]],
}

impl<T: Scalar> Source<T> for Centers<'_, T> {
    fn len(&self) -> usize {
        self.centers.len()
    }

    fn keys(&self, range: Range<usize>, keys: &mut [u32]) {
        T::with_widest(Keys { layout: &self.layout, centers: &self.centers[range], keys });
    }

    #[inline(always)]
    fn item(&self, index: usize, key: u32) -> Item<T> {
        Item { key, row: index as u32, center: self.centers[index] }
    }
}

/// Computes the keys of some centres.
struct Keys<'a, T> {
    layout: &'a Layout,
    centers: &'a [[T; 2]],
    keys: &'a mut [u32],
}

impl<T: Scalar> Work<T> for Keys<'_, T> {
    type Out = ();

    #[inline(always)]
    fn run<S: Simd<T>>(self, _: S) {
        let Self { layout, centers, keys } = self;
        let axis = layout.axis;
        let (blocks, rest) = centers.as_chunks::<LANES>();
        let (key_blocks, rest_keys) = keys.as_chunks_mut::<LANES>();
        for (block, keys) in blocks.iter().zip(key_blocks) {
            let (mut x, mut y) = ([0.0; LANES], [0.0; LANES]);
            for lane in 0..LANES {
                (x[lane], y[lane]) = (block[lane][0].to_f64(), block[lane][1].to_f64());
            }
            *keys = if axis == 0 { layout.keys(&x, &y) } else { layout.keys(&y, &x) };
        }
        for (center, key) in rest.iter().zip(rest_keys) {
            let [along, across] = [axis, 1 - axis].map(|axis| [center[axis].to_f64()]);
            *key = layout.keys(&along, &across)[0];
        }
    }
}

/// The distance between the centres of two of the shapes below which they overlap; None unless all
/// are circles of one radius that may pair.
pub(super) fn distance_of<T: Scalar>(shapes: &Shapes<T>) -> Option<T> {
    let Shapes { radii: Each::One(radius), half_sizes: None, boxes: None, filters: None, .. } =
        shapes
    else {
        return None;
    };
    shapes.period.is_none().then_some(*radius + *radius)
}
