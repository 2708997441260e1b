//! Convex polygons.

use super::rect::list;
use super::region::{Region, Window};
use crate::error::{Error, Result};
use crate::geometry::{Cover, Scalar, Shape};

/// A convex polygon; what only touches its border does not overlap it.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon<T> {
    /// Corners; the inside is on the left of the way from one to the next.
    vertices: Vec<[T; 2]>,
    window: Window<T>,
}

impl<T: Scalar> Polygon<T> {
    /// The polygon with these corners, in either direction of turning. Refuses what is
    /// not convex; the refusal names the corner.
    pub fn new(vertices: &[[T; 2]]) -> Result<Self> {
        let refuse = |index: usize, rule: &str| {
            Err(Error::at("vertices", index, list(&vertices[index]), rule))
        };
        if vertices.len() < 3 {
            return Err(Error::of("vertices", vertices.len(), "a polygon has at least 3"));
        }
        let infinite = |vertex: &[T; 2]| !vertex.iter().all(|v| v.is_finite());
        if let Some(index) = vertices.iter().position(infinite) {
            return refuse(index, "both coordinates must be finite");
        }
        let mut vertices_left = vertices.to_vec();
        if area(vertices) < 0.0 {
            vertices_left.reverse();
        }
        if let Some(corner) = dent(&vertices_left) {
            let index = if area(vertices) < 0.0 { vertices.len() - 1 - corner } else { corner };
            return refuse(index, "the polygon is not convex there, or has no area");
        }
        let corner = |pick: fn(T, T) -> T| {
            let along = |axis: usize| vertices.iter().map(|v| v[axis]).reduce(pick);
            [along(0).unwrap_or(T::ZERO), along(1).unwrap_or(T::ZERO)]
        };
        let window = Window { min: corner(T::least), max: corner(T::most), radius: T::ZERO };
        Ok(Self { vertices: vertices_left, window })
    }

    /// Where each side begins, and the way along it.
    fn sides(&self) -> impl Iterator<Item = ([T; 2], [T; 2])> + '_ {
        let next = self.vertices.iter().cycle().skip(1);
        self.vertices.iter().zip(next).map(|(&a, &b)| (a, [b[0] - a[0], b[1] - a[1]]))
    }

    /// Whether the box inside the shape and the inside of the polygon overlap: no side
    /// has all of the box on its right. The sides of the box have been asked before.
    fn overlaps_core(&self, shape: &Shape<T>) -> bool {
        let [hx, hy] = shape.half_size;
        self.sides().all(|(start, way)| {
            let (x, y) = (shape.center[0] - start[0], shape.center[1] - start[1]);
            let outside = way[1] * x - way[0] * y;
            outside - (way[1].abs() * hx + way[0].abs() * hy) < T::ZERO
        })
    }

    /// Whether a corner of the polygon is nearer to the box inside the shape than its radius,
    /// or a corner of that box to a side.
    fn is_within_radius(&self, shape: &Shape<T>) -> bool {
        let reach = shape.radius * shape.radius;
        let [cx, cy] = shape.center;
        let [hx, hy] = shape.half_size;
        let from_box = |&[x, y]: &[T; 2]| {
            let dx = ((cx - x).abs() - hx).most(T::ZERO);
            let dy = ((cy - y).abs() - hy).most(T::ZERO);
            dx * dx + dy * dy
        };
        let corners =
            [[cx - hx, cy - hy], [cx + hx, cy - hy], [cx - hx, cy + hy], [cx + hx, cy + hy]];
        let corners = if hx == T::ZERO && hy == T::ZERO { &corners[..1] } else { &corners[..] };
        self.vertices.iter().any(|vertex| from_box(vertex) < reach)
            || self.sides().any(|(start, way)| {
                corners.iter().any(|&corner| from_side(corner, start, way) < reach)
            })
    }
}

/// Squared distance of a point from a side.
fn from_side<T: Scalar>(point: [T; 2], start: [T; 2], way: [T; 2]) -> T {
    let (x, y) = (point[0] - start[0], point[1] - start[1]);
    let length = way[0] * way[0] + way[1] * way[1];
    let along = if length > T::ZERO { (x * way[0] + y * way[1]) * length.recip() } else { T::ZERO };
    let along = along.most(T::ZERO).least(T::ONE);
    let (x, y) = (x - along * way[0], y - along * way[1]);
    x * x + y * y
}

/// Twice the area, positive where the inside is on the left.
fn area<T: Scalar>(vertices: &[[T; 2]]) -> f64 {
    let [x0, y0] = vertices[0].map(T::to_f64);
    let from_first = |v: &[T; 2]| [v[0].to_f64() - x0, v[1].to_f64() - y0];
    let fans = vertices[1..].windows(2).map(|pair| {
        let [a, b] = [from_first(&pair[0]), from_first(&pair[1])];
        a[0] * b[1] - a[1] * b[0]
    });
    fans.sum()
}

/// The first corner that keeps the polygon from being convex; the inside should be on the left.
fn dent<T: Scalar>(vertices: &[[T; 2]]) -> Option<usize> {
    let len = vertices.len();
    let way = |from: usize| {
        let (a, b) = (vertices[from % len], vertices[(from + 1) % len]);
        [b[0].to_f64() - a[0].to_f64(), b[1].to_f64() - a[1].to_f64()]
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
    let [x0, y0] = vertices[0].map(T::to_f64);
    let runs_backwards = |corner: usize| {
        let ([ax, ay], [bx, by]) = (vertices[corner].map(T::to_f64), way(corner));
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
    /// The window is asked first, so that whatever the window misses is missed.
    fn touches(&self, shape: &Shape<T>) -> bool {
        let [dx, dy] = self.window.gap(shape.center, shape.half_size);
        let (x, y) = (dx.most(T::ZERO), dy.most(T::ZERO));
        let inside = (dx < T::ZERO) & (dy < T::ZERO);
        if !inside && x * x + y * y >= shape.radius * shape.radius {
            return false;
        }
        (inside && self.overlaps_core(shape)) || self.is_within_radius(shape)
    }

    /// Whether a side has the whole cover on its right, by more than rounding could do.
    fn misses(&self, cover: &Cover<T>) -> bool {
        let Window { min, max, .. } = self.window;
        let span = (max[0] - min[0]) + (max[1] - min[1]);
        let roundings = T::from_f64(32.0 + 8.0 * self.vertices.len() as f64) * T::EPSILON;
        self.sides().any(|(start, way)| {
            // Along the outward normal of the side, x and y.
            let normal = [way[1], -way[0]];
            let (mut outside, mut size) = (T::ZERO, T::ZERO);
            for axis in 0..2 {
                let least = if normal[axis] < T::ZERO { cover.max[axis] } else { cover.min[axis] };
                let reach = cover.half_size[axis] + cover.radius;
                let steep = normal[axis].abs();
                outside = outside + (normal[axis] * (least - start[axis]) - steep * reach);
                size = size + steep * (least.abs() + start[axis].abs() + reach + span);
            }
            outside > size * roundings
        })
    }
}
