//! Accelerations and forces of the caller.

use jostle_base::Method;
use jostle_scenes::random::Random;
use jostle_world::{OnTouch, Particles, World, WorldSettings};

use crate::common::worlds::{bouncing, boxed, run, still, world_of};

fn discs(positions: &[[f32; 2]]) -> Particles {
    still(positions, 0.5)
}

#[test]
fn an_external_acceleration_leads_to_a_parabola() {
    let mut world = world_of(discs(&[[0.0; 2], [5.0, 0.0]]), WorldSettings::default());
    world.set_accelerations(vec![[3.0, -4.0], [0.0; 2]]).unwrap();
    assert!(world.external_accelerations().eq([[3.0, -4.0], [0.0; 2]]));
    run(&mut world, 60);
    let ([x, y], [u, v]) =
        (world.bodies().positions().unwrap()[0], world.bodies().velocities().unwrap()[0]);
    assert!((x - 1.5).abs() < 1e-5 && (y + 2.0).abs() < 1e-5, "{x} {y}");
    assert!((u - 3.0).abs() < 1e-5 && (v + 4.0).abs() < 1e-5, "{u} {v}");
    assert_eq!(world.bodies().velocities().unwrap()[1], [0.0; 2]);
    world.clear_accelerations();
    run(&mut world, 60);
    assert_eq!(world.bodies().velocities().unwrap()[0], [u, v]);
}

#[test]
fn forces_add_up_and_are_divided_by_the_mass() {
    let mut all = discs(&[[0.0; 2], [5.0, 0.0], [9.0, 0.0]]);
    all.masses = vec![2.0, 4.0, 1.0];
    all.movable[2] = false;
    let mut world = world_of(all, WorldSettings::default());
    world.remove(&[0]).unwrap();
    world.add_forces(&[1, 2, 1], &[[4.0, 0.0], [1.0, 1.0], [0.0, 2.0]], None).unwrap();
    world.add_forces(&[1], &[[4.0, 0.0]], None).unwrap();
    assert!(world.external_accelerations().eq([[2.0, 0.5], [0.0; 2]]));
    let added = world.add(discs(&[[20.0, 0.0]])).unwrap();
    assert_eq!(added, 3..4);
    run(&mut world, 60);
    let velocities = world.bodies().velocities().unwrap();
    assert!((velocities[0][0] - 2.0).abs() < 1e-5 && (velocities[0][1] - 0.5).abs() < 1e-5);
    assert_eq!(velocities[1..], [[0.0; 2]; 2]);
}

/// A box of inelastic discs under gravity.
fn crowd(order: &[usize], method: Method, threads: usize) -> World {
    let mut random = Random::new(3);
    let positions: Vec<[f32; 2]> =
        (0..200).map(|_| [0, 1].map(|_| random.between(1.0, 19.0))).collect();
    let mut settings = WorldSettings {
        container: boxed([0.0; 2], [20.0; 2]),
        gravity: [0.0, -9.8],
        method,
        ..WorldSettings::default()
    };
    settings.tree.threads = Some(threads);
    let positions: Vec<[f32; 2]> = order.iter().map(|&k| positions[k]).collect();
    world_of(bouncing(discs(&positions), 0.5), settings)
}

/// Steps with a field that depends on place and velocity.
fn run_in_field(world: &mut World, calls: usize) {
    for _ in 0..calls {
        let pairs = world
            .bodies()
            .positions()
            .unwrap()
            .into_iter()
            .zip(world.bodies().velocities().unwrap());
        let field = pairs.map(|([x, y], [u, v])| [10.0 - x - v, 3.0 * u - 0.5 * y]);
        let field = field.collect();
        world.set_accelerations(field).unwrap();
        run(world, 2);
    }
}

#[test]
fn the_bits_are_the_same_however_it_is_computed() {
    let order: Vec<usize> = (0..200).collect();
    let mut expected = crowd(&order, Method::Quadtree, 1);
    run_in_field(&mut expected, 60);
    for (method, threads) in [(Method::Brute, 1), (Method::Quadtree, 2)] {
        let mut other = crowd(&order, method, threads);
        run_in_field(&mut other, 60);
        assert!(
            other.bodies().particles().unwrap() == expected.bodies().particles().unwrap(),
            "{method:?} {threads}"
        );
    }
    let reversed: Vec<usize> = order.iter().rev().copied().collect();
    let mut other = crowd(&reversed, Method::Quadtree, 1);
    run_in_field(&mut other, 60);
    let mut found = other.bodies().positions().unwrap();
    found.reverse();
    assert_eq!(found, expected.bodies().positions().unwrap());
}

