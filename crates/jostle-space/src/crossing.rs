//! Whether two shapes that move along straight lines overlap on the way.
//!
//! The first shape is at rest in the frame of the second one. Then the Minkowski difference of the two cores, a box or
//! a polygon, moves along a straight line. The shapes overlap while the origin is nearer to it than the sum of the
//! radii.
//! The casts of `jostle-slide` tell when that begins, rounded; here only the answer is needed, and it has to agree
//! with [`Shape::overlaps`] at both ends. So nothing is divided: times are compared as fractions.

use jostle_index::geometry::{self, Scalar, Shape, Side, into_range, length};
use jostle_index::period::Period;

/// A shape at the beginning and at the end of a motion.
pub(super) type Motion<T> = [Shape<T>; 2];

/// The Minkowski difference of two boxes: its lower and its upper side along each axis.
type Difference = [[f64; 2]; 2];

/// Images of a periodic shape that may be met on the way, in each direction: a path is at most half a period long, so
/// two shapes whose centres are in the first period at the end are at most two periods apart before.
const IMAGES: i32 = 2;

/// Whether two shapes overlap neither at the beginning nor at the end of their motions, and overlap at a time in
/// between. Both move at constant velocities during the same time. With a period, any of their images may meet.
pub(super) fn cross<T: Scalar>(a: &Motion<T>, b: &Motion<T>, period: &Period<T>) -> bool {
    let mut any = false;
    for y in images_along(period, 1) {
        for x in images_along(period, 0) {
            // The higher centre is moved downwards, as in `Period::overlap`, and not the other one upwards: so the
            // answer does not depend on the order of the two, and rounding is the same.
            let down = |turns: [i32; 2]| period.span(turns.map(|turns| turns.max(0)));
            let [of_a, of_b] = [down([x, y]), down([-x, -y])];
            let (a, b) = (a.map(|shape| shape.moved(of_a)), b.map(|shape| shape.moved(of_b)));
            if (0..2).any(|end| a[end].overlaps(&b[end])) {
                return false;
            }
            any |= if a[0].is_slanted() || b[0].is_slanted() {
                passes_slanted(&a, &b)
            } else {
                let ends = [0, 1].map(|end| difference(&a[end], &b[end]));
                passes(&ends.map(exact), (a[1].radius + b[1].radius).to_f64())
            };
        }
    }
    any
}

fn images_along<T: Scalar>(period: &Period<T>, axis: usize) -> std::ops::RangeInclusive<i32> {
    if period.is_along(axis) { -IMAGES..=IMAGES } else { 0..=0 }
}

/// With the roundings of [`Shape::gaps`].
fn difference<T: Scalar>(a: &Shape<T>, b: &Shape<T>) -> [[T; 2]; 2] {
    [0, 1].map(|axis| {
        let half_sizes = a.half_size[axis] + b.half_size[axis];
        [(b.min[axis] - a.max[axis]) - half_sizes, (b.max[axis] - a.min[axis]) + half_sizes]
    })
}

/// In float64 no product of float32 numbers is rounded or out of range.
fn exact<T: Scalar>(sides: [[T; 2]; 2]) -> Difference {
    sides.map(|side| side.map(T::to_f64))
}

/// Whether the origin is within a distance of a moving box at a time between the beginning and the end.
fn passes(ends: &[Difference; 2], distance: f64) -> bool {
    let [start, end] = ends;
    // Most candidates: on the whole way there is a gap along one axis.
    let is_apart = |axis: usize| {
        let ([low, high], [to_low, to_high]) = (start[axis], end[axis]);
        low.min(to_low) >= distance || -high.max(to_high) >= distance
    };
    if is_apart(0) || is_apart(1) {
        return false;
    }
    let largest =
        start.iter().chain(end).flatten().fold(distance, |most, side| most.max(side.abs()));
    let [into, _] = into_range(largest);
    let (scaled, radius) =
        (ends.map(|sides| sides.map(|side| side.map(|v| v * into))), distance * into);
    if radius == 0.0 {
        return sweeps_origin(&scaled, [0.0; 2]);
    }
    // The points within a radius of a box are the union of two larger boxes and a disc at each corner.
    let corner = |x: usize, y: usize| scaled.map(|sides| [sides[0][x], sides[1][y]]);
    sweeps_origin(&scaled, [radius, 0.0])
        || sweeps_origin(&scaled, [0.0, radius])
        || [[0, 0], [1, 0], [0, 1], [1, 1]].iter().any(|&[x, y]| nears_origin(corner(x, y), radius))
}

