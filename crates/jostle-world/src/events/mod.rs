//! The events of a sub-step in the order of time (event-driven simulation: B. J. Alder and T. E. Wainwright,
//! *Studies in Molecular Dynamics*, Journal of Chemical Physics 31, 1959), in parallel.
//!
//! A sub-step is divided into windows. In a window the discs are divided into blocks, and each block
//! is simulated by itself. Then the trajectories of its discs are tested against the discs of other
//! blocks. If two trajectories meet, the discs whose histories depend on them are simulated again,
//! together. When no test finds anything, every trajectory has been tested against everything that
//! it can reach, so all trajectories are correct. The result does not depend on blocks or
//! threads, nor on how pairs were found.

mod alone;
mod block;
mod bounds;
mod conflicts;
mod early;
mod exhaustion;
mod first;
mod flight;
mod friction;
mod history;
mod impulses;
mod neighbors;
mod queue;
mod sensed;
mod shared;
mod simulation;
mod two;
mod window;

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::motion::Motion;
use block::{Arguments, Block};
use bounds::find_outside_at_start;
pub use bounds::{Candidates, Outside, SweptBounds};
use conflicts::AGAIN;
use flight::TimeWindow;
pub use flight::{Flight, Start};
pub use history::Bounce;
use history::{Carried, History, NONE, Pieces, Trajectory};
use jostle_base::error::{Error, Result};
use jostle_base::interrupt::{self, Stop};
use jostle_base::memory;
use jostle_base::parallel::{self, locked};
use neighbors::Neighbor;
use neighbors::Neighbors;
pub use neighbors::{NearPair, PairList};
pub use queue::WALL;
use simulation::Scratch;
use window::{end_for_the_fast, most_impacts, shortest_of_all};

/// Windows of a sub-step at most, apart from the last of all. More windows would let crowds have
/// few impacts in each, but each window is a pass over all discs.
const MAX_WINDOWS: f64 = 1024.0;

/// Collisions of one disc in a step at most; a step with more is refused. At a thousand radii a
/// step in a crystal the discs have about a third of these.
pub const MAX_COLLISIONS: u32 = 100_000;

/// Scratch, and the results of a sub-step.
#[derive(Debug, Default)]
pub struct Events {
    /// The discs that each disc may meet.
    neighbors: Neighbors,
    /// Bounces during the step, in any order.
    pub bounced: Vec<Bounce>,
    /// Pairs that touched during the step, of those that pass through each other; some may be listed
    /// twice.
    pub sensed: Vec<[u32; 2]>,
    /// Discs and the numbers of the walls that they touched, of those that are sensors; some may be listed twice.
    pub at_walls: Vec<[u32; 2]>,
    /// Discs that were exhausted, sorted. See [`exhaustion`].
    pub exhausted: Vec<u32>,
    /// Discs whose collisions became elastic in a window, because they had many, once for each window.
    pub collapsed: Vec<u32>,
    /// Discs that got beyond their watched reaches, and how far, once for each window. Unlike the
    /// growth of bounds they follow from the trajectories alone.
    pub beyond_reach: Vec<(u32, f64)>,
    /// Discs whose bounds grew: candidates for `beyond_reach`.
    may_be_beyond_reach: Vec<u32>,
    /// The number of events of each disc.
    pub counts: Vec<u32>,
    /// Whether a disc of this process has more than [`MAX_COLLISIONS`] of them.
    has_too_many: AtomicBool,
    /// Hashes of the trajectories of the discs that are shared with other processes.
    pub digests: Vec<u64>,
    /// Whether each of them may meet a disc of this process.
    pub may_meet: Vec<bool>,
    starts: Vec<Start>,
    /// Where discs are when a window begins that is not the first.
    now: Vec<Start>,
    /// The discs that had events in earlier windows of the sub-step.
    carried: Carried,
    /// The pairs of bounds that were renewed in the step, and where discs were then.
    candidates: Candidates,
    anchors: Vec<[f32; 2]>,
    is_renewed: bool,
    blocks: Vec<Block>,
    /// Discs of each block but the last.
    size: usize,
    /// The number of the trajectory of each disc: in the history of its block, or in that of the discs
    /// that were simulated again, if it has the mark [`AGAIN`].
    trajectory_of: Vec<u32>,
    /// The trajectories of discs that were simulated again.
    again: History,
    scratch: Mutex<Vec<Scratch>>,
    outside: Vec<Outside>,
    /// Pairs whose trajectories meet, of discs that were not simulated together.
    conflicts: Vec<[u32; 2]>,
    /// Those of the window for which discs were simulated again.
    had_conflicts: Vec<[u32; 2]>,
    /// Those that each block has found.
    found: Vec<Vec<[u32; 2]>>,
    /// Discs that are simulated again.
    discs: Vec<u32>,
    /// Pairs that may meet in larger bounds.
    near: Vec<NearPair>,
    /// Those of them that pass through each other.
    sensed_near: Vec<NearPair>,
    /// Those that are new.
    new: Vec<(u32, Neighbor)>,
}

