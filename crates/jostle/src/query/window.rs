//! The bounds of a region, for tests against nodes and blocks of shapes.

use crate::columns::Columns;
use crate::geometry::{Cover, Scalar, Shape, gap};
use crate::simd::{Simd, block};

/// A rectangle and a distance from it: what lies beyond touches nothing in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window<T> {
    pub(super) min: [T; 2],
    pub(super) max: [T; 2],
    pub(super) radius: T,
}

impl<T: Scalar> Window<T> {
    /// The window of a region without half sizes.
    pub(super) fn around(region: &Cover<T>) -> Self {
        debug_assert!(region.half_size == [T::ZERO; 2]);
        Self { min: region.min, max: region.max, radius: region.radius }
    }

    /// Gap between the core of a shape and the window along each axis; negative inside.
    #[inline(always)]
    pub(super) fn gap(&self, shape: &Shape<T>) -> [T; 2] {
        let along = |axis: usize| {
            let own = [self.min[axis], self.max[axis]];
            gap(own, [shape.min[axis], shape.max[axis]]) - shape.half_size[axis]
        };
        [along(0), along(1)]
    }

    /// What holds both.
    pub(super) fn join(self, other: Self) -> Self {
        let both = |f: fn(T, T) -> T, a: [T; 2], b: [T; 2]| [f(a[0], b[0]), f(a[1], b[1])];
        Self {
            min: both(T::least, self.min, other.min),
            max: both(T::most, self.max, other.max),
            radius: self.radius.most(other.radius),
        }
    }

    /// Whether some shape of `cover` could touch it.
    #[inline(always)]
    pub(super) fn meets(&self, cover: &Cover<T>) -> bool {
        let beyond = |axis: usize| {
            let below = self.min[axis] - cover.max[axis];
            let above = cover.min[axis] - self.max[axis];
            (below.most(above) - cover.half_size[axis]).most(T::ZERO)
        };
        let (x, y) = (beyond(0), beyond(1));
        let reach = self.radius + cover.radius;
        x * x + y * y <= reach * reach
    }

    /// Whether every shape with its `min` and `max` in `cover` overlaps it, however small.
    #[inline(always)]
    pub(super) fn holds(&self, cover: &Cover<T>) -> bool {
        let beyond =
            |axis: usize| (self.min[axis] - cover.min[axis]).most(cover.max[axis] - self.max[axis]);
        let (dx, dy) = (beyond(0), beyond(1));
        let (x, y) = (dx.most(T::ZERO), dy.most(T::ZERO));
        (x * x + y * y < self.radius * self.radius) | ((dx < T::ZERO) & (dy < T::ZERO))
    }

    /// A bit for each shape of a block that overlaps it; where it is not `plain`, for each
    /// that could touch what it is around.
    #[inline(always)]
    pub(super) fn lanes<S: Simd<T>>(
        &self,
        simd: S,
        shapes: &Columns<T>,
        first: usize,
        (round, plain): (bool, bool),
    ) -> u32 {
        let zero = simd.splat(T::ZERO);
        let dx = self.gaps(simd, 0, [&shapes.x, shapes.max_x(), &shapes.half_x], first);
        let dy = self.gaps(simd, 1, [&shapes.y, shapes.max_y(), &shapes.half_y], first);
        let (x, y) = (simd.most(dx, zero), simd.most(dy, zero));
        let mut reach = simd.splat(self.radius);
        if round {
            reach = simd.add(reach, simd.load(block(&shapes.radius, first)));
        }
        let (reach, away) = (simd.mul(reach, reach), simd.add(simd.mul(x, x), simd.mul(y, y)));
        if plain {
            simd.less(away, reach) | (simd.less(dx, zero) & simd.less(dy, zero))
        } else {
            !simd.less(reach, away)
        }
    }

    /// [`Window::gap`] for the shapes of a block, along one axis.
    #[inline(always)]
    fn gaps<S: Simd<T>>(
        &self,
        simd: S,
        axis: usize,
        [min, max, half_sizes]: [&[T]; 3],
        first: usize,
    ) -> S::Block {
        let below = simd.sub(simd.splat(self.min[axis]), simd.load(block(max, first)));
        let above = simd.sub(simd.load(block(min, first)), simd.splat(self.max[axis]));
        let gap = simd.most(below, above);
        if half_sizes.is_empty() {
            return gap;
        }
        simd.sub(gap, simd.load(block(half_sizes, first)))
    }
}
