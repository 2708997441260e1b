//! Strips: the shapes of a leaf sorted into horizontal strips, from low y to high y.
//!
//! A shape can overlap only shapes of its own strip and of a fixed number of strips on either
//! side, because these together are higher than any shape. They are adjacent in memory. This is
//! a sort and sweep along y with buckets.

use std::ops::Range;

use super::partition::Item;
use crate::geometry::{Bounds, Scalar};
use crate::shapes::{Each, Shapes};
use jostle_base::error::Result;
use jostle_base::memory;

/// Maximum number of strips of a leaf.
const MAX_STRIPS: usize = 192;

/// Strips per height of the highest shape, if there are enough shapes.
const STRIPS_PER_HEIGHT: f64 = 2.0;

/// Minimum mean number of shapes in a strip.
const MIN_SHAPES: usize = 2;

/// Heights are increased by this factor, which is much larger than all rounding errors.
const SLACK: f64 = 1.0 + 1.0 / 256.0;

/// Minimum height: squares of smaller float32 distances lose precision.
const MIN_HEIGHT: f64 = 1e-15;

/// The strips of one leaf.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Strips<T> {
    /// Index of the end of its first strip in the list of ends.
    first: u32,
    count: u32,
    /// Number of strips after its own with shapes that a shape could overlap.
    ahead: u32,
    low: T,
    per_unit: T,
    /// Height of the highest box.
    box_height: T,
}

impl<T: Scalar> Strips<T> {
    /// Strips for `len` shapes with centres (or lower sides) from `low` to `high`, none higher than
    /// `max_height`.
    fn new(len: usize, [low, high]: [T; 2], max_height: f64, box_height: T) -> Self {
        // A height of 0 (points) would give infinitely many strips. In float32 the squares of
        // smaller distances lose bits, so two shapes may overlap by the formula although they are
        // slightly more than their heights apart.
        let height = (max_height * SLACK).max(MIN_HEIGHT);
        let extent = high.to_f64() - low.to_f64();
        let heights = extent / height;
        let count =
            // Two strips for each height: with one a search takes 10.4 ns a shape, with two 9.9,
            // with four 11.6 (docs/benchmarks-notes.md). Lower strips follow the shapes more
            // closely, but each has a loop of its own. Strips with fewer than two shapes would be
            // mostly loops. The number has to fit into a u8.
            (STRIPS_PER_HEIGHT * heights).min((len / MIN_SHAPES).min(MAX_STRIPS) as f64).floor();
        if !heights.is_finite() || count < 2.0 {
            return Self { count: 1, box_height, ..Self::default() };
        }
        // Let d be the distance of two y in strips. If the shapes overlap, then d < count /
        // heights, by the slack also after rounding. The integer parts of two numbers at that
        // distance differ by at most its ceiling. So no overlapping pair is further apart than
        // `ahead`.
        let ahead = (count / heights).ceil() as u32;
        let per_unit = T::from_f64(count / extent);
        Self { first: 0, count: count as u32, ahead, low, per_unit, box_height }
    }

    /// The strip of a shape by the y of its centre (or lower side), clamped to the existing ones.
    #[inline(always)]
    fn index(&self, y: T) -> usize {
        let along = ((y - self.low) * self.per_unit).to_f64();
        // The cast makes 0 of negative numbers and of NaN. The shape with the largest y would be in
        // a strip after the last.
        (along as usize).min(self.count as usize - 1)
    }

    /// These strips with their ends listed `by` later, modulo 2^32.
    pub(super) fn moved(self, by: u32) -> Self {
        Self { first: self.first.wrapping_add(by), ..self }
    }

    /// These strips for shapes that are higher by `distance`.
    pub(super) fn reaching(self, distance: T) -> Self {
        // The shapes stay in their strips. Only the reach grows, by the strips in the distance.
        let more = (distance.to_f64() * SLACK * self.per_unit.to_f64()).ceil();
        // Below the number of strips, so that the sum does not overflow.
        let more = (more as u32).min(MAX_STRIPS as u32) + 1;
        Self { ahead: self.ahead.saturating_add(more), ..self }
    }

    /// The range of the ends of its strips in the list of ends.
    pub(super) fn ends(&self) -> Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }

    /// The last strip with shapes that a shape in `strip` could overlap.
    #[inline(always)]
    pub(super) fn last_reached(&self, strip: usize) -> usize {
        (strip + self.ahead as usize).min(self.count as usize - 1)
    }

    /// The range of the indices of a leaf, whole strips, with all shapes that could overlap a shape
    /// within `bounds`; `own` are the bounds of the leaf.
    #[inline(always)]
    pub(super) fn indices(
        &self,
        ends: &[u32],
        indices: Range<usize>,
        own: &Bounds<T>,
        bounds: &Bounds<T>,
    ) -> Range<usize> {
        if self.count == 1 {
            return indices;
        }
        let half_sum = own.half_size[1].to_f64() + bounds.half_size[1].to_f64();
        // In float64 and with the slack: no shape that passes the exact test afterwards is outside,
        // whatever that test rounds.
        let above = own.radius.to_f64() + bounds.radius.to_f64() + half_sum;
        let above = above.max(MIN_HEIGHT) * SLACK;
        // Boxes are sorted by their lower sides, so a box that reaches `bounds` may begin its own
        // height below.
        let below = above + self.box_height.to_f64() * SLACK;
        let low = self.index(T::from_f64(bounds.min[1].to_f64() - below));
        let high = self.index(T::from_f64(bounds.max[1].to_f64() + above));
        let ends = &ends[self.ends()];
        let start = if low == 0 { indices.start } else { ends[low - 1] as usize };
        start..ends[high] as usize
    }
}

