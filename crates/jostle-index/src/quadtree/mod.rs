//! The quadtree: shapes in Morton order; each node is a range of them.
//!
//! Each shape is stored once, in the leaf that contains its centre. A shape may extend beyond
//! the cell of its leaf; the [`Bounds`] of a node contain its shapes. Nodes are split into four,
//! without empty quarters, until they have at most `leaf_capacity` shapes or are at `max_depth`.
//! Subdivisions with all shapes in one quarter are skipped (path compression), so depth and
//! memory depend on the number of shapes and not on the distances between them.
//!
//! H. Samet, *Foundations of Multidimensional and Metric Data Structures* (2006), chapter 1.4.
//! T. Karras, *Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees*, High
//! Performance Graphics (2012): construction from sorted Morton keys.

mod build;
mod cells;
mod check;
mod grid;
mod order;
pub(crate) mod partition;
mod sort;
mod strips;
mod subtrees;

use std::cmp::Ordering;
use std::ops::Range;

pub use cells::TreeBox;
pub use grid::nearest_integer;
pub use order::extent_of;

use crate::columns::Columns;
use crate::geometry::{Bounds, Scalar, Shape};
use crate::period::Period;
use crate::shapes::{Shapes, half_of};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_base::parallel;
use jostle_base::settings::Settings;

/// A node of the tree: a range of shapes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Node {
    start: u32,
    end: u32,
    /// Index of the first child; for a leaf, index of its strips.
    children: u32,
    child_count: u8,
    /// Subdivisions above this node in its grid.
    level: u8,
    /// Subdivisions above this node.
    pub depth: u16,
    /// Index of the entry of `Order::keyed` with the keys of its shapes.
    grid: u32,
}

impl Node {
    /// Its shapes, as indices in Morton order.
    pub fn range(&self) -> Range<usize> {
        self.start as usize..self.end as usize
    }

    /// Indices of its children; empty for a leaf.
    pub fn children(&self) -> Range<usize> {
        let first = self.children as usize;
        first..first + self.child_count as usize
    }

    /// Number of its shapes.
    #[allow(clippy::len_without_is_empty, reason = "a node is never empty")]
    pub fn len(&self) -> usize {
        (self.end - self.start) as usize
    }

    /// Whether it has no children.
    pub fn is_leaf(&self) -> bool {
        self.child_count == 0
    }
}

/// A quadtree over shapes that do not change.
///
/// ```
/// # mod jostle {
/// #     pub use jostle_base::{error::Error, settings::Settings};
/// #     pub use jostle_index::query::{Rect, search};
/// #     pub use jostle_index::{Each, Quadtree, Shapes};
/// # }
/// use jostle::{Each, Quadtree, Rect, Settings, Shapes, search};
/// let discs = Shapes::circles(vec![[0.0, 0.0], [1.0, 0.0], [5.0, 0.0]], Each::One(0.6))?;
/// let tree = Quadtree::new(&discs, Settings::default())?;
/// let rects = Rect::all(&[[1.5, -1.0, 4.0, 1.0]])?;
/// assert_eq!(search(&tree, &rects, None)?.of(0), [1]);
/// # Ok::<(), jostle::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Quadtree<T> {
    columns: Columns<T>,
    built: build::Nodes<T>,
    order: order::Order<T>,
    settings: Settings,
    period: Period<T>,
}

impl<T: Scalar> Quadtree<T> {
    /// Builds the tree of `shapes`. Refuses invalid settings.
    pub fn new(shapes: &Shapes<T>, settings: Settings) -> Result<Self> {
        let mut tree = Self::default();
        tree.fill(shapes, settings)?;
        tree.order.free_scratch();
        Ok(tree)
    }

    /// Replaces this tree by that of `shapes`, reusing its memory.
    pub fn fill(&mut self, shapes: &Shapes<T>, settings: Settings) -> Result<()> {
        settings.validate()?;
        self.rebuild(shapes, settings, &|a, b| compare_shapes(shapes, a, b))
    }

    /// As [`Quadtree::fill`] and faster, but the order of the shapes in a leaf depends on their
    /// rows too.
    pub fn fill_unordered(&mut self, shapes: &Shapes<T>, settings: Settings) -> Result<()> {
        settings.validate()?;
        self.build(shapes, settings, settings.leaf_capacity, &|_, _| Ordering::Equal)
    }

