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

use std::cmp::Ordering;
use std::ops::Range;

pub use cells::TreeBox;

use crate::columns::Columns;
use crate::error::Result;
use crate::geometry::{Cover, Scalar, Shape};
use crate::parallel;
use crate::settings::Settings;
use crate::shapes::Shapes;

/// A box of the tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Node {
    start: u32,
    end: u32,
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

    /// Indices of its children.
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
    nodes: Vec<Node>,
    covers: Vec<Cover<T>>,
    order: order::Order,
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
        let threads = parallel::worthwhile(settings.threads, shapes.len());
        parallel::among(threads, || {
            self.rebuild(shapes, settings, &|a, b| compare_shapes(shapes, a, b))
        })
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
        self.settings = settings;
        let built = self.build(shapes, tie);
        if built.is_err() {
            self.clear();
        }
        built
    }

    fn build(&mut self, shapes: &Shapes<T>, tie: &order::Tie<'_>) -> Result<()> {
        let threads = parallel::worthwhile(self.settings.threads, shapes.len());
        self.order.sort(shapes, tie, threads)?;
        self.columns.gather(shapes, &self.order.rows, threads)?;
        let (nodes, covers) = (&mut self.nodes, &mut self.covers);
        build::nodes(&self.order, &self.columns, &self.settings, nodes, covers)
    }

    /// Forgets all shapes and keeps their memory.
    fn clear(&mut self) {
        self.columns.clear();
        self.order.clear();
        self.nodes.clear();
        self.covers.clear();
    }

    /// Bytes of memory that it keeps, used or not.
    pub fn kept_bytes(&self) -> usize {
        let nodes = self.nodes.capacity() * size_of::<Node>();
        let covers = self.covers.capacity() * size_of::<Cover<T>>();
        nodes + covers + self.columns.kept_bytes() + self.order.kept_bytes()
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
        &self.nodes
    }

    /// The covers, one for each node.
    pub fn covers(&self) -> &[Cover<T>] {
        &self.covers
    }

    /// The settings it was built with.
    pub fn settings(&self) -> Settings {
        self.settings
    }

    /// Number of leaves.
    pub fn leaf_count(&self) -> usize {
        self.nodes.iter().filter(|node| node.is_leaf()).count()
    }

    /// Subdivisions above the deepest node.
    pub fn depth(&self) -> usize {
        self.nodes.iter().map(|node| usize::from(node.depth)).max().unwrap_or(0)
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
