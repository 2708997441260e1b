//! Swept bounds: for each particle a circle in which it is expected to stay during a step. The tree of these
//! circles is the broad phase (C. Ericson, *Real-Time Collision Detection*, 2005).
//!
//! A particle that leaves its circle gets a larger one, or, if it travels around a torus, a chain of
//! circles along its trajectory.

use std::cmp;
use std::collections::HashSet;
use std::f64::consts::TAU;
use std::sync::atomic::{AtomicBool, Ordering};

use super::force_step::force_displacement;
use super::{MAX_CANDIDATES, OnTouch, World};
use crate::container::Container;
use crate::error::{Error, Result};
use crate::events::{Bounds, NearPair, Outside};
use crate::geometry::{self, Shape};
use crate::interrupt::Pulse;
use crate::parallel;
use crate::particles::Particles;
use crate::quadtree::Quadtree;
use crate::query::each_overlap;
use crate::shapes::{Filter, Shapes, fill_filters};
use crate::trajectory::{Segment, Vector, dot};

/// Displacement that bounds allow for, in mean displacements, because collisions make slow particles
/// faster.
const USUAL: f32 = 1.7;

/// Circles of a chain at most.
const MAX_CIRCLES: f64 = 4096.0;

/// Pairs that one call of [`StepBounds::grow`] may find.
const MAX_NEW: usize = MAX_CANDIDATES / 8;

/// Collisions that the fastest particle on a torus may have in a part of a step if it meets the
/// others at random places.
const MAX_COLLISIONS: f64 = 16.0;

/// Parts into which the rest of a step is cut at most because of few fast particles.
const MAX_FOR_FEW: f64 = 128.0;

/// Candidate pairs that a particle may have because it moves, in a dilute gas.
const CANDIDATES: f64 = 1.5;

/// Parts into which a step is cut at most so that there are few candidate pairs.
const MAX_SPLITS: f64 = 4096.0;

/// Candidate pairs of a particle that cost less to test than another part of the step.
const WORTH_A_SPLIT: f64 = 4.0;

/// Displacements, in units of [`Container::max_displacement`], up to which one circle is made. It and a particle
/// together are at most half as large as the torus.
const ONE_CIRCLE: f64 = 1.6;

/// Bounds that are too small grow to this many times what is needed, so that they rarely have to
/// grow twice.
const GROWTH: f64 = 1.25;

impl World {
    /// Computes the bounds of a step of `dt` seconds. If a particle moves farther,
    /// [`StepBounds::grow`] enlarges its bounds: the answer does not depend on them.
    pub(super) fn find_bounds(&mut self, dt: f32) {
        let threads = self.threads();
        let super::StepScratch { max_displacements, forces, usual_speed, shapes, .. } =
            &mut self.scratch;
        let (particles, settings) = (&self.particles, &self.settings);
        let usual = (*usual_speed * dt).min(settings.container.max_displacement());
        let accelerations = &forces.accelerations;
        let fall = distance_of_fall(settings.gravity, dt);
        // Particles that merge are not searched again, so their bounds contain the estimated
        // displacements by springs.
        let is_merging = settings.on_touch == OnTouch::Merge;
        let by_springs = if is_merging { &forces.max_displacements[..] } else { &[] };
        let is_pulled = !(accelerations.is_empty() && by_springs.is_empty());
        let pulled = |index: usize| {
            force_displacement(accelerations.get(index), by_springs.get(index), dt).unwrap_or(0.0)
        };
        let longest =
            if is_merging { f32::INFINITY } else { settings.container.max_displacement() };
        let len = particles.len();
        shapes.centers.clone_from(&particles.positions);
        shapes.half_sizes = None;
        fill_filters(particles.filters.iter().copied(), &mut shapes.filters);
        let radii = shapes.radii.rows_mut();
        radii.resize(len, 0.0);
        max_displacements.resize(len, 0.0);
        let is_cut = AtomicBool::new(false);
        let sides = torus_sides(&settings.container);
        parallel::for_chunks_of_two(
            threads,
            max_displacements,
            radii,
            |first, max_displacements, radii| {
                let bounds = max_displacements.iter_mut().zip(radii);
                let columns =
                    particles.velocities[first..].iter().zip(&particles.positions[first..]);
                let own = particles.radii[first..].iter().zip(&particles.movable[first..]);
                let mut any_cut = false;
                let all = bounds.zip(columns).zip(own).zip(first..);
                for (
                    (
                        ((max_displacement, radius), (&velocity, &center)),
                        (&own_radius, &is_movable),
                    ),
                    index,
                ) in all
                {
                    let own = distance_at(velocity, dt);
                    let mut by_forces = fall;
                    if is_pulled {
                        by_forces += pulled(index);
                    }
                    let (least, by_forces) =
                        if is_movable { (usual, by_forces) } else { (0.0, 0.0) };
                    *max_displacement = (own.max(least) + by_forces).min(longest);
                    any_cut |= *max_displacement < own + by_forces;
                    *radius =
                        own_radius + *max_displacement + rounding_of(center, own_radius, sides);
                }
                if any_cut {
                    is_cut.store(true, Ordering::Relaxed);
                }
            },
        );
        self.scratch.bounded = !is_cut.into_inner();
    }

