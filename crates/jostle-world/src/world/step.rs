//! A step: from positions and velocities to those `dt` seconds later.
//!
//! A chain of three functions: [`World::step_watched`] makes several steps. `step_until_complete` makes one: it undoes
//! and repeats an attempt that would touch sleeping particles, or on which processes do not agree. `step_once` is one
//! attempt, and has the order of the stages.

use super::boundaries::Boundaries;
use super::bounds::find_bounds;
use super::displacements::{check_displacements, parts};
use super::drive::{Driven, drive};
use super::force_step::{apply_andersen, break_springs};
use super::islands::sleep::fall_asleep;
use super::islands::wake::{
    cancel_waking, find_touched_beyond_reach_on_all, find_touched_on_all, forget_woken, is_still,
    wake_touched,
};
use super::merge::merge;
use super::plan::Plan;
use super::pumps::{Pumped, pump};
use super::record::{record_pairs, record_walls};
use super::renewal::Horizon;
use super::reorder::reorder;
use super::store::{load_motions, store_motions};
use super::touches::collect_touches;
use super::undo::{begin_attempt, undo};
use super::{Agreement, OnTouch, Stage, Stats, StepScratch, Watch, World, search};
use crate::world::bodies::Bodies;
use crate::world::bodies::discs::Discs;
use jostle_base::error::{Error, Result};
use jostle_base::{interrupt, memory};

/// Share of the usual displacement by which the bounds in which walls are searched are larger than
/// those for particles.
/// Without it many discs that had become faster left the bounds, and for each the tree of walls was
/// searched (docs/benchmarks-notes.md, walls).
const SPARE: f32 = 0.3;

/// Times in a step that only the islands wake that an attempt would touch. The next time all wake.
const MAX_WAKINGS: usize = 4;

impl World {
    /// Advances the world by `steps` times `dt` seconds. After a refused or interrupted step the world has
    /// the state before that step; previous steps remain done.
    pub fn step(&mut self, dt: f64, steps: usize) -> Result<()> {
        self.step_watched(dt, steps, &mut |_, _| ())
    }

    /// As [`World::step`]; `watch` is called when a stage of a step ends.
    pub fn step_watched(&mut self, dt: f64, steps: usize, watch: &mut Watch<'_>) -> Result<()> {
        let single = dt as f32;
        if !(single > 0.0 && single.is_finite()) {
            return Err(Error::of("dt", dt, "it must be finite and above 0 in float32"));
        }
        let _awake = self.keep_threads_awake();
        for _ in 0..steps {
            // Where all that can move sleeps, nothing changes. The ranks of a distributed world
            // find this out together, in `migrate`.
            let done = if self.halo.is_whole() && is_still(&self.bodies, &self.influences) {
                skip_step(self)
            } else {
                self.bodies.forget_tree();
                self.step_until_complete(dt, watch)
            };
            self.record.keep_or_cancel(done.is_ok(), dt);
            done?;
            self.time += dt;
        }
        Ok(())
    }

    /// Makes a step. If it fails on any process, it fails on all, and changes nothing.
    ///
    /// An attempt that reaches sleeping islands is undone, they wake, and the next attempt begins. So no particle
    /// meets a sleeping one, and the stages do not depend on sleeping. After [`MAX_WAKINGS`] such attempts the next
    /// one wakes all islands, so that the loop ends. An attempt on which processes do not agree is repeated with more
    /// ghosts.
    fn step_until_complete(&mut self, dt: f64, watch: &mut Watch<'_>) -> Result<()> {
        let single = dt as f32;
        // Motors drive and pumps move before the first attempt, because all attempts begin with the same
        // velocities. They are taken back only if the step fails.
        let (mut driven, mut pumped) = (Driven::default(), Pumped::default());
        let protocol = self.halo.protocol();
        let mut repeat = |world: &mut Self| {
            let mut wakings = 0;
            // An attempt completes, or leaves no trace in the world. What it has learned decides
            // how the next one begins: which islands wake, or how wide the halo is. The loop ends.
            // Each waking removes sleeping islands, and the last removes all. Each disagreement
            // doubles the margin of the halo, until every rank has all particles.
            loop {
                protocol.gather(world, single)?;
                begin_attempt(world)?;
                let outcome = world.step_once(single, watch);
                let outcome = outcome.and_then(|outcome| world.end_attempt(outcome, dt));
                // An attempt that failed with an error is undone as well.
                if !matches!(outcome, Ok(Outcome::Complete(_))) {
                    undo(world);
                    protocol.undo(world);
                }
                match outcome? {
                    Outcome::Complete(_) => return Ok(()),
                    Outcome::Disagreement(agreement) => protocol.widen(world, agreement, dt)?,
                    Outcome::MeetsSleepers => {
                        wake_touched(world, wakings == MAX_WAKINGS)?;
                        wakings += 1;
                    }
                }
            }
        };
        let done = protocol.guard(self, &mut |world| {
            // All that follows is within `guard`. So an error of one rank ends the step on all, and
            // none waits for a message that never comes.
            let World { influences, bodies, boundaries, time, .. } = &mut *world;
            let seconds = (*time, f64::from(single));
            drive(influences, bodies, boundaries, seconds, &mut driven)?;
            protocol.begin_step(world);
            check_displacements(world, single)?;
            let Boundaries { walls, ids, .. } = &world.boundaries;
            walls.check_displacements(f64::from(single), |wall| ids.of(wall))?;
            if !protocol.migrate(world)? {
                return Ok(());
            }
            let World { influences, bodies, .. } = &mut *world;
            if pump(influences, bodies, seconds, &mut pumped)? {
                check_displacements(world, single)?;
            }
            // Between attempts the islands must stay awake, so waking is taken back only here.
            repeat(world).inspect_err(|_| {
                protocol.give_up(world);
                cancel_waking(world);
            })
        });
        if done.is_err() {
            pumped.restore(&mut self.bodies);
            driven.restore(&mut self.bodies, &mut self.boundaries);
        }
        done
    }

