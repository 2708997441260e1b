//! The events of a sub-step in the order of time.
//!
//! Discs that meet along their first segments form islands. Each island finds the history of its
//! discs by itself, then the new trajectories are tested against all discs near them. Where a
//! trajectory meets a disc of another island, the two islands become one and begin again; where
//! it leaves the bounds of its disc, the bounds grow. When no test finds anything, every
//! trajectory has been tested against everything that it can reach, so the histories together are
//! the true one. It does not depend on threads, nor on how pairs were found.

mod impulses;
mod island;
mod neighbors;

use crate::container::{Container, MAX_WALLS};
use crate::error::Result;
use crate::flow::Flow;
use crate::forces::Thermostat;
use crate::interrupt::{self, Stop};
use crate::motion::Motions;
use crate::parallel;
use crate::particles::Particles;
use crate::trajectory::{
    Impact, Limits, Relative, Segment, Vector, dot, vector, wall_impact, wall_normal,
};
use island::{Bounce, Course, History, Island, NO_ISLAND, Place, Scratch};
use neighbors::Neighbor;
pub use neighbors::Neighbors;

/// Members of islands that one task simulates.
const TASK: usize = 1024;

/// Relative size of the rounding of positions in float32, with a reserve for sums.
const ROUNDING: f64 = 1.0 / (1 << 22) as f64;

/// Discs for each first impact in a window, at least.
const DISCS_PER_IMPACT: usize = 4;

/// So few discs can all have impacts in one window.
const FEW: usize = 64;

/// Windows of a sub-step at most, apart from the last of all.
const MOST_WINDOWS: f64 = 1024.0;

/// Relative error, with a large reserve, of the tests in float32.
const MARGIN: f32 = 1e-4;

/// How a disc begins a sub-step.
struct Start {
    position: [f32; 2],
    velocity: [f32; 2],
    radius: f32,
    /// Whether it cannot move.
    is_still: bool,
}

/// What all discs of a sub-step have in common, and how they begin it.
#[derive(Clone, Copy)]
pub struct Flight<'a> {
    /// The discs.
    pub particles: &'a Particles,
    /// Which of them move.
    pub movable: &'a [bool],
    /// Positions and velocities at the beginning.
    pub motions: &'a Motions,
    /// Acceleration.
    pub gravity: Vector,
    /// Duration of the flight.
    pub end: f64,
    /// What linear damping does to the velocities after the flight.
    pub flow: Flow,
    /// Whether the flight ends the sub-step.
    pub last: bool,
    /// The walls.
    pub container: Container,
    /// Coefficient of restitution of the world.
    pub restitution: f32,
    /// What walls do to speeds.
    pub thermostat: Option<Thermostat>,
    /// Whether discs bounce off each other.
    pub pairs: bool,
    /// Whether all discs stay in their bounds as long as they have no events.
    pub bounded: bool,
    /// Threads to use.
    pub threads: Option<usize>,
}

