//! A moving shape and a line segment.
//!
//! The shape meets the segment if its centre enters the Minkowski sum of both: a hexagon, the hull
//! of the core of the shape at both ends, with rounded corners. For a disc the hexagon is the
//! segment itself, whose sides face in both directions.

use super::cast::into_disc;
use jostle_index::geometry::{self, Scalar, Shape, length};

/// The corners of the hexagon, counterclockwise, relative to the centre of the shape. Some coincide
/// if the shape is a disc or the segment is along an axis.
type Hexagon<T> = [[T; 2]; 6];

/// A side of the hexagon.
struct Side<T> {
    /// Whether it is parallel to the segment, and not a side of the shape at one of the ends.
    is_along: bool,
    start: [T; 2],
    /// Unit vector along it.
    along: [T; 2],
    length: T,
}

impl<T: Scalar> Side<T> {
    /// The outer unit normal.
    fn normal(&self) -> [T; 2] {
        [self.along[1], T::ZERO - self.along[0]]
    }

    /// Distance of the point (0, 0) from the line, positive outside.
    fn outside(&self) -> T {
        let normal = self.normal();
        T::ZERO - (normal[0] * self.start[0] + normal[1] * self.start[1])
    }

    /// Distance from (0, 0) to the line moved outwards by `by`, and by how much `v` comes nearer.
    fn approach(&self, by: T, v: [T; 2]) -> (T, T) {
        let normal = self.normal();
        (self.outside() - by, T::ZERO - (v[0] * normal[0] + v[1] * normal[1]))
    }

    /// Position of a point along the line, from the start.
    fn position(&self, point: [T; 2]) -> T {
        let [x, y] = [point[0] - self.start[0], point[1] - self.start[1]];
        x * self.along[0] + y * self.along[1]
    }

    /// The vector from the nearest point of the side to (0, 0).
    fn offset(&self) -> [T; 2] {
        let at = self.position([T::ZERO; 2]).max(T::ZERO).min(self.length);
        [0, 1].map(|axis| T::ZERO - (self.start[axis] + self.along[axis] * at))
    }
}

/// The first side along the segment is the second one, the other the fifth.
fn hexagon<T: Scalar>(body: &Shape<T>, ends: &[[T; 2]; 2]) -> Hexagon<T> {
    let [mut a, mut b] = ends.map(|end| [end[0] - body.min[0], end[1] - body.min[1]]);
    // With the ends ordered by x there are two cases: rising and falling.
    if b[0] < a[0] {
        (a, b) = (b, a);
    }
    let [w, h] = body.half_size;
    let corner = |end: [T; 2], x: T, y: T| [end[0] + x, end[1] + y];
    if b[1] >= a[1] {
        let second = [corner(b, w, -h), corner(b, w, h), corner(b, -w, h)];
        [corner(a, -w, -h), corner(a, w, -h), second[0], second[1], second[2], corner(a, -w, h)]
    } else {
        let second = [corner(b, -w, -h), corner(b, w, -h), corner(b, w, h)];
        [corner(a, -w, h), corner(a, -w, -h), second[0], second[1], second[2], corner(a, w, h)]
    }
}

/// The sides that are not points.
fn sides<T: Scalar>(hexagon: &Hexagon<T>) -> impl Iterator<Item = Side<T>> {
    (0..6).filter_map(|index| {
        let (start, end) = (hexagon[index], hexagon[(index + 1) % 6]);
        let d = [end[0] - start[0], end[1] - start[1]];
        let length = length(d[0].abs(), d[1].abs());
        // In both cases of `hexagon` the sides 1 and 4 join the two ends.
        let is_along = index % 3 == 1;
        (length > T::ZERO).then(|| Side { is_along, start, along: d.map(|v| v / length), length })
    })
}

/// Distance of (0, 0) from the hexagon with the outward normal at the nearest point; the distance
/// is negative inside. A segment that is a point, with a disc, has one corner and no side.
fn distance<T: Scalar>(hexagon: &Hexagon<T>) -> (T, [T; 2]) {
    let deepest = sides(hexagon).map(|side| (side.outside(), side.normal()));
    let (outside, normal) = deepest
        .reduce(|a, b| if b.0 > a.0 { b } else { a })
        .unwrap_or((T::ZERO, [T::ONE, T::ZERO]));
    // Inside: the nearest side is the one of which the point is least deep.
    if outside < T::ZERO {
        return (outside, normal);
    }
    let corner = hexagon[0].map(|v| T::ZERO - v);
    // The corner is for a segment that is a point and a disc: then no side has a length.
    let offsets = sides(hexagon).map(|side| side.offset()).chain([corner]);
    let measured = offsets.map(|v| (length(v[0].abs(), v[1].abs()), v));
    let nearest = measured.reduce(|a, b| if b.0 < a.0 { b } else { a });
    match nearest {
        Some((distance, [x, y])) if distance > T::ZERO => (distance, [x / distance, y / distance]),
        _ => (T::ZERO, normal),
    }
}

