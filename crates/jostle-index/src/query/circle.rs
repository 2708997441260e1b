//! Queries for the shapes that overlap a disc.

use super::region::Region;
use super::window::Window;
use crate::geometry::{Scalar, Shape, cores_overlap, overlap};
use crate::period::Period;
use crate::shapes::{Each, check_finite, check_radii};
use jostle_base::error::Result;
use jostle_base::memory;

/// A disc. Shapes that only touch it do not overlap it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle<T> {
    center: [T; 2],
    radius: T,
}

impl<T: Scalar> Circle<T> {
    /// Discs from centres and radii: one for each row of either argument, or one.
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
    const WINDOW_IS_EXACT: bool = true;

    #[inline(always)]
    fn window(&self) -> Window<T> {
        Window { min: self.center, max: self.center, radius: self.radius }
    }

    #[inline(always)]
    fn overlaps(&self, shape: &Shape<T>) -> bool {
        overlap(shape.gaps_to(self.center), shape.radius + self.radius)
            && cores_overlap(&self.window().shape(), shape)
    }

    fn moved(&self, shift: [T; 2]) -> Self {
        Self { center: self.window().moved(shift).min, ..*self }
    }

    fn wrapped(&self, period: &Period<T>) -> Self {
        Self { center: period.wrap(self.center), ..*self }
    }
}
