//! Scenes without gravity with two kinds of discs.

use std::ops::Range;

use super::placing::{Area, kept, lattice_places, lattice_where};
use super::random::Random;
use super::start::{Start, area_of, boxed, side_for};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_world::forces::{Influence, Thermostat};
use jostle_world::particles::Particles;

/// Radius and coverage of both gases.
const RADIUS: f32 = 4.0;
const COVERAGE: f32 = 0.3;

/// Densities of the gases on the left and on the right.
const DENSITIES: [f32; 2] = [1.0, 8.0];

/// Maximum speeds of both at the start, px/s.
const SPEEDS: [f32; 2] = [400.0, 60.0];

/// Target speed of the walls, between both.
const WALLS: Thermostat = Thermostat { speed: 180.0, rate: 0.2 };

pub(crate) fn thermostat_view(n: usize) -> Area {
    let height = side_for(n as f32 * area_of(RADIUS), 1.6 * COVERAGE, 40.0);
    [0.0, 0.0, 1.6 * height, height]
}

/// Half of the discs are on either side.
pub(crate) fn thermostat(n: usize, random: &mut Random, rows: Range<usize>) -> Result<Start> {
    let area = thermostat_view(n);
    let [min_x, min_y, max_x, max_y] = area;
    let middle = (min_x + max_x) / 2.0;
    let light = n.div_ceil(2);
    let sides = [[min_x, min_y, middle, max_y], [middle, min_y, max_x, max_y]];
    let mut places = Vec::new();
    for (first, count, side) in [(0, light, sides[0]), (light, n - light, sides[1])] {
        // The range of rows counts from the start of all; on either side rows count from its first
        // disc.
        let rows = rows.start.saturating_sub(first)..rows.end.saturating_sub(first);
        memory::append(&mut places, &kept(&rows, lattice_places(count, side, 0.5, random))?)?;
    }
    let kind = |row: usize| usize::from(row >= light);
    let velocity = |row| random.in_disc().map(|v| v * SPEEDS[kind(row)]);
    let velocities = kept(&rows, (0..n).map(velocity))?;
    let radii = memory::filled(places.len(), RADIUS)?;
    let mut particles = Particles::try_new(places, velocities, radii, 1.0)?;
    let masses = particles.masses.iter_mut().zip(rows.start..);
    masses.for_each(|(mass, row)| *mass *= DENSITIES[kind(row)]);
    let settings = boxed(area);
    Ok(Start::new(particles, settings).with(Influence::Thermostat(WALLS)))
}

/// Radii of the large disc and of the small discs around it.
const LARGE: f32 = 36.0;
const SMALL: f32 = 3.0;

/// Fraction of the area that the gas covers, and its maximum speed at the start, px/s.
const THIN: f32 = 0.2;
const SPEED: f32 = 500.0;

pub(crate) fn brownian_view(n: usize) -> Area {
    let side = side_for(n as f32 * area_of(SMALL) + area_of(LARGE), THIN, 8.0 * LARGE);
    [0.0, 0.0, side, side]
}

/// `n` particles in all; the first is the large one.
pub(crate) fn brownian(n: usize, random: &mut Random) -> Result<Start> {
    let area = brownian_view(n);
    let middle = area[2] / 2.0;
    let gas = n.saturating_sub(1);
    let mut places = memory::filled(n.min(1), [middle; 2])?;
    // With room for the displacement of the lattice, so that no small disc begins inside the large
    // one.
    let others = around(gas, area, [middle; 2], LARGE + 2.0 * SMALL, random)?;
    memory::append(&mut places, &others)?;
    let mut velocities = memory::filled(n.min(1), [0.0; 2])?;
    memory::extend(&mut velocities, (0..gas).map(|_| random.in_disc().map(|v| v * SPEED)))?;
    let mut radii = memory::filled(n.min(1), LARGE)?;
    memory::resize(&mut radii, n, SMALL)?;
    let particles = Particles::try_new(places, velocities, radii, 1.0)?;
    Ok(Start::new(particles, boxed(area)))
}

/// `count` positions on a lattice outside of a circle.
fn around(
    count: usize,
    area: Area,
    [x, y]: [f32; 2],
    radius: f32,
    random: &mut Random,
) -> Result<Vec<[f32; 2]>> {
    let free = |p: &[f32; 2]| {
        let offset = [p[0] - x, p[1] - y];
        offset[0] * offset[0] + offset[1] * offset[1] > radius * radius
    };
    lattice_where(count, area, 0.5, random, free)
}
