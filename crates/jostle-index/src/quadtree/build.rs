//! Construction of the nodes from sorted shapes, and of their strips and bounds.
//!
//! One thread makes the upper nodes; all threads make the subtrees below them. Which nodes are
//! upper nodes depends only on the number of shapes, so the tree is the same for every number
//! of threads.

use std::ops::Range;

use super::Node;
use super::grid::GRID_LEVELS;
use super::order::{Keyed, Order};
use super::strips::{self, Outputs, Strips};
use super::subtrees::{Subtrees, ThreadSubtrees};
use crate::columns::Columns;
use crate::geometry::{Bounds, Scalar};
use crate::shapes::Shapes;
use jostle_base::error::Result;
use jostle_base::interrupt::{Pulse, Stop};
use jostle_base::memory;
use jostle_base::parallel;
use jostle_base::settings::Settings;
use jostle_simd::{LANES, Simd, Work, block};

/// Trees of more shapes than this have upper nodes.
const LARGE: usize = 4096;

/// Nodes of at most this number of shapes are split by counting, larger ones by binary search.
const FEW: usize = 256;

/// Upper nodes have at least 1 / `MAX_SUBTREES` of all shapes.
const MAX_SUBTREES: usize = 64;

/// The nodes of a tree with their bounds and strips.
#[derive(Clone, Debug, Default)]
pub(super) struct Nodes<T> {
    /// Parents precede their children; siblings are adjacent.
    pub nodes: Vec<Node>,
    /// The bounds of each node.
    pub bounds: Vec<Bounds<T>>,
    /// The strips of each leaf.
    pub strips: Vec<Strips<T>>,
    /// The end of each strip, as an index.
    pub ends: Vec<u32>,
    scratch: strips::Scratch,
    subtrees: Subtrees<T>,
}

impl<T: Scalar> Nodes<T> {
    /// Removes all nodes and keeps their memory.
    pub(super) fn clear(&mut self) {
        self.nodes.clear();
        self.bounds.clear();
        self.strips.clear();
        self.ends.clear();
    }

