//! The cells that contain particles of each rank, by which a rank finds which of its particles are
//! near those of other ranks.

use std::ops::Range;

use super::scale::{CELLS, Scale};
use crate::container::Container;
use jostle_base::sorting;
use jostle_index::period::Period;

/// The first and the last coordinate along each axis.
type Aabb = [[f64; 2]; 2];

/// The AABB of no circles.
const EMPTY: Aabb = [[f64::INFINITY, f64::NEG_INFINITY]; 2];

/// Mean number of particles in a cell.
const IN_A_CELL: f64 = 16.0;

/// A grid of cells over all particles. All columns have about the same number of particles, and so
/// have all rows.
#[derive(Clone, Copy, Debug)]
pub struct Grid<'a> {
    scales: &'a [Scale; 2],
    /// Number of cells of the scales in a cell along each axis, as a power of two.
    shift: u32,
    /// Cells along each axis.
    count: usize,
    period: Period<f64>,
}

impl<'a> Grid<'a> {
    /// The grid over `total` particles that have these scales.
    pub fn new(container: &Container, scales: &'a [Scale; 2], total: usize) -> Self {
        // More cells mean fewer ghosts that are sent in vain, and longer lists of marks. The mean
        // number of particles in a cell trades the two; results do not depend on it.
        let wanted = (total as f64 / IN_A_CELL).sqrt().clamp(1.0, CELLS as f64) as usize;
        // A power of two, so that a cell is a shift of a cell of the scales.
        let shift = (CELLS / wanted).next_power_of_two().trailing_zeros();
        Self { scales, shift, count: CELLS >> shift, period: container.period().exact() }
    }

    /// The number of cells.
    pub fn cells(&self) -> usize {
        self.count * self.count
    }

    #[inline(always)]
    fn cell(&self, axis: usize, x: f64) -> u16 {
        (self.scales[axis].cell(x) >> self.shift) as u16
    }

    /// The columns and rows of the cells that the AABB of a circle overlaps: the first and the last
    /// of each. On a torus the first may be greater than the last.
    #[inline(always)]
    pub fn range(&self, center: [f32; 2], radius: f64) -> [[u16; 2]; 2] {
        self.range_of(sides_of(center, radius))
    }

    /// The columns and rows of the cells that an AABB overlaps, from the ends of both sides.
    #[inline(always)]
    fn range_of(&self, sides: Aabb) -> [[u16; 2]; 2] {
        // On a torus both ends are wrapped, so the last cell may come before the first.
        let corners = [0, 1].map(|end| self.period.wrap([sides[0][end], sides[1][end]]));
        [0, 1].map(|axis| {
            let ends = sides[axis];
            if !self.period.is_along(axis) {
                return ends.map(|end| self.cell(axis, end));
            }
            let all = [0, (self.count - 1) as u16];
            if ends[1] - ends[0] < self.period.sides()[axis] {
                let [first, last] = corners.map(|corner| corner[axis]);
                let cells = [first, last].map(|end| self.cell(axis, end));
                // Not around the torus, from a cell to itself.
                if cells[0] != cells[1] || first <= last {
                    return cells;
                }
            }
            all
        })
    }

    /// The number of cells of such a range.
    fn count_of(&self, range: [[u16; 2]; 2]) -> usize {
        let along = |[first, last]: [u16; 2]| {
            let behind = if first > last { self.count } else { 0 };
            usize::from(last) + behind - usize::from(first) + 1
        };
        along(range[0]) * along(range[1])
    }

    /// Calls `act` with each cell of such a range.
    #[inline(always)]
    pub fn each_cell(&self, range: [[u16; 2]; 2], mut act: impl FnMut(usize)) {
        let [columns, rows] = range.map(|[first, last]| [usize::from(first), usize::from(last)]);
        // Cells follow each other around the torus. Without a period the last one is never before
        // the first.
        let next = |cell: usize| if cell + 1 == self.count { 0 } else { cell + 1 };
        let mut column = columns[0];
        loop {
            let mut row = rows[0];
            loop {
                act(column * self.count + row);
                if row == rows[1] {
                    break;
                }
                row = next(row);
            }
            if column == columns[1] {
                break;
            }
            column = next(column);
        }
    }
}

