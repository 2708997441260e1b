//! The size up to which the shapes of a grid are small, by an estimate of the time from a sample.

use super::layout::Layout;
use super::sizes::{EQUAL, Input, half_extent_of};
use crate::geometry::Scalar;
use crate::quadtree::partition::Item;
use jostle_simd::LANES;

/// Shapes for each one of the sample, and limits of its size.
const FOR_EACH_SAMPLED: usize = 64;
const SAMPLES: [usize; 2] = [32, 4096];

/// The fractions of the sample that are tried as small shapes. Smaller fractions were slower in
/// most scenes (`docs/benchmarks-notes.md`).
const FRACTIONS: [f64; 4] = [1.0, 0.98, 0.95, 0.9];

/// If all shapes are small, the largest size of the sample times this is the limit of small shapes.
const MARGIN: f64 = 1.0 + 1.0 / 16.0;

/// Times as multiples of that of a test of a shape against one block of others, measured with
/// AVX-512 (`docs/benchmarks-notes.md`): to sort a small shape; to sort a large one, list the bands
/// that it may reach and sort it again for a grid of larger cells.
const SHAPE: f64 = 8.0;
const LARGE: f64 = 50.0;

/// The time of a tree for each shape, in the same unit. A grid that takes as long has about 24
/// shapes in a cell, or a seventh of its shapes are large.
const TREE: f64 = 16.0;

/// Number of cells whose shapes are tested against a shape: half of its own cell, and four others.
const TESTED_CELLS: f64 = 4.5;

/// The cells of a grid, and the largest small shape.
pub(super) struct Choice<T> {
    pub(super) layout: Layout,
    pub(super) small: [T; 2],
}

/// The fastest grid; None if the tree is faster.
pub(super) fn choose<T: Scalar, const SIZES: usize>(
    input: &(impl Input<T, SIZES> + ?Sized),
    extent: [[T; 2]; 2],
    radius: Option<T>,
) -> Option<Choice<T>> {
    let len = input.len();
    // Circles of one radius are all small, and the layout alone says whether most cells would be
    // empty. So there is no sample, and no cost of one.
    if let Some(radius) = radius {
        let distance = [(radius + radius).to_f64(); 2];
        let layout = Layout::over(extent, distance, len, false)?;
        return Some(Choice { layout, small: [radius; 2] });
    }
    debug_assert!(SIZES != EQUAL);
    let sample = Sample::of(input);
    let mut best: Option<(f64, Choice<T>)> = None;
    for fraction in FRACTIONS {
        // A grid with fewer small shapes takes at least this time.
        let least = fraction * SHAPE + (1.0 - fraction) * LARGE;
        // The least possible time of this fraction, with empty cells. Without this end a sparse
        // scene of 1,000 circles took 1.26 instead of 1.03 times as long as with the tree
        // (docs/benchmarks-notes.md).
        if best.as_ref().is_some_and(|best| best.0 < least + blocks(0.0)) {
            break;
        }
        let last = ((sample.len() as f64 * fraction) as usize).clamp(1, sample.len()) - 1;
        // The largest shape is most likely not in the sample. With the margin most shapes that are
        // a little larger are still small, instead of a few large ones that each cost six times as
        // much.
        let margin = if fraction < 1.0 { 1.0 } else { MARGIN };
        let small = sample.sorted.each_ref().map(|sorted| T::from_f64(sorted[last] * margin));
        let Some((time, choice)) = sample.estimate(extent, small, len) else { continue };
        if best.as_ref().is_none_or(|best| time < best.0) {
            best = Some((time, choice));
        }
    }
    best.filter(|(time, _)| *time < TREE).map(|(_, choice)| choice)
}

/// Some shapes, whose rows in the input have no pattern.
struct Sample {
    centers: Vec<[f64; 2]>,
    /// Half the widths and the heights of their bounding boxes.
    half_extents: Vec<[f64; 2]>,
    /// Half the widths in ascending order, and half the heights.
    sorted: [Vec<f64>; 2],
}