    /// Makes an attempt final, unless it must be repeated. If there is an error, it can be undone.
    fn end_attempt(&mut self, outcome: Outcome, dt: f64) -> Result<Outcome> {
        let meets_sleepers = matches!(outcome, Outcome::MeetsSleepers);
        let agreement = match outcome {
            Outcome::Disagreement(known) => known,
            // Processes have compared it before particles merged, and make no further call.
            Outcome::Complete(_) if self.settings.on_touch == OnTouch::Merge => Agreement::Same,
            _ => self.halo.protocol().compare(self, meets_sleepers)?,
        };
        // If ranks contradict each other, the islands that they would touch may be wrong, too.
        if agreement != Agreement::Same {
            return Ok(Outcome::Disagreement(agreement));
        }
        let Outcome::Complete(plan) = outcome else { return Ok(outcome) };
        // From here on the attempt counts, unless there is an error.
        let particles = &mut self.bodies.awake.particles;
        apply_andersen(&self.influences, particles, self.time, dt as f32, plan.threads);
        self.boundaries.end_attempt()?;
        if self.settings.track_events {
            let Self { contacts, record, bodies, boundaries, halo, .. } = self;
            let touching = contacts.touching().map(|contact| contact.indices);
            record_pairs(record, bodies, &**halo, touching)?;
            let at_walls = boundaries.impulses.iter().map(|of| [of.row, of.wall]);
            record_walls(record, (bodies, boundaries), &**halo, at_walls)?;
        }
        self.record.make_room()?;
        // Falling asleep is the last that may fail. What comes after it cannot be undone.
        fall_asleep(self, &plan, dt)?;
        forget_woken(self);
        self.record.end_step();
        self.halo.protocol().end_step(self);
        Ok(outcome)
    }

    /// One attempt at a step: forces → bounds → tree → candidate pairs → order of particles → contacts →
    /// sub-steps → store. It has one part, unless particles merge on a torus. It ends early if particles meet
    /// sleeping ones, which it lists in `islands`, or if processes do not agree.
    fn step_once(&mut self, dt: f32, watch: &mut Watch<'_>) -> Result<Outcome> {
        let (parts, substeps) = self.begin_parts(dt)?;
        let dt = dt / parts as f32;
        let mut part = 0;
        loop {
            part += 1;
            self.halo.protocol().renew(self, dt)?;
            interrupt::check()?;
            // Forces come first, because bounds must contain the displacements by them.
            self.apply_forces(dt, substeps)?;
            if !self.influences.is_empty() || self.external.act() {
                watch(Stage::Forces, self);
            }
            let mut plan = Plan::new(self, dt, substeps);
            plan.is_bounded &= find_bounds(
                &self.bodies.awake.particles,
                &self.settings,
                &mut self.scratch,
                &plan,
            )?;
            watch(Stage::Bounds, self);
            interrupt::check()?;
            build_tree(self)?;
            watch(Stage::Build, self);
            interrupt::check()?;
            // As early as possible, because the attempt is undone if this is true.
            if find_touched_on_all(self, dt)? {
                return Ok(Outcome::MeetsSleepers);
            }
            find_candidates(self, &plan)?;
            watch(Stage::Pairs, self);
            interrupt::check()?;
            // From here on the order of indices is the canonical one: Morton order, ties by the
            // state. All sums, contacts and loops use it, so results do not depend on the order of
            // adding. It is the order of the tree, so candidate pairs, listed above, and near walls
            // have the new indices already. `tree.rows()` has the old index of each new one: by old
            // indices `find_touched_on_all` reads the columns, before this line, and `make_contacts`
            // finds the impulses of the last step.
            reorder(self, plan.threads)?;
            self.halo.protocol().begin_part(self);
            // Only the contacts show which heavy particles press on light ones.
            let refinement = self.make_contacts(&plan)?;
            let plan = plan.refined(self, refinement);
            let StepScratch { tree, reaches, horizon, .. } = &self.scratch;
            let bounds = (&reaches[..], SPARE * horizon.usual_speed * plan.horizon);
            self.boundaries.find_near(tree, bounds, &self.settings, f64::from(dt))?;
            watch(Stage::Contacts, self);
            let StepScratch { motions, spins, torques, .. } = &mut self.scratch;
            torques.list(&self.external, &self.bodies.awake, &*self.halo)?;
            let particles = &mut self.bodies.awake.particles;
            if self.external.turns() {
                memory::resize_default(&mut particles.spins, particles.positions.len())?;
            }
            load_motions(particles, self.settings.on_touch, &plan, (motions, spins))?;
            self.run_substeps(&plan, watch)?;
            self.halo.protocol().end_part(self);
            // Collisions may have carried particles beyond the bounds that were tested before.
            if find_touched_beyond_reach_on_all(self)? {
                return Ok(Outcome::MeetsSleepers);
            }
            // Particles must not merge on trajectories that another rank contradicts.
            if self.settings.on_touch == OnTouch::Merge {
                let agreement = self.halo.protocol().compare(self, false)?;
                if agreement != Agreement::Same {
                    return Ok(Outcome::Disagreement(agreement));
                }
            }
            // The results of the sub-steps are in `motions` so far; from here on they go to the columns.
            self.boundaries.end_part(f64::from(dt));
            collect_touches(self, plan.threads)?;
            store_motions(self, plan.threads)?;
            let indices = &self.scratch.forces.indices;
            break_springs(&mut self.influences, &self.bodies.awake, indices, &self.settings);
            merge(self)?;
            watch(Stage::Store, self);
            if part == parts {
                return Ok(Outcome::Complete(plan));
            }
        }
    }

