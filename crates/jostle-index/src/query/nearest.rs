//! The k nearest neighbours of a point.
//!
//! N. Roussopoulos, S. Kelley and F. Vincent, *Nearest Neighbor Queries*, SIGMOD (1995):
//! depth-first branch and bound.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::mem;
use std::ops::Range;

use super::region::{MAX_IDS, selects};
use super::{IdOf, NODE_WORK, QUERIES_PER_TASK, check_max_distances, morton_order, worthwhile};
use crate::columns::Columns;
use crate::geometry::{
    Bounds, Core, Difference, Scalar, Shape, gap, lanes, length, square_of_gaps,
};
use crate::period::Period;
use crate::quadtree::Quadtree;
use crate::shapes::{Each, check_finite};
use jostle_base::error::{Error, Result};
use jostle_base::interrupt::{Pulse, Stop};
use jostle_base::memory;
use jostle_base::parallel;
use jostle_base::sorting::{self, Bytes};
use jostle_simd::{LANES, Simd, Work, block, first_lanes, for_each_lane};

/// The distance of a point from the surface of a shape; 0 inside.
#[inline(always)]
pub fn distance<T: Scalar>(point: [T; 2], shape: &Shape<T>) -> T {
    Origin { images: point.map(|at| [at; 3]) }.distance::<false>(shape)
}

/// As [`distance`], to the nearest image in a periodic plane.
pub fn distance_in<T: Scalar>(period: &Period<T>, point: [T; 2], shape: &Shape<T>) -> T {
    if period.is_none() {
        return distance(point, shape);
    }
    Origin::at(point, period).distance::<true>(shape)
}

/// The point of a search, with its images along each axis.
#[derive(Clone, Copy)]
struct Origin<T> {
    images: [[T; 3]; 2],
}

impl<T: Scalar> Origin<T> {
    fn at(point: [T; 2], period: &Period<T>) -> Self {
        let point = period.wrap(point);
        Self { images: [0, 1].map(|axis| period.images_along(axis, point[axis])) }
    }

    /// The gaps along each axis between the nearest image, in a periodic plane, and cores from
    /// `min` to `max`, extended by `half_size`; negative inside.
    #[inline(always)]
    fn gaps<const PERIODIC: bool>(&self, [min, max]: [[T; 2]; 2], half_size: [T; 2]) -> [T; 2] {
        let mut gaps = [T::ZERO; 2];
        for axis in 0..2 {
            let images = self.images[axis];
            let core = [min[axis], max[axis]];
            let mut nearest = gap([images[0]; 2], core);
            if PERIODIC {
                nearest = nearest.min(gap([images[1]; 2], core)).min(gap([images[2]; 2], core));
            }
            gaps[axis] = nearest - half_size[axis];
        }
        gaps
    }

    /// The distance from the surface of a shape; 0 inside.
    #[inline(always)]
    fn distance<const PERIODIC: bool>(&self, shape: &Shape<T>) -> T {
        let [x, y] = self.gaps::<PERIODIC>([shape.min, shape.max], shape.half_size);
        let mut from_core = length(x.max(T::ZERO), y.max(T::ZERO));
        if shape.is_slanted() {
            // Never below that of the box, by which nodes and blocks are left out.
            from_core = from_core.max(self.distance_of_line::<PERIODIC>(shape));
        }
        (from_core - shape.radius).max(T::ZERO)
    }

    /// The distance from a slanted core.
    fn distance_of_line<const PERIODIC: bool>(&self, shape: &Shape<T>) -> T {
        let [along_x, along_y] = self.images;
        let count = if PERIODIC { 3 } else { 1 };
        let images = along_y.into_iter().take(count);
        let images = images.flat_map(|y| along_x.into_iter().take(count).map(move |x| [x, y]));
        let distance = |point: [T; 2]| {
            let half_size = [T::ZERO; 2];
            let point = Shape { min: point, max: point, half_size, core: Core::Box, ..*shape };
            Difference::of(&point, shape).distance()
        };
        images.map(distance).fold(T::INFINITY, T::min)
    }

