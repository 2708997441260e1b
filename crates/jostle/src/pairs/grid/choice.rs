//! The size up to which the shapes of a grid are small, by an estimate of the time from a sample.

use super::layout::Layout;
use super::sizes::{EQUAL, Input, reach_of};
use crate::geometry::Scalar;
use crate::simd::{HALF, LANES};

/// Shapes for each one of the sample, and limits of its size.
const FOR_EACH_SAMPLED: usize = 32;
const SAMPLES: [usize; 2] = [32, 512];

/// The fractions of the sample that may be small.
const FRACTIONS: [f64; 7] = [1.0, 0.98, 0.95, 0.9, 0.8, 0.65, 0.5];

/// The largest of a sample times this is the largest small shape, if all are small.
const MARGIN: f64 = 1.0 + 1.0 / 16.0;

/// Estimated times in nanoseconds, measured with AVX-512: to sort a shape and to test it against one
/// block of others; to test another block; to sort a large shape and to search for those that are
/// larger; to find the shapes of one of its rows of cells.
const SHAPE: f64 = 15.0;
const BLOCK: f64 = 2.0;
const LARGE: f64 = 40.0;
const ROW: f64 = 5.0;

/// A grid that takes longer than this for each shape is slower than the tree.
const MAX_TIME: f64 = 60.0;

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
    if let Some(radius) = radius {
        let distance = [(radius + radius).to_f64(); 2];
        let layout = Layout::over(extent, distance, len, false)?;
        return Some(Choice { layout, small: [radius; 2] });
    }
    debug_assert!(SIZES != EQUAL);
    let sample = sample(input);
    let mut sorted = [0, 1].map(|k| sample.iter().map(|reach| reach[k]).collect::<Vec<f64>>());
    sorted.iter_mut().for_each(|reaches| reaches.sort_unstable_by(f64::total_cmp));
    let mut best: Option<(f64, Choice<T>)> = None;
    for fraction in FRACTIONS {
        let last = ((sample.len() as f64 * fraction) as usize).clamp(1, sample.len()) - 1;
        let margin = if fraction < 1.0 { 1.0 } else { MARGIN };
        let small = [0, 1].map(|k| T::from_f64(sorted[k][last] * margin));
        let Some((time, choice)) = estimate(extent, small, &sample, len) else { continue };
        if best.as_ref().is_none_or(|best| time < best.0) {
            best = Some((time, choice));
        }
    }
    best.filter(|(time, _)| *time < MAX_TIME).map(|(_, choice)| choice)
}

/// Half the widths and the heights of some shapes, whose places in the input have no pattern.
fn sample<T: Scalar, const SIZES: usize>(input: &(impl Input<T, SIZES> + ?Sized)) -> Vec<[f64; 2]> {
    let len = input.len();
    let count = (len / FOR_EACH_SAMPLED).clamp(SAMPLES[0], SAMPLES[1]).min(len);
    let step = |index: usize| (index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
    let at = |index: usize| (step(index) * len as u64 >> 32) as usize;
    (0..count).map(|index| reach_of(&input.item(at(index)).sizes).map(T::to_f64)).collect()
}

/// The time for each shape of a grid with some largest small shape.
fn estimate<T: Scalar>(
    extent: [[T; 2]; 2],
    small: [T; 2],
    sample: &[[f64; 2]],
    len: usize,
) -> Option<(f64, Choice<T>)> {
    let limit = small.map(T::to_f64);
    let is_small = |reach: &&[f64; 2]| reach[0] <= limit[0] && reach[1] <= limit[1];
    let share = sample.iter().filter(is_small).count() as f64 / sample.len() as f64;
    let count = (share * len as f64).max(1.0);
    let layout = Layout::over(extent, limit.map(|v| 2.0 * v), count as usize, true)?;
    // Width and height of a cell, and small shapes in a unit of area.
    let [across, along] = [1, 0].map(|k| 1.0 / layout.per_unit[k]);
    let cell = if layout.axis == 0 { [along, across] } else { [across, along] };
    let sides = [0, 1].map(|k| extent[1][k].to_f64() - extent[0][k].to_f64() + cell[k]);
    let density = count / sides[0] / sides[1];
    let in_cell = density * cell[0] * cell[1];
    let blocks = (3.0 * in_cell / HALF as f64).max(1.0);
    let mut time = share * (SHAPE + BLOCK * blocks);
    let [x, y] = if layout.axis == 0 { [0, 1] } else { [1, 0] };
    let mut of_large = 0.0;
    for reach in sample.iter().filter(|reach| !is_small(reach)) {
        let rows = 2.0 * (reach[y] + limit[y]) / cell[y] + 1.0;
        let in_row = density * cell[y] * (2.0 * (reach[x] + limit[x]) + cell[x]);
        of_large += LARGE + rows * (ROW + BLOCK * (0.5 + in_row / LANES as f64));
    }
    time += of_large / sample.len() as f64;
    Some((time, Choice { layout, small }))
}
