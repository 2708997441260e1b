//! Scene: a fountain of static discs with three emitters of drops.
//!
//! A world does not emit particles. The caller of `step` adds new drops and removes the oldest;
//! this module has the data of the emitters.

use super::placing::{Area, immovable, walls};
use super::random::Random;
use super::scene::checked;
use super::start::{Start, boxed};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_world::particles::Particles;
use jostle_world::world::WorldSettings;

/// The default maximum number of drops, for which the lengths below are given.
pub(crate) const DEFAULT_COUNT: usize = 3_000;

/// Lifetime of a drop in seconds when there is the maximum number of drops.
const LIFE: f32 = 11.0;

const GRAVITY: f32 = 900.0;
const BEAD: f32 = 4.0;
const DROPS: [f32; 2] = [2.1, 3.1];

/// Seconds of flight of the first drops at the start.
const FLOWN: f32 = 0.6;

/// Half width of the view, and its height above the floor at y = 0.
const HALF_WIDTH: f32 = 480.0;
const HEIGHT: f32 = 640.0;

/// Lines of the right half; the left half is its mirror image: two sloped tiers of steps, their
/// supports, and the rim of the basin.
const TOP: [[f32; 2]; 4] = [[0.0, -330.0], [50.0, -320.0], [50.0, -304.0], [95.0, -295.0]];
const MIDDLE: [[f32; 2]; 4] = [[0.0, -205.0], [120.0, -185.0], [120.0, -165.0], [225.0, -148.0]];
const COLUMN: [[f32; 2]; 2] = [[12.0, -318.0], [12.0, -211.0]];
const FOOT: [[f32; 2]; 2] = [[26.0, -192.0], [40.0, 0.0]];
const RIM: [[f32; 2]; 2] = [[425.0, 0.0], [445.0, -105.0]];

/// A source of drops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emitter {
    /// Centre of the emitted drops.
    pub position: [f32; 2],
    /// Mean velocity of the emitted drops, px/s.
    pub velocity: [f32; 2],
    /// Drops are emitted on a line of this length, perpendicular to the velocity.
    pub width: f32,
    /// Maximum random deviation of the velocity, in any direction, px/s.
    pub spread: f32,
    /// Smallest and largest radius.
    pub radii: [f32; 2],
    /// Mass divided by the radius squared, different for each emitter.
    pub density: f32,
    /// Emitted drops per second.
    pub drops_per_second: f32,
}

/// The emitters of the scene `emitters` with at most `n` drops (`None`: the default number).
pub fn emitters(n: Option<usize>) -> Result<Vec<Emitter>> {
    Ok(all(checked(n.unwrap_or(DEFAULT_COUNT))?).to_vec())
}

/// Factor of all lengths; the area is proportional to the number of drops.
fn scale(n: usize) -> f32 {
    (n as f32 / DEFAULT_COUNT as f32).sqrt().max(0.25)
}

fn all(n: usize) -> [Emitter; 3] {
    let scale = scale(n);
    // Times of flight are proportional to the square root of the height.
    let faster = scale.sqrt();
    // In equilibrium each of the three adds a third of the drops in one lifetime.
    let drops_per_second = n as f32 / (3.0 * LIFE * faster);
    let emitter = |position: [f32; 2], velocity: [f32; 2], density| Emitter {
        position: position.map(|v| v * scale),
        velocity: velocity.map(|v| v * faster),
        width: 7.0 * scale,
        spread: 22.0 * faster,
        radii: DROPS,
        density,
        drops_per_second,
    };
    [
        emitter([-380.0, -135.0], [282.0, -900.0], 1.0),
        emitter([0.0, -342.0], [0.0, -590.0], 1.15),
        emitter([380.0, -135.0], [-282.0, -900.0], 1.3),
    ]
}

pub(crate) fn view(n: usize) -> Area {
    let scale = scale(n);
    [-HALF_WIDTH * scale, -HEIGHT * scale, HALF_WIDTH * scale, 0.0]
}

/// Static discs of the fountain, then the first drops, oldest first.
pub(crate) fn fountain(n: usize, random: &mut Random) -> Result<Start> {
    let scale = scale(n);
    let mut particles = immovable(beads(scale)?, BEAD)?;
    particles.try_extend(&first_drops(n, random)?)?;
    let [min_x, min_y, max_x, max_y] = view(n);
    let settings = WorldSettings {
        gravity: [0.0, GRAVITY],
        // Drops may rise above the view.
        ..boxed([min_x, 2.0 * min_y, max_x, max_y])
    };
    Ok(Start::new(particles, settings).restitution(0.3))
}

fn beads(scale: f32) -> Result<Vec<[f32; 2]>> {
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
    let mut all = Vec::new();
    for line in both {
        memory::append(&mut all, &walls(&line, BEAD)?)?;
    }
    Ok(all)
}

/// The drops that were emitted in the last [`FLOWN`] seconds.
fn first_drops(n: usize, random: &mut Random) -> Result<Particles> {
    let emitters = all(n);
    let rate: f32 = emitters.iter().map(|emitter| emitter.drops_per_second).sum();
    let count = ((FLOWN * scale(n).sqrt() * rate) as usize).min(n);
    let mut drops = Particles::default();
    for number in (0..count).rev() {
        let emitter = &emitters[number % emitters.len()];
        drops.try_extend(&emitter.drop((number as f32 + 1.0) / rate, random))?;
    }
    Ok(drops)
}

impl Emitter {
    /// A drop that was emitted `age` seconds ago.
    fn drop(&self, age: f32, random: &mut Random) -> Particles {
        let [u, v] = self.velocity;
        let across = random.between(-0.5, 0.5) * self.width / (u * u + v * v).sqrt();
        let [x, y] = [self.position[0] - v * across, self.position[1] + u * across];
        let deviation = random.in_disc().map(|w| w * self.spread);
        let [u, v] = [u + deviation[0], v + deviation[1]];
        let place = [x + u * age, y + v * age + 0.5 * GRAVITY * age * age];
        let radius = random.between(self.radii[0], self.radii[1]);
        let velocity = [u, v + GRAVITY * age];
        Particles::new(vec![place], vec![velocity], vec![radius], self.density)
    }
}
