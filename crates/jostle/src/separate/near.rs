//! Lists of the pairs that may overlap before a shape has moved by half a margin.
//!
//! L. Verlet, *Computer "Experiments" on Classical Fluids*, Phys. Rev. 159 (1967), for lists with a
//! margin.

use std::ops::Range;

use super::bodies::{Bodies, Body};
use crate::error::Result;
use crate::geometry::Scalar;
use crate::memory;
use crate::pairs::{self, JoinScratch};
use crate::parallel::CHUNK;
use crate::quadtree::Quadtree;
use crate::settings::{DEFAULT_MAX_PAIRS, Settings};
use crate::shapes::{Each, Shapes};
use crate::sorting;

/// Margin, as a share of the mean extent of the shapes.
const MARGIN: f64 = 0.5;

/// The margin of shapes with these mean extents.
pub fn margin<T: Scalar>([x, y]: [T; 2], gap: T) -> T {
    (x.min(y).max(T::from_f64(0.1) * x.max(y)) + gap) * T::from_f64(MARGIN)
}

/// Shapes that overlap if the gap between the bodies is below the margin and the least gap.
pub fn wide_shapes<T: Scalar>(
    bodies: &[Body<T>],
    centers: Vec<[T; 2]>,
    margin_and_gap: T,
) -> Result<Shapes<T>> {
    let wider = margin_and_gap * T::from_f64(0.5);
    let radii = memory::collect(bodies.iter().map(|body| body.radius + wider))?;
    let mut shapes = Shapes { centers, radii: Each::Rows(radii), ..Shapes::default() };
    if bodies.iter().any(|body| body.half != [T::ZERO; 2]) {
        let halves = memory::collect(bodies.iter().map(|body| body.half))?;
        shapes.half_sizes = Some(Each::Rows(halves));
    }
    Ok(shapes)
}

/// For each shape the others near it, ascending. A pair within one chunk of [`CHUNK`] places is
/// listed for its first shape, another pair for both.
#[derive(Clone, Debug, Default)]
pub struct Near<T> {
    ends: Vec<u32>,
    others: Vec<u32>,
    /// Shapes and those listed for them, and scratch of their sorting.
    listed: Vec<[u32; 2]>,
    spare: Vec<[u32; 2]>,
    /// The centres for which the lists were made.
    pub origins: Vec<[T; 2]>,
    margin: T,
    gap: T,
    shapes: Shapes<T>,
    tree: Quadtree<T>,
    scratch: JoinScratch,
}

impl<T: Scalar> Near<T> {
    /// Empty lists for `bodies`.
    pub fn of(bodies: &Bodies<T>, gap: T) -> Self {
        Self { margin: margin(bodies.mean_extents, gap), gap, ..Self::default() }
    }

    /// The distance from its origin up to which a shape may move; slightly less than half the
    /// margin, because of rounding.
    pub fn reach(&self) -> T {
        self.margin * T::from_f64(0.49)
    }

    /// Makes the lists for the current centres.
    pub fn find(&mut self, bodies: &Bodies<T>, threads: Option<usize>) -> Result<()> {
        if self.shapes.centers.is_empty() {
            let centers = memory::collect(bodies.centers.iter().copied())?;
            self.shapes = wide_shapes(&bodies.all, centers, self.margin + self.gap)?;
        } else {
            self.shapes.centers.copy_from_slice(&bodies.centers);
        }
        let mut tree = std::mem::take(&mut self.tree);
        tree.fill_unordered(&self.shapes, Settings { threads, ..Settings::default() })?;
        self.find_in(&tree, Some(tree.rows()), bodies)?;
        self.tree = tree;
        Ok(())
    }

    /// Makes the lists from a tree of the shapes, [`wide_shapes`], with the current centres. `rows`
    /// are the bodies in its order, if that is not theirs.
    pub fn find_in(
        &mut self,
        tree: &Quadtree<T>,
        rows: Option<&[u32]>,
        bodies: &Bodies<T>,
    ) -> Result<()> {
        let found = pairs::places_within(tree, DEFAULT_MAX_PAIRS, &mut self.scratch)?.pairs;
        let is_fixed = |place: u32| bodies.all[place as usize].is_fixed();
        self.listed.clear();
        memory::reserve(&mut self.listed, 2 * found.len())?;
        for &pair in &found {
            let [a, b] = pair.map(|place| rows.map_or(place, |rows| rows[place as usize]));
            let [i, j] = [a.min(b), a.max(b)];
            if !(is_fixed(i) && is_fixed(j)) {
                self.listed.push([i, j]);
                if chunk(i) != chunk(j) {
                    self.listed.push([j, i]);
                }
            }
        }
        self.scratch.keep(found);
        self.sort(bodies.len())?;
        self.origins.clear();
        memory::reserve(&mut self.origins, bodies.len())?;
        self.origins.extend(&bodies.centers);
        Ok(())
    }

    /// Sorts the lists by the second shape, then by the first.
    fn sort(&mut self, len: usize) -> Result<()> {
        let Self { listed, spare, ends, others, .. } = self;
        memory::resize(spare, listed.len(), [0; 2])?;
        for which in [1, 0] {
            ends.clear();
            memory::resize(ends, len, 0)?;
            sorting::counting_sort(listed, |entry| entry[which] as usize, ends, spare);
            std::mem::swap(listed, spare);
        }
        others.clear();
        memory::reserve(others, listed.len())?;
        others.extend(listed.iter().map(|entry| entry[1]));
        Ok(())
    }

    /// The places of the shapes listed for the one at `place`.
    #[inline(always)]
    pub fn of_place(&self, place: usize) -> &[u32] {
        let start = if place == 0 { 0 } else { self.ends[place - 1] };
        &self.others[start as usize..self.ends[place] as usize]
    }
}

fn chunk(place: u32) -> usize {
    place as usize / CHUNK
}

/// The places of a chunk.
pub fn places_of(chunk: usize, len: usize) -> Range<usize> {
    chunk * CHUNK..len.min((chunk + 1) * CHUNK)
}
