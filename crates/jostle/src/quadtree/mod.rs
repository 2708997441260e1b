//! The quadtree: shapes in Z-order, leaves as ranges of them.
//!
//! Each shape is stored once, at its centre; a shape may reach over the border
//! of its leaf's cell, and the node's [`Cover`] says how far. Nodes split into
//! four (empty quarters are left out) until they hold `leaf_capacity` shapes or
//! `max_depth` is reached. Runs of subdivisions that would leave everything in
//! one quarter are skipped, so depth and memory follow the number of shapes and
//! never the distances between them.

mod build;
mod cells;
mod check;
mod grid;
mod order;
mod sort;
mod strips;

use std::cmp::Ordering;
use std::ops::Range;

pub use cells::TreeBox;

use crate::columns::Columns;
use crate::error::Result;
use crate::geometry::{Cover, Scalar, Shape};
use crate::memory;
use crate::parallel;
use crate::settings::Settings;
use crate::shapes::Shapes;

/// A box of the tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Node {
    start: u32,
    end: u32,
    /// The first child; the strips of a leaf.
    children: u32,
    child_count: u8,
    /// Subdivisions of its grid above it.
    level: u8,
    /// Subdivisions above this node.
    pub depth: u16,
    /// Which entry of `Order::keyed` tells its shapes apart.
    grid: u32,
}

impl Node {
    /// Places of its shapes in the tree's order.
    pub fn range(&self) -> Range<usize> {
        self.start as usize..self.end as usize
    }

    /// Indices of its children; empty for a leaf.
    pub fn children(&self) -> Range<usize> {
        let first = self.children as usize;
        first..first + self.child_count as usize
    }

    /// Number of shapes in it.
    #[allow(clippy::len_without_is_empty, reason = "a node is never empty")]
    pub fn len(&self) -> usize {
        (self.end - self.start) as usize
    }

    /// Whether it did not split.
    pub fn is_leaf(&self) -> bool {
        self.child_count == 0
    }
}

/// A quadtree over shapes that do not change.
///
/// ```
/// use jostle::{Each, Quadtree, Settings, Shapes};
/// let discs = Shapes::circles(vec![[0.0, 0.0], [1.0, 0.0], [5.0, 0.0]], Each::One(0.6))?;
/// let tree = Quadtree::new(&discs, Settings::default())?;
/// let found = jostle::pairs::within(&tree, jostle::settings::DEFAULT_MAX_PAIRS)?;
/// assert_eq!(found.pairs.len(), 1);
/// # Ok::<(), jostle::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Quadtree<T> {
    columns: Columns<T>,
    built: build::Nodes<T>,
    order: order::Order<T>,
    settings: Settings,
}

impl<T: Scalar> Quadtree<T> {
    /// Builds the tree of `shapes`. Refuses settings that no tree can follow.
    pub fn new(shapes: &Shapes<T>, settings: Settings) -> Result<Self> {
        let mut tree = Self::default();
        tree.fill(shapes, settings)?;
        tree.order.forget_scratch();
        Ok(tree)
    }

    /// Builds the tree of `shapes` in the memory of this one.
    pub fn fill(&mut self, shapes: &Shapes<T>, settings: Settings) -> Result<()> {
        settings.validate()?;
        self.rebuild(shapes, settings, &|a, b| compare_shapes(shapes, a, b))
    }

    /// As [`Quadtree::fill`], in less time: the order of the shapes in a leaf depends on their rows
    /// too.
    pub fn fill_unordered(&mut self, shapes: &Shapes<T>, settings: Settings) -> Result<()> {
        settings.validate()?;
        self.build(shapes, settings, settings.leaf_capacity, &|_, _| Ordering::Equal)
    }

    /// Builds the tree anew in its old memory. `tie` orders rows whose centres
    /// coincide; the settings are taken as valid. Where it fails the tree is empty.
    pub fn rebuild(
        &mut self,
        shapes: &Shapes<T>,
        settings: Settings,
        tie: &order::Tie<'_>,
    ) -> Result<()> {
        let built = self.rebuild_unchecked(shapes, settings, tie);
        debug_assert!(self.len() > CHECKED || self.check() == Ok(()), "{:?}", self.check());
        built
    }

    /// As [`Quadtree::rebuild`], never checked.
    pub fn rebuild_unchecked(
        &mut self,
        shapes: &Shapes<T>,
        settings: Settings,
        tie: &order::Tie<'_>,
    ) -> Result<()> {
        self.build(shapes, settings, 0, tie)
    }

