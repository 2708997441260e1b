//! Searches for the shapes that rays hit: the first of each ray, or all.
//!
//! In a periodic plane a ray is replaced by its images, each moved by a multiple of the period.

use std::ops::Range;

use super::nearest::sort_farthest_first;
use super::ray::{Ray, hit, normal, touch};
use super::region::{MAX_IDS, selects};
use super::{IdOf, NODE_WORK, QUERIES_PER_TASK, morton_order, worthwhile};
use crate::columns::Columns;
use crate::geometry::{Bounds, Scalar, Shape};
use crate::period::Period;
use crate::quadtree::Quadtree;
use jostle_base::error::{Error, Result};
use jostle_base::interrupt::{Pulse, Stop};
use jostle_base::memory;
use jostle_base::parallel;
use jostle_simd::{LANES, Simd, Work, block, first_lanes, for_each_lane};

/// Upper bound of the sum of the rounding errors in [`hit`] and in the tests of nodes, in units in
/// the last place.
const ROUNDINGS: f64 = 32.0;

/// A ray for tests against nodes.
#[derive(Clone, Copy)]
struct NodeRay<T> {
    ray: Ray<T>,
    /// The inverse of each component of the direction; infinite for 0.
    inverse: [T; 2],
}

impl<T: Scalar> NodeRay<T> {
    fn of(ray: Ray<T>) -> Self {
        Self { ray, inverse: ray.direction.map(T::recip) }
    }

    /// Upper bound of the rounding errors for shapes within `bounds`.
    #[inline(always)]
    fn slack(&self, bounds: &Bounds<T>) -> T {
        let size = |axis: usize| {
            self.ray.origin[axis].abs()
                + bounds.min[axis].abs().max(bounds.max[axis].abs())
                + bounds.half_size[axis]
        };
        let [hx, hy] = self.ray.half_size;
        let all = size(0) + size(1) + hx + hy + bounds.radius + self.ray.radius;
        // The last term is for underflow.
        all * T::EPSILON * T::from_f64(ROUNDINGS) + T::SMALLEST_SQUARE
    }

    /// A lower bound of the distance to the shapes within `bounds`; `None` if it misses all of
    /// them.
    #[inline(always)]
    fn enters(&self, bounds: &Bounds<T>) -> Option<T> {
        // The bounds grow by all roundings of the exact test and of this one, so a shape is never
        // left out where `hit` would find it. Roundings are in proportion to the numbers, so the
        // slack is to their sum.
        let radius_sum = bounds.radius + self.ray.radius + self.slack(bounds);
        let (mut enter, mut leave) = (T::ZERO, T::INFINITY);
        for axis in 0..2 {
            let grown = bounds.half_size[axis] + self.ray.half_size[axis] + radius_sum;
            let first = ((bounds.min[axis] - grown) - self.ray.origin[axis]) * self.inverse[axis];
            let second = ((bounds.max[axis] + grown) - self.ray.origin[axis]) * self.inverse[axis];
            // NaN (0 · ∞) is ignored by `max` and `min`.
            let (near, far) =
                // By the sign of the direction, not by comparison of the two: with NaN a comparison
                // would take either.
                if self.inverse[axis] < T::ZERO { (second, first) } else { (first, second) };
            enter = enter.max(near);
            leave = leave.min(far);
        }
        let less = T::ONE - T::EPSILON * T::from_f64(ROUNDINGS);
        // A lower bound also after the rounding of the product above.
        let enter = enter * less;
        (enter <= leave).then_some(enter)
    }

