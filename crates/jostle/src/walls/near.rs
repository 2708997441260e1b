//! The broad phase of walls: which of them each disc may touch during a step.

use std::cell::Cell;

use super::moving::Clock;
use super::torus::each_tile;
use super::{FIRST, Part, Walls, less};
use crate::columns::Columns;
use crate::container::size;
use crate::error::{Error, Result};
use crate::geometry::{Bounds, Shape};
use crate::motion::exact;
use crate::pairs::{self, Filters, JoinScratch};
use crate::particles::Particles;
use crate::quadtree::Quadtree;
use crate::query::each_overlap;
use crate::settings::Method;
use crate::shapes::{DEFAULT_CATEGORY, DEFAULT_MASK};
use crate::trajectory::{Impact, Limits, Segment, Vector, dot, vector};

/// Relative size of the rounding of bounds in float32, with a large reserve.
const MARGIN: f64 = 1e-6;

/// A disc that leaves its bounds is tested in parts of its trajectory. A part is about as long as
/// this, in radii.
const PART: f64 = 32.0;

/// Parts of a trajectory at most.
const MOST_PARTS: f64 = 256.0;

thread_local! {
    /// Scratch of [`Around::each`], which many threads call.
    static STACK: Cell<Vec<u32>> = const { Cell::new(Vec::new()) };
}

/// The walls near each disc in the bounds of a step, in one array (compressed sparse rows).
#[derive(Debug, Default)]
pub struct Near {
    /// `walls[starts[i]..starts[i + 1]]` are the numbers of the walls near disc i.
    starts: Vec<u32>,
    walls: Vec<u32>,
    /// Their offsets on a torus; empty elsewhere.
    offsets: Vec<Vector>,
    /// Distances from their positions at the beginning of the step within which discs were
    /// searched.
    reaches: Vec<f32>,
    /// Displacements after which discs certainly touch no wall yet; at most these distances.
    free: Vec<f32>,
    found: Vec<[u32; 2]>,
    join: JoinScratch,
}

impl Near {
    /// Takes the walls that overlap the circles of `bounds`, which are in the order of the discs.
    pub fn fill(
        &mut self,
        walls: &Walls,
        bounds: &Quadtree<f32>,
        reaches: &[f32],
        method: Method,
        most: usize,
    ) -> Result<()> {
        self.starts.clear();
        self.walls.clear();
        if walls.is_empty() {
            return Ok(());
        }
        let is_near = |[wall, place]: [u32; 2]| {
            let circle = bounds.columns().shape(place as usize);
            let line = &walls.lines[wall as usize];
            let distance = line.distance(less(circle.min.map(f64::from), walls.offset_at(wall)));
            distance <= line.reach(f64::from(circle.radius)) * (1.0 + MARGIN) + line.travel
        };
        let Self { join, found, .. } = self;
        join.keep(std::mem::take(found));
        let pairs = match method {
            Method::Quadtree => {
                pairs::near_segments(&walls.tree, &walls.segments, bounds, most, join)
            }
            Method::Brute => {
                let [lines, discs] = [&walls.tree, bounds].map(Quadtree::columns);
                pairs::brute_between(lines, discs, [0.0; 2], Filters::Ignore, most)
            }
        };
        *found = pairs
            .map_err(|error| match error {
                Error::TooManyPairs { max_pairs } => Error::TooManyCandidates { limit: max_pairs },
                other => other,
            })?
            .pairs;
        if method == Method::Brute {
            found.retain(|&pair| is_near(pair));
        }
        self.arrange(walls, bounds.len());
        self.find_free(walls, bounds, reaches);
        Ok(())
    }

    /// Sorts the walls that were found by discs.
    fn arrange(&mut self, walls: &Walls, discs: usize) {
        self.starts.resize(discs + 2, 0);
        self.found.iter().for_each(|&[_, place]| self.starts[place as usize + 2] += 1);
        for place in 2..self.starts.len() {
            self.starts[place] += self.starts[place - 1];
        }
        self.walls.resize(self.found.len(), 0);
        let offsets = if walls.torus.is_some() { self.found.len() } else { 0 };
        self.offsets.resize(offsets, [0.0; 2]);
        for &[wall, place] in &self.found {
            let next = &mut self.starts[place as usize + 1];
            let image = &walls.images[walls.tree.rows()[wall as usize] as usize];
            self.walls[*next as usize] = FIRST + image.wall;
            if let Some(offset) = self.offsets.get_mut(*next as usize) {
                *offset = image.offset;
            }
            *next += 1;
        }
    }

