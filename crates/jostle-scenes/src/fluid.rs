//! Scene: two droplets of a Lennard-Jones fluid meet.

use std::sync::Arc;

use super::placing::Area;
use super::random::Random;
use super::start::Start;
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_world::container::Container;
use jostle_world::forces::{Influence, PairForce, PairTable};
use jostle_world::particles::Particles;
use jostle_world::world::{OnTouch, WorldSettings};

/// σ and ε of the particles, whose mass is 1. The unit of time, σ/√ε, is 0.21 s.
const SIGMA: f32 = 6.0;
const EPSILON: f32 = 800.0;

/// The cutoff over σ.
const CUTOFF: f32 = 2.5;

/// Sub-steps of about 0.01 units of time.
const SUBSTEPS: usize = 8;

/// Distance of neighbours over σ, at the minimum of the potential.
const SPACING: f32 = 1.122_462;

/// Temperature over ε of the velocities. Half of it becomes potential energy of the lattice.
const HEAT: f32 = 1.1;

/// Speed of the droplets over √ε, and their offset from each other's line over their radius.
const SPEED: f32 = 0.8;
const OFFSET: f32 = 0.5;

/// Side of the torus over the radius of a droplet.
const ROOM: f32 = 5.5;

/// Radius of a droplet of half of the particles.
fn droplet(n: usize) -> f32 {
    let cell = 0.866_025_4 * (SPACING * SIGMA) * (SPACING * SIGMA);
    (0.5 * n as f32 * cell / std::f32::consts::PI).sqrt().max(SIGMA)
}

pub(crate) fn fluid_view(n: usize) -> Area {
    let side = ROOM * droplet(n);
    [0.0, 0.0, side, side]
}

pub(crate) fn fluid(n: usize, random: &mut Random) -> Result<Start> {
    let (radius, side) = (droplet(n), ROOM * droplet(n));
    let (mut places, mut velocities) = (memory::with_capacity(n)?, memory::with_capacity(n)?);
    for (count, direction) in [(n / 2, 1.0), (n - n / 2, -1.0)] {
        // With the default number further apart than the cutoff, and beside each other's line, so
        // that the merged droplet turns.
        let center = [-1.3 * radius * direction, -0.5 * OFFSET * radius * direction];
        for site in hexagonal(count)? {
            places.push([0, 1].map(|k| 0.5 * side + center[k] + site[k]));
            // The variance of a component is a quarter of the squared radius of the disc.
            // A uniform disc, not Maxwell's distribution, which needs a logarithm; collisions soon
            // make that of it.
            let heat = random.in_disc().map(|v| v * 2.0 * (HEAT * EPSILON).sqrt());
            velocities.push([heat[0] + direction * SPEED * EPSILON.sqrt(), heat[1]]);
        }
    }
    let mut particles =
        Particles::try_new(places, velocities, memory::filled(n, 0.5 * SIGMA)?, 1.0)?;
    particles.masses = memory::filled(n, 1.0)?;
    let settings = WorldSettings {
        container: Container::Torus { size: [side, side] },
        on_touch: OnTouch::Ignore,
        substeps: Some(SUBSTEPS),
        ..Default::default()
    };
    let table = PairTable::lennard_jones(1, &[EPSILON], &[SIGMA], CUTOFF * SIGMA);
    let table = Arc::new(table.expect("the numbers are valid"));
    Ok(Start::new(particles, settings).with(Influence::Pair(PairForce { table })))
}

/// The sites of a hexagonal lattice that are nearest to its centre.
fn hexagonal(count: usize) -> Result<Vec<[f32; 2]>> {
    // More rows than a disc of so many sites has.
    // A hexagonal lattice of distance 1 has about 2π / √3 · r² sites within r, so this is enough in
    // each direction.
    let half = (count as f32).sqrt() as i32 + 2;
    let step = SPACING * SIGMA;
    let site = |row: i32, column: i32| {
        let shift = if row % 2 == 0 { 0.0 } else { 0.5 };
        [step * (column as f32 + shift), step * 0.866_025_4 * row as f32]
    };
    let sites = (-half..=half).flat_map(|row| (-half..=half).map(move |at| site(row, at)));
    let mut all: Vec<[f32; 2]> = Vec::new();
    memory::extend(&mut all, sites)?;
    let mut sites = all;
    let square = |[x, y]: &[f32; 2]| x * x + y * y;
    // Sites at one distance keep the order of rows, on each machine.
    sites.sort_unstable_by(|a, b| {
        let of_place = |k: usize| a[k].total_cmp(&b[k]);
        square(a).total_cmp(&square(b)).then_with(|| of_place(1)).then_with(|| of_place(0))
    });
    sites.truncate(count);
    Ok(sites)
}
