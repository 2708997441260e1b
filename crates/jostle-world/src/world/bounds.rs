//! Swept bounds: for each particle a circle in which it is expected to stay during a step. The tree of these
//! circles is the broad phase (C. Ericson, *Real-Time Collision Detection*, 2005).
//!
//! A particle that leaves its circle gets a larger one, or, if it travels around a torus, a chain of
//! circles along its trajectory.

use std::cmp;
use std::collections::HashSet;
use std::sync::atomic::{AtomicBool, Ordering};

use super::force_step::force_displacement;
use super::plan::Plan;
use super::reach::{
    FreeReaches, distance_at, distance_of_fall, rest_distance, rounding, rounding_of, torus_sides,
};
use super::renewal::{Crowding, Renewed};
use super::search::MAX_CANDIDATES;
use super::{OnTouch, StepScratch, WorldSettings};
use crate::container::Container;
use crate::events::{Candidates, NearPair, Outside, Start, SweptBounds};
use crate::particles::Particles;
use crate::trajectory::{Piece, Vector, dot};
use jostle_base::error::{Error, Result};
use jostle_base::interrupt::Pulse;
use jostle_base::memory;
use jostle_base::parallel;
use jostle_index::geometry::{self, Shape};
use jostle_index::quadtree::Quadtree;
use jostle_index::query::each_overlap;
use jostle_index::shapes::{Filter, Shapes, fill_filters};

/// Circles of a chain at most.
const MAX_CIRCLES: f64 = 4096.0;

/// Pairs that one call of [`StepBounds::grow`] may find.
const MAX_NEW: usize = MAX_CANDIDATES / 8;

/// Tests of circles that grow in one window, at most: so many, and so many for each particle. A few discs
/// that others make faster and faster on a torus would take minutes. In a step of the scenes gas and sand
/// there are 3 and 25 tests for each particle.
const MAX_TESTS: usize = 1 << 24;
const MAX_TESTS_OF_EACH: usize = 1 << 12;

/// Displacements, in units of [`Container::max_reach`], up to which one circle is made. It and a particle
/// together are at most half as large as the torus.
/// Times [`GROWTH`] and an eighth of the shorter side this is a quarter of the side, and a radius
/// is at most another quarter.
const ONE_CIRCLE: f64 = 1.6;

/// Share of the radius by which bounds are larger than needed for contacts, because of rounding.
const RESERVE: f32 = 0.001;

/// Bounds that are too small grow to this many times what is needed, so that they rarely have to
/// grow twice.
const GROWTH: f64 = 1.25;

/// Computes the bounds of a part of a step. If a particle moves farther, [`StepBounds::grow`] enlarges
/// its bounds: the answer does not depend on them. Returns whether all particles stay in theirs if they have no
/// events.
pub(crate) fn find_bounds(
    particles: &Particles,
    settings: &WorldSettings,
    scratch: &mut StepScratch,
    plan: &Plan,
) -> Result<bool> {
    let Plan { may_rest, threads, horizon: dt, .. } = *plan;
    let StepScratch { reaches, forces, horizon, shapes, .. } = scratch;
    // A collision may make a slow particle faster. So each movable particle gets at least the
    // usual displacement, and few leave their bounds, which would cost a search for each.
    let usual = (horizon.usual_speed * dt).min(settings.container.max_reach());
    let accelerations = &forces.accelerations;
    let fall = distance_of_fall(settings.gravity, dt);
    let free = FreeReaches::new(settings, forces, plan.dt);
    // Particles that merge are not searched again, so their bounds contain the estimated
    // displacements by springs.
    let is_merging = settings.on_touch == OnTouch::Merge;
    let by_springs = if is_merging { &forces.spring_displacements[..] } else { &[] };
    let is_pulled = !(accelerations.is_empty() && by_springs.is_empty());
    let pulled = |index: usize| {
        force_displacement(accelerations.get(index), by_springs.get(index), dt).unwrap_or(0.0)
    };
    // On a torus, bounds are cut so that few images of other particles are in them: `grow`
    // finds more when a particle gets there. The candidates of particles that merge are
    // searched once, so their bounds are not cut.
    let longest = if is_merging { f32::INFINITY } else { settings.container.max_reach() };
    let len = particles.len();
    let columns = shapes.columns_mut();
    memory::assign(columns.centers, &particles.positions)?;
    *columns.half_sizes = None;
    fill_filters(particles.filters.iter().copied(), columns.filters)?;
    let radii = columns.radii.rows_mut();
    memory::resize(radii, len, 0.0)?;
    memory::resize(reaches, len, 0.0)?;
    // If an own displacement is cut, its particle may leave the bounds without any event. Then
    // the first flight must test where particles get.
    let is_cut = AtomicBool::new(false);
    let sides = torus_sides(&settings.container);
    parallel::for_chunks_of_two(threads, reaches, radii, |first, reaches, radii| {
        let bounds = reaches.iter_mut().zip(&mut *radii);
        let columns = particles.velocities[first..].iter().zip(&particles.positions[first..]);
        let own = particles.radii[first..].iter().zip(&particles.movable[first..]);
        let mut any_cut = false;
        let all = bounds.zip(columns).zip(own).zip(first..);
        for ((((reach, radius), (&velocity, &center)), (&own_radius, &is_movable)), index) in all {
            let own = distance_at(velocity, dt);
            let mut by_forces = fall;
            if is_pulled {
                by_forces += pulled(index);
            }
            // Nothing but its own velocity moves an immovable particle.
            let (least, by_forces) = if is_movable { (usual, by_forces) } else { (0.0, 0.0) };
            *reach = (own.max(least) + by_forces).min(longest);
            any_cut |= *reach < own + by_forces;
            *radius = own_radius + *reach + rounding_of(center, own_radius, sides);
        }
        // The value is read after all threads have joined, so no order of memory is needed.
        if any_cut {
            is_cut.store(true, Ordering::Relaxed);
        }
        // Contacts are made of pairs that come near each other by themselves. Candidates
        // must contain these pairs. Otherwise the size of the bounds would decide which
        // contacts there are.
        if !may_rest {
            return;
        }
        let bounds = reaches.iter_mut().zip(radii).zip(first..);
        contain_contacts(particles, &free, bounds);
    });
    Ok(!is_cut.into_inner())
}

