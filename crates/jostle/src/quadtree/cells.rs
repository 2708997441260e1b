//! The parts of the plane that the nodes stand for, for those who want to see them.
//! Finding pairs does without.

use super::Quadtree;
use crate::error::Result;
use crate::geometry::Scalar;
use crate::interrupt::Pulse;
use crate::memory;

/// A box: min x, min y, max x, max y.
type Cell = [f64; 4];

/// About as many numbers are read for a cell.
const CELL_WORK: usize = 8;

impl<T: Scalar> Quadtree<T> {
    /// The cell of every node. Children tile what of their parent's cell holds shapes;
    /// a cell holds the centres of its shapes.
    pub fn cells(&self) -> Result<Vec<Cell>> {
        self.cells_unless_stopped(&mut Pulse::current())
    }

    pub(super) fn cells_unless_stopped(&self, pulse: &mut Pulse) -> Result<Vec<Cell>> {
        let mut cells = memory::with_room(self.nodes.len())?;
        for node in &self.nodes {
            pulse.check(CELL_WORK)?;
            cells.push(self.own_cell(node));
        }
        for (index, node) in self.nodes.iter().enumerate() {
            pulse.check(CELL_WORK)?;
            for child in node.children() {
                cells[child] = common(cells[child], cells[index]);
            }
        }
        // In a world 1e30 wide, keys round a centre across its cell's border.
        for (index, node) in self.nodes.iter().enumerate().rev() {
            pulse.check(CELL_WORK)?;
            let cover = &self.covers[index];
            let [left, top] = cover.min.map(T::to_f64);
            let [right, bottom] = cover.max.map(T::to_f64);
            cells[index] = union(cells[index], [left, top, right, bottom]);
            for child in node.children() {
                cells[index] = union(cells[index], cells[child]);
            }
        }
        Ok(cells)
    }

    /// The node's cell in its own grid; of a node that split, the part that it split.
    fn own_cell(&self, node: &super::Node) -> Cell {
        let keyed = &self.order.keyed[node.grid as usize];
        keyed.grid.cell(keyed.key(node.start as usize), u32::from(node.level))
    }
}

/// What two cells have in common.
fn common(a: Cell, b: Cell) -> Cell {
    [a[0].max(b[0]), a[1].max(b[1]), a[2].min(b[2]), a[3].min(b[3])]
}

/// The smallest cell that holds both.
fn union(a: Cell, b: Cell) -> Cell {
    [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])]
}
