//! The shape that a ray hits first, or a disc that is thrown along it.

use std::ops::Range;

use super::nearest::sort_farthest_first;
use super::region::selects;
use super::{IdOf, NODE_WORK, QUESTIONS, along_a_curve, check_reach, worthwhile};
use crate::columns::Columns;
use crate::error::{Error, Result};
use crate::geometry::{Cover, Scalar, Shape, into_range, within};
use crate::interrupt::{Pulse, Stop};
use crate::memory;
use crate::parallel;
use crate::quadtree::Quadtree;
use crate::shapes::{Each, check_finite, check_radii};
use crate::simd::{LANES, Simd, Work, block, first_lanes, for_each_lane};

/// A way from a point into a direction, for a disc of some radius; a ray has none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray<T> {
    origin: [T; 2],
    /// Of length 1, but for rounding.
    direction: [T; 2],
    radius: T,
    max_distance: T,
}

impl<T: Scalar> Ray<T> {
    /// Rays, as many as an argument has rows, or one. Directions may have any length but 0;
    /// radii are those of discs thrown along the rays.
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
        check_reach(max_distance)?;
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

/// The direction with length 1; scaled first, so that no square is too large or too small.
fn unit<T: Scalar>(direction: [T; 2]) -> [T; 2] {
    let largest = direction[0].abs().most(direction[1].abs());
    let [x, y] = direction.map(|v| v.over(largest));
    let length = (x * x + y * y).sqrt();
    [x.over(length), y.over(length)]
}

/// How far along the ray it meets the shape, whose edge counts as part of it; 0 where it
/// begins inside, `None` where it never does.
///
/// What the disc of the ray can touch is the shape grown by its radius: for a circle a
/// larger circle; for a box a box as wide, a box as high, and a circle at each corner.
pub fn hit<T: Scalar>(ray: &Ray<T>, shape: &Shape<T>) -> Option<T> {
    let Shape { min, max, half_size: [hx, hy], .. } = *shape;
    let reach = shape.radius + ray.radius;
    let gap = shape.gap_to(ray.origin);
    if within((gap[0] - hx).most(T::ZERO), (gap[1] - hy).most(T::ZERO), reach) {
        return Some(T::ZERO);
    }
    let far = |axis: usize| {
        (ray.origin[axis] - min[axis]).abs().most((ray.origin[axis] - max[axis]).abs())
    };
    let [into, back] = into_range(far(0).most(far(1)).most(hx.most(hy)).most(reach));
    // Before the difference, which may be too large for the type.
    let from = |corner: [T; 2]| [0, 1].map(|axis| ray.origin[axis] * into - corner[axis] * into);
    let half_size = [hx * into, hy * into];
    let core = Core { min: from(min), max: from(max), half_size, is_box: min != max };
    hit_in_range(&core, reach * into, ray).map(|far| far * back)
}

/// The core of a shape as seen from where a ray begins: how far that lies above `min` and
/// above `max`, and how far the core reaches beyond them.
struct Core<T> {
    min: [T; 2],
    max: [T; 2],
    half_size: [T; 2],
    /// Whether `min` and `max` differ, which rounding may hide here.
    is_box: bool,
}

/// [`hit`] for a shape as large as its core and `reach` more. For a beginning outside of it.
fn hit_in_range<T: Scalar>(core: &Core<T>, reach: T, ray: &Ray<T>) -> Option<T> {
    let Core { min, max, half_size: [hx, hy], is_box } = *core;
    if hx == T::ZERO && hy == T::ZERO && !is_box {
        return into_circle(min, ray.direction, reach);
    }
    let into_box = |half_size| into_box(&Core { half_size, ..*core }, ray.direction);
    if reach == T::ZERO {
        return into_box([hx, hy]);
    }
    let corner = |x: T, y: T| into_circle([x, y], ray.direction, reach);
    let (left, top) = (min[0] + hx, min[1] + hy);
    let (right, bottom) = (max[0] - hx, max[1] - hy);
    let ways = [
        into_box([hx + reach, hy]),
        into_box([hx, hy + reach]),
        corner(left, top),
        corner(right, top),
        corner(left, bottom),
        corner(right, bottom),
    ];
    ways.into_iter().flatten().reduce(T::least)
}

/// How far from `m` along `u` a circle around the origin is. For an `m` outside of it.
fn into_circle<T: Scalar>(m: [T; 2], u: [T; 2], radius: T) -> Option<T> {
    let along = m[0] * u[0] + m[1] * u[1];
    let aside = m[0] * u[1] - m[1] * u[0];
    // Squares may be too small to be compared. Written so that what is not a number misses.
    if !(along <= T::ZERO && aside.abs() <= radius) {
        return None;
    }
    let half_chord = (radius * radius - aside * aside).most(T::ZERO);
    Some((-along - half_chord.sqrt()).most(T::ZERO))
}

/// How far a box is along `u`. For a beginning outside of it.
fn into_box<T: Scalar>(Core { min, max, half_size, .. }: &Core<T>, u: [T; 2]) -> Option<T> {
    let (mut enter, mut leave) = (T::ZERO, T::INFINITY);
    for axis in 0..2 {
        if u[axis] == T::ZERO {
            if (-min[axis]).most(max[axis]) > half_size[axis] {
                return None;
            }
            continue;
        }
        let first = (-half_size[axis] - min[axis]).over(u[axis]);
        let second = (half_size[axis] - max[axis]).over(u[axis]);
        enter = enter.most(first.least(second));
        leave = leave.least(first.most(second));
    }
    (enter <= leave).then_some(enter)
}

/// Roundings that may add up in [`hit`] and in what passes over nodes, in units of the
/// last place of the numbers involved.
const ROUNDINGS: f64 = 32.0;

/// A ray as nodes see it.
#[derive(Clone, Copy)]
struct Beam<T> {
    ray: Ray<T>,
    /// One over the direction; infinite along an axis that it does not move on.
    inverse: [T; 2],
}

impl<T: Scalar> Beam<T> {
    fn of(ray: Ray<T>) -> Self {
        Self { ray, inverse: ray.direction.map(T::recip) }
    }

