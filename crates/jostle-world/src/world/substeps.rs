//! The sub-steps of a step. In each, forces, torques and resting contacts give kicks, then all particles fly and
//! collide in the order of time, then overlaps are corrected.

use std::cmp::Reverse;

use super::boundaries::{Boundaries, around};
use super::bounds::{BoundsScratch, StepBounds};
use super::islands::wake::any_sleeps;
use super::merge;
use super::plan::Plan;
use super::reach::FreeReaches;
use super::{OnTouch, Stage, StepScratch, Watch, World};
use crate::events::{Flight, MAX_COLLISIONS};
use crate::flow::{Flow, Kick};
use crate::forces::springs::Surroundings;
use crate::halo::Halo;
use crate::motion::Motion;
use crate::resting::Support;
use crate::walls::Clock;
use crate::world::bodies::Bodies;
use crate::world::bodies::discs::Discs;
use jostle_base::error::{Error, Result};
use jostle_base::interrupt;
use jostle_base::memory;

/// What the sub-steps of a part have in common, beside its plan.
struct Substeps<'a> {
    plan: &'a Plan,
    flow: Flow,
    /// The smallest radius above 0.
    smallest_radius: f32,
}

impl Substeps<'_> {
    /// Where moving walls are when a sub-step begins.
    fn clock(&self, substep: usize) -> Clock {
        let elapsed = substep as f64 * self.plan.seconds();
        // With damping a flight is shorter than the sub-step, but walls move in real time.
        Clock { elapsed, rate: self.flow.seconds / self.flow.duration }
    }
}

impl World {
    /// The order of a sub-step: kicks of forces → resting contacts → collisions in the order of time →
    /// position correction.
    pub(crate) fn run_substeps(&mut self, plan: &Plan, watch: &mut Watch<'_>) -> Result<()> {
        // More sub-steps help piles more than more iterations: each sub-step begins with the
        // impulses of the one before, and a heavy particle falls less far in it. So the iterations
        // have a fixed number, which depends on nothing far away, and the sub-steps follow from the
        // contacts.
        let common = self.begin_substeps(plan)?;
        for substep in 0..plan.substeps {
            interrupt::check()?;
            // A ghost may have collided with particles that only its own rank has.
            if substep > 0 {
                self.refresh_ghosts(plan)?;
            }
            self.apply_forces_in_substep(&common, substep, watch)?;
            self.scratch.torques.begin(&self.scratch.spins, plan.seconds());
            if plan.may_rest {
                self.solve_resting_contacts(&common, substep)?;
                watch(Stage::Resting, self);
                interrupt::check()?;
            }
            self.scratch.torques.halve(&self.scratch.spins, plan.seconds());
            self.simulate_collisions(&common, substep)?;
            self.scratch.torques.end(&self.scratch.spins, plan.seconds());
            watch(Stage::Events, self);
            interrupt::check()?;
            self.correct_positions(&common, substep)?;
            watch(Stage::Correction, self);
        }
        if plan.may_rest {
            self.contacts.end_resting(plan.has_friction);
        }
        self.stats.substeps += plan.substeps;
        Ok(())
    }

