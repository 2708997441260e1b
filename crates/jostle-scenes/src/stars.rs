//! Scene: a cloud of dust collapses under its gravitation, and grains that touch merge.

use super::placing::Area;
use super::random::Random;
use super::start::Start;
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_world::forces::{Gravitation, Influence};
use jostle_world::particles::Particles;
use jostle_world::world::{OnTouch, WorldSettings};

/// Number and radius of the grains, and the radius of the cloud.
const DUST_COUNT: f32 = 10_000.0;
const DUST: f32 = 0.5;
const CLOUD: f32 = 400.0;

/// The gravitational constant for this number of grains.
const G: f32 = 70.0;

/// Fraction of the circular orbital speed, so that the cloud contracts slowly.
const TURN: f32 = 0.85;

/// Fraction of the radius within which the rotation is rigid.
const CORE: f32 = 0.1;

/// Random speed as a fraction of the orbital speed.
const RANDOM_SPEED: f32 = 0.07;

/// Factor of all lengths, proportional to the square root of the number.
fn scale(n: usize) -> f32 {
    (n as f32 / DUST_COUNT).sqrt().max(0.02)
}

pub(crate) fn stars_view(n: usize) -> Area {
    let half = 1.15 * CLOUD * scale(n);
    [-half, -half, half, half]
}

pub(crate) fn stars(n: usize, random: &mut Random) -> Result<Start> {
    let cloud = CLOUD * scale(n);
    // Gravitation grows with the size of the cloud, so every cloud takes the same time.
    let g = G * scale(n);
    let mass = n as f32 * DUST * DUST;
    // The mass within a radius is proportional to it, so the orbital speed is constant.
    let speed = TURN * (g * mass / cloud).sqrt();
    let (mut places, mut velocities) = (memory::with_capacity(n)?, memory::with_capacity(n)?);
    for _ in 0..n {
        let [x, y] = random.in_disc();
        let length = (x * x + y * y).sqrt();
        // A uniform point of the unit disc, moved towards the centre by its own distance: then the
        // mass within r grows with r, not with r².
        places.push([x, y].map(|v| v * length * cloud));
        // `x` and `y` over their length are the direction, so all move at one speed, but for those
        // of the core.
        let turn = speed / length.max(CORE.sqrt());
        let [u, v] = random.in_disc().map(|v| v * RANDOM_SPEED * speed);
        velocities.push([u - y * turn, v + x * turn]);
    }
    let particles = Particles::try_new(places, velocities, memory::filled(n, DUST)?, 1.0)?;
    let settings =
        WorldSettings { on_touch: OnTouch::Merge, substeps: Some(1), ..Default::default() };
    let pull = Gravitation { g, softening: 2.0 * DUST, theta: 0.7 };
    Ok(Start::new(particles, settings).with(Influence::Gravitation(pull)))
}
