//! A line segment, with a radius or without, as an obstacle.
//!
//! The Minkowski sum of it and a moving shape is a hexagon, the hull of the core of the shape at
//! both ends, with rounded corners. For a disc the hexagon is the segment itself, whose sides face
//! in both directions.

use super::convex::Convex;
use super::outline::Outline;
use jostle_index::geometry::{self, Scalar, Shape, length};

/// A shape whose core is a line segment with a length; solid from both sides.
#[derive(Clone, Copy, Debug)]
pub struct Segment<T> {
    shape: Shape<T>,
    /// The ends of its core.
    ends: [[T; 2]; 2],
}

/// The corners of the hexagon, counterclockwise, relative to the centre of the shape. Some coincide
/// if the shape is a disc or the segment is along an axis.
type Hexagon<T> = [[T; 2]; 6];

/// The sides along the segment are the second one and the fifth.
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

fn convex<T>(hexagon: &Hexagon<T>) -> Convex<'_, T> {
    // In both cases of `hexagon` the sides 1 and 4 join the two ends.
    Convex { corners: hexagon, is_own: |side| side % 3 == 1 }
}

impl<T: Scalar> Segment<T> {
    /// A shape, if its core is a line segment with a length.
    pub(crate) fn of(shape: Shape<T>) -> Option<Self> {
        let ends = shape.segment().filter(|[start, end]| start != end)?;
        Some(Self { shape, ends })
    }

    /// The shape.
    pub(crate) fn shape(&self) -> &Shape<T> {
        &self.shape
    }

    /// The same segment moved by `-shift`.
    pub(crate) fn moved(&self, shift: [T; 2]) -> Self {
        let ends = self.ends.map(|end| [end[0] - shift[0], end[1] - shift[1]]);
        Self { shape: self.shape.moved(shift), ends }
    }
}

impl<T: Scalar> Outline<T> for Segment<T> {
    fn overlaps(&self, body: &Shape<T>) -> bool {
        self.shape.overlaps(body)
    }

    fn contact(&self, body: &Shape<T>) -> ([T; 2], T) {
        geometry::contact(body, &self.shape)
    }

    fn enters(&self, body: &Shape<T>, displacement: [T; 2], slop: T) -> Option<(T, [T; 2])> {
        let hexagon = hexagon(body, &self.ends);
        convex(&hexagon).enters(body.radius + self.shape.radius, displacement, slop)
    }

    fn span(&self, body: &Shape<T>) -> T {
        let [a, b] = self.ends;
        let away =
            |axis: usize| (a[axis] - body.min[axis]).abs().max((b[axis] - body.min[axis]).abs());
        away(0) + away(1)
    }

    fn is_above(&self, body: &Shape<T>, up: [T; 2], slop: T) -> bool {
        let [a, b] = self.ends;
        let d = [b[0] - a[0], b[1] - a[1]];
        let length = length(d[0].abs(), d[1].abs());
        let across = [d[1] / length, T::ZERO - d[0] / length];
        let along_up = across[0] * up[0] + across[1] * up[1];
        // Of its line, not of its bounding box: a shape may stand on the lower end of a slope.
        let normal = if along_up < T::ZERO { across.map(|v| T::ZERO - v) } else { across };
        let height = [0, 1].map(|axis| (body.min[axis] - a[axis]) * normal[axis]);
        let extent = [0, 1].map(|axis| body.half_size[axis] * normal[axis].abs());
        let radius = body.radius + self.shape.radius;
        along_up != T::ZERO && height[0] + height[1] >= extent[0] + extent[1] + radius - slop
    }

