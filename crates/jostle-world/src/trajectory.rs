//! Trajectories of discs between events, and times of impact: of two discs, and of a disc and a
//! flat or round wall.
//!
//! Between two events a disc moves along a parabola (if it falls) or a straight line. The
//! relative motion of two discs of which both fall, or none, is straight, so the time of impact
//! is the root of a quadratic equation; otherwise it is the root of a quartic.

use crate::roots::first_root;

/// A vector in float64.
pub type Vector = [f64; 2];

/// The scalar product.
#[inline(always)]
pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Unit vectors whose cosine is above this have the same direction.
const SAME: f64 = 1.0 - 1e-9;

/// Whether two unit vectors have the same direction, up to rounding.
#[inline(always)]
pub fn is_same_direction(a: Vector, b: Vector) -> bool {
    dot(a, b) > SAME
}

/// A vector from its two components.
#[inline(always)]
pub fn vector(component: impl Fn(usize) -> f64) -> Vector {
    [component(0), component(1)]
}

/// A part of a trajectory without events.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Piece {
    /// When it begins, in seconds since the beginning of the flight.
    pub time: f64,
    /// Centre at that time.
    pub position: Vector,
    /// Velocity at that time.
    pub velocity: Vector,
    /// Whether gravity accelerates the disc.
    pub falls: bool,
    /// Whether the disc has had no event in the flight.
    pub is_first: bool,
}

impl Piece {
    /// Centre and velocity at `time`.
    #[inline(always)]
    pub fn at(&self, time: f64, gravity: Vector) -> [Vector; 2] {
        // All positions of a piece come from its beginning, in one formula. Steps from event to
        // event would add a rounding for each.
        let t = time - self.time;
        let g = if self.falls { gravity } else { [0.0; 2] };
        [self.position_at(time, gravity), vector(|k| self.velocity[k] + g[k] * t)]
    }

    /// The rest of the piece from `time` on.
    #[inline(always)]
    pub fn moved(&self, time: f64, gravity: Vector) -> Self {
        let [position, velocity] = self.at(time, gravity);
        Self { time, position, velocity, ..*self }
    }

    /// Centre at `time`.
    #[inline(always)]
    pub fn position_at(&self, time: f64, gravity: Vector) -> Vector {
        let t = time - self.time;
        let g = if self.falls { gravity } else { [0.0; 2] };
        vector(|k| self.position[k] + (self.velocity[k] + 0.5 * g[k] * t) * t)
    }
}

/// What happens when two surfaces touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// They bounce.
    Bounce,
    /// Their bounces would be too low to be resolved, or would all end before the flight ends, so
    /// they stay together.
    Hold,
}

/// A predicted event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// In seconds since the beginning of the flight.
    pub time: f64,
    /// What happens.
    pub kind: Kind,
}

/// Limits of a prediction for two surfaces. The lengths are those of [`crate::tolerance`].
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Events after this time are not predicted.
    pub until: f64,
    /// When the flight ends.
    pub end: f64,
    /// Surfaces with a smaller gap touch, and lower bounces are ignored. About the rounding of
    /// positions to float32.
    pub rounding: f64,
    /// An impact is ignored if without it the surfaces would overlap by less than this at the end
    /// of the flight. The next one resolves it, because the surfaces touch as it begins.
    pub tolerance: f64,
    /// This tolerance for surfaces that touch, or overlap, where the motion begins.
    pub touching_tolerance: f64,
    /// Overlap from which on surfaces are deep in each other. Position correction moves them apart.
    pub deep: f64,
    /// The tolerance for them: many of them can have very many impacts at the same time.
    pub deep_tolerance: f64,
    /// Duration of all bounces after an impact, divided by v/a, where v is the speed of the impact
    /// and a the acceleration: 2e/(1 − e) with the coefficient of restitution e.
    pub bounces: f64,
}

impl Limits {
    /// The limits for surfaces with a gap where the motion begins, negative if they overlap.
    #[inline(always)]
    pub fn of_gap(&self, gap: f64) -> Self {
        // The gap at the start decides how much approach counts as nothing. Surfaces that touch
        // must react to the slightest approach, or they would sink into each other in many sub-
        // steps.
        let tolerance = if gap > self.rounding {
            self.tolerance
        } else if gap < -self.deep {
            self.deep_tolerance
        } else {
            self.touching_tolerance
        };
        Self { tolerance, ..*self }
    }

