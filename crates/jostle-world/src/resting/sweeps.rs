//! The iterations over all resting contacts, colour after colour. Several threads take a part of each colour
//! and wait for each other before the next.

use std::ops::Range;
use std::sync::Mutex;

use super::pairs::{Pass, Phase, Sweep};
use super::walls::OnWalls;
use super::{Support, sum};
use crate::contacts::{self, Block, Blocks};
use crate::flow::Kick;
use crate::forces::springs::{Place, Push, Pushes, SpringSolver};
use crate::motion::{Scalars, Vectors};
use jostle_base::error::Result;
use jostle_base::interrupt::Stop;
use jostle_base::memory;
use jostle_base::parallel::{self, Member, locked};

/// Iterations in a sub-step. The number is fixed, so it does not depend on particles far away.
/// `docs/benchmarks-notes.md` has speed and overlap of piles with other numbers.
const ITERATIONS: usize = 10;

/// Further iterations after each but the last, over the contacts of particles that have contacts of
/// uneven masses. With the ratio q of masses, the number that is needed grows with √q. Piles with
/// masses 100:1 overlap by 2.8 % with 3, 1.4 % with 6 and 0.7 % with 12; the times are 1, 1.04 and
/// 1.22 (`docs/benchmarks-notes.md`).
const UNEVEN_ITERATIONS: usize = 6;

/// Iterations of the impacts at the beginning of a sub-step.
const IMPACT_ITERATIONS: usize = 4;

/// Blocks, and particles with wall contacts, that a thread takes at a time.
const BLOCKS: usize = 16;
const WALLS: usize = 64;

/// The contacts of an iteration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Which {
    All,
    /// Those of particles that have contacts of uneven masses.
    Uneven,
}

/// A part of the iterations. All threads wait for each other after it; in a part with the contacts of
/// particles they also wait after each colour.
#[derive(Clone, Copy, Debug)]
enum Task {
    Contacts(Pass, Which),
    Walls(Pass, Which),
    /// A turn of the springs of bodies that are held.
    Springs(Pass),
    /// Gravity and forces are added to the velocities after the impacts.
    Accelerate,
}

/// What the iterations need.
pub struct Sweeps<'a> {
    pub all: State<'a>,
    /// The contacts of two particles.
    pub pairs: &'a mut Blocks,
    /// The particles with wall contacts. Those with contacts of uneven masses come first.
    pub walls: &'a mut [OnWalls],
    pub uneven_walls: usize,
    /// Springs that are solved together with the contacts.
    pub springs: Option<&'a mut SpringSolver>,
    /// Whether particles touch and approach too fast to rest.
    pub has_fast: bool,
    /// Scratch: what there is to do in each colour, on any process.
    pub work: &'a mut Vec<u8>,
}

