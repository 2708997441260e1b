//! Pairs that pass through each other, and discs that pass through walls: which of them touch.

use super::Events;
use super::flight::TimeWindow;
use super::history::TimedPiece;
use super::neighbors::NearPair;
use crate::trajectory::{Relative, Vector};
use jostle_base::error::Result;
use jostle_base::interrupt::Stop;
use jostle_base::{memory, parallel};

/// Pairs that one thread tests at a time.
const PAIRS: usize = 4096;

impl Events {
    /// Appends the pairs that touch along their trajectories in the window, of those that pass
    /// through each other.
    pub(super) fn find_sensed(&mut self, window: &TimeWindow<'_>) -> Result<()> {
        // Those of renewed bounds are in another list.
        let sensed = if window.anchors.is_some() { &[] } else { window.flight.sensed };
        let is_any = sensed.iter().any(|(_, pairs)| !pairs.is_empty());
        if !is_any && self.sensed_near.is_empty() {
            return Ok(());
        }
        // Trajectories are final here, and this test changes none. So it needs no repetition, and
        // each pair is tested alone.
        let parts = sensed
            .iter()
            .flat_map(|(image, pairs)| pairs.chunks(PAIRS).map(move |part| (*image, part)));
        let (mut found, count) = (std::mem::take(&mut self.found), parts.clone().count());
        let len = found.len().max(count);
        memory::resize_default(&mut found, len)?;
        let stop = Stop::current();
        let tasks = found.iter_mut().zip(parts);
        parallel::try_for_each(window.flight.threads, tasks, |(found, (image, pairs))| {
            found.clear();
            if stop.is_set() {
                return Ok(());
            }
            let image = image.map(f64::from);
            let passing = pairs.iter().copied().filter(|&pair| self.pass(window, pair, image));
            memory::extend(found, passing)
        })?;
        for found in &found[..count] {
            memory::append(&mut self.sensed, found)?;
        }
        self.found = found;
        let mut sensed = std::mem::take(&mut self.sensed);
        let passes = |near: &&NearPair| self.pass(window, near.pair, near.offset);
        let touching = self.sensed_near.iter().filter(passes).map(|near| near.pair);
        memory::extend(&mut sensed, touching)?;
        self.sensed = sensed;
        Ok(())
    }

    /// Appends the discs that touch walls which are sensors along their trajectories in the window.
    pub(super) fn find_at_walls(&mut self, window: &TimeWindow<'_>) -> Result<()> {
        if !window.flight.senses_walls {
            return Ok(());
        }
        let (walls, gravity) = (window.flight.walls, window.gravity());
        let (mut at_walls, mut done) = (std::mem::take(&mut self.at_walls), Ok(()));
        let mut add = |index: u32, wall: u32| {
            let added = memory::push(&mut at_walls, [index, wall]);
            if added.is_err() {
                done = added;
            }
        };
        walls.each_near_sensor(|index, wall, offset| {
            let touches = |at: TimedPiece| {
                walls.is_touched(index, (wall, offset), &at.piece, at.end, gravity)
            };
            if self.pieces(window, index).any(touches) {
                add(index, wall);
            }
        });
        // Few discs leave the bounds in which walls were searched.
        for index in 0..window.flight.particles.len() as u32 {
            for at in self.pieces(window, index) {
                walls.each_sensor_beyond(index, &at.piece, at.end, gravity, |wall, offset| {
                    if walls.is_touched(index, (wall, offset), &at.piece, at.end, gravity) {
                        add(index, wall);
                    }
                });
            }
        }
        self.at_walls = at_walls;
        done
    }

    /// Whether two discs may touch, and their trajectories come so near each other that their surfaces touch.
    fn pass(&self, window: &TimeWindow<'_>, pair: [u32; 2], image: Vector) -> bool {
        let [a, b] = pair.map(|index| index as usize);
        if !window.flight.particles.may_touch(a, b) {
            return false;
        }
        let contact_distance = window.contact_distance(pair[0], pair[1]);
        self.any_at_once(window, pair, |own: &TimedPiece, other: &TimedPiece| {
            let both = Relative::of(&own.piece, &other.piece, image, window.gravity());
            // Sensors touch also if they separate, so there is no limit for slow approaches.
            both.touches(contact_distance, own.end.min(other.end))
        })
    }

    /// Moves the pairs that pass through each other from those near each other in larger bounds to
    /// those to be tested for touching.
    pub(super) fn take_sensed(&mut self, window: &TimeWindow<'_>) -> Result<()> {
        let particles = window.flight.particles;
        let all_pass = !window.flight.pairs;
        if !all_pass && particles.sensors.is_empty() {
            return Ok(());
        }
        let passes = |[a, b]: [u32; 2]| {
            all_pass || particles.is_sensor(a as usize) || particles.is_sensor(b as usize)
        };
        let Self { near, sensed_near, .. } = self;
        memory::extend(sensed_near, near.iter().copied().filter(|near| passes(near.pair)))?;
        near.retain(|near| !passes(near.pair));
        Ok(())
    }
}
