//! The world: particles that move and collide, and the one function that knows
//! the order of a step.
//!
//! Particles are kept in the canonical order of the last step (Z-order of their
//! sweeps, ties by state), so that neighbours in space are neighbours in memory
//! and every sum and every loop runs in an order that comes from the state.
//! `rows` leads back to the order of adding, which is all that callers see.

mod feel;
mod settings;
mod sums;

use std::cmp::Ordering;
use std::ops::Range;

use crate::contacts::Contacts;
use crate::container::MAX_WALLS;
use crate::error::{Error, Result};
use crate::forces::{self, Force};
use crate::integrate::{self, Sweep};
use crate::motion::{Motion, Motions};
use crate::pairs::{self, SortScratch};
use crate::parallel;
use crate::particles::{self, Particles};
use crate::quadtree::Quadtree;
use crate::resolve::{self, Rules, Scene};
use crate::settings::Method;
use crate::shapes::{MOST_ROWS, Shapes};
use feel::{ForceMemory, accelerate, aside, find_places, springs};
pub use settings::{DEFAULT_SUBSTEPS, WorldSettings};

/// Bounces slower than this many steps' worth of gravity are not bounces.
const REST_STEPS: f32 = 3.0;

/// Pairs that may touch in one step before it is refused: four gibibytes of them.
const MAX_CANDIDATES: usize = 1 << 25;

/// Fewer particles than this are not worth waking other threads for.
const WORTH_WAKING: usize = 12_000;

/// Parts into which a step on a torus is cut at most.
const MAX_PARTS: f32 = 1000.0;

/// The stages of a step, in the order of the data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// How far the step may carry every particle.
    Integrate,
    /// The tree, and the particles in its order.
    Build,
    /// The pairs that may touch.
    Pairs,
    /// Contacts from pairs, coloured.
    Contacts,
    /// Velocities and positions from contacts.
    Resolve,
}

/// What the last step's search looked like.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// Boxes of the tree.
    pub nodes: usize,
    /// Boxes that did not split.
    pub leaves: usize,
    /// Subdivisions above the deepest box.
    pub depth: usize,
    /// Pairs tested.
    pub tests: u64,
}

/// Two particles that touched during the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Their rows, the smaller first.
    pub pair: [u32; 2],
    /// Unit vector from the first to the second.
    pub normal: [f32; 2],
    /// How far they overlapped when the step ended; negative where they had parted.
    pub depth: f32,
}

/// Particles, walls and rules.
///
/// ```
/// use jostle::{Particles, World, WorldSettings};
/// let (left, right) = ([-2.0, 0.0], [2.0, 0.0]);
/// let discs = Particles::new(vec![left, right], vec![[1.0, 0.0], [0.0, 0.0]], vec![1.0; 2], 1.0);
/// let mut world = World::new(discs, WorldSettings::default())?;
/// world.step(0.1, 40, &mut |_| ())?;
/// assert_eq!(world.particles().velocities, [[0.0, 0.0], [1.0, 0.0]]); // they swapped
/// # Ok::<(), jostle::Error>(())
/// ```
#[derive(Debug, Default)]
pub struct World {
    settings: WorldSettings,
    forces: Vec<Force>,
    /// In canonical order, as everything below.
    particles: Particles,
    /// The row, in the order of adding, of the particle at each place.
    rows: Vec<u32>,
    wall_pushes: Vec<[f32; MAX_WALLS]>,
    contacts: Contacts,
    time: f64,
    stats: Stats,
    memory: Memory,
}

/// What a step needs and the next one uses again.
#[derive(Debug, Default)]
struct Memory {
    sweeps: Vec<Sweep>,
    shapes: Shapes<f32>,
    tree: Quadtree<f32>,
    motions: Motions,
    resolving: resolve::Memory,
    sorting: SortScratch,
    /// The pairs that may touch: a sorted list for each torus image.
    pairs: Vec<([f32; 2], Vec<[u32; 2]>)>,
    particles: Particles,
    rows: Vec<u32>,
    wall_pushes: Vec<[f32; MAX_WALLS]>,
    old_sweeps: Vec<Sweep>,
    forces: ForceMemory,
}

