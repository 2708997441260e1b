//! How far and in which direction two overlapping shapes are moved apart.

use super::bodies::Body;
use super::rules::Separation;
use jostle_index::geometry::{Scalar, discs_overlap, overlap};

/// Factor of over-relaxation: each pair is moved this much farther than it overlaps. In the first
/// [`EXACT`] rounds it is 1, so that a pair far from others moves no farther than needed.
const RELAXATION: f64 = 1.2;

/// As above.
const EXACT: usize = 2;

/// The rules of all pairs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pusher<T> {
    axis: Option<usize>,
    gap: T,
    tolerance: T,
    relaxation: T,
}

impl<T: Scalar> Pusher<T> {
    /// The rules of a call.
    pub(crate) fn of(rules: &Separation<T>) -> Self {
        // With a tolerance of 0 two shapes would touch after exact arithmetic, and overlap after
        // rounding half of the time. Four epsilons are more than the roundings of a push.
        let smallest = T::from_f64(4.0) * T::EPSILON;
        Self {
            axis: rules.axis,
            gap: rules.gap,
            tolerance: rules.tolerance.max(smallest),
            relaxation: T::ONE,
        }
    }

    /// The rules in a round, of which `before` precede.
    pub(crate) fn in_round(&self, before: usize) -> Self {
        // In a crowd each push moves shapes into others, so pushes that are too long arrive sooner
        // (successive over-relaxation). Two shapes alone are done after one round and stay as near
        // as they can. `examples/crowd` prints rounds, time and mean displacement.
        let factor = if before < EXACT { 1.0 } else { RELAXATION };
        Self { relaxation: T::from_f64(factor), ..*self }
    }

    /// Whether two shapes overlap or are closer than the gap; `offset` is that of the centre
    /// of `b` from the centre of `a`. With `ROUND` both are discs, and the test is quicker.
    #[inline(always)]
    pub(crate) fn overlaps<const ROUND: bool>(
        &self,
        a: &Body<T>,
        b: &Body<T>,
        offset: [T; 2],
    ) -> bool {
        if ROUND {
            return discs_overlap(offset, self.radius_sum(a, b));
        }
        overlap(gaps(offset, half_sizes(a, b)), self.radius_sum(a, b))
    }

    /// The factor by which shapes are moved farther apart than touching.
    pub(crate) fn size_factor(&self) -> T {
        T::ONE + self.tolerance
    }

    fn radius_sum(&self, a: &Body<T>, b: &Body<T>) -> T {
        a.radius + b.radius + self.gap
    }

    /// The vector by which `b` must move relative to `a`. If the shapes coincide along the axis of
    /// the vector, `b`, which is `rank` positions after `a`, moves in the positive direction.
    #[inline(always)]
    pub(crate) fn push(&self, a: &Body<T>, b: &Body<T>, offset: [T; 2], rank: usize) -> [T; 2] {
        if let Some(axis) = self.axis {
            return self.push_along(axis, a, b, offset);
        }
        // 0 counts as positive, so of two shapes with the same coordinate the later one moves up:
        // their order decides, and it is canonical.
        let sign = |axis: usize| if offset[axis] < T::ZERO { -T::ONE } else { T::ONE };
        let halves = half_sizes(a, b);
        let gaps = gaps(offset, halves);
        let radius_sum = self.radius_sum(a, b);
        let [x, y] = [gaps[0].max(T::ZERO), gaps[1].max(T::ZERO)];
        // The pair overlaps, so the squares are at most that of the radii and do not overflow. If
        // they vanish, the shapes move along an axis.
        let distance = (x * x + y * y).sqrt();
        let (normal, depth) = if distance > T::ZERO {
            let scale = distance.recip();
            ([x * scale * sign(0), y * scale * sign(1)], radius_sum - distance)
        } else if offset == [T::ZERO; 2] && halves == [T::ZERO; 2] {
            // Coincident discs have no normal. If all went the same way, a heap of them would
            // become a line.
            (direction(rank), radius_sum)
        } else if gaps[0] < gaps[1] {
            ([T::ZERO, sign(1)], radius_sum - gaps[1])
        } else {
            ([sign(0), T::ZERO], radius_sum - gaps[0])
        };
        let size = normal[0].abs() * halves[0] + normal[1].abs() * halves[1] + radius_sum;
        let length = (depth + self.tolerance * size) * self.relaxation;
        [normal[0] * length, normal[1] * length]
    }

