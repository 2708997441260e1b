//! Convex polygons.

use super::region::Region;
use super::window::Window;
use crate::error::{Error, Result};
use crate::geometry::{Cover, Scalar, Shape};
use crate::shapes::tuple;

/// A convex polygon; what only touches its border does not overlap it.
///
/// Sides and corners are tested in float64 for either type, in which the products of float32
/// are neither rounded away nor too large.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon<T> {
    sides: Vec<Side>,
    window: Window<T>,
}

/// A side of a polygon, the inside on its left. Its vector is `length` times `along`: `length` is a
/// power of two and no component of `along` above 1, so that products with it stay finite.
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
}

/// A power of two above `value`, at most twice as large if that is a normal number.
fn power_of_two_above(value: f64) -> f64 {
    2.0 * f64::from_bits(value.to_bits() & 0x7ff0_0000_0000_0000).max(f64::MIN_POSITIVE)
}

impl<T: Scalar> Polygon<T> {
    /// The polygon with these corners, clockwise or counterclockwise. Refuses a polygon
    /// that is not convex, with the index of the corner.
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
        let window = Window { min: corner(T::least), max: corner(T::most), radius: T::ZERO };
        let next = corners.iter().cycle().skip(1);
        let sides = corners.iter().zip(next).map(|(&a, &b)| Side::new(a, b)).collect();
        Ok(Self { sides, window })
    }

    /// Whether the core of the shape and the inside of the polygon overlap: no side
    /// has all of the core on its right. The sides of the core have been tested before.
    fn overlaps_core(&self, shape: &Shape<f64>) -> bool {
        let [hx, hy] = shape.half_size;
        self.sides.iter().all(|Side { start, along, .. }| {
            // The corner farthest to the left of the side.
            let corner_x = if along[1] < 0.0 { shape.max[0] } else { shape.min[0] };
            let corner_y = if along[0] < 0.0 { shape.min[1] } else { shape.max[1] };
            let (x, y) = (corner_x - start[0], corner_y - start[1]);
            let outside = along[1] * x - along[0] * y;
            outside - (along[1].abs() * hx + along[0].abs() * hy) < 0.0
        })
    }

    /// Whether a corner of the polygon is nearer to the core of the shape than its radius,
    /// or a corner of the core to a side.
    fn is_within(&self, shape: &Shape<f64>) -> bool {
        let reach = shape.radius * shape.radius;
        let from_core = |vertex: [f64; 2]| {
            let [gx, gy] = shape.gap_to(vertex);
            let dx = (gx - shape.half_size[0]).max(0.0);
            let dy = (gy - shape.half_size[1]).max(0.0);
            dx * dx + dy * dy
        };
        let [left, top, right, bottom] = shape.core();
        let corners = [[left, top], [right, top], [left, bottom], [right, bottom]];
        let corners = if shape.is_round() { &corners[..1] } else { &corners[..] };
        self.sides.iter().any(|side| from_core(side.start) < reach)
            || self
                .sides
                .iter()
                .any(|side| corners.iter().any(|&corner| from_side(corner, side) < reach))
    }
}

/// Squared distance of a point from a side.
fn from_side(point: [f64; 2], &Side { start, along, length }: &Side) -> f64 {
    let (x, y) = (point[0] - start[0], point[1] - start[1]);
    let square = along[0] * along[0] + along[1] * along[1];
    let far = if square > 0.0 { (x * along[0] + y * along[1]) / square } else { 0.0 };
    let far = far.clamp(0.0, length);
    let (x, y) = (x - far * along[0], y - far * along[1]);
    x * x + y * y
}

/// The corners of a polygon of the same form whose area is neither too large nor too small.
fn scaled(corners: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let [x, y] = corners[0];
    let spans = corners.iter().map(|corner| (corner[0] - x).abs().max((corner[1] - y).abs()));
    let scale = power_of_two_above(spans.fold(0.0, f64::max));
    corners.iter().map(|corner| corner.map(|v| v / scale)).collect()
}