/// Whether a shape given by its centre overlaps a segment; touching is not overlapping.
pub(crate) fn overlaps<T: Scalar>(body: &Shape<T>, ends: &[[T; 2]; 2]) -> bool {
    let [x, y] = gaps(body, ends);
    let radius = body.radius;
    // Quick, and right for segments along an axis whatever the rounding below.
    // The gaps come from coordinates by one subtraction, so a box that stands exactly on a
    // horizontal segment is not called an overlap. The normals of the hexagon below are rounded.
    if x > radius || y > radius || (radius == T::ZERO && (x >= T::ZERO || y >= T::ZERO)) {
        return false;
    }
    distance(&hexagon(body, ends)).0 < radius
}

/// The unit normal from a shape towards a segment, and the depth of their overlap.
pub(crate) fn contact<T: Scalar>(body: &Shape<T>, ends: &[[T; 2]; 2]) -> ([T; 2], T) {
    let (distance, normal) = distance(&hexagon(body, ends));
    (normal.map(|v| T::ZERO - v), body.radius - distance)
}

/// The gaps between the core of a shape and the bounding box of a segment along each axis.
fn gaps<T: Scalar>(body: &Shape<T>, [a, b]: &[[T; 2]; 2]) -> [T; 2] {
    let corners = [[a[0].min(b[0]), a[1].min(b[1])], [a[0].max(b[0]), a[1].max(b[1])]];
    geometry::gaps([body.min, body.max], corners, body.half_size)
}

/// As [`cast::enters`](super::cast::enters), for a segment.
pub(crate) fn enters<T: Scalar>(
    body: &Shape<T>,
    displacement: [T; 2],
    ends: &[[T; 2]; 2],
    slop: T,
) -> Option<(T, [T; 2])> {
    let hexagon = hexagon(body, ends);
    // A disc that is smaller than the slop stops before its centre is on the other side.
    // Never 0 for a disc: the sum would be the segment itself, and a disc whose centre has crossed
    // it would be on the other side. Half of its radius keeps the centre on its own side.
    let radius = (body.radius - slop).max(body.radius * T::from_f64(0.5));
    if body.radius == T::ZERO {
        return into_convex(&hexagon, displacement, slop);
    }
    let through_side = |side: Side<T>| {
        let (clearance, approach) = side.approach(radius, displacement);
        if !(approach > T::ZERO && clearance >= T::ZERO && clearance <= approach) {
            return None;
        }
        let share = clearance / approach;
        let position = side.position(displacement.map(|v| v * share));
        // A little beyond its ends, so that rounding leaves no gap between a side and the disc at
        // its corner.
        (-slop <= position && position <= side.length + slop).then(|| (share, side.normal()))
    };
    let through_corner =
        hexagon.iter().filter_map(|&corner| into_disc(corner, radius, displacement));
    let hits = sides(&hexagon).filter_map(through_side).chain(through_corner);
    hits.reduce(|a, b| if b.0 < a.0 { b } else { a })
}

