//! Ray casts, and circle casts: the first shape that a ray or a moving disc hits.

use std::ops::Range;

use super::nearest::sort_farthest_first;
use super::region::selects;
use super::{IdOf, NODE_WORK, QUERIES_PER_TASK, check_max_distance, morton_order, worthwhile};
use crate::columns::Columns;
use crate::error::{Error, Result};
use crate::geometry::{Bounds, Scalar, Shape, into_range, within};
use crate::interrupt::{Pulse, Stop};
use crate::memory;
use crate::parallel;
use crate::quadtree::Quadtree;
use crate::shapes::{Each, check_finite, check_radii};
use crate::simd::{LANES, Simd, Work, block, first_lanes, for_each_lane};

/// A ray, or the path of a disc; the radius of a ray is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray<T> {
    origin: [T; 2],
    /// A unit vector, up to rounding.
    direction: [T; 2],
    radius: T,
    max_distance: T,
}

impl<T: Scalar> Ray<T> {
    /// Rays: one for each row of an argument, or one. Directions may have any length except 0.
    pub fn all(
        origins: &Each<[T; 2]>,
        directions: &Each<[T; 2]>,
        radii: &Each<T>,
        max_distance: T,
    ) -> Result<Vec<Self>> {
        let len = origins.len().or(directions.len()).or(radii.len()).unwrap_or(1);
        origins.check_len("origin", len)?;
        directions.check_len("direction", len)?;
        radii.check_len("radius", len)?;
        origins.check(|origins| check_finite("origin", origins))?;
        directions.check(check_directions)?;
        radii.check(|radii| check_radii("radius", radii))?;
        check_max_distance(max_distance)?;
        let ray = |row| Self {
            origin: origins.at(row),
            direction: unit(directions.at(row)),
            radius: radii.at(row),
            max_distance,
        };
        memory::collect((0..len).map(ray))
    }
}

fn check_directions<T: Scalar>(directions: &[[T; 2]]) -> Result<()> {
    check_finite("direction", directions)?;
    match directions.iter().position(|direction| *direction == [T::ZERO; 2]) {
        Some(index) => Err(Error::at("direction", index, "(0, 0)", "a direction has a length")),
        None => Ok(()),
    }
}

/// The unit vector of a direction, scaled first so that squares neither overflow nor underflow.
fn unit<T: Scalar>(direction: [T; 2]) -> [T; 2] {
    let largest = direction[0].abs().max(direction[1].abs());
    let [x, y] = direction.map(|v| v / largest);
    let length = (x * x + y * y).sqrt();
    [x / length, y / length]
}

/// The distance along the ray to the shape, which includes its edge; 0 if the ray starts inside,
/// `None` if it misses.
///
/// A moving disc hits a shape if its centre hits the Minkowski sum of both. For a circle that is a
/// larger circle; for a box the union of two larger boxes and a circle at each corner.
pub fn hit<T: Scalar>(ray: &Ray<T>, shape: &Shape<T>) -> Option<T> {
    let Shape { min, max, half_size: [hx, hy], .. } = *shape;
    let radius_sum = shape.radius + ray.radius;
    let [x, y] = shape.gaps_to(ray.origin);
    if within(x.max(T::ZERO), y.max(T::ZERO), radius_sum) {
        return Some(T::ZERO);
    }
    let far = |axis: usize| {
        (ray.origin[axis] - min[axis]).abs().max((ray.origin[axis] - max[axis]).abs())
    };
    let [into, back] = into_range(far(0).max(far(1)).max(hx.max(hy)).max(radius_sum));
    // Scaled before the subtraction, which may overflow.
    let from = |corner: [T; 2]| [0, 1].map(|axis| ray.origin[axis] * into - corner[axis] * into);
    let half_size = [hx * into, hy * into];
    let core = Core { min: from(min), max: from(max), half_size, is_box: min != max };
    hit_in_range(&core, radius_sum * into, ray).map(|distance| distance * back)
}

/// The core of a shape relative to the origin of a ray: the origin minus `min` and minus `max`.
struct Core<T> {
    min: [T; 2],
    max: [T; 2],
    half_size: [T; 2],
    /// Whether `min` and `max` of the shape differ; here they may be equal after rounding.
    is_box: bool,
}

