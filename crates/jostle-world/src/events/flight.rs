//! What all discs of a sub-step have in common, and the impacts that this makes possible.

use super::history::{Carried, Trajectory};
use super::neighbors::PairList;
use super::queue::Event;
use crate::flow::{Flow, Kick};
use crate::forces::{Thermostat, WallTemperatures};
use crate::halo::Halo;
use crate::motion::{Motion, Motions, Spins, exact};
use crate::particles::Particles;
use crate::tolerance::{COARSE, Tolerance, size_of};
use crate::trajectory::{
    Impact, Limits, Piece, Relative, Vector, dot, restitution_at_rest, vector,
};
use crate::walls::{Around, WallContact, number_of};
use jostle_base::error::Result;
use jostle_base::{memory, parallel};

/// An impact without which the surfaces would overlap by less than this share of the size at the
/// end of the flight is left out, if it loses energy and follows another impact in the flight. A
/// larger share saves events of discs that bounce ever lower, and adds to the overlap that
/// `crates/jostle/tests/scales.rs` limits.
const SLIGHT: f64 = 1e-6;

/// The share for other impacts. It is below the displacements of the slowest discs in a step.
const SLIGHTEST: f64 = 1e-11;

/// Overlap of two discs, as a share of the size, from which on position correction separates them.
/// It is above the overlap at which correction begins and above the usual ones of piles, so that
/// ordinary contacts do not get the wider limit.
const DEEP: f64 = 0.01;

/// Relative reserve for rounding of the time in which a disc is far from the sides of the
/// container.
const FAR: f64 = 1e-6;

/// Two supported particles do not collide if they would overlap by less than this share of the
/// size: their contact is solved at the beginning of the next sub-step. A larger share saves events
/// in piles, and is added to the overlaps that `tests/library/physics/test_resting.py` prints.
pub const DEFERRED: f64 = 0.01;

/// How a disc begins a flight, or in float32 a window of it.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(32))]
pub struct Start {
    /// Centre.
    pub position: [f32; 2],
    /// What rounding to float32 removed from the centre.
    pub residual: [f32; 2],
    /// Velocity.
    pub velocity: [f32; 2],
    /// Radius.
    pub radius: f32,
    /// Whether it can move.
    pub is_movable: bool,
    /// Whether resting contacts support it.
    pub is_supported: bool,
    /// Whether gravity accelerates it.
    pub falls: bool,
    /// Whether it certainly has no impact with another settled disc, nor with a side of the container,
    /// along its first piece: it rests or cannot move, and travels by less than the overlap that is
    /// left to the next sub-step.
    pub is_settled: bool,
}

/// What all discs of a sub-step have in common.
#[derive(Clone, Copy)]
pub struct Flight<'a> {
    /// The discs, as they were at the beginning of the step.
    pub particles: &'a Particles,
    /// Positions and velocities at the beginning of the flight, if it is not the first of the step.
    pub motions: &'a Motions,
    /// Angular velocities and angles at the beginning of the flight.
    pub spins: &'a Spins,
    /// Whether any disc has friction.
    pub has_friction: bool,
    /// Acceleration.
    pub gravity: Vector,
    /// Duration of the flight.
    pub end: f64,
    /// What linear damping does to the velocities after the flight.
    pub flow: Flow,
    /// What forces and resting contacts do to each disc; empty where there are none.
    pub kicks: &'a [Kick],
    /// Whether it is the first of the part. Then discs begin as `particles` and `kicks` tell, and `motions` may not
    /// be loaded: nothing but this flight may write it before it ends.
    pub begins_part: bool,
    /// The container and the walls.
    pub walls: Around<'a>,
    /// Whether all collisions keep the energy: elastic, without friction.
    pub is_lossless: bool,
    /// Which discs lose energy, of a world in which some do and others do not; else empty.
    pub lossy: &'a [bool],
    /// What walls do to speeds.
    pub thermostat: Option<Thermostat>,
    /// The walls at temperatures.
    pub temperatures: &'a WallTemperatures,
    /// Whether discs bounce off each other.
    pub pairs: bool,
    /// The candidate pairs, a list for each image.
    pub candidates: &'a [([f32; 2], Vec<[u32; 2]>)],
    /// The candidate pairs that pass through each other, and are listed if they touch.
    pub sensed: &'a [([f32; 2], Vec<[u32; 2]>)],
    /// Whether all pairs are of this kind.
    pub senses_all: bool,
    /// Whether discs that pass through walls are listed.
    pub senses_walls: bool,
    /// Distances from the positions at the beginning of the part; discs that get beyond them are
    /// listed. Empty if none are to be listed.
    pub watched_reaches: &'a [f32],
    /// The smallest radius above 0; infinite if all discs are points.
    pub smallest_radius: f32,
    /// What is shared with other processes.
    pub halo: &'a dyn Halo,
    /// Whether it is known that all discs without events stay in their bounds.
    pub bounded: bool,
    /// Threads to use.
    pub threads: Option<usize>,
}