    /// Allocated bytes, used or not.
    pub(super) fn memory_bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>()
            + self.bounds.capacity() * size_of::<Bounds<T>>()
            + self.strips.capacity() * size_of::<Strips<T>>()
            + self.ends.capacity() * size_of::<u32>()
            + self.subtrees.memory_bytes()
    }

    /// Makes the nodes and the strips of the leaves, and writes the shapes to `outputs`. Not
    /// inlined, so that profiles show it.
    #[inline(never)]
    pub(super) fn build(
        &mut self,
        order: &Order<T>,
        shapes: &Shapes<T>,
        outputs: Outputs<'_, T>,
        settings: &Settings,
        in_strips: bool,
    ) -> Result<()> {
        self.clear();
        let len = shapes.len();
        if len == 0 {
            return Ok(());
        }
        let builder = Builder { order, shapes, settings, in_strips, stop: Stop::current() };
        let root = Node { end: len as u32, ..Node::default() };
        // Small trees are made in one piece: the parts of subtrees would be copied once more.
        if len <= LARGE {
            let Self { nodes, strips, ends, scratch, .. } = self;
            nodes.push(root);
            builder.split_all(nodes, 0)?;
            return builder.fill_leaves(nodes, outputs, strips, ends, scratch);
        }
        self.nodes.push(root);
        // The upper nodes. About 64 subtrees divide evenly enough among a few threads, and finding
        // the upper nodes takes little time, because large nodes are split by the listed ends of
        // groups.
        builder.split_all(&mut self.nodes, len / MAX_SUBTREES)?;
        let Self { nodes, subtrees, .. } = self;
        let add = |thread: &mut ThreadSubtrees<T>, root, outputs: Outputs<'_, T>| {
            builder.add(thread, root, outputs)
        };
        subtrees.build(settings.threads, nodes, outputs, add)?;
        self.append_subtrees()
    }

    /// Appends the nodes, strips and ends of the subtrees.
    fn append_subtrees(&mut self) -> Result<()> {
        let Self { nodes, strips, ends, subtrees, .. } = self;
        let [more_nodes, more_strips, more_ends] = subtrees.sizes();
        memory::reserve(nodes, more_nodes)?;
        memory::reserve(strips, more_strips)?;
        memory::reserve(ends, more_ends)?;
        for (root, subtree, thread) in subtrees.iter() {
            // The root of the subtree exists already; its other nodes are appended.
            // Numbers count from the start of the lists of a thread. The shift may be negative; modulo 2^32 it is
            // right in any case.
            let node_shift = (nodes.len() as u32).wrapping_sub(subtree.nodes.start as u32 + 1);
            let strip_shift = (strips.len() as u32).wrapping_sub(subtree.strips.start as u32);
            let end_shift = (ends.len() as u32).wrapping_sub(subtree.ends.start as u32);
            let moved = |node: &Node| {
                let shift = if node.is_leaf() { strip_shift } else { node_shift };
                Node { children: node.children.wrapping_add(shift), ..*node }
            };
            let (first, rest) = thread.nodes[subtree.nodes.clone()].split_first().expect("a root");
            // Subtrees come in the order of their shapes, not in that in which threads made them.
            // So the list of nodes is the same on each number of threads, and parents still precede
            // their children.
            nodes[root as usize] = moved(first);
            nodes.extend(rest.iter().map(moved));
            let leaves = &thread.strips[subtree.strips.clone()];
            strips.extend(leaves.iter().map(|leaf| leaf.moved(end_shift)));
            ends.extend_from_slice(&thread.ends[subtree.ends.clone()]);
        }
        Ok(())
    }

    /// A copy.
    pub(super) fn copied(&self) -> Result<Self> {
        Ok(Self {
            nodes: memory::collect(self.nodes.iter().copied())?,
            bounds: memory::collect(self.bounds.iter().copied())?,
            strips: memory::collect(self.strips.iter().copied())?,
            ends: memory::collect(self.ends.iter().copied())?,
            scratch: strips::Scratch::default(),
            subtrees: Subtrees::default(),
        })
    }

    /// Prepares the nodes for shapes whose radii are larger by `by`.
    pub(super) fn grow(&mut self, by: T) {
        // Rounding is monotone: the largest radius plus `by` is the largest of all sums.
        self.bounds.iter_mut().for_each(|bounds| bounds.radius = bounds.radius + by);
        self.strips.iter_mut().for_each(|strips| *strips = strips.reaching(by + by));
    }

    /// Computes the bounds of all nodes.
    pub(super) fn compute_bounds(
        &mut self,
        columns: &Columns<T>,
        settings: &Settings,
    ) -> Result<()> {
        if columns.is_empty() {
            return Ok(());
        }
        let nothing = Bounds::of(&columns.shape(0));
        memory::resize(&mut self.bounds, self.nodes.len(), nothing)?;
        let Self { nodes, bounds, .. } = self;
        let stop = Stop::current();
        let leaves = |first: usize, bounds: &mut [Bounds<T>]| {
            let pulse = Pulse::of(&stop);
            T::with_widest(LeafBounds { columns, nodes: &nodes[first..], bounds, pulse });
        };
        parallel::for_chunks(settings.threads, bounds, leaves);
        stop.check()?;
        // Nested bounds: those of a node contain the bounds of its children, and each number is a
        // minimum or a maximum of numbers of its shapes. Nothing is added or multiplied, so nothing
        // is rounded, and `Bounds::overlaps` on them is never false where it is true for one of the
        // shapes.
        //
        // Backwards, because children come after their parents.
        for (index, node) in nodes.iter().enumerate().rev() {
            if !node.is_leaf() {
                let children = bounds[node.children()].iter().copied();
                bounds[index] = children.reduce(Bounds::join).unwrap_or(nothing);
            }
        }
        Ok(())
    }
}

struct Builder<'a, T> {
    order: &'a Order<T>,
    shapes: &'a Shapes<T>,
    settings: &'a Settings,
    in_strips: bool,
    stop: Stop,
}