    /// A lower bound of the squared distance to the cores of the shapes within `bounds`.
    #[inline(always)]
    fn min_square<const PERIODIC: bool>(&self, bounds: &Bounds<T>) -> T {
        square_of_gaps(self.gaps::<PERIODIC>([bounds.min, bounds.max], bounds.half_size))
    }
}

/// An upper bound of the square of `distance`: it is at least the rounded square of each distance
/// up to `distance`, also in case of underflow.
#[inline(always)]
fn max_square<T: Scalar>(distance: T) -> T {
    // Squares are compared because a square root for each node takes too long. The two sides are
    // rounded in different ways, so this one is enlarged by more than all roundings, and nothing at
    // exactly the limit is lost. The added constant is for squares that vanish.
    let distance = distance * slack();
    distance * distance + T::SMALLEST_SQUARE
}

/// A factor larger than the relative rounding errors of both squares.
#[inline(always)]
fn slack<T: Scalar>() -> T {
    T::ONE + T::from_f64(16.0) * T::EPSILON
}

/// A shape and its distance. Ordered by distance, then by id.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Neighbor<T> {
    distance: T,
    id: u64,
}

impl<T: Scalar> Eq for Neighbor<T> {}

impl<T: Scalar> PartialOrd for Neighbor<T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<T: Scalar> Ord for Neighbor<T> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.distance.total_order(&other.distance).then(self.id.cmp(&other.id))
    }
}

impl<T: Scalar> Bytes for Neighbor<T> {
    const COUNT: usize = 16;

    #[inline(always)]
    fn byte(&self, at: usize) -> u8 {
        // A distance is at least 0, or −0.
        let distance = self.distance.to_f64().to_bits() as i64;
        // The bits of floats are in the order of their values, except that those of negative ones
        // are descending.
        let signed = if distance < 0 { !distance ^ i64::MIN } else { distance };
        if at < 8 { signed.byte(at) } else { (self.id >> (120 - 8 * at)) as u8 }
    }
}

/// The nearest shapes found so far.
#[derive(Clone, Debug)]
pub struct Nearest<T> {
    k: usize,
    /// Shapes farther than this are ignored.
    bound: T,
    /// A max-heap: the farthest is on top.
    found: BinaryHeap<Neighbor<T>>,
    /// Nodes to visit, with [`min_square`].
    stack: Vec<(T, u32)>,
    pulse: Pulse,
    failed: Option<Error>,
    /// Number of shapes that were tested.
    pub tests: u64,
}

impl<T: Scalar> Nearest<T> {
    /// For searches for the `k` nearest shapes; `pulse` may interrupt them.
    fn new(k: usize, pulse: Pulse) -> Self {
        let (found, stack) = (BinaryHeap::new(), Vec::with_capacity(64));
        Self { k, bound: T::ZERO, found, stack, pulse, failed: None, tests: 0 }
    }

    /// The distance beyond which shapes are ignored.
    #[inline(always)]
    fn limit(&self) -> T {
        match self.found.peek() {
            // With k shapes found only nearer ones count. At the same distance a smaller id still
            // does, so nodes at exactly the limit are visited.
            Some(last) if self.found.len() >= self.k => last.distance,
            _ => self.bound,
        }
    }

    /// Adds a shape if it is one of the nearest.
    #[inline(always)]
    pub fn offer(&mut self, distance: T, id: u64) {
        let new = Neighbor { distance, id };
        if self.found.len() < self.k {
            // Equal to the bound counts: the bound may be the distance of a shape that has to be
            // found.
            if distance <= self.bound && self.has_room() {
                self.found.push(new);
            }
        } else if let Some(mut last) = self.found.peek_mut()
            && new < *last
        {
            *last = new;
        }
    }

    /// Whether there is memory for one more shape.
    #[inline(always)]
    fn has_room(&mut self) -> bool {
        self.found.len() < self.found.capacity() || self.grow()
    }

