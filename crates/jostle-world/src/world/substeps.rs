//! The sub-steps of a step. In each, forces and resting contacts give kicks, then all particles fly and
//! collide in the order of time, then overlaps are corrected.

use super::bounds::{BoundsScratch, FreeDisplacements, StepBounds};
use super::discs::WarmStart;
use super::force_step::springs;
use super::merge;
use super::settings::DEFAULT_SUBSTEPS;
use super::{OnTouch, Stage, StepScratch, Watch, World};
use crate::events::Flight;
use crate::flow::{Flow, Kick};
use crate::forces;
use crate::forces::springs::Surroundings;
use crate::halo::Halo;
use crate::motion::Motion;
use crate::particles::Particles;
use crate::resting::{Support, WallPushes};
use crate::walls::{Around, Clock, Near, Walls};
use jostle_base::error::Result;
use jostle_base::interrupt;

/// What the sub-steps of a step have in common.
#[derive(Clone, Copy)]
pub(crate) struct Substeps {
    /// Their number.
    count: usize,
    /// Seconds of each.
    seconds: f64,
    flow: Flow,
    is_lossless: bool,
    may_rest: bool,
    has_friction: bool,
    has_accelerations: bool,
    /// The smallest radius above 0.
    smallest_radius: f32,
    /// Whether forces or resting contacts change velocities.
    has_kicks: bool,
    /// Whether all particles without events stay in their bounds in the first sub-step.
    is_bounded: bool,
    /// The share of the first sub-step for which the bounds of the step are made, if these are
    /// renewed.
    horizon: Option<f64>,
    /// Whether there are more sub-steps than [`World::apply_forces`] knew of.
    is_refined: bool,
    threads: Option<usize>,
}

impl Substeps {
    /// Where moving walls are when a sub-step begins.
    fn clock(&self, substep: usize) -> Clock {
        let elapsed = substep as f64 * self.seconds;
        Clock { elapsed, rate: self.flow.seconds / self.flow.duration }
    }
}

impl World {
    /// Whether all collisions keep the energy, so that nothing comes to rest: they are elastic and without
    /// friction.
    pub(crate) fn is_lossless(&self) -> bool {
        self.halo.agreed().map_or_else(|| self.are_own_lossless(), |agreed| agreed.is_lossless)
    }

    /// The same of the particles of this process.
    pub(crate) fn are_own_lossless(&self) -> bool {
        // Chunks without branches, for vector instructions.
        let elastic = |all: &[f32]| all.iter().fold(true, |so_far, &one| so_far & (one == 1.0));
        // Stiff springs whose ends touch anything are solved with contacts that rest.
        !self.scratch.forces.are_springs_stiff
            && self.settings.restitution == 1.0
            && self.particles.restitutions.chunks(256).all(elastic)
            && self.walls.are_elastic()
            && !self.particles.has_friction()
    }

    /// Whether any particle has friction.
    pub(crate) fn has_friction(&self) -> bool {
        let own = || self.particles.has_friction();
        self.halo.agreed().map_or_else(own, |agreed| agreed.has_friction)
    }

    /// Whether forces give kicks before and after the flights of a step.
    pub(crate) fn is_pulled(&self) -> bool {
        self.has_accelerations() || springs(&self.forces).next().is_some()
    }

    /// Whether gravity or forces may press particles against each other or against walls, where collisions
    /// lose energy.
    pub(crate) fn may_rest(&self) -> bool {
        // Coefficients of restitution are read last, because there is one for each particle.
        (self.is_pulled() || self.settings.gravity != [0.0; 2]) && !self.is_lossless()
    }

    /// Sub-steps of a step: those of the settings, or as many as the scene needs. One is enough
    /// where flights between collisions are exact and nothing rests. Forces between neighbours alone
    /// take one, too: their accuracy depends on the length of a step, as in molecular dynamics.
    pub fn substeps(&self) -> usize {
        let is_short_ranged = self.given.is_none()
            && forces::are_short_ranged(&self.forces)
            && springs(&self.forces).next().is_none();
        let is_one_enough = (!self.is_pulled() || is_short_ranged) && !self.may_rest();
        self.settings.substeps.unwrap_or(if is_one_enough { 1 } else { DEFAULT_SUBSTEPS })
    }

    /// The order of a sub-step: kicks of forces → resting contacts → collisions in the order of time →
    /// position correction.
    pub(crate) fn run_substeps(&mut self, dt: f32, watch: &mut Watch<'_>) -> Result<()> {
        let of = self.begin_substeps(dt);
        for substep in 0..of.count {
            interrupt::check()?;
            if substep > 0 {
                self.refresh_ghosts()?;
            }
            self.apply_forces_in_substep(&of, substep, watch)?;
            if of.may_rest {
                self.solve_resting_contacts(&of, substep)?;
                watch(Stage::Resting, self);
                interrupt::check()?;
            }
            self.simulate_collisions(&of, substep)?;
            watch(Stage::Events, self);
            interrupt::check()?;
            self.correct_positions(&of, substep)?;
            watch(Stage::Correction, self);
        }
        self.end_substeps(&of);
        self.stats.substeps += of.count;
        Ok(())
    }

