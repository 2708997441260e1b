//! All pairs of circles or rectangles, by uniform grids.
//!
//! A cell is at least as wide and as high as a small shape. A small shape is tested only against
//! those of its own cell, of the next cell and of three cells of the row before. Pairs with the
//! other neighbouring cells are found from the other shape. The tested shapes are two contiguous
//! ranges. A large shape is tested against the small ones of all cells that it may reach. The pairs
//! of two large shapes are found in the same way by a grid of larger cells, until few are left.
//!
//! The shapes are partitioned into bands of adjacent rows. Each band, which fits into the
//! second-level cache, is then sorted into its cells and searched. No more of the grid is stored.

mod band;
mod choice;
mod large;
mod layout;
mod search;
mod sizes;

use std::ops::Range;
use std::sync::Mutex;

use super::Found;
use super::output::{Budget, Output, Pair, PairScratch};
use super::unchanged;
use crate::geometry::Scalar;
use crate::quadtree::extent_of;
use crate::quadtree::partition::{Item, Partition};
use crate::shapes::{Each, Shapes};
use band::Band;
use choice::{Choice, choose};
use jostle_base::error::Result;
use jostle_base::parallel::{self, locked};
use large::Large;
use layout::Layout;
use search::Search;
use sizes::{CIRCLES, EQUAL, Input, Keyed, RECTANGLES, ROUNDED, Rows};

/// For fewer shapes the tree or brute force is faster. Measured with AVX-512; the same for all
/// processors, because the order of the pairs depends on it.
const MIN_SHAPES: usize = 300;

/// As [`MIN_SHAPES`], for shapes of different sizes, for which the choice of a grid takes about 2
/// µs.
const MIN_DIFFERENT: usize = 512;

/// Maximum number of tasks for several threads. A task sorts the band before its first one too.
const MAX_TASKS: usize = 16;

/// Minimum number of bands of a task.
const MIN_BANDS: usize = 4;

/// Scratch, kept between calls.
#[derive(Debug, Default)]
pub(super) struct Grid<T> {
    equal: Levels<T, EQUAL>,
    circles: Levels<T, CIRCLES>,
    rectangles: Levels<T, RECTANGLES>,
    rounded: Levels<T, ROUNDED>,
}

/// Some of the pairs; `rest` are rows of large shapes whose pairs with each other are not in
/// `found`.
pub(super) struct GridPairs {
    pub(super) found: Found,
    pub(super) rest: Vec<u32>,
}

impl<T: Scalar> Grid<T> {
    /// The overlapping pairs of rows, `i < j`, except those of two shapes of `rest`. None if there
    /// are filters, boxes or a period, or if a tree is faster.
    pub(super) fn find(
        &mut self,
        shapes: &Shapes<T>,
        threads: Option<usize>,
        max_pairs: usize,
        scratch: &mut PairScratch,
    ) -> Option<Result<GridPairs>> {
        let Shapes { radii, half_sizes, boxes: None, filters: None, period, .. } = shapes else {
            return None;
        };
        // Measured: with 100 circles the tree takes 21 ns a circle and the grid 39, with 400 they
        // take 27 and 20 (docs/benchmarks-notes.md).
        let equal_circles = matches!((half_sizes, radii), (None, Each::One(_)));
        let least = if equal_circles { MIN_SHAPES } else { MIN_DIFFERENT };
        if shapes.len() < least || !period.is_none() {
            return None;
        }
        let rows = &Rows::of(shapes);
        let Self { equal, circles, rectangles, rounded } = self;
        match (half_sizes, radii) {
            (None, Each::One(radius)) => {
                equal.find(rows, Some(*radius), threads, max_pairs, scratch)
            }
            (None, Each::Rows(_)) => circles.find(rows, None, threads, max_pairs, scratch),
            (Some(_), Each::One(radius)) if *radius == T::ZERO => {
                rectangles.find(rows, None, threads, max_pairs, scratch)
            }
            (Some(_), _) => rounded.find(rows, None, threads, max_pairs, scratch),
        }
    }

    /// Allocated bytes, used or not.
    pub(super) fn memory_bytes(&self) -> usize {
        self.equal.memory_bytes()
            + self.circles.memory_bytes()
            + self.rectangles.memory_bytes()
            + self.rounded.memory_bytes()
    }
}

/// Scratch of the grids of shapes with some number of sizes.
#[derive(Debug, Default)]
struct Levels<T, const SIZES: usize> {
    partition: Partition<T, SIZES>,
    large: Large<T, SIZES>,
    bands: Mutex<Vec<[Band<T, SIZES>; 2]>>,
    /// The large shapes of the level before.
    rest: Vec<Item<T, SIZES>>,
    /// Memory for the pairs of all levels after the first.
    pairs: Vec<Pair>,
}