/// Columns for the rows and the centres of some shapes.
pub(super) struct Outputs<'a, T> {
    /// Rows.
    pub rows: &'a mut [u32],
    /// Centres, x. For shapes given as boxes another module overwrites x and y.
    pub x: &'a mut [T],
    /// Centres, y.
    pub y: &'a mut [T],
}

impl<'a, T> Outputs<'a, T> {
    /// Splits off the first `len` entries.
    pub(super) fn split_off(&mut self, len: usize) -> Self {
        const EXPECT: &str = "the sizes add up";
        Self {
            rows: self.rows.split_off_mut(..len).expect(EXPECT),
            x: self.x.split_off_mut(..len).expect(EXPECT),
            y: self.y.split_off_mut(..len).expect(EXPECT),
        }
    }

    /// A range of them.
    pub(super) fn range(&mut self, range: Range<usize>) -> Outputs<'_, T> {
        Outputs {
            rows: &mut self.rows[range.clone()],
            x: &mut self.x[range.clone()],
            y: &mut self.y[range],
        }
    }
}

/// Scratch for the shapes of one leaf.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    strips: Vec<u8>,
}

/// Writes the shapes of a leaf, whose first index is `start`, in the order of their strips
/// (counting sort); appends the end of each strip to `ends`.
pub(super) fn sort_into_strips<T: Scalar>(
    shapes: &Shapes<T>,
    items: &[Item<T>],
    start: usize,
    to: Outputs<'_, T>,
    ends: &mut Vec<u32>,
    scratch: &mut Scratch,
) -> Result<Strips<T>> {
    let leaf = Strips { first: ends.len() as u32, ..strips_of(shapes, items) };
    if leaf.count == 1 {
        return single_strip(items, start, to, ends);
    }
    let mut next = [0u32; MAX_STRIPS + 1];
    let strips = &mut scratch.strips;
    strips.clear();
    // One byte for each shape, computed once: counting and writing both need it.
    memory::extend(strips, items.iter().map(|item| leaf.index(low_y(shapes, item)) as u8))?;
    memory::reserve(ends, leaf.count as usize)?;
    strips.iter().for_each(|&strip| next[strip as usize + 1] += 1);
    for strip in 0..leaf.count as usize {
        next[strip + 1] += next[strip];
        ends.push(start as u32 + next[strip + 1]);
    }
    for (&strip, item) in strips.iter().zip(items) {
        let index = next[strip as usize] as usize;
        // The columns are written here, while the item is in the cache. A later pass would fetch
        // each centre by its row from all over memory: 24 → 18 ns a shape in trees of a million.
        (to.rows[index], [to.x[index], to.y[index]]) = (item.row, item.center);
        next[strip as usize] += 1;
    }
    Ok(leaf)
}

/// Writes the shapes of a leaf in the order of the items, as one strip.
pub(super) fn single_strip<T: Scalar>(
    items: &[Item<T>],
    start: usize,
    to: Outputs<'_, T>,
    ends: &mut Vec<u32>,
) -> Result<Strips<T>> {
    let first = ends.len() as u32;
    memory::push(ends, (start + items.len()) as u32)?;
    for (index, item) in items.iter().enumerate() {
        (to.rows[index], [to.x[index], to.y[index]]) = (item.row, item.center);
    }
    Ok(Strips { first, count: 1, ..Strips::default() })
}

/// The y of a shape's centre, or of its lower side.
#[inline(always)]
fn low_y<T: Scalar>(shapes: &Shapes<T>, item: &Item<T>) -> T {
    match &shapes.boxes {
        None => item.center[1],
        Some(boxes) => boxes[item.row as usize][1],
    }
}

/// Number and height of the strips for the shapes of a leaf.
fn strips_of<T: Scalar>(shapes: &Shapes<T>, items: &[Item<T>]) -> Strips<T> {
    let rows = || items.iter().map(|item| item.row as usize);
    let [low, high] = extent(items, |item| low_y(shapes, item));
    let box_height = shapes.boxes.as_ref().map_or(T::ZERO, |boxes| {
        rows().map(|row| boxes[row][3] - boxes[row][1]).fold(T::ZERO, T::max)
    });
    let radius = match &shapes.radii {
        Each::One(radius) => *radius,
        Each::Rows(radii) => rows().map(|row| radii[row]).fold(T::ZERO, T::max),
    };
    let half_height = shapes.half_sizes.as_ref().map_or(T::ZERO, |half_sizes| {
        rows().map(|row| half_sizes.at(row)[1]).fold(T::ZERO, T::max)
    });
    let max_height = box_height.to_f64() + 2.0 * (radius.to_f64() + half_height.to_f64());
    Strips::new(items.len(), [low, high], max_height, box_height)
}

/// The smallest and the largest y, in independent streams.
fn extent<T: Scalar>(items: &[Item<T>], y_of: impl Fn(&Item<T>) -> T) -> [T; 2] {
    // A minimum waits for the one before it. Four independent ones run at the same time.
    const STREAMS: usize = 4;
    let (chunks, rest) = items.as_chunks::<STREAMS>();
    let first = y_of(&items[0]);
    let (mut low, mut high) = ([first; STREAMS], [first; STREAMS]);
    for chunk in chunks {
        for stream in 0..STREAMS {
            let y = y_of(&chunk[stream]);
            (low[stream], high[stream]) = (low[stream].min(y), high[stream].max(y));
        }
    }
    let low = rest.iter().map(&y_of).chain(low).fold(first, T::min);
    let high = rest.iter().map(&y_of).chain(high).fold(first, T::max);
    [low, high]
}
