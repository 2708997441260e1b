//! A shape that moves among obstacles, and never ends a motion inside one.

use std::cmp::Ordering;

use super::outline::Outline;
use super::rules::{CheckedRules, Surface, along_surface, dot};
use super::solid::{FindObstacles, Obstacle};
use jostle_index::geometry::{Bounds, Scalar, Shape};
use jostle_index::period::Period;

/// Roundings of a position, in units in the last place of the largest number involved. A path
/// enters an obstacle only if it is deeper inside than this.
const ROUNDINGS: f64 = 16.0;

/// Attempts to move a shape out of the obstacles that it overlaps by rounding.
const ATTEMPTS: usize = 8;

/// Minimum share of a displacement along the normal of an obstacle for which a shape is moved back
/// along its path. Otherwise shapes that move along a floor would lose a part of their
/// displacement.
const MIN_APPROACH: f64 = 0.6;

/// Maximum length of a displacement along a surface out of an obstacle, divided by that of the
/// shortest displacement out of it.
const LONGEST_AROUND: f64 = 16.0;

/// Displacements up to this many sizes of the shape need one search of obstacles in all.
const SHORT: f64 = 4.0;

/// An obstacle that a shape met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlideHit<T> {
    /// The index of the obstacle.
    pub index: u32,
    /// Unit normal of its surface, towards the shape that met it.
    pub normal: [T; 2],
}

/// A moving shape and the obstacles near it. In a periodic plane it begins in the first period and
/// may leave it; obstacles have images.
pub struct Walker<'a, T> {
    pub(super) rules: &'a CheckedRules<T>,
    pub(super) period: Period<T>,
    find: &'a mut FindObstacles<'a, T>,
    pub(super) body: Shape<T>,
    pub(super) near: &'a mut Vec<Obstacle<T>>,
    /// The region whose obstacles are in `near`: lower and upper corner.
    known: Option<[[T; 2]; 2]>,
    /// The region whose obstacles had an effect: lower and upper corner.
    pub seen: [[T; 2]; 2],
    /// The obstacles met.
    pub hits: Vec<SlideHit<T>>,
    /// The displacement without its components into the obstacles met.
    pub remaining: [T; 2],
}

