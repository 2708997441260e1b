//! Resting contacts: impulses that keep surfaces from approaching, one sub-step at a time.
//!
//! The unknowns are the velocities at the end of the sub-step, with gravity and forces. For every
//! contact that rests, with the normal n, the gap d and the sub-step h, an impulse P ≥ 0 along n
//! gives n·w ≥ −d/h, and P = 0 where n·w > −d/h (E. Catto, *Iterative Dynamics with Temporal
//! Coherence*, 2005). The impulses are found by projected successive over-relaxation (D. M. Young,
//! *Iterative Solution of Large Linear Systems*, 1971; R. W. Cottle et al., *The Linear
//! Complementarity Problem*, 1992) from those of the sub-step before (warm starting): each
//! correction of an impulse is multiplied by a factor between 1 and 2. In a pile of many layers this
//! converges in far fewer iterations than the factor 1 (Gauss–Seidel). The last iteration has the
//! factor 1, so that a single contact is exact. There is no damping.
//!
//! `rule` tells which contacts rest. All others bounce, see [`crate::events`].

mod friction;
mod pairs;
mod rule;
mod start;
mod sweeps;
mod walls;

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::contacts::{Block, ContactShape, Contacts};
use crate::flow::{Flow, Kick};
use crate::forces::springs::{Place, SpringSolver};
use crate::halo::Halo;
use crate::motion::{Motions, Scalars, Spins, Vectors};
use crate::particles::Particles;
use crate::walls::{self as segments, Around};
use jostle_base::error::Result;
use jostle_base::{memory, parallel, plain};
use jostle_simd::LANES;
use rule::{MAX_REST_GAP, Start, Surfaces};
pub use rule::{TOUCHING, are_touching};
use start::Starts;
use sweeps::{State, Sweeps};
use walls::OnWalls;

/// Blocks in one task of a thread.
const BLOCKS_OF_A_THREAD: usize = 64;

/// What the resting contacts of a sub-step depend on.
pub struct Support<'a> {
    /// The particles.
    pub particles: &'a Particles,
    /// Which of them may rest, of a world in which some may not; else empty.
    pub lossy: &'a [bool],
    /// Positions and velocities at the beginning of the sub-step.
    pub motions: &'a Motions,
    /// Angular velocities at the beginning of the sub-step.
    pub spins: &'a Spins,
    /// Whether any particle has friction.
    pub has_friction: bool,
    /// The sub-step.
    pub flow: &'a Flow,
    /// The container and the walls.
    pub walls: Around<'a>,
    /// The row of each particle.
    pub rows: &'a [u32],
    /// The impulses of walls in the sub-step before, sorted by row and wall.
    pub wall_impulses: &'a [WallImpulse],
    /// What is shared with other processes.
    pub halo: &'a dyn Halo,
    /// The number of colours, and whether any masses are uneven, on all processes.
    pub shape: ContactShape,
    /// Threads to use.
    pub threads: Option<usize>,
}

/// Scratch.
#[derive(Debug, Default)]
pub struct Resting {
    velocities: Vectors,
    /// The velocities after the impacts at the beginning of the sub-step, if there are any.
    after_impacts: Vectors,
    /// Angular velocity times radius; empty if there is no friction.
    surface_speeds: Scalars,
    /// The speed that gravity and forces give to each particle in the sub-step, with 0 as a second
    /// number. Empty, or out of date, if there is a `speed_of_all`.
    speeds: Vectors,
    /// The speed that gravity gives to each particle that moves, if there are no forces.
    speed_of_all: Option<f32>,
    /// Whether particles touch and approach too fast to rest.
    is_fast: bool,
    /// Scratch of the sweeps.
    work: Vec<u8>,
    walls: Vec<OnWalls>,
    /// The lists of the parts of the particles, which are joined to `walls`.
    parts: Vec<WallPart>,
    /// How many of these, the first, belong to particles that have contacts of uneven masses.
    uneven_walls: usize,
}

/// Particles whose walls a thread lists at a time.
const WALL_PART: usize = 4096;

/// The wall contacts of [`WALL_PART`] particles, which one thread lists.
#[derive(Debug, Default)]
struct WallPart {
    walls: Vec<OnWalls>,
    /// The contacts of a particle and walls.
    found: Vec<segments::WallContact>,
    /// The particles that may be near walls.
    near: Vec<u32>,
}

/// The impulses that a wall gave to a particle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WallImpulse {
    /// The row of the particle.
    pub row: u32,
    /// The number of the wall.
    pub wall: u32,
    /// Along the normal, and of friction.
    pub impulses: [f32; 2],
    /// The impulses at rest of the last sub-step, divided by the mass. The next sub-step begins with them.
    pub pushes: [f32; 2],
}

plain! { WallImpulse { row, wall, impulses, pushes } }