#[test]
fn snapshots_contain_external_accelerations() {
    let order: Vec<usize> = (0..200).collect();
    let mut world = crowd(&order, Method::Quadtree, 1);
    run(&mut world, 20);
    world.add_forces(&[3, 4], &[[50.0, 0.0], [0.0, 90.0]], None).unwrap();
    let mut again = World::restore(&world.snapshot().unwrap()).unwrap();
    assert!(again.external_accelerations().eq(world.external_accelerations()));
    run(&mut world, 20);
    run(&mut again, 20);
    assert_eq!(again.snapshot().unwrap(), world.snapshot().unwrap());
}

#[test]
fn pushed_particles_do_not_sleep_and_others_do() {
    let settings = WorldSettings {
        container: boxed([0.0; 2], [20.0; 2]),
        gravity: [0.0, -9.8],
        ..WorldSettings::default()
    };
    let mut world = world_of(bouncing(discs(&[[2.0, 0.5], [9.0, 0.5]]), 0.3), settings);
    for _ in 0..120 {
        // It presses the disc against the floor.
        world.add_forces(&[0], &[[0.0, -1.0]], None).unwrap();
        run(&mut world, 1);
        world.clear_accelerations();
    }
    assert_eq!(world.bodies().asleep().unwrap(), [false, true]);
    run(&mut world, 120);
    assert_eq!(world.bodies().asleep().unwrap(), [true, true]);
    world.add_forces(&[1], &[[0.0, 40.0]], None).unwrap();
    assert_eq!(world.bodies().asleep().unwrap(), [true, false]);
    run(&mut world, 3);
    assert!(world.bodies().velocities().unwrap()[1][1] > 1.0);
    world.clear_accelerations();
}

#[test]
fn particles_that_merge_keep_the_external_force() {
    let mut all = discs(&[[0.0; 2], [0.9, 0.0]]);
    all.masses = vec![1.0, 3.0];
    let settings = WorldSettings { on_touch: OnTouch::Merge, ..WorldSettings::default() };
    let mut world = world_of(all, settings);
    world.add_forces(&[0, 1], &[[8.0, 0.0], [0.0, 4.0]], None).unwrap();
    run(&mut world, 60);
    assert_eq!(world.len(), 1);
    let [u, v] = world.bodies().velocities().unwrap()[0];
    assert!((u - 2.0).abs() < 1e-4 && (v - 1.0).abs() < 1e-4, "{u} {v}");
}

#[test]
fn a_step_that_fails_keeps_them() {
    let mut world = world_of(discs(&[[0.0; 2]]), WorldSettings::default());
    world.add_forces(&[0], &[[1e10, 0.0]], None).unwrap();
    let before = world.snapshot().unwrap();
    let text = world.step(1e10, 1).unwrap_err().to_string();
    assert!(text.contains("forces would move particle 0"), "{text}");
    assert_eq!(world.snapshot().unwrap(), before);
}

#[test]
fn wrong_ones_are_refused() {
    let mut all = discs(&[[0.0; 2], [5.0, 0.0]]);
    all.masses[1] = 1e-6;
    let mut world = world_of(all, WorldSettings::default());
    let before = world.snapshot().unwrap();
    let text = world.set_accelerations(vec![[0.0; 2]]).unwrap_err().to_string();
    assert!(text.contains("accelerations"), "{text}");
    let text = world.set_accelerations(vec![[0.0; 2], [0.0, f32::NAN]]).unwrap_err().to_string();
    assert!(text.starts_with("accelerations[1] is (0, NaN)"), "{text}");
    let text = world.add_forces(&[0, 7], &[[0.0; 2]; 2], None).unwrap_err().to_string();
    assert!(text.contains("7"), "{text}");
    let text = world.add_forces(&[0, 1], &[[1.0; 2], [1e15, 0.0]], None).unwrap_err().to_string();
    assert!(text.starts_with("forces[1] is ("), "{text}");
    assert_eq!(world.snapshot().unwrap(), before);
}