impl Sweeps<'_> {
    /// Finds the impulses, and the velocities with them. Returns whether there were impacts.
    pub fn run(mut self) -> Result<bool> {
        let Support { threads, halo, .. } = *self.all.scene;
        // Several threads of one process need no list of work: they pass empty blocks quickly.
        // Processes need it, because each colour with work costs a message.
        let has_fast = self.has_fast || self.walls.iter().any(OnWalls::is_fast);
        if halo.is_alone() && parallel::is_parallel(threads) {
            return self.run_together(has_fast);
        }
        self.list_work(has_fast)?;
        halo.any_bits(self.work)?;
        self.run_on_one()
    }

    /// Lists whether there are fast contacts, and for each colour a bit if any contacts rest, and one
    /// if any of uneven masses do.
    fn list_work(&mut self, has_fast: bool) -> Result<()> {
        let any = |blocks: &[Block]| u8::from(blocks.iter().any(|block| block.resting > 0));
        // The list is combined over all processes. All of them must make the same steps, or one
        // would wait for a message that another does not send.
        self.work.clear();
        memory::push(self.work, u8::from(has_fast))?;
        let Blocks { list, colours } = &*self.pairs;
        let any = |of: &contacts::Colour| any(&list[of.all()]) | any(&list[of.uneven()]) << 1;
        memory::extend(self.work, colours.iter().map(any))
    }

    /// The tasks in their order. It is the same on all threads and processes, because each correction
    /// uses the velocities that those before it have left.
    fn each_task(
        [has_fast, has_uneven, has_springs]: [bool; 3],
        mut act: impl FnMut(Task) -> Result<()>,
    ) -> Result<()> {
        use Task::{Accelerate, Contacts};
        use Which::{All, Uneven};
        if has_fast {
            for _ in 0..IMPACT_ITERATIONS {
                act(Task::Walls(Pass::Impact, All))?;
                act(Contacts(Pass::Impact, All))?;
            }
        }
        // Impacts are those of the velocities with which the sub-step begins. Gravity and forces act
        // after them, so that a disc that only bounces still falls in the sub-step.
        act(Accelerate)?;
        let further = if has_uneven { UNEVEN_ITERATIONS } else { 0 };
        let mut iterate = |pass, which| {
            if has_springs && which == All && pass != Pass::Start {
                act(Task::Springs(pass))?;
            }
            act(Contacts(pass, which))?;
            // Walls come last, so that no disc leaves the last iteration with a velocity into a wall: walls
            // cannot yield, and another disc can.
            act(Task::Walls(pass, which))?;
            if has_springs && pass == Pass::Start { act(Task::Springs(pass)) } else { Ok(()) }
        };
        // All impulses of the sub-step before, before any is corrected: the corrections are small then.
        iterate(Pass::Start, All)?;
        // A fixed number: a test for convergence would need a maximum over all contacts, and make
        // the result depend on particles far away. With 7 instead of 10, a pile of 4,000 discs
        // moves at 0.69 instead of 0.45 px/s (`docs/benchmarks-notes.md`).
        for _ in 1..ITERATIONS {
            iterate(Pass::Relaxed, All)?;
            for _ in 0..further {
                iterate(Pass::Relaxed, Uneven)?;
            }
        }
        // Over-relaxation makes each correction too large. The last pass is without it, so that a
        // contact that shares no particle with others ends exact.
        iterate(Pass::Exact, All)
    }

    /// Solves all contacts on this thread, together with other processes.
    fn run_on_one(self) -> Result<bool> {
        let Self { all, pairs, walls, uneven_walls, mut springs, .. } = self;
        let Blocks { list: blocks, colours } = pairs;
        let (&has_fast, work) = self.work.split_first().unwrap_or((&0, &[]));
        let State { scene, .. } = all;
        let has_springs = springs.is_some();
        let (stop, shape) = (Stop::current(), scene.shape);
        // Whether the velocities of ghosts are those of their own processes. They are refreshed only before a colour
        // or `Accelerate` reads them. A contact with a wall reads no other particle.
        let mut is_current = true;
        let mut act = |task| {
            // Other processes would wait for one that is interrupted here.
            if scene.halo.is_alone() {
                stop.check()?;
            }
            match task {
                Task::Contacts(pass, which) => {
                    let bit = if which == Which::All { 1 } else { 2 };
                    // Another process may have more colours.
                    for number in 0..shape.stages() {
                        if work.get(number).is_none_or(|work| work & bit == 0) {
                            continue;
                        }
                        // A colour may read any ghost, and after it the ghosts are no longer
                        // current.
                        if !std::mem::replace(&mut is_current, false) {
                            all.refresh()?;
                        }
                        if let Some(colour) = colours.get(number) {
                            let is_all = which == Which::All;
                            let range = if is_all { colour.all() } else { colour.uneven() };
                            all.sweep(&mut blocks[range], pass);
                        }
                    }
                    Ok(())
                }
                Task::Walls(pass, which) => {
                    let count = if which == Which::All { walls.len() } else { uneven_walls };
                    all.solve_walls(&mut walls[..count], pass);
                    is_current = false;
                    Ok(())
                }
                Task::Springs(pass) => {
                    if let Some(springs) = &mut springs {
                        let pushes = &mut Alone { blocks: &mut blocks[..], walls: &mut *walls };
                        springs.take_turn(all.velocities, pushes, pass == Pass::Start);
                    }
                    Ok(())
                }
                Task::Accelerate => {
                    if !std::mem::replace(&mut is_current, true) {
                        all.refresh()?;
                    }
                    all.accelerate(0..scene.particles.len(), has_fast > 0);
                    Ok(())
                }
            }
        };
        Self::each_task([has_fast > 0, shape.has_uneven, has_springs], &mut act)?;
        all.refresh()?;
        Ok(has_fast > 0)
    }

    /// Solves all contacts on this thread and on others.
    fn run_together(self, has_fast: bool) -> Result<bool> {
        let stop = Stop::current();
        let Self { all, pairs, walls, uneven_walls, springs, .. } = self;
        let State { scene, .. } = all;
        let traits = [has_fast, scene.shape.has_uneven, springs.is_some()];
        let springs = Mutex::new(springs);
        let (mut parts, mut colours) = (Vec::new(), Vec::new());
        let mut of_block = Vec::new();
        let mut rest = &mut pairs.list[..];
        for colour in &pairs.colours {
            let first = parts.len();
            let uneven = colour.uneven().len();
            // Blocks are cut into parts of sixteen with a lock each. Within a colour each part is
            // solved by one thread, so the lock never waits; it proves to the compiler that access
            // is exclusive.
            let mut cut = |blocks: usize| {
                let own = rest.split_off_mut(..blocks).unwrap_or_default();
                for blocks in own.chunks_mut(BLOCKS) {
                    if traits[2] {
                        memory::extend(
                            &mut of_block,
                            (0..blocks.len()).map(|at| [parts.len(), at]),
                        )?;
                    }
                    memory::push(&mut parts, Mutex::new(blocks))?;
                }
                Ok(parts.len())
            };
            let uneven_end = cut(uneven)?;
            let end = cut(colour.all().len() - uneven)?;
            colours.push(Colour { first, uneven_end, end, is_serial: colour.is_serial });
        }
        let walls = memory::collect(walls.chunks_mut(WALLS).map(Mutex::new))?;
        // After an interruption there is no more work, but all threads still wait for each other.
        let run = |member: &Member<'_>, task| match task {
            Task::Contacts(pass, which) => {
                for colour in &colours {
                    // Each thread has the same parts of a colour in each iteration over all
                    // contacts, so its blocks may stay in its cache.
                    let own = if stop.is_set() { 0..0 } else { colour.share(member, which) };
                    for part in &parts[own] {
                        all.sweep(&mut locked(part), pass);
                    }
                    member.wait();
                }
            }
            Task::Walls(pass, which) => {
                let count = if which == Which::All { usize::MAX } else { uneven_walls };
                for part in member.share(walls.len()) {
                    let walls = &mut *locked(&walls[part]);
                    let count = count.saturating_sub(part * WALLS).min(walls.len());
                    all.solve_walls(&mut walls[..count], pass);
                }
                member.wait();
            }
            Task::Springs(pass) => {
                // Bodies of springs are coupled by one system of equations, so one thread solves
                // them and the others wait.
                if member.is_first()
                    && let Some(springs) = &mut *locked(&springs)
                {
                    let pushes =
                        &mut Together { parts: &parts, of_block: &of_block, walls: &walls };
                    springs.take_turn(all.velocities, pushes, pass == Pass::Start);
                }
                member.wait();
            }
            Task::Accelerate => {
                all.accelerate(member.share(scene.particles.len()), has_fast);
                member.wait();
            }
        };
        // More threads than parts of the longest colour would only wait.
        let most = colours.iter().map(|colour| colour.end - colour.first).max().unwrap_or(1);
        parallel::together(scene.threads, most, |member| {
            let act = |task| {
                run(member, task);
                Ok(())
            };
            let _ = Self::each_task(traits, act);
        });
        stop.check()?;
        Ok(has_fast)
    }
}