    #[cold]
    fn grow(&mut self) -> bool {
        let len = self.found.len();
        // Doubled, but not beyond k: with a huge k and few shapes nothing is reserved that is not
        // used.
        let grown = self.found.try_reserve(1 + len.min(self.k - len - 1));
        let grown = grown
            .and_then(|()| memory::check_margin::<Neighbor<T>>(self.found.capacity()))
            .map_err(|error| {
                self.found.shrink_to(len);
                memory::no_memory::<Neighbor<T>>(&error, (2 * len).max(4))
            });
        self.failed = self.failed.take().or(grown.err());
        self.failed.is_none()
    }

    /// Whether to stop; `work` is the approximate number of values read since the last call.
    #[inline(always)]
    pub fn is_over(&mut self, work: usize) -> bool {
        if self.pulse.stops(work) && self.failed.is_none() {
            self.failed = Some(Error::Interrupted);
        }
        self.failed.is_some()
    }

    /// Appends the shapes found to `neighbors`, nearest first, and clears the heap.
    fn move_to(&mut self, neighbors: &mut Vec<Neighbor<T>>) -> Result<()> {
        if let Some(error) = self.failed.take() {
            return Err(error);
        }
        let mut found = mem::take(&mut self.found).into_vec();
        // Not `into_sorted_vec` of the heap: k may be millions, and this sort can be interrupted.
        sorting::sort(&mut found, &mut self.pulse)?;
        memory::reserve(neighbors, found.len())?;
        neighbors.append(&mut found);
        self.found = found.into();
        Ok(())
    }

    /// Searches a tree.
    pub fn search(
        &mut self,
        tree: &Quadtree<T>,
        point: [T; 2],
        mask: Option<u32>,
        id_of: &IdOf<'_>,
    ) {
        self.search_in(&tree.period(), tree, point, mask, id_of);
    }

    /// Searches a tree in a periodic plane. The centres of its shapes are in the first period.
    pub fn search_in(
        &mut self,
        period: &Period<T>,
        tree: &Quadtree<T>,
        point: [T; 2],
        mask: Option<u32>,
        id_of: &IdOf<'_>,
    ) {
        let origin = Origin::at(point, period);
        if period.is_none() {
            T::with_widest(Search::<T, false> { tree, origin, mask, id_of, best: self });
        } else {
            T::with_widest(Search::<T, true> { tree, origin, mask, id_of, best: self });
        }
    }
}

/// One search through one tree.
struct Search<'a, T, const PERIODIC: bool> {
    tree: &'a Quadtree<T>,
    origin: Origin<T>,
    mask: Option<u32>,
    id_of: &'a IdOf<'a>,
    best: &'a mut Nearest<T>,
}

impl<T: Scalar, const PERIODIC: bool> Work<T> for Search<'_, T, PERIODIC> {
    type Out = ();

    /// Depth first, the nearest child first. Nodes on the stack may be beyond the limit when they
    /// are visited.
    #[inline(always)]
    fn run<S: Simd<T>>(mut self, simd: S) {
        let (nodes, node_bounds) = (self.tree.nodes(), self.tree.bounds());
        let Some(root) = node_bounds.first().filter(|root| selects(self.mask, root.category))
        else {
            return;
        };
        let mut stack = mem::take(&mut self.best.stack);
        stack.clear();
        stack.push((self.origin.min_square::<PERIODIC>(root), 0));
        while let Some((square, index)) = stack.pop() {
            let radius = node_bounds[index as usize].radius;
            // Tested again: nearer shapes may have been found since the node was pushed. `radius`
            // is on this side, because the squares are those of distances to cores.
            if square > max_square(self.best.limit() + radius) {
                continue;
            }
            if self.best.is_over(NODE_WORK) {
                break;
            }
            let node = &nodes[index as usize];
            if node.is_leaf() {
                self.leaf(simd, node.range(), radius > T::ZERO);
                continue;
            }
            let (from, limit) = (stack.len(), self.best.limit());
            for child in node.children() {
                let bounds = &node_bounds[child];
                let square = self.origin.min_square::<PERIODIC>(bounds);
                if square <= max_square(limit + bounds.radius)
                    && selects(self.mask, bounds.category)
                {
                    stack.push((square, child as u32));
                }
            }
            // The nearest child is visited first and lowers the limit for the others. With the
            // children of one node sorted, a search leaves out most of the tree without a priority
            // queue over all nodes.
            sort_farthest_first(&mut stack[from..]);
        }
        self.best.stack = stack;
    }
}