    /// What happens when surfaces touch at `time` that approach with `speed` and accelerate
    /// towards each other with `pull`; None if nothing does.
    #[inline(always)]
    pub fn kind(&self, speed: f64, pull: f64, time: f64) -> Option<Kind> {
        // To the end of the flight, because bounces after it belong to the next sub-step.
        let left = self.end - time;
        if pull > 0.0 {
            // A bounce with this speed is as high as speed² / (2 · pull).
            // Such a bounce would be lost in the rounding of the position, and the next one would
            // be predicted for the same moment.
            let is_low = speed * speed <= 2.0 * pull * self.rounding;
            // All bounces together are a geometric series with the sum 2 e u/(a (1 − e)), where u
            // is the speed of the impact. Infinitely many events in finite time end here as one.
            let ends = speed >= 0.0 && speed * self.bounces <= pull * left;
            if is_low || ends {
                return Some(Kind::Hold);
            }
        }
        // The product is the overlap at the end of the flight if nothing happens. A limit for the
        // speed would depend on the length of the sub-step.
        (speed * left > self.tolerance).then_some(Kind::Bounce)
    }
}

/// Speeds of approach and separation between which a contact rests, in units of the speed that
/// gravity and forces give in a sub-step of h seconds. With the acceleration a, a bounce that
/// leaves with the speed u takes 2u/a seconds, and this bounce and all later ones together take
/// 2u/(a (1 − e)). They end within the sub-step if u ≤ a h (1 − e)/2; the speed of approach is then
/// at most u/e.
pub fn rest_speeds(restitution: f64) -> [f64; 2] {
    let restitution = restitution_at_rest(restitution);
    // With u ≤ a h (1 − e)/2 after the bounce, and u/e before it; in units of a h.
    let approach = ((1.0 - restitution) / (2.0 * restitution)).min(MAX_REST_SPEED);
    [approach, restitution * approach]
}

/// Contacts with a larger coefficient of restitution rest as with this one, in worlds that lose
/// energy. Friction makes discs come to rest also if they collide elastically, and without this
/// limit their collisions would become ever more frequent.
const MAX_RESTITUTION_AT_REST: f64 = 0.999;

/// The coefficient of restitution that decides whether a contact rests.
pub fn restitution_at_rest(restitution: f64) -> f64 {
    restitution.min(MAX_RESTITUTION_AT_REST)
}

/// Maximum of the first of [`rest_speeds`]: without it every approach would rest if e is 0.
pub const MAX_REST_SPEED: f64 = 4.0;

/// Two surfaces that meet and approach, in straight relative motion.
pub struct Meeting {
    time: f64,
    /// The gap where the motion begins, negative if they overlap.
    gap: f64,
    /// With which they approach then.
    speed: f64,
}

impl Meeting {
    /// What happens then.
    #[inline(always)]
    pub fn impact(&self, limits: &Limits) -> Option<Impact> {
        let kind = limits.of_gap(self.gap).kind(self.speed, 0.0, self.time)?;
        Some(Impact { time: self.time, kind })
    }
}

/// The motion of a point against another.
#[derive(Clone, Copy, Debug)]
pub struct Relative {
    /// When it begins.
    pub start: f64,
    /// Offset at that time.
    pub offset: Vector,
    /// Relative velocity at that time.
    pub velocity: Vector,
    /// Relative acceleration.
    pub acceleration: Vector,
}

impl Relative {
    /// The motion of the disc on `second` against that on `first`; `image` is added to the offset.
    /// Exchanging the two changes signs only, so the time of impact has the same bits.
    #[inline(always)]
    pub fn of(first: &Piece, second: &Piece, image: Vector, gravity: Vector) -> Self {
        // Both are moved to the later start, and only then subtracted. The difference of two near
        // positions is small and nearly without error, so what follows has its relative accuracy.
        let start = first.time.max(second.time);
        let ([p, v], [q, w]) = (first.at(start, gravity), second.at(start, gravity));
        // Gravity cancels exactly if both fall, so that the quadratic case is recognised by a 0.
        let sign = f64::from(i8::from(second.falls) - i8::from(first.falls));
        Self {
            start,
            offset: vector(|k| q[k] - p[k] + image[k]),
            velocity: vector(|k| w[k] - v[k]),
            acceleration: gravity.map(|g| g * sign),
        }
    }

