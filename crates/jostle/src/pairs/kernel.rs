//! Some shapes against some others, in blocks of [`LANES`] whose results are bits.

use std::ops::Range;

use super::output::Output;
use crate::columns::{Columns, DEFAULT_CATEGORY, DEFAULT_MASK, LANES};
use crate::geometry::{Cover, Scalar, Shape, overlap};

/// Some rows of `a` to be tested against some rows of `b`.
pub(super) struct Block<'a, T> {
    pub(super) a: &'a Columns<T>,
    pub(super) rows: Range<usize>,
    pub(super) b: &'a Columns<T>,
    pub(super) others: Range<usize>,
}

/// Which pairs of a block are wanted.
#[derive(Clone, Copy)]
pub(super) enum Wanted<'a, T> {
    /// Every row with every other.
    All,
    /// Both sides are the same rows: the second has to lie behind the first.
    Behind,
    /// Every row that reaches this cover of the others with every other.
    Near(&'a Cover<T>),
}

impl<T: Scalar> Block<'_, T> {
    /// Emits every wanted overlapping pair. The kernels for circles and for what
    /// pairs with everything are spared the other numbers.
    #[inline(always)]
    pub(super) fn test(&self, shift: [T; 2], wanted: Wanted<'_, T>, output: &mut Output) {
        let boxes = self.a.has_boxes() || self.b.has_boxes();
        let filters = self.a.has_filters() || self.b.has_filters();
        match (boxes, filters) {
            (false, false) => self.rows::<false, false>(shift, wanted, output),
            (true, false) => self.rows::<true, false>(shift, wanted, output),
            (false, true) => self.rows::<false, true>(shift, wanted, output),
            (true, true) => self.rows::<true, true>(shift, wanted, output),
        }
    }

    #[inline(always)]
    fn rows<const BOXES: bool, const FILTERS: bool>(
        &self,
        shift: [T; 2],
        wanted: Wanted<'_, T>,
        output: &mut Output,
    ) {
        let Range { start, end } = self.rows;
        match wanted {
            Wanted::All => {
                for row in start..end {
                    self.row::<BOXES, FILTERS>(row, self.others.start, shift, output);
                }
            }
            Wanted::Behind => {
                for row in start..end {
                    let from = self.others.start.max(row + 1);
                    self.row::<BOXES, FILTERS>(row, from, shift, output);
                }
            }
            Wanted::Near(cover) => {
                for block in (start..end).step_by(LANES) {
                    let near = reaching(self.a, block, shift, cover) & first_lanes(end - block);
                    for_each_bit(near, |lane| {
                        let from = self.others.start;
                        self.row::<BOXES, FILTERS>(block + lane, from, shift, output);
                    });
                }
            }
        }
    }

    /// Tests one row against the others from `from`.
    #[inline(always)]
    fn row<const BOXES: bool, const FILTERS: bool>(
        &self,
        row: usize,
        from: usize,
        shift: [T; 2],
        output: &mut Output,
    ) {
        let end = self.others.end;
        if from >= end || output.is_full() {
            return;
        }
        let mut shape = self.a.shape(row);
        shape.center = [shape.center[0] - shift[0], shape.center[1] - shift[1]];
        output.tests += (end - from) as u64;
        for start in (from..end).step_by(LANES) {
            let hits = hits::<T, BOXES, FILTERS>(&shape, self.b, start) & first_lanes(end - start);
            for_each_bit(hits, |lane| output.push([row as u32, (start + lane) as u32]));
        }
    }
}

/// Bits of the first `count` lanes.
#[inline(always)]
fn first_lanes(count: usize) -> u32 {
    if count < LANES { (1 << count) - 1 } else { u32::MAX }
}

