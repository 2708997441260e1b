//! The arithmetic of shapes: float32 or float64, and lengths without overflow or underflow.

use std::cmp::Ordering;
use std::fmt::{Debug, Display, LowerExp};
use std::ops::Neg;

use jostle_simd::Number;

/// The arithmetic of a tree: `f32` or `f64`.
pub trait Scalar: Number + Debug + Display + LowerExp + Neg<Output = Self> {
    /// Zero.
    const ZERO: Self;
    /// One.
    const ONE: Self;
    /// Infinity.
    const INFINITY: Self;
    /// Not a number: no value.
    const NAN: Self;
    /// The largest half size. Sums of four are finite, so [`overlap`](super::overlap) never subtracts
    /// infinity from infinity.
    const MAX_SIZE: Self;
    /// The smallest radius above 0, and the largest: the square of the sum of two neither
    /// overflows nor loses precision.
    const RADII: [Self; 2];
    /// The difference between 1 and the next larger number.
    const EPSILON: Self;
    /// The smallest positive normal number: smaller squares lose precision.
    const SMALLEST_SQUARE: Self;
    /// Squares of numbers above the first may overflow, squares of numbers below the second may
    /// underflow. A division or a multiplication by the third, a power of two, prevents both
    /// without rounding.
    const RANGE: [Self; 3];
    /// The absolute value.
    fn abs(self) -> Self;
    /// The square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// Whether the value is neither infinite nor NaN.
    fn is_finite(self) -> bool;
    /// The value as a float64, exactly.
    fn to_f64(self) -> f64;
    /// The nearest value of this type.
    fn from_f64(value: f64) -> Self;
    /// One divided by the value.
    fn recip(self) -> Self;
    /// The remainder of a division, exact, with the sign of the value.
    fn remainder(self, divisor: Self) -> Self;
    /// The total order of IEEE 754, in which −0 precedes 0.
    fn total_order(&self, other: &Self) -> Ordering;
    /// The smaller of two numbers.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }
    /// The larger of two numbers.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
}

macro_rules! scalar {
    ($t:ty, $radii:expr, $range:expr) => {
        impl Scalar for $t {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const INFINITY: Self = <$t>::INFINITY;
            const NAN: Self = <$t>::NAN;
            const MAX_SIZE: Self = <$t>::MAX / 8.0;
            const RADII: [Self; 2] = $radii;
            const EPSILON: Self = <$t>::EPSILON;
            const SMALLEST_SQUARE: Self = <$t>::MIN_POSITIVE;
            const RANGE: [Self; 3] = $range;
            #[inline(always)]
            fn abs(self) -> Self {
                <$t>::abs(self)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                <$t>::sqrt(self)
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                <$t>::is_finite(self)
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as $t
            }
            #[inline(always)]
            fn total_order(&self, other: &Self) -> Ordering {
                self.total_cmp(other)
            }
            #[inline(always)]
            fn recip(self) -> Self {
                1.0 / self
            }
            #[inline(always)]
            fn remainder(self, divisor: Self) -> Self {
                self % divisor
            }
        }
    };
}
scalar!(f32, [1e-18, 1e18], [two_to(50) as f32, two_to(-50) as f32, two_to(90) as f32]);
scalar!(f64, [1e-150, 1e150], [two_to(500), two_to(-500), two_to(600)]);

/// A power of two.
const fn two_to(exponent: i64) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// The factor for numbers up to `largest` that prevents overflow and underflow of their squares,
/// and its inverse.
#[inline(always)]
pub fn into_range<T: Scalar>(largest: T) -> [T; 2] {
    let [large, small, step] = T::RANGE;
    // Powers of two change the exponent alone, so scaling rounds nothing. Not `hypot`: the
    // libraries of systems round it differently.
    if largest > large {
        [step.recip(), step]
    } else if largest < small {
        [step, step.recip()]
    } else {
        [T::ONE; 2]
    }
}

/// √(x² + y²) of two numbers that are at least 0, without overflow or underflow. Monotone in both.
#[inline(always)]
pub fn length<T: Scalar>(x: T, y: T) -> T {
    let [into, back] = into_range(x.max(y));
    let (x, y) = (x * into, y * into);
    (x * x + y * y).sqrt() * back
}

/// Whether √(x² + y²) ≤ radius, for two numbers that are at least 0 and a radius that is valid
/// for a shape. With radius 0 both numbers must be 0.
#[inline(always)]
pub fn within<T: Scalar>(x: T, y: T, radius: T) -> bool {
    // With radius 0 the squares of tiny numbers would vanish, and points at a distance would be
    // inside. Valid radii above 0 are so large that a number whose square vanishes is inside in any
    // case.
    if radius == T::ZERO { x.max(y) == T::ZERO } else { x * x + y * y <= radius * radius }
}

/// The midpoint of `min` and `max`, rounded once, never outside of them.
#[inline(always)]
pub fn middle<T: Scalar>(min: T, max: T) -> T {
    let half = T::from_f64(0.5);
    let sum = min + max;
    // The sum of two numbers is rounded once and halved exactly. The other formula rounds twice
    // near 0, where halves lose a bit; it is used only if the sum overflows, far from there.
    if sum.is_finite() { sum * half } else { min * half + max * half }
}

#[cfg(test)]
mod tests {
    use super::middle;

    #[test]
    fn the_middle_is_between() {
        for (min, max) in [(0.0, 0.1), (-1e38, 3e38), (3e38, 3.2e38), (0.0, 1e-45), (-0.0, -0.0)] {
            let middle: f32 = middle(min, max);
            assert!(min <= middle && middle <= max, "{min} {middle} {max}");
            assert_eq!(self::middle(max, max).to_bits(), max.to_bits());
        }
    }
}
