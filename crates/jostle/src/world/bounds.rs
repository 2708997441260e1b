//! Bounds: a circle for each particle that it does not leave during a step.

use core::f64::consts::TAU;

use super::World;
use crate::container::Container;
use crate::error::Result;
use crate::events::Bounds;
use crate::parallel;
use crate::particles::Particles;
use crate::quadtree::Quadtree;
use crate::query::{self, Circle};
use crate::shapes::Each;
use crate::trajectory::{Vector, dot, vector};

/// Displacement for which bounds have room, in root mean square displacements: collisions make
/// slow particles faster.
const USUAL: f32 = 1.5;

/// Candidate pairs that a particle may have because it moves, in a dilute gas.
const CANDIDATES: f64 = 3.0;

/// Parts into which a step is cut at most so that there are few candidate pairs.
const MOST_SPLITS: f64 = 4096.0;

/// Bounds that are too small grow to this many times what is needed, so that they rarely have to
/// grow twice.
const GROWTH: f64 = 1.25;

impl World {
    /// Finds out how far each particle may get in `dt` seconds, and the circles around that. Where
    /// a particle gets further, [`StepBounds::grow`] corrects it: the answer does not depend on
    /// the bounds.
    pub(super) fn bound(&mut self, dt: f32) {
        let threads = self.threads();
        let usual = USUAL * self.typical_speed();
        let super::Memory { reaches, shapes, fast, .. } = &mut self.memory;
        let held = |place: usize| !fast.held.is_empty() && fast.held[self.rows[place] as usize];
        let (particles, settings) = (&self.particles, &self.settings);
        let [gx, gy] = settings.gravity;
        let fall = 0.5 * dt * dt * (gx * gx + gy * gy).sqrt();
        let most = settings.container.reach();
        let len = particles.len();
        reaches.resize(len, 0.0);
        parallel::for_chunks(threads, reaches, |first, reaches| {
            for (reach, place) in reaches.iter_mut().zip(first..) {
                *reach = 0.0;
                if !particles.movable[place] || held(place) {
                    continue;
                }
                let [u, v] = particles.velocities[place];
                let own = (u * u + v * v).sqrt() * dt * 1.000_01;
                *reach = own.max((usual * dt).min(most)) + fall;
            }
        });
        shapes.centers.clone_from(&particles.positions);
        shapes.half_sizes = None;
        let radii = shapes.radii.rows_mut();
        radii.resize(len, 0.0);
        parallel::for_chunks(threads, radii, |first, radii| {
            for (radius, place) in radii.iter_mut().zip(first..) {
                *radius = particles.radii[place] + reaches[place];
            }
        });
    }

    /// Root mean square of the speeds of all particles that are not held.
    fn typical_speed(&self) -> f32 {
        let all = self.rows.iter().zip(&self.particles.velocities);
        let free = all.filter(|&(&row, _)| !self.is_held(row));
        root_mean(free.map(|(_, v)| dot(v.map(f64::from), v.map(f64::from)))) as f32
    }

    /// Parts of `dt` seconds in which the bounds of a particle meet few others. With the number
    /// density n, a typical radius r and a typical displacement d, a particle has 2 π n (r + d)²
    /// candidate pairs.
    pub(super) fn parts_with_few_candidates(&self, dt: f32) -> f32 {
        let Particles { positions, radii, .. } = &self.particles;
        let [gx, gy] = self.settings.gravity.map(f64::from);
        let (dt, fall) = (f64::from(dt), (gx * gx + gy * gy).sqrt());
        let displacement = f64::from(USUAL * self.typical_speed()) * dt + 0.5 * fall * dt * dt;
        let radius = root_mean(radii.iter().map(|&r| f64::from(r) * f64::from(r)));
        let area = self.settings.container.area().unwrap_or_else(|| extent(positions));
        let density = positions.len() as f64 / area;
        let least = TAU * density * radius * radius;
        let most = 2.0 * least + CANDIDATES;
        let room = (most / (TAU * density)).sqrt() - radius;
        let parts = (displacement / room).ceil();
        // Not finite where there is no area.
        if parts.is_finite() { parts.clamp(1.0, MOST_SPLITS) as f32 } else { 1.0 }
    }
}

