//! Time of a step of 100,000 discs among 10,000 walls over that of the discs alone, and of its stages:
//! `cargo run --release --package jostle --example walls`; arguments: DISCS WALLS STEPS THREADS KIND LAYOUT.
//! KIND is `gas`, `falling` or `both`; LAYOUT is `random` or `polygons`.
//!
//! Valgrind's callgrind counts instructions, which do not depend on the load of the machine:
//! `valgrind --tool=callgrind "--toggle-collect=*among_walls*" target/local/examples/walls 3000 300 3 1 gas`,
//! and `*step_alone*`.

use std::hint::black_box;
use std::time::Instant;

use jostle_scenes::random::Random;
use jostle_world::{Container, Particles, Stage, Wall, World, WorldSettings};

const STEP: f64 = 1.0 / 60.0;

/// Distance of neighbouring places of the lattice of discs.
const SPACING: f32 = 2.1;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |index: usize, default| {
        arguments.get(index).and_then(|text| text.parse().ok()).unwrap_or(default)
    };
    let (discs, walls, steps) = (number(0, 100_000), number(1, 10_000), number(2, 31).max(1));
    let kinds = [("gas", 0.0, 1.0), ("falling", -9.8, 0.5)];
    let is_wanted = |name: &str| arguments.get(4).is_none_or(|kind| kind == name || kind == "both");
    let layout =
        if arguments.get(5).is_some_and(|name| name == "polygons") { polygons } else { scattered };
    for (name, gravity, restitution) in kinds.into_iter().filter(|kind| is_wanted(kind.0)) {
        let mut settings =
            WorldSettings { gravity: [0.0, gravity], sleeping: false, ..WorldSettings::default() };
        settings.tree.threads = arguments.get(3).and_then(|text| text.parse().ok());
        let mut both =
            [0, walls].map(|shown| crowd((discs, restitution), (layout, walls), shown, settings));
        for world in &mut both {
            step(world, 30);
        }
        let mut times = [Vec::new(), Vec::new()];
        let mut stages = [[0.0; Stage::ALL.len()]; 2];
        // One after the other, so that both see the same changes of the machine's speed.
        for _ in 0..steps {
            for (k, world) in both.iter_mut().enumerate() {
                let start = Instant::now();
                let new = if k == 0 { step_alone(world) } else { step_among_walls(world) };
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
            world.begin_record().unwrap();
            step(world, 1);
            world.record().totals().collisions
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

/// Functions of their own, so that callgrind can count each. The compiler would merge equal ones.
#[inline(never)]
fn step_alone(world: &mut World) -> [f64; Stage::ALL.len()] {
    black_box("alone");
    step(world, 1)
}

#[inline(never)]
fn step_among_walls(world: &mut World) -> [f64; Stage::ALL.len()] {
    black_box("among walls");
    step(world, 1)
}

/// Makes some steps; returns the milliseconds of each stage.
fn step(world: &mut World, steps: usize) -> [f64; Stage::ALL.len()] {
    let (mut times, mut last) = ([0.0; Stage::ALL.len()], Instant::now());
    let note = &mut |stage: Stage, _: &World| {
        let at = Stage::ALL.iter().position(|(of, _)| *of == stage).expect("it is listed");
        times[at] += last.elapsed().as_secs_f64() * 1e3;
        last = Instant::now();
    };
    world.step_watched(STEP, steps, note).expect("a step succeeds");
    times
}

/// Discs of radius 1 that cover 30 % of a box, and walls. The discs are on a lattice, at random places
/// that overlap no wall: one that began between crossing walls would bounce there very often. Without
/// walls (`shown` is 0) there are the same discs.
fn crowd(
    (discs, restitution): (usize, f32),
    (layout, walls): (Layout, usize),
    shown: usize,
    settings: WorldSettings,
) -> World {
    let mut random = Random::new(1);
    let side = (discs as f32 * std::f32::consts::PI / 0.3).sqrt();
    let lines = layout(walls, side, &mut random);
    let positions = free_places(&lines, discs, side, &mut random);
    let velocities =
        positions.iter().map(|_| [random.between(-20.0, 20.0), random.between(-20.0, 20.0)]);
    let mut all = Particles::new(positions.clone(), velocities.collect(), vec![1.0; discs], 1.0);
    all.restitution.fill(restitution);
    let container = Container::Box { min: [0.0; 2], max: [side; 2] };
    let mut world =
        World::new(all, WorldSettings { container, ..settings }).expect("the world is valid");
    world.set_walls(lines[..shown].to_vec()).expect("the walls are valid");
    world
}

/// Makes a number of walls in a box with this side.
type Layout = fn(usize, f32, &mut Random) -> Vec<Wall>;

/// Walls of length 6 at random places, many of which cross.
fn scattered(count: usize, side: f32, random: &mut Random) -> Vec<Wall> {
    let wall = |_| {
        let [x, y] = [random.between(0.0, side), random.between(0.0, side)];
        let angle = random.between(0.0, std::f32::consts::TAU);
        Wall::new([[x, y], [x + 6.0 * angle.cos(), y + 6.0 * angle.sin()]])
    };
    (0..count).map(wall).collect()
}

/// Closed polygons of [`SIDES`] walls on a lattice, as in the level of a game.
fn polygons(count: usize, side: f32, random: &mut Random) -> Vec<Wall> {
    const SIDES: usize = 100;
    let columns = count.div_ceil(SIDES).isqrt().max(1);
    let spacing = side / columns as f32;
    let mut walls = Vec::new();
    for index in 0..count.div_ceil(SIDES) {
        let [x, y] = [index % columns, index / columns].map(|k| (k as f32 + 0.5) * spacing);
        let turn = random.between(0.0, std::f32::consts::TAU);
        let corner = |at: usize| {
            let angle = at as f32 / SIDES as f32 * std::f32::consts::TAU;
            let radius = spacing * (0.35 + 0.08 * (3.0 * angle + turn).sin());
            [x + radius * angle.cos(), y + radius * angle.sin()]
        };
        walls.extend((0..SIDES).map(|at| Wall::new([at, (at + 1) % SIDES].map(corner))));
    }
    walls.truncate(count);
    walls
}

/// Random places of a lattice for discs of radius 1 that overlap no wall.
fn free_places(walls: &[Wall], count: usize, side: f32, random: &mut Random) -> Vec<[f32; 2]> {
    let columns = ((side - 2.0) / SPACING) as usize;
    let mut is_free = vec![true; columns * columns];
    let place = |at: usize| [at % columns, at / columns].map(|k| 1.0 + (k as f32 + 0.5) * SPACING);
    for Wall { ends: [a, b], .. } in walls {
        let along = [b[0] - a[0], b[1] - a[1]];
        let square = along[0] * along[0] + along[1] * along[1];
        let cells = |k: usize| {
            let cell = |at: f32| ((at - 1.0) / SPACING).clamp(0.0, columns as f32) as usize;
            cell(a[k].min(b[k]) - SPACING)..(cell(a[k].max(b[k]) + SPACING) + 1).min(columns)
        };
        for at in cells(1).flat_map(|row| cells(0).map(move |column| row * columns + column)) {
            let [x, y] = place(at);
            let share = ((x - a[0]) * along[0] + (y - a[1]) * along[1]) / square;
            let near = [0, 1].map(|k| a[k] + share.clamp(0.0, 1.0) * along[k]);
            is_free[at] &= (x - near[0]).hypot(y - near[1]) > 1.0;
        }
    }
    let mut free: Vec<usize> = (0..is_free.len()).filter(|&at| is_free[at]).collect();
    assert!(free.len() >= count, "there is no room");
    let last = free.len() - 1;
    for at in 0..count {
        let other = at + (random.unit() * (last - at + 1) as f32) as usize;
        free.swap(at, other.min(last));
    }
    free[..count].iter().map(|&at| place(at)).collect()
}