/// The impulse that a wall, no side of the container, gave to a particle in a sub-step.
#[derive(Clone, Copy, Debug)]
pub struct WallVector {
    /// The row of the particle.
    pub row: u32,
    /// The number of the wall.
    pub wall: u32,
    /// The impulse.
    pub impulse: [f32; 2],
}

/// The sum of two vectors.
fn sum(a: [f32; 2], b: [f32; 2]) -> [f32; 2] {
    [0, 1].map(|k| a[k] + b[k])
}

impl Support<'_> {
    /// The impulses of walls on a particle in the sub-step before.
    fn impulses_before(&self, index: usize) -> &[WallImpulse] {
        // The list is sorted by rows, so a binary search finds those of a particle. Rows do not
        // change within a step; indices change from step to step.
        let (row, all) = (self.rows[index], self.wall_impulses);
        let rest = &all[all.partition_point(|of| of.row < row)..];
        &rest[..rest.iter().take_while(|of| of.row == row).count()]
    }

    /// Angular velocity times radius at the beginning of the sub-step.
    fn surface_speed(&self, index: usize) -> f32 {
        self.spins.velocity(index as u32) * self.particles.radii[index]
    }

    /// Those of some particles that may be near enough to walls to rest on them. `near` is scratch.
    fn near_walls<'n>(
        &self,
        indices: Range<usize>,
        kicks: &[Kick],
        near: &'n mut Vec<u32>,
    ) -> &'n [u32] {
        near.clear();
        near.resize(indices.len(), 0);
        let container = self.walls.container;
        let (inner, has_sides) = (container.inner(), container.has_sides());
        let has_walls = !self.walls.is_empty();
        let h = self.flow.duration as f32;
        let mut count = 0;
        for index in indices {
            let position = self.motions.position(index as u32);
            // No contact farther away can rest, by the rule. The distance is in proportion to what
            // gravity gives, so it has no unit of its own.
            let far = MAX_REST_GAP * kicks[index].speed * h;
            // Twice the distance, so that rounding does not matter.
            let is_inside = inner.contains(position, 2.0 * far + self.particles.radii[index]);
            let is_near = (has_sides & !is_inside)
                | (has_walls && !self.walls.is_far(index as u32, position, far));
            // Without a branch, which would often be predicted wrongly.
            near[count] = index as u32;
            count += usize::from(is_near);
        }
        &near[..count]
    }

    /// The change of velocity that gravity and forces give to a free particle in the sub-step.
    #[inline(always)]
    fn change(&self, kick: &Kick) -> [f64; 2] {
        let Flow { gravity, duration, .. } = self.flow;
        [0, 1].map(|k| kick.before[k] + gravity[k] * duration + kick.after[k])
    }
}

impl Resting {
    /// Finds the impulses of the resting contacts. Writes those of walls to `to`, adds them as vectors to `to_walls`,
    /// see [`OnWalls::vectors`], and changes the kicks of the particles that they support.
    pub fn support(
        &mut self,
        scene: &Support<'_>,
        contacts: &mut Contacts,
        (to, to_walls): (&mut Vec<WallImpulse>, &mut Vec<WallVector>),
        springs: &mut SpringSolver,
        kicks: &mut [Kick],
    ) -> Result<()> {
        // The order of a sub-step: velocities without contacts, springs that are held, the contacts
        // that rest, the iterations, and then kicks for the flight. Positions do not change here.
        self.begin(scene, kicks)?;
        self.begin_held(scene, springs, kicks)?;
        self.find_starts(scene, &mut contacts.blocks.list);
        self.list_walls(scene, contacts, kicks)?;
        let pairs = &mut contacts.blocks;
        if springs.holds_any() {
            springs.add_pushes(self.pushes(scene, &pairs.list))?;
            self.forgo_impacts(springs, &mut pairs.list);
        }
        let Self { velocities, after_impacts, surface_speeds, .. } = self;
        let all = State { scene, kicks, velocities, after_impacts, surface_speeds };
        let Self { walls, work, .. } = self;
        let (uneven_walls, has_fast) = (self.uneven_walls, self.is_fast);
        let springs = springs.holds_any().then_some(springs);
        let had_impacts =
            Sweeps { all, pairs, walls, uneven_walls, springs, has_fast, work }.run()?;
        to.clear();
        for walls in &*walls {
            let (row, mass) =
                (scene.rows[walls.index as usize], scene.particles.masses[walls.index as usize]);
            memory::extend(to, walls.impulses(row, mass))?;
            memory::extend(to_walls, walls.vectors(row, mass))?;
        }
        // The next sub-step searches by rows.
        to.sort_unstable_by_key(|of| (of.row, of.wall));
        self.end(scene, had_impacts, kicks);
        Ok(())
    }