/// The square root of the mean of some numbers, the same whatever their order.
fn root_mean(squares: impl Iterator<Item = f64> + Clone) -> f64 {
    let largest = squares.clone().fold(0.0, f64::max);
    if largest == 0.0 {
        return 0.0;
    }
    // Whole numbers have sums without rounding.
    let share = |square: f64| (square / largest * (1u64 << 40) as f64) as u128;
    let (sum, count) = squares.fold((0, 0u32), |(sum, count), v| (sum + share(v), count + 1));
    (largest * (sum as f64 / (1u64 << 40) as f64 / f64::from(count))).sqrt()
}

/// Area of the smallest AABB around some points.
fn extent(points: &[[f32; 2]]) -> f64 {
    let side = |k: usize| {
        let all = points.iter().map(|point| f64::from(point[k]));
        all.clone().fold(f64::MIN, f64::max) - all.fold(f64::MAX, f64::min)
    };
    side(0) * side(1)
}

/// Bounds that have grown during the step.
#[derive(Debug, Default)]
pub(super) struct Grown {
    /// Particles whose bounds have grown.
    list: Vec<u32>,
    /// The index of each row of the tree; filled when it is first needed.
    indices: Vec<u32>,
}

/// The bounds of a step, and the tree of those that it began with.
pub(super) struct StepBounds<'a> {
    tree: &'a Quadtree<f32>,
    particles: &'a Particles,
    reaches: &'a mut [f32],
    grown: &'a mut Grown,
    container: Container,
}

impl<'a> StepBounds<'a> {
    pub(super) fn new(
        tree: &'a Quadtree<f32>,
        particles: &'a Particles,
        reaches: &'a mut [f32],
        grown: &'a mut Grown,
        container: Container,
    ) -> Self {
        grown.list.clear();
        grown.indices.clear();
        Self { tree, particles, reaches, grown, container }
    }

    /// Offsets between a torus and its images within some distance.
    fn offsets(&self, distance: f32) -> Vec<[f32; 2]> {
        let Container::Torus { size } = self.container else { return vec![[0.0; 2]] };
        let count = |side: f32| (distance / side).ceil().clamp(1.0, 8.0) as i32;
        let [columns, rows] = size.map(count);
        let all = (-columns..=columns).flat_map(|i| (-rows..=rows).map(move |j| [i, j]));
        all.map(|[i, j]| [i as f32 * size[0], j as f32 * size[1]]).collect()
    }
}

impl Bounds for StepBounds<'_> {
    fn reach(&self, index: u32) -> f64 {
        f64::from(self.reaches[index as usize])
    }

    fn grow(&mut self, distances: &[(u32, f64)]) -> Result<Vec<(u32, u32, Vector)>> {
        if self.grown.indices.is_empty() {
            self.grown.indices.resize(self.tree.len(), 0);
            for (index, &row) in self.tree.rows().iter().enumerate() {
                self.grown.indices[row as usize] = index as u32;
            }
        }
        for &(index, distance) in distances {
            self.reaches[index as usize] = (distance * GROWTH) as f32;
            self.grown.list.push(index);
        }
        self.grown.list.sort_unstable();
        self.grown.list.dedup();
        let Particles { positions, radii, .. } = self.particles;
        // A circle for each disc and each image: the images of the others at +offset are around
        // the disc at −offset.
        let (mut of, mut centers, mut wide) = (Vec::new(), Vec::new(), Vec::new());
        for &(index, _) in distances {
            let own = index as usize;
            let radius = radii[own] + self.reaches[own];
            for offset in self.offsets(2.0 * radius) {
                of.push((index, offset.map(f64::from)));
                centers.push([0, 1].map(|k| positions[own][k] - offset[k]));
                wide.push(radius);
            }
        }
        let circles = Circle::all(&Each::Rows(centers), &Each::Rows(wide))?;
        let found = query::search(self.tree, &circles, None)?;
        let mut pairs = Vec::new();
        for (question, &(index, image)) in of.iter().enumerate() {
            let others = found.of(question).iter().map(|&row| self.grown.indices[row as usize]);
            pairs.extend(others.filter(|&other| other != index).map(|o| (index, o, image)));
            // The tree knows the old bounds of discs whose bounds have grown.
            let own = index as usize;
            let radius = radii[own] + self.reaches[own];
            for &other in self.grown.list.iter().filter(|&&other| other != index) {
                let q = vector(|k| {
                    let [a, b] = [positions[own][k], positions[other as usize][k]];
                    f64::from(b) - f64::from(a) + image[k]
                });
                let other = other as usize;
                let reach = f64::from(radius) + f64::from(radii[other] + self.reaches[other]);
                if dot(q, q) <= reach * reach {
                    pairs.push((index, other as u32, image));
                }
            }
        }
        Ok(pairs)
    }
}
