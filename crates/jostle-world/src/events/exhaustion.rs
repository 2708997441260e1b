//! Discs that have had many events: what ends collisions that would go on without end.
//!
//! A disc can have infinitely many collisions in finite time: in a crowd that loses energy
//! (inelastic collapse; S. Luding and S. McNamara, *How to handle the inelastic collapse of a
//! dissipative hard-sphere gas with the TC model*, 1998), between walls at an acute angle, and
//! between surfaces that close in. So each disc counts its recent events: those of the flight since
//! it has moved by its radius. The more there are, the simpler its collisions become.
//!
//! 1. From 64 recent events on ([`COLLAPSE`]), its collisions with other discs and with walls, except
//!    the sides of the container, are elastic: the number of elastic collisions is finite.
//! 2. From 384 on, or 1,024 if the disc loses no energy ([`MAX_EVENTS`]), it is *exhausted* until the
//!    end of the step. Its contacts are solved jointly: at each event all that touches it, approaching
//!    or not, in one problem without restitution. So what presses it stays with it. A disc that loses
//!    no energy must keep it: it stands still, others bounce off it as off an immovable one, and after
//!    the flight it has its velocity again.
//! 3. After 128 more ([`MORE_EVENTS`]), it has *ended*: it has no more events of its own in the flight.
//!    It moves with the walls and immovable discs that press it, or stands still, and for other discs
//!    it is immovable.
//!
//! In every state other discs have events with it, because nothing may pass through it. An overlap
//! is corrected along the shortest way out: a disc whose centre has passed a wall or another disc
//! is pushed further to the wrong side, and does not come back. So only contacts of two surfaces
//! that no impulse moves are left out, such as two discs that have ended.
//!
//! The counts follow from the trajectory of the disc alone, and continue from window to window.
//! They begin anew in each flight; which discs are exhausted is known until the end of the step.

use super::flight::{Flight, Start, TimeWindow};
use super::history::{History, Pieces, Trajectory};
use super::impulses::{self, Constraint};
use super::simulation::{Scratch, Simulation};
use crate::trajectory::{Piece, Vector, dot, vector};
use crate::walls::index_of;
use jostle_base::error::Result;
use jostle_base::memory;

/// Recent events from which on the collisions of a disc are elastic. A smaller number takes too
/// little energy from dense crowds, a larger one costs time in those that collapse.
/// `stats.collapsed` counts the discs that reach it.
const COLLAPSE: u32 = 64;

/// Recent events from which on a disc is exhausted: of one that loses no energy, and of others.
/// Larger numbers would take minutes for a long row that collapses.
const MAX_EVENTS: [u32; 2] = [1024, 384];

/// Recent events of an exhausted disc after which it has ended. The number trades time against
/// discs that stop early. `stats.unresolved` counts exhausted discs.
const MORE_EVENTS: u32 = 128;

/// Points have no radius by which they could move: their events are counted in each of so many
/// equal parts of a flight.
const PARTS: f64 = 1024.0;

/// Events of a disc at one moment after which its contacts are solved jointly in this moment.
/// Between a wall that pushes and another disc there can be infinitely many. Where energy is
/// conserved their number is finite, and surfaces that separate may not be solved with others,
/// because that would add energy.
const MAX_AT_ONCE: usize = 8;

/// Square of the share of its speed with which a disc may approach surfaces that nothing moves
/// without counting as one that has no room.
const NO_ROOM: f64 = 1e-12;