    /// Rebuilds the tree in its memory. `tie` compares rows whose centres coincide; the settings
    /// must be valid. After an error the tree is empty.
    pub fn rebuild(
        &mut self,
        shapes: &Shapes<T>,
        settings: Settings,
        tie: &order::Tie<'_>,
    ) -> Result<()> {
        let built = self.rebuild_unchecked(shapes, settings, tie);
        // The check takes longer than the build, so trees of long tests would make them too slow.
        debug_assert!(self.len() > CHECKED || self.check() == Ok(()), "{:?}", self.check());
        built
    }

    /// Lets later builds order the shapes as among others whose centres are within an AABB.
    pub fn set_extent(&mut self, extent: Option<[[T; 2]; 2]>) {
        self.order.extent = extent;
    }

    /// The AABB of the grid, if it is given.
    pub fn extent(&self) -> Option<[[T; 2]; 2]> {
        self.order.extent
    }

    /// Lets later builds order two shapes by their centres alone, whatever others there are.
    pub fn set_nested(&mut self) {
        self.order.is_nested = true;
    }

    /// As [`Quadtree::rebuild`], without a check of the invariants in debug builds.
    pub fn rebuild_unchecked(
        &mut self,
        shapes: &Shapes<T>,
        settings: Settings,
        tie: &order::Tie<'_>,
    ) -> Result<()> {
        self.build(shapes, settings, 0, tie)
    }

    /// Groups of at most `unsorted` shapes, which fit into a leaf, may be in the order of their
    /// rows.
    fn build(
        &mut self,
        shapes: &Shapes<T>,
        settings: Settings,
        unsorted: usize,
        tie: &order::Tie<'_>,
    ) -> Result<()> {
        self.settings = settings;
        self.period = shapes.period;
        let threads = parallel::worthwhile(settings.threads, shapes.len());
        // The upper nodes and the joining of subtrees use one thread. Without this the others could
        // fall asleep meanwhile, and each stage after it would have to wake them.
        let _awake = parallel::keep_awake(threads, shapes.len(), parallel::WORTH_WAKING);
        let built = self.build_here(shapes, unsorted, tie, threads);
        // Half of a tree could have ranges beyond the columns. An empty one answers every query.
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
        // The stages and what each hands on:
        //
        // 1. The order: rows and centres sorted by Morton key, as far as a leaf needs it. After it
        // a node of the tree is a range of indices, and nothing is moved between nodes.
        //
        // 2. Nodes: each is split where the keys of its range change. Leaves sort their shapes into
        // strips and write rows and centres to the columns, so both are read once.
        //
        // 3. The other columns are gathered by row.
        //
        // 4. Bounds, from the leaves up. They need the columns, not the keys.
        //
        // Canonical order: the order comes from the keys, the coordinates and `tie`, so a
        // permutation of the input permutes `rows` and changes nothing else. The tree is the same
        // for each number of threads, because every division of work depends on the number of
        // shapes alone.
        let settings = Settings { threads, ..self.settings };
        self.order.sort(shapes, tie, unsorted, threads)?;
        // Taken out, because the leaves write the rows while they read the keys of the same order.
        let mut rows = std::mem::take(&mut self.order.rows);
        memory::resize(&mut rows, shapes.len(), 0)?;
        let [x, y] = self.columns.centers_mut(shapes.len())?;
        let outputs = strips::Outputs { rows: &mut rows, x, y };
        // Strips change the order within a leaf, so only a caller that allows unsorted groups gets
        // them. The others need the Morton order in the leaves too.
        let built = self.built.build(&self.order, shapes, outputs, &settings, unsorted > 0);
        self.order.rows = rows;
        built?;
        self.columns.fill_rest(shapes, &self.order.rows, threads)?;
        self.built.compute_bounds(&self.columns, &settings)
    }

    /// Removes all shapes and keeps their memory.
    fn clear(&mut self) {
        self.columns.clear();
        self.order.clear();
        self.built.clear();
    }

    /// Allocated bytes, used or not.
    pub fn memory_bytes(&self) -> usize {
        self.built.memory_bytes() + self.columns.memory_bytes() + self.order.memory_bytes()
    }