/// [`hit`] for a shape with a core and a radius, and a ray that starts outside of it.
fn hit_in_range<T: Scalar>(core: &Core<T>, radius: T, ray: &Ray<T>) -> Option<T> {
    let Core { min, max, half_size: [hx, hy], is_box } = *core;
    if hx == T::ZERO && hy == T::ZERO && !is_box {
        return into_circle(min, ray.direction, radius);
    }
    let into_box = |half_size| into_box(&Core { half_size, ..*core }, ray.direction);
    if radius == T::ZERO {
        return into_box([hx, hy]);
    }
    let corner = |x: T, y: T| into_circle([x, y], ray.direction, radius);
    let (left, top) = (min[0] + hx, min[1] + hy);
    let (right, bottom) = (max[0] - hx, max[1] - hy);
    let distances = [
        into_box([hx + radius, hy]),
        into_box([hx, hy + radius]),
        corner(left, top),
        corner(right, top),
        corner(left, bottom),
        corner(right, bottom),
    ];
    distances.into_iter().flatten().reduce(T::min)
}

/// The distance from `m`, which is outside, along `u` to a circle around (0, 0).
fn into_circle<T: Scalar>(m: [T; 2], u: [T; 2], radius: T) -> Option<T> {
    let along = m[0] * u[0] + m[1] * u[1];
    let across = m[0] * u[1] - m[1] * u[0];
    // Not compared as squares, which may underflow. NaN is a miss.
    if !(along <= T::ZERO && across.abs() <= radius) {
        return None;
    }
    let half_chord = (radius * radius - across * across).max(T::ZERO);
    Some((-along - half_chord.sqrt()).max(T::ZERO))
}

/// The distance to a box along `u` from a point outside of it (slab method).
fn into_box<T: Scalar>(Core { min, max, half_size, .. }: &Core<T>, u: [T; 2]) -> Option<T> {
    let (mut enter, mut leave) = (T::ZERO, T::INFINITY);
    for axis in 0..2 {
        if u[axis] == T::ZERO {
            if (-min[axis]).max(max[axis]) > half_size[axis] {
                return None;
            }
            continue;
        }
        let first = (-half_size[axis] - min[axis]) / u[axis];
        let second = (half_size[axis] - max[axis]) / u[axis];
        enter = enter.max(first.min(second));
        leave = leave.min(first.max(second));
    }
    (enter <= leave).then_some(enter)
}

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
        let all = size(0) + size(1) + bounds.radius + self.ray.radius;
        // The last term is for underflow.
        all * T::EPSILON * T::from_f64(ROUNDINGS) + T::SMALLEST_SQUARE
    }

    /// A lower bound of the distance to the shapes within `bounds`; `None` if it misses all of
    /// them.
    #[inline(always)]
    fn enters(&self, bounds: &Bounds<T>) -> Option<T> {
        let radius_sum = bounds.radius + self.ray.radius + self.slack(bounds);
        let (mut enter, mut leave) = (T::ZERO, T::INFINITY);
        for axis in 0..2 {
            let grown = bounds.half_size[axis] + radius_sum;
            let first = ((bounds.min[axis] - grown) - self.ray.origin[axis]) * self.inverse[axis];
            let second = ((bounds.max[axis] + grown) - self.ray.origin[axis]) * self.inverse[axis];
            // NaN (0 · ∞) is ignored by `max` and `min`.
            let (near, far) =
                if self.inverse[axis] < T::ZERO { (second, first) } else { (first, second) };
            enter = enter.max(near);
            leave = leave.min(far);
        }
        let less = T::ONE - T::EPSILON * T::from_f64(ROUNDINGS);
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
        let across = simd.sub(simd.mul(x, simd.splat(uy)), simd.mul(y, simd.splat(ux)));
        let mut size = simd.splat(self.ray.radius + slack);
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

/// The first hit of a ray so far.
#[derive(Clone, Debug)]
pub struct FirstHit<T> {
    ray: Ray<T>,
    /// Distance and id of the shape; at equal distances the smaller id.
    pub found: Option<(T, u64)>,
    /// Number of shapes that were tested.
    pub tests: u64,
    pulse: Pulse,
}

impl<T: Scalar> FirstHit<T> {
    /// No hit yet; `pulse` may interrupt the search.
    pub fn new(ray: Ray<T>, pulse: Pulse) -> Self {
        Self { ray, found: None, tests: 0, pulse }
    }

    /// Whether to stop; `work` is the approximate number of values read since the last call.
    #[inline(always)]
    pub fn is_over(&mut self, work: usize) -> bool {
        self.pulse.stops(work)
    }

    /// The distance beyond which shapes are ignored.
    #[inline(always)]
    fn limit(&self) -> T {
        self.found.map_or(self.ray.max_distance, |(distance, _)| distance)
    }

    /// Tests one shape.
    #[inline(always)]
    pub fn offer(&mut self, shape: &Shape<T>, id: u64) {
        let Some(distance) = hit(&self.ray, shape) else { return };
        let nearer = match self.found {
            Some((nearest, first)) => distance < nearest || (distance == nearest && id < first),
            None => distance <= self.ray.max_distance,
        };
        if nearer {
            self.found = Some((distance, id));
        }
    }

    /// Searches a tree.
    pub fn search(&mut self, tree: &Quadtree<T>, mask: Option<u32>, id_of: &IdOf<'_>) {
        let node_ray = NodeRay::of(self.ray);
        T::with_widest(Search { tree, node_ray, mask, id_of, best: self });
    }
}

/// The search of one ray in one tree.
struct Search<'a, T> {
    tree: &'a Quadtree<T>,
    node_ray: NodeRay<T>,
    mask: Option<u32>,
    id_of: &'a IdOf<'a>,
    best: &'a mut FirstHit<T>,
}

