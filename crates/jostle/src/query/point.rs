//! Single points: which shapes are under the cursor?

use super::region::Region;
use super::window::Window;
use crate::error::Result;
use crate::geometry::{Scalar, Shape, within};
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
        let half_size = shape.half_size;
        if shape.radius == T::ZERO && !shape.is_round() {
            let inside = |axis: usize| {
                let (point, half) = (self.0[axis], half_size[axis]);
                (point - shape.min[axis] >= -half) & (point - shape.max[axis] < half)
            };
            return inside(0) & inside(1);
        }
        let [gx, gy] = shape.gap_to(self.0);
        let (x, y) = ((gx - half_size[0]).most(T::ZERO), (gy - half_size[1]).most(T::ZERO));
        within(x, y, shape.radius)
    }
}
