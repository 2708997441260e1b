//! Motors: immovable particles and walls that follow a given motion.

use std::f64::consts::{PI, TAU};

use jostle_base::Method;
use jostle_scenes::random::Random;
use jostle_world::forces::{Influence, Motor, WallIds};
use jostle_world::{Container, Particles, Wall, World, WorldSettings};

use crate::common::worlds::{bouncing, boxed, run, still, walled, world_of};

fn motor(ids: &[i64], walls: &[i64]) -> Motor {
    Motor {
        ids: ids.to_vec(),
        walls: WallIds(walls.to_vec()),
        pivot: [0.0; 2],
        angular_velocity: 0.0,
        velocity: [0.0; 2],
        cycle: f32::INFINITY,
    }
}

/// Immovable discs of radius 0.5, then movable ones.
fn discs(driven: &[[f32; 2]], free: &[[f32; 2]]) -> Particles {
    let positions = [driven, free].concat();
    let mut all = still(&positions, 0.5);
    all.movable[..driven.len()].fill(false);
    all
}

#[test]
fn a_paddle_turns_about_its_centre_for_an_hour() {
    let pivot = [3.0, -2.0];
    let at = [1.0f32, 2.0, 3.0].map(|x| [pivot[0] + x, pivot[1]]);
    let mut world = world_of(discs(&at, &[]), WorldSettings::default());
    let angular_velocity = 1.7;
    let turning = Motor { pivot, angular_velocity, ..motor(&[0, 1, 2], &[]) };
    world.set_forces(vec![Influence::Motor(turning)]).unwrap();
    run(&mut world, 60 * 3600);
    let angle = f64::from(angular_velocity) * world.time();
    for (k, [x, y]) in world.bodies().positions().unwrap().into_iter().enumerate() {
        let radius = 1.0 + k as f64;
        let [dx, dy] = [x - pivot[0], y - pivot[1]].map(f64::from);
        assert!((dx.hypot(dy) - radius).abs() < 2e-3, "{k}: {}", dx.hypot(dy));
        let off = (dy.atan2(dx) - angle).rem_euclid(TAU);
        assert!(off.min(TAU - off) < 2e-3, "{k}: {off}");
    }
    let turned = f64::from(world.bodies().angles().unwrap()[0]);
    let off = (turned - angle).rem_euclid(TAU);
    assert!(off.min(TAU - off) < 2e-2, "{off}: each disc turns with the paddle");
}

#[test]
fn the_motion_does_not_depend_on_the_steps() {
    let place = |dt: f64, steps: usize| {
        let settings = WorldSettings::default();
        let mut world =
            walled(discs(&[[1.0, 0.0]], &[]), vec![Wall::new([[9.0, 0.0], [9.0, 1.0]])], settings);
        let swing = Motor { angular_velocity: 0.8, cycle: 1.3, ..motor(&[0], &[]) };
        let piston = Motor { velocity: [2.0, 1.0], cycle: 0.7, ..motor(&[], &[0]) };
        world.set_forces(vec![Influence::Motor(swing), Influence::Motor(piston)]).unwrap();
        world.step(dt, steps).unwrap();
        (world.bodies().positions().unwrap()[0], world.walls()[0].ends)
    };
    let (disc, wall) = place(1.0 / 64.0, 640);
    // After 10 s: 10 = 7 · 1.3 + 0.9, so 0.4 s forward; 10 = 14 · 0.7 + 0.2.
    let angle = 0.8 * 0.4;
    let expected = [f64::cos(angle), f64::sin(angle)];
    for (found, expected) in disc.into_iter().zip(expected) {
        assert!((f64::from(found) - expected).abs() < 1e-5, "{disc:?}");
    }
    assert!((wall[0][0] - 9.4).abs() < 1e-5 && (wall[1][1] - 1.2).abs() < 1e-5, "{wall:?}");
    for (dt, steps) in [(1.0 / 16.0, 160), (0.1, 100), (2.5, 4)] {
        let (other, walls) = place(dt, steps);
        for (a, b) in [(other, disc), (walls[0], wall[0]), (walls[1], wall[1])] {
            assert!((a[0] - b[0]).abs() < 2e-5 && (a[1] - b[1]).abs() < 2e-5, "{dt}: {a:?} {b:?}");
        }
    }
}

#[test]
fn a_disc_that_a_paddle_hits_leaves_with_its_speed() {
    // A paddle that turns by a right angle in a second, with a tip that moves at 4 · π/2.
    let mut world = world_of(discs(&[[4.0, 0.0]], &[[2.7, 2.95]]), WorldSettings::default());
    let turning = Motor { angular_velocity: PI as f32 / 2.0, ..motor(&[0], &[]) };
    world.set_forces(vec![Influence::Motor(turning)]).unwrap();
    run(&mut world, 60);
    let [u, v] = world.bodies().velocities().unwrap()[1].map(f64::from);
    let speed = u.hypot(v);
    // Elastic, of infinite mass: up to twice the speed of the tip.
    assert!(speed > 2.0 && speed < 2.0 * 4.0 * PI / 2.0, "{speed}");
    assert!(world.contacts().unwrap().is_empty());
}

