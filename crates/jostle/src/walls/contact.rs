//! The closest points of discs and walls, and position correction at walls.

use super::{Around, FIRST, Part, Walls};
use crate::trajectory::{Vector, dot, vector};

/// Directions of contacts whose cosine is above this are the same, as at the joint of two walls in
/// a line.
const SAME: f64 = 1.0 - 1e-9;

/// Walls out of which a disc is pushed in one call, at most.
const MOST_PUSHES: usize = 8;

/// A wall near a disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The number of the wall.
    pub wall: u32,
    /// Unit vector from the wall to the centre.
    pub normal: Vector,
    /// Distance from surface to surface; negative if they overlap.
    pub gap: f64,
    /// Whether it is an end of the wall.
    pub is_end: bool,
}

impl Contact {
    /// Whether two contacts are in the same direction, so that only one of them counts.
    pub fn is_same(&self, other: &Self) -> bool {
        dot(self.normal, other.normal) > SAME
    }
}

impl Walls {
    /// The contact of a disc and the closest point of the wall with a number.
    pub fn contact(&self, wall: u32, position: Vector, radius: f64) -> Contact {
        let line = self.line(wall - FIRST);
        let offset = line.offset(position);
        let distance = dot(offset, offset).sqrt();
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
        Contact { wall, normal, gap: distance - line.reach(radius), is_end }
    }

    /// The same, if the part of the wall that is closest acts on the disc.
    pub fn acting_contact(&self, wall: u32, position: Vector, radius: f64) -> Option<Contact> {
        let index = wall - FIRST;
        let part = self.line(index).part_at(position);
        self.acts(index, part, position).then(|| self.contact(wall, position, radius))
    }

    /// Whether a disc does not overlap a wall at the second point, and its centre does not cross
    /// the wall on the way from the first.
    pub fn is_free(&self, wall: u32, [from, to]: [Vector; 2], radius: f64) -> bool {
        let line = self.line(wall - FIRST);
        line.distance(to) >= line.reach(radius) && !self.is_crossed(wall, from, to)
    }

    /// Whether the way from one point to another crosses a wall.
    fn is_crossed(&self, wall: u32, from: Vector, to: Vector) -> bool {
        let line = self.line(wall - FIRST);
        let [a, b] = line.ends;
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
    /// Position of a disc that is pushed out of some walls, by `most` at most; each time out of the
    /// one that it overlaps most. Its centre crosses none of them, starting at `from`.
    pub fn push_out(
        &self,
        walls: &[u32],
        [from, to]: [Vector; 2],
        radius: f64,
        most: f64,
    ) -> Vector {
        let seen = |wall: u32, position: Vector| self.position_from(wall, position, 0.0);
        let mut position = to;
        let mut left = most;
        for _ in 0..MOST_PUSHES {
            let contact = |&wall: &u32| self.walls.contact(wall, seen(wall, position), radius);
            let contacts = walls.iter().map(contact);
            let deepest =
                contacts.min_by(|a, b| a.gap.total_cmp(&b.gap).then_with(|| a.wall.cmp(&b.wall)));
            let Some(deepest) = deepest.filter(|of| of.gap < 0.0 && left > 0.0) else { break };
            let by = (-deepest.gap).min(left);
            left -= by;
            position = vector(|k| position[k] + by * deepest.normal[k]);
        }
        let crosses =
            |&wall: &u32| self.walls.is_crossed(wall, seen(wall, from), seen(wall, position));
        if walls.iter().any(crosses) { from } else { position }
    }
}
