//! A step: from positions and velocities to those `dt` seconds later.

use std::cmp::Ordering;

use super::feel::{ForceMemory, accelerate, aside, find_places, springs};
use super::{Memory, OnTouch, Stage, Stats, World, merge, search};
use crate::error::{Error, Result};
use crate::forces;
use crate::integrate::{self, Sweep};
use crate::motion::Motion;
use crate::parallel;
use crate::particles::{self, Particles};
use crate::resolve::{self, Rules, Scene};

/// Bounces slower than this many steps' worth of gravity are not bounces.
const REST_STEPS: f32 = 3.0;

/// Pairs that may touch in one step before it is refused: four gibibytes of them.
pub(super) const MAX_CANDIDATES: usize = 1 << 25;

/// Fewer particles than this are not worth waking other threads for.
const WORTH_WAKING: usize = 12_000;

/// Parts into which a step on a torus is cut at most.
const MAX_PARTS: f32 = 1000.0;

impl World {
    /// Lets `steps` times `dt` seconds pass. `watch` is told when a stage ends.
    pub fn step(
        &mut self,
        dt: f64,
        steps: usize,
        watch: &mut (dyn FnMut(Stage) + Send),
    ) -> Result<()> {
        let single = dt as f32;
        if !(single > 0.0 && single.is_finite()) {
            return Err(Error::of("dt", dt, "it must be finite and above 0"));
        }
        let threads = self.threads();
        parallel::among(threads, || self.step_often(single, dt, steps, watch))
    }

    /// The threads to use: one for a small world.
    pub(super) fn threads(&self) -> Option<usize> {
        if self.len() < WORTH_WAKING { Some(1) } else { self.settings.tree.threads }
    }

    fn step_often(
        &mut self,
        single: f32,
        dt: f64,
        steps: usize,
        watch: &mut (dyn FnMut(Stage) + Send),
    ) -> Result<()> {
        for _ in 0..steps {
            let parts = self.parts(single)?;
            for _ in 0..parts {
                self.step_once(single / parts as f32, watch)?;
            }
            self.time += dt;
        }
        Ok(())
    }

    /// How many parts a step needs so that nothing outruns its images.
    fn parts(&self, dt: f32) -> Result<usize> {
        let gravity = self.settings.gravity;
        let ways = self.particles.velocities.iter().map(|v| {
            let way = |k: usize| (v[k].abs() + gravity[k].abs() * dt) * dt;
            way(0).max(way(1))
        });
        let longest = ways.fold(0.0, f32::max);
        if longest > particles::FARTHEST {
            let rule = format!(
                "a particle would move by {longest:e}, more than {:e}",
                particles::FARTHEST
            );
            return Err(Error::of("dt", dt, &rule));
        }
        let parts = (longest / self.settings.container.reach()).ceil().max(1.0);
        if parts > MAX_PARTS {
            let rule = format!(
                "a particle would circle the torus {} times; take smaller steps",
                parts / 8.0
            );
            return Err(Error::of("dt", dt, &rule));
        }
        Ok(parts as usize)
    }

    /// The order of a step, spelled once: positions → sweeps → tree → candidate
    /// pairs → contacts → resolved velocities and positions.
    fn step_once(&mut self, dt: f32, watch: &mut (dyn FnMut(Stage) + Send)) -> Result<()> {
        self.feel(dt)?;
        if !self.forces.is_empty() {
            watch(Stage::Forces);
        }
        self.sweep(dt);
        watch(Stage::Integrate);
        self.build()?;
        watch(Stage::Build);
        self.candidates()?;
        watch(Stage::Pairs);
        self.arrange();
        self.meet();
        watch(Stage::Contacts);
        self.resolve(dt, watch);
        self.break_springs();
        self.merge();
        watch(Stage::Resolve);
        Ok(())
    }

    /// Finds out how far each particle may get.
    fn sweep(&mut self, dt: f32) {
        let threads = self.threads();
        let Memory { sweeps, shapes, forces, .. } = &mut self.memory;
        let ForceMemory { accelerations, reaches, .. } = &*forces;
        let (particles, settings) = (&self.particles, &self.settings);
        let len = particles.len();
        sweeps.resize(len, Sweep::default());
        parallel::for_chunks(threads, sweeps, |first, sweeps| {
            for (sweep, place) in sweeps.iter_mut().zip(first..) {
                let position = particles.positions[place];
                *sweep = if particles.movable[place] {
                    let (velocity, radius) = (particles.velocities[place], particles.radii[place]);
                    let sweep = Sweep::new(position, velocity, radius, settings.gravity, dt);
                    let (by, reach) = (accelerations.get(place), reaches.get(place));
                    match aside(by, reach, dt) {
                        None => sweep,
                        Some(way) => sweep.widened(way.min(settings.container.reach())),
                    }
                } else {
                    Sweep::still(position)
                };
            }
        });
        let half_sizes = shapes.half_sizes.get_or_insert_default().rows_mut();
        shapes.centers.resize(len, [0.0; 2]);
        half_sizes.resize(len, [0.0; 2]);
        parallel::for_chunks_of_two(threads, &mut shapes.centers, half_sizes, |first, c, h| {
            for ((center, half_size), sweep) in c.iter_mut().zip(h).zip(&sweeps[first..]) {
                (*center, *half_size) = sweep.as_box();
            }
        });
        shapes.radii.rows_mut().clone_from(&particles.radii);
    }