    /// A bit for each shape of a block whose distance from the line of the ray could be at most its
    /// size.
    #[inline(always)]
    fn lanes<S: Simd<T>>(
        &self,
        simd: S,
        (slack, round): (T, bool),
        shapes: &Columns<T>,
        first: usize,
    ) -> u32 {
        let [ox, oy] = self.ray.origin;
        let [ux, uy] = self.ray.direction;
        let x = simd.sub(simd.splat(ox), simd.load(block(&shapes.x, first)));
        let y = simd.sub(simd.splat(oy), simd.load(block(&shapes.y, first)));
        // The distance from the whole line. Shapes behind the start pass, too, and `hit` leaves
        // them out.
        let across = simd.sub(simd.mul(x, simd.splat(uy)), simd.mul(y, simd.splat(ux)));
        let [hx, hy] = self.ray.half_size;
        let mut size = simd.splat(self.ray.radius + hx + hy + slack);
        if round {
            size = simd.add(size, simd.load(block(&shapes.radius, first)));
        }
        if shapes.has_half_sizes() {
            size = simd.add(size, simd.load(block(&shapes.half_x, first)));
            size = simd.add(size, simd.load(block(&shapes.half_y, first)));
        }
        if shapes.has_boxes() {
            // The size of a box as seen from its lower corner.
            for (min, max) in [(&shapes.x, &shapes.max_x), (&shapes.y, &shapes.max_y)] {
                let (min, max) = (simd.load(block(min, first)), simd.load(block(max, first)));
                size = simd.add(size, simd.sub(max, min));
            }
        }
        let smallest = simd.splat(T::SMALLEST_SQUARE);
        let size = simd.add(simd.mul(size, size), smallest);
        !simd.less(size, simd.mul(across, across))
    }
}

/// What a search along one ray collects.
pub trait RayPath<T: Scalar>: Sized {
    /// The ray, or the image of it that is searched.
    fn ray(&mut self) -> &mut Ray<T>;
    /// The distance beyond which shapes are ignored.
    fn limit(&self) -> T;
    /// Tests one shape.
    fn offer(&mut self, shape: &Shape<T>, id: u64);
    /// Takes the hit of something that is no shape of a tree.
    fn take(&mut self, hit: RayContact<T>);
    /// Adds a number of tested shapes.
    fn count(&mut self, tests: usize);
    /// Whether to stop; `work` is the approximate number of values read since the last call.
    fn is_over(&mut self, work: usize) -> bool;

    /// Searches a tree.
    fn search(&mut self, tree: &Quadtree<T>, mask: Option<u32>, id_of: &IdOf<'_>) {
        self.search_in(&tree.period(), tree, mask, id_of);
    }

    /// Searches a tree in a periodic plane. The centres of its shapes are in the first period.
    fn search_in(
        &mut self,
        period: &Period<T>,
        tree: &Quadtree<T>,
        mask: Option<u32>,
        id_of: &IdOf<'_>,
    ) {
        let Some(root) = tree.bounds().first() else { return };
        self.each_image(period, root, |best| {
            let node_ray = NodeRay::of(*best.ray());
            T::with_widest(Search { tree, node_ray, mask, id_of, best });
        });
    }

    /// Tests one shape in a periodic plane.
    fn offer_in(&mut self, period: &Period<T>, shape: &Shape<T>, id: u64) {
        self.each_image(period, &Bounds::of(shape), |best| best.offer(shape, id));
    }

    /// Calls `act` for each image of the ray that may hit a shape within `bounds`.
    fn each_image(
        &mut self,
        period: &Period<T>,
        bounds: &Bounds<T>,
        mut act: impl FnMut(&mut Self),
    ) {
        if period.is_none() {
            return act(self);
        }
        let ray = *self.ray();
        for turns in images(&ray, period, bounds) {
            let shift = [0, 1].map(|axis| T::from_f64(turns[axis] * period.sides()[axis].to_f64()));
            *self.ray() = ray.moved(shift);
            let near = NodeRay::of(*self.ray()).enters(bounds);
            // Images come in the order of the ray. After a first hit most of the others are beyond
            // the limit.
            if near.is_some_and(|near| near <= self.limit()) {
                act(self);
            }
            if self.is_over(NODE_WORK) {
                break;
            }
        }
        *self.ray() = ray;
    }
}

