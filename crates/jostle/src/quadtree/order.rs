//! The order of the shapes: along a Z-curve (Morton order) of their centres.
//!
//! A grid of 2^16 × 2^16 cells over the centres gives each shape a 32-bit key.
//! Where more than a few shapes share the finest cell (a small cluster in a
//! vast world), that cell gets a grid of its own, fitted to its contents, and
//! so on: no position is out of range and no cluster stays unresolved. What
//! still shares a cell is ordered by coordinates, then by the caller's rule,
//! then by row, so that the order comes from the shapes and not from the order
//! in which they were given.

use std::cmp::Ordering;
use std::collections::{HashMap, VecDeque};
use std::ops::Range;

use super::grid::Grid;
use super::sort::Sorter;
use crate::columns::Columns;
use crate::geometry::Scalar;
use crate::parallel;
use crate::simd::{LANES, Simd, Work};

/// Runs of equal keys up to this length are sorted by comparing; longer ones
/// are given a finer grid.
const SHORT_RUN: usize = 8;

/// Keys of the places `start..end` of the order, in one grid.
#[derive(Clone, Debug, Default)]
pub struct Keyed {
    /// First place.
    pub start: usize,
    /// Behind the last place.
    pub end: usize,
    /// The grid of the keys.
    pub grid: Grid,
    /// One key for each place, ascending.
    pub keys: Vec<u32>,
}

impl Keyed {
    /// The key of the shape at a place.
    pub fn key(&self, place: usize) -> u32 {
        self.keys[place - self.start]
    }
}

/// The shapes' rows in canonical order, and the keys that led there.
#[derive(Clone, Debug, Default)]
pub struct Order {
    /// `rows[place]` is the shape's row in the caller's columns.
    pub rows: Vec<u32>,
    /// The first entry keys all places; each further one the places that shared
    /// one finest cell of an earlier entry.
    pub keyed: Vec<Keyed>,
    finer: HashMap<(usize, usize), usize>,
    sorter: Sorter,
}

impl Order {
    /// Orders the shapes. `tie` compares two rows whose centres coincide.
    pub fn sort<T: Scalar>(
        &mut self,
        columns: &Columns<T>,
        tie: &impl Fn(usize, usize) -> Ordering,
        threads: Option<usize>,
    ) {
        let len = columns.len();
        self.rows.clear();
        self.rows.extend(0..len as u32);
        let mut root = self.keyed.drain(..).next().unwrap_or_default();
        (root.start, root.end) = (0, len);
        self.finer.clear();
        if len == 0 {
            return;
        }
        let mut open = VecDeque::new();
        if let Some(grid) = grid_of_all(columns) {
            root.grid = grid;
            self.sort_by_key(&mut root, threads, &mut open, |rows, items| {
                let range = rows[0] as usize..rows[0] as usize + rows.len();
                let (x, y) = (&columns.x[range.clone()], &columns.y[range]);
                T::with_widest(KeyRows { grid: &grid, x, y, rows, items });
            });
        } else {
            root.grid = Grid::at([columns.x[0].to_f64(), columns.y[0].to_f64()]);
            root.keys.clear();
            root.keys.resize(len, 0);
            open.extend((len > 1).then_some(0..len));
        }
        self.keyed.push(root);
        while let Some(range) = open.pop_front() {
            self.resolve(range, columns, tie, threads, &mut open);
        }
    }

    /// The index in `keyed` of the finer grid made for exactly these places.
    pub fn finer(&self, start: usize, end: usize) -> Option<usize> {
        self.finer.get(&(start, end)).copied()
    }

    /// Orders a range of places that share a key: few by comparing, many by the keys of
    /// a finer grid, which may leave ranges `open` in their turn.
    fn resolve<T: Scalar>(
        &mut self,
        range: Range<usize>,
        columns: &Columns<T>,
        tie: &impl Fn(usize, usize) -> Ordering,
        threads: Option<usize>,
        open: &mut VecDeque<Range<usize>>,
    ) {
        let rows = &mut self.rows[range.clone()];
        let finer = if rows.len() > SHORT_RUN { grid_of(columns, rows) } else { None };
        let Some(grid) = finer else {
            rows.sort_unstable_by(|&a, &b| {
                let (i, j) = (a as usize, b as usize);
                let by_x = columns.x[i].total_order(&columns.x[j]);
                let by_place = by_x.then_with(|| columns.y[i].total_order(&columns.y[j]));
                by_place.then_with(|| tie(i, j)).then(a.cmp(&b))
            });
            return;
        };
        let Range { start, end } = range;
        let mut keyed = Keyed { start, end, grid, keys: Vec::new() };
        self.sort_by_key(&mut keyed, threads, open, |rows, items| {
            for (&row, item) in rows.iter().zip(items) {
                let center = [columns.x[row as usize].to_f64(), columns.y[row as usize].to_f64()];
                *item = u64::from(grid.key(center)) << 32 | u64::from(row);
            }
        });
        self.finer.insert((start, end), self.keyed.len());
        self.keyed.push(keyed);
    }

