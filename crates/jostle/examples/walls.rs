//! Time of a step of 100,000 discs among 10,000 walls over that of the discs alone, and of its stages:
//! `cargo run --release --package jostle --example walls`; arguments: DISCS WALLS STEPS.

use std::time::Instant;

use jostle::scenes::random::Random;
use jostle::{Container, Particles, Stage, Wall, World, WorldSettings};

const STEP: f64 = 1.0 / 60.0;

fn main() {
    let numbers: Vec<usize> =
        std::env::args().skip(1).filter_map(|text| text.parse().ok()).collect();
    let number = |index: usize, default| numbers.get(index).copied().unwrap_or(default);
    let (discs, walls, steps) = (number(0, 100_000), number(1, 10_000), number(2, 31).max(1));
    for (name, gravity, restitution) in [("gas", 0.0, 1.0), ("falling", -9.8, 0.5)] {
        let settings = WorldSettings {
            gravity: [0.0, gravity],
            restitution,
            sleeping: false,
            ..WorldSettings::default()
        };
        let mut both = [0, walls].map(|walls| crowd(discs, walls, settings));
        for world in &mut both {
            step(world, 30);
        }
        let mut times = [Vec::new(), Vec::new()];
        let mut stages = [[0.0; Stage::ALL.len()]; 2];
        // One after the other, so that both see the same changes of the machine's speed.
        for _ in 0..steps {
            for (k, world) in both.iter_mut().enumerate() {
                let start = Instant::now();
                let new = step(world, 1);
                times[k].push(start.elapsed().as_secs_f64() * 1e3);
                stages[k].iter_mut().zip(new).for_each(|(sum, time)| *sum += time / steps as f64);
            }
        }
        let [alone, among] = times.map(|mut times| {
            times.sort_by(f64::total_cmp);
            times[steps / 2]
        });
        println!(
            "{name:8} {discs} discs: {alone:7.2} ms, among {walls} walls: {among:7.2} ms, \
             ratio {:.2}",
            among / alone
        );
        // Walls make discs collide more often, which no implementation can avoid.
        let [alone, among] = both.each_mut().map(|world| {
            world.begin_record();
            step(world, 1);
            world.collisions()
        });
        println!(
            "    collisions a step: {} of pairs, among walls {} of pairs and {} with walls",
            alone.pairs, among.pairs, among.walls
        );
        for (at, (_, name)) in Stage::ALL.iter().enumerate() {
            println!("    {name:10} {:7.2} ms, {:7.2} ms", stages[0][at], stages[1][at]);
        }
    }
}

/// Makes some steps; returns the milliseconds of each stage.
fn step(world: &mut World, steps: usize) -> [f64; Stage::ALL.len()] {
    let (mut times, mut last) = ([0.0; Stage::ALL.len()], Instant::now());
    let note = &mut |stage: Stage| {
        let at = Stage::ALL.iter().position(|(of, _)| *of == stage).expect("it is listed");
        times[at] += last.elapsed().as_secs_f64() * 1e3;
        last = Instant::now();
    };
    world.step_watched(STEP, steps, note).expect("a step succeeds");
    times
}

/// Discs of radius 1 that cover 30 % of a box, and walls of length 6 at random places.
fn crowd(discs: usize, walls: usize, settings: WorldSettings) -> World {
    let mut random = Random::new(1);
    let columns = (discs as f64).sqrt().ceil() as usize;
    let spacing = (std::f32::consts::PI / 0.3).sqrt();
    let side = columns as f32 * spacing;
    let center = |row: usize| [row % columns, row / columns].map(|k| (k as f32 + 0.5) * spacing);
    let velocities =
        (0..discs).map(|_| [random.between(-20.0, 20.0), random.between(-20.0, 20.0)]).collect();
    let positions = (0..discs).map(center).collect();
    let all = Particles::new(positions, velocities, vec![1.0; discs], 1.0);
    let container = Container::Box { min: [0.0; 2], max: [side; 2] };
    let mut world =
        World::new(all, WorldSettings { container, ..settings }).expect("the world is valid");
    let walls = (0..walls).map(|_| {
        let [x, y] = [random.between(0.0, side), random.between(0.0, side)];
        let angle = random.between(0.0, std::f32::consts::TAU);
        Wall::new([[x, y], [x + 6.0 * angle.cos(), y + 6.0 * angle.sin()]])
    });
    world.set_walls(walls.collect()).expect("the walls are valid");
    world
}
