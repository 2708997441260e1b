//! Bounds: for each particle a circle in which it is expected to stay during a step.

use core::f64::consts::TAU;

use super::World;
use super::feel::aside;
use crate::container::Container;
use crate::error::Result;
use crate::events::Bounds;
use crate::parallel;
use crate::particles::Particles;
use crate::quadtree::Quadtree;
use crate::query::{self, Circle};
use crate::shapes::{Each, Shapes};
use crate::trajectory::{Vector, dot};

/// Displacement that bounds allow for, in mean displacements, because collisions make slow particles
/// faster.
const USUAL: f32 = 1.7;

/// Candidate pairs that a particle may have because it moves, in a dilute gas.
const CANDIDATES: f64 = 1.5;

/// Parts into which a step is cut at most so that there are few candidate pairs.
const MOST_SPLITS: f64 = 4096.0;

/// Candidate pairs of a particle that cost less to test than another part of the step.
const WORTH_A_SPLIT: f64 = 4.0;

/// Bounds that are too small grow to this many times what is needed, so that they rarely have to
/// grow twice.
const GROWTH: f64 = 1.25;

impl World {
    /// Computes the bounds of a step of `dt` seconds. If a particle gets further,
    /// [`StepBounds::grow`] enlarges its bounds: the answer does not depend on them.
    pub(super) fn bound(&mut self, dt: f32) {
        let threads = self.threads();
        let super::Memory { reaches, shapes, fast, forces, usual_speed, .. } = &mut self.memory;
        let (usual, accelerations) = (*usual_speed, &forces.accelerations);
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
                let pulled = aside(accelerations.get(place), None, dt).unwrap_or(0.0);
                *reach = own.max((usual * dt).min(most)) + fall + pulled;
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

    /// The speed that bounds allow for.
    pub(super) fn usual_speed(&self) -> f32 {
        let all = (0..self.len()).filter(|&place| !self.is_held(self.rows[place]));
        let square = |place: usize| {
            let v = self.particles.velocities[place].map(f64::from);
            dot(v, v)
        };
        USUAL * mean(all.map(|place| square(place).sqrt())) as f32
    }

    /// Parts of `dt` seconds in which the bounds of a particle meet few others. With the number
    /// density n, a typical radius r and a typical displacement d, a particle has 2 π n (r + d)²
    /// candidate pairs.
    pub(super) fn parts_with_few_candidates(&self, dt: f32) -> f32 {
        let Particles { positions, radii, .. } = &self.particles;
        let [gx, gy] = self.settings.gravity.map(f64::from);
        let (dt, fall) = (f64::from(dt), (gx * gx + gy * gy).sqrt());
        let displacement = f64::from(self.memory.usual_speed) * dt + 0.5 * fall * dt * dt;
        let radius = mean(radii.iter().map(|&radius| f64::from(radius)));
        let area = self.settings.container.area().unwrap_or_else(|| extent(positions));
        let density = positions.len() as f64 / area;
        let least = TAU * density * radius * radius;
        let most = 2.0 * least + CANDIDATES;
        let room = (most / (TAU * density)).sqrt() - radius;
        let parts = (displacement / room).ceil();
        let most = (positions.len() as f64 / WORTH_A_SPLIT).floor().clamp(1.0, MOST_SPLITS);
        // Not finite where there is no area.
        if parts.is_finite() { parts.clamp(1.0, most) as f32 } else { 1.0 }
    }
}

/// The mean of some numbers, none negative; the same whatever their order.
fn mean(numbers: impl Iterator<Item = f64> + Clone) -> f64 {
    let largest = numbers.clone().fold(0.0, f64::max);
    if largest == 0.0 {
        return 0.0;
    }
    // Whole numbers have sums without rounding.
    let scale = f64::from(u32::MAX) / largest;
    let add = |(sum, count), number| (sum + (number * scale) as u64, count + 1);
    let (sum, count) = numbers.fold((0, 0u32), add);
    sum as f64 / scale / f64::from(count)
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
    fn reaches(&self) -> &[f32] {
        self.reaches
    }

    fn grow(&mut self, distances: &[(u32, f64)]) -> Result<Vec<(u32, u32, Vector)>> {
        if self.grown.indices.is_empty() {
            self.grown.indices.resize(self.tree.len(), 0);
            for (index, &row) in self.tree.rows().iter().enumerate() {
                self.grown.indices[row as usize] = index as u32;
            }
        }
        for &(index, distance) in distances {
            let reach = &mut self.reaches[index as usize];
            *reach = reach.max((distance * GROWTH) as f32);
        }
        let mut new: Vec<u32> = distances.iter().map(|&(index, _)| index).collect();
        new.sort_unstable();
        new.dedup();
        self.grown.list.extend(&new);
        self.grown.list.sort_unstable();
        self.grown.list.dedup();
        let position = |index: u32| self.particles.positions[index as usize];
        let radius =
            |index: u32| self.particles.radii[index as usize] + self.reaches[index as usize];
        // A circle for each disc and each image: the images of the others at +offset are around
        // the disc at −offset.
        let (mut of, mut centers, mut radii) = (Vec::new(), Vec::new(), Vec::new());
        for index in new {
            for offset in self.offsets(2.0 * radius(index)) {
                of.push((index, offset.map(f64::from)));
                centers.push([0, 1].map(|k| position(index)[k] - offset[k]));
                radii.push(radius(index));
            }
        }
        let circles = Circle::all(&Each::Rows(centers), &Each::Rows(radii))?;
        let found = query::search(self.tree, &circles, None)?;
        // That tree knows the old bounds of discs whose bounds have grown.
        let list = &self.grown.list;
        let grown = Shapes {
            centers: list.iter().map(|&index| position(index)).collect(),
            radii: Each::Rows(list.iter().map(|&index| radius(index)).collect()),
            ..Shapes::default()
        };
        let grown = Quadtree::new(&grown, self.tree.settings())?;
        let found_grown = query::search(&grown, &circles, None)?;
        let mut pairs = Vec::new();
        for (circle, &(index, image)) in of.iter().enumerate() {
            let old = found.of(circle).iter().map(|&row| self.grown.indices[row as usize]);
            let new = found_grown.of(circle).iter().map(|&row| list[row as usize]);
            let others = old.chain(new).filter(|&other| other != index);
            pairs.extend(others.map(|other| (index, other, image)));
        }
        Ok(pairs)
    }
}