impl Flight<'_> {
    fn is_movable(&self, index: u32) -> bool {
        self.movable[index as usize]
    }

    fn inverse_mass(&self, index: u32) -> f64 {
        if self.is_movable(index) {
            1.0 / f64::from(self.particles.masses[index as usize])
        } else {
            0.0
        }
    }

    fn radius(&self, index: u32) -> f64 {
        f64::from(self.particles.radii[index as usize])
    }

    /// The first segment of a disc.
    #[inline(always)]
    fn segment(&self, index: u32) -> Segment {
        let falls = self.gravity != [0.0; 2] && self.is_movable(index);
        Segment {
            time: 0.0,
            position: self.motions.position(index).map(f64::from),
            velocity: self.motions.velocity(index).map(f64::from),
            falls,
        }
    }

    /// How a disc begins, in float32.
    #[inline(always)]
    fn start(&self, index: u32) -> Start {
        Start {
            position: self.motions.position(index),
            velocity: self.motions.velocity(index),
            radius: self.particles.radii[index as usize],
            is_still: !self.is_movable(index),
        }
    }

    /// A test in float32 that is false only if two discs certainly do not meet along their first
    /// segments.
    #[inline(always)]
    fn may_meet(&self, own: &Start, index: u32, image: Vector) -> bool {
        let other = self.start(index);
        if own.is_still != other.is_still && self.gravity != [0.0; 2] {
            return true;
        }
        let q = [0, 1].map(|k| other.position[k] - own.position[k] + image[k] as f32);
        let w = [0, 1].map(|k| other.velocity[k] - own.velocity[k]);
        let (approach, ww) = (q[0] * w[0] + q[1] * w[1], w[0] * w[0] + w[1] * w[1]);
        if approach > MARGIN * (q[0] * w[0]).abs() {
            return false;
        }
        let (qq, end) = (q[0] * q[0] + q[1] * q[1], self.end as f32);
        let reach = own.radius + other.radius;
        let sizes = own.position[0].abs() + own.position[1].abs() + reach;
        // Squared distance, less than any rounding of the numbers above can make it.
        let square = if -approach >= ww * end {
            qq + 2.0 * approach * end + ww * end * end
        } else {
            qq - approach * approach / ww
        };
        let error = MARGIN * (qq + reach * sizes);
        // Not a number, where there are overflows, counts as near.
        square <= reach * reach + error || square.is_nan() || error.is_nan()
    }

    /// A test in float32 that is false only if a disc certainly does not get to a flat wall.
    fn may_hit_walls(&self, index: u32) -> bool {
        let Container::Box { min, max } = self.container else {
            return self.container.has_walls();
        };
        let Start { position, velocity, radius, .. } = self.start(index);
        let end = self.end as f32;
        let near = |k: usize| {
            let far = velocity[k].abs() * end + 0.5 * self.gravity[k].abs() as f32 * end * end;
            let far = (far + radius) * (1.0 + MARGIN) + MARGIN * position[k].abs();
            !(position[k] - min[k] > far && max[k] - position[k] > far)
        };
        near(0) || near(1)
    }

    /// The velocity after the sub-step from that at the end of the flight.
    #[inline(always)]
    fn after(&self, falls: bool, velocity: Vector) -> Vector {
        if !self.last {
            return velocity;
        }
        let Flow { decay, correction, .. } = self.flow;
        let added = if falls { correction } else { [0.0; 2] };
        vector(|k| velocity[k] * decay + added[k])
    }

    /// A segment that begins later.
    fn moved(&self, segment: &Segment, time: f64) -> Segment {
        let [position, velocity] = segment.at(time, self.gravity);
        Segment { time, position, velocity, falls: segment.falls }
    }

    fn pair_restitution(&self, a: u32, b: u32) -> f64 {
        let own = self.particles.restitutions[a as usize] * self.particles.restitutions[b as usize];
        f64::from(self.restitution * own)
    }

    fn wall_restitution(&self, index: u32) -> f64 {
        f64::from(self.restitution * self.particles.restitutions[index as usize])
    }

    #[inline(always)]
    fn limits(&self, until: f64, position: Vector, reach: f64) -> Limits {
        let rounding = ROUNDING * (position[0].abs() + position[1].abs() + reach);
        Limits { until, end: self.end, rounding }
    }

    /// The next impact of two discs before `until`; `image` is added to the second.
    #[inline(always)]
    fn impact(
        &self,
        (a, first): (u32, &Segment),
        (b, second): (u32, &Segment),
        image: Vector,
        until: f64,
    ) -> Option<Impact> {
        // From the smaller index to the larger, so that both give the same numbers.
        let relative = if a < b {
            Relative::of(first, second, image, self.gravity)
        } else {
            Relative::of(second, first, image.map(|v| -v), self.gravity)
        };
        let reach = self.radius(a) + self.radius(b);
        if relative.separates() {
            return None;
        }
        let position = if a < b { first.position } else { second.position };
        let limits = self.limits(until, position, reach);
        relative.impact(reach, &limits)
    }

    /// The next impact of a disc on a wall.
    fn wall_impact(&self, index: u32, segment: &Segment) -> Option<(Impact, u8)> {
        if !self.container.has_walls() || !self.is_movable(index) {
            return None;
        }
        let radius = self.radius(index);
        let limits = self.limits(self.end, segment.position, radius);
        wall_impact(segment, radius, &self.container, self.gravity, &limits)
    }

    /// Whether two discs that begin segments now touch and approach.
    fn touch_now(
        &self,
        (a, first): (u32, &Segment),
        (b, second): (u32, &Segment),
        image: Vector,
    ) -> bool {
        let offset = vector(|k| second.position[k] - first.position[k] + image[k]);
        let reach = self.radius(a) + self.radius(b);
        let position = if a < b { first.position } else { second.position };
        let limits = self.limits(self.end, position, reach);
        let (length, near) = (dot(offset, offset).sqrt(), reach + limits.rounding);
        let speed = -dot(offset, vector(|k| second.velocity[k] - first.velocity[k])) / length;
        length <= near && is_fast(speed, first.time, &limits)
    }

    /// The walls that a disc touches and approaches as it begins a segment.
    fn touched_walls(&self, index: u32, now: &Segment) -> [Option<u8>; MAX_WALLS] {
        let mut touched = [None; MAX_WALLS];
        if !self.container.has_walls() {
            return touched;
        }
        let radius = self.radius(index);
        let limits = self.limits(self.end, now.position, radius);
        let gaps = self.container.gaps(now.position, radius);
        for (wall, gap) in gaps.into_iter().enumerate() {
            let Some(gap) = gap else { continue };
            let normal = wall_normal(&self.container, wall as u8, now.position);
            let fast = is_fast(-dot(normal, now.velocity), now.time, &limits);
            if gap <= limits.rounding && fast {
                touched[wall] = Some(wall as u8);
            }
        }
        touched
    }
}