    /// Whether two discs in straight relative motion never come closer.
    #[inline(always)]
    pub fn separates(&self) -> bool {
        !self.is_curved() && dot(self.offset, self.velocity) >= 0.0
    }

    /// Whether one of the two falls and the other does not.
    #[inline(always)]
    pub fn is_curved(&self) -> bool {
        self.acceleration != [0.0; 2]
    }

    /// Whether two discs whose radii have the sum `contact_distance` touch or overlap before
    /// `until`.
    pub fn touches(&self, contact_distance: f64, until: f64) -> bool {
        let [q, w, a] = [self.offset, self.velocity, self.acceleration];
        let span = (until - self.start).max(0.0);
        let (gap, rate) = (dot(q, q) - contact_distance * contact_distance, dot(q, w));
        if a != [0.0; 2] {
            // The square of the distance, |q + w t + a t²/2|² minus that of the sum of radii, in
            // powers of t.
            let rest = [dot(w, w) + dot(q, a), dot(w, a), 0.25 * dot(a, a)];
            return first_root([gap, 2.0 * rate, rest[0], rest[1], rest[2]], span).is_some();
        }
        // They are nearest at the beginning, at the end or between.
        let wait = if rate < 0.0 { (-rate / dot(w, w)).min(span) } else { 0.0 };
        let nearest = vector(|k| q[k] + w[k] * wait);
        dot(nearest, nearest) <= contact_distance * contact_distance
    }

    /// The first impact before `until` of two discs whose radii have the sum `contact_distance`.
    pub fn impact(&self, contact_distance: f64, until: f64, limits: &Limits) -> Option<Impact> {
        if self.is_curved() {
            self.curved_impact(contact_distance, limits)
        } else {
            self.meeting(contact_distance, until)?.impact(limits)
        }
    }

    /// Where two discs in straight relative motion meet before `until`. The closest approach is
    /// found first and the meeting from there, which keeps its accuracy when the displacement is a
    /// thousand radii long.
    #[inline(always)]
    pub fn meeting(&self, contact_distance: f64, until: f64) -> Option<Meeting> {
        let (q, w) = (self.offset, self.velocity);
        let approach = dot(q, w);
        if approach >= 0.0 {
            return None;
        }
        let (square, qq) = (contact_distance * contact_distance, dot(q, q));
        if qq <= square {
            let length = qq.sqrt();
            // Surfaces that overlap and approach have an impact at once. An overlap is left over
            // from rounding or from position correction, and must not become deeper.
            let speed = -approach / length.max(f64::MIN_POSITIVE);
            let gap = length - contact_distance;
            return (self.start <= until).then_some(Meeting { time: self.start, gap, speed });
        }
        // The usual formula for a quadratic equation subtracts numbers of the size of the
        // displacement squared. The root of small discs on a long way would have no digits left.
        // From the closest approach, only lengths of the size of the radii are subtracted.
        let ww = dot(w, w);
        let span = until - self.start;
        // Still approaching then, and still apart.
        // This saves the square root and the division for pairs that do not meet in time.
        if -approach > ww * span && qq + (2.0 * approach + ww * span) * span > square {
            return None;
        }
        let closest = -approach / ww;
        let middle = vector(|k| q[k] + w[k] * closest);
        let free = square - dot(middle, middle);
        if free <= 0.0 {
            return None;
        }
        // The time between touching and the closest approach.
        let back = (free / ww).sqrt();
        let time = self.start + (closest - back).max(0.0);
        // The square of the gap is missing, which does not matter where the gap is small.
        let gap = 0.5 * (qq - square) / contact_distance;
        (time <= until).then_some(Meeting { time, gap, speed: back * ww / contact_distance })
    }

    /// The first impact of two discs of which one falls and the other does not.
    pub fn curved_impact(&self, contact_distance: f64, limits: &Limits) -> Option<Impact> {
        let [q, w, a] = [self.offset, self.velocity, self.acceleration];
        let span = limits.until - self.start;
        let square = dot(q, q) - contact_distance * contact_distance;
        let rate = 2.0 * dot(q, w);
        let rest = [dot(w, w) + dot(q, a), dot(w, a), 0.25 * dot(a, a)];
        let limits = limits.of_gap(dot(q, q).sqrt() - contact_distance);
        let wait = if square > 0.0 {
            first_root([square, rate, rest[0], rest[1], rest[2]], span)?
        } else if let Some(kind) = self.kind_at(0.0, &limits) {
            return Some(Impact { time: self.start, kind });
        } else {
            // They touch and separate: the root at 0 is divided out.
            first_root([rate.max(f64::MIN_POSITIVE), rest[0], rest[1], rest[2], 0.0], span)?
        };
        if wait > span {
            return None;
        }
        let kind = self.kind_at(wait, &limits)?;
        Some(Impact { time: self.start + wait, kind })
    }

