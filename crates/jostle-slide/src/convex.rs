//! The point (0, 0) and a convex polygon with rounded corners: the time of impact.
//!
//! A moving shape meets an obstacle if its centre enters the Minkowski sum of both, which is such a
//! polygon, relative to the centre. Some of its corners may coincide.

use jostle_index::geometry::{Scalar, length};

/// The corners of a polygon, counterclockwise where y grows upwards.
pub(crate) struct Convex<'a, T> {
    pub corners: &'a [[T; 2]],
    /// Whether the side from a corner to the next one is one of the obstacle.
    pub is_own: fn(usize) -> bool,
}

/// A side that is not a point.
struct Side<T> {
    /// Whether it is a side of the obstacle, and not one of the moving shape.
    is_own: bool,
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
}

impl<T: Scalar> Convex<'_, T> {
    fn sides(&self) -> impl Iterator<Item = Side<T>> {
        (0..self.corners.len()).filter_map(|index| {
            let (start, end) =
                (self.corners[index], self.corners[(index + 1) % self.corners.len()]);
            let d = [end[0] - start[0], end[1] - start[1]];
            let length = length(d[0].abs(), d[1].abs());
            let is_own = (self.is_own)(index);
            (length > T::ZERO).then(|| Side { is_own, start, along: d.map(|v| v / length), length })
        })
    }

    /// The share of `v` at which (0, 0), which is outside, enters the polygon with this radius by
    /// more than `slop`.
    pub(crate) fn enters(&self, radius: T, v: [T; 2], slop: T) -> Option<(T, [T; 2])> {
        if radius == T::ZERO {
            return self.enters_sharp(v, slop);
        }
        // A disc that is smaller than the slop stops before its centre is on the other side.
        // Never 0 for a disc: the sum would be the segment itself, and a disc whose centre has
        // crossed it would be on the other side. Half of its radius keeps the centre on its own
        // side.
        let radius = (radius - slop).max(radius * T::from_f64(0.5));
        let through_side = |side: Side<T>| {
            let (clearance, approach) = side.approach(radius, v);
            if !(approach > T::ZERO && clearance >= T::ZERO && clearance <= approach) {
                return None;
            }
            let share = clearance / approach;
            let position = side.position(v.map(|v| v * share));
            // A little beyond its ends, so that rounding leaves no gap between a side and the disc
            // at its corner.
            (-slop <= position && position <= side.length + slop).then(|| (share, side.normal()))
        };
        let through_corner = self.corners.iter().filter_map(|&corner| into_disc(corner, radius, v));
        let hits = self.sides().filter_map(through_side).chain(through_corner);
        hits.reduce(|a, b| if b.0 < a.0 { b } else { a })
    }

    /// As [`enters`](Self::enters), without a radius: the part of the path in all half-planes
    /// (Cyrus and Beck).
    ///
    /// Sides of the obstacle are moved inwards by more than those of the moving shape. So a box
    /// meets a slope and not its end, where it begins at a floor.
    fn enters_sharp(&self, v: [T; 2], slop: T) -> Option<(T, [T; 2])> {
        let (mut enter, mut leave) = (-T::INFINITY, T::INFINITY);
        let mut normal = [T::ZERO; 2];
        for side in self.sides() {
            // Not too much: three slops are still far below any visible length.
            let inwards = if side.is_own { slop + slop + slop } else { slop };
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
}

/// The share of `v` at which the point (0, 0), which is outside, enters a disc.
pub(crate) fn into_disc<T: Scalar>(center: [T; 2], radius: T, v: [T; 2]) -> Option<(T, [T; 2])> {
    let length = (v[0] * v[0] + v[1] * v[1]).sqrt();
    if length == T::ZERO {
        return None;
    }
    let u = [v[0] / length, v[1] / length];
    let along = center[0] * u[0] + center[1] * u[1];
    let across = (center[0] * u[1] - center[1] * u[0]).abs();
    if !(along > T::ZERO && across < radius) {
        return None;
    }
    // Factored: `radius² - across²` loses the digits of a grazing path to cancellation.
    let distance = along - ((radius - across) * (radius + across)).sqrt();
    let share = distance / length;
    if !(T::ZERO <= distance && share <= T::ONE) {
        return None;
    }
    let [x, y] = [u[0] * distance - center[0], u[1] * distance - center[1]];
    let norm = (x * x + y * y).sqrt();
    Some((share, [x / norm, y / norm]))
}