    /// Finds the displacements after which discs touch no wall yet.
    fn find_free(&mut self, walls: &Walls, bounds: &Quadtree<f32>, reaches: &[f32]) {
        let Self { found, free, .. } = self;
        self.reaches.clear();
        self.reaches.extend_from_slice(reaches);
        free.clear();
        free.extend_from_slice(reaches);
        for &[wall, place] in &*found {
            let (line, at) = (&walls.lines[wall as usize], place as usize);
            let Columns { x, y, radius, .. } = bounds.columns();
            let (free, center) = (&mut free[at], [x[at], y[at]].map(f64::from));
            // The radius of the disc, with the reserve of the circle for rounding.
            let radius = line.reach(f64::from(radius[at]) - f64::from(reaches[at]));
            let distance = line.distance(less(center, walls.offset_at(wall)));
            let left = distance - radius * (1.0 + MARGIN) - line.travel;
            *free = free.min(left as f32);
        }
    }

    /// Calls `act` with the number and the offset of each wall near a disc.
    fn each(&self, place: u32, mut act: impl FnMut(u32, Vector)) {
        let [first, end] = [place, place + 1].map(|at| self.starts[at as usize] as usize);
        for (at, &wall) in (first..).zip(&self.walls[first..end]) {
            act(wall, self.offsets.get(at).copied().unwrap_or_default());
        }
    }
}