/// Whether surfaces that touch bounce.
fn is_fast(speed: f64, time: f64, limits: &Limits) -> bool {
    speed * (limits.end - time) > limits.rounding
}

/// Where discs may be during a step, and how to find others that may be there too.
pub trait Bounds {
    /// Distance from its position at the beginning of the step within which a disc was searched
    /// for neighbours.
    fn reach(&self, index: u32) -> f64;
    /// Lets the bounds of discs grow to the given distances, and returns the pairs that may
    /// meet in them: the second, moved by the offset, is near the first.
    fn grow(&mut self, distances: &[(u32, f64)]) -> Result<Vec<(u32, u32, Vector)>>;
}

/// Working memory, and what came of a sub-step.
#[derive(Debug, Default)]
pub struct Events {
    /// The discs that each disc may meet.
    pub neighbors: Neighbors,
    /// Pairs that bounced during the step.
    pub bounced: Vec<[u32; 2]>,
    /// Discs that had too many events and stood still for the rest of a sub-step.
    pub unresolved: u64,
    places: Vec<Place>,
    /// Members of all islands, and for each island which of them.
    members: Vec<u32>,
    islands: Vec<[u32; 2]>,
    /// Which of `courses` is that of a disc in an island.
    course_of: Vec<u32>,
    courses: Vec<Course>,
    segments: Vec<Segment>,
    bounces: Vec<Bounce>,
    hot: Vec<u32>,
}

/// What a test of trajectories found.
#[derive(Default)]
struct Findings {
    links: Vec<(u32, Neighbor)>,
    outside: Vec<(u32, f64)>,
}

impl Events {
    /// Moves all discs to the end of the sub-step, window by window.
    pub fn fly(&mut self, flight: &Flight<'_>, bounds: &mut dyn Bounds) -> Result<()> {
        let (mut left, mut bounded) = (flight.end, flight.bounded);
        loop {
            let window = Flight { end: left, bounded, ..*flight };
            // Windows are not shorter than this, so that there are not too many.
            let done = self.fly_window(&window, bounds, flight.end / MOST_WINDOWS)?;
            if done == left {
                return Ok(());
            }
            left -= done;
            bounded = false;
        }
    }

    /// Moves all discs to the end of the window that `flight` describes, or of a shorter one, and
    /// returns its length.
    fn fly_window(
        &mut self,
        flight: &Flight<'_>,
        bounds: &mut dyn Bounds,
        shortest: f64,
    ) -> Result<f64> {
        let len = flight.particles.len();
        let nowhere = Place { island: NO_ISLAND, member: 0 };
        self.places.clear();
        self.places.resize(len, nowhere);
        self.course_of.resize(len, 0);
        for list in [&mut self.members, &mut self.hot] {
            list.clear();
        }
        self.islands.clear();
        self.courses.clear();
        self.segments.clear();
        self.bounces.clear();
        self.neighbors.unlink();
        let outside =
            if flight.bounded { Vec::new() } else { self.outside_at_start(flight, bounds) };
        self.grow(flight, bounds, &outside)?;
        let window = self.find_first_impacts(flight, shortest);
        interrupt::check()?;
        let flight = &Flight { end: window, last: window == flight.end, ..*flight };
        while !self.hot.is_empty() {
            interrupt::check()?;
            let first = self.make_islands(flight);
            self.simulate(flight, first);
            interrupt::check()?;
            let findings = self.test(flight, bounds, first);
            interrupt::check()?;
            self.reopen(&findings.links);
            self.grow(flight, bounds, &findings.outside)?;
        }
        self.finish(flight);
        Ok(window)
    }