    /// How much rounding could shift anything about shapes in `cover`.
    #[inline(always)]
    fn slack(&self, cover: &Cover<T>) -> T {
        let size = |axis: usize| {
            self.ray.origin[axis].abs()
                + cover.min[axis].abs().most(cover.max[axis].abs())
                + cover.half_size[axis]
        };
        let all = size(0) + size(1) + cover.radius + self.ray.radius;
        // The last term is for numbers that are too small for all their digits.
        all * T::EPSILON * T::from_f64(ROUNDINGS) + T::SMALLEST_SQUARE
    }

    /// At most how far it is to a shape of `cover`; `None` if it passes by all of them.
    #[inline(always)]
    fn enters(&self, cover: &Cover<T>) -> Option<T> {
        let reach = cover.radius + self.ray.radius + self.slack(cover);
        let (mut enter, mut leave) = (T::ZERO, T::INFINITY);
        for axis in 0..2 {
            let grown = cover.half_size[axis] + reach;
            let first = ((cover.min[axis] - grown) - self.ray.origin[axis]) * self.inverse[axis];
            let second = ((cover.max[axis] + grown) - self.ray.origin[axis]) * self.inverse[axis];
            // What is not a number (0 · ∞) loses every comparison and says nothing.
            let (near, far) =
                if self.inverse[axis] < T::ZERO { (second, first) } else { (first, second) };
            enter = enter.most(near);
            leave = leave.least(far);
        }
        let less = T::ONE - T::EPSILON * T::from_f64(ROUNDINGS);
        let enter = enter * less;
        (enter <= leave).then_some(enter)
    }

    /// A bit for each shape of a block that is about as near to the line as it is large.
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
        let aside = simd.sub(simd.mul(x, simd.splat(uy)), simd.mul(y, simd.splat(ux)));
        let mut reach = simd.splat(self.ray.radius + slack);
        if round {
            reach = simd.add(reach, simd.load(block(&shapes.radius, first)));
        }
        if shapes.has_half_sizes() {
            reach = simd.add(reach, simd.load(block(&shapes.half_x, first)));
            reach = simd.add(reach, simd.load(block(&shapes.half_y, first)));
        }
        if shapes.has_boxes() {
            // Seen from the lower corner.
            for (min, max) in [(&shapes.x, &shapes.max_x), (&shapes.y, &shapes.max_y)] {
                let (min, max) = (simd.load(block(min, first)), simd.load(block(max, first)));
                reach = simd.add(reach, simd.sub(max, min));
            }
        }
        let smallest = simd.splat(T::SMALLEST_SQUARE);
        let reach = simd.add(simd.mul(reach, reach), smallest);
        !simd.less(reach, simd.mul(aside, aside))
    }
}

/// The first shape that a ray was found to hit.
#[derive(Clone, Debug)]
pub struct FirstHit<T> {
    ray: Ray<T>,
    /// How far it is, and which shape; of two as far the one with the smaller id.
    pub found: Option<(T, u64)>,
    /// Shapes tested.
    pub tests: u64,
    pulse: Pulse,
}

impl<T: Scalar> FirstHit<T> {
    /// Nothing hit yet; `pulse` may end the search.
    pub fn new(ray: Ray<T>, pulse: Pulse) -> Self {
        Self { ray, found: None, tests: 0, pulse }
    }

