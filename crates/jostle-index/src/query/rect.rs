//! Queries for the shapes that overlap an axis-aligned rectangle.

use super::region::Region;
use super::window::Window;
use crate::geometry::{Scalar, Shape, cores_overlap, overlap};
use crate::shapes::{check_rects, corners};
use jostle_base::error::Result;
use jostle_base::memory;

/// A rectangle. Shapes that only touch it do not overlap it.
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
    const WINDOW_IS_EXACT: bool = true;

    #[inline(always)]
    fn window(&self) -> Window<T> {
        Window { min: self.min, max: self.max, radius: T::ZERO }
    }

    /// The gaps are computed from the sides of the rectangle, because its centre and half size
    /// would be rounded.
    #[inline(always)]
    fn overlaps(&self, shape: &Shape<T>) -> bool {
        overlap(self.window().gaps(shape), shape.radius)
            && cores_overlap(&self.window().shape(), shape)
    }

    fn moved(&self, shift: [T; 2]) -> Self {
        let Window { min, max, .. } = self.window().moved(shift);
        Self { min, max }
    }
}
