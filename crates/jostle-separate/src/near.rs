//! Lists of the pairs that may overlap before a shape has moved by half a margin.
//!
//! L. Verlet, *Computer "Experiments" on Classical Fluids*, Phys. Rev. 159 (1967), for lists with a
//! margin.

use super::bodies::{Bodies, Body};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_base::settings::{DEFAULT_MAX_PAIRS, Settings};
use jostle_base::sorting;
use jostle_index::geometry::Scalar;
use jostle_index::pairs::{self, JoinScratch};
use jostle_index::quadtree::Quadtree;
use jostle_index::shapes::Shapes;

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

/// For each shape the others near it, ascending; not the pairs of two fixed shapes. They are found
/// in the arithmetic of `K`.
#[derive(Clone, Debug, Default)]
pub(crate) struct NeighborLists<T, K> {
    ends: Vec<u32>,
    others: Vec<u32>,
    /// The centres for which the lists were made.
    pub origins: Vec<[T; 2]>,
    margin: T,
    gap: T,
    shapes: Shapes<K>,
    tree: Quadtree<K>,
    scratch: JoinScratch,
}

impl<T: Scalar, K: Scalar> NeighborLists<T, K> {
    /// Empty lists for `bodies`.
    pub(crate) fn of(bodies: &Bodies<T>, gap: T) -> Self {
        Self { margin: margin(bodies.mean_extents, gap), gap, ..Self::default() }
    }

    /// The distance from its origin up to which a shape may move; slightly less than half the
    /// margin, because of rounding.
    pub(crate) fn max_displacement(&self) -> T {
        self.margin * T::from_f64(0.49)
    }

    /// Makes the lists for the current centres.
    pub(crate) fn find(&mut self, bodies: &Bodies<T>, threads: Option<usize>) -> Result<()> {
        fill_wide(&mut self.shapes, &bodies.all, &bodies.centers, self.margin + self.gap)?;
        let mut tree = std::mem::take(&mut self.tree);
        // The order of the pairs has no effect, because each list is sorted below.
        tree.fill_unordered(&self.shapes, Settings { threads, ..Settings::default() })?;
        self.find_in(&tree, Some(tree.rows()), bodies)?;
        self.tree = tree;
        Ok(())
    }

    /// Makes the lists from a tree of the shapes, [`fill_wide`], with the current centres. `rows`
    /// are the bodies in its order, if that is not theirs.
    pub(crate) fn find_in(
        &mut self,
        tree: &Quadtree<K>,
        rows: Option<&[u32]>,
        bodies: &Bodies<T>,
    ) -> Result<()> {
        let mut found = pairs::indices_within(tree, DEFAULT_MAX_PAIRS, &mut self.scratch)?.pairs;
        if let Some(rows) = rows {
            found.iter_mut().for_each(|pair| *pair = pair.map(|index| rows[index as usize]));
        }
        let is_fixed = |index: u32| bodies.all[index as usize].is_fixed();
        if bodies.any_fixed {
            // Neither can move, so such a pair would count as an overlap for ever.
            found.retain(|&[i, j]| !(is_fixed(i) && is_fixed(j)));
        }
        self.list(&found, bodies.len())?;
        self.scratch.keep(found);
        self.origins.clear();
        memory::reserve(&mut self.origins, bodies.len())?;
        self.origins.extend(&bodies.centers);
        Ok(())
    }

    /// Counting sort of the pairs by both of their shapes.
    fn list(&mut self, found: &[[u32; 2]], len: usize) -> Result<()> {
        let Self { ends, others, .. } = self;
        memory::resize(ends, len, 0)?;
        memory::resize(others, 2 * found.len(), 0)?;
        let both = found.iter().flat_map(|&[i, j]| [[i, j], [j, i]]);
        sorting::counting_sort(both, |pair| pair[0] as usize, |pair| pair[1], ends, others);
        // The order in which the pairs were found may depend on threads.
        let mut start = 0;
        for &end in &*ends {
            others[start..end as usize].sort_unstable();
            start = end as usize;
        }
        Ok(())
    }

    /// The indices of the shapes listed for the one at `index`.
    #[inline(always)]
    pub(crate) fn of_index(&self, index: usize) -> &[u32] {
        let start = if index == 0 { 0 } else { self.ends[index - 1] };
        &self.others[start as usize..self.ends[index] as usize]
    }
}