impl TimeWindow<'_> {
    /// Whether the flight ends with the window.
    pub fn is_last(&self) -> bool {
        self.end == self.flight.end
    }

    /// Writes where all discs are when the window begins, rounded to float32. Those that have
    /// ended count as immovable.
    pub fn fill_now(&self, now: &mut Vec<Start>) -> Result<()> {
        memory::resize(now, self.starts.len(), Start::default())?;
        parallel::for_chunks(self.flight.threads, now, |first, now| {
            for (now, index) in now.iter_mut().zip(first..) {
                let (start, trajectory) = (self.starts[index], self.carried(index as u32));
                let piece = self.piece(index as u32);
                let [position, velocity] = piece.at(self.begin, self.gravity());
                *now = Start {
                    position: position.map(|v| v as f32),
                    residual: [0.0; 2],
                    velocity: velocity.map(|v| v as f32),
                    // A disc that has ended has no events of its own; two of them need no test.
                    is_movable: start.is_movable
                        && !trajectory.is_some_and(|trajectory| self.has_ended(trajectory)),
                    falls: piece.falls,
                    // After an event nothing is known about the speed any more.
                    is_settled: start.is_settled && trajectory.is_none(),
                    ..start
                };
            }
        });
        Ok(())
    }
}

impl Flight<'_> {
    /// Whether nothing reads the motions after the window has begun, so that they may be written before
    /// all histories are known.
    pub fn keeps_starts(&self) -> bool {
        self.kicks.is_empty() && self.spins.is_empty()
    }

    /// The position of a disc at the beginning of the step.
    pub fn anchor(&self, index: u32) -> Vector {
        let Particles { positions, residuals, .. } = self.particles;
        exact(positions[index as usize], residuals[index as usize])
    }

    /// Whether collisions of some discs may lose energy.
    #[inline(always)]
    pub fn lose_energy<const N: usize>(&self, indices: [u32; N]) -> bool {
        // Three cases, the cheapest first: no disc loses energy, all do, or a column tells which.
        let is_lossy = |&index: &u32| self.lossy[index as usize];
        !self.is_lossless && (self.lossy.is_empty() || indices.iter().any(is_lossy))
    }

    /// The motion with which a disc begins.
    #[inline(always)]
    pub fn motion(&self, index: u32) -> Motion {
        if self.begins_part {
            Motion::of(self.particles, index as usize)
        } else {
            self.motions.get(index)
        }
    }

    /// The velocity with which a movable disc begins.
    #[inline(always)]
    fn velocity(&self, index: u32) -> Vector {
        let velocity = self.motion(index).velocity.map(f64::from);
        match self.kicks.get(index as usize) {
            // The sum stays in float64: rounding it to float32 would lose small kicks in each sub-
            // step.
            Some(kick) => vector(|k| velocity[k] + kick.before[k]),
            None => velocity,
        }
    }

    /// The velocity of a disc that nothing accelerates. The flight is shorter than the sub-step if there
    /// is damping, but such a disc is not damped.
    fn velocity_of_kinematic(&self, index: u32) -> [f32; 2] {
        // The displacement must be velocity times seconds, and the flight has fewer seconds.
        let longer = self.flow.seconds / self.flow.duration;
        self.motion(index).velocity.map(|v| (f64::from(v) * longer) as f32)
    }

    /// Writes how all discs begin. Those in `exhausted` that lose no energy stand still.
    pub fn fill(&self, starts: &mut Vec<Start>, exhausted: &[u32]) -> Result<()> {
        memory::resize(starts, self.particles.len(), Start::default())?;
        let Self { particles, kicks, .. } = *self;
        let has_gravity = self.gravity != [0.0; 2];
        parallel::for_chunks(self.threads, starts, |first, starts| {
            for (start, index) in starts.iter_mut().zip(first..) {
                let Motion { position, residual, .. } = self.motion(index as u32);
                *start = Start {
                    position,
                    residual,
                    velocity: [0.0; 2],
                    radius: particles.radii[index],
                    is_movable: particles.movable[index],
                    is_supported: false,
                    falls: false,
                    is_settled: false,
                };
                if !particles.movable[index] {
                    start.velocity = self.velocity_of_kinematic(index as u32);
                } else {
                    start.is_supported = kicks.get(index).is_some_and(|kick| kick.is_supported);
                    // What resting contacts support has its share of gravity in its kick, and flies
                    // straight. Two supported discs then have a straight relative motion, and a
                    // quadratic equation.
                    start.falls = has_gravity && !start.is_supported;
                    start.velocity = self.velocity(index as u32).map(|v| v as f32);
                }
                // Discs without loss bounce at any speed, so none of them is settled.
                start.is_settled =
                    !self.is_lossless && start.is_settled(self.end as f32, self.smallest_radius);
            }
        });
        self.stop(starts, exhausted);
        Ok(())
    }
}

