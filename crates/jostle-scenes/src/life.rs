//! Scenes: particle life, and a flock.

use std::sync::Arc;

use super::placing::Area;
use super::random::Random;
use super::start::Start;
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_world::container::Container;
use jostle_world::forces::{Flocking, Influence, PairForce, PairTable};
use jostle_world::particles::Particles;
use jostle_world::world::{OnTouch, WorldSettings};

/// Radius of all particles.
const RADIUS: f32 = 2.0;

/// The forces of particle life: cutoff, share of the core, and strength, for particles of mass 1.
const REACH: f32 = 40.0;
const CORE: f32 = 0.3;
const STRENGTH: f32 = 120.0;

/// Half of the speed is lost in 0.07 s.
const LIFE_DRAG: f32 = 10.0;

/// Area for each particle, so that it has about 35 others within the cutoff.
const LIFE_AREA: f32 = 145.0;

/// Attraction of each kind (row) to each kind (column).
const MATRIX: [[f32; KINDS]; KINDS] = [
    [0.7, 0.4, -0.6, -0.7, -0.2, 0.5],
    [0.5, 0.7, 0.4, -0.6, -0.7, -0.2],
    [-0.2, 0.5, 0.7, 0.4, -0.6, -0.7],
    [-0.7, -0.2, 0.5, 0.7, 0.4, -0.6],
    [-0.6, -0.7, -0.2, 0.5, 0.7, 0.4],
    [0.4, -0.6, -0.7, -0.2, 0.5, 0.7],
];
const KINDS: usize = 6;

/// Side of the torus.
fn side(n: usize, area: f32, cutoff: f32) -> f32 {
    // On a torus narrower than two cutoffs a particle would meet another one twice.
    (n as f32 * area).sqrt().max(3.0 * cutoff)
}

/// Particles at random places on a torus, which pass through each other.
fn scattered(
    n: usize,
    side: f32,
    speed: f32,
    random: &mut Random,
) -> Result<(Particles, WorldSettings)> {
    let place = |random: &mut Random| [random.between(0.0, side), random.between(0.0, side)];
    let places = memory::collect((0..n).map(|_| place(random)))?;
    let velocities = memory::collect((0..n).map(|_| random.in_disc().map(|v| v * speed)))?;
    let mut particles = Particles::try_new(places, velocities, memory::filled(n, RADIUS)?, 1.0)?;
    particles.masses = memory::filled(n, 1.0)?;
    let container = Container::Torus { size: [side, side] };
    let settings = WorldSettings { container, on_touch: OnTouch::Ignore, ..Default::default() };
    Ok((particles, settings))
}

pub(crate) fn life_view(n: usize) -> Area {
    let side = side(n, LIFE_AREA, REACH);
    [0.0, 0.0, side, side]
}

pub(crate) fn life(n: usize, random: &mut Random) -> Result<Start> {
    let (mut particles, settings) = scattered(n, side(n, LIFE_AREA, REACH), 0.0, random)?;
    // Kinds take turns, not at random: their numbers differ by at most one. Places are random, so
    // kinds are mixed.
    particles.kinds = memory::collect((0..n).map(|row| (row % KINDS) as u8))?;
    let table = PairTable::particle_life(KINDS, MATRIX.as_flattened(), REACH, CORE, STRENGTH);
    let table = Arc::new(table.expect("the matrix is valid"));
    let settings = WorldSettings { drag: LIFE_DRAG, ..settings };
    Ok(Start::new(particles, settings).with(Influence::Pair(PairForce { table })))
}

/// The flock; speeds are in px/s.
const FLOCK: Flocking = Flocking {
    cutoff: 30.0,
    separation: 300.0,
    alignment: 2.0,
    cohesion: 4.0,
    max_speed: 120.0,
    min_speed: 60.0,
};

/// Area for each bird, so that it has about ten others within the cutoff.
const FLOCK_AREA: f32 = 280.0;

pub(crate) fn flock_view(n: usize) -> Area {
    let side = side(n, FLOCK_AREA, FLOCK.cutoff);
    [0.0, 0.0, side, side]
}

pub(crate) fn flock(n: usize, random: &mut Random) -> Result<Start> {
    let side = side(n, FLOCK_AREA, FLOCK.cutoff);
    let (particles, settings) = scattered(n, side, FLOCK.max_speed, random)?;
    Ok(Start::new(particles, settings).with(Influence::Flocking(FLOCK)))
}