impl<T: Scalar> Work<T> for Search<'_, T> {
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

impl<T: Scalar> Search<'_, T> {
    #[inline(always)]
    fn leaf<S: Simd<T>>(&mut self, simd: S, about: (T, bool), places: Range<usize>) {
        let shapes = self.tree.columns();
        self.best.tests += places.len() as u64;
        for first in places.clone().step_by(LANES) {
            if self.best.is_over(LANES) {
                return;
            }
            let near = self.node_ray.lanes(simd, about, shapes, first);
            for_each_lane(near & first_lanes(places.end - first), |lane| {
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
    first_hits_by(rays, tree.settings().threads, |best| {
        best.search(tree, mask, &|place| Some(u64::from(rows[place])));
    })
}

/// As [`first_hits`], for shapes that are not in one tree: `search` tests them for one ray.
pub fn first_hits_by<T: Scalar>(
    rays: &[Ray<T>],
    threads: Option<usize>,
    search: impl Fn(&mut FirstHit<T>) + Sync + Send,
) -> Result<RayHits<T>> {
    let threads = worthwhile(threads, rays.len());
    let order = morton_order(rays.iter().map(|ray| ray.origin))?;
    let stop = Stop::current();
    let parts: Vec<&[u32]> = order.chunks(QUERIES_PER_TASK).collect();
    let found = parallel::map(threads, parts.len(), |part| {
        let mut pulse = Pulse::of(&stop);
        let mut found = Vec::with_capacity(parts[part].len());
        for &query in parts[part] {
            pulse.check(NODE_WORK)?;
            let mut best = FirstHit::new(rays[query as usize], pulse);
            search(&mut best);
            found.push((best.found, best.tests));
            pulse = best.pulse;
        }
        pulse.check(0)?;
        Ok(found)
    });
    let found = found.into_iter().collect::<Result<Vec<_>>>()?;
    let len = rays.len();
    let distances = memory::filled(len, T::INFINITY)?;
    let mut all = RayHits { ids: memory::filled(len, -1)?, distances, tests: 0 };
    for (&query, &(hit, tests)) in order.iter().zip(found.iter().flatten()) {
        if let Some((distance, id)) = hit {
            all.ids[query as usize] = id as i64;
            all.distances[query as usize] = distance;
        }
        all.tests += tests;
    }
    Ok(all)
}
