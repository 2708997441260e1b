//! The time of impact of a disc and a wall.

use super::{Line, Part, Walls, index_of, less};
use crate::trajectory::{Impact, Limits, Piece, Relative, Vector, dot, flat_impact, vector};

impl Walls {
    /// The first impact of a disc on the wall with a number.
    ///
    /// A part of the wall is tested in the intervals of time in which it acts. At their borders the
    /// distance to the walls is continuous, so an impact cannot be between two parts.
    pub fn impact(
        &self,
        wall: u32,
        piece: &Piece,
        radius: f64,
        gravity: Vector,
        limits: &Limits,
    ) -> Option<Impact> {
        let index = index_of(wall)?;
        let line = self.line(index);
        let contact_distance = line.contact_distance(radius);
        let acceleration = if piece.falls { gravity } else { [0.0; 2] };
        let mut first = None::<Impact>;
        let parts = [Part::Side, Part::End(0), Part::End(1)];
        let has = |part: &Part| match *part {
            Part::Side => true,
            Part::End(end) => line.has_end[end],
        };
        for part in parts.into_iter().filter(has) {
            // A later part counts only if it is hit before the first impact so far.
            let until = first.map_or(limits.until, |impact| impact.time);
            let disc = (piece, radius);
            let found = self.first_while_acting(index, part, disc, gravity, until, |during| {
                let [start, until] = during;
                let limits = Limits { until, ..*limits };
                let [position, velocity] = piece.at(start, gravity);
                match part {
                    Part::Side if line.is_one_way => {
                        let motion = [position, velocity, acceleration];
                        line.impact_on_left(radius, motion, start, &limits)
                    }
                    Part::Side => {
                        let across = line.across();
                        // The side on which the centre is decides the direction of the normal,
                        // because walls are solid from both sides.
                        let distance = dot(vector(|k| position[k] - line.ends[0][k]), across);
                        let side = if distance < 0.0 { -1.0 } else { 1.0 };
                        let speed = side * dot(across, velocity);
                        let pull = -side * dot(across, acceleration);
                        flat_impact(side * distance - contact_distance, speed, pull, start, &limits)
                    }
                    Part::End(end) => {
                        let relative = Relative {
                            start,
                            offset: vector(|k| line.ends[end][k] - position[k]),
                            velocity: velocity.map(|v| -v),
                            acceleration: acceleration.map(|v| -v),
                        };
                        if line.is_one_way {
                            return line.impact_on_left_end(radius, relative, &limits);
                        }
                        relative.impact(contact_distance, until, &limits)
                    }
                }
            });
            first = found.or(first);
        }
        first
    }

    /// Calls `test` with the beginning and the end of each interval until `until` in which a part
    /// of a wall acts on a disc, until it finds an impact.
    fn first_while_acting(
        &self,
        index: u32,
        part: Part,
        (piece, radius): (&Piece, f64),
        gravity: Vector,
        until: f64,
        test: impl Fn([f64; 2]) -> Option<Impact>,
    ) -> Option<Impact> {
        let mut start = piece.time;
        loop {
            // Between two changes the same part acts, so one point tells which. The middle is
            // farthest from the roots at both ends, whose rounding could give the wrong answer.
            let end = self.next_change(index, part, (piece, radius), gravity, start).min(until);
            let middle = piece.position_at(0.5 * (start + end), gravity);
            if self.acts(index, part, middle, radius)
                && let Some(impact) = test([start, end])
            {
                return Some(impact);
            }
            if end >= until {
                return None;
            }
            start = end;
        }
    }

    /// The first time after `after` at which a part of a wall may begin or cease to act on a disc.
    fn next_change(
        &self,
        index: u32,
        part: Part,
        (piece, radius): (&Piece, f64),
        gravity: Vector,
        after: f64,
    ) -> f64 {
        let next = |line: &Line, end: usize, offset: Vector| {
            let seen = Piece { position: less(piece.position, offset), ..*piece };
            line.crossing(end, &seen, gravity, after)
        };
        let own = self.line(index);
        let of_both =
            |line: &Line, offset: Vector| next(line, 0, offset).min(next(line, 1, offset));
        match part {
            Part::Side => of_both(own, [0.0; 2]),
            Part::End(end) => {
                // An end also begins and ceases to act where the disc comes beside a wall that covers the end.
                // Walls that are solid from one side do so where the centre crosses their line.
                let turn = |line: &Line, offset: Vector| {
                    let seen = Piece { position: less(piece.position, offset), ..*piece };
                    let crosses = || line.crossing_of_line(&seen, gravity, after);
                    if line.is_one_way { crosses() } else { f64::INFINITY }
                };
                let others = self.covering(index, end, radius).map(|other| {
                    let line = self.line(other.wall);
                    of_both(line, other.offset).min(turn(line, other.offset))
                });
                let own = next(own, end, [0.0; 2]).min(turn(own, [0.0; 2]));
                others.fold(own, f64::min)
            }
        }
    }
}

impl Line {
    /// The first time after `after` at which the centre of a disc crosses the line through an end
    /// at a right angle to the wall; infinite if there is none.
    fn crossing(&self, end: usize, piece: &Piece, gravity: Vector, after: f64) -> f64 {
        first_crossing(self.beyond(end, piece.position), self.along, piece, gravity, after)
    }

    /// The first time after `after` at which the centre of a disc crosses the line through both ends; infinite if there
    /// is none.
    pub(super) fn crossing_of_line(&self, piece: &Piece, gravity: Vector, after: f64) -> f64 {
        first_crossing(self.left_of(piece.position), self.across(), piece, gravity, after)
    }
}

/// The first time after `after` at which the distance of a disc from a line is 0; infinite if there is none. The
/// distance is `distance` at the beginning of the piece and grows along `direction`.
fn first_crossing(
    distance: f64,
    direction: Vector,
    piece: &Piece,
    gravity: Vector,
    after: f64,
) -> f64 {
    let speed = dot(piece.velocity, direction);
    let pull = if piece.falls { dot(gravity, direction) } else { 0.0 };
    let roots = if pull == 0.0 {
        [-distance / speed; 2]
    } else {
        // Both summands have the same sign, and the second root follows from the product of the
        // roots.
        // distance + speed t + ½ pull t² = 0, without cancellation.
        let root = (speed * speed - 2.0 * pull * distance).sqrt();
        let sum = -(speed + if speed < 0.0 { -root } else { root });
        [sum / pull, 2.0 * distance / sum]
    };
    let times = roots.map(|t| piece.time + t);
    // NaN is no root.
    times.into_iter().filter(|&time| time > after).fold(f64::INFINITY, f64::min)
}
