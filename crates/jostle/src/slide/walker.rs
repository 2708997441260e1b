//! A shape that moves among obstacles, and never ends a motion inside one.

use super::cast::enters;
use super::{FindObstacles, Obstacle, SlideHit, SlideRules, Surface, along_surface, dot};
use crate::geometry::{self, Bounds, Scalar, Shape, gap, overlap};

/// Roundings of a position, in units in the last place of the largest number involved. Deeper than
/// this a path enters an obstacle.
const ROUNDINGS: f64 = 16.0;

/// Attempts to move a shape out of the obstacles that it overlaps by rounding.
const ATTEMPTS: usize = 8;

/// Displacements up to this many sizes of the shape need one search of obstacles in all.
const SHORT: f64 = 4.0;

/// A moving shape and the obstacles near it.
pub struct Walker<'a, T> {
    rules: &'a SlideRules<T>,
    find: &'a mut FindObstacles<'a, T>,
    body: Shape<T>,
    near: &'a mut Vec<Obstacle<T>>,
    /// The region whose obstacles are in `near`: lower and upper corner.
    known: Option<[[T; 2]; 2]>,
    /// The obstacles met.
    pub hits: Vec<SlideHit<T>>,
    /// The displacement without its components into the obstacles met.
    pub remaining: [T; 2],
}

impl<'a, T: Scalar> Walker<'a, T> {
    /// A shape given by its centre. `near` is memory.
    pub fn new(
        rules: &'a SlideRules<T>,
        body: Shape<T>,
        near: &'a mut Vec<Obstacle<T>>,
        find: &'a mut FindObstacles<'a, T>,
    ) -> Self {
        Self { rules, find, body, near, known: None, hits: Vec::new(), remaining: [T::ZERO; 2] }
    }

    /// Its centre.
    pub fn center(&self) -> [T; 2] {
        self.body.min
    }

    /// Moves it with the obstacle on which it stands, which has moved by `displacement`; other
    /// obstacles stop it.
    pub fn carry(&mut self, displacement: [T; 2], floor: u32) {
        self.look(displacement);
        self.advance(displacement, Some(floor));
    }

    /// Moves it out of the obstacles that it overlaps, the deepest overlap first, as far as others
    /// allow.
    pub fn leave_obstacles(&mut self) {
        for _ in 0..ATTEMPTS {
            self.look([T::ZERO; 2]);
            let body = self.body;
            let inside = self.near.iter().filter(|near| {
                near.shape.category & self.rules.one_way == 0 && overlaps(&body, &near.shape)
            });
            let contacts = inside.map(|near| geometry::contact(&body, &near.shape));
            let Some((normal, depth)) = contacts.reduce(|a, b| if b.1 > a.1 { b } else { a })
            else {
                return;
            };
            let out = -(depth + self.slop(depth));
            let displacement = [normal[0] * out, normal[1] * out];
            self.look(displacement);
            self.advance(displacement, None);
        }
    }

    /// Moves it by a displacement, sliding along obstacles.
    pub fn slide(&mut self, displacement: [T; 2]) {
        self.remaining = displacement;
        let mut rest = displacement;
        while rest != [T::ZERO; 2] && self.hits.len() < self.rules.max_slides {
            self.look(rest);
            let Some((share, hit)) = self.advance(rest, None) else { return };
            self.hits.push(hit);
            let left = [rest[0] * (T::ONE - share), rest[1] * (T::ONE - share)];
            rest = along_surface(self.rules, left, hit.normal);
            self.remaining = along_surface(self.rules, self.remaining, hit.normal);
        }
    }

    /// Upper bound of the rounding errors of a position at a distance.
    fn slop(&self, distance: T) -> T {
        let size = |axis: usize| self.body.min[axis].abs() + extent(&self.body, axis);
        (size(0).max(size(1)) + distance) * T::EPSILON * T::from_f64(ROUNDINGS)
    }

    /// Finds the obstacles on the way, unless they are known.
    fn look(&mut self, displacement: [T; 2]) {
        let center = self.body.min;
        let slop = self.slop(length(displacement));
        let margin = [0, 1].map(|axis| extent(&self.body, axis) + (slop + slop) + (slop + slop));
        let low = |axis: usize| center[axis] + displacement[axis].min(T::ZERO) - margin[axis];
        let high = |axis: usize| center[axis] + displacement[axis].max(T::ZERO) + margin[axis];
        let (min, max) = ([low(0), low(1)], [high(0), high(1)]);
        let is_within = |[low, high]: [[T; 2]; 2]| {
            (0..2).all(|axis| low[axis] <= min[axis] && max[axis] <= high[axis])
        };
        if self.known.is_some_and(is_within) {
            return;
        }
        let length = length(displacement);
        let short = T::from_f64(SHORT) * (margin[0] + margin[1]);
        let region = if length <= short {
            // Later parts of the path are no longer than the displacement.
            let around = [0, 1].map(|axis| margin[axis] + margin[axis] + length + length);
            [0, 1].map(|side| {
                [0, 1]
                    .map(|axis| center[axis] + if side == 0 { -around[axis] } else { around[axis] })
            })
        } else {
            [min, max]
        };
        self.near.clear();
        let bounds = Bounds {
            min: region[0],
            max: region[1],
            half_size: [T::ZERO; 2],
            radius: T::ZERO,
            category: self.body.category,
            mask: self.body.mask & self.rules.mask,
        };
        (self.find)(&bounds, self.near);
        self.known = Some(region);
    }