impl<T: Scalar, const SIZES: usize> Levels<T, SIZES> {
    /// [`Grid::find`] for shapes with some number of sizes, or circles of one radius.
    fn find(
        &mut self,
        rows: &Rows<'_, T>,
        radius: Option<T>,
        threads: Option<usize>,
        max_pairs: usize,
        scratch: &mut PairScratch,
    ) -> Option<Result<GridPairs>> {
        let extent = extent_of(rows.centers);
        let choice = choose::<T, SIZES>(rows, extent, radius)?;
        let found = self.level(rows, choice, threads, max_pairs, scratch)?;
        let mut part = match found {
            Ok(found) => GridPairs { found, rest: Vec::new() },
            Err(error) => return Some(Err(error)),
        };
        if SIZES == EQUAL {
            return Some(Ok(part));
        }
        let more = self.more_levels(extent, threads, max_pairs, scratch, &mut part.found);
        part.rest = self.large.items.iter().map(|item| item.row).collect();
        Some(more.map(|()| part))
    }

    /// Adds the pairs of large shapes, until few are left or a tree is faster.
    fn more_levels(
        &mut self,
        extent: [[T; 2]; 2],
        threads: Option<usize>,
        max_pairs: usize,
        scratch: &mut PairScratch,
        found: &mut Found,
    ) -> Result<()> {
        // Pairs of two large shapes are a search of its own, with larger cells. Each level has at
        // most a tenth of the shapes of the one before, unless the tree is faster, so all further
        // levels take little time.
        while self.large.items.len() >= MIN_SHAPES {
            let rest = std::mem::replace(&mut self.large.items, std::mem::take(&mut self.rest));
            let choice = choose::<T, SIZES>(&rest[..], extent, None);
            scratch.result = std::mem::take(&mut self.pairs);
            let left = max_pairs - found.pairs.len();
            let more =
                choice.and_then(|choice| self.level(&rest[..], choice, threads, left, scratch));
            self.rest = rest;
            let Some(more) = more else {
                // `large` names the shapes whose pairs are missing, for the caller. The level has
                // not been searched, so they are those of the level before.
                std::mem::swap(&mut self.rest, &mut self.large.items);
                return Ok(());
            };
            self.pairs = found.append(more, max_pairs)?;
        }
        Ok(())
    }

    /// The pairs of the small shapes of a grid, and of a small and a large one. None if there are
    /// so many large ones that the tree is faster.
    fn level(
        &mut self,
        input: &(impl Input<T, SIZES> + ?Sized),
        Choice { layout, small }: Choice<T>,
        threads: Option<usize>,
        max_pairs: usize,
        scratch: &mut PairScratch,
    ) -> Option<Result<Found>> {
        let len = input.len();
        let threads = parallel::worthwhile(threads, len);
        let _awake = parallel::keep_awake(threads, len, parallel::WORTH_WAKING);
        let Self { partition, large, .. } = self;
        let source = Keyed { layout, small, input };
        if let Err(error) = partition.fill(threads, &source, layout.bits) {
            return Some(Err(error));
        }
        if SIZES != EQUAL {
            match large.fill(&layout, small, len, partition.pieces(layout.bands)) {
                Ok(true) => {}
                Ok(false) => return None,
                Err(error) => return Some(Err(error)),
            }
        }
        // Of circles of one radius.
        // The same operations as the sum and the square of two radii in a register: the same bits.
        let squared = (small[0] + small[0]) * (small[0] + small[0]);
        // At most one band in four is sorted twice, because each task sorts the one before its
        // first again. Sixteen tasks divide evenly enough among a few threads.
        let tasks = (layout.bands / MIN_BANDS).clamp(1, MAX_TASKS);
        // Each task sorts the band before its first one once more, for its last row. The order of
        // the pairs does not depend on the number of tasks: it is that of the bands.
        let tasks = if parallel::is_parallel(threads) { tasks } else { 1 };
        let budget = Budget::new(max_pairs);
        Some(budget.find(threads, tasks, &unchanged, scratch, |task, output| {
            let first = |task: usize| layout.bands * task / tasks;
            let mut bands = locked(&self.bands).pop().unwrap_or_default();
            self.search(&layout, squared, first(task)..first(task + 1), &mut bands, output);
            locked(&self.bands).push(bands);
        }))
    }

    /// Finds the pairs of the shapes in some bands, with those of the row before them.
    fn search(
        &self,
        layout: &Layout,
        squared: T,
        bands: Range<usize>,
        scratch: &mut [Band<T, SIZES>; 2],
        output: &mut Output<'_>,
    ) {
        scratch.iter_mut().for_each(Band::clear);
        // Two bands are in memory at a time, this one and the one before. The whole grid would be
        // larger than the cache, and has to be read only once.
        for number in bands.start.saturating_sub(1)..bands.end {
            scratch.swap(0, 1);
            let [last, band] = scratch;
            if let Err(error) =
                band.fill(layout, layout.rows_of(number), last, self.partition.pieces(number))
            {
                return output.fail(error);
            }
            if output.is_over(band.indices().len()) {
                return;
            }
            if number >= bands.start {
                let large = &self.large;
                T::with_widest(Search { band, layout, number, large, squared, output });
            }
        }
    }

    /// Allocated bytes, used or not.
    fn memory_bytes(&self) -> usize {
        let bands: usize = locked(&self.bands).iter().flatten().map(Band::memory_bytes).sum();
        self.partition.memory_bytes()
            + self.large.memory_bytes()
            + bands
            + self.rest.capacity() * size_of::<Item<T, SIZES>>()
            + self.pairs.capacity() * size_of::<Pair>()
    }
}
