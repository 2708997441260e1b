//! The shapes in the order in which they are moved.

use std::cmp::Ordering;

use super::{Separation, near};
use crate::error::Result;
use crate::geometry::Scalar;
use crate::memory;
use crate::quadtree::Quadtree;
use crate::settings::Settings;
use crate::shapes::Shapes;

/// Maximum number of shapes in a leaf of the tree.
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
    /// Sorts shapes, and returns the tree that sorted them: that of [`near::wide_shapes`].
    pub fn sorted(shapes: &Shapes<T>, rules: &Separation<T>) -> Result<(Self, Quadtree<T>)> {
        let body = |row: usize| {
            let shape = shapes.shape(row);
            let weight = if rules.fixed.at(row) { T::INFINITY } else { rules.weights.at(row) };
            Body { half: shape.core_half_size(), radius: shape.radius, weight }
        };
        let given: Vec<Body<T>> = memory::collect((0..shapes.len()).map(body))?;
        let mean_extents = [0, 1].map(|axis| mean(given.iter().map(|body| body.extent(axis))));
        let centers = memory::collect(shapes.centers.iter().copied())?;
        let wider = near::margin(mean_extents, rules.gap) + rules.gap;
        let wide = near::wide_shapes(&given, centers, wider)?;
        let values = |row: usize| {
            let Body { half, radius, weight } = given[row];
            [radius, half[0], half[1], weight]
        };
        let tie = |a: usize, b: usize| {
            let pairs = values(a).into_iter().zip(values(b));
            let by_value = pairs.map(|(a, b)| a.total_order(&b)).find(|order| order.is_ne());
            by_value.unwrap_or(Ordering::Equal).then(a.cmp(&b))
        };
        let settings = Settings {
            leaf_capacity: LEAF_CAPACITY,
            threads: rules.threads,
            ..Settings::default()
        };
        let mut tree = Quadtree::default();
        tree.rebuild(&wide, settings, &tie)?;
        let rows = memory::collect(tree.rows().iter().copied())?;
        let all = memory::collect(rows.iter().map(|&row| given[row as usize]))?;
        let centers = memory::collect(rows.iter().map(|&row| wide.centers[row as usize]))?;
        Ok((Self { rows, all, centers, mean_extents }, tree))
    }

    /// Number of shapes.
    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// Whether all are discs.
    pub fn are_round(&self) -> bool {
        self.all.iter().all(|body| body.half == [T::ZERO; 2])
    }
}

/// The mean of numbers that are at least 0, to about forty bits of the largest. Sums of integers do
/// not depend on their order.
fn mean<T: Scalar>(all: impl ExactSizeIterator<Item = T> + Clone) -> T {
    const STEPS: f64 = (1u64 << 40) as f64;
    let count = all.len().max(1) as f64;
    let largest = all.clone().fold(T::ZERO, T::max).to_f64();
    if largest == 0.0 {
        return T::ZERO;
    }
    let sum: u128 = all.map(|number| (number.to_f64() / largest * STEPS) as u128).sum();
    T::from_f64(largest * (sum as f64 / STEPS / count))
}