/// Sorts at most four nodes, so that the nearest is on top of the stack.
#[inline(always)]
pub(super) fn sort_farthest_first<T: Scalar>(nodes: &mut [(T, u32)]) {
    for end in 1..nodes.len() {
        for index in (1..=end).rev() {
            if nodes[index].0 <= nodes[index - 1].0 {
                break;
            }
            nodes.swap(index, index - 1);
        }
    }
}

impl<T: Scalar, const PERIODIC: bool> Search<'_, T, PERIODIC> {
    #[inline(always)]
    fn leaf<S: Simd<T>>(&mut self, simd: S, indices: Range<usize>, round: bool) {
        let shapes = self.tree.columns();
        self.best.tests += indices.len() as u64;
        for first in indices.clone().step_by(LANES) {
            if self.best.is_over(LANES) {
                return;
            }
            let limit = self.best.limit();
            let origin = &self.origin;
            // A conservative test of sixteen shapes; the few that pass get their exact distance in
            // scalar code.
            let near = within::<T, S, PERIODIC>(simd, origin, limit, (shapes, round), first);
            for_each_lane(near & first_lanes(indices.end - first), |lane| {
                let shape = shapes.shape_if(first + lane, round);
                if selects(self.mask, shape.category)
                    && let Some(id) = (self.id_of)(first + lane)
                {
                    self.best.offer(self.origin.distance::<PERIODIC>(&shape), id);
                }
            });
        }
    }
}

/// A bit for each shape of a block whose distance could be at most `limit`, by [`max_square`].
#[inline(always)]
fn within<T: Scalar, S: Simd<T>, const PERIODIC: bool>(
    simd: S,
    origin: &Origin<T>,
    limit: T,
    (shapes, round): (&Columns<T>, bool),
    first: usize,
) -> u32 {
    let [along_x, along_y] = origin.images;
    let columns_x: [&[T]; 3] = [&shapes.x, &shapes.max_x, &shapes.half_x];
    let columns_y: [&[T]; 3] = [&shapes.y, &shapes.max_y, &shapes.half_y];
    let x = core_gap::<T, S, PERIODIC>(simd, along_x, columns_x, first);
    let y = core_gap::<T, S, PERIODIC>(simd, along_y, columns_y, first);
    let mut distance = simd.splat(limit);
    if round {
        distance = simd.add(distance, simd.load(block(&shapes.radius, first)));
    }
    let distance = simd.mul(distance, simd.splat(slack()));
    let max_square = simd.add(simd.mul(distance, distance), simd.splat(T::SMALLEST_SQUARE));
    // Negated, so that NaN passes and is decided by the exact distance.
    !simd.less(max_square, lanes::square(simd, [x, y]))
}

/// The gaps between a point and the cores of a block along one axis, at least 0; in a periodic
/// plane those of the nearest of its images.
#[inline(always)]
fn core_gap<T: Scalar, S: Simd<T>, const PERIODIC: bool>(
    simd: S,
    images: [T; 3],
    [min, max, half_sizes]: [&[T]; 3],
    first: usize,
) -> S::Block {
    let mut gap = gap_to(simd, images[0], [min, max], first);
    if PERIODIC {
        gap = simd.min(gap, gap_to(simd, images[1], [min, max], first));
        gap = simd.min(gap, gap_to(simd, images[2], [min, max], first));
    }
    if max.is_empty() && half_sizes.is_empty() {
        return gap;
    }
    if !half_sizes.is_empty() {
        gap = simd.sub(gap, simd.load(block(half_sizes, first)));
    }
    simd.max(gap, simd.splat(T::ZERO))
}