    /// What happens if they touch `wait` seconds after the start; None if they separate.
    fn kind_at(&self, wait: f64, limits: &Limits) -> Option<Kind> {
        let [q, w, a] = [self.offset, self.velocity, self.acceleration];
        let offset = vector(|k| q[k] + (w[k] + 0.5 * a[k] * wait) * wait);
        let velocity = vector(|k| w[k] + a[k] * wait);
        // The maximum keeps the quotient finite if the centres coincide.
        let length = dot(offset, offset).sqrt().max(f64::MIN_POSITIVE);
        let speed = -dot(offset, velocity) / length;
        limits.kind(speed, -dot(offset, a) / length, self.start + wait)
    }
}

/// The impact on a flat wall at the distance `gap`, from which the disc moves away with `speed`
/// and to which it accelerates with `pull`.
pub fn flat_impact(gap: f64, speed: f64, pull: f64, start: f64, limits: &Limits) -> Option<Impact> {
    let span = limits.until - start;
    // Far from the wall all the time.
    // A bound without a root. Nearly all discs are farther from each wall than they get in the sub-
    // step.
    let lowest = gap + speed.min(0.0) * span - 0.5 * pull.max(0.0) * span * span;
    if lowest > 0.0 {
        return None;
    }
    let limits = limits.of_gap(gap);
    let wait = if gap <= 0.0 {
        if let Some(kind) = limits.kind(-speed, pull, start) {
            return Some(Impact { time: start, kind });
        }
        if pull <= 0.0 || speed <= 0.0 {
            return None;
        }
        // The disc touches, moves away and falls back: the second root of a parabola whose first
        // root is 0.
        2.0 * speed / pull
    } else if pull == 0.0 {
        if speed >= 0.0 {
            return None;
        }
        gap / -speed
    } else {
        // gap + speed t − ½ pull t² = 0; the root that is not lost by cancellation.
        let discriminant = speed * speed + 2.0 * pull * gap;
        if discriminant < 0.0 {
            return None;
        }
        let root = discriminant.sqrt();
        let wait = if speed > 0.0 { (speed + root) / pull } else { 2.0 * gap / (root - speed) };
        if wait < 0.0 {
            return None;
        }
        wait
    };
    if wait > span {
        return None;
    }
    let kind = limits.kind(pull * wait - speed, pull, start + wait)?;
    Some(Impact { time: start + wait, kind })
}

/// The impact of a point inside a circle of radius `contact_distance` around the origin.
pub fn round_impact(
    q: Vector,
    v: Vector,
    a: Vector,
    contact_distance: f64,
    start: f64,
    limits: &Limits,
) -> Option<Impact> {
    let span = limits.until - start;
    // The signs are those of a point that must stay inside. So the polynomial is positive before
    // the impact here, too, and `first_root` needs no second version.
    let inside = contact_distance * contact_distance - dot(q, q);
    let limits = limits.of_gap(contact_distance - dot(q, q).sqrt());
    let kind_at = |wait: f64| {
        let offset = vector(|k| q[k] + (v[k] + 0.5 * a[k] * wait) * wait);
        let velocity = vector(|k| v[k] + a[k] * wait);
        let length = dot(offset, offset).sqrt().max(f64::MIN_POSITIVE);
        let [speed, pull] = [dot(offset, velocity) / length, dot(offset, a) / length];
        limits.kind(speed, pull, start + wait)
    };
    let rate = -2.0 * dot(q, v);
    let rest = [-dot(v, v) - dot(q, a), -dot(v, a), -0.25 * dot(a, a)];
    let wait = if inside > 0.0 {
        first_root([inside, rate, rest[0], rest[1], rest[2]], span)?
    } else if let Some(kind) = kind_at(0.0) {
        return Some(Impact { time: start, kind });
    } else {
        first_root([rate.max(f64::MIN_POSITIVE), rest[0], rest[1], rest[2], 0.0], span)?
    };
    let kind = kind_at(wait)?;
    Some(Impact { time: start + wait, kind })
}