impl Events {
    /// Moves all discs to the end of the sub-step, window by window.
    pub fn simulate(&mut self, flight: &Flight<'_>, bounds: &mut dyn SweptBounds) -> Result<()> {
        // The lists are taken out of `self`, because windows borrow them while `self` changes. They
        // are put back at the end, so that their memory is reused in the next sub-step.
        let mut starts = std::mem::take(&mut self.starts);
        let mut now = std::mem::take(&mut self.now);
        let mut carried = std::mem::take(&mut self.carried);
        let mut anchors = std::mem::take(&mut self.anchors);
        let mut candidates = std::mem::take(&mut self.candidates);
        let before = std::mem::take(&mut self.exhausted);
        // Discs that an earlier sub-step exhausted stay so until the end of the step. Otherwise a
        // row that collapses would cost its full number of events in each sub-step.
        flight.fill(&mut starts, &before)?;
        let kept = flight.kept_velocities(&before)?;
        carried.clear();
        let (mut begin, mut horizon) = (0.0, bounds.horizon());
        // A window has a least length, so that the number of windows of a sub-step is bounded.
        // Halving stops there, however many impacts remain in the window.
        let mut shortest = horizon.min(flight.end) / MAX_WINDOWS;
        while begin < flight.end {
            // Before each window but the first of a sub-step all processes learn that one has failed,
            // which ends long steps early.
            if begin > 0.0 && *self.has_too_many.get_mut() {
                return Err(Error::TooManyCollisions { id: 0, limit: MAX_COLLISIONS });
            }
            // The window is described with the state at its beginning. Nothing in it is rounded
            // between windows: trajectories continue from `carried` in float64. So the schedule of
            // windows does not change a result.
            let mut window = TimeWindow {
                flight,
                starts: &starts,
                exhausted: &before,
                now: &starts,
                carried: &carried,
                anchors: None,
                candidates: flight.candidates,
                begin,
                end: flight.end,
            };
            if begin > 0.0 {
                // The first window reads `starts` itself. Later ones need present places in
                // float32, for the early tests alone.
                window.fill_now(&mut now)?;
                window.now = &now;
            }
            // Whether all discs without events stay in their bounds in this window.
            let mut are_within = flight.bounded && begin == 0.0 && !self.is_renewed;
            if begin >= horizon {
                // On a torus a disc must not be searched too far away, or it would meet images of
                // itself. So the bounds of fast discs hold for a limited time, and are then made
                // anew.
                let seconds;
                (seconds, are_within) =
                    self.renew(&window, bounds, &mut candidates, &mut anchors)?;
                shortest = seconds / MAX_WINDOWS;
                let is_last = seconds >= flight.end - begin;
                horizon = if is_last { f64::INFINITY } else { begin + seconds };
            }
            if self.is_renewed {
                // Renewed bounds lie around `anchors`, no longer around the positions at the
                // beginning of the step. Distances must be measured from the same points as the
                // bounds.
                (window.anchors, window.candidates) = (Some(&anchors[..]), &candidates.pairs[..]);
            }
            window.end = window.end.min(horizon);
            begin = self.simulate_window(window, (bounds, are_within), shortest)?;
            // After the last window nothing continues.
            if begin < flight.end {
                self.carry_over(&mut carried)?;
            }
        }
        // Of a distributed world [`World::step`](crate::World::step) refuses it, on all processes.
        if flight.halo.is_alone() && *self.has_too_many.get_mut() {
            return Err(Error::TooManyCollisions { id: 0, limit: MAX_COLLISIONS });
        }
        // A disc that was exhausted and loses no energy stood still in the flight. It gets its
        // velocity back here, so that the energy is conserved.
        for (index, velocity) in kept {
            flight.motions.set(index, Motion { velocity, ..flight.motions.get(index) });
        }
        memory::append(&mut self.exhausted, &before)?;
        self.exhausted.sort_unstable();
        (self.starts, self.now, self.carried) = (starts, now, carried);
        (self.anchors, self.candidates) = (anchors, candidates);
        Ok(())
    }

