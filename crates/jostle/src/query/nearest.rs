//! The shapes nearest to a point.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::mem;
use std::ops::Range;

use super::region::{MOST_IDS, selects};
use super::{IdOf, NODE_WORK, QUESTIONS, along_a_curve, check_reach, worthwhile};
use crate::columns::Columns;
use crate::error::{Error, Result};
use crate::geometry::{Cover, Scalar, Shape, length};
use crate::interrupt::{Pulse, Stop};
use crate::memory;
use crate::parallel;
use crate::quadtree::Quadtree;
use crate::shapes::check_finite;
use crate::simd::{LANES, Simd, Work, block, first_lanes, for_each_lane};
use crate::sorting::{self, Bytes};

/// How far a point is from a shape; 0 inside.
#[inline(always)]
pub fn distance<T: Scalar>(point: [T; 2], shape: &Shape<T>) -> T {
    let gap = shape.gap_to(point);
    let away = |axis: usize| (gap[axis] - shape.half_size[axis]).most(T::ZERO);
    (length(away(0), away(1)) - shape.radius).most(T::ZERO)
}

/// At most the square of the distance from a point to the cores of the shapes of `cover`.
#[inline(always)]
fn least_square<T: Scalar>(point: [T; 2], cover: &Cover<T>) -> T {
    let away = |axis: usize| {
        let (below, above) = (cover.min[axis] - point[axis], point[axis] - cover.max[axis]);
        (below.most(above) - cover.half_size[axis]).most(T::ZERO)
    };
    let (x, y) = (away(0), away(1));
    x * x + y * y
}

/// At least the square of `reach`: no square of a smaller distance is larger, however both are
/// rounded, and where squares are too small for their last bits.
#[inline(always)]
fn largest_square<T: Scalar>(reach: T) -> T {
    let reach = reach * slack();
    reach * reach + T::SMALLEST_SQUARE
}

/// A factor that makes up for the rounding of both squares.
#[inline(always)]
fn slack<T: Scalar>() -> T {
    T::ONE + T::from_f64(16.0) * T::EPSILON
}

/// A shape and how far it is. The nearer comes first, and of two as near the smaller id.
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
        // A distance is not negative, except for the sign of a zero.
        let distance = self.distance.to_f64().to_bits() as i64;
        let signed = if distance < 0 { !distance ^ i64::MIN } else { distance };
        if at < 8 { signed.byte(at) } else { (self.id >> (120 - 8 * at)) as u8 }
    }
}

/// The nearest shapes seen so far.
#[derive(Clone, Debug)]
pub struct Nearest<T> {
    wanted: usize,
    /// Shapes farther than this are not among them.
    bound: T,
    /// The farthest on top.
    found: BinaryHeap<Neighbor<T>>,
    /// Nodes to visit, with [`least_square`].
    stack: Vec<(T, u32)>,
    pulse: Pulse,
    failed: Option<Error>,
    /// Shapes tested.
    pub tests: u64,
}

impl<T: Scalar> Nearest<T> {
    /// For searches for the `wanted` nearest shapes; `pulse` may end them.
    fn new(wanted: usize, pulse: Pulse) -> Self {
        let (found, stack) = (BinaryHeap::new(), Vec::with_capacity(64));
        Self { wanted, bound: T::ZERO, found, stack, pulse, failed: None, tests: 0 }
    }

    /// What is farther is of no interest.
    #[inline(always)]
    fn limit(&self) -> T {
        match self.found.peek() {
            Some(last) if self.found.len() >= self.wanted => last.distance,
            _ => self.bound,
        }
    }

    /// Looks at one shape.
    #[inline(always)]
    pub fn offer(&mut self, distance: T, id: u64) {
        let new = Neighbor { distance, id };
        if self.found.len() < self.wanted {
            if distance <= self.bound && self.has_room() {
                self.found.push(new);
            }
        } else if let Some(mut last) = self.found.peek_mut()
            && new < *last
        {
            *last = new;
        }
    }

    /// Whether there is memory for one more.
    #[inline(always)]
    fn has_room(&mut self) -> bool {
        self.found.len() < self.found.capacity() || self.grow()
    }

    #[cold]
    fn grow(&mut self) -> bool {
        let len = self.found.len();
        let grown = self.found.try_reserve(1 + len.min(self.wanted - len - 1));
        let grown = grown
            .and_then(|()| memory::check_margin::<Neighbor<T>>(self.found.capacity()))
            .map_err(|error| {
                self.found.shrink_to(len);
                memory::no_memory::<Neighbor<T>>(&error, (2 * len).max(4))
            });
        self.failed = self.failed.take().or(grown.err());
        self.failed.is_none()
    }

    /// Whether to end early, now that about `work` numbers have been read.
    #[inline(always)]
    pub fn is_over(&mut self, work: usize) -> bool {
        if self.pulse.stops(work) && self.failed.is_none() {
            self.failed = Some(Error::Interrupted);
        }
        self.failed.is_some()
    }