/// Grains in a round mill with two crossed paddles, and a piston at its side.
fn mill(method: Method, threads: usize) -> World {
    let paddles: Vec<[f32; 2]> = (-6..=6)
        .flat_map(|k| [[k as f32, 0.0], [0.0, k as f32]])
        .filter(|at| *at != [0.0; 2])
        .collect();
    let mut random = Random::new(5);
    let mut free = Vec::new();
    for _ in 0..120 {
        let [x, y] = [0, 1].map(|_| random.between(0.7, 6.3));
        free.push([x, y]);
    }
    let mut settings = WorldSettings {
        container: Container::Circle { center: [0.0; 2], radius: 9.0 },
        gravity: [0.0, -9.8],
        method,
        ..WorldSettings::default()
    };
    settings.tree.threads = Some(threads);
    let mut all = bouncing(discs(&paddles, &free), 0.5);
    all.radii[paddles.len()..].fill(0.3);
    all.masses.fill(1.0);
    let len = all.len();
    all.spins_mut()[..len].iter_mut().for_each(|spin| spin.friction = 0.4);
    let ids: Vec<i64> = (0..paddles.len() as i64).collect();
    let mut world = walled(all, vec![Wall::new([[-3.0, -8.0], [3.0, -8.0]])], settings);
    let turning = Motor { angular_velocity: 2.0, ..motor(&ids, &[]) };
    let piston = Motor { velocity: [0.0, 0.7], cycle: 1.1, ..motor(&[], &[0]) };
    world.set_forces(vec![Influence::Motor(turning), Influence::Motor(piston)]).unwrap();
    world
}

#[test]
fn a_mill_has_the_same_bits_however_it_is_computed() {
    let mut expected = mill(Method::Quadtree, 1);
    run(&mut expected, 240);
    for (method, threads) in [(Method::Brute, 1), (Method::Quadtree, 2)] {
        let mut other = mill(method, threads);
        run(&mut other, 240);
        assert!(
            other.bodies().particles().unwrap() == expected.bodies().particles().unwrap(),
            "{method:?} {threads}"
        );
    }
    let mut half = mill(Method::Quadtree, 1);
    run(&mut half, 100);
    let mut half = World::restore(&half.snapshot().unwrap()).unwrap();
    run(&mut half, 140);
    assert_eq!(half.snapshot().unwrap(), expected.snapshot().unwrap());
    // It lifts grains; they stay in the mill.
    assert!(expected.bodies().positions().unwrap().iter().all(|[x, y]| x.hypot(*y) < 9.0));
    assert!(expected.kinetic_energy() > 1.0);
}

#[test]
fn grains_on_a_paddle_do_not_sleep_and_others_do() {
    let mut all = bouncing(discs(&[[0.0, 1.0]], &[[5.0, 0.5]]), 0.3);
    all.spins_mut();
    let settings = WorldSettings {
        container: boxed([-10.0, 0.0], [10.0, 10.0]),
        gravity: [0.0, -9.8],
        ..WorldSettings::default()
    };
    let mut world = world_of(all, settings);
    let lift = Motor { velocity: [0.0, 0.5], cycle: 4.0, ..motor(&[0], &[]) };
    world.set_forces(vec![Influence::Motor(lift)]).unwrap();
    run(&mut world, 120);
    assert_eq!(world.bodies().asleep().unwrap(), [false, true]);
    assert!(
        (world.bodies().positions().unwrap()[0][1] - 2.0).abs() < 1e-5,
        "it moves on while others sleep"
    );
}

#[test]
fn a_step_that_fails_leaves_the_velocities() {
    let far = 2e5;
    let mut world = walled(
        discs(&[[1.0, 0.0]], &[[far, 0.0]]),
        vec![Wall::new([[9.0, 0.0], [9.0, 1.0]])],
        WorldSettings::default(),
    );
    let turning = Motor { angular_velocity: 1.0, velocity: [1.0, 0.0], ..motor(&[0], &[]) };
    let piston = Motor { velocity: [2.0, 1.0], cycle: 0.7, ..motor(&[], &[0]) };
    world.set_forces(vec![Influence::Motor(turning), Influence::Motor(piston)]).unwrap();
    let before = world.snapshot().unwrap();
    assert!(world.step(1e30, 1).is_err());
    assert_eq!(world.snapshot().unwrap(), before);
}

#[test]
fn motors_of_what_cannot_be_driven_are_refused() {
    let at = [[1.0, 0.0], [3.0, 0.0]];
    let mut world = world_of(discs(&at, &[[9.0, 0.0]]), WorldSettings::default());
    let refusal = |world: &mut World, motor: Motor| {
        world.set_forces(vec![Influence::Motor(motor)]).unwrap_err().to_string()
    };
    let text = refusal(&mut world, motor(&[0, 2], &[]));
    assert_eq!(text, "forces[0] is a motor of particle 2; it drives immovable particles only");
    assert!(refusal(&mut world, motor(&[3], &[])).contains("no particle has this id"));
    assert!(refusal(&mut world, motor(&[], &[0])).contains("no wall has this id"));
    assert!(refusal(&mut world, motor(&[0, 1, 0], &[])).starts_with("ids[2] is 0"));
    let endless = Motor { cycle: 0.0, ..motor(&[0], &[]) };
    assert!(refusal(&mut world, endless).starts_with("cycle is 0"));
    let turning = Motor { angular_velocity: 1.0, ..motor(&[], &[0]) };
    assert!(refusal(&mut world, turning).contains("walls do not turn"));
    world.set_walls(vec![Wall::new([[0.0, 5.0], [1.0, 5.0]])]).unwrap();
    world.set_forces(vec![Influence::Motor(motor(&[0, 1], &[0]))]).unwrap();
    let text = world.set_walls(vec![]).unwrap_err().to_string();
    assert_eq!(text, "forces[0] is a motor of wall 0; no wall has this id");
    // A removed particle is driven no more, and a movable one neither.
    world.remove(&[0]).unwrap();
    let [Influence::Motor(left)] = &world.forces().unwrap()[..] else { panic!("one motor") };
    assert_eq!(left.ids, [1]);
    world
        .edit(|all| {
            all.movable[0] = true;
            Ok(())
        })
        .unwrap();
    run(&mut world, 10);
}
