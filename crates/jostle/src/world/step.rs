//! A step: from positions and velocities to those `dt` seconds later.

use std::cmp::Ordering;
use std::sync::atomic::{AtomicBool, Ordering as Atomic};

use super::bounds::largest;
use super::feel::{find_places, springs};
use super::undo::Ordered;
use super::{Memory, OnTouch, Stage, Stats, World, search, touches};
use crate::container::{Container, MAX_WALLS, MOST_TOURS};
use crate::error::{Error, Result};
use crate::forces;
use crate::interrupt;
use crate::motion::Motion;
use crate::parallel;
use crate::particles::{FARTHEST, Particles, Spin, wrap_angle};
use crate::space::Id;

/// Candidate pairs of a step at most. They take 256 MiB, with everything that is stored for each
/// about four GiB.
pub(super) const MAX_CANDIDATES: usize = 1 << 25;

/// Repetitions of a step that wake only islands that would be touched. One more wakes all.
const MOST_ATTEMPTS: usize = 4;

/// Fewer particles than this are not worth sharing with other threads.
const WORTH_SHARING: usize = 5000;

/// Fewer particles than this are not worth waking other threads for.
const WORTH_WAKING: usize = 24_000;

/// Particles that one thread stores at a time.
const STORED: usize = 1 << 14;

impl World {
    /// Advances the world by `steps` times `dt` seconds. `watch` is called when a stage ends. After
    /// a refused or interrupted step the world has the state before that step; previous steps
    /// remain done.
    pub fn step(
        &mut self,
        dt: f64,
        steps: usize,
        watch: &mut (dyn FnMut(Stage) + Send),
    ) -> Result<()> {
        let single = dt as f32;
        if !(single > 0.0 && single.is_finite()) {
            return Err(Error::of("dt", dt, "it must be finite and above 0 in float32"));
        }
        self.step_often(single, dt, steps, watch)
    }

    /// The threads to use: one for a small world. Those of a large one are woken.
    pub(super) fn threads(&self) -> Option<usize> {
        let threads = self.settings.tree.threads;
        parallel::threads_for(threads, self.rows.len(), WORTH_SHARING, WORTH_WAKING)
    }

    fn step_often(
        &mut self,
        single: f32,
        dt: f64,
        steps: usize,
        watch: &mut (dyn FnMut(Stage) + Send),
    ) -> Result<()> {
        for _ in 0..steps {
            let done = self.step_awake(single, dt, watch);
            let record_before = self.memory.record_before.take();
            if done.is_err() {
                if let Some(record) = record_before {
                    self.record = record;
                }
                return done;
            }
            self.time += dt;
        }
        Ok(())
    }

    /// Makes a step, if it changes anything.
    fn step_awake(
        &mut self,
        single: f32,
        dt: f64,
        watch: &mut (dyn FnMut(Stage) + Send),
    ) -> Result<()> {
        if !self.is_still() {
            return self.step_driven(single, dt, watch);
        }
        interrupt::check()?;
        self.wall_impulses.clear();
        self.stats = Stats::default();
        self.record.is_open |= !self.record.knows_sleepers;
        Ok(())
    }