    /// The speed that bounds allow for.
    pub(super) fn usual_speed(&self) -> Result<f32> {
        let speed = |&[u, v]: &[f32; 2]| (u * u + v * v).sqrt();
        let mean = self.mean(&self.particles.velocities, speed)?;
        Ok(USUAL * mean as f32)
    }

    /// Parts of `dt` seconds in which the bounds of a particle meet few others. With the number
    /// density n, a typical radius r and a typical displacement d, a particle has 2 π n (r + d)²
    /// candidate pairs.
    pub(super) fn parts_with_few_candidates(&self, dt: f32) -> Result<usize> {
        let Particles { radii, .. } = &self.particles;
        let count = self.count_of_all();
        let [gx, gy] = self.settings.gravity.map(f64::from);
        let (dt, fall) = (f64::from(dt), (gx * gx + gy * gy).sqrt());
        let displacement = f64::from(self.scratch.usual_speed) * dt + 0.5 * fall * dt * dt;
        let radius = self.mean(radii, |&radius| radius)?;
        let area = match self.settings.container.area() {
            Some(area) => area,
            None => self.area_of_extent()?,
        };
        let density = count as f64 / area;
        let least = TAU * density * radius * radius;
        let most = 2.0 * least + CANDIDATES;
        let clearance = (most / (TAU * density)).sqrt() - radius;
        let parts = (displacement / clearance).ceil();
        let most = (count as f64 / WORTH_A_SPLIT).floor().clamp(1.0, MAX_SPLITS);
        // Not finite where there is no area.
        let parts = if parts.is_finite() { parts.clamp(1.0, most) } else { 1.0 };
        Ok(parts.max(self.parts_with_few_collisions(dt, radius)?) as usize)
    }

    /// Parts of `dt` seconds in which the fastest particle on a torus has few collisions. A particle
    /// of radius r meets 2 v (N r + Σ r) / A others in a second, with the area A.
    fn parts_with_few_collisions(&self, dt: f64, mean_radius: f64) -> Result<f64> {
        let Particles { velocities, radii, .. } = &self.particles;
        let Some(size) = self.settings.container.period() else { return Ok(1.0) };
        let [width, height] = size.map(f64::from);
        let share = 2.0 * dt * self.count_of_all() as f64 / (width * height);
        let collisions = |(velocity, &radius): (&[f32; 2], &f32)| {
            let velocity = velocity.map(f64::from);
            dot(velocity, velocity).sqrt() * (f64::from(radius) + mean_radius) * share
        };
        let all = velocities.iter().zip(radii).map(collisions);
        let most = match &self.domain {
            None => all.fold(0.0, f64::max),
            Some(domain) => {
                let most = domain.own_or(0.0, all, &self.rows).fold(0.0, f64::max);
                self.largest_of_all([most])?[0]
            }
        };
        Ok((most / MAX_COLLISIONS).ceil().clamp(1.0, MAX_FOR_FEW))
    }

