//! Axis-aligned rectangles.

use std::fmt::Display;

use super::region::Region;
use super::window::Window;
use crate::error::{Error, Result};
use crate::geometry::{Scalar, Shape};
use crate::memory;

/// A rectangle; what only touches its border does not overlap it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect<T> {
    min: [T; 2],
    max: [T; 2],
}

impl<T: Scalar> Rect<T> {
    /// Rectangles from `[min_x, min_y, max_x, max_y]` each.
    pub fn all(rows: &[[T; 4]]) -> Result<Vec<Self>> {
        let good = |[min_x, min_y, max_x, max_y]: &[T; 4]| {
            let finite = [min_x, min_y, max_x, max_y].iter().all(|v| v.is_finite());
            finite && min_x <= max_x && min_y <= max_y
        };
        if let Some(index) = rows.iter().position(|row| !good(row)) {
            let rule = if rows[index].iter().all(|v| v.is_finite()) {
                "it must be (min_x, min_y, max_x, max_y), no minimum above its maximum"
            } else {
                "all four numbers must be finite"
            };
            return Err(Error::at("rect", index, list(&rows[index]), rule));
        }
        let rect = |&[min_x, min_y, max_x, max_y]: &[T; 4]| Self {
            min: [min_x, min_y],
            max: [max_x, max_y],
        };
        memory::collect(rows.iter().map(rect))
    }
}

/// Numbers as Python writes a tuple of them.
pub(super) fn list(values: &[impl Display]) -> String {
    let values: Vec<String> = values.iter().map(ToString::to_string).collect();
    format!("({})", values.join(", "))
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
        let [dx, dy] = self.window().gap(shape.center, shape.half_size);
        let (x, y) = (dx.most(T::ZERO), dy.most(T::ZERO));
        (x * x + y * y < shape.radius * shape.radius) | ((dx < T::ZERO) & (dy < T::ZERO))
    }
}