/// The images of a ray that may hit shapes within `bounds`, as multiples of the period: in columns
/// along x, in the order in which the ray passes them; for each, all that its part there may hit.
///
/// Of the images of a shape, that with the nearest centre is hit first, because shapes are convex
/// and symmetric. It is at most half a period away along each axis, so sizes beyond that add none.
fn images<T: Scalar>(
    ray: &Ray<T>,
    period: &Period<T>,
    bounds: &Bounds<T>,
) -> impl Iterator<Item = [f64; 2]> {
    let ray64 = |axis: usize| (ray.origin[axis].to_f64(), ray.direction[axis].to_f64());
    let (sides, length) = (period.sides().map(T::to_f64), ray.max_distance.to_f64());
    let extent = |axis: usize| {
        let grown = bounds.half_size[axis] + ray.half_size[axis] + (bounds.radius + ray.radius);
        let (low, high) =
            ((bounds.min[axis] - grown).to_f64(), (bounds.max[axis] + grown).to_f64());
        let side = sides[axis];
        // Centres are in the first period.
        // See above: what is wider than the period is hit first in the image whose centre is
        // nearest.
        if side > 0.0 { [low.max(-0.5 * side), high.min(1.5 * side)] } else { [low, high] }
    };
    let (columns, rows) = (extent(0), extent(1));
    // The images whose shapes are passed between two distances. One more on either side contains
    // all rounding errors.
    let range = move |axis: usize, [low, high]: [f64; 2], [from, to]: [f64; 2]| {
        if sides[axis] == 0.0 {
            return [0, 0];
        }
        let (origin, direction) = ray64(axis);
        let (a, b) = (origin + direction * from, origin + direction * to);
        let first = ((a.min(b) - high) / sides[axis]).floor() as i64 - 1;
        [first, ((a.max(b) - low) / sides[axis]).ceil() as i64 + 1]
    };
    let [first, last] = range(0, columns, [0.0, length]);
    let (origin, direction) = ray64(0);
    let backwards = direction < 0.0;
    (first..=last).flat_map(move |index| {
        let column = if backwards { first + last - index } else { index };
        let shift = column as f64 * sides[0];
        // The distances between which the ray is in the column.
        // A ray along the column: the distances of the edges would be infinite or NaN. The longest
        // ray has 1,024 periods, so with such a direction it moves by a billionth of a period along
        // x.
        let part = if direction.abs() < 1e-12 || sides[0] == 0.0 {
            [0.0, length]
        } else {
            let edges = columns.map(|edge| (edge + shift - origin) / direction);
            [
                edges[0].min(edges[1]).max(0.0).min(length),
                edges[0].max(edges[1]).max(0.0).min(length),
            ]
        };
        let [first, last] = range(1, rows, part);
        (first..=last).map(move |row| [column as f64, row as f64])
    })
}

/// A hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayContact<T> {
    /// The distance along the ray.
    pub distance: T,
    /// The id of what is hit.
    pub id: u64,
    /// Unit normal there; (0, 0) at distance 0.
    pub normal: [T; 2],
    /// From the place on the ray to the point where the shapes touch.
    pub touch: [T; 2],
}

impl<T: Scalar> RayContact<T> {
    fn new(ray: &Ray<T>, shape: &Shape<T>, distance: T, id: u64) -> Self {
        let normal = normal(ray, shape, distance);
        Self { distance, id, normal, touch: touch(ray, shape, distance, normal) }
    }
}

/// The first hit of a ray so far.
#[derive(Clone, Debug)]
pub struct FirstHit<T> {
    ray: Ray<T>,
    /// At equal distances that with the smaller id.
    found: Option<RayContact<T>>,
    /// Number of shapes that were tested.
    pub tests: u64,
    pulse: Pulse,
}

impl<T: Scalar> FirstHit<T> {
    /// No hit yet; `pulse` may interrupt the search.
    fn new(ray: Ray<T>, pulse: Pulse) -> Self {
        Self { ray, found: None, tests: 0, pulse }
    }

    #[inline(always)]
    fn is_nearer(&self, distance: T, id: u64) -> bool {
        match self.found {
            Some(first) => {
                distance < first.distance || (distance == first.distance && id < first.id)
            }
            None => distance <= self.ray.max_distance,
        }
    }
}

impl<T: Scalar> RayPath<T> for FirstHit<T> {
    fn ray(&mut self) -> &mut Ray<T> {
        &mut self.ray
    }

