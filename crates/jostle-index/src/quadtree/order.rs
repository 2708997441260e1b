//! The Morton order of the shapes' centres.
//!
//! A grid of 2^16 × 2^16 cells over the centres gives each shape a 32-bit key. If more than a
//! few shapes are in one finest cell (a small cluster in a large world), they get a grid of their
//! own, fitted to them, and so on. So positions are not limited to a range, and clusters are
//! resolved at any scale. Shapes that are still in one cell are ordered by their coordinates,
//! then by the caller's rule, then by row. So the order depends on the shapes, and on the order
//! in which they were given only if they are equal.

use std::cmp::Ordering;
use std::collections::{HashMap, VecDeque};
use std::ops::Range;

use super::grid::{Grid, NESTED};
use super::partition::{Item, Source};
use super::sort::{BlockStarts, Precision, Sorter};
use crate::geometry::Scalar;
use crate::shapes::Shapes;
use jostle_base::error::Result;
use jostle_base::interrupt::{self, Pulse};
use jostle_base::memory;
use jostle_base::parallel;
use jostle_simd::{LANES, Simd, Work};

/// Runs of equal keys up to this length are sorted by comparison; longer ones get a finer grid.
const SHORT_RUN: usize = 8;

/// Compares two rows whose centres coincide. A trait object, so that the sorting is compiled once;
/// calls are rare.
pub(super) type Tie<'a> = dyn Fn(usize, usize) -> Ordering + 'a;

/// Keys of the indices `start..end` of the order, in one grid.
#[derive(Clone, Debug, Default)]
pub(super) struct Keyed<T> {
    /// First index.
    pub start: usize,
    /// Index after the last one.
    pub end: usize,
    /// The grid of the keys.
    pub grid: Grid,
    /// The shapes with their keys, sorted as far as the tree requires.
    pub items: Vec<Item<T>>,
    parts: BlockStarts,
}

impl<T> Keyed<T> {
    /// The key of the shape at an index.
    pub(super) fn key(&self, index: usize) -> u32 {
        self.items[index - self.start].key
    }

    /// The first index whose key is at least `bound`.
    pub(super) fn first_at_least(&self, bound: u32) -> usize {
        self.start + self.parts.first_at_least(&self.items, bound)
    }

    /// The items of some indices.
    pub(super) fn items(&self, indices: Range<usize>) -> &[Item<T>] {
        &self.items[indices.start - self.start..indices.end - self.start]
    }
}

/// The rows of the shapes in Morton order, and the keys.
#[derive(Clone, Debug, Default)]
pub(super) struct Order<T> {
    /// `rows[index]` is the shape's row in the caller's columns.
    pub rows: Vec<u32>,
    /// The first entry has the keys of all indices; each other entry those of indices that are in
    /// one finest cell of an earlier entry.
    pub keyed: Vec<Keyed<T>>,
    /// The AABB of the grid, if it is given.
    pub extent: Option<[[T; 2]; 2]>,
    /// Whether finer grids are the cells of the first one, so that the order of two shapes does not
    /// depend on others.
    pub is_nested: bool,
    finer: HashMap<(usize, usize), usize>,
    sorter: Sorter<T>,
    /// Ranges of indices that share a key.
    equal: Vec<Range<usize>>,
    /// Those that are not sorted yet.
    open: VecDeque<Range<usize>>,
}

