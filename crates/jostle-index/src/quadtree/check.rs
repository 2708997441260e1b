//! The invariants of a tree. Tests check them after every build.

use super::Quadtree;
use crate::geometry::{Bounds, Scalar};
use jostle_base::interrupt::{Pulse, Stop};

impl<T: Scalar> Quadtree<T> {
    /// Checks every node; the error describes the first violated invariant.
    ///
    /// * Every row is at exactly one index.
    /// * The root has all indices. The ranges of children partition the range of their parent in
    ///   order. No node is empty, and no parent has a single child.
    /// * Parents precede their children, whose depth is one more.
    /// * A leaf has at most `leaf_capacity` shapes unless it is at `max_depth`; no node is deeper
    ///   than `max_depth`.
    /// * The bounds of a node are exactly those of its shapes. Its cell contains the centres of its
    ///   shapes and the cells of its children.
    pub fn check(&self) -> Result<(), String> {
        self.check_rows()?;
        match self.nodes().first() {
            None if self.is_empty() => return Ok(()),
            None => return Err("shapes without a root".into()),
            Some(root) if root.range() != (0..self.len()) || root.depth != 0 => {
                return Err(format!("the root is {root:?}"));
            }
            Some(_) => {}
        }
        let mut seen = 1;
        let cells = self
            .cells_unless_stopped(&mut Pulse::of(&Stop::default()))
            .map_err(|error| error.to_string())?;
        for index in 0..self.nodes().len() {
            self.check_size(index)?;
            self.check_children(index, &mut seen)?;
            self.check_bounds(index)?;
            self.check_cell(index, &cells)?;
        }
        if seen == self.nodes().len() { Ok(()) } else { Err("some nodes have no parent".into()) }
    }

    fn check_rows(&self) -> Result<(), String> {
        let mut rows = self.rows().to_vec();
        rows.sort_unstable();
        if rows.len() == self.len() && rows.iter().enumerate().all(|(i, &row)| i == row as usize) {
            Ok(())
        } else {
            Err("the rows are not a permutation".into())
        }
    }

    fn check_size(&self, index: usize) -> Result<(), String> {
        let node = &self.nodes()[index];
        let depth = usize::from(node.depth);
        if node.len() == 0 {
            return Err(format!("node {index} is empty"));
        }
        if depth > self.settings.max_depth {
            return Err(format!("node {index} is {depth} deep"));
        }
        let full = node.len() > self.settings.leaf_capacity;
        if node.is_leaf() && full && depth < self.settings.max_depth {
            return Err(format!("leaf {index} holds {} at depth {depth}", node.len()));
        }
        Ok(())
    }

    fn check_children(&self, index: usize, seen: &mut usize) -> Result<(), String> {
        let node = &self.nodes()[index];
        if node.is_leaf() {
            return Ok(());
        }
        let children = &self.nodes()[node.children()];
        *seen += children.len();
        let mut from = node.range().start;
        for child in children {
            if child.range().start != from || child.depth != node.depth + 1 {
                return Err(format!("node {index} has the child {child:?}"));
            }
            from = child.range().end;
        }
        let in_order = node.children().start > index && children.len() > 1;
        if from != node.range().end || !in_order {
            return Err(format!("the children of node {index} do not fill it"));
        }
        Ok(())
    }

    fn check_bounds(&self, index: usize) -> Result<(), String> {
        let shapes = self.nodes()[index].range().map(|at| Bounds::of(&self.columns.shape(at)));
        if shapes.reduce(Bounds::join) == Some(self.bounds()[index]) {
            Ok(())
        } else {
            Err(format!("the bounds of node {index} are not tight"))
        }
    }

    fn check_cell(&self, index: usize, cells: &[[f64; 4]]) -> Result<(), String> {
        let node = &self.nodes()[index];
        let [min_x, min_y, max_x, max_y] = cells[index];
        let [left, top, right, bottom] = self.centers_within(index);
        if left < min_x || top < min_y || right > max_x || bottom > max_y {
            return Err(format!("node {index} has centres outside its cell {:?}", cells[index]));
        }
        let inside = |cell: [f64; 4]| {
            cell[0] >= min_x && cell[1] >= min_y && cell[2] <= max_x && cell[3] <= max_y
        };
        if node.children().all(|child| inside(cells[child])) {
            Ok(())
        } else {
            Err(format!("a child of node {index} leaves its cell"))
        }
    }
}