    /// Writes the velocities without contacts, and the speeds that gravity and forces give.
    fn begin(&mut self, scene: &Support<'_>, kicks: &mut [Kick]) -> Result<()> {
        let count = kicks.len();
        self.velocities.resize_with_spare(count)?;
        self.after_impacts.resize(count)?;
        let turning = if scene.has_friction { count } else { 0 };
        self.surface_speeds.resize(if scene.has_friction { turning + 1 } else { 0 })?;
        let Self { velocities, surface_speeds, .. } = &*self;
        parallel::for_rows(scene.threads, turning, |index| {
            surface_speeds.set(index as u32, scene.surface_speed(index));
        });
        let speed_of = |kick: &Kick| {
            let [x, y] = scene.change(kick);
            (x * x + y * y).sqrt() as f32
        };
        // Without forces all particles have the same.
        let without_kick = speed_of(&Kick::default());
        let any_kick = AtomicBool::new(false);
        parallel::for_chunks(scene.threads, kicks, |first, kicks| {
            let mut any = false;
            for (kick, index) in kicks.iter_mut().zip(first..) {
                velocities.set(index as u32, scene.motions.velocity(index as u32));
                if scene.particles.movable[index] {
                    let has_kick = kick.has_changes();
                    any |= has_kick;
                    kick.speed = if has_kick { speed_of(kick) } else { without_kick };
                }
            }
            // Relaxed: the value is read after the region, whose end orders it. One access for each
            // chunk, and not for each particle, keeps threads from waiting for one cache line.
            any_kick.fetch_or(any, Ordering::Relaxed);
        });
        // A pile under gravity alone needs no column of speeds, and the kernel saves two gathers.
        self.speed_of_all = (!any_kick.into_inner()).then_some(without_kick);
        if self.speed_of_all.is_none() { self.list_speeds(scene, kicks) } else { Ok(()) }
    }

    /// Lists the speeds that gravity and forces give.
    fn list_speeds(&mut self, scene: &Support<'_>, kicks: &[Kick]) -> Result<()> {
        self.speeds.resize_with_spare(kicks.len())?;
        let speeds = &self.speeds;
        parallel::for_rows(scene.threads, kicks.len(), |index| {
            speeds.set(index as u32, [kicks[index].speed, 0.0]);
        });
        Ok(())
    }

    /// Begins a sub-step of springs that are solved together with contacts. They count as forces
    /// that may press particles against each other.
    fn begin_held(
        &mut self,
        scene: &Support<'_>,
        springs: &mut SpringSolver,
        kicks: &mut [Kick],
    ) -> Result<()> {
        if !springs.holds_any() {
            return Ok(());
        }
        springs.begin_held(scene.flow, scene.motions, &scene.particles.movable, |index, by| {
            kicks[index as usize].speed += (by[0] * by[0] + by[1] * by[1]).sqrt() as f32;
        })?;
        self.speed_of_all = None;
        self.list_speeds(scene, kicks)
    }

    /// Leaves out the impacts of contacts that are solved together with springs: springs press
    /// their surfaces together anew in each sub-step, and a bounce would add energy to them.
    fn forgo_impacts(&mut self, springs: &SpringSolver, blocks: &mut [Block]) {
        for place in springs.places() {
            match place {
                Place::Pair { block, lane } => {
                    blocks[block as usize].forgo_impact(lane as usize);
                }
                Place::Wall { particle, contact } => {
                    self.walls[particle as usize].forgo_impact(contact as usize);
                }
            }
        }
    }

    /// All resting contacts, for springs that are solved together with them.
    fn pushes(
        &self,
        scene: &Support<'_>,
        blocks: &[Block],
    ) -> impl Iterator<Item = (Place, [u32; 2], [f32; 2])> {
        let pairs = (0..).zip(blocks).flat_map(|(block, of)| {
            let lanes = (0..LANES).filter(move |lane| of.resting >> lane & 1 == 1);
            lanes.map(move |lane| {
                let pair = [0, 1].map(|k| of.indices.of(k)[lane]);
                let masses = [0, 1].map(|k| of.inverse_masses[k][lane]);
                (Place::Pair { block, lane: lane as u32 }, pair, masses)
            })
        });
        let walls = (0..).zip(&self.walls).flat_map(|(particle, of)| {
            let mass = 1.0 / scene.particles.masses[of.index as usize];
            let contact =
                move |contact| (Place::Wall { particle, contact }, [of.index; 2], [mass; 2]);
            of.numbers().map(contact)
        });
        pairs.chain(walls)
    }

