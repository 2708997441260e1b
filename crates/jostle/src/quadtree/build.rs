//! From the order of the shapes to the nodes of the tree and their covers.
//!
//! The upper nodes are made one after the other; what hangs below them is made by all
//! threads. Which nodes are upper ones follows from the number of shapes alone.

use std::ops::Range;

use super::Node;
use super::grid::GRID_LEVELS;
use super::order::Order;
use crate::columns::Columns;
use crate::geometry::{Cover, Scalar};
use crate::parallel;
use crate::settings::Settings;
use crate::simd::{LANES, Simd, Work, block};

/// A tree of more shapes than this has upper nodes.
const LARGE: usize = 16_384;

/// Upper nodes hold at least this share of all shapes.
const SHARE: usize = 64;

/// Makes the nodes, parents before children, siblings adjacent, and the covers.
pub fn nodes<T: Scalar>(
    order: &Order,
    columns: &Columns<T>,
    settings: &Settings,
    nodes: &mut Vec<Node>,
    covers: &mut Vec<Cover<T>>,
) {
    nodes.clear();
    covers.clear();
    if columns.is_empty() {
        return;
    }
    let builder = Builder { order, columns, settings };
    nodes.push(Node { end: columns.len() as u32, ..Node::default() });
    if columns.len() <= LARGE {
        builder.grow(nodes, 0);
        covers.resize(nodes.len(), builder.nothing());
        return builder.cover(nodes, covers);
    }
    builder.grow(nodes, columns.len() / SHARE);
    let upper = nodes.len();
    let open: Vec<usize> = (0..upper).filter(|&node| nodes[node].is_leaf()).collect();
    let parts = parallel::map(settings.threads, open.len(), |index| builder.below(nodes[open[index]]));
    for (&node, part) in open.iter().zip(&parts) {
        adopt(nodes, node, &part.0);
    }
    covers.resize(nodes.len(), builder.nothing());
    let mut end = upper;
    for (&node, (_, part)) in open.iter().zip(&parts) {
        covers[node] = part[0];
        covers[end..end + part.len() - 1].copy_from_slice(&part[1..]);
        end += part.len() - 1;
    }
    builder.cover(&nodes[..upper], covers);
}

/// Appends the nodes below a part's root, which stands at `root` already.
fn adopt(nodes: &mut Vec<Node>, root: usize, part: &[Node]) {
    // The part's node 1 comes to stand at the end.
    let moved = nodes.len() as u32 - 1;
    let place = |node: &Node| Node { children: node.children + moved, ..*node };
    nodes[root] = place(&part[0]);
    nodes.extend(part[1..].iter().map(place));
}

struct Builder<'a, T> {
    order: &'a Order,
    columns: &'a Columns<T>,
    settings: &'a Settings,
}

impl<T: Scalar> Builder<'_, T> {
    /// The nodes from `root` down, counted from there, and their covers.
    fn below(&self, root: Node) -> (Vec<Node>, Vec<Cover<T>>) {
        let mut nodes = vec![root];
        self.grow(&mut nodes, 0);
        let mut covers = vec![self.nothing(); nodes.len()];
        self.cover(&nodes, &mut covers);
        (nodes, covers)
    }

    /// Splits the nodes from the last one on until each holds `enough` shapes, or no
    /// more than a leaf may.
    fn grow(&self, nodes: &mut Vec<Node>, enough: usize) {
        let enough = enough.max(self.settings.leaf_capacity);
        let mut next = nodes.len() - 1;
        while next < nodes.len() {
            let node = nodes[next];
            if node.len() > enough && usize::from(node.depth) < self.settings.max_depth {
                self.split(next, nodes);
            }
            next += 1;
        }
    }

    /// Appends the non-empty quarters of a node.
    fn split(&self, index: usize, nodes: &mut Vec<Node>) {
        let node = &mut nodes[index];
        let (start, end) = (node.start as usize, node.end as usize);
        let mut keyed = &self.order.keyed[node.grid as usize];
        let mut differing = keyed.key(start) ^ keyed.key(end - 1);
        if differing == 0 && let Some(finer) = self.order.finer(start, end) {
            keyed = &self.order.keyed[finer];
            (node.grid, node.level) = (finer as u32, 0);
            differing = keyed.key(start) ^ keyed.key(end - 1);
        }
        if differing == 0 {
            return by_rank(index, nodes);
        }
        // The level at which the first and the last key part: sorted, so all agree above.
        node.level = (differing.leading_zeros() / 2) as u8;
        let shift = 2 * (GRID_LEVELS - 1 - u32::from(node.level));
        let keys = &keyed.keys[start - keyed.start..end - keyed.start];
        let mut from = 0;
        let mut ends = [0; 4];
        let mut count = 0;
        while from < keys.len() {
            let quarter = keys[from] >> shift;
            from += keys[from..].partition_point(|&key| key >> shift == quarter);
            ends[count] = start + from;
            count += 1;
        }
        let level = node.level + 1;
        append(index, nodes, &ends[..count], level);
    }

    /// Fills in the covers, children before parents. Where a leaf's `covers` entry
    /// stands for nodes below it, it has been filled in already.
    fn cover(&self, nodes: &[Node], covers: &mut [Cover<T>]) {
        T::with_widest(CoverAll { columns: self.columns, nodes, covers });
    }

    fn nothing(&self) -> Cover<T> {
        Cover::of(&self.columns.shape(0))
    }
}

