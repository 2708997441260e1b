//! Shapes, the overlap test, bounds of sets of shapes, and contacts.
//!
//! A shape is every point within `radius` of its core: an axis-aligned box, or a line segment, which
//! is a diagonal of its bounding box. The box is given as `center ± half_size`, or as `min` and
//! `max`. [`overlap`] is the only formula for the overlap of two boxes, and of the bounding boxes of
//! segments, in the arithmetic of the caller's type; [`lanes`] has it for blocks of shapes. Cores
//! given as `min` and `max` are compared exactly. [`Bounds`] of a set of shapes are tested with the
//! same formula. Rounding is monotone, so if bounds do not overlap, none of their shapes does; no
//! tolerance is needed.
//!
//! C. Ericson, *Real-Time Collision Detection* (2005), chapters 4.2 (AABBs) and 4.4.2
//! (swept spheres).

mod scalar;
mod core;
pub mod lanes;

pub(crate) use core::into_circle;
pub use core::{Core, Difference, Side, cores_overlap};
pub use scalar::{Scalar, into_range, length, middle, within};

/// The gap between two intervals `[min, max]`; negative if they overlap.
#[inline(always)]
pub fn gap<T: Scalar>(a: [T; 2], b: [T; 2]) -> T {
    (b[0] - a[1]).max(a[0] - b[1])
}

/// The gaps along each axis between two boxes, given by their lower and upper corners, that are
/// enlarged by half sizes with this sum.
#[inline(always)]
pub fn gaps<T: Scalar>(a: [[T; 2]; 2], b: [[T; 2]; 2], half_sizes: [T; 2]) -> [T; 2] {
    let along =
        |axis: usize| gap([a[0][axis], a[1][axis]], [b[0][axis], b[1][axis]]) - half_sizes[axis];
    [along(0), along(1)]
}

/// The squared distance of two cores from the gaps between them along each axis, of which
/// negative ones count as 0.
#[inline(always)]
pub fn square_of_gaps<T: Scalar>([x, y]: [T; 2]) -> T {
    let (x, y) = (x.max(T::ZERO), y.max(T::ZERO));
    x * x + y * y
}

/// Whether two rounded boxes overlap, from the gaps between their cores along each axis and the
/// sum of their radii. The gap of an axis is that between `min` and `max` of both (the distance of
/// the centres if these are equal) minus the sum of the half sizes, as in [`gaps`]. Touching is not
/// overlapping.
#[inline(always)]
pub fn overlap<T: Scalar>(gaps: [T; 2], radius_sum: T) -> bool {
    // Squares are compared: a square root would cost more and round once more. The second part is
    // for cores that overlap, whose distance counts as 0: with radii 0 nothing is below 0. `|` and
    // `&` without branches, because the answer is hard to predict.
    (square_of_gaps(gaps) < radius_sum * radius_sum) | ((gaps[0] < T::ZERO) & (gaps[1] < T::ZERO))
}

/// [`overlap`] of two discs, from the offset of their centres.
#[inline(always)]
pub fn discs_overlap<T: Scalar>([x, y]: [T; 2], radius_sum: T) -> bool {
    x * x + y * y < radius_sum * radius_sum
}

/// A shape with its filter. The bounding box of its core extends from `min - half_size` to `max + half_size`.
///
/// If a shape is given by its centre, both `min` and `max` are the centre. If it is given as a
/// box, its `half_size` is 0, so its sides are compared without rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape<T> {
    /// Lower corner, world units; the centre, unless the shape is given as a box.
    pub min: [T; 2],
    /// Upper corner, world units; the centre, unless the shape is given as a box.
    pub max: [T; 2],
    /// Half width and half height; 0 for a circle and for a shape given as a box.
    pub half_size: [T; 2],
    /// Distance by which the shape extends beyond its core.
    pub radius: T,
    /// Its categories, a bit set.
    pub category: u32,
    /// The categories that it may pair with, a bit set.
    pub mask: u32,
    /// What the core is within `min - half_size` to `max + half_size`.
    pub core: Core,
}

impl<T: Scalar> Shape<T> {
    /// The centre of the shape.
    pub fn center(&self) -> [T; 2] {
        [0, 1].map(|axis| middle(self.min[axis], self.max[axis]))
    }

    /// Half width and half height of the core; rounded if the shape is given as a box.
    pub fn core_half_size(&self) -> [T; 2] {
        let half = T::from_f64(0.5);
        let own = |axis: usize| self.max[axis] * half - self.min[axis] * half;
        [0, 1].map(|axis| if self.is_box(axis) { own(axis) } else { self.half_size[axis] })
    }

    /// The same shape moved by `-shift`.
    #[inline(always)]
    pub fn moved(&self, shift: [T; 2]) -> Self {
        let by = |v: [T; 2]| [v[0] - shift[0], v[1] - shift[1]];
        Self { min: by(self.min), max: by(self.max), ..*self }
    }

