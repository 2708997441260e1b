//! The plan of a part of a step: what its stages do.
//!
//! `World::step_once` makes it after the forces, because these say how springs are solved, and hands it to the stages.
//! What it says about physics follows from the settings, the forces and what the particles of all processes require,
//! never from candidate pairs. So it is the same on every process, with brute force and with the tree. Stiff springs
//! decide whether contacts rest; they are a property of one process, because distributed worlds have no springs.
//!
//! Later stages complete it twice. The bounds clear `is_bounded` if they are cut. The contacts give `refinement`, on
//! which all processes agree, and with it `substeps` and `threads` ([`Plan::refined`]). `threads` and `is_bounded`,
//! which allows events to skip a test, are those of one process and change no result.

use super::external::has_accelerations;
use super::{DEFAULT_SUBSTEPS, World};
use crate::forces::Influences;
use jostle_base::parallel;

/// Fewer particles times sub-steps than this are not worth sharing with other threads.
/// It trades the time of waiting for other threads against their work: a stage on two threads costs
/// about two microseconds more (docs/benchmarks-notes.md, piles on two threads).
const WORTH_SHARING: usize = 5000;

/// Fewer particles times sub-steps than this are not worth waking other threads for. Where contacts
/// rest, threads wait for each other more often.
const WORTH_WAKING: usize = 8_000;
const WORTH_WAKING_TO_REST: usize = 20_000;

/// What the stages of a part of a step do.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan {
    /// Seconds of the part.
    pub(crate) dt: f32,
    /// Seconds for which its first bounds are made. Bounds, near walls and events read it.
    pub(crate) horizon: f32,
    /// Sub-steps, each with its kicks, resting contacts, events and position correction.
    pub(crate) substeps: usize,
    /// How many times more sub-steps these are than the forces knew of. If it is above 1, the accelerations of the
    /// first sub-step are computed again.
    pub(crate) refinement: usize,
    /// Whether all collisions keep the energy. Contacts, events and sleeping read it.
    pub(crate) is_lossless: bool,
    /// Whether contacts may rest: collisions lose energy, and gravity or forces press. Then bounds contain the
    /// surroundings of each particle, candidate pairs are sorted, contacts are made of near pairs, and each sub-step
    /// finds their impulses.
    pub(crate) may_rest: bool,
    /// Whether any particle has friction. Resting contacts, events and ghosts read it.
    pub(crate) has_friction: bool,
    /// Whether anything but gravity and springs accelerates particles. The kicks read it.
    pub(crate) has_accelerations: bool,
    /// Whether there are springs. The kicks read it.
    pub(crate) has_springs: bool,
    /// Whether a particle without events certainly stays in its bounds in the first sub-step. Events read it.
    pub(crate) is_bounded: bool,
    /// The threads of all stages: one if there is little work.
    pub(crate) threads: Option<usize>,
}

impl Plan {
    /// The plan of a part of `dt` seconds with some sub-steps, after its forces are computed.
    pub(crate) fn new(world: &World, dt: f32, substeps: usize) -> Self {
        let World { scratch, influences, external, halo, .. } = world;
        // The contacts of stiff springs are solved as resting ones, also where nothing loses energy.
        let is_lossless = !scratch.forces.are_springs_stiff && is_lossless(world);
        let may_rest = is_pressed(world) && !is_lossless;
        let own_friction = || world.bodies.awake.particles.has_friction();
        let has_springs = has_springs(influences);
        Self {
            dt,
            horizon: scratch.horizon.seconds.min(dt),
            substeps,
            refinement: 1,
            is_lossless,
            may_rest,
            has_friction: halo.agreed().map_or_else(own_friction, |agreed| agreed.has_friction),
            has_accelerations: has_accelerations(external, influences),
            has_springs,
            // Resting contacts and springs change velocities after the bounds are made.
            is_bounded: !may_rest && !has_springs,
            threads: threads(world, substeps, may_rest),
        }
    }

