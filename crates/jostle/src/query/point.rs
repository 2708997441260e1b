//! Single points: which shapes are under the cursor?

use super::region::Region;
use super::window::Window;
use crate::error::Result;
use crate::geometry::{Scalar, Shape};
use crate::memory;
use crate::shapes::check_finite;

/// A point, inside a shape also on its edge; of a rectangle the left and the upper
/// edge count as inside and the right and the lower do not, so that tiles which share
/// an edge share no point.
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
    const PLAIN: bool = false;

    #[inline(always)]
    fn window(&self) -> Window<T> {
        Window { min: self.0, max: self.0, radius: T::ZERO }
    }

    #[inline(always)]
    fn touches(&self, shape: &Shape<T>) -> bool {
        let [ox, oy] = [self.0[0] - shape.center[0], self.0[1] - shape.center[1]];
        let [hx, hy] = shape.half_size;
        if shape.radius == T::ZERO && (hx > T::ZERO || hy > T::ZERO) {
            return (ox >= -hx) & (ox < hx) & (oy >= -hy) & (oy < hy);
        }
        let (x, y) = ((ox.abs() - hx).most(T::ZERO), (oy.abs() - hy).most(T::ZERO));
        x * x + y * y <= shape.radius * shape.radius
    }
}
