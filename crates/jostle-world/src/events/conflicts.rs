//! Trajectories of discs that were simulated apart and meet: these discs are simulated again, together.
//!
//! This is optimistic synchronisation of a parallel simulation of discrete events, with rollback
//! (D. R. Jefferson, *Virtual Time*, ACM Transactions on Programming Languages and Systems 7, 1985).

use std::hint::black_box;

use super::Events;
use super::block::Block;
use super::bounds::SweptBounds;
use super::flight::TimeWindow;
use super::history::{NONE, TimedPiece, Trajectory};
use super::simulation::Simulation;
use crate::trajectory::Vector;
use jostle_base::error::Result;
use jostle_base::interrupt::{self, Pulse, Stop};
use jostle_base::memory;
use jostle_base::parallel::{self, locked};

/// Marks trajectories of discs that were simulated again.
pub(super) const AGAIN: u32 = 1 << 31;

/// Repetitions in which only discs with conflicts are simulated again. After that, all discs with
/// events are, so that the repetitions end.
const MAX_ROUNDS: usize = 64;

/// Approximate number of values read to test two trajectories.
const MEETING_WORK: usize = 64;

impl Events {
    /// Simulates discs again until no two trajectories meet that were simulated apart.
    pub(super) fn resolve_conflicts(
        &mut self,
        window: &TimeWindow<'_>,
        bounds: &mut dyn SweptBounds,
    ) -> Result<()> {
        // Blocks were simulated as if discs of other blocks did not exist. This is a guess, and it
        // is verified here. Each trajectory with events is tested against all that it can reach
        // outside its block. What does not hold is removed and simulated again, together.
        // The result is the one history in which no two trajectories meet unnoticed. It does not
        // depend on which guess was made first, so blocks and threads do not matter.
        self.conflicts.clear();
        self.had_conflicts.clear();
        // There are three sources of conflicts. Some pairs cross along their first pieces, and
        // some meet after an event. Others are new, because a disc has left its bounds.
        self.find_crossing(window)?;
        self.find_meeting(window)?;
        interrupt::check()?;
        self.outside.clear();
        for block in &self.blocks {
            memory::append(&mut self.outside, &block.history.outside)?;
        }
        self.grow(window, bounds)?;
        self.find_meeting_new(window)?;
        let mut rounds = 0;
        while !self.conflicts.is_empty() {
            rounds += 1;
            // Each round ends with tests of what it has changed. Discs with a conflict stay in one
            // island, so the islands become larger from round to round. After `MAX_ROUNDS` all
            // discs with events are one simulation, and the loop ends.
            self.simulate_again(window, rounds > MAX_ROUNDS, bounds)?;
            interrupt::check()?;
        }
        Ok(())
    }

    /// Appends the pairs of different blocks that meet along their first pieces to the conflicts.
    fn find_crossing(&mut self, window: &TimeWindow<'_>) -> Result<()> {
        // A pair that crosses may be deflected before it meets. It is simulated together all the
        // same, which costs time and changes no result.
        let all = self.blocks.iter().flat_map(|block| &block.crossing);
        let in_window = all.filter(|event| event.time <= window.end);
        memory::extend(&mut self.conflicts, in_window.map(|event| event.pair))
    }

    /// Appends the pairs of different blocks whose trajectories meet after an event to the
    /// conflicts.
    fn find_meeting(&mut self, window: &TimeWindow<'_>) -> Result<()> {
        // One block knows all discs, so it has no neighbours outside.
        if !window.flight.pairs || self.blocks.len() < 2 {
            return Ok(());
        }
        let stop = Stop::current();
        let mut found = std::mem::take(&mut self.found);
        memory::resize_default(&mut found, self.blocks.len())?;
        let blocks = found.iter_mut().zip(&self.blocks);
        parallel::try_for_each(window.flight.threads, blocks, |(found, block)| {
            found.clear();
            let Block { number, range, .. } = block;
            let mut done = Ok(());
            if stop.is_set() {
                return done;
            }
            self.neighbors.each_across(*number, range, |own, neighbor| {
                // Pairs without any event follow their first pieces, which `find_crossing`
                // covers. An immovable disc takes part in each block, so its impacts are known
                // already.
                if self.trajectory_of[own as usize] == NONE
                    || !window.starts[neighbor.index as usize].is_movable
                {
                    return;
                }
                let (pair, image) = ([own, neighbor.index], self.neighbors.image(&neighbor));
                // Both discs list the pair, and it may be found twice. Each is simulated once,
                // because `sort_discs` removes duplicates.
                if self.meet(window, pair, image, false)
                    && let Err(error) = memory::push(found, pair)
                {
                    done = Err(error);
                }
            });
            done
        })?;
        for found in &found {
            memory::append(&mut self.conflicts, found)?;
        }
        self.found = found;
        Ok(())
    }

