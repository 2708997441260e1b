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
use super::sort::{FillKeys, Item, Parts, Sorter, key_of};
use crate::error::Result;
use crate::geometry::Scalar;
use crate::interrupt::{self, Pulse};
use crate::memory;
use crate::parallel;
use crate::shapes::Shapes;
use crate::simd::{LANES, Simd, Work};

/// Runs of equal keys up to this length are sorted by comparing; longer ones
/// are given a finer grid.
const SHORT_RUN: usize = 8;

/// Compares two rows whose centres coincide. It is called seldom, so the sorting does not
/// depend on its type and is compiled once.
pub type Tie<'a> = dyn Fn(usize, usize) -> Ordering + 'a;

/// Keys of the places `start..end` of the order, in one grid.
#[derive(Clone, Debug, Default)]
pub struct Keyed {
    /// First place.
    pub start: usize,
    /// Behind the last place.
    pub end: usize,
    /// The grid of the keys.
    pub grid: Grid,
    /// The key of each place above its row when it was sorted, ascending.
    pub items: Vec<Item>,
    parts: Parts,
}

impl Keyed {
    /// The key of the shape at a place.
    pub fn key(&self, place: usize) -> u32 {
        key_of(self.items[place - self.start])
    }

    /// The first place whose key is at least `bound`.
    pub fn first_at_least(&self, bound: u32) -> usize {
        self.start + self.parts.first_at_least(&self.items, bound)
    }

    /// The items of some places.
    pub fn items(&self, places: Range<usize>) -> &[Item] {
        &self.items[places.start - self.start..places.end - self.start]
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
    /// Ranges of places that share a key.
    equal: Vec<Range<usize>>,
    /// Those that are not in order yet.
    open: VecDeque<Range<usize>>,
}

impl Order {
    /// Orders the shapes. `tie` compares two rows whose centres coincide.
    pub fn sort<T: Scalar>(
        &mut self,
        shapes: &Shapes<T>,
        tie: &Tie<'_>,
        threads: Option<usize>,
    ) -> Result<()> {
        let len = shapes.len();
        interrupt::check()?;
        self.rows.clear();
        memory::reserve(&mut self.rows, len)?;
        self.rows.extend(0..len as u32);
        let mut root = self.keyed.drain(..).next().unwrap_or_default();
        (root.start, root.end) = (0, len);
        self.finer.clear();
        if len == 0 {
            return Ok(());
        }
        let mut open = std::mem::take(&mut self.open);
        open.clear();
        if let Some(grid) = grid_of_all(&shapes.centers) {
            root.grid = grid;
            self.sort_by_key(&mut root, threads, &mut open, &|range, items| {
                let centers = &shapes.centers[range.clone()];
                T::with_widest(KeyRows { grid: &grid, centers, first: range.start, items });
            })?;
        } else {
            root.grid = Grid::at(shapes.centers[0].map(T::to_f64));
            root.items.clear();
            root.parts.clear();
            memory::reserve(&mut root.items, len)?;
            root.items.extend(0..len as Item);
            open.extend((len > 1).then_some(0..len));
        }
        self.keyed.push(root);
        let mut pulse = Pulse::current();
        while let Some(range) = open.pop_front() {
            pulse.check(range.len())?;
            self.resolve(range, shapes, tie, threads, &mut open)?;
        }
        self.open = open;
        Ok(())
    }

    /// Forgets all rows and keeps their memory.
    pub fn clear(&mut self) {
        self.rows.clear();
        self.finer.clear();
        self.keyed.truncate(1);
        if let Some(root) = self.keyed.first_mut() {
            root.items.clear();
            root.parts.clear();
        }
    }

    /// Bytes of memory that it keeps, used or not.
    pub fn kept_bytes(&self) -> usize {
        let items: usize = self.keyed.iter().map(|keyed| keyed.items.capacity()).sum();
        let grids = self.keyed.capacity() * (size_of::<Keyed>() + size_of::<[usize; 4]>());
        grids
            + items * size_of::<Item>()
            + self.rows.capacity() * size_of::<u32>()
            + (self.equal.capacity() + self.open.capacity()) * size_of::<Range<usize>>()
            + self.sorter.kept_bytes()
    }

