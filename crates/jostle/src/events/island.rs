//! The events of one island: discs that meet each other during a sub-step.
//!
//! A heap gives the earliest event. The disc with that event, its partner and all discs that
//! touch them at that moment get new velocities at once; then their next events are predicted,
//! and those of their neighbours. Predictions depend on the trajectories of two discs only, so
//! the history does not depend on which other discs are in the island.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use super::Flight;
use super::impulses::{self, Touch};
use super::neighbors::{Neighbor, Neighbors};
use crate::interrupt::Stop;
use crate::trajectory::{Impact, Kind, Segment, Vector, dot, vector, wall_normal};

/// Events of one disc in a window, at most. A disc that has had them stands still until the
/// window ends.
const MOST_EVENTS: u32 = 1024;

/// Events of a large island between two polls.
const POLL_EVERY: u32 = 256;

/// Islands up to this size do without the heap.
const SMALL: usize = 12;

/// Takes the place of the second index in the key of a contact with a wall.
const WALL: u32 = u32::MAX;

/// Index of discs that are in no island.
pub const NO_ISLAND: u32 = u32::MAX;

/// Where each disc is: its island, and its index in it.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// The island.
    pub island: u32,
    /// The index among the members.
    pub member: u32,
}

/// What a disc meets.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Partner {
    #[default]
    None,
    /// The other end of an edge.
    Disc(u32),
    Wall(u8),
}

/// Two discs that may meet, as the first sees it: both members, or the second cannot move.
#[derive(Clone, Copy, Debug, Default)]
struct Edge {
    /// Index of the second.
    index: u32,
    /// The second as a member; [`NO_MEMBER`] if it cannot move.
    member: u32,
    image: u16,
    /// Whether they meet along their first segments, as far as is known.
    linked: bool,
}

/// Stands for discs that are not members because they cannot move.
const NO_MEMBER: u32 = u32::MAX;

/// A disc of the island.
#[derive(Clone, Copy, Debug)]
struct Member {
    index: u32,
    inverse_mass: f64,
    /// The first of its edges, and the end of them.
    edges: [u32; 2],
    partner: Partner,
    impact: Impact,
    /// Changes with every prediction, so that old entries of the heap are recognised.
    stamp: u32,
    events: u32,
    /// Its position in the group plus one, while events happen.
    in_group: u32,
    /// The velocity after the sub-step, if the disc had too many events.
    stopped: Option<Vector>,
}

/// An entry of the heap, the earliest first.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Entry {
    time: f64,
    index: u32,
    member: u32,
    stamp: u32,
}

impl Eq for Entry {}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        self.time.total_cmp(&other.time).then(self.index.cmp(&other.index))
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Two discs that bounced.
#[derive(Clone, Copy, Debug)]
pub struct Bounce {
    /// Their indices, the smaller first.
    pub pair: [u32; 2],
    /// The island in whose history it is.
    pub island: u32,
}

/// The trajectory of a disc: a range of segments and the velocity at the end.
#[derive(Clone, Copy, Debug)]
pub struct Course {
    /// The disc.
    pub index: u32,
    /// The first of its segments.
    pub start: u32,
    /// The number of its segments.
    pub len: u32,
    /// The velocity after the sub-step, if the disc had too many events.
    pub stopped: Option<Vector>,
}

/// What the events of some islands lead to.
#[derive(Debug, Default)]
pub struct History {
    /// A trajectory for each member, in the order of the members.
    pub courses: Vec<Course>,
    /// The segments of all trajectories.
    pub segments: Vec<Segment>,
    /// The pairs that bounced.
    pub bounces: Vec<Bounce>,
}

/// Scratch for islands.
#[derive(Debug, Default)]
pub struct Scratch {
    members: Vec<Member>,
    /// The current segment of each member.
    segments: Vec<Segment>,
    edges: Vec<Edge>,
    log: Vec<(u32, Segment)>,
    queue: BinaryHeap<Reverse<Entry>>,
    group: Vec<u32>,
    touches: Vec<Touch>,
    velocities: Vec<Vector>,
    impulses: Vec<[f64; 2]>,
    counts: Vec<u32>,
}