    /// The discs whose first segment leaves their bounds, and how far it gets.
    fn outside_at_start(&self, flight: &Flight<'_>, bounds: &dyn Bounds) -> Vec<(u32, f64)> {
        let leaves = |index: &u32| {
            let segment = flight.segment(*index);
            let distance = distance_of(flight, *index, &segment, flight.end);
            (distance > bounds.reach(*index)).then_some((*index, distance))
        };
        let all = 0..flight.particles.len() as u32;
        all.filter(|&index| flight.is_movable(index)).filter_map(|index| leaves(&index)).collect()
    }

    /// Adds the neighbours that discs have in larger bounds; those that their trajectories meet
    /// are linked.
    fn grow(
        &mut self,
        flight: &Flight<'_>,
        bounds: &mut dyn Bounds,
        outside: &[(u32, f64)],
    ) -> Result<()> {
        if outside.is_empty() || !flight.pairs {
            return Ok(());
        }
        let pairs = bounds.grow(outside)?;
        self.neighbors.add(&pairs);
        let mut links = Vec::new();
        for &(index, _) in outside {
            self.neighbors.of(index, |neighbor| {
                if !neighbor.linked && self.meet(flight, index, neighbor, true) {
                    links.push((index, *neighbor));
                }
            });
        }
        self.reopen(&links);
        Ok(())
    }

    /// Links the discs that meet along their first segments, and collects those with events.
    /// Returns the end of a window in which few discs have events, so that islands stay small.
    fn find_first_impacts(&mut self, flight: &Flight<'_>, shortest: f64) -> f64 {
        let len = flight.particles.len();
        let neighbors = &self.neighbors;
        let tasks = len.div_ceil(TASK);
        let stop = Stop::current();
        let found = parallel::map(flight.threads, tasks, |task| {
            let mut found = Vec::new();
            if stop.is_set() {
                return found;
            }
            let discs = (task * TASK) as u32..len.min((task + 1) * TASK) as u32;
            if flight.container.has_walls() {
                for index in discs.clone().filter(|&index| flight.may_hit_walls(index)) {
                    if let Some((impact, _)) = flight.wall_impact(index, &flight.segment(index)) {
                        found.push((impact.time, index, None));
                    }
                }
            }
            if !flight.pairs {
                return found;
            }
            for index in discs {
                let movable = flight.is_movable(index);
                let motion = flight.start(index);
                neighbors.of(index, |neighbor| {
                    let image = neighbors.image(neighbor);
                    if neighbor.index <= index || !flight.may_meet(&motion, neighbor.index, image) {
                        return;
                    }
                    if !movable && !flight.is_movable(neighbor.index) {
                        return;
                    }
                    let own = flight.segment(index);
                    let other = flight.segment(neighbor.index);
                    let (own, other) = ((index, &own), (neighbor.index, &other));
                    if let Some(impact) = flight.impact(own, other, image, flight.end) {
                        found.push((impact.time, index, Some(*neighbor)));
                    }
                });
            }
            found
        });
        let window = window(&found, len, flight.end, shortest);
        for (time, index, neighbor) in found.into_iter().flatten() {
            if time > window {
                continue;
            }
            self.hot.push(index);
            if let Some(neighbor) = neighbor {
                self.neighbors.link(index, neighbor);
                self.hot.push(neighbor.index);
            }
        }
        self.hot.retain(|&disc| flight.is_movable(disc));
        window
    }

