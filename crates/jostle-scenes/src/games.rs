//! Scenes: fast discs among pegs, a billiards break, and discs that circle in a round container.

use super::placing::{Area, lattice, lattice_where};
use super::random::Random;
use super::start::{Start, area_of, boxed, side_for};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_world::container::Container;
use jostle_world::particles::Particles;
use jostle_world::world::WorldSettings;

const SHOT_RADIUS: f32 = 2.0;
const PEG_RADIUS: f32 = 10.0;

/// Movable shots for each peg.
const SHOTS_PER_PEG: usize = 4;

pub(crate) fn shots_view(n: usize) -> Area {
    let pegs = n.div_ceil(SHOTS_PER_PEG) as f32 * area_of(PEG_RADIUS);
    let side = side_for(pegs, 0.1, 200.0);
    [0.0, 0.0, side, side]
}

/// `n` particles in all; every fifth is an immovable peg.
pub(crate) fn shots(n: usize, random: &mut Random) -> Result<Start> {
    let area = shots_view(n);
    let pegs = n / (SHOTS_PER_PEG + 1);
    let peg_places = lattice(pegs, area, 0.0, random)?;
    // The distance of the pegs' columns, as `lattice` computes it, so that shots start between
    // them.
    let spacing = area[2] / (pegs as f32).sqrt().ceil().max(1.0);
    let count = n - pegs;
    // Shots start in the gaps between the pegs' columns.
    let shot_places = lattice(count, area, 0.0, random)?.into_iter().map(|[x, y]| {
        let column = (x / spacing).round() * spacing;
        [column.clamp(SHOT_RADIUS, area[2] - SHOT_RADIUS), y]
    });
    let mut places: Vec<[f32; 2]> = peg_places;
    memory::extend(&mut places, shot_places)?;
    let mut velocities = memory::filled(pegs, [0.0; 2])?;
    memory::extend(&mut velocities, (0..count).map(|_| random.in_disc().map(|v| v * 3000.0)))?;
    let radii = memory::collect((0..n).map(|i| if i < pegs { PEG_RADIUS } else { SHOT_RADIUS }))?;
    let mut particles = Particles::try_new(places, velocities, radii, 1.0)?;
    particles.movable[..pegs].fill(false);
    Ok(Start::new(particles, boxed(area)))
}

const BALL_RADIUS: f32 = 10.0;

/// Coefficient of friction of the balls with each other and with the cushions.
const BALL_FRICTION: f32 = 0.1;

/// Speed of the cue ball, and its angular velocity: side spin of half the speed on its surface.
const CUE_SPEED: f32 = 1500.0;
const CUE_SPIN: f32 = 0.5 * CUE_SPEED / BALL_RADIUS;

/// Rows of the triangle that holds all balls but the cue ball.
fn rack_rows(n: usize) -> usize {
    let balls = n.saturating_sub(1);
    (0..).find(|rows| rows * (rows + 1) / 2 >= balls).unwrap_or(0)
}

pub(crate) fn billiards_view(n: usize) -> Area {
    let height = (rack_rows(n) as f32 * 4.0 * BALL_RADIUS).max(400.0);
    [0.0, 0.0, 2.0 * height, height]
}

pub(crate) fn billiards(n: usize, random: &mut Random) -> Result<Start> {
    let area = billiards_view(n);
    let [width, height] = [area[2], area[3]];
    // Small gaps, so that the balls do not overlap at the beginning.
    // The first shock then goes through the rack ball by ball. Balls that touch exactly would
    // collide at the same time, in groups.
    let pitch = 2.0 * BALL_RADIUS * 1.002;
    let rack = (0..).flat_map(|row| (0..=row).map(move |ball| (row, ball)));
    let depth = pitch * 3f32.sqrt() / 2.0;
    let (mut places, mut velocities) = (memory::with_capacity(n)?, memory::with_capacity(n)?);
    if n > 0 {
        // Slightly off the axis, so that the break is not symmetric.
        places.push([width * 0.2, height / 2.0 + random.between(-1.0, 1.0)]);
        velocities.push([CUE_SPEED, 0.0]);
    }
    places.extend(rack.take(n.saturating_sub(1)).map(|(row, ball)| {
        let across = ball as f32 - row as f32 / 2.0;
        [width * 0.6 + row as f32 * depth, height / 2.0 + across * pitch]
    }));
    velocities.resize(n, [0.0; 2]);
    let mut particles =
        Particles::try_new(places, velocities, memory::filled(n, BALL_RADIUS)?, 1.0)?;
    for (ball, spin) in particles.try_spins_mut()?.iter_mut().enumerate() {
        spin.friction = BALL_FRICTION;
        // Side spin: friction passes it on to the balls that are hit.
        spin.velocity = if ball == 0 { CUE_SPIN } else { 0.0 };
    }
    let settings = WorldSettings { drag: 0.25, ..boxed(area) };
    Ok(Start::new(particles, settings).restitution(0.95))
}

const ORBIT_RADIUS: f32 = 4.0;
const ORBIT_COVERAGE: f32 = 0.25;

fn orbit_radius(n: usize) -> f32 {
    side_for(n as f32 * area_of(ORBIT_RADIUS), ORBIT_COVERAGE, 100.0) / std::f32::consts::PI.sqrt()
}

pub(crate) fn orbit_view(n: usize) -> Area {
    let radius = orbit_radius(n);
    [-radius, -radius, radius, radius]
}

pub(crate) fn orbit(n: usize, random: &mut Random) -> Result<Start> {
    let radius = orbit_radius(n);
    let square = orbit_view(n);
    let limit = radius - ORBIT_RADIUS;
    let is_inside = |p: &[f32; 2]| p[0] * p[0] + p[1] * p[1] < limit * limit;
    let inside = lattice_where(n, square, 0.0, random, is_inside)?;
    // All move about the centre with random deviations; the speed at the rim does not depend on the
    // size.
    // An angular velocity, so that the speed at the rim is 240 px/s in each size.
    let turn = 240.0 / radius;
    let velocities = memory::collect(inside.iter().map(|&[x, y]| {
        let [u, v] = random.in_disc().map(|v| v * 0.1 * turn * radius);
        [-turn * y + u, turn * x + v]
    }))?;
    let settings = WorldSettings {
        container: Container::Circle { center: [0.0; 2], radius },
        ..WorldSettings::default()
    };
    Ok(Start::new(
        Particles::try_new(inside, velocities, memory::filled(n, ORBIT_RADIUS)?, 1.0)?,
        settings,
    ))
}