    /// Renews the bounds around where the discs of a window are, and takes their pairs. Returns for
    /// how many seconds all processes have made them, and whether all discs stay in them until then if they
    /// have no events.
    fn renew(
        &mut self,
        window: &TimeWindow<'_>,
        bounds: &mut dyn SweptBounds,
        candidates: &mut Candidates,
        anchors: &mut Vec<[f32; 2]>,
    ) -> Result<(f64, bool)> {
        let flight = window.flight;
        let (seconds, are_within) =
            bounds.renew(window.now, flight.end - window.begin, candidates)?;
        // All processes must have windows of the same length, because they compare trajectories
        // window by window. So the process with the shortest horizon decides.
        let seconds = shortest_of_all(flight, seconds)?;
        anchors.clear();
        memory::extend(anchors, window.now.iter().map(|of| of.position))?;
        self.is_renewed = true;
        let lists = (&candidates.pairs[..], candidates.offsets.iter().copied());
        self.neighbors.fill(window.starts.len(), lists, self.size, flight.threads)?;
        memory::assign(&mut self.sensed_near, &candidates.sensed)?;
        Ok((seconds, are_within))
    }

    /// Whether a disc of this process has more than [`MAX_COLLISIONS`] collisions in the step.
    pub fn has_too_many(&self) -> bool {
        // Relaxed: the flag publishes no other data. The end of the parallel region that sets it
        // orders the store before this load.
        self.has_too_many.load(Ordering::Relaxed)
    }

    /// Moves all discs to the end of the window, or of a shorter one, and returns its end.
    fn simulate_window(
        &mut self,
        mut window: TimeWindow<'_>,
        (bounds, are_within): (&mut dyn SweptBounds, bool),
        shortest: f64,
    ) -> Result<f64> {
        // A window has five parts. First, each block finds the impacts along the first pieces.
        // Then these decide how long the window is. Each block is then simulated by itself. After
        // that, conflicts between blocks are resolved. At last the results are collected.
        // The second part needs the impacts of all blocks, so it is a barrier between two parallel
        // regions.
        self.prepare(window.starts.len())?;
        window.end = end_for_the_fast(&window, shortest)?;
        bounds.begin_window();
        self.neighbors.begin_window()?;
        // Neighbours that were found only because a disc left its bounds in the last window are
        // forgotten. Those that may also meet later are kept.
        self.sensed_near.retain(|near| near.lasts);
        if !are_within {
            // Bounds grow before the first impacts are searched: these must include all discs that
            // a first piece can reach. New bounds contain the first pieces, unless they are cut.
            find_outside_at_start(&window, bounds.reaches(), &mut self.outside)?;
            self.grow(&window, bounds)?;
        }
        self.find_first_impacts_of_later(&window)?;
        // A window with few first impacts has few conflicts. Blocks would otherwise simulate long
        // histories that a disc of another block makes invalid.
        let (reaches, most) = (bounds.reaches(), most_impacts(window.starts.len()));
        self.each_block(&window, reaches, |block, mut arguments| {
            block.load_starts(&arguments);
            let Scratch { near, near_walls, unsettled, .. } = &mut *arguments.scratch;
            window.list_unsettled(block.range.clone(), unsettled)?;
            block.find_first_impacts(&window, arguments.neighbors, unsettled, near)?;
            block.find_first_wall_impacts(&window, unsettled, near_walls)?;
            block.load(&arguments);
            // Most windows are not shortened, and the discs are in the cache now.
            let share = most as u64 * block.range.len() as u64 / window.starts.len() as u64;
            // The simulation here is a guess: the length of the window is not known yet. A block
            // with no more than its share of the allowed impacts takes the full window. If the
            // window becomes shorter, `shorten` discards the history.
            if block.impacts_until([window.begin, window.end]) as u64 <= share {
                block.simulate(&mut arguments)?;
            }
            Ok(())
        })?;
        interrupt::check()?;
        // The sum over all blocks does not depend on the order of summation, since it counts
        // events. So the end of the window does not depend on threads.
        let end = self.end_of_window(&window, shortest)?;
        let is_shorter = end < window.end;
        window.end = end;
        self.each_block(&window, reaches, |block, mut arguments| {
            if is_shorter {
                // The trajectories refer to events after the new end, so none of them is valid.
                arguments.trajectory_of.fill(NONE);
                block.shorten(&window);
            }
            if !block.is_simulated {
                block.simulate(&mut arguments)?;
            }
            Ok(())
        })?;
        interrupt::check()?;
        // From here on all blocks have a history. Only after conflicts are resolved are the
        // trajectories correct: what reads them must come later.
        self.resolve_conflicts(&window, bounds)?;
        self.find_beyond_reach(&window)?;
        self.find_sensed(&window)?;
        self.find_at_walls(&window)?;
        self.digest_shared(&window)?;
        if window.is_last() {
            self.finish(&window);
        }
        self.collect(&window)?;
        Ok(window.end)
    }

