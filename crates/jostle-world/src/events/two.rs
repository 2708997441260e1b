//! Two discs that collide and touch nothing else at that moment, as most do.
//!
//! The result has the same bits as that of [`Simulation::happen`], without its lists.

use super::early::Now;
use super::history::{Bounce, Trajectory};
use super::impulses::{self, Constraint};
use super::neighbors::opposite;
use super::queue::{Event, WALL};
use super::simulation::Simulation;
use crate::trajectory::{Kind, Piece, Vector, vector};
use jostle_base::error::Result;
use jostle_base::memory;

/// A disc that gets a new piece.
#[derive(Clone, Copy)]
pub(super) struct Turned<'a> {
    pub(super) index: u32,
    /// The piece that begins now, with the velocity before the impact.
    pub(super) now: &'a Piece,
    /// The piece that begins now, with the velocity after the impact.
    pub(super) new: &'a Piece,
    /// The number of its events.
    pub(super) count: u32,
}

/// The disc with which another one collides.
#[derive(Clone, Copy)]
pub(super) enum Partner<'a> {
    /// Its next impacts are predicted; with the number of its image.
    Predicted(&'a Turned<'a>, u32),
    /// They have been.
    Known(u32),
}

impl Simulation<'_> {
    /// Computes the bounce of two discs and returns true. Returns false, with trajectories unchanged,
    /// if it is no bounce of two movable discs, if one touches something else, or if one reaches its
    /// limit of events.
    pub(super) fn collide_two(&mut self, event: &Event) -> Result<bool> {
        let window = self.window;
        let Event { time, kind, code, pair: discs, .. } = *event;
        // A partner that cannot move has no trajectory, and its velocity enters the contact in another
        // way.
        let are_discs = discs[1] != WALL && window.starts[discs[1] as usize].is_movable;
        if kind != Kind::Bounce || !are_discs {
            return Ok(false);
        }
        // New trajectories may stay without an event if this returns false. `happen` then finds them and
        // adds the event.
        let numbers = discs.map(|disc| self.trajectory(disc));
        let trajectories = numbers.map(|number| &self.history.trajectories[number as usize]);
        let needs_group = |trajectory: &Trajectory| {
            self.is_nearly_exhausted(trajectory) || self.is_joint(trajectory, time)
        };
        if trajectories.into_iter().any(needs_group) {
            return Ok(false);
        }
        let now = |k: usize| trajectories[k].piece.moved(time, window.gravity());
        // Arrays that are mapped are copied through memory again.
        let now = [now(0), now(1)];
        let counts = trajectories.map(|trajectory| trajectory.count);
        let recent = trajectories.map(|trajectory| trajectory.recent);
        // From the smaller index to the larger, so that both give the same numbers.
        let ([a, b], code) =
            if discs[0] < discs[1] { ([0, 1], code) } else { ([1, 0], opposite(code)) };
        let pair = [discs[a], discs[b]];
        let image = self.neighbors.image_of(code);
        let offset = vector(|k| now[b].position[k] - now[a].position[k] + image[k]);
        let touch = Constraint {
            bodies: [Some(a), Some(b)],
            inverse_masses: [a, b].map(|k| trajectories[k].inverse_mass),
            restitution: self.pair_restitution(pair, recent),
            friction: window.pair_friction(pair),
            ..Constraint::of_discs(pair, code, offset)
        };
        let mut velocities = now.map(|now| now.velocity);
        // With one contact the iteration ends after one turn, so the result is the closed formula
        // for two discs.
        impulses::apply(&mut [touch], &mut velocities, &mut self.scratch.impulses);
        if window.flight.has_friction {
            self.rub(&[touch], numbers.into_iter(), &mut velocities);
        }
        let turned = |k: usize| Piece { velocity: velocities[k], is_first: false, ..now[k] };
        let new = [turned(0), turned(1)];
        // The predictions and the search for other contacts visit the same neighbours, so they are
        // one pass. If another contact is found, the predictions are dropped, and no trajectory has
        // changed.
        if !self.predict_two(event, &now, &new, counts.map(|count| count + 1))? {
            return Ok(false);
        }
        // An island is what a rollback takes together; see `Simulation::bounce`.
        self.history.connect(numbers[0], numbers[1]);
        if window.flight.has_friction {
            self.set_rotors(numbers.into_iter(), time);
        }
        (0..2).for_each(|k| self.turn(numbers[k], new[k]));
        let impulses = self.impulses_of(0);
        let (normal, trajectory) = (touch.normal.map(|v| v as f32), numbers[a]);
        self.history.bounces.push(Bounce { pair, code, normal, impulses, trajectory });
        Ok(true)
    }

    /// Adds the next impacts of two discs that continue on `new` instead of `now` to the queue.
    /// Returns false, and adds nothing, if they touch anything else.
    fn predict_two(
        &mut self,
        event: &Event,
        now: &[Piece; 2],
        new: &[Piece; 2],
        counts: [u32; 2],
    ) -> Result<bool> {
        let Event { time, code, pair: discs, .. } = *event;
        let mut predicted = std::mem::take(&mut self.scratch.predicted);
        predicted.clear();
        let both =
            |k: usize| Turned { index: discs[k], now: &now[k], new: &new[k], count: counts[k] };
        let both = [both(0), both(1)];
        // The impacts of the two with each other are predicted once.
        let partners = [Partner::Predicted(&both[1], code), Partner::Known(discs[0])];
        let is_known = |_, _| false;
        let mut are_alone = true;
        for k in [0, 1] {
            let partner = Some(partners[k]);
            are_alone &=
                self.predict_one(time, &both[k], partner, None, is_known, &mut predicted)?;
        }
        if are_alone {
            predicted.iter().try_for_each(|event| self.scratch.queue.push(*event))?;
        }
        self.scratch.predicted = predicted;
        Ok(are_alone)
    }

    /// Appends the next impacts of a disc that gets a new piece at `time`. Returns whether it touches
    /// nothing then, apart from its partner and from walls, with their normals, that are known. `left` is
    /// a wall of those that are known.
    #[inline(always)]
    pub(super) fn predict_one(
        &mut self,
        time: f64,
        own: &Turned<'_>,
        partner: Option<Partner<'_>>,
        left: Option<u32>,
        is_known: impl Fn(u32, Vector) -> bool,
        predicted: &mut Vec<Event>,
    ) -> Result<bool> {
        let (window, neighbors) = (self.window, self.neighbors);
        let Turned { index, now, new, count } = *own;
        // The early tests look as far as the window, not the flight: what happens later is
        // predicted in the next window.
        let span = (window.end - time) as f32;
        // The test in float32 leaves out most neighbours before anything is computed in float64.
        let own_now = Now::of(new, window.radius(index));
        let (mut is_alone, mut done) = (true, Ok(()));
        let [touches, hits] = window.may_touch_wall(index, &own_now, span, left);
        if touches {
            let contacts = &mut self.scratch.contacts;
            // `now` has the velocity before the impact. A wall that the disc approaches with it
            // belongs to the same moment.
            window.each_touched_wall(index, now, false, contacts, |wall, normal| {
                is_alone &= is_known(wall, normal);
            });
        }
        if hits {
            memory::extend(predicted, window.wall_event(index, new, count, &|_| false))?;
        }
        neighbors.of(index, |neighbor| {
            let (other, image) = (neighbor.index, neighbors.image(neighbor));
            let (before, after, other_count, is_this) = match partner {
                Some(Partner::Known(partner)) if other == partner => return,
                Some(Partner::Predicted(partner, code)) if other == partner.index => {
                    (*partner.now, *partner.new, partner.count, neighbor.image == code)
                }
                _ => {
                    let there = match self.number(other) {
                        Some(number) => {
                            let piece = &self.history.trajectories[number as usize].piece;
                            Now::of(&piece.moved(time, window.gravity()), window.radius(other))
                        }
                        None => window.first_at(other, time),
                    };
                    let image = image.map(|v| v as f32);
                    // The early test covers both questions: whether they touch now and whether they
                    // meet later.
                    if !own_now.may_meet(&there, image, span) {
                        return;
                    }
                    // Discs that take no part are found later, as conflicts.
                    let Some((_, piece, count)) = self.current(other) else { return };
                    let moved = piece.moved(time, window.gravity());
                    (moved, moved, count, false)
                }
            };
            is_alone &=
                is_this || !window.touch_now((index, now), (other, &before), image, || false);
            if let Some(impact) = window.impact((index, new), (other, &after), image, window.end) {
                let counts = [count, other_count];
                let event = Event::of_discs(impact, [index, other], neighbor.image, counts);
                if let Err(error) = memory::push(predicted, event) {
                    done = Err(error);
                }
            }
        });
        done.map(|()| is_alone)
    }
}