/// Makes bounds contain what contacts are made of: displacements and radii, with the index of each
/// particle.
fn contain_contacts<'a>(
    particles: &Particles,
    free: &FreeReaches<'_>,
    bounds: impl Iterator<Item = ((&'a mut f32, &'a mut f32), usize)>,
) {
    for ((reach, radius), index) in bounds {
        let own_radius = particles.radii[index];
        let least = rest_distance(free.of(particles, index), own_radius) + RESERVE * own_radius;
        *radius += (least - *reach).max(0.0);
        *reach = reach.max(least);
    }
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
pub(crate) struct Grown {
    circles: Vec<Circle>,
    /// The pieces that have chains.
    chained: HashSet<[u64; 6]>,
    shapes: Shapes<f32>,
    tree: Quadtree<f32>,
    stack: Vec<u32>,
    /// Tests of circles in the window.
    tests: usize,
}

impl Grown {
    /// Begins a part of a step.
    pub(crate) fn begin_part(&mut self) {
        self.circles.clear();
    }
}

/// What the bounds of a step are made of.
pub(crate) struct BoundsScratch<'a> {
    /// The tree of those with which it began.
    pub(crate) tree: &'a Quadtree<f32>,
    pub(crate) reaches: &'a mut [f32],
    pub(crate) grown: &'a mut Grown,
    pub(crate) renewed: &'a mut Renewed,
    pub(crate) crowding: Crowding,
}

/// The bounds of a step, and the tree of those that it began with.
pub(crate) struct StepBounds<'a> {
    tree: &'a Quadtree<f32>,
    particles: &'a Particles,
    reaches: &'a mut [f32],
    grown: &'a mut Grown,
    renewed: &'a mut Renewed,
    settings: &'a WorldSettings,
    container: Container,
    /// Typical distance between neighbouring particles.
    spacing: f32,
    crowding: Crowding,
    /// Until when the bounds are made, in seconds since the beginning of the flight.
    horizon: f64,
}

impl<'a> StepBounds<'a> {
    /// The bounds of a step, for a sub-step of `duration` seconds of flight. Those with which the
    /// step began last for a `share` of the first sub-step, if they are to be renewed in the step.
    pub(crate) fn new(
        particles: &'a Particles,
        settings: &'a WorldSettings,
        scratch: BoundsScratch<'a>,
        share: Option<f64>,
        duration: f64,
    ) -> Self {
        let BoundsScratch { tree, reaches, grown, renewed, crowding } = scratch;
        let container = settings.container;
        let area = container.area().unwrap_or(f64::INFINITY);
        let spacing = (area / particles.len() as f64).sqrt() as f32;
        let horizon = share.map_or(f64::INFINITY, |share| share * duration);
        Self {
            tree,
            particles,
            reaches,
            grown,
            renewed,
            settings,
            container,
            spacing,
            crowding,
            horizon,
        }
    }

