//! Scenes with motors: a piston, a mill and a conveyor.

use std::f64::consts::TAU;

use super::placing::{Area, immovable, lattice, lattice_where};
use super::random::Random;
use super::start::{Start, area_of, boxed, direction, side_for};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_world::container::Container;
use jostle_world::forces::{Influence, Motor, WallIds};
use jostle_world::particles::Particles;
use jostle_world::walls::Wall;
use jostle_world::world::WorldSettings;

const GRAVITY: f32 = 900.0;

/// A motor without particles, walls or motion.
pub(crate) const MOTOR: Motor = Motor {
    ids: Vec::new(),
    walls: WallIds(Vec::new()),
    pivot: [0.0; 2],
    angular_velocity: 0.0,
    velocity: [0.0; 2],
    cycle: f32::INFINITY,
};

const GAS_RADIUS: f32 = 3.0;
const GAS_COVERAGE: f32 = 0.2;
const GAS_SPEED: f32 = 200.0;

/// Length of the cylinder divided by its height, and the fraction by which the piston shortens it.
const CYLINDER: f32 = 1.6;
const STROKE: f32 = 0.5;

/// Seconds of the piston there and back.
const PISTON_CYCLE: f32 = 16.0;

/// Length and height of the cylinder.
fn cylinder(n: usize) -> [f32; 2] {
    let height = side_for(n as f32 * area_of(GAS_RADIUS), GAS_COVERAGE * CYLINDER, 100.0);
    [CYLINDER * height, height]
}

pub(crate) fn piston_view(n: usize) -> Area {
    let [length, height] = cylinder(n);
    // Space for the rod.
    [0.0, 0.0, (1.0 + STROKE) * length, height]
}

/// `n` discs of a gas in a cylinder with a piston.
pub(crate) fn piston(n: usize, random: &mut Random) -> Result<Start> {
    let [length, height] = cylinder(n);
    let inside = [GAS_RADIUS, GAS_RADIUS, length - GAS_RADIUS, height - GAS_RADIUS];
    let places = lattice(n, inside, 0.0, random)?;
    let velocities = memory::collect((0..n).map(|_| random.in_disc().map(|v| v * GAS_SPEED)))?;
    let gas = Particles::try_new(places, velocities, memory::filled(n, GAS_RADIUS)?, 1.0)?;
    let mut start = Start::new(gas, boxed(piston_view(n)));
    start.walls.push(Wall::new([[length, 0.0], [length, height]]));
    let middle = 0.5 * height;
    start.walls.push(Wall::new([[length, middle], [(1.0 + STROKE) * length, middle]]));
    // Half of the cycle in either direction: the stroke over half a cycle.
    let velocity = [-2.0 * STROKE * length / PISTON_CYCLE, 0.0];
    Ok(start.with(Influence::Motor(Motor {
        walls: WallIds(vec![0, 1]),
        velocity,
        cycle: PISTON_CYCLE,
        ..MOTOR
    })))
}

const GRAINS: [f32; 2] = [3.0, 4.0];
const MILL_COVERAGE: f32 = 0.35;
const ARMS: usize = 5;

/// Radius of the discs of a paddle, and the distance between them.
const PADDLE: f32 = 3.0;
const PADDLE_PITCH: f32 = 3.6;

/// Radius of the hub divided by that of the drum.
const HUB: f32 = 0.12;

/// Centrifugal acceleration at the rim divided by gravity.
const FROUDE: f32 = 0.25;

fn drum(n: usize) -> f32 {
    let grain = area_of(0.5 * (GRAINS[0] + GRAINS[1]));
    side_for(n as f32 * grain, MILL_COVERAGE, 160.0) / std::f32::consts::PI.sqrt()
}

pub(crate) fn mill_view(n: usize) -> Area {
    let radius = drum(n);
    [-radius, -radius, radius, radius]
}

/// Unit vectors of the arms.
fn arms() -> impl Iterator<Item = [f32; 2]> {
    (0..ARMS).map(|arm| direction(TAU * arm as f64 / ARMS as f64))
}