    /// The mean of a number of all particles, none negative; the same whatever their order and ranks.
    fn mean<V>(&self, column: &[V], number: impl Fn(&V) -> f32 + Copy) -> Result<f64> {
        let most = match &self.domain {
            None => f64::from(largest(column.iter().map(number))),
            Some(domain) => {
                let own = domain.own_or(0.0, column.iter().map(number), &self.rows);
                self.largest_of_all([f64::from(largest(own))])?[0]
            }
        };
        if most == 0.0 {
            return Ok(0.0);
        }
        // Whole numbers have sums without rounding. To add 2⁵² rounds a number below 2³¹ and puts it into
        // the last bits.
        let scale = f64::from(i32::MAX) / most;
        let whole = |value: &V| (f64::from(number(value)) * scale + WHOLE).to_bits() - WHOLE_BITS;
        let sum = match &self.domain {
            None => column.iter().map(whole).sum(),
            Some(domain) => {
                let own = domain.own_or(0, column.iter().map(whole), &self.rows);
                self.sum_of_all([own.sum()])?[0]
            }
        };
        Ok(sum as f64 / scale / self.count_of_all() as f64)
    }

    /// Area of the smallest AABB around all particles.
    fn area_of_extent(&self) -> Result<f64> {
        let [right, bottom, left, top] = self.farthest()?;
        Ok((right + left) * (bottom + top))
    }
}

/// Numbers from this one on, 2⁵², are whole.
const WHOLE: f64 = (1u64 << 52) as f64;
const WHOLE_BITS: u64 = WHOLE.to_bits();

/// The largest of some numbers, none negative, which have the order of their bits; 0 if there are
/// none.
pub(super) fn largest(numbers: impl Iterator<Item = f32>) -> f32 {
    f32::from_bits(numbers.map(|number| number.to_bits() as i32).fold(0, i32::max) as u32)
}

/// Upper bound of the distance that a particle travels at a velocity in `dt` seconds.
#[inline(always)]
pub(super) fn distance_at([u, v]: [f32; 2], dt: f32) -> f32 {
    (u * u + v * v).sqrt() * dt * 1.000_01
}

/// The distance that a particle at rest falls in `dt` seconds.
pub(super) fn distance_of_fall([x, y]: [f32; 2], dt: f32) -> f32 {
    0.5 * dt * dt * (x * x + y * y).sqrt()
}

/// Upper bound of the residual of a position, which on a torus may be that of the far side, and of the
/// error of a distance of about the radius in float32.
pub(super) fn rounding(position: [f32; 2], radius: f32, container: &Container) -> f32 {
    rounding_of(position, radius, torus_sides(container))
}

#[inline(always)]
fn rounding_of([x, y]: [f32; 2], radius: f32, sides: f32) -> f32 {
    f32::EPSILON * (x.abs() + y.abs() + sides + 4.0 * radius)
}

/// Sum of the sides of a torus; 0 for other containers.
fn torus_sides(container: &Container) -> f32 {
    container.period().map_or(0.0, |[width, height]| width + height)
}

/// A circle in which a particle may be at some time of the step.
#[derive(Clone, Copy, Debug)]
struct Circle {
    index: u32,
    /// Centre, on the torus.
    center: [f32; 2],
    radius: f32,
    /// The copy of the torus in which it is.
    tile: [i32; 2],
    /// When the particle is in it, in seconds since the beginning of the window.
    times: [f64; 2],
}

impl Circle {
    /// Whether it is one circle for the whole step, and no part of a chain.
    fn is_whole(&self) -> bool {
        self.times[1] == f64::INFINITY
    }
}

/// The circles that were added during the step.
#[derive(Debug, Default)]
pub(super) struct Grown {
    circles: Vec<Circle>,
    /// The segments that have chains.
    chained: HashSet<[u64; 6]>,
    shapes: Shapes<f32>,
    tree: Quadtree<f32>,
    stack: Vec<u32>,
}