impl Flight<'_> {
    /// Of the discs that are exhausted as the flight begins those that stand still in it: those
    /// that lose no energy.
    fn standing(&self, exhausted: &[u32]) -> impl Iterator<Item = u32> {
        // A disc that loses energy may come to rest in the joint solution. One that must keep its
        // energy cannot, so it stands still and gets its velocity back.
        exhausted.iter().copied().filter(|&index| !self.lose_energy([index]))
    }

    /// Lets them stand still.
    pub(super) fn stop(&self, starts: &mut [Start], exhausted: &[u32]) {
        for index in self.standing(exhausted) {
            let start = &mut starts[index as usize];
            (start.velocity, start.falls) = ([0.0; 2], false);
        }
    }

    /// The velocities that they have again after the flight.
    pub(super) fn kept_velocities(&self, exhausted: &[u32]) -> Result<Vec<(u32, [f32; 2])>> {
        let mut kept = Vec::new();
        let all = self.standing(exhausted).map(|index| (index, self.motion(index).velocity));
        memory::extend(&mut kept, all)?;
        Ok(kept)
    }

    /// Recent events of a disc from which on it is exhausted.
    #[inline(always)]
    fn max_events(&self, index: u32) -> u32 {
        MAX_EVENTS[usize::from(self.lose_energy([index]))]
    }
}

impl TimeWindow<'_> {
    /// Whether a disc was exhausted when the window began.
    #[inline(always)]
    pub fn is_exhausted(&self, index: u32) -> bool {
        match self.carried(index) {
            Some(trajectory) => trajectory.is_exhausted,
            // Nearly always nothing is exhausted, and the first test costs one comparison.
            None => !self.exhausted.is_empty() && self.exhausted.binary_search(&index).is_ok(),
        }
    }

    /// Whether an earlier window of the flight exhausted a disc, or one that was exhausted had
    /// events in it.
    pub fn was_exhausted(&self, index: u32) -> bool {
        self.carried(index).is_some_and(|trajectory| trajectory.is_exhausted)
    }

    /// Whether the disc of a trajectory has no more events in the flight.
    pub(super) fn has_ended(&self, trajectory: &Trajectory) -> bool {
        trajectory.recent >= self.flight.max_events(trajectory.index) + MORE_EVENTS
    }
}

impl Trajectory {
    /// Counts an event after which the disc of this radius continues on `new`, in a flight of
    /// `seconds`.
    pub(super) fn count_recent(&mut self, new: &Piece, radius: f64, seconds: f64) {
        if radius > 0.0 {
            // The count measures events without progress. A fast disc in a dense gas has many
            // events, and moves by its radius between few of them. Distances along the axes need no
            // square root.
            let by = vector(|k| (new.position[k] - self.piece.position[k]).abs());
            self.travelled += (by[0] + by[1]) as f32;
        } else {
            let part = |time: f64| (time / (seconds / PARTS)).floor();
            if part(self.piece.time) < part(new.time) {
                self.travelled = f32::INFINITY;
            }
        }
        if self.travelled > radius as f32 {
            // The event itself is the first of the new count.
            (self.recent, self.travelled) = (0, 0.0);
        }
        self.recent += 1;
    }
}

