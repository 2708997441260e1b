//! The cells in which the particles of each rank are, so that ranks know which of theirs are near
//! others.

use crate::container::Container;

/// Particles in a cell, on average.
const IN_A_CELL: f64 = 16.0;

/// Cells along each axis, at most.
const MOST: f64 = 256.0;

/// A grid of cells over all particles.
#[derive(Clone, Copy, Debug)]
pub struct Grid {
    origin: [f64; 2],
    /// Cells in a unit of length.
    per_length: [f64; 2],
    extent: f64,
    /// Cells along each axis.
    count: usize,
    is_periodic: bool,
}

impl Grid {
    /// The grid over `total` particles between `low` and `high`; over all of a torus.
    pub fn new(container: &Container, [low, high]: [[f64; 2]; 2], total: usize) -> Self {
        let count = (total as f64 / IN_A_CELL).sqrt().clamp(1.0, MOST).floor();
        let period = container.period().map(|size| size.map(f64::from));
        let origin = if period.is_some() { [0.0; 2] } else { low };
        let sides = [0, 1].map(|k| {
            let side = period.map_or(high[k] - low[k], |size| size[k]);
            if side > 0.0 && side.is_finite() { side } else { 1.0 }
        });
        Self {
            origin,
            per_length: sides.map(|side| count / side),
            extent: sides[0].max(sides[1]),
            count: count as usize,
            is_periodic: period.is_some(),
        }
    }

    /// The number of cells.
    pub fn cells(&self) -> usize {
        self.count * self.count
    }

    /// The longer side of all cells together.
    pub fn extent(&self) -> f64 {
        self.extent
    }

    /// The columns and rows of the cells that the AABB of a circle overlaps: the first and the last of
    /// each. On a torus the first may be behind the last.
    #[inline(always)]
    pub fn range(&self, center: [f32; 2], radius: f64) -> [[u16; 2]; 2] {
        let last_cell = self.count as f64 - 1.0;
        [0, 1].map(|k| {
            let along = f64::from(center[k]) - self.origin[k];
            let ends = [along - radius, along + radius].map(|v| (v * self.per_length[k]).floor());
            if !self.is_periodic {
                return ends.map(|cell| cell.clamp(0.0, last_cell) as u16);
            }
            // All cells, if it is about as wide as the torus.
            if ends[1] - ends[0] >= last_cell || !(ends[1] - ends[0]).is_finite() {
                return [0, last_cell as u16];
            }
            let count = self.count as f64;
            ends.map(|cell| (cell - count * (cell / count).floor()) as u16)
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

/// A bit for each cell.
#[derive(Clone, Debug, Default)]
pub struct Marks(pub Vec<u8>);

impl Marks {
    /// No cell of a grid.
    pub fn new(grid: &Grid) -> Self {
        Self(vec![0; grid.cells().div_ceil(8)])
    }

    /// Marks a cell.
    #[inline(always)]
    pub fn set(&mut self, cell: usize) {
        self.0[cell / 8] |= 1 << (cell % 8);
    }
}

/// The ranks near each cell: compressed sparse rows.
#[derive(Clone, Debug, Default)]
pub struct Near {
    starts: Vec<u32>,
    ranks: Vec<u32>,
}

impl Near {
    /// Lists which of the ranks, apart from `own`, have marked each cell; `all` are the marks of each
    /// rank.
    pub fn new(grid: &Grid, all: &[u8], own: usize) -> Self {
        let bytes = grid.cells().div_ceil(8);
        let mut near = Self::default();
        for cell in 0..grid.cells() {
            near.starts.push(near.ranks.len() as u32);
            for (rank, marks) in all.chunks_exact(bytes).enumerate() {
                if rank != own && marks[cell / 8] & 1 << (cell % 8) != 0 {
                    near.ranks.push(rank as u32);
                }
            }
        }
        near.starts.push(near.ranks.len() as u32);
        near
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

    fn cells(grid: &Grid, center: [f32; 2], radius: f64) -> Vec<usize> {
        let mut cells = Vec::new();
        grid.each_cell(grid.range(center, radius), |cell| cells.push(cell));
        cells.sort_unstable();
        cells
    }

    #[test]
    fn circles_cover_the_cells_of_their_aabb() {
        let grid = Grid::new(&Container::None, [[0.0, 0.0], [4.0, 8.0]], 256);
        assert_eq!(grid.cells(), 16);
        assert_eq!(cells(&grid, [0.5, 1.0], 0.25), [0]);
        assert_eq!(cells(&grid, [1.0, 2.0], 0.25), [0, 1, 4, 5]);
        assert_eq!(cells(&grid, [-9.0, 99.0], 0.25), [3]);
        assert_eq!(cells(&grid, [2.0, 2.0], 1e30).len(), 16);
    }

    #[test]
    fn circles_on_a_torus_cover_cells_on_both_sides() {
        let grid = Grid::new(&Container::Torus { size: [4.0, 4.0] }, [[0.0; 2]; 2], 256);
        assert_eq!(cells(&grid, [0.0, 0.5], 0.25), [0, 12]);
        assert_eq!(cells(&grid, [0.0, 0.0], 0.25), [0, 3, 12, 15]);
        assert_eq!(cells(&grid, [1.0, 1.0], 2.0).len(), 16);
    }

    #[test]
    fn near_lists_the_other_ranks_of_each_cell() {
        let grid = Grid::new(&Container::None, [[0.0; 2], [4.0; 2]], 256);
        let marked = |cells: &[usize]| {
            let mut marks = Marks::new(&grid);
            cells.iter().for_each(|&cell| marks.set(cell));
            marks.0
        };
        let near = Near::new(&grid, &[marked(&[0, 9]), marked(&[9]), marked(&[9, 15])].concat(), 1);
        assert_eq!((near.of(0), near.of(9), near.of(15)), (&[0][..], &[0, 2][..], &[2][..]));
        assert!((1..9).all(|cell| near.of(cell).is_empty()));
    }
}