    /// Moves it along a displacement until it meets an obstacle; returns the share that it has
    /// moved, and the obstacle. Obstacles that it overlaps at the start do not stop it.
    fn advance(&mut self, displacement: [T; 2], except: Option<u32>) -> Option<(T, SlideHit<T>)> {
        let start = self.body;
        let close = self.slop(T::ZERO);
        let rules = self.rules;
        let is_solid = |obstacle: &Obstacle<T>| {
            Some(obstacle.slot) != except
                && !overlaps(&start, &obstacle.shape)
                && (obstacle.shape.category & rules.one_way == 0
                    || is_above(rules, &start, &obstacle.shape, close))
        };
        let mut first: Option<(T, SlideHit<T>)> = None;
        for obstacle in self.near.iter().filter(|obstacle| is_solid(obstacle)) {
            // Rounding errors grow with the distance of the obstacle, not with the displacement.
            let [x, y] = gaps(&start, &obstacle.shape).map(|gap| gap.max(T::ZERO));
            let slop = self.slop(x + y);
            let Some((share, normal)) = enters(&start, displacement, &obstacle.shape, slop) else {
                continue;
            };
            let hit = SlideHit { slot: obstacle.slot, normal };
            let is_first = first.is_none_or(|(nearest, before)| {
                // A floor before a wall, so that the joints of tiles do not stop a shape.
                let height = |hit: &SlideHit<T>| dot(hit.normal, rules.up);
                share < nearest
                    || (share == nearest
                        && (height(&before), hit.slot) < (height(&hit), before.slot))
            });
            if is_first {
                first = Some((share, hit));
            }
        }
        let share = first.map_or(T::ONE, |(share, _)| share);
        let end = self.free_end(displacement, share, &is_solid);
        self.body.min = end;
        self.body.max = end;
        first
    }

    /// The position after a share of a displacement, changed by rounding errors only, at which
    /// no solid obstacle is overlapped.
    fn free_end(
        &self,
        displacement: [T; 2],
        share: T,
        is_solid: &impl Fn(&Obstacle<T>) -> bool,
    ) -> [T; 2] {
        let start = self.body.min;
        let slop = self.slop(length(displacement) * share);
        let at =
            |share: T| [start[0] + displacement[0] * share, start[1] + displacement[1] * share];
        let overlapped = |center: [T; 2]| {
            let body = Shape { min: center, max: center, ..self.body };
            let solid = self.near.iter().filter(|obstacle| is_solid(obstacle));
            let mut inside = solid.filter(|obstacle| overlaps(&body, &obstacle.shape));
            inside.next().map(|obstacle| geometry::contact(&body, &obstacle.shape))
        };
        let mut center = at(share);
        let mut extra = slop * T::from_f64(1.0 / 64.0);
        for _ in 0..ATTEMPTS {
            let Some((normal, depth)) = overlapped(center) else { return center };
            if depth > slop + slop + slop + slop {
                break;
            }
            let out = depth + extra;
            center = [center[0] - normal[0] * out, center[1] - normal[1] * out];
            extra = extra + extra;
        }
        let (mut share, mut back) = (share, T::EPSILON);
        loop {
            share = share - back;
            back = back * T::from_f64(4.0);
            if share <= T::ZERO {
                return start;
            }
            let center = at(share);
            if overlapped(center).is_none() {
                return center;
            }
        }
    }

    /// The last obstacle of this kind that it met.
    pub fn last_of(&self, kind: Surface) -> Option<u32> {
        self.hits.iter().rev().find(|hit| self.rules.kind(hit.normal) == kind).map(|hit| hit.slot)
    }
}

/// Distance from the centre of a shape given by its centre to the side of its bounding box.
#[inline(always)]
fn extent<T: Scalar>(body: &Shape<T>, axis: usize) -> T {
    body.half_size[axis] + body.radius
}

#[inline(always)]
fn length<T: Scalar>(v: [T; 2]) -> T {
    v[0].abs() + v[1].abs()
}

/// The gaps between the cores of two shapes along each axis.
#[inline(always)]
fn gaps<T: Scalar>(body: &Shape<T>, obstacle: &Shape<T>) -> [T; 2] {
    let along = |axis: usize| {
        let own = [body.min[axis], body.max[axis]];
        gap(own, [obstacle.min[axis], obstacle.max[axis]])
            - (body.half_size[axis] + obstacle.half_size[axis])
    };
    [along(0), along(1)]
}

/// Whether two shapes overlap, by the formula of all queries.
#[inline(always)]
fn overlaps<T: Scalar>(body: &Shape<T>, obstacle: &Shape<T>) -> bool {
    overlap(gaps(body, obstacle), body.radius + obstacle.radius)
}

/// Whether a shape is above an obstacle, as seen from `up`.
fn is_above<T: Scalar>(
    rules: &SlideRules<T>,
    body: &Shape<T>,
    obstacle: &Shape<T>,
    slop: T,
) -> bool {
    let half = T::from_f64(0.5);
    let height = |shape: &Shape<T>| {
        let center = dot(shape.center(), rules.up);
        let along = |axis: usize| {
            let own = (shape.max[axis] - shape.min[axis]) * half + shape.half_size[axis];
            own * rules.up[axis].abs()
        };
        (center, along(0) + along(1) + shape.radius)
    };
    let ((own, own_half), (other, other_half)) = (height(body), height(obstacle));
    rules.up != [T::ZERO; 2] && own - own_half >= other + other_half - slop
}