/// The share of `v` at which the point (0, 0), which is outside, enters a hexagon by more than
/// `slop`: the part of its path in all half-planes (Cyrus and Beck).
///
/// Sides along the segment are moved inwards by more than those at its ends, so that where a slope
/// begins at a floor, a box meets the slope and not the end of it.
fn into_convex<T: Scalar>(hexagon: &Hexagon<T>, v: [T; 2], slop: T) -> Option<(T, [T; 2])> {
    let (mut enter, mut leave) = (-T::INFINITY, T::INFINITY);
    let mut normal = [T::ZERO; 2];
    for side in sides(hexagon) {
        // Not too much: three slops are still far below any size that a user sees.
        let inwards = if side.is_along { slop + slop + slop } else { slop };
        let (clearance, approach) = side.approach(-inwards, v);
        if approach == T::ZERO {
            if clearance >= T::ZERO {
                return None;
            }
        } else if approach > T::ZERO {
            if clearance / approach > enter {
                (enter, normal) = (clearance / approach, side.normal());
            }
        } else {
            leave = leave.min(clearance / approach);
        }
    }
    (enter < leave && T::ZERO <= enter && enter <= T::ONE).then_some((enter, normal))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(center: [f64; 2], half_size: [f64; 2], radius: f64) -> Shape<f64> {
        Shape { min: center, max: center, half_size, radius, category: 1, mask: 1 }
    }

    const SLOPE: [[f64; 2]; 2] = [[0.0, 0.0], [4.0, 3.0]];

    #[test]
    fn a_disc_meets_a_slope_from_both_sides() {
        for (start, step, normal) in
            [([2.0, 5.0], [0.0, -5.0], [-0.6, 0.8]), ([2.0, -5.0], [0.0, 10.0], [0.6, -0.8])]
        {
            let disc = body(start, [0.0; 2], 1.0);
            let (share, found) = enters(&disc, step, &SLOPE, 0.0).unwrap();
            let end = [start[0] + step[0] * share, start[1] + step[1] * share];
            assert!((0..2).all(|k| (found[k] - normal[k]).abs() < 1e-12), "{found:?}");
            assert!(((end[0] * 3.0 - end[1] * 4.0).abs() / 5.0 - 1.0).abs() < 1e-12);
            assert!(!overlaps(&disc, &SLOPE));
        }
    }

    #[test]
    fn a_disc_smaller_than_the_slop_does_not_pass() {
        for (start, step) in [(1.0, -2.0), (-1.0, 2.0)] {
            let disc = body([3.0, start], [0.0; 2], 1e-3);
            let floor = [[0.0, 0.0], [6.0, 0.0]];
            let (share, _) = enters(&disc, [0.0, step], &floor, 5e-3).unwrap();
            let end = start + step * share;
            assert!(end * start > 0.0 && end.abs() <= 1e-3, "{end}");
        }
    }

    #[test]
    fn a_box_meets_a_slope_with_its_corner() {
        let walker = body([2.0, 6.0], [0.5, 1.0], 0.0);
        let (share, normal) = enters(&walker, [0.0, -9.0], &SLOPE, 0.0).unwrap();
        // The lower right corner, at x = 2.5, touches the slope at y = 1.875.
        assert!((6.0 - 9.0 * share - 1.0 - 1.875).abs() < 1e-12, "{share}");
        assert!((normal[0] + 0.6).abs() < 1e-12 && (normal[1] - 0.8).abs() < 1e-12);
    }

    #[test]
    fn a_box_at_the_foot_of_a_slope_meets_the_slope() {
        let slope = [[100.0, 100.0], [160.0, 60.0]];
        let starts = [(94.0, [3.0, 0.0]), (95.0 - 1e-13, [3.0, 2.0]), (95.0, [3.0, 2.0])];
        for (x, step) in starts {
            let walker = body([x, 92.0], [5.0, 8.0], 0.0);
            let (_, normal) = enters(&walker, step, &slope, 1e-12).unwrap();
            assert!((normal[1] + 0.832).abs() < 1e-3, "{x} {step:?} {normal:?}");
        }
        // Onto the end of a wall, from where it touches it.
        let post = [[0.0, 0.0], [0.0, 9.0]];
        let walker = body([1.0, -8.0], [5.0, 8.0], 0.0);
        let (share, normal) = enters(&walker, [0.0, 50.0], &post, 1e-12).unwrap();
        assert!(share < 1e-12 && normal == [0.0, -1.0]);
        assert_eq!(enters(&walker, [50.0, 0.0], &post, 1e-12), None);
    }

    #[test]
    fn the_ends_are_round_for_a_disc() {
        let disc = body([-5.0, 0.5], [0.0; 2], 1.0);
        let (share, normal) = enters(&disc, [10.0, 0.0], &[[0.0, 0.0], [0.0, -9.0]], 0.0).unwrap();
        let before = 0.75f64.sqrt();
        assert!((share * 10.0 - (5.0 - before)).abs() < 1e-12);
        assert!((normal[0] + before).abs() < 1e-12 && (normal[1] - 0.5).abs() < 1e-12);
        let point = [[0.0, 0.0], [0.0, 0.0]];
        assert!(enters(&disc, [10.0, 0.0], &point, 0.0).is_some());
        assert!(overlaps(&body([0.5, 0.0], [0.0; 2], 1.0), &point));
    }

    #[test]
    fn touching_is_not_overlapping() {
        let wall = [[0.0, 0.0], [9.0, 0.0]];
        assert!(!overlaps(&body([4.0, 1.0], [0.0; 2], 1.0), &wall));
        assert!(!overlaps(&body([4.0, 1.0], [1.0; 2], 0.0), &wall));
        assert!(overlaps(&body([4.0, 0.99], [1.0; 2], 0.0), &wall));
        let (normal, depth) = contact(&body([4.0, 0.75], [1.0; 2], 0.0), &wall);
        assert!(normal == [0.0, -1.0] && depth == 0.25, "{normal:?} {depth}");
    }
}