    /// Lower and upper corner of the bounding box of the core; rounded if the shape has a `half_size`.
    pub fn sides(&self) -> [T; 4] {
        let low = |axis: usize| self.min[axis] - self.half_size[axis];
        let high = |axis: usize| self.max[axis] + self.half_size[axis];
        [low(0), low(1), high(0), high(1)]
    }

    /// Whether the filters of two shapes let them pair.
    #[inline(always)]
    pub fn may_pair(&self, other: &Self) -> bool {
        filters_agree([self.category, self.mask], [other.category, other.mask])
    }

    /// Whether the core is a point.
    #[inline(always)]
    pub fn is_round(&self) -> bool {
        self.half_size == [T::ZERO; 2] && self.min == self.max
    }

    fn is_box(&self, axis: usize) -> bool {
        self.min[axis] < self.max[axis]
    }

    /// The gaps between a point and the core along each axis; negative inside.
    #[inline(always)]
    pub fn gaps_to(&self, point: [T; 2]) -> [T; 2] {
        gaps([point; 2], [self.min, self.max], self.half_size)
    }

    /// The gaps between the cores of two shapes along each axis; negative where they overlap.
    #[inline(always)]
    pub fn gaps(&self, other: &Self) -> [T; 2] {
        let half_sizes = sum(self.half_size, other.half_size);
        gaps([self.min, self.max], [other.min, other.max], half_sizes)
    }
}

/// Whether the filters of two shapes let them pair: the mask of each contains a category of the
/// other.
#[inline(always)]
pub fn filters_agree([category, mask]: [u32; 2], [other_category, other_mask]: [u32; 2]) -> bool {
    (category & other_mask) != 0 && (other_category & mask) != 0
}

#[inline(always)]
fn sum<T: Scalar>(a: [T; 2], b: [T; 2]) -> [T; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

/// Bounds of a set of shapes: the bounding box of their `min` and `max`, the largest half sizes
/// and radius, and the union of their filter bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds<T> {
    /// Lower corner of the bounding box of every `min`.
    pub min: [T; 2],
    /// Upper corner of the bounding box of every `max`.
    pub max: [T; 2],
    /// Largest half size along each axis.
    pub half_size: [T; 2],
    /// Largest radius.
    pub radius: T,
    /// The union of all categories.
    pub category: u32,
    /// The union of all masks.
    pub mask: u32,
}

impl<T: Scalar> Bounds<T> {
    /// The bounds of one shape.
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

    /// The bounds of the union of both sets.
    pub fn join(self, other: Self) -> Self {
        let both = |f: fn(T, T) -> T, a: [T; 2], b: [T; 2]| [f(a[0], b[0]), f(a[1], b[1])];
        Self {
            min: both(T::min, self.min, other.min),
            max: both(T::max, self.max, other.max),
            half_size: both(T::max, self.half_size, other.half_size),
            radius: self.radius.max(other.radius),
            category: self.category | other.category,
            mask: self.mask | other.mask,
        }
    }

    /// The bounds of the same shapes moved by `-shift`.
    #[inline(always)]
    pub fn moved(&self, shift: [T; 2]) -> Self {
        let by = |v: [T; 2]| [v[0] - shift[0], v[1] - shift[1]];
        Self { min: by(self.min), max: by(self.max), ..*self }
    }

    /// Whether a shape within these bounds, moved by `-shift`, could overlap a shape within
    /// `other`. `min_gap` is 0 if all shapes of both are given by their centres, because the
    /// [`gap`] between two centres is never negative; otherwise it is -infinity.
    #[inline(always)]
    pub fn overlaps(&self, other: &Self, shift: [T; 2], min_gap: T) -> bool {
        self.overlaps_unfiltered(other, shift, min_gap)
            && filters_agree([self.category, self.mask], [other.category, other.mask])
    }

    /// As [`overlaps`](Self::overlaps), without the filters.
    #[inline(always)]
    pub fn overlaps_unfiltered(&self, other: &Self, shift: [T; 2], min_gap: T) -> bool {
        let half_sizes = sum(self.half_size, other.half_size);
        // The same operations in the same order as for two shapes, on numbers that are at most as
        // large. Each operation is monotone, and its rounding too. So the gaps here are never above
        // those of the shapes, and no tolerance is needed. A formula that is only equal in exact
        // arithmetic would lose pairs.
        let gap_along = |axis: usize| {
            // Subtracted from the coordinate, as `Shape::moved` does for the shapes. Added to the
            // other side it would round differently.
            let own = [self.min[axis] - shift[axis], self.max[axis] - shift[axis]];
            gap(own, [other.min[axis], other.max[axis]]).max(min_gap) - half_sizes[axis]
        };
        overlap([gap_along(0), gap_along(1)], self.radius + other.radius)
    }