/// Whether the origin is inside a moving box, made larger by `by` on each side, at a time in between.
fn sweeps_origin([start, end]: &[Difference; 2], by: [f64; 2]) -> bool {
    let sides = (0..2).flat_map(|axis| {
        let ([low, high], [to_low, to_high]) = (start[axis], end[axis]);
        [[low - by[axis], to_low - by[axis]], [-high - by[axis], -to_high - by[axis]]]
    });
    are_below_zero_at_once(sides)
}

/// Whether values that change evenly are all below 0 at a time in between. Each is given at the beginning and at the
/// end.
fn are_below_zero_at_once(values: impl Iterator<Item = [f64; 2]>) -> bool {
    // Each side of a polygon is beyond the origin during an interval of time, and the origin is inside while all are.
    // The latest beginning and the earliest end are fractions with positive denominators.
    let (mut first, mut last) = ([0.0, 1.0], [1.0, 1.0]);
    for [from, to] in values {
        match (from < 0.0, to < 0.0) {
            (true, true) => {}
            (false, true) => first = later(first, [from, from - to]),
            (true, false) => last = earlier(last, [-from, to - from]),
            (false, false) => return false,
        }
    }
    is_before(first, last)
}

/// As [`passes`], if the core of one of the shapes is a slanted segment: then the difference of the cores is a polygon
/// with up to six sides.
fn passes_slanted<T: Scalar>(a: &Motion<T>, b: &Motion<T>) -> bool {
    let [start, end] = geometry::Difference::of_motions([a, b]);
    let radius = start.radius().to_f64();
    let outwards = |side: &Side<T>| -side.inwards().to_f64();
    if radius == 0.0 {
        return are_below_zero_at_once(
            start.sides_with(&end).map(|both| both.map(|side| outwards(&side))),
        );
    }
    // The origin is outside at both ends. On its way it is nearest to the polygon at a corner, unless it passes through
    // a side.
    start.sides_with(&end).any(|both| {
        let corners = both.map(|side| side.start.map(T::to_f64));
        let next = both.map(|side| side.end.map(T::to_f64));
        nears_origin(corners, radius)
            || (differ(both.map(|side| outwards(&side)))
                && differ([corners, next].map(left_of_path)))
    })
}

/// Whether two numbers have different signs, and none is 0.
fn differ([a, b]: [f64; 2]) -> bool {
    a < 0.0 && 0.0 < b || b < 0.0 && 0.0 < a
}

/// On which side of the origin a moving point passes.
fn left_of_path([start, end]: [[f64; 2]; 2]) -> f64 {
    let [x, y] = [end[0] - start[0], end[1] - start[1]];
    start[0] * y - start[1] * x
}

fn is_before([a, b]: [f64; 2], [c, d]: [f64; 2]) -> bool {
    a * d < c * b
}

fn later(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    if is_before(a, b) { b } else { a }
}

fn earlier(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    if is_before(b, a) { b } else { a }
}

