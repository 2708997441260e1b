//! What the core of a shape is within its bounding box, and the overlap of cores that are not
//! boxes.
//!
//! Every core lies in an axis-aligned box, `min - half_size` to `max + half_size`, and most are that
//! box. The others are tested in two steps. First the boxes, as rounded boxes, with the formula of
//! [`overlap`](super::overlap): trees, grids and blocks of shapes use no other test. Then the cores
//! themselves, by their [`Difference`]. A pair must pass both, so no bounds can lose one.

use super::{Scalar, Shape, into_range, length, within};

/// The core of a shape within its bounding box.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Core {
    /// The box itself; a point if it has no size.
    #[default]
    Box,
    /// A line segment: a diagonal of the box, so its ends are numbers of the box, without rounding.
    Segment {
        /// Whether it starts at the largest x, and at the largest y, of the box.
        from_max: [bool; 2],
    },
}

impl Core {
    /// A number for each core, for files.
    pub fn number(self) -> u32 {
        match self {
            Self::Box => 0,
            Self::Segment { from_max: [x, y] } => 1 + u32::from(x) + 2 * u32::from(y),
        }
    }

    /// The core with a number, if there is one.
    pub fn of_number(number: u32) -> Option<Self> {
        let bit = |bit: u32| (number.wrapping_sub(1) >> bit) & 1 != 0;
        match number {
            0 => Some(Self::Box),
            1..=4 => Some(Self::Segment { from_max: [bit(0), bit(1)] }),
            _ => None,
        }
    }

    /// The bounding box of a segment from `start` to `end`, and its core.
    pub fn of_segment<T: Scalar>([start, end]: [[T; 2]; 2]) -> ([[T; 2]; 2], Self) {
        let pick = |f: fn(T, T) -> T| [f(start[0], end[0]), f(start[1], end[1])];
        let from_max = [start[0] > end[0], start[1] > end[1]];
        ([pick(T::min), pick(T::max)], Self::Segment { from_max })
    }
}

impl<T: Scalar> Shape<T> {
    /// Start and end of the core, if it is a segment.
    pub fn segment(&self) -> Option<[[T; 2]; 2]> {
        let Core::Segment { from_max } = self.core else { return None };
        let corner = |at_max: [bool; 2]| {
            [0, 1].map(|axis| if at_max[axis] { self.max[axis] } else { self.min[axis] })
        };
        Some([corner(from_max), corner(from_max.map(|at_max| !at_max))])
    }

    /// Whether the core is not its bounding box: a segment that is not along an axis.
    ///
    /// A segment along an axis is a box without width, for which the formula of boxes is exact.
    #[inline(always)]
    pub fn is_slanted(&self) -> bool {
        self.core != Core::Box && self.min[0] < self.max[0] && self.min[1] < self.max[1]
    }

    /// Whether two shapes overlap. Touching is not overlapping.
    #[inline]
    pub fn overlaps(&self, other: &Self) -> bool {
        super::overlap(self.gaps(other), self.radius + other.radius) && cores_overlap(self, other)
    }

    /// The ends of a segment, that at the smaller x first. Start and end do not matter here, so that
    /// no answer depends on them.
    fn line(&self) -> [[T; 2]; 2] {
        let ([left, low], [right, high]) = (self.min, self.max);
        match self.core {
            Core::Segment { from_max: [x, y] } if x != y => [[left, high], [right, low]],
            _ => [[left, low], [right, high]],
        }
    }
}

/// Whether two shapes overlap whose bounding boxes do, as rounded boxes.
#[inline(always)]
pub fn cores_overlap<T: Scalar>(a: &Shape<T>, b: &Shape<T>) -> bool {
    // Two boxes, and most pairs are, have no second step.
    !(a.is_slanted() || b.is_slanted()) || Difference::of(a, b).overlaps()
}

