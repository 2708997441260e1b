//! Discs.

use super::region::Region;
use super::window::Window;
use crate::error::Result;
use crate::geometry::{Scalar, Shape, overlap};
use crate::memory;
use crate::shapes::{Each, check_finite, check_radii};

/// A disc; what only touches its edge does not overlap it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle<T> {
    center: [T; 2],
    radius: T,
}

impl<T: Scalar> Circle<T> {
    /// Discs from centres and radii, as many as the one or the other has rows, or one.
    pub fn all(centers: &Each<[T; 2]>, radii: &Each<T>) -> Result<Vec<Self>> {
        let len = centers.len().or(radii.len()).unwrap_or(1);
        centers.check_len("center", len)?;
        radii.check_len("radius", len)?;
        centers.check(|centers| check_finite("center", centers))?;
        radii.check(|radii| check_radii("radius", radii))?;
        let circle = |row| Self { center: centers.at(row), radius: radii.at(row) };
        memory::collect((0..len).map(circle))
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
        overlap(shape.gap_to(self.center), shape.half_size, shape.radius + self.radius)
    }
}