/// The simulation of one island.
pub struct Island<'a> {
    /// The sub-step.
    pub flight: &'a Flight<'a>,
    /// The discs that each disc may meet.
    pub neighbors: &'a Neighbors,
    /// The island of each disc.
    pub places: &'a [Place],
    /// The number of this island.
    pub id: u32,
    /// Where the events go.
    pub history: &'a mut History,
    /// Scratch.
    pub scratch: &'a mut Scratch,
}

impl Island<'_> {
    /// Finds the trajectories of the discs.
    pub fn run(mut self, discs: &[u32]) {
        let Scratch { members, segments, edges, log, queue, .. } = &mut *self.scratch;
        members.clear();
        segments.clear();
        edges.clear();
        log.clear();
        queue.clear();
        for &index in discs {
            let first = edges.len() as u32;
            self.neighbors.of(index, |neighbor| {
                let Neighbor { index, image, linked } = *neighbor;
                let place = self.places[index as usize];
                if place.island == self.id {
                    edges.push(Edge { index, image, linked, member: place.member });
                } else if !self.flight.is_movable(index) {
                    edges.push(Edge { index, image, linked, member: NO_MEMBER });
                }
            });
            segments.push(self.flight.segment(index));
            members.push(Member {
                index,
                inverse_mass: self.flight.inverse_mass(index),
                edges: [first, edges.len() as u32],
                partner: Partner::None,
                impact: Impact { time: f64::INFINITY, kind: Kind::Bounce },
                stamp: 0,
                events: 0,
                in_group: 0,
                stopped: None,
            });
        }
        if self.scratch.edges.len() == 2 && discs.len() == 2 && self.run_pair() {
            return self.record();
        }
        for member in 0..discs.len() as u32 {
            self.predict(member, true);
        }
        let stop = (discs.len() > SMALL).then(Stop::current);
        let mut events = 0u32;
        while let Some(member) = self.earliest() {
            self.happen(member);
            events = events.wrapping_add(1);
            if events.is_multiple_of(POLL_EVERY) && stop.as_ref().is_some_and(Stop::is_set) {
                break;
            }
        }
        self.record();
    }

    /// The whole history of two discs that meet each other and nothing else, in straight relative
    /// motion: most islands are that. Returns false if there is more to it.
    fn run_pair(&mut self) -> bool {
        let flight = self.flight;
        let [a, b] = [self.scratch.members[0], self.scratch.members[1]];
        let edge = self.scratch.edges[0];
        let separate = edge.member == 1 && self.scratch.edges[1].image == edge.image ^ 1;
        if !separate || [a, b].iter().any(|own| flight.may_hit_walls(own.index)) {
            return false;
        }
        let image = self.neighbors.image_of(edge.image);
        let [first, second] = [self.scratch.segments[0], self.scratch.segments[1]];
        let both = ((a.index, &first), (b.index, &second));
        let Some(Impact { time, kind: Kind::Bounce }) =
            flight.impact(both.0, both.1, image, flight.end)
        else {
            return false;
        };
        self.scratch.group.clear();
        self.scratch.touches.clear();
        self.join(0);
        self.touch_disc(0, 0, time);
        self.bounce(time, Kind::Bounce);
        let hits_wall = |member: usize| {
            let index = self.scratch.members[member].index;
            flight.wall_impact(index, &self.scratch.segments[member]).is_some()
        };
        if !flight.container.has_walls() || !(hits_wall(0) || hits_wall(1)) {
            return true;
        }
        // Begin again.
        self.history.bounces.pop();
        self.scratch.log.clear();
        self.scratch.members.clone_from_slice(&[a, b]);
        self.scratch.segments.clone_from_slice(&[first, second]);
        false
    }

    /// The member with the earliest event. Small islands are searched, large ones use the heap.
    fn earliest(&mut self) -> Option<u32> {
        let Scratch { members, queue, .. } = &mut *self.scratch;
        if members.len() <= SMALL {
            let waiting = members.iter().zip(0..).filter(|(own, _)| own.partner != Partner::None);
            let key = |own: &Member| (own.impact.time, own.index);
            let first = waiting.min_by(|(a, _), (b, _)| {
                let ((s, i), (t, j)) = (key(a), key(b));
                s.total_cmp(&t).then(i.cmp(&j))
            });
            return first.map(|(_, member)| member);
        }
        while let Some(Reverse(entry)) = queue.pop() {
            if members[entry.member as usize].stamp == entry.stamp {
                return Some(entry.member);
            }
        }
        None
    }

    /// Predicts the next event of a member. Of the first segments it is known which do not meet.
    fn predict(&mut self, member: u32, first: bool) {
        let Member { index, edges: [start, end], stopped, .. } =
            self.scratch.members[member as usize];
        let mut best = (f64::INFINITY, Kind::Bounce, Partner::None);
        if stopped.is_none()
            && self.flight.container.has_walls()
            && let Some((impact, wall)) =
                self.flight.wall_impact(index, &self.scratch.segments[member as usize])
        {
            best = (impact.time, impact.kind, Partner::Wall(wall));
        }
        for at in start..end {
            if first && !self.scratch.edges[at as usize].linked {
                continue;
            }
            if let Some(impact) = self.impact(member, at)
                && impact.time < best.0
            {
                best = (impact.time, impact.kind, Partner::Disc(at));
            }
        }
        self.set_next(member, best);
    }

    fn set_next(&mut self, member: u32, (time, kind, partner): (f64, Kind, Partner)) {
        let Scratch { members, queue, .. } = &mut *self.scratch;
        let large = members.len() > SMALL;
        let own = &mut members[member as usize];
        own.stamp += 1;
        own.partner = partner;
        own.impact = Impact { time, kind };
        if partner != Partner::None && large {
            queue.push(Reverse(Entry { time, index: own.index, member, stamp: own.stamp }));
        }
    }

    /// The current segment of the disc at the other end of an edge.
    fn other(&self, edge: &Edge) -> Segment {
        match self.scratch.segments.get(edge.member as usize) {
            Some(segment) => *segment,
            None => self.flight.segment(edge.index),
        }
    }

    /// Whether the disc at the other end of an edge does not move any more.
    fn is_still(&self, edge: &Edge) -> bool {
        let member = self.scratch.members.get(edge.member as usize);
        member.is_none_or(|member| member.stopped.is_some())
    }

    /// The next impact of a member along one of its edges.
    fn impact(&self, member: u32, at: u32) -> Option<Impact> {
        let Scratch { members, segments, edges, .. } = &*self.scratch;
        let (edge, own) = (edges[at as usize], &members[member as usize]);
        if own.stopped.is_some() && self.is_still(&edge) {
            return None;
        }
        let image = self.neighbors.image_of(edge.image);
        let other = self.other(&edge);
        let both = ((own.index, &segments[member as usize]), (edge.index, &other));
        self.flight.impact(both.0, both.1, image, self.flight.end)
    }

    /// Lets the next event of a member happen, with all that happens at the same time.
    fn happen(&mut self, member: u32) {
        let Member { partner, impact: Impact { time, kind }, .. } =
            self.scratch.members[member as usize];
        self.scratch.group.clear();
        self.scratch.touches.clear();
        self.join(member);
        match partner {
            Partner::None => return,
            Partner::Wall(wall) => self.touch_wall(member, wall, time),
            Partner::Disc(at) => self.touch_disc(member, at, time),
        }
        if kind == Kind::Hold {
            self.scratch.touches.iter_mut().for_each(|touch| touch.restitution = 0.0);
        } else {
            self.find_simultaneous(time);
        }
        self.bounce(time, kind);
        self.predict_again();
    }

    fn join(&mut self, member: u32) {
        let Scratch { group, members, .. } = &mut *self.scratch;
        let own = &mut members[member as usize];
        if own.in_group == 0 {
            group.push(member);
            own.in_group = group.len() as u32;
        }
    }

    /// Adds all contacts whose surfaces touch and approach at `time`, of discs in the group and
    /// of discs that thereby join it.
    fn find_simultaneous(&mut self, time: f64) {
        let mut next = 0;
        while next < self.scratch.group.len() {
            let member = self.scratch.group[next];
            next += 1;
            let Member { index, edges: [start, end], stopped, .. } =
                self.scratch.members[member as usize];
            if stopped.is_some() {
                continue;
            }
            let now = self.flight.moved(&self.scratch.segments[member as usize], time);
            for wall in self.flight.touched_walls(index, &now).into_iter().flatten() {
                self.touch_wall(member, wall, time);
            }
            for at in start..end {
                let edge = self.scratch.edges[at as usize];
                let partner = self.scratch.members.get(edge.member as usize);
                let position = partner.map_or(u32::MAX, |partner| partner.in_group.wrapping_sub(1));
                // Contacts with those before were found from their side.
                if position < next as u32 - 1 {
                    continue;
                }
                let there = self.flight.moved(&self.other(&edge), time);
                let image = self.neighbors.image_of(edge.image);
                if self.flight.touch_now((index, &now), (edge.index, &there), image) {
                    self.touch_disc(member, at, time);
                }
            }
        }
    }

    fn inverse_mass_of(&self, member: &Member) -> f64 {
        if member.stopped.is_some() { 0.0 } else { member.inverse_mass }
    }

    fn touch_wall(&mut self, member: u32, wall: u8, time: f64) {
        let own = self.scratch.members[member as usize];
        let now = self.flight.moved(&self.scratch.segments[member as usize], time);
        let normal = wall_normal(&self.flight.container, wall, now.position).map(|v| -v);
        let touch = Touch {
            key: [own.index, WALL, u32::from(wall)],
            bodies: [Some(self.position_in_group(member)), None],
            normal,
            inverse_masses: [own.inverse_mass, 0.0],
            restitution: self.flight.wall_restitution(own.index),
        };
        // The first is the contact whose event it is.
        if self.scratch.touches.first().is_none_or(|first| first.key != touch.key) {
            self.scratch.touches.push(touch);
        }
    }

    fn position_in_group(&self, member: u32) -> usize {
        self.scratch.members[member as usize].in_group as usize - 1
    }

    fn touch_disc(&mut self, member: u32, at: u32, time: f64) {
        let own = self.scratch.members[member as usize];
        let edge = self.scratch.edges[at as usize];
        let partner = (edge.member != NO_MEMBER).then_some(edge.member);
        partner.into_iter().for_each(|partner| self.join(partner));
        // From the smaller index to the larger, so that both give the same numbers.
        let own_first = own.index < edge.index;
        let mut image = self.neighbors.image_of(edge.image);
        let mut sides =
            [(self.scratch.segments[member as usize], Some(member)), (self.other(&edge), partner)];
        let mut code = edge.image;
        if !own_first {
            sides.swap(0, 1);
            image = image.map(|v| -v);
            code ^= 1;
        }
        let [p, q] = sides.map(|(segment, _)| self.flight.moved(&segment, time).position);
        let offset = vector(|k| q[k] - p[k] + image[k]);
        let length = dot(offset, offset).sqrt();
        let normal = if length > 0.0 { offset.map(|v| v / length) } else { [1.0, 0.0] };
        let inverse_mass = |member: Option<u32>| {
            member.map_or(0.0, |m| self.inverse_mass_of(&self.scratch.members[m as usize]))
        };
        let pair = [own.index.min(edge.index), own.index.max(edge.index)];
        let touch = Touch {
            key: [pair[0], pair[1], u32::from(code)],
            bodies: sides.map(|(_, member)| member.map(|member| self.position_in_group(member))),
            normal,
            inverse_masses: sides.map(|(_, member)| inverse_mass(member)),
            restitution: self.flight.pair_restitution(pair[0], pair[1]),
        };
        if self.scratch.touches.first().is_none_or(|first| first.key != touch.key) {
            self.scratch.touches.push(touch);
            self.history.bounces.push(Bounce { pair, island: self.id });
        }
    }

    /// Gives the discs of the group their velocities after the impacts.
    fn bounce(&mut self, time: f64, kind: Kind) {
        let flight = self.flight;
        let Scratch { members, segments, group, touches, velocities, impulses, log, .. } =
            &mut *self.scratch;
        velocities.clear();
        let state = |&member: &u32| flight.moved(&segments[member as usize], time).velocity;
        velocities.extend(group.iter().map(state));
        impulses::apply(touches, velocities, impulses);
        if let Some(thermostat) = flight.thermostat {
            for touch in touches.iter().filter(|touch| touch.key[1] == WALL) {
                let body = touch.bodies[0].expect("a disc touches the wall");
                velocities[body] = thermostat.drive(velocities[body]);
            }
        }
        for (&member, &velocity) in group.iter().zip(velocities.iter()) {
            let (own, segment) = (&mut members[member as usize], &mut segments[member as usize]);
            own.in_group = 0;
            if own.stopped.is_some() {
                continue;
            }
            log.push((member, *segment));
            *segment = Segment { velocity, ..flight.moved(segment, time) };
            own.events += 1;
            if own.events >= MOST_EVENTS {
                let [_, end] = segment.at(flight.end, flight.gravity);
                own.stopped = Some(end);
                *segment = Segment { velocity: [0.0; 2], falls: false, ..*segment };
            }
        }
        if kind == Kind::Hold {
            // Gravity along the surface acts at once; that against the surface is balanced.
            let normal = touches[0].normal;
            for &member in group.iter() {
                let segment = &mut segments[member as usize];
                if segment.falls {
                    let left = flight.end - time;
                    let g = flight.gravity.map(|g| g * left);
                    let pressing = dot(g, normal);
                    let along = vector(|k| g[k] - pressing * normal[k]);
                    segment.velocity = vector(|k| segment.velocity[k] + along[k]);
                    segment.falls = false;
                }
            }
        }
    }

    /// Predicts the next events of the group, and of all neighbours whose next event was with
    /// the group or comes later than one with it.
    fn predict_again(&mut self) {
        let group = std::mem::take(&mut self.scratch.group);
        for &member in &group {
            self.predict(member, false);
            self.scratch.members[member as usize].in_group = 1;
        }
        for &member in &group {
            let [start, end] = self.scratch.members[member as usize].edges;
            for at in start..end {
                let edge = self.scratch.edges[at as usize];
                let theirs = match self.scratch.members.get(edge.member as usize) {
                    Some(theirs) if theirs.in_group == 0 => *theirs,
                    _ => continue,
                };
                let with_group = match theirs.partner {
                    Partner::Disc(at) => {
                        let with = self.scratch.edges[at as usize].member;
                        let with = self.scratch.members.get(with as usize);
                        with.is_some_and(|with| with.in_group > 0)
                    }
                    _ => false,
                };
                // Others meet a disc of the group only if that is earlier than their next event.
                let impact = || self.impact(member, at);
                if with_group || impact().is_some_and(|impact| impact.time < theirs.impact.time) {
                    self.predict(edge.member, false);
                }
            }
        }
        for &member in &group {
            self.scratch.members[member as usize].in_group = 0;
        }
        self.scratch.group = group;
    }

    /// Appends the trajectories of all members to the history.
    fn record(&mut self) {
        let Scratch { members, segments: last, log, counts, .. } = &mut *self.scratch;
        let History { courses, segments, .. } = &mut *self.history;
        counts.clear();
        counts.resize(members.len(), 1);
        log.iter().for_each(|&(member, _)| counts[member as usize] += 1);
        let mut start = segments.len() as u32;
        for (member, count) in members.iter().zip(counts.iter_mut()) {
            let Member { index, stopped, .. } = *member;
            courses.push(Course { index, start, len: *count, stopped });
            (start, *count) = (start + *count, start);
        }
        segments.resize(start as usize, Segment::default());
        for &(member, segment) in log.iter() {
            let at = &mut counts[member as usize];
            segments[*at as usize] = segment;
            *at += 1;
        }
        for (&segment, &at) in last.iter().zip(counts.iter()) {
            segments[at as usize] = segment;
        }
    }
}