    /// Simulates the discs of the conflicts again, with all whose histories depend on theirs. The
    /// pairs of these discs and others whose trajectories meet are the new conflicts.
    fn simulate_again(
        &mut self,
        window: &TimeWindow<'_>,
        all: bool,
        bounds: &mut dyn SweptBounds,
    ) -> Result<()> {
        // The repetition is one simulation on one thread. Its discs may be in any blocks, and those
        // of an island depend on each other.
        self.reopen(window, all)?;
        self.load_near(window);
        let stop = Stop::current();
        let mut scratch = locked(&self.scratch).pop().unwrap_or_default();
        // Trajectories of earlier repetitions stay in the list and remain valid, unless they were
        // reopened. Numbers from `base` on belong to this repetition.
        let base = self.again.trajectories.len() as u32;
        let simulation = Simulation {
            window,
            neighbors: &self.neighbors,
            range: 0..window.starts.len() as u32,
            trajectory_of: &mut self.trajectory_of,
            reaches: bounds.reaches(),
            history: &mut self.again,
            mark: AGAIN,
            base,
            stop: &stop,
            scratch: &mut scratch,
        };
        simulation.run(&[], &self.discs)?;
        locked(&self.scratch).push(scratch);
        self.connect_conflicts()?;
        let mut found = std::mem::take(&mut self.conflicts);
        found.clear();
        let mut done = Ok(());
        // Only pairs with a disc of this repetition can have changed, so only these are tested. Two
        // discs of this repetition already know each other.
        for Trajectory { index, .. } in &self.again.trajectories[base as usize..] {
            self.neighbors.of(*index, |neighbor| {
                let number = self.trajectory_of[neighbor.index as usize];
                let is_new = number & AGAIN != 0 && number & !AGAIN >= base;
                let pair = [*index, neighbor.index];
                let image = self.neighbors.image(neighbor);
                if number != NONE
                    && !is_new
                    && self.meet(window, pair, image, true)
                    && let Err(error) = memory::push(&mut found, pair)
                {
                    done = Err(error);
                }
            });
        }
        self.conflicts = found;
        done?;
        memory::assign(&mut self.outside, &self.again.outside)?;
        self.again.outside.clear();
        self.grow(window, bounds)?;
        self.find_meeting_new(window)
    }

    /// Makes one island of the discs of each conflict of the window, so that they are simulated
    /// together in all later repetitions, also if they do not collide. Without this, a disc that has
    /// conflicts with two others could be simulated again with each of them in turn, without end.
    fn connect_conflicts(&mut self) -> Result<()> {
        let Self { had_conflicts, conflicts, trajectory_of, again, .. } = self;
        memory::append(had_conflicts, conflicts)?;
        conflicts.clear();
        for pair in had_conflicts {
            let trajectories = pair.map(|disc| trajectory_of[disc as usize]);
            if trajectories.iter().all(|&trajectory| trajectory != NONE && trajectory & AGAIN != 0)
            {
                let [a, b] = trajectories.map(|trajectory| trajectory & !AGAIN);
                again.connect(a, b);
            }
        }
        Ok(())
    }

    /// Loads the first pieces of the discs that are simulated again, and of their neighbours, into
    /// the cache. They are far from each other in memory, and the processor waits for many of these
    /// reads at once.
    fn load_near(&self, window: &TimeWindow<'_>) {
        for &disc in &self.discs {
            let near = self.neighbors.at_start(disc).iter().map(|neighbor| neighbor.index);
            near.chain([disc]).for_each(|index| _ = black_box(window.now[index as usize].radius));
        }
    }

    /// Removes the trajectories of the discs of the conflicts, and of all that depend on theirs, and
    /// lists these discs. If these are more than half of the discs with events, or if `all` is true,
    /// the other discs with events are added: one repetition for all costs less than several for
    /// nearly all.
    fn reopen(&mut self, window: &TimeWindow<'_>, all: bool) -> Result<()> {
        let with_events =
            self.blocks.iter().map(|block| block.history.trajectories.len()).sum::<usize>();
        let conflicts = std::mem::take(&mut self.conflicts);
        self.discs.clear();
        // If a disc has another history, all discs with which it collided may have another one,
        // too. They form the island, and the island is removed as a whole.
        self.reopen_islands(conflicts.iter().flatten().copied())?;
        self.conflicts = conflicts;
        self.sort_discs(window);
        // The share of a half was found with inelastic discs that fall together. The mean time of a
        // step fell from 16,000 to 9,800 ns for a disc (`docs/benchmarks-notes.md`).
        if all || self.discs.len() > with_events / 2 {
            for index in 0..self.trajectory_of.len() as u32 {
                if self.trajectory_of[index as usize] != NONE {
                    self.reopen_islands([index].into_iter())?;
                }
            }
            self.sort_discs(window);
        }
        Ok(())
    }

