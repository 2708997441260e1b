//! The renewal of bounds within a step.
//!
//! Where particles travel far in a step, bounds for all of it overlap many others, and most
//! candidate pairs are far apart. So bounds are made for a part of the step, up to a *horizon*, and
//! renewed there: circles around where the particles are then, with a tree and candidate pairs of
//! their own. The horizon decides how fast a step is, and changes no result.

use std::cmp;
use std::collections::HashMap;
use std::f64::consts::TAU;

use super::reach::{distance_at, distance_of_fall, rounding_of, torus_sides};
use super::reductions::Everywhere;
use super::search::{self, ListScratch, Lists};
use super::settings::{OnTouch, WorldSettings};
use crate::events::{Candidates, NearPair, Start};
use crate::particles::Particles;
use crate::trajectory::dot;
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_index::quadtree::Quadtree;
use jostle_index::shapes::{Shapes, fill_filters};

/// Displacement that bounds allow for, in mean displacements, because collisions make slow
/// particles faster.
/// With 1, 1.2, 1.4, 1.7, 2 and 2.4 a step of a gas took 194, 183, 182, 177, 173 and 178 ns per
/// disc (docs/benchmarks-notes.md). It changes no result: with 2 the pinned states are the same.
const USUAL: f32 = 1.7;

/// Collisions that the fastest particle on a torus may have until the horizon if it meets the
/// others at random places.
/// It trades the cost of a renewal against that of bounds which overlap many others. The program
/// tests/library/physics/test_exact_step.py prints the times of long steps.
const FEW_COLLISIONS: f64 = 16.0;

/// Parts into which the horizon divides a step at most because of few fast particles.
const MAX_PARTS_FOR_FEW: f64 = 128.0;

/// Candidate pairs that a particle may have because it moves, in a dilute gas.
/// It trades tests of candidate pairs against renewals; the same program shows the effect.
const CANDIDATES: f64 = 1.5;

/// Parts into which the horizon divides a step at most so that there are few candidate pairs.
const MAX_PARTS: f64 = 4096.0;

/// Candidate pairs of a particle that cost less to test than another renewal.
const WORTH_A_PART: f64 = 4.0;

/// For how many seconds the first bounds of a step are made, and what they allow for.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Horizon {
    pub(crate) seconds: f32,
    /// A multiple of the mean speed: how fast collisions may make a slow particle.
    pub(crate) usual_speed: f32,
    pub(crate) crowding: Crowding,
}

impl Horizon {
    /// That of a step of `dt` seconds, the same on all processes.
    pub(crate) fn new(
        everywhere: Everywhere<'_>,
        particles: &Particles,
        settings: &WorldSettings,
        dt: f32,
    ) -> Result<Self> {
        let Particles { positions, velocities, radii, .. } = particles;
        let speed = |&[u, v]: &[f32; 2]| (u * u + v * v).sqrt();
        let usual_speed = USUAL * everywhere.mean(velocities, speed)? as f32;
        // Only events in the order of time can take new candidates within a step.
        if settings.on_touch != OnTouch::Bounce {
            return Ok(Self { seconds: dt, usual_speed, crowding: Crowding::default() });
        }
        let count = everywhere.count() as f64;
        let area = match settings.container.area() {
            Some(area) => area,
            None => everywhere.area(positions)?,
        };
        let [gx, gy] = settings.gravity.map(f64::from);
        let crowding = Crowding {
            density: count / area,
            radius: everywhere.mean(radii, |&radius| radius)?,
            max_parts: (count / WORTH_A_PART).floor().clamp(1.0, MAX_PARTS),
            acceleration: (gx * gx + gy * gy).sqrt(),
            is_torus: !settings.container.period().is_none(),
        };
        // Bounds for a long step would overlap most others. Bounds for a part of it are small, but
        // each renewal builds a tree and lists pairs. The horizon is chosen so that a particle has
        // about twice the candidates that it has at rest. All ranks compute it from the same means.
        let mut parts = crowding.parts(f64::from(usual_speed), f64::from(dt));
        if crowding.is_torus {
            let all = velocities.iter().zip(radii);
            let most =
                everywhere.largest(all.map(|(&v, &radius)| crowding.collisions(v, radius)))?;
            parts = parts.max(Crowding::parts_of_the_fastest(most * f64::from(dt)));
        }
        Ok(Self { seconds: dt / parts as f32, usual_speed, crowding })
    }
}