/// A part of a sub-step at whose end all discs are known.
///
/// Windows are a schedule and nothing more: no number of a trajectory depends on where they begin
/// and end. Times are seconds since the beginning of the flight, trajectories continue from window
/// to window without rounding, and a prediction is that of the whole flight, left out if it is
/// later than the window.
#[derive(Clone, Copy)]
pub struct TimeWindow<'a> {
    /// The sub-step.
    pub flight: &'a Flight<'a>,
    /// How the discs begin the flight.
    pub starts: &'a [Start],
    /// Discs that were exhausted in earlier flights of the step, sorted.
    pub exhausted: &'a [u32],
    /// Where all discs are when the window begins, rounded to float32, for tests that leave out
    /// pairs.
    pub now: &'a [Start],
    /// The discs that had events in earlier windows.
    pub carried: &'a Carried,
    /// Where discs were when their bounds were renewed, if they were.
    pub anchors: Option<&'a [[f32; 2]]>,
    /// The candidate pairs, a list for each image.
    pub candidates: &'a [PairList],
    /// When the window begins.
    pub begin: f64,
    /// When the window ends.
    pub end: f64,
}

impl TimeWindow<'_> {
    /// Acceleration of falling discs.
    #[inline(always)]
    pub fn gravity(&self) -> Vector {
        self.flight.gravity
    }

    /// What earlier windows have led to, for a disc that had events in them.
    #[inline(always)]
    pub fn carried(&self, index: u32) -> Option<&Trajectory> {
        self.carried.get(index)
    }

    /// The piece with which a disc begins the window.
    #[inline(always)]
    pub fn piece(&self, index: u32) -> Piece {
        match self.carried(index) {
            Some(trajectory) => trajectory.piece,
            None => self.free_piece(index),
        }
    }

    /// The piece with which a disc begins the flight.
    #[inline(always)]
    pub fn free_piece(&self, index: u32) -> Piece {
        let start = &self.starts[index as usize];
        let is_kicked = !self.flight.kicks.is_empty() && start.is_movable;
        Piece {
            time: 0.0,
            position: exact(start.position, start.residual),
            // Not rounded to float32 where forces change it.
            // The column `Start` holds float32 for the early tests; here the rest of the sum
            // matters.
            velocity: if is_kicked {
                self.flight.velocity(index)
            } else {
                start.velocity.map(f64::from)
            },
            falls: start.falls,
            is_first: true,
        }
    }

    /// Moves a disc that nothing accelerates to the end of the flight.
    pub fn carry(&self, index: u32) {
        let Flight { particles, motions, spins, .. } = self.flight;
        if self.flight.begins_part {
            motions.set(index, self.flight.motion(index));
        }
        if particles.is_static(index as usize) {
            return;
        }
        let start = &self.starts[index as usize];
        if start.velocity != [0.0; 2] {
            let piece = self.piece(index);
            let position = piece.position_at(self.end, self.gravity());
            let velocity = motions.velocity(index).map(f64::from);
            motions.advance(index, piece.position, position, velocity);
        }
        if !spins.is_empty() && !particles.movable[index as usize] {
            self.turn(index, &self.turning(index));
        }
    }

    /// Moves a disc along its last piece to the end of the flight; `stopped` is the velocity that
    /// it keeps, if it was exhausted and loses no energy.
    #[inline(always)]
    pub fn move_disc(&self, index: u32, last: &Piece, stopped: Option<Vector>) {
        let Start { position, residual, .. } = self.starts[index as usize];
        // The position at the end of the flight comes from the last piece in one formula. Steps
        // from window to window would add a rounding for each.
        let [end, velocity] = last.at(self.end, self.gravity());
        let velocity = stopped.unwrap_or_else(|| self.after(index, last.falls, velocity));
        self.flight.motions.advance(index, exact(position, residual), end, velocity);
    }

    /// The velocity of a disc after the sub-step from that at the end of the flight.
    #[inline(always)]
    pub fn after(&self, index: u32, falls: bool, velocity: Vector) -> Vector {
        let Flight { flow: Flow { decay, correction, .. }, kicks, .. } = self.flight;
        let added = if falls { *correction } else { [0.0; 2] };
        // Damping first, then the second kick: see `Flow`.
        let damped = vector(|k| velocity[k] * decay + added[k]);
        let kick = kicks.get(index as usize);
        kick.map_or(damped, |kick| vector(|k| damped[k] + kick.after[k]))
    }

    /// One over the mass of a disc; 0 if it cannot move.
    pub fn inverse_mass(&self, index: u32) -> f64 {
        let mass = f64::from(self.flight.particles.masses[index as usize]);
        if self.starts[index as usize].is_movable { 1.0 / mass } else { 0.0 }
    }

    /// Coefficient of restitution of two discs.
    pub fn pair_restitution(&self, [a, b]: [u32; 2]) -> f64 {
        // Not read if all are 1.
        if self.flight.is_lossless {
            return 1.0;
        }
        self.flight.particles.pair_restitution(a as usize, b as usize).into()
    }

    /// Coefficient of restitution of a disc and a wall.
    pub fn wall_restitution(&self, index: u32, wall: u32) -> f64 {
        let own = self.flight.particles.restitution[index as usize];
        self.flight.walls.walls.surface(wall).restitution_with(own).into()
    }

    /// The limits for surfaces of a size that meet at a place; whether neither has had an impact in
    /// the flight, whether resting contacts support both, and the coefficient of restitution.
    #[inline(always)]
    fn limits(
        &self,
        tolerance: &Tolerance,
        [is_first, is_lossy]: [bool; 2],
        surfaces: impl Fn() -> (bool, f64),
    ) -> Limits {
        // Nothing may be ignored in an elastic world but rounding itself: an approach that is left
        // out in each sub-step would become an overlap.
        let slightest = tolerance.at_most(SLIGHTEST);
        let limits = Limits {
            until: self.flight.end,
            end: self.flight.end,
            rounding: tolerance.rounding(),
            tolerance: slightest,
            touching_tolerance: slightest,
            deep: f64::INFINITY,
            deep_tolerance: slightest,
            bounces: f64::INFINITY,
        };
        if !is_lossy {
            return limits;
        }
        let (are_supported, restitution) = surfaces();
        let deferred = if are_supported { DEFERRED * tolerance.size() } else { 0.0 };
        // A sequence of bounces that lose energy ends with ever lower ones. Without a limit a disc
        // would have very many of them in the last moments of a sub-step. Surfaces that touch as
        // the sub-step begins have the small limit in their first impact. So no approach is left
        // out in two sub-steps.
        let slight = if restitution < 1.0 { tolerance.at_most(SLIGHT) } else { slightest };
        let restitution = restitution_at_rest(restitution);
        Limits {
            // The contact of two supported discs is solved anew as the next sub-step begins. So a
            // small approach needs no event.
            tolerance: slight.max(deferred),
            touching_tolerance: if is_first { slightest } else { slight }.max(deferred),
            bounces: 2.0 * restitution / (1.0 - restitution),
            ..limits
        }
    }

    /// The limits for two discs at positions; whether neither has had an impact in the flight.
    #[inline(always)]
    fn pair_limits(&self, pair: [u32; 2], positions: [Vector; 2], is_first: bool) -> Limits {
        let radii = pair.map(|index| self.starts[index as usize].radius);
        // They meet at the surface of the smaller disc, which is near its centre.
        // The choice must not depend on the order of the pair, because either disc may predict the
        // impact. Equal radii are decided by the index.
        let is_swapped = if radii[0] == radii[1] { pair[1] < pair[0] } else { radii[1] < radii[0] };
        let place = if is_swapped { positions[1] } else { positions[0] };
        let tolerance = Tolerance::of(f64::from(size_of(radii[0], radii[1])), place);
        let surfaces = || {
            let rests = |index: u32| {
                let start = &self.starts[index as usize];
                start.is_supported || !start.is_movable
            };
            (rests(pair[0]) && rests(pair[1]), self.pair_restitution(pair))
        };
        let limits = self.limits(&tolerance, [is_first, self.flight.lose_energy(pair)], surfaces);
        // Discs deep in each other may have very many impacts at the same moment, if each of these
        // changes little. They may overlap by the rounding more, and position correction moves them
        // apart.
        let deep_tolerance = tolerance.rounding().max(limits.tolerance);
        Limits { deep: DEEP * tolerance.size(), deep_tolerance, ..limits }
    }

    /// The limits for a disc and a wall where the disc begins a piece.
    #[inline(always)]
    fn wall_limits(&self, now: &Piece, index: u32, wall: u32) -> Limits {
        let start = &self.starts[index as usize];
        let surfaces = || (start.is_supported, self.wall_restitution(index, wall));
        let size = self.flight.walls.walls.contact_distance(wall, f64::from(start.radius));
        let traits = [now.is_first, self.flight.lose_energy([index])];
        self.limits(&Tolerance::of(size, now.position), traits, surfaces)
    }

    /// The limits at each side of the container.
    #[inline(always)]
    fn side_limits(&self, now: &Piece, index: u32) -> impl Fn(u32) -> Limits {
        let (first, now) = (self.wall_limits(now, index, 0), *now);
        let are_equal = self.flight.walls.walls.has_equal_sides();
        move |side| if are_equal { first } else { self.wall_limits(&now, index, side) }
    }

    /// Sum of the radii of two discs.
    #[inline(always)]
    pub fn contact_distance(&self, a: u32, b: u32) -> f64 {
        let [a, b] = [a, b].map(|index| f64::from(self.starts[index as usize].radius));
        a + b
    }

    /// The next impact of two discs before `until`; `image` is added to the second.
    #[inline(always)]
    pub fn impact(
        &self,
        (a, first): (u32, &Piece),
        (b, second): (u32, &Piece),
        image: Vector,
        until: f64,
    ) -> Option<Impact> {
        // Exchanging the two changes signs only.
        let relative = Relative::of(first, second, image, self.flight.gravity);
        // Pairs that separate end here, before limits or square roots are computed.
        if relative.separates() {
            return None;
        }
        let contact_distance = self.contact_distance(a, b);
        let limits = || {
            let at = |piece: &Piece| piece.position_at(relative.start, self.gravity());
            let is_first = first.is_first & second.is_first;
            self.pair_limits([a, b], [at(first), at(second)], is_first)
        };
        // The limits are computed first only where the root needs them. On the straight path they
        // are needed only if there is a meeting.
        if relative.is_curved() {
            let impact = relative.curved_impact(contact_distance, &limits());
            return impact.filter(|impact| impact.time <= until);
        }
        let meeting = relative.meeting(contact_distance, until)?;
        meeting.impact(&limits())
    }

    /// The next impact of a disc in the window on a wall for which `skips` is false.
    pub fn wall_event(
        &self,
        index: u32,
        piece: &Piece,
        count: u32,
        skips: &dyn Fn(u32) -> bool,
    ) -> Option<Event> {
        if !self.starts[index as usize].is_movable {
            return None;
        }
        let limits = |wall: u32, limits: Limits| {
            let all = f64::INFINITY;
            if skips(wall) {
                // An infinite tolerance leaves out every bounce at this wall, and needs no second
                // path through the geometry.
                Limits { tolerance: all, touching_tolerance: all, deep_tolerance: all, ..limits }
            } else {
                limits
            }
        };
        let mut hit = self.container_impact(index, piece, &limits);
        if !self.flight.walls.is_empty() {
            let other = self.flight.walls.impact(index, piece, self.end, self.gravity(), |wall| {
                limits(wall, self.wall_limits(piece, index, wall))
            });
            // At equal times the side of the container wins, always, so the result does not depend
            // on the order of tests.
            let is_first = hit.zip(other).is_none_or(|(a, b)| b.0.time < a.0.time);
            hit = if is_first { other.or(hit) } else { hit };
        }
        // The prediction is for the whole flight and then left out if it is later than the window.
        // So it has the same bits in each schedule of windows.
        let hit = hit.filter(|(impact, _)| impact.time <= self.end);
        hit.map(|(impact, wall)| Event::with_wall(impact, index, wall, count))
    }

    /// The next impact of a disc on a wall of the container.
    fn container_impact(
        &self,
        index: u32,
        piece: &Piece,
        limits: &impl Fn(u32, Limits) -> Limits,
    ) -> Option<(Impact, u32)> {
        let container = &self.flight.walls.container;
        let radius = f64::from(self.starts[index as usize].radius);
        // A reserve of time makes the test safe. The exact formula might round an impact at the end
        // of the window to a moment before it.
        let span = (self.end - piece.time) * (1.0 + FAR);
        let far = |k: usize| (piece.velocity[k].abs() + self.gravity()[k].abs() * span) * span;
        if container.is_far(piece.position, radius, [far(0), far(1)]) {
            return None;
        }
        let of_side = self.side_limits(piece, index);
        let limits = |side| limits(side, of_side(side));
        container.impact(piece, radius, self.flight.gravity, limits)
    }

    /// Whether two discs that begin pieces now touch, and approach or `all` is true.
    #[inline(always)]
    pub fn touch_now(
        &self,
        (a, first): (u32, &Piece),
        (b, second): (u32, &Piece),
        image: Vector,
        all: impl Fn() -> bool,
    ) -> bool {
        let offset = vector(|k| second.position[k] - first.position[k] + image[k]);
        let (square, contact_distance) = (dot(offset, offset), self.contact_distance(a, b));
        // The rounding is at most a share of the size, which is at most twice this distance.
        // This test needs no limits and no square root, and most neighbours fail it.
        let farthest = (1.0 + 2.0 * COARSE) * contact_distance;
        if square > farthest * farthest {
            return false;
        }
        let is_first = first.is_first & second.is_first;
        let limits = self.pair_limits([a, b], [first.position, second.position], is_first);
        let near = contact_distance + limits.rounding;
        if square > near * near {
            return false;
        }
        let length = square.sqrt();
        let limits = limits.of_gap(length - contact_distance);
        let approach = -dot(offset, vector(|k| second.velocity[k] - first.velocity[k]));
        // `kind` is the rule of the impact itself. With another rule here, a contact could be in a
        // group without having an event, or the reverse.
        limits.kind(approach / length, 0.0, first.time).is_some() || all()
    }

    /// Calls `act` with each wall that a disc touches as it begins a piece, and that it
    /// approaches or `all` is true, and its unit normal. `contacts` is scratch.
    pub fn each_touched_wall(
        &self,
        index: u32,
        now: &Piece,
        all: bool,
        contacts: &mut Vec<WallContact>,
        mut act: impl FnMut(u32, Vector),
    ) {
        self.each_touched_side(index, now, all, &mut act);
        if self.flight.walls.is_empty() {
            return;
        }
        let radius = f64::from(self.starts[index as usize].radius);
        // The search needs one distance. The rounding depends on the disc and its place, and hardly
        // on the wall; each wall found is tested with its own limits.
        let rounding = self.wall_limits(now, index, number_of(0)).rounding;
        let (at, walls) = ((now.position, now.time), self.flight.walls);
        walls.contacts(index, at, radius, rounding, contacts);
        for &WallContact { wall, normal, gap, .. } in &*contacts {
            let limits = self.wall_limits(now, index, wall).of_gap(gap);
            let own = walls.velocity(wall);
            let approach = -dot(normal, vector(|k| now.velocity[k] - own[k]));
            if all || limits.kind(approach, 0.0, now.time).is_some() {
                act(wall, normal);
            }
        }
    }

    /// Calls `act` with each side of the container that a disc touches, as [`Self::each_touched_wall`].
    fn each_touched_side(
        &self,
        index: u32,
        now: &Piece,
        all: bool,
        act: &mut impl FnMut(u32, Vector),
    ) {
        let container = &self.flight.walls.container;
        let radius = f64::from(self.starts[index as usize].radius);
        if container.is_far(now.position, radius, [0.0; 2]) {
            return;
        }
        let limits_of = self.side_limits(now, index);
        for (wall, side) in container.sides() {
            let WallContact { normal, gap, .. } = side.contact(wall, now.position, radius);
            let limits = limits_of(wall);
            // False where numbers overflow and the gap is none.
            let is_near = gap <= limits.rounding;
            if !is_near {
                continue;
            }
            debug_assert!(gap.is_finite());
            let limits = limits.of_gap(gap);
            if all || limits.kind(-dot(normal, now.velocity), 0.0, now.time).is_some() {
                act(wall, normal);
            }
        }
    }

    /// Unit normal of a wall where a disc begins a piece, towards the disc.
    pub fn wall_normal(&self, index: u32, wall: u32, now: &Piece) -> Vector {
        self.flight.walls.normal(index, wall, now)
    }

    /// The position of a disc when the bounds were made.
    #[inline(always)]
    pub fn anchor(&self, index: u32) -> Vector {
        if let Some(anchors) = self.anchors {
            return anchors[index as usize].map(f64::from);
        }
        if self.flight.begins_part {
            // In the cache, for other reasons.
            let Start { position, residual, .. } = self.starts[index as usize];
            exact(position, residual)
        } else {
            self.flight.anchor(index)
        }
    }

    /// Square of the longest distance from a position that a disc has while it moves along a
    /// piece to the end of the window.
    #[inline(always)]
    pub fn longest_square(&self, anchor: Vector, piece: &Piece) -> f64 {
        let square = |p: Vector| {
            let offset = vector(|k| p[k] - anchor[k]);
            dot(offset, offset)
        };
        // The distance from a point is convex along a straight line, so it is largest at one end.
        let last = piece.position_at(self.end, self.gravity());
        let square = square(piece.position).max(square(last));
        if !piece.falls {
            return square;
        }
        // A parabola leaves its chord by at most g t² / 8.
        let (gravity, t) = (self.gravity(), self.end - piece.time);
        let distance = square.sqrt() + 0.125 * dot(gravity, gravity).sqrt() * t * t;
        distance * distance
    }
}
