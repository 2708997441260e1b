//! The boxes of the tree as a caller sees them. Finding pairs does without.

use super::{Node, Quadtree};
use crate::geometry::Scalar;

/// A box: min x, min y, max x, max y.
type Cell = [f64; 4];

/// A box of the tree as a caller sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TreeBox {
    /// min x, min y, max x, max y.
    pub bounds: Cell,
    /// Subdivisions above it.
    pub depth: usize,
    /// Shapes in it and in all boxes below it.
    pub count: usize,
    /// Whether there is no box below it.
    pub is_leaf: bool,
}

impl<T: Scalar> Quadtree<T> {
    /// The boxes, parents before children. Nodes that share out shapes at one place among them
    /// have the same box; it is listed once, as a leaf.
    pub fn boxes(&self) -> Vec<TreeBox> {
        let cells = self.cells();
        let seen = self.seen_nodes().map(|(index, is_leaf)| {
            let node = &self.nodes[index];
            let (depth, count) = (usize::from(node.depth), node.len());
            TreeBox { bounds: cells[index], depth, count, is_leaf }
        });
        seen.collect()
    }

    /// Number of boxes, number of leaves among them, and the depth of the deepest.
    pub fn count_boxes(&self) -> [usize; 3] {
        self.seen_nodes().fold([0; 3], |[boxes, leaves, depth], (index, is_leaf)| {
            let here = usize::from(self.nodes[index].depth);
            [boxes + 1, leaves + usize::from(is_leaf), depth.max(here)]
        })
    }

    /// The nodes whose boxes a caller sees, and whether each is a leaf for them.
    fn seen_nodes(&self) -> impl Iterator<Item = (usize, bool)> + '_ {
        let mut hidden = vec![false; self.nodes.len()];
        for node in self.nodes.iter().filter(|node| self.is_one_place(node)) {
            hidden[node.children()].fill(true);
        }
        let seen = (0..self.nodes.len()).filter(move |&index| !hidden[index]);
        seen.map(|index| {
            let node = &self.nodes[index];
            (index, node.is_leaf() || self.is_one_place(node))
        })
    }

    /// Whether a node split although its grid does not tell its shapes apart: its children
    /// have its cell.
    fn is_one_place(&self, node: &Node) -> bool {
        let child = self.nodes[node.children()].first();
        child.is_some_and(|child| (child.grid, child.level) == (node.grid, node.level))
    }

    /// The cell of every node. Children tile what of their parent's cell holds shapes;
    /// a cell holds the centres of its shapes.
    pub fn cells(&self) -> Vec<Cell> {
        let mut cells: Vec<Cell> = self.nodes.iter().map(|node| self.own_cell(node)).collect();
        for (index, node) in self.nodes.iter().enumerate() {
            for child in node.children() {
                cells[child] = common(cells[child], cells[index]);
            }
        }
        // In a world 1e30 wide, keys round a centre across its cell's border.
        for (index, node) in self.nodes.iter().enumerate().rev() {
            let cover = &self.covers[index];
            let [left, top] = cover.min.map(T::to_f64);
            let [right, bottom] = cover.max.map(T::to_f64);
            cells[index] = union(cells[index], [left, top, right, bottom]);
            for child in node.children() {
                cells[index] = union(cells[index], cells[child]);
            }
        }
        cells
    }

    /// The node's cell in its own grid; of a node that split, the part that it split.
    fn own_cell(&self, node: &Node) -> Cell {
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