/// The discs of a wheel, then `n` grains in a drum.
pub(crate) fn mill(n: usize, random: &mut Random) -> Result<Start> {
    let radius = drum(n);
    // Grains fit between the tips of the arms and the drum.
    // Less than two grains fit between the tip and the drum, so none is squeezed between both.
    let (hub, tip) = (HUB * radius, radius - 3.0 * GRAINS[1] - PADDLE);
    let count = ((tip - hub) / PADDLE_PITCH) as usize + 1;
    let along = |k: usize| tip - k as f32 * PADDLE_PITCH;
    let paddles =
        arms().flat_map(|[x, y]| (0..count).map(move |k| [x * along(k), y * along(k)])).collect();
    let mut particles = immovable(vec![[0.0; 2]], hub)?;
    particles.try_extend(&immovable(paddles, PADDLE)?)?;
    let ids = (0..particles.len() as i64).collect();
    particles.try_extend(&grains(between_arms(n, radius, random)?, 10.0, random)?)?;
    particles.try_spins_mut()?.iter_mut().for_each(|spin| spin.friction = 0.5);
    let container = Container::Circle { center: [0.0; 2], radius };
    let gravity = [0.0, GRAVITY];
    let settings = WorldSettings { container, gravity, ..WorldSettings::default() };
    // From the Froude number ω² r / g, which decides the flow in a drum: at a quarter grains
    // tumble, at 1 they stay at the rim.
    let angular_velocity = (FROUDE * GRAVITY / radius).sqrt();
    Ok(Start::new(particles, settings).restitution(0.2).with(Influence::Motor(Motor {
        ids,
        angular_velocity,
        ..MOTOR
    })))
}

/// Positions of `n` grains in the drum that overlap neither it nor the wheel.
fn between_arms(n: usize, radius: f32, random: &mut Random) -> Result<Vec<[f32; 2]>> {
    let grain = GRAINS[1];
    let is_free = |&[x, y]: &[f32; 2]| {
        let distance = (x * x + y * y).sqrt();
        let off_arms = arms().all(|[u, v]| {
            let across = (x * v - y * u).abs();
            x * u + y * v < 0.0 || across > PADDLE + grain
        });
        distance < radius - grain && distance > HUB * radius + grain && off_arms
    };
    lattice_where(n, mill_view(n), 0.0, random, is_free)
}

/// Grains at some positions, with random velocities of up to `speed`.
fn grains(places: Vec<[f32; 2]>, speed: f32, random: &mut Random) -> Result<Particles> {
    let radii = places.iter().map(|_| random.between(GRAINS[0], GRAINS[1]));
    let radii = memory::collect(radii)?;
    let velocities = places.iter().map(|_| random.in_disc().map(|v| v * speed));
    let velocities = memory::collect(velocities)?;
    Particles::try_new(places, velocities, radii, 1.0)
}

const ROLLER: f32 = 6.0;

/// Distance between rollers: the gap is smaller than a grain.
const ROLLER_PITCH: f32 = 12.5;

/// Surface speed of the rollers.
const BELT_SPEED: f32 = 120.0;

/// Slopes of the row of rollers, up to the right, and of the chute below.
const CLIMB: f32 = 0.08;
const CHUTE: f32 = 0.06;

/// Width of the gaps at both ends of the rollers.
const GAP: f32 = 60.0;

/// Height of the first roller above the lowest point, small enough that grains there soon touch it.
const DEPTH: f32 = 26.0;

/// Length of the machine per grain.
const LENGTH_PER_GRAIN: f32 = 1.6;

/// Length of the machine, and its lowest and its highest y.
fn conveyor_size(n: usize) -> [f32; 3] {
    let length = (n as f32 * LENGTH_PER_GRAIN).max(240.0);
    [length, DEPTH, -CLIMB * length - 2.0 * GAP]
}

pub(crate) fn conveyor_view(n: usize) -> Area {
    let [length, lowest, highest] = conveyor_size(n);
    [0.0, highest, length, lowest]
}

/// `n` grains on rollers that carry them up to the right; a chute below leads them back.
pub(crate) fn conveyor(n: usize, random: &mut Random) -> Result<Start> {
    let area = conveyor_view(n);
    let [length, lowest, _] = conveyor_size(n);
    let count = ((length - 2.0 * GAP) / ROLLER_PITCH) as usize;
    let roller = |k: usize| [GAP + k as f32 * ROLLER_PITCH, -CLIMB * k as f32 * ROLLER_PITCH];
    let mut particles = immovable((0..count).map(roller).collect(), ROLLER)?;
    let turning = BELT_SPEED / ROLLER;
    particles.try_spins_mut()?.iter_mut().for_each(|spin| spin.velocity = turning);
    // The grains are in layers above the rollers.
    let pitch = 2.02 * GRAINS[1];
    let columns = (((length - 2.0 * GAP) / pitch) as usize).max(1);
    let place = |index: usize| {
        let x = GAP + (index % columns) as f32 * pitch;
        let layer = 1.0 + (index / columns) as f32;
        [x, -CLIMB * (x - GAP) - ROLLER - layer * pitch]
    };
    particles.try_extend(&grains(memory::collect((0..n).map(place))?, 10.0, random)?)?;
    particles.try_spins_mut()?.iter_mut().for_each(|spin| spin.friction = 0.8);
    let settings = WorldSettings { gravity: [0.0, GRAVITY], ..boxed(area) };
    let mut start = Start::new(particles, settings).restitution(0.1);
    let mut chute = Wall::new([[0.0, lowest], [length, lowest - CHUTE * length]]);
    chute.surface.friction = Some(0.0);
    start.walls.push(chute);
    Ok(start)
}
