//! Some shapes against some others, a block at a time.
//!
//! A block's results are bits of a mask, and what they name is packed side by side
//! instead of being visited one by one: no branch depends on which shapes overlap.

use std::ops::Range;

use super::Filters;
use super::output::Output;
use crate::columns::{Columns, SPARE};
use crate::geometry::{Cover, Scalar, Shape};
use crate::shapes::{DEFAULT_CATEGORY, DEFAULT_MASK};
use crate::simd::{LANES, Simd, block, block_mut, first_lanes, for_each_lane};

/// Shapes that are packed at a time.
const CHUNK: usize = NOTES;

/// Rows tested against a block at a time.
const NOTES: usize = 64;

/// Strips that reach farther are tested block by block instead of row by row.
const NEAR: usize = 2 * LANES;

/// Two sets of shapes to be tested against each other, those of `a` moved by `-shift`.
pub(super) struct Kernel<'a, T, S> {
    pub(super) simd: S,
    pub(super) a: &'a Columns<T>,
    pub(super) b: &'a Columns<T>,
    pub(super) shift: [T; 2],
    pub(super) filters: Filters,
}

/// One side of a test of leaf against leaf.
pub(super) struct Side<'a, T> {
    pub(super) range: Range<usize>,
    pub(super) cover: &'a Cover<T>,
}

/// Memory for the shapes of two leaves that reach each other.
pub(super) struct Scratch<T> {
    packed: [Packed<T>; 2],
    notes: Notes,
}

/// Which of some rows overlaps which lanes of a block.
type Notes = [(u32, u32); NOTES];

/// A few shapes side by side.
struct Packed<T> {
    len: usize,
    x: [T; CHUNK + LANES],
    y: [T; CHUNK + LANES],
    max_x: [T; CHUNK + LANES],
    max_y: [T; CHUNK + LANES],
    radius: [T; CHUNK + LANES],
    half_x: [T; CHUNK + LANES],
    half_y: [T; CHUNK + LANES],
    place: [u32; CHUNK + LANES],
}