    /// Makes islands of the discs in `hot`, which are in none, and of all that are linked to
    /// them. Returns the number of the first new island.
    fn make_islands(&mut self, flight: &Flight<'_>) -> usize {
        let Self { neighbors, places, members, islands, hot, .. } = self;
        let first = islands.len();
        for seed in hot.drain(..) {
            if places[seed as usize].island != NO_ISLAND {
                continue;
            }
            let (island, start) = (islands.len() as u32, members.len());
            let mut join = |index: u32, members: &mut Vec<u32>| {
                let place = &mut places[index as usize];
                if place.island == NO_ISLAND && flight.is_movable(index) {
                    *place = Place { island, member: (members.len() - start) as u32 };
                    members.push(index);
                }
            };
            join(seed, members);
            let mut next = start;
            while next < members.len() {
                let index = members[next];
                neighbors.of(index, |neighbor| {
                    if neighbor.linked {
                        join(neighbor.index, members);
                    }
                });
                next += 1;
            }
            islands.push([start as u32, members.len() as u32]);
        }
        first
    }

    /// Tasks of about equal size, as ranges of islands.
    fn tasks(&self, first: usize) -> Vec<std::ops::Range<usize>> {
        let mut tasks = Vec::new();
        let (mut start, mut size) = (first, 0);
        for island in first..self.islands.len() {
            let [from, to] = self.islands[island];
            size += (to - from) as usize;
            if size >= TASK || island + 1 == self.islands.len() {
                tasks.push(start..island + 1);
                (start, size) = (island + 1, 0);
            }
        }
        tasks
    }

    /// Finds the histories of the islands from `first` on.
    fn simulate(&mut self, flight: &Flight<'_>, first: usize) {
        let tasks = self.tasks(first);
        let stop = Stop::current();
        let histories = parallel::map(flight.threads, tasks.len(), |task| {
            let (mut history, mut scratch) = (History::default(), Scratch::default());
            if stop.is_set() {
                return history;
            }
            for id in tasks[task].clone() {
                let [start, end] = self.islands[id];
                let island = Island {
                    flight,
                    neighbors: &self.neighbors,
                    places: &self.places,
                    id: id as u32,
                    history: &mut history,
                    scratch: &mut scratch,
                };
                island.run(&self.members[start as usize..end as usize]);
            }
            history
        });
        for History { courses, segments, bounces } in histories {
            let before = self.segments.len() as u32;
            self.segments.extend(segments);
            self.bounces.extend(bounces);
            for course in courses {
                self.course_of[course.index as usize] = self.courses.len() as u32;
                self.courses.push(Course { start: course.start + before, ..course });
            }
        }
    }

    /// The trajectory of a disc in an island.
    #[inline(always)]
    fn course(&self, index: u32) -> Option<(&Course, &[Segment])> {
        if self.places[index as usize].island == NO_ISLAND {
            return None;
        }
        let course = &self.courses[self.course_of[index as usize] as usize];
        Some((course, &self.segments[course.start as usize..(course.start + course.len) as usize]))
    }

    /// Tests the trajectories of the islands from `first` on against the discs of other islands
    /// and those of none, and against their own bounds.
    fn test(&self, flight: &Flight<'_>, bounds: &dyn Bounds, first: usize) -> Findings {
        let tasks = self.tasks(first);
        let stop = Stop::current();
        let links = parallel::map(flight.threads, tasks.len(), |task| {
            let mut links = Vec::new();
            if stop.is_set() {
                return links;
            }
            for &[start, end] in &self.islands[tasks[task].clone()] {
                for &index in &self.members[start as usize..end as usize] {
                    if !flight.pairs {
                        continue;
                    }
                    let island = self.places[index as usize].island;
                    self.neighbors.of(index, |neighbor| {
                        let outside = self.places[neighbor.index as usize].island != island;
                        let movable = flight.is_movable(neighbor.index);
                        if outside && movable && self.meet(flight, index, neighbor, false) {
                            links.push((index, *neighbor));
                        }
                    });
                }
            }
            links
        });
        let mut findings = Findings { links: links.concat(), ..Findings::default() };
        for &[start, end] in &self.islands[first..] {
            for &index in &self.members[start as usize..end as usize] {
                let Some((_, segments)) = self.course(index) else { continue };
                let ends = segments[1..].iter().map(|next| next.time).chain([flight.end]);
                let distances = segments
                    .iter()
                    .zip(ends)
                    .map(|(segment, end)| distance_of(flight, index, segment, end));
                let farthest = distances.fold(0.0, f64::max);
                if farthest > bounds.reach(index) {
                    findings.outside.push((index, farthest));
                }
            }
        }
        findings
    }