impl<T: Scalar> Builder<'_, T> {
    /// Makes the subtree of `root`.
    fn add(
        &self,
        thread: &mut ThreadSubtrees<T>,
        root: Node,
        outputs: Outputs<'_, T>,
    ) -> Result<()> {
        let ThreadSubtrees { nodes, strips, ends, scratch, .. } = thread;
        let first = nodes.len();
        memory::push(nodes, root)?;
        self.split_all(nodes, 0)?;
        self.fill_leaves(&mut nodes[first..], outputs, strips, ends, scratch)
    }

    /// Writes the shapes of all leaves to `outputs`, which begin with the first shape of the first
    /// node, and makes their strips.
    fn fill_leaves(
        &self,
        nodes: &mut [Node],
        mut outputs: Outputs<'_, T>,
        strips: &mut Vec<Strips<T>>,
        ends: &mut Vec<u32>,
        scratch: &mut strips::Scratch,
    ) -> Result<()> {
        let mut pulse = Pulse::of(&self.stop);
        let before = nodes[0].start;
        for node in nodes.iter_mut().filter(|node| node.is_leaf()) {
            pulse.check(node.len())?;
            // Leaves are visited in the order of the nodes, so the number of strips so far is the
            // index of the next.
            node.children = strips.len() as u32;
            let items = self.order.keyed[0].items(node.range());
            let from = (node.start - before) as usize;
            let to = outputs.range(from..from + node.len());
            let start = node.start as usize;
            let leaf = if self.in_strips {
                strips::sort_into_strips(self.shapes, items, start, to, ends, scratch)?
            } else {
                strips::single_strip(items, start, to, ends)?
            };
            memory::push(strips, leaf)?;
        }
        Ok(())
    }

    /// Splits the last node, and the nodes that this appends, until each has at most `max_len`
    /// shapes or at most `leaf_capacity`.
    fn split_all(&self, nodes: &mut Vec<Node>, max_len: usize) -> Result<()> {
        T::with_widest(Split { builder: self, nodes, max_len })
    }

    #[inline(always)]
    fn split_here(&self, nodes: &mut Vec<Node>, max_len: usize) -> Result<()> {
        let mut pulse = Pulse::of(&self.stop);
        // With `max_len` above the capacity only upper nodes are made; the rest is left for the
        // subtrees.
        let max_len = max_len.max(self.settings.leaf_capacity);
        let mut next = nodes.len() - 1;
        // The list of nodes is its own queue: children are appended and their turn comes later.
        // This gives the invariant that parents precede children, and the siblings are next to each
        // other in memory.
        while next < nodes.len() {
            let node = nodes[next];
            if node.len() > max_len && usize::from(node.depth) < self.settings.max_depth {
                pulse.check(node.len().min(FEW))?;
                memory::reserve(nodes, 4)?;
                self.split(next, nodes);
            }
            next += 1;
        }
        Ok(())
    }

    /// Appends the non-empty quarters of a node; there is capacity for them.
    #[inline(always)]
    fn split(&self, index: usize, nodes: &mut Vec<Node>) {
        let node = &mut nodes[index];
        let (start, end) = (node.start as usize, node.end as usize);
        let mut keyed = &self.order.keyed[node.grid as usize];
        // Items of one group may be unsorted. That changes nothing here: a node above the capacity
        // either has several groups, and their leading bits differ, or its group was too large and
        // has been sorted.
        let mut differing = keyed.key(start) ^ keyed.key(end - 1);
        // All shapes are in one finest cell of this grid, so they have a grid of their own, unless
        // they coincide.
        if differing == 0
            && let Some(finer) = self.order.finer(start, end)
        {
            keyed = &self.order.keyed[finer];
            (node.grid, node.level) = (finer as u32, 0);
            differing = keyed.key(start) ^ keyed.key(end - 1);
        }
        // Coincident shapes, or a short run. A split by index keeps leaves small, whatever the
        // shapes: a leaf with a million coincident points would be tested against itself, a million
        // times a million.
        if differing == 0 {
            return split_by_index(index, nodes);
        }
        // The level at which the first and the last key differ. The keys are sorted, so all agree
        // above.
        // Levels at which all shapes are in the same quarter are skipped (path compression). So a
        // node always has at least two children, and there are fewer nodes than shapes.
        node.level = (differing.leading_zeros() / 2) as u8;
        let shift = 2 * (GRID_LEVELS - 1 - u32::from(node.level));
        let level = node.level + 1;
        let sizes = quarters(keyed, start, end, shift);
        append(index, nodes, sizes, level);
    }
}

/// Splits a node of coincident shapes into four parts of about equal size.
fn split_by_index(index: usize, nodes: &mut Vec<Node>) {
    let node = nodes[index];
    let end = |quarter: usize| node.len() * quarter / 4;
    append(index, nodes, [0, 1, 2, 3].map(|quarter| end(quarter + 1) - end(quarter)), node.level);
}

/// Number of the shapes from `start` to `end` in each quarter. The two bits of a key at `shift`
/// are the number of its quarter; all higher bits agree.
#[inline(always)]
fn quarters<T>(keyed: &Keyed<T>, start: usize, end: usize, shift: u32) -> [usize; 4] {
    // A large node: three bounds are looked up among the listed starts of groups. The `& !3` clears
    // the bits of the quarter, so what is left are the bits in which all keys of the node agree.
    let before = if end - start > FEW {
        let first = keyed.key(start) >> shift & !3;
        let before = |quarter: u32| keyed.first_at_least((first | quarter) << shift) - start;
        [before(1), before(2), before(3)]
    } else {
        // Counting is faster than binary search here: its steps do not depend on each other.
        let mut before = [0u32; 3];
        for item in keyed.items(start..end) {
            for q in 0..3 {
                before[q as usize] += u32::from(item.key >> shift & 3 <= q);
            }
        }
        before.map(|count| count as usize)
    };
    let [one, two, three] = before;
    [one, two - one, three - two, end - start - three]
}

