//! What the scenes with a story have to show.

use jostle_scenes::{self as scenes, STEP};
use jostle_world::World;
use jostle_world::forces::Influence;

fn create(name: &str, n: Option<usize>, seed: u64) -> World {
    scenes::find(name).unwrap().create(n, seed).unwrap()
}

fn run(world: &mut World, seconds: usize) {
    world.step(STEP, 60 * seconds).unwrap();
}

/// Positions of what can be moved.
fn moving(world: &World) -> Vec<[f32; 2]> {
    let movable = world.bodies().movable().unwrap();
    world
        .bodies()
        .positions()
        .unwrap()
        .into_iter()
        .zip(movable)
        .filter_map(|(p, m)| m.then_some(p))
        .collect()
}

fn distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    let offset = [b[0] - a[0], b[1] - a[1]];
    (offset[0] * offset[0] + offset[1] * offset[1]).sqrt()
}

#[test]
fn springs_hold_discs_that_do_not_overlap_at_rest() {
    let world = create("springs", None, 0);
    let radii = world.bodies().radii().unwrap();
    let [Influence::Springs(springs)] = &world.forces().unwrap()[..] else {
        panic!("springs alone")
    };
    for spring in &springs.0 {
        let [a, b] = spring.pair.map(|row| radii[row as usize]);
        assert!(spring.length >= a + b);
    }
}

#[test]
fn soft_bodies_come_to_rest_in_one_piece() {
    let mut world = create("springs", Some(200), 1);
    run(&mut world, 30);
    let positions = world.bodies().positions().unwrap();
    let [Influence::Springs(springs)] = &world.forces().unwrap()[..] else {
        panic!("springs alone")
    };
    for spring in &springs.0 {
        let [a, b] = spring.pair.map(|row| positions[row as usize]);
        let share = distance(a, b) / spring.length;
        assert!((0.7..1.3).contains(&share), "{:?} is {share} of its length", spring.pair);
    }
    let fastest = world
        .bodies()
        .velocities()
        .unwrap()
        .iter()
        .map(|&v| distance([0.0; 2], v))
        .fold(0.0, f32::max);
    assert!(fastest < 200.0, "something still moves at {fastest}");
}

#[test]
fn no_grain_leaks_and_the_sand_runs_through() {
    for (n, seed) in [(300, 0), (150, 1)] {
        let mut world = create("sand", Some(n), seed);
        let [_, top, right, floor] = scenes::find("sand").unwrap().view(Some(n)).unwrap();
        let glass: Vec<[[f32; 2]; 2]> = world.walls().iter().map(|wall| wall.ends).collect();
        assert_eq!((glass.len(), world.len()), (12, n));
        let half_width = glass.iter().map(|ends| ends[0][0]).fold(0.0, f32::max);
        assert!(half_width < right);
        run(&mut world, 30);
        let grains = moving(&world);
        assert_eq!(grains.len(), n);
        for &[x, y] in &grains {
            assert!(x.abs() < half_width && y > top && y < floor, "a grain leaked to ({x}, {y})");
            assert!(is_inside(&glass, [x, y]), "a grain is outside at ({x}, {y})");
        }
        let through = grains.iter().filter(|grain| grain[1] > 0.0).count();
        assert!(through * 100 >= n * 95, "{through} of {n} grains have run through");
    }
}

/// Whether a ray from a point to the right crosses an odd number of the walls.
fn is_inside(walls: &[[[f32; 2]; 2]], [x, y]: [f32; 2]) -> bool {
    let is_crossed = |[a, b]: [[f32; 2]; 2]| {
        (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    };
    walls.iter().filter(|&&wall| is_crossed(wall)).count() % 2 == 1
}

#[test]
fn balls_on_the_board_fall_as_coins_do() {
    let board = scenes::galton_board(None).unwrap();
    let (mut counts, mut balls) = (vec![0.0; board.rows + 1], 0.0);
    let mut world = create("galton", None, 0);
    while moving(&world).iter().any(|ball| ball[1] < board.bin_top) && world.time() < 120.0 {
        run(&mut world, 1);
    }
    for [x, y] in moving(&world) {
        assert!(y > board.bin_top, "a ball is stuck at ({x}, {y})");
        let bin = board.bin_edges.iter().filter(|&&edge| edge <= x).count() - 1;
        counts[bin.min(board.rows)] += 1.0;
        balls += 1.0;
    }
    let about = |power: i32, middle: f64| {
        let terms = counts.iter().enumerate().map(|(k, n)| n * (k as f64 - middle).powi(power));
        terms.sum::<f64>() / balls
    };
    let (mean, rows) = (about(1, 0.0), board.rows as f64);
    assert!((mean - rows / 2.0).abs() < 0.25, "the mean is {mean} of {rows}");
    let deviation = about(2, mean).sqrt() / (rows / 4.0).sqrt();
    assert!((0.85..1.15).contains(&deviation), "{deviation} of the binomial's deviation");
}

#[test]
fn the_large_disc_gets_its_share_of_the_energy() {
    let mut world = create("brownian", Some(400), 0);
    let (mut large, mut all, samples) = (0.0, 0.0, 250);
    run(&mut world, 5);
    for _ in 0..samples {
        world.step(STEP, 12).unwrap();
        let [u, v] = world.bodies().velocities().unwrap()[0].map(f64::from);
        large += 0.5 * f64::from(world.bodies().masses().unwrap()[0]) * (u * u + v * v);
        all += world.kinetic_energy() / world.len() as f64;
    }
    let share = large / all;
    assert!((0.5..2.0).contains(&share), "{share} of the mean energy");
}

#[test]
fn both_gases_take_the_speed_of_the_walls() {
    let mut world = create("thermostat", Some(400), 0);
    run(&mut world, 120);
    let energies = |first: usize| {
        let (velocities, masses) =
            (world.bodies().velocities().unwrap(), world.bodies().masses().unwrap());
        let rows = first..first + 200;
        rows.map(|i| masses[i] * distance([0.0; 2], velocities[i]).powi(2)).sum::<f32>()
    };
    let share = energies(0) / energies(200);
    assert!((0.7..1.4).contains(&share), "the light gas has {share} of the heavy one's energy");
}

#[test]
fn dust_becomes_stars() {
    let mut world = create("stars", Some(3000), 0);
    let mass =
        |world: &World| world.bodies().masses().unwrap().iter().map(|&m| f64::from(m)).sum::<f64>();
    let before = mass(&world);
    run(&mut world, 20);
    assert!((mass(&world) / before - 1.0).abs() < 1e-4);
    assert!(world.len() < 600, "{} are left", world.len());
    let largest = world.bodies().radii().unwrap().into_iter().fold(0.0, f32::max);
    assert!(largest > 5.0, "the largest star has a radius of {largest}");
}