    /// Whether to end early, now that about `work` numbers have been read.
    #[inline(always)]
    pub fn is_over(&mut self, work: usize) -> bool {
        self.pulse.stops(work)
    }

    /// What is farther is of no interest.
    #[inline(always)]
    fn limit(&self) -> T {
        self.found.map_or(self.ray.max_distance, |(distance, _)| distance)
    }

    /// Looks at one shape.
    #[inline(always)]
    pub fn offer(&mut self, shape: &Shape<T>, id: u64) {
        let Some(distance) = hit(&self.ray, shape) else { return };
        let nearer = match self.found {
            Some((least, first)) => distance < least || (distance == least && id < first),
            None => distance <= self.ray.max_distance,
        };
        if nearer {
            self.found = Some((distance, id));
        }
    }

    /// Looks at the shapes of a tree. `id_of` names the shape in a place, or hides it.
    pub fn look(&mut self, tree: &Quadtree<T>, mask: Option<u32>, id_of: &IdOf<'_>) {
        let beam = Beam::of(self.ray);
        T::with_widest(Look { tree, beam, mask, id_of, best: self });
    }
}

/// One ray through one tree.
struct Look<'a, T> {
    tree: &'a Quadtree<T>,
    beam: Beam<T>,
    mask: Option<u32>,
    id_of: &'a IdOf<'a>,
    best: &'a mut FirstHit<T>,
}

impl<T: Scalar> Work<T> for Look<'_, T> {
    type Out = ();

    /// Depth first, the nearer child first; what was put off may be too far by its turn.
    #[inline(always)]
    fn run<S: Simd<T>>(mut self, simd: S) {
        let (nodes, covers) = (self.tree.nodes(), self.tree.covers());
        let mut stack: Vec<(T, u32)> = Vec::with_capacity(64);
        let (mask, beam) = (self.mask, self.beam);
        let enters = |cover: &Cover<T>| {
            if selects(mask, cover.category) { beam.enters(cover) } else { None }
        };
        let root = covers.first().and_then(enters);
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
                let cover = &covers[index as usize];
                self.leaf(simd, (beam.slack(cover), cover.radius > T::ZERO), node.range());
                continue;
            }
            let from = stack.len();
            for child in node.children() {
                if let Some(nearest) = enters(&covers[child]) {
                    stack.push((nearest, child as u32));
                }
            }
            sort_farthest_first(&mut stack[from..]);
        }
    }
}

impl<T: Scalar> Look<'_, T> {
    #[inline(always)]
    fn leaf<S: Simd<T>>(&mut self, simd: S, about: (T, bool), places: Range<usize>) {
        let shapes = self.tree.columns();
        self.best.tests += places.len() as u64;
        for first in places.clone().step_by(LANES) {
            if self.best.is_over(LANES) {
                return;
            }
            let near = self.beam.lanes(simd, about, shapes, first);
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

/// What each of many rays hits first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RayHits<T> {
    /// Ids of the shapes; −1 where nothing is hit.
    pub ids: Vec<i64>,
    /// How far it is to them; infinity where nothing is hit.
    pub distances: Vec<T>,
    /// Shapes tested.
    pub tests: u64,
}

/// What each ray hits first in a tree, among what has a category in `mask`, if there is one.
pub fn first_hits<T: Scalar>(
    tree: &Quadtree<T>,
    rays: &[Ray<T>],
    mask: Option<u32>,
) -> Result<RayHits<T>> {
    let rows = tree.rows();
    first_hits_by(rays, tree.settings().threads, |best| {
        best.look(tree, mask, &|place| Some(u64::from(rows[place])));
    })
}

/// As [`first_hits`]; `look` lets a ray see the shapes that there are.
pub fn first_hits_by<T: Scalar>(
    rays: &[Ray<T>],
    threads: Option<usize>,
    look: impl Fn(&mut FirstHit<T>) + Sync + Send,
) -> Result<RayHits<T>> {
    let threads = worthwhile(threads, rays.len());
    let order = along_a_curve(rays.iter().map(|ray| ray.origin))?;
    let stop = Stop::current();
    let parts: Vec<&[u32]> = order.chunks(QUESTIONS).collect();
    let found = parallel::map(threads, parts.len(), |part| {
        let mut pulse = Pulse::of(&stop);
        let mut found = Vec::with_capacity(parts[part].len());
        for &question in parts[part] {
            pulse.check(NODE_WORK)?;
            let mut best = FirstHit::new(rays[question as usize], pulse);
            look(&mut best);
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
    for (&question, &(hit, tests)) in order.iter().zip(found.iter().flatten()) {
        if let Some((distance, id)) = hit {
            all.ids[question as usize] = id as i64;
            all.distances[question as usize] = distance;
        }
        all.tests += tests;
    }
    Ok(all)
}