impl<'a, T: Scalar> Walker<'a, T> {
    /// A shape given by its centre. `near` is scratch.
    pub fn new(
        (rules, period): (&'a CheckedRules<T>, Period<T>),
        body: Shape<T>,
        near: &'a mut Vec<Obstacle<T>>,
        find: &'a mut FindObstacles<'a, T>,
    ) -> Self {
        let seen = [body.min; 2];
        let (hits, remaining) = (Vec::new(), [T::ZERO; 2]);
        Self { rules, period, find, body, near, known: None, seen, hits, remaining }
    }

    /// Its centre.
    pub fn center(&self) -> [T; 2] {
        self.body.min
    }

    /// Repeats the motions that have brought the obstacles to where they are, all at the same time,
    /// while the floor on which it stands carries it by `displacement`. What meets it pushes it,
    /// and an obstacle that moves with its floor is at rest relative to it. Between obstacles that
    /// leave it no room along the path, it stays where it was, if it is free there.
    pub fn carry(&mut self, displacement: [T; 2]) {
        let start = self.body;
        let was_inside = self.overlap(T::ONE).is_some_and(|(_, depth, close)| depth > close);
        // The obstacles are at the end of their motion already. They are taken back to its start,
        // and then all move at the same time: if they moved first, a fast platform would jump
        // through the shape.
        self.follow(displacement);
        // Squeezed between two that move towards each other, or out of `ATTEMPTS`. The place at the
        // start may be free now, and is the only other one that is known.
        if !was_inside && self.overlap(T::ZERO).is_some() {
            let end = std::mem::replace(&mut self.body, start);
            if self.overlap(T::ZERO).is_some() {
                self.body = end;
            }
        }
    }

    fn follow(&mut self, displacement: [T; 2]) {
        let (mut velocity, mut left) = (displacement, T::ONE);
        for _ in 0..ATTEMPTS {
            let rest = velocity.map(|v| v * left);
            // An image of an obstacle is searched at one place. A path longer than the period would
            // pass it twice.
            if self.period.is_exceeded_by(rest) {
                return;
            }
            self.look(rest);
            let is_still = |obstacle: &Obstacle<T>| obstacle.motion == [T::ZERO; 2];
            if rest == [T::ZERO; 2] && self.near.iter().all(is_still) {
                return;
            }
            let Some((share, hit, motion)) = self.advance(rest, left) else { return };
            self.record(hit);
            // The shares of time multiply: after half of the way a third of the rest leaves a
            // third.
            left = left * (T::ONE - share);
            // In the frame of the obstacle it stands still, so the rule for standing obstacles
            // applies. Then its velocity is added again, which pushes the shape along.
            let relative = [velocity[0] - motion[0], velocity[1] - motion[1]];
            let [x, y] = along_surface(self.rules, relative, hit.normal);
            velocity = [motion[0] + x, motion[1] + y];
        }
    }

    /// Moves it out of the obstacles that it overlaps, the deepest overlap first: along the normal,
    /// and, if another obstacle stops it, along the surface of that one. Returns whether it is free
    /// afterwards.
    pub fn leave_obstacles(&mut self) -> bool {
        for _ in 0..ATTEMPTS {
            let Some((normal, depth, _)) = self.overlap(T::ZERO) else { return true };
            // Out by a rounding error more than the depth, or the shape would still overlap in half
            // of all cases.
            let out = -(depth + self.slop(depth));
            let out = [normal[0] * out, normal[1] * out];
            if let Some((share, hit)) = self.shift(out)
                // Another obstacle is in the way: along its surface, as far as brings the whole
                // displacement in the direction out. At a sharp angle that would be a long way,
                // which is not taken.
                && let Some(around) = around(out.map(|v| v * (T::ONE - share)), hit.normal)
            {
                self.shift(around);
            }
        }
        self.is_free()
    }

    /// Whether it overlaps no obstacle by more than rounding errors.
    pub fn is_free(&mut self) -> bool {
        self.overlap(T::ZERO).is_none_or(|(_, depth, close)| depth <= close)
    }

    /// The deepest overlap with an obstacle, before the share `left` of its motion: as
    /// [`deepest`](Self::deepest).
    fn overlap(&mut self, left: T) -> Option<([T; 2], T, T)> {
        self.look([T::ZERO; 2]);
        let (rules, period, close) = (self.rules, self.period, self.slop(T::ZERO));
        // By rounding, its floor may have moved it into the floor itself, which must still stop it.
        let is_solid = |near: &Obstacle<T>| {
            near.facing((&period, left), &self.body, |body, solid| {
                is_solid_for(rules, near, (body, solid), close)
            })
        };
        self.deepest(&self.body, left, &is_solid)
    }

    /// Moves it by a displacement that is not its own, up to the first obstacle. It does not leave
    /// an obstacle that is wider than a period.
    fn shift(&mut self, displacement: [T; 2]) -> Option<(T, SlideHit<T>)> {
        if self.period.is_exceeded_by(displacement) {
            return None;
        }
        let (share, hit) = self.cast(displacement)?;
        self.record(hit);
        Some((share, hit))
    }

    /// Adds a hit of a motion that is not its own, unless the obstacle has been met before.
    fn record(&mut self, hit: SlideHit<T>) {
        if self.hits.iter().all(|before| before.index != hit.index) {
            self.hits.push(hit);
        }
    }

    /// Moves it by a displacement, sliding along obstacles.
    pub fn slide(&mut self, displacement: [T; 2]) {
        self.remaining = displacement;
        self.slide_by(displacement, |_, _, _| None);
    }

    /// As [`slide`](Self::slide), without a new [`remaining`](Self::remaining). `choose` is called
    /// with the rest of the displacement at each obstacle; if it returns another rest, it has
    /// recorded what was met, else the shape slides along the obstacle.
    pub(super) fn slide_by(
        &mut self,
        displacement: [T; 2],
        mut choose: impl FnMut(&mut Self, [T; 2], SlideHit<T>) -> Option<[T; 2]>,
    ) {
        let mut rest = displacement;
        // A motion is a sequence of casts: look for what is near, go to the first impact, take the
        // component into the surface from the rest, repeat. Each step ends at a place without
        // overlap (`advance`), so the loop may stop after any number of them. Between two surfaces
        // at a sharp angle it would never end by itself.
        for _ in 0..self.rules.max_slides {
            if rest == [T::ZERO; 2] {
                return;
            }
            let Some((share, hit)) = self.cast(rest) else { return };
            let left = [rest[0] * (T::ONE - share), rest[1] * (T::ONE - share)];
            rest = choose(self, left, hit).unwrap_or_else(|| {
                self.hits.push(hit);
                // The whole displacement, not the rest: callers take it as the velocity that is
                // left after the step.
                self.remaining = along_surface(self.rules, self.remaining, hit.normal);
                along_surface(self.rules, left, hit.normal)
            });
        }
    }

    /// Moves it by a displacement up to the first obstacle. Returns the share of the displacement
    /// and the obstacle.
    pub(super) fn cast(&mut self, displacement: [T; 2]) -> Option<(T, SlideHit<T>)> {
        self.look(displacement);
        let (share, hit, _) = self.advance(displacement, T::ZERO)?;
        Some((share, hit))
    }

    /// Upper bound of the rounding errors of a position at a distance.
    pub(super) fn slop(&self, distance: T) -> T {
        slop(&self.body, &self.period, distance)
    }

    /// Finds the obstacles along the path, unless they are known.
    pub(super) fn look(&mut self, displacement: [T; 2]) {
        let center = self.body.min;
        // Room for rounding on either side, so that what a test with slop could find has been
        // listed.
        let slop = self.slop(length(displacement));
        let margin = [0, 1].map(|axis| extent(&self.body, axis) + (slop + slop) + (slop + slop));
        let low = |axis: usize| center[axis] + displacement[axis].min(T::ZERO) - margin[axis];
        let high = |axis: usize| center[axis] + displacement[axis].max(T::ZERO) + margin[axis];
        let (min, max) = ([low(0), low(1)], [high(0), high(1)]);
        for axis in 0..2 {
            self.seen[0][axis] = self.seen[0][axis].min(min[axis]);
            self.seen[1][axis] = self.seen[1][axis].max(max[axis]);
        }
        // A short slide needs one search: the first region is large enough for all later parts of
        // the path. Long ones would list too many obstacles that way, so each part is searched by
        // itself.
        if self.known.is_some_and(|known| contains(known, [min, max])) {
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

    /// Moves it along a displacement until it meets an obstacle, while obstacles make the share
    /// `left` of their motions. Returns the share of the displacement that it has made, the
    /// obstacle and the motion of this. Obstacles that it overlaps at the start do not stop it.
    fn advance(&mut self, displacement: [T; 2], left: T) -> Option<(T, SlideHit<T>, [T; 2])> {
        let start = self.body;
        let (rules, period) = (self.rules, self.period);
        // An obstacle is moved back to its start with rounding errors.
        // Moved back and forth it may be off by a rounding of the way, not of its coordinates
        // alone.
        let back = |obstacle: &Obstacle<T>| length(obstacle.motion) * left;
        let is_solid = |obstacle: &Obstacle<T>| {
            let close = slop(&start, &period, back(obstacle));
            obstacle.facing((&period, left), &start, |body, solid| {
                // What the shape is inside of does not stop it. Otherwise a shape that spawned in a
                // wall could never move; so it can leave, and not enter any other.
                let is_outside =
                    !solid.overlaps(body) || (left != T::ZERO && solid.contact(body).1 <= close);
                is_outside && is_solid_for(rules, obstacle, (body, solid), close)
            })
        };
        let impact = |obstacle: &'_ Obstacle<T>| {
            let motion = obstacle.motion;
            let relative = [0, 1].map(|axis| displacement[axis] - motion[axis] * left);
            obstacle.facing((&period, left), &start, |body, solid| {
                // Rounding errors grow with the distance of the obstacle, not with the
                // displacement.
                let slop = self.slop(solid.span(body) + back(obstacle));
                let (share, normal) = solid.enters(body, relative, slop)?;
                // −0 becomes 0.
                Some((share + T::ZERO, normal))
            })
        };
        let solid = self.near.iter().filter(|obstacle| is_solid(obstacle));
        let impacts = solid.filter_map(|obstacle| Some((impact(obstacle)?, obstacle)));
        // A floor before a wall, so that the joints of tiles do not stop a shape.
        // Between equal shares the surface that faces up most. At a joint of two tiles the corner
        // of the next tile is met at the same time as the floor: taken first, it would stop a walk
        // on flat ground.
        let height = |normal: [T; 2]| dot(normal, rules.up) + T::ZERO;
        let first = impacts.min_by(|((a, a_normal), a_of), ((b, b_normal), b_of)| {
            a.total_order(b)
                .then_with(|| height(*b_normal).total_order(&height(*a_normal)))
                .then_with(|| a_of.order(b_of))
        });
        let first = first.map(|((share, normal), obstacle)| {
            (share, SlideHit { index: obstacle.index, normal }, obstacle.motion)
        });
        let share = first.map_or(T::ONE, |(share, ..)| share);
        let motion = first.map_or([T::ZERO; 2], |(.., motion)| motion);
        // The slop of the path up to the impact, not of the whole displacement: what lies beyond
        // rounds nothing here.
        let path = (length(displacement) + length(motion) * left) * share;
        let slop = self.slop(path);
        let (end, reached) = self.free_end(displacement, (share, left), slop, &is_solid);
        self.body.min = end;
        self.body.max = end;
        first.map(|(share, hit, motion)| {
            // For standing obstacles the share of the impact itself, so that the rest of a motion
            // does not depend on the last bits of the place. For moving ones time and place have to
            // match, so the share that was reached.
            (if left == T::ZERO { share } else { reached }, hit, motion)
        })
    }

    /// The deepest overlap of a shape with a solid obstacle, before the share `left` of its motion:
    /// the unit normal towards the obstacle, the depth, and the upper bound of its rounding errors.
    fn deepest(
        &self,
        body: &Shape<T>,
        left: T,
        is_solid: &impl Fn(&Obstacle<T>) -> bool,
    ) -> Option<([T; 2], T, T)> {
        let at = (&self.period, left);
        let overlaps = |near: &Obstacle<T>| near.facing(at, body, |body, it| it.overlaps(body));
        let inside = self.near.iter().filter(|near| overlaps(near) && is_solid(near));
        let contact = |near: &Obstacle<T>| near.facing(at, body, |body, solid| solid.contact(body));
        let deepest = inside.map(|near| (contact(near), near)).reduce(|a, b| {
            // The deepest first: moving out of it most likely ends the others. Ties by geometry, as
            // in `Obstacle::order`.
            let order = b.0.1.total_order(&a.0.1).then_with(|| a.1.order(b.1));
            if order == Ordering::Greater { b } else { a }
        });
        let ((normal, depth), near) = deepest?;
        let span = near.facing(at, body, |body, solid| solid.span(body));
        Some((normal, depth, self.slop(span)))
    }

    /// The position after a share of a displacement, changed by rounding errors only, at which
    /// no solid obstacle is overlapped, and the share. Meanwhile obstacles make this share of what
    /// is `left` of their motions. `slop` bounds the rounding errors of the path.
    fn free_end(
        &self,
        displacement: [T; 2],
        (share, left): (T, T),
        slop: T,
        is_solid: &impl Fn(&Obstacle<T>) -> bool,
    ) -> ([T; 2], T) {
        let start = self.body.min;
        let at =
            |share: T| [start[0] + displacement[0] * share, start[1] + displacement[1] * share];
        let overlapped = |center: [T; 2], share: T| {
            let body = Shape { min: center, max: center, ..self.body };
            self.deepest(&body, left * (T::ONE - share), is_solid)
        };
        // The promise of this module: the place that is returned overlaps nothing solid, by the
        // formula of the queries. The impact is rounded, so the place may be inside by a few slops.
        //
        // First it is moved out along the path or the normal, by 1/64 of a slop at the beginning
        // and twice as much after each attempt: most places need the least, and a walk along a
        // floor stays at the same height.
        //
        // If that does not help, the path is taken back, four times further each time, down to the
        // start, which is free by assumption. So the loop ends.
        let mut center = at(share);
        let mut factor = T::from_f64(1.0 / 64.0);
        for _ in 0..ATTEMPTS {
            let Some((normal, depth, close)) = overlapped(center, share) else {
                return (center, share);
            };
            let slop = slop.max(close);
            // Not a rounding error: the place is inside something else. Moving out of it would be a
            // motion that nobody asked for.
            if depth > slop + slop + slop + slop {
                break;
            }
            let out = depth + slop * factor;
            center = self.moved_out(center, displacement, normal, out);
            factor = factor + factor;
        }
        // From one epsilon by factors of four to 1: about 26 steps in float64, 12 in float32.
        let (mut share, mut back) = (share, T::EPSILON);
        loop {
            share = share - back;
            back = back * T::from_f64(4.0);
            let is_ahead = share > T::ZERO;
            if !is_ahead {
                return (start, T::ZERO);
            }
            let center = at(share);
            if overlapped(center, share).is_none() {
                return (center, share);
            }
        }
    }

    /// A position moved by `out` away from an obstacle: back along the path, so that a shape that
    /// stands on a slope does not creep down it, but not behind the start; else along the normal.
    fn moved_out(&self, center: [T; 2], path: [T; 2], normal: [T; 2], out: T) -> [T; 2] {
        let approach = dot(path, normal);
        let back = path.map(|v| v * (out / approach));
        let new = [center[0] - back[0], center[1] - back[1]];
        let displacement = [new[0] - self.body.min[0], new[1] - self.body.min[1]];
        // At a flat angle a small distance along the normal is a long way back along the path. The
        // length is that of the sum of both components, at most 1.42 times the real one.
        if approach > length(path) * T::from_f64(MIN_APPROACH) && dot(displacement, path) >= T::ZERO
        {
            return new;
        }
        [center[0] - normal[0] * out, center[1] - normal[1] * out]
    }

    /// The last obstacle of this kind that it met.
    pub fn last_of(&self, kind: Surface) -> Option<u32> {
        self.hits.iter().rev().find(|hit| self.rules.kind(hit.normal) == kind).map(|hit| hit.index)
    }
}

/// Upper bound of the rounding errors of a position at a distance from a shape given by its centre.
pub fn slop<T: Scalar>(body: &Shape<T>, period: &Period<T>, distance: T) -> T {
    let size = |axis: usize| body.min[axis].abs() + extent(body, axis) + period.sides()[axis];
    // Rounding errors are in proportion to the numbers that are added: coordinates, sizes, the
    // period, the way.
    (size(0).max(size(1)) + distance) * T::EPSILON * T::from_f64(ROUNDINGS)
}

/// Distance from the centre of a shape given by its centre to the side of its bounding box.
#[inline(always)]
pub(super) fn extent<T: Scalar>(body: &Shape<T>, axis: usize) -> T {
    body.half_size[axis] + body.radius
}

#[inline(always)]
pub(super) fn length<T: Scalar>(v: [T; 2]) -> T {
    v[0].abs() + v[1].abs()
}

/// The displacement along a surface that has a displacement `out` as its component; None if it is
/// more than [`LONGEST_AROUND`] times as long.
fn around<T: Scalar>(out: [T; 2], surface: [T; 2]) -> Option<[T; 2]> {
    let tangent = [-surface[1], surface[0]];
    let along = dot(out, tangent);
    let square = dot(out, out);
    let longest = T::from_f64(LONGEST_AROUND);
    // Squares, so that no root is needed. The part of `out` along the surface decides how much
    // longer the way is.
    (along * along * longest * longest >= square && square > T::ZERO)
        .then(|| tangent.map(|v| v * (square / along)))
}

/// Whether a region, as lower and upper corner, contains another.
pub fn contains<T: Scalar>(outer: [[T; 2]; 2], inner: [[T; 2]; 2]) -> bool {
    (0..2).all(|axis| outer[0][axis] <= inner[0][axis] && inner[1][axis] <= outer[1][axis])
}

/// Whether an obstacle stops a shape: if it is one-way, only a shape above it.
fn is_solid_for<T: Scalar>(
    rules: &CheckedRules<T>,
    obstacle: &Obstacle<T>,
    (body, outline): (&Shape<T>, &dyn Outline<T>),
    slop: T,
) -> bool {
    let is_one_way = obstacle.solid.category() & rules.one_way != 0;
    !is_one_way || (rules.up != [T::ZERO; 2] && outline.is_above(body, rules.up, slop))
}
