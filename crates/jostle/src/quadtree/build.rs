//! From the order of the shapes to the nodes of the tree, their strips and their covers.
//!
//! The upper nodes are made one after the other; what hangs below them is made by all
//! threads. Which nodes are upper ones follows from the number of shapes alone.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use super::Node;
use super::grid::GRID_LEVELS;
use super::order::{Keyed, Order};
use super::strips::{self, Places, Strips};
use crate::columns::Columns;
use crate::error::Result;
use crate::geometry::{Cover, Scalar};
use crate::interrupt::{Pulse, Stop};
use crate::memory;
use crate::parallel::{self, locked};
use crate::settings::Settings;
use crate::shapes::Shapes;
use crate::simd::{LANES, Simd, Work, block};

/// A tree of more shapes than this has upper nodes.
const LARGE: usize = 4096;

/// Quarters of so few shapes are told apart by looking at all.
const FEW: usize = 256;

/// Upper nodes hold at least this share of all shapes.
const SHARE: usize = 64;

/// What a tree consists of, besides the order of its shapes.
#[derive(Clone, Debug, Default)]
pub struct Nodes<T> {
    /// Parents before children, siblings adjacent.
    pub nodes: Vec<Node>,
    /// One for each node.
    pub covers: Vec<Cover<T>>,
    /// One for each leaf.
    pub strips: Vec<Strips<T>>,
    /// Where each strip ends.
    pub ends: Vec<u32>,
    scratch: strips::Scratch,
}

impl<T: Scalar> Nodes<T> {
    /// Forgets everything and keeps the memory.
    pub fn clear(&mut self) {
        self.nodes.clear();
        self.covers.clear();
        self.strips.clear();
        self.ends.clear();
    }

    /// Bytes of memory that they keep, used or not.
    pub fn kept_bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>()
            + self.covers.capacity() * size_of::<Cover<T>>()
            + self.strips.capacity() * size_of::<Strips<T>>()
            + self.ends.capacity() * size_of::<u32>()
    }

    /// Makes the nodes and the strips of their leaves, which sorts the `rows` of each leaf. Not
    /// inlined, so that a profile can name it.
    #[inline(never)]
    pub fn grow(
        &mut self,
        order: &Order<T>,
        shapes: &Shapes<T>,
        mut places: Places<'_, T>,
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
        if len <= LARGE {
            let Self { nodes, strips, ends, scratch, .. } = self;
            nodes.push(root);
            builder.split_all(nodes, 0)?;
            return builder.put(nodes, places, strips, ends, scratch);
        }
        self.nodes.push(root);
        builder.split_all(&mut self.nodes, len / SHARE)?;
        let mut open: Vec<u32> = (0..self.nodes.len() as u32).collect();
        open.retain(|&node| self.nodes[node as usize].is_leaf());
        open.sort_unstable_by_key(|&node| self.nodes[node as usize].start);
        let failed = Mutex::new(Ok(()));
        let tasks = open.iter().map(|&node| {
            let node = self.nodes[node as usize];
            (node, places.split_off(node.len()))
        });
        let tasks: Vec<_> = tasks.collect();
        let mut parts = Vec::new();
        parallel::for_each_with(
            settings.threads,
            tasks.into_iter().enumerate(),
            Part::default,
            |(task, (root, places)), part| {
                if let Err(error) = builder.add(part, task, root, places) {
                    *locked(&failed) = Err(error);
                }
            },
            |part| parts.push(part),
        );
        failed.into_inner().unwrap_or_else(PoisonError::into_inner)?;
        self.adopt(&open, &parts)
    }

    /// Appends what hangs below the `open` nodes.
    fn adopt(&mut self, open: &[u32], parts: &[Part<T>]) -> Result<()> {
        memory::reserve(&mut self.nodes, parts.iter().map(|part| part.nodes.len()).sum())?;
        memory::reserve(&mut self.strips, parts.iter().map(|part| part.strips.len()).sum())?;
        memory::reserve(&mut self.ends, parts.iter().map(|part| part.ends.len()).sum())?;
        let mut pieces: Vec<(&Piece, &Part<T>)> = parts
            .iter()
            .flat_map(|part| part.pieces.iter().map(move |piece| (piece, part)))
            .collect();
        pieces.sort_unstable_by_key(|(piece, _)| piece.task);
        for (&root, (piece, part)) in open.iter().zip(pieces) {
            // The piece's root stands above already, its next node comes to stand at the end.
            let node_shift = (self.nodes.len() as u32).wrapping_sub(piece.nodes.start as u32 + 1);
            let strip_shift = (self.strips.len() as u32).wrapping_sub(piece.strips.start as u32);
            let end_shift = (self.ends.len() as u32).wrapping_sub(piece.ends.start as u32);
            let moved = |node: &Node| {
                let shift = if node.is_leaf() { strip_shift } else { node_shift };
                Node { children: node.children.wrapping_add(shift), ..*node }
            };
            let (first, rest) = part.nodes[piece.nodes.clone()].split_first().expect("a root");
            self.nodes[root as usize] = moved(first);
            self.nodes.extend(rest.iter().map(moved));
            let strips = &part.strips[piece.strips.clone()];
            self.strips.extend(strips.iter().map(|leaf| leaf.moved(end_shift)));
            self.ends.extend_from_slice(&part.ends[piece.ends.clone()]);
        }
        Ok(())
    }

    /// Computes the covers of all nodes.
    pub fn cover(&mut self, columns: &Columns<T>, settings: &Settings) -> Result<()> {
        if columns.is_empty() {
            return Ok(());
        }
        let nothing = Cover::of(&columns.shape(0));
        memory::resize(&mut self.covers, self.nodes.len(), nothing)?;
        let Self { nodes, covers, .. } = self;
        let stop = Stop::current();
        let leaves = |first: usize, covers: &mut [Cover<T>]| {
            let pulse = Pulse::of(&stop);
            T::with_widest(CoverLeaves { columns, nodes: &nodes[first..], covers, pulse });
        };
        parallel::for_chunks(settings.threads, covers, leaves);
        stop.check()?;
        for (index, node) in nodes.iter().enumerate().rev() {
            if !node.is_leaf() {
                let children = covers[node.children()].iter().copied();
                covers[index] = children.reduce(Cover::join).unwrap_or(nothing);
            }
        }
        Ok(())
    }
}

