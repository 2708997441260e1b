//! Kinematic discs: immovable ones with a velocity, which push and are not pushed.

use jostle_base::Method;
use jostle_scenes::random::Random;
use jostle_world::{Container, Particles, Spin, World, WorldSettings};
use proptest::prelude::*;

use crate::common::worlds::{STEP, bouncing, boxed, falling, gathered, run, world_of};

/// Discs of radius 1, each with a position and a velocity; the first `kinematic` are immovable.
fn discs(rows: &[([f32; 2], [f32; 2])], kinematic: usize) -> Particles {
    let (positions, velocities): (Vec<_>, Vec<_>) = rows.iter().copied().unzip();
    let mut all = Particles::new(positions, velocities, vec![1.0; rows.len()], 1.0);
    all.movable[..kinematic].fill(false);
    all
}

#[test]
fn nothing_changes_the_velocity() {
    let mut all =
        discs(&[([0.0, 0.0], [3.0, 1.0]), ([5.0, 0.0], [-40.0, 0.0]), ([9.0, 2.0], [0.0; 2])], 1);
    all.spins = vec![Spin { friction: 0.5, velocity: 2.0, angle: 0.0 }; 3];
    let container = boxed([-8.0, -6.0], [14.0, 6.0]);
    for drag in [0.0, 0.8] {
        let settings = WorldSettings { container, drag, ..falling() };
        let mut world = world_of(bouncing(all.clone(), 0.7), settings);
        let (momentum, energy) = (world.momentum(), world.kinetic_energy());
        assert!(momentum[1] == 0.0 && (energy - 802.0).abs() < 1e-3, "{momentum:?} {energy}");
        // It also leaves the container.
        run(&mut world, 600);
        assert_eq!(world.bodies().velocities().unwrap()[0], [3.0, 1.0]);
        assert_eq!(world.bodies().angular_velocities().unwrap()[0], 2.0);
        let ([x, y], angle) = (
            world.bodies().positions().unwrap()[0],
            f64::from(world.bodies().angles().unwrap()[0]),
        );
        assert!((x - 30.0).abs() < 1e-4 && (y - 10.0).abs() < 1e-4, "{x} {y}");
        assert!((angle.cos() - 20f64.cos()).abs() < 1e-5, "{angle}");
        assert!(
            world.bodies().positions().unwrap()[1..]
                .iter()
                .all(|[x, y]| x.abs() < 14.0 && y.abs() < 6.0)
        );
    }
}

#[test]
fn a_disc_leaves_with_the_relative_speed() {
    // The disc meets the other with the relative speed u + V, and leaves with e (u + V) + V.
    for (pushing, own, restitution) in [
        (3.0, 0.0, 1.0),
        (3.0, -2.0, 1.0),
        (3.0, -2.0, 0.5),
        (60_000.0, 0.0, 1.0),
        (-3.0, -5.0, 0.0),
    ] {
        let rows = [([0.0, 0.0], [pushing, 0.0]), ([12.0, 0.0], [own, 0.0])];
        let discs = bouncing(discs(&rows, 1), restitution);
        let mut world = world_of(discs, WorldSettings::default());
        run(&mut world, 400);
        let expected = pushing + restitution * (pushing - own);
        let [found, across] = world.bodies().velocities().unwrap()[1];
        assert!((found - expected).abs() <= 1e-6 * expected.abs() && across == 0.0, "{found}");
        let gap = world.bodies().positions().unwrap()[1][0]
            - world.bodies().positions().unwrap()[0][0]
            - 2.0;
        assert!(gap >= -1e-5 * pushing.abs(), "{gap}");
    }
}

proptest! {
    #![proptest_config(crate::common::cases(40))]

    /// With everything seen from a kinematic disc, which then stands still, the motion is the same.
    #[test]
    fn the_motion_is_the_same_in_the_frame_of_a_kinematic_disc(seed in any::<u64>()) {
        let mut random = Random::new(seed);
        let mut between = |least: f32, most: f32| random.between(least, most);
        let own = [between(-30.0, 30.0), between(-30.0, 30.0)];
        let mut rows = vec![([0.0, 0.0], own)];
        for row in 0..6 {
            let place = [3.0 * (row % 3) as f32 - 8.0, 3.0 * (row / 3) as f32 + 3.0];
            rows.push((place, [between(-30.0, 30.0), between(-30.0, 30.0)]));
        }
        let at_rest: Vec<_> = rows
            .iter()
            .map(|(place, velocity)| (*place, [0, 1].map(|k| velocity[k] - own[k])))
            .collect();
        let mut both = [rows, at_rest]
            .map(|rows| world_of(bouncing(discs(&rows, 1), 0.9), WorldSettings::default()));
        both.iter_mut().for_each(|world| run(world, 30));
        let [moving, at_rest] = both.map(|world| {
            let bodies = world.bodies();
            (bodies.positions().unwrap(), bodies.velocities().unwrap())
        });
        for row in 0..7 {
            for (k, speed) in own.into_iter().enumerate() {
                let there = moving.0[row][k] - speed * 0.5;
                prop_assert!((there - at_rest.0[row][k]).abs() < 2e-3, "{row}");
                let velocity = moving.1[row][k] - speed;
                prop_assert!((velocity - at_rest.1[row][k]).abs() < 2e-3, "{row}");
            }
        }
    }
}

