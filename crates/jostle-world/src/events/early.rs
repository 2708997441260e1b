//! Tests in float32 that leave out most pairs of discs before anything is computed in float64.

use std::ops::Range;

use super::flight::{DEFERRED, Flight, Start, TimeWindow};
use crate::tolerance::size_of;
use crate::trajectory::Piece;
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_index::pairs::Path;
use jostle_simd::LANES;

/// Relative error, with a large reserve, of the squares of distances in float32. Too large a margin
/// costs exact tests and no result; one that is too small loses collisions. The tests below look
/// for these at random.
pub const MARGIN: f32 = 1e-4;

/// Relative error of positions and displacements in float32, and of what counts as touching, with a
/// reserve.
const ROUNDING: f32 = 1e-6;

/// The straight motion of one disc against another.
struct Passing {
    /// Offset at the beginning.
    offset: [f32; 2],
    velocity: [f32; 2],
    /// Sum of the radii.
    contact_distance: f32,
    /// Sum of the numbers whose rounding matters: positions and displacements.
    sizes: f32,
}

impl Passing {
    /// Whether the two certainly do not touch within `span` seconds. False where numbers overflow.
    #[inline(always)]
    fn is_far(&self, span: f32) -> bool {
        // The square of the distance is a parabola in time. Its minimum within the span, compared
        // with the square of the sum of the radii, needs neither a root nor the time of impact.
        let (approach, ww) = (dot(self.offset, self.velocity), dot(self.velocity, self.velocity));
        let qq = dot(self.offset, self.offset);
        // The time of the closest approach. `max` returns 0 for what is not a number.
        let closest = (-approach / ww).max(0.0).min(span);
        // Without fused multiply-add: the rounding would differ between processors, and with it
        // which pairs are tested further. The result would be the same, because the margin covers
        // both. But the rule holds for all of the state's path.
        let square = qq + (2.0 * approach + ww * closest) * closest;
        square > self.contact_distance * self.contact_distance + self.error(qq)
    }

    /// Upper bound of the error of the square of a distance near the sum of the radii. `square` is
    /// that at the beginning: until the closest approach no term of a later one is larger.
    #[inline(always)]
    fn error(&self, square: f32) -> f32 {
        // An error d of the distance r makes one of (2 r + d) d of the square.
        // Positions are rounded to float32 with an error in proportion to the coordinates. Far from
        // the origin this dominates, near it the relative error of the square does.
        let rounding = 2.0 * ROUNDING * self.sizes;
        MARGIN * square + (2.0 * self.contact_distance + rounding) * rounding
    }
}

/// A block of discs as they begin a window, a column for each value.
#[derive(Clone, Copy, Debug, Default)]
pub struct StartBlock {
    position: [[f32; LANES]; 2],
    velocity: [[f32; LANES]; 2],
    radius: [f32; LANES],
    flags: [u32; LANES],
}

impl StartBlock {
    #[inline(always)]
    fn set(&mut self, lane: usize, start: &Start) {
        for k in 0..2 {
            self.position[k][lane] = start.position[k];
            self.velocity[k][lane] = start.velocity[k];
        }
        self.radius[lane] = start.radius;
        let Start { is_movable, is_supported, falls, is_settled, .. } = *start;
        // One load: the four are beside each other in memory.
        let flags = [is_movable, is_supported, falls, is_settled].map(u8::from);
        self.flags[lane] = u32::from_le_bytes(flags);
    }

    #[inline(always)]
    fn at(&self, lane: usize) -> Start {
        let has = |flag: u32| self.flags[lane] & 1 << (8 * flag) != 0;
        Start {
            // Not by `map`, which copies the columns and prevents vector instructions.
            position: [self.position[0][lane], self.position[1][lane]],
            velocity: [self.velocity[0][lane], self.velocity[1][lane]],
            residual: [0.0; 2],
            radius: self.radius[lane],
            is_movable: has(0),
            is_supported: has(1),
            falls: has(2),
            is_settled: has(3),
        }
    }
}

/// A disc at some time, in float32.
#[derive(Clone, Copy, Debug)]
pub struct Now {
    position: [f32; 2],
    velocity: [f32; 2],
    radius: f32,
    falls: bool,
    /// Upper bound of the numbers from which the position was computed.
    sizes: f32,
}

