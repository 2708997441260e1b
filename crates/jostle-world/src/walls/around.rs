//! The walls around discs in a step: which of them a disc may touch, its contacts, and its next
//! impact.

use std::cell::Cell;

use super::moving::Clock;
use super::near::{MARGIN, Near, NearWall};
use super::torus::each_tile;
use super::{Part, Walls, less, number_of};
use crate::container::{Container, size};
use crate::motion::exact;
use crate::particles::Particles;
use crate::trajectory::{Impact, Limits, Piece, Vector, dot, vector};
use jostle_index::geometry::{Bounds, Core, Shape};
use jostle_index::pairs::Path;
use jostle_index::query::each_overlap;
use jostle_index::shapes::{DEFAULT_CATEGORY, DEFAULT_MASK};

/// Relative size of the rounding of positions in float32, with a reserve.
const ROUNDING: f32 = 1e-6;

/// A disc that leaves its bounds is tested in parts of its trajectory. A part is about as long as
/// this, in radii.
const PART: f64 = 32.0;

/// Maximum number of parts of a trajectory.
const MAX_PARTS: f64 = 256.0;

thread_local! {
    /// Scratch of [`Around::each`], which many threads call.
    static STACK: Cell<Vec<u32>> = const { Cell::new(Vec::new()) };
}

/// The walls around discs in a step.
#[derive(Clone, Copy)]
pub struct Around<'a> {
    /// The container.
    pub container: Container,
    /// All other walls.
    pub walls: &'a Walls,
    /// Those near each disc.
    pub near: &'a Near,
    /// The discs at the beginning of the step.
    pub particles: &'a Particles,
    /// When the flight begins.
    pub clock: Clock,
}