/// The walls around discs in a step.
#[derive(Clone, Copy)]
pub struct Around<'a> {
    /// All walls.
    pub walls: &'a Walls,
    /// Those near each disc.
    pub near: &'a Near,
    /// The discs at the beginning of the step.
    pub particles: &'a Particles,
    /// When the window begins.
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
    pub fn is_far(&self, place: u32, [x, y]: [f32; 2], extent: f32) -> bool {
        let at = place as usize;
        let [p, q] = self.particles.positions[at];
        let square = (x - p) * (x - p) + (y - q) * (y - q);
        // The circles of the bounds and the boxes of the walls have a reserve for rounding.
        let left = self.near.free[at] - extent;
        left >= 0.0 && square <= left * left
    }

    /// Calls `act` with the number and the offset of each wall that a disc may touch while its centre
    /// is in a box given by two corners, or that is nearer than `extent` to its surface there; and
    /// with others. A wall acts as if it were moved by the offset, which is 0 but on a torus.
    pub fn each(
        &self,
        place: u32,
        [min, max]: [Vector; 2],
        extent: f64,
        mut act: impl FnMut(u32, Vector),
    ) {
        if self.is_empty() {
            return;
        }
        let Particles { positions, residuals, radii, .. } = self.particles;
        let at = place as usize;
        let radius = f64::from(radii[at]);
        let anchor = exact(positions[at], residuals[at]);
        let far = vector(|k| (anchor[k] - min[k]).max(max[k] - anchor[k]));
        // The circles of the bounds and the boxes of the walls have a reserve for rounding.
        if dot(far, far).sqrt() + extent <= f64::from(self.near.reaches[at]) {
            self.near.each(place, act);
        } else {
            let margin = (radius + extent) * (1.0 + MARGIN);
            let mut stack = STACK.take();
            self.walls.each_near([min, max], margin, &mut stack, |index, offset| {
                act(FIRST + index, offset);
            });
            STACK.set(stack);
        }
    }

    /// The first impact of a disc on a wall before `until`, and the number of the wall. `limits`
    /// gives those of each wall.
    pub fn impact(
        &self,
        place: u32,
        segment: &Segment,
        until: f64,
        gravity: Vector,
        limits: impl Fn(u32) -> Limits,
    ) -> Option<(Impact, u32)> {
        let mut start = segment.time;
        let radius = f64::from(self.particles.radii[place as usize]);
        let (velocity, span) = (segment.velocity, until - start);
        let fastest = dot(velocity, velocity).sqrt() + dot(gravity, gravity).sqrt() * span;
        let longest = fastest * span;
        if self.is_far(place, segment.position.map(|v| v as f32), longest as f32) {
            return None;
        }
        // Not a number without displacement of a point.
        let parts = longest / (PART * radius);
        let is_long = parts > 1.0;
        let mut search = Search { around: self, segment, until, radius, gravity, first: None };
        if !is_long && self.stays_near(place, segment.position, longest) {
            self.near.each(place, |wall, offset| {
                search.test(wall, offset, [start, until], &limits);
            });
            return search.first;
        }
        let parts = if is_long { parts.min(MOST_PARTS).ceil() } else { 1.0 };
        for part in 1..=parts as u32 {
            let end = start + (until - start) / (parts - f64::from(part - 1));
            let bounds = bounds(segment, [start, end], gravity);
            self.each(place, bounds, 0.0, |wall, offset| {
                search.test(wall, offset, [start, end], &limits);
            });
            if search.first.is_some_and(|(impact, _)| impact.time <= end) {
                break;
            }
            start = end;
        }
        search.first
    }

    /// Whether a disc stays where the walls near it were searched, if it moves by `longest` at most from
    /// a position.
    fn stays_near(&self, place: u32, position: Vector, longest: f64) -> bool {
        let at = place as usize;
        let anchor = exact(self.particles.positions[at], self.particles.residuals[at]);
        let offset = less(position, anchor);
        dot(offset, offset).sqrt() + longest <= f64::from(self.near.reaches[at])
    }

    /// A segment relative to a wall with an offset.
    fn seen_from(&self, wall: u32, offset: Vector, segment: &Segment) -> Segment {
        let velocity = self.velocity(wall);
        if velocity == [0.0; 2] && offset == [0.0; 2] {
            return *segment;
        }
        Segment {
            position: self.position_from(wall, less(segment.position, offset), segment.time),
            velocity: vector(|k| segment.velocity[k] - velocity[k]),
            ..*segment
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

    /// Unit normal of a wall where a disc begins a segment, towards the disc.
    pub fn normal(&self, place: u32, wall: u32, now: &Segment) -> Vector {
        let radius = f64::from(self.particles.radii[place as usize]);
        let seen = self.seen_from(wall, [0.0; 2], now);
        self.walls.nearest_contact(wall, seen.position, seen.velocity, radius).normal
    }

    /// Finds the contacts of a disc at some time and the walls that are nearer to its surface than
    /// `extent`, and that act on it. Contacts in the same direction are one, that with the
    /// smallest gap.
    pub fn contacts(
        &self,
        place: u32,
        (position, time): (Vector, f64),
        radius: f64,
        extent: f64,
        found: &mut Vec<super::Contact>,
    ) {
        found.clear();
        if self.is_far(place, position.map(|v| v as f32), extent as f32) {
            return;
        }
        self.each(place, [position; 2], extent, |wall, offset| {
            let position = self.position_from(wall, less(position, offset), time);
            if !self.walls.is_near(wall, [position; 2], radius + extent) {
                return;
            }
            let contact = self.walls.acting_contact(wall, position, radius);
            found.extend(contact.filter(|contact| contact.gap <= extent));
        });
        if found.len() > 1 {
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
    segment: &'a Segment,
    until: f64,
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
        let seen = around.seen_from(wall, offset, self.segment);
        if !around.walls.may_hit(wall, &seen, times, radius, gravity) {
            return;
        }
        let until = first.map_or(self.until, |(impact, _)| impact.time);
        let limits = Limits { until, ..limits(wall) };
        let found = around.walls.impact(wall, &seen, radius, gravity, &limits);
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
fn bounds(segment: &Segment, times: [f64; 2], gravity: Vector) -> [Vector; 2] {
    let [a, b] = times.map(|time| segment.place_at(time, gravity));
    // Where a parabola has its vertex along an axis, or one of the ends.
    let vertex = |k: usize| {
        let time = segment.time - segment.velocity[k] / gravity[k];
        let is_between = segment.falls && times[0] < time && time < times[1];
        if is_between { segment.place_at(time, gravity)[k] } else { a[k] }
    };
    [vector(|k| a[k].min(b[k]).min(vertex(k))), vector(|k| a[k].max(b[k]).max(vertex(k)))]
}

impl Walls {
    /// Whether the wall with a number may be nearer than a radius to a box, by their extents along
    /// the wall and across it (separating axes).
    #[inline(always)]
    pub fn is_near(&self, wall: u32, [min, max]: [Vector; 2], radius: f64) -> bool {
        let line = self.line(wall - FIRST);
        let [ux, uy] = line.along;
        let [x, y] = vector(|k| 0.5 * (min[k] + max[k]) - line.ends[0][k]);
        let [width, height] = vector(|k| 0.5 * (max[k] - min[k]));
        // The skin of points, and a reserve for rounding.
        let reach = line.reach(radius) + line.least_radius;
        let [ax, ay] = [ux.abs(), uy.abs()];
        let (across, along) = (x * uy - y * ux, x * ux + y * uy);
        let far = reach + (ax * width + ay * height);
        across.abs() <= reach + (ay * width + ax * height)
            && along >= -far
            && along <= line.length + far
    }

    /// Whether a disc on a segment may touch the wall with a number between two times, by its extent
    /// along the wall and across it, and by the direction in which it moves.
    #[inline(always)]
    fn may_hit(
        &self,
        wall: u32,
        segment: &Segment,
        times: [f64; 2],
        radius: f64,
        gravity: Vector,
    ) -> bool {
        let line = self.line(wall - FIRST);
        let [ux, uy] = line.along;
        // Its distances from the first end across the wall and along it, at both times.
        let [[a, along_a], [b, along_b]] = times.map(|time| {
            let place = segment.place_at(time, gravity);
            let [x, y] = vector(|k| place[k] - line.ends[0][k]);
            [y * ux - x * uy, x * ux + y * uy]
        });
        // A parabola leaves its chord by at most g t² / 8.
        let span = times[1] - times[0];
        let sag =
            if segment.falls { 0.125 * dot(gravity, gravity).sqrt() * span * span } else { 0.0 };
        // The skin of points, and a reserve for rounding.
        let reach = line.reach(radius) + line.least_radius;
        let far = reach + sag;
        let is_apart = a.min(b) > far
            || a.max(b) < -far
            || along_a.max(along_b) < -far
            || along_a.min(along_b) > line.length + far;
        // A disc that moves away from the line does not come nearer to any of its points; if it is
        // beside the wall and touches it, it will not touch an end either.
        let side = if a < 0.0 { -1.0 } else { 1.0 };
        let speed = side * dot(line.across(), segment.velocity);
        let leaves = !segment.falls
            && speed >= 0.0
            && (side * a > reach || line.part_at(segment.position) == Part::Side);
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
        match self.torus {
            None => self.each_in(area, margin, stack, act),
            Some(sides) => each_tile(area, sides, |part, tile| {
                self.each_in(part, margin, stack, |wall, offset| {
                    act(wall, vector(|k| offset[k] + tile[k]));
                });
            }),
        }
    }

    /// The same for a box on the torus.
    fn each_in(
        &self,
        [min, max]: [Vector; 2],
        margin: f64,
        stack: &mut Vec<u32>,
        mut act: impl FnMut(u32, Vector),
    ) {
        let margin = margin + MARGIN * size(min, 0.0).max(size(max, 0.0));
        let bounds = Bounds::of(&Shape {
            min: min.map(|v| v as f32),
            max: max.map(|v| v as f32),
            half_size: [0.0; 2],
            radius: margin as f32,
            category: DEFAULT_CATEGORY,
            mask: DEFAULT_MASK,
        });
        each_overlap(&self.tree, &bounds, f32::NEG_INFINITY, stack, |place| {
            let image = &self.images[self.tree.rows()[place] as usize];
            act(image.wall, image.offset);
        });
    }

    /// The offset of the wall at a place of the tree.
    #[inline(always)]
    fn offset_at(&self, place: u32) -> Vector {
        if self.torus.is_none() {
            return [0.0; 2];
        }
        self.images[self.tree.rows()[place as usize] as usize].offset
    }
}
