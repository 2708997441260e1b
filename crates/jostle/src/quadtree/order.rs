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
use std::collections::HashMap;

use crate::columns::Columns;
use crate::geometry::Scalar;

/// Subdivisions that one grid's keys can tell apart.
pub const GRID_LEVELS: u32 = 16;

/// Runs of equal keys up to this length are sorted by comparing; longer ones
/// are given a finer grid.
const SHORT_RUN: usize = 8;

/// Below this many keys a comparison sort beats the radix sort.
const SMALL_SORT: usize = 2048;

/// A square grid over some centres, fitted when it was made.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Grid {
    /// Coordinates are multiplied by this power of two before anything else,
    /// so that neither the largest nor the smallest float64 leaves the range.
    prescale: f64,
    origin: [f64; 2],
    side: f64,
}

impl Grid {
    /// The grid whose cells hold all centres between `min` and `max`.
    ///
    /// The side is a power of two and the origin a multiple of an eighth of
    /// it: as the shapes move, the cells stay where they are.
    fn around(min: [f64; 2], max: [f64; 2]) -> Self {
        let widest =
            |scale: f64| (max[0] * scale - min[0] * scale).max(max[1] * scale - min[1] * scale);
        let prescale = match widest(0.125) {
            extent if extent > 1e300 => 0.125,
            extent if extent < 1e-280 => 2f64.powi(64),
            _ => 1.0,
        };
        let side = power_of_two_at_least(widest(prescale) * (8.0 / 7.0));
        let step = side / 8.0;
        let origin = [0, 1].map(|axis| (min[axis] * prescale / step).floor() * step);
        Self { prescale, origin, side }
    }

    /// The Z-order key of a centre: bits of x and y in turn, coarsest first.
    #[inline]
    fn key(&self, center: [f64; 2]) -> u32 {
        let cells = f64::from(1u32 << GRID_LEVELS) / self.side;
        let index = |axis: usize| {
            let along = (center[axis] * self.prescale - self.origin[axis]) * cells;
            (along as u32).min((1 << GRID_LEVELS) - 1)
        };
        spread(index(0)) | spread(index(1)) << 1
    }

    /// The cell of `key` after `level` subdivisions: min x, min y, max x, max y.
    pub fn cell(&self, key: u32, level: u32) -> [f64; 4] {
        let side = self.side / f64::from(1u32 << level);
        let shift = GRID_LEVELS - level;
        let index = [compact(key) >> shift, compact(key >> 1) >> shift];
        let min = [0, 1].map(|axis| self.origin[axis] + f64::from(index[axis]) * side);
        let back = |v: f64| v / self.prescale;
        [back(min[0]), back(min[1]), back(min[0] + side), back(min[1] + side)]
    }
}

/// Smallest power of two that is at least `value`, for positive normal values.
fn power_of_two_at_least(value: f64) -> f64 {
    let floor = f64::from_bits(value.to_bits() & 0x7ff0_0000_0000_0000);
    if floor < value { floor * 2.0 } else { floor }
}

/// Moves the low 16 bits to the even places.
fn spread(v: u32) -> u32 {
    let v = (v | v << 8) & 0x00ff_00ff;
    let v = (v | v << 4) & 0x0f0f_0f0f;
    let v = (v | v << 2) & 0x3333_3333;
    (v | v << 1) & 0x5555_5555
}

/// Gathers the even bits, the inverse of [`spread`].
fn compact(v: u32) -> u32 {
    let v = v & 0x5555_5555;
    let v = (v | v >> 1) & 0x3333_3333;
    let v = (v | v >> 2) & 0x0f0f_0f0f;
    let v = (v | v >> 4) & 0x00ff_00ff;
    (v | v >> 8) & 0x0000_ffff
}

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

/// The shapes' rows in canonical order, and the keys that led there.
#[derive(Clone, Debug, Default)]
pub struct Order {
    /// `rows[place]` is the shape's row in the caller's columns.
    pub rows: Vec<u32>,
    /// The first entry keys all places; each further one the places that shared
    /// one finest cell of an earlier entry.
    pub keyed: Vec<Keyed>,
    finer: HashMap<(usize, usize), usize>,
    scratch: [Vec<u64>; 2],
}

impl Order {
    /// Orders the shapes. `tie` compares two rows whose centres coincide.
    pub fn sort<T: Scalar>(
        &mut self,
        columns: &Columns<T>,
        tie: &impl Fn(usize, usize) -> Ordering,
    ) {
        let len = columns.len();
        self.rows.clear();
        self.rows.extend(0..len as u32);
        let mut root = self.keyed.drain(..).next().unwrap_or_default();
        (root.start, root.end) = (0, len);
        root.keys.clear();
        self.finer.clear();
        if len == 0 {
            return;
        }
        if let Some(grid) = grid_of(columns, &self.rows) {
            root.grid = grid;
            self.sort_by_key(columns, &mut root);
        } else {
            let origin = [columns.x[0].to_f64(), columns.y[0].to_f64()];
            root.grid = Grid { prescale: 1.0, origin, side: 1.0 };
            root.keys.resize(len, 0);
        }
        self.keyed.push(root);
        let mut next = 0;
        while next < self.keyed.len() {
            self.resolve_runs(next, columns, tie);
            next += 1;
        }
    }

    /// The index in `keyed` of the finer grid made for exactly these places.
    pub fn finer(&self, start: usize, end: usize) -> Option<usize> {
        self.finer.get(&(start, end)).copied()
    }

