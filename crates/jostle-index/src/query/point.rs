//! Queries for the shapes that contain a point.

use super::region::Region;
use super::window::Window;
use crate::geometry::{Core, Difference, Scalar, Shape, within};
use crate::period::Period;
use crate::shapes::check_finite;
use jostle_base::error::Result;
use jostle_base::memory;

/// A point. Shapes contain their edge, except rectangles (radius 0): these contain their edges at the
/// smallest x and the smallest y, but not those at the largest, so that tiles with a common edge have
/// no common point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point<T>([T; 2]);

impl<T: Scalar> Point<T> {
    /// Points at `points`.
    pub fn all(points: &[[T; 2]]) -> Result<Vec<Self>> {
        check_finite("point", points)?;
        memory::collect(points.iter().map(|&point| Self(point)))
    }
}

impl<T: Scalar> Region<T> for Point<T> {
    const WINDOW_IS_EXACT: bool = false;

    #[inline(always)]
    fn window(&self) -> Window<T> {
        Window { min: self.0, max: self.0, radius: T::ZERO }
    }

    #[inline(always)]
    fn overlaps(&self, shape: &Shape<T>) -> bool {
        let half_size = shape.half_size;
        if shape.radius == T::ZERO && !shape.is_round() && shape.core == Core::Box {
            let inside = |axis: usize| {
                let (point, half) = (self.0[axis], half_size[axis]);
                // Differences, as everywhere in the core: `shape.min - half` is rounded, and a
                // point at exactly the edge would be inside or outside by chance.
                (point - shape.min[axis] >= -half) & (point - shape.max[axis] < half)
            };
            return inside(0) & inside(1);
        }
        let [x, y] = shape.gaps_to(self.0);
        within(x.max(T::ZERO), y.max(T::ZERO), shape.radius)
            && (!shape.is_slanted() || Difference::of(&self.window().shape(), shape).touches())
    }

    fn moved(&self, shift: [T; 2]) -> Self {
        Self(self.window().moved(shift).min)
    }

    fn wrapped(&self, period: &Period<T>) -> Self {
        Self(period.wrap(self.0))
    }
}