/// The Minkowski difference of the cores of two shapes: all points of the second core, seen from
/// each point of the first. One of the cores is a slanted segment.
///
/// It is a convex polygon, and the cores are as far from each other as the polygon is from (0, 0).
/// So overlaps, contacts, distances and casts are questions about one point and one polygon: a
/// parallelogram for two segments, and a hexagon for a segment and a box.
///
/// C. Ericson, *Real-Time Collision Detection* (2005), chapter 3.11.
#[derive(Clone, Copy, Debug)]
pub struct Difference<T> {
    /// The sides, counterclockwise: where each starts, and the vector to its end. Those of a core
    /// without width or height may have no length.
    sides: [[[T; 2]; 2]; 6],
    len: usize,
    /// The sum of the radii.
    radius: T,
    /// All numbers above have this factor, and times this they have the size of the shapes: powers
    /// of two, which round nothing and keep squares within the range of numbers.
    scale: [T; 2],
}

impl<T: Scalar> Difference<T> {
    /// The core of `b` seen from that of `a`.
    pub fn of(a: &Shape<T>, b: &Shape<T>) -> Self {
        Self::arranged([a, b], into_range(size(a).max(size(b))), is_first(a, b))
    }

    /// As [`of`](Self::of) two shapes at the beginning and at the end of their motions. The sides and
    /// the scales of both correspond.
    pub fn of_motions([a, b]: [&[Shape<T>; 2]; 2]) -> [Self; 2] {
        let largest = a.iter().chain(b).map(size).fold(T::ZERO, T::max);
        [0, 1].map(|end| {
            Self::arranged([&a[end], &b[end]], into_range(largest), is_first(&a[0], &b[0]))
        })
    }

    /// As [`of`](Self::of), with a scale. Of two segments the sides begin at an end of the first one,
    /// or else of the second.
    fn arranged([a, b]: [&Shape<T>; 2], scale: [T; 2], is_first: bool) -> Self {
        // Scaled before they are subtracted, which may overflow.
        let scaled = |shape: &Shape<T>| {
            let by = |v: [T; 2]| v.map(|v| v * scale[0]);
            let (min, max, half_size) = (by(shape.min), by(shape.max), by(shape.half_size));
            Shape { min, max, half_size, ..*shape }
        };
        let (first, second) = (scaled(a), scaled(b));
        let (sides, len) = match (a.is_slanted(), b.is_slanted()) {
            (true, false) => (hexagon(first.line(), &second), 6),
            (false, _) => (opposite(hexagon(second.line(), &first)), 6),
            _ if is_first => (parallelogram(first.line(), second.line()), 4),
            _ => (opposite(parallelogram(second.line(), first.line())), 4),
        };
        Self { sides, len, radius: (a.radius + b.radius) * scale[0], scale }
    }

    /// The sides that have a length.
    fn sides(&self) -> impl Iterator<Item = Side<T>> {
        (0..self.len).map(|index| self.side(index)).filter(|side| side.along != [T::ZERO; 2])
    }

    /// The sides that have a length, with those of the difference at the end of a motion.
    pub fn sides_with(&self, end: &Self) -> impl Iterator<Item = [Side<T>; 2]> {
        let both = (0..self.len).map(|index| [self.side(index), end.side(index)]);
        both.filter(|[side, _]| side.along != [T::ZERO; 2])
    }

    fn side(&self, index: usize) -> Side<T> {
        let [start, along] = self.sides[index];
        Side { start, along, end: self.sides[(index + 1) % self.len][0] }
    }

    /// The sum of the radii, with the scale of the sides.
    pub fn radius(&self) -> T {
        self.radius
    }

    /// Whether (0, 0) is in the interior.
    fn is_around(&self) -> bool {
        self.sides().all(|side| side.inwards() > T::ZERO)
    }

    /// Whether the shapes overlap. Touching is not overlapping.
    pub fn overlaps(&self) -> bool {
        self.is_around()
            || self.sides().any(|side| match side.nearest() {
                Nearest::Corner([x, y]) => x * x + y * y < self.radius * self.radius,
                // Not as squares: products of four coordinates leave the range of float32 early.
                Nearest::Inside => side.inwards().abs() < self.radius * side.length(),
            })
    }

    /// Whether the shapes overlap or touch.
    pub fn touches(&self) -> bool {
        self.is_around()
            || self.sides().any(|side| match side.nearest() {
                Nearest::Corner([x, y]) => within(x.abs(), y.abs(), self.radius),
                Nearest::Inside => side.inwards().abs() <= self.radius * side.length(),
            })
    }

