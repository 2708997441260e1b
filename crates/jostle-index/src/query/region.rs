//! Range queries: all shapes that overlap a region.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::frontier::{Frontier, GROUP};
use super::images::Images;
use super::window::Window;
use super::{NODE_WORK, QUERIES_PER_TASK, morton_order, worthwhile};
use crate::geometry::{Bounds, Scalar, Shape};
use crate::period::Period;
use crate::quadtree::{Node, Quadtree};
use crate::shapes::Each;
use jostle_base::error::{Error, Result};
use jostle_base::interrupt::{Pulse, Stop};
use jostle_base::memory;
use jostle_base::parallel;
use jostle_base::sorting;
use jostle_simd::{LANES, Simd, Work, first_lanes, for_each_lane};

/// Number of indices that are converted to rows between two checks for interruption.
const CHUNK: usize = 1 << 14;

/// The shapes of trees up to this size are not prefetched, because they fit into the second-level
/// cache.
const CACHED: usize = 1 << 15;

/// Maximum number of ids in one answer: 1 GiB of them.
pub const MAX_IDS: usize = 1 << 27;

/// A region of the plane. Programs may implement it for regions of their own.
pub trait Region<T>: Sync {
    /// Whether the region equals its window: true for rectangles and discs. Then shapes are tested
    /// with the window alone.
    const WINDOW_IS_EXACT: bool;
    /// Its bounds: each shape that touches the region touches the window.
    fn window(&self) -> Window<T>;
    /// Whether the shape overlaps the region, exactly.
    fn overlaps(&self, shape: &Shape<T>) -> bool;
    /// Whether the region certainly touches no shape within `bounds`; a conservative test after
    /// that of the window.
    fn misses(&self, bounds: &Bounds<T>) -> bool {
        let _ = bounds;
        false
    }
    /// The same region moved by `-shift`.
    fn moved(&self, shift: [T; 2]) -> Self
    where
        Self: Sized;
    /// The same region with its centre in the first period, up to rounding.
    fn wrapped(&self, period: &Period<T>) -> Self
    where
        Self: Sized,
        T: Scalar,
    {
        self.moved(period.turns(self.window().center()))
    }
    /// Refuses a region that is too large for a period.
    fn check_period(&self, index: usize, period: &Period<T>) -> Result<()> {
        let _ = (index, period);
        Ok(())
    }
}

/// Regions of one kind, as a trait object, so that the search is compiled once.
trait Regions<T>: Sync {
    /// [`Region::WINDOW_IS_EXACT`] of the kind.
    fn window_is_exact(&self) -> bool;
    /// [`Region::window`] of one of them.
    fn window(&self, index: u32) -> Window<T>;
    /// [`Region::overlaps`] of one of them.
    fn overlaps(&self, index: u32, shape: &Shape<T>) -> bool;
    /// [`Region::misses`] of one of them.
    fn misses(&self, index: u32, bounds: &Bounds<T>) -> bool;
}

impl<T, R: Region<T>> Regions<T> for &[R] {
    fn window_is_exact(&self) -> bool {
        R::WINDOW_IS_EXACT
    }
    fn window(&self, index: u32) -> Window<T> {
        self[index as usize].window()
    }
    fn overlaps(&self, index: u32, shape: &Shape<T>) -> bool {
        self[index as usize].overlaps(shape)
    }
    fn misses(&self, index: u32, bounds: &Bounds<T>) -> bool {
        self[index as usize].misses(bounds)
    }
}

/// The ids found by each of many queries, concatenated.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hits<I> {
    /// Query q has the ids `ids[offsets[q]..offsets[q + 1]]`.
    pub offsets: Vec<usize>,
    /// Ids, ascending for each query.
    pub ids: Vec<I>,
    /// Number of shapes that were tested.
    pub tests: u64,
}

impl<I> Hits<I> {
    /// No results yet, and memory for the offsets of `queries`.
    pub fn with_capacity(queries: usize) -> Result<Self> {
        let mut offsets = memory::with_capacity(queries + 1)?;
        offsets.push(0);
        Ok(Self { offsets, ids: Vec::new(), tests: 0 })
    }

    /// Removes an id from the results of each query; −1 removes none.
    pub fn exclude(&mut self, ids: &Each<i64>) -> Result<()>
    where
        I: Copy + Into<i64>,
    {
        ids.check_len("exclude", self.offsets.len() - 1)?;
        let mut kept = 0;
        for query in 0..self.offsets.len() - 1 {
            let (excluded, range) = (ids.at(query), self.offsets[query]..self.offsets[query + 1]);
            self.offsets[query] = kept;
            for index in range {
                if self.ids[index].into() != excluded {
                    self.ids[kept] = self.ids[index];
                    kept += 1;
                }
            }
        }
        self.ids.truncate(kept);
        if let Some(last) = self.offsets.last_mut() {
            *last = kept;
        }
        Ok(())
    }