    /// The gaps along each axis between a box from `min` to `max` and the cores of the shapes, at
    /// most; negative if they overlap.
    #[inline(always)]
    pub fn gaps_to(&self, min: [T; 2], max: [T; 2]) -> [T; 2] {
        gaps([self.min, self.max], [min, max], self.half_size)
    }
}

/// The contact of two overlapping rounded boxes: the unit normal from `a` to `b` and the
/// penetration depth.
///
/// If the cores are disjoint, the normal joins their closest points. If they overlap, it is the
/// axis of least penetration (separating axis test). For coincident centres it is +x.
pub fn contact<T: Scalar>(a: &Shape<T>, b: &Shape<T>) -> ([T; 2], T) {
    if a.is_slanted() || b.is_slanted() {
        return Difference::of(a, b).contact();
    }
    // Both gaps of each axis, since which of them is the larger one tells on which side `b` lies.
    let above = [b.min[0] - a.max[0], b.min[1] - a.max[1]];
    let below = [a.min[0] - b.max[0], a.min[1] - b.max[1]];
    let sign = |axis: usize| if above[axis] < below[axis] { -T::ONE } else { T::ONE };
    let d = a.gaps(b);
    let radius_sum = a.radius + b.radius;
    let e = [d[0].max(T::ZERO), d[1].max(T::ZERO)];
    let length = length(e[0], e[1]);
    // The cores are disjoint. `e` is the offset of their closest points, without signs.
    if length > T::ZERO {
        // The squares of offsets near the ends of the range would overflow or vanish.
        let [into, _] = into_range(e[0].max(e[1]));
        let normal = [e[0] * into * sign(0), e[1] * into * sign(1)];
        // Scaled twice, so that the length is 1 for tiny and huge offsets too.
        let scale = normal[0].abs().max(normal[1].abs()).recip();
        let unit = [normal[0] * scale, normal[1] * scale];
        let norm = (unit[0] * unit[0] + unit[1] * unit[1]).sqrt().recip();
        return ([unit[0] * norm, unit[1] * norm], radius_sum - length);
    }
    // The cores overlap, so both gaps are at most 0. The gap nearest to 0 is the shortest way out.
    if d[0] < d[1] {
        ([T::ZERO, sign(1)], radius_sum - d[1])
    } else {
        ([sign(0), T::ZERO], radius_sum - d[0])
    }
}

/// The points in the middle of the overlap of two rounded boxes, from the result of [`contact`]. Where two sides
/// overlap they are the ends of the common part of the cores, the lower one first; elsewhere there is one point, and
/// the second one is NaN.
pub fn contact_points<T: Scalar>(
    a: &Shape<T>,
    b: &Shape<T>,
    (normal, depth): ([T; 2], T),
) -> [[T; 2]; 2] {
    if a.is_slanted() || b.is_slanted() {
        return core::contact_points(a, b, (normal, depth));
    }
    // From the surface of `a` half of the depth inwards; the surface of `b` is as far away on the other side.
    let inwards = a.radius - depth * T::from_f64(0.5);
    let side_of_a = |axis: usize| {
        if normal[axis] < T::ZERO {
            a.min[axis] - a.half_size[axis]
        } else {
            a.max[axis] + a.half_size[axis]
        }
    };
    let none = [T::NAN; 2];
    if normal[0] != T::ZERO && normal[1] != T::ZERO {
        return [[0, 1].map(|axis| side_of_a(axis) + normal[axis] * inwards), none];
    }
    let axis = usize::from(normal[0] == T::ZERO);
    let along = 1 - axis;
    let level = side_of_a(axis) + normal[axis] * inwards;
    let low = (a.min[along] - a.half_size[along]).max(b.min[along] - b.half_size[along]);
    let high = (a.max[along] + a.half_size[along]).min(b.max[along] + b.half_size[along]);
    let point = |at: T| if axis == 0 { [level, at] } else { [at, level] };
    // Equal for the centre of a circle, and for corners that are level with each other.
    if low < high { [point(low), point(high)] } else { [point(low), none] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn disc(x: f32, y: f32, radius: f32) -> Shape<f32> {
        Shape {
            min: [x, y],
            max: [x, y],
            half_size: [0.0; 2],
            radius,
            category: 1,
            mask: 1,
            core: Core::Box,
        }
    }

    /// The bounds of one shape overlap if the shape does.
    fn overlapping(a: Shape<f32>, b: Shape<f32>) -> bool {
        Bounds::of(&a).overlaps(&Bounds::of(&b), [0.0; 2], f32::NEG_INFINITY)
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
    fn contact_of_boxes_has_the_least_depth() {
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
