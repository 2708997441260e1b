//! The frontier: nodes at which a group of neighbouring queries starts its search (packet
//! traversal).

use super::window::Window;
use crate::geometry::{Scalar, lanes};
use crate::quadtree::Quadtree;
use jostle_simd::{LANES, Simd, block};

/// Number of neighbouring queries with a common frontier.
pub(super) const GROUP: usize = 16;

/// Number of nodes above which the frontier is not refined further.
const MAX_NODES: usize = 3 * LANES;

/// Capacity: the children of the last node that is opened, and padding for a whole block.
const CAPACITY: usize = MAX_NODES + 4 + LANES;

/// Nodes that contain all results of a group of queries, with their bounds in columns, so that a
/// query tests a block of them at once.
pub(super) struct Frontier<T> {
    pub(super) len: usize,
    pub(super) nodes: [u32; CAPACITY],
    min: [[T; CAPACITY]; 2],
    max: [[T; CAPACITY]; 2],
    half_size: [[T; CAPACITY]; 2],
    radius: [T; CAPACITY],
}

impl<T: Scalar> Default for Frontier<T> {
    fn default() -> Self {
        let none = [[T::ZERO; CAPACITY]; 2];
        let (min, max, half_size) = (none, none, none);
        Self { len: 0, nodes: [0; CAPACITY], min, max, half_size, radius: [T::ZERO; CAPACITY] }
    }
}

impl<T: Scalar> Frontier<T> {
    /// Finds the nodes that overlap `window`, which contains all queries, level by level, up to the
    /// capacity.
    #[inline(always)]
    pub(super) fn fill(&mut self, tree: &Quadtree<T>, window: &Window<T>) {
        let (nodes, node_bounds) = (tree.nodes(), tree.bounds());
        self.len = usize::from(!nodes.is_empty());
        self.nodes[0] = 0;
        // Leaves remain; other nodes are replaced by their children.
        // Level by level, so that the nodes of a full frontier have about the same size. Depth
        // first would spend the whole capacity on one corner of the window.
        let mut opened = true;
        while opened && self.len <= MAX_NODES {
            opened = false;
            let mut index = 0;
            let mut end = self.len;
            while index < end && self.len <= MAX_NODES {
                let node = &nodes[self.nodes[index] as usize];
                if node.is_leaf() {
                    index += 1;
                    continue;
                }
                opened = true;
                // Nodes before `end` are those of this level that have not been opened. The opened
                // one is replaced by the last of these, and that one by the last of the children.
                // So no list has to be moved.
                end -= 1;
                self.len -= 1;
                self.nodes[index] = self.nodes[end];
                self.nodes[end] = self.nodes[self.len];
                for child in node.children() {
                    self.nodes[self.len] = child as u32;
                    // Written in any case and counted only if it is near: a branch here would be
                    // hard to predict.
                    self.len += usize::from(window.may_touch(&node_bounds[child]));
                }
            }
        }
        // The bounds are copied into columns once for sixteen queries, each of which then tests
        // sixteen nodes with one instruction of each kind.
        for index in 0..self.len {
            let bounds = &node_bounds[self.nodes[index] as usize];
            for axis in 0..2 {
                self.min[axis][index] = bounds.min[axis];
                self.max[axis][index] = bounds.max[axis];
                self.half_size[axis][index] = bounds.half_size[axis];
            }
            self.radius[index] = bounds.radius;
        }
    }

    /// A bit for each node of a block with shapes that could touch the window.
    #[inline(always)]
    pub(super) fn lanes<S: Simd<T>>(&self, simd: S, window: &Window<T>, first: usize) -> u32 {
        let gaps = [self.gaps(simd, window, 0, first), self.gaps(simd, window, 1, first)];
        let radius_sum = simd.add(simd.splat(window.radius), simd.load(block(&self.radius, first)));
        lanes::may_touch(simd, gaps, radius_sum)
    }

    /// The gaps between the window and the nodes of a block along one axis.
    #[inline(always)]
    fn gaps<S: Simd<T>>(&self, simd: S, window: &Window<T>, axis: usize, first: usize) -> S::Block {
        let min = simd.load(block(&self.min[axis], first));
        let max = simd.load(block(&self.max[axis], first));
        let gap = window.gap_lanes(simd, axis, [min, max]);
        simd.sub(gap, simd.load(block(&self.half_size[axis], first)))
    }
}