    /// Number of shapes.
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Whether there is no shape.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// The shapes in Morton order.
    pub fn columns(&self) -> &Columns<T> {
        &self.columns
    }

    /// `rows()[index]` is the caller's row of the shape at `index` in Morton order.
    pub fn rows(&self) -> &[u32] {
        &self.order.rows
    }

    /// The nodes, parents before children. Empty if there is no shape.
    pub fn nodes(&self) -> &[Node] {
        &self.built.nodes
    }

    /// The bounds, one for each node.
    pub fn bounds(&self) -> &[Bounds<T>] {
        &self.built.bounds
    }

    /// For each strip of a leaf: its indices, and the end of the last strip with shapes that its
    /// own shapes could overlap.
    #[inline(always)]
    pub fn strips(&self, leaf: &Node) -> impl Iterator<Item = (Range<usize>, usize)> {
        // A leaf has no children, so the field holds the index of its strips instead.
        let strips = &self.built.strips[leaf.children as usize];
        let ends = &self.built.ends[strips.ends()];
        let mut start = leaf.start as usize;
        // Only strips after the own one: a pair is found from the lower of its two strips, so from
        // one side only.
        ends.iter().enumerate().map(move |(strip, &end)| {
            let indices = start..end as usize;
            start = end as usize;
            (indices, ends[strips.last_reached(strip)] as usize)
        })
    }

    /// A range of indices of a leaf that contains all shapes that could overlap a shape within
    /// `bounds`.
    #[inline(always)]
    pub fn indices_near(&self, leaf: usize, bounds: &Bounds<T>) -> Range<usize> {
        let (node, own) = (&self.nodes()[leaf], &self.bounds()[leaf]);
        let strips = &self.built.strips[node.children as usize];
        strips.indices(&self.built.ends, node.range(), own, bounds)
    }

    /// The settings with which it was built.
    pub fn settings(&self) -> Settings {
        self.settings
    }

    /// The period of the plane; none unless its shapes have one.
    #[inline(always)]
    pub fn period(&self) -> Period<T> {
        self.period
    }

    /// A copy in which the radii are larger by half of `distance`, so that two shapes overlap if
    /// the gap between them was less than that. Refuses a distance that is out of range.
    pub fn grown(&self, distance: T) -> Result<Self> {
        let by = half_of(distance)?;
        let mut grown = Self {
            columns: self.columns.copied()?,
            built: self.built.copied()?,
            order: order::Order::of_rows(memory::collect(self.rows().iter().copied())?),
            settings: self.settings,
            period: self.period,
        };
        // Only radii change, and by the same number. So the order, the nodes and which shapes they
        // have stay as they are. A copy costs far less than a new tree.
        grown.columns.grow(by);
        grown.built.grow(by);
        Ok(grown)
    }

    /// Number of leaves.
    pub fn leaf_count(&self) -> usize {
        self.nodes().iter().filter(|node| node.is_leaf()).count()
    }

    /// The depth of the deepest node.
    pub fn depth(&self) -> usize {
        self.nodes().iter().map(|node| usize::from(node.depth)).max().unwrap_or(0)
    }
}

/// Debug builds check the invariants of trees up to this number of shapes after each build.
const CHECKED: usize = 500;

/// Compares shapes with coincident centres by all their other values.
fn compare_shapes<T: Scalar>(shapes: &Shapes<T>, a: usize, b: usize) -> Ordering {
    let (a, b) = (shapes.shape(a), shapes.shape(b));
    // All values that can make two shapes with one centre differ. Shapes that are equal in all of
    // them may be exchanged without any effect, so they may stay in the order of their rows.
    let sizes = |Shape { min, max, half_size, radius, .. }: &Shape<T>| {
        [*radius, half_size[0], half_size[1], min[0], min[1], max[0], max[1]]
    };
    let pairs = sizes(&a).into_iter().zip(sizes(&b));
    let by_size = pairs.map(|(a, b)| a.total_order(&b)).find(|order| order.is_ne());
    let bits = |shape: &Shape<T>| (shape.category, shape.mask, shape.core);
    by_size.unwrap_or(Ordering::Equal).then_with(|| bits(&a).cmp(&bits(&b)))
}