#[inline(always)]
fn for_each_bit(mut bits: u32, mut act: impl FnMut(usize)) {
    while bits != 0 {
        act(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}

/// A bit for each of the [`LANES`] rows from `start` that `shape` overlaps.
#[inline(always)]
fn hits<T: Scalar, const BOXES: bool, const FILTERS: bool>(
    shape: &Shape<T>,
    others: &Columns<T>,
    start: usize,
) -> u32 {
    let block = start..start + LANES;
    let (x, y) = (&others.x[block.clone()], &others.y[block.clone()]);
    let radius = &others.radius[block.clone()];
    let mut near = [false; LANES];
    if BOXES && others.has_boxes() {
        let half_x = &others.half_x[block.clone()];
        let half_y = &others.half_y[block.clone()];
        for lane in 0..LANES {
            let half_sum = [shape.half_size[0] + half_x[lane], shape.half_size[1] + half_y[lane]];
            near[lane] = reaches(shape, x[lane], y[lane], half_sum, radius[lane]);
        }
    } else if BOXES {
        for lane in 0..LANES {
            near[lane] = reaches(shape, x[lane], y[lane], shape.half_size, radius[lane]);
        }
    } else {
        for lane in 0..LANES {
            let dx = shape.center[0] - x[lane];
            let dy = shape.center[1] - y[lane];
            let reach = shape.radius + radius[lane];
            near[lane] = dx * dx + dy * dy < reach * reach;
        }
    }
    let mut bits = as_bits(&near);
    if FILTERS && bits != 0 {
        bits &= allowed(shape, others, block);
    }
    bits
}

/// A bit for each of the [`LANES`] rows from `start` that, moved by `-shift`, could
/// overlap something under `cover`. Filters are left to the pairs themselves.
#[inline(always)]
fn reaching<T: Scalar>(rows: &Columns<T>, start: usize, shift: [T; 2], cover: &Cover<T>) -> u32 {
    let block = start..start + LANES;
    let (x, y) = (&rows.x[block.clone()], &rows.y[block.clone()]);
    let radius = &rows.radius[block.clone()];
    let gap = |v: T, axis: usize| {
        let v = v - shift[axis];
        (cover.min[axis] - v).most(v - cover.max[axis]).most(T::ZERO)
    };
    let mut near = [false; LANES];
    if rows.has_boxes() {
        let (half_x, half_y) = (&rows.half_x[block.clone()], &rows.half_y[block]);
        for lane in 0..LANES {
            let half_sum = [half_x[lane] + cover.half_size[0], half_y[lane] + cover.half_size[1]];
            let gaps = [gap(x[lane], 0), gap(y[lane], 1)];
            near[lane] = overlap(gaps, half_sum, radius[lane] + cover.radius);
        }
    } else {
        for lane in 0..LANES {
            let gaps = [gap(x[lane], 0), gap(y[lane], 1)];
            near[lane] = overlap(gaps, cover.half_size, radius[lane] + cover.radius);
        }
    }
    as_bits(&near)
}

/// Lane k as bit k.
#[inline(always)]
fn as_bits(lanes: &[bool; LANES]) -> u32 {
    lanes.iter().enumerate().fold(0, |bits, (lane, &set)| bits | u32::from(set) << lane)
}

/// The overlap formula for one lane.
#[inline(always)]
fn reaches<T: Scalar>(shape: &Shape<T>, x: T, y: T, half_sum: [T; 2], radius: T) -> bool {
    let distance = [(shape.center[0] - x).abs(), (shape.center[1] - y).abs()];
    overlap(distance, half_sum, shape.radius + radius)
}

/// A bit for each row whose filter and the shape's agree.
#[inline(always)]
fn allowed<T: Scalar>(shape: &Shape<T>, others: &Columns<T>, block: Range<usize>) -> u32 {
    let mut bits = 0;
    for (lane, row) in block.enumerate() {
        let (category, mask) = if others.has_filters() {
            (others.category[row], others.mask[row])
        } else {
            (DEFAULT_CATEGORY, DEFAULT_MASK)
        };
        let agree = (shape.category & mask) != 0 && (category & shape.mask) != 0;
        bits |= u32::from(agree) << lane;
    }
    bits
}