/// A row of kinematic discs with a velocity and an angular velocity under one movable disc.
fn on_a_belt(velocity: [f32; 2], turning: f32, friction: f32) -> World {
    // One very large disc is nearly flat.
    let rows = [([0.0, -10_000.0], velocity), ([0.0, 1.0], [0.0, velocity[1]])];
    let mut all = discs(&rows, 1);
    all.radii[0] = 10_000.0;
    all.spins = vec![Spin { friction, velocity: 0.0, angle: 0.0 }; 2];
    all.spins[0].velocity = turning;
    world_of(bouncing(all, 0.5), falling())
}

#[test]
fn a_belt_carries_a_disc_until_it_rolls() {
    // The surface moves with V, so the disc slides until v + 2 v = V; I = m r²/2.
    for (velocity, turning) in [([6.0, 0.0], 0.0), ([0.0, 0.0], -6.0e-4)] {
        let mut world = on_a_belt(velocity, turning, 0.3);
        run(&mut world, 20);
        let expected = 0.3 * 9.8 / 3.0;
        let found = world.bodies().velocities().unwrap()[1][0];
        assert!((found - expected).abs() < 0.03, "sliding: {found}");
        run(&mut world, 100);
        let (found, spin) = (
            world.bodies().velocities().unwrap()[1][0],
            world.bodies().angular_velocities().unwrap()[1],
        );
        assert!((found - 2.0).abs() < 0.03 && (spin - 4.0).abs() < 0.05, "rolling: {found} {spin}");
    }
}

#[test]
fn a_lift_carries_a_disc_at_rest() {
    for speed in [2.0, -2.0] {
        let mut world = on_a_belt([0.0, speed], 0.0, 0.0);
        run(&mut world, 200);
        let (positions, velocities) =
            (world.bodies().positions().unwrap(), world.bodies().velocities().unwrap());
        let gap = f64::from(positions[1][1]) - f64::from(positions[0][1]) - 10_001.0;
        assert!(gap.abs() < 0.01, "{gap}");
        assert!((velocities[1][1] - speed).abs() < 0.02, "{:?}", velocities[1]);
        let impulse =
            world.contacts().expect("found").iter().map(|touch| touch.normal_impulse).sum::<f32>();
        assert!((f64::from(impulse) - 9.8 * STEP).abs() < 1e-3, "{impulse}");
    }
}

#[test]
fn a_disc_is_caught_on_a_torus() {
    let settings = WorldSettings {
        container: Container::Torus { size: [40.0, 40.0] },
        ..WorldSettings::default()
    };
    let mut world =
        world_of(discs(&[([1.0, 20.0], [-9.0, 0.0]), ([30.0, 20.0], [0.0; 2])], 1), settings);
    run(&mut world, 90);
    assert_eq!(world.bodies().velocities().unwrap()[1], [-18.0, 0.0]);
    assert!((world.bodies().positions().unwrap()[0][0] - 27.5).abs() < 1e-4);
}

/// A heap of discs in a box through which kinematic discs move, some of them turning.
fn stirred(count: usize, seed: u64) -> World {
    let mut random = Random::new(seed);
    let mut between = |least: f32, most: f32| random.between(least, most);
    let rows: Vec<_> = (0..count)
        .map(|row| {
            let (x, y) = ((row % 20) as f32, (row / 20) as f32);
            let place = [2.4 * x + between(0.0, 0.3), 2.4 * y + between(0.0, 0.3)];
            (place, [between(-20.0, 20.0), between(-20.0, 20.0)])
        })
        .collect();
    let mut all = bouncing(discs(&rows, 6), 0.6);
    all.spins = vec![Spin { friction: 0.4, velocity: 0.0, angle: 0.0 }; count];
    all.spins[..3].iter_mut().for_each(|spin| spin.velocity = 5.0);
    let container = boxed([-2.0; 2], [50.0; 2]);
    world_of(all, WorldSettings { container, ..falling() })
}

