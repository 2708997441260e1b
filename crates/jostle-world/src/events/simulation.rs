//! The events of some discs in the order of time.
//!
//! A queue gives the earliest event. The two discs and all that touch them at that moment get new
//! velocities at once; then their next impacts are predicted. Predictions depend on the pieces
//! of two discs only, so the history does not depend on which other discs are simulated together.

use std::ops::Range;

use super::exhaustion::approaches_still;
use super::flight::TimeWindow;
use super::friction::FrictionScratch;
use super::history::{Bounce, History, NONE, Trajectory};
use super::impulses::{self, Constraint};
use super::neighbors::{Neighbor, Neighbors, opposite};
use super::queue::{Event, Queue, WALL};
use super::{MAX_COLLISIONS, Outside};
use crate::halo::{digest, digest_all};
use crate::trajectory::{Kind, Piece, Vector, dot, vector};
use crate::walls::WallContact;
use jostle_base::error::Result;
use jostle_base::interrupt::Stop;
use jostle_base::{memory, reserve};

/// Impacts between two polls. More would make an interruption wait longer, fewer would read a
/// shared flag more often.
const POLL_EVERY: usize = 256;

/// Simple events for which memory is reserved at a time, so that not each of them tests seven lists.
const RESERVED: usize = 64;

/// A disc that gets a new velocity at this moment.
#[derive(Clone, Debug)]
pub(super) struct InGroup {
    pub(super) index: u32,
    /// The number of its trajectory.
    pub(super) number: u32,
    /// Whether its contacts are solved jointly, see [`exhaustion`](super::exhaustion).
    pub(super) is_joint: bool,
    /// The piece that begins now, with the velocity before the impacts.
    now: Piece,
    /// Which of the list of nearby discs are near it.
    near: Range<usize>,
}

/// A disc that one of the group may meet.
#[derive(Clone, Copy, Debug)]
struct Nearby {
    index: u32,
    /// The number of its trajectory; [`NONE`] if it has none.
    number: u32,
    image: u32,
    /// The number of its events.
    count: u32,
    /// A piece that begins now.
    now: Piece,
}

/// Scratch of a simulation.
#[derive(Debug, Default)]
pub struct Scratch {
    pub(super) queue: Queue,
    pub(super) predicted: Vec<Event>,
    /// Pairs that may have an impact along their first pieces.
    pub(super) near: Vec<[u32; 2]>,
    /// Discs that may hit a wall along their first pieces.
    pub(super) near_walls: Vec<u32>,
    /// The discs of a block that are not settled.
    pub(super) unsettled: Vec<u32>,
    /// The contacts of a disc with walls.
    pub(super) contacts: Vec<WallContact>,
    pub(super) impulses: Vec<[f64; 2]>,
    pub(super) friction_scratch: FrictionScratch,
    pub(super) group: Vec<InGroup>,
    nearby: Vec<Nearby>,
    pub(super) touches: Vec<Constraint>,
    pub(super) velocities: Vec<Vector>,
    /// The velocities before they are corrected, and sums of corrections with their numbers.
    pub(super) before: Vec<Vector>,
    pub(super) sums: Vec<(Vector, f64)>,
}

impl Scratch {
    /// Forgets a group that an error has left.
    fn clear(&mut self) {
        self.group.clear();
        self.nearby.clear();
        self.touches.clear();
    }
}

/// The simulation of the discs of a range.
pub struct Simulation<'a> {
    /// The window.
    pub window: &'a TimeWindow<'a>,
    /// The discs that each disc may meet.
    pub neighbors: &'a Neighbors,
    /// The discs that may have events.
    pub range: Range<u32>,
    /// The number of the trajectory of each disc of the range. Those that have one before the
    /// simulation take no part.
    pub trajectory_of: &'a mut [u32],
    /// How far each disc was searched for neighbours.
    pub reaches: &'a [f32],
    /// Where the trajectories go.
    pub history: &'a mut History,
    /// Added to the numbers of the trajectories of the history.
    pub mark: u32,
    /// The number of the first trajectory of this simulation in the history.
    pub base: u32,
    /// Ends the simulation early.
    pub stop: &'a Stop,
    /// Scratch.
    pub scratch: &'a mut Scratch,
}