    /// As [`Self::push`], for two discs.
    #[inline(always)]
    pub(crate) fn push_round(
        &self,
        a: &Body<T>,
        b: &Body<T>,
        offset: [T; 2],
        rank: usize,
    ) -> [T; 2] {
        if self.axis.is_some() {
            return self.push(a, b, offset, rank);
        }
        let needed = self.radius_sum(a, b) * self.size_factor();
        let distance = (offset[0] * offset[0] + offset[1] * offset[1]).sqrt();
        if distance > T::ZERO {
            // As in `push`, for discs: depth plus tolerance is `needed - distance`.
            let scale = (needed - distance) * self.relaxation / distance;
            return [offset[0] * scale, offset[1] * scale];
        }
        self.push(a, b, offset, rank)
    }

    /// As [`Self::push`], along an axis.
    fn push_along(&self, axis: usize, a: &Body<T>, b: &Body<T>, offset: [T; 2]) -> [T; 2] {
        // No over-relaxation along an axis, so that shapes in a row keep their order.
        let needed = self.needed_along(axis, a, b, offset[1 - axis]);
        let depth = needed * self.size_factor() - offset[axis].abs();
        let mut push = [T::ZERO; 2];
        push[axis] = if offset[axis] < T::ZERO { -depth } else { depth };
        push
    }

    /// The distance of the centres along an axis at which two shapes touch; `across` is their
    /// offset along the other axis. 0 if they cannot touch.
    pub(crate) fn needed_along(&self, axis: usize, a: &Body<T>, b: &Body<T>, across: T) -> T {
        let radius_sum = self.radius_sum(a, b);
        let gap = across.abs() - (a.half[1 - axis] + b.half[1 - axis]);
        let halves = a.half[axis] + b.half[axis];
        let beyond = gap.max(T::ZERO);
        // Two rounded boxes touch where the nearest corners of their cores are a radius apart
        // (Pythagoras). If the cores overlap across, nothing is beyond, and the whole radius counts
        // along the axis.
        let square = radius_sum * radius_sum - beyond * beyond;
        if gap >= T::ZERO && square <= T::ZERO {
            return T::ZERO;
        }
        halves + square.max(T::ZERO).sqrt()
    }
}

/// The sums of the half sizes of two shapes.
#[inline(always)]
fn half_sizes<T: Scalar>(a: &Body<T>, b: &Body<T>) -> [T; 2] {
    [a.half[0] + b.half[0], a.half[1] + b.half[1]]
}

/// The gaps between the cores of two shapes along each axis.
#[inline(always)]
fn gaps<T: Scalar>(offset: [T; 2], half_sizes: [T; 2]) -> [T; 2] {
    [offset[0].abs() - half_sizes[0], offset[1].abs() - half_sizes[1]]
}

/// A unit vector that depends on the difference of two indices, for discs with the same centre.
fn direction<T: Scalar>(rank: usize) -> [T; 2] {
    /// Points on the circle of radius 65 with integer coordinates, in an order in which
    /// successive ones are far apart.
    const POINTS: [[f64; 2]; 12] = [
        [65.0, 0.0],
        [-33.0, 56.0],
        [-39.0, -52.0],
        [16.0, 63.0],
        [-63.0, 16.0],
        [56.0, -33.0],
        [-16.0, -63.0],
        [52.0, 39.0],
        [33.0, -56.0],
        [-56.0, 33.0],
        [63.0, -16.0],
        [-25.0, -60.0],
    ];
    // A table, not sine and cosine, whose last bits differ between systems.
    POINTS[rank % POINTS.len()].map(|v| T::from_f64(v / 65.0))
}