    /// This plan with more sub-steps, which contacts need.
    pub(crate) fn refined(self, world: &World, refinement: usize) -> Self {
        let substeps = self.substeps * refinement;
        let threads = threads(world, substeps, self.may_rest);
        Self { substeps, refinement, threads, ..self }
    }

    /// Whether forces or resting contacts change velocities.
    pub(crate) fn has_kicks(&self) -> bool {
        self.may_rest || self.has_accelerations || self.has_springs
    }

    /// Seconds of a sub-step.
    pub(crate) fn seconds(&self) -> f64 {
        f64::from(self.dt) / self.substeps as f64
    }

    /// The share of the first sub-step for which the first bounds are made, if these are renewed.
    pub(crate) fn share_of_bounds(&self) -> Option<f64> {
        (self.horizon < self.dt).then(|| f64::from(self.horizon) / self.seconds())
    }
}

impl World {
    /// Keeps the threads awake that steps will use, until the result is dropped.
    pub(crate) fn keep_threads_awake(&self) -> impl Sized + use<> {
        let work = self.bodies.awake.rows.len() * self.substeps();
        parallel::keep_awake(self.settings.tree.threads, work, worth_waking(may_rest(self)))
    }

    /// Sub-steps of a step: those of the settings, or as many as the scene needs. One is enough
    /// where flights between collisions are exact and nothing rests. Forces between neighbours alone
    /// take one, too: their accuracy depends on the length of a step, as in molecular dynamics.
    pub fn substeps(&self) -> usize {
        let is_short_ranged = !self.external.act()
            && self.influences.are_short_ranged()
            && !has_springs(&self.influences);
        let is_one_enough = (!is_pulled(self) || is_short_ranged) && !may_rest(self);
        self.settings.substeps.unwrap_or(if is_one_enough { 1 } else { DEFAULT_SUBSTEPS })
    }
}

/// The threads to use for some sub-steps. For much work they are woken.
fn threads(world: &World, substeps: usize, may_rest: bool) -> Option<usize> {
    let work = world.bodies.awake.rows.len() * substeps;
    let threads = world.settings.tree.threads;
    parallel::threads_for(threads, work, WORTH_SHARING, worth_waking(may_rest))
}

/// Whether all collisions keep the energy, so that nothing comes to rest: they are elastic and without
/// friction.
fn is_lossless(world: &World) -> bool {
    world.halo.agreed().map_or_else(|| are_own_lossless(world), |agreed| agreed.is_lossless)
}

/// Whether all collisions of the particles of this process keep the energy.
pub(crate) fn are_own_lossless(world: &World) -> bool {
    // Chunks without branches, for vector instructions.
    let elastic = |all: &[f32]| all.iter().fold(true, |so_far, &one| so_far & (one == 1.0));
    world.bodies.awake.particles.restitution.chunks(256).all(elastic)
        && world.boundaries.walls.are_elastic()
        && !world.bodies.awake.particles.has_friction()
}

/// Whether particles may rest, if stiff springs do not decide it.
fn may_rest(world: &World) -> bool {
    // Coefficients of restitution are read last, because there is one for each particle.
    is_pressed(world) && !is_lossless(world)
}

/// Whether gravity or forces may press particles against each other or against walls.
fn is_pressed(world: &World) -> bool {
    is_pulled(world) || world.settings.gravity != [0.0; 2]
}

/// Whether forces give kicks before and after the flights of a step.
fn is_pulled(world: &World) -> bool {
    has_accelerations(&world.external, &world.influences) || has_springs(&world.influences)
}

fn has_springs(influences: &Influences) -> bool {
    influences.springs().next().is_some()
}

/// Starts the threads that steps of a world will use, which needs memory.
pub(crate) fn start_threads(world: &World) {
    let work = world.bodies.len() * world.substeps();
    parallel::start(world.settings.tree.threads, work, WORTH_SHARING);
}

fn worth_waking(may_rest: bool) -> usize {
    if may_rest { WORTH_WAKING_TO_REST } else { WORTH_WAKING }
}
