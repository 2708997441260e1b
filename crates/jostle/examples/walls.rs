//! Time of a step of 100,000 discs among 10,000 walls over that of the discs alone:
//! `cargo run --release --package jostle --example walls`; arguments: DISCS WALLS STEPS.

use std::time::Instant;

use jostle::scenes::random::Random;
use jostle::{Container, Particles, Wall, World, WorldSettings};

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
        both.iter_mut().for_each(|world| step(world, 30));
        let mut times = [Vec::new(), Vec::new()];
        // One after the other, so that both see the same changes of the machine's speed.
        for _ in 0..steps {
            for (world, times) in both.iter_mut().zip(&mut times) {
                let start = Instant::now();
                step(world, 1);
                times.push(start.elapsed().as_secs_f64() * 1e3);
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
    }
}

fn step(world: &mut World, steps: usize) {
    world.step(STEP, steps, &mut |_| ()).expect("a step succeeds");
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