impl<T: Scalar> Default for Scratch<T> {
    fn default() -> Self {
        Self { packed: Default::default(), notes: [(0, 0); NOTES] }
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
            place: [0; CHUNK + LANES],
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

    /// The same with room for a block behind them.
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

/// Numbers of some shapes, as in [`Columns`]; half sizes may be empty.
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
    /// All rows of `columns`, spare ones too.
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

    /// Some of them.
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

/// Kinds of cores, as a parameter of the functions below, so that each kind is computed only
/// as far as necessary. Here: all cores are points.
const POINTS: u8 = 0;

/// All are given by their centres, some with half sizes.
const HALF_SIZES: u8 = 1;

/// Some are given as boxes.
const BOXES: u8 = 2;

/// Calls a method with the kind of the kernel's shapes as parameters.
macro_rules! of_kind {
    ($self:ident.$method:ident($($argument:expr),*)) => {
        match $self.core() {
            POINTS => $self.$method::<POINTS>($($argument),*),
            HALF_SIZES => $self.$method::<HALF_SIZES>($($argument),*),
            _ => $self.$method::<BOXES>($($argument),*),
        }
    };
}

impl<T: Scalar, S: Simd<T>> Kernel<'_, T, S> {
    /// Passes on every overlapping pair of one row each of two ranges.
    #[inline(always)]
    pub(super) fn leaves(
        &self,
        first: &Side<'_, T>,
        second: &Side<'_, T>,
        scratch: &mut Scratch<T>,
        output: &mut Output<'_>,
    ) {
        of_kind!(self.near(first, second, scratch, output))
    }

    /// Passes on every overlapping pair of one of `rows` and a row of the same columns
    /// behind it, up to `last`.
    #[inline(always)]
    pub(super) fn itself(&self, rows: Range<usize>, last: usize, output: &mut Output<'_>) {
        of_kind!(self.behind(rows, last, output))
    }

    /// Passes on the pairs of one row with rows of `others`, in their order.
    #[inline(always)]
    pub(super) fn row(&self, row: usize, others: Range<usize>, output: &mut Output<'_>) {
        of_kind!(self.along(row, others, output))
    }

    /// What the cores of the shapes are.
    #[inline(always)]
    fn core(&self) -> u8 {
        if self.a.has_boxes() || self.b.has_boxes() {
            BOXES
        } else if self.a.has_half_sizes() || self.b.has_half_sizes() {
            HALF_SIZES
        } else {
            POINTS
        }
    }

    /// Leaf against leaf: only what reaches the other's cover is tested.
    #[inline(always)]
    fn near<const CORE: u8>(
        &self,
        first: &Side<'_, T>,
        second: &Side<'_, T>,
        scratch: &mut Scratch<T>,
        output: &mut Output<'_>,
    ) {
        let Scratch { packed: [near_a, near_b], notes } = scratch;
        let shift = self.shift;
        let cover_a = first.cover.moved(shift);
        for start in first.range.clone().step_by(CHUNK) {
            let rows = start..first.range.end.min(start + CHUNK);
            self.pack::<CORE>(self.a, rows, shift, second.cover, near_a);
            if near_a.len == 0 {
                continue;
            }
            for start in second.range.clone().step_by(CHUNK) {
                let rows = start..second.range.end.min(start + CHUNK);
                self.pack::<CORE>(self.b, rows, [T::ZERO; 2], &cover_a, near_b);
                if near_b.len > 0 {
                    self.packed::<CORE>(near_a, near_b, notes, output);
                }
                if output.is_over(near_a.len * (1 + near_b.len)) {
                    return;
                }
            }
        }
    }

    /// Everything packed in `near_a` against everything packed in `near_b`.
    #[inline(always)]
    fn packed<const CORE: u8>(
        &self,
        near_a: &Packed<T>,
        near_b: &Packed<T>,
        notes: &mut Notes,
        output: &mut Output<'_>,
    ) {
        output.tests += (near_a.len * near_b.len) as u64;
        let rows = near_a.rows();
        for start in (0..near_b.len.min(CHUNK)).step_by(LANES) {
            let others = self.load::<CORE>(&near_b.padded(), start);
            let lanes = first_lanes(near_b.len - start);
            let places = block(&near_b.place, start);
            let allowed = |row: usize, bits: u32| {
                let shape = self.a.shape(near_a.place[row] as usize);
                allowed(&shape, self.b, |lane| places[lane] as usize, bits)
            };
            let wanted = |_: usize| lanes;
            let found = self.test::<CORE>(&rows, &others, wanted, allowed, notes);
            let simd = self.simd;
            settle(found, output, |row, bits, to| {
                simd.pair_with(near_a.place[row], places, bits, to);
            });
        }
    }

    /// Packs the `rows` (at most [`CHUNK`]) that, moved by `-shift`, could overlap
    /// something under `cover`. Filters are left to the pairs themselves.
    #[inline(always)]
    fn pack<const CORE: u8>(
        &self,
        columns: &Columns<T>,
        rows: Range<usize>,
        shift: [T; 2],
        cover: &Cover<T>,
        to: &mut Packed<T>,
    ) {
        let simd = self.simd;
        to.len = 0;
        for start in rows.clone().step_by(LANES) {
            let mut shapes = self.load::<CORE>(&Rows::all(columns), start);
            shapes.x = simd.sub(shapes.x, simd.splat(shift[0]));
            shapes.y = simd.sub(shapes.y, simd.splat(shift[1]));
            if CORE == BOXES {
                shapes.max_x = simd.sub(shapes.max_x, simd.splat(shift[0]));
                shapes.max_y = simd.sub(shapes.max_y, simd.splat(shift[1]));
            } else {
                [shapes.max_x, shapes.max_y] = [shapes.x, shapes.y];
            }
            let bits = self.reaching::<CORE>(&shapes, cover) & first_lanes(rows.end - start);
            let end = to.len.min(CHUNK);
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
            simd.pack_places(start as u32, bits, block_mut(&mut to.place, end));
            to.len = end + bits.count_ones() as usize;
        }
    }

    /// A bit for each shape of a block that could overlap something under `cover`.
    #[inline(always)]
    fn reaching<const CORE: u8>(&self, shapes: &Loaded<S::Block>, cover: &Cover<T>) -> u32 {
        let dx = self.beyond::<CORE>([shapes.x, shapes.max_x], shapes.half[0], cover, 0);
        let dy = self.beyond::<CORE>([shapes.y, shapes.max_y], shapes.half[1], cover, 1);
        let reach = self.simd.add(shapes.radius, self.simd.splat(cover.radius));
        self.overlap::<CORE>(dx, dy, reach)
    }

    /// How far each shape of a block lies beyond a cover along an axis, at least.
    #[inline(always)]
    fn beyond<const CORE: u8>(
        &self,
        [min, max]: [S::Block; 2],
        half: S::Block,
        cover: &Cover<T>,
        axis: usize,
    ) -> S::Block {
        let simd = self.simd;
        let below = simd.sub(simd.splat(cover.min[axis]), max);
        let above = simd.sub(min, simd.splat(cover.max[axis]));
        let mut gap = simd.most(below, above);
        if CORE != BOXES {
            // The distance of two centres is never negative.
            gap = simd.most(gap, simd.splat(T::ZERO));
        }
        if CORE == POINTS {
            return gap;
        }
        simd.sub(gap, simd.add(half, simd.splat(cover.half_size[axis])))
    }

    /// A bit for each of the block's shapes that overlaps the one given.
    #[inline(always)]
    fn hits<const CORE: u8>(
        &self,
        [min, max]: [[T; 2]; 2],
        half: [T; 2],
        radius: T,
        others: &Loaded<S::Block>,
    ) -> u32 {
        let (x, y) = ([others.x, others.max_x], [others.y, others.max_y]);
        let dx = self.apart::<CORE>([min[0], max[0]], x, half[0], others.half[0]);
        let dy = self.apart::<CORE>([min[1], max[1]], y, half[1], others.half[1]);
        let reach = self.simd.add(self.simd.splat(radius), others.radius);
        self.overlap::<CORE>(dx, dy, reach)
    }

    /// Gap between the cores along an axis; for points only its square is
    /// meaningful.
    #[inline(always)]
    fn apart<const CORE: u8>(
        &self,
        [min, max]: [T; 2],
        [min_others, max_others]: [S::Block; 2],
        half: T,
        half_others: S::Block,
    ) -> S::Block {
        let simd = self.simd;
        let min = simd.splat(min);
        let gap = match CORE {
            POINTS => return simd.sub(min, min_others),
            HALF_SIZES => simd.distance(min, min_others),
            _ => simd.most(simd.sub(min_others, simd.splat(max)), simd.sub(min, max_others)),
        };
        simd.sub(gap, simd.add(simd.splat(half), half_others))
    }

    /// The overlap formula ([`overlap`](crate::geometry::overlap)) in every lane. For points
    /// the signs of the distances have no effect.
    #[inline(always)]
    fn overlap<const CORE: u8>(&self, dx: S::Block, dy: S::Block, reach: S::Block) -> u32 {
        let simd = self.simd;
        let zero = simd.splat(T::ZERO);
        let reach = simd.mul(reach, reach);
        if CORE == POINTS {
            return simd.less(simd.add(simd.mul(dx, dx), simd.mul(dy, dy)), reach);
        }
        let (ex, ey) = (simd.most(dx, zero), simd.most(dy, zero));
        let round = simd.less(simd.add(simd.mul(ex, ex), simd.mul(ey, ey)), reach);
        if CORE == BOXES {
            // Sides at −0 and 0 touch, and may be −0 apart.
            return round | (simd.less(dx, zero) & simd.less(dy, zero));
        }
        round | simd.both_negative(dx, dy)
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

    /// Tests at most [`NOTES`] rows against a block and notes what overlaps, as far as
    /// `wanted` has the lane; returns the notes. Nothing branches on them.
    #[inline(always)]
    fn test<'n, const CORE: u8>(
        &self,
        rows: &Rows<'_, T>,
        others: &Loaded<S::Block>,
        wanted: impl Fn(usize) -> u32,
        allowed: impl Fn(usize, u32) -> u32,
        notes: &'n mut Notes,
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
            notes[count % NOTES] = (row as u32, bits);
            count += usize::from(bits != 0);
        }
        let has_filters = self.a.has_filters() || self.b.has_filters();
        let found = count.min(NOTES);
        if !has_filters || self.filters == Filters::Ignore {
            return &notes[..found];
        }
        count = 0;
        for note in 0..found {
            let (row, bits) = notes[note];
            let bits = allowed(row as usize, bits);
            notes[count] = (row, bits);
            count += usize::from(bits != 0);
        }
        &notes[..count]
    }

