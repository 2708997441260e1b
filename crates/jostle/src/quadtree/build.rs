//! From the order of the shapes to the nodes of the tree and their covers.
//!
//! The upper nodes are made one after the other; what hangs below them is made by all
//! threads. Which nodes are upper ones follows from the number of shapes alone.

use std::ops::Range;

use super::Node;
use super::grid::GRID_LEVELS;
use super::order::{Keyed, Order};
use super::sort::key_of;
use crate::columns::Columns;
use crate::error::Result;
use crate::geometry::{Cover, Scalar};
use crate::interrupt::{Pulse, Stop};
use crate::memory;
use crate::parallel;
use crate::settings::Settings;
use crate::simd::{LANES, Simd, Work, block};

/// A tree of more shapes than this has upper nodes.
const LARGE: usize = 16_384;

/// Quarters of so few shapes are told apart by looking at all.
const FEW: usize = 256;

/// Upper nodes hold at least this share of all shapes.
const SHARE: usize = 64;

/// Makes the nodes, parents before children, siblings adjacent, and the covers. Not inlined,
/// so that a profile can name it.
#[inline(never)]
pub fn nodes<T: Scalar>(
    order: &Order,
    columns: &Columns<T>,
    settings: &Settings,
    nodes: &mut Vec<Node>,
    covers: &mut Vec<Cover<T>>,
) -> Result<()> {
    nodes.clear();
    covers.clear();
    if columns.is_empty() {
        return Ok(());
    }
    let builder = Builder { order, columns, settings, stop: Stop::current() };
    nodes.push(Node { end: columns.len() as u32, ..Node::default() });
    if columns.len() <= LARGE {
        builder.grow(nodes, 0)?;
        memory::resize(covers, nodes.len(), builder.nothing())?;
        return builder.cover(nodes, covers);
    }
    builder.grow(nodes, columns.len() / SHARE)?;
    let upper = nodes.len();
    let open: Vec<usize> = (0..upper).filter(|&node| nodes[node].is_leaf()).collect();
    let parts =
        parallel::map(settings.threads, open.len(), |index| builder.below(nodes[open[index]]));
    let parts = parts.into_iter().collect::<Result<Vec<_>>>()?;
    memory::reserve(nodes, parts.iter().map(|part| part.0.len()).sum())?;
    for (&node, part) in open.iter().zip(&parts) {
        adopt(nodes, node, &part.0);
    }
    memory::resize(covers, nodes.len(), builder.nothing())?;
    let mut end = upper;
    for (&node, (_, part)) in open.iter().zip(&parts) {
        covers[node] = part[0];
        covers[end..end + part.len() - 1].copy_from_slice(&part[1..]);
        end += part.len() - 1;
    }
    builder.cover(&nodes[..upper], covers)
}

/// Appends the nodes below a part's root, which stands at `root` already.
fn adopt(nodes: &mut Vec<Node>, root: usize, part: &[Node]) {
    // The part's node 1 comes to stand at the end.
    let moved = nodes.len() as u32 - 1;
    let (first, rest) = part.split_first().expect("a part has a root");
    nodes[root] = Node { children: first.children + moved, ..*first };
    nodes.extend(rest.iter().map(|node| Node { children: node.children + moved, ..*node }));
}

struct Builder<'a, T> {
    order: &'a Order,
    columns: &'a Columns<T>,
    settings: &'a Settings,
    stop: Stop,
}

impl<T: Scalar> Builder<'_, T> {
    /// The nodes from `root` down, counted from there, and their covers.
    fn below(&self, root: Node) -> Result<(Vec<Node>, Vec<Cover<T>>)> {
        let mut nodes = vec![root];
        self.grow(&mut nodes, 0)?;
        let mut covers = memory::filled(nodes.len(), self.nothing())?;
        self.cover(&nodes, &mut covers)?;
        Ok((nodes, covers))
    }

    /// Splits the nodes from the last one on until each holds `enough` shapes, or no
    /// more than a leaf may.
    fn grow(&self, nodes: &mut Vec<Node>, enough: usize) -> Result<()> {
        T::with_widest(Grow { builder: self, nodes, enough })
    }

    #[inline(always)]
    fn grow_here(&self, nodes: &mut Vec<Node>, enough: usize) -> Result<()> {
        let mut pulse = Pulse::of(&self.stop);
        let enough = enough.max(self.settings.leaf_capacity);
        let mut next = nodes.len() - 1;
        while next < nodes.len() {
            let node = nodes[next];
            if node.len() > enough && usize::from(node.depth) < self.settings.max_depth {
                pulse.check(node.len().min(FEW))?;
                memory::reserve(nodes, 4)?;
                self.split(next, nodes);
            }
            next += 1;
        }
        Ok(())
    }

    /// Appends the non-empty quarters of a node; there is room for them.
    #[inline(always)]
    fn split(&self, index: usize, nodes: &mut Vec<Node>) {
        let node = &mut nodes[index];
        let (start, end) = (node.start as usize, node.end as usize);
        let mut keyed = &self.order.keyed[node.grid as usize];
        let mut differing = keyed.key(start) ^ keyed.key(end - 1);
        if differing == 0
            && let Some(finer) = self.order.finer(start, end)
        {
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
        let level = node.level + 1;
        let sizes = quarters(keyed, start, end, shift);
        append(index, nodes, sizes, level);
    }

    /// Fills in the covers, children before parents. Where a leaf's `covers` entry
    /// stands for nodes below it, it has been filled in already.
    fn cover(&self, nodes: &[Node], covers: &mut [Cover<T>]) -> Result<()> {
        let pulse = Pulse::of(&self.stop);
        T::with_widest(CoverAll { columns: self.columns, nodes, covers, pulse })
    }

    fn nothing(&self) -> Cover<T> {
        Cover::of(&self.columns.shape(0))
    }
}