    /// Sorts the rows at `keyed`'s places by `key`, then by row, and fills in the keys.
    /// Ranges that share a key are left `open`.
    fn sort_by_key(
        &mut self,
        keyed: &mut Keyed,
        threads: Option<usize>,
        open: &mut VecDeque<Range<usize>>,
        key: impl Fn(&[u32], &mut [u64]) + Sync + Send,
    ) {
        let rows = &mut self.rows[keyed.start..keyed.end];
        keyed.keys.resize(rows.len(), 0);
        let threads = parallel::worthwhile(threads, rows.len());
        let equal = self.sorter.sort(threads, rows, &mut keyed.keys, key);
        open.extend(equal.iter().map(|range| keyed.start + range.start..keyed.start + range.end));
    }
}

/// The keys of adjacent rows.
struct KeyRows<'a, T> {
    grid: &'a Grid,
    x: &'a [T],
    y: &'a [T],
    rows: &'a [u32],
    items: &'a mut [u64],
}

impl<T: Scalar> Work<T> for KeyRows<'_, T> {
    type Out = ();

    #[inline(always)]
    fn run<S: Simd<T>>(self, _: S) {
        let rows = self.x.iter().zip(self.y).zip(self.rows);
        for (((&x, &y), &row), item) in rows.zip(self.items) {
            let key = self.grid.key([x.to_f64(), y.to_f64()]);
            *item = u64::from(key) << 32 | u64::from(row);
        }
    }
}

/// The grid around all centres; none where they all coincide.
fn grid_of_all<T: Scalar>(columns: &Columns<T>) -> Option<Grid> {
    let len = columns.len();
    let x = T::with_widest(Extent(&columns.x[..len]));
    let y = T::with_widest(Extent(&columns.y[..len]));
    grid_around([x[0], y[0]], [x[1], y[1]])
}

/// The smallest and the largest of some numbers.
struct Extent<'a, T>(&'a [T]);

impl<T: Scalar> Work<T> for Extent<'_, T> {
    type Out = [T; 2];

    #[inline(always)]
    fn run<S: Simd<T>>(self, simd: S) -> [T; 2] {
        let (blocks, rest) = self.0.as_chunks::<LANES>();
        let first = simd.splat(self.0[0]);
        let (mut low, mut high) = (first, first);
        for block in blocks {
            let block = simd.load(block);
            (low, high) = (simd.least(low, block), simd.most(high, block));
        }
        let (mut lows, mut highs) = ([self.0[0]; LANES], [self.0[0]; LANES]);
        simd.store(low, &mut lows);
        simd.store(high, &mut highs);
        let low = lows.iter().chain(rest).copied().reduce(T::least);
        let high = highs.iter().chain(rest).copied().reduce(T::most);
        [low.unwrap_or(self.0[0]), high.unwrap_or(self.0[0])]
    }
}

/// The grid around the centres of `rows`; none where they all coincide.
fn grid_of<T: Scalar>(columns: &Columns<T>, rows: &[u32]) -> Option<Grid> {
    let center = |row: u32| [columns.x[row as usize], columns.y[row as usize]];
    let (mut min, mut max) = (center(rows[0]), center(rows[0]));
    for &row in rows {
        for axis in 0..2 {
            min[axis] = min[axis].least(center(row)[axis]);
            max[axis] = max[axis].most(center(row)[axis]);
        }
    }
    grid_around(min, max)
}

fn grid_around<T: Scalar>(min: [T; 2], max: [T; 2]) -> Option<Grid> {
    (min != max).then(|| Grid::around(min.map(Scalar::to_f64), max.map(Scalar::to_f64)))
}