    /// Every one of `rows` with all behind it up to `last`. Blocks are counted from the
    /// end, so that only the foremost is not full, and that one meets the fewest rows.
    #[inline(always)]
    fn behind<const CORE: u8>(&self, rows: Range<usize>, last: usize, output: &mut Output<'_>) {
        let mut notes = [(0, 0); NOTES];
        let mut end = last;
        while end > rows.start + 1 {
            let start = rows.start.max(end.saturating_sub(LANES));
            let lanes = first_lanes(end - start);
            let others = self.load::<CORE>(&Rows::all(self.b), start);
            let before = rows.end.min(end - 1);
            for first in (rows.start..before).step_by(CHUNK) {
                let some = Rows::of(self.a, first..before.min(first + CHUNK));
                let wanted = |row: usize| {
                    lanes & u32::MAX << (first + row + 1).saturating_sub(start).min(31)
                };
                self.against::<CORE>(first, &some, start, &others, wanted, &mut notes, output);
                if output.is_over(CHUNK * LANES) {
                    return;
                }
            }
            let tests = (start..end).map(|other| other.min(rows.end) - rows.start);
            output.tests += tests.sum::<usize>() as u64;
            end = start;
        }
    }

    /// One row against some others in their order.
    #[inline(always)]
    fn along<const CORE: u8>(&self, row: usize, others: Range<usize>, output: &mut Output<'_>) {
        output.tests += others.len() as u64;
        let mut notes = [(0, 0); NOTES];
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
            self.against::<CORE>(row, &alone, start, &loaded, |_| lanes, &mut notes, output);
        }
    }

    /// The rows of `a` from `first` (at most [`CHUNK`]) against the block of `b` at `start`.
    #[allow(clippy::too_many_arguments, reason = "a part of two loops, inlined")]
    #[inline(always)]
    fn against<const CORE: u8>(
        &self,
        first: usize,
        rows: &Rows<'_, T>,
        start: usize,
        others: &Loaded<S::Block>,
        wanted: impl Fn(usize) -> u32,
        notes: &mut Notes,
        output: &mut Output<'_>,
    ) {
        let allowed = |row: usize, bits: u32| {
            allowed(&self.a.shape(first + row), self.b, |lane| start + lane, bits)
        };
        let found = self.test::<CORE>(rows, others, wanted, allowed, notes);
        let simd = self.simd;
        settle(found, output, |row, bits, to| {
            simd.pair_with_places((first + row) as u32, start as u32, bits, to);
        });
    }

    /// Passes on every overlapping pair of a leaf's rows. Those of each of its `strips` are tested
    /// against those behind them up to the end of the last strip that they can reach.
    #[inline(always)]
    pub(super) fn within_leaf(
        &self,
        leaf: Range<usize>,
        strips: impl Iterator<Item = (Range<usize>, usize)>,
        output: &mut Output<'_>,
    ) {
        of_kind!(self.strips(leaf, strips, output))
    }

    #[inline(always)]
    fn strips<const CORE: u8>(
        &self,
        leaf: Range<usize>,
        strips: impl Iterator<Item = (Range<usize>, usize)>,
        output: &mut Output<'_>,
    ) {
        let simd = self.simd;
        let has_filters = self.a.has_filters() && self.filters == Filters::Apply;
        let window = Rows::of(self.a, leaf.start..leaf.end + SPARE);
        for (rows, last) in strips {
            if last - rows.start > NEAR {
                self.behind::<CORE>(rows, last, output);
                continue;
            }
            // As many for each row, which the processor can predict.
            let blocks = (last - rows.start).saturating_sub(1).div_ceil(LANES);
            let Some(room) = output.room(rows.len() * blocks * LANES) else { return };
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
                    let start = row + 1 + block * LANES;
                    let others = self.load::<CORE>(&window, start - leaf.start);
                    let bits = self.hits::<CORE>([[x, y], max], half, window.radius[own], &others);
                    let mut bits = bits & first_lanes(last.saturating_sub(start));
                    if has_filters {
                        bits = allowed(&self.a.shape(row), self.b, |lane| start + lane, bits);
                    }
                    let to = room[count..].first_chunk_mut().expect("there is room");
                    simd.pair_with_places(row as u32, start as u32, bits, to);
                    count += bits.count_ones() as usize;
                }
            }
            output.tests += tests as u64;
            output.accept(count);
        }
    }
}

