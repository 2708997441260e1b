//! The shapes in the order in which they are moved.

use std::cmp::Ordering;

use super::{Separation, near};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_base::settings::Settings;
use jostle_index::geometry::Scalar;
use jostle_index::quadtree::Quadtree;
use jostle_index::shapes::Shapes;

/// Maximum number of shapes in a leaf of the tree.
const LEAF_CAPACITY: usize = 64;

/// The properties of a shape that do not change.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Body<T> {
    /// Half width and half height of the core.
    pub half: [T; 2],
    /// Radius.
    pub radius: T,
    /// Weight; infinite if the shape is fixed.
    pub weight: T,
}

impl<T: Scalar> Body<T> {
    /// Whether the shape is fixed.
    #[inline(always)]
    pub(crate) fn is_fixed(&self) -> bool {
        self.weight == T::INFINITY
    }

    /// Distance from the centre to the side of the bounding box along an axis.
    #[inline(always)]
    pub(crate) fn extent(&self, axis: usize) -> T {
        self.half[axis] + self.radius
    }
}

/// Shapes in Morton order of their first centres, ties by their values. Shapes with equal values
/// are in the order of their rows: they can be exchanged, and the set of results is the same.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bodies<T> {
    /// The caller's row of each.
    pub rows: Vec<u32>,
    /// Their sizes and weights.
    pub all: Vec<Body<T>>,
    /// Their current centres.
    pub centers: Vec<[T; 2]>,
    /// Mean half width and half height, with radii.
    pub mean_extents: [T; 2],
    /// Whether some are fixed.
    pub any_fixed: bool,
}

/// Shapes in the order of the caller's rows.
pub(crate) struct Input<T> {
    all: Vec<Body<T>>,
    centers: Vec<[T; 2]>,
    mean_extents: [T; 2],
}

impl<T: Scalar> Input<T> {
    /// The shapes of a call.
    pub(crate) fn of(shapes: &Shapes<T>, rules: &Separation<T>) -> Result<Self> {
        let body = |row: usize| {
            let shape = shapes.shape(row);
            let weight = if rules.fixed.at(row) { T::INFINITY } else { rules.weights.at(row) };
            Body { half: shape.core_half_size(), radius: shape.radius, weight }
        };
        let all: Vec<Body<T>> = memory::collect((0..shapes.len()).map(body))?;
        let mean_extents = [0, 1].map(|axis| mean(all.iter().map(|body| body.extent(axis))));
        Ok(Self { all, centers: memory::collect(shapes.centers().iter().copied())?, mean_extents })
    }

    /// Whether near pairs can be found in float32 without many more than in float64.
    pub(crate) fn fits_single(&self, gap: T) -> bool {
        /// Squares of larger numbers, and of smaller ones, lose precision.
        const RANGE: [f64; 2] = [1e-12, 1e12];
        // float32 pays off only if its rounding adds few pairs to the lists. At the limit the
        // distance of the search is larger by a fifth of the margin.
        let margin = near::margin(self.mean_extents, gap);
        let error = near::rounding::<T, f32>(&self.all, &self.centers, margin + gap);
        let margin = margin.to_f64();
        margin >= RANGE[0] && error <= 0.1 * margin && error <= RANGE[1] * f64::from(f32::EPSILON)
    }
}

impl<T: Scalar> Bodies<T> {
    /// Sorts shapes, and returns the tree that sorted them: that of [`near::fill_wide`].
    pub(crate) fn sorted<K: Scalar>(
        input: &Input<T>,
        rules: &Separation<T>,
    ) -> Result<(Self, Quadtree<K>)> {
        let Input { all, centers, mean_extents } = input;
        let mut wide = Shapes::default();
        let wider = near::margin(*mean_extents, rules.gap) + rules.gap;
        near::fill_wide(&mut wide, all, centers, wider)?;
        let values = |row: usize| {
            let (Body { half, radius, weight }, [x, y]) = (all[row], centers[row]);
            [x, y, radius, half[0], half[1], weight]
        };
        let tie = |a: usize, b: usize| {
            let pairs = values(a).into_iter().zip(values(b));
            // All values that make a difference, then the row. So the order of the rounds follows
            // from the shapes, and a permutation of the input permutes the result.
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
        let all: Vec<Body<T>> = memory::collect(rows.iter().map(|&row| all[row as usize]))?;
        let centers = memory::collect(rows.iter().map(|&row| centers[row as usize]))?;
        let any_fixed = all.iter().any(Body::is_fixed);
        let mean_extents = *mean_extents;
        Ok((Self { rows, all, centers, mean_extents, any_fixed }, tree))
    }

    /// Number of shapes.
    pub(crate) fn len(&self) -> usize {
        self.all.len()
    }

    /// Whether all are discs.
    pub(crate) fn are_round(&self) -> bool {
        self.all.iter().all(|body| body.half == [T::ZERO; 2])
    }
}

/// The mean of numbers that are at least 0, to about thirty bits of the largest. Sums of integers
/// do not depend on their order; 2^31 of them do not overflow.
fn mean<T: Scalar>(all: impl ExactSizeIterator<Item = T> + Clone) -> T {
    const STEPS: f64 = (1u64 << 32) as f64;
    let count = all.len().max(1) as f64;
    let largest = all.clone().fold(T::ZERO, T::max).to_f64();
    if largest == 0.0 {
        return T::ZERO;
    }
    // A sum of floats depends on the order of the rows, and the margin and with it the result
    // would, too.
    let sum: u64 = all.map(|number| (number.to_f64() / largest * STEPS) as u64).sum();
    T::from_f64(largest * (sum as f64 / STEPS / count))
}
