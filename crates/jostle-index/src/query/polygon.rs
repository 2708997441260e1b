//! Queries for the shapes that overlap a convex polygon, by the separating axis test.

use super::region::Region;
use super::window::Window;
use crate::geometry::{Bounds, Scalar, Shape, overlap, square_of_gaps};
use crate::period::Period;
use crate::shapes::tuple;
use jostle_base::error::{Error, Result};

/// A convex polygon. Shapes that only touch it do not overlap it.
///
/// Sides and corners are tested in float64 for both types, so that products of float32 neither
/// overflow nor underflow.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon<T> {
    sides: Vec<Side>,
    window: Window<T>,
}

/// A side of a polygon, whose interior is on the left. The vector of the side is `length · along`,
/// where `length` is a power of two and the components of `along` are at most 1, so that products
/// are finite.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Side {
    start: [f64; 2],
    along: [f64; 2],
    length: f64,
}

impl Side {
    fn new([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> Self {
        let [x, y] = [bx - ax, by - ay];
        let length = power_of_two_above(x.abs().max(y.abs()));
        Self { start: [ax, ay], along: [x / length, y / length], length }
    }

    /// Distance of a point from the line, up to a factor; positive on the left.
    fn left(&self, [x, y]: [f64; 2]) -> f64 {
        self.along[0] * (y - self.start[1]) - self.along[1] * (x - self.start[0])
    }
}

/// A power of two above `value`, at most `2 · value` if that is a normal number.
fn power_of_two_above(value: f64) -> f64 {
    2.0 * f64::from_bits(value.to_bits() & 0x7ff0_0000_0000_0000).max(f64::MIN_POSITIVE)
}

impl<T: Scalar> Polygon<T> {
    /// The polygon with these corners, clockwise or counterclockwise. Refuses a polygon that is not
    /// convex; the error names the corner.
    pub fn new(vertices: &[[T; 2]]) -> Result<Self> {
        let refuse = |index: usize, rule: &str| {
            Err(Error::at("vertices", index, tuple(&vertices[index]), rule))
        };
        if vertices.len() < 3 {
            return Err(Error::of(
                "vertices",
                format!("a list of {}", vertices.len()),
                "a polygon has at least 3",
            ));
        }
        let infinite = |vertex: &[T; 2]| !vertex.iter().all(|v| v.is_finite());
        if let Some(index) = vertices.iter().position(infinite) {
            return refuse(index, "both coordinates must be finite");
        }
        let too_far = |vertex: &[T; 2]| !vertex.iter().all(|v| v.abs() <= T::MAX_SIZE);
        if let Some(index) = vertices.iter().position(too_far) {
            let rule = format!("both coordinates must be within ±{:e}", T::MAX_SIZE);
            return refuse(index, &rule);
        }
        let mut corners: Vec<[f64; 2]> = vertices.iter().map(|v| v.map(T::to_f64)).collect();
        let scaled = scaled(&corners);
        // Sides need their interior on the left. A clockwise polygon is read backwards, and errors
        // name the corner as the caller counts it.
        let reversed = area(&scaled) < 0.0;
        if reversed {
            corners.reverse();
        }
        let scaled = if reversed { scaled.into_iter().rev().collect() } else { scaled };
        if let Some(corner) = dent::<T>(&scaled) {
            let index = if reversed { vertices.len() - 1 - corner } else { corner };
            return refuse(index, "the polygon is not convex there, or has no area");
        }
        let corner = |pick: fn(T, T) -> T| {
            let along = |axis: usize| vertices.iter().map(|v| v[axis]).reduce(pick);
            [along(0).unwrap_or(T::ZERO), along(1).unwrap_or(T::ZERO)]
        };
        // In the type of the caller, from the corners themselves: the window is exact, without a
        // rounding.
        let window = Window { min: corner(T::min), max: corner(T::max), radius: T::ZERO };
        let next = corners.iter().cycle().skip(1);
        let sides = corners.iter().zip(next).map(|(&a, &b)| Side::new(a, b)).collect();
        Ok(Self { sides, window })
    }

    /// Whether the core of the shape and the interior of the polygon overlap: no side of the
    /// polygon separates them. The sides of the core have been tested before.
    fn overlaps_core(&self, shape: &Shape<f64>) -> bool {
        let [hx, hy] = shape.half_size;
        if let Some([a, b]) = line_of(shape) {
            let line = Side::new(a, b);
            let (left, right) = (|side: f64| side > 0.0, |side: f64| side < 0.0);
            let is_on =
                |which: fn(f64) -> bool| self.sides.iter().any(|s| which(line.left(s.start)));
            // The sides of the polygon, and the segment itself, are all the lines that may separate
            // the two.
            return is_on(left)
                && is_on(right)
                && self.sides.iter().all(|side| side.left(a) > 0.0 || side.left(b) > 0.0);
        }
        self.sides.iter().all(|Side { start, along, .. }| {
            // The corner of `min` and `max` farthest to the left of the side.
            let corner_x = if along[1] < 0.0 { shape.max[0] } else { shape.min[0] };
            let corner_y = if along[0] < 0.0 { shape.min[1] } else { shape.max[1] };
            let (x, y) = (corner_x - start[0], corner_y - start[1]);
            let outside = along[1] * x - along[0] * y;
            // Whether the farthest corner is inside this side. If all sides have one, no side
            // separates the two. Equality is touching.
            outside - (along[1].abs() * hx + along[0].abs() * hy) < 0.0
        })
    }

    /// Whether the distance between the polygon and the core of the shape is below its radius: that
    /// of a corner of the polygon from the core, or of a corner of the core from a side.
    fn is_within(&self, shape: &Shape<f64>) -> bool {
        let radius_square = shape.radius * shape.radius;
        let line = line_of(shape);
        let from_core = |vertex: [f64; 2]| match line {
            Some([a, b]) => from_side(vertex, &Side::new(a, b)),
            None => square_of_gaps(shape.gaps_to(vertex)),
        };
        let [left, top, right, bottom] = shape.sides();
        let corners = match line {
            Some([a, b]) => [a, b, a, b],
            None => [[left, top], [right, top], [left, bottom], [right, bottom]],
        };
        // The four corners of a point are the same.
        let corners = if shape.is_round() { &corners[..1] } else { &corners[..] };
        self.sides.iter().any(|side| from_core(side.start) < radius_square)
            || self
                .sides
                .iter()
                .any(|side| corners.iter().any(|&corner| from_side(corner, side) < radius_square))
    }
}

/// The ends of a slanted segment.
fn line_of(shape: &Shape<f64>) -> Option<[[f64; 2]; 2]> {
    if shape.is_slanted() { shape.segment() } else { None }
}

/// Squared distance of a point from a side.
fn from_side(point: [f64; 2], &Side { start, along, length }: &Side) -> f64 {
    let (x, y) = (point[0] - start[0], point[1] - start[1]);
    // `along` is not a unit vector: a division by its length would round it. Its square may be 0
    // for a side of length 0, whose only point is its start.
    let square = along[0] * along[0] + along[1] * along[1];
    let far = if square > 0.0 { (x * along[0] + y * along[1]) / square } else { 0.0 };
    let far = far.clamp(0.0, length);
    let (x, y) = (x - far * along[0], y - far * along[1]);
    x * x + y * y
}

/// The corners relative to the size of the polygon, so that its area neither overflows nor
/// underflows.
fn scaled(corners: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let [x, y] = corners[0];
    let spans = corners.iter().map(|corner| (corner[0] - x).abs().max((corner[1] - y).abs()));
    let scale = power_of_two_above(spans.fold(0.0, f64::max));
    corners.iter().map(|corner| corner.map(|v| v / scale)).collect()
}

/// Twice the signed area, positive if the interior is on the left.
fn area(corners: &[[f64; 2]]) -> f64 {
    let [x0, y0] = corners[0];
    let fans = corners[1..].windows(2).map(|pair| {
        let [a, b] = [pair[0], pair[1]].map(|[x, y]| [x - x0, y - y0]);
        a[0] * b[1] - a[1] * b[0]
    });
    fans.sum()
}

/// The first corner at which the polygon is not convex. Its interior must be on the left.
fn dent<T: Scalar>(vertices: &[[f64; 2]]) -> Option<usize> {
    let len = vertices.len();
    let side = |from: usize| {
        let (a, b) = (vertices[from % len], vertices[(from + 1) % len]);
        [b[0] - a[0], b[1] - a[1]]
    };
    // With a tolerance, because rounding can move corners on a straight side.
    // In the caller's precision, not that of the calculation: corners on a straight side were
    // rounded to float32 before they came here.
    let slack = 4.0 * T::EPSILON.to_f64();
    let turns_right = |corner: usize| {
        let ([ax, ay], [bx, by]) = (side(corner + len - 1), side(corner));
        let size = (ax.abs() + ay.abs()) * (bx.abs() + by.abs());
        ax * by - ay * bx < -slack * size
    };
    if area(vertices) <= 0.0 {
        return Some(0);
    }
    // A star polygon turns left at every corner too, but winds around more than once: as seen from
    // the first corner, a side of it runs clockwise.
    let [x0, y0] = vertices[0];
    let runs_clockwise = |corner: usize| {
        let ([ax, ay], [bx, by]) = (vertices[corner], side(corner));
        let (ax, ay) = (ax - x0, ay - y0);
        ax * by - ay * bx < -slack * (ax.abs() + ay.abs()) * (bx.abs() + by.abs())
    };
    (0..len).find(|&corner| turns_right(corner) || runs_clockwise(corner))
}

impl<T: Scalar> Region<T> for Polygon<T> {
    const WINDOW_IS_EXACT: bool = false;

    fn window(&self) -> Window<T> {
        self.window
    }

    /// Tests the window, then the core (separating axis test), then the distance from the core.
    fn overlaps(&self, shape: &Shape<T>) -> bool {
        let [dx, dy] = self.window.gaps(shape);
        let inside = (dx < T::ZERO) & (dy < T::ZERO);
        if !overlap([dx, dy], shape.radius) {
            return false;
        }
        let Shape { min, max, half_size, radius, category, mask, core } = *shape;
        let [min, max, half_size] = [min, max, half_size].map(|pair| pair.map(T::to_f64));
        let shape = Shape { min, max, half_size, radius: radius.to_f64(), category, mask, core };
        (inside && self.overlaps_core(&shape)) || self.is_within(&shape)
    }

    /// Whether a side separates the polygon from the bounds by more than the rounding errors.
    fn misses(&self, bounds: &Bounds<T>) -> bool {
        let Window { min, max, .. } = self.window;
        let span = (max[0].to_f64() - min[0].to_f64()) + (max[1].to_f64() - min[1].to_f64());
        let roundings = (32.0 + 8.0 * self.sides.len() as f64) * T::EPSILON.to_f64();
        self.sides.iter().any(|Side { start, along, .. }| {
            // The outward normal of the side.
            let normal = [along[1], -along[0]];
            let (mut outside, mut size) = (0.0, 0.0);
            for axis in 0..2 {
                let side = if normal[axis] < 0.0 { bounds.max[axis] } else { bounds.min[axis] };
                let corner = side.to_f64();
                let extent = (bounds.half_size[axis] + bounds.radius).to_f64();
                let steep = normal[axis].abs();
                outside += normal[axis] * (corner - start[axis]) - steep * extent;
                size += steep * (corner.abs() + start[axis].abs() + extent + span);
            }
            // Only if certain. A node that is kept in vain costs some tests, one that is left out
            // wrongly costs a hit.
            outside > size * roundings
        })
    }

    fn moved(&self, shift: [T; 2]) -> Self {
        let [x, y] = shift.map(T::to_f64);
        let moved = |side: &Side| Side { start: [side.start[0] - x, side.start[1] - y], ..*side };
        Self { sides: self.sides.iter().map(moved).collect(), window: self.window.moved(shift) }
    }

    /// A larger polygon could overlap shapes in more images than are tested.
    fn check_period(&self, index: usize, period: &Period<T>) -> Result<()> {
        let Window { min, max, .. } = self.window;
        let fits =
            |axis: usize| !period.is_along(axis) || max[axis] - min[axis] <= period.sides()[axis];
        if fits(0) && fits(1) {
            return Ok(());
        }
        let size = tuple(&[max[0] - min[0], max[1] - min[1]]);
        let rule = format!(
            "with period={}, a polygon may be at most one period wide and high",
            tuple(&period.sides())
        );
        Err(Error::at("vertices", index, format!("{size} wide and high"), &rule))
    }
}
