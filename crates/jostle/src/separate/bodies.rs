//! The shapes in the order in which they are moved.

use std::cmp::Ordering;

use super::Separation;
use crate::error::Result;
use crate::geometry::Scalar;
use crate::memory;
use crate::quadtree::Quadtree;
use crate::settings::Settings;
use crate::shapes::{Each, Shapes};

/// Maximum number of shapes in a leaf of the first tree.
const LEAF_CAPACITY: usize = 32;

/// What does not change of a shape.
#[derive(Clone, Copy, Debug, Default)]
pub struct Body<T> {
    /// Half width and half height of the core.
    pub half: [T; 2],
    /// Radius.
    pub radius: T,
    /// Weight; infinite if the shape is fixed.
    pub weight: T,
}

impl<T: Scalar> Body<T> {
    /// Whether the shape stays where it is.
    #[inline(always)]
    pub fn is_fixed(&self) -> bool {
        self.weight == T::INFINITY
    }

    /// Distance from the centre to the side of the bounding box along an axis.
    #[inline(always)]
    pub fn extent(&self, axis: usize) -> T {
        self.half[axis] + self.radius
    }
}

/// Shapes in Morton order of their first centres, ties by their values. Shapes with equal values
/// are in the order of their rows: they can be exchanged, and the set of results is the same.
#[derive(Clone, Debug, Default)]
pub struct Bodies<T> {
    /// The caller's row of each.
    pub rows: Vec<u32>,
    /// Their sizes and weights.
    pub all: Vec<Body<T>>,
    /// Their current centres.
    pub centers: Vec<[T; 2]>,
    /// Mean half width and half height, with radii.
    pub mean_extents: [T; 2],
}

impl<T: Scalar> Bodies<T> {
    /// Sorts shapes, and returns the tree that sorted them.
    pub fn sorted(shapes: &Shapes<T>, rules: &Separation<T>) -> Result<(Self, Quadtree<T>)> {
        let body = |row: usize| {
            let shape = shapes.shape(row);
            let weight = if rules.fixed.at(row) { T::INFINITY } else { rules.weights.at(row) };
            Body { half: shape.core_half_size(), radius: shape.radius, weight }
        };
        let values = |row| {
            let Body { half, radius, weight } = body(row);
            [radius, half[0], half[1], weight]
        };
        let tie = |a: usize, b: usize| {
            let pairs = values(a).into_iter().zip(values(b));
            let by_value = pairs.map(|(a, b)| a.total_order(&b)).find(|order| order.is_ne());
            by_value.unwrap_or(Ordering::Equal).then(a.cmp(&b))
        };
        let centers = memory::collect(shapes.centers.iter().copied())?;
        let points = Shapes { centers, radii: Each::One(T::ZERO), ..Shapes::default() };
        let mut tree = Quadtree::default();
        let settings = Settings {
            leaf_capacity: LEAF_CAPACITY,
            threads: rules.threads,
            ..Settings::default()
        };
        tree.rebuild(&points, settings, &tie)?;
        let rows = memory::collect(tree.rows().iter().copied())?;
        let all: Vec<Body<T>> = memory::collect(rows.iter().map(|&row| body(row as usize)))?;
        let centers = memory::collect(rows.iter().map(|&row| points.centers[row as usize]))?;
        let mean_extents = [0, 1].map(|axis| {
            let sum: f64 = all.iter().map(|body| body.extent(axis).to_f64()).sum();
            T::from_f64(sum / all.len().max(1) as f64)
        });
        Ok((Self { rows, all, centers, mean_extents }, tree))
    }

    /// Number of shapes.
    pub fn len(&self) -> usize {
        self.all.len()
    }
}