/// How crowded the particles of a step are, from which horizons follow.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Crowding {
    /// Particles in a unit of area.
    density: f64,
    /// Their mean radius.
    radius: f64,
    /// Parts into which the horizon divides a step at most.
    max_parts: f64,
    /// Magnitude of gravity.
    acceleration: f64,
    is_torus: bool,
}

impl Crowding {
    /// Parts of `dt` seconds for each of which the bounds of a particle overlap few others. With
    /// the number density n, a typical radius r and a typical displacement d, a particle has 2 π n
    /// (r + d)² candidate pairs.
    fn parts(&self, usual_speed: f64, dt: f64) -> f64 {
        let Self { density, radius, max_parts, acceleration, .. } = *self;
        let displacement = usual_speed * dt + 0.5 * acceleration * dt * dt;
        let least = TAU * density * radius * radius;
        // Solved for d: 2 π n (r + d)² is twice the number that particles at rest would have, plus
        // `CANDIDATES`. The second term counts in a dilute gas, the first in a dense one.
        let clearance = ((2.0 * least + CANDIDATES) / (TAU * density)).sqrt() - radius;
        let parts = (displacement / clearance).ceil();
        // Not finite where there is no area.
        if parts.is_finite() { parts.clamp(1.0, max_parts) } else { 1.0 }
    }

    /// Collisions of a particle in a second, if it meets others at random places. With the speed v
    /// and the radius r it meets 2 v n (r + r̄), with the number density n and the mean radius r̄.
    fn collisions(&self, velocity: [f32; 2], radius: f32) -> f64 {
        let velocity = velocity.map(f64::from);
        let size = f64::from(radius) + self.radius;
        2.0 * dot(velocity, velocity).sqrt() * size * self.density
    }

    /// Parts of a time in which the fastest particle on a torus has so many collisions, each with
    /// few.
    fn parts_of_the_fastest(collisions: f64) -> f64 {
        (collisions / FEW_COLLISIONS).ceil().clamp(1.0, MAX_PARTS_FOR_FEW)
    }

    /// For how many of the `left` seconds bounds of these particles are made, and the speed that
    /// they allow for.
    pub(crate) fn horizon(&self, now: &[Start], left: f64) -> (f64, f32) {
        let speed = |of: &Start| dot(of.velocity.map(f64::from), of.velocity.map(f64::from)).sqrt();
        // The order of this sum may be any: the horizon changes no result.
        let mean = now.iter().map(speed).sum::<f64>() / now.len() as f64;
        let usual = f64::from(USUAL) * mean;
        let mut parts = self.parts(usual, left);
        // The mean says nothing of one fast particle, whose circle soon contains the whole torus.
        if self.is_torus {
            let all = now.iter().map(|of| self.collisions(of.velocity, of.radius));
            parts = parts.max(Self::parts_of_the_fastest(all.fold(0.0, f64::max) * left));
        }
        (left / parts, usual as f32)
    }
}

/// The bounds that replace those with which a step began, after the particles have moved far.
#[derive(Debug, Default)]
pub(crate) struct Renewed {
    /// Whether they do, in this part of the step.
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

impl Renewed {
    /// Begins a part of a step.
    pub(crate) fn begin_part(&mut self) {
        self.is_used = false;
    }

    /// Their tree, if they are used.
    pub(crate) fn tree(&self) -> Option<&Quadtree<f32>> {
        self.is_used.then_some(&self.tree)
    }

    /// The particle at an index of that tree, and the copy of the torus in which it is.
    pub(crate) fn at(&self, index: usize) -> (u32, [i32; 2]) {
        let particle = self.tree.rows()[index];
        (particle, self.tiles[particle as usize])
    }