    /// Prepares what lasts for all sub-steps: the impulses of resting contacts and of position
    /// correction, and the results of events.
    fn begin_substeps(&mut self, dt: f32) -> Substeps {
        let (threads, may_rest, is_lossless) =
            (self.threads(), self.may_rest(), self.is_lossless());
        let (is_pulled, has_accelerations) = (self.is_pulled(), self.has_accelerations());
        let has_friction = self.has_friction();
        let any_sleeps = self.any_sleeps();
        let Self { particles, scratch, settings, .. } = self;
        scratch.limits.clear();
        if any_sleeps {
            let free = FreeDisplacements::new(settings, &scratch.forces, dt);
            let all = scratch.max_displacements.iter().enumerate();
            scratch.limits.extend(all.map(|(index, &most)| free.within(particles, index, most)));
        }
        self.halo.protocol().limit(self);
        let Self { particles, persistent, contacts, scratch, settings, .. } = self;
        scratch.grown.begin_step();
        scratch.renewed.clear();
        scratch.events.begin_step(particles.len());
        scratch.hot_walls.fill(forces::thermal_walls(&self.forces), self.time);
        scratch.wall_impulses.clear();
        let on_walls = if may_rest { particles.len() } else { 0 };
        let with_friction = if has_friction { on_walls } else { 0 };
        persistent.warm_start.normal.resize(on_walls, Default::default());
        persistent.warm_start.friction.resize(with_friction, Default::default());
        if may_rest {
            scratch.resting.begin_step(contacts, particles, &scratch.lossy, has_friction);
        } else {
            scratch.wall_pushes.clear();
        }
        scratch.correction.begin_step(contacts);
        let seconds = f64::from(dt) / scratch.substeps as f64;
        Substeps {
            count: scratch.substeps,
            seconds,
            flow: Flow::new(seconds, settings.gravity, settings.drag),
            is_lossless,
            may_rest,
            has_friction,
            has_accelerations,
            smallest_radius: smallest(&particles.radii),
            has_kicks: may_rest || is_pulled,
            is_bounded: scratch.bounded && !may_rest && springs(&self.forces).next().is_none(),
            horizon: (scratch.horizon < dt).then(|| f64::from(scratch.horizon) / seconds),
            is_refined: scratch.refinement > 1,
            threads,
        }
    }

    /// Gives ghosts the state that their own processes have computed.
    fn refresh_ghosts(&self) -> Result<()> {
        let StepScratch { motions, spins, .. } = &self.scratch;
        let halo: &dyn Halo = &*self.halo;
        halo.wait()?;
        halo.refresh(
            |index| {
                let of = motions.get(index);
                let ([x, y], [a, b], [u, v]) = (of.position, of.residual, of.velocity);
                [x, y, a, b, u, v]
            },
            |index, [x, y, a, b, u, v]| {
                let displacement = motions.displacement(index);
                let (position, residual, velocity) = ([x, y], [a, b], [u, v]);
                motions.set(index, Motion { position, residual, velocity, displacement });
            },
        )?;
        if !self.has_friction() {
            return Ok(());
        }
        halo.refresh(
            |index| [spins.velocity(index)],
            |index, [velocity]| spins.set_velocity(index, velocity),
        )
    }

    /// Computes the kicks of accelerations and springs. [`World::apply_forces`] has computed the
    /// accelerations of the first sub-step, unless it is shorter now.
    fn apply_forces_in_substep(
        &mut self,
        of: &Substeps,
        substep: usize,
        watch: &mut Watch<'_>,
    ) -> Result<()> {
        self.scratch.kicks.clear();
        if of.has_accelerations && (substep > 0 || of.is_refined) {
            let StepScratch { forces, motions, .. } = &mut self.scratch;
            forces.find_halfway(motions, &self.settings.container, of.seconds as f32);
            self.accelerate(of.seconds as f32)?;
            watch(Stage::Forces, self);
        }
        let Self { particles, scratch, contacts, walls, .. } = self;
        let StepScratch { forces, motions, kicks, near_walls, .. } = scratch;
        if !of.has_kicks {
            return Ok(());
        }
        kicks.resize(particles.len(), Kick::default());
        forces.kick(kicks, &of.flow);
        if !forces.sprung.is_empty() && !self.forces.is_empty() {
            if forces.are_springs_stiff {
                let surroundings = Surroundings {
                    particles,
                    motions,
                    walls: around(walls, near_walls, particles, of.clock(substep)),
                    kicks,
                    flow: &of.flow,
                };
                forces.sprung.find_held(&surroundings, |each| {
                    for block in &contacts.blocks.list {
                        block.each_lane(|lane| {
                            let pair = [0, 1].map(|k| block.indices.of(k)[lane]);
                            let image = [0, 1].map(|k| block.images[k][lane]);
                            each(pair, image, block.contact_distances[lane]);
                        });
                    }
                });
            }
            forces.sprung.act(motions, kicks, of.seconds);
            watch(Stage::Forces, self);
        }
        Ok(())
    }

