//! The cells in which the particles of each rank are, so that ranks know which of theirs are near
//! others.

use super::scale::{CELLS, Scale};
use crate::container::Container;

/// Particles in a cell, on average.
const IN_A_CELL: f64 = 16.0;

/// A grid of cells over all particles: about as many are in each column, and in each row.
#[derive(Clone, Copy, Debug)]
pub struct Grid<'a> {
    scales: &'a [Scale; 2],
    /// A cell has 2 to the power of this cells of the scales along each axis.
    shift: u32,
    /// Cells along each axis.
    count: usize,
    period: Option<[f32; 2]>,
}

impl<'a> Grid<'a> {
    /// The grid over `total` particles that have these scales.
    pub fn new(container: &Container, scales: &'a [Scale; 2], total: usize) -> Self {
        let wanted = (total as f64 / IN_A_CELL).sqrt().clamp(1.0, CELLS as f64) as usize;
        let shift = (CELLS / wanted).next_power_of_two().trailing_zeros();
        Self { scales, shift, count: CELLS >> shift, period: container.period() }
    }

    /// The number of cells.
    pub fn cells(&self) -> usize {
        self.count * self.count
    }

    #[inline(always)]
    fn cell(&self, axis: usize, x: f64) -> u16 {
        (self.scales[axis].cell(x) >> self.shift) as u16
    }

    /// The cell of a point, which on a torus is wrapped.
    #[inline(always)]
    pub fn cell_of(&self, point: [f32; 2]) -> u32 {
        let [column, row] = [0, 1].map(|axis| u32::from(self.cell(axis, f64::from(point[axis]))));
        column * self.count as u32 + row
    }

    /// The columns and rows of the cells that the AABB of a circle overlaps: the first and the last of
    /// each. On a torus the first may be behind the last.
    #[inline(always)]
    pub fn range(&self, center: [f32; 2], radius: f64) -> [[u16; 2]; 2] {
        self.range_of(sides_of(center, radius))
    }

    /// The same of an AABB, from the ends of both sides.
    #[inline(always)]
    fn range_of(&self, sides: [[f64; 2]; 2]) -> [[u16; 2]; 2] {
        [0, 1].map(|axis| {
            let ends = sides[axis];
            let Some(size) = self.period else {
                return ends.map(|end| self.cell(axis, end));
            };
            let (side, all) = (f64::from(size[axis]), [0, (self.count - 1) as u16]);
            if ends[1] - ends[0] < side {
                let [first, last] = ends.map(|end| end - side * (end / side).floor());
                let cells = [first, last].map(|end| self.cell(axis, end));
                // Not around the torus, from a cell to itself.
                if cells[0] != cells[1] || first <= last {
                    return cells;
                }
            }
            all
        })
    }

