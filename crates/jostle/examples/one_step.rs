//! Milliseconds of each stage of a step: `cargo run --release --package jostle --example one_step
//! -- gas 10000 60 31`.
//!
//! The arguments are a scene, the number of particles, the number of steps before timing, and the
//! number of timed steps. Nothing falls asleep. `benchmarks/stages.py` runs this program under
//! valgrind's callgrind and counts instructions, which do not depend on the load of the machine.

use std::time::Instant;

use jostle_scenes::{self as scenes, STEP};
use jostle_world::{Stage, World};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, numbers @ ..] = arguments.as_slice() else {
        return println!("arguments: SCENE PARTICLES WARM_UP STEPS THREADS");
    };
    let number = |index: usize, default| {
        numbers.get(index).and_then(|text| text.parse().ok()).unwrap_or(default)
    };
    let (count, warm_up, steps) = (number(0, 10_000), number(1, 60), number(2, 31).max(1));
    let scene = match scenes::find(scene) {
        Ok(scene) => scene,
        Err(error) => return println!("{error}"),
    };
    let mut world = scene.create(Some(count), 0).expect("a scene is valid");
    let mut settings = *world.settings();
    settings.tree.threads = Some(number(3, 1));
    settings.sleeping = false;
    world.configure(settings).expect("the settings are valid");
    world.step(STEP, warm_up).expect("a scene can be stepped");
    let mut times: [Vec<f64>; Stage::ALL.len()] = Default::default();
    for _ in 0..steps {
        timed_step(&mut world, &mut times);
    }
    for ((_, name), times) in Stage::ALL.iter().zip(&mut times) {
        times.sort_by(f64::total_cmp);
        println!("{name:10} {:9.3} ms", times[steps / 2]);
    }
}

/// One step, with the time of each stage added to its list.
#[inline(never)]
fn timed_step(world: &mut World, times: &mut [Vec<f64>]) {
    let mut last = Instant::now();
    let mut sums = [0.0; Stage::ALL.len()];
    let mut watch = |stage: Stage, _: &World| {
        let now = Instant::now();
        sums[stage as usize] += (now - last).as_secs_f64() * 1e3;
        last = now;
    };
    world.step_watched(STEP, 1, &mut watch).expect("a scene can be stepped");
    times.iter_mut().zip(sums).for_each(|(times, sum)| times.push(sum));
}
