//! The narrow phase: SIMD tests of shapes against blocks of shapes.
//!
//! The results for a block are bits of a mask, and the pairs are written by stream compaction. So
//! no branch depends on which shapes overlap.

use std::ops::Range;

use super::Filters;
use super::output::Output;
use crate::columns::{Columns, SPARE};
use crate::geometry::{Bounds, Scalar, Shape, filters_agree, lanes};
use crate::shapes::{DEFAULT_CATEGORY, DEFAULT_MASK};
use jostle_simd::{LANES, Simd, block, block_mut, first_lanes, for_each_lane};

/// Number of shapes that are packed at a time.
const CHUNK: usize = MAX_ROW_HITS;

/// Maximum number of rows that are tested against a block at a time.
const MAX_ROW_HITS: usize = 64;

/// Rows with more candidates than this are tested block by block instead of row by row.
const MAX_STRIP_ROWS: usize = 2 * LANES;

/// Tests shapes of `a`, moved by `-shift`, against shapes of `b`, moved by `-other_shift`.
pub(super) struct Kernel<'a, T, S> {
    pub(super) simd: S,
    pub(super) a: &'a Columns<T>,
    pub(super) b: &'a Columns<T>,
    pub(super) shift: [T; 2],
    /// Only leaves are tested with it.
    pub(super) other_shift: [T; 2],
    pub(super) filters: Filters,
}

/// One leaf of a pair of leaves.
pub(super) struct Side<'a, T> {
    pub(super) range: Range<usize>,
    pub(super) bounds: &'a Bounds<T>,
}

/// Scratch for a pair of leaves.
pub(super) struct Scratch<T> {
    packed: [Packed<T>; 2],
    row_hits: RowHits,
}

/// Rows that overlap shapes of a block, and the lanes of these.
type RowHits = [(u32, u32); MAX_ROW_HITS];

/// Shapes packed by stream compaction.
struct Packed<T> {
    len: usize,
    x: [T; CHUNK + LANES],
    y: [T; CHUNK + LANES],
    max_x: [T; CHUNK + LANES],
    max_y: [T; CHUNK + LANES],
    radius: [T; CHUNK + LANES],
    half_x: [T; CHUNK + LANES],
    half_y: [T; CHUNK + LANES],
    index: [u32; CHUNK + LANES],
}

impl<T: Scalar> Default for Scratch<T> {
    fn default() -> Self {
        Self { packed: Default::default(), row_hits: [(0, 0); MAX_ROW_HITS] }
    }
}

impl<T: Scalar> Default for Packed<T> {
    fn default() -> Self {
        let none = [T::ZERO; CHUNK + LANES];
        Self {
            len: 0,
            x: none,
            y: none,
            max_x: none,
            max_y: none,
            radius: none,
            half_x: none,
            half_y: none,
            index: [0; CHUNK + LANES],
        }
    }
}

impl<T> Packed<T> {
    /// The shapes that are packed.
    #[inline(always)]
    fn rows(&self) -> Rows<'_, T> {
        let len = self.len.min(CHUNK);
        Rows {
            x: &self.x[..len],
            y: &self.y[..len],
            max_x: &self.max_x[..len],
            max_y: &self.max_y[..len],
            radius: &self.radius[..len],
            half_x: &self.half_x[..len],
            half_y: &self.half_y[..len],
        }
    }

    /// The packed shapes with padding, so that a block can be loaded at each.
    #[inline(always)]
    fn padded(&self) -> Rows<'_, T> {
        Rows {
            x: &self.x,
            y: &self.y,
            max_x: &self.max_x,
            max_y: &self.max_y,
            radius: &self.radius,
            half_x: &self.half_x,
            half_y: &self.half_y,
        }
    }
}

/// Columns of some shapes, as in [`Columns`]; half sizes may be empty.
struct Rows<'a, T> {
    x: &'a [T],
    y: &'a [T],
    max_x: &'a [T],
    max_y: &'a [T],
    radius: &'a [T],
    half_x: &'a [T],
    half_y: &'a [T],
}

impl<'a, T: Scalar> Rows<'a, T> {
    /// All rows of `columns`, including spare rows.
    #[inline(always)]
    fn all(columns: &'a Columns<T>) -> Self {
        Self {
            x: &columns.x,
            y: &columns.y,
            max_x: columns.max_x(),
            max_y: columns.max_y(),
            radius: &columns.radius,
            half_x: &columns.half_x,
            half_y: &columns.half_y,
        }
    }

