//! Rays and the paths of moving discs and boxes: the distance to a shape, and the normal there.

use std::borrow::Cow;

use super::check_max_distances;
use crate::geometry::{
    self, Difference, Scalar, Shape, into_circle, into_range, length, middle, within,
};
use crate::period::Period;
use crate::shapes::{Each, check_each_half_size, check_finite, check_radii, tuple};
use jostle_base::error::{Error, Result};
use jostle_base::memory;

/// A ray, or the path of a rounded box; the half size and the radius of a ray are 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray<T> {
    pub(super) origin: [T; 2],
    /// A unit vector, up to rounding.
    pub(super) direction: [T; 2],
    pub(super) half_size: [T; 2],
    pub(super) radius: T,
    pub(super) max_distance: T,
    /// The id of a shape that it passes; [`NO_ID`] if there is none.
    pub(super) exclude: u64,
}

/// No id of a shape.
const NO_ID: u64 = -1_i64 as u64;

/// Maximum length of a ray in a periodic plane, in periods.
const MAX_PERIODS: f64 = 1024.0;

impl<T: Scalar> Ray<T> {
    /// Rays: one for each row of an argument, or one. Directions may have any length except 0.
    pub fn all(
        origins: &Each<[T; 2]>,
        directions: &Each<[T; 2]>,
        radii: &Each<T>,
        max_distances: impl Into<Each<T>>,
    ) -> Result<Vec<Self>> {
        let none = Each::One([T::ZERO; 2]);
        Self::of_boxes(origins, directions, (&none, radii), &max_distances.into())
    }

    /// As [`Ray::all`], the paths of rounded boxes with these half sizes and radii.
    pub fn of_boxes(
        origins: &Each<[T; 2]>,
        directions: &Each<[T; 2]>,
        (half_sizes, radii): (&Each<[T; 2]>, &Each<T>),
        max_distances: &Each<T>,
    ) -> Result<Vec<Self>> {
        let len = origins.len().or(directions.len()).or(half_sizes.len()).or(radii.len());
        let len = len.or(max_distances.len()).unwrap_or(1);
        origins.check_len("origin", len)?;
        directions.check_len("direction", len)?;
        half_sizes.check_len("half_sizes", len)?;
        radii.check_len("radii", len)?;
        max_distances.check_len("max_distance", len)?;
        origins.check(|origins| check_finite("origin", origins))?;
        directions.check(check_directions)?;
        check_each_half_size("half_sizes", half_sizes)?;
        radii.check(|radii| check_radii("radii", radii))?;
        max_distances.check(check_max_distances)?;
        let ray = |row| Self {
            origin: origins.at(row),
            direction: unit(directions.at(row)),
            half_size: half_sizes.at(row),
            radius: radii.at(row),
            max_distance: max_distances.at(row),
            exclude: NO_ID,
        };
        memory::collect((0..len).map(ray))
    }

    /// Where it starts.
    pub fn origin(&self) -> [T; 2] {
        self.origin
    }

    /// Its direction, a unit vector up to rounding.
    pub fn direction(&self) -> [T; 2] {
        self.direction
    }

    /// The half size and the radius of the shape that moves along it.
    pub fn shape(&self) -> ([T; 2], T) {
        (self.half_size, self.radius)
    }

    /// The same rays, of which each passes the shape with an id; −1 is none.
    pub fn excluding(mut rays: Vec<Self>, ids: &Each<i64>) -> Result<Vec<Self>> {
        ids.check_len("exclude", rays.len())?;
        rays.iter_mut().enumerate().for_each(|(row, ray)| ray.exclude = ids.at(row) as u64);
        Ok(rays)
    }