    /// The distance of the cores; 0 if they overlap.
    pub fn distance(&self) -> T {
        if self.is_around() { T::ZERO } else { self.nearest().0 * self.scale[1] }
    }

    /// The distance of (0, 0) from the boundary, and the unit vector from there to the nearest
    /// point; that of a point on a side is (0, 0) or points outwards.
    fn nearest(&self) -> (T, [T; 2]) {
        let nearest = self.sides().map(|side| match side.nearest() {
            Nearest::Corner([x, y]) => {
                let far = length(x.abs(), y.abs());
                (far, if far > T::ZERO { [x / far, y / far] } else { [T::ZERO; 2] })
            }
            Nearest::Inside => {
                let (away, [x, y]) = (side.inwards() / side.length(), side.normal());
                (away.abs(), if away < T::ZERO { [-x, -y] } else { [x, y] })
            }
        });
        nearest.reduce(|a, b| if b.0 < a.0 { b } else { a }).unwrap_or_default()
    }

    /// The unit normal from the first shape to the second, and the depth of their overlap.
    ///
    /// If the cores overlap, it is that of the side which is the shortest way out.
    pub fn contact(&self) -> ([T; 2], T) {
        if !self.is_around() {
            let (distance, normal) = self.nearest();
            if distance > T::ZERO {
                return (normal, (self.radius - distance) * self.scale[1]);
            }
        }
        let ways = self.sides().map(|side| (side.inwards() / side.length(), side.normal()));
        let shortest = ways.reduce(|a, b| if b.0 < a.0 { b } else { a });
        let (way, [x, y]) = shortest.unwrap_or_default();
        // The second shape leaves against the outer normal: then the side passes over (0, 0).
        ([-x, -y], (self.radius + way) * self.scale[1])
    }

    /// How far the first shape moves along the unit vector `u` until it touches the second, and the
    /// unit normal of the second there. The shapes neither overlap nor touch.
    pub fn entry(&self, u: [T; 2]) -> Option<(T, [T; 2])> {
        let through_sides = self.sides().filter_map(|side| side.entry(self.radius, u));
        let into_corners = self.sides().filter_map(|side| {
            let from = side.start.map(|v| -v);
            let distance = into_circle(from, u, self.radius)?;
            let away = [0, 1].map(|axis| (from[axis] + u[axis] * distance) / self.radius);
            Some((distance, away))
        });
        let rounded = self.radius > T::ZERO;
        let hits = through_sides.chain(into_corners.filter(|_| rounded));
        let first = hits.reduce(|a, b| if b.0 < a.0 { b } else { a });
        first.map(|(distance, normal)| (distance * self.scale[1], normal))
    }
}

/// Whether a segment comes before another one.
///
/// Of two segments the lesser one is always the first. So a difference in the other order has the
/// same sides with other signs, and the same roundings.
fn is_first<T: Scalar>(a: &Shape<T>, b: &Shape<T>) -> bool {
    a.line() <= b.line()
}

/// The largest of the numbers that describe a core.
fn size<T: Scalar>(shape: &Shape<T>) -> T {
    let along =
        |axis: usize| shape.min[axis].abs().max(shape.max[axis].abs()).max(shape.half_size[axis]);
    along(0).max(along(1))
}

/// A side of a [`Difference`].
#[derive(Clone, Copy, Debug)]
pub struct Side<T> {
    /// Its first end; the inside is on the left.
    pub start: [T; 2],
    /// Its second end.
    pub end: [T; 2],
    /// From start to end, rounded once, whereas the difference of the two would be rounded again.
    along: [T; 2],
}

/// The point of a side that is nearest to (0, 0).
enum Nearest<T> {
    Corner([T; 2]),
    /// Between both ends.
    Inside,
}

impl<T: Scalar> Side<T> {
    /// Distance of (0, 0) from the line, times the length of the side; positive on the inner side.
    pub fn inwards(&self) -> T {
        cross(self.start, self.along)
    }

    fn length(&self) -> T {
        dot(self.along, self.along).sqrt()
    }