    /// A range of the rows of `columns`.
    #[inline(always)]
    fn of(columns: &'a Columns<T>, rows: Range<usize>) -> Self {
        let half = |column: &'a [T]| if column.is_empty() { column } else { &column[rows.clone()] };
        Self {
            x: &columns.x[rows.clone()],
            y: &columns.y[rows.clone()],
            max_x: &columns.max_x()[rows.clone()],
            max_y: &columns.max_y()[rows.clone()],
            radius: &columns.radius[rows.clone()],
            half_x: half(&columns.half_x),
            half_y: half(&columns.half_y),
        }
    }
}

/// A block of shapes in registers.
#[derive(Clone, Copy)]
struct Loaded<B> {
    x: B,
    y: B,
    max_x: B,
    max_y: B,
    radius: B,
    half: [B; 2],
}

/// Kinds of cores, a const parameter of the functions below, which compute only what the kind
/// requires. This kind: all cores are points.
pub(super) const POINTS: u8 = 0;

/// All shapes are given by their centres; some have half sizes.
pub(super) const HALF_SIZES: u8 = 1;

/// Some shapes are given as boxes.
pub(super) const BOXES: u8 = 2;

/// Calls a method of a [`Kernel`] with the kind of the cores as its const parameter.
macro_rules! of_kind {
    ($kernel:ident.$method:ident($($argument:expr),* $(,)?)) => {
        match $kernel.core() {
            $crate::pairs::kernel::POINTS => {
                $kernel.$method::<{ $crate::pairs::kernel::POINTS }>($($argument),*)
            }
            $crate::pairs::kernel::HALF_SIZES => {
                $kernel.$method::<{ $crate::pairs::kernel::HALF_SIZES }>($($argument),*)
            }
            _ => $kernel.$method::<{ $crate::pairs::kernel::BOXES }>($($argument),*),
        }
    };
}
pub(super) use of_kind;

