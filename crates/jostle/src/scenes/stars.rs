//! Dust that becomes stars.

use super::Start;
use super::placing::Area;
use super::random::Random;
use crate::forces::{Force, Gravitation};
use crate::particles::Particles;
use crate::world::{OnTouch, WorldSettings};

/// Number and radius of the dust, and the radius of its cloud.
const DUST_COUNT: f32 = 10_000.0;
const DUST: f32 = 0.5;
const CLOUD: f32 = 400.0;

/// The constant of gravitation for so much dust.
const G: f32 = 70.0;

/// Share of the speed at which the cloud would carry itself, so it falls in slowly.
const TURN: f32 = 0.85;

/// Within this share of the radius it turns like one piece.
const CORE: f32 = 0.1;

/// Speed at random, as a share of the turning.
const UNREST: f32 = 0.07;

/// Everything grows with the root of the number.
fn scale(n: usize) -> f32 {
    (n as f32 / DUST_COUNT).sqrt().max(0.02)
}

pub fn stars_view(n: usize) -> Area {
    let reach = 1.15 * CLOUD * scale(n);
    [-reach, -reach, reach, reach]
}

pub fn stars(n: usize, random: &mut Random) -> Start {
    let cloud = CLOUD * scale(n);
    // The larger the cloud, the stronger the pull: every cloud takes the same time.
    let g = G * scale(n);
    let mass = n as f32 * DUST * DUST;
    // The mass within a radius grows with the radius, so one speed carries all.
    let speed = TURN * (g * mass / cloud).sqrt();
    let (mut places, mut velocities) = (Vec::with_capacity(n), Vec::with_capacity(n));
    for _ in 0..n {
        let [x, y] = random.in_disc();
        let length = (x * x + y * y).sqrt();
        places.push([x, y].map(|v| v * length * cloud));
        let turn = speed / length.max(CORE.sqrt());
        let [u, v] = random.in_disc().map(|v| v * UNREST * speed);
        velocities.push([u - y * turn, v + x * turn]);
    }
    let particles = Particles::new(places, velocities, vec![DUST; n], 1.0);
    let settings =
        WorldSettings { on_touch: OnTouch::Merge, substeps: Some(1), ..Default::default() };
    let pull = Gravitation { g, softening: 2.0 * DUST, theta: 0.7 };
    Start::new(particles, settings).with(Force::Gravitation(pull))
}
