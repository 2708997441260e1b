//! Blocks of discs that are simulated by themselves at first.

use std::ops::Range;

use super::flight::TimeWindow;
use super::history::{Bounce, History};
use super::neighbors::Neighbors;
use super::queue::Event;
use super::simulation::{Scratch, Simulation};
use crate::particles::Particles;
use jostle_base::cache;
use jostle_base::error::Result;
use jostle_base::interrupt::Stop;
use jostle_base::{memory, parallel};

/// Discs of a block, at least and at most. In Morton order they are neighbours of each other for
/// the most part. Large blocks have fewer trajectories to test against other blocks.
const BLOCK: Range<usize> = 1024..8192;

/// Blocks for other threads to share, at least, if they are not too small.
const SHARED: usize = 16;

/// Discs of each block but the last.
pub(super) fn size(len: usize, threads: Option<usize>) -> usize {
    // With several threads a small world gets several blocks, so that no thread waits long for the
    // last one. The result does not depend on the size of blocks, so this may depend on the number
    // of threads.
    let least = if parallel::is_parallel(threads) { SHARED } else { 1 };
    // The lower limit keeps the share of pairs across blocks small: these are tested after the
    // simulation and cause repetitions. With 1,024 discs in a block the events of a gas take 6 %
    // longer than with 8,192. With 16,384 they take 1 % less, and fewer blocks are there to share.
    len.div_ceil(least).clamp(BLOCK.start, BLOCK.end).next_power_of_two()
}

/// A range of discs that are simulated together.
#[derive(Debug, Default)]
pub(super) struct Block {
    pub(super) number: usize,
    pub(super) range: Range<u32>,
    /// Impacts along the first pieces.
    pub(super) first: Vec<Event>,
    /// Impacts along the first pieces with discs of other blocks.
    pub(super) crossing: Vec<Event>,
    pub(super) history: History,
    pub(super) is_simulated: bool,
}

/// Arguments of the simulation of a block.
pub(super) struct Arguments<'a> {
    pub(super) window: &'a TimeWindow<'a>,
    pub(super) neighbors: &'a Neighbors,
    pub(super) trajectory_of: &'a mut [u32],
    pub(super) reaches: &'a [f32],
    pub(super) stop: &'a Stop,
    pub(super) scratch: &'a mut Scratch,
}

impl Block {
    /// Empties the block for a window.
    pub(super) fn begin_window(&mut self, number: usize, range: Range<u32>) {
        self.number = number;
        self.range = range;
        self.first.clear();
        self.crossing.clear();
        self.history.clear();
        self.is_simulated = false;
    }

    /// Leaves out the impacts after the end of a shorter window.
    pub(super) fn shorten(&mut self, window: &TimeWindow<'_>) {
        // Events after the new end have changed trajectories, bounces and islands. To simulate the block
        // again is simpler than to undo them, and few windows are shortened.
        self.history.clear();
        self.is_simulated = false;
        for events in [&mut self.first, &mut self.crossing] {
            events.retain(|event| event.time <= window.end);
        }
    }

    pub(super) fn load_starts(&self, arguments: &Arguments<'_>) {
        let range = self.range.start as usize..self.range.end as usize;
        cache::load(&arguments.window.now[range]);
    }

    /// Loads into the cache what events need of a few discs each, in the order of time.
    pub(super) fn load(&self, arguments: &Arguments<'_>) {
        let range = self.range.start as usize..self.range.end as usize;
        let Particles { positions, residuals, .. } = arguments.window.flight.particles;
        // Events jump between discs, and each jump would wait for memory. To read the columns in
        // order first lets the processor prefetch them.
        arguments.neighbors.load(self.number);
        if !arguments.window.flight.begins_part {
            cache::load(&positions[range.clone()]);
            cache::load(&residuals[range.clone()]);
        }
        cache::load(&arguments.reaches[range]);
    }

    /// Finds the impacts on walls along the first pieces; `unsettled` are the discs of the block that
    /// are not settled. `near` is scratch.
    pub(super) fn find_first_wall_impacts(
        &mut self,
        window: &TimeWindow<'_>,
        unsettled: &[u32],
        near: &mut Vec<u32>,
    ) -> Result<()> {
        // Settled discs hit no side of the container, but walls may move.
        // A wall with a velocity reaches discs that do not move. Whether they are settled tells
        // nothing about it.
        let near = if window.flight.walls.is_empty() {
            window.list_near_walls(unsettled.iter().copied(), near)?
        } else {
            window.list_near_walls(self.range.clone(), near)?
        };
        let near = near.iter();
        let event = |&index| window.wall_event(index, &window.piece(index), 0, &|_| false);
        let events = near.map(event);
        memory::extend(&mut self.first, events.flatten())
    }

    /// Simulates the events of the block by itself.
    pub(super) fn simulate(&mut self, arguments: &mut Arguments<'_>) -> Result<()> {
        self.is_simulated = true;
        let Arguments { window, neighbors, trajectory_of, reaches, stop, scratch } = arguments;
        let (range, history) = (self.range.clone(), &mut self.history);
        // A block has one simulation in each window, so its trajectories begin with number 0.
        // Repetitions append to one list, with a mark and a base of their own.
        let (mark, base) = (0, 0);
        let simulation = Simulation {
            window,
            neighbors,
            range,
            trajectory_of,
            reaches,
            history,
            mark,
            base,
            stop,
            scratch,
        };
        simulation.run(&self.first, &[])?;
        // Sums of impulses in float32 depend on their order. The order of events depends on blocks
        // where discs do not affect each other, so bounces are sorted by discs.
        self.history.bounces.sort_unstable_by(Bounce::order);
        if window.is_last() && window.flight.keeps_starts() {
            // The discs are in the cache now. Those that are simulated again are moved again.
            self.move_discs(window, trajectory_of);
        }
        Ok(())
    }

    /// Moves the discs of the block to the end of the flight, by its own history.
    pub(super) fn move_discs(&self, window: &TimeWindow<'_>, trajectory_of: &[u32]) {
        // All as if they had no events, and then those that have, because a branch for each would often be
        // predicted wrongly.
        for index in self.range.clone() {
            if !window.starts[index as usize].is_movable {
                window.carry(index);
            } else if window.begin == 0.0 {
                window.move_disc(index, &window.free_piece(index), None);
            } else {
                // In a window that is not the first, a disc without events in it may have had some
                // before.
                let stopped = window.carried(index).and_then(|trajectory| trajectory.stopped);
                window.move_disc(index, &window.piece(index), stopped);
            }
        }
        for (number, trajectory) in (0..).zip(&self.history.trajectories) {
            // At the end of a repetition `trajectory_of` may name another trajectory; that one is written
            // elsewhere.
            if trajectory_of[(trajectory.index - self.range.start) as usize] == number {
                window.move_disc(trajectory.index, &trajectory.piece, trajectory.stopped);
            }
        }
    }

    /// The number of impacts after `begin`, until `end`.
    pub(super) fn impacts_until(&self, [begin, end]: [f64; 2]) -> usize {
        // Impacts at the very beginning are in a window of any length. If they counted, windows
        // would be halved to the shortest one without any gain.
        let is_counted = |event: &&Event| event.time > begin && event.time <= end;
        self.first.iter().chain(&self.crossing).filter(is_counted).count()
    }
}