/// Makes pairs of the notes by `pairs`, from the row and the bits.
#[inline(always)]
fn settle(
    notes: &[(u32, u32)],
    output: &mut Output<'_>,
    pairs: impl Fn(usize, u32, &mut [[u32; 2]; LANES]),
) {
    let Some(room) = output.room(notes.len() * LANES) else { return };
    let mut found = 0;
    for &(row, bits) in notes {
        let to = room[found..].first_chunk_mut().expect("there is room");
        pairs(row as usize, bits, to);
        found += bits.count_ones() as usize;
    }
    output.accept(found);
}

/// Those of the `bits` whose row has a filter that agrees with the shape's.
#[inline(always)]
fn allowed<T: Scalar>(
    shape: &Shape<T>,
    others: &Columns<T>,
    row: impl Fn(usize) -> usize,
    bits: u32,
) -> u32 {
    let mut agreeing = 0;
    for_each_lane(bits, |lane| {
        let (category, mask) = if others.has_filters() {
            (others.category[row(lane)], others.mask[row(lane)])
        } else {
            (DEFAULT_CATEGORY, DEFAULT_MASK)
        };
        let agree = (shape.category & mask) != 0 && (category & shape.mask) != 0;
        agreeing |= u32::from(agree) << lane;
    });
    agreeing
}
