//! Shapes and when they overlap.
//!
//! A shape is a rounded box: every point within `radius` of its core, an
//! axis-aligned box. The core is given as `center ± half_size`, or as `min` and
//! `max`. One formula says whether two shapes overlap, in the arithmetic of the
//! caller's type; cores given as `min` and `max` are compared exactly. A [`Cover`]
//! bounds a set of shapes and is tested with *the same formula*. Rounding is monotone,
//! so if a cover does not overlap, none of its shapes does; no tolerance is needed.

use std::cmp::Ordering;
use std::fmt::{Debug, Display, LowerExp};
use std::ops::Neg;

use crate::simd::Number;

/// The arithmetic of a tree: `f32` or `f64`.
pub trait Scalar: Number + Debug + Display + LowerExp + Neg<Output = Self> {
    /// Zero.
    const ZERO: Self;
    /// One.
    const ONE: Self;
    /// Larger than every finite value.
    const INFINITY: Self;
    /// The largest half size: sums of four stay finite, so that the formula never subtracts
    /// infinity from infinity.
    const MAX_SIZE: Self;
    /// The smallest radius above 0, and the largest: the square of a sum of two neither
    /// overflows nor loses digits.
    const RADII: [Self; 2];
    /// The distance from 1 to the next larger number.
    const EPSILON: Self;
    /// The smallest square with all its digits.
    const SMALLEST_SQUARE: Self;
    /// Numbers above the first have squares that may be too large, those below the second
    /// squares that may be too small; both are good after a division, or a multiplication, by
    /// the third. It is a power of two, so no digit is lost.
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
    /// The value divided by another.
    fn over(self, other: Self) -> Self;
    /// Which comes first; tells −0 from 0.
    fn total_order(&self, other: &Self) -> Ordering;
    /// The smaller of two numbers.
    #[inline(always)]
    fn least(self, other: Self) -> Self {
        if other < self { other } else { self }
    }
    /// The larger of two numbers.
    #[inline(always)]
    fn most(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
}

macro_rules! scalar {
    ($t:ty, $radii:expr, $range:expr) => {
        impl Scalar for $t {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const INFINITY: Self = <$t>::INFINITY;
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
            fn over(self, other: Self) -> Self {
                self / other
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

/// What numbers up to `largest` have to be multiplied by for their squares to be good, and by
/// what to go back.
#[inline(always)]
pub fn into_range<T: Scalar>(largest: T) -> [T; 2] {
    let [large, small, step] = T::RANGE;
    if largest > large {
        [step.recip(), step]
    } else if largest < small {
        [step, step.recip()]
    } else {
        [T::ONE; 2]
    }
}

/// √(x² + y²) of two numbers that are not negative, however large or small. Grows with both.
#[inline(always)]
pub fn length<T: Scalar>(x: T, y: T) -> T {
    let [into, back] = into_range(x.most(y));
    let (x, y) = (x * into, y * into);
    (x * x + y * y).sqrt() * back
}

/// Whether √(x² + y²) ≤ radius, for two numbers that are not negative. The squares are compared
/// if the radius is valid for a shape; with radius 0 both numbers must be 0.
#[inline(always)]
pub fn within<T: Scalar>(x: T, y: T, radius: T) -> bool {
    if radius == T::ZERO { x.most(y) == T::ZERO } else { x * x + y * y <= radius * radius }
}

/// The middle of `min` and `max`, rounded once, and always between them.
#[inline(always)]
pub fn middle<T: Scalar>(min: T, max: T) -> T {
    let half = T::from_f64(0.5);
    let sum = min + max;
    if sum.is_finite() { sum * half } else { min * half + max * half }
}

/// The gap between two intervals `[min, max]` along one axis; negative if they
/// overlap.
#[inline(always)]
pub fn gap<T: Scalar>(a: [T; 2], b: [T; 2]) -> T {
    (b[0] - a[1]).most(a[0] - b[1])
}

/// Whether two rounded boxes overlap, from the [`gap`] between their `min` and `max`
/// along each axis (the distance of their centres, where these are the same), the sums of
/// their half sizes and the sum of their radii. Touching is not overlapping.
#[inline(always)]
pub fn overlap<T: Scalar>(gap: [T; 2], half_sum: [T; 2], radius_sum: T) -> bool {
    let dx = gap[0] - half_sum[0];
    let dy = gap[1] - half_sum[1];
    let ex = dx.most(T::ZERO);
    let ey = dy.most(T::ZERO);
    (ex * ex + ey * ey < radius_sum * radius_sum) | ((dx < T::ZERO) & (dy < T::ZERO))
}

/// One rounded box with its filter. Its core reaches from `min - half_size` to
/// `max + half_size`.
///
/// A shape that is given by its centre has that for `min` and for `max`. One that is given
/// as a box has no `half_size`, so that its sides are compared without any rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape<T> {
    /// Lower corner, world units; the centre, unless the shape is given as a box.
    pub min: [T; 2],
    /// Upper corner, world units; the centre, unless the shape is given as a box.
    pub max: [T; 2],
    /// Half width and half height around these; 0 for a circle and for a shape given as
    /// a box.
    pub half_size: [T; 2],
    /// Distance by which the shape extends beyond its core.
    pub radius: T,
    /// What it is, a bit set.
    pub category: u32,
    /// What it may pair with, a bit set.
    pub mask: u32,
}

impl<T: Scalar> Shape<T> {
    /// The middle of the shape.
    pub fn center(&self) -> [T; 2] {
        [0, 1].map(|axis| middle(self.min[axis], self.max[axis]))
    }

    /// Half width and half height of the core; rounded, where the shape is given as a box.
    pub fn core_half_size(&self) -> [T; 2] {
        let half = T::from_f64(0.5);
        let own = |axis: usize| self.max[axis] * half - self.min[axis] * half;
        [0, 1].map(|axis| if self.is_box(axis) { own(axis) } else { self.half_size[axis] })
    }

    /// Lower and upper corner of the core; rounded, where the shape has a `half_size`.
    pub fn core(&self) -> [T; 4] {
        let low = |axis: usize| self.min[axis] - self.half_size[axis];
        let high = |axis: usize| self.max[axis] + self.half_size[axis];
        [low(0), low(1), high(0), high(1)]
    }

    /// Whether the core is a point.
    #[inline(always)]
    pub fn is_round(&self) -> bool {
        self.half_size == [T::ZERO; 2] && self.min == self.max
    }

    fn is_box(&self, axis: usize) -> bool {
        self.min[axis] < self.max[axis]
    }

    /// How far a point is from `min` and `max` along each axis; negative between them.
    #[inline(always)]
    pub fn gap_to(&self, point: [T; 2]) -> [T; 2] {
        [0, 1].map(|axis| (self.min[axis] - point[axis]).most(point[axis] - self.max[axis]))
    }
}

/// Bounds of a set of shapes: of their centres or boxes, the largest half size and
/// radius, and every filter bit that any of them has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cover<T> {
    /// Lower corner of the bounding box of every `min`.
    pub min: [T; 2],
    /// Upper corner of the bounding box of every `max`.
    pub max: [T; 2],
    /// Largest half size along each axis.
    pub half_size: [T; 2],
    /// Largest radius.
    pub radius: T,
    /// All categories, OR-ed.
    pub category: u32,
    /// All masks, OR-ed.
    pub mask: u32,
}

impl<T: Scalar> Cover<T> {
    /// The cover of one shape.
    pub fn of(shape: &Shape<T>) -> Self {
        Self {
            min: shape.min,
            max: shape.max,
            half_size: shape.half_size,
            radius: shape.radius,
            category: shape.category,
            mask: shape.mask,
        }
    }

    /// The cover of both sets.
    pub fn join(self, other: Self) -> Self {
        let both = |f: fn(T, T) -> T, a: [T; 2], b: [T; 2]| [f(a[0], b[0]), f(a[1], b[1])];
        Self {
            min: both(T::least, self.min, other.min),
            max: both(T::most, self.max, other.max),
            half_size: both(T::most, self.half_size, other.half_size),
            radius: self.radius.most(other.radius),
            category: self.category | other.category,
            mask: self.mask | other.mask,
        }
    }

    /// The cover of the same shapes moved by `-shift`.
    #[inline(always)]
    pub fn moved(&self, shift: [T; 2]) -> Self {
        let by = |v: [T; 2]| [v[0] - shift[0], v[1] - shift[1]];
        Self { min: by(self.min), max: by(self.max), ..*self }
    }

    /// Whether some shape of this cover, moved by `-shift`, could overlap some
    /// shape of `other`. `least_gap` is 0 where both hold nothing but shapes given by
    /// their centres, the [`gap`] between which is never negative, and -infinity
    /// otherwise.
    #[inline(always)]
    pub fn meets(&self, other: &Self, shift: [T; 2], least_gap: T) -> bool {
        self.reaches(other, shift, least_gap)
            && (self.category & other.mask) != 0
            && (other.category & self.mask) != 0
    }

    /// The same, whatever the filters.
    #[inline(always)]
    pub fn reaches(&self, other: &Self, shift: [T; 2], least_gap: T) -> bool {
        let gap = |axis: usize| {
            let own = [self.min[axis] - shift[axis], self.max[axis] - shift[axis]];
            gap(own, [other.min[axis], other.max[axis]]).most(least_gap)
        };
        let half_sum =
            [self.half_size[0] + other.half_size[0], self.half_size[1] + other.half_size[1]];
        overlap([gap(0), gap(1)], half_sum, self.radius + other.radius)
    }
}

/// Normal from `a` to `b` and depth of the overlap of two rounded boxes.
///
/// Where the cores are apart, the normal joins their nearest points. Where they
/// overlap, it is the axis of least penetration. Coincident centres have no
/// direction of their own and get +x.
pub fn contact<T: Scalar>(a: &Shape<T>, b: &Shape<T>) -> ([T; 2], T) {
    let above = [b.min[0] - a.max[0], b.min[1] - a.max[1]];
    let below = [a.min[0] - b.max[0], a.min[1] - b.max[1]];
    let sign = |axis: usize| if above[axis] < below[axis] { -T::ONE } else { T::ONE };
    let d = [
        above[0].most(below[0]) - (a.half_size[0] + b.half_size[0]),
        above[1].most(below[1]) - (a.half_size[1] + b.half_size[1]),
    ];
    let radius_sum = a.radius + b.radius;
    let e = [d[0].most(T::ZERO), d[1].most(T::ZERO)];
    let length = length(e[0], e[1]);
    if length > T::ZERO {
        let [into, _] = into_range(e[0].most(e[1]));
        let normal = [e[0] * into * sign(0), e[1] * into * sign(1)];
        // Scaled twice, so that tiny and huge offsets keep unit length.
        let scale = normal[0].abs().most(normal[1].abs()).recip();
        let unit = [normal[0] * scale, normal[1] * scale];
        let norm = (unit[0] * unit[0] + unit[1] * unit[1]).sqrt().recip();
        return ([unit[0] * norm, unit[1] * norm], radius_sum - length);
    }
    if d[0] < d[1] {
        ([T::ZERO, sign(1)], radius_sum - d[1])
    } else {
        ([sign(0), T::ZERO], radius_sum - d[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn disc(x: f32, y: f32, radius: f32) -> Shape<f32> {
        Shape { min: [x, y], max: [x, y], half_size: [0.0; 2], radius, category: 1, mask: 1 }
    }

    /// A cover of one shape answers for the shape.
    fn overlapping(a: Shape<f32>, b: Shape<f32>) -> bool {
        Cover::of(&a).meets(&Cover::of(&b), [0.0; 2], f32::NEG_INFINITY)
    }

    #[test]
    fn touching_is_not_overlapping() {
        assert!(!overlapping(disc(0.0, 0.0, 1.0), disc(2.0, 0.0, 1.0)));
        assert!(overlapping(disc(0.0, 0.0, 1.0), disc(1.999, 0.0, 1.0)));
        assert!(!overlapping(disc(0.0, 0.0, 0.0), disc(0.0, 0.0, 0.0)));
    }

    #[test]
    fn boxes_overlap_by_their_open_interior() {
        let unit = |x: f32| Shape { half_size: [0.5, 0.5], ..disc(x, 0.0, 0.0) };
        assert!(overlapping(unit(0.0), unit(0.9)));
        assert!(!overlapping(unit(0.0), unit(1.0)));
    }

    fn box_of([left, top, right, bottom]: [f32; 4]) -> Shape<f32> {
        Shape { min: [left, top], max: [right, bottom], ..disc(0.0, 0.0, 0.0) }
    }

    #[test]
    fn sides_of_boxes_are_compared_exactly() {
        let (step, next) = (0.3f32, 0.3f32.next_up());
        let first = box_of([0.0, 0.0, step, 1.0]);
        assert!(!overlapping(first, box_of([step, 0.0, 1.0, 1.0])));
        assert!(overlapping(box_of([0.0, 0.0, next, 1.0]), box_of([step, 0.0, 1.0, 1.0])));
        assert!(overlapping(first, box_of([-1e30, 0.5, 1e30, 0.6])));
    }

    #[test]
    fn the_middle_is_between() {
        for (min, max) in [(0.0, 0.1), (-1e38, 3e38), (3e38, 3.2e38), (0.0, 1e-45), (-0.0, -0.0)] {
            let middle: f32 = middle(min, max);
            assert!(min <= middle && middle <= max, "{min} {middle} {max}");
            assert_eq!(super::middle(max, max).to_bits(), max.to_bits());
        }
    }

    #[test]
    fn contact_of_boxes_takes_the_shortest_way_out() {
        let wide = box_of([0.0, 0.0, 10.0, 4.0]);
        assert_eq!(contact(&wide, &box_of([1.0, 1.0, 2.0, 9.0])), ([-1.0, 0.0], 2.0));
        assert_eq!(contact(&wide, &box_of([4.0, 2.5, 6.0, 9.0])), ([0.0, 1.0], 1.5));
        assert_eq!(contact(&wide, &wide), ([0.0, 1.0], 4.0));
    }

    #[test]
    fn contact_of_discs_points_from_first_to_second() {
        let (normal, depth) = contact(&disc(0.0, 0.0, 1.0), &disc(0.0, -1.5, 1.0));
        assert_eq!((normal, depth), ([0.0, -1.0], 0.5));
        let (normal, depth) = contact(&disc(3.0, 3.0, 1.0), &disc(3.0, 3.0, 2.0));
        assert_eq!((normal, depth), ([1.0, 0.0], 3.0));
    }

    #[test]
    fn contact_of_boxes_takes_the_axis_of_least_penetration() {
        let flat = |x, y| Shape { half_size: [2.0, 1.0], ..disc(x, y, 0.0) };
        let (normal, depth) = contact(&flat(0.0, 0.0), &flat(1.0, 1.5));
        assert_eq!((normal, depth), ([0.0, 1.0], 0.5));
    }
}