    /// Finds the impulses of contacts that rest, and adds them to the kicks.
    fn solve_resting_contacts(&mut self, of: &Substeps, substep: usize) -> Result<()> {
        let Self { particles, settings, scratch, halo, .. } = self;
        let StepScratch { kicks, wall_impulses, wall_pushes, new_wall_pushes: new, .. } = scratch;
        let springs = &mut scratch.forces.sprung;
        let clock = of.clock(substep);
        let scene = Support {
            particles,
            lossy: &scratch.lossy,
            motions: &scratch.motions,
            spins: &scratch.spins,
            has_friction: of.has_friction,
            flow: &of.flow,
            container: settings.container,
            walls: around(&self.walls, &scratch.near_walls, particles, clock),
            rows: &self.rows,
            pushes: wall_pushes,
            restitution: settings.restitution,
            halo: &**halo,
            shape: scratch.contact_shape,
            threads: of.threads,
        };
        let WarmStart { normal, friction } = &mut self.persistent.warm_start;
        new.clear();
        let pushes = WallPushes { normal, friction, walls: new, impulses: wall_impulses };
        scratch.resting.support(&scene, &self.contacts, pushes, springs, kicks)?;
        new.sort_unstable_by_key(|of| (of.row, of.wall));
        std::mem::swap(new, wall_pushes);
        Ok(())
    }

    /// Moves all particles to the end of the sub-step, with their collisions in the order of time.
    fn simulate_collisions(&mut self, of: &Substeps, substep: usize) -> Result<()> {
        let Self { particles, settings, scratch, halo, .. } = self;
        let StepScratch { tree, max_displacements, grown, renewed, crowding, .. } = scratch;
        let of_bounds =
            BoundsScratch { tree, max_displacements, grown, renewed, crowding: *crowding };
        let share = of.horizon.map(|share| if substep == 0 { share } else { 0.0 });
        let mut bounds = StepBounds::new(particles, settings, of_bounds, share, of.flow.duration);
        let flight = Flight {
            particles,
            motions: &scratch.motions,
            spins: &scratch.spins,
            has_friction: of.has_friction,
            gravity: of.flow.gravity,
            end: of.flow.duration,
            flow: of.flow,
            kicks: &scratch.kicks,
            begins_step: substep == 0,
            halo: &**halo,
            bounded: substep == 0 && of.is_bounded,
            container: settings.container,
            walls: around(&self.walls, &scratch.near_walls, particles, of.clock(substep)),
            restitution: settings.restitution,
            is_lossless: of.is_lossless,
            lossy: &scratch.lossy,
            thermostat: forces::thermostat(&self.forces),
            hot: &scratch.hot_walls,
            pairs: settings.on_touch == OnTouch::Bounce,
            candidates: &scratch.pairs,
            sensed: &scratch.sensed,
            senses_all: settings.on_touch == OnTouch::Ignore && settings.track_events,
            limits: &scratch.limits,
            smallest_radius: of.smallest_radius,
            threads: of.threads,
        };
        scratch.events.simulate(&flight, &mut bounds)
    }

    /// Pushes overlapping particles apart, without changing velocities, and marks those that merge.
    fn correct_positions(&mut self, of: &Substeps, substep: usize) -> Result<()> {
        let Self { particles, settings, scratch, halo, .. } = self;
        let StepScratch { motions, near_walls, correction, candidate_merges, .. } = scratch;
        let walls = around(&self.walls, near_walls, particles, of.clock(substep + 1));
        let boundaries = (&settings.container, walls);
        let shared: (usize, &dyn Halo) = (scratch.contact_shape.stages(), &**halo);
        correction.run(&self.contacts, motions, particles, boundaries, shared, of.threads)?;
        merge::mark_touching(candidate_merges, motions, of.threads);
        Ok(())
    }

    /// Stores the impulses in the contacts.
    fn end_substeps(&mut self, of: &Substeps) {
        if of.may_rest {
            self.scratch.resting.end_step(&mut self.contacts);
        }
        self.scratch.correction.end_step(&mut self.contacts);
    }
}

/// The smallest radius above 0; infinite if there is none. No result depends on it.
fn smallest(radii: &[f32]) -> f32 {
    let of = |chunk: &[f32]| {
        let positive =
            chunk.iter().map(|&radius| if radius > 0.0 { radius } else { f32::INFINITY });
        positive.fold(f32::INFINITY, |a, b| if b < a { b } else { a })
    };
    radii.chunks(256).map(of).fold(f32::INFINITY, f32::min)
}

/// The walls near each particle at a time of the step.
fn around<'a>(
    walls: &'a Walls,
    near: &'a Near,
    particles: &'a Particles,
    clock: Clock,
) -> Around<'a> {
    Around { walls, near, particles, clock }
}