impl<T: Scalar, S: Simd<T>> Kernel<'_, T, S> {
    /// The kind of the cores.
    #[inline(always)]
    pub(super) fn core(&self) -> u8 {
        if self.a.has_boxes() || self.b.has_boxes() {
            BOXES
        } else if self.a.has_half_sizes() || self.b.has_half_sizes() {
            HALF_SIZES
        } else {
            POINTS
        }
    }

    /// Finds the overlapping pairs of one shape each of two leaves: only shapes that overlap the
    /// bounds of the other leaf are tested.
    #[inline(always)]
    pub(super) fn leaf_pair<const CORE: u8>(
        &self,
        first: &Side<'_, T>,
        second: &Side<'_, T>,
        scratch: &mut Scratch<T>,
        output: &mut Output<'_>,
    ) {
        let Scratch { packed: [packed_a, packed_b], row_hits } = scratch;
        let [shift, other_shift] = [self.shift, self.other_shift];
        // Most shapes of a leaf are far from the other leaf. Those that overlap its bounds are
        // packed side by side first, so the tests of all against all are few and their blocks full.
        let (bounds_a, bounds_b) = (first.bounds.moved(shift), second.bounds.moved(other_shift));
        for start in first.range.clone().step_by(CHUNK) {
            let rows = start..first.range.end.min(start + CHUNK);
            self.pack::<CORE>(self.a, rows, shift, &bounds_b, packed_a);
            if packed_a.len == 0 {
                continue;
            }
            for start in second.range.clone().step_by(CHUNK) {
                let rows = start..second.range.end.min(start + CHUNK);
                self.pack::<CORE>(self.b, rows, other_shift, &bounds_a, packed_b);
                if packed_b.len > 0 {
                    self.packed::<CORE>(packed_a, packed_b, row_hits, output);
                }
                // Leaves of coincident points at `max_depth` may have a million shapes each, so
                // this loop checks too.
                if output.is_over(packed_a.len * (1 + packed_b.len)) {
                    return;
                }
            }
        }
    }

    /// Tests all shapes in `packed_a` against all shapes in `packed_b`.
    #[inline(always)]
    fn packed<const CORE: u8>(
        &self,
        packed_a: &Packed<T>,
        packed_b: &Packed<T>,
        row_hits: &mut RowHits,
        output: &mut Output<'_>,
    ) {
        output.tests += (packed_a.len * packed_b.len) as u64;
        let rows = packed_a.rows();
        for start in (0..packed_b.len.min(CHUNK)).step_by(LANES) {
            let others = self.load::<CORE>(&packed_b.padded(), start);
            let lanes = first_lanes(packed_b.len - start);
            // The indices of packed shapes have gaps, so the pairs take them from a column instead
            // of counting on.
            let indices = block(&packed_b.index, start);
            let allowed = |row: usize, bits: u32| {
                let shape = self.a.shape(packed_a.index[row] as usize);
                allowed(&shape, self.b, |lane| indices[lane] as usize, bits)
            };
            let wanted = |_: usize| lanes;
            let found = self.test::<CORE>(&rows, &others, wanted, allowed, row_hits);
            let simd = self.simd;
            emit_pairs(
                found,
                output,
                #[inline(always)]
                |row, bits, to| simd.pair_with(packed_a.index[row], indices, bits, to),
            );
        }
    }

    /// Packs those of `rows` (at most [`CHUNK`]) that, moved by `-shift`, could overlap a shape
    /// within `bounds`. Filters are tested for pairs only.
    #[inline(always)]
    fn pack<const CORE: u8>(
        &self,
        columns: &Columns<T>,
        rows: Range<usize>,
        shift: [T; 2],
        bounds: &Bounds<T>,
        to: &mut Packed<T>,
    ) {
        let simd = self.simd;
        to.len = 0;
        for start in rows.clone().step_by(LANES) {
            let mut shapes = self.load::<CORE>(&Rows::all(columns), start);
            // Packed where they are after the move, by the same subtraction as in `Shape::moved`.
            shapes.x = simd.sub(shapes.x, simd.splat(shift[0]));
            shapes.y = simd.sub(shapes.y, simd.splat(shift[1]));
            if CORE == BOXES {
                shapes.max_x = simd.sub(shapes.max_x, simd.splat(shift[0]));
                shapes.max_y = simd.sub(shapes.max_y, simd.splat(shift[1]));
            } else {
                // The compiler removes this where upper corners are not read: the kind is known at
                // compile time.
                [shapes.max_x, shapes.max_y] = [shapes.x, shapes.y];
            }
            let bits = self.lanes_near::<CORE>(&shapes, bounds) & first_lanes(rows.end - start);
            // Always true that `len` is at most `CHUNK`, since no more rows come in. The minimum
            // tells the compiler, which then leaves out the checks of the slices.
            let end = to.len.min(CHUNK);
            // A whole block is written, of which the first numbers count; the next block overwrites
            // the others.
            simd.pack(shapes.x, bits, block_mut(&mut to.x, end));
            simd.pack(shapes.y, bits, block_mut(&mut to.y, end));
            simd.pack(shapes.radius, bits, block_mut(&mut to.radius, end));
            if CORE == BOXES {
                simd.pack(shapes.max_x, bits, block_mut(&mut to.max_x, end));
                simd.pack(shapes.max_y, bits, block_mut(&mut to.max_y, end));
            }
            if CORE != POINTS {
                simd.pack(shapes.half[0], bits, block_mut(&mut to.half_x, end));
                simd.pack(shapes.half[1], bits, block_mut(&mut to.half_y, end));
            }
            simd.pack_indices(start as u32, bits, block_mut(&mut to.index, end));
            to.len = end + bits.count_ones() as usize;
        }
    }

    /// A bit for each shape of a block that could overlap a shape within `bounds`.
    #[inline(always)]
    fn lanes_near<const CORE: u8>(&self, shapes: &Loaded<S::Block>, bounds: &Bounds<T>) -> u32 {
        let dx = self.gap_to_bounds::<CORE>([shapes.x, shapes.max_x], shapes.half[0], bounds, 0);
        let dy = self.gap_to_bounds::<CORE>([shapes.y, shapes.max_y], shapes.half[1], bounds, 1);
        let radius_sum = self.simd.add(shapes.radius, self.simd.splat(bounds.radius));
        self.overlap::<CORE>(dx, dy, radius_sum)
    }

    /// A lower bound of the gap between the core of each shape of a block and the cores within
    /// `bounds` along an axis.
    #[inline(always)]
    fn gap_to_bounds<const CORE: u8>(
        &self,
        [min, max]: [S::Block; 2],
        half: S::Block,
        bounds: &Bounds<T>,
        axis: usize,
    ) -> S::Block {
        let simd = self.simd;
        let mut gap = lanes::gap(simd, [bounds.min[axis], bounds.max[axis]], [min, max]);
        if CORE != BOXES {
            // The distance of two centres is never negative.
            // A centre inside the bounds has a negative gap. For points the overlap test takes its
            // square as a distance, so without the maximum such shapes would be left out, and pairs
            // lost.
            gap = simd.max(gap, simd.splat(T::ZERO));
        }
        if CORE == POINTS {
            return gap;
        }
        simd.sub(gap, simd.add(half, simd.splat(bounds.half_size[axis])))
    }

    /// A bit for each shape of a block that overlaps a given shape.
    #[inline(always)]
    fn hits<const CORE: u8>(
        &self,
        [min, max]: [[T; 2]; 2],
        half: [T; 2],
        radius: T,
        others: &Loaded<S::Block>,
    ) -> u32 {
        let (x, y) = ([others.x, others.max_x], [others.y, others.max_y]);
        let dx = self.gap::<CORE>([min[0], max[0]], x, half[0], others.half[0]);
        let dy = self.gap::<CORE>([min[1], max[1]], y, half[1], others.half[1]);
        let radius_sum = self.simd.add(self.simd.splat(radius), others.radius);
        self.overlap::<CORE>(dx, dy, radius_sum)
    }

    /// The gap between the cores along an axis; for points, the signed difference of the centres,
    /// of which only the square is used.
    #[inline(always)]
    fn gap<const CORE: u8>(
        &self,
        [min, max]: [T; 2],
        [min_others, max_others]: [S::Block; 2],
        half: T,
        half_others: S::Block,
    ) -> S::Block {
        let simd = self.simd;
        let gap = match CORE {
            // The sign vanishes in the square, so no absolute value is needed.
            POINTS => return simd.sub(simd.splat(min), min_others),
            HALF_SIZES => simd.distance(simd.splat(min), min_others),
            _ => lanes::gap(simd, [min, max], [min_others, max_others]),
        };
        simd.sub(gap, simd.add(simd.splat(half), half_others))
    }

    /// [`overlap`](crate::geometry::overlap) in every lane. For points the signs of the gaps have
    /// no effect.
    #[inline(always)]
    fn overlap<const CORE: u8>(&self, dx: S::Block, dy: S::Block, radius_sum: S::Block) -> u32 {
        match CORE {
            POINTS => lanes::discs_overlap(self.simd, [dx, dy], radius_sum),
            HALF_SIZES => lanes::overlap_by_centers(self.simd, [dx, dy], radius_sum),
            // The gap between sides at −0 and 0 may be −0, which is touching.
            _ => lanes::overlap(self.simd, [dx, dy], radius_sum),
        }
    }

    #[inline(always)]
    fn load<const CORE: u8>(&self, rows: &Rows<'_, T>, start: usize) -> Loaded<S::Block> {
        let simd = self.simd;
        let zero = simd.splat(T::ZERO);
        let (x, y) = (simd.load(block(rows.x, start)), simd.load(block(rows.y, start)));
        let radius = simd.load(block(rows.radius, start));
        let mut loaded = Loaded { x, y, max_x: x, max_y: y, radius, half: [zero; 2] };
        if CORE == BOXES {
            loaded.max_x = simd.load(block(rows.max_x, start));
            loaded.max_y = simd.load(block(rows.max_y, start));
        }
        if CORE != POINTS && !rows.half_x.is_empty() {
            loaded.half =
                [simd.load(block(rows.half_x, start)), simd.load(block(rows.half_y, start))];
        }
        loaded
    }

    /// Tests at most [`MAX_ROW_HITS`] rows against those lanes of a block that `wanted` returns;
    /// returns the rows with overlaps. No branch depends on the results.
    #[inline(always)]
    fn test<'n, const CORE: u8>(
        &self,
        rows: &Rows<'_, T>,
        others: &Loaded<S::Block>,
        wanted: impl Fn(usize) -> u32,
        allowed: impl Fn(usize, u32) -> u32,
        row_hits: &'n mut RowHits,
    ) -> &'n [(u32, u32)] {
        let mut count = 0;
        let centers = rows.x.iter().zip(rows.y).zip(rows.radius);
        for (row, ((&x, &y), &radius)) in centers.enumerate() {
            let max = if CORE == BOXES { [rows.max_x[row], rows.max_y[row]] } else { [x, y] };
            let half = if CORE != POINTS && !rows.half_x.is_empty() {
                [rows.half_x[row], rows.half_y[row]]
            } else {
                [T::ZERO; 2]
            };
            let bits = self.hits::<CORE>([[x, y], max], half, radius, others) & wanted(row);
            // Written in any case, and overwritten by the next row unless a bit is set. A branch on
            // `bits` would be predicted wrongly about as often as there are hits. The remainder is
            // the mask of a power of two, and spares the check of the index; there are at most that
            // many rows.
            row_hits[count % MAX_ROW_HITS] = (row as u32, bits);
            count += usize::from(bits != 0);
        }
        let has_filters = self.a.has_filters() || self.b.has_filters();
        let found = count.min(MAX_ROW_HITS);
        // Filters are applied to hits only: few pairs overlap, and filters agree in most scenes.
        if !has_filters || self.filters == Filters::Ignore {
            return &row_hits[..found];
        }
        count = 0;
        for entry in 0..found {
            let (row, bits) = row_hits[entry];
            let bits = allowed(row as usize, bits);
            row_hits[count] = (row, bits);
            count += usize::from(bits != 0);
        }
        &row_hits[..count]
    }

    /// Finds the overlapping pairs of one of `rows` and a later row of the same columns, up to
    /// `last`. Blocks are aligned to the end, so only the first one is not full,
    /// and that one is tested against the fewest rows.
    #[inline(always)]
    pub(super) fn self_block<const CORE: u8>(
        &self,
        rows: Range<usize>,
        last: usize,
        output: &mut Output<'_>,
    ) {
        let mut row_hits = [(0, 0); MAX_ROW_HITS];
        let mut end = last;
        while end > rows.start + 1 {
            let start = rows.start.max(end.saturating_sub(LANES));
            // Blocks end at `last` and go downwards. The block with fewer lanes is then the first
            // one, which is tested against the fewest rows.
            let lanes = first_lanes(end - start);
            let others = self.load::<CORE>(&Rows::all(self.b), start);
            let before = rows.end.min(end - 1);
            for first in (rows.start..before).step_by(CHUNK) {
                let chunk = Rows::of(self.a, first..before.min(first + CHUNK));
                let wanted = |row: usize| {
                    // Only later lanes: each pair is tested from its first shape. The shift is
                    // below 16; the minimum tells the compiler that it does not overflow.
                    lanes & u32::MAX << (first + row + 1).saturating_sub(start).min(31)
                };
                self.rows_with_block::<CORE>(
                    first,
                    &chunk,
                    start,
                    &others,
                    wanted,
                    &mut row_hits,
                    output,
                );
                if output.is_over(CHUNK * LANES) {
                    return;
                }
            }
            // Pairs, not lanes: the number that users see does not depend on the width of the
            // instructions.
            let tests = (start..end).map(|other| other.min(rows.end) - rows.start);
            output.tests += tests.sum::<usize>() as u64;
            end = start;
        }
    }

    /// Finds the overlapping pairs of one row with rows of `others`, in their order.
    #[inline(always)]
    pub(super) fn row_block<const CORE: u8>(
        &self,
        row: usize,
        others: Range<usize>,
        output: &mut Output<'_>,
    ) {
        output.tests += others.len() as u64;
        let mut row_hits = [(0, 0); MAX_ROW_HITS];
        let shape = self.a.shape(row);
        let [x, y] = [0, 1].map(|axis| [shape.min[axis] - self.shift[axis]]);
        let [max_x, max_y] = [0, 1].map(|axis| [shape.max[axis] - self.shift[axis]]);
        let [half_x, half_y] = shape.half_size.map(|half| [half]);
        let radius = [shape.radius];
        let alone = Rows {
            x: &x,
            y: &y,
            max_x: &max_x,
            max_y: &max_y,
            radius: &radius,
            half_x: &half_x,
            half_y: &half_y,
        };
        for start in others.clone().step_by(LANES) {
            let loaded = self.load::<CORE>(&Rows::all(self.b), start);
            let lanes = first_lanes(others.end - start);
            self.rows_with_block::<CORE>(
                row,
                &alone,
                start,
                &loaded,
                |_| lanes,
                &mut row_hits,
                output,
            );
        }
    }

    /// Tests rows of `a` from `first` (at most [`CHUNK`]) against the block of `b` at `start`.
    #[allow(clippy::too_many_arguments, reason = "a part of two loops, inlined")]
    #[inline(always)]
    fn rows_with_block<const CORE: u8>(
        &self,
        first: usize,
        rows: &Rows<'_, T>,
        start: usize,
        others: &Loaded<S::Block>,
        wanted: impl Fn(usize) -> u32,
        row_hits: &mut RowHits,
        output: &mut Output<'_>,
    ) {
        let allowed = |row: usize, bits: u32| {
            allowed(&self.a.shape(first + row), self.b, |lane| start + lane, bits)
        };
        let found = self.test::<CORE>(rows, others, wanted, allowed, row_hits);
        let simd = self.simd;
        emit_pairs(
            found,
            output,
            #[inline(always)]
            |row, bits, to| simd.pair_with_indices((first + row) as u32, start as u32, bits, to),
        );
    }

    /// Finds the overlapping pairs within a leaf. The rows of each of its `strips` are tested
    /// against later rows up to the end of the last strip that they could overlap.
    #[inline(always)]
    pub(super) fn within_leaf<const CORE: u8>(
        &self,
        leaf: Range<usize>,
        strips: impl Iterator<Item = (Range<usize>, usize)>,
        output: &mut Output<'_>,
    ) {
        let simd = self.simd;
        let has_filters = self.a.has_filters() && self.filters == Filters::Apply;
        let window = Rows::of(self.a, leaf.start..leaf.end + SPARE);
        for (rows, last) in strips {
            // With more candidates than two blocks, a block that is loaded once for all rows takes
            // less time than a window that begins anew at each row.
            if last - rows.start > MAX_STRIP_ROWS {
                self.self_block::<CORE>(rows, last, output);
                continue;
            }
            // The same number of blocks for each row: the branch is predictable.
            let blocks = (last - rows.start).saturating_sub(1).div_ceil(LANES);
            // Reserved once for a strip, not in the innermost loop.
            let Some(spare) = output.spare(rows.len() * blocks * LANES) else { return };
            let mut count = 0;
            let mut tests = 0;
            for row in rows {
                let own = row - leaf.start;
                let [x, y] = [window.x[own], window.y[own]];
                let max =
                    if CORE == BOXES { [window.max_x[own], window.max_y[own]] } else { [x, y] };
                let half = if CORE != POINTS && !window.half_x.is_empty() {
                    [window.half_x[own], window.half_y[own]]
                } else {
                    [T::ZERO; 2]
                };
                tests += last - row - 1;
                for block in 0..blocks {
                    // Blocks begin after the row itself, not at multiples of sixteen: unaligned
                    // loads cost little, and no lane is spent on earlier rows.
                    let start = row + 1 + block * LANES;
                    let others = self.load::<CORE>(&window, start - leaf.start);
                    let bits = self.hits::<CORE>([[x, y], max], half, window.radius[own], &others);
                    let mut bits = bits & first_lanes(last.saturating_sub(start));
                    if has_filters {
                        bits = allowed(&self.a.shape(row), self.b, |lane| start + lane, bits);
                    }
                    let to = spare[count..].first_chunk_mut().expect("there is spare");
                    simd.pair_with_indices(row as u32, start as u32, bits, to);
                    count += bits.count_ones() as usize;
                }
            }
            output.tests += tests as u64;
            output.accept(count);
        }
    }
}