impl Simulation<'_> {
    /// Appends the trajectories of all discs that have events: those that follow from the first events
    /// of all, and the events of `discs`.
    pub fn run(mut self, first: &[Event], discs: &[u32]) -> Result<()> {
        let window = self.window;
        self.scratch.clear();
        // This is the algorithm of Alder and Wainwright with one queue. An event is executed only
        // if neither of its discs has had another event since the prediction. Executed in the order
        // of time, no event can come too late: predictions never lie before the event that leads to
        // them.
        self.scratch.queue.fill(first.iter().filter(|event| event.time <= window.end))?;
        let has_friction = window.flight.has_friction;
        self.history.reserve(discs.len(), has_friction)?;
        // Each of these discs gets a trajectory at once, also if it will have no event. The search for
        // new conflicts visits all trajectories of the repetition, and a disc that lost its events may
        // meet others on its new way.
        discs.iter().for_each(|&disc| _ = self.trajectory(disc));
        for &disc in discs {
            // The group of one disc is used for its list of neighbours only; nothing happens at the
            // start.
            self.join(disc, None)?;
            self.predict(0)?;
            self.dissolve();
        }
        // A simple event has two discs, and the lists have memory for so many of them. `happen` reserves its own.
        let (mut work, mut room) = (0, 0);
        while let Some(event) = self.scratch.queue.pop() {
            if room == 0 {
                room = RESERVED;
                self.history.reserve(2 * RESERVED, has_friction)?;
            }
            room -= 1;
            let count = |index: u32| self.find(index).map_or(0, |own| own.count);
            // Events are not removed from the queue when a disc turns; that would need a search.
            // Instead each event has the numbers of events that its discs had. A number that has
            // changed makes the event invalid. That of a wall is 0.
            if event.pair.map(count) == event.counts {
                // Most events are one contact of one or two discs. These have paths without lists,
                // which give the same bits and give up, without a change, if anything else touches.
                let is_simple = self.collide_two(&event)? || self.collide_alone(&event)?;
                work += if is_simple { 1 } else { self.happen(&event, &mut room)? };
            }
            // The step will be refused.
            let has_too_many = || {
                let count = self.find(event.pair[0]).map_or(0, |own| own.count);
                count > MAX_COLLISIONS && window.flight.halo.is_alone()
            };
            // To read the shared flag after each event would cost more than the simplest events.
            // The limit of collisions ends a simulation that would take very long, and whose step
            // is refused in any case.
            if work >= POLL_EVERY && (self.stop.is_set() || has_too_many()) {
                break;
            }
            work %= POLL_EVERY;
        }
        Ok(())
    }

    /// The number of the trajectory of a disc, if it takes part and has one.
    #[inline(always)]
    pub(super) fn number(&self, index: u32) -> Option<u32> {
        // For an index below the range the difference wraps to a large number, so one comparison
        // tests both ends.
        let number = *self.trajectory_of.get(index.wrapping_sub(self.range.start) as usize)?;
        // A trajectory of an earlier simulation in the same list has a number below `base`. Its disc
        // takes no part: its trajectory is fixed until a test finds a conflict.
        let own = number.wrapping_sub(self.mark);
        (self.base..self.history.trajectories.len() as u32).contains(&own).then_some(own)
    }

    /// The trajectory of a disc, if it takes part and has one.
    #[inline(always)]
    pub(super) fn find(&self, index: u32) -> Option<&Trajectory> {
        self.number(index).map(|number| &self.history.trajectories[number as usize])
    }

    /// The number of the trajectory of a disc, or [`NONE`], its piece and the number of its events;
    /// None if it does not take part. Discs that cannot move take part, wherever they are.
    #[inline(always)]
    pub(super) fn current(&self, index: u32) -> Option<(u32, Piece, u32)> {
        if let Some(number) = self.number(index) {
            let trajectory = &self.history.trajectories[number as usize];
            return Some((number, trajectory.piece, trajectory.count));
        }
        // Discs of other blocks do not take part, even if they are near. Their trajectories are not
        // known yet; conflicts with them are found after all blocks were simulated. An immovable
        // disc has the same trajectory in each block, so each block may use it.
        let takes_part = match self.trajectory_of.get(index.wrapping_sub(self.range.start) as usize)
        {
            Some(&number) => number == NONE,
            None => !self.window.starts[index as usize].is_movable,
        };
        takes_part.then(|| (NONE, self.window.piece(index), 0))
    }

    /// The number of the trajectory of a movable disc, which gets one if it has none.
    pub(super) fn trajectory(&mut self, index: u32) -> u32 {
        if let Some(number) = self.number(index) {
            return number;
        }
        let number = self.history.trajectories.len() as u32;
        // The recent events and the state of exhaustion continue from earlier windows. The count
        // begins with 0, because queues hold only events of this window.
        let carried = self.window.carried(index);
        self.trajectory_of[(index - self.range.start) as usize] = self.mark + number;
        // A new trajectory is an island of its own: parent and successor are itself.
        self.history.trajectories.push(Trajectory {
            index,
            count: 0,
            recent: carried.map_or(0, |trajectory| trajectory.recent),
            travelled: carried.map_or(0.0, |trajectory| trajectory.travelled),
            piece: self.window.piece(index),
            before: NONE,
            inverse_mass: self.window.inverse_mass(index),
            in_group: 0,
            island: number,
            next: number,
            is_exhausted: self.window.is_exhausted(index),
            is_joint: false,
            stopped: carried.and_then(|trajectory| trajectory.stopped),
            groups: 0,
        });
        if self.window.flight.has_friction {
            self.history.turnings.push(self.window.turning(index));
        }
        number
    }

    /// Executes an event and all simultaneous contacts. Returns the number of impacts. It uses up the `room` that is
    /// reserved for other events.
    fn happen(&mut self, event: &Event, room: &mut usize) -> Result<usize> {
        *room = 0;
        let Event { time, kind, code, pair: [index, partner], .. } = *event;
        self.join(index, Some(time))?;
        if partner == WALL {
            let (_, own, _) = self.in_group(index).expect("it is in the group");
            self.touch_wall(index, code, self.window.wall_normal(index, code, &own.now))?;
        } else {
            self.touch_disc(index, partner, code, time)?;
        }
        if kind == Kind::Hold {
            // A hold ends an infinite sequence of bounces of two surfaces. It concerns these two
            // alone: others that touch have events of their own at the same moment.
            self.scratch.touches.iter_mut().for_each(|touch| touch.restitution = 0.0);
        } else {
            // Contacts at the same moment are solved as one problem. One after the other, the
            // result would depend on their order, and a symmetric impact would not have a symmetric
            // result.
            self.find_simultaneous(time)?;
        }
        self.bounce(time, kind)?;
        // Discs of the group may have got their trajectories after they were listed.
        // A disc that joined the group later has a trajectory now. `predict` uses its new piece, and
        // not the one that was listed.
        for at in 0..self.scratch.nearby.len() {
            let number = self.number(self.scratch.nearby[at].index);
            self.scratch.nearby[at].number = number.unwrap_or(NONE);
        }
        for position in 0..self.scratch.group.len() {
            self.predict(position)?;
        }
        let impacts = self.scratch.touches.len();
        self.dissolve();
        Ok(impacts)
    }

    /// Adds a movable disc to the group, with the discs near it: all as they are at `time`, or on
    /// the pieces with which they begin the window.
    fn join(&mut self, index: u32, time: Option<f64>) -> Result<()> {
        let (gravity, neighbors) = (self.window.gravity(), self.neighbors);
        self.history.reserve(1, self.window.flight.has_friction)?;
        let at = |piece: &Piece| time.map_or(*piece, |time| piece.moved(time, gravity));
        let number = self.trajectory(index);
        let position = self.scratch.group.len();
        // The position plus one is stored, so that 0 means "in no group" and the test needs no
        // search.
        if self.history.trajectories[number as usize].in_group != 0 {
            return Ok(());
        }
        let trajectory = &self.history.trajectories[number as usize];
        let is_joint = self.is_joint(trajectory, time.unwrap_or(self.window.begin));
        let own = &mut self.history.trajectories[number as usize];
        own.in_group = position as u32 + 1;
        // The mark stays for the window: the search for conflicts then also counts contacts that do
        // not approach, as the joint solution does.
        own.is_joint |= is_joint;
        // All members are moved to the same moment once. Later tests subtract positions of one
        // time, without a difference of times.
        let now = at(&own.piece);
        let (start, mut done) = (self.scratch.nearby.len(), Ok(()));
        neighbors.of(index, |neighbor| {
            let Neighbor { index, image } = *neighbor;
            let Some((number, piece, count)) = self.current(index) else { return };
            let now = at(&piece);
            // Neighbours are listed before the bounce, because the same list serves the search for
            // simultaneous contacts and the predictions after it.
            let other = Nearby { index, number, image, count, now };
            if let Err(error) = memory::push(&mut self.scratch.nearby, other) {
                done = Err(error);
            }
        });
        let near = start..self.scratch.nearby.len();
        memory::push(&mut self.scratch.group, InGroup { index, number, is_joint, now, near })?;
        done
    }

    /// Ends the group.
    fn dissolve(&mut self) {
        let Scratch { group, nearby, touches, .. } = &mut *self.scratch;
        group.drain(..).for_each(|own| self.history.trajectories[own.number as usize].in_group = 0);
        nearby.clear();
        touches.clear();
    }

    /// Adds the next impacts of a disc of the group to the queue.
    fn predict(&mut self, position: usize) -> Result<()> {
        let window = self.window;
        let Scratch { queue, group, nearby, touches, velocities, .. } = &mut *self.scratch;
        let InGroup { index, number, is_joint, near, .. } = &group[position];
        let trajectories = &self.history.trajectories;
        let trajectory = &trajectories[*number as usize];
        let Trajectory { piece: own, count: own_count, .. } = trajectory;
        // A disc that has ended has no events of its own, but others still hit it as an immovable
        // one. So only pairs of two such discs, and their walls, are left out.
        let has_ended = window.has_ended(trajectory);
        let is_without_room =
            |wall: u32| *is_joint && approaches_still(touches, velocities, [*index, WALL, wall]);
        if !has_ended
            && let Some(event) = window.wall_event(*index, own, *own_count, &is_without_room)
        {
            queue.push(event)?;
        }
        let was_solved = |other: u32| {
            let pair = [(*index).min(other), (*index).max(other)];
            touches.iter().any(|touch| touch.key[..2] == pair)
        };
        for other in &nearby[near.clone()] {
            let (mut piece, mut count) = (&other.now, other.count);
            let mut are_joint = *is_joint;
            if let Some(trajectory) = trajectories.get(other.number as usize) {
                if trajectory.in_group != 0 {
                    (piece, count) = (&trajectory.piece, trajectory.count);
                    are_joint |= group[trajectory.in_group as usize - 1].is_joint;
                }
                // The impacts of two discs of the group are predicted once.
                // Members of the group are visited in ascending order. The pair of two members
                // belongs to the one that comes first.
                let is_predicted =
                    trajectory.in_group != 0 && (trajectory.in_group as usize) <= position;
                if is_predicted || has_ended && window.has_ended(trajectory) {
                    continue;
                }
            } else if has_ended && !window.now[other.index as usize].is_movable {
                continue;
            }
            let image = self.neighbors.image_of(other.image);
            let both = ((*index, own), (other.index, piece));
            if let Some(impact) = window.impact(both.0, both.1, image, window.end) {
                // The joint solution may leave a small approach, because its iteration ends early
                // or no solution exists. The same impact at the same moment would be found again
                // without end.
                if are_joint && impact.time == own.time && was_solved(other.index) {
                    continue;
                }
                let (pair, counts) = ([*index, other.index], [*own_count, count]);
                queue.push(Event::of_discs(impact, pair, other.image, counts))?;
            }
        }
        Ok(())
    }

    /// Adds all contacts whose surfaces touch and approach at `time`, of discs in the group and
    /// of discs that thereby join it. Some discs have all that touches them solved together.
    fn find_simultaneous(&mut self, time: f64) -> Result<()> {
        let window = self.window;
        let mut position = 0;
        // The group grows during the loop: a disc that joins may touch further discs. Each is
        // visited once, so the loop ends.
        while position < self.scratch.group.len() {
            let InGroup { index, is_joint, now, near, .. } = self.scratch.group[position].clone();
            position += 1;
            if self.has_ended(index) {
                continue;
            }
            let (mut contacts, mut done) = (std::mem::take(&mut self.scratch.contacts), Ok(()));
            window.each_touched_wall(index, &now, is_joint, &mut contacts, |wall, normal| {
                if let Err(error) = self.touch_wall(index, wall, normal) {
                    done = Err(error);
                }
            });
            self.scratch.contacts = contacts;
            done?;
            for at in near {
                let Nearby { index: partner, image: code, now: there, .. } =
                    &self.scratch.nearby[at];
                let (partner, code) = (*partner, *code);
                let image = self.neighbors.image_of(code);
                let has_joint = |other: &Trajectory| self.is_joint(other, time);
                let was_exhausted = || window.was_exhausted(partner);
                // A joint problem also needs contacts that touch and do not approach. An impulse
                // from one side would press the disc into the other side, and an event at the same
                // moment would follow.
                let all = || is_joint || self.find(partner).map_or_else(was_exhausted, has_joint);
                if !window.touch_now((index, &now), (partner, there), image, all) {
                    continue;
                }
                // Contacts with those before were found from their side.
                let in_group = self.find(partner).map_or(0, |other| other.in_group as usize);
                // `position` is already that of the next member, so this leaves out members before
                // the present one.
                if in_group == 0 || in_group >= position {
                    self.touch_disc(index, partner, code, time)?;
                }
            }
        }
        Ok(())
    }

    /// The disc of the group with an index, and its position.
    fn in_group(&self, index: u32) -> Option<(usize, &InGroup, &Trajectory)> {
        let trajectory = self.find(index)?;
        let position = (trajectory.in_group as usize).checked_sub(1)?;
        Some((position, &self.scratch.group[position], trajectory))
    }

    fn touch_wall(&mut self, index: u32, wall: u32, normal: Vector) -> Result<()> {
        let (position, own, trajectory) = self.in_group(index).expect("it is in the group");
        let (number, time) = (own.number, own.now.time);
        self.add(self.wall_touch(index, position, trajectory, wall, normal))?;
        self.exhaust_without_room(number, wall, time);
        Ok(())
    }

    /// The contact of the disc of a trajectory, the body `position`, and a wall.
    pub(super) fn wall_touch(
        &self,
        index: u32,
        position: usize,
        trajectory: &Trajectory,
        wall: u32,
        normal: Vector,
    ) -> Constraint {
        Constraint {
            bodies: [Some(position), None],
            inverse_masses: [trajectory.inverse_mass, 0.0],
            restitution: self.wall_restitution(trajectory, wall),
            friction: self.window.wall_friction(index, wall),
            carried: self.window.flight.walls.velocity(wall),
            ..Constraint::of_wall(index, wall, normal)
        }
    }

    fn touch_disc(&mut self, index: u32, partner: u32, code: u32, time: f64) -> Result<()> {
        let window = self.window;
        if window.starts[partner as usize].is_movable {
            self.join(partner, Some(time))?;
        }
        // From the smaller index to the larger, so that both give the same numbers.
        // Normal and offset have a direction, and their rounding depends on it. One fixed order
        // makes the impulse the same, whichever disc predicted the event.
        let (pair, code) = if index < partner {
            ([index, partner], code)
        } else {
            ([partner, index], opposite(code))
        };
        let found = pair.map(|disc| self.in_group(disc));
        let now = [0, 1].map(|k| match found[k] {
            Some((_, own, _)) => own.now,
            None => window.piece(pair[k]).moved(time, window.gravity()),
        });
        let [p, q] = now.map(|now| now.position);
        // Of two surfaces at most one has no body.
        let (mut carried, mut carried_turning) = ([0.0; 2], 0.0);
        for (k, sign) in [(0, -1.0), (1, 1.0)] {
            if found[k].is_none() {
                // The velocity of an immovable surface enters as a constant of the relative
                // velocity. Then the solver needs no bodies of infinite mass.
                carried = now[k].velocity.map(|v| sign * v);
                carried_turning = window.surface_speed(pair[k]);
            }
        }
        let image = self.neighbors.image_of(code);
        let offset = vector(|k| q[k] - p[k] + image[k]);
        let trajectories = found.map(|found| found.map(|(.., trajectory)| trajectory));
        let (inverse_masses, restitution) = self.masses_and_restitution(pair, trajectories);
        let touch = Constraint {
            bodies: found.map(|found| found.map(|(position, ..)| position)),
            inverse_masses,
            restitution,
            friction: window.pair_friction(pair),
            carried,
            carried_turning,
            ..Constraint::of_discs(pair, code, offset)
        };
        self.add(touch)
    }

    /// Adds a contact of this moment, unless it is the one whose event it is.
    fn add(&mut self, touch: Constraint) -> Result<()> {
        let touches = &mut self.scratch.touches;
        // The event's own contact is the first of the list, and the search for simultaneous
        // contacts finds it a second time. Twice in the list it would get its impulse in two
        // shares, and slow down the iteration.
        let is_it = |first: &Constraint| first.key == touch.key && first.is_same(&touch);
        if touches.first().is_some_and(is_it) { Ok(()) } else { memory::push(touches, touch) }
    }

    /// The impulses of a contact of this moment along its normal and of friction.
    pub(super) fn impulses_of(&self, touch: usize) -> [f32; 2] {
        let [normal, friction] =
            // Infinite impulses would make sums that are no numbers. The clamp keeps results finite
            // for bodies of extreme masses.
            self.scratch.impulses[touch].map(|impulse| (impulse as f32).clamp(f32::MIN, f32::MAX));
        [normal, if self.window.flight.has_friction { friction } else { 0.0 }]
    }

    /// Appends all contacts of this moment to the history.
    fn record_bounces(&mut self) {
        for (at, touch) in self.scratch.touches.iter().enumerate() {
            let [a, b] = touch.bodies.map(|body| body.map(|body| &self.scratch.group[body]));
            let trajectory = a.or(b).expect("one of them is in the group").number;
            let ([first, second, code], impulses) = (touch.key, self.impulses_of(at));
            let (pair, normal) = ([first, second], touch.normal.map(|v| v as f32));
            self.history.bounces.push(Bounce { pair, code, normal, impulses, trajectory });
        }
    }

    /// Gives the discs of the group their velocities after the impacts, and makes one island of
    /// them.
    fn bounce(&mut self, time: f64, kind: Kind) -> Result<()> {
        let window = self.window;
        let Scratch {
            group, touches, velocities, impulses, before, sums, friction_scratch, ..
        } = &mut *self.scratch;
        // Nothing below allocates.
        let len = group.len().max(touches.len());
        self.history.reserve(len, window.flight.has_friction)?;
        reserve!(len; *velocities, *impulses, *before, *sums);
        friction_scratch.reserve(len)?;
        velocities.clear();
        // The velocities are in an array beside the group, because the solver needs nothing else of
        // a disc.
        velocities.extend(group.iter().map(|own| own.now.velocity));
        let is_joint = group.iter().any(|own| own.is_joint);
        if is_joint {
            self.apply_jointly();
        } else {
            impulses::apply(touches, velocities, impulses);
        }
        if window.flight.has_friction {
            // Friction comes after the impulses along normals, because these limit it. In a joint
            // problem the rest of approach is shared out after that.
            self.rub_group(time);
        }
        if is_joint {
            self.share();
        }
        let Scratch { touches, velocities, .. } = &mut *self.scratch;
        if let Some(thermostat) = window.flight.thermostat {
            for touch in touches.iter().filter(|touch| touch.key[1] == WALL) {
                let body = touch.bodies[0].expect("a disc touches the wall");
                velocities[body] = thermostat.bounced(velocities[body]);
            }
        }
        let is_heated = self.heat(time);
        self.note_group();
        for position in 0..self.scratch.group.len() {
            let InGroup { number, now, .. } = self.scratch.group[position];
            // The velocities of all members depend on each other from here on. If one of them must
            // be simulated again, so must all: the island is the unit of rollback.
            self.history.connect(self.scratch.group[0].number, number);
            if self.has_ended(self.scratch.group[position].index) {
                continue;
            }
            let velocity = self.scratch.velocities[position];
            let mut new = Piece { velocity, is_first: false, ..now };
            if kind == Kind::Hold && !is_heated {
                self.hold(position, &mut new, window.flight.end - time);
            }
            self.turn(number, new);
        }
        self.record_bounces();
        Ok(())
    }

    /// Notes which discs collide at the same moment, if these are at least three: the velocities of each
    /// depend on all of them.
    fn note_group(&mut self) {
        let Scratch { group, velocities, .. } = &*self.scratch;
        // A process may not know all members of a group. The digest of their states then differs
        // from that of the other processes.
        if group.len() < 3 || self.window.flight.halo.is_alone() {
            return;
        }
        let member = |(own, new): (&InGroup, &Vector)| {
            digest_all(0, [own.now.position, own.now.velocity, *new].into_iter().flatten())
        };
        // A sum, because the order of members differs between processes and addition does not
        // depend on it.
        let all = group.iter().zip(velocities).map(member).fold(0, u64::wrapping_add);
        for own in group {
            let groups = &mut self.history.trajectories[own.number as usize].groups;
            *groups = digest(*groups, all);
        }
    }

    /// Gives the discs of the group that touch walls at a temperature the velocities with which they
    /// leave them; returns whether there are any.
    fn heat(&mut self, time: f64) -> bool {
        let temperatures = self.window.flight.temperatures;
        if temperatures.is_empty() {
            return false;
        }
        let Scratch { group, touches, velocities, impulses, .. } = &mut *self.scratch;
        let mut is_any = false;
        for (touch, impulse) in touches.iter().zip(impulses) {
            let (Some(body), [_, WALL, wall]) = (touch.bodies[0], touch.key) else { continue };
            let (now, inverse_mass) = (&group[body].now, touch.inverse_masses[0]);
            let before = [now.position, now.velocity];
            let speeds = temperatures.speeds(wall, inverse_mass, time, before);
            let Some([leaving, along]) = speeds else { continue };
            // The normal of the contact points to the wall; that of the formula points to the disc.
            let [x, y] = touch.normal.map(|v| -v);
            let own = [leaving * x - along * y, leaving * y + along * x];
            let new = vector(|k| own[k] + touch.carried[k]);
            let change = vector(|k| new[k] - velocities[body][k]);
            // The recorded impulse includes what the temperature adds, so that the impulses of
            // walls are the change of momentum.
            impulse[0] += dot(change, [x, y]) / inverse_mass;
            velocities[body] = new;
            is_any = true;
        }
        is_any
    }

    /// Lets a disc of the group slide along the surface that it touches for `left` seconds.
    fn hold(&mut self, position: usize, piece: &mut Piece, left: f64) {
        let (number, touch) = (self.scratch.group[position].number, self.scratch.touches[0]);
        let is_second = touch.bodies[1] == Some(position);
        let normal = touch.normal.map(|v| if is_second { v } else { -v });
        // From now on the disc does not fall: the surface balances gravity until the flight ends.
        // The speed that gravity would give in this time, times the mass, is the impulse on the
        // surface.
        let pressing = -hold(piece, normal, self.window.gravity(), left);
        let inverse_mass = self.history.trajectories[number as usize].inverse_mass;
        self.scratch.impulses[0][0] += pressing.max(0.0) / inverse_mass;
        if self.window.flight.has_friction {
            let change = self.brake(number, piece, &touch, is_second, pressing.max(0.0));
            self.scratch.impulses[0][1] += change / inverse_mass;
        }
    }

    /// Lets a disc continue on a new piece.
    pub(super) fn turn(&mut self, number: u32, new: Piece) {
        let window = self.window;
        let History { trajectories, ended, .. } = &mut *self.history;
        let trajectory = &mut trajectories[number as usize];
        // The distance is measured on the old piece, so this comes before the piece is
        // replaced.
        trajectory.count_recent(&new, window.radius(trajectory.index), window.flight.end);
        // Ended pieces form a chain through one list for all trajectories. A vector for each disc
        // would need an allocation for each.
        ended.push((trajectory.piece, trajectory.before));
        trajectory.before = ended.len() as u32 - 1;
        trajectory.piece = new;
        trajectory.count += 1;
        // It may stop the disc. So the test of bounds below reads the trajectory again, and not `new`.
        self.exhaust_if_many(number);
        let History { trajectories, outside, .. } = &mut *self.history;
        let trajectory = &trajectories[number as usize];
        let square = window.longest_square(window.anchor(trajectory.index), &trajectory.piece);
        let reach = f64::from(self.reaches[trajectory.index as usize]);
        // The neighbours of a disc are complete only within its bounds. The simulation goes on as
        // if they were complete. Afterwards the bounds grow, and the new neighbours are tested as
        // conflicts.
        if square > reach * reach {
            let Trajectory { index, piece, .. } = *trajectory;
            outside.push(Outside { index, distance: square.sqrt(), piece });
        }
    }
}

/// Lets a disc that touches a surface slide for `left` seconds: gravity along the surface acts at
/// once; that along the normal is balanced. Returns the speed along the normal that it would give.
fn hold(piece: &mut Piece, normal: Vector, gravity: Vector, left: f64) -> f64 {
    if piece.falls {
        let g = gravity.map(|g| g * left);
        let pressing = dot(g, normal);
        // All of gravity along the surface is applied at once. The path is then a straight line,
        // and its error is of the first order in the sub-step.
        piece.velocity = vector(|k| piece.velocity[k] + (g[k] - pressing * normal[k]));
        piece.falls = false;
        return pressing;
    }
    0.0
}