    /// Makes a step with the velocities that motors give.
    fn step_driven(
        &mut self,
        single: f32,
        dt: f64,
        watch: &mut (dyn FnMut(Stage) + Send),
    ) -> Result<()> {
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

    /// Makes a step. If particles would meet sleeping ones, wakes these and makes it anew.
    fn step_until_complete(
        &mut self,
        single: f32,
        dt: f64,
        watch: &mut (dyn FnMut(Stage) + Send),
    ) -> Result<()> {
        self.check_displacements(single)?;
        self.walls.check_displacements(f64::from(single))?;
        let (awake, had_friction) = (self.rows.len(), !self.wall_frictions.is_empty());
        for attempt in 0.. {
            self.begin();
            let mut done = self.step_in_parts(single, watch);
            let mut touched = std::mem::take(&mut self.memory.touched);
            if done.is_ok() && touched.is_empty() {
                self.meet_bath(single);
                self.keep_wall_pushes();
                touches::add_up(&mut self.wall_impulses);
                self.record_touching();
                done = self.fall_asleep(dt);
                if done.is_ok() {
                    self.asleep.forget_woken();
                    self.close_step();
                    return Ok(());
                }
            }
            self.undo();
            if done.is_err() {
                self.cancel_waking(awake, had_friction);
                return done;
            }
            if attempt == MOST_ATTEMPTS {
                touched = self.asleep.islands().collect();
            }
            self.wake(&touched);
        }
        Ok(())
    }

    fn step_in_parts(&mut self, dt: f32, watch: &mut (dyn FnMut(Stage) + Send)) -> Result<()> {
        self.memory.exhausted.clear();
        // On a torus, fast particles may make others fast, so each part is chosen anew.
        let is_torus = matches!(self.settings.container, Container::Torus { .. });
        let mut left = dt;
        loop {
            self.memory.usual_speed = self.usual_speed();
            let parts = self.parts(left);
            let substeps = (self.substeps() as f32 * (left / dt)).ceil() as usize;
            let substeps = substeps.max(1).div_ceil(parts);
            let part = left / parts as f32;
            for _ in 0..if is_torus { 1 } else { parts } {
                self.step_once(part, substeps, watch)?;
                if !self.memory.touched.is_empty() {
                    return Ok(());
                }
            }
            if !is_torus || parts == 1 {
                return Ok(());
            }
            left -= part;
        }
    }

    /// The smallest id of a particle with this `number`, for an error.
    pub(super) fn id_of(&self, number: f32, of: impl Fn(usize) -> f32) -> Id {
        let places = (0..self.rows.len()).filter(|&place| of(place) == number);
        places.map(|place| self.ids.of(self.rows[place])).min().unwrap_or(0)
    }

    /// The longer side of the box of a particle's displacement without collisions in `dt` seconds,
    /// or more.
    fn displacement(&self, place: usize, dt: f32) -> f32 {
        let (gravity, v) = (self.settings.gravity, self.particles.velocities[place]);
        let along = |k: usize| (v[k].abs() + gravity[k].abs() * dt) * dt;
        along(0).max(along(1))
    }

    /// The largest of these displacements.
    fn longest_displacement(&self, dt: f32) -> f32 {
        largest((0..self.rows.len()).map(|place| self.displacement(place, dt)))
    }

    /// Refuses a step in which a particle would move too far.
    fn check_displacements(&self, dt: f32) -> Result<()> {
        let longest = self.longest_displacement(dt);
        let tours = self.settings.container.tours(longest);
        if longest <= FARTHEST && tours <= MOST_TOURS {
            return Ok(());
        }
        let id = self.id_of(longest, |place| self.displacement(place, dt));
        let rule = if longest > FARTHEST {
            let most = FARTHEST;
            format!("particle {id} would move by {longest:e}, more than {most:e}")
        } else {
            format!("particle {id} would circle the torus {tours} times; take smaller steps")
        };
        Err(Error::of("dt", dt, &rule))
    }

    /// The number of parts of a step of `dt` seconds.
    fn parts(&self, dt: f32) -> usize {
        match self.settings.on_touch {
            OnTouch::Ignore => 1,
            OnTouch::Bounce => self.parts_with_few_candidates(dt),
            // Merging particles touch only their nearest images.
            OnTouch::Merge => {
                let longest = self.longest_displacement(dt);
                (longest / self.settings.container.reach()).ceil().max(1.0) as usize
            }
        }
    }

    /// The order of a step: forces → bounds → tree → candidate pairs → order of particles →
    /// contacts → sub-steps (kicks, flights, position correction). It ends early if particles meet
    /// sleeping ones, and lists these.
    pub(super) fn step_once(
        &mut self,
        dt: f32,
        substeps: usize,
        watch: &mut (dyn FnMut(Stage) + Send),
    ) -> Result<()> {
        interrupt::check()?;
        self.memory.substeps = substeps;
        self.feel(dt)?;
        if !self.forces.is_empty() || !self.given.is_empty() {
            watch(Stage::Forces);
        }
        self.bound(dt);
        watch(Stage::Bounds);
        interrupt::check()?;
        self.build()?;
        watch(Stage::Build);
        interrupt::check()?;
        if self.is_near_sleepers()? {
            return Ok(());
        }
        self.candidates()?;
        watch(Stage::Pairs);
        interrupt::check()?;
        self.arrange();
        self.prepare();
        self.find_near_walls(dt)?;
        watch(Stage::Contacts);
        self.fly(dt, watch)?;
        if self.has_left_bounds_to_sleepers()? {
            return Ok(());
        }
        self.walls.end_step(f64::from(dt));
        self.record()?;
        self.break_springs();
        self.merge();
        watch(Stage::Store);
        Ok(())
    }

    /// Finds the walls that may come near each particle in `dt` seconds.
    fn find_near_walls(&mut self, dt: f32) -> Result<()> {
        self.walls.begin_step(self.settings.tree, f64::from(dt))?;
        let Memory { near_walls, tree, reaches, .. } = &mut self.memory;
        near_walls.fill(&self.walls, tree, reaches, self.settings.method, MAX_CANDIDATES)
    }

    /// Builds the tree of the bounds.
    fn build(&mut self) -> Result<()> {
        let (particles, forces, rows) = (&self.particles, &self.forces, &self.rows);
        let memory = &mut self.memory;
        let tie = |a: usize, b: usize| {
            let order = compare_particles(particles, a, b);
            order.then_with(|| forces::compare_kinds(forces, rows[a], rows[b]))
        };
        memory.tree.rebuild(&memory.shapes, self.settings.tree, &tie)
    }

    /// Reorders all columns into the order of the tree. The first part of a step keeps the old
    /// order for [`World::undo`].
    fn arrange(&mut self) {
        let threads = self.threads();
        let memory = &mut self.memory;
        let order = memory.tree.rows();
        let spare =
            if memory.before.arranged { &mut memory.spare } else { &mut memory.before.ordered };
        let Ordered { particles, rows, wall_pushes, wall_frictions, drifts } = spare;
        particles.gather(&self.particles, order, threads);
        std::mem::swap(particles, &mut self.particles);
        gather(rows, &mut self.rows, order, threads);
        gather(wall_pushes, &mut self.wall_pushes, order, threads);
        wall_frictions.clear();
        if self.wall_frictions.is_empty() {
            std::mem::swap(wall_frictions, &mut self.wall_frictions);
        } else {
            gather(wall_frictions, &mut self.wall_frictions, order, threads);
        }
        drifts.clear();
        if self.drifts.is_empty() {
            std::mem::swap(drifts, &mut self.drifts);
        } else {
            gather(drifts, &mut self.drifts, order, threads);
        }
        memory.touched_before.clear();
        if memory.before.arranged {
            let indices = &mut memory.indices;
            indices.resize(order.len(), 0);
            (0..).zip(order).for_each(|(index, &before)| indices[before as usize] = index);
            let touched = self.contacts.touching();
            let moved = touched.map(|contact| {
                (contact.places.map(|place| indices[place as usize]), contact.totals)
            });
            memory.touched_before.extend(moved);
        } else {
            self.contacts.exchange(&mut memory.before.contacts);
            memory.before.arranged = true;
        }
        gather(&mut memory.old_reaches, &mut memory.reaches, order, threads);
        if self.forces.is_empty() && self.given.is_empty() {
            return;
        }
        let forces = &mut memory.forces;
        if !forces.accelerations.is_empty() {
            gather(&mut forces.old_accelerations, &mut forces.accelerations, order, threads);
        }
        find_places(&self.forces, &self.rows, &mut forces.places);
        let all = springs(&self.forces).flat_map(|springs| &springs.0);
        let inverse_mass = |place: usize| self.particles.inverse_mass(place);
        forces.sprung.prepare(all, &forces.places, self.settings.container, inverse_mass);
    }

    /// The pairs of places whose bounds overlap; none if particles pass through each other.
    fn candidates(&mut self) -> Result<()> {
        // Without resting contacts the pairs need no order.
        let is_sorted = self.may_rest() || self.settings.on_touch != OnTouch::Bounce;
        let Memory { tree, listing, pairs, sensed, .. } = &mut self.memory;
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
        self.stats = Stats { nodes, leaves, depth, tests, unresolved: 0 };
        Ok(())
    }

    /// Keeps the impulses for the next step, and the positions and velocities of the motions.
    pub(super) fn store(&mut self) -> Result<()> {
        let (threads, settings, memory) = (self.threads(), &self.settings, &self.memory);
        if let Some(contact) = self.contacts.remember(self.particles.len()) {
            let place = contact.places[0] as usize;
            return Err(self.not_finite("contact_impulses", place, "inf"));
        }
        let Particles { positions, residuals, velocities, spins, .. } = &mut self.particles;
        let (motions, wall_pushes) = (&memory.motions, &self.wall_pushes);
        let any = AtomicBool::new(false);
        let chunks = || (0..).step_by(STORED);
        let columns = positions.chunks_mut(STORED).zip(residuals.chunks_mut(STORED));
        let columns = columns.zip(velocities.chunks_mut(STORED)).zip(chunks());
        parallel::for_each(threads, columns, |(((positions, residuals), velocities), first)| {
            let columns = positions.iter_mut().zip(residuals).zip(velocities).zip(first..);
            for (((position, residual), velocity), place) in columns {
                let mut motion = motions.get(place);
                let wall_pushes = &wall_pushes[place as usize];
                if !(is_allowed(&motion) & (*wall_pushes == [0.0; MAX_WALLS])) {
                    if !is_finite(&motion, wall_pushes) {
                        any.store(true, Atomic::Relaxed);
                    }
                    clamp(&mut motion);
                }
                (*position, *residual) =
                    settings.container.wrap_exact(motion.position, motion.residual);
                *velocity = motion.velocity;
            }
        });
        parallel::for_chunks(threads, spins, |first, spins| {
            for (spin, place) in spins.iter_mut().zip(first as u32..) {
                let (velocity, angle) = (memory.spins.velocity(place), memory.spins.angle(place));
                if !velocity.is_finite() {
                    any.store(true, Atomic::Relaxed);
                }
                spin.velocity = velocity.clamp(-FARTHEST, FARTHEST);
                spin.angle = wrap_angle(angle);
            }
        });
        if any.into_inner() { Err(self.name_what_is_not_finite()) } else { Ok(()) }
    }

    /// Returns an error with the first row whose number is not finite after the sub-steps.
    fn name_what_is_not_finite(&self) -> Error {
        let motion = |place: usize| self.memory.motions.get(place as u32);
        let spins = &self.memory.spins;
        let spin = |place: usize| {
            if spins.is_empty() { 0.0 } else { spins.velocity(place as u32) }
        };
        let bad = |&place: &usize| {
            !is_finite(&motion(place), &self.wall_pushes[place]) || !spin(place).is_finite()
        };
        let place = (0..self.rows.len()).filter(bad).min_by_key(|&place| self.rows[place]);
        let place = place.expect("only called if there is one");
        let Motion { position, velocity, .. } = motion(place);
        let columns: [(&str, &[f32]); 4] = [
            ("angular_velocities", &[spin(place)]),
            ("velocities", &velocity),
            ("positions", &position),
            ("wall_impulses", &self.wall_pushes[place]),
        ];
        let broken =
            columns.into_iter().find(|(_, numbers)| !numbers.iter().all(|v| v.is_finite()));
        let (argument, numbers) = broken.expect("one of them is not finite");
        let numbers: Vec<String> = numbers.iter().map(ToString::to_string).collect();
        self.not_finite(argument, place, &format!("({})", numbers.join(", ")))
    }

    fn not_finite(&self, argument: &'static str, place: usize, value: &str) -> Error {
        let row = self.rows[place];
        let (index, id) = (row as usize, self.ids.of(row));
        Error::NotFinite { argument, index, id, value: value.to_string() }
    }
}

/// Whether all numbers are finite and not too large.
#[inline(always)]
fn is_allowed(Motion { position: [x, y], velocity: [u, v], .. }: &Motion) -> bool {
    let is_small = |value: &f32| value.abs() <= FARTHEST;
    is_small(x) & is_small(y) & is_small(u) & is_small(v)
}

/// Makes numbers that are too large the largest allowed ones.
fn clamp(motion: &mut Motion) {
    let allowed = |vector: [f32; 2]| vector.map(|v| v.clamp(-FARTHEST, FARTHEST));
    if allowed(motion.position) != motion.position {
        motion.residual = [0.0; 2];
    }
    motion.position = allowed(motion.position);
    motion.velocity = allowed(motion.velocity);
}

/// Whether a step may end with these numbers.
#[inline(always)]
fn is_finite(motion: &Motion, wall_pushes: &[f32; MAX_WALLS]) -> bool {
    let Motion { position: [x, y], velocity: [u, v], .. } = motion;
    // A product with 0 is 0, or not a number.
    let [a, b, c, d] = wall_pushes;
    [x, y, u, v, a, b, c, d].into_iter().map(|value| value * 0.0).sum::<f32>() == 0.0
}

/// Reorders a column into its spare and swaps the two.
fn gather<V: Copy + Default + Send + Sync>(
    spare: &mut Vec<V>,
    column: &mut Vec<V>,
    order: &[u32],
    threads: Option<usize>,
) {
    parallel::gather(threads, spare, column, order);
    std::mem::swap(spare, column);
}

/// Orders particles whose bounds have the same centre by everything else.
fn compare_particles(all: &Particles, a: usize, b: usize) -> Ordering {
    let numbers = |place: usize| {
        let ([x, y], [u, v]) = (all.positions[place], all.velocities[place]);
        let [a, b] = all.residuals[place];
        [x, y, a, b, u, v, all.radii[place], all.masses[place], all.restitutions[place]]
    };
    let turning = |place: usize| {
        let Spin { friction, velocity, angle } = all.spin(place);
        [f64::from(friction), f64::from(velocity), angle]
    };
    let pairs = numbers(a).into_iter().zip(numbers(b));
    let by_numbers = pairs.map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne());
    let pairs = turning(a).into_iter().zip(turning(b));
    let by_turning = pairs.map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne());
    let order = by_numbers.or(by_turning).unwrap_or(Ordering::Equal);
    let order = order.then_with(|| all.movable[a].cmp(&all.movable[b]));
    let order = order.then_with(|| all.filter(a).cmp(&all.filter(b)));
    order.then_with(|| all.is_sensor(a).cmp(&all.is_sensor(b)))
}