    /// Moves what was found to the end of `neighbors`, the nearest first.
    fn move_to(&mut self, neighbors: &mut Vec<Neighbor<T>>) -> Result<()> {
        if let Some(error) = self.failed.take() {
            return Err(error);
        }
        let mut found = mem::take(&mut self.found).into_vec();
        sorting::sort(&mut found, &mut self.pulse)?;
        memory::reserve(neighbors, found.len())?;
        neighbors.append(&mut found);
        self.found = found.into();
        Ok(())
    }

    /// Looks at the shapes of a tree. `id_of` names the shape in a place, or hides it.
    pub fn look(&mut self, tree: &Quadtree<T>, point: [T; 2], mask: Option<u32>, id_of: &IdOf<'_>) {
        T::with_widest(Look { tree, point, mask, id_of, best: self });
    }
}

/// One search through one tree.
struct Look<'a, T> {
    tree: &'a Quadtree<T>,
    point: [T; 2],
    mask: Option<u32>,
    id_of: &'a IdOf<'a>,
    best: &'a mut Nearest<T>,
}

impl<T: Scalar> Work<T> for Look<'_, T> {
    type Out = ();

    /// Depth first, the nearer child first; what was put off may be too far by its turn.
    #[inline(always)]
    fn run<S: Simd<T>>(mut self, simd: S) {
        let (nodes, covers) = (self.tree.nodes(), self.tree.covers());
        let Some(root) = covers.first().filter(|root| selects(self.mask, root.category)) else {
            return;
        };
        let mut stack = mem::take(&mut self.best.stack);
        stack.clear();
        stack.push((least_square(self.point, root), 0));
        while let Some((square, index)) = stack.pop() {
            let radius = covers[index as usize].radius;
            if square > largest_square(self.best.limit() + radius) {
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
                let cover = &covers[child];
                let square = least_square(self.point, cover);
                if square <= largest_square(limit + cover.radius)
                    && selects(self.mask, cover.category)
                {
                    stack.push((square, child as u32));
                }
            }
            sort_farthest_first(&mut stack[from..]);
        }
        self.best.stack = stack;
    }
}

/// Sorts at most four nodes; the nearest ends on top of the stack.
#[inline(always)]
pub(super) fn sort_farthest_first<T: Scalar>(nodes: &mut [(T, u32)]) {
    for end in 1..nodes.len() {
        for place in (1..=end).rev() {
            if nodes[place].0 <= nodes[place - 1].0 {
                break;
            }
            nodes.swap(place, place - 1);
        }
    }
}

impl<T: Scalar> Look<'_, T> {
    #[inline(always)]
    fn leaf<S: Simd<T>>(&mut self, simd: S, places: Range<usize>, round: bool) {
        let shapes = self.tree.columns();
        self.best.tests += places.len() as u64;
        for first in places.clone().step_by(LANES) {
            if self.best.is_over(LANES) {
                return;
            }
            let limit = self.best.limit();
            let near = within(simd, self.point, limit, (shapes, round), first);
            for_each_lane(near & first_lanes(places.end - first), |lane| {
                let shape = shapes.shape_if(first + lane, round);
                if selects(self.mask, shape.category)
                    && let Some(id) = (self.id_of)(first + lane)
                {
                    self.best.offer(distance(self.point, &shape), id);
                }
            });
        }
    }
}

/// A bit for each shape of a block that could be as near as `limit`, as [`largest_square`] says.
#[inline(always)]
fn within<T: Scalar, S: Simd<T>>(
    simd: S,
    point: [T; 2],
    limit: T,
    (shapes, round): (&Columns<T>, bool),
    first: usize,
) -> u32 {
    let x = away(simd, point[0], [&shapes.x, &shapes.max_x, &shapes.half_x], first);
    let y = away(simd, point[1], [&shapes.y, &shapes.max_y, &shapes.half_y], first);
    let mut reach = simd.splat(limit);
    if round {
        reach = simd.add(reach, simd.load(block(&shapes.radius, first)));
    }
    let reach = simd.mul(reach, simd.splat(slack()));
    let reach = simd.add(simd.mul(reach, reach), simd.splat(T::SMALLEST_SQUARE));
    !simd.less(reach, simd.add(simd.mul(x, x), simd.mul(y, y)))
}

/// How far the shapes of a block are from a point along one axis.
#[inline(always)]
fn away<T: Scalar, S: Simd<T>>(
    simd: S,
    point: T,
    [min, max, half_sizes]: [&[T]; 3],
    first: usize,
) -> S::Block {
    let (min, point) = (simd.load(block(min, first)), simd.splat(point));
    let mut away = if max.is_empty() {
        simd.distance(min, point)
    } else {
        simd.most(simd.sub(min, point), simd.sub(point, simd.load(block(max, first))))
    };
    if max.is_empty() && half_sizes.is_empty() {
        return away;
    }
    if !half_sizes.is_empty() {
        away = simd.sub(away, simd.load(block(half_sizes, first)));
    }
    simd.most(away, simd.splat(T::ZERO))
}