/// Splits a node into quarters by place, for shapes that no grid can tell apart.
fn by_rank(index: usize, nodes: &mut Vec<Node>) {
    let node = nodes[index];
    let (start, len) = (node.start as usize, node.len());
    let mut ends = [0; 4];
    let mut count = 0;
    for quarter in 1..=4 {
        let end = start + len * quarter / 4;
        if end > if count == 0 { start } else { ends[count - 1] } {
            ends[count] = end;
            count += 1;
        }
    }
    append(index, nodes, &ends[..count], node.level);
}

/// Appends the children of a node, which end at `ends`.
fn append(index: usize, nodes: &mut Vec<Node>, ends: &[usize], level: u8) {
    let parent = Node { children: nodes.len() as u32, child_count: ends.len() as u8, ..nodes[index] };
    nodes[index] = parent;
    let mut start = parent.start;
    for &end in ends {
        let end = end as u32;
        let depth = parent.depth + 1;
        nodes.push(Node { start, end, children: 0, child_count: 0, depth, level, ..parent });
        start = end;
    }
}

/// The covers of nodes whose covers are still open.
struct CoverAll<'a, T> {
    columns: &'a Columns<T>,
    nodes: &'a [Node],
    covers: &'a mut [Cover<T>],
}

impl<T: Scalar> Work<T> for CoverAll<'_, T> {
    type Out = ();

    #[inline(always)]
    fn run<S: Simd<T>>(self, simd: S) {
        for (index, node) in self.nodes.iter().enumerate().rev() {
            if node.is_leaf() {
                self.covers[index] = cover_of_leaf(simd, self.columns, node);
            } else if node.children().end <= self.nodes.len() {
                let children = self.covers[node.children()].iter().copied();
                self.covers[index] = children.reduce(Cover::join).unwrap_or(self.covers[index]);
            }
        }
    }
}

/// The cover of a leaf's shapes, a block at a time.
#[inline(always)]
fn cover_of_leaf<T: Scalar, S: Simd<T>>(simd: S, columns: &Columns<T>, leaf: &Node) -> Cover<T> {
    let range = leaf.range();
    let first = columns.shape(range.start);
    // The last block overlaps the one before it instead of being cut; a leaf smaller than
    // a block is filled up with its first shape.
    let most = |column: &[T], first: T| {
        let mut most = simd.splat(first);
        fold(simd, column, &range, first, |block| most = simd.most(most, block));
        reduce(simd, most, T::most)
    };
    let least = |column: &[T], first: T| {
        let mut least = simd.splat(first);
        fold(simd, column, &range, first, |block| least = simd.least(least, block));
        reduce(simd, least, T::least)
    };
    let [x, y] = first.center;
    let mut cover = Cover {
        min: [least(&columns.x, x), least(&columns.y, y)],
        max: [most(&columns.x, x), most(&columns.y, y)],
        radius: most(&columns.radius, first.radius),
        ..Cover::of(&first)
    };
    if columns.has_boxes() {
        let [half_x, half_y] = first.half_size;
        cover.half_size = [most(&columns.half_x, half_x), most(&columns.half_y, half_y)];
    }
    if columns.has_filters() {
        let all = |column: &[u32]| column[range.clone()].iter().fold(0, |all, bits| all | bits);
        (cover.category, cover.mask) = (all(&columns.category), all(&columns.mask));
    }
    cover
}

/// Calls `act` with blocks that hold every number of the range and nothing else but
/// `filling`.
#[inline(always)]
fn fold<T: Scalar, S: Simd<T>>(
    simd: S,
    column: &[T],
    range: &Range<usize>,
    filling: T,
    mut act: impl FnMut(S::Block),
) {
    if range.len() < LANES {
        let mut padded = [filling; LANES];
        let lanes = padded.iter_mut().zip(&column[range.clone()]);
        lanes.for_each(|(lane, &number)| *lane = number);
        return act(simd.load(&padded));
    }
    let last = range.end - LANES;
    for start in (range.start..last).step_by(LANES) {
        act(simd.load(block(column, start)));
    }
    act(simd.load(block(column, last)));
}

/// The lanes of a block, taken together.
#[inline(always)]
fn reduce<T: Scalar, S: Simd<T>>(simd: S, block: S::Block, both: impl Fn(T, T) -> T) -> T {
    let mut lanes = [T::ZERO; LANES];
    simd.store(block, &mut lanes);
    let mut width = LANES;
    while width > 1 {
        width /= 2;
        for lane in 0..width {
            lanes[lane] = both(lanes[lane], lanes[lane + width]);
        }
    }
    lanes[0]
}