impl Around<'_> {
    /// Whether there are no walls.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.walls.is_empty()
    }

    /// A test in float32 that is true only if a disc at a position is certainly farther than
    /// `extent` from all walls.
    #[inline(always)]
    pub fn is_far(&self, index: u32, [x, y]: [f32; 2], extent: f32) -> bool {
        let at = index as usize;
        let [p, q] = self.particles.positions[at];
        let square = (x - p) * (x - p) + (y - q) * (y - q);
        // The circles of the bounds and the boxes of the walls have a reserve for rounding.
        let left = self.near.free[at] - extent;
        left >= 0.0 && square <= left * left
    }

    /// A distance by which a disc at a position may certainly be displaced without touching a wall, in
    /// float32; not above 0 if none is known.
    #[inline(always)]
    pub fn clearance(&self, index: u32, [x, y]: [f32; 2]) -> f32 {
        let at = index as usize;
        let [p, q] = self.particles.positions[at];
        let far = ((x - p) * (x - p) + (y - q) * (y - q)).sqrt();
        self.near.free[at] - far * (1.0 + 4.0 * f32::EPSILON)
    }

    /// Whether a disc may come within `extent` of a wall at the beginning of a straight path, and
    /// anywhere on it; false only if it certainly does not, in float32. The wall `left` does not
    /// count if the path leads away from it.
    #[inline(always)]
    pub fn may_touch(&self, index: u32, path: &Path, extent: f32, left: Option<u32>) -> [bool; 2] {
        let [x, y] = path.displacement;
        let far = (x * x + y * y).sqrt() + extent;
        if self.is_far(index, path.position, far) {
            return [false; 2];
        }
        self.may_touch_near(index, path, far, extent, left)
    }

    /// Tests the listed walls of the disc. Not inlined, because few discs need it.
    #[inline(never)]
    fn may_touch_near(
        &self,
        index: u32,
        path: &Path,
        far: f32,
        extent: f32,
        left: Option<u32>,
    ) -> [bool; 2] {
        let (at, near) = (index as usize, self.near);
        let ([x, y], [p, q]) = (path.position, self.particles.positions[at]);
        let square = (x - p) * (x - p) + (y - q) * (y - q);
        let clearance = near.reaches[at] - far;
        // The list of walls is complete only within the bounds in which it was searched.
        if clearance < 0.0 || square > clearance * clearance {
            return [true; 2];
        }
        let radius = self.particles.radii[at];
        let extent = extent + ROUNDING * (x.abs() + y.abs() + radius);
        let here = Path { displacement: [0.0; 2], ..*path };
        let mut found = [false; 2];
        let all = near.starts[at] as usize..near.starts[at + 1] as usize;
        for NearWall { number, segment } in &near.walls[all] {
            // Without this, each disc that has just bounced off a wall would be tested in float64
            // again.
            let is_left = || left == Some(*number) && segment.is_left(path, extent);
            if segment.may_touch(path, radius, extent) && !is_left() {
                found = [found[0] | segment.may_touch(&here, radius, extent), true];
            }
        }
        found
    }

    /// The wall with a number, if a disc that bounces off it may count as having left it: one that
    /// stands still and has no images.
    pub fn left(&self, wall: u32) -> Option<u32> {
        // A moving wall may catch up with the disc, and on a torus another image may be ahead.
        (self.walls.period().is_none() && !self.walls.any_moves).then_some(wall)
    }

    /// Calls `act` with the number and the offset of each wall that a disc may touch, or whose
    /// distance from its surface may be less than `extent`, while its centre is in a box given by
    /// two corners; also with some others. A wall acts as if it were moved by the offset, which is
    /// 0 except on a torus.
    pub fn each(
        &self,
        index: u32,
        [min, max]: [Vector; 2],
        extent: f64,
        mut act: impl FnMut(u32, Vector),
    ) {
        if self.is_empty() {
            return;
        }
        let Particles { positions, residuals, radii, .. } = self.particles;
        let at = index as usize;
        let radius = f64::from(radii[at]);
        let anchor = exact(positions[at], residuals[at]);
        // The farthest corner of the box from where the disc was when walls were searched.
        let far = vector(|k| (anchor[k] - min[k]).max(max[k] - anchor[k]));
        // The circles of the bounds and the boxes of the walls have a reserve for rounding.
        if dot(far, far).sqrt() + extent <= f64::from(self.near.reaches[at]) {
            self.near.each(index, act);
        } else {
            let margin = (radius + extent) * (1.0 + MARGIN);
            let filter = self.particles.filter(at);
            let mut stack = STACK.take();
            self.walls.each_near([min, max], margin, &mut stack, |wall, offset| {
                if self.walls.all[wall as usize].stops(filter) {
                    act(number_of(wall), offset);
                }
            });
            STACK.set(stack);
        }
    }

    /// The first impact of a disc on a wall before `until`, or of some after it, and the number of
    /// the wall. `limits` gives those of each wall.
    pub fn impact(
        &self,
        index: u32,
        piece: &Piece,
        until: f64,
        gravity: Vector,
        limits: impl Fn(u32) -> Limits,
    ) -> Option<(Impact, u32)> {
        let mut start = piece.time;
        let radius = f64::from(self.particles.radii[index as usize]);
        let (velocity, span) = (piece.velocity, until - start);
        // An upper bound: gravity adds to the speed as if it had the same direction.
        let fastest = dot(velocity, velocity).sqrt() + dot(gravity, gravity).sqrt() * span;
        let longest = fastest * span;
        if self.is_far(index, piece.position.map(|v| v as f32), longest as f32) {
            return None;
        }
        // Not a number without displacement of a point.
        let parts = longest / (PART * radius);
        let is_long = parts > 1.0;
        // A disc that stays where its walls were searched needs no search in the tree.
        let mut search = Search { around: self, piece, radius, gravity, first: None };
        if !is_long && self.stays_near(index, piece.position, longest) {
            self.near.each(index, |wall, offset| {
                search.test(wall, offset, [start, until], &limits);
            });
            return search.first;
        }
        // The box around a long path contains walls far from the path, and in the worst case all.
        // Parts of it have small boxes, and the search ends with the part that has an impact.
        let parts = if is_long { parts.min(MAX_PARTS).ceil() } else { 1.0 };
        for part in 1..=parts as u32 {
            let end = start + (until - start) / (parts - f64::from(part - 1));
            let bounds = bounds(piece, [start, end], gravity);
            self.each(index, bounds, 0.0, |wall, offset| {
                search.test(wall, offset, [start, end], &limits);
            });
            // An impact that was found may be later than this part, and the next part may have an
            // earlier one.
            if search.first.is_some_and(|(impact, _)| impact.time <= end) {
                break;
            }
            start = end;
        }
        search.first
    }

    /// Whether a disc that moves from a position by at most `longest` stays in the region in which
    /// walls near it were searched.
    pub(super) fn stays_near(&self, index: u32, position: Vector, longest: f64) -> bool {
        let at = index as usize;
        let anchor = exact(self.particles.positions[at], self.particles.residuals[at]);
        let offset = less(position, anchor);
        dot(offset, offset).sqrt() + longest <= f64::from(self.near.reaches[at])
    }

    /// A piece relative to a wall with an offset.
    pub(super) fn seen_from(&self, wall: u32, offset: Vector, piece: &Piece) -> Piece {
        let velocity = self.velocity(wall);
        if velocity == [0.0; 2] && offset == [0.0; 2] {
            return *piece;
        }
        Piece {
            position: self.position_from(wall, less(piece.position, offset), piece.time),
            velocity: vector(|k| piece.velocity[k] - velocity[k]),
            ..*piece
        }
    }

    /// A position at some time relative to where a wall is then, as if the wall had not moved.
    pub fn position_from(&self, wall: u32, position: Vector, time: f64) -> Vector {
        let offset = self.clock.offset(self.walls, wall, time);
        vector(|k| position[k] - offset[k])
    }

    /// The velocity of a wall, per second of flight; 0 at the container.
    pub fn velocity(&self, wall: u32) -> Vector {
        self.walls.velocity(wall).map(|v| f64::from(v) * self.clock.rate)
    }

    /// Unit normal of a wall where a disc begins a piece, towards the disc.
    pub fn normal(&self, index: u32, wall: u32, now: &Piece) -> Vector {
        let radius = f64::from(self.particles.radii[index as usize]);
        let seen = self.seen_from(wall, [0.0; 2], now);
        let contact = self.walls.nearest_contact(wall, seen.position, seen.velocity, radius);
        contact.map_or([0.0; 2], |contact| contact.normal)
    }

    /// Finds the contacts of a disc at some time and the walls that are nearer to its surface than
    /// `extent`, and that act on it. Contacts in the same direction are one, that with the
    /// smallest gap.
    pub fn contacts(
        &self,
        index: u32,
        (position, time): (Vector, f64),
        radius: f64,
        extent: f64,
        found: &mut Vec<super::WallContact>,
    ) {
        found.clear();
        let path = Path { position: position.map(|v| v as f32), displacement: [0.0; 2] };
        if self.may_touch(index, &path, extent as f32, None) == [false; 2] {
            return;
        }
        self.each(index, [position; 2], extent, |wall, offset| {
            let position = self.position_from(wall, less(position, offset), time);
            if !self.walls.is_near(wall, [position; 2], radius + extent) {
                return;
            }
            let contact = self.walls.acting_contact(wall, position, radius);
            found.extend(contact.filter(|contact| contact.gap <= extent));
        });
        if found.len() > 1 {
            // Of contacts in one direction that with the smallest gap remains, of equal ones that
            // of the first wall. So the order of the lists, which differs with the method, does not
            // matter.
            found.sort_unstable_by(|a, b| a.gap.total_cmp(&b.gap).then_with(|| a.compare(b)));
            let mut kept = 0;
            for at in 0..found.len() {
                let contact = found[at];
                if !found[..kept].iter().any(|other| other.is_same(&contact)) {
                    found[kept] = contact;
                    kept += 1;
                }
            }
            found.truncate(kept);
        }
    }
}