impl Grown {
    /// Begins a step.
    pub(super) fn clear(&mut self) {
        self.circles.clear();
    }
}

/// The bounds of a step, and the tree of those that it began with.
pub(super) struct StepBounds<'a> {
    tree: &'a Quadtree<f32>,
    particles: &'a Particles,
    max_displacements: &'a mut [f32],
    grown: &'a mut Grown,
    container: Container,
    /// Typical distance between neighbouring particles.
    spacing: f32,
}

impl<'a> StepBounds<'a> {
    pub(super) fn new(
        tree: &'a Quadtree<f32>,
        particles: &'a Particles,
        max_displacements: &'a mut [f32],
        grown: &'a mut Grown,
        container: Container,
    ) -> Self {
        let area = container.area().unwrap_or(f64::INFINITY);
        let spacing = (area / particles.len() as f64).sqrt() as f32;
        Self { tree, particles, max_displacements, grown, container, spacing }
    }

    /// Appends circles around where a particle gets, and adapts its bounds if one circle is enough.
    fn cover(&mut self, outside: &Outside, gravity: Vector, end: f64) -> Result<()> {
        let Outside { index, distance, .. } = *outside;
        if distance > ONE_CIRCLE * f64::from(self.container.max_displacement()) {
            return self.cover_by_chain(outside, gravity, end);
        }
        let max_displacement = &mut self.max_displacements[index as usize];
        // Another of its segments may have made them large enough.
        if distance > f64::from(*max_displacement) {
            *max_displacement = (distance * GROWTH) as f32;
            let center = self.particles.positions[index as usize];
            let radius = self.particles.radii[index as usize]
                + *max_displacement
                + rounding(center, self.particles.radii[index as usize], &self.container);
            let times = [0.0, f64::INFINITY];
            self.grown.circles.push(Circle { index, center, radius, tile: [0; 2], times });
        }
        Ok(())
    }

    /// Appends circles along a segment.
    fn cover_by_chain(&mut self, outside: &Outside, gravity: Vector, end: f64) -> Result<()> {
        let Outside { index, segment, .. } = *outside;
        let Segment { time, position: [x, y], velocity: [u, v], .. } = segment;
        let key = [f64::from(index), time, x, y, u, v].map(f64::to_bits);
        if !self.grown.chained.insert(key) {
            return Ok(());
        }
        // Along a parabola the speed is largest at an end.
        let speeds = [time, end].map(|time| {
            let [_, velocity] = segment.at(time, gravity);
            dot(velocity, velocity).sqrt()
        });
        let displacement = speeds[0].max(speeds[1]) * (end - time);
        // Circles about as large as the distances between particles find few of them.
        let size = self
            .container
            .max_displacement()
            .min(self.spacing.max(self.particles.radii[index as usize]));
        let count = (displacement / f64::from(size)).ceil().max(1.0);
        if count > MAX_CIRCLES {
            return Err(Error::TooManyCandidates { limit: MAX_NEW });
        }
        let interval = (end - time) / count;
        let radius = self.particles.radii[index as usize];
        let radius = (f64::from(radius) + 0.5 * displacement / count) as f32 * 1.001;
        for number in 0..count as usize {
            let times = [number, number + 1].map(|number| time + number as f64 * interval);
            let middle = segment.position_at(0.5 * (times[0] + times[1]), gravity);
            let tile = self.container.tile(middle);
            let offset = self.container.offset(tile);
            let center = [0, 1].map(|k| (middle[k] - offset[k]) as f32);
            let radius = radius + rounding(center, radius, &self.container);
            // A step whose positions overflow is refused when they are stored.
            if center.into_iter().chain([radius]).all(f32::is_finite) {
                self.grown.circles.push(Circle { index, center, radius, tile, times });
            }
        }
        Ok(())
    }

