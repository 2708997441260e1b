//! Scenes without gravity: gases of discs.

use std::ops::Range;

use super::placing::{Area, kept, lattice, lattice_places, scatter};
use super::random::Random;
use super::start::{Start, area_of, boxed, side_for};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_world::particles::Particles;

/// Fraction of the area that the discs of a gas cover.
const COVERAGE: f32 = 0.4;

/// Maximum speed at the start, px/s.
const SPEED: f32 = 120.0;

const RADIUS: f32 = 5.0;

/// Fraction of the particles in clusters, and of the area of the clusters.
const CLUSTERED: f32 = 0.9;
const CLUSTER_AREA: f32 = 0.01;
const CLUSTERS: usize = 9;

fn velocities(count: usize, random: &mut Random) -> Result<Vec<[f32; 2]>> {
    memory::collect(velocities_of(count, random))
}

fn velocities_of(count: usize, random: &mut Random) -> impl ExactSizeIterator<Item = [f32; 2]> {
    (0..count).map(|_| random.in_disc().map(|v| v * SPEED))
}

pub(crate) fn gas_view(n: usize) -> Area {
    let side = side_for(n as f32 * area_of(RADIUS), COVERAGE, 4.0 * RADIUS);
    [0.0, 0.0, side, side]
}

pub(crate) fn gas(n: usize, random: &mut Random, rows: Range<usize>) -> Result<Start> {
    let area = gas_view(n);
    // Half of the free distance in a cell: with 0.9 of it no two discs overlap at the start.
    let gap = area[2] / (n as f32).sqrt().ceil().max(1.0) / 2.0 - RADIUS;
    let places = kept(&rows, lattice_places(n, area, 0.9 * gap.max(0.0), random))?;
    let velocities = kept(&rows, velocities_of(n, random))?;
    let radii = memory::filled(places.len(), RADIUS)?;
    Ok(Start::new(Particles::try_new(places, velocities, radii, 1.0)?, boxed(area)))
}

/// Radii from 1 to 100. Each factor of two covers the same area: the density of radii is
/// proportional to r⁻³.
fn mixed_radius(quantile: f32) -> f32 {
    let (small, large) = (1.0f32, 100.0f32);
    // The inverse of the distribution function of r⁻³ between both radii. Quantiles instead of
    // random numbers: the area covered is the same for each seed.
    let share = 1.0 - small * small / (large * large);
    (small / (1.0 - quantile * share).sqrt()).min(large)
}

/// Radii at evenly spaced quantiles, including the smallest and the largest.
fn mixed_radii(n: usize) -> impl ExactSizeIterator<Item = f32> {
    let last = n.saturating_sub(1).max(1) as f32;
    (0..n).map(move |i| mixed_radius(i as f32 / last))
}

pub(crate) fn mixed_view(n: usize) -> Area {
    let covered = mixed_radii(n).map(area_of).sum();
    let side = side_for(covered, COVERAGE, 250.0);
    [0.0, 0.0, side, side]
}

pub(crate) fn mixed(n: usize, random: &mut Random) -> Result<Start> {
    let area = mixed_view(n);
    let radii = memory::collect(mixed_radii(n))?;
    let places = scatter(&radii, area, random)?;
    let velocities = velocities(n, random)?;
    let particles = Particles::try_new(places, velocities, radii, 1.0)?;
    Ok(Start::new(particles, boxed(area)))
}

pub(crate) fn clusters_view(n: usize) -> Area {
    let clustered = CLUSTERED * n as f32 * area_of(RADIUS);
    let side = side_for(clustered / COVERAGE, CLUSTER_AREA, 40.0 * RADIUS);
    [0.0, 0.0, side, side]
}

pub(crate) fn clusters(n: usize, random: &mut Random) -> Result<Start> {
    let area = clusters_view(n);
    let side = area[2];
    let gathered = (CLUSTERED * n as f32) as usize;
    let width = side * (CLUSTER_AREA / CLUSTERS as f32).sqrt();
    let mut places = memory::with_capacity(n)?;
    for cluster in 0..CLUSTERS {
        let count = gathered * (cluster + 1) / CLUSTERS - gathered * cluster / CLUSTERS;
        // One cluster in each ninth of the square, so that they do not overlap.
        let third = side / 3.0;
        let corner = [(cluster % 3) as f32 * third, (cluster / 3) as f32 * third];
        let free = third - width;
        let [x, y] = corner.map(|c| c + free * random.between(0.1, 0.9));
        places.extend(lattice(count, [x, y, x + width, y + width], 0.0, random)?);
    }
    places.extend(lattice(n - gathered, area, 0.0, random)?);
    let velocities = velocities(n, random)?;
    let particles = Particles::try_new(places, velocities, memory::filled(n, RADIUS)?, 1.0)?;
    Ok(Start::new(particles, boxed(area)))
}
