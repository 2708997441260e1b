//! Time of a step of 100,000 discs with events and with sensors over that without:
//! `cargo run --release --package jostle --example events`; arguments: DISCS STEPS.

use std::time::Instant;

use jostle_base::Settings;
use jostle_scenes::{STEP, find};
use jostle_world::{World, WorldSettings};

fn main() {
    let numbers: Vec<usize> =
        std::env::args().skip(1).filter_map(|text| text.parse().ok()).collect();
    let number = |index: usize, default| numbers.get(index).copied().unwrap_or(default);
    let (discs, steps) = (number(0, 100_000), number(1, 61).max(1));
    for threads in [1, 2] {
        for scene in ["gas", "pile"] {
            let mut worlds = [false, true, true].map(|events| world(scene, discs, threads, events));
            // One disc of a hundred.
            worlds[2]
                .edit(|all| {
                    all.sensors_mut().iter_mut().step_by(100).for_each(|sensor| *sensor = true);
                    Ok(())
                })
                .expect("valid");
            let mut times = [const { Vec::new() }; 3];
            // One after the other, so that all see the same changes of the machine's speed.
            for _ in 0..steps {
                for (world, times) in worlds.iter_mut().zip(&mut times) {
                    let start = Instant::now();
                    step(world);
                    times.push(start.elapsed().as_secs_f64() * 1e3);
                }
            }
            let [off, on, sensors] = times.map(|mut times| {
                times.sort_by(f64::total_cmp);
                times[steps / 2]
            });
            println!(
                "{scene} of {discs} discs, {threads} threads: {off:.2} ms a step, with events \
                 {:.3} times, 1 % sensors {:.3} times",
                on / off,
                sensors / off
            );
        }
    }
}

fn step(world: &mut World) {
    world.begin_record().unwrap();
    world.step(STEP, 1).expect("a step succeeds");
    world.end_record().expect("few pairs touch");
}

/// A scene after a second.
fn world(scene: &str, discs: usize, threads: usize, track_events: bool) -> World {
    let mut world = find(scene).expect("it exists").create(Some(discs), 0).expect("valid");
    let tree = Settings { threads: Some(threads), ..world.settings().tree };
    let settings = WorldSettings { track_events, tree, sleeping: false, ..*world.settings() };
    world.configure(settings).expect("valid");
    (0..60).for_each(|_| step(&mut world));
    world
}
