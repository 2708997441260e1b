//! Axis-aligned rectangles.

use super::region::Region;
use super::window::Window;
use crate::error::Result;
use crate::geometry::{Scalar, Shape};
use crate::memory;
use crate::shapes::{check_rects, corners};

/// A rectangle; what only touches its border does not overlap it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect<T> {
    min: [T; 2],
    max: [T; 2],
}

impl<T: Scalar> Rect<T> {
    /// Rectangles from `[min_x, min_y, max_x, max_y]` each.
    pub fn all(rows: &[[T; 4]]) -> Result<Vec<Self>> {
        check_rects("rect", rows)?;
        let rect = |row: &[T; 4]| {
            let [min, max] = corners(row);
            Self { min, max }
        };
        memory::collect(rows.iter().map(rect))
    }
}

impl<T: Scalar> Region<T> for Rect<T> {
    const PLAIN: bool = true;

    #[inline(always)]
    fn window(&self) -> Window<T> {
        Window { min: self.min, max: self.max, radius: T::ZERO }
    }

    /// The rule of [`overlap`](crate::geometry::overlap), with the distances from the
    /// rectangle's sides in place of its centre and half size, which would be rounded.
    #[inline(always)]
    fn touches(&self, shape: &Shape<T>) -> bool {
        let [dx, dy] = self.window().gap(shape);
        let (x, y) = (dx.most(T::ZERO), dy.most(T::ZERO));
        (x * x + y * y < shape.radius * shape.radius) | ((dx < T::ZERO) & (dy < T::ZERO))
    }
}