/// Distances and ids of the nearest shapes, `k` for each point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Neighbors<T> {
    /// Nearest first; infinity where there are fewer.
    pub distances: Vec<T>,
    /// Ids of the shapes; −1 where there are fewer.
    pub ids: Vec<i64>,
    /// Shapes tested.
    pub tests: u64,
}

/// Refuses points, distances and counts that no search can follow.
pub fn check_nearest<T: Scalar>(points: &[[T; 2]], (k, max_distance): (usize, T)) -> Result<()> {
    check_finite("point", points)?;
    check_reach(max_distance)?;
    let neighbors = k.saturating_mul(points.len().max(1));
    if neighbors > MOST_IDS {
        let of =
            if points.len() < 2 { "1 point".into() } else { format!("{} points", points.len()) };
        let rule = format!(
            "for {of} that is {neighbors} neighbours, more than {MOST_IDS}; ask for fewer at a time"
        );
        return Err(Error::of("k", k, &rule));
    }
    Ok(())
}

/// The `k` shapes of a tree nearest to each point and not farther than `max_distance`, among
/// what has a category in `mask`, if there is one.
pub fn nearest<T: Scalar>(
    tree: &Quadtree<T>,
    points: &[[T; 2]],
    (k, max_distance): (usize, T),
    mask: Option<u32>,
) -> Result<Neighbors<T>> {
    let rows = tree.rows();
    // Sorted as by row, and the place of the shape is known, too.
    let id_of = |place: usize| Some(u64::from(rows[place]) << 32 | place as u64);
    let shape_of = |id: u64| tree.columns().shape(id as u32 as usize);
    let look = |point, best: &mut Nearest<T>| best.look(tree, point, mask, &id_of);
    let mut found = nearest_by(points, (k, max_distance), tree.settings().threads, look, shape_of)?;
    found.ids.iter_mut().for_each(|id| *id >>= 32);
    Ok(found)
}

/// Values written between two checks for an interruption.
const FILLED: usize = 1 << 18;

/// As [`memory::filled`], with checks for an interruption: the first use of new memory may take long.
fn filled<V: Clone>(len: usize, value: V, stop: &Stop) -> Result<Vec<V>> {
    let mut values = memory::with_room(len)?;
    while values.len() < len {
        stop.check()?;
        values.resize(len.min(values.len() + FILLED), value.clone());
    }
    Ok(values)
}

/// As [`nearest`]; `look` lets a point see the shapes that there are, and `shape_of` tells them by
/// their ids.
///
/// Queries are taken in the order of a curve. The `k` shapes that one has found are near the next
/// point, too, so the farthest of them bounds its search from the beginning.
pub fn nearest_by<T: Scalar>(
    points: &[[T; 2]],
    (k, max_distance): (usize, T),
    threads: Option<usize>,
    look: impl Fn([T; 2], &mut Nearest<T>) + Sync + Send,
    shape_of: impl Fn(u64) -> Shape<T> + Sync + Send,
) -> Result<Neighbors<T>> {
    check_nearest(points, (k, max_distance))?;
    let threads = worthwhile(threads, points.len());
    let order = along_a_curve(points.iter().copied())?;
    let stop = Stop::current();
    let parts: Vec<&[u32]> = order.chunks(QUESTIONS).collect();
    let len = k * points.len();
    let distances = filled(len, T::INFINITY, &stop)?;
    let mut all = Neighbors { distances, ids: filled(len, -1, &stop)?, tests: 0 };
    let found = parallel::map(threads, parts.len(), |part| {
        // One list for all questions: small allocations would not notice that memory ends.
        let (mut neighbors, mut ends) = (Vec::new(), memory::with_room(parts[part].len())?);
        let mut best = Nearest::new(k, Pulse::of(&stop));
        let mut start = 0;
        for &question in parts[part] {
            best.pulse.check(NODE_WORK + k)?;
            let point = points[question as usize];
            best.bound = max_distance;
            let before: &[Neighbor<T>] = &neighbors[start..];
            if before.len() == k {
                let distances = before.iter().map(|near| distance(point, &shape_of(near.id)));
                best.bound = distances.fold(T::ZERO, T::most).least(max_distance);
            }
            look(point, &mut best);
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
        for (&question, end) in part.iter().zip(ends) {
            pulse.check(k)?;
            let mut place = k * question as usize;
            while let Some((_, Neighbor { distance, id })) = neighbors.next_if(|&(at, _)| at < end)
            {
                all.distances[place] = distance;
                all.ids[place] = id as i64;
                place += 1;
            }
        }
        all.tests += tests;
    }
    Ok(all)
}