    #[inline(always)]
    fn limit(&self) -> T {
        self.found.map_or(self.ray.max_distance, |found| found.distance)
    }

    #[inline(always)]
    fn offer(&mut self, shape: &Shape<T>, id: u64) {
        if id == self.ray.exclude {
            return;
        }
        let Some(distance) = hit(&self.ray, shape) else { return };
        if self.is_nearer(distance, id) {
            self.found = Some(RayContact::new(&self.ray, shape, distance, id));
        }
    }

    fn take(&mut self, hit: RayContact<T>) {
        if self.is_nearer(hit.distance, hit.id) {
            self.found = Some(hit);
        }
    }

    fn count(&mut self, tests: usize) {
        self.tests += tests as u64;
    }

    #[inline(always)]
    fn is_over(&mut self, work: usize) -> bool {
        self.pulse.stops(work)
    }
}

/// All hits of a ray so far.
#[derive(Clone, Debug)]
pub struct AllHits<T> {
    ray: Ray<T>,
    found: Vec<RayContact<T>>,
    tests: u64,
    pulse: Pulse,
    failed: Option<Error>,
}

impl<T: Scalar> AllHits<T> {
    fn new(ray: Ray<T>, pulse: Pulse) -> Self {
        Self { ray, found: Vec::new(), tests: 0, pulse, failed: None }
    }

    /// The hits, nearest first, at equal distances the smaller id first. A shape that is hit in
    /// several images is listed once.
    fn sorted(mut self) -> Result<(Vec<RayContact<T>>, u64, Pulse)> {
        if let Some(error) = self.failed {
            return Err(error);
        }
        self.pulse.check(self.found.len())?;
        let by_distance =
            |a: &RayContact<T>, b: &RayContact<T>| a.distance.total_order(&b.distance);
        // By id and distance first: of several hits of one shape `dedup_by_key` keeps the first,
        // the nearest one.
        self.found.sort_unstable_by(|a, b| a.id.cmp(&b.id).then(by_distance(a, b)));
        self.found.dedup_by_key(|hit| hit.id);
        self.found.sort_unstable_by(|a, b| by_distance(a, b).then(a.id.cmp(&b.id)));
        Ok((self.found, self.tests, self.pulse))
    }
}

impl<T: Scalar> RayPath<T> for AllHits<T> {
    fn ray(&mut self) -> &mut Ray<T> {
        &mut self.ray
    }

    #[inline(always)]
    fn limit(&self) -> T {
        self.ray.max_distance
    }

    #[inline(always)]
    fn offer(&mut self, shape: &Shape<T>, id: u64) {
        if id == self.ray.exclude {
            return;
        }
        let Some(distance) = hit(&self.ray, shape) else { return };
        if distance <= self.ray.max_distance {
            self.take(RayContact::new(&self.ray, shape, distance, id));
        }
    }

    fn take(&mut self, hit: RayContact<T>) {
        if hit.distance <= self.ray.max_distance {
            let added = memory::push(&mut self.found, hit);
            self.failed = self.failed.take().or(added.err());
        }
    }

    fn count(&mut self, tests: usize) {
        self.tests += tests as u64;
    }

    #[inline(always)]
    fn is_over(&mut self, work: usize) -> bool {
        if self.pulse.stops(work) && self.failed.is_none() {
            self.failed = Some(Error::Interrupted);
        }
        self.failed.is_some()
    }
}

/// The search of one ray in one tree.
struct Search<'a, T, C> {
    tree: &'a Quadtree<T>,
    node_ray: NodeRay<T>,
    mask: Option<u32>,
    id_of: &'a IdOf<'a>,
    best: &'a mut C,
}