/// Whether a moving point is nearer to the origin than a radius at a time in between, and nearest then.
fn nears_origin([start, end]: [[f64; 2]; 2], radius: f64) -> bool {
    let [x, y] = [end[0] - start[0], end[1] - start[1]];
    // It comes nearer at the beginning and goes away at the end; otherwise it is nearest at one of these, where the
    // shapes are known not to overlap.
    let approaches = start[0] * x + start[1] * y < 0.0;
    let leaves = end[0] * x + end[1] * y > 0.0;
    // The distance of the line times the length of the path. For whole numbers both sides are exact where they are
    // equal, so touching is not overlapping here either.
    approaches && leaves && left_of_path([start, end]).abs() < radius * length(x.abs(), y.abs())
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

    fn moving(from: [f64; 2], to: [f64; 2], half_size: [f64; 2], radius: f64) -> Motion<f64> {
        [body(from, half_size, radius), body(to, half_size, radius)]
    }

    /// Both orders, and both directions of time, have the same answer.
    fn crosses(a: &Motion<f64>, b: &Motion<f64>, period: &Period<f64>) -> bool {
        let [a_back, b_back] = [[a[1], a[0]], [b[1], b[0]]];
        let answers = [cross(a, b, period), cross(b, a, period), cross(&a_back, &b_back, period)];
        assert!(answers.iter().all(|answer| *answer == answers[0]), "{answers:?}");
        answers[0]
    }

    #[test]
    fn discs_cross_if_their_paths_come_near_enough() {
        let none = Period::default();
        let rock = |y| moving([50.0, y], [50.0, y], [0.0; 2], 2.0);
        let shot = moving([0.0, 0.0], [100.0, 0.0], [0.0; 2], 1.0);
        for (y, expected) in
            [(0.0, true), (2.875, true), (3.0, false), (-2.875, true), (-3.0, false)]
        {
            assert_eq!(crosses(&shot, &rock(y), &none), expected, "{y}");
        }
        // Touching exactly along an oblique line: 5 times the distance of 3.
        let slanted = moving([0.0, -5.0], [40.0, 25.0], [0.0; 2], 1.0);
        let near = |by: f64| {
            moving(
                [20.0 - 0.6 * by, 10.0 + 0.8 * by],
                [20.0 - 0.6 * by, 10.0 + 0.8 * by],
                [0.0; 2],
                2.0,
            )
        };
        assert!(crosses(&slanted, &near(2.9), &none) && !crosses(&slanted, &near(5.0), &none));
        // Both move, and only their common motion tells.
        let other = moving([100.0, 0.0], [0.0, 0.0], [0.0; 2], 1.0);
        let late = moving([50.0, 60.0], [50.0, -20.0], [0.0; 2], 1.0);
        assert!(crosses(&shot, &other, &none) && !crosses(&shot, &late, &none));
    }

    #[test]
    fn boxes_cross_through_their_interior() {
        let none = Period::default();
        let bar = |x: f64, y| moving([x, y], [x, y], [1.0, 1.0], 0.0);
        let bullet = moving([0.0, 0.0], [10.0, 10.0], [0.5, 0.5], 0.0);
        assert!(crosses(&bullet, &bar(5.0, 5.0), &none) && crosses(&bullet, &bar(6.0, 4.0), &none));
        // Corners that meet in passing only touch.
        assert!(
            !crosses(&bullet, &bar(6.5, 3.5), &none) && crosses(&bullet, &bar(6.5, 3.625), &none)
        );
        let along = moving([0.0, 1.5], [10.0, 1.5], [0.5, 0.5], 0.0);
        assert!(!crosses(&along, &bar(5.0, 0.0), &none));
        // A corner rounded by the radius of a disc.
        let disc = |y| moving([0.0, y], [10.0, y], [0.0; 2], 1.0);
        assert!(
            crosses(&disc(1.875), &bar(5.0, 0.0), &none)
                && !crosses(&disc(2.0), &bar(5.0, 0.0), &none)
        );
    }

    #[test]
    fn what_overlaps_at_an_end_does_not_cross() {
        let none = Period::default();
        let rock = moving([10.0, 0.0], [10.0, 0.0], [0.0; 2], 2.0);
        for (from, to, expected) in [
            (0.0, 9.0, false),
            (9.0, 30.0, false),
            (0.0, 8.0, false),
            (8.0, 30.0, true),
            (12.0, 30.0, false),
        ] {
            let point = moving([from, 0.0], [to, 0.0], [0.0; 2], 0.0);
            assert_eq!(crosses(&point, &rock, &none), expected, "{from} {to}");
        }
    }

    #[test]
    fn images_of_a_periodic_plane_cross() {
        let period = Period::new([20.0, 0.0]).unwrap();
        // From 1 to -4, which is 16: it passes 19.
        let shot = moving([1.0, 0.0], [-4.0, 0.0], [0.0; 2], 0.5);
        let shot = [shot[0].moved([-20.0, 0.0]), shot[1].moved([-20.0, 0.0])];
        let rock = |x: f64| moving([x, 0.0], [x, 0.0], [0.0; 2], 0.5);
        assert!(crosses(&shot, &rock(19.0), &period) && !crosses(&shot, &rock(9.0), &period));
    }

    #[test]
    fn numbers_at_the_ends_of_the_range_are_no_exception() {
        let none = Period::default();
        for scale in [1e-148, 1e148] {
            let rock = moving([0.0, 2.0 * scale], [0.0, 2.0 * scale], [0.0; 2], 2.5 * scale);
            let shot = moving([-9.0 * scale, 0.0], [9.0 * scale, 0.0], [0.0; 2], 0.0);
            assert!(crosses(&shot, &rock, &none), "{scale}");
        }
        let far = moving([-1e308, 0.0], [1e308, 0.0], [0.0; 2], 1.0);
        let _ = crosses(&far, &moving([0.0, 0.0], [0.0, 0.0], [0.0; 2], 1.0), &none);
    }
}