    /// Begins an attempt: the number of its parts, and the sub-steps of each.
    fn begin_parts(&mut self, dt: f32) -> Result<(usize, usize)> {
        self.scratch.exhausted.clear();
        self.stats = Stats::default();
        let particles = &self.bodies.awake.particles;
        self.scratch.horizon = Horizon::new(self.everywhere(), particles, &self.settings, dt)?;
        let parts = parts(self, dt)?;
        // The parts share the sub-steps of the whole step.
        Ok((parts, self.substeps().div_ceil(parts)))
    }
}

/// Makes a step in which nothing moves.
fn skip_step(world: &mut World) -> Result<()> {
    interrupt::check()?;
    world.boundaries.impulses.clear();
    world.stats = Stats::default();
    world.record.skip_step();
    Ok(())
}

/// Builds the tree of the bounds.
fn build_tree(world: &mut World) -> Result<()> {
    let extent = match world.halo.take_extent() {
        Some(known) => Some(known),
        None => world.everywhere().extent(&world.bodies.awake.particles.positions)?,
    };
    let World {
        bodies: Bodies { awake: Discs { particles, rows, .. }, .. }, scratch, halo, ..
    } = world;
    let ids = halo.ids();
    // Particles at the same place are sorted by all their values. Of equal ones in a
    // distributed world the id decides, because rows differ between ranks.
    let tie = |a: usize, b: usize| {
        let id = |index: usize| ids.get(rows[index] as usize);
        particles.compare(a, b).then_with(|| id(a).cmp(&id(b)))
    };
    // The Morton order depends on the extent, so it is that of all ranks.
    scratch.tree.set_extent(extent);
    scratch.tree.set_nested();
    scratch.tree.rebuild(&scratch.shapes, world.settings.tree, &tie)
}

/// Finds the pairs of indices whose bounds overlap. If particles pass through each other, they are listed only
/// for events.
fn find_candidates(world: &mut World, plan: &Plan) -> Result<()> {
    // Without resting contacts the pairs need no order.
    let is_sorted = plan.may_rest || world.settings.on_touch != OnTouch::Bounce;
    let StepScratch { tree, listing, pairs, sensed, .. } = &mut world.scratch;
    sensed.clear();
    let tests = match world.settings.on_touch {
        OnTouch::Ignore => {
            pairs.clear();
            if world.settings.track_events {
                search::list(tree, &world.settings, true, listing, sensed)?;
            }
            0
        }
        OnTouch::Bounce | OnTouch::Merge => {
            search::list(tree, &world.settings, is_sorted, listing, pairs)?
        }
    };
    let (nodes, leaves, depth) = (tree.nodes().len(), tree.leaf_count(), tree.depth());
    // The sums and the largest numbers of the parts of the step.
    world.stats.nodes = world.stats.nodes.max(nodes);
    world.stats.leaves = world.stats.leaves.max(leaves);
    world.stats.depth = world.stats.depth.max(depth);
    world.stats.tests += tests;
    Ok(())
}

/// How an attempt at a step ended.
enum Outcome {
    /// With the plan of its last part.
    Complete(Plan),
    /// It would touch sleeping islands, which are listed.
    MeetsSleepers,
    /// The processes do not agree on it.
    Disagreement(Agreement),
}