impl<T: Scalar> Order<T> {
    /// Sorts the shapes. `tie` compares two rows whose centres coincide. If `unsorted` is above 0,
    /// groups of at most this number, which fit into a leaf, may be in the order of their rows.
    pub(super) fn sort(
        &mut self,
        shapes: &Shapes<T>,
        tie: &Tie<'_>,
        unsorted: usize,
        threads: Option<usize>,
    ) -> Result<()> {
        let len = shapes.len();
        interrupt::check()?;
        // The grid of all shapes is kept for its memory. Finer grids are dropped: how many there
        // will be, and how large, is different each time.
        let mut root = self.keyed.drain(..).next().unwrap_or_default();
        (root.start, root.end) = (0, len);
        self.finer.clear();
        if len == 0 {
            return Ok(());
        }
        let mut open = std::mem::take(&mut self.open);
        open.clear();
        let centers = &shapes.centers;
        let extent = extent_of(centers);
        let known = grid_around(self.extent.unwrap_or(extent), self.is_nested);
        // All centres coincide. Any grid with finite numbers will do, because the keys of all are
        // equal in it.
        let grid = known.unwrap_or(Grid::at(centers[0].map(T::to_f64)));
        let precision = match unsorted {
            0 => Precision::Full,
            max => Precision::Groups { max, occupied: occupied(&grid, extent) },
        };
        self.sort_by_key(&mut root, threads, precision, &Centers { grid, centers }, &mut open)?;
        self.keyed.push(root);
        let mut pulse = Pulse::current();
        // A queue instead of recursion: with clusters in clusters the depth follows from the data.
        while let Some(range) = open.pop_front() {
            pulse.check(range.len())?;
            self.resolve(range, tie, threads, &mut open)?;
        }
        self.open = open;
        Ok(())
    }

    /// An order without keys, for a copy of a tree whose boxes are not listed.
    pub(super) fn of_rows(rows: Vec<u32>) -> Self {
        Self { rows, ..Self::default() }
    }

    /// Removes all rows and keeps their memory.
    pub(super) fn clear(&mut self) {
        self.rows.clear();
        self.finer.clear();
        self.keyed.truncate(1);
        if let Some(root) = self.keyed.first_mut() {
            root.items.clear();
            root.parts.clear();
        }
    }

    /// Allocated bytes, used or not.
    pub(super) fn memory_bytes(&self) -> usize {
        let items: usize = self.keyed.iter().map(|keyed| keyed.items.capacity()).sum();
        let grids = self.keyed.capacity() * (size_of::<Keyed<T>>() + size_of::<[usize; 4]>());
        grids
            + items * size_of::<Item<T>>()
            + self.rows.capacity() * size_of::<u32>()
            + (self.equal.capacity() + self.open.capacity()) * size_of::<Range<usize>>()
            + self.sorter.memory_bytes()
    }

    /// Frees the memory that only sorting uses.
    pub(super) fn free_scratch(&mut self) {
        self.sorter = Sorter::default();
        self.equal = Vec::new();
        self.open = VecDeque::new();
    }

    /// The index in `keyed` of the finer grid for exactly these indices.
    pub(super) fn finer(&self, start: usize, end: usize) -> Option<usize> {
        self.finer.get(&(start, end)).copied()
    }

    /// Sorts a range of indices that share a key: few by comparison, many by the keys of a finer
    /// grid, which may append ranges to `open`.
    fn resolve(
        &mut self,
        range: Range<usize>,
        tie: &Tie<'_>,
        threads: Option<usize>,
        open: &mut VecDeque<Range<usize>>,
    ) -> Result<()> {
        let (root, is_nested) = (self.keyed[0].grid, self.is_nested);
        let items = &mut self.keyed[0].items[range.clone()];
        // In a grid of their own, fitted to them, most shapes of a cluster get keys of their own at
        // once. For a few shapes the search of the extent and another sort cost more than
        // comparisons.
        let finer = match items.len() {
            0..=SHORT_RUN => None,
            // A fitted grid would depend on which other shapes are in the cell. The cells of the
            // first grid do not.
            _ if is_nested => cell_of(root, items),
            _ => grid_of(items),
        };
        // Few shapes, or coincident ones, or coordinates so close that not even `NESTED` grids
        // separate them. The comparison ends with the row, so that it is a total order: without one
        // the result of an unstable sort is not defined.
        let Some(grid) = finer.filter(Grid::is_finite) else {
            items.sort_unstable_by(|a, b| {
                let ([a_x, a_y], [b_x, b_y]) = (a.center, b.center);
                let nested = || root.compare(a.center.map(T::to_f64), b.center.map(T::to_f64));
                // Short runs, too, must be in Morton order if the order of two shapes may not
                // depend on a third: with one more shape in its cell the same pair would be sorted
                // by keys.
                let by_cell = if is_nested { nested() } else { Ordering::Equal };
                let by_x = by_cell.then_with(|| a_x.total_order(&b_x));
                let by_position = by_x.then_with(|| a_y.total_order(&b_y));
                let by_tie = by_position.then_with(|| tie(a.row as usize, b.row as usize));
                by_tie.then(a.row.cmp(&b.row))
            });
            return Ok(());
        };
        let Range { start, end } = range;
        let mut keyed = Keyed { start, end, ..Keyed::default() };
        // A copy, since the sorted items are written over those that are read.
        let items = memory::collect(items.iter().copied())?;
        let source = Items { grid, items: &items };
        self.sort_by_key(&mut keyed, threads, Precision::Full, &source, open)?;
        for (item, finer) in self.keyed[0].items[start..end].iter_mut().zip(&keyed.items) {
            // The shape moves, the key stays: keys of the first grid must remain ascending, because
            // the upper nodes are found in them. The finer keys are in an entry of their own.
            *item = Item { key: item.key, ..*finer };
        }
        let entries = self.finer.len() + 1;
        self.finer.try_reserve(1).map_err(|e| memory::no_memory::<[usize; 4]>(&e, entries))?;
        // The builder reaches this range as a node whose keys are all equal, and asks for it by its
        // ends. The map is never iterated, so its order has no effect.
        self.finer.insert((start, end), self.keyed.len());
        memory::push(&mut self.keyed, keyed)
    }