impl<T: Scalar, C: RayPath<T>> Work<T> for Search<'_, T, C> {
    type Out = ();

    /// Depth first, the nearest child first. Nodes on the stack may be beyond the limit when they
    /// are visited.
    #[inline(always)]
    fn run<S: Simd<T>>(mut self, simd: S) {
        let (nodes, node_bounds) = (self.tree.nodes(), self.tree.bounds());
        let mut stack: Vec<(T, u32)> = Vec::with_capacity(64);
        let (mask, node_ray) = (self.mask, self.node_ray);
        let enters = |bounds: &Bounds<T>| {
            if selects(mask, bounds.category) { node_ray.enters(bounds) } else { None }
        };
        let root = node_bounds.first().and_then(enters);
        stack.extend(root.map(|nearest| (nearest, 0)));
        while let Some((nearest, index)) = stack.pop() {
            if nearest > self.best.limit() {
                continue;
            }
            if self.best.is_over(NODE_WORK) {
                return;
            }
            let node = &nodes[index as usize];
            if node.is_leaf() {
                let bounds = &node_bounds[index as usize];
                self.leaf(simd, (node_ray.slack(bounds), bounds.radius > T::ZERO), node.range());
                continue;
            }
            let from = stack.len();
            for child in node.children() {
                if let Some(nearest) = enters(&node_bounds[child]) {
                    stack.push((nearest, child as u32));
                }
            }
            sort_farthest_first(&mut stack[from..]);
        }
    }
}

impl<T: Scalar, C: RayPath<T>> Search<'_, T, C> {
    #[inline(always)]
    fn leaf<S: Simd<T>>(&mut self, simd: S, about: (T, bool), indices: Range<usize>) {
        let shapes = self.tree.columns();
        self.best.count(indices.len());
        for first in indices.clone().step_by(LANES) {
            if self.best.is_over(LANES) {
                return;
            }
            let near = self.node_ray.lanes(simd, about, shapes, first);
            for_each_lane(near & first_lanes(indices.end - first), |lane| {
                let shape = shapes.shape_if(first + lane, about.1);
                if selects(self.mask, shape.category)
                    && let Some(id) = (self.id_of)(first + lane)
                {
                    self.best.offer(&shape, id);
                }
            });
        }
    }
}

/// The first hits of many rays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RayHits<T> {
    /// Ids of the shapes; −1 if nothing is hit.
    pub ids: Vec<i64>,
    /// Distances; infinity if nothing is hit.
    pub distances: Vec<T>,
    /// Normals of the shapes; (0, 0) if nothing is hit or a ray starts in the shape.
    pub normals: Vec<[T; 2]>,
    /// Where the shapes are hit; NaN if nothing is hit. With a period it lies on the ray, which may be an image
    /// of the place.
    pub points: Vec<[T; 2]>,
    /// For all hits of many rays, those of ray r are `offsets[r]..offsets[r + 1]`; otherwise empty.
    pub offsets: Vec<usize>,
    /// Number of shapes that were tested.
    pub tests: u64,
}

/// The first hit of each ray in a tree. If there is a `mask`, only shapes with a category in it are
/// hit.
pub fn first_hits<T: Scalar>(
    tree: &Quadtree<T>,
    rays: &[Ray<T>],
    mask: Option<u32>,
) -> Result<RayHits<T>> {
    let rows = tree.rows();
    let search = |best: &mut FirstHit<T>| {
        best.search(tree, mask, &|index| Some(u64::from(rows[index])));
    };
    first_hits_by(rays, &tree.period(), tree.settings().threads, search)
}

/// As [`first_hits`], for shapes that are not in one tree: `search` tests them for one ray.
pub fn first_hits_by<T: Scalar>(
    rays: &[Ray<T>],
    period: &Period<T>,
    threads: Option<usize>,
    search: impl Fn(&mut FirstHit<T>) + Sync + Send,
) -> Result<RayHits<T>> {
    let wrapped = Ray::in_period(rays, period)?;
    let (order, found) = each_ray(&wrapped, threads, |ray, pulse| {
        let mut best = FirstHit::new(ray, pulse);
        search(&mut best);
        Ok(((best.found, best.tests), best.pulse))
    })?;
    let len = rays.len();
    let (offsets, tests) = (Vec::new(), found.iter().flatten().map(|(_, tests)| tests).sum());
    let mut all = RayHits {
        ids: memory::filled(len, -1)?,
        distances: memory::filled(len, T::INFINITY)?,
        normals: memory::filled(len, [T::ZERO; 2])?,
        points: memory::filled(len, [T::NAN; 2])?,
        offsets,
        tests,
    };
    for (&query, (hit, _)) in order.iter().zip(found.iter().flatten()) {
        if let Some(hit) = hit {
            let query = query as usize;
            all.ids[query] = hit.id as i64;
            all.distances[query] = hit.distance;
            all.normals[query] = hit.normal;
            all.points[query] = rays[query].place(hit.distance, hit.touch);
        }
    }
    Ok(all)
}

