//! The events of a sub-step in the order of time.
//!
//! A sub-step is divided into windows. In a window the discs are divided into blocks, and each block
//! is simulated by itself. Then the trajectories of its discs are tested against the discs of other
//! blocks. If two trajectories meet, the discs whose histories depend on them are simulated again,
//! together. When no test finds anything, every trajectory has been tested against everything that
//! it can reach, so the histories together are correct. It does not depend on blocks or
//! threads, nor on how pairs were found.

mod early;
mod first;
mod flight;
mod friction;
mod history;
mod impulses;
mod neighbors;
mod queue;
mod sensed;
mod simulation;
mod two;

use std::hint::black_box;
use std::ops::Range;
use std::sync::Mutex;

use crate::cache;
use crate::container::{Container, MOST_TOURS};
use crate::error::{Error, Result};
use crate::interrupt::{self, Pulse, Stop};
use crate::parallel::{self, locked};
use crate::particles::Particles;
use crate::trajectory::{Segment, Vector};
pub use flight::Flight;
use flight::{Start, Window};
pub use history::Bounce;
use history::{Course, History, NONE, Part, Trajectory};
use neighbors::Neighbor;
use neighbors::Neighbors;
pub use neighbors::{NearPair, PairList};
use queue::Event;
pub use queue::WALL;
use simulation::{Scratch, Simulation};

/// Discs of a block, at least and at most. In Morton order they are neighbours of each other for
/// the most part. Large blocks have fewer trajectories to test against other blocks.
const BLOCK: Range<usize> = 1024..8192;

/// Blocks for other threads to share, at least, if they are not too small.
const SHARED: usize = 16;

/// Marks courses of discs that were simulated again.
const AGAIN: u32 = 1 << 31;

/// Discs for each first impact in a window, at least.
const DISCS_PER_IMPACT: usize = 3;

/// Fewer discs count as so many.
const FEW: usize = 64;

/// Repetitions in which only discs with conflicts are simulated again. After that, all discs that
/// ever had a conflict are simulated again, so that the repetition ends.
const MOST_ROUNDS: usize = 64;

/// Approximate number of values read to test two trajectories.
const MEETING_WORK: usize = 64;

/// Windows of a sub-step at most, apart from the last of all.
const MOST_WINDOWS: f64 = 1024.0;

/// Where discs may be during a step, and how to find others that may be there too.
pub trait Bounds {
    /// Distances from their positions at the beginning of the step within which discs were
    /// searched for neighbours.
    fn reaches(&self) -> &[f32];
    /// Forgets what was added for the window before.
    fn begin_window(&mut self);
    /// Lets the bounds of discs grow around trajectories in a window that ends at `end`, and appends
    /// the pairs that may meet in them.
    fn grow(
        &mut self,
        outside: &[Outside],
        gravity: Vector,
        end: f64,
        pairs: &mut Vec<NearPair>,
    ) -> Result<()>;
}

/// A disc that leaves its bounds.
#[derive(Clone, Copy, Debug)]
pub struct Outside {
    /// The disc.
    pub index: u32,
    /// How far it gets from its position at the beginning of the step, if it has no further events.
    pub distance: f64,
    /// The segment that it is on.
    pub segment: Segment,
}

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
    /// Discs that had too many events in a window and stand still for the rest of the step.
    pub exhausted: Vec<u32>,
    /// Discs that got further than their limits, and how far, once for each window. Unlike the
    /// growth of bounds they follow from the trajectories alone.
    pub outside_limits: Vec<(u32, f64)>,
    /// Discs whose bounds grew, so that they may belong to these.
    may_be_outside_limits: Vec<u32>,
    starts: Vec<Start>,
    blocks: Vec<Block>,
    /// Discs of each block but the last.
    size: usize,
    /// The number of the course of each disc: in the history of its block, or in that of the discs
    /// that were simulated again, if it has the mark [`AGAIN`].
    course_of: Vec<u32>,
    /// The courses of discs that were simulated again.
    again: History,
    scratch: Mutex<Vec<Scratch>>,
    outside: Vec<Outside>,
    /// Pairs whose trajectories meet, of discs that were not simulated together.
    conflicts: Vec<[u32; 2]>,
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