/// The search for the first impact of a disc on a wall.
struct Search<'a> {
    around: &'a Around<'a>,
    piece: &'a Piece,
    radius: f64,
    gravity: Vector,
    /// The first impact so far, and the number of the wall.
    first: Option<(Impact, u32)>,
}

impl Search<'_> {
    /// Takes the impact on a wall with an offset between two times, if it is the first.
    fn test(
        &mut self,
        wall: u32,
        offset: Vector,
        times: [f64; 2],
        limits: &impl Fn(u32) -> Limits,
    ) {
        let Self { around, radius, gravity, first, .. } = *self;
        let seen = around.seen_from(wall, offset, self.piece);
        // A cheap test first, because most walls near a disc are not hit.
        if !around.walls.may_hit(wall, &seen, times, radius, gravity) {
            return;
        }
        let found = around.walls.impact(wall, &seen, radius, gravity, &limits(wall));
        // Two walls may be hit at the same time. The number decides, and not the order of the
        // search.
        let is_first = |impact: &Impact| {
            first.is_none_or(|(before, other)| {
                impact.time.total_cmp(&before.time).then(wall.cmp(&other)).is_lt()
            })
        };
        if let Some(impact) = found.filter(is_first) {
            self.first = Some((impact, wall));
        }
    }
}

/// A box that contains the trajectory of a centre between two times.
pub(super) fn bounds(piece: &Piece, times: [f64; 2], gravity: Vector) -> [Vector; 2] {
    let [a, b] = times.map(|time| piece.position_at(time, gravity));
    // Where a parabola has its vertex along an axis, or one of the ends.
    let vertex = |k: usize| {
        let time = piece.time - piece.velocity[k] / gravity[k];
        let is_between = piece.falls && times[0] < time && time < times[1];
        if is_between { piece.position_at(time, gravity)[k] } else { a[k] }
    };
    [vector(|k| a[k].min(b[k]).min(vertex(k))), vector(|k| a[k].max(b[k]).max(vertex(k)))]
}

