//! Walls that move with a constant velocity.

use std::cell::Cell;

use jostle_base::Method;
use jostle_base::interrupt::watch;
use jostle_scenes::random::Random;
use jostle_world::{Spin, World, WorldSettings};
use proptest::prelude::*;

use crate::common::worlds::{STEP, bouncing, boxed, discs, falling, moving, run, walled, world_of};

thread_local! {
    /// Polls that do not stop the step.
    static LEFT: Cell<u32> = const { Cell::new(0) };
}

#[test]
fn a_disc_leaves_with_the_relative_speed() {
    for (pushing, own, restitution) in [
        (3.0, 0.0, 1.0),
        (3.0, -2.0, 1.0),
        (3.0, -2.0, 0.5),
        (60_000.0, 0.0, 1.0),
        (-3.0, -5.0, 0.0),
    ] {
        let disc = bouncing(discs(&[([11.0, 0.3], [own, 0.0])], 1.0), restitution);
        let walls = vec![moving([[0.0, -3.0], [0.0, 4.0]], [pushing, 0.0])];
        let mut world = walled(disc, walls, WorldSettings::default());
        run(&mut world, 400);
        let expected = pushing + restitution * (pushing - own);
        let [found, across] = world.bodies().velocities().unwrap()[0];
        assert!((found - expected).abs() <= 1e-6 * expected.abs() && across == 0.0, "{found}");
        let [[x, y], _] = world.walls()[0].ends;
        let there = f64::from(pushing) * 400.0 * STEP;
        assert!((f64::from(x) - there).abs() <= 1e-6 * there.abs(), "{x}");
        assert_eq!(y, -3.0);
        let gap = world.bodies().positions().unwrap()[0][0] - x - 1.0;
        assert!(gap >= -1e-5 * pushing.abs(), "{gap}");
    }
}

#[test]
fn an_end_pushes_as_an_immovable_disc_of_radius_0() {
    for gravity in [[0.0, 0.0], [0.0, -9.8]] {
        for y in [0.2, 0.7, -0.6] {
            let velocity = [5.0, 1.0];
            let settings = WorldSettings { gravity, ..WorldSettings::default() };
            let start = ([3.0, y], [-1.0, 0.3]);
            let walls = vec![moving([[0.0, 0.0], [-4.0, 0.0]], velocity)];
            let one = bouncing(discs(&[start], 1.0), 0.8);
            let mut with_wall = walled(one, walls, settings);
            let mut both = bouncing(discs(&[start, ([0.0, 0.0], velocity)], 1.0), 0.8);
            (both.radii[1], both.movable[1]) = (0.0, false);
            let mut with_point = world_of(both, settings);
            for _ in 0..40 {
                run(&mut with_wall, 1);
                run(&mut with_point, 1);
                let [a, b] =
                    [&with_wall, &with_point].map(|world| world.bodies().positions().unwrap()[0]);
                assert!((0..2).all(|k| (a[k] - b[k]).abs() < 1e-4), "{a:?} {b:?}");
            }
        }
    }
}

/// A closed polygon of walls with discs in it; all move with a velocity more than what is random.
fn room(seed: u64, extra: [f32; 2], falls: bool) -> World {
    let mut random = Random::new(seed);
    let corners = 3 + (seed % 9) as usize;
    let points: Vec<[f32; 2]> = (0..corners)
        .map(|k| {
            let angle = (k as f32 + 0.3) / corners as f32 * std::f32::consts::TAU;
            let out = random.between(4.0, 12.0);
            [out * angle.cos(), out * angle.sin()]
        })
        .collect();
    let walls = (0..corners).map(|k| moving([points[k], points[(k + 1) % corners]], extra));
    let rows: Vec<_> = (0..3)
        .map(|k| {
            let velocity = extra.map(|v| v + random.between(-20.0, 20.0));
            ([0.61 * k as f32 - 0.61, 0.0], velocity)
        })
        .collect();
    let gravity = if falls { [0.0, -9.8] } else { [0.0; 2] };
    let settings = WorldSettings { gravity, ..WorldSettings::default() };
    walled(bouncing(discs(&rows, 0.3), 0.9), walls.collect(), settings)
}

proptest! {
    #![proptest_config(crate::common::cases(100))]

    /// Seen from walls that move together, the motion is as between walls that stand still.
    #[test]
    fn the_motion_is_the_same_in_the_frame_of_the_walls(
        seed in any::<u64>(),
        extra in [-40.0..40.0f32, -40.0..40.0f32],
        falls in any::<bool>(),
    ) {
        let mut both = [room(seed, extra, falls), room(seed, [0.0; 2], falls)];
        // Later, collisions have made the differences of rounding large.
        both.iter_mut().for_each(|world| run(world, 10));
        let [moving, at_rest] = both.map(|world| world.bodies().positions().unwrap());
        for row in 0..3 {
            for k in 0..2 {
                let there = moving[row][k] - extra[k] * (10.0 * STEP) as f32;
                prop_assert!((there - at_rest[row][k]).abs() < 0.01, "{there} {at_rest:?}");
            }
        }
    }

    /// Two fast walls move towards each other between discs; none gets past them.
    #[test]
    fn nothing_passes_a_moving_wall(seed in any::<u64>(), speed in 0.0..3000.0f32, falls in any::<bool>()) {
        let mut random = Random::new(seed);
        let rows: Vec<_> = (0..8)
            .map(|k| ([k as f32 * 2.5, random.between(-3.0, 3.0)],
                      [random.between(-speed, speed), random.between(-1.0, 1.0)]))
            .collect();
        let gravity = if falls { [0.0, -9.8] } else { [0.0; 2] };
        let tall = |x: f32, v: f32| moving([[x, -1e4], [x, 1e4]], [v, 0.0]);
        let walls = vec![tall(-2.0, speed), tall(23.0, -0.3 * speed)];
        let settings = WorldSettings { gravity, ..WorldSettings::default() };
        let mut world = walled(discs(&rows, 0.5), walls, settings);
        let mut steps = 0;
        // Until there is hardly room left.
        while world.walls()[1].ends[0][0] - world.walls()[0].ends[0][0] > 12.0 && steps < 60 {
            world.step(1e-3, 1).expect("a step succeeds");
            steps += 1;
            let [left, right] = [0, 1].map(|k| world.walls()[k].ends[0][0]);
            for [x, _] in world.bodies().positions().unwrap() {
                prop_assert!(x > left + 0.45 && x < right - 0.45, "{left} {x} {right}");
            }
        }
    }
}

