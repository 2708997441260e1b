//! A fountain: steps and a basin of beads, and the nozzles that fill them.
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
const DROPS: [f32; 2] = [2.1, 3.1];

/// Seconds of their flight that the jets have behind them at the start.
const FLOWN: f32 = 0.6;

/// The view: half its width, and its height above the floor at y = 0.
const HALF_WIDTH: f32 = 480.0;
const HEIGHT: f32 = 640.0;

/// Lines on the right of the middle, the same on the left: two tiers of steps, from which
/// all water runs off, what carries them, and the rim of the basin.
const TOP: [[f32; 2]; 4] = [[0.0, -330.0], [50.0, -320.0], [50.0, -304.0], [95.0, -295.0]];
const MIDDLE: [[f32; 2]; 4] = [[0.0, -205.0], [120.0, -185.0], [120.0, -165.0], [225.0, -148.0]];
const COLUMN: [[f32; 2]; 2] = [[12.0, -318.0], [12.0, -211.0]];
const FOOT: [[f32; 2]; 2] = [[26.0, -192.0], [40.0, 0.0]];
const RIM: [[f32; 2]; 2] = [[425.0, 0.0], [445.0, -105.0]];

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
        nozzle([-380.0, -135.0], [282.0, -900.0], 1.0),
        nozzle([0.0, -342.0], [0.0, -590.0], 1.15),
        nozzle([380.0, -135.0], [-282.0, -900.0], 1.3),
    ]
}

pub fn emitters_view(n: usize) -> Area {
    let scale = scale(n);
    [-HALF_WIDTH * scale, -HEIGHT * scale, HALF_WIDTH * scale, 0.0]
}

/// Steps and basin, and behind them the first drops, oldest first.
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
    let right: [&[[f32; 2]]; 5] = [&TOP, &MIDDLE, &COLUMN, &FOOT, &RIM];
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