    fn numbers(&self) -> [T; 8] {
        let [a, b] = self.ends;
        [T::ONE, a[0], a[1], b[0], b[1], self.shape.radius, T::ZERO, T::ZERO]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jostle_index::Core;

    fn body(center: [f64; 2], half_size: [f64; 2], radius: f64) -> Shape<f64> {
        Shape { min: center, max: center, half_size, radius, category: 1, mask: 1, core: Core::Box }
    }

    fn capsule(ends: [[f64; 2]; 2], radius: f64) -> Segment<f64> {
        let ([min, max], core) = Core::of_segment(ends);
        Segment::of(Shape { min, max, core, ..body([0.0; 2], [0.0; 2], radius) }).unwrap()
    }

    fn wall(ends: [[f64; 2]; 2]) -> Segment<f64> {
        capsule(ends, 0.0)
    }

    const SLOPE: [[f64; 2]; 2] = [[0.0, 0.0], [4.0, 3.0]];

    #[test]
    fn a_disc_meets_a_slope_from_both_sides() {
        for (start, step, normal) in
            [([2.0, 5.0], [0.0, -5.0], [-0.6, 0.8]), ([2.0, -5.0], [0.0, 10.0], [0.6, -0.8])]
        {
            let disc = body(start, [0.0; 2], 1.0);
            let (share, found) = wall(SLOPE).enters(&disc, step, 0.0).unwrap();
            let end = [start[0] + step[0] * share, start[1] + step[1] * share];
            assert!((0..2).all(|k| (found[k] - normal[k]).abs() < 1e-12), "{found:?}");
            assert!(((end[0] * 3.0 - end[1] * 4.0).abs() / 5.0 - 1.0).abs() < 1e-12);
            assert!(!wall(SLOPE).overlaps(&disc));
        }
    }

    #[test]
    fn a_disc_smaller_than_the_slop_does_not_pass() {
        for (start, step) in [(1.0, -2.0), (-1.0, 2.0)] {
            let disc = body([3.0, start], [0.0; 2], 1e-3);
            let floor = [[0.0, 0.0], [6.0, 0.0]];
            let (share, _) = wall(floor).enters(&disc, [0.0, step], 5e-3).unwrap();
            let end = start + step * share;
            assert!(end * start > 0.0 && end.abs() <= 1e-3, "{end}");
        }
    }

    #[test]
    fn a_box_meets_a_slope_with_its_corner() {
        let walker = body([2.0, 6.0], [0.5, 1.0], 0.0);
        let (share, normal) = wall(SLOPE).enters(&walker, [0.0, -9.0], 0.0).unwrap();
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
            let (_, normal) = wall(slope).enters(&walker, step, 1e-12).unwrap();
            assert!((normal[1] + 0.832).abs() < 1e-3, "{x} {step:?} {normal:?}");
        }
        // Onto the end of a wall, from where it touches it.
        let post = [[0.0, 0.0], [0.0, 9.0]];
        let walker = body([1.0, -8.0], [5.0, 8.0], 0.0);
        let (share, normal) = wall(post).enters(&walker, [0.0, 50.0], 1e-12).unwrap();
        assert!(share < 1e-12 && normal == [0.0, -1.0]);
        assert_eq!(wall(post).enters(&walker, [50.0, 0.0], 1e-12), None);
    }

    #[test]
    fn the_ends_are_round_for_a_disc() {
        let disc = body([-5.0, 0.5], [0.0; 2], 1.0);
        let (share, normal) =
            wall([[0.0, 0.0], [0.0, -9.0]]).enters(&disc, [10.0, 0.0], 0.0).unwrap();
        let before = 0.75f64.sqrt();
        assert!((share * 10.0 - (5.0 - before)).abs() < 1e-12);
        assert!((normal[0] + before).abs() < 1e-12 && (normal[1] - 0.5).abs() < 1e-12);
    }

    #[test]
    fn touching_is_not_overlapping() {
        let floor = [[0.0, 0.0], [9.0, 0.0]];
        assert!(!wall(floor).overlaps(&body([4.0, 1.0], [0.0; 2], 1.0)));
        assert!(!wall(floor).overlaps(&body([4.0, 1.0], [1.0; 2], 0.0)));
        assert!(wall(floor).overlaps(&body([4.0, 0.99], [1.0; 2], 0.0)));
        let (normal, depth) = wall(floor).contact(&body([4.0, 0.75], [1.0; 2], 0.0));
        assert!(normal == [0.0, -1.0] && depth == 0.25, "{normal:?} {depth}");
    }

    #[test]
    fn a_capsule_is_a_segment_with_a_radius() {
        let capsule = capsule([[0.0, 0.0], [9.0, 0.0]], 0.5);
        let walker = body([4.0, 5.0], [1.0; 2], 0.0);
        let (share, normal) = capsule.enters(&walker, [0.0, -7.0], 0.0).unwrap();
        assert!((share - 0.5).abs() < 1e-12 && normal == [0.0, 1.0]);
        assert!(capsule.overlaps(&body([4.0, 1.4], [1.0; 2], 0.0)));
        assert!(!capsule.overlaps(&body([4.0, 1.5], [1.0; 2], 0.0)));
    }

    #[test]
    fn above_a_slope_is_above_its_line() {
        let (slope, up) = (wall(SLOPE), [0.0, 1.0]);
        assert!(slope.is_above(&body([-3.0, 1.0], [1.0; 2], 0.0), up, 0.0));
        assert!(slope.is_above(&body([1.0, 3.0], [1.0; 2], 0.0), up, 0.0));
        assert!(!slope.is_above(&body([1.0, 2.0], [1.0; 2], 0.0), up, 0.0));
        assert!(!wall([[0.0, 0.0], [0.0, 9.0]]).is_above(
            &body([5.0, 3.0], [1.0; 2], 0.0),
            up,
            0.0
        ));
    }
}