/// What one thread has made.
#[derive(Default)]
struct Part<T> {
    nodes: Vec<Node>,
    strips: Vec<Strips<T>>,
    ends: Vec<u32>,
    pieces: Vec<Piece>,
    scratch: strips::Scratch,
}

/// What hangs below one node: ranges of what a thread has made.
struct Piece {
    task: usize,
    nodes: Range<usize>,
    strips: Range<usize>,
    ends: Range<usize>,
}

struct Builder<'a, T> {
    order: &'a Order<T>,
    shapes: &'a Shapes<T>,
    settings: &'a Settings,
    in_strips: bool,
    stop: Stop,
}

impl<T: Scalar> Builder<'_, T> {
    /// Adds a root with everything below it.
    fn add(
        &self,
        part: &mut Part<T>,
        task: usize,
        root: Node,
        places: Places<'_, T>,
    ) -> Result<()> {
        let [first, strip, end] = [part.nodes.len(), part.strips.len(), part.ends.len()];
        memory::push(&mut part.nodes, root)?;
        self.split_all(&mut part.nodes, 0)?;
        let Part { nodes, strips, ends, scratch, .. } = part;
        self.put(&mut nodes[first..], places, strips, ends, scratch)?;
        part.pieces.push(Piece {
            task,
            nodes: first..part.nodes.len(),
            strips: strip..part.strips.len(),
            ends: end..part.ends.len(),
        });
        Ok(())
    }

    /// Puts the shapes of the leaves at their places, those of the first node.
    fn put(
        &self,
        nodes: &mut [Node],
        mut places: Places<'_, T>,
        strips: &mut Vec<Strips<T>>,
        ends: &mut Vec<u32>,
        scratch: &mut strips::Scratch,
    ) -> Result<()> {
        let mut pulse = Pulse::of(&self.stop);
        let before = nodes[0].start;
        for node in nodes.iter_mut().filter(|node| node.is_leaf()) {
            pulse.check(node.len())?;
            node.children = strips.len() as u32;
            let items = self.order.keyed[0].items(node.range());
            let from = (node.start - before) as usize;
            let to = places.some(from..from + node.len());
            let start = node.start as usize;
            let leaf = if self.in_strips {
                strips::arrange(self.shapes, items, start, to, ends, scratch)
            } else {
                strips::as_one(items, start, to, ends)
            };
            memory::push(strips, leaf)?;
        }
        Ok(())
    }

    /// Splits the nodes from the last one on until each holds `enough` shapes, or no
    /// more than a leaf may.
    fn split_all(&self, nodes: &mut Vec<Node>, enough: usize) -> Result<()> {
        T::with_widest(Grow { builder: self, nodes, enough })
    }

    #[inline(always)]
    fn split_here(&self, nodes: &mut Vec<Node>, enough: usize) -> Result<()> {
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
fn quarters<T>(keyed: &Keyed<T>, start: usize, end: usize, shift: u32) -> [usize; 4] {
    let before = if end - start > FEW {
        let first = keyed.key(start) >> shift & !3;
        let before = |quarter: u32| keyed.first_at_least((first | quarter) << shift) - start;
        [before(1), before(2), before(3)]
    } else {
        // Counting all is faster than searching: no step waits for the one before it.
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
        self.builder.split_here(self.nodes, self.enough)
    }
}

/// The covers of some nodes, as far as they are leaves.
struct CoverLeaves<'a, T> {
    columns: &'a Columns<T>,
    nodes: &'a [Node],
    covers: &'a mut [Cover<T>],
    pulse: Pulse,
}

impl<T: Scalar> Work<T> for CoverLeaves<'_, T> {
    type Out = ();

    #[inline(always)]
    fn run<S: Simd<T>>(mut self, simd: S) {
        for (node, cover) in self.nodes.iter().zip(self.covers) {
            if node.is_leaf() {
                if self.pulse.stops(node.len()) {
                    return;
                }
                *cover = cover_of_leaf(simd, self.columns, node);
            }
        }
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
