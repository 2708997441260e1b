//! The closest points of discs and walls, and position correction at walls.

use std::cmp::Ordering;

use super::{Around, Part, Walls, index_of, less};
use crate::container::WallContact;
use crate::trajectory::{Vector, dot, is_same_direction, vector};

/// Maximum number of pushes of a disc out of walls in one call.
const MAX_PUSHES: usize = 8;

/// Two normals whose cosine is below this are those of walls at an acute angle. A disc between them
/// is pushed out of both at once, because alternating pushes out of one wall after the other
/// converge very slowly; and it begins each step without impulses at rest.
/// It is the cosine of 120°, so the angle between the walls is below 60°.
pub const OPPOSED: f64 = -0.5;

/// Walls whose angle has a smaller sine count as parallel.
const PARALLEL: f64 = 1e-6;

impl WallContact {
    /// Whether two contacts are in the same direction, as at the joint of two walls in a line. Only one
    /// of them counts then.
    pub fn is_same(&self, other: &Self) -> bool {
        is_same_direction(self.normal, other.normal)
    }

    /// The order of contacts with the same gap: by walls; of images of a wall, by directions.
    pub(super) fn compare(&self, other: &Self) -> Ordering {
        let by_normal = |k: usize| self.normal[k].total_cmp(&other.normal[k]);
        self.wall.cmp(&other.wall).then_with(|| by_normal(0)).then_with(|| by_normal(1))
    }
}

impl Walls {
    /// The contact of a disc and the closest point of the wall with a number.
    pub fn contact(&self, wall: u32, position: Vector, radius: f64) -> WallContact {
        let line = self.numbered(wall);
        let offset = line.offset(position);
        let distance = dot(offset, offset).sqrt();
        // The normal of a side is that of the line, the normal of an end points from the end to the
        // centre.
        let is_end = line.part_at(position) != Part::Side;
        let normal: Vector = if distance > 0.0 {
            // Beside the wall, the normal does not depend on the rounding of the distance.
            let across = line.across();
            let side = if dot(offset, across) < 0.0 { -1.0 } else { 1.0 };
            let scale = |v: f64| if is_end { v } else { side * v };
            if is_end { offset.map(|v| v / distance) } else { across.map(scale) }
        } else {
            line.across()
        };
        // Without −0.
        let normal = normal.map(|v| v + 0.0);
        WallContact { wall, normal, gap: distance - line.contact_distance(radius), is_end }
    }

    /// The contact of a disc with a wall, if the part of the wall that is closest acts on the disc.
    pub fn acting_contact(&self, wall: u32, position: Vector, radius: f64) -> Option<WallContact> {
        let index = index_of(wall)?;
        let line = self.line(index);
        let part = line.part_at(position);
        let acts = line.is_solid_for(position, radius) && self.acts(index, part, position, radius);
        acts.then(|| self.contact(wall, position, radius))
    }

    /// Whether a disc does not overlap a wall at the second point, and its centre does not cross
    /// the wall along the path from the first.
    pub fn is_free(&self, wall: u32, [from, to]: [Vector; 2], radius: f64) -> bool {
        let line = self.numbered(wall);
        line.distance(to) >= line.contact_distance(radius) && !self.is_crossed(wall, from, to)
    }

    /// Whether the path from one point to another crosses a wall.
    fn is_crossed(&self, wall: u32, from: Vector, to: Vector) -> bool {
        let line = self.numbered(wall);
        let [a, b] = line.ends;
        // Twice the area of a triangle, with its sign: two points on different sides of a line have
        // different signs.
        let side = |[p, q]: [Vector; 2], of: Vector| {
            let [u, v] = [vector(|k| q[k] - p[k]), vector(|k| of[k] - p[k])];
            u[0] * v[1] - u[1] * v[0]
        };
        from != to
            && side([a, b], from) * side([a, b], to) < 0.0
            && side([from, to], a) * side([from, to], b) <= 0.0
    }
}

impl Around<'_> {
    /// Position of a disc that is pushed out of some walls with their offsets, by at most `most`.
    /// Each push is out of the wall that it overlaps most, and also out of another one at an acute
    /// angle to it. On the path from `from` its centre crosses none of them.
    pub fn push_out(
        &self,
        walls: &[(u32, Vector)],
        [from, to]: [Vector; 2],
        radius: f64,
        most: f64,
    ) -> Vector {
        let seen = |&(wall, offset): &(u32, Vector), position: Vector| {
            self.position_from(wall, less(position, offset), 0.0)
        };
        let mut position = to;
        let mut left = most;
        // The deepest overlap first. One push often ends several overlaps, and the limit bounds the
        // time where walls leave no room.
        for _ in 0..MAX_PUSHES {
            let contact = |of: &(u32, Vector)| self.walls.contact(of.0, seen(of, position), radius);
            let contacts = || walls.iter().map(contact);
            let deepest = least(contacts(), |of| of.gap);
            let Some(deepest) = deepest.filter(|of| of.gap < 0.0 && left > 0.0) else { break };
            // The gap that would remain after a push out of the deepest wall alone.
            let after = |of: &WallContact| of.gap - deepest.gap * dot(of.normal, deepest.normal);
            let is_opposed = |of: &WallContact| dot(of.normal, deepest.normal) < OPPOSED;
            let opposed = least(contacts().filter(is_opposed), after).filter(|of| after(of) < 0.0);
            let both = opposed.and_then(|other| out_of_both(&deepest, &other));
            let (direction, length) = both.unwrap_or((deepest.normal, -deepest.gap));
            // All pushes together are limited, so that a disc deep in a wall comes out over several
            // steps.
            let by = length.min(left);
            left -= by;
            position = vector(|k| position[k] + by * direction[k]);
        }
        // A correction must never carry a centre through a wall: the disc would be outside for
        // good.
        let crosses =
            |of: &(u32, Vector)| self.walls.is_crossed(of.0, seen(of, from), seen(of, position));
        if walls.iter().any(crosses) { from } else { position }
    }
}

/// The contact with the least value; of equal ones that of the first wall.
fn least(
    all: impl Iterator<Item = WallContact>,
    value: impl Fn(&WallContact) -> f64,
) -> Option<WallContact> {
    all.min_by(|a, b| value(a).total_cmp(&value(b)).then_with(|| a.compare(b)))
}

/// Unit vector and length of the displacement after which the gaps of two opposed contacts are 0,
/// or equal if their walls are parallel and leave no room. The first has the smaller gap.
fn out_of_both(a: &WallContact, b: &WallContact) -> Option<(Vector, f64)> {
    let ([p, q], [u, v]) = (a.normal, b.normal);
    let sine = p * v - q * u;
    if sine.abs() < PARALLEL {
        return Some((a.normal, 0.5 * (b.gap - a.gap)));
    }
    // The displacement x with n₁·x = −g₁ and n₂·x = −g₂, by Cramer's rule.
    let by = [(b.gap * q - a.gap * v) / sine, (a.gap * u - b.gap * p) / sine];
    let length = dot(by, by).sqrt();
    (length > 0.0).then(|| (by.map(|of| of / length), length))
}
