//! The boxes of the tree, for display. Queries and pair searches do not use them.

use super::{Node, Quadtree};
use crate::geometry::{Bounds, Scalar};
use jostle_base::error::Result;
use jostle_base::interrupt::Pulse;
use jostle_base::memory;

/// A box: min x, min y, max x, max y.
type Cell = [f64; 4];

/// A box of the tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TreeBox {
    /// min x, min y, max x, max y.
    pub bounds: Cell,
    /// Number of subdivisions above it.
    pub depth: usize,
    /// Shapes in it and in its descendants.
    pub count: usize,
    /// Whether it has no children in the list.
    pub is_leaf: bool,
}

/// Approximate number of values read for a cell.
const CELL_WORK: usize = 8;

impl<T: Scalar> Quadtree<T> {
    /// The boxes, parents before children. Nodes that split coincident shapes have the same box;
    /// it is listed once, as a leaf.
    pub fn boxes(&self) -> Result<Vec<TreeBox>> {
        let cells = self.cells()?;
        let hidden = self.hidden_nodes()?;
        let listed = self.listed_nodes(&hidden).map(|(index, is_leaf)| {
            let node = &self.nodes()[index];
            let (depth, count) = (usize::from(node.depth), node.len());
            TreeBox { bounds: cells[index], depth, count, is_leaf }
        });
        let mut boxes = memory::with_capacity(self.nodes().len())?;
        boxes.extend(listed);
        Ok(boxes)
    }

    /// Number of boxes, number of leaves among them, and the depth of the deepest.
    pub fn count_boxes(&self) -> Result<[usize; 3]> {
        let hidden = self.hidden_nodes()?;
        Ok(self.listed_nodes(&hidden).fold([0; 3], |[boxes, leaves, depth], (index, is_leaf)| {
            let here = usize::from(self.nodes()[index].depth);
            [boxes + 1, leaves + usize::from(is_leaf), depth.max(here)]
        }))
    }

    /// For each node, whether its box is that of its parent.
    fn hidden_nodes(&self) -> Result<Vec<bool>> {
        let mut hidden = memory::filled(self.nodes().len(), false)?;
        for node in self.nodes().iter().filter(|node| self.is_one_place(node)) {
            hidden[node.children()].fill(true);
        }
        Ok(hidden)
    }

    /// The nodes whose boxes are listed, and whether each is listed as a leaf.
    fn listed_nodes(&self, hidden: &[bool]) -> impl Iterator<Item = (usize, bool)> {
        let listed = (0..self.nodes().len()).filter(|&index| !hidden[index]);
        listed.map(|index| {
            let node = &self.nodes()[index];
            (index, node.is_leaf() || self.is_one_place(node))
        })
    }

    /// Whether a node was split although its shapes coincide; its children have the same cell.
    fn is_one_place(&self, node: &Node) -> bool {
        let child = self.nodes()[node.children()].first();
        child.is_some_and(|child| (child.grid, child.level) == (node.grid, node.level))
    }

    /// The cell of every node. It contains the centres of the node's shapes and the cells of its
    /// children.
    pub fn cells(&self) -> Result<Vec<Cell>> {
        self.cells_unless_stopped(&mut Pulse::current())
    }

    pub(super) fn cells_unless_stopped(&self, pulse: &mut Pulse) -> Result<Vec<Cell>> {
        let mut cells = memory::with_capacity(self.nodes().len())?;
        for node in self.nodes() {
            pulse.check(CELL_WORK)?;
            cells.push(self.own_cell(node));
        }
        for (index, node) in self.nodes().iter().enumerate() {
            pulse.check(CELL_WORK)?;
            // The cell of a finer grid is fitted to its shapes and may extend beyond the cell of
            // its parent. Parents come first in the list, so a cell is cut by all that are above
            // it.
            for child in node.children() {
                cells[child] = intersection(cells[child], cells[index]);
            }
        }
        // Rounding of a key can put a centre beyond its cell if coordinates are as large as 1e30.
        for (index, node) in self.nodes().iter().enumerate().rev() {
            pulse.check(CELL_WORK)?;
            cells[index] = union(cells[index], self.centers_within(index));
            for child in node.children() {
                cells[index] = union(cells[index], cells[child]);
            }
        }
        Ok(cells)
    }

    /// The box around the centres of a node's shapes.
    pub(super) fn centers_within(&self, node: usize) -> Cell {
        // Shapes given by their centres: the bounds of a node are those of the centres themselves.
        if !self.columns.has_boxes() {
            let Bounds { min, max, .. } = self.bounds()[node];
            return [min[0], min[1], max[0], max[1]].map(T::to_f64);
        }
        let centers = self.nodes()[node].range().map(|index| {
            let [x, y] = self.columns.shape(index).center().map(T::to_f64);
            [x, y, x, y]
        });
        centers.reduce(union).expect("a node is never empty")
    }

    /// The node's cell in its own grid, after skipped subdivisions.
    fn own_cell(&self, node: &Node) -> Cell {
        let keyed = &self.order.keyed[node.grid as usize];
        keyed.grid.cell(keyed.key(node.start as usize), u32::from(node.level))
    }
}

/// The intersection of two cells.
fn intersection(a: Cell, b: Cell) -> Cell {
    [a[0].max(b[0]), a[1].max(b[1]), a[2].min(b[2]), a[3].min(b[3])]
}

/// The bounding box of two cells.
fn union(a: Cell, b: Cell) -> Cell {
    [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])]
}
