//! Scene: a fountain of static discs with three jets. Pumps take drops out of the basin and let them start again.

use super::placing::{Area, immovable, lattice_where, walls};
use super::random::Random;
use super::start::{Start, boxed};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_world::forces::{Influence, Pump};
use jostle_world::particles::Particles;
use jostle_world::world::WorldSettings;

/// The default number of drops, for which the lengths below are given.
pub(crate) const DEFAULT_COUNT: usize = 3_000;

/// Drops of all jets per second when there is the default number of drops, at the start.
const FLOW: f32 = 273.0;

/// How often a drop in a drain is taken, per second: the drops in all drains times it are about [`FLOW`].
const RATE: f32 = 0.25;

const GRAVITY: f32 = 900.0;
const BEAD: f32 = 4.0;
const DROPS: [f32; 2] = [2.1, 3.1];

/// Mass of a drop divided by its radius squared, different for the drops that begin in each jet.
const DENSITIES: [f32; 3] = [1.0, 1.15, 1.3];

/// Seconds of flight of the first drops at the start.
const FLOWN: f32 = 1.2;

/// Distance of the drops in the basin at the start.
const CELL: f32 = 6.3;

/// Half width of the view, and its height above the floor at y = 0.
const HALF_WIDTH: f32 = 480.0;
const HEIGHT: f32 = 640.0;

/// Half of the width of the middle drain, and the height of all.
const MIDDLE_DRAIN: f32 = 160.0;
const DRAIN: f32 = 30.0;

/// Lines of the right half; the left half is its mirror image: two sloped tiers of steps, their
/// supports, and the rim of the basin.
const TOP: [[f32; 2]; 4] = [[0.0, -330.0], [50.0, -320.0], [50.0, -304.0], [95.0, -295.0]];
const MIDDLE: [[f32; 2]; 4] = [[0.0, -205.0], [120.0, -185.0], [120.0, -165.0], [225.0, -148.0]];
const COLUMN: [[f32; 2]; 2] = [[12.0, -318.0], [12.0, -211.0]];
const FOOT: [[f32; 2]; 2] = [[26.0, -192.0], [40.0, 0.0]];
const RIM: [[f32; 2]; 2] = [[425.0, 0.0], [445.0, -105.0]];

/// Factor of all lengths; the area is proportional to the number of drops.
fn scale(n: usize) -> f32 {
    (n as f32 / DEFAULT_COUNT as f32).sqrt().max(0.25)
}

/// Drops of all jets per second. They are proportional to the number of drops over the time of flight.
fn flow(n: usize) -> f32 {
    let scale = scale(n);
    FLOW * scale * scale / scale.sqrt()
}

/// The left jet, the one in the middle, and the right one.
fn pumps(n: usize) -> [Pump; 3] {
    let scale = scale(n);
    // Times of flight are proportional to the square root of the height.
    let faster = scale.sqrt();
    let pump = |position: [f32; 2], velocity: [f32; 2], [left, right]: [f32; 2], seed| Pump {
        drain: [left, -DRAIN, right, 0.0].map(|side| side * scale),
        position: position.map(|v| v * scale),
        velocity: velocity.map(|v| v * faster),
        rate: RATE / faster,
        width: 20.0 * scale,
        spread: 22.0 * faster,
        seed,
    };
    [
        pump([-380.0, -135.0], [282.0, -900.0], [-HALF_WIDTH, -MIDDLE_DRAIN], 0),
        pump([0.0, -345.0], [0.0, -590.0], [-MIDDLE_DRAIN, MIDDLE_DRAIN], 1),
        pump([380.0, -135.0], [-282.0, -900.0], [MIDDLE_DRAIN, HALF_WIDTH], 2),
    ]
}

pub(crate) fn view(n: usize) -> Area {
    let scale = scale(n);
    [-HALF_WIDTH * scale, -HEIGHT * scale, HALF_WIDTH * scale, 0.0]
}

/// Static discs of the fountain, then the drops: those of the jets, and those in the basin.
pub(crate) fn fountain(n: usize, random: &mut Random) -> Result<Start> {
    let scale = scale(n);
    let mut particles = immovable(beads(scale)?, BEAD)?;
    let flying = ((flow(n) * FLOWN * scale.sqrt()) as usize).min(n);
    for number in (0..flying).rev() {
        particles.try_extend(&flown(n, number, random)?)?;
    }
    particles.try_extend(&basin(n, n - flying, random)?)?;
    let [min_x, min_y, max_x, max_y] = view(n);
    let settings = WorldSettings {
        gravity: [0.0, GRAVITY],
        // Drops may rise above the view.
        ..boxed([min_x, 2.0 * min_y, max_x, max_y])
    };
    let start = Start::new(particles, settings).restitution(0.3);
    Ok(pumps(n).into_iter().fold(start, |start, pump| start.with(Influence::Pump(pump))))
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

/// One of the drops that have left a nozzle; that with the number 0 is the last one.
fn flown(n: usize, number: usize, random: &mut Random) -> Result<Particles> {
    let all = pumps(n);
    let jet = number % all.len();
    let Pump { position, velocity: [u, v], width, spread, .. } = all[jet];
    let age = (number as f32 + 1.0) / flow(n);
    let across = random.between(-0.5, 0.5) * width / (u * u + v * v).sqrt();
    let [x, y] = [position[0] - v * across, position[1] + u * across];
    let deviation = random.in_disc().map(|w| w * spread);
    let [u, v] = [u + deviation[0], v + deviation[1]];
    let place = [x + u * age, y + v * age + 0.5 * GRAVITY * age * age];
    drops(vec![place], vec![[u, v + GRAVITY * age]], jet, random)
}

/// Drops at rest between the rims, from the floor upwards.
fn basin(n: usize, count: usize, random: &mut Random) -> Result<Particles> {
    let scale = scale(n);
    let half_width = RIM[0][0] * scale - BEAD - DROPS[1];
    // The supports stand in it.
    let wide = 2.0 * (FOOT[1][0] - FOOT[0][0]) * scale + 4.0 * (BEAD + DROPS[1]);
    let height = (count as f32 * CELL * CELL / (2.0 * half_width - wide)).max(CELL);
    let [[top_x, top_y], [foot_x, _]] = FOOT.map(|corner| corner.map(|v| v * scale));
    let is_free = |&[x, y]: &[f32; 2]| {
        let support = foot_x + (top_x - foot_x) * (y / top_y).clamp(0.0, 1.0);
        (x.abs() - support).abs() > BEAD + DROPS[1]
    };
    let area = [-half_width, -height, half_width, 0.0];
    let places = lattice_where(count, area, 0.0, random, is_free)?;
    let mut all = Particles::default();
    for (number, place) in places.into_iter().enumerate() {
        all.try_extend(&drops(vec![place], vec![[0.0; 2]], number % DENSITIES.len(), random)?)?;
    }
    Ok(all)
}

/// Drops of random sizes, with the density of those of a jet.
fn drops(
    places: Vec<[f32; 2]>,
    velocities: Vec<[f32; 2]>,
    jet: usize,
    random: &mut Random,
) -> Result<Particles> {
    let radii = memory::collect(places.iter().map(|_| random.between(DROPS[0], DROPS[1])))?;
    Particles::try_new(places, velocities, radii, DENSITIES[jet])
}