    /// The outer unit normal.
    fn normal(&self) -> [T; 2] {
        let length = length(self.along[0].abs(), self.along[1].abs());
        [self.along[1] / length, -self.along[0] / length]
    }

    fn nearest(&self) -> Nearest<T> {
        let (before, behind) = (dot(self.start, self.along), dot(self.end, self.along));
        if before >= T::ZERO {
            Nearest::Corner(self.start)
        } else if behind <= T::ZERO {
            Nearest::Corner(self.end)
        } else {
            Nearest::Inside
        }
    }

    /// Where the path from (0, 0) along `u` meets the side moved outwards by `radius`, and its normal.
    fn entry(&self, radius: T, u: [T; 2]) -> Option<(T, [T; 2])> {
        let normal = self.normal();
        if radius > T::ZERO && dot(normal, u) >= T::ZERO {
            return None;
        }
        let moved = |[x, y]: [T; 2]| [x + normal[0] * radius, y + normal[1] * radius];
        let (start, end) = (moved(self.start), moved(self.end));
        // On which side of the path each end is. Two segments with a common end find the same
        // number for it, so that no path passes between them.
        let (c, d) = (cross(start, u), cross(end, u));
        let (a, b) = (dot(start, u), dot(end, u));
        let against = |normal: [T; 2]| {
            if dot(normal, u) > T::ZERO { normal.map(|v| -v) } else { normal }
        };
        let (distance, normal) = if c == T::ZERO && d == T::ZERO {
            (a.min(b), u.map(|v| -v))
        } else if (c > T::ZERO && d > T::ZERO) || (c < T::ZERO && d < T::ZERO) {
            return None;
        } else {
            // A mean of both ends, weighted by the distances of the other from the path. It is between them
            // however long the side is and however flat it is met.
            let share = c / (c - d);
            (a + (b - a) * share, against(normal))
        };
        (distance >= T::ZERO).then_some((distance, normal))
    }
}

fn dot<T: Scalar>(a: [T; 2], b: [T; 2]) -> T {
    a[0] * b[0] + a[1] * b[1]
}

fn cross<T: Scalar>(a: [T; 2], b: [T; 2]) -> T {
    a[0] * b[1] - a[1] * b[0]
}