    /// Whether the trajectories of two discs meet; the first segments are tested against each
    /// other only if `first` says so.
    fn meet(&self, flight: &Flight<'_>, index: u32, neighbor: &Neighbor, first: bool) -> bool {
        let (own_first, other_first);
        let own = match self.course(index) {
            Some((_, segments)) => segments,
            None => {
                own_first = [flight.segment(index)];
                &own_first
            }
        };
        let other = match self.course(neighbor.index) {
            Some((_, segments)) => segments,
            None => {
                other_first = [flight.segment(neighbor.index)];
                &other_first
            }
        };
        if !first && own.len() == 1 && other.len() == 1 {
            return false;
        }
        let image = self.neighbors.image(neighbor);
        let end_of = |segments: &[Segment], k: usize| {
            segments.get(k + 1).map_or(flight.end, |next| next.time)
        };
        for (i, a) in own.iter().enumerate() {
            let a_end = end_of(own, i);
            for (j, b) in other.iter().enumerate() {
                if !first && i == 0 && j == 0 {
                    continue;
                }
                let until = a_end.min(end_of(other, j));
                let both = ((index, a), (neighbor.index, b));
                if a.time.max(b.time) < until
                    && flight.impact(both.0, both.1, image, until).is_some()
                {
                    return true;
                }
            }
        }
        false
    }

    /// Links discs that meet. Their islands end; all their discs begin again.
    fn reopen(&mut self, links: &[(u32, Neighbor)]) {
        for &(index, neighbor) in links {
            self.neighbors.link(index, neighbor);
            for disc in [index, neighbor.index] {
                let island = self.places[disc as usize].island;
                if island == NO_ISLAND {
                    self.hot.push(disc);
                    continue;
                }
                let [start, end] = self.islands[island as usize];
                for &member in &self.members[start as usize..end as usize] {
                    self.places[member as usize].island = NO_ISLAND;
                    self.hot.push(member);
                }
            }
        }
    }

    /// Writes positions, velocities and displacements at the end of the sub-step.
    fn finish(&mut self, flight: &Flight<'_>) {
        let motions = flight.motions;
        let mut unresolved = 0;
        for index in 0..flight.particles.len() as u32 {
            if !flight.is_movable(index) {
                continue;
            }
            let mut last = flight.segment(index);
            let mut stopped = None;
            if let Some((course, segments)) = self.course(index) {
                last = *segments.last().expect("a trajectory has a segment");
                stopped = course.stopped;
                unresolved += u64::from(stopped.is_some());
            }
            let [position, velocity] = last.at(flight.end, flight.gravity);
            let end = flight.after(last.falls, stopped.unwrap_or(velocity));
            motions.advance(index, position, end);
        }
        self.unresolved += unresolved;
        let alive = |bounce: &&Bounce| {
            self.places[bounce.pair[0] as usize].island == bounce.island
                || self.places[bounce.pair[1] as usize].island == bounce.island
        };
        let bounced = self.bounces.iter().filter(alive).map(|bounce| bounce.pair);
        self.bounced.extend(bounced);
    }
}

/// The longest of `end`, `end`/2, `end`/4 … before which at most one first impact for so many
/// discs happens, but not less than `shortest`. It depends on the state alone.
fn window(found: &[Vec<Found>], len: usize, end: f64, shortest: f64) -> f64 {
    let mut window = end;
    while 0.5 * window >= shortest {
        let early = found.iter().flatten().filter(|&&(time, ..)| time <= window).count();
        if early * DISCS_PER_IMPACT <= len.max(FEW) {
            break;
        }
        window *= 0.5;
    }
    window
}

/// The time of a first impact, the disc, and the neighbour that it meets; none for a wall.
type Found = (f64, u32, Option<Neighbor>);

/// How far a disc gets from its position at the beginning of the step while it moves along a
/// segment.
fn distance_of(flight: &Flight<'_>, index: u32, segment: &Segment, end: f64) -> f64 {
    let anchor = flight.particles.positions[index as usize].map(f64::from);
    let distance = |p: Vector| {
        let offset = vector(|k| p[k] - anchor[k]);
        dot(offset, offset).sqrt()
    };
    let [last, _] = segment.at(end, flight.gravity);
    let longest = distance(segment.position).max(distance(last));
    if !segment.falls {
        return longest;
    }
    // A parabola leaves its chord by at most g t² / 8.
    let t = end - segment.time;
    longest + 0.125 * dot(flight.gravity, flight.gravity).sqrt() * t * t
}