    /// Sorts the shapes of a source, those at the indices of `keyed`, by key, then by row. Appends
    /// the ranges that share a key to `open`.
    fn sort_by_key(
        &mut self,
        keyed: &mut Keyed<T>,
        threads: Option<usize>,
        precision: Precision,
        source: &impl GridSource<T>,
        open: &mut VecDeque<Range<usize>>,
    ) -> Result<()> {
        keyed.grid = source.grid();
        let threads = parallel::worthwhile(threads, source.len());
        let (Keyed { items, parts, .. }, equal) = (&mut *keyed, &mut self.equal);
        self.sorter.sort(threads, precision, source, items, parts, equal)?;
        let ranges = open.len() + equal.len();
        open.try_reserve(equal.len()).map_err(|e| memory::no_memory::<Range<usize>>(&e, ranges))?;
        // The ranges count from the first item of this grid, `open` from the first of all.
        open.extend(equal.iter().map(|range| keyed.start + range.start..keyed.start + range.end));
        Ok(())
    }
}

/// Shapes and the grid of their keys.
trait GridSource<T>: Source<T> {
    fn grid(&self) -> Grid;
}

/// All shapes, as the source of the first sort.
struct Centers<'a, T> {
    grid: Grid,
    centers: &'a [[T; 2]],
}

/// Shapes that share a key, as the source of a finer sort.
struct Items<'a, T> {
    grid: Grid,
    items: &'a [Item<T>],
}

impl<T: Scalar> GridSource<T> for Centers<'_, T> {
    fn grid(&self) -> Grid {
        self.grid
    }
}

impl<T: Scalar> GridSource<T> for Items<'_, T> {
    fn grid(&self) -> Grid {
        self.grid
    }
}

impl<T: Scalar> Source<T> for Centers<'_, T> {
    fn len(&self) -> usize {
        self.centers.len()
    }

    fn keys(&self, range: Range<usize>, keys: &mut [u32]) {
        T::with_widest(Keys { grid: &self.grid, centers: &self.centers[range], keys });
    }

    #[inline(always)]
    fn item(&self, index: usize, key: u32) -> Item<T> {
        Item { key, row: index as u32, center: self.centers[index], sizes: [] }
    }
}

impl<T: Scalar> Source<T> for Items<'_, T> {
    fn len(&self) -> usize {
        self.items.len()
    }

    fn keys(&self, range: Range<usize>, keys: &mut [u32]) {
        for (item, key) in self.items[range].iter().zip(keys) {
            *key = self.grid.key(item.center.map(T::to_f64));
        }
    }

    #[inline(always)]
    fn item(&self, index: usize, key: u32) -> Item<T> {
        Item { key, ..self.items[index] }
    }
}

/// Computes the keys of some centres.
struct Keys<'a, T> {
    grid: &'a Grid,
    centers: &'a [[T; 2]],
    keys: &'a mut [u32],
}