#[test]
fn methods_threads_and_order_do_not_show() {
    let mut first = stirred(300, 1);
    run(&mut first, 60);
    let all = stirred(300, 1).bodies().particles().unwrap();
    let brute = WorldSettings { method: Method::Brute, ..*first.settings() };
    let mut other = world_of(all.clone(), brute);
    run(&mut other, 60);
    assert_eq!(other.state_hash().unwrap(), first.state_hash().unwrap());
    let order: Vec<u32> = (0..300).rev().collect();
    let permuted = gathered(&all, &order);
    let mut other = world_of(permuted, *first.settings());
    run(&mut other, 30);
    let mut other = World::restore(&other.snapshot().unwrap()).expect("valid");
    run(&mut other, 30);
    let (mut back, found) = (Particles::default(), other.bodies().particles().unwrap());
    back.gather(&found, &order, Some(1));
    assert_eq!(back, first.bodies().particles().unwrap());
    for threads in [1, 2, 5] {
        let mut settings = *first.settings();
        settings.tree.threads = Some(threads);
        let mut other = world_of(all.clone(), settings);
        run(&mut other, 60);
        assert_eq!(other.state_hash().unwrap(), first.state_hash().unwrap(), "{threads}");
    }
}

#[test]
fn no_disc_gets_into_a_kinematic_one() {
    for seed in 0..5 {
        let mut world = stirred(300, seed);
        for _ in 0..120 {
            run(&mut world, 1);
            let all = world.bodies().particles().unwrap();
            for a in 0..6 {
                for b in 6..300 {
                    let offset = [0, 1].map(|k| all.positions[b][k] - all.positions[a][k]);
                    let distance = offset[0].hypot(offset[1]);
                    let [x, y] = all.positions[a];
                    // Where one crosses the wall of the container, it may press a disc against it.
                    let is_inside = [x, y].iter().all(|v| (2.0..46.0).contains(v));
                    assert!(
                        distance > 1.85 || !is_inside,
                        "{distance} of {a} and {b}, seed {seed}"
                    );
                }
            }
        }
    }
}

/// A disc that rests on a static one between two others, and a kinematic one far away.
fn asleep() -> World {
    let rows = [
        ([0.0, 0.0], [0.0; 2]),
        ([2.1, 0.0], [0.0; 2]),
        ([40.0, 0.0], [0.0; 2]),
        ([1.0, 1.8], [0.0; 2]),
    ];
    let mut world = world_of(bouncing(discs(&rows, 3), 0.2), falling());
    run(&mut world, 300);
    assert_eq!(world.bodies().asleep().unwrap(), [false, false, false, true]);
    world
}

fn drive(world: &mut World, row: usize, velocity: [f32; 2]) {
    let change = |all: &mut Particles| {
        all.velocities[row] = velocity;
        Ok(())
    };
    world.edit(change).expect("valid");
}

#[test]
fn only_what_touches_a_kinematic_disc_wakes() {
    let mut world = asleep();
    drive(&mut world, 2, [0.0, 10.0]);
    assert!(world.bodies().asleep().unwrap()[3], "it does not touch");
    run(&mut world, 10);
    assert!(world.bodies().asleep().unwrap()[3], "it is far away");
    drive(&mut world, 2, [-60.0, 0.0]);
    run(&mut world, 60);
    assert!(!world.bodies().asleep().unwrap()[3], "it comes near");

    let mut world = asleep();
    drive(&mut world, 1, [1.0, 0.0]);
    assert!(!world.bodies().asleep().unwrap()[3], "it rests on the disc that moves");
    run(&mut world, 60);
    assert!(
        world.bodies().positions().unwrap()[3][1] < 1.5,
        "it sinks: {:?}",
        world.bodies().positions().unwrap()[3]
    );
}

#[test]
fn nothing_falls_asleep_on_what_moves() {
    let mut world = on_a_belt([1e-4, 0.0], 0.0, 0.5);
    run(&mut world, 600);
    assert!(!world.bodies().asleep().unwrap()[1]);
    drive(&mut world, 0, [0.0; 2]);
    run(&mut world, 600);
    assert!(world.bodies().asleep().unwrap()[1]);
}