/// A range of discs that are simulated together.
#[derive(Debug, Default)]
struct Block {
    number: usize,
    range: Range<u32>,
    /// Impacts along the first segments.
    first: Vec<Event>,
    /// The same with discs of other blocks.
    crossing: Vec<Event>,
    history: History,
    is_simulated: bool,
}

/// Arguments of the simulation of a block.
struct Arguments<'a> {
    window: &'a Window<'a>,
    neighbors: &'a Neighbors,
    course_of: &'a mut [u32],
    reaches: &'a [f32],
    stop: &'a Stop,
    scratch: &'a mut Scratch,
}

impl Events {
    /// Moves all discs to the end of the sub-step, window by window.
    pub fn fly(&mut self, flight: &Flight<'_>, bounds: &mut dyn Bounds) -> Result<()> {
        // Windows are not shorter than this, so that there are not too many.
        let shortest = flight.end / MOST_WINDOWS;
        let mut rest = *flight;
        let mut starts = std::mem::take(&mut self.starts);
        loop {
            rest.fill(&mut starts, &self.exhausted);
            let window = Window { flight: &rest, starts: &starts, end: rest.end };
            let end = self.fly_window(window, bounds, shortest)?;
            if end == rest.end {
                self.starts = starts;
                return Ok(());
            }
            rest.end -= end;
            rest.walls.clock.elapsed += end * rest.walls.clock.rate;
            rest.bounded = false;
            rest.is_first = false;
        }
    }

    /// Moves all discs to the end of the window, or of a shorter one, and returns its end.
    fn fly_window(
        &mut self,
        mut window: Window<'_>,
        bounds: &mut dyn Bounds,
        shortest: f64,
    ) -> Result<f64> {
        self.prepare(window.starts.len());
        window.end = end_for_the_fast(&window, shortest)?;
        self.conflicts.clear();
        bounds.begin_window();
        self.neighbors.begin_window();
        self.sensed_near.retain(|near| near.lasts);
        if !window.flight.bounded {
            find_outside_at_start(&window, bounds.reaches(), &mut self.outside);
            self.grow(&window, bounds)?;
        }
        self.find_first_impacts_of_later(&window);
        let (reaches, most) = (bounds.reaches(), window.starts.len().max(FEW) / DISCS_PER_IMPACT);
        self.each_block(&window, reaches, |block, mut arguments| {
            block.load_starts(&arguments);
            let near = &mut arguments.scratch.near;
            block.find_first_impacts(&window, arguments.neighbors, near);
            block.find_first_wall_impacts(&window);
            block.load(&arguments);
            // Most windows are not shortened, and the discs are in the cache now.
            let share = most as u64 * block.range.len() as u64 / window.starts.len() as u64;
            if block.impacts_until(window.end) as u64 <= share {
                block.simulate(&mut arguments);
            }
        });
        interrupt::check()?;
        let end = self.end_of_window(&window, shortest, most);
        let is_shorter = end < window.end;
        window.end = end;
        self.each_block(&window, reaches, |block, mut arguments| {
            if is_shorter {
                block.history.clear();
                block.is_simulated = false;
                arguments.course_of.fill(NONE);
                block.shorten(&window, arguments.neighbors);
            }
            if !block.is_simulated {
                block.simulate(&mut arguments);
            }
        });
        interrupt::check()?;
        self.find_crossing(&window);
        self.find_meeting(&window);
        interrupt::check()?;
        self.outside.clear();
        self.outside.extend(self.blocks.iter().flat_map(|block| &block.history.outside));
        self.grow(&window, bounds)?;
        self.find_meeting_new(&window)?;
        let mut rounds = 0;
        while !self.conflicts.is_empty() {
            rounds += 1;
            self.simulate_again(&window, rounds > MOST_ROUNDS, bounds)?;
            interrupt::check()?;
        }
        self.find_outside_limits(&window);
        self.find_sensed(&window);
        self.finish(&window);
        Ok(window.end)
    }

    /// Begins a step: clears its results.
    pub fn begin_step(&mut self) {
        self.bounced.clear();
        self.sensed.clear();
        self.sensed_near.clear();
        self.exhausted.clear();
        self.outside_limits.clear();
        self.may_be_outside_limits.clear();
    }