    /// Gives back the memory that only sorting needs.
    pub fn forget_scratch(&mut self) {
        self.sorter = Sorter::default();
        self.equal = Vec::new();
        self.open = VecDeque::new();
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
        shapes: &Shapes<T>,
        tie: &Tie<'_>,
        threads: Option<usize>,
        open: &mut VecDeque<Range<usize>>,
    ) -> Result<()> {
        let rows = &mut self.rows[range.clone()];
        let finer = if rows.len() > SHORT_RUN { grid_of(shapes, rows) } else { None };
        let Some(grid) = finer.filter(Grid::is_finite) else {
            rows.sort_unstable_by(|&a, &b| {
                let (i, j) = (a as usize, b as usize);
                let [[a_x, a_y], [b_x, b_y]] = [shapes.centers[i], shapes.centers[j]];
                let by_place = a_x.total_order(&b_x).then_with(|| a_y.total_order(&b_y));
                by_place.then_with(|| tie(i, j)).then(a.cmp(&b))
            });
            return Ok(());
        };
        let Range { start, end } = range;
        let mut keyed = Keyed { start, end, grid, ..Keyed::default() };
        let rows = memory::collect(rows.iter().copied())?;
        self.sort_by_key(&mut keyed, threads, open, &|range, items| {
            for (&row, item) in rows[range].iter().zip(items) {
                let center = shapes.centers[row as usize].map(T::to_f64);
                *item = u64::from(grid.key(center)) << 32 | u64::from(row);
            }
        })?;
        let entries = self.finer.len() + 1;
        self.finer.try_reserve(1).map_err(|e| memory::no_memory::<[usize; 4]>(&e, entries))?;
        self.finer.insert((start, end), self.keyed.len());
        memory::push(&mut self.keyed, keyed)
    }

    /// Sorts the shapes at `keyed`'s places by their keys, then by row. Ranges that share
    /// a key are left `open`. `key` fills in the items of some of the rows.
    fn sort_by_key(
        &mut self,
        keyed: &mut Keyed,
        threads: Option<usize>,
        open: &mut VecDeque<Range<usize>>,
        key: &FillKeys<'_>,
    ) -> Result<()> {
        let rows = &mut self.rows[keyed.start..keyed.end];
        let threads = parallel::worthwhile(threads, rows.len());
        memory::resize(&mut keyed.items, rows.len(), 0)?;
        let (Keyed { items, parts, .. }, equal) = (&mut *keyed, &mut self.equal);
        self.sorter.sort(threads, items, parts, key, equal)?;
        let ranges = open.len() + equal.len();
        open.try_reserve(equal.len()).map_err(|e| memory::no_memory::<Range<usize>>(&e, ranges))?;
        open.extend(equal.iter().map(|range| keyed.start + range.start..keyed.start + range.end));
        parallel::for_chunks(threads, rows, |first, rows| {
            for (row, &item) in rows.iter_mut().zip(&keyed.items[first..]) {
                *row = item as u32;
            }
        });
        Ok(())
    }
}

/// The keys of adjacent rows.
struct KeyRows<'a, T> {
    grid: &'a Grid,
    centers: &'a [[T; 2]],
    first: usize,
    items: &'a mut [Item],
}

impl<T: Scalar> Work<T> for KeyRows<'_, T> {
    type Out = ();

    #[inline(always)]
    fn run<S: Simd<T>>(self, _: S) {
        for ((row, center), item) in (self.first..).zip(self.centers).zip(self.items) {
            let key = self.grid.key(center.map(T::to_f64));
            *item = u64::from(key) << 32 | row as u64;
        }
    }
}

/// The grid around all centres; none where they all coincide.
fn grid_of_all<T: Scalar>(centers: &[[T; 2]]) -> Option<Grid> {
    let [min, max] = T::with_widest(Extent(centers));
    grid_around(min, max)
}

/// The corners of the box around some centres.
struct Extent<'a, T>(&'a [[T; 2]]);

impl<T: Scalar> Work<T> for Extent<'_, T> {
    type Out = [[T; 2]; 2];

    /// Lanes hold x and y in turn.
    #[inline(always)]
    fn run<S: Simd<T>>(self, simd: S) -> Self::Out {
        let numbers = self.0.as_flattened();
        let (blocks, rest) = numbers.as_chunks::<LANES>();
        let mut lows: [T; LANES] = std::array::from_fn(|lane| numbers[lane % 2]);
        let mut highs = lows;
        let (mut low, mut high) = (simd.load(&lows), simd.load(&lows));
        for block in blocks {
            let block = simd.load(block);
            (low, high) = (simd.least(low, block), simd.most(high, block));
        }
        simd.store(low, &mut lows);
        simd.store(high, &mut highs);
        let of_axis = |lanes: &[T; LANES], axis: usize, both: fn(T, T) -> T| {
            let all = lanes.iter().chain(rest).skip(axis).step_by(2).copied();
            all.reduce(both).unwrap_or(numbers[axis])
        };
        let both_axes = |lanes: &[T; LANES], both| [0, 1].map(|axis| of_axis(lanes, axis, both));
        [both_axes(&lows, T::least), both_axes(&highs, T::most)]
    }
}

/// The grid around the centres of `rows`; none where they all coincide.
fn grid_of<T: Scalar>(shapes: &Shapes<T>, rows: &[u32]) -> Option<Grid> {
    let center = |row: u32| shapes.centers[row as usize];
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