    /// Lets the discs that had events in a window continue from there in the next.
    fn carry_over(&self, carried: &mut Carried) -> Result<()> {
        for block in &self.blocks {
            carried.take(&block.history, 0, &self.trajectory_of)?;
        }
        carried.take(&self.again, AGAIN, &self.trajectory_of)
    }

    /// Begins a part of a step of `len` discs: clears its results.
    pub fn begin_part(&mut self, len: usize) -> Result<()> {
        self.counts.clear();
        memory::resize(&mut self.counts, len, 0)?;
        *self.has_too_many.get_mut() = false;
        self.bounced.clear();
        self.sensed.clear();
        self.sensed_near.clear();
        self.at_walls.clear();
        self.exhausted.clear();
        self.collapsed.clear();
        self.beyond_reach.clear();
        self.may_be_beyond_reach.clear();
        self.digests.clear();
        self.may_meet.clear();
        Ok(())
    }

    /// Takes the candidate pairs of a step of `len` discs, a list for each image of a torus.
    pub fn take_pairs(
        &mut self,
        len: usize,
        lists: &[PairList],
        threads: Option<usize>,
    ) -> Result<()> {
        self.size = block::size(len, threads);
        self.is_renewed = false;
        // The images of a step are offsets in float32, so that they are the same numbers in the
        // tests in float32 and in float64.
        let offsets = lists.iter().map(|(image, _)| image.map(f64::from));
        self.neighbors.fill(len, (lists, offsets), self.size, threads)
    }

    /// Makes blocks of all discs.
    fn prepare(&mut self, len: usize) -> Result<()> {
        self.again.clear();
        memory::resize_default(&mut self.blocks, len.div_ceil(self.size))?;
        // All blocks but the last have the same size, so the block of a disc follows from its
        // index.
        let starts = (0..).step_by(self.size);
        for (number, (block, start)) in self.blocks.iter_mut().zip(starts).enumerate() {
            block.begin_window(number, start..(len as u32).min(start + self.size as u32));
        }
        self.trajectory_of.clear();
        memory::resize(&mut self.trajectory_of, len, NONE)
    }