impl Simulation<'_> {
    /// Applies the rule to a disc after an event was counted.
    #[inline(always)]
    pub(super) fn exhaust_if_many(&mut self, number: u32) {
        let window = self.window;
        let History { trajectories, exhausted_trajectories, collapsed, .. } = &mut *self.history;
        let trajectory = &mut trajectories[number as usize];
        let is_lossy = window.flight.lose_energy([trajectory.index]);
        // Equality, so that a collapse is listed once.
        if trajectory.recent == COLLAPSE && is_lossy {
            collapsed.push(number);
        }
        // The rule depends on this disc's own trajectory alone. A limit for the whole world would
        // let events far away decide, which would depend on how the world is divided among
        // processes.
        if trajectory.recent >= window.flight.max_events(trajectory.index)
            && !trajectory.is_exhausted
        {
            trajectory.is_exhausted = true;
            exhausted_trajectories.push(number);
            if !is_lossy {
                // The velocity is kept outside the piece: for all others the disc stands still,
                // so predictions read 0.
                trajectory.stopped = Some(trajectory.piece.velocity);
                trajectory.piece.velocity = [0.0; 2];
                trajectory.piece.falls = false;
            }
        }
        if window.has_ended(trajectory) {
            // Nothing would stop its fall.
            trajectory.piece.falls = false;
        }
    }

    /// Whether the next event of the disc of a trajectory exhausts it. The paths for simple collisions
    /// leave such an event to [`Simulation::happen`].
    pub(super) fn is_nearly_exhausted(&self, trajectory: &Trajectory) -> bool {
        trajectory.recent + 1 >= self.window.flight.max_events(trajectory.index)
    }

    /// Lets the event at `time` exhaust a disc that loses no energy and has no room between walls:
    /// it would bounce without end, and ever faster.
    pub(super) fn exhaust_without_room(&mut self, number: u32, wall: u32, time: f64) {
        let trajectory = &self.history.trajectories[number as usize];
        let most = self.window.flight.max_events(trajectory.index);
        let is_lossy = self.window.flight.lose_energy([trajectory.index]);
        if index_of(wall).is_some() && !is_lossy && self.has_many_at_once(trajectory, time) {
            let trajectory = &mut self.history.trajectories[number as usize];
            // The event itself is counted later.
            // Between two walls that close in, the times between bounces shrink without limit. No
            // number of further events helps, so the disc skips the count.
            trajectory.recent = trajectory.recent.max(most - 1);
        }
    }

    /// Whether a disc has no more events in the flight.
    pub(super) fn has_ended(&self, index: u32) -> bool {
        let trajectory = self.find(index).or_else(|| self.window.carried(index));
        trajectory.is_some_and(|trajectory| self.window.has_ended(trajectory))
    }

    /// Whether the contacts of the disc of a trajectory are solved jointly at `time`.
    pub(super) fn is_joint(&self, trajectory: &Trajectory, time: f64) -> bool {
        let is_lossy = || self.window.flight.lose_energy([trajectory.index]);
        // Where no energy is lost, the number of collisions at one moment is finite, so they are
        // solved one by one. A joint solution without restitution would lose energy.
        trajectory.is_exhausted || self.has_many_at_once(trajectory, time) && is_lossy()
    }

    /// Whether the disc of a trajectory has had more than [`MAX_AT_ONCE`] events at this moment.
    fn has_many_at_once(&self, trajectory: &Trajectory, time: f64) -> bool {
        let has_many = || {
            let pieces = Pieces::of(self.history, trajectory, time);
            // Pieces of the same time are a run at the end of the chain, so the walk back is
            // short.
            pieces.take_while(|part| part.piece.time == time).count() > MAX_AT_ONCE
        };
        trajectory.count as usize >= MAX_AT_ONCE && trajectory.piece.time == time && has_many()
    }

    /// Coefficient of restitution of two discs that have had so many recent events.
    pub(super) fn pair_restitution(&self, pair: [u32; 2], counts: [u32; 2]) -> f64 {
        let collapses = counts.iter().any(|&count| count >= COLLAPSE);
        if collapses { 1.0 } else { self.window.pair_restitution(pair) }
    }

    /// Coefficient of restitution of the disc of a trajectory and a wall.
    pub(super) fn wall_restitution(&self, trajectory: &Trajectory, wall: u32) -> f64 {
        if trajectory.is_exhausted {
            0.0
        } else if index_of(wall).is_some() && trajectory.recent >= COLLAPSE {
            1.0
        } else {
            self.window.wall_restitution(trajectory.index, wall)
        }
    }

    /// One over the masses of two discs of the group and their coefficient of restitution; a disc
    /// without a trajectory cannot move.
    pub(super) fn masses_and_restitution(
        &self,
        pair: [u32; 2],
        trajectories: [Option<&Trajectory>; 2],
    ) -> ([f64; 2], f64) {
        let window = self.window;
        let are_exhausted =
            trajectories.map(|of| of.is_none_or(|trajectory| trajectory.is_exhausted));
        // Others bounce off an exhausted disc that must keep its energy, but two of them stay
        // together.
        let conserves = !window.flight.lose_energy(pair) && are_exhausted != [true; 2];
        let inverse_mass = |trajectory: &Trajectory| {
            let is_fixed = conserves && trajectory.is_exhausted || window.has_ended(trajectory);
            // An inverse mass of 0 makes a disc immovable in the solver without a case of its own.
            if is_fixed { 0.0 } else { trajectory.inverse_mass }
        };
        let inverse_masses = trajectories.map(|of| of.map_or(0.0, inverse_mass));
        // With a restitution above 0, discs that press an exhausted one would bounce off it again
        // and again at the same place.
        let sticks = !conserves && trajectories.into_iter().flatten().any(|of| of.is_exhausted);
        let counts = trajectories.map(|of| of.map_or(0, |trajectory| trajectory.recent));
        let restitution = if sticks { 0.0 } else { self.pair_restitution(pair, counts) };
        (inverse_masses, restitution)
    }

    /// Changes the velocities of the group by the impulses of all its contacts, solved jointly.
    pub(super) fn apply_jointly(&mut self) {
        let Scratch { group, touches, velocities, impulses, .. } = &mut *self.scratch;
        if group.iter().any(|own| self.window.flight.lose_energy([own.index])) {
            touches.iter_mut().for_each(|touch| touch.restitution = 0.0);
        }
        impulses::apply_jointly(touches, velocities, impulses);
    }

    /// Divides the approach that is left evenly, if no velocities keep all surfaces of the group
    /// from approaching: a disc between two walls that close in moves with the mean of their
    /// velocities, and stays between them. Surfaces that no impulse moves come last, so that others
    /// do not push a disc through them. A disc that has no room between them, or that ends with
    /// this event, moves with them alone.
    pub(super) fn share(&mut self) {
        let window = self.window;
        let Scratch { group, touches, velocities, before, sums, .. } = &mut *self.scratch;
        let fixed = touches.iter().filter(|touch| touch.is_with_fixed());
        let has_fixed = fixed.clone().next().is_some();
        if has_fixed {
            impulses::project(touches.iter(), velocities, sums);
        }
        for (own, velocity) in group.iter().zip(&mut *velocities) {
            let trajectory = &self.history.trajectories[own.number as usize];
            // The event is counted later.
            // A disc that has ended has no velocity of its own; what presses it gives it one below.
            if window.has_ended(&Trajectory { recent: trajectory.recent + 1, ..*trajectory }) {
                *velocity = [0.0; 2];
            }
        }
        if !has_fixed {
            return;
        }
        // Walls and immovable discs are projected last, because no other body yields to keep a disc
        // out of them. A disc that has crossed a wall would not come back.
        impulses::project(fixed.clone(), velocities, sums);
        before.clone_from(velocities);
        for touch in fixed.clone().filter(|touch| touch.separation_speed(before) < 0.0) {
            for body in touch.bodies.into_iter().flatten() {
                let (missing, velocity) = (touch.separation_speed(before), before[body]);
                // An approach that is left after the projection means that no velocity satisfies
                // all surfaces. Then the velocity of the disc has no meaning, and it starts from 0
                // for the last projection.
                if missing * missing > NO_ROOM * dot(velocity, velocity) {
                    velocities[body] = [0.0; 2];
                }
            }
        }
        impulses::project(fixed, velocities, sums);
    }
}

/// Whether the surfaces of the contact with a key still approach after it was solved: a disc
/// without room has no velocity with which they do not. To predict their impact again would be
/// without end.
pub(super) fn approaches_still(
    touches: &[Constraint],
    velocities: &[Vector],
    key: [u32; 3],
) -> bool {
    let approaches = |touch: &Constraint| touch.separation_speed(velocities) < 0.0;
    touches.iter().any(|touch| touch.key == key && approaches(touch))
}
