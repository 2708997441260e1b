//! Discs.

use super::region::Region;
use super::window::Window;
use crate::error::Result;
use crate::geometry::{Scalar, Shape, overlap};
use crate::memory;
use crate::shapes::{Each, check_finite, check_sizes};

/// A disc; what only touches its edge does not overlap it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle<T> {
    center: [T; 2],
    radius: T,
}

impl<T: Scalar> Circle<T> {
    /// A disc around each centre.
    pub fn all(centers: &[[T; 2]], radii: &Each<T>) -> Result<Vec<Self>> {
        check_finite("center", centers)?;
        radii.check(|radii| check_sizes("radius", "a radius", radii))?;
        let circle = |(row, &center)| Self { center, radius: radii.at(row) };
        memory::collect(centers.iter().enumerate().map(circle))
    }
}

impl<T: Scalar> Region<T> for Circle<T> {
    const PLAIN: bool = true;

    #[inline(always)]
    fn window(&self) -> Window<T> {
        Window { min: self.center, max: self.center, radius: self.radius }
    }

    #[inline(always)]
    fn touches(&self, shape: &Shape<T>) -> bool {
        let away = |axis: usize| (shape.center[axis] - self.center[axis]).abs();
        overlap([away(0), away(1)], shape.half_size, shape.radius + self.radius)
    }
}