    /// Builds the tree of the sweeps.
    fn build(&mut self) -> Result<()> {
        let particles = &self.particles;
        let memory = &mut self.memory;
        let tie = |a: usize, b: usize| compare_particles(particles, a, b);
        memory.tree.rebuild(&memory.shapes, self.settings.tree, &tie)
    }

    /// Brings everything into the order of the tree. Nothing can fail any more.
    fn arrange(&mut self) {
        let threads = self.threads();
        let memory = &mut self.memory;
        let order = memory.tree.rows();
        memory.particles.gather(&self.particles, order, threads);
        std::mem::swap(&mut memory.particles, &mut self.particles);
        gather(&mut memory.rows, &mut self.rows, order, threads);
        gather(&mut memory.wall_pushes, &mut self.wall_pushes, order, threads);
        gather(&mut memory.old_sweeps, &mut memory.sweeps, order, threads);
        if self.forces.is_empty() {
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

    /// The pairs of places whose sweeps overlap. None are needed where all pass through all.
    fn candidates(&mut self) -> Result<()> {
        let Memory { tree, sorting, pairs, .. } = &mut self.memory;
        let tests = match self.settings.on_touch {
            OnTouch::Ignore => {
                pairs.clear();
                0
            }
            OnTouch::Bounce | OnTouch::Merge => search::list(tree, &self.settings, sorting, pairs)?,
        };
        let (nodes, leaves, depth) = (tree.nodes().len(), tree.leaf_count(), tree.depth());
        self.stats = Stats { nodes, leaves, depth, tests };
        Ok(())
    }

    /// Contacts from pairs, or meetings where nothing bounces.
    fn meet(&mut self) {
        let threads = self.threads();
        let Memory { tree, pairs, meetings, .. } = &mut self.memory;
        meetings.clear();
        if self.settings.on_touch == OnTouch::Merge {
            merge::expect(pairs, &self.particles, meetings);
            pairs.clear();
        }
        let (particles, restitution) = (&self.particles, self.settings.restitution);
        self.contacts.collect(pairs, particles, restitution, tree.rows(), threads);
    }

    fn resolve(&mut self, dt: f32, watch: &mut (dyn FnMut(Stage) + Send)) {
        let settings = &self.settings;
        let [gx, gy] = settings.gravity;
        let rules = Rules {
            gravity: settings.gravity,
            drag: settings.drag,
            restitution: settings.restitution,
            container: settings.container,
            rest_speed: REST_STEPS * dt * (gx * gx + gy * gy).sqrt(),
            thermostat: forces::thermostat(&self.forces),
            threads: self.threads(),
        };
        let memory = &mut self.memory;
        let len = self.particles.len();
        memory.motions.resize(len);
        let (motions, particles) = (&memory.motions, &self.particles);
        parallel::for_rows(rules.threads, len, |place| {
            let (position, velocity) = (particles.positions[place], particles.velocities[place]);
            motions.set(place as u32, Motion { position, velocity, ..Motion::default() });
        });
        let mut scene = Scene {
            particles: &self.particles,
            motions: &memory.motions,
            sweeps: &memory.sweeps,
            contacts: &mut self.contacts,
            wall_pushes: &mut self.wall_pushes,
            memory: &mut memory.resolving,
        };
        let forces = &mut memory.forces;
        let h = dt / settings.substeps as f32;
        for substep in 0..settings.substeps {
            if substep > 0 && forces::pull(&self.forces) {
                watch(Stage::Resolve);
                for (place, halfway) in forces.halfway.iter_mut().enumerate() {
                    let (position, velocity) =
                        (motions.position(place as u32), motions.velocity(place as u32));
                    let there = integrate::halfway(position, velocity, h);
                    *halfway = settings.container.wrap(there);
                }
                accelerate(&self.forces, scene.particles, settings, forces);
                watch(Stage::Forces);
            }
            resolve::kick(&scene, &rules, &forces.accelerations, h);
            if !forces.sprung.is_empty() && !self.forces.is_empty() {
                watch(Stage::Resolve);
                forces.sprung.act(motions, h);
                watch(Stage::Forces);
            }
            resolve::substep(&mut scene, &rules, h);
            merge::note(&mut memory.meetings, motions, rules.threads);
        }
        resolve::measure_touching(&mut scene, &rules);
        self.contacts.remember(self.particles.len());
        let Particles { positions, velocities, .. } = &mut self.particles;
        let motions = &memory.motions;
        parallel::for_chunks_of_two(rules.threads, positions, velocities, |first, p, v| {
            for ((position, velocity), place) in p.iter_mut().zip(v).zip(first as u32..) {
                let limit = particles::FARTHEST;
                let motion = motions.get(place);
                let allowed = motion.position.map(|v| v.clamp(-limit, limit));
                *position = settings.container.wrap(allowed);
                *velocity = motion.velocity.map(|v| v.clamp(-limit, limit));
            }
        });
    }
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

/// Orders particles whose sweeps have the same centre by everything else.
fn compare_particles(all: &Particles, a: usize, b: usize) -> Ordering {
    let numbers = |place: usize| {
        let ([x, y], [u, v]) = (all.positions[place], all.velocities[place]);
        [x, y, u, v, all.radii[place], all.masses[place], all.restitutions[place]]
    };
    let pairs = numbers(a).into_iter().zip(numbers(b));
    let by_numbers = pairs.map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne());
    by_numbers.unwrap_or(Ordering::Equal).then_with(|| all.movable[a].cmp(&all.movable[b]))
}