    /// Lists the discs that get further than their limits in the window.
    fn find_outside_limits(&mut self, window: &Window<'_>) {
        let mut listed = std::mem::take(&mut self.may_be_outside_limits);
        listed.sort_unstable();
        listed.dedup();
        for &index in &listed {
            let squares = self.trajectory(window, index);
            let squares = squares.map(|part| window.longest_square(index, &part.segment));
            let distance = squares.fold(0.0, f64::max).sqrt();
            if distance > f64::from(window.flight.limits[index as usize]) {
                self.outside_limits.push((index, distance));
            }
        }
        self.may_be_outside_limits = listed;
    }

    /// Takes the candidate pairs of a step of `len` discs, a list for each image of a torus.
    pub fn take_pairs(&mut self, len: usize, lists: &[PairList], threads: Option<usize>) {
        let least = if parallel::is_parallel(threads) { SHARED } else { 1 };
        self.size = len.div_ceil(least).clamp(BLOCK.start, BLOCK.end).next_power_of_two();
        self.neighbors.fill(len, lists, self.size, threads);
    }

    /// Makes blocks of all discs.
    fn prepare(&mut self, len: usize) {
        self.again.clear();
        self.blocks.resize_with(len.div_ceil(self.size), Block::default);
        let starts = (0..).step_by(self.size);
        for (number, (block, start)) in self.blocks.iter_mut().zip(starts).enumerate() {
            block.number = number;
            block.range = start..(len as u32).min(start + self.size as u32);
            block.first.clear();
            block.crossing.clear();
            block.history.clear();
            block.is_simulated = false;
        }
        self.course_of.clear();
        self.course_of.resize(len, NONE);
    }

    /// The longest of `end`, `end`/2, `end`/4 … before which at most `most` first impacts happen,
    /// but not less than `shortest`. Impacts at the start are in every window, so they do not count. The result depends on the state alone.
    fn end_of_window(&self, window: &Window<'_>, shortest: f64, most: usize) -> f64 {
        if !window.flight.pairs {
            return window.end;
        }
        let mut end = window.end;
        while 0.5 * end >= shortest {
            let early = self.blocks.iter().map(|block| block.impacts_until(end)).sum::<usize>();
            if early <= most {
                break;
            }
            end *= 0.5;
        }
        end
    }

    /// Calls `act` with each block and the arguments to simulate it by itself.
    fn each_block(
        &mut self,
        window: &Window<'_>,
        reaches: &[f32],
        act: impl Fn(&mut Block, Arguments<'_>) + Sync + Send,
    ) {
        let (neighbors, pool, stop) = (&self.neighbors, &self.scratch, Stop::current());
        let blocks = self.blocks.iter_mut().zip(self.course_of.chunks_mut(self.size));
        parallel::for_each(window.flight.threads, blocks, |(block, course_of)| {
            if stop.is_set() {
                return;
            }
            let mut scratch = locked(pool).pop().unwrap_or_default();
            let (scratch_of, stop) = (&mut scratch, &stop);
            act(
                block,
                Arguments { window, neighbors, course_of, reaches, stop, scratch: scratch_of },
            );
            locked(pool).push(scratch);
        });
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
            reaches: bounds.reaches(),
            history: &mut self.again,
            mark: AGAIN,
            base,
            stop: &stop,
            scratch: &mut scratch,
        };
        simulation.run(&[], &self.discs);
        locked(&self.scratch).push(scratch);
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

    /// Loads the first segments of the discs that are simulated again, and of their neighbours, into
    /// the cache. They are far from each other in memory, and the processor waits for many of these
    /// reads at once.
    fn load_near(&self, window: &Window<'_>) {
        for &disc in &self.discs {
            let near = self.neighbors.at_start(disc).iter().map(|neighbor| neighbor.index);
            near.chain([disc])
                .for_each(|index| _ = black_box(window.starts[index as usize].radius));
        }
    }

    /// Removes the courses of the discs of the conflicts, and of all that depend on theirs, and
    /// lists these discs.
    fn reopen(&mut self, window: &Window<'_>, all: bool) {
        let Self { course_of, blocks, again, size, conflicts, discs, .. } = self;
        discs.clear();
        let had_conflicts = if all { &again.courses[..] } else { &[] };
        let reopened: Vec<u32> = had_conflicts.iter().map(|course| course.index).collect();
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
        conflicts.iter().flatten().chain(&reopened).for_each(|&index| reopen(index));
        discs.retain(|&index| window.starts[index as usize].is_movable);
        discs.sort_unstable();
        discs.dedup();
    }

    /// The trajectory of a disc.
    fn trajectory(&self, window: &Window<'_>, index: u32) -> Trajectory<'_> {
        let number = self.course_of[index as usize];
        if number == NONE {
            return Trajectory::free(window.segment(index), window.end);
        }
        let history = match number & AGAIN {
            0 => &self.blocks[index as usize / self.size].history,
            _ => &self.again,
        };
        Trajectory::of(history, &history.courses[(number & !AGAIN) as usize], window.end)
    }

    /// Whether the trajectories of two discs meet, or touch as one of the two collides; the times
    /// of impact of the first segments are tested only if `first` says so.
    fn meet(&self, window: &Window<'_>, [a, b]: [u32; 2], image: Vector, first: bool) -> bool {
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
            until < window.end && window.touch_now((a, &p), (b, &q), image)
        })
    }

