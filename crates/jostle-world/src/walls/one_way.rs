//! Walls that are solid from one side: for what comes from the left of the line from the first end to the second.
//!
//! The side from which a disc came is not stored. The wall stops a disc whose surface is on the left, up to an overlap
//! of a small share of its radius. Any other disc passes: one on the right, and one that has passed partly and falls
//! back. It is stopped again as soon as all of it is on the left. An end acts only on discs whose
//! centres are on the left, by the same rule. Where a disc rests on a wall, its overlap is far smaller than this share.

use super::{Around, Line, Part, less};
use crate::trajectory::{Impact, Limits, Relative, Vector, dot, flat_impact, round_impact, vector};

/// A disc may overlap the left of a wall by this share of its radius and is stopped.
const OVERLAP: f64 = 1.0 / 64.0;

/// The same for points, as a share of the distance that they keep.
const OVERLAP_OF_POINT: f64 = 0.5;

/// The distance of a point from the line through `start` to its left; `across` is the unit vector to the left.
fn left_of(start: Vector, across: Vector, point: Vector) -> f64 {
    dot(vector(|k| point[k] - start[k]), across)
}

/// Whether a wall between two points, solid from its left, may stop a rounded box that moves along `direction`: all of
/// the box is strictly on the left, and it moves to the right.
pub fn may_stop(
    [start, end]: [Vector; 2],
    (center, direction): (Vector, Vector),
    (half_size, radius): (Vector, f64),
) -> bool {
    let along = vector(|k| end[k] - start[k]);
    let length = dot(along, along).sqrt();
    let across = [-along[1] / length, along[0] / length];
    let extent = across[0].abs() * half_size[0] + across[1].abs() * half_size[1] + radius;
    left_of(start, across, center) > extent && dot(direction, across) < 0.0
}

impl Line {
    /// Whether the side on which a point is may be solid.
    pub(super) fn faces(&self, point: Vector) -> bool {
        !self.is_one_way || self.left_of(point) > 0.0
    }

    /// The distance of a point from the line to its left; negative on the right.
    pub(super) fn left_of(&self, point: Vector) -> f64 {
        left_of(self.ends[0], self.across(), point)
    }

    /// Whether a disc of this radius with a gap on the left comes from there.
    fn comes_from_left(&self, gap: f64, radius: f64) -> bool {
        gap >= -(OVERLAP * radius).max(OVERLAP_OF_POINT * self.least_radius)
    }

    /// Whether it stops a disc of this radius with its centre at a point.
    pub(super) fn is_solid_for(&self, point: Vector, radius: f64) -> bool {
        if !self.is_one_way {
            return true;
        }
        let left = self.left_of(point);
        let distance = if self.part_at(point) == Part::Side { left } else { self.distance(point) };
        left > 0.0 && self.comes_from_left(distance - self.contact_distance(radius), radius)
    }

    /// The impact of a disc on the left of a side, from a position at `start`.
    pub(super) fn impact_on_left(
        &self,
        radius: f64,
        [position, velocity, acceleration]: [Vector; 3],
        start: f64,
        limits: &Limits,
    ) -> Option<Impact> {
        let across = self.across();
        let gap = self.left_of(position) - self.contact_distance(radius);
        let (speed, pull) = (dot(across, velocity), -dot(across, acceleration));
        if self.comes_from_left(gap, radius) {
            return flat_impact(gap, speed, pull, start, limits);
        }
        // gap + speed t − ½ pull t² = 0 where it grows: from then on all of the disc is on the left.
        let root = (speed * speed + 2.0 * pull * gap).sqrt();
        let wait = -2.0 * gap / (speed + root);
        // Not a number without a root.
        let is_before = wait >= 0.0 && start + wait < limits.until;
        is_before.then(|| flat_impact(0.0, root, pull, start + wait, limits)).flatten()
    }

    /// The impact of a disc on an end, from a position at `start`, while the centre is on the left.
    pub(super) fn impact_on_left_end(
        &self,
        radius: f64,
        relative: Relative,
        limits: &Limits,
    ) -> Option<Impact> {
        let contact_distance = self.contact_distance(radius);
        let Relative { start, offset, velocity, acceleration } = relative;
        let gap = dot(offset, offset).sqrt() - contact_distance;
        if self.comes_from_left(gap, radius) {
            return relative.impact(contact_distance, limits.until, limits);
        }
        // The time at which the disc no longer overlaps the end.
        let exit =
            round_impact(offset, velocity, acceleration, contact_distance, start, limits)?.time;
        let wait = exit - start;
        let after = Relative {
            start: exit,
            offset: vector(|k| offset[k] + (velocity[k] + 0.5 * acceleration[k] * wait) * wait),
            velocity: vector(|k| velocity[k] + acceleration[k] * wait),
            acceleration,
        };
        after.impact(contact_distance, limits.until, limits)
    }
}

impl Around<'_> {
    /// Whether the wall with a number and an offset stops a disc of this radius with its centre at a position, at the
    /// beginning of the window.
    pub fn is_solid_for(&self, wall: u32, offset: Vector, position: Vector, radius: f64) -> bool {
        let seen = self.position_from(wall, less(position, offset), 0.0);
        self.walls.numbered(wall).is_solid_for(seen, radius)
    }
}