/// Blocks, and particles at walls, of one thread, as springs see them.
struct Alone<'a> {
    blocks: &'a mut [Block],
    walls: &'a mut [OnWalls],
}

impl Pushes for Alone<'_> {
    fn get(&self, place: Place) -> Push {
        match place {
            Place::Pair { block, lane } => self.blocks[block as usize].push(lane as usize),
            Place::Wall { particle, contact } => {
                self.walls[particle as usize].push(contact as usize).unwrap_or_default()
            }
        }
    }

    fn set(&mut self, place: Place, impulse: f32) {
        match place {
            Place::Pair { block, lane } => {
                self.blocks[block as usize].impulses[Phase::Rest as usize][lane as usize] = impulse;
            }
            Place::Wall { particle, contact } => {
                self.walls[particle as usize].set_push(contact as usize, impulse);
            }
        }
    }
}

/// Impulses of contacts that several threads share, each part behind a lock.
struct Together<'a, 'b, 'w> {
    parts: &'a [Mutex<&'b mut [Block]>],
    /// The part of each block, and its number there.
    of_block: &'a [[usize; 2]],
    walls: &'a [Mutex<&'w mut [OnWalls]>],
}

impl Pushes for Together<'_, '_, '_> {
    fn get(&self, place: Place) -> Push {
        match place {
            Place::Pair { block, lane } => {
                let [part, at] = self.of_block[block as usize];
                locked(&self.parts[part])[at].push(lane as usize)
            }
            Place::Wall { particle, contact } => {
                let particle = particle as usize;
                let part = &*locked(&self.walls[particle / WALLS]);
                part[particle % WALLS].push(contact as usize).unwrap_or_default()
            }
        }
    }

    fn set(&mut self, place: Place, impulse: f32) {
        match place {
            Place::Pair { block, lane } => {
                let [part, at] = self.of_block[block as usize];
                let impulses = &mut locked(&self.parts[part])[at].impulses;
                impulses[Phase::Rest as usize][lane as usize] = impulse;
            }
            Place::Wall { particle, contact } => {
                let particle = particle as usize;
                let part = &mut *locked(&self.walls[particle / WALLS]);
                part[particle % WALLS].set_push(contact as usize, impulse);
            }
        }
    }
}

