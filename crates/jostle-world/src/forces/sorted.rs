//! The bodies of a force in the order of a tree of their own, in groups of neighbours.

use std::cmp::Ordering;
use std::ops::Range;

use super::ForceInput;
use jostle_base::error::Result;
use jostle_base::interrupt;
use jostle_base::memory;
use jostle_base::settings::{DEFAULT_MAX_DEPTH, Settings};
use jostle_index::quadtree::Quadtree;
use jostle_index::shapes::{Each, Shapes};

/// Maximum number of bodies in a leaf of the tree.
const LEAF: usize = 16;

/// The bodies as points of a tree. Their order depends only on positions and ties, so it is the
/// same for every number of threads and every order of adding.
#[derive(Debug, Default)]
pub struct Sorted {
    shapes: Shapes<f32>,
    /// The tree.
    pub tree: Quadtree<f32>,
    /// Nodes that cover all bodies once, in order.
    pub groups: Vec<u32>,
    stack: Vec<u32>,
}

impl Sorted {
    /// Sorts the bodies. A group has at most `most` bodies, or is a leaf. `tie` orders bodies at
    /// the same position.
    pub fn sort(
        &mut self,
        bodies: &ForceInput<'_>,
        most: usize,
        tie: &dyn Fn(usize, usize) -> Ordering,
    ) -> Result<()> {
        let columns = self.shapes.columns_mut();
        // Positions alone sort the bodies, so radii are left out.
        memory::assign(columns.centers, bodies.positions)?;
        *columns.radii = Each::One(0.0);
        let settings =
            Settings { leaf_capacity: LEAF, max_depth: DEFAULT_MAX_DEPTH, threads: bodies.threads };
        // Not interrupted: the caller cannot undo a part of a step.
        // All ranks need the same extent, or the order of sums would differ between them.
        self.tree.set_extent(bodies.extent);
        self.tree.set_nested();
        interrupt::unwatched(|| self.tree.rebuild(&self.shapes, settings, tie))?;
        self.find_groups(most)
    }

    /// Lists the largest nodes of at most `most` bodies, and leaves, in order.
    fn find_groups(&mut self, most: usize) -> Result<()> {
        let Self { tree, groups, stack, .. } = self;
        groups.clear();
        stack.clear();
        if tree.is_empty() {
            return Ok(());
        }
        memory::push(stack, 0)?;
        while let Some(index) = stack.pop() {
            // Groups follow from the tree alone, so they do not depend on threads.
            let node = &tree.nodes()[index as usize];
            if node.is_leaf() || node.len() <= most {
                memory::push(groups, index)?;
            } else {
                // In reverse order, so that groups are listed in the order of the tree.
                memory::extend(stack, node.children().rev().map(|child| child as u32))?;
            }
        }
        Ok(())
    }

    /// The bodies of a group, as indices in the order of the tree.
    pub fn range(&self, group: u32) -> Range<usize> {
        self.tree.nodes()[group as usize].range()
    }

    /// Groups in tasks of `share`, each with its part of a column in the order of the tree.
    pub fn tasks<'a, V>(
        &'a self,
        share: usize,
        mut column: &'a mut [V],
    ) -> impl Iterator<Item = (&'a [u32], &'a mut [V])> {
        self.groups.chunks(share).map(move |groups| {
            let len = groups.iter().map(|&group| self.range(group).len()).sum::<usize>();
            (groups, column.split_off_mut(..len).expect("the groups cover all bodies"))
        })
    }
}
