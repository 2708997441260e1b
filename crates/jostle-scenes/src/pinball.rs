//! Scene: a pinball table whose flippers are driven by motors.

use super::machines::MOTOR;
use super::placing::{Area, immovable, lattice};
use super::random::Random;
use super::start::{Start, boxed, direction};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_world::forces::{Influence, Motor, WallIds};
use jostle_world::particles::Particles;
use jostle_world::walls::Wall;
use jostle_world::world::WorldSettings;
use jostle_world::{Sides, Surface};

/// Width and height of a table for this number of balls; tables for more balls are larger.
const TABLE: [f32; 2] = [300.0, 500.0];
const BALLS: f32 = 12.0;
const BALL: f32 = 7.0;

/// Coefficient of restitution of a ball and something elastic.
const BOUNCE: f32 = 0.9;

/// Positions and radii of the bumpers, in widths of the table.
const BUMPERS: [([f32; 2], f32); 7] = [
    ([0.30, 0.52], 0.075),
    ([0.70, 0.52], 0.075),
    ([0.50, 0.78], 0.075),
    ([0.50, 0.34], 0.045),
    ([0.13, 0.80], 0.03),
    ([0.87, 0.80], 0.03),
    ([0.50, 1.08], 0.03),
];

/// The left half of the outline of the table, in widths of the table: the rounded top, and the
/// guide above the flipper.
const TOP: [[f32; 2]; 5] = [[0.0, 0.3], [0.03, 0.17], [0.1, 0.07], [0.2, 0.015], [0.3, 0.0]];
const GUIDE: [[f32; 2]; 3] = [[0.0, 1.15], [PIVOT[0], PIVOT[1]], [PIVOT[0], TABLE[1] / TABLE[0]]];

/// A triangle above the left flipper.
const SLINGSHOT: [[f32; 2]; 4] = [[0.15, 0.98], [0.15, 1.12], [0.27, 1.21], [0.15, 0.98]];

/// The left flipper, in widths of the table: its pivot, its length, and its radii at both ends.
const PIVOT: [f32; 2] = [0.28, 1.36];
const FLIPPER: f32 = 0.155;
const FLIPPER_RADII: [f32; 2] = [0.024, 0.012];

/// Number of discs of a flipper, its initial angle below the horizontal, and its angle of rotation.
const FLIPPER_DISCS: usize = 12;
const REST_ANGLE: f64 = 0.45;
const SWING: f32 = 0.9;

/// Cycles in seconds of the flippers, and of the floor between them, which pushes balls back.
const FLIPPER_CYCLE: f32 = 0.5;
const FLOOR_CYCLE: f32 = 0.2;
const FLOOR_SPEED: f32 = 700.0;

/// Factor of all lengths.
fn scale(n: usize) -> f32 {
    (n as f32 / BALLS).sqrt().max(1.0)
}

fn width(n: usize) -> f32 {
    scale(n) * TABLE[0]
}

pub(crate) fn pinball_view(n: usize) -> Area {
    [0.0, 0.0, width(n), scale(n) * TABLE[1]]
}

/// Bumpers and flippers, then `n` balls.
pub(crate) fn pinball(n: usize, random: &mut Random) -> Result<Start> {
    let width = width(n);
    let mut particles = Particles::default();
    for (place, radius) in BUMPERS {
        particles.try_extend(&immovable(vec![place.map(|v| v * width)], radius * width)?)?;
    }
    let mut flipper = |is_right| flipper(is_right, width, &mut particles);
    let flippers = [flipper(false)?, flipper(true)?];
    let [u, v] = [0.15 * width, 0.1 * width];
    let places = lattice(n, [u, v, width - u, 0.42 * width], 0.0, random)?;
    let velocities = memory::collect((0..n).map(|_| random.in_disc().map(|v| v * 300.0)))?;
    let mut balls = Particles::try_new(places, velocities, memory::filled(n, BALL)?, 1.0)?;
    balls.restitution.fill(BOUNCE * BOUNCE);
    particles.try_extend(&balls)?;
    // Balls bounce with 0.9 off bumpers, flippers, the floor and the sides, which are elastic.
    let elastic = Surface { restitution: Some(1.0), friction: None };
    let settings = WorldSettings {
        gravity: [0.0, 500.0],
        drag: 0.05,
        sides: Sides([elastic; 4]),
        ..boxed(pinball_view(n))
    };
    let mut start = Start::new(particles, settings);
    for is_right in [false, true] {
        let side = |line: &[[f32; 2]]| -> Vec<[f32; 2]> {
            line.iter().map(|&at| mirrored(at, is_right).map(|v| v * width)).collect()
        };
        start = start.walled(&side(&TOP)).walled(&side(&GUIDE)).walled(&side(&SLINGSHOT));
    }
    start.walls.iter_mut().for_each(|wall| wall.surface.restitution = Some(0.49));
    let floor = start.walls.len() as i64;
    // Slightly shorter than the distance between the guides, so that it touches neither.
    let (y, inset) = (0.96 * scale(n) * TABLE[1], 0.3 * BALL);
    let ends = [PIVOT[0] * width + inset, (1.0 - PIVOT[0]) * width - inset];
    start.walls.push(Wall { surface: elastic, ..Wall::new(ends.map(|x| [x, y])) });
    start.forces.extend(flippers.map(Influence::Motor));
    Ok(start.with(Influence::Motor(Motor {
        walls: WallIds(vec![floor]),
        velocity: [0.0, -FLOOR_SPEED],
        cycle: FLOOR_CYCLE,
        ..MOTOR
    })))
}

/// The mirror image of a point on the right half, if `is_right`.
fn mirrored([x, y]: [f32; 2], is_right: bool) -> [f32; 2] {
    if is_right { [1.0 - x, y] } else { [x, y] }
}

/// Adds the discs of a flipper, and returns its motor.
fn flipper(is_right: bool, width: f32, particles: &mut Particles) -> Result<Motor> {
    let first = particles.len() as i64;
    let along = direction(REST_ANGLE);
    for k in 0..FLIPPER_DISCS {
        // A tapered row of discs, since a motor turns discs. They overlap, so no ball gets between
        // them.
        let share = k as f32 / (FLIPPER_DISCS - 1) as f32;
        let place = [0, 1].map(|axis| PIVOT[axis] + share * FLIPPER * along[axis]);
        let radius = FLIPPER_RADII[0] + share * (FLIPPER_RADII[1] - FLIPPER_RADII[0]);
        let place = mirrored(place, is_right).map(|v| v * width);
        particles.try_extend(&immovable(vec![place], radius * width)?)?;
    }
    let upwards = if is_right { SWING } else { -SWING };
    Ok(Motor {
        ids: (first..particles.len() as i64).collect(),
        pivot: mirrored(PIVOT, is_right).map(|v| v * width),
        angular_velocity: 2.0 * upwards / FLIPPER_CYCLE,
        cycle: FLIPPER_CYCLE,
        ..MOTOR
    })
}