impl Start {
    /// The disc as it begins.
    #[inline(always)]
    fn now(&self) -> Now {
        let Self { position, velocity, radius, falls, .. } = *self;
        Now { position, velocity, radius, falls, sizes: length(position) }
    }

    /// Whether it is settled in a window of `span` seconds, where `smallest` is the smallest
    /// radius. Two such discs approach by less than [`DEFERRED`] of their size, so nothing happens
    /// to them, also if they overlap.
    #[inline(always)]
    pub fn is_settled(&self, span: f32, smallest: f32) -> bool {
        // Each of two discs moves by at most half of the allowed overlap: its limit is the share of
        // the radius, that of the pair the share of the diameter. The smallest radius of the world
        // stands for that of the unknown partner.
        let farthest = DEFERRED as f32 * self.radius.min(smallest) * (1.0 - MARGIN);
        (self.is_supported | !self.is_movable) & (length(self.velocity) * span <= farthest)
    }

    /// False only if it certainly stays within `reach` of `anchor` for `span` seconds, without events.
    #[inline(always)]
    fn may_leave(&self, anchor: [f32; 2], gravity: [f32; 2], span: f32, reach: f32) -> bool {
        let Self { position, velocity, falls, .. } = *self;
        // Twice the fall from rest, which is simpler than the bound for a parabola, and safe.
        let fall = if falls { length(gravity) * span * span } else { 0.0 };
        let far = length([0, 1].map(|k| position[k] - anchor[k])) + length(velocity) * span + fall;
        let rounding = ROUNDING * (length(position) + length(anchor));
        // The comparison is written so that it is false for NaN, and the disc counts as one that
        // may leave.
        let stays = far * (1.0 + MARGIN) + rounding <= reach;
        // Also true where numbers overflow.
        !stays
    }
}

impl Now {
    /// A disc that begins a piece.
    #[inline(always)]
    pub fn of(piece: &Piece, radius: f64) -> Self {
        let position = piece.position.map(|v| v as f32);
        Self {
            position,
            velocity: piece.velocity.map(|v| v as f32),
            radius: radius as f32,
            falls: piece.falls,
            sizes: length(position),
        }
    }

    /// The motion of another disc against this one for `span` seconds.
    #[inline(always)]
    fn passing(&self, other: &Self, image: [f32; 2], span: f32) -> Passing {
        let contact_distance = self.radius + other.radius;
        Passing {
            offset: [0, 1].map(|k| other.position[k] - self.position[k] + image[k]),
            velocity: [0, 1].map(|k| other.velocity[k] - self.velocity[k]),
            contact_distance,
            // The error of a later position has a share of the displacement as well, so both are in
            // the sum.
            sizes: self.sizes
                + other.sizes
                + (length(self.velocity) + length(other.velocity)) * span
                + contact_distance,
        }
    }

    /// False only if two discs certainly neither touch now nor in the next `span` seconds, without
    /// events.
    #[inline(always)]
    pub fn may_meet(&self, other: &Self, image: [f32; 2], span: f32) -> bool {
        // If one falls and the other does not, the relative motion is a parabola, and a test of a
        // straight line says nothing.
        !self.passing(other, image, span).is_far(span) | (self.falls != other.falls)
    }
}