    /// Ids of one query.
    pub fn of(&self, query: usize) -> &[I] {
        &self.ids[self.offsets[query]..self.offsets[query + 1]]
    }
}

/// Whether a query with a mask includes shapes of `category`.
#[inline(always)]
pub fn selects(mask: Option<u32>, category: u32) -> bool {
    mask.is_none_or(|mask| mask & category != 0)
}

/// The rows of all shapes that overlap each region, ascending. If there is a `mask`, only shapes
/// with a category in it.
pub fn search<T: Scalar, R: Region<T>>(
    tree: &Quadtree<T>,
    regions: &[R],
    mask: Option<u32>,
) -> Result<Hits<u32>> {
    let period = tree.period();
    if period.is_none() {
        return search_here(tree, regions, mask);
    }
    let images = Images::of(regions, &period, tree.bounds().first())?;
    images.combine(search_here(tree, &images.regions, mask)?)
}

/// As [`search`], without the images of a periodic plane.
pub fn search_here<T: Scalar, R: Region<T>>(
    tree: &Quadtree<T>,
    regions: &[R],
    mask: Option<u32>,
) -> Result<Hits<u32>> {
    // Sixteen consecutive queries share a frontier, so they should be near each other.
    let order = morton_order(regions.iter().map(|region| region.window().min))?;
    search_in_order(tree, &regions, &order, mask)
}

/// As [`search`]; `order` is the order in which the queries are processed.
fn search_in_order<T: Scalar>(
    tree: &Quadtree<T>,
    regions: &dyn Regions<T>,
    order: &[u32],
    mask: Option<u32>,
) -> Result<Hits<u32>> {
    let threads = worthwhile(tree.settings().threads, order.len());
    // The window is compared with bounding boxes. If cores are something else, the region decides.
    let exact = regions.window_is_exact() && !tree.columns().has_cores();
    let stop = Stop::current();
    let count = AtomicUsize::new(0);
    let parts: Vec<&[u32]> = order.chunks(QUERIES_PER_TASK).collect();
    let found = parallel::map(threads, parts.len(), |part| {
        let (order, pulse) = (parts[part], Pulse::of_task(&stop, part));
        T::with_widest(Search { tree, regions, exact, order, mask, count: &count, pulse, len: 0 })
    });
    let count = count.into_inner();
    // Checked once more here: the count may have passed the limit in the last group of each task.
    if count > MAX_IDS {
        return Err(Error::TooManyIds { limit: MAX_IDS });
    }
    // A failed part reports its own size, the error that of all parts.
    let sizes = found.iter().filter_map(|hits| hits.as_ref().err().map(Error::bytes));
    let bytes = sizes.max().unwrap_or(0).max(count * size_of::<u32>());
    let found = found.into_iter().collect::<Result<Vec<_>>>();
    combine(&parts, found.map_err(|error| error.in_all(bytes))?)
}

/// Combines the results of all tasks in the order of the queries.
fn combine(parts: &[&[u32]], mut found: Vec<Hits<u32>>) -> Result<Hits<u32>> {
    match found.len() {
        0 => return Hits::with_capacity(0),
        1 => return Ok(found.remove(0)),
        _ => {}
    }
    let mut pulse = Pulse::current();
    let queries = parts.iter().map(|part| part.len()).sum::<usize>();
    let answers = || parts.iter().zip(&found);
    let mut offsets = memory::filled(queries + 1, 0)?;
    for (part, hits) in answers() {
        for (index, &query) in part.iter().enumerate() {
            offsets[query as usize] = hits.of(index).len();
        }
    }
    sorting::prefix_sum(&mut offsets);
    let mut ids = memory::zeroed(offsets[queries])?;
    for (part, hits) in answers() {
        for (index, &query) in part.iter().enumerate() {
            pulse.check(1 + hits.of(index).len())?;
            let query = query as usize;
            ids[offsets[query]..offsets[query + 1]].copy_from_slice(hits.of(index));
        }
    }
    let tests = found.iter().map(|hits| hits.tests).sum();
    Ok(Hits { offsets, ids, tests })
}

/// The queries of one task.
struct Search<'a, T> {
    tree: &'a Quadtree<T>,
    regions: &'a dyn Regions<T>,
    exact: bool,
    order: &'a [u32],
    mask: Option<u32>,
    /// Number of ids found by all tasks.
    count: &'a AtomicUsize,
    pulse: Pulse,
    /// Number of ids found by this task; the list is longer.
    len: usize,
}