impl World {
    /// A world of `particles`. Refuses what no world can hold.
    pub fn new(particles: Particles, settings: WorldSettings) -> Result<Self> {
        let mut world = Self::default();
        world.configure(settings)?;
        world.add(particles)?;
        Ok(world)
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there is no particle.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The rules.
    pub fn settings(&self) -> &WorldSettings {
        &self.settings
    }

    /// Changes the rules. Refused rules leave the old ones.
    pub fn configure(&mut self, settings: WorldSettings) -> Result<()> {
        settings.validate()?;
        settings.container.check_fit(&self.radii())?;
        if settings.container != self.settings.container {
            self.wall_pushes.fill([0.0; MAX_WALLS]);
        }
        self.settings = settings;
        Ok(())
    }

    /// The forces.
    pub fn forces(&self) -> &[Force] {
        &self.forces
    }

    /// Changes the forces. They name particles by their rows. Refused forces leave the
    /// old ones.
    pub fn set_forces(&mut self, forces: Vec<Force>) -> Result<()> {
        forces::validate(&forces, self.len())?;
        self.forces = forces;
        Ok(())
    }

    /// Adds particles behind the others and returns their rows.
    pub fn add(&mut self, mut particles: Particles) -> Result<Range<u32>> {
        particles.validate()?;
        self.settings.container.check_fit(&particles.radii)?;
        rest_the_immovable(&mut particles);
        let (old, new) = (self.len(), self.len() + particles.len());
        if new > MOST_ROWS {
            return Err(Error::of("positions", new, "a world holds at most 2147483647 particles"));
        }
        self.particles.extend(&particles);
        self.rows.extend(old as u32..new as u32);
        self.wall_pushes.resize(new, [0.0; MAX_WALLS]);
        Ok(old as u32..new as u32)
    }

    /// Removes the particles in `rows`; the rows behind them close up. Springs and
    /// attractors that name one go with it.
    pub fn remove(&mut self, rows: &[u32]) -> Result<()> {
        self.check_rows(rows)?;
        let mut gone = vec![false; self.len()];
        rows.iter().for_each(|&row| gone[row as usize] = true);
        let mut shifted = Vec::with_capacity(self.len());
        let mut left = 0;
        for &gone in &gone {
            shifted.push(left);
            left += u32::from(!gone);
        }
        let keep: Vec<bool> = self.rows.iter().map(|&row| !gone[row as usize]).collect();
        self.particles.retain(|place| keep[place]);
        let mut place = 0;
        self.wall_pushes.retain(|_| {
            place += 1;
            keep[place - 1]
        });
        self.contacts.retain(&keep);
        self.rows.retain(|&row| !gone[row as usize]);
        self.rows.iter_mut().for_each(|row| *row = shifted[*row as usize]);
        let moved: Vec<Option<u32>> =
            gone.iter().zip(shifted).map(|(&gone, new)| (!gone).then_some(new)).collect();
        forces::follow(&mut self.forces, &moved);
        Ok(())
    }

    /// A copy of all particles in the order of adding.
    pub fn particles(&self) -> Particles {
        let mut copy = Particles::default();
        copy.gather(&self.particles, &self.places(), Some(1));
        copy
    }

    /// Centres in the order of adding.
    pub fn positions(&self) -> Vec<[f32; 2]> {
        self.column(&self.particles.positions)
    }

    /// Velocities in the order of adding.
    pub fn velocities(&self) -> Vec<[f32; 2]> {
        self.column(&self.particles.velocities)
    }

    /// Radii in the order of adding.
    pub fn radii(&self) -> Vec<f32> {
        self.column(&self.particles.radii)
    }

    /// Masses in the order of adding.
    pub fn masses(&self) -> Vec<f32> {
        self.column(&self.particles.masses)
    }

    /// Restitutions in the order of adding.
    pub fn restitutions(&self) -> Vec<f32> {
        self.column(&self.particles.restitutions)
    }

    /// Whether each particle can be moved, in the order of adding.
    pub fn movable(&self) -> Vec<bool> {
        self.column(&self.particles.movable)
    }

    fn column<V: Copy + Default>(&self, values: &[V]) -> Vec<V> {
        let mut column = vec![V::default(); values.len()];
        for (&row, &value) in self.rows.iter().zip(values) {
            column[row as usize] = value;
        }
        column
    }

    /// Changes columns of the particles: `change` gets a copy of them in the order of
    /// adding. Refused values change nothing.
    pub fn edit(&mut self, change: impl FnOnce(&mut Particles) -> Result<()>) -> Result<()> {
        let mut copy = self.particles();
        change(&mut copy)?;
        if copy.len() != self.len() {
            let (found, expected) = (copy.len(), self.len());
            return Err(Error::Length { argument: "positions", found, expected });
        }
        copy.validate()?;
        self.settings.container.check_fit(&copy.radii)?;
        rest_the_immovable(&mut copy);
        self.particles.gather(&copy, &self.rows, Some(1));
        Ok(())
    }

    /// Refuses rows that no particle has, and rows named twice.
    pub fn check_rows(&self, rows: &[u32]) -> Result<()> {
        let mut seen = vec![false; self.len()];
        for (index, &row) in rows.iter().enumerate() {
            match seen.get_mut(row as usize) {
                None => {
                    let rule = format!("there are {} particles, so it must be below", self.len());
                    return Err(Error::at("ids", index, row, &rule));
                }
                Some(true) => return Err(Error::at("ids", index, row, "it is named twice")),
                Some(seen) => *seen = true,
            }
        }
        Ok(())
    }

    /// The place of each row.
    fn places(&self) -> Vec<u32> {
        let mut places = vec![0; self.len()];
        for (place, &row) in self.rows.iter().enumerate() {
            places[row as usize] = place as u32;
        }
        places
    }

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
    fn threads(&self) -> Option<usize> {
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
        self.sweep(dt);
        watch(Stage::Integrate);
        self.build();
        watch(Stage::Build);
        self.candidates().map_err(|error| match error {
            Error::TooManyPairs { max_pairs } => Error::TooManyCandidates { most: max_pairs },
            other => other,
        })?;
        watch(Stage::Pairs);
        self.arrange();
        self.contacts.collect(
            &self.memory.pairs,
            &self.particles,
            self.settings.restitution,
            self.memory.tree.rows(),
            self.threads(),
        );
        watch(Stage::Contacts);
        self.resolve(dt);
        self.break_springs();
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
    fn build(&mut self) {
        let particles = &self.particles;
        let memory = &mut self.memory;
        let tie = |a: usize, b: usize| compare_particles(particles, a, b);
        memory.tree.rebuild(&memory.shapes, self.settings.tree, &tie);
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

    /// The pairs of places whose sweeps overlap, sorted: first those of the plane,
    /// then those across each seam.
    fn candidates(&mut self) -> Result<()> {
        let Memory { tree, sorting, pairs: lists, .. } = &mut self.memory;
        // Brute force is worth other threads long before a tree is.
        let threads = self.settings.tree.threads;
        let max = MAX_CANDIDATES;
        let brute = self.settings.method == Method::Brute;
        let images = self.settings.container.images();
        lists.clear();
        let mut tests = 0;
        let mut keep = |image, mut found: pairs::Found| {
            tests += found.tests;
            pairs::sort_places(&mut found.pairs, tree.len(), sorting);
            lists.push((image, found.pairs));
        };
        let within = if brute {
            pairs::brute(tree.columns(), threads, max)?
        } else {
            pairs::places_within(tree, max)?
        };
        keep([0.0; 2], within);
        for image in images {
            let mut across = if brute {
                pairs::brute_between(tree.columns(), tree.columns(), image, max)?
            } else {
                pairs::places_between(tree, tree, image, max)?
            };
            across.pairs.retain(|pair| pair[0] != pair[1]);
            keep(image, across);
        }
        let (nodes, leaves, depth) = (tree.nodes().len(), tree.leaf_count(), tree.depth());
        self.stats = Stats { nodes, leaves, depth, tests };
        Ok(())
    }

    fn resolve(&mut self, dt: f32) {
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
                for (place, halfway) in forces.halfway.iter_mut().enumerate() {
                    let (position, velocity) =
                        (motions.position(place as u32), motions.velocity(place as u32));
                    let there = integrate::halfway(position, velocity, h);
                    *halfway = settings.container.wrap(there);
                }
                accelerate(&self.forces, scene.particles, settings, forces);
            }
            resolve::kick(&scene, &rules, &forces.accelerations, h);
            if !self.forces.is_empty() {
                forces.sprung.act(motions, h);
            }
            resolve::substep(&mut scene, &rules, h);
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

    /// The pairs that touched during the last step, in canonical order.
    pub fn contacts(&self) -> Vec<Touch> {
        let row = |place: u32| self.rows[place as usize];
        let touch = |contact: &crate::contacts::Contact| {
            let [i, j] = contact.places.map(row);
            let sign = if i < j { 1.0 } else { -1.0 };
            let normal = contact.normal.map(|v| v * sign);
            Touch { pair: [i.min(j), i.max(j)], normal, depth: -contact.gap }
        };
        self.contacts.touching().map(touch).collect()
    }

    /// Seconds that have passed.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// What the last step's search looked like.
    pub fn stats(&self) -> Stats {
        self.stats
    }
}

/// What nothing can move stands still.
fn rest_the_immovable(particles: &mut Particles) {
    for (velocity, &movable) in particles.velocities.iter_mut().zip(&particles.movable) {
        if !movable {
            *velocity = [0.0; 2];
        }
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
