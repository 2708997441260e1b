//! The window of a region: bounds that are tested against nodes and blocks of shapes.

use crate::columns::Columns;
use crate::geometry::{Bounds, Core, Scalar, Shape, gaps, lanes, middle, overlap, square_of_gaps};
use jostle_simd::{Simd, block};

/// The bounds of a [`Region`](super::Region): all points within `radius` of the rectangle from `min`
/// to `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window<T> {
    /// Lower corner of the rectangle.
    pub min: [T; 2],
    /// Upper corner.
    pub max: [T; 2],
    /// The distance, at least 0.
    pub radius: T,
}

impl<T: Scalar> Window<T> {
    /// The window of bounds whose half sizes are 0.
    pub(super) fn around(region: &Bounds<T>) -> Self {
        debug_assert!(region.half_size == [T::ZERO; 2]);
        Self { min: region.min, max: region.max, radius: region.radius }
    }

    /// The window as a shape.
    #[inline(always)]
    pub(super) fn shape(&self) -> Shape<T> {
        let Self { min, max, radius } = *self;
        let (half_size, core) = ([T::ZERO; 2], Core::Box);
        Shape { min, max, half_size, radius, category: u32::MAX, mask: u32::MAX, core }
    }

    /// The middle of the window.
    pub(super) fn center(&self) -> [T; 2] {
        [0, 1].map(|axis| middle(self.min[axis], self.max[axis]))
    }

    /// The same window moved by `-shift`.
    pub(super) fn moved(&self, shift: [T; 2]) -> Self {
        let by = |v: [T; 2]| [v[0] - shift[0], v[1] - shift[1]];
        Self { min: by(self.min), max: by(self.max), ..*self }
    }

    /// The gaps between the core of a shape and the window along each axis; negative inside.
    #[inline(always)]
    pub(super) fn gaps(&self, shape: &Shape<T>) -> [T; 2] {
        gaps([self.min, self.max], [shape.min, shape.max], shape.half_size)
    }

    /// The bounds of both windows.
    pub(super) fn join(self, other: Self) -> Self {
        let both = |f: fn(T, T) -> T, a: [T; 2], b: [T; 2]| [f(a[0], b[0]), f(a[1], b[1])];
        Self {
            min: both(T::min, self.min, other.min),
            max: both(T::max, self.max, other.max),
            radius: self.radius.max(other.radius),
        }
    }

    /// Whether a shape within `bounds` could touch the window.
    #[inline(always)]
    pub(super) fn may_touch(&self, bounds: &Bounds<T>) -> bool {
        let radius_sum = self.radius + bounds.radius;
        // At most, not below: some regions contain their edge.
        square_of_gaps(bounds.gaps_to(self.min, self.max)) <= radius_sum * radius_sum
    }

    /// Whether every shape within `bounds` overlaps the window, whatever its size.
    #[inline(always)]
    pub(super) fn contains(&self, bounds: &Bounds<T>) -> bool {
        let beyond = |axis: usize| {
            (self.min[axis] - bounds.min[axis]).max(bounds.max[axis] - self.max[axis])
        };
        // The centre of the farthest corner overlaps the window as a point would. A shape around a
        // centre inside overlaps even more, since rounding is monotone in the sizes, too.
        overlap([beyond(0), beyond(1)], self.radius)
    }

    /// A bit for each shape of a block that overlaps the window; if it is not `exact`, for each
    /// shape that could touch the region within it.
    #[inline(always)]
    pub(super) fn lanes<S: Simd<T>>(
        &self,
        simd: S,
        shapes: &Columns<T>,
        first: usize,
        (round, exact): (bool, bool),
    ) -> u32 {
        let dx = self.core_gap_lanes(simd, 0, [&shapes.x, shapes.max_x(), &shapes.half_x], first);
        let dy = self.core_gap_lanes(simd, 1, [&shapes.y, shapes.max_y(), &shapes.half_y], first);
        let mut radius_sum = simd.splat(self.radius);
        if round {
            radius_sum = simd.add(radius_sum, simd.load(block(&shapes.radius, first)));
        }
        if exact {
            // The window is the region, so this block test is the exact test, with the same bits.
            lanes::overlap(simd, [dx, dy], radius_sum)
        } else {
            lanes::may_touch(simd, [dx, dy], radius_sum)
        }
    }

    /// [`Window::gaps`] of the shapes of a block, along one axis.
    #[inline(always)]
    fn core_gap_lanes<S: Simd<T>>(
        &self,
        simd: S,
        axis: usize,
        [min, max, half_sizes]: [&[T]; 3],
        first: usize,
    ) -> S::Block {
        let corners = [simd.load(block(min, first)), simd.load(block(max, first))];
        let gap = self.gap_lanes(simd, axis, corners);
        if half_sizes.is_empty() {
            return gap;
        }
        simd.sub(gap, simd.load(block(half_sizes, first)))
    }

    /// The gaps between the window and the intervals of a block, along one axis.
    #[inline(always)]
    pub(super) fn gap_lanes<S: Simd<T>>(
        &self,
        simd: S,
        axis: usize,
        corners: [S::Block; 2],
    ) -> S::Block {
        lanes::gap(simd, [self.min[axis], self.max[axis]], corners)
    }
}
