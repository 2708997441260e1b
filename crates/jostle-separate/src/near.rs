//! Lists of the pairs that may overlap before a shape has moved by half a margin.
//!
//! L. Verlet, *Computer "Experiments" on Classical Fluids*, Phys. Rev. 159 (1967), for lists with a
//! margin.

use super::bodies::{Bodies, fill_wide, margin};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_base::settings::{DEFAULT_MAX_PAIRS, Settings};
use jostle_base::sorting;
use jostle_index::geometry::Scalar;
use jostle_index::pairs::{self, JoinScratch};
use jostle_index::quadtree::Quadtree;
use jostle_index::shapes::Shapes;

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
