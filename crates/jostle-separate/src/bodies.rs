//! The shapes in the order in which they are moved.

use std::cmp::Ordering;

use super::rules::Separation;
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
            let weight = if rules.movable.at(row) { rules.weights.at(row) } else { T::INFINITY };
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
        let margin = margin(self.mean_extents, gap);
        let error = rounding::<T, f32>(&self.all, &self.centers, margin + gap);
        let margin = margin.to_f64();
        margin >= RANGE[0] && error <= 0.1 * margin && error <= RANGE[1] * f64::from(f32::EPSILON)
    }
}

impl<T: Scalar> Bodies<T> {
    /// Sorts shapes, and returns the tree that sorted them: that of [`fill_wide`].
    pub(crate) fn sorted<K: Scalar>(
        input: &Input<T>,
        rules: &Separation<T>,
    ) -> Result<(Self, Quadtree<K>)> {
        let Input { all, centers, mean_extents } = input;
        let mut wide = Shapes::default();
        let wider = margin(*mean_extents, rules.gap) + rules.gap;
        fill_wide(&mut wide, all, centers, wider)?;
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
            // The leaves also show where shapes are crowded (`spread::is_crowded`): larger ones
            // would hide small heaps. For the search alone capacities of 64 to 128 are equally fast
            // (docs/benchmarks-notes.md).
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

/// Margin, as a share of the mean extent of the shapes.
const MARGIN: f64 = 0.5;

/// The margin of shapes with these mean extents.
pub(crate) fn margin<T: Scalar>([x, y]: [T; 2], gap: T) -> T {
    // In proportion to the shorter extent: that is how far a shape moves before its list is out of
    // date. Long labels would otherwise list everything above and below. Not below a tenth of the
    // longer one, because lists that hold for a tiny displacement would be made again in each
    // round.
    (x.min(y).max(T::from_f64(0.1) * x.max(y)) + gap) * T::from_f64(MARGIN)
}

/// Upper bound of the errors by which a gap in the arithmetic of `K` between shapes at `centers`
/// differs from that in `T`; 0 if both are the same.
pub(crate) fn rounding<T: Scalar, K: Scalar>(
    bodies: &[Body<T>],
    centers: &[[T; 2]],
    wider: T,
) -> f64 {
    if size_of::<T>() == size_of::<K>() {
        return 0.0;
    }
    let far = centers.as_flattened().iter().fold(T::ZERO, |most, v| most.max(v.abs()));
    let wide =
        bodies.iter().fold(T::ZERO, |most, body| most.max(body.extent(0)).max(body.extent(1)));
    // Two coordinates, two sizes and their sums are rounded once each, by half an epsilon of the
    // largest number.
    (far.to_f64() + wide.to_f64() + wider.to_f64()) * 4.0 * K::EPSILON.to_f64()
}

/// Writes shapes that overlap if the gap between two bodies is below `wider`.
pub(crate) fn fill_wide<T: Scalar, K: Scalar>(
    shapes: &mut Shapes<K>,
    bodies: &[Body<T>],
    centers: &[[T; 2]],
    wider: T,
) -> Result<()> {
    // Both shapes of a pair are enlarged, so each by half of the distance.
    let more = wider.to_f64() * 0.5 + rounding::<T, K>(bodies, centers, wider);
    let key = |v: T| K::from_f64(v.to_f64());
    let columns = shapes.columns_mut();
    columns.centers.clear();
    memory::reserve(columns.centers, centers.len())?;
    columns.centers.extend(centers.iter().map(|center| center.map(key)));
    let radii = columns.radii.rows_mut();
    radii.clear();
    memory::reserve(radii, bodies.len())?;
    radii.extend(bodies.iter().map(|body| K::from_f64(body.radius.to_f64() + more)));
    if bodies.iter().any(|body| body.half != [T::ZERO; 2]) {
        let halves = columns.half_sizes.get_or_insert_default().rows_mut();
        halves.clear();
        memory::reserve(halves, bodies.len())?;
        halves.extend(bodies.iter().map(|body| body.half.map(key)));
    }
    Ok(())
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