/// The ends of both sides of the AABB of a circle.
#[inline(always)]
fn sides_of(center: [f32; 2], radius: f64) -> Aabb {
    center.map(|v| [f64::from(v) - radius, f64::from(v) + radius])
}

/// Circles in a block.
const BLOCK: usize = 8;

/// Maximum number of cells of the AABB of a block that is tested as a whole. In a larger block each
/// circle is tested: the Morton curve jumps there, and its circles are far apart.
const MAX_CELLS: usize = 16;

/// Circles in Morton order, in blocks of successive ones, most of which are near each other.
#[derive(Debug)]
pub struct CircleBlocks<'a, C> {
    grid: &'a Grid<'a>,
    /// The centre and the radius of each circle, and whether it needs others near it.
    circle: C,
    len: usize,
    /// An AABB of each block, and one of those of its circles that need others.
    bounds: Vec<[Aabb; 2]>,
}

impl<'a, C: Fn(usize) -> ([f32; 2], f64, bool)> CircleBlocks<'a, C> {
    /// The blocks of `len` circles.
    pub fn new(grid: &'a Grid<'a>, len: usize, circle: C) -> Self {
        let mut bounds = Vec::with_capacity(len.div_ceil(BLOCK));
        for first in (0..len).step_by(BLOCK) {
            let [mut all, mut needing] = [EMPTY; 2];
            for index in first..len.min(first + BLOCK) {
                // Two boxes for each block: one of all circles, with which ghosts are sent, and one
                // of those that need ghosts, with which cells are marked.
                let (center, radius, needs) = circle(index);
                let sides = sides_of(center, radius);
                all = union(all, sides);
                needing = union(needing, if needs { sides } else { EMPTY });
            }
            bounds.push([all, needing]);
        }
        Self { grid, circle, len, bounds }
    }

    /// The cells near circles that need others.
    pub fn marks(&self) -> Marks {
        let mut marks = Marks::new(self.grid);
        for (block, [_, needing]) in self.bounds.iter().enumerate() {
            if needing[0][0] > needing[0][1] {
                continue;
            }
            // Successive circles in Morton order are mostly near each other, and one box of few
            // cells marks them all. It marks some cells in vain, which only costs ghosts.
            if let Some(range) = self.few_cells(needing) {
                self.grid.each_cell(range, |cell| marks.set(cell));
                continue;
            }
            for (center, radius, needs) in self.indices(block).map(&self.circle) {
                if needs {
                    self.grid.each_cell(self.grid.range(center, radius), |cell| marks.set(cell));
                }
            }
        }
        marks
    }

    /// Calls `act` with each circle that may be near other ranks, and with those ranks, ascending.
    pub fn each_near(&self, near: &Near, mut act: impl FnMut(usize, &[u32])) {
        let mut ranks = Vec::new();
        for (block, [all, _]) in self.bounds.iter().enumerate() {
            // Most blocks are inside the domain of the rank. One test of their cells leaves them
            // out.
            if let Some(range) = self.few_cells(all) {
                let mut is_near = false;
                self.grid.each_cell(range, |cell| is_near |= !near.of(cell).is_empty());
                if !is_near {
                    continue;
                }
            }
            for index in self.indices(block) {
                let (center, radius, _) = (self.circle)(index);
                near.list_ranks(self.grid, center, radius, &mut ranks);
                if !ranks.is_empty() {
                    act(index, &ranks);
                }
            }
        }
    }

    /// The cells of an AABB, unless there are many.
    fn few_cells(&self, sides: &Aabb) -> Option<[[u16; 2]; 2]> {
        let range = self.grid.range_of(*sides);
        (self.grid.count_of(range) <= MAX_CELLS).then_some(range)
    }

    fn indices(&self, block: usize) -> Range<usize> {
        block * BLOCK..self.len.min((block + 1) * BLOCK)
    }
}

/// The AABB of two AABBs. Functions such as `min` take longer, because they treat NaN.
#[inline(always)]
fn union(a: Aabb, b: Aabb) -> Aabb {
    [0, 1].map(|axis| {
        let ([low, high], [other_low, other_high]) = (a[axis], b[axis]);
        let low = if other_low < low { other_low } else { low };
        [low, if other_high > high { other_high } else { high }]
    })
}