impl<T: Scalar> Work<T> for Search<'_, T> {
    type Out = Result<Hits<u32>>;

    #[inline(always)]
    fn run<S: Simd<T>>(mut self, simd: S) -> Result<Hits<u32>> {
        let mut hits = Hits::with_capacity(self.order.len())?;
        let (mut frontier, mut stack) = (Frontier::default(), Vec::new());
        let (mut ends, mut nodes) = (Vec::new(), Vec::new());
        // Ten thousand rectangles of eight points each among a million take 12.6 ms when each
        // descends from the root, 6.8 to 8.5 in Morton order, 7.0 with groups of sixteen and a
        // frontier of 48 nodes, and 5.6 with prefetching (docs/benchmarks-notes.md).
        for group in self.order.chunks(GROUP) {
            let windows = group.iter().map(|&query| self.regions.window(query));
            match windows.reduce(Window::join) {
                // There are too many ids already: the other queries are skipped.
                Some(_) if self.count.load(Ordering::Relaxed) > MAX_IDS => frontier.len = 0,
                // Two passes over a group. First the nodes of all sixteen queries are found, and
                // their shapes prefetched. Then the shapes are tested, which are in the cache by
                // then. With one pass a query waits for memory at each leaf.
                Some(window) => frontier.fill(self.tree, &window),
                None => {}
            }
            ends.clear();
            nodes.clear();
            for &query in group {
                self.find(simd, query, &frontier, &mut stack, &mut nodes)?;
                ends.push(nodes.len());
            }
            let (before, mut from) = (self.len, 0);
            for (&query, &end) in group.iter().zip(&ends) {
                self.answer(simd, query, &nodes[from..end], &mut hits).map_err(|error| {
                    let new = hits.offsets[hits.offsets.len() - 1] - before;
                    error.in_all((self.count.load(Ordering::Relaxed) + new) * size_of::<u32>())
                })?;
                from = end;
            }
            // Relaxed: the sum only decides whether to go on. Too late costs the ids of one group
            // for each thread.
            self.count.fetch_add(self.len - before, Ordering::Relaxed);
        }
        hits.ids.truncate(self.len);
        Ok(hits)
    }
}

