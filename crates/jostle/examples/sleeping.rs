//! What sleeping discs cost: `cargo run --release --package jostle --example sleeping -- 1000000`.
//!
//! Discs lie on a floor in groups of three, or in 20 rows, all in one island. They fall asleep,
//! then steps are timed: with nothing awake, with 100 discs that fall far above, and while one of
//! these wakes sleeping ones. The argument is the number of discs.

use std::time::Instant;

use jostle_base::Settings;
use jostle_scenes::STEP;
use jostle_world::{Container, Particles, World, WorldSettings};

/// Rows of discs that lie on each other.
const ROWS: usize = 20;

/// Discs in the lowest row of a group.
const BASE: usize = 2;

fn main() {
    let count = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(1_000_000);
    for (name, world) in [("in groups of three", pyramids(count)), ("in one island", packed(count))]
    {
        println!("{count} discs, {name}");
        measure(world, count);
    }
}

/// Discs in pyramids, each an island.
fn pyramids(count: usize) -> World {
    let of_each = BASE * (BASE + 1) / 2;
    let width = 2.0 * BASE as f32 + 2.0;
    let center = |at: usize| {
        let (pyramid, mut rest) = (at / of_each, at % of_each);
        let mut row = 0;
        while rest >= BASE - row {
            (row, rest) = (row + 1, rest - (BASE - row));
        }
        let x = width * pyramid as f32 + (2 * rest + row) as f32 + 2.0;
        [x, 1.0 + row as f32 * 3.0f32.sqrt()]
    };
    world((0..count).map(center).collect(), width * count.div_ceil(of_each) as f32)
}

/// Discs in a hexagonal packing.
fn packed(count: usize) -> World {
    let columns = count.div_ceil(ROWS);
    let center = |at: usize| {
        let (column, row) = ((at % columns) as f32, at / columns);
        [2.0 * column + (row % 2) as f32 + 1.0, 1.0 + row as f32 * 3.0f32.sqrt()]
    };
    world((0..count).map(center).collect(), 2.0 * columns as f32 + 1.0)
}

fn world(mut centers: Vec<[f32; 2]>, width: f32) -> World {
    // Float32 is finest around 0.
    centers.iter_mut().for_each(|center| center[0] -= 0.5 * width);
    let len = centers.len();
    let mut all = Particles::new(centers, vec![[0.0; 2]; len], vec![1.0; len], 1.0);
    all.spins_mut().iter_mut().for_each(|spin| spin.friction = 0.5);
    all.restitution.fill(0.3);
    let settings = WorldSettings {
        gravity: [0.0, -9.8],
        container: Container::Box { min: [-0.5 * width, 0.0], max: [0.5 * width, 1e5] },
        tree: Settings { threads: Some(1), ..Settings::default() },
        ..WorldSettings::default()
    };
    World::new(all, settings).expect("valid")
}

fn measure(mut world: World, count: usize) {
    let asleep =
        |world: &World| world.bodies().asleep().unwrap().iter().filter(|&&asleep| asleep).count();
    let seconds = time(&mut world, 1);
    println!("  awake: {:9.1} ns a disc and step", per_disc(seconds, count));
    let mut steps = 1;
    while asleep(&world) < count && steps < 240 {
        time(&mut world, 15);
        steps += 15;
    }
    println!("  {} asleep after {steps} steps; {}", asleep(&world), resident());
    let seconds = time(&mut world, 1000) / 1000.0;
    println!("  nothing awake: {:9.4} ns a sleeping disc and step", per_disc(seconds, count));
    let x = |at: usize| 3.0 * at as f32;
    let falling = (0..100).map(|at| [x(at), 9e4]).collect();
    let mut falling = Particles::new(falling, vec![[0.0; 2]; 100], vec![1.0; 100], 1.0);
    falling.restitution.fill(0.3);
    let rows = world.add(falling).expect("valid");
    let seconds = time(&mut world, 200) / 200.0;
    println!(
        "  100 awake: {:9.4} ns a sleeping disc and step, {:.3} ms a step",
        per_disc(seconds, count),
        seconds * 1e3,
    );
    let bytes = world.snapshot().unwrap().len();
    let restored = World::restore(&world.snapshot().unwrap()).expect("its own snapshot");
    println!("  {:.0} bytes a disc in a snapshot", bytes as f64 / count as f64);
    drop(world);
    let mut world = restored;
    println!("  restored: {}", resident());
    let row = rows.start as usize;
    let lower = |all: &mut Particles| {
        all.positions[row] = [1e3 + 0.3, 60.0];
        all.velocities[row] = [0.0, -90.0];
        Ok(())
    };
    let start = Instant::now();
    world.edit(lower).expect("valid");
    println!("  one edit: {:.1} ms", start.elapsed().as_secs_f64() * 1e3);
    let before = asleep(&world);
    let mut longest = 0.0f64;
    for _ in 0..60 {
        longest = longest.max(time(&mut world, 1));
        if asleep(&world) < before {
            break;
        }
    }
    let woken = before - asleep(&world);
    println!("  {woken} woken: longest step {:.3} ms", longest * 1e3);
}

fn per_disc(seconds: f64, count: usize) -> f64 {
    seconds * 1e9 / count as f64
}

/// Seconds that some steps take.
fn time(world: &mut World, steps: usize) -> f64 {
    let start = Instant::now();
    world.step(STEP, steps).expect("a step succeeds");
    start.elapsed().as_secs_f64()
}

/// Memory of this program, where the system tells it.
fn resident() -> String {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmRSS"));
    line.map_or_else(|| "memory unknown".into(), |line| line.replace('\t', " "))
}