fn minus<T: Scalar>(a: [T; 2], b: [T; 2]) -> [T; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

/// A box seen from each point of a line, whose first end has the smaller x.
fn hexagon<T: Scalar>([left, right]: [[T; 2]; 2], other: &Shape<T>) -> [[[T; 2]; 2]; 6] {
    let [hx, hy] = other.half_size;
    // Lower and upper corner of the box, seen from an end. Coordinates are subtracted first, so that a box
    // given by its centre is as exact here as in `gaps`.
    let low = |end: [T; 2]| {
        let [x, y] = minus(other.min, end);
        [x - hx, y - hy]
    };
    let high = |end: [T; 2]| {
        let [x, y] = minus(other.max, end);
        [x + hx, y + hy]
    };
    let (none, two) = (T::ZERO, T::ONE + T::ONE);
    let [width, height] =
        [0, 1].map(|axis| other.max[axis] - other.min[axis] + two * other.half_size[axis]);
    let (line, back) = (minus(right, left), minus(left, right));
    // Seen from the right end the box is at the left.
    let ([x0, y0], [x1, y1]) = (low(right), high(right));
    let ([p0, q0], [p1, q1]) = (low(left), high(left));
    if line[1] > none {
        [
            [[x0, y0], [width, none]],
            [[x1, y0], line],
            [[p1, q0], [none, height]],
            [[p1, q1], [-width, none]],
            [[p0, q1], back],
            [[x0, y1], [none, -height]],
        ]
    } else {
        [
            [[x0, y0], line],
            [[p0, q0], [width, none]],
            [[p1, q0], [none, height]],
            [[p1, q1], back],
            [[x1, y1], [-width, none]],
            [[x0, y1], [none, -height]],
        ]
    }
}

/// The second line seen from each point of the first.
fn parallelogram<T: Scalar>(first: [[T; 2]; 2], second: [[T; 2]; 2]) -> [[[T; 2]; 2]; 6] {
    let ([a, b], [c, d]) = (first, second);
    let (ab, ba, cd, dc) = (minus(b, a), minus(a, b), minus(d, c), minus(c, d));
    let (ac, ad, bc, bd) = (minus(c, a), minus(d, a), minus(c, b), minus(d, b));
    let none = [[T::ZERO; 2]; 2];
    if cross(ab, cd) < T::ZERO {
        [[ac, ba], [bc, cd], [bd, ab], [ad, dc], none, none]
    } else {
        [[ac, cd], [ad, ba], [bd, dc], [bc, ab], none, none]
    }
}

/// The same sides seen from the other shape.
fn opposite<T: Scalar>(sides: [[[T; 2]; 2]; 6]) -> [[[T; 2]; 2]; 6] {
    sides.map(|side| side.map(|vector| vector.map(|v| -v)))
}

/// The distance from `m`, which is outside, along `u` to a circle around (0, 0).
pub(crate) fn into_circle<T: Scalar>(m: [T; 2], u: [T; 2], radius: T) -> Option<T> {
    let along = m[0] * u[0] + m[1] * u[1];
    let across = m[0] * u[1] - m[1] * u[0];
    // Not compared as squares, which may underflow. NaN is a miss.
    if !(along <= T::ZERO && across.abs() <= radius) {
        return None;
    }
    // Not from the discriminant of the quadratic equation, b² - c: both are large for a distant
    // circle, and their difference has few digits.
    let half_chord = (radius * radius - across * across).max(T::ZERO);
    Some((-along - half_chord.sqrt()).max(T::ZERO))
}

/// [`contact_points`](super::contact_points) of shapes of which one has a slanted core: the middle of
/// the overlap at the corner, or along the side, of each core that is farthest towards the other.
pub(super) fn contact_points<T: Scalar>(
    a: &Shape<T>,
    b: &Shape<T>,
    (normal, depth): ([T; 2], T),
) -> [[T; 2]; 2] {
    let half = depth * T::from_f64(0.5);
    let by = |[x, y]: [T; 2], far: T| [x + normal[0] * far, y + normal[1] * far];
    let (first, second) = (farthest(a, normal), farthest(b, normal.map(|v| -v)));
    let (inwards, outwards) = (a.radius - half, half - b.radius);
    let none = [T::NAN; 2];
    // A corner of either core is the place, whatever the side of the other is like.
    if first[0] == first[1] {
        return [by(first[0], inwards), none];
    }
    if second[0] == second[1] {
        return [by(second[0], outwards), none];
    }
    // The common part of both sides, along the direction of the first.
    let along = [-normal[1], normal[0]];
    let at = |point: [T; 2]| dot(minus(point, first[0]), along);
    let range = |[start, end]: [[T; 2]; 2]| (at(start).min(at(end)), at(start).max(at(end)));
    let (own, other) = (range(first), range(second));
    let (low, high) = (own.0.max(other.0), own.1.min(other.1));
    let point = |far: T| by([0, 1].map(|axis| first[0][axis] + along[axis] * far), inwards);
    if low >= high {
        return [point(low), none];
    }
    let (one, two) = (point(low), point(high));
    if one <= two { [one, two] } else { [two, one] }
}

/// The ends of the side of a core that is farthest in a direction; twice the same corner if it is one.
fn farthest<T: Scalar>(shape: &Shape<T>, direction: [T; 2]) -> [[T; 2]; 2] {
    if shape.is_slanted() {
        let [start, end] = shape.line();
        let [x, y] = [0, 1].map(|axis| (end[axis] - start[axis]) * direction[axis]);
        // Across the segment up to rounding.
        if (x + y).abs() <= (x.abs() + y.abs()) * T::EPSILON * T::from_f64(64.0) {
            return [start, end];
        }
        return if x + y > T::ZERO { [end; 2] } else { [start; 2] };
    }
    let [min_x, min_y, max_x, max_y] = shape.sides();
    let (min, max) = ([min_x, min_y], [max_x, max_y]);
    let side = |upper: bool| {
        [0, 1].map(|axis| {
            let zero = direction[axis] == T::ZERO;
            if direction[axis] > T::ZERO || (zero && upper) { max[axis] } else { min[axis] }
        })
    };
    [side(false), side(true)]
}
