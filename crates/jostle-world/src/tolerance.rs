//! Lengths that count as nothing: one rule for all of them.
//!
//! A tolerance is a share of the smaller of two bodies, or of the rounding of positions at the
//! place where they meet. It is never a share of the larger body: a small disc would then sink into
//! a large one. A gap is computed from the difference of the exact positions, in float64, before
//! anything is rounded: the difference of two rounded lengths has an error of the size of the
//! larger body.

use crate::trajectory::Vector;

/// Relative size of the rounding of positions in float32, with a reserve for sums.
pub const ROUNDING: f64 = 1.0 / (1 << 22) as f64;

/// Relative size of the rounding of positions with residuals, with a reserve for sums.
pub const PRECISION: f64 = ROUNDING / (1 << 26) as f64;

/// The rounding counts as at most this share of the size, which matters far from the origin, where
/// float32 is coarse.
pub const COARSE: f64 = 1e-3;

/// Contacts of two discs whose size is a smaller share of the sum of the radii are computed in
/// float64. In float32 the error of a gap is about 10⁻⁷ of the sum of the radii.
const UNEVEN: f32 = 1.0 / 32.0;

/// The size of two discs: the smaller diameter. A point has none, so that of the other counts.
#[inline(always)]
pub fn size_of(a: f32, b: f32) -> f32 {
    // With the size 0 of a point all tolerances would be the rounding alone, also near a large
    // disc.
    let smaller = if a.min(b) > 0.0 { a.min(b) } else { a.max(b) };
    2.0 * smaller
}

/// Whether the radii of two discs are so different that float32 is too coarse for their gap.
#[inline(always)]
pub fn are_uneven(size: f32, contact_distance: f32) -> bool {
    // In float32 the error of a gap is about 10⁻⁷ of the sum of radii. With the limit of 1/32 that
    // is 3 · 10⁻⁶ of the size, far below the slop of position correction.
    size < UNEVEN * contact_distance
}

/// Unit vector from the first centre to the second, and the gap between two surfaces. `offset` is
/// the difference of the exact positions. Coincident centres have no unit vector.
#[inline(always)]
pub fn gap(offset: Vector, contact_distance: f64) -> (Option<Vector>, f64) {
    // A square root is rounded correctly by IEEE 754 on each machine; the function `hypot` is not.
    let length = (offset[0] * offset[0] + offset[1] * offset[1]).sqrt();
    let normal = (length > 0.0 && length < f64::INFINITY).then(|| offset.map(|v| v / length));
    (normal, length - contact_distance)
}

/// The lengths that count as nothing where bodies of a size meet at a place.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    size: f64,
    /// Rounding of positions to float32.
    coarse: f64,
    /// Rounding of positions with residuals.
    precise: f64,
}

impl Tolerance {
    /// That of bodies of a size at a place.
    #[inline(always)]
    pub fn of(size: f64, [x, y]: Vector) -> Self {
        // The sum bounds each coordinate and each offset of the two bodies, and is above 0 wherever
        // they are.
        let largest = x.abs() + y.abs() + size;
        Self { size, coarse: ROUNDING * largest, precise: PRECISION * largest }
    }

    /// The size of the bodies.
    #[inline(always)]
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Gap up to which surfaces count as touching: the rounding of float32.
    #[inline(always)]
    pub fn rounding(&self) -> f64 {
        // A point has no size to limit the rounding by.
        if self.size > 0.0 { self.at_most(COARSE) } else { self.coarse }
    }

    /// A share of the size, but not more than the rounding of float32, and not less than that of
    /// positions with residuals.
    #[inline(always)]
    pub fn at_most(&self, share: f64) -> f64 {
        // The lower limit is what positions with residuals can resolve. A smaller tolerance would
        // ask for a difference that no position can have.
        self.coarse.min((share * self.size).max(self.precise))
    }
}
