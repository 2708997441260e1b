//! A step: from positions and velocities to those `dt` seconds later.

use std::cmp::Reverse;

use super::reductions::largest;
use super::{Agreement, OnTouch, Stage, Stats, StepScratch, Watch, World, search, touches};
use crate::container::MAX_TOURS;
use crate::events::MAX_COLLISIONS;
use crate::forces;
use crate::particles::FARTHEST;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::interrupt;
use jostle_base::parallel;

/// Candidate pairs of a step at most. They take 256 MiB, with everything that is stored for each
/// about four GiB.
pub(crate) const MAX_CANDIDATES: usize = 1 << 25;

/// Share of the usual displacement by which the bounds in which walls are searched are larger than
/// those for particles.
const SPARE: f32 = 0.3;

/// Repetitions of a step that wake only islands that would be touched. One more wakes all.
pub(crate) const MAX_ATTEMPTS: usize = 4;

/// Fewer particles times sub-steps than this are not worth sharing with other threads.
const WORTH_SHARING: usize = 5000;

/// Fewer particles times sub-steps than this are not worth waking other threads for. Where contacts
/// rest, threads wait for each other more often.
const WORTH_WAKING: usize = 8_000;
const WORTH_WAKING_TO_REST: usize = 20_000;

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
        let work = self.rows.len() * self.substeps();
        let _awake = parallel::keep_awake(self.settings.tree.threads, work, self.worth_waking());
        for _ in 0..steps {
            let done = self.step_awake(single, dt, watch);
            let record_before = self.scratch.record_before.take();
            if done.is_err() {
                if let Some((record, renumbered)) = record_before {
                    self.record = record;
                    self.renumbered = renumbered;
                }
                return done;
            }
            self.time += dt;
        }
        Ok(())
    }

    /// The threads to use: one if there is little work. For much work they are woken.
    pub(crate) fn threads(&self) -> Option<usize> {
        let work = self.rows.len() * self.scratch.substeps.max(1);
        let waking = self.worth_waking();
        parallel::threads_for(self.settings.tree.threads, work, WORTH_SHARING, waking)
    }

    /// The work from which on other threads are woken.
    fn worth_waking(&self) -> usize {
        if self.may_rest() { WORTH_WAKING_TO_REST } else { WORTH_WAKING }
    }

    /// Makes a step, if it changes anything.
    fn step_awake(&mut self, single: f32, dt: f64, watch: &mut Watch<'_>) -> Result<()> {
        if !self.halo.is_whole() || !self.is_still() {
            return self.step_driven(single, dt, watch);
        }
        interrupt::check()?;
        self.wall_impulses.clear();
        self.stats = Stats::default();
        self.record.is_open |= !self.record.knows_sleepers;
        Ok(())
    }

    /// Makes a step with the velocities that motors give.
    fn step_driven(&mut self, single: f32, dt: f64, watch: &mut Watch<'_>) -> Result<()> {
        if forces::motors(&self.forces).next().is_none() {
            return self.step_until_complete(single, dt, watch);
        }
        let before = self.drive(f64::from(single));
        let done = self.step_until_complete(single, dt, watch);
        if done.is_err() {
            self.restore_driven(before);
        }
        done
    }

    /// Makes a step. If it fails on any process, it fails on all, and changes nothing.
    fn step_until_complete(&mut self, single: f32, dt: f64, watch: &mut Watch<'_>) -> Result<()> {
        let protocol = self.halo.protocol();
        protocol.guard(self, &mut |world| {
            protocol.begin_step(world);
            world.check_displacements(single)?;
            world.walls.check_displacements(f64::from(single))?;
            if !protocol.migrate(world)? {
                return Ok(());
            }
            let done = world.attempt_until_complete(single, dt, watch);
            if done.is_err() {
                protocol.give_up(world);
                world.cancel_waking();
            }
            done
        })
    }

    /// Makes a step again and again: with sleeping islands awake that it would touch, or with more
    /// ghosts where processes did not agree.
    fn attempt_until_complete(
        &mut self,
        single: f32,
        dt: f64,
        watch: &mut Watch<'_>,
    ) -> Result<()> {
        let protocol = self.halo.protocol();
        let mut attempt = 0;
        loop {
            protocol.gather(self, single)?;
            self.begin();
            let mut done = self.step_in_parts(single, watch).and_then(|()| self.agreement());
            let mut touched = std::mem::take(&mut self.scratch.touched);
            if matches!(done, Ok(Agreement::Same)) && !self.scratch.meets_sleepers {
                match self.complete(single, dt) {
                    Ok(()) => return Ok(()),
                    Err(error) => done = Err(error),
                }
            }
            self.undo();
            protocol.undo(self);
            match done? {
                Agreement::Same => {
                    protocol.wake_touched(self, &touched, attempt == MAX_ATTEMPTS)?;
                    attempt += 1;
                }
                other => protocol.widen(self, other, dt)?,
            }
            touched.clear();
            self.scratch.touched = touched;
        }
    }

    /// Whether the processes agree on the step.
    fn agreement(&mut self) -> Result<Agreement> {
        match self.scratch.agreement.take() {
            Some(known) => Ok(known),
            None => self.halo.protocol().compare(self),
        }
    }

    /// Whether the processes are known to disagree on the step.
    fn is_disagreed(&self) -> bool {
        self.scratch.agreement.is_some_and(|agreement| agreement != Agreement::Same)
    }

    /// Makes a step final. If there is an error, it can be undone.
    fn complete(&mut self, single: f32, dt: f64) -> Result<()> {
        self.apply_bath(single);
        self.keep_wall_pushes();
        touches::add_up(&mut self.wall_impulses);
        self.record_touching();
        self.fall_asleep(dt)?;
        self.forget_woken();
        self.close_step();
        self.halo.protocol().end_step(self);
        Ok(())
    }

    pub(crate) fn step_in_parts(&mut self, dt: f32, watch: &mut Watch<'_>) -> Result<()> {
        self.scratch.exhausted.clear();
        self.scratch.meets_sleepers = false;
        self.scratch.agreement = None;
        self.stats = Stats::default();
        self.choose_horizon(dt)?;
        let parts = self.parts(dt)?;
        let (substeps, part) = (self.substeps().div_ceil(parts), dt / parts as f32);
        for _ in 0..parts {
            self.halo.protocol().renew(self, part)?;
            let done = self.step_once(part, substeps, watch);
            done.map_err(|error| match error {
                Error::TooManyCollisions { .. } => self.too_many_collisions(),
                other => other,
            })?;
            if self.scratch.meets_sleepers || self.is_disagreed() {
                break;
            }
        }
        Ok(())
    }

    /// The smallest id of a particle with this `number`, for an error.
    pub(crate) fn id_of(&self, number: f32, of: impl Fn(usize) -> f32) -> Id {
        let indices = (0..self.rows.len()).filter(|&index| of(index) == number);
        indices.map(|index| self.id_among_all(self.rows[index])).min().unwrap_or(0)
    }

    /// The longer side of the box of a particle's displacement without collisions in `dt` seconds,
    /// or more.
    fn displacement(&self, index: usize, dt: f32) -> f32 {
        let (gravity, v) = (self.settings.gravity, self.particles.velocities[index]);
        let along = |k: usize| (v[k].abs() + gravity[k].abs() * dt) * dt;
        along(0).max(along(1))
    }

    /// The largest of these displacements.
    fn longest_displacement(&self, dt: f32) -> f32 {
        largest((0..self.rows.len()).map(|index| self.displacement(index, dt)))
    }

    /// Refuses a step in which a particle would move too far.
    pub(crate) fn check_displacements(&self, dt: f32) -> Result<()> {
        let longest = self.longest_displacement(dt);
        let tours = self.settings.container.tours(longest);
        if longest <= FARTHEST && tours <= MAX_TOURS {
            return Ok(());
        }
        let id = self.id_of(longest, |index| self.displacement(index, dt));
        let rule = if longest > FARTHEST {
            let most = FARTHEST;
            format!("particle {id} would move by {longest:e}, more than {most:e}")
        } else {
            format!("particle {id} would circle the torus {tours} times; take smaller steps")
        };
        Err(Error::of("dt", dt, &rule))
    }

    /// The error of a step in which particles of this process have too many collisions, with the id of
    /// the one that has most.
    pub(crate) fn too_many_collisions(&self) -> Error {
        let all = self.rows.iter().zip(&self.scratch.events.counts);
        let own = all.filter(|of| *of.0 < self.halo.own_rows());
        let most = own.map(|(&row, &count)| (Reverse(count), self.id_among_all(row))).min();
        Error::TooManyCollisions { id: most.map_or(0, |(_, id)| id), limit: MAX_COLLISIONS }
    }

    /// The number of parts of a step of `dt` seconds: one, unless particles merge on a torus. These
    /// touch only their nearest images.
    fn parts(&self, dt: f32) -> Result<usize> {
        if self.settings.on_touch != OnTouch::Merge {
            return Ok(1);
        }
        let [longest] = self.largest_of_all([f64::from(self.longest_displacement(dt))])?;
        let parts = longest as f32 / self.settings.container.max_displacement();
        Ok(parts.ceil().max(1.0) as usize)
    }

    /// The order of a step: forces → bounds → tree → candidate pairs → order of particles → contacts →
    /// sub-steps → store. It ends early if particles meet sleeping ones, and lists these.
    pub(crate) fn step_once(
        &mut self,
        dt: f32,
        substeps: usize,
        watch: &mut Watch<'_>,
    ) -> Result<()> {
        interrupt::check()?;
        self.scratch.substeps = substeps;
        self.scratch.kicks.clear();
        self.apply_forces(dt)?;
        if !self.forces.is_empty() || self.given.is_some() {
            watch(Stage::Forces, self);
        }
        self.find_bounds(dt);
        watch(Stage::Bounds, self);
        interrupt::check()?;
        self.build_tree()?;
        watch(Stage::Build, self);
        interrupt::check()?;
        if self.is_near_sleepers(dt)? {
            return Ok(());
        }
        self.find_candidates()?;
        watch(Stage::Pairs, self);
        interrupt::check()?;
        self.reorder();
        self.halo.protocol().begin_part(self);
        self.make_contacts(dt)?;
        self.scratch.substeps *= self.scratch.refinement;
        self.find_near_walls(dt)?;
        watch(Stage::Contacts, self);
        self.load_motions();
        self.run_substeps(dt, watch)?;
        self.halo.protocol().end_part(self);
        if self.has_left_bounds_to_sleepers()? {
            return Ok(());
        }
        if self.settings.on_touch == OnTouch::Merge && self.halo.protocol().must_repeat(self)? {
            return Ok(());
        }
        self.walls.end_step(f64::from(dt));
        self.collect_touches();
        self.store_motions()?;
        self.break_springs();
        self.merge()?;
        watch(Stage::Store, self);
        Ok(())
    }

    /// Finds the walls that may come near each particle in `dt` seconds.
    fn find_near_walls(&mut self, dt: f32) -> Result<()> {
        self.walls.begin_step(self.settings.tree, f64::from(dt))?;
        let StepScratch { near_walls, tree, max_displacements, usual_speed, horizon, .. } =
            &mut self.scratch;
        let bounds = (&max_displacements[..], SPARE * *usual_speed * *horizon);
        near_walls.fill(&self.walls, tree, bounds, self.settings.method, MAX_CANDIDATES)
    }

    /// Builds the tree of the bounds.
    fn build_tree(&mut self) -> Result<()> {
        let extent = self.extent_of_all()?;
        let Self { particles, forces, rows, scratch, halo, .. } = self;
        let ids = halo.ids();
        let tie = |a: usize, b: usize| {
            let order = particles.compare(a, b);
            let (a, b) = (rows[a], rows[b]);
            let order = order.then_with(|| forces::compare_kinds(forces, a, b));
            order.then_with(|| ids.get(a as usize).cmp(&ids.get(b as usize)))
        };
        scratch.tree.set_extent(extent);
        scratch.tree.set_nested();
        scratch.tree.rebuild(&scratch.shapes, self.settings.tree, &tie)
    }

    /// Finds the pairs of indices whose bounds overlap; none if particles pass through each other.
    fn find_candidates(&mut self) -> Result<()> {
        // Without resting contacts the pairs need no order.
        let is_sorted = self.may_rest() || self.settings.on_touch != OnTouch::Bounce;
        let StepScratch { tree, listing, pairs, sensed, .. } = &mut self.scratch;
        sensed.clear();
        let tests = match self.settings.on_touch {
            OnTouch::Ignore => {
                pairs.clear();
                if self.settings.track_events {
                    search::list(tree, &self.settings, true, listing, sensed)?;
                }
                0
            }
            OnTouch::Bounce | OnTouch::Merge => {
                search::list(tree, &self.settings, is_sorted, listing, pairs)?
            }
        };
        let (nodes, leaves, depth) = (tree.nodes().len(), tree.leaf_count(), tree.depth());
        // The sums and the largest numbers of the parts of the step.
        self.stats.nodes = self.stats.nodes.max(nodes);
        self.stats.leaves = self.stats.leaves.max(leaves);
        self.stats.depth = self.stats.depth.max(depth);
        self.stats.tests += tests;
        Ok(())
    }
}