    /// Whether `test` is true for segments of two discs at the same time.
    fn any_at_once(
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

    /// Adds the neighbours that the discs outside their bounds have in larger bounds.
    fn grow(&mut self, window: &Window<'_>, bounds: &mut dyn Bounds) -> Result<()> {
        self.new.clear();
        if self.outside.is_empty() || !(window.flight.pairs || window.flight.senses_all) {
            return Ok(());
        }
        if !window.flight.limits.is_empty() {
            self.may_be_outside_limits.extend(self.outside.iter().map(|outside| outside.index));
        }
        self.near.clear();
        bounds.grow(&self.outside, window.gravity(), window.end, &mut self.near)?;
        self.take_sensed(window);
        self.neighbors.add(&self.near, &mut self.new);
        Ok(())
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

    /// Writes positions, velocities and displacements at the end of the window.
    fn finish(&mut self, window: &Window<'_>) {
        let (course_of, again) = (&self.course_of, &self.again);
        let is_moved = window.flight.keeps_starts();
        let turns = !window.flight.spins.is_empty();
        parallel::for_each(window.flight.threads, self.blocks.iter_mut(), |block| {
            if !is_moved {
                let range = block.range.start as usize..block.range.end as usize;
                block.move_discs(window, &course_of[range]);
            }
            for index in block.range.clone().filter(|_| turns) {
                if window.starts[index as usize].is_movable {
                    let number = course_of[index as usize];
                    let history = if number & AGAIN != 0 { again } else { &block.history };
                    let found = history.turnings.get((number & !AGAIN) as usize);
                    let turning = found.copied().unwrap_or_else(|| window.turning(index));
                    window.turn(index, &turning);
                }
            }
            block.history.retain(0, course_of);
        });
        for (number, course) in (0..).zip(&again.courses) {
            if course_of[course.index as usize] == AGAIN | number {
                window.move_disc(course.index, &course.segment, course.stopped);
            }
        }
        self.again.retain(AGAIN, &self.course_of);
        for history in self.blocks.iter().map(|block| &block.history).chain([&self.again]) {
            self.exhausted.extend(&history.exhausted);
        }
        // Those of one window are sorted, for the most part.
        self.blocks.iter().for_each(|block| self.bounced.extend(&block.history.bounces));
        self.again.bounces.sort_unstable_by(Bounce::order);
        history::insert(&mut self.bounced, &self.again.bounces);
    }
}

impl Block {
    /// Predicts the impacts of a shorter window again: what is too slow to matter depends on its
    /// end.
    fn shorten(&mut self, window: &Window<'_>, neighbors: &Neighbors) {
        for events in [&mut self.first, &mut self.crossing] {
            events.retain_mut(|event| {
                let Event { time, pair: [a, b], code, .. } = *event;
                if time > window.end {
                    return false;
                }
                let new = if b == WALL {
                    window.wall_event(a, &window.segment(a), 0)
                } else {
                    let [p, q] = [a, b].map(|disc| window.segment(disc));
                    let impact =
                        window.impact((a, &p), (b, &q), neighbors.image_of(code), window.end);
                    impact.map(|impact| Event::of_discs(impact, [a, b], code, [0; 2]))
                };
                new.is_some_and(|new| {
                    *event = new;
                    true
                })
            });
        }
    }

    fn load_starts(&self, arguments: &Arguments<'_>) {
        let range = self.range.start as usize..self.range.end as usize;
        cache::load(&arguments.window.starts[range]);
    }

    /// Loads into the cache what events need of a few discs each, in the order of time.
    fn load(&self, arguments: &Arguments<'_>) {
        let range = self.range.start as usize..self.range.end as usize;
        let Particles { positions, residuals, .. } = arguments.window.flight.particles;
        arguments.neighbors.load(self.number);
        cache::load(&positions[range.clone()]);
        cache::load(&residuals[range.clone()]);
        cache::load(&arguments.reaches[range]);
    }

    /// Finds the impacts on walls along the first segments.
    fn find_first_wall_impacts(&mut self, window: &Window<'_>) {
        let start = |index: u32| &window.starts[index as usize];
        let Flight { container, walls, .. } = window.flight;
        if walls.is_empty() && !container.has_walls() {
            return;
        }
        for index in self.range.clone() {
            let may_hit = !walls.is_empty() && window.may_hit_walls(index);
            if may_hit || window.may_hit_container(start(index)) {
                self.first.extend(window.wall_event(index, &window.segment(index), 0));
            }
        }
    }

    /// Simulates the events of the block by itself.
    fn simulate(&mut self, arguments: &mut Arguments<'_>) {
        self.is_simulated = true;
        let Arguments { window, neighbors, course_of, reaches, stop, scratch } = arguments;
        let (range, history) = (self.range.clone(), &mut self.history);
        let (mark, base) = (0, 0);
        let simulation = Simulation {
            window,
            neighbors,
            range,
            course_of,
            reaches,
            history,
            mark,
            base,
            stop,
            scratch,
        };
        simulation.run(&self.first, &[]);
        self.history.bounces.sort_unstable_by(Bounce::order);
        if window.flight.keeps_starts() {
            // The discs are in the cache now. Those that are simulated again are moved again.
            self.move_discs(window, course_of);
        }
    }

    /// Moves the discs of the block to the end of the window, by its own history.
    fn move_discs(&self, window: &Window<'_>, course_of: &[u32]) {
        for (index, &number) in self.range.clone().zip(course_of) {
            match self.history.courses.get(number as usize) {
                Some(course) => window.move_disc(index, &course.segment, course.stopped),
                None if window.starts[index as usize].is_movable => {
                    window.move_disc(index, &window.segment(index), None);
                }
                None => window.carry(index),
            }
        }
    }

    /// The number of impacts after the start, until `end`.
    fn impacts_until(&self, end: f64) -> usize {
        let is_counted = |event: &&Event| event.time > 0.0 && event.time <= end;
        self.first.iter().chain(&self.crossing).filter(is_counted).count()
    }
}

/// Lists the discs whose first segment leaves their bounds.
fn find_outside_at_start(window: &Window<'_>, reaches: &[f32], outside: &mut Vec<Outside>) {
    let moves = |start: &Start| start.is_movable || start.velocity != [0.0; 2];
    let moving = (0..).zip(window.starts).filter(|(_, start)| moves(start));
    let all = moving.map(|(index, _)| {
        let segment = window.segment(index);
        let distance = window.longest_square(index, &segment).sqrt();
        Outside { index, distance, segment }
    });
    outside.clear();
    outside.extend(all.filter(|disc| disc.distance > f64::from(reaches[disc.index as usize])));
}

/// The longest of `end`, `end`/2, `end`/4 … before which no disc travels further than around a torus,
/// but not less than `shortest`. Refuses a sub-step in which forces make one too fast.
fn end_for_the_fast(window: &Window<'_>, shortest: f64) -> Result<f64> {
    let container = &window.flight.container;
    if !matches!(container, Container::Torus { .. }) {
        return Ok(window.end);
    }
    let speed = |start: &Start| start.velocity.map(f32::abs).into_iter().sum::<f32>();
    let fastest = window.starts.iter().map(speed).fold(0.0, f32::max);
    let tours = |seconds: f64| container.tours(fastest * seconds as f32);
    if tours(window.end) > 2.0 * MOST_TOURS {
        let rule = "forces would make a particle circle the torus too often; take smaller steps";
        return Err(Error::of("dt", format!("{} s in a sub-step", window.end), rule));
    }
    let mut end = window.end;
    while 0.5 * end >= shortest && tours(end) > 1.0 {
        end *= 0.5;
    }
    Ok(end)
}
