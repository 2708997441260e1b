//! The common part of the search of neighbouring queries.

use super::window::Window;
use crate::geometry::Scalar;
use crate::quadtree::Quadtree;
use crate::simd::{LANES, Simd, block};

/// Number of neighbouring queries that share the first part of their search.
pub(super) const GROUP: usize = 16;

/// Nodes at which they part at the latest.
const MOST_NODES: usize = 3 * LANES;

/// Room for the nodes that come of the last one that is opened, and for a whole block.
const ROOM: usize = MOST_NODES + 4 + LANES;

/// Nodes that contain all results of some neighbouring queries, with their covers in columns:
/// a query tests a block of them at once.
pub(super) struct Frontier<T> {
    pub(super) len: usize,
    pub(super) nodes: [u32; ROOM],
    min: [[T; ROOM]; 2],
    max: [[T; ROOM]; 2],
    half_size: [[T; ROOM]; 2],
    radius: [T; ROOM],
}

impl<T: Scalar> Default for Frontier<T> {
    fn default() -> Self {
        let none = [[T::ZERO; ROOM]; 2];
        let (min, max, half_size) = (none, none, none);
        Self { len: 0, nodes: [0; ROOM], min, max, half_size, radius: [T::ZERO; ROOM] }
    }
}

impl<T: Scalar> Frontier<T> {
    /// Opens nodes that overlap `window`, which contains all queries, as long as there is room.
    #[inline(always)]
    pub(super) fn fill(&mut self, tree: &Quadtree<T>, window: &Window<T>) {
        let (nodes, covers) = (tree.nodes(), tree.covers());
        self.len = usize::from(!nodes.is_empty());
        self.nodes[0] = 0;
        // Leaves stay, everything else makes way for its children, level by level.
        let mut opened = true;
        while opened && self.len <= MOST_NODES {
            opened = false;
            let mut place = 0;
            let mut end = self.len;
            while place < end && self.len <= MOST_NODES {
                let node = &nodes[self.nodes[place] as usize];
                if node.is_leaf() {
                    place += 1;
                    continue;
                }
                opened = true;
                end -= 1;
                self.len -= 1;
                self.nodes[place] = self.nodes[end];
                self.nodes[end] = self.nodes[self.len];
                for child in node.children() {
                    self.nodes[self.len] = child as u32;
                    self.len += usize::from(window.meets(&covers[child]));
                }
            }
        }
        for place in 0..self.len {
            let cover = &covers[self.nodes[place] as usize];
            for axis in 0..2 {
                self.min[axis][place] = cover.min[axis];
                self.max[axis][place] = cover.max[axis];
                self.half_size[axis][place] = cover.half_size[axis];
            }
            self.radius[place] = cover.radius;
        }
    }

    /// A bit for each node of a block of which some shape could touch the window.
    #[inline(always)]
    pub(super) fn lanes<S: Simd<T>>(&self, simd: S, window: &Window<T>, first: usize) -> u32 {
        let x = self.beyond(simd, window, 0, first);
        let y = self.beyond(simd, window, 1, first);
        let reach = simd.add(simd.splat(window.radius), simd.load(block(&self.radius, first)));
        !simd.less(simd.mul(reach, reach), simd.add(simd.mul(x, x), simd.mul(y, y)))
    }

    /// How far the window is from the nodes of a block along one axis; 0 inside.
    #[inline(always)]
    fn beyond<S: Simd<T>>(
        &self,
        simd: S,
        window: &Window<T>,
        axis: usize,
        first: usize,
    ) -> S::Block {
        let min = simd.load(block(&self.min[axis], first));
        let max = simd.load(block(&self.max[axis], first));
        let below = simd.sub(simd.splat(window.min[axis]), max);
        let above = simd.sub(min, simd.splat(window.max[axis]));
        let gap = simd.most(below, above);
        let gap = simd.sub(gap, simd.load(block(&self.half_size[axis], first)));
        simd.most(gap, simd.splat(T::ZERO))
    }
}