/// A mark for each cell.
#[derive(Clone, Debug, Default)]
pub struct Marks(Vec<bool>);

impl Marks {
    /// No cell of a grid.
    pub fn new(grid: &Grid<'_>) -> Self {
        Self(vec![false; grid.cells()])
    }

    /// Marks a cell.
    #[inline(always)]
    pub fn set(&mut self, cell: usize) {
        self.0[cell] = true;
    }

    /// The runs of marked cells as bytes: the first and the last cell of each.
    pub fn runs(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        // Marked cells form runs along the boundary of a domain, so runs are shorter than lists of
        // cells.
        let mut rest = 0;
        for run in self.0.chunk_by(|a, b| a == b) {
            let cells = [rest, rest + run.len() - 1];
            rest += run.len();
            if run[0] {
                bytes.extend(cells.iter().flat_map(|&cell| (cell as u16).to_le_bytes()));
            }
        }
        bytes
    }
}

/// The cells of runs.
fn cells_of(runs: &[u8]) -> impl Iterator<Item = usize> + Clone {
    let (runs, _) = runs.as_chunks::<4>();
    runs.iter().flat_map(|&[a, b, c, d]| {
        usize::from(u16::from_le_bytes([a, b]))..=usize::from(u16::from_le_bytes([c, d]))
    })
}

/// The ranks near each cell: compressed sparse rows.
#[derive(Clone, Debug, Default)]
pub struct Near {
    starts: Vec<u32>,
    ranks: Vec<u32>,
}

impl Near {
    /// Lists which of the ranks, apart from `own`, have marked each cell; `all` are the runs of
    /// each rank.
    pub fn new(grid: &Grid<'_>, all: &[Vec<u8>], own: usize) -> Self {
        // The iterator is made twice, to count and to fill.
        let marked = || {
            let others = (0..).zip(all).filter(move |(rank, _)| *rank as usize != own);
            others.flat_map(|(rank, runs)| cells_of(runs).map(move |cell| (rank, cell)))
        };
        let mut starts = vec![0; grid.cells() + 1];
        let mut ranks = vec![0; marked().count()];
        let (cell, rank) = (|of: &(u32, usize)| of.1, |of: (u32, usize)| of.0);
        sorting::counting_sort(marked(), cell, rank, &mut starts[1..], &mut ranks);
        Self { starts, ranks }
    }