impl<T: Scalar> Search<'_, T> {
    /// Appends the nodes with results of one query: leaves that it overlaps, and nodes whose shapes
    /// all overlap it. The search starts at the `frontier`.
    #[inline(always)]
    fn find<S: Simd<T>>(
        &mut self,
        simd: S,
        query: u32,
        frontier: &Frontier<T>,
        stack: &mut Vec<u32>,
        found: &mut Vec<u32>,
    ) -> Result<()> {
        let window = self.regions.window(query);
        for first in (0..frontier.len).step_by(LANES) {
            let bits = frontier.lanes(simd, &window, first) & first_lanes(frontier.len - first);
            for_each_lane(bits, |lane| {
                let node = frontier.nodes[first + lane];
                let bounds = &self.tree.bounds()[node as usize];
                if selects(self.mask, bounds.category) && !self.misses(query, bounds) {
                    stack.push(node);
                }
            });
        }
        while let Some(index) = stack.pop() {
            self.pulse.check(NODE_WORK)?;
            let node = &self.tree.nodes()[index as usize];
            // If the window contains all centres and is the region itself, every shape of the node
            // overlaps it. So the descent ends there: a large window costs as much as its border,
            // plus a copy of the indices inside.
            if node.is_leaf() || self.takes_all(&window, index as usize) {
                memory::push(found, index)?;
                self.prefetch(simd, node);
                continue;
            }
            for child in node.children() {
                let bounds = &self.tree.bounds()[child];
                let near = selects(self.mask, bounds.category) & window.may_touch(bounds);
                if near && !self.misses(query, bounds) {
                    stack.push(child as u32);
                }
            }
        }
        Ok(())
    }

    /// Prefetches the shapes of a leaf.
    #[inline(always)]
    fn prefetch<S: Simd<T>>(&self, simd: S, node: &Node) {
        // Below the limit the shapes are in the second-level cache already, and a prefetch is an
        // instruction more.
        if node.is_leaf() && self.tree.len() > CACHED {
            let shapes = self.tree.columns();
            simd.prefetch(&shapes.x[node.range()]);
            simd.prefetch(&shapes.y[node.range()]);
            simd.prefetch(&self.tree.rows()[node.range()]);
        }
    }

    /// Appends the results of one query, from the nodes that [`Search::find`] has found.
    #[inline(always)]
    fn answer<S: Simd<T>>(
        &mut self,
        simd: S,
        query: u32,
        nodes: &[u32],
        hits: &mut Hits<u32>,
    ) -> Result<()> {
        let start = self.len;
        let window = self.regions.window(query);
        for &node in nodes {
            let indices = self.tree.nodes()[node as usize].range();
            let spare = spare(&mut hits.ids, self.len, indices.len())?;
            if self.takes_all(&window, node as usize) {
                self.pulse.check(indices.len())?;
                self.len += indices.len();
                // Shapes are adjacent in the order of the tree, so a node that is taken whole is a
                // range of numbers.
                spare.iter_mut().zip(indices).for_each(|(to, index)| *to = index as u32);
            } else {
                hits.tests += indices.len() as u64;
                self.collect(simd, (query, &window), node as usize, spare)?;
            }
        }
        let (rows, found) = (self.tree.rows(), &mut hits.ids[start..self.len]);
        for indices in found.chunks_mut(CHUNK) {
            self.pulse.check(indices.len())?;
            indices.iter_mut().for_each(|index| *index = rows[*index as usize]);
        }
        // Ascending, so that the answer is the same as that of brute force and of any other tree.
        sort(found, &mut self.pulse)?;
        hits.offsets.push(self.len);
        Ok(())
    }

    /// [`Region::misses`]; not called if the window is exact.
    #[inline(always)]
    fn misses(&self, query: u32, bounds: &Bounds<T>) -> bool {
        !self.exact && self.regions.misses(query, bounds)
    }

    /// Whether every shape of a node overlaps the region. With a mask the shapes must be tested.
    #[inline(always)]
    fn takes_all(&self, window: &Window<T>, node: usize) -> bool {
        self.exact && self.mask.is_none() && window.contains(&self.tree.bounds()[node])
    }

    /// Writes the indices of the shapes of a leaf that overlap a region.
    #[inline(always)]
    fn collect<S: Simd<T>>(
        &mut self,
        simd: S,
        (query, window): (u32, &Window<T>),
        leaf: usize,
        spare: &mut [u32],
    ) -> Result<()> {
        let shapes = self.tree.columns();
        let indices = self.tree.nodes()[leaf].range();
        let round = self.tree.bounds()[leaf].radius > T::ZERO;
        let mut count = 0;
        for first in indices.clone().step_by(LANES) {
            self.pulse.check(LANES)?;
            let bits = window.lanes(simd, shapes, first, (round, self.exact));
            let mut bits = bits & first_lanes(indices.end - first);
            if !self.exact || self.mask.is_some() {
                for lane in 0..LANES {
                    if bits >> lane & 1 != 0 {
                        let shape = shapes.shape_if(first + lane, round);
                        let hit = selects(self.mask, shape.category)
                            && (self.exact || self.regions.overlaps(query, &shape));
                        bits ^= u32::from(!hit) << lane;
                    }
                }
            }
            let to = spare[count..].first_chunk_mut().expect("a block more is reserved");
            simd.pack_indices(first as u32, bits, to);
            count += bits.count_ones() as usize;
        }
        self.len += count;
        Ok(())
    }
}

/// Memory for `more` ids after the first `len`, and for a spare block.
#[inline(always)]
fn spare(ids: &mut Vec<u32>, len: usize, more: usize) -> Result<&mut [u32]> {
    let needed = len + more + LANES;
    if ids.len() < needed {
        memory::reserve(ids, needed - ids.len())?;
        // To the capacity at once, so that most calls find the length large enough.
        ids.resize(ids.capacity(), 0);
    }
    Ok(&mut ids[len..])
}

/// Sorts distinct numbers; up to [`LANES`] of them by counting smaller ones, without unpredictable
/// branches.
#[inline(always)]
fn sort(ids: &mut [u32], pulse: &mut Pulse) -> Result<()> {
    if ids.len() > LANES {
        return sorting::sort(ids, pulse);
    }
    let mut all = [0; LANES];
    all[..ids.len()].copy_from_slice(ids);
    let mut ranks = [0u32; LANES];
    // Each number adds one to the rank of all larger ones: sixteen comparisons at a time and no
    // branch. Numbers are distinct, so ranks are as well.
    for &id in &all[..ids.len()] {
        for (rank, other) in ranks.iter_mut().zip(&all) {
            *rank += u32::from(id < *other);
        }
    }
    for (id, rank) in all[..ids.len()].iter().zip(ranks) {
        ids[rank as usize] = *id;
    }
    Ok(())
}
