//! A rounded box as an obstacle.
//!
//! The Minkowski sum of it and a moving shape is a rounded box too: the union of two boxes and a
//! disc at each corner.

use super::convex::into_disc;
use super::outline::Outline;
use jostle_index::geometry::{self, Scalar, Shape, overlap};

impl<T: Scalar> Outline<T> for Shape<T> {
    #[inline(always)]
    fn overlaps(&self, body: &Shape<T>) -> bool {
        overlap(body.gaps(self), body.radius + self.radius)
    }

    fn contact(&self, body: &Shape<T>) -> ([T; 2], T) {
        geometry::contact(body, self)
    }

    fn enters(&self, body: &Shape<T>, displacement: [T; 2], slop: T) -> Option<(T, [T; 2])> {
        let corner = |axis: usize| {
            let halves = body.half_size[axis] + self.half_size[axis];
            let low = (self.min[axis] - body.max[axis]) - halves;
            [low, (self.max[axis] - body.min[axis]) + halves]
        };
        let (x, y) = (corner(0), corner(1));
        let radius_sum = body.radius + self.radius;
        // Two boxes: no corners to round, and the slop makes the box smaller on all sides instead of
        // the radius.
        if radius_sum == T::ZERO {
            return into_box(shrunk(x, slop), shrunk(y, slop), displacement);
        }
        // A path along a surface is inside by a rounding error as often as outside. Only what goes
        // deeper than the slop is an impact, so a shape that slides does not get stuck on what it
        // slides along.
        let radius = (radius_sum - slop).max(T::ZERO);
        let into_corner = |x: T, y: T| into_disc([x, y], radius, displacement);
        if x[0] == x[1] && y[0] == y[1] {
            return into_corner(x[0], y[0]);
        }
        let tests = [
            into_box(shrunk(x, -radius), y, displacement),
            into_box(x, shrunk(y, -radius), displacement),
            into_corner(x[0], y[0]),
            into_corner(x[1], y[0]),
            into_corner(x[0], y[1]),
            into_corner(x[1], y[1]),
        ];
        // The first of the six: the union is convex, so the path enters it where it first enters a
        // part.
        tests.into_iter().flatten().reduce(|a, b| if b.0 < a.0 { b } else { a })
    }

    fn span(&self, body: &Shape<T>) -> T {
        let [x, y] = body.gaps(self);
        x.max(T::ZERO) + y.max(T::ZERO)
    }

    fn is_above(&self, body: &Shape<T>, up: [T; 2], slop: T) -> bool {
        let half = T::from_f64(0.5);
        let height = |shape: &Shape<T>| {
            let center = shape.center();
            let along = |axis: usize| {
                let own = (shape.max[axis] - shape.min[axis]) * half + shape.half_size[axis];
                own * up[axis].abs()
            };
            (center[0] * up[0] + center[1] * up[1], along(0) + along(1) + shape.radius)
        };
        let ((own, own_half), (other, other_half)) = (height(body), height(self));
        own - own_half >= other + other_half - slop
    }

    fn numbers(&self) -> [T; 8] {
        let Self { min, max, half_size, radius, .. } = *self;
        [T::ZERO, min[0], min[1], max[0], max[1], half_size[0], half_size[1], radius]
    }
}

#[inline(always)]
fn shrunk<T: Scalar>([low, high]: [T; 2], by: T) -> [T; 2] {
    [low + by, high - by]
}

/// The share of `v` at which the point (0, 0), which is outside, enters an open box.
fn into_box<T: Scalar>(x: [T; 2], y: [T; 2], v: [T; 2]) -> Option<(T, [T; 2])> {
    let (mut enter, mut leave) = (-T::INFINITY, T::INFINITY);
    let mut normal = [T::ZERO; 2];
    for (axis, [low, high]) in [x, y].into_iter().enumerate() {
        if v[axis] == T::ZERO {
            // Parallel to the axis: inside the slab for the whole path or never. An open interval,
            // since a box that only touches does not stop the motion along it.
            if !(low < T::ZERO && T::ZERO < high) {
                return None;
            }
            continue;
        }
        let (first, last) = if v[axis] > T::ZERO { (low, high) } else { (high, low) };
        let from = first / v[axis];
        // The last slab entered is the side that is met. At a corner exactly the first axis wins,
        // always the same one.
        if from > enter {
            enter = from;
            normal = [T::ZERO; 2];
            normal[axis] = if v[axis] > T::ZERO { -T::ONE } else { T::ONE };
        }
        leave = leave.min(last / v[axis]);
    }
    (enter < leave && T::ZERO <= enter && enter <= T::ONE).then_some((enter, normal))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(center: [f64; 2], half_size: [f64; 2], radius: f64) -> Shape<f64> {
        Shape {
            min: center,
            max: center,
            half_size,
            radius,
            category: 1,
            mask: 1,
            core: jostle_index::Core::Box,
        }
    }

    #[test]
    fn a_box_meets_a_box() {
        let (moving, wall) = (body([0.0, 0.0], [1.0, 1.0], 0.0), body([5.0, 0.5], [1.0, 1.0], 0.0));
        assert_eq!(wall.enters(&moving, [6.0, 0.0], 0.0), Some((0.5, [-1.0, 0.0])));
        assert_eq!(wall.enters(&moving, [2.0, 0.0], 0.0), None);
        assert_eq!(wall.enters(&moving, [6.0, 20.0], 0.0), None);
    }

    #[test]
    fn touching_along_a_surface_is_no_impact() {
        let (moving, floor) =
            (body([0.0, 0.0], [1.0, 1.0], 0.0), body([9.0, 2.0], [3.0, 1.0], 0.0));
        assert_eq!(floor.enters(&moving, [50.0, 0.0], 1e-12), None);
        assert!(floor.enters(&moving, [50.0, 1.0], 1e-12).is_some());
    }

    #[test]
    fn a_disc_meets_a_corner_and_a_disc() {
        let disc = body([0.0, 0.0], [0.0; 2], 1.0);
        let wall = |y| body([4.0, y], [2.0, 1.0], 0.0);
        let (share, normal) = wall(1.5).enters(&disc, [10.0, 0.0], 0.0).unwrap();
        let before = 0.75f64.sqrt();
        assert!((share - (2.0 - before) / 10.0).abs() < 1e-12);
        assert!((normal[0] + before).abs() < 1e-12 && (normal[1] + 0.5).abs() < 1e-12);
        // Past the corner, which it only touches.
        assert_eq!(wall(2.0).enters(&disc, [10.0, 0.0], 0.0), None);
        let other = body([6.0, 0.0], [0.0; 2], 2.0);
        assert_eq!(other.enters(&disc, [10.0, 0.0], 0.0), Some((0.3, [-1.0, 0.0])));
    }
}