    /// Prepares what lasts for all sub-steps: the impulses of resting contacts and of position
    /// correction, and the results of events.
    fn begin_substeps<'a>(&mut self, plan: &'a Plan) -> Result<Substeps<'a>> {
        let any_sleeps = any_sleeps(&self.bodies, &*self.halo);
        let Self {
            bodies: Bodies { awake: Discs { particles, .. }, .. }, scratch, settings, ..
        } = self;
        scratch.watched_reaches.clear();
        // These distances decide which sleeping islands an attempt would touch.
        if any_sleeps {
            let free = FreeReaches::new(settings, &scratch.forces, plan.dt);
            let all = scratch.reaches.iter().enumerate();
            let all = all.map(|(index, &most)| free.within(particles, index, most));
            memory::extend(&mut scratch.watched_reaches, all)?;
        }
        self.halo.protocol().limit(self)?;
        let Self {
            bodies: Bodies { awake: Discs { particles, .. }, .. }, scratch, settings, ..
        } = self;
        scratch.grown.begin_part();
        scratch.renewed.begin_part();
        scratch.events.begin_part(particles.len())?;
        let row = |wall| self.boundaries.ids.row(wall);
        scratch.wall_temperatures.fill(self.influences.thermal_walls(), row, self.time);
        self.boundaries.begin_substeps(plan.may_rest);
        let flow = Flow::new(plan.seconds(), settings.gravity, settings.drag);
        Ok(Substeps { plan, flow, smallest_radius: smallest(&particles.radii) })
    }

    /// Gives ghosts the state that their own processes have computed.
    fn refresh_ghosts(&self, plan: &Plan) -> Result<()> {
        let StepScratch { motions, spins, .. } = &self.scratch;
        let halo: &dyn Halo = &*self.halo;
        halo.wait()?;
        halo.refresh(
            |index| {
                let motion = motions.get(index);
                let ([x, y], [a, b], [u, v]) = (motion.position, motion.residual, motion.velocity);
                [x, y, a, b, u, v]
            },
            |index, [x, y, a, b, u, v]| {
                let (position, residual, velocity) = ([x, y], [a, b], [u, v]);
                motions.set(index, Motion { position, residual, velocity });
            },
        )?;
        if !plan.has_friction {
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
        common: &Substeps<'_>,
        substep: usize,
        watch: &mut Watch<'_>,
    ) -> Result<()> {
        self.scratch.kicks.clear();
        if common.plan.has_accelerations && (substep > 0 || common.plan.refinement > 1) {
            let StepScratch { forces, motions, .. } = &mut self.scratch;
            forces.find_halfway(motions, &self.settings.container, common.plan.seconds() as f32);
            self.accelerate(common.plan.seconds() as f32)?;
            watch(Stage::Forces, self);
        }
        let Self {
            bodies: Bodies { awake: Discs { particles, .. }, .. },
            scratch,
            contacts,
            boundaries,
            ..
        } = self;
        let StepScratch { forces, motions, kicks, .. } = scratch;
        if !common.plan.has_kicks() {
            return Ok(());
        }
        memory::resize(kicks, particles.len(), Kick::default())?;
        forces.kick(kicks, &common.flow);
        // Springs come after the kicks of other forces, with which their parts begin.
        if !forces.sprung.is_empty() && !self.influences.is_empty() {
            if forces.are_springs_stiff {
                let surroundings = Surroundings {
                    particles,
                    motions,
                    walls: boundaries.around(particles, common.clock(substep)),
                    kicks,
                    flow: &common.flow,
                };
                forces.sprung.find_held(&surroundings, |each| {
                    for block in &contacts.blocks.list {
                        block.each_lane(|lane| {
                            let pair = [0, 1].map(|k| block.indices.of(k)[lane]);
                            let image = [0, 1].map(|k| block.images[k][lane]);
                            each(pair, image, block.contact_distances[lane]);
                        });
                    }
                })?;
            }
            forces.sprung.act(motions, kicks, common.plan.seconds());
            watch(Stage::Forces, self);
        }
        Ok(())
    }

    /// Finds the impulses of contacts that rest, and adds them to the kicks.
    fn solve_resting_contacts(&mut self, common: &Substeps<'_>, substep: usize) -> Result<()> {
        let Self {
            bodies: Bodies { awake: Discs { particles, .. }, .. },
            scratch,
            halo,
            boundaries,
            ..
        } = self;
        let Boundaries { walls, near, pushes, new_pushes, resting_vectors, .. } = boundaries;
        let new = (new_pushes, resting_vectors);
        let springs = &mut scratch.forces.sprung;
        let clock = common.clock(substep);
        let scene = Support {
            particles,
            lossy: &scratch.lossy,
            motions: &scratch.motions,
            spins: &scratch.spins,
            has_friction: common.plan.has_friction,
            flow: &common.flow,
            walls: around(walls, near, particles, clock),
            rows: &self.bodies.awake.rows,
            wall_impulses: pushes,
            halo: &**halo,
            shape: scratch.contact_shape,
            threads: common.plan.threads,
        };
        scratch.resting.support(&scene, &mut self.contacts, new, springs, &mut scratch.kicks)?;
        self.boundaries.end_resting()
    }

    /// Moves all particles to the end of the sub-step, with their collisions in the order of time.
    fn simulate_collisions(&mut self, common: &Substeps<'_>, substep: usize) -> Result<()> {
        let Self {
            bodies: Bodies { awake: Discs { particles, .. }, .. },
            settings,
            scratch,
            halo,
            ..
        } = self;
        let StepScratch { tree, reaches, grown, renewed, horizon, .. } = scratch;
        let of_bounds = BoundsScratch { tree, reaches, grown, renewed, crowding: horizon.crowding };
        // The first bounds last for their share of the first sub-step. At the beginning of each
        // later sub-step they have expired.
        let share =
            common.plan.share_of_bounds().map(|share| if substep == 0 { share } else { 0.0 });
        let mut bounds =
            StepBounds::new(particles, settings, of_bounds, share, common.flow.duration);
        let flight = Flight {
            particles,
            motions: &scratch.motions,
            spins: &scratch.spins,
            has_friction: common.plan.has_friction,
            gravity: common.flow.gravity,
            end: common.flow.duration,
            flow: common.flow,
            kicks: &scratch.kicks,
            begins_part: substep == 0,
            halo: &**halo,
            bounded: substep == 0 && common.plan.is_bounded,
            walls: self.boundaries.around(particles, common.clock(substep)),
            is_lossless: common.plan.is_lossless,
            lossy: &scratch.lossy,
            thermostat: self.influences.thermostats().next().copied(),
            temperatures: &scratch.wall_temperatures,
            pairs: settings.on_touch == OnTouch::Bounce,
            candidates: &scratch.pairs,
            sensed: &scratch.sensed,
            senses_all: settings.on_touch == OnTouch::Ignore && settings.track_events,
            senses_walls: settings.track_events && self.boundaries.walls.has_sensors(),
            watched_reaches: &scratch.watched_reaches,
            smallest_radius: common.smallest_radius,
            threads: common.plan.threads,
        };
        let done = scratch.events.simulate(&flight, &mut bounds);
        // The error of the events has an index, not an id.
        done.map_err(|error| match error {
            Error::TooManyCollisions { .. } => too_many_collisions(self),
            other => other,
        })
    }

    /// Pushes overlapping particles apart, without changing velocities, and marks those that merge.
    fn correct_positions(&mut self, common: &Substeps<'_>, substep: usize) -> Result<()> {
        let Self { bodies: Bodies { awake: Discs { particles, .. }, .. }, scratch, halo, .. } =
            self;
        let StepScratch { motions, correction, candidate_merges, .. } = scratch;
        // At the end of the sub-step, where the particles are.
        let walls = self.boundaries.around(particles, common.clock(substep + 1));
        let shared: (usize, &dyn Halo) = (scratch.contact_shape.stages(), &**halo);
        let threads = common.plan.threads;
        correction.run(&mut self.contacts, motions, particles, walls, shared, threads)?;
        merge::mark_touching(candidate_merges, motions, threads);
        Ok(())
    }
}

/// The error of a step in which particles of this process have too many collisions, with the id of
/// the one that has most.
pub(crate) fn too_many_collisions(world: &World) -> Error {
    let all = world.bodies.awake.rows.iter().zip(&world.scratch.events.counts);
    let own = all.filter(|particle| *particle.0 < world.halo.own_rows());
    let most = own
        .map(|(&row, &count)| (Reverse(count), world.halo.id_among_all(&world.bodies.ids, row)))
        .min();
    Error::TooManyCollisions { id: most.map_or(0, |(_, id)| id), limit: MAX_COLLISIONS }
}

/// The smallest radius above 0; infinite if there is none. No result depends on it.
fn smallest(radii: &[f32]) -> f32 {
    // Chunks and comparisons become vector instructions. `min` takes longer, because it treats NaN.
    let least = |chunk: &[f32]| {
        let positive =
            chunk.iter().map(|&radius| if radius > 0.0 { radius } else { f32::INFINITY });
        positive.fold(f32::INFINITY, |a, b| if b < a { b } else { a })
    };
    radii.chunks(256).map(least).fold(f32::INFINITY, f32::min)
}