    /// Appends circles around where a particle gets, and adapts its bounds if one circle is enough.
    fn cover(&mut self, outside: &Outside, gravity: Vector, end: f64) -> Result<()> {
        let Outside { index, distance, .. } = *outside;
        // One circle for a long path would contain most of the torus, and images of itself. A chain
        // of small circles follows the path instead.
        if distance > ONE_CIRCLE * f64::from(self.container.max_reach()) {
            return self.cover_by_chain(outside, gravity, end);
        }
        let reach = &mut self.reaches[index as usize];
        // Another of its pieces may have made them large enough.
        if distance > f64::from(*reach) {
            *reach = (distance * GROWTH) as f32;
            // Bounds grow around their present centre: that of the last renewal, or of the
            // beginning of the step.
            let at = index as usize;
            let of_step = || (self.particles.positions[at], [0; 2]);
            let (center, tile) = self.renewed.center(at).unwrap_or_else(of_step);
            let radius = self.particles.radii[at]
                + *reach
                + rounding(center, self.particles.radii[at], &self.container);
            let times = [0.0, f64::INFINITY];
            let circle = Circle { index, center, radius, tile, times };
            memory::push(&mut self.grown.circles, circle)?;
        }
        Ok(())
    }

    /// Appends circles along a piece.
    fn cover_by_chain(&mut self, outside: &Outside, gravity: Vector, end: f64) -> Result<()> {
        let Outside { index, piece, .. } = *outside;
        let Piece { time, position: [x, y], velocity: [u, v], .. } = piece;
        // A piece may be reported several times in a window. Its bits name it, so one chain is
        // made.
        let key = [f64::from(index), time, x, y, u, v].map(f64::to_bits);
        let chained = &mut self.grown.chained;
        let room = chained.try_reserve(1);
        room.map_err(|error| memory::no_memory::<[u64; 6]>(&error, chained.len() + 1))?;
        if !chained.insert(key) {
            return Ok(());
        }
        // Along a parabola the speed is largest at an end.
        let speeds = [time, end].map(|time| {
            let [_, velocity] = piece.at(time, gravity);
            dot(velocity, velocity).sqrt()
        });
        let displacement = speeds[0].max(speeds[1]) * (end - time);
        // Circles about as large as the distances between particles find few of them.
        let size =
            self.container.max_reach().min(self.spacing.max(self.particles.radii[index as usize]));
        let count = (displacement / f64::from(size)).ceil().max(1.0);
        if count > MAX_CIRCLES {
            return Err(Error::TooManyCandidates { limit: MAX_NEW });
        }
        // Each circle stands for the same time. In it the particle travels at most displacement /
        // count, so at most half of this before and after the middle. The factor is a reserve for
        // rounding.
        let interval = (end - time) / count;
        let radius = self.particles.radii[index as usize];
        let radius = (f64::from(radius) + 0.5 * displacement / count) as f32 * 1.001;
        let period = self.container.period().exact();
        for number in 0..count as usize {
            let times = [number, number + 1].map(|number| time + number as f64 * interval);
            let middle = piece.position_at(0.5 * (times[0] + times[1]), gravity);
            // Trajectories are not wrapped within a step, but the tree is on the torus. The tile
            // tells how often the particle has travelled around, so the offset of a pair is a
            // difference of tiles.
            let tile = period.turns_of(middle);
            let offset = period.span(tile);
            let center = [0, 1].map(|k| (middle[k] - offset[k]) as f32);
            let radius = radius + rounding(center, radius, &self.container);
            // A step whose positions overflow is refused when they are stored.
            if center.into_iter().chain([radius]).all(f32::is_finite) {
                let circle = Circle { index, center, radius, tile, times };
                memory::push(&mut self.grown.circles, circle)?;
            }
        }
        Ok(())
    }

    /// The copies of the torus that have a point within some distance of it.
    fn tiles(&self, distance: f32) -> impl Iterator<Item = [i32; 2]> + use<> {
        let period = self.container.period();
        let count = |k: usize| (distance / period.sides()[k]).ceil() as i32;
        let [columns, rows] = [0, 1].map(|k| if period.is_along(k) { count(k) } else { 0 });
        (-columns..=columns).flat_map(move |i| (-rows..=rows).map(move |j| [i, j]))
    }
}