    /// Groups of at most `unsorted` shapes in a leaf may stay in the order of their rows.
    fn build(
        &mut self,
        shapes: &Shapes<T>,
        settings: Settings,
        unsorted: usize,
        tie: &order::Tie<'_>,
    ) -> Result<()> {
        self.settings = settings;
        let threads = parallel::worthwhile(settings.threads, shapes.len());
        let built = self.build_here(shapes, unsorted, tie, threads);
        if built.is_err() {
            self.clear();
        }
        built
    }

    fn build_here(
        &mut self,
        shapes: &Shapes<T>,
        unsorted: usize,
        tie: &order::Tie<'_>,
        threads: Option<usize>,
    ) -> Result<()> {
        let settings = Settings { threads, ..self.settings };
        self.order.sort(shapes, tie, unsorted, threads)?;
        let mut rows = std::mem::take(&mut self.order.rows);
        memory::resize(&mut rows, shapes.len(), 0)?;
        let [x, y] = self.columns.places(shapes.len())?;
        let places = strips::Places { rows: &mut rows, x, y };
        let grown = self.built.grow(&self.order, shapes, places, &settings, unsorted > 0);
        self.order.rows = rows;
        grown?;
        self.columns.fill_rest(shapes, &self.order.rows, threads)?;
        self.built.cover(&self.columns, &settings)
    }

    /// Forgets all shapes and keeps their memory.
    fn clear(&mut self) {
        self.columns.clear();
        self.order.clear();
        self.built.clear();
    }

    /// Bytes of memory that it keeps, used or not.
    pub fn kept_bytes(&self) -> usize {
        self.built.kept_bytes() + self.columns.kept_bytes() + self.order.kept_bytes()
    }

    /// Number of shapes.
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Whether there is no shape.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// The shapes in the tree's order.
    pub fn columns(&self) -> &Columns<T> {
        &self.columns
    }

    /// `rows()[place]` is the caller's row of the shape at `place`.
    pub fn rows(&self) -> &[u32] {
        &self.order.rows
    }

    /// The nodes, parents before children. Empty where there is no shape.
    pub fn nodes(&self) -> &[Node] {
        &self.built.nodes
    }

    /// The covers, one for each node.
    pub fn covers(&self) -> &[Cover<T>] {
        &self.built.covers
    }

    /// For each strip of a leaf: its places, and where the last strip ends that it can reach.
    #[inline(always)]
    pub fn strips(&self, leaf: &Node) -> impl Iterator<Item = (Range<usize>, usize)> {
        let strips = &self.built.strips[leaf.children as usize];
        let ends = &self.built.ends[strips.ends()];
        let mut start = leaf.start as usize;
        ends.iter().enumerate().map(move |(strip, &end)| {
            let places = start..end as usize;
            start = end as usize;
            (places, ends[strips.last_reached(strip)] as usize)
        })
    }

    /// Places of the shapes of a leaf, at least of those that could overlap a shape under `cover`.
    #[inline(always)]
    pub fn places_near(&self, leaf: usize, cover: &Cover<T>) -> Range<usize> {
        let (node, own) = (&self.nodes()[leaf], &self.covers()[leaf]);
        let strips = &self.built.strips[node.children as usize];
        strips.places(&self.built.ends, node.range(), own, cover)
    }

    /// The settings it was built with.
    pub fn settings(&self) -> Settings {
        self.settings
    }

    /// Number of leaves.
    pub fn leaf_count(&self) -> usize {
        self.nodes().iter().filter(|node| node.is_leaf()).count()
    }

    /// Subdivisions above the deepest node.
    pub fn depth(&self) -> usize {
        self.nodes().iter().map(|node| usize::from(node.depth)).max().unwrap_or(0)
    }
}

/// Trees up to this size are checked after every build where debug assertions are on.
const CHECKED: usize = 500;

/// Orders shapes with coincident centres by everything else about them.
fn compare_shapes<T: Scalar>(shapes: &Shapes<T>, a: usize, b: usize) -> Ordering {
    let (a, b) = (shapes.shape(a), shapes.shape(b));
    let sizes = |Shape { min, max, half_size, radius, .. }: &Shape<T>| {
        [*radius, half_size[0], half_size[1], min[0], min[1], max[0], max[1]]
    };
    let pairs = sizes(&a).into_iter().zip(sizes(&b));
    let by_size = pairs.map(|(a, b)| a.total_order(&b)).find(|order| order.is_ne());
    by_size.unwrap_or(Ordering::Equal).then_with(|| (a.category, a.mask).cmp(&(b.category, b.mask)))
}
