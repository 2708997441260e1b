//! Milliseconds of a step of one sub-step in which all bodies pull all others, summed
//! directly and by the tree, on one thread and on two, and how many steps of as many
//! sub-steps as worlds have by default pass in a second:
//! `cargo run --release --package jostle --example gravitation`.

use std::time::Instant;

use jostle_scenes::random::Random;
use jostle_world::forces::Gravitation;
use jostle_world::world::DEFAULT_SUBSTEPS;
use jostle_world::{Influence, Particles, World, WorldSettings};

const COUNTS: [usize; 6] = [256, 512, 1024, 2048, 10_000, 100_000];

/// With more bodies than this a direct sum takes seconds.
const MOST_DIRECT: usize = 10_000;

/// Seconds.
const STEP: f64 = 0.01;

fn main() {
    for count in COUNTS {
        for (theta, threads) in [(0.0, 2), (0.5, 1), (0.5, 2)] {
            if theta > 0.0 || count <= MOST_DIRECT {
                let ms = milliseconds(count, theta, threads, 1);
                println!("{count:7} bodies, theta {theta}, {threads} threads: {ms:9.3} ms");
            }
        }
    }
    let ms = milliseconds(100_000, 0.5, 2, DEFAULT_SUBSTEPS);
    println!("100,000 bodies, {DEFAULT_SUBSTEPS} sub-steps: {:.1} steps a second", 1e3 / ms);
}

fn milliseconds(count: usize, theta: f32, threads: usize, substeps: usize) -> f64 {
    let mut random = Random::new(1);
    let mut place = || [random.between(0.0, 100.0), random.between(0.0, 100.0)];
    let positions = (0..count).map(|_| place()).collect();
    let bodies = Particles::new(positions, vec![[0.0; 2]; count], vec![0.01; count], 1.0);
    let mut settings = WorldSettings { substeps: Some(substeps), ..WorldSettings::default() };
    settings.tree.threads = Some(threads);
    let mut world = World::new(bodies, settings).expect("the bodies are valid");
    let pull = Gravitation { g: 1e-4, softening: 0.1, theta };
    world.set_forces(vec![Influence::Gravitation(pull)]).expect("the force is valid");
    let mut run = |steps| world.step(STEP, steps).expect("the bodies move slowly");
    run(2);
    let steps = (200_000 / count).clamp(3, 200);
    let start = Instant::now();
    run(steps);
    start.elapsed().as_secs_f64() * 1e3 / steps as f64
}