impl Sample {
    fn of<T: Scalar, const SIZES: usize>(input: &(impl Input<T, SIZES> + ?Sized)) -> Self {
        let len = input.len();
        let count = (len / FOR_EACH_SAMPLED).clamp(SAMPLES[0], SAMPLES[1]).min(len);
        // One from each of `count` ranges of rows, at an offset in it from a hash.
        // Rows at equal distances may have a pattern: of rectangles alternately wide and high all
        // of one kind were chosen. Not random either, because the choice decides the order of the
        // pairs.
        let at = |index: usize| index * len / count + hash(index) as usize % (len / count);
        let shapes = (0..count).map(|index| {
            let Item { center, sizes, .. } = input.item(at(index));
            (center.map(T::to_f64), half_extent_of(&sizes).map(T::to_f64))
        });
        let (centers, half_extents): (Vec<[f64; 2]>, Vec<[f64; 2]>) = shapes.unzip();
        let mut sorted = [0, 1]
            .map(|k| half_extents.iter().map(|half_extent| half_extent[k]).collect::<Vec<f64>>());
        sorted.iter_mut().for_each(|half_extents| half_extents.sort_unstable_by(f64::total_cmp));
        Self { centers, half_extents, sorted }
    }

    fn len(&self) -> usize {
        self.centers.len()
    }

    /// The time for each of `len` shapes of a grid with some largest small shape.
    fn estimate<T: Scalar>(
        &self,
        extent: [[T; 2]; 2],
        small: [T; 2],
        len: usize,
    ) -> Option<(f64, Choice<T>)> {
        let limit = small.map(T::to_f64);
        let is_small =
            |half_extent: &[f64; 2]| half_extent[0] <= limit[0] && half_extent[1] <= limit[1];
        let shapes = || self.centers.iter().zip(&self.half_extents);
        let share = shapes().filter(|shape| is_small(shape.1)).count() as f64 / self.len() as f64;
        let count = (share * len as f64).max(1.0);
        let layout = Layout::over(extent, limit.map(|v| 2.0 * v), count as usize, true)?;
        let cell = layout.cell_size();
        let sides = [0, 1].map(|k| extent[1][k].to_f64() - extent[0][k].to_f64() + cell[k]);
        // As if the shapes were spread evenly. The sample sees clusters, but with few shapes it may
        // see no two in one cell. The larger of the two estimates errs towards the tree.
        let even = count * (cell[0] / sides[0]) * (cell[1] / sides[1]);
        let some = shapes().filter(|shape| is_small(shape.1)).map(|shape| *shape.0);
        let in_cell = neighbors(&layout, some, len as f64 / self.len() as f64).max(even);
        let mut time = share * (SHAPE + blocks(TESTED_CELLS * in_cell));
        for half_extent in self.half_extents.iter().filter(|half_extent| !is_small(half_extent)) {
            let cells = [0, 1].map(|k| 2.0 * (half_extent[k] + limit[k]) / cell[k] + 1.0);
            // The cells of a row are one range, tested as whole blocks; each row begins a block of
            // its own.
            let [along, across] = [layout.axis, 1 - layout.axis].map(|axis| cells[axis]);
            time += (LARGE + across * blocks(along * in_cell)) / self.len() as f64;
        }
        Some((time, Choice { layout, small }))
    }
}

/// A number without a pattern.
fn hash(index: usize) -> u32 {
    let word = (index as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    ((word ^ word >> 32).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as u32
}

/// Number of blocks that have some number of shapes.
fn blocks(shapes: f64) -> f64 {
    1.0 + shapes / LANES as f64
}

/// The mean number of others in the cell of a shape, from a sample that has one shape for `each`.
fn neighbors(layout: &Layout, centers: impl Iterator<Item = [f64; 2]>, each: f64) -> f64 {
    let key = |center: [f64; 2]| layout.keys(&[center[layout.axis]], &[center[1 - layout.axis]])[0];
    let mut keys: Vec<u32> = centers.map(key).collect();
    keys.sort_unstable();
    let pairs_in = |keys: &[u32]| keys.len() * (keys.len() - 1);
    let pairs: usize = keys.chunk_by(|a, b| a == b).map(pairs_in).sum();
    // Each shape of the sample stands for `each` shapes, so a neighbour in the sample stands for as
    // many.
    pairs as f64 * each / keys.len().max(1) as f64
}