/// Writes the pairs of `row_hits` to the output; `pairs` writes those of one row.
#[inline(always)]
fn emit_pairs(
    row_hits: &[(u32, u32)],
    output: &mut Output<'_>,
    pairs: impl Fn(usize, u32, &mut [[u32; 2]; LANES]),
) {
    let Some(spare) = output.spare(row_hits.len() * LANES) else { return };
    let mut found = 0;
    for &(row, bits) in row_hits {
        let to = spare[found..].first_chunk_mut().expect("there is spare");
        pairs(row as usize, bits, to);
        found += bits.count_ones() as usize;
    }
    output.accept(found);
}

/// Those of the `bits` whose shapes may pair with `shape`.
#[inline(always)]
fn allowed<T: Scalar>(
    shape: &Shape<T>,
    others: &Columns<T>,
    row: impl Fn(usize) -> usize,
    bits: u32,
) -> u32 {
    let mut agreeing = 0;
    // Scalar code: it runs for hits of shapes with filters only.
    for_each_lane(bits, |lane| {
        let filter = if others.has_filters() {
            [others.category[row(lane)], others.mask[row(lane)]]
        } else {
            [DEFAULT_CATEGORY, DEFAULT_MASK]
        };
        agreeing |= u32::from(filters_agree([shape.category, shape.mask], filter)) << lane;
    });
    agreeing
}