    /// Finds the contacts of two particles that rest.
    fn find_starts(&mut self, scene: &Support<'_>, blocks: &mut [Block]) {
        let starts = Starts {
            velocities: &self.velocities,
            motions: scene.motions,
            radii: &scene.particles.radii,
            speeds: &self.speeds,
            speed_of_all: self.speed_of_all,
            duration: scene.flow.duration as f32,
            has_friction: scene.has_friction,
        };
        // Each block is written by one thread, and reads only the state at the beginning. So blocks
        // of all colours can begin in parallel.
        let size = BLOCKS_OF_A_THREAD;
        let threads = if blocks.len() <= size { Some(1) } else { scene.threads };
        let any = AtomicBool::new(false);
        parallel::for_each(threads, blocks.chunks_mut(size), |blocks| {
            // Relaxed: only the final value counts, and the end of the region makes it visible.
            any.fetch_or(starts.run(blocks), Ordering::Relaxed);
        });
        self.is_fast = any.into_inner();
    }

    /// Lists the particles that rest on walls, those with contacts of uneven masses first.
    fn list_walls(
        &mut self,
        scene: &Support<'_>,
        contacts: &Contacts,
        kicks: &[Kick],
    ) -> Result<()> {
        let Self { walls, uneven_walls, parts, .. } = self;
        walls.clear();
        memory::resize_default(parts, kicks.len().div_ceil(WALL_PART))?;
        let mut list = |uneven| -> Result<usize> {
            // Those of ghosts are solved by their own processes.
            let is_own = |index: usize| scene.halo.owns(index as u32);
            let may_rest = |index: usize| scene.lossy.get(index).is_none_or(|&lossy| lossy);
            let is_listed = |&index: &usize| {
                scene.particles.movable[index]
                    && may_rest(index)
                    && is_own(index)
                    && contacts.is_uneven(index as u32) == uneven
            };
            let tasks = parts.iter_mut().zip((0..kicks.len()).step_by(WALL_PART));
            parallel::try_for_each(scene.threads, tasks, |(part, first)| {
                let WallPart { walls, found, near } = part;
                // An error of another part leaves them.
                walls.clear();
                memory::reserve(near, WALL_PART)?;
                let indices = first..kicks.len().min(first + WALL_PART);
                let near = scene.near_walls(indices, kicks, near).iter();
                let near = near.map(|&index| index as usize).filter(is_listed);
                for index in near {
                    if let Some(of) = OnWalls::of(index, scene, &kicks[index], found) {
                        memory::push(walls, of)?;
                    }
                }
                Ok(())
            })?;
            // Joined in the order of particles, whichever thread has made a part.
            for part in &mut *parts {
                memory::reserve(walls, part.walls.len())?;
                walls.append(&mut part.walls);
            }
            Ok(walls.len())
        };
        *uneven_walls = 0;
        if scene.walls.container.has_sides() || !scene.walls.is_empty() {
            if contacts.has_uneven() {
                *uneven_walls = list(true)?;
            }
            list(false)?;
        }
        Ok(())
    }

    /// Writes the changes of velocity of the particles, which come before the flight. A particle that
    /// resting contacts support gets all of its change, that by gravity included, and flies straight.
    /// One that has only impacts gets the change by these, and falls in its flight.
    fn end(&self, scene: &Support<'_>, had_impacts: bool, kicks: &mut [Kick]) {
        parallel::for_chunks(scene.threads, kicks, |first, kicks| {
            for (kick, index) in kicks.iter_mut().zip(first..) {
                if !scene.particles.movable[index] {
                    continue;
                }
                if scene.has_friction {
                    self.set_spin(scene, index);
                }
                let index = index as u32;
                let (new, old) = (self.velocities.get(index), scene.motions.velocity(index));
                let impacted = if had_impacts { self.after_impacts.get(index) } else { old };
                let from_old = |v: [f32; 2]| [0, 1].map(|k| f64::from(v[k]) - f64::from(old[k]));
                // The sum that [`State::accelerate`] has written: nothing at rest has changed it.
                // Equality to the bit is the test for "no contact has pushed". The same sum of the
                // same numbers has the same bits; a tolerance would take small impulses away.
                if new == sum(impacted, scene.change(kick).map(|v| v as f32)) {
                    if impacted != old {
                        let by = from_old(impacted);
                        kick.before = [0, 1].map(|k| kick.before[k] + by[k]);
                    }
                    continue;
                }
                // The whole change acts before the flight, so the particle flies straight with the
                // velocity at the end of the sub-step. With these velocities no resting contact
                // closes by more than its gap.
                kick.before = from_old(new);
                kick.after = [0.0; 2];
                kick.is_supported = true;
            }
        });
    }

    /// Writes the angular velocity of a particle, if friction has changed it.
    fn set_spin(&self, scene: &Support<'_>, index: usize) {
        let new = self.surface_speeds.get(index as u32);
        // Product and quotient with the radius do not return the same bits, so a disc without
        // friction keeps its angular velocity.
        if new != scene.surface_speed(index) {
            scene.spins.set_velocity(index as u32, new / scene.particles.radii[index]);
        }
    }
}