/// Appends the children of a node; quarters of size 0 are left out.
fn append(index: usize, nodes: &mut Vec<Node>, sizes: [usize; 4], level: u8) {
    let (parent, children) = (nodes[index], nodes.len());
    let mut start = parent.start;
    for size in sizes.into_iter().filter(|&size| size > 0) {
        let (end, depth) = (start + size as u32, parent.depth + 1);
        // `grid` is that of the parent. `split` replaces it when the shapes of the child share a
        // key.
        nodes.push(Node { start, end, children: 0, child_count: 0, depth, level, ..parent });
        start = end;
    }
    let child_count = (nodes.len() - children) as u8;
    nodes[index] = Node { children: children as u32, child_count, ..parent };
}

/// [`Builder::split_all`] with the widest vector instructions.
struct Split<'a, T> {
    builder: &'a Builder<'a, T>,
    nodes: &'a mut Vec<Node>,
    max_len: usize,
}

impl<T: Scalar> Work<T> for Split<'_, T> {
    type Out = Result<()>;

    #[inline(always)]
    fn run<S: Simd<T>>(self, _: S) -> Result<()> {
        self.builder.split_here(self.nodes, self.max_len)
    }
}

/// Computes the bounds of those of some nodes that are leaves.
struct LeafBounds<'a, T> {
    columns: &'a Columns<T>,
    nodes: &'a [Node],
    bounds: &'a mut [Bounds<T>],
    pulse: Pulse,
}

impl<T: Scalar> Work<T> for LeafBounds<'_, T> {
    type Out = ();

    #[inline(always)]
    fn run<S: Simd<T>>(mut self, simd: S) {
        for (node, bounds) in self.nodes.iter().zip(self.bounds) {
            if node.is_leaf() {
                if self.pulse.stops(node.len()) {
                    return;
                }
                *bounds = leaf_bounds(simd, self.columns, node);
            }
        }
    }
}

/// The bounds of the shapes of a leaf.
#[inline(always)]
fn leaf_bounds<T: Scalar, S: Simd<T>>(simd: S, columns: &Columns<T>, leaf: &Node) -> Bounds<T> {
    let range = leaf.range();
    let first = columns.shape(range.start);
    let mut x = extent(simd, &columns.x, &range, first.min[0]);
    let mut y = extent(simd, &columns.y, &range, first.min[1]);
    if columns.has_boxes() {
        x[1] = extent(simd, &columns.max_x, &range, first.max[0])[1];
        y[1] = extent(simd, &columns.max_y, &range, first.max[1])[1];
    }
    let radius = extent(simd, &columns.radius, &range, first.radius)[1];
    let mut bounds = Bounds { min: [x[0], y[0]], max: [x[1], y[1]], radius, ..Bounds::of(&first) };
    if columns.has_half_sizes() {
        let half_x = extent(simd, &columns.half_x, &range, first.half_size[0])[1];
        let half_y = extent(simd, &columns.half_y, &range, first.half_size[1])[1];
        bounds.half_size = [half_x, half_y];
    }
    if columns.has_filters() {
        let all = |column: &[u32]| column[range.clone()].iter().fold(0, |all, bits| all | bits);
        (bounds.category, bounds.mask) = (all(&columns.category), all(&columns.mask));
    }
    bounds
}

/// The smallest and the largest number of a range of a column. The last block overlaps the block
/// before it; a range shorter than a block is padded with its `first` number.
#[inline(always)]
fn extent<T: Scalar, S: Simd<T>>(simd: S, column: &[T], range: &Range<usize>, first: T) -> [T; 2] {
    let last = if range.len() < LANES {
        let mut padded = [first; LANES];
        let lanes = padded.iter_mut().zip(&column[range.clone()]);
        lanes.for_each(|(lane, &number)| *lane = number);
        simd.load(&padded)
    } else {
        simd.load(block(column, range.end - LANES))
    };
    let (mut low, mut high) = (last, last);
    // The last block is read first, so that no block is partly outside the range. A number that is
    // read twice does not change a minimum.
    for start in (range.start..range.end.saturating_sub(LANES)).step_by(LANES) {
        let block = simd.load(block(column, start));
        (low, high) = (simd.min(low, block), simd.max(high, block));
    }
    let (mut lows, mut highs) = ([first; LANES], [first; LANES]);
    simd.store(low, &mut lows);
    simd.store(high, &mut highs);
    // Pairs of halves: four dependent steps instead of fifteen. Minima of numbers that are not NaN
    // do not depend on the order.
    for width in [8, 4, 2, 1] {
        for lane in 0..width {
            lows[lane] = lows[lane].min(lows[lane + width]);
            highs[lane] = highs[lane].max(highs[lane + width]);
        }
    }
    [lows[0], highs[0]]
}