    /// Calls `act` with each cell of such a range.
    #[inline(always)]
    pub fn each_cell(&self, range: [[u16; 2]; 2], mut act: impl FnMut(usize)) {
        let [columns, rows] = range.map(|[first, last]| [usize::from(first), usize::from(last)]);
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
fn sides_of(center: [f32; 2], radius: f64) -> [[f64; 2]; 2] {
    center.map(|v| [f64::from(v) - radius, f64::from(v) + radius])
}

/// The cell of the centre of each circle, and an AABB of the circles of each cell. There are fewer cells than
/// circles.
#[derive(Debug)]
pub struct CirclesInCells {
    cells: Vec<u32>,
    all: CellBounds,
    /// Only of circles that need others near them.
    needing: CellBounds,
}

impl CirclesInCells {
    /// Those of some circles, of which some need others near them.
    pub fn new(grid: &Grid<'_>, circles: impl Iterator<Item = ([f32; 2], f64, bool)>) -> Self {
        let [mut all, mut needing] = [CellBounds::new(grid), CellBounds::new(grid)];
        let cell = |(center, radius, needs): ([f32; 2], f64, bool)| {
            let cell = grid.cell_of(center);
            all.add(cell, center, radius);
            if needs {
                needing.add(cell, center, radius);
            }
            cell
        };
        let cells = circles.map(cell).collect();
        Self { cells, all, needing }
    }

    /// The cell of a circle.
    #[inline(always)]
    pub fn cell(&self, index: usize) -> usize {
        self.cells[index] as usize
    }

    /// The cells near circles that need others.
    pub fn marks(&self, grid: &Grid<'_>) -> Marks {
        let mut marks = Marks::new(grid);
        self.needing.each(grid, |_, range| grid.each_cell(range, |cell| marks.set(cell)));
        marks
    }

    /// Whether the circles of each cell may be near another rank.
    pub fn are_near(&self, grid: &Grid<'_>, near: &Near) -> Vec<bool> {
        let mut are_near = vec![false; grid.cells()];
        self.all.each(grid, |cell, range| {
            grid.each_cell(range, |other| are_near[cell] |= !near.of(other).is_empty());
        });
        are_near
    }
}

/// An AABB of the circles whose centres are in each cell.
#[derive(Debug)]
struct CellBounds(Vec<[[f64; 2]; 2]>);

impl CellBounds {
    /// Those of no circles.
    fn new(grid: &Grid<'_>) -> Self {
        Self(vec![[[f64::INFINITY, f64::NEG_INFINITY]; 2]; grid.cells()])
    }

    /// Adds a circle with its centre in a cell.
    #[inline(always)]
    fn add(&mut self, cell: u32, center: [f32; 2], radius: f64) {
        let bounds = &mut self.0[cell as usize];
        for ([first, last], [low, high]) in bounds.iter_mut().zip(sides_of(center, radius)) {
            // Functions such as `min` take longer, because they treat NaN.
            *first = if low < *first { low } else { *first };
            *last = if high > *last { high } else { *last };
        }
    }

    /// Calls `act` with each cell that has circles, and the range of cells that their AABB overlaps.
    fn each(&self, grid: &Grid<'_>, mut act: impl FnMut(usize, [[u16; 2]; 2])) {
        for (cell, &sides) in self.0.iter().enumerate() {
            if sides[0][0] <= sides[0][1] {
                act(cell, grid.range_of(sides));
            }
        }
    }
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
fn cells_of(runs: &[u8]) -> impl Iterator<Item = usize> {
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
    /// Lists which of the ranks, apart from `own`, have marked each cell; `all` are the runs of each rank.
    pub fn new(grid: &Grid<'_>, all: &[Vec<u8>], own: usize) -> Self {
        let marked = || {
            let others = (0..).zip(all).filter(move |(rank, _)| *rank as usize != own);
            others.flat_map(|(rank, runs)| cells_of(runs).map(move |cell| (rank, cell)))
        };
        let mut starts = vec![0; grid.cells() + 1];
        marked().for_each(|(_, cell)| starts[cell + 1] += 1);
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        let mut next = starts.clone();
        let mut ranks = vec![0; starts[grid.cells()] as usize];
        for (rank, cell) in marked() {
            ranks[next[cell] as usize] = rank;
            next[cell] += 1;
        }
        Self { starts, ranks }
    }

    /// The ranks that have marked a cell.
    #[inline(always)]
    pub fn of(&self, cell: usize) -> &[u32] {
        &self.ranks[self.starts[cell] as usize..self.starts[cell + 1] as usize]
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

    #[test]
    fn bounds_of_cells_contain_their_circles() {
        for container in [Container::None, Container::Torus { size: [4.0, 4.0] }] {
            let scales = even([4.0, 4.0]);
            let grid = Grid::new(&container, &scales, 1 << 12);
            let circle = |k: usize| {
                let center = [0.618, 0.755].map(|step| (k as f32 * step).fract() * 4.0);
                (center, 0.01 + 0.3 * (k as f64 * 0.37).fract())
            };
            let circles: Vec<_> = (0..300).map(circle).collect();
            let all = circles.iter().map(|&(center, radius)| (center, radius, false));
            let bounds = CirclesInCells::new(&grid, all);
            assert!(bounds.marks(&grid).runs().is_empty());
            let mut found = vec![Vec::new(); grid.cells()];
            bounds
                .all
                .each(&grid, |cell, range| grid.each_cell(range, |other| found[cell].push(other)));
            for (center, radius) in circles {
                let near = &found[grid.cell_of(center) as usize];
                assert!(cells(&grid, center, radius).iter().all(|cell| near.contains(cell)));
            }
            assert!(found.iter().all(|near| near.len() < grid.cells()));
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