    /// Lists each movable disc that is simulated again once, in ascending order.
    fn sort_discs(&mut self, window: &TimeWindow<'_>) {
        self.discs.retain(|&index| window.starts[index as usize].is_movable);
        // In ascending order, so that the repetition reads memory in order. The result would be the
        // same in any order.
        self.discs.sort_unstable();
        self.discs.dedup();
    }

    /// Removes the trajectories of some discs and of all that depend on theirs, and appends these discs to
    /// the list.
    fn reopen_islands(&mut self, mut indices: impl Iterator<Item = u32>) -> Result<()> {
        let Self { trajectory_of, blocks, again, size, discs, .. } = self;
        let mut reopen = |index: u32| {
            let (history, mark) = match trajectory_of[index as usize] {
                // Without a trajectory the disc is in no island, so it is listed alone.
                NONE => return memory::push(discs, index),
                number if number & AGAIN != 0 => (&mut *again, AGAIN),
                _ => (&mut blocks[index as usize / *size].history, 0),
            };
            // The flag lets `History::retain` skip its test of all bounces where nothing was
            // removed.
            history.has_removed = true;
            let mut done = Ok(());
            history.each_of_island(trajectory_of[index as usize] & !AGAIN, |number| {
                let member = history.trajectories[number as usize].index;
                let trajectory = &mut trajectory_of[member as usize];
                // A member that was reopened before has another trajectory, or none, and must not be
                // removed twice.
                if *trajectory == mark | number {
                    *trajectory = NONE;
                    if let Err(error) = memory::push(discs, member) {
                        done = Err(error);
                    }
                }
            });
            done
        };
        indices.try_for_each(&mut reopen)
    }

    /// Whether the trajectories of two discs meet, or touch as one of the two collides; the times
    /// of impact of the first pieces are tested only if `first` says so.
    fn meet(&self, window: &TimeWindow<'_>, [a, b]: [u32; 2], image: Vector, first: bool) -> bool {
        let is_joint = |index| match self.trajectory(index) {
            Some((_, trajectory)) => trajectory.is_joint,
            None => window.was_exhausted(index),
        };
        let all = is_joint(a) || is_joint(b);
        self.any_at_once(window, [a, b], |own, other| {
            // The two pieces exist together from the later start to the earlier end. An impact
            // after that belongs to other pieces.
            let until = own.end.min(other.end);
            let start = own.piece.time.max(other.piece.time);
            // Straight pieces without duration, between collisions at the same time, only
            // touch.
            let is_new = first || !own.is_first || !other.is_first;
            // A disc that falls may be pressed against one that does not, which is no touch.
            let is_curved = own.piece.falls != other.piece.falls;
            let is_tested = is_new && (start < until || is_curved);
            let both = ((a, &own.piece), (b, &other.piece));
            if is_tested && window.impact(both.0, both.1, image, until).is_some() {
                return true;
            }
            // Simultaneous contacts are solved together.
            let [p, q] = [own.piece, other.piece].map(|s| s.moved(until, window.gravity()));
            let ends_with_event = |part: &TimedPiece| part.end == until && !part.is_last;
            // If one disc has an event at the moment at which it touches the other, both belong to
            // one group. A simulation apart has solved this group without the other disc.
            let is_event = ends_with_event(own) || ends_with_event(other);
            is_event && window.touch_now((a, &p), (b, &q), image, || all)
        })
    }

    /// Whether `test` is true for pieces of two discs at the same time.
    pub(super) fn any_at_once(
        &self,
        window: &TimeWindow<'_>,
        [a, b]: [u32; 2],
        test: impl Fn(&TimedPiece, &TimedPiece) -> bool,
    ) -> bool {
        let mut others = self.pieces(window, b);
        self.pieces(window, a).any(|own| {
            // Both are in the order of time, the last piece first.
            // The iterator is kept from piece to piece, so all pairs of pieces at the same
            // time take linear time in the number of events.
            others.skip_after(own.end);
            let mut at_the_time = others.clone().take_while(|other| other.end >= own.piece.time);
            at_the_time.any(|other| test(&own, &other))
        })
    }

    /// Appends the new neighbours whose trajectories meet to the conflicts.
    fn find_meeting_new(&mut self, window: &TimeWindow<'_>) -> Result<()> {
        let mut conflicts = std::mem::take(&mut self.conflicts);
        let mut pulse = Pulse::current();
        for (a, neighbor) in &self.new {
            pulse.check(MEETING_WORK)?;
            let pair = [*a, neighbor.index];
            if self.meet(window, pair, self.neighbors.image(neighbor), true) {
                memory::push(&mut conflicts, pair)?;
            }
        }
        self.conflicts = conflicts;
        Ok(())
    }
}