    /// The centre of the bounds of a particle, and the copy of the torus in which it is, if they
    /// are used.
    pub(crate) fn center(&self, particle: usize) -> Option<([f32; 2], [i32; 2])> {
        self.is_used.then(|| (self.centers[particle], self.tiles[particle]))
    }

    /// Makes bounds for some seconds around where all particles are `now`, which allow for a usual
    /// speed, and writes how far particles get in them. Returns whether all particles stay in theirs if they
    /// have no events.
    pub(crate) fn rebuild(
        &mut self,
        now: &[Start],
        (seconds, usual_speed): (f32, f32),
        (particles, settings): (&Particles, &WorldSettings),
        reaches: &mut [f32],
    ) -> Result<bool> {
        let Self { is_used, centers, tiles, shapes, tree, .. } = self;
        let container = &settings.container;
        *is_used = true;
        tiles.clear();
        // Trajectories are not wrapped within a step. The centre is moved to the torus for the
        // tree, and the tile keeps how often the particle has travelled around.
        let period = container.period().exact();
        let turns = now.iter().map(|of| period.turns_of(of.position.map(f64::from)));
        memory::extend(tiles, turns)?;
        centers.clear();
        let places = now.iter().zip(&*tiles).map(|(of, &tile)| {
            let offset = period.span(tile);
            [0, 1].map(|k| (f64::from(of.position[k]) - offset[k]) as f32)
        });
        memory::extend(centers, places)?;
        let usual = usual_speed * seconds;
        let fall = distance_of_fall(settings.gravity, seconds);
        let longest = container.max_reach();
        let mut is_cut = false;
        for (to, of) in reaches.iter_mut().zip(now) {
            let least = if of.is_movable { usual } else { 0.0 };
            let own = distance_at(of.velocity, seconds);
            *to = (own.max(least) + fall).min(longest);
            is_cut |= *to < own + fall;
        }
        let columns = shapes.columns_mut();
        memory::assign(columns.centers, centers)?;
        let radii = columns.radii.rows_mut();
        radii.clear();
        let sides = torus_sides(container);
        let all = now.iter().zip(reaches.iter());
        let all =
            all.map(|(of, by)| of.radius + by + 2.0 * rounding_of(of.position, of.radius, sides));
        memory::extend(radii, all)?;
        fill_filters(particles.filters.iter().copied(), columns.filters)?;
        // Ties need no order: only the list of candidate pairs depends on this tree.
        tree.rebuild(shapes, settings.tree, &|_, _| cmp::Ordering::Equal)?;
        Ok(!is_cut)
    }

    /// Lists the candidate pairs of the new bounds.
    pub(crate) fn list(
        &mut self,
        particles: &Particles,
        settings: &WorldSettings,
        to: &mut Candidates,
    ) -> Result<()> {
        let Self { tree, tiles, listing, found, numbers, .. } = self;
        let period = settings.container.period().exact();
        search::list(tree, settings, false, listing, found)?;
        numbers.clear();
        to.clear();
        // Most pairs are in the same list as the pair before.
        let mut last = None;
        for (image, pairs) in &*found {
            let image = period.turns_of(image.map(f64::from));
            for pair in pairs {
                let [a, b] = pair.map(|index| tree.rows()[index as usize] as usize);
                // The image is between the centres on the torus. With both tiles it becomes the
                // offset between the trajectories, which are not wrapped.
                let tile = [0, 1].map(|k| image[k] + tiles[a][k] - tiles[b][k]);
                let pair = [a as u32, b as u32];
                if particles.is_sensor(a) || particles.is_sensor(b) {
                    let offset = period.span(tile);
                    memory::push(&mut to.sensed, NearPair { pair, offset, lasts: true })?;
                    continue;
                }
                let number = match last {
                    Some((last, number)) if last == tile => number,
                    _ => match numbers.get(&tile) {
                        Some(&known) => known,
                        None => {
                            let number = to.add(period.span(tile))?;
                            numbers.insert(tile, number);
                            number
                        }
                    },
                };
                last = Some((tile, number));
                memory::push(&mut to.pairs[number].1, pair)?;
            }
        }
        Ok(())
    }
}