impl TimeWindow<'_> {
    /// False only if two discs certainly do not meet along their first pieces.
    #[inline(always)]
    pub fn may_meet(&self, [own, other]: [&Start; 2], image: [f32; 2]) -> bool {
        let span = (self.end - self.begin) as f32;
        let passing = own.now().passing(&other.now(), image, span);
        let is_out = !(own.is_movable | other.is_movable) | (own.is_settled & other.is_settled);
        let defers = !self.flight.is_lossless & self.defers(own, other, &passing);
        // Operators without branches: the result of each is as good as random in a gas, and a branch
        // would prevent vector instructions in `may_meet_of`.
        (!passing.is_far(span) | (own.falls != other.falls)) & !defers & !is_out
    }

    /// As [`may_meet`](Self::may_meet), for a block of pairs: 1 for each that may, else 0.
    /// `discs` is scratch.
    #[inline(always)]
    pub fn may_meet_of(
        &self,
        pairs: &[[u32; 2]; LANES],
        image: [f32; 2],
        discs: &mut [StartBlock; 2],
    ) -> [u32; LANES] {
        for (lane, pair) in pairs.iter().enumerate() {
            for k in 0..2 {
                discs[k].set(lane, &self.now[pair[k] as usize]);
            }
        }
        // The rule is written once, for one pair, in plain Rust. Through these columns the compiler
        // makes vector instructions of it.
        let mut may_meet = [0; LANES];
        for (lane, may_meet) in may_meet.iter_mut().enumerate() {
            let (own, other) = (discs[0].at(lane), discs[1].at(lane));
            *may_meet = u32::from(self.may_meet([&own, &other], image));
        }
        may_meet
    }

    /// Whether two discs at rest certainly do not collide, because they approach by less than
    /// [`DEFERRED`], and do not overlap by more.
    #[inline(always)]
    fn defers(&self, own: &Start, other: &Start, passing: &Passing) -> bool {
        let rests = |start: &Start| start.is_supported | !start.is_movable;
        let Passing { offset, velocity, contact_distance, .. } = *passing;
        let size = size_of(own.radius, other.radius);
        // All roundings are taken to the side on which the pair is tested further. A wrong "no"
        // loses a collision, a wrong "yes" costs time.
        let square = dot(offset, offset) - passing.error(dot(offset, offset));
        let [v, w] = [own, other].map(|start| dot(start.velocity, start.velocity));
        // (a + b)² is at most 2 (a² + b²).
        // The difference of two nearly equal velocities has an error in proportion to the
        // velocities, not to the difference.
        let speeds = dot(velocity, velocity) + MARGIN * MARGIN * (v + w);
        // To the end of the flight, and not of the window: the exact rule has this span, too.
        let left = self.flight.end - self.begin;
        let approach = 2.0 * speeds * (left * left) as f32;
        let most = DEFERRED as f32 * size;
        let least = contact_distance - most;
        let is_slow = approach < most * most;
        let is_apart = square > least * least * (1.0 + MARGIN);
        rests(own) & rests(other) & is_slow & is_apart
    }

    /// A disc without events in the window at `time`.
    #[inline(always)]
    pub fn first_at(&self, index: u32, time: f64) -> Now {
        // Times are measured from the start of the window, where the column `now` is exact to
        // rounding. A float32 of the time since the start of the flight would have a larger error.
        let time = (time - self.begin) as f32;
        let Start { position, velocity, radius, falls, .. } = self.now[index as usize];
        let gained = if falls { self.flight.gravity.map(|g| g as f32 * time) } else { [0.0; 2] };
        let displacement = |k: usize| (velocity[k] + 0.5 * gained[k]) * time;
        Now {
            position: [0, 1].map(|k| position[k] + displacement(k)),
            velocity: [0, 1].map(|k| velocity[k] + gained[k]),
            radius,
            falls,
            sizes: length(position) + (length(velocity) + length(gained)) * time,
        }
    }

    /// Whether a disc may touch a wall now, and in the next `span` seconds without events; false only if
    /// it certainly does not. The wall `left` does not count if the disc moves away from it.
    #[inline(always)]
    pub fn may_touch_wall(&self, index: u32, now: &Now, span: f32, left: Option<u32>) -> [bool; 2] {
        let Now { position, velocity, radius, falls, sizes } = *now;
        let is_near_side = self.may_touch_side([position, velocity], radius, span);
        let walls = &self.flight.walls;
        if walls.is_empty() {
            return [is_near_side; 2];
        }
        let fall = if falls { self.flight.gravity.map(|g| g as f32 * span) } else { [0.0; 2] };
        let displacement = [0, 1].map(|k| (velocity[k] + 0.5 * fall[k]) * span);
        let path = Path { position, displacement };
        // A parabola leaves its chord by at most g t² / 8.
        let error = 0.125 * length(fall) * span
            + MARGIN * (length(velocity) + length(fall)) * span
            + ROUNDING * (sizes + radius);
        // A falling disc may return to the wall from which it bounces.
        let left = left.filter(|_| !falls);
        walls.may_touch(index, &path, error, left).map(|may| may | is_near_side)
    }

    /// False only if a disc certainly stays in its bounds along its first piece.
    #[inline(always)]
    pub fn may_leave(&self, index: u32, reach: f32) -> bool {
        let own = &self.flight.particles.positions;
        let anchor = self.anchors.unwrap_or(own)[index as usize];
        let gravity = self.flight.gravity.map(|g| g as f32);
        let span = (self.end - self.begin) as f32;
        self.now[index as usize].may_leave(anchor, gravity, span, reach)
    }

    /// Lists the discs of a range that are not settled.
    pub fn list_unsettled(&self, range: Range<u32>, unsettled: &mut Vec<u32>) -> Result<()> {
        memory::resize(unsettled, range.len(), 0)?;
        let mut count = 0;
        for index in range {
            // Without a branch, which would often be predicted wrongly.
            unsettled[count] = index;
            count += usize::from(!self.now[index as usize].is_settled);
        }
        unsettled.truncate(count);
        Ok(())
    }

    /// Lists those of some discs that may hit a wall along their first pieces, and some others.
    pub fn list_near_walls<'n>(
        &self,
        discs: impl ExactSizeIterator<Item = u32>,
        near: &'n mut Vec<u32>,
    ) -> Result<&'n [u32]> {
        let Flight { walls, gravity, .. } = self.flight;
        let container = walls.container;
        let (has_sides, has_walls) = (container.has_sides(), !walls.is_empty());
        near.clear();
        if !(has_sides || has_walls) {
            return Ok(near);
        }
        let end = (self.end - self.begin) as f32;
        let fall = 0.5 * end * dot(gravity.map(|g| g as f32), gravity.map(|g| g as f32)).sqrt();
        memory::resize(near, discs.len(), 0)?;
        let mut count = 0;
        for index in discs {
            let Start { position, velocity, radius, .. } = self.now[index as usize];
            let far = (dot(velocity, velocity).sqrt() + fall) * end * (1.0 + MARGIN);
            let margin = |k: usize| far + radius + MARGIN * (position[k].abs() + radius);
            let is_near_side =
                has_sides && container.is_near_side(position, [margin(0), margin(1)]);
            let is_near_wall = has_walls && !walls.is_far(index, position, far);
            // Without a branch, which would often be predicted wrongly.
            near[count] = index;
            count += usize::from(is_near_side | is_near_wall);
        }
        near.truncate(count);
        if has_walls {
            // The first test has a circle for each disc; this one has the path. It is slower, so it
            // sees only what the first has left.
            near.retain(|&index| {
                let now = self.now[index as usize].now();
                self.may_touch_wall(index, &now, end, None)[1]
            });
        }
        Ok(near)
    }

    #[inline(always)]
    fn may_touch_side(&self, [position, velocity]: [[f32; 2]; 2], radius: f32, span: f32) -> bool {
        let far = |k: usize| {
            let fall = 0.5 * self.flight.gravity[k].abs() as f32 * span * span;
            let far = velocity[k].abs() * span + fall + radius;
            far * (1.0 + MARGIN) + MARGIN * position[k].abs()
        };
        self.flight.walls.container.is_near_side(position, [far(0), far(1)])
    }
}

