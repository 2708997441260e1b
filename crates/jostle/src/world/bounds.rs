//! Swept bounds: for each particle a circle in which it is expected to stay during a step. The tree of these
//! circles is the broad phase (C. Ericson, *Real-Time Collision Detection*, 2005).
//!
//! A particle that leaves its circle gets a larger one, or, if it travels around a torus, a chain of
//! circles along its trajectory.

use std::cmp;
use std::collections::{HashMap, HashSet};
use std::f64::consts::TAU;
use std::sync::atomic::{AtomicBool, Ordering};

use super::force_step::{ForceScratch, force_displacement};
use super::search::{self, ListScratch, Lists};
use super::{MAX_CANDIDATES, OnTouch, World, WorldSettings};
use crate::container::Container;
use crate::error::{Error, Result};
use crate::events::{Bounds, Candidates, NearPair, Outside, Start};
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

/// Share of the radius within which surfaces may come to rest, whatever their speeds.
const SLACK: f32 = 0.005;

/// Share of the radius by which bounds are larger than needed for contacts, because of rounding.
const RESERVE: f32 = 0.001;

/// Bounds that are too small grow to this many times what is needed, so that they rarely have to
/// grow twice.
const GROWTH: f64 = 1.25;

impl World {
    /// Computes the bounds of a step of `dt` seconds. If a particle moves farther,
    /// [`StepBounds::grow`] enlarges its bounds: the answer does not depend on them.
    pub(super) fn find_bounds(&mut self, dt: f32) {
        let threads = self.threads();
        let may_rest = self.may_rest();
        let super::StepScratch { max_displacements, forces, usual_speed, shapes, horizon, .. } =
            &mut self.scratch;
        let (particles, settings) = (&self.particles, &self.settings);
        let (step, dt) = (dt, if settings.on_touch == OnTouch::Bounce { *horizon } else { dt });
        let usual = (*usual_speed * dt).min(settings.container.max_displacement());
        let accelerations = &forces.accelerations;
        let fall = distance_of_fall(settings.gravity, dt);
        let free = FreeDisplacements::new(settings, forces, step);
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
                let bounds = max_displacements.iter_mut().zip(&mut *radii);
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
                if !may_rest {
                    return;
                }
                // In a loop of its own: bounds contain what contacts are made of.
                let bounds = max_displacements.iter_mut().zip(radii).zip(first..);
                for ((max_displacement, radius), index) in bounds {
                    let own_radius = particles.radii[index];
                    let least = reach(free.of(particles, index), own_radius) + RESERVE * own_radius;
                    *radius += (least - *max_displacement).max(0.0);
                    *max_displacement = max_displacement.max(least);
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

    /// Finds out how crowded the particles are, and for how many of the `dt` seconds of a step bounds are made.
    pub(super) fn choose_horizon(&mut self, dt: f32) -> Result<()> {
        self.scratch.usual_speed = self.usual_speed()?;
        self.scratch.horizon = dt;
        if self.settings.on_touch != OnTouch::Bounce {
            return Ok(());
        }
        let count = self.count_of_all() as f64;
        let area = match self.settings.container.area() {
            Some(area) => area,
            None => self.area_of_extent()?,
        };
        let [gx, gy] = self.settings.gravity.map(f64::from);
        let crowd = Crowd {
            density: count / area,
            radius: self.mean(&self.particles.radii, |&radius| radius)?,
            most: (count / WORTH_A_SPLIT).floor().clamp(1.0, MAX_SPLITS),
            acceleration: (gx * gx + gy * gy).sqrt(),
            is_torus: self.settings.container.period().is_some(),
        };
        let parts = crowd.parts(f64::from(self.scratch.usual_speed), f64::from(dt));
        let parts = parts.max(self.parts_with_few_collisions(&crowd, f64::from(dt))?);
        self.scratch.crowd = crowd;
        self.scratch.horizon = dt / parts as f32;
        Ok(())
    }

    /// Parts of `dt` seconds in which the fastest particle on a torus has few collisions.
    fn parts_with_few_collisions(&self, crowd: &Crowd, dt: f64) -> Result<f64> {
        if !crowd.is_torus {
            return Ok(1.0);
        }
        let Particles { velocities, radii, .. } = &self.particles;
        let all = velocities.iter().zip(radii).map(|(&v, &radius)| crowd.collisions(v, radius));
        let most = match &self.domain {
            None => all.fold(0.0, f64::max),
            Some(domain) => {
                let most = domain.own_or(0.0, all, &self.rows).fold(0.0, f64::max);
                self.largest_of_all([most])?[0]
            }
        };
        Ok(Crowd::parts_of_the_fastest(most * dt))
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

/// How crowded the particles of a step are. It decides for how long bounds are made, so that there are few
/// candidate pairs. The result of a step does not depend on it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Crowd {
    /// Particles in a unit of area.
    density: f64,
    /// Their mean radius.
    radius: f64,
    /// Parts into which a step is divided at most.
    most: f64,
    /// That of gravity.
    acceleration: f64,
    is_torus: bool,
}

impl Crowd {
    /// Parts of `dt` seconds in which the bounds of a particle meet few others. With the number
    /// density n, a typical radius r and a typical displacement d, a particle has 2 π n (r + d)²
    /// candidate pairs.
    fn parts(&self, usual_speed: f64, dt: f64) -> f64 {
        let Self { density, radius, most, acceleration, .. } = *self;
        let displacement = usual_speed * dt + 0.5 * acceleration * dt * dt;
        let least = TAU * density * radius * radius;
        let clearance = ((2.0 * least + CANDIDATES) / (TAU * density)).sqrt() - radius;
        let parts = (displacement / clearance).ceil();
        // Not finite where there is no area.
        if parts.is_finite() { parts.clamp(1.0, most) } else { 1.0 }
    }

    /// Collisions of a particle in a second, if it meets others at random places. A particle of radius r meets
    /// 2 v n (r + r̄), with the number density n and the mean radius r̄.
    fn collisions(&self, velocity: [f32; 2], radius: f32) -> f64 {
        let velocity = velocity.map(f64::from);
        let size = f64::from(radius) + self.radius;
        2.0 * dot(velocity, velocity).sqrt() * size * self.density
    }

    /// Parts of a time in which the fastest particle of a torus has so many collisions.
    fn parts_of_the_fastest(collisions: f64) -> f64 {
        (collisions / MAX_COLLISIONS).ceil().clamp(1.0, MAX_FOR_FEW)
    }

    /// Of `left` seconds those for which bounds around particles with these velocities are made, and the speed
    /// that they allow for.
    fn horizon(&self, now: &[Start], left: f64) -> (f64, f32) {
        let speed = |of: &Start| dot(of.velocity.map(f64::from), of.velocity.map(f64::from)).sqrt();
        let mean = now.iter().map(speed).sum::<f64>() / now.len() as f64;
        let usual = f64::from(USUAL) * mean;
        let mut parts = self.parts(usual, left);
        if self.is_torus {
            let all = now.iter().map(|of| self.collisions(of.velocity, of.radius));
            parts = parts.max(Self::parts_of_the_fastest(all.fold(0.0, f64::max) * left));
        }
        (left / parts, usual as f32)
    }
}

/// The bounds that replace those with which a step began, after the particles have moved far.
#[derive(Debug, Default)]
pub(super) struct Renewed {
    /// Whether they do.
    is_used: bool,
    /// Centres, on the torus, and the copies of the torus in which they are.
    centers: Vec<[f32; 2]>,
    tiles: Vec<[i32; 2]>,
    shapes: Shapes<f32>,
    tree: Quadtree<f32>,
    listing: ListScratch,
    found: Lists,
    /// The number of the list of each image.
    numbers: HashMap<[i32; 2], usize>,
}

/// Numbers from this one on, 2⁵², are whole.
const WHOLE: f64 = (1u64 << 52) as f64;
const WHOLE_BITS: u64 = WHOLE.to_bits();

/// The largest of some numbers, none negative, which have the order of their bits; 0 if there are
/// none.
pub(super) fn largest(numbers: impl Iterator<Item = f32>) -> f32 {
    f32::from_bits(numbers.map(|number| number.to_bits() as i32).fold(0, i32::max) as u32)
}

/// How far particles get in a step by their velocities and by forces, if nothing hits them.
pub(super) struct FreeDisplacements<'a> {
    accelerations: &'a [[f32; 2]],
    fall: f32,
    longest: f32,
    dt: f32,
}

impl<'a> FreeDisplacements<'a> {
    /// Those of a step of `dt` seconds.
    pub(super) fn new(settings: &WorldSettings, forces: &'a ForceScratch, dt: f32) -> Self {
        let fall = distance_of_fall(settings.gravity, dt);
        let longest = settings.container.max_displacement();
        Self { accelerations: &forces.accelerations, fall, longest, dt }
    }

    /// That of a particle.
    pub(super) fn of(&self, particles: &Particles, index: usize) -> f32 {
        let pulled = || force_displacement(self.accelerations.get(index), None, self.dt);
        let is_movable = particles.movable[index];
        let by_forces = if is_movable { self.fall + pulled().unwrap_or(0.0) } else { 0.0 };
        (distance_at(particles.velocities[index], self.dt) + by_forces).min(self.longest)
    }
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

/// How far from its surface at the beginning of a step a particle may rest on another: its free displacement,
/// but at most its radius, and a share of its radius for surfaces that nearly touch.
#[inline(always)]
pub(super) fn reach(free: f32, radius: f32) -> f32 {
    free.min(radius) + SLACK * radius
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

impl Renewed {
    /// Begins a step.
    pub(super) fn clear(&mut self) {
        self.is_used = false;
    }
}

impl Grown {
    /// Begins a step.
    pub(super) fn clear(&mut self) {
        self.circles.clear();
    }
}

/// What the bounds of a step are made of.
pub(super) struct BoundsScratch<'a> {
    /// The tree of those with which it began.
    pub(super) tree: &'a Quadtree<f32>,
    pub(super) max_displacements: &'a mut [f32],
    pub(super) grown: &'a mut Grown,
    pub(super) renewed: &'a mut Renewed,
    pub(super) crowd: Crowd,
}

/// The bounds of a step, and the tree of those that it began with.
pub(super) struct StepBounds<'a> {
    tree: &'a Quadtree<f32>,
    particles: &'a Particles,
    max_displacements: &'a mut [f32],
    grown: &'a mut Grown,
    renewed: &'a mut Renewed,
    settings: &'a WorldSettings,
    container: Container,
    /// Typical distance between neighbouring particles.
    spacing: f32,
    crowd: Crowd,
    /// Until when the bounds are made, in seconds since the beginning of the flight.
    horizon: f64,
}

impl<'a> StepBounds<'a> {
    /// The bounds of a step, for a sub-step of `duration` seconds of flight. Those with which the step began
    /// last for a `share` of the first sub-step, if they are to be renewed in the step.
    pub(super) fn new(
        particles: &'a Particles,
        settings: &'a WorldSettings,
        scratch: BoundsScratch<'a>,
        share: Option<f64>,
        duration: f64,
    ) -> Self {
        let BoundsScratch { tree, max_displacements, grown, renewed, crowd } = scratch;
        let container = settings.container;
        let area = container.area().unwrap_or(f64::INFINITY);
        let spacing = (area / particles.len() as f64).sqrt() as f32;
        let horizon = share.map_or(f64::INFINITY, |share| share * duration);
        Self {
            tree,
            particles,
            max_displacements,
            grown,
            renewed,
            settings,
            container,
            spacing,
            crowd,
            horizon,
        }
    }

    /// The tree of the present bounds.
    fn present(&self) -> &Quadtree<f32> {
        if self.renewed.is_used { &self.renewed.tree } else { self.tree }
    }

    /// The particle at an index of that tree, and the copy of the torus in which it is.
    fn at(&self, index: usize) -> (u32, [i32; 2]) {
        if !self.renewed.is_used {
            return (index as u32, [0; 2]);
        }
        let particle = self.renewed.tree.rows()[index];
        (particle, self.renewed.tiles[particle as usize])
    }

    /// Makes bounds around the present places of all particles, for some seconds.
    fn rebuild(&mut self, now: &[Start], seconds: f32, usual_speed: f32) -> Result<()> {
        let Self { renewed, particles, container, max_displacements, settings, .. } = self;
        let Renewed { is_used, centers, tiles, shapes, tree, .. } = &mut **renewed;
        *is_used = true;
        tiles.clear();
        tiles.extend(now.iter().map(|of| container.tile(of.position.map(f64::from))));
        centers.clear();
        centers.extend(now.iter().zip(&*tiles).map(|(of, &tile)| {
            let offset = container.offset(tile);
            [0, 1].map(|k| (f64::from(of.position[k]) - offset[k]) as f32)
        }));
        let usual = usual_speed * seconds;
        let fall = distance_of_fall(settings.gravity, seconds);
        let longest = container.max_displacement();
        for (to, of) in max_displacements.iter_mut().zip(now) {
            let least = if of.is_movable { usual } else { 0.0 };
            *to = (distance_at(of.velocity, seconds).max(least) + fall).min(longest);
        }
        shapes.centers.clone_from(centers);
        let radii = shapes.radii.rows_mut();
        radii.clear();
        let all = now.iter().zip(max_displacements.iter());
        radii.extend(
            all.map(|(of, by)| of.radius + by + 2.0 * rounding(of.position, of.radius, container)),
        );
        fill_filters(particles.filters.iter().copied(), &mut shapes.filters);
        tree.rebuild(shapes, settings.tree, &|_, _| cmp::Ordering::Equal)
    }

    /// Lists the pairs of the new bounds.
    fn list_renewed(&mut self, to: &mut Candidates) -> Result<()> {
        let Self { renewed, particles, container, settings, .. } = self;
        let Renewed { tree, tiles, listing, found, numbers, .. } = &mut **renewed;
        search::list(tree, settings, false, listing, found)?;
        let sides = container.period().unwrap_or([1.0; 2]);
        numbers.clear();
        to.clear();
        // Most pairs are in the same list as the pair before.
        let mut last = None;
        for (image, pairs) in &*found {
            let image = [0, 1].map(|k| (image[k] / sides[k]).round() as i32);
            for pair in pairs {
                let [a, b] = pair.map(|index| tree.rows()[index as usize] as usize);
                let tile = [0, 1].map(|k| image[k] + tiles[a][k] - tiles[b][k]);
                let pair = [a as u32, b as u32];
                if particles.is_sensor(a) || particles.is_sensor(b) {
                    let offset = container.offset(tile);
                    to.sensed.push(NearPair { pair, offset, lasts: true });
                    continue;
                }
                let number = match last {
                    Some((last, number)) if last == tile => number,
                    _ => *numbers.entry(tile).or_insert_with(|| to.add(container.offset(tile))),
                };
                last = Some((tile, number));
                to.pairs[number].1.push(pair);
            }
        }
        Ok(())
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
            let at = index as usize;
            let (center, tile) = if self.renewed.is_used {
                (self.renewed.centers[at], self.renewed.tiles[at])
            } else {
                (self.particles.positions[at], [0; 2])
            };
            let radius = self.particles.radii[at]
                + *max_displacement
                + rounding(center, self.particles.radii[at], &self.container);
            let times = [0.0, f64::INFINITY];
            self.grown.circles.push(Circle { index, center, radius, tile, times });
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

    fn horizon(&self) -> f64 {
        self.horizon
    }

    fn renew(&mut self, now: &[Start], left: f64, to: &mut Candidates) -> Result<f64> {
        let (seconds, usual_speed) = self.crowd.horizon(now, left);
        self.grown.clear();
        self.rebuild(now, seconds as f32, usual_speed)?;
        self.list_renewed(to)?;
        Ok(seconds)
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
        let trees = [self.present(), tree];
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
                let work = each_overlap(self.present(), &of, 0.0, stack, |index| {
                    let (other, tile) = self.at(index);
                    add(other, tile, true);
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
