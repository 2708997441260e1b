//! Trajectories of discs that were simulated apart and meet: these discs are simulated again, together.
//!
//! This is optimistic synchronisation of a parallel simulation of discrete events, with rollback
//! (D. R. Jefferson, *Virtual Time*, ACM Transactions on Programming Languages and Systems 7, 1985).

use std::hint::black_box;

use super::Events;
use super::block::Block;
use super::bounds::Bounds;
use super::flight::Window;
use super::history::{Course, NONE, Part};
use super::simulation::Simulation;
use crate::trajectory::Vector;
use jostle_base::error::Result;
use jostle_base::interrupt::{self, Pulse, Stop};
use jostle_base::parallel::{self, locked};

/// Marks courses of discs that were simulated again.
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
        window: &Window<'_>,
        bounds: &mut dyn Bounds,
    ) -> Result<()> {
        self.conflicts.clear();
        self.had_conflicts.clear();
        self.find_crossing(window);
        self.find_meeting(window);
        interrupt::check()?;
        self.outside.clear();
        self.outside.extend(self.blocks.iter().flat_map(|block| &block.history.outside));
        self.grow(window, bounds)?;
        self.find_meeting_new(window)?;
        let mut rounds = 0;
        while !self.conflicts.is_empty() {
            rounds += 1;
            self.simulate_again(window, rounds > MAX_ROUNDS, bounds)?;
            interrupt::check()?;
        }
        Ok(())
    }

    /// Appends the pairs of different blocks that meet along their first segments to the conflicts.
    fn find_crossing(&mut self, window: &Window<'_>) {
        let all = self.blocks.iter().flat_map(|block| &block.crossing);
        let in_window = all.filter(|event| event.time <= window.end);
        self.conflicts.extend(in_window.map(|event| event.pair));
    }

    /// Appends the pairs of different blocks whose trajectories meet after an event to the
    /// conflicts.
    fn find_meeting(&mut self, window: &Window<'_>) {
        if !window.flight.pairs || self.blocks.len() < 2 {
            return;
        }
        let stop = Stop::current();
        let mut found = std::mem::take(&mut self.found);
        found.resize_with(self.blocks.len(), Vec::new);
        let blocks = found.iter_mut().zip(&self.blocks);
        parallel::for_each(window.flight.threads, blocks, |(found, block)| {
            found.clear();
            let Block { number, range, .. } = block;
            if stop.is_set() {
                return;
            }
            self.neighbors.each_across(*number, range, |own, neighbor| {
                if self.course_of[own as usize] == NONE
                    || !window.starts[neighbor.index as usize].is_movable
                {
                    return;
                }
                let (pair, image) = ([own, neighbor.index], self.neighbors.image(&neighbor));
                if self.meet(window, pair, image, false) {
                    found.push(pair);
                }
            });
        });
        self.conflicts.extend(found.iter().flatten());
        self.found = found;
    }

    /// Simulates the discs of the conflicts again, with all whose histories depend on theirs. The
    /// pairs of these discs and others whose trajectories meet are the new conflicts.
    fn simulate_again(
        &mut self,
        window: &Window<'_>,
        all: bool,
        bounds: &mut dyn Bounds,
    ) -> Result<()> {
        self.reopen(window, all);
        self.load_near(window);
        let stop = Stop::current();
        let mut scratch = locked(&self.scratch).pop().unwrap_or_default();
        let base = self.again.courses.len() as u32;
        let simulation = Simulation {
            window,
            neighbors: &self.neighbors,
            range: 0..window.starts.len() as u32,
            course_of: &mut self.course_of,
            max_displacements: bounds.max_displacements(),
            history: &mut self.again,
            mark: AGAIN,
            base,
            stop: &stop,
            scratch: &mut scratch,
        };
        simulation.run(&[], &self.discs);
        locked(&self.scratch).push(scratch);
        self.connect_conflicts();
        let mut found = std::mem::take(&mut self.conflicts);
        found.clear();
        for Course { index, .. } in &self.again.courses[base as usize..] {
            self.neighbors.of(*index, |neighbor| {
                let number = self.course_of[neighbor.index as usize];
                let is_new = number & AGAIN != 0 && number & !AGAIN >= base;
                let pair = [*index, neighbor.index];
                let image = self.neighbors.image(neighbor);
                if number != NONE && !is_new && self.meet(window, pair, image, true) {
                    found.push(pair);
                }
            });
        }
        self.conflicts = found;
        self.outside.clear();
        self.outside.append(&mut self.again.outside);
        self.grow(window, bounds)?;
        self.find_meeting_new(window)
    }

    /// Makes one island of the discs of each conflict of the window, so that they are simulated
    /// together in all later repetitions, also if they do not collide. Without this, a disc that has
    /// conflicts with two others could be simulated again with each of them in turn, without end.
    fn connect_conflicts(&mut self) {
        let Self { had_conflicts, conflicts, course_of, again, .. } = self;
        had_conflicts.append(conflicts);
        for pair in had_conflicts {
            let courses = pair.map(|disc| course_of[disc as usize]);
            if courses.iter().all(|&course| course != NONE && course & AGAIN != 0) {
                let [a, b] = courses.map(|course| course & !AGAIN);
                again.connect(a, b);
            }
        }
    }

    /// Loads the first segments of the discs that are simulated again, and of their neighbours, into
    /// the cache. They are far from each other in memory, and the processor waits for many of these
    /// reads at once.
    fn load_near(&self, window: &Window<'_>) {
        for &disc in &self.discs {
            let near = self.neighbors.at_start(disc).iter().map(|neighbor| neighbor.index);
            near.chain([disc]).for_each(|index| _ = black_box(window.now[index as usize].radius));
        }
    }

    /// Removes the courses of the discs of the conflicts, and of all that depend on theirs, and
    /// lists these discs. If these are more than half of the discs with events, or if `all` is true,
    /// the other discs with events are added: one repetition for all costs less than several for
    /// nearly all.
    fn reopen(&mut self, window: &Window<'_>, all: bool) {
        let with_events =
            self.blocks.iter().map(|block| block.history.courses.len()).sum::<usize>();
        let conflicts = std::mem::take(&mut self.conflicts);
        self.discs.clear();
        self.reopen_islands(conflicts.iter().flatten().copied());
        self.conflicts = conflicts;
        self.sort_discs(window);
        if all || self.discs.len() > with_events / 2 {
            for index in 0..self.course_of.len() as u32 {
                if self.course_of[index as usize] != NONE {
                    self.reopen_islands([index].into_iter());
                }
            }
            self.sort_discs(window);
        }
    }

    /// Lists each movable disc that is simulated again once, in ascending order.
    fn sort_discs(&mut self, window: &Window<'_>) {
        self.discs.retain(|&index| window.starts[index as usize].is_movable);
        self.discs.sort_unstable();
        self.discs.dedup();
    }

    /// Removes the courses of some discs and of all that depend on theirs, and appends these discs to
    /// the list.
    fn reopen_islands(&mut self, indices: impl Iterator<Item = u32>) {
        let Self { course_of, blocks, again, size, discs, .. } = self;
        let mut reopen = |index: u32| {
            let (history, mark) = match course_of[index as usize] {
                NONE => return discs.push(index),
                number if number & AGAIN != 0 => (&mut *again, AGAIN),
                _ => (&mut blocks[index as usize / *size].history, 0),
            };
            history.has_removed = true;
            history.each_of_island(course_of[index as usize] & !AGAIN, |number| {
                let member = history.courses[number as usize].index;
                let course = &mut course_of[member as usize];
                if *course == mark | number {
                    *course = NONE;
                    discs.push(member);
                }
            });
        };
        indices.for_each(&mut reopen);
    }

    /// Whether the trajectories of two discs meet, or touch as one of the two collides; the times
    /// of impact of the first segments are tested only if `first` says so.
    fn meet(&self, window: &Window<'_>, [a, b]: [u32; 2], image: Vector, first: bool) -> bool {
        let is_joint = |index| match self.course(index) {
            Some((_, course)) => course.is_joint,
            None => window.was_exhausted(index),
        };
        let all = is_joint(a) || is_joint(b);
        self.any_at_once(window, [a, b], |own, other| {
            let until = own.end.min(other.end);
            let start = own.segment.time.max(other.segment.time);
            // Straight segments without duration, between collisions at the same time, only
            // touch.
            let is_new = first || !own.is_first || !other.is_first;
            // A disc that falls may be pressed against one that does not, which is no touch.
            let is_curved = own.segment.falls != other.segment.falls;
            let is_tested = is_new && (start < until || is_curved);
            let both = ((a, &own.segment), (b, &other.segment));
            if is_tested && window.impact(both.0, both.1, image, until).is_some() {
                return true;
            }
            // Simultaneous contacts are solved together.
            let [p, q] = [own.segment, other.segment].map(|s| s.moved(until, window.gravity()));
            let ends_with_event = |part: &Part| part.end == until && !part.is_last;
            let is_event = ends_with_event(own) || ends_with_event(other);
            is_event && window.touch_now((a, &p), (b, &q), image, || all)
        })
    }

    /// Whether `test` is true for segments of two discs at the same time.
    pub(super) fn any_at_once(
        &self,
        window: &Window<'_>,
        [a, b]: [u32; 2],
        test: impl Fn(&Part, &Part) -> bool,
    ) -> bool {
        let mut others = self.trajectory(window, b);
        self.trajectory(window, a).any(|own| {
            // Both are in the order of time, the last segment first.
            others.skip_after(own.end);
            let mut at_the_time = others.clone().take_while(|other| other.end >= own.segment.time);
            at_the_time.any(|other| test(&own, &other))
        })
    }

    /// Appends the new neighbours whose trajectories meet to the conflicts.
    fn find_meeting_new(&mut self, window: &Window<'_>) -> Result<()> {
        let mut conflicts = std::mem::take(&mut self.conflicts);
        let mut pulse = Pulse::current();
        for (a, neighbor) in &self.new {
            pulse.check(MEETING_WORK)?;
            let pair = [*a, neighbor.index];
            if self.meet(window, pair, self.neighbors.image(neighbor), true) {
                conflicts.push(pair);
            }
        }
        self.conflicts = conflicts;
        Ok(())
    }
}