    /// Calls `act` with each block and the arguments to simulate it by itself.
    fn each_block(
        &mut self,
        window: &TimeWindow<'_>,
        reaches: &[f32],
        act: impl Fn(&mut Block, Arguments<'_>) -> Result<()> + Sync + Send,
    ) -> Result<()> {
        // `trajectory_of` is divided into one part for each block, so that no two threads can write to
        // the same part. The borrow checker proves this; no lock is needed.
        let (neighbors, pool, stop) = (&self.neighbors, &self.scratch, Stop::current());
        let blocks = self.blocks.iter_mut().zip(self.trajectory_of.chunks_mut(self.size));
        parallel::try_for_each(window.flight.threads, blocks, |(block, trajectory_of)| {
            // The caller returns an error after an interruption and discards all histories. So
            // blocks that have not begun may be left out.
            if stop.is_set() {
                return Ok(());
            }
            // A pool, and not one scratch for each block: there are many blocks and few threads.
            // The lock is held for a `pop` and a `push` for each block only.
            let mut scratch = locked(pool).pop().unwrap_or_default();
            let (scratch_of, stop) = (&mut scratch, &stop);
            let done = act(
                block,
                Arguments { window, neighbors, trajectory_of, reaches, stop, scratch: scratch_of },
            );
            locked(pool).push(scratch);
            done
        })
    }

    /// The trajectory of a disc.
    fn pieces(&self, window: &TimeWindow<'_>, index: u32) -> Pieces<'_> {
        match self.trajectory(index) {
            None => Pieces::free(window.piece(index), window.end),
            Some((history, trajectory)) => Pieces::of(history, trajectory, window.end),
        }
    }

    /// The trajectory of a disc and its history, if it has one. A disc that was simulated again may have one
    /// without events.
    fn trajectory(&self, index: u32) -> Option<(&History, &Trajectory)> {
        let number = self.trajectory_of[index as usize];
        if number == NONE {
            return None;
        }
        // The highest bit of the number tells in which list the trajectory is. One array for all discs
        // is enough then, and a disc has exactly one valid trajectory.
        let history = match number & AGAIN {
            0 => &self.blocks[index as usize / self.size].history,
            _ => &self.again,
        };
        Some((history, &history.trajectories[(number & !AGAIN) as usize]))
    }

    /// Writes positions, velocities and displacements at the end of the flight.
    fn finish(&mut self, window: &TimeWindow<'_>) {
        let (trajectory_of, again) = (&self.trajectory_of, &self.again);
        let is_moved = window.flight.keeps_starts();
        let turns = !window.flight.spins.is_empty();
        parallel::for_each(window.flight.threads, self.blocks.iter_mut(), |block| {
            // If nothing reads the motions later, each block has already moved its discs while they
            // were in the cache. See `Block::simulate`.
            if !is_moved {
                let range = block.range.start as usize..block.range.end as usize;
                block.move_discs(window, &trajectory_of[range]);
            }
            for index in block.range.clone().filter(|_| turns) {
                if window.starts[index as usize].is_movable {
                    let number = trajectory_of[index as usize];
                    let history = if number & AGAIN != 0 { again } else { &block.history };
                    // `NONE` has the mark, too, and its number is beyond the end of each list.
                    // Then nothing is found, and the disc turns as it did.
                    let found = history.turnings.get((number & !AGAIN) as usize);
                    let turning = found.copied().unwrap_or_else(|| window.turning(index));
                    window.turn(index, &turning);
                }
            }
        });
        for (number, trajectory) in (0..).zip(&again.trajectories) {
            // A disc may have been simulated again several times. Only the trajectory that `trajectory_of`
            // names is valid.
            if trajectory_of[trajectory.index as usize] == AGAIN | number {
                window.move_disc(trajectory.index, &trajectory.piece, trajectory.stopped);
            }
        }
    }

    /// Takes what belongs to valid trajectories.
    fn collect(&mut self, window: &TimeWindow<'_>) -> Result<()> {
        let trajectory_of = &self.trajectory_of;
        let halo = window.flight.halo;
        // Only valid trajectories are counted. Events of histories that were discarded are not a
        // property of the state, and depend on blocks.
        let count = |counts: &mut u32, trajectory: &Trajectory| {
            *counts += trajectory.count;
            // Ghosts do not count: their owner decides about them, so that all processes refuse the
            // same steps.
            if *counts > MAX_COLLISIONS && halo.owns(trajectory.index) {
                // Relaxed: the flag only becomes true, and nothing else is read by its value. The
                // end of the region makes it visible to the caller.
                self.has_too_many.store(true, Ordering::Relaxed);
            }
        };
        let blocks = self.blocks.iter_mut().zip(self.counts.chunks_mut(self.size));
        parallel::try_for_each(window.flight.threads, blocks, |(block, counts)| {
            for (number, trajectory) in (0..).zip(&block.history.trajectories) {
                if trajectory_of[trajectory.index as usize] == number {
                    count(&mut counts[(trajectory.index - block.range.start) as usize], trajectory);
                }
            }
            block.history.retain(0, trajectory_of)
        })?;
        for (number, trajectory) in (0..).zip(&self.again.trajectories) {
            if trajectory_of[trajectory.index as usize] == AGAIN | number {
                count(&mut self.counts[trajectory.index as usize], trajectory);
            }
        }
        self.again.retain(AGAIN, trajectory_of)?;
        // The exhausted discs are sorted when the sub-step ends, and the collapsed ones are only
        // counted. So the order of these lists does not matter.
        for history in self.blocks.iter().map(|block| &block.history).chain([&self.again]) {
            memory::append(&mut self.exhausted, &history.exhausted)?;
            let index = |&number: &u32| history.trajectories[number as usize].index;
            memory::extend(&mut self.collapsed, history.collapsed.iter().map(index))?;
        }
        // Those of one window are sorted, for the most part.
        // Each block has sorted its own bounces in parallel, and blocks have ascending indices. Few
        // bounces belong to discs that were simulated again, so an insertion costs less than a sort
        // of all.
        for block in &self.blocks {
            memory::append(&mut self.bounced, &block.history.bounces)?;
        }
        self.again.bounces.sort_unstable_by(Bounce::order);
        history::insert(&mut self.bounced, &self.again.bounces)
    }
}