#[inline(always)]
fn dot(a: [f32; 2], b: [f32; 2]) -> f32 {
    a[0] * b[0] + a[1] * b[1]
}

/// Upper bound of the length of a vector.
#[inline(always)]
fn length([x, y]: [f32; 2]) -> f32 {
    x.abs() + y.abs()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::trajectory::{Limits, Relative};

    /// A vector of any direction and of a length between powers of ten.
    fn vector(exponents: std::ops::Range<f64>) -> impl Strategy<Value = [f64; 2]> {
        (0.0..std::f64::consts::TAU, exponents).prop_map(|(angle, exponent)| {
            [angle.cos(), angle.sin()].map(|v| v * 10f64.powf(exponent))
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        /// Two discs are led to a point at which their distance is a share of the sum of radii: near
        /// and far from the origin, slow and fast, with parallel velocities, and points; within a
        /// torus and across its seam.
        #[test]
        fn what_touches_is_never_left_out(
            point in vector(-2.0..6.0),
            [v, w] in [vector(-3.0..5.0), vector(-3.0..5.0)],
            drift in prop_oneof![Just(1.0), Just(1e-4), Just(0.0)],
            radii in prop_oneof![Just([0.0f32; 2]), Just([1.0; 2]), Just([0.01, 3.0])],
            direction in vector(0.0..1e-9),
            image in prop_oneof![Just([0.0; 2]), vector(0.0..6.0)],
            (share, when) in (0.0..1.0, 0.0..1.0),
        ) {
            let (span, contact_distance) = (1.0, f64::from(radii[0]) + f64::from(radii[1]));
            let w = [0, 1].map(|k| v[k] + drift * w[k]);
            let meeting = [point, [0, 1].map(|k| point[k] + share * contact_distance * direction[k])];
            // Offsets between a torus and its images are numbers in float32.
            let image = image.map(|v| v as f32);
            let seam = image.map(f64::from);
            let starts = [(v, meeting[0], [0.0; 2]), (w, meeting[1], seam)];
            let pieces = starts.map(|(velocity, at, seam)| Piece {
                time: 0.0,
                position: [0, 1].map(|k| at[k] - velocity[k] * when * span - seam[k]),
                velocity,
                falls: false,
                is_first: true,
            });
            let relative = Relative::of(&pieces[0], &pieces[1], seam, [0.0; 2]);
            if relative.touches(contact_distance, span) {
                let [own, other] = [0, 1].map(|k| Now::of(&pieces[k], f64::from(radii[k])));
                prop_assert!(own.may_meet(&other, image, span as f32));
                prop_assert!(other.may_meet(&own, image.map(|v| -v), span as f32));
            }
        }
    }

    /// A supported disc as it begins a window.
    fn resting(position: [f64; 2], velocity: [f64; 2]) -> Start {
        Start {
            position: position.map(|v| v as f32),
            velocity: velocity.map(|v| v as f32),
            radius: 1.0,
            is_movable: true,
            is_supported: true,
            ..Start::default()
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(5_000))]

        /// Whether they overlap or not, by the exact test with the limits of supported discs.
        #[test]
        fn nothing_happens_to_two_settled_discs(
            offset in vector(-1.0..0.4),
            velocities in [vector(-3.0..-1.5), vector(-3.0..-1.5)],
        ) {
            let starts = [([0.0; 2], velocities[0]), (offset, velocities[1])];
            if starts.iter().all(|&(position, velocity)| resting(position, velocity).is_settled(1.0, 1.0)) {
                let pieces = starts.map(|(position, velocity)| {
                    Piece { position, velocity, ..Piece::default() }
                });
                let relative = Relative::of(&pieces[0], &pieces[1], [0.0; 2], [0.0; 2]);
                let tolerance = 2.0 * DEFERRED;
                let limits = Limits {
                    until: 1.0,
                    end: 1.0,
                    rounding: 1e-7,
                    tolerance,
                    touching_tolerance: tolerance,
                    deep: 0.02,
                    deep_tolerance: tolerance,
                    bounces: 0.5,
                };
                prop_assert!(relative.impact(2.0, 1.0, &limits).is_none());
            }
        }

        #[test]
        fn a_disc_that_leaves_its_bounds_is_never_left_out(
            anchor in vector(-1.0..5.0),
            [from, velocity, gravity] in [vector(-3.0..0.0), vector(-3.0..0.0), vector(-3.0..0.0)],
            (share, falls) in (0.0f32..1.2, any::<bool>()),
        ) {
            let disc = resting([0, 1].map(|k| anchor[k] + from[k]), velocity);
            let (disc, anchor) = (Start { falls, ..disc }, anchor.map(|v| v as f32));
            let pull = if falls { gravity } else { [0.0; 2] };
            let distance = (0..=64).map(|k| f64::from(k) / 64.0).map(|time| {
                let at = |k: usize| {
                    f64::from(disc.position[k]) - f64::from(anchor[k])
                        + (velocity[k] + 0.5 * pull[k] * time) * time
                };
                at(0).hypot(at(1))
            });
            let farthest = distance.fold(0.0, f64::max) as f32;
            let gravity = gravity.map(|g| g as f32);
            prop_assert!(disc.may_leave(anchor, gravity, 1.0, farthest * share.min(0.999)));
            prop_assert!(!disc.may_leave(anchor, gravity, 1.0, 100.0));
        }
    }

    #[test]
    fn discs_that_pass_far_away_are_left_out() {
        let piece = |position, velocity| Piece { position, velocity, ..Piece::default() };
        let own = Now::of(&piece([0.0, 0.0], [1.0, 0.0]), 1.0);
        let other = Now::of(&piece([10.0, 2.1], [-9.0, 0.0]), 1.0);
        assert!(!own.may_meet(&other, [0.0; 2], 2.0));
        let nearer = Now::of(&piece([10.0, 1.9], [-9.0, 0.0]), 1.0);
        assert!(own.may_meet(&nearer, [0.0; 2], 2.0));
        assert!(!own.may_meet(&nearer, [0.0; 2], 0.1));
    }
}