    /// Orders what shares a key in `keyed[which]`.
    fn resolve_runs<T: Scalar>(
        &mut self,
        which: usize,
        columns: &Columns<T>,
        tie: &impl Fn(usize, usize) -> Ordering,
    ) {
        let offset = self.keyed[which].start;
        let count = self.keyed[which].keys.len();
        let mut start = 0;
        while start < count {
            let keys = &self.keyed[which].keys;
            let key = keys[start];
            let end = start + keys[start..].iter().take_while(|&&other| other == key).count();
            if end - start > 1 {
                self.resolve_run(offset + start, offset + end, columns, tie);
            }
            start = end;
        }
    }

    fn resolve_run<T: Scalar>(
        &mut self,
        start: usize,
        end: usize,
        columns: &Columns<T>,
        tie: &impl Fn(usize, usize) -> Ordering,
    ) {
        let rows = &mut self.rows[start..end];
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
        let mut keyed = Keyed { start, end, grid, keys: Vec::new() };
        self.sort_by_key(columns, &mut keyed);
        self.finer.insert((start, end), self.keyed.len());
        self.keyed.push(keyed);
    }

    /// Sorts the rows at `keyed`'s places by their key in `keyed`'s grid, then
    /// by row, and fills in the keys.
    fn sort_by_key<T: Scalar>(&mut self, columns: &Columns<T>, keyed: &mut Keyed) {
        let rows = &mut self.rows[keyed.start..keyed.end];
        let [items, spare] = &mut self.scratch;
        items.clear();
        items.extend(rows.iter().map(|&row| {
            let center = [columns.x[row as usize].to_f64(), columns.y[row as usize].to_f64()];
            u64::from(keyed.grid.key(center)) << 32 | u64::from(row)
        }));
        if items.len() < SMALL_SORT {
            items.sort_unstable();
        } else {
            radix_sort(items, spare);
        }
        keyed.keys.clear();
        keyed.keys.extend(items.iter().map(|&item| (item >> 32) as u32));
        for (row, &item) in rows.iter_mut().zip(items.iter()) {
            *row = item as u32;
        }
    }
}

/// The grid around the centres of `rows`; none where they all coincide.
fn grid_of<T: Scalar>(columns: &Columns<T>, rows: &[u32]) -> Option<Grid> {
    let first = rows[0] as usize;
    let (mut min, mut max) =
        ([columns.x[first], columns.y[first]], [columns.x[first], columns.y[first]]);
    for &row in rows {
        let center = [columns.x[row as usize], columns.y[row as usize]];
        for axis in 0..2 {
            min[axis] = min[axis].least(center[axis]);
            max[axis] = max[axis].most(center[axis]);
        }
    }
    if min == max {
        return None;
    }
    Some(Grid::around(min.map(Scalar::to_f64), max.map(Scalar::to_f64)))
}

/// Sorts by the upper 32 bits in three passes of 11, keeping the order of equals.
/// The rows in the lower half must ascend to begin with where ties matter.
fn radix_sort(items: &mut Vec<u64>, spare: &mut Vec<u64>) {
    const BITS: u32 = 11;
    const BUCKETS: usize = 1 << BITS;
    let digit = |item: u64, pass: u32| (item >> (32 + pass * BITS)) as usize & (BUCKETS - 1);
    let mut counts = [[0u32; BUCKETS]; 3];
    for &item in items.iter() {
        for pass in 0..3 {
            counts[pass as usize][digit(item, pass)] += 1;
        }
    }
    spare.clear();
    spare.resize(items.len(), 0);
    for pass in 0..3 {
        let counts = &mut counts[pass as usize];
        let mut sum = 0;
        for count in counts.iter_mut() {
            sum += std::mem::replace(count, sum);
        }
        for &item in items.iter() {
            let place = &mut counts[digit(item, pass)];
            spare[*place as usize] = item;
            *place += 1;
        }
        std::mem::swap(items, spare);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spreading_and_compacting_are_inverse() {
        for v in [0, 1, 0x8000, 0xffff, 0x1234] {
            assert_eq!(compact(spread(v)), v);
        }
    }

    #[test]
    fn a_cell_holds_the_centres_that_have_its_key() {
        let grid = Grid::around([-3.0, 10.0], [500.0, 300.0]);
        for center in [[-3.0, 10.0], [500.0, 300.0], [100.25, 299.0]] {
            for level in [0, 1, 7, GRID_LEVELS] {
                let cell = grid.cell(grid.key(center), level);
                assert!(cell[0] <= center[0] && center[0] < cell[2], "{cell:?} {center:?}");
                assert!(cell[1] <= center[1] && center[1] < cell[3], "{cell:?} {center:?}");
            }
        }
    }

    #[test]
    fn grids_fit_the_extremes_of_float64() {
        for [min, max] in [
            [-f64::MAX, f64::MAX],
            [0.0, 5e-324],
            [1.0, 1.0 + f64::EPSILON],
            [1e300, f64::MAX],
            [-1e-300, 1e300],
        ] {
            let grid = Grid::around([min; 2], [max; 2]);
            assert!(grid.key([min; 2]) < grid.key([max; 2]), "{min} {max} {grid:?}");
        }
    }

    #[test]
    fn both_sorts_agree() {
        let items: Vec<u64> =
            (0..5000u64).map(|i| (i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) << 32 | i).collect();
        let mut expected = items.clone();
        expected.sort_unstable();
        let (mut sorted, mut spare) = (items, Vec::new());
        radix_sort(&mut sorted, &mut spare);
        assert_eq!(sorted, expected);
    }
}