/// The parts of a colour.
struct Colour {
    first: usize,
    uneven_end: usize,
    end: usize,
    is_serial: bool,
}

impl Colour {
    /// Those of a thread. Contacts that share particles are solved by one.
    fn share(&self, member: &Member<'_>, which: Which) -> Range<usize> {
        let end = if which == Which::All { self.end } else { self.uneven_end };
        let count = end - self.first;
        let own = match self.is_serial {
            // In sequence there is nothing to share: each contact reads what the one before has
            // written.
            true if member.is_first() => 0..count,
            true => 0..0,
            false => member.share(count),
        };
        self.first + own.start..self.first + own.end
    }
}

/// What all tasks share.
#[derive(Clone, Copy)]
pub struct State<'a> {
    pub scene: &'a Support<'a>,
    pub velocities: &'a Vectors,
    /// The velocities after the impacts at the beginning of the sub-step, if there are any.
    pub after_impacts: &'a Vectors,
    pub kicks: &'a [Kick],
    /// Angular velocity times radius.
    pub surface_speeds: &'a Scalars,
}

impl State<'_> {
    fn sweep(&self, blocks: &mut [Block], pass: Pass) {
        let Self { velocities, surface_speeds, .. } = *self;
        Sweep { blocks, velocities, surface_speeds, pass }.run();
    }

    /// Gives ghosts the velocities that their own processes have computed.
    fn refresh(&self) -> Result<()> {
        let Self { velocities, surface_speeds, .. } = *self;
        self.scene.halo.refresh(
            |index| {
                let [u, v] = velocities.get(index);
                [u, v, surface_speeds.get(index)]
            },
            |index, [u, v, speed]| {
                velocities.set(index, [u, v]);
                surface_speeds.set(index, speed);
            },
        )
    }

    fn solve_walls(&self, walls: &mut [OnWalls], pass: Pass) {
        for of in walls {
            if pass == Pass::Start {
                of.start(self.velocities, self.surface_speeds);
            } else {
                of.solve(self.velocities, self.surface_speeds, pass);
            }
        }
    }

    /// Adds gravity and forces to the velocities. Those after impacts are kept for what falls freely.
    fn accelerate(&self, indices: Range<usize>, had_impacts: bool) {
        for index in indices {
            let velocity = self.velocities.get(index as u32);
            // Kept before gravity is added: a particle that only bounced gets the impact as its
            // kick and falls on a parabola.
            if had_impacts {
                self.after_impacts.set(index as u32, velocity);
            }
            if self.scene.particles.movable[index] {
                let change = self.scene.change(&self.kicks[index]).map(|v| v as f32);
                self.velocities.set(index as u32, sum(velocity, change));
            }
        }
    }
}