/// Splits a node into quarters by place, for shapes that no grid can tell apart.
fn by_rank(index: usize, nodes: &mut Vec<Node>) {
    let node = nodes[index];
    let end = |quarter: usize| node.len() * quarter / 4;
    append(index, nodes, [0, 1, 2, 3].map(|quarter| end(quarter + 1) - end(quarter)), node.level);
}

/// How many of the shapes from `start` to `end` lie in each quarter, named by the two
/// bits of their keys from `shift`; all bits above agree.
#[inline(always)]
fn quarters(keyed: &Keyed, start: usize, end: usize, shift: u32) -> [usize; 4] {
    let before = if end - start > FEW {
        let first = keyed.key(start) >> shift & !3;
        [1, 2, 3].map(|q| keyed.first_at_least((first | q) << shift) - start)
    } else {
        // Counting all is faster than searching: no step waits for the one before it.
        let mut before = [0u32; 3];
        for &item in keyed.items(start..end) {
            for q in 0..3 {
                before[q as usize] += u32::from(key_of(item) >> shift & 3 <= q);
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
        nodes.push(Node { start, end, children: 0, child_count: 0, depth, level, ..parent });
        start = end;
    }
    let child_count = (nodes.len() - children) as u8;
    nodes[index] = Node { children: children as u32, child_count, ..parent };
}

/// [`Builder::grow`] with the widest instructions, for counting.
struct Grow<'a, T> {
    builder: &'a Builder<'a, T>,
    nodes: &'a mut Vec<Node>,
    enough: usize,
}

impl<T: Scalar> Work<T> for Grow<'_, T> {
    type Out = Result<()>;

    #[inline(always)]
    fn run<S: Simd<T>>(self, _: S) -> Result<()> {
        self.builder.grow_here(self.nodes, self.enough)
    }
}

/// The covers of nodes whose covers are still open.
struct CoverAll<'a, T> {
    columns: &'a Columns<T>,
    nodes: &'a [Node],
    covers: &'a mut [Cover<T>],
    pulse: Pulse,
}

impl<T: Scalar> Work<T> for CoverAll<'_, T> {
    type Out = Result<()>;

    #[inline(always)]
    fn run<S: Simd<T>>(mut self, simd: S) -> Result<()> {
        for (index, node) in self.nodes.iter().enumerate().rev() {
            if node.is_leaf() {
                self.pulse.check(node.len())?;
                self.covers[index] = cover_of_leaf(simd, self.columns, node);
            } else if node.children().end <= self.nodes.len() {
                let children = self.covers[node.children()].iter().copied();
                self.covers[index] = children.reduce(Cover::join).unwrap_or(self.covers[index]);
            }
        }
        Ok(())
    }
}

/// The cover of a leaf's shapes, a block at a time.
#[inline(always)]
fn cover_of_leaf<T: Scalar, S: Simd<T>>(simd: S, columns: &Columns<T>, leaf: &Node) -> Cover<T> {
    let range = leaf.range();
    let first = columns.shape(range.start);
    let mut x = extent(simd, &columns.x, &range, first.min[0]);
    let mut y = extent(simd, &columns.y, &range, first.min[1]);
    if columns.has_boxes() {
        x[1] = extent(simd, &columns.max_x, &range, first.max[0])[1];
        y[1] = extent(simd, &columns.max_y, &range, first.max[1])[1];
    }
    let radius = extent(simd, &columns.radius, &range, first.radius)[1];
    let mut cover = Cover { min: [x[0], y[0]], max: [x[1], y[1]], radius, ..Cover::of(&first) };
    if columns.has_half_sizes() {
        let half_x = extent(simd, &columns.half_x, &range, first.half_size[0])[1];
        let half_y = extent(simd, &columns.half_y, &range, first.half_size[1])[1];
        cover.half_size = [half_x, half_y];
    }
    if columns.has_filters() {
        let all = |column: &[u32]| column[range.clone()].iter().fold(0, |all, bits| all | bits);
        (cover.category, cover.mask) = (all(&columns.category), all(&columns.mask));
    }
    cover
}

/// The smallest and the largest number of a range of a column. The last block overlaps
/// the one before it instead of being cut; a range smaller than a block is filled up with
/// its `first` number.
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
    for start in (range.start..range.end.saturating_sub(LANES)).step_by(LANES) {
        let block = simd.load(block(column, start));
        (low, high) = (simd.least(low, block), simd.most(high, block));
    }
    let (mut lows, mut highs) = ([first; LANES], [first; LANES]);
    simd.store(low, &mut lows);
    simd.store(high, &mut highs);
    for width in [8, 4, 2, 1] {
        for lane in 0..width {
            lows[lane] = lows[lane].least(lows[lane + width]);
            highs[lane] = highs[lane].most(highs[lane + width]);
        }
    }
    [lows[0], highs[0]]
}