/// The gaps between a coordinate and the intervals of a block; half sizes are not subtracted.
#[inline(always)]
fn gap_to<T: Scalar, S: Simd<T>>(simd: S, at: T, [min, max]: [&[T]; 2], first: usize) -> S::Block {
    let min = simd.load(block(min, first));
    if max.is_empty() {
        return simd.distance(min, simd.splat(at));
    }
    lanes::gap(simd, [at; 2], [min, simd.load(block(max, first))])
}

/// Distances and ids of the nearest shapes, `k` for each point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Neighbors<T> {
    /// Distances, nearest first; infinity if there are fewer.
    pub distances: Vec<T>,
    /// Ids of the shapes; −1 if there are fewer.
    pub ids: Vec<i64>,
    /// Number of shapes that were tested.
    pub tests: u64,
}

impl<T: Scalar> Neighbors<T> {
    /// Removes an id from the `k + 1` shapes of each point, or the last of them, so that `k` remain; −1
    /// removes none.
    ///
    /// It does not narrow the search itself, whose limits follow from the shapes of the point before, of which the
    /// id may be one.
    pub fn exclude(&mut self, k: usize, ids: &Each<i64>) -> Result<()> {
        ids.check_len("exclude", self.ids.len() / (k + 1))?;
        for point in 0..self.ids.len() / (k + 1) {
            let (from, to) = (point * (k + 1), point * k);
            let found = &self.ids[from..from + k + 1];
            // Empty places have −1, too.
            let excluded = ids.at(point);
            let at = found.iter().position(|&id| id >= 0 && id == excluded).unwrap_or(k);
            for nth in 0..k {
                let of = from + nth + usize::from(nth >= at);
                self.ids[to + nth] = self.ids[of];
                self.distances[to + nth] = self.distances[of];
            }
        }
        let len = self.ids.len() / (k + 1) * k;
        self.ids.truncate(len);
        self.distances.truncate(len);
        Ok(())
    }
}

/// Refuses invalid points, distances and counts.
pub fn check_nearest<T: Scalar>(
    points: &[[T; 2]],
    (k, max_distances): (usize, &Each<T>),
) -> Result<()> {
    check_finite("point", points)?;
    max_distances.check_len("max_distance", points.len())?;
    max_distances.check(check_max_distances)?;
    let neighbors = k.saturating_mul(points.len().max(1));
    if neighbors > MAX_IDS {
        let what =
            if points.len() < 2 { "1 point".into() } else { format!("{} points", points.len()) };
        let rule = format!(
            "for {what} that is {neighbors} neighbours, more than {MAX_IDS}; ask for fewer at a time"
        );
        return Err(Error::of("k", k, &rule));
    }
    Ok(())
}

/// The `k` shapes of a tree nearest to each point, not farther than the maximum distance, one for
/// all or one for each point. If there is a `mask`, only shapes with a category in it.
pub fn nearest<T: Scalar>(
    tree: &Quadtree<T>,
    points: &[[T; 2]],
    (k, max_distance): (usize, impl Into<Each<T>>),
    mask: Option<u32>,
) -> Result<Neighbors<T>> {
    let rows = tree.rows();
    // Ordered by row; the low bits are the index.
    // At equal distances the smaller row comes first, whatever the tree looks like. The index in
    // the low bits finds the shape again without a table from rows to indices.
    let id_of = |index: usize| Some(u64::from(rows[index]) << 32 | index as u64);
    let period = tree.period();
    let distance_of =
        |point, id: u64| distance_in(&period, point, &tree.columns().shape(id as u32 as usize));
    let search = |point, best: &mut Nearest<T>| best.search(tree, point, mask, &id_of);
    let wanted = (k, &max_distance.into());
    let mut found = nearest_from(points, wanted, tree.settings().threads, search, distance_of)?;
    found.ids.iter_mut().for_each(|id| *id >>= 32);
    Ok(found)
}