/// Twice the area, positive where the inside is on the left.
fn area(corners: &[[f64; 2]]) -> f64 {
    let [x0, y0] = corners[0];
    let fans = corners[1..].windows(2).map(|pair| {
        let [a, b] = [pair[0], pair[1]].map(|[x, y]| [x - x0, y - y0]);
        a[0] * b[1] - a[1] * b[0]
    });
    fans.sum()
}

/// The first corner that keeps the polygon from being convex; the inside should be on the left.
fn dent<T: Scalar>(vertices: &[[f64; 2]]) -> Option<usize> {
    let len = vertices.len();
    let way = |from: usize| {
        let (a, b) = (vertices[from % len], vertices[(from + 1) % len]);
        [b[0] - a[0], b[1] - a[1]]
    };
    // A little is forgiven, or corners on a straight side would be refused by rounding.
    let slack = 4.0 * T::EPSILON.to_f64();
    let turns_right = |corner: usize| {
        let ([ax, ay], [bx, by]) = (way(corner + len - 1), way(corner));
        let size = (ax.abs() + ay.abs()) * (bx.abs() + by.abs());
        ax * by - ay * bx < -slack * size
    };
    if area(vertices) <= 0.0 {
        return Some(0);
    }
    // A star turns left at every corner too, but comes around more than once: seen from
    // the first corner, some side of it runs backwards.
    let [x0, y0] = vertices[0];
    let runs_backwards = |corner: usize| {
        let ([ax, ay], [bx, by]) = (vertices[corner], way(corner));
        let (ax, ay) = (ax - x0, ay - y0);
        ax * by - ay * bx < -slack * (ax.abs() + ay.abs()) * (bx.abs() + by.abs())
    };
    (0..len).find(|&corner| turns_right(corner) || runs_backwards(corner))
}

impl<T: Scalar> Region<T> for Polygon<T> {
    const PLAIN: bool = false;

    fn window(&self) -> Window<T> {
        self.window
    }

    /// Separating axes for the boxes inside the shapes, distances for what is around them.
    /// The window is tested first: a shape outside the window is outside the polygon.
    fn touches(&self, shape: &Shape<T>) -> bool {
        let [dx, dy] = self.window.gap(shape);
        let (x, y) = (dx.most(T::ZERO), dy.most(T::ZERO));
        let inside = (dx < T::ZERO) & (dy < T::ZERO);
        if !inside && x * x + y * y >= shape.radius * shape.radius {
            return false;
        }
        let Shape { min, max, half_size, radius, category, mask } = *shape;
        let [min, max, half_size] = [min, max, half_size].map(|pair| pair.map(T::to_f64));
        let shape = Shape { min, max, half_size, radius: radius.to_f64(), category, mask };
        (inside && self.overlaps_core(&shape)) || self.is_within(&shape)
    }

    /// Whether a side has the whole cover on its right, by more than rounding could do.
    fn misses(&self, cover: &Cover<T>) -> bool {
        let Window { min, max, .. } = self.window;
        let span = (max[0].to_f64() - min[0].to_f64()) + (max[1].to_f64() - min[1].to_f64());
        let roundings = (32.0 + 8.0 * self.sides.len() as f64) * T::EPSILON.to_f64();
        self.sides.iter().any(|Side { start, along, .. }| {
            // The outward normal of the side.
            let normal = [along[1], -along[0]];
            let (mut outside, mut size) = (0.0, 0.0);
            for axis in 0..2 {
                let side = if normal[axis] < 0.0 { cover.max[axis] } else { cover.min[axis] };
                let least = side.to_f64();
                let reach = (cover.half_size[axis] + cover.radius).to_f64();
                let steep = normal[axis].abs();
                outside += normal[axis] * (least - start[axis]) - steep * reach;
                size += steep * (least.abs() + start[axis].abs() + reach + span);
            }
            outside > size * roundings
        })
    }
}
