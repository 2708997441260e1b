//! A disc that bounces off a wall and touches nothing else at that moment, as most do.
//!
//! The result has the same bits as that of [`Simulation::happen`], without its lists.

use super::history::Bounce;
use super::impulses;
use super::queue::{Event, WALL};
use super::simulation::Simulation;
use super::two::Turned;
use crate::trajectory::{Kind, Piece};
use jostle_base::error::Result;

impl Simulation<'_> {
    /// Computes the bounce of a disc off a wall and returns true. Returns false, with its trajectory
    /// unchanged, if it is no such bounce, if the wall has a temperature, if there is friction, if the
    /// disc touches anything else, or if it reaches its limit of events.
    pub(super) fn collide_alone(&mut self, event: &Event) -> Result<bool> {
        let window = self.window;
        let Event { time, kind, code: wall, pair: [index, partner], .. } = *event;
        let flight = window.flight;
        let is_plain =
            !flight.has_friction && flight.thermostat.is_none() && flight.temperatures.is_empty();
        if kind != Kind::Bounce || partner != WALL || !is_plain {
            return Ok(false);
        }
        let number = self.trajectory(index);
        let trajectory = &self.history.trajectories[number as usize];
        // A disc without room has several events at one moment.
        // `happen` treats discs between walls at an acute angle or between walls that close in, and
        // counts their events at one moment.
        let has_just_turned = trajectory.count > 0 && trajectory.piece.time == time;
        if has_just_turned || trajectory.is_exhausted || self.is_nearly_exhausted(trajectory) {
            return Ok(false);
        }
        // The steps below are those of `happen` for a group of one disc and one contact. The same
        // functions in the same order make the same bits.
        let now = trajectory.piece.moved(time, window.gravity());
        let count = trajectory.count + 1;
        let normal = window.wall_normal(index, wall, &now);
        let touch = self.wall_touch(index, 0, trajectory, wall, normal);
        let mut velocities = [now.velocity];
        impulses::apply(&mut [touch], &mut velocities, &mut self.scratch.impulses);
        let new = Piece { velocity: velocities[0], is_first: false, ..now };
        let own = Turned { index, now: &now, new: &new, count };
        let mut predicted = std::mem::take(&mut self.scratch.predicted);
        predicted.clear();
        // The wall of the event is found again among those that the disc touches. On a torus
        // another image of it is another contact, so the normal is compared, too.
        let is_known = |other: u32, normal| {
            other == wall && touch.is_same(&impulses::Constraint::of_wall(index, wall, normal))
        };
        // The early test leaves out this wall if the disc moves away from it after the bounce.
        let left = flight.walls.left(wall);
        let is_alone = self.predict_one(time, &own, None, left, is_known, &mut predicted)?;
        // Only now does anything change. If the disc touches something else, `happen` computes the
        // event from an unchanged state.
        if is_alone {
            predicted.iter().try_for_each(|event| self.scratch.queue.push(*event))?;
            self.turn(number, new);
            let impulses = self.impulses_of(0);
            let (pair, normal) = ([index, WALL], touch.normal.map(|v| v as f32));
            let (code, trajectory) = (wall, number);
            self.history.bounces.push(Bounce { pair, code, normal, impulses, trajectory });
        }
        self.scratch.predicted = predicted;
        Ok(is_alone)
    }
}