/// Number of values written between two checks for interruption.
const FILLED: usize = 1 << 18;

/// As [`memory::filled`], with checks for interruption: the first writes to new memory can be slow.
fn filled<V: Clone>(len: usize, value: V, stop: &Stop) -> Result<Vec<V>> {
    let mut values = memory::with_capacity(len)?;
    while values.len() < len {
        stop.check()?;
        values.resize(len.min(values.len() + FILLED), value.clone());
    }
    Ok(values)
}

/// As [`nearest`], for shapes that are not in one tree: `search` tests them for one point, and
/// `distance_of` returns the distance of a point from the shape with an id.
///
/// Queries are processed in Morton order. The `k` shapes that are nearest to one point are near the
/// next point too: the largest of their distances from it is an upper bound for its search.
pub fn nearest_from<T: Scalar>(
    points: &[[T; 2]],
    (k, max_distances): (usize, &Each<T>),
    threads: Option<usize>,
    search: impl Fn([T; 2], &mut Nearest<T>) + Sync + Send,
    distance_of: impl Fn([T; 2], u64) -> T + Sync + Send,
) -> Result<Neighbors<T>> {
    check_nearest(points, (k, max_distances))?;
    let threads = worthwhile(threads, points.len());
    let order = morton_order(points.iter().copied())?;
    let stop = Stop::current();
    // Tasks are long enough that handing one over does not show, and short enough that the chain of
    // limits below begins anew seldom.
    let parts: Vec<&[u32]> = order.chunks(QUERIES_PER_TASK).collect();
    let len = k * points.len();
    let distances = filled(len, T::INFINITY, &stop)?;
    let mut all = Neighbors { distances, ids: filled(len, -1, &stop)?, tests: 0 };
    // The chain of limits ends with the task, whose queries depend on their number alone. So the
    // number of tests is the same on each number of threads.
    let found = parallel::map(threads, parts.len(), |part| {
        // One list for all queries of a task, because failures of small allocations abort.
        let (mut neighbors, mut ends) = (Vec::new(), memory::with_capacity(parts[part].len())?);
        let mut best = Nearest::new(k, Pulse::of_task(&stop, part));
        let mut start = 0;
        for &query in parts[part] {
            best.pulse.check(NODE_WORK + k)?;
            let point = points[query as usize];
            let max_distance = max_distances.at(query as usize);
            best.bound = max_distance;
            let before: &[Neighbor<T>] = &neighbors[start..];
            // The k shapes of the query before are k shapes at known distances. So the k nearest
            // are not farther than the farthest of them, and the first nodes are already tested
            // with a useful limit.
            if before.len() == k {
                let distances = before.iter().map(|near| distance_of(point, near.id));
                best.bound = distances.fold(T::ZERO, T::max).min(max_distance);
            }
            search(point, &mut best);
            start = neighbors.len();
            best.move_to(&mut neighbors)?;
            ends.push(neighbors.len());
        }
        Ok((neighbors, ends, best.tests))
    });
    let bytes = len.saturating_mul(size_of::<T>() + size_of::<i64>());
    let found = found.into_iter().collect::<Result<Vec<_>>>();
    let found = found.map_err(|error: Error| error.in_all(bytes))?;
    let mut pulse = Pulse::of(&stop);
    for (part, (neighbors, ends, tests)) in parts.iter().zip(found) {
        let mut neighbors = neighbors.into_iter().enumerate().peekable();
        for (&query, end) in part.iter().zip(ends) {
            pulse.check(k)?;
            let mut index = k * query as usize;
            // Rows with fewer than k shapes keep the infinity and the -1 with which they were
            // filled.
            while let Some((_, Neighbor { distance, id })) = neighbors.next_if(|&(at, _)| at < end)
            {
                all.distances[index] = distance;
                all.ids[index] = id as i64;
                index += 1;
            }
        }
        all.tests += tests;
    }
    Ok(all)
}