impl SweptBounds for StepBounds<'_> {
    fn reaches(&self) -> &[f32] {
        self.reaches
    }

    fn horizon(&self) -> f64 {
        self.horizon
    }

    fn renew(&mut self, now: &[Start], left: f64, to: &mut Candidates) -> Result<(f64, bool)> {
        let (seconds, usual_speed) = self.crowding.horizon(now, left);
        let Self { particles, settings, reaches, grown, renewed, .. } = self;
        // The circles that have grown enlarge the old bounds.
        grown.circles.clear();
        let allowed = (seconds as f32, usual_speed);
        let are_within = renewed.rebuild(now, allowed, (particles, settings), reaches)?;
        renewed.list(particles, settings, to)?;
        Ok((seconds, are_within))
    }

    fn begin_window(&mut self) {
        self.grown.tests = 0;
        // A whole circle lasts as long as the bounds that it enlarges. The times of a chain are
        // those of its window.
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
        let columns = shapes.columns_mut();
        columns.centers.clear();
        memory::extend(columns.centers, circles.iter().map(|circle| circle.center))?;
        let radii = columns.radii.rows_mut();
        radii.clear();
        memory::extend(radii, circles.iter().map(|circle| circle.radius))?;
        let all = self.particles;
        let filtered = if all.filters.is_empty() { &[][..] } else { &circles[..] };
        let filters = filtered.iter().map(|circle| all.filter(circle.index as usize));
        fill_filters(filters, columns.filters)?;
        // Ties need no order: only the list of candidate pairs depends on this tree.
        tree.rebuild_unchecked(shapes, self.tree.settings(), &|_, _| cmp::Ordering::Equal)?;
        // The stack is taken out, because the search borrows the rest of `self`.
        let mut stack = std::mem::take(&mut self.grown.stack);
        let found = self.find_pairs(known, &mut stack, pairs);
        self.grown.stack = stack;
        self.grown.tests = found?;
        Ok(())
    }
}

impl StepBounds<'_> {
    /// Appends the pairs of the particles in new circles, from number `first` on, and all others.
    /// Returns the number of tests of the window.
    fn find_pairs(
        &self,
        first: usize,
        stack: &mut Vec<u32>,
        pairs: &mut Vec<NearPair>,
    ) -> Result<usize> {
        let Grown { circles, tree, .. } = &*self.grown;
        let mut tests = self.grown.tests;
        let most = MAX_TESTS.max(MAX_TESTS_OF_EACH * self.particles.len());
        let (renewed, period) = (self.renewed.tree(), self.container.period().exact());
        let present = renewed.unwrap_or(self.tree);
        // Two trees hold all particles: one the bounds that all had at first or at the renewal, the
        // other the circles that have been added since.
        let trees = [present, tree];
        // The root has the largest radius of its tree. The centres are on the torus, so an image
        // farther away than both radii cannot overlap.
        let largest = trees.map(|tree| tree.bounds().first().map_or(0.0, |root| root.radius));
        let largest = largest[0].max(largest[1]);
        let mut pulse = Pulse::current();
        for circle in &circles[first..] {
            let Filter { category, mask } = self.particles.filter(circle.index as usize);
            // The images of the others at +offset are around the particle at −offset.
            for image in self.tiles(circle.radius + largest) {
                let offset = period.span(image).map(|v| v as f32);
                let center = [0, 1].map(|k| circle.center[k] - offset[k]);
                let of = geometry::Bounds::of(&Shape {
                    min: center,
                    max: center,
                    half_size: [0.0; 2],
                    radius: circle.radius,
                    category,
                    mask,
                    core: geometry::Core::Box,
                });
                let mut done = Ok(());
                let mut add = |other: u32, tile: [i32; 2], lasts: bool| {
                    if other != circle.index {
                        // The tile of the first, and the image in which both overlap, lead to the
                        // copy of the torus in which the other has its circle. Its own tile counts
                        // back to where it is.
                        let tile = [0, 1].map(|k| circle.tile[k] + image[k] - tile[k]);
                        let offset = period.span(tile);
                        let pair = [circle.index, other];
                        // A pair of a circle of a chain is known for this window only.
                        let near = NearPair { pair, offset, lasts: lasts && circle.is_whole() };
                        if let Err(error) = memory::push(pairs, near) {
                            done = Err(error);
                        }
                    }
                };
                let work = each_overlap(present, &of, 0.0, stack, |index| {
                    let (other, tile) = match renewed {
                        Some(_) => self.renewed.at(index),
                        None => (index as u32, [0; 2]),
                    };
                    add(other, tile, true);
                });
                pulse.check(work)?;
                tests += work;
                let work = each_overlap(tree, &of, 0.0, stack, |index| {
                    let other = &circles[tree.rows()[index] as usize];
                    let [start, end] = other.times;
                    // Circles of two chains matter only if both particles are in them at the same
                    // time.
                    if start <= circle.times[1] && circle.times[0] <= end {
                        add(other.index, other.tile, other.is_whole());
                    }
                });
                done?;
                pulse.check(work)?;
                tests += work;
            }
            if pairs.len() > MAX_NEW {
                return Err(Error::TooManyCandidates { limit: MAX_NEW });
            }
            if tests > most {
                return Err(Error::TooManyCandidates { limit: most });
            }
        }
        Ok(tests)
    }
}