impl Walls {
    /// Whether the wall with a number may be nearer than a radius to a box, by their extents along
    /// the wall and across it (separating axes).
    #[inline(always)]
    pub fn is_near(&self, wall: u32, [min, max]: [Vector; 2], radius: f64) -> bool {
        let line = self.numbered(wall);
        let [ux, uy] = line.along;
        let [x, y] = vector(|k| 0.5 * (min[k] + max[k]) - line.ends[0][k]);
        let [width, height] = vector(|k| 0.5 * (max[k] - min[k]));
        // The skin of points, and a reserve for rounding.
        let contact_distance = line.contact_distance(radius) + line.least_radius;
        let [ax, ay] = [ux.abs(), uy.abs()];
        let (across, along) = (x * uy - y * ux, x * ux + y * uy);
        let far = contact_distance + (ax * width + ay * height);
        across.abs() <= contact_distance + (ay * width + ax * height)
            && along >= -far
            && along <= line.length + far
    }

    /// Whether a disc on a piece may touch the wall with a number between two times, by its
    /// extent along the wall and across it, and by the direction in which it moves.
    #[inline(always)]
    fn may_hit(
        &self,
        wall: u32,
        piece: &Piece,
        times: [f64; 2],
        radius: f64,
        gravity: Vector,
    ) -> bool {
        let line = self.numbered(wall);
        let [ux, uy] = line.along;
        // Its distances from the first end across the wall and along it, at both times.
        let [[a, along_a], [b, along_b]] = times.map(|time| {
            let position = piece.position_at(time, gravity);
            let [x, y] = vector(|k| position[k] - line.ends[0][k]);
            [y * ux - x * uy, x * ux + y * uy]
        });
        // A parabola leaves its chord by at most g t² / 8.
        let span = times[1] - times[0];
        let sag =
            if piece.falls { 0.125 * dot(gravity, gravity).sqrt() * span * span } else { 0.0 };
        // The skin of points, and a reserve for rounding.
        let contact_distance = line.contact_distance(radius) + line.least_radius;
        let far = contact_distance + sag;
        let is_apart = a.min(b) > far
            || a.max(b) < -far
            || along_a.max(along_b) < -far
            || along_a.min(along_b) > line.length + far;
        // A disc that moves away from the line does not come nearer to any of its points; if it is
        // beside the wall and touches it, it will not touch an end either.
        let side = if a < 0.0 { -1.0 } else { 1.0 };
        let speed = side * dot(line.across(), piece.velocity);
        let leaves = !piece.falls
            && speed >= 0.0
            && (side * a > contact_distance || line.part_at(piece.position) == Part::Side);
        !(is_apart || leaves)
    }

    /// Calls `act` with the index and the offset of each wall whose bounds are nearer than `margin`
    /// to a box given by two corners, and of a few others.
    pub(super) fn each_near(
        &self,
        area: [Vector; 2],
        margin: f64,
        stack: &mut Vec<u32>,
        mut act: impl FnMut(u32, Vector),
    ) {
        let period = self.period();
        if period.is_none() {
            return self.each_in(area, margin, stack, act);
        }
        each_tile(area, period.sides(), |part, tile| {
            self.each_in(part, margin, stack, |wall, offset| {
                act(wall, vector(|k| offset[k] + tile[k]));
            });
        });
    }

    /// Calls `act` with the distance of a point from each solid wall that is nearer than `margin`, and from a few
    /// others.
    pub fn each_distance(
        &self,
        point: Vector,
        margin: f64,
        stack: &mut Vec<u32>,
        mut act: impl FnMut(f64),
    ) {
        self.each_near([point; 2], margin, stack, |wall, offset| {
            if !self.at(wall).is_sensor {
                act(self.line(wall).distance(less(point, offset)));
            }
        });
    }

    /// Calls `act` for the walls in a box that is on the torus.
    fn each_in(
        &self,
        [min, max]: [Vector; 2],
        margin: f64,
        stack: &mut Vec<u32>,
        mut act: impl FnMut(u32, Vector),
    ) {
        // The corners are rounded to float32 below. The margin grows by more than that.
        let margin = margin + MARGIN * size(min, 0.0).max(size(max, 0.0));
        let bounds = Bounds::of(&Shape {
            min: min.map(|v| v as f32),
            max: max.map(|v| v as f32),
            half_size: [0.0; 2],
            radius: margin as f32,
            category: DEFAULT_CATEGORY,
            mask: DEFAULT_MASK,
            core: Core::Box,
        });
        each_overlap(&self.tree, &bounds, f32::NEG_INFINITY, stack, |index| {
            let image = &self.images[self.tree.rows()[index] as usize];
            act(image.wall, image.offset);
        });
    }
}