    /// The copies of the torus that have a point within some distance of it.
    fn tiles(&self, distance: f32) -> impl Iterator<Item = [i32; 2]> + use<> {
        let sides = self.container.period().unwrap_or([f32::INFINITY; 2]);
        let [columns, rows] = sides.map(|side| (distance / side).ceil() as i32);
        (-columns..=columns).flat_map(move |i| (-rows..=rows).map(move |j| [i, j]))
    }
}

impl Bounds for StepBounds<'_> {
    fn max_displacements(&self) -> &[f32] {
        self.max_displacements
    }

    fn begin_window(&mut self) {
        self.grown.circles.retain(Circle::is_whole);
        self.grown.chained.clear();
    }

    fn grow(
        &mut self,
        outside: &[Outside],
        gravity: Vector,
        end: f64,
        pairs: &mut Vec<NearPair>,
    ) -> Result<()> {
        let known = self.grown.circles.len();
        outside.iter().try_for_each(|outside| self.cover(outside, gravity, end))?;
        if self.grown.circles.len() == known {
            return Ok(());
        }
        // The step's tree has the old bounds of particles whose bounds have grown.
        let Grown { circles, shapes, tree, .. } = &mut *self.grown;
        shapes.centers.clear();
        shapes.centers.extend(circles.iter().map(|circle| circle.center));
        let radii = shapes.radii.rows_mut();
        radii.clear();
        radii.extend(circles.iter().map(|circle| circle.radius));
        let all = self.particles;
        let filtered = if all.filters.is_empty() { &[][..] } else { &circles[..] };
        let filters = filtered.iter().map(|circle| all.filter(circle.index as usize));
        fill_filters(filters, &mut shapes.filters);
        tree.rebuild_unchecked(shapes, self.tree.settings(), &|_, _| cmp::Ordering::Equal)?;
        let mut stack = std::mem::take(&mut self.grown.stack);
        let found = self.find_pairs(known, &mut stack, pairs);
        self.grown.stack = stack;
        found
    }
}

impl StepBounds<'_> {
    /// Appends the pairs of the particles in new circles, from number `first` on, and all others.
    fn find_pairs(
        &self,
        first: usize,
        stack: &mut Vec<u32>,
        pairs: &mut Vec<NearPair>,
    ) -> Result<()> {
        let Grown { circles, tree, .. } = &*self.grown;
        let trees = [self.tree, tree];
        let largest = trees.map(|tree| tree.bounds().first().map_or(0.0, |root| root.radius));
        let largest = largest[0].max(largest[1]);
        let mut pulse = Pulse::current();
        for circle in &circles[first..] {
            let Filter { category, mask } = self.particles.filter(circle.index as usize);
            // The images of the others at +offset are around the particle at −offset.
            for image in self.tiles(circle.radius + largest) {
                let offset = self.container.offset(image).map(|v| v as f32);
                let center = [0, 1].map(|k| circle.center[k] - offset[k]);
                let of = geometry::Bounds::of(&Shape {
                    min: center,
                    max: center,
                    half_size: [0.0; 2],
                    radius: circle.radius,
                    category,
                    mask,
                });
                let mut add = |other: u32, tile: [i32; 2], lasts: bool| {
                    if other != circle.index {
                        let tile = [0, 1].map(|k| circle.tile[k] + image[k] - tile[k]);
                        let offset = self.container.offset(tile);
                        let pair = [circle.index, other];
                        pairs.push(NearPair { pair, offset, lasts: lasts && circle.is_whole() });
                    }
                };
                let work = each_overlap(self.tree, &of, 0.0, stack, |index| {
                    add(index as u32, [0; 2], true);
                });
                pulse.check(work)?;
                let work = each_overlap(tree, &of, 0.0, stack, |index| {
                    let other = &circles[tree.rows()[index] as usize];
                    let [start, end] = other.times;
                    if start <= circle.times[1] && circle.times[0] <= end {
                        add(other.index, other.tile, other.is_whole());
                    }
                });
                pulse.check(work)?;
            }
            if pairs.len() > MAX_NEW {
                return Err(Error::TooManyCandidates { limit: MAX_NEW });
            }
        }
        Ok(())
    }
}