impl<T: Scalar> Work<T> for Keys<'_, T> {
    type Out = ();

    #[inline(always)]
    fn run<S: Simd<T>>(self, _: S) {
        let (blocks, rest) = self.centers.as_chunks::<LANES>();
        let (key_blocks, rest_keys) = self.keys.as_chunks_mut::<LANES>();
        for (block, keys) in blocks.iter().zip(key_blocks) {
            let (mut x, mut y) = ([0.0; LANES], [0.0; LANES]);
            for lane in 0..LANES {
                (x[lane], y[lane]) = (block[lane][0].to_f64(), block[lane][1].to_f64());
            }
            *keys = self.grid.keys(&x, &y);
        }
        for (center, key) in rest.iter().zip(rest_keys) {
            *key = self.grid.key(center.map(T::to_f64));
        }
    }
}

/// The fraction of a grid that the bounding box of the centres covers, at least 0.001.
fn occupied<T: Scalar>(grid: &Grid, [min, max]: [[T; 2]; 2]) -> f64 {
    let [width, height] = [0, 1].map(|axis| grid.fraction(max[axis].to_f64(), min[axis].to_f64()));
    // Centres on a line cover nothing. Without a limit the expected number of groups would be
    // infinite.
    (width * height).clamp(1e-3, 1.0)
}

/// The bounding box of some centres, of which there must be one.
pub fn extent_of<T: Scalar>(centers: &[[T; 2]]) -> [[T; 2]; 2] {
    T::with_widest(Extent(centers))
}

/// Computes the bounding box of some centres.
struct Extent<'a, T>(&'a [[T; 2]]);

impl<T: Scalar> Work<T> for Extent<'_, T> {
    type Out = [[T; 2]; 2];

    /// Even lanes have x, odd lanes y.
    #[inline(always)]
    fn run<S: Simd<T>>(self, simd: S) -> Self::Out {
        let numbers = self.0.as_flattened();
        let (blocks, rest) = numbers.as_chunks::<LANES>();
        // The first centre in all lanes: a lane that gets no other number then changes nothing.
        let mut lows: [T; LANES] = std::array::from_fn(|lane| numbers[lane % 2]);
        let mut highs = lows;
        let (mut low, mut high) = (simd.load(&lows), simd.load(&lows));
        for block in blocks {
            let block = simd.load(block);
            (low, high) = (simd.min(low, block), simd.max(high, block));
        }
        simd.store(low, &mut lows);
        simd.store(high, &mut highs);
        // The rest begins after whole blocks, at an even number, so x is at even places in it too.
        let along = |lanes: &[T; LANES], axis: usize, both: fn(T, T) -> T| {
            let all = lanes.iter().chain(rest).skip(axis).step_by(2).copied();
            all.reduce(both).unwrap_or(numbers[axis])
        };
        let both_axes = |lanes: &[T; LANES], both| [0, 1].map(|axis| along(lanes, axis, both));
        [both_axes(&lows, T::min), both_axes(&highs, T::max)]
    }
}

/// The grid over some shapes; None if all centres coincide.
fn grid_of<T: Scalar>(items: &[Item<T>]) -> Option<Grid> {
    let (mut min, mut max) = (items[0].center, items[0].center);
    for item in items {
        for axis in 0..2 {
            min[axis] = min[axis].min(item.center[axis]);
            max[axis] = max[axis].max(item.center[axis]);
        }
    }
    grid_around([min, max], false)
}

/// The first of the cells of a grid, of their cells and so on that separates some shapes; None if
/// none does.
fn cell_of<T: Scalar>(root: Grid, items: &[Item<T>]) -> Option<Grid> {
    let mut grid = root;
    for _ in 0..NESTED {
        let key = |item: &Item<T>| grid.key(item.center.map(T::to_f64));
        let first = key(&items[0]);
        // A grid in which all shapes share a key divides nothing, so it is skipped.
        if !items.iter().all(|item| key(item) == first) {
            return Some(grid);
        }
        grid = grid.inside(first);
    }
    None
}

/// The grid over a bounding box, `nested` or not; None if it is a point.
fn grid_around<T: Scalar>([min, max]: [[T; 2]; 2], nested: bool) -> Option<Grid> {
    let around = if nested { Grid::nested_around } else { Grid::around };
    (min != max).then(|| around(min.map(Scalar::to_f64), max.map(Scalar::to_f64)))
}