#[test]
fn a_belt_and_a_lift_carry_discs() {
    for velocity in [[6.0, 0.0], [0.0, 2.0], [6.0, -2.0]] {
        let mut all = bouncing(discs(&[([0.0, 1.0], [0.0, velocity[1]])], 1.0), 0.5);
        all.spins = vec![Spin { friction: 0.3, ..Spin::default() }];
        let walls = vec![moving([[-100.0, 0.0], [100.0, 0.0]], velocity)];
        let mut world = walled(all, walls, falling());
        run(&mut world, 200);
        // It rolls: v + 2 v is the speed of the belt.
        let ([u, v], spin) = (
            world.bodies().velocities().unwrap()[0],
            world.bodies().angular_velocities().unwrap()[0],
        );
        let rolling = velocity[0] / 3.0;
        assert!((u - rolling).abs() < 0.02 && (v - velocity[1]).abs() < 0.02, "{u} {v}");
        assert!((spin - 2.0 * rolling).abs() < 0.04, "{spin}");
        let height = world.bodies().positions().unwrap()[0][1] - world.walls()[0].ends[0][1];
        assert!((height - 1.0).abs() < 5e-3, "{height}");
        let impulse = world.wall_contacts().unwrap()[0].normal_impulse;
        assert!((f64::from(impulse) - 9.8 * STEP).abs() < 1e-3, "{impulse}");
    }
}

/// Discs in a box, in which walls move; some of the walls share ends.
fn stirred(restitution: f32, settings: WorldSettings) -> World {
    let mut random = Random::new(3);
    let rows: Vec<_> = (0..300)
        .map(|row| {
            let place = [2.4 * (row % 20) as f32, 2.4 * (row / 20) as f32];
            (place, [0, 1].map(|_| random.between(-20.0, 20.0)))
        })
        .collect();
    let container = boxed([-2.0; 2], [50.0; 2]);
    let walls = vec![
        moving([[1.2, 10.0], [20.0, 37.2]], [4.0, -2.0]),
        moving([[20.0, 37.2], [30.0, 40.8]], [4.0, -2.0]),
        moving([[40.8, 10.0], [40.8, 1.2]], [-8.0, 0.0]),
    ];
    let discs = bouncing(discs(&rows, 0.6), restitution);
    walled(discs, walls, WorldSettings { container, ..settings })
}

#[test]
fn methods_threads_snapshots_and_undone_steps_do_not_show() {
    for (restitution, settings) in [(0.6, falling()), (1.0, WorldSettings::default())] {
        let state = |world: &World| (world.state_hash().unwrap(), world.walls().to_vec());
        let mut first = stirred(restitution, settings);
        run(&mut first, 60);
        for threads in [1, 3] {
            for method in [Method::Brute, Method::Quadtree] {
                let mut settings = WorldSettings { method, ..settings };
                settings.tree.threads = Some(threads);
                let mut other = stirred(restitution, settings);
                run(&mut other, 30);
                let mut other = World::restore(&other.snapshot().unwrap()).expect("valid");
                let before = state(&other);
                assert!(other.step(1e30, 1).is_err());
                assert_eq!(state(&other), before);
                run(&mut other, 30);
                assert_eq!(state(&other), state(&first));
            }
        }
    }
}

#[test]
fn an_interrupted_step_moves_no_wall() {
    let mut world = stirred(0.6, falling());
    run(&mut world, 5);
    let state = |world: &World| {
        (world.state_hash().unwrap(), world.walls().to_vec(), world.snapshot().unwrap())
    };
    let before = state(&world);
    // Not at the first poll, which is before the step.
    for polls in 1..9 {
        LEFT.set(polls);
        let poll = || {
            let left = LEFT.get();
            LEFT.set(left.saturating_sub(1));
            left == 0
        };
        let step = watch(poll, || world.step(STEP, 1));
        if step.is_ok() {
            assert!(polls > 3, "hardly anything was polled");
            return;
        }
        assert_eq!(state(&world), before, "{polls}");
    }
}

#[test]
fn a_step_in_which_a_wall_would_go_too_far_is_refused() {
    let walls = vec![moving([[0.0; 2], [1.0, 0.0]], [1e17, 0.0])];
    let mut world = walled(discs(&[], 1.0), walls, WorldSettings::default());
    let error = world.step(20.0, 1).expect_err("too far").to_string();
    assert_eq!(error, "dt is 20; wall 0 would move out of the range ±1e18");
    world.step(1.0, 1).expect("not too far");
    assert_eq!(world.walls()[0].ends[0], [1e17, 0.0]);
}
