//! A fountain: bowls of beads, and the nozzles that fill them.
//!
//! A world has nothing that makes particles. What steps it may add what is due at the
//! nozzles and take the oldest drops away; here is where, how fast and how many.

use super::placing::{Area, immovable, walls};
use super::random::Random;
use super::{Start, boxed, find};
use crate::error::Result;
use crate::particles::Particles;
use crate::world::WorldSettings;

/// The cap for which the lengths below are written.
const DEFAULT_CAP: f32 = 3000.0;

/// Seconds that a drop stays, once there are as many as the cap allows.
const LIFE: f32 = 11.0;

const GRAVITY: f32 = 900.0;
const BEAD: f32 = 4.0;
const DROPS: [f32; 2] = [2.4, 3.4];

/// Seconds of their flight that the jets have behind them at the start.
const FLOWN: f32 = 0.6;

/// The view: half its width, and its height above the floor at y = 0.
const HALF_WIDTH: f32 = 480.0;
const HEIGHT: f32 = 640.0;

/// The right halves of the bowls, from the middle outwards.
const TOP: [[f32; 2]; 3] = [[0.0, -330.0], [60.0, -330.0], [95.0, -356.0]];
const MIDDLE: [[f32; 2]; 3] = [[0.0, -180.0], [180.0, -180.0], [235.0, -218.0]];
const POOL: [[f32; 2]; 2] = [[400.0, 0.0], [440.0, -90.0]];

/// What carries the bowls: lines on the right of the middle.
const STEMS: [[[f32; 2]; 2]; 2] = [[[12.0, -322.0], [12.0, -188.0]], [[26.0, -172.0], [40.0, 0.0]]];

/// Where drops come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nozzle {
    /// Their centre as they come out.
    pub position: [f32; 2],
    /// Their velocity, px/s.
    pub velocity: [f32; 2],
    /// They come out anywhere on a line of this length across the velocity.
    pub width: f32,
    /// Most that is added to it by chance, in any direction, px/s.
    pub spread: f32,
    /// The smallest radius and the largest.
    pub radii: [f32; 2],
    /// Mass over the radius squared, by which the jets can be told apart.
    pub density: f32,
    /// How many come out in a second.
    pub drops_per_second: f32,
}

/// The nozzles of the scene `emitters` with at most `n` drops (`None`: as many as suit it).
pub fn fountains(n: Option<usize>) -> Result<Vec<Nozzle>> {
    Ok(nozzles(find("emitters")?.count(n)?).to_vec())
}

/// Everything grows with the number of drops.
fn scale(n: usize) -> f32 {
    (n as f32 / DEFAULT_CAP).sqrt().max(0.25)
}

fn nozzles(n: usize) -> [Nozzle; 3] {
    let scale = scale(n);
    // On the way up and down time grows with the root of the height.
    let faster = scale.sqrt();
    let drops_per_second = n as f32 / (3.0 * LIFE * faster);
    let nozzle = |position: [f32; 2], velocity: [f32; 2], density| Nozzle {
        position: position.map(|v| v * scale),
        velocity: velocity.map(|v| v * faster),
        width: 7.0 * scale,
        spread: 22.0 * faster,
        radii: DROPS,
        density,
        drops_per_second,
    };
    [
        nozzle([-360.0, -110.0], [285.0, -810.0], 1.0),
        nozzle([0.0, -345.0], [0.0, -640.0], 2.0),
        nozzle([360.0, -110.0], [-285.0, -810.0], 3.0),
    ]
}

pub fn emitters_view(n: usize) -> Area {
    let scale = scale(n);
    [-HALF_WIDTH * scale, -HEIGHT * scale, HALF_WIDTH * scale, 0.0]
}

/// The bowls, and behind them the first drops, oldest first.
pub fn emitters(n: usize, random: &mut Random) -> Start {
    let scale = scale(n);
    let mut particles = immovable(beads(scale), BEAD);
    particles.extend(&first_drops(n, random));
    let [min_x, min_y, max_x, max_y] = emitters_view(n);
    let settings = WorldSettings {
        gravity: [0.0, GRAVITY],
        restitution: 0.3,
        // Splashes may rise above what is shown.
        ..boxed([min_x, 2.0 * min_y, max_x, max_y])
    };
    Start::new(particles, settings)
}

fn beads(scale: f32) -> Vec<[f32; 2]> {
    let scaled = |line: &[[f32; 2]]| -> Vec<[f32; 2]> {
        line.iter().map(|corner| corner.map(|v| v * scale)).collect()
    };
    let mirrored =
        |line: &[[f32; 2]]| -> Vec<[f32; 2]> { line.iter().map(|&[x, y]| [-x, y]).collect() };
    let right: [&[[f32; 2]]; 5] = [&TOP, &MIDDLE, &POOL, &STEMS[0], &STEMS[1]];
    let both = right.into_iter().flat_map(|line| {
        let line = scaled(line);
        [mirrored(&line), line]
    });
    both.flat_map(|line| walls(&line, BEAD)).collect()
}

/// Those that would be on their way up had the nozzles been open a little while.
fn first_drops(n: usize, random: &mut Random) -> Particles {
    let nozzles = nozzles(n);
    let rate: f32 = nozzles.iter().map(|nozzle| nozzle.drops_per_second).sum();
    let count = ((FLOWN * scale(n).sqrt() * rate) as usize).min(n);
    let mut drops = Particles::default();
    for number in (0..count).rev() {
        let nozzle = &nozzles[number % nozzles.len()];
        drops.extend(&nozzle.drop((number as f32 + 1.0) / rate, random));
    }
    drops
}

impl Nozzle {
    /// A drop that came out `age` seconds ago.
    fn drop(&self, age: f32, random: &mut Random) -> Particles {
        let [u, v] = self.velocity;
        let across = random.between(-0.5, 0.5) * self.width / (u * u + v * v).sqrt();
        let [x, y] = [self.position[0] - v * across, self.position[1] + u * across];
        let aside = random.in_disc().map(|w| w * self.spread);
        let [u, v] = [u + aside[0], v + aside[1]];
        let place = [x + u * age, y + v * age + 0.5 * GRAVITY * age * age];
        let radius = random.between(self.radii[0], self.radii[1]);
        let velocity = [u, v + GRAVITY * age];
        Particles::new(vec![place], vec![velocity], vec![radius], self.density)
    }
}