    /// The same rays with their origins in the first period. Refuses rays that pass through too
    /// many periods.
    pub fn in_period<'r>(rays: &'r [Self], period: &Period<T>) -> Result<Cow<'r, [Self]>> {
        if period.is_none() {
            return Ok(Cow::Borrowed(rays));
        }
        let sides = period.sides().map(T::to_f64);
        let shorter = sides.into_iter().filter(|&side| side > 0.0).fold(f64::INFINITY, f64::min);
        let longest = MAX_PERIODS * shorter;
        if let Some(row) = rays.iter().position(|ray| ray.max_distance.to_f64() > longest) {
            let rule = format!(
                "with period={}, it must be at most {MAX_PERIODS} periods, {longest}",
                tuple(&period.sides())
            );
            let error = Error::at("max_distance", row, rays[row].max_distance, &rule);
            return Err(if rays.len() == 1 { error.without_row() } else { error });
        }
        let wrapped = |ray: &Self| Self { origin: period.wrap(ray.origin), ..*ray };
        memory::collect(rays.iter().map(wrapped)).map(Cow::Owned)
    }

    /// The place at a distance along the ray, and `by` more.
    pub(super) fn place(&self, distance: T, by: [T; 2]) -> [T; 2] {
        [0, 1].map(|axis| self.origin[axis] + self.direction[axis] * distance + by[axis])
    }

    /// The same ray moved by `-shift`.
    #[inline(always)]
    pub(super) fn moved(&self, shift: [T; 2]) -> Self {
        let origin = [self.origin[0] - shift[0], self.origin[1] - shift[1]];
        Self { origin, ..*self }
    }

    /// The shape that moves, at its start.
    fn start(&self) -> Shape<T> {
        let Self { origin, half_size, radius, .. } = *self;
        let core = geometry::Core::Box;
        Shape { min: origin, max: origin, half_size, radius, category: 0, mask: 0, core }
    }

    /// A shape extended by the half size of the ray.
    #[inline(always)]
    fn extended(&self, shape: &Shape<T>) -> Shape<T> {
        let [hx, hy] = shape.half_size;
        Shape { half_size: [hx + self.half_size[0], hy + self.half_size[1]], ..*shape }
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
/// A moving disc or box hits a shape if its centre hits the Minkowski sum of both. For two circles
/// that is a larger circle; for a box the union of two larger boxes and a circle at each corner.
pub fn hit<T: Scalar>(ray: &Ray<T>, shape: &Shape<T>) -> Option<T> {
    if shape.is_slanted() {
        let difference = Difference::of(&ray.start(), shape);
        if difference.touches() {
            return Some(T::ZERO);
        }
        return difference.entry(ray.direction).map(|(distance, _)| distance);
    }
    let shape = ray.extended(shape);
    let Shape { min, max, half_size: [hx, hy], .. } = shape;
    let radius_sum = shape.radius + ray.radius;
    let [x, y] = shape.gaps_to(ray.origin);
    // Inside or touching first, with the formula of points. What follows may assume that the start
    // is outside, and never has to choose between two hits behind it.
    if within(x.max(T::ZERO), y.max(T::ZERO), radius_sum) {
        return Some(T::ZERO);
    }
    let far = |axis: usize| {
        (ray.origin[axis] - min[axis]).abs().max((ray.origin[axis] - max[axis]).abs())
    };
    // The largest number of the calculation decides. A power of two rounds nothing.
    let [into, back] = into_range(far(0).max(far(1)).max(hx.max(hy)).max(radius_sum));
    // Scaled before the subtraction, which may overflow.
    let from = |corner: [T; 2]| [0, 1].map(|axis| ray.origin[axis] * into - corner[axis] * into);
    let half_size = [hx * into, hy * into];
    let core = Core { min: from(min), max: from(max), half_size, is_box: min != max };
    hit_in_range(&core, radius_sum * into, ray).map(|distance| distance * back)
}

/// The unit normal of a shape where a ray hits it at a distance, pointing away from the shape; (0,
/// 0) at distance 0, where the ray starts inside or touches.
pub fn normal<T: Scalar>(ray: &Ray<T>, shape: &Shape<T>, distance: T) -> [T; 2] {
    if distance == T::ZERO {
        return [T::ZERO; 2];
    }
    if shape.is_slanted() {
        let entry = Difference::of(&ray.start(), shape).entry(ray.direction);
        return entry.map_or([T::ZERO; 2], |(_, normal)| normal);
    }
    let Shape { min, max, half_size, radius, .. } = ray.extended(shape);
    let (mut gaps, mut signs) = ([T::ZERO; 2], [T::ONE; 2]);
    for axis in 0..2 {
        let at = ray.origin[axis] + ray.direction[axis] * distance;
        let (above, below) = (at - max[axis], min[axis] - at);
        gaps[axis] = above.max(below) - half_size[axis];
        signs[axis] = if above < below { -T::ONE } else { T::ONE };
    }
    let (x, y) = (gaps[0].max(T::ZERO), gaps[1].max(T::ZERO));
    let far = length(x, y);
    // The nearest point of the core is a corner or lies on a side, so the normal points from it.
    // Without a radius `far` is a rounding error of the hit, with an arbitrary direction.
    if radius + ray.radius > T::ZERO && far > T::ZERO {
        return [x / far * signs[0], y / far * signs[1]];
    }
    // A side without rounding: the axis with the larger gap, but none along which the ray does not move. Of a core
    // without width both sides are at the same place, up to rounding; the one that is hit faces the ray.
    let facing = |axis: usize| if ray.direction[axis] > T::ZERO { -T::ONE } else { T::ONE };
    let [along_x, along_y] = ray.direction.map(|along| along != T::ZERO);
    let is_y = if along_x && along_y { gaps[0] < gaps[1] } else { along_y };
    if is_y { [T::ZERO, facing(1)] } else { [facing(0), T::ZERO] }
}

/// From the place of a moving shape when it hits another, to the point where they touch: on the surface of the shape
/// that is hit, in the middle if they touch along sides. It is (0, 0) for a ray.
pub(super) fn touch<T: Scalar>(
    ray: &Ray<T>,
    shape: &Shape<T>,
    distance: T,
    normal: [T; 2],
) -> [T; 2] {
    if ray.half_size == [T::ZERO; 2] && ray.radius == T::ZERO || distance == T::ZERO {
        return [T::ZERO; 2];
    }
    if shape.is_slanted() {
        return touch_of_line(ray, shape, distance, normal);
    }
    [0, 1].map(|axis| {
        let at = ray.origin[axis] + ray.direction[axis] * distance;
        // The core of the shape, seen from there.
        let (low, high) = (
            shape.min[axis] - shape.half_size[axis] - at,
            shape.max[axis] + shape.half_size[axis] - at,
        );
        let half = ray.half_size[axis];
        // The point of the core that is nearest to the core that moves; where both overlap along
        // the axis, the middle of the overlap.
        let nearest = if low >= half {
            low
        } else if high <= -half {
            high
        } else {
            middle(low.max(-half), high.min(half))
        };
        nearest + normal[axis] * shape.radius
    })
}

/// [`touch`] for a slanted segment.
fn touch_of_line<T: Scalar>(ray: &Ray<T>, shape: &Shape<T>, distance: T, normal: [T; 2]) -> [T; 2] {
    // A side of the box has met an end of the segment: the end that is farthest along the normal.
    if let Some(axis) = (0..2).find(|&axis| normal[axis] == T::ZERO)
        && let Some([start, end]) = shape.segment()
    {
        let along = 1 - axis;
        let is_end = (end[along] - start[along]) * normal[along] > T::ZERO;
        let place = if is_end { end } else { start };
        return [0, 1].map(|axis| {
            let at = ray.origin[axis] + ray.direction[axis] * distance;
            place[axis] - at + normal[axis] * shape.radius
        });
    }
    // A corner of the moving shape has met the segment.
    [0, 1].map(|axis| {
        let half = ray.half_size[axis];
        let corner = if normal[axis] > T::ZERO { -half } else { half };
        corner - normal[axis] * ray.radius
    })
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
    // The first of six: of a convex union the ray enters the part that it reaches first. All six
    // are computed, since which parts lie behind others costs more to find out.
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

/// The distance to a box along `u` from a point outside of it (slab method).
fn into_box<T: Scalar>(Core { min, max, half_size, .. }: &Core<T>, u: [T; 2]) -> Option<T> {
    let (mut enter, mut leave) = (T::ZERO, T::INFINITY);
    for axis in 0..2 {
        // Parallel to the slab: a division would give 0 / 0 for a start at its edge.
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