    /// The ranks that have marked a cell.
    #[inline(always)]
    pub fn of(&self, cell: usize) -> &[u32] {
        &self.ranks[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// Replaces `ranks` by those that have marked a cell of a circle, in ascending order.
    #[inline(always)]
    pub fn list_ranks(&self, grid: &Grid<'_>, center: [f32; 2], radius: f64, ranks: &mut Vec<u32>) {
        ranks.clear();
        grid.each_cell(grid.range(center, radius), |cell| ranks.extend_from_slice(self.of(cell)));
        ranks.sort_unstable();
        ranks.dedup();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Even scales over an area.
    fn even([width, height]: [f64; 2]) -> [Scale; 2] {
        [width, height].map(|side| {
            let index = |k: usize| (side * k as f64 / CELLS as f64, 1.0);
            let samples: Vec<_> = (0..=CELLS).map(index).collect();
            Scale::new(&samples, Some(side))
        })
    }

    fn cells(grid: &Grid<'_>, center: [f32; 2], radius: f64) -> Vec<usize> {
        let mut cells = Vec::new();
        grid.each_cell(grid.range(center, radius), |cell| cells.push(cell));
        cells.sort_unstable();
        cells
    }

    #[test]
    fn circles_cover_the_cells_of_their_aabb() {
        let scales = even([4.0, 8.0]);
        let grid = Grid::new(&Container::None, &scales, 256);
        assert_eq!(grid.cells(), 16);
        assert_eq!(cells(&grid, [0.5, 1.0], 0.25), [0]);
        assert_eq!(cells(&grid, [1.0, 2.0], 0.25), [0, 1, 4, 5]);
        assert_eq!(cells(&grid, [-9.0, 99.0], 0.25), [3]);
        assert_eq!(cells(&grid, [2.0, 2.0], 1e30).len(), 16);
    }

    #[test]
    fn circles_on_a_torus_cover_cells_on_both_sides() {
        let scales = even([4.0, 4.0]);
        let grid = Grid::new(&Container::Torus { size: [4.0, 4.0] }, &scales, 256);
        assert_eq!(cells(&grid, [0.0, 0.5], 0.25), [0, 12]);
        assert_eq!(cells(&grid, [0.0, 0.0], 0.25), [0, 3, 12, 15]);
        assert_eq!(cells(&grid, [1.0, 1.0], 2.0).len(), 16);
        // Around the torus, from a cell to the same cell.
        assert_eq!(cells(&grid, [2.5, 0.5], 1.99).len(), 16);
    }

    /// Circles at random positions: the cells of all that need others are marked, and each is near
    /// exactly the ranks that have marked one of its cells.
    #[test]
    fn blocks_mark_and_find_the_cells_of_their_circles() {
        for container in [Container::None, Container::Torus { size: [4.0, 4.0] }] {
            let scales = even([4.0, 4.0]);
            let grid = Grid::new(&container, &scales, 1 << 12);
            let circle = |k: usize| {
                // Of each 64 circles the first 40 are at one position.
                let place = if k % 64 < 40 { k / 64 } else { k };
                let center = [0.618, 0.755].map(|step| (place as f32 * step).fract() * 4.0);
                (center, 0.01 + 0.3 * (k as f64 * 0.37).fract().powi(4), k.is_multiple_of(3))
            };
            let none = |k: usize| (circle(k).0, circle(k).1, false);
            assert!(CircleBlocks::new(&grid, 300, none).marks().runs().is_empty());
            let blocks = CircleBlocks::new(&grid, 300, circle);
            let marked = blocks.marks().0;
            let of = |k: usize| cells(&grid, circle(k).0, circle(k).1);
            let needing = || (0..300usize).filter(|k| k.is_multiple_of(3));
            assert!(needing().all(|k| of(k).iter().all(|&cell| marked[cell])));
            // A block marks an AABB of at most `MAX_CELLS`, so not all cells.
            assert!(marked.iter().any(|&is_marked| !is_marked));
            let mut marks = [(); 2].map(|()| Marks::new(&grid));
            (0..3).for_each(|k| of(70 * k).iter().for_each(|&cell| marks[k % 2].set(cell)));
            let near = Near::new(&grid, &[marks[0].runs(), marks[1].runs(), vec![]], 2);
            let mut found = vec![Vec::new(); 300];
            blocks.each_near(&near, |k, ranks| found[k] = ranks.to_vec());
            for (k, found) in found.iter().enumerate() {
                let has = |rank: u32| of(k).iter().any(|&cell| near.of(cell).contains(&rank));
                let expected: Vec<u32> = (0..2).filter(|&rank| has(rank)).collect();
                assert_eq!(*found, expected);
            }
        }
    }

    #[test]
    fn near_lists_the_other_ranks_of_each_cell() {
        let scales = even([4.0, 4.0]);
        let grid = Grid::new(&Container::None, &scales, 256);
        let marked = |cells: &[usize]| {
            let mut marks = Marks::new(&grid);
            cells.iter().for_each(|&cell| marks.set(cell));
            marks.runs()
        };
        assert_eq!(marked(&[]), []);
        assert_eq!(marked(&[3, 4, 5, 15]), [3, 0, 5, 0, 15, 0, 15, 0]);
        let near = Near::new(&grid, &[marked(&[0, 9]), marked(&[9]), marked(&[9, 10, 15])], 1);
        assert_eq!((near.of(0), near.of(9), near.of(15)), (&[0][..], &[0, 2][..], &[2][..]));
        assert_eq!(near.of(10), [2]);
        assert!((1..9).all(|cell| near.of(cell).is_empty()));
    }

    #[test]
    fn a_particle_far_away_leaves_the_cells_of_the_others_small() {
        let samples: Vec<_> = (0..1000).map(f64::from).chain([1e18]).map(|x| (x, 1.0)).collect();
        let scales = [Scale::new(&samples, None), Scale::new(&samples, None)];
        let grid = Grid::new(&Container::None, &scales, 100_000);
        assert!(cells(&grid, [500.0, 500.0], 20.0).len() < grid.cells() / 100);
    }
}