/// All shapes of a tree that each ray hits, nearest first. If there is a `mask`, only shapes with a
/// category in it.
pub fn all_hits<T: Scalar>(
    tree: &Quadtree<T>,
    rays: &[Ray<T>],
    mask: Option<u32>,
) -> Result<RayHits<T>> {
    let rows = tree.rows();
    let search = |all: &mut AllHits<T>| {
        all.search(tree, mask, &|index| Some(u64::from(rows[index])));
    };
    all_hits_by(rays, &tree.period(), tree.settings().threads, search)
}

/// As [`all_hits`], for shapes that are not in one tree: `search` tests them for one ray.
pub fn all_hits_by<T: Scalar>(
    rays: &[Ray<T>],
    period: &Period<T>,
    threads: Option<usize>,
    search: impl Fn(&mut AllHits<T>) + Sync + Send,
) -> Result<RayHits<T>> {
    let wrapped = Ray::in_period(rays, period)?;
    let (order, found) = each_ray(&wrapped, threads, |ray, pulse| {
        let mut all = AllHits::new(ray, pulse);
        search(&mut all);
        let (found, tests, pulse) = all.sorted()?;
        Ok(((found, tests), pulse))
    })?;
    let found: Vec<_> = found.iter().flatten().collect();
    let mut indices = memory::filled(rays.len(), 0)?;
    order.iter().enumerate().for_each(|(index, &query)| indices[query as usize] = index);
    let count = found.iter().map(|(hits, _)| hits.len()).sum::<usize>();
    if count > MAX_IDS {
        return Err(Error::TooManyIds { limit: MAX_IDS });
    }
    let mut all = RayHits {
        ids: memory::with_capacity(count)?,
        distances: memory::with_capacity(count)?,
        normals: memory::with_capacity(count)?,
        points: memory::with_capacity(count)?,
        offsets: memory::with_capacity(rays.len() + 1)?,
        tests: found.iter().map(|(_, tests)| tests).sum(),
    };
    all.offsets.push(0);
    for (ray, index) in rays.iter().zip(indices) {
        for hit in &found[index].0 {
            all.ids.push(hit.id as i64);
            all.distances.push(hit.distance);
            all.normals.push(hit.normal);
            all.points.push(ray.place(hit.distance, hit.touch));
        }
        all.offsets.push(all.ids.len());
    }
    Ok(all)
}

/// The order in which rays are processed, and in this order the results of `search` for each, one
/// list for each task.
fn each_ray<T: Scalar, V: Send>(
    rays: &[Ray<T>],
    threads: Option<usize>,
    search: impl Fn(Ray<T>, Pulse) -> Result<(V, Pulse)> + Sync + Send,
) -> Result<(Vec<u32>, Vec<Vec<V>>)> {
    let threads = worthwhile(threads, rays.len());
    let order = morton_order(rays.iter().map(|ray| ray.origin))?;
    let stop = Stop::current();
    let parts: Vec<&[u32]> = order.chunks(QUERIES_PER_TASK).collect();
    let found = parallel::map(threads, parts.len(), |part| {
        let mut pulse = Pulse::of_task(&stop, part);
        let mut found = Vec::with_capacity(parts[part].len());
        for &query in parts[part] {
            pulse.check(NODE_WORK)?;
            // The pulse goes through all searches of a task, since each alone is too short for a
            // check.
            let (result, rest) = search(rays[query as usize], pulse)?;
            found.push(result);
            pulse = rest;
        }
        pulse.check(0)?;
        Ok(found)
    });
    let found = found.into_iter().collect::<Result<Vec<_>>>()?;
    Ok((order, found))
}
