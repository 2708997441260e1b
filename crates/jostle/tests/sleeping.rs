//! Islands that rest fall asleep, and wake when something touches them or changes.

use std::sync::atomic::{AtomicI32, Ordering};

use jostle_base::bytes::{HEAD, checksum};
use jostle_base::{Method, Settings};
use jostle_scenes::random::Random;
use jostle_world::forces::Thermostat;
use jostle_world::{Container, Influence, OnTouch, Particles, Stage, Stats, World, WorldSettings};

use crate::common::worlds::{
    self, STEP, bouncing, boxed, change, gathered, run, surface, with_friction, world_of,
};

/// Polls until an interruption.
static LEFT: AtomicI32 = AtomicI32::new(0);

fn settings() -> WorldSettings {
    WorldSettings {
        gravity: [0.0, -9.8],
        container: boxed([-50.0, 0.0], [50.0, 100.0]),
        ..WorldSettings::default()
    }
}

/// Discs that lose energy, without velocities.
fn still(positions: &[[f32; 2]], radius: f32) -> Particles {
    bouncing(worlds::still(positions, radius), 0.3)
}

fn world(all: Particles) -> World {
    world_of(all, settings())
}

/// A triangle of three discs with friction around `x`, on the floor.
fn triangle(x: f32) -> [[f32; 2]; 3] {
    [[x - 1.0, 1.0], [x + 1.0, 1.0], [x, 1.0 + 3.0f32.sqrt()]]
}

fn triangles(centers: &[f32]) -> World {
    let positions: Vec<[f32; 2]> = centers.iter().flat_map(|&x| triangle(x)).collect();
    world(with_friction(still(&positions, 1.0), 0.6))
}

fn count(world: &World) -> usize {
    world.bodies().asleep().unwrap().iter().filter(|&&asleep| asleep).count()
}

fn sleep(world: &mut World) {
    run(world, 120);
    assert_eq!(
        count(world),
        world.bodies().movable().unwrap().iter().filter(|&&movable| movable).count()
    );
}

/// Settings of a box that is as wide as a heap.
fn narrow() -> WorldSettings {
    let container = boxed([-13.0, 0.0], [13.0, 100.0]);
    WorldSettings { container, ..settings() }
}

/// Discs that have fallen on a heap, with and without friction, and some of them immovable.
fn heap(seed: u64, len: usize, friction: bool) -> Particles {
    let mut random = Random::new(seed);
    let positions = (0..len).map(|at| {
        let (column, row) = (at % 12, at / 12);
        [column as f32 * 2.1 - 12.0 + random.between(0.0, 0.1), 1.0 + row as f32 * 2.1]
    });
    let mut all = still(&positions.collect::<Vec<_>>(), 1.0);
    all.radii.iter_mut().for_each(|radius| *radius = random.between(0.7, 1.0));
    all.movable[3] = false;
    all.movable[20] = false;
    if friction {
        all = with_friction(all, 0.5);
    }
    all
}

#[test]
fn a_pile_falls_asleep_and_stays_as_it_is() {
    let mut world = world_of(heap(1, 60, true), narrow());
    run(&mut world, 600);
    // Single discs may roll for longer.
    for _ in 0..20 {
        if count(&world) < 58 {
            run(&mut world, 60);
        }
    }
    assert_eq!(count(&world), 58, "all but the immovable ones");
    let start = world.time();
    assert_eq!(world.kinetic_energy(), 0.0);
    assert_eq!(world.momentum(), [0.0; 2]);
    let before = (
        world.bodies().particles().unwrap(),
        world.contacts().unwrap(),
        world.wall_contacts().unwrap(),
    );
    let energy = world.potential_energy().unwrap();
    let mut stages = Vec::new();
    world.step_watched(STEP, 500, &mut |stage: Stage, _: &World| stages.push(stage)).unwrap();
    assert_eq!(
        (
            world.bodies().particles().unwrap(),
            world.contacts().unwrap(),
            world.wall_contacts().unwrap()
        ),
        before
    );
    assert!(!before.1.is_empty() && !before.2.is_empty());
    assert_eq!(world.potential_energy().unwrap(), energy);
    assert_eq!(world.stats(), Stats::default());
    assert_eq!(stages, []);
    assert!((world.time() - start - 500.0 * STEP).abs() < 1e-9);
}

#[test]
fn the_contacts_of_a_sleeping_pile_carry_its_weight() {
    let mut world = triangles(&[0.0]);
    sleep(&mut world);
    let floor: f32 = world.wall_contacts().unwrap().iter().map(|touch| touch.normal_impulse).sum();
    let weight = 3.0 * 9.8 * STEP as f32;
    assert!((floor / weight - 1.0).abs() < 0.01, "{floor} {weight}");
    assert!(world.contacts().unwrap().len() >= 2);
}

#[test]
fn half_a_second_of_rest_is_needed() {
    let mut world = triangles(&[0.0]);
    run(&mut world, 29);
    assert_eq!(count(&world), 0);
    run(&mut world, 40);
    assert_eq!(count(&world), 3);
}

#[test]
fn nothing_sleeps_where_nothing_rests() {
    let lone = || still(&[[0.0, 1.0], [9.0, 1.0]], 1.0);
    let none_of = |all: Particles, changed: WorldSettings| {
        let mut world = world_of(all, changed);
        run(&mut world, 120);
        assert_eq!(count(&world), 0, "{changed:?}");
    };
    none_of(bouncing(lone(), 1.0), settings());
    let none = |changed| none_of(lone(), changed);
    none(WorldSettings { gravity: [0.0; 2], ..settings() });
    none(WorldSettings { sleeping: false, ..settings() });
    none(WorldSettings { on_touch: OnTouch::Ignore, ..settings() });
    let mut elastic = lone();
    elastic.restitution = vec![1.0, 0.5];
    let mut mixed = world(elastic);
    run(&mut mixed, 120);
    assert_eq!(mixed.bodies().asleep().unwrap(), [false, true]);
    let thermostat = Influence::Thermostat(Thermostat { speed: 2.0, rate: 0.3 });
    let attractor = jostle_world::forces::Attractor {
        pole: jostle_world::forces::Pole::Point([0.0, 9.0]),
        strength: 1e-9,
        law: jostle_world::forces::Law::Harmonic,
    };
    for (force, expected) in [(thermostat, 2), (Influence::Attractor(attractor), 0)] {
        let mut world = world(lone());
        world.set_forces(vec![force]).unwrap();
        run(&mut world, 120);
        assert_eq!(count(&world), expected);
    }
}

#[test]
fn all_immovable_and_empty_worlds() {
    let mut empty = world_of(Particles::default(), settings());
    run(&mut empty, 100);
    let mut all = still(&triangle(0.0), 1.0);
    all.movable.fill(false);
    let mut fixed = world(all);
    run(&mut fixed, 100);
    assert_eq!(
        (empty.bodies().asleep().unwrap(), fixed.bodies().asleep().unwrap()),
        (vec![], vec![false; 3])
    );
}

#[test]
fn discs_that_topple_do_not_sleep() {
    for (radius, gravity) in [(1.0f32, 9.8f32), (3.0, 980.0), (1000.0, 9.8), (1e-3, 9.8)] {
        for offset in [1e-3, 1e-4] {
            let off = offset * radius;
            let positions = [[0.0, radius], [off, radius + 1.999_999 * radius]];
            let far = 50.0 * radius;
            let container = boxed([-far, 0.0], [far, far]);
            let changed = WorldSettings { gravity: [0.0, -gravity], container, ..settings() };
            let mut world = world_of(still(&positions, radius), changed);
            // The time in which the offset grows e times is about (r/g)^½.
            let steps = (60.0 * 25.0 * (radius / gravity).sqrt()) as usize + 90;
            run(&mut world, steps);
            let fallen = world.bodies().positions().unwrap()[1][1] < 2.0 * radius;
            assert!(
                fallen,
                "{radius} {gravity} {offset}: {:?}",
                world.bodies().positions().unwrap()
            );
        }
    }
}

#[test]
fn a_disc_that_turns_round_in_flight_does_not_sleep() {
    for (radius, gravity, speed) in [(1.0f32, 9.8f32, 4.9f32), (1e4, 9.8, 9.8), (1e6, 0.1, 0.1)] {
        let mut all = still(&[[0.0, 2.0 * radius]], radius);
        all.velocities[0] = [0.0, speed];
        let far = 9.0 * radius;
        let container = boxed([-far, 0.0], [far, far]);
        let changed = WorldSettings { gravity: [0.0, -gravity], container, ..settings() };
        let mut world = world_of(all, changed);
        let top = (speed / gravity * 60.0) as usize;
        for _ in 0..2 * top {
            run(&mut world, 1);
            assert_eq!(count(&world), 0, "{radius} {gravity}");
        }
    }
}

#[test]
fn a_disc_that_falls_slowly_in_a_viscous_medium_does_not_sleep() {
    for drag in [30.0, 300.0, 3e4] {
        let mut world = world_of(still(&[[0.0, 9.0]], 1.0), WorldSettings { drag, ..settings() });
        run(&mut world, 300);
        assert_eq!(count(&world), 0, "{drag}");
        let expected = 9.0 - 9.8 / drag * (5.0 - 1.0 / drag);
        assert!((world.bodies().positions().unwrap()[0][1] - expected).abs() < 1e-2, "{drag}");
    }
}

#[test]
fn a_pile_without_friction_falls_asleep_in_spite_of_its_vibrations() {
    let mut world = jostle_scenes::find("pile").unwrap().create(Some(200), 1).unwrap();
    run(&mut world, 600);
    assert_eq!(count(&world), 200);
}

#[test]
fn a_slow_disc_slides_on_unless_it_is_below_the_limit() {
    for (speed, expected) in [(0.05f32, 0), (0.02, 1)] {
        let mut all = still(&[[0.0, 1.0]], 1.0);
        all.velocities[0] = [speed, 0.0];
        let mut world = world(all);
        run(&mut world, 120);
        assert_eq!(count(&world), expected, "{speed}");
    }
}

#[test]
fn a_disc_that_turns_round_on_a_slope_does_not_sleep() {
    for (radius, gravity, degrees, speed) in
        [(1.0f32, 9.8f32, 1.0f32, 0.5f32), (1.0, 9.8, 0.25, 0.2), (20.0, 900.0, 0.25, 10.0)]
    {
        for friction in [0.0, 0.5] {
            let mut all = with_friction(still(&[[0.0, radius]], radius), friction);
            let rolls = friction > 0.0;
            all.velocities[0] = [-speed, 0.0];
            all.spins_mut()[0].velocity = if rolls { speed / radius } else { 0.0 };
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let far = 500.0 * radius;
            let container = boxed([-far, 0.0], [far, far]);
            let pull = [gravity * sine, -gravity * cosine];
            let changed = WorldSettings { gravity: pull, container, ..settings() };
            let mut world = world_of(all, changed);
            let acceleration = gravity * sine * if rolls { 2.0 / 3.0 } else { 1.0 };
            // Back where it started.
            let seconds = 2.0 * speed / acceleration;
            run(&mut world, (f64::from(seconds) * 60.0).round() as usize);
            let x = world.bodies().positions().unwrap()[0][0];
            assert!(x.abs() < 0.05 * radius, "{radius} {degrees} {friction}: {x}");
            assert_eq!(count(&world), 0);
        }
    }
}

#[test]
fn a_disc_that_spins_without_friction_does_not_sleep() {
    let mut all = still(&[[0.0, 1.0]], 1.0);
    all.spins_mut()[0].velocity = 0.2;
    let mut world = world(all);
    run(&mut world, 300);
    assert_eq!(count(&world), 0);
    assert_eq!(world.bodies().angular_velocities().unwrap(), [0.2]);
}

#[test]
fn a_point_sleeps_if_it_stands_still() {
    let mut points = still(&[[0.0, 0.0], [5.0, 0.0]], 0.0);
    points.masses.fill(1.0);
    points.velocities[1] = [1e-6, 0.0];
    let mut world = world(points);
    run(&mut world, 120);
    assert_eq!(world.bodies().asleep().unwrap(), [true, false]);
}

#[test]
fn a_slow_ball_wakes_the_island_that_it_touches_and_no_other() {
    let mut world = triangles(&[-20.0, 0.0, 20.0]);
    sleep(&mut world);
    let mut ball = still(&[[0.0, 9.0]], 0.5);
    ball.velocities[0] = [0.0, -1.0];
    world.add(ball).unwrap();
    assert_eq!(count(&world), 9, "adding wakes nothing");
    run(&mut world, 40);
    assert_eq!(count(&world), 9, "it is still in the air");
    run(&mut world, 50);
    let asleep = world.bodies().asleep().unwrap();
    assert_eq!(asleep[..9], [true, true, true, false, false, false, true, true, true]);
}

/// A pile that rests with the same bits whether or not it sleeps.
fn lone_discs(sleeping: bool) -> World {
    let positions: Vec<[f32; 2]> = (0..20).map(|at| [4.0 * at as f32 - 38.0, 1.0]).collect();
    let mut world = world_of(still(&positions, 1.0), WorldSettings { sleeping, ..settings() });
    run(&mut world, 120);
    assert_eq!(count(&world), if sleeping { 20 } else { 0 });
    world
}

#[test]
fn nothing_tunnels_through_sleeping_discs() {
    // From 1 to 1,000 radii in a step, along the row of discs.
    for speed in [30.0f32, 300.0, 3_000.0, 30_000.0] {
        let shot = |sleeping: bool| {
            let mut world = lone_discs(sleeping);
            let mut bullet = still(&[[-40.7, 1.2]], 0.5);
            bullet.velocities[0] = [speed, 0.0];
            bullet.masses[0] = 0.3;
            world.add(bullet).unwrap();
            run(&mut world, 3);
            world
        };
        let [asleep, awake] = [true, false].map(shot);
        let [a, b] = [asleep.bodies().velocities().unwrap(), awake.bodies().velocities().unwrap()];
        assert!(
            a.iter().take(20).flatten().any(|v| v.abs() > 0.01 * speed),
            "{speed}: {a:?} {b:?}"
        );
        for (a, b) in a.iter().zip(&b) {
            let difference = (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
            assert!(difference <= 1e-4 * speed, "{speed}: {a:?} {b:?}");
        }
    }
}

#[test]
fn a_ball_deflected_out_of_its_bounds_wakes_what_it_meets() {
    let make = |sleeping: bool| {
        let mut world = lone_discs(sleeping);
        // A light ball at rest in the air, and a heavy fast one that sends it down at twice the
        // speed. Neither reaches the floor by itself.
        let mut balls = still(&[[0.0, 40.0], [-0.1, 60.0]], 1.0);
        balls.masses = vec![1e-3, 1e3];
        balls.velocities = vec![[0.0; 2], [0.0, -1200.0]];
        world.add(balls).unwrap();
        world
    };
    for steps in [1, 2] {
        let run = |sleeping: bool| {
            let mut world = make(sleeping);
            run(&mut world, steps);
            world
        };
        let [asleep, awake] = [true, false].map(run);
        let [a, b] = [asleep.bodies().positions().unwrap(), awake.bodies().positions().unwrap()];
        for (a, b) in a.iter().zip(&b) {
            assert!((a[0] - b[0]).abs() < 1e-2 && (a[1] - b[1]).abs() < 1e-2, "{a:?} {b:?}");
        }
    }
}

#[test]
fn changes_wake() {
    let all = [true; 6];
    let base = || {
        let mut world = triangles(&[-20.0, 20.0]);
        sleep(&mut world);
        world
    };
    let mut world = base();
    change(&mut world, |settings| {
        settings.method = Method::Brute;
        settings.tree = Settings { leaf_capacity: 3, max_depth: 9, threads: Some(2) };
    });
    assert_eq!(world.bodies().asleep().unwrap(), all, "these settings change no result");
    world.edit(|_| Ok(())).unwrap();
    assert_eq!(world.bodies().asleep().unwrap(), all, "nothing changed");
    world
        .edit(|of| {
            of.velocities[4] = [0.0, 1.0];
            Ok(())
        })
        .unwrap();
    assert_eq!(world.bodies().asleep().unwrap(), [true, true, true, false, false, false]);
    assert!(!world.contacts().unwrap().is_empty());
    let changes: [fn(&mut WorldSettings); 6] = [
        |settings| settings.gravity = [0.0, -9.0],
        |settings| settings.drag = 0.1,
        |settings| settings.sides.0[2] = surface(0.2),
        |settings| settings.sleeping = false,
        |settings| settings.on_touch = OnTouch::Ignore,
        |settings| settings.container = Container::None,
    ];
    for of in changes {
        let mut world = base();
        let (contacts, walls) =
            (world.contacts().unwrap().len(), world.wall_contacts().unwrap().len());
        change(&mut world, of);
        assert_eq!(count(&world), 0);
        if world.settings().on_touch == OnTouch::Bounce {
            assert_eq!(world.contacts().unwrap().len(), contacts);
        }
        if world.settings().container != Container::None {
            assert_eq!(world.wall_contacts().unwrap().len(), walls);
        }
        run(&mut world, 10);
        assert_eq!(count(&world), 0);
    }
    let mut world = base();
    let change = |all: &mut Particles| {
        all.restitution.fill(0.2);
        Ok(())
    };
    world.edit(change).unwrap();
    assert_eq!(count(&world), 0);
    let mut world = base();
    world.set_forces(vec![Influence::Thermostat(Thermostat { speed: 1.0, rate: 0.1 })]).unwrap();
    assert_eq!(count(&world), 0);
    let mut world = base();
    let mut wall = still(&[[0.0, 50.0]], 1.0);
    wall.movable[0] = false;
    world.add(wall).unwrap();
    assert_eq!(count(&world), 0);
}

#[test]
fn without_the_floor_a_pile_falls() {
    let mut world = triangles(&[0.0]);
    sleep(&mut world);
    change(&mut world, |settings| settings.container = Container::None);
    run(&mut world, 60);
    assert!(world.bodies().positions().unwrap().iter().all(|position| position[1] < -2.0));
}

#[test]
fn a_disc_falls_when_the_immovable_one_under_it_is_removed_or_moved() {
    let make = || {
        let mut all = still(&[[0.0, 20.0], [0.0, 22.0]], 1.0);
        all.movable[0] = false;
        let mut world = world(with_friction(all, 0.5));
        run(&mut world, 120);
        assert_eq!(world.bodies().asleep().unwrap(), [false, true]);
        assert_eq!(world.contacts().unwrap()[0].pair, [0, 1]);
        world
    };
    let mut removed = make();
    removed.remove(&[0]).unwrap();
    run(&mut removed, 30);
    assert!(removed.bodies().positions().unwrap()[0][1] < 21.5);
    let mut moved = make();
    moved
        .edit(|all| {
            all.positions[0] = [30.0, 20.0];
            Ok(())
        })
        .unwrap();
    run(&mut moved, 30);
    assert!(moved.bodies().positions().unwrap()[1][1] < 21.5);
}

#[test]
fn ids_stay_when_particles_are_removed() {
    let mut world = triangles(&[-20.0, 0.0, 20.0]);
    sleep(&mut world);
    world.add(still(&[[-10.0, 50.0], [10.0, 60.0]], 0.5)).unwrap();
    let before = world.bodies().particles().unwrap();
    world.remove(&[0, 9]).unwrap();
    assert_eq!(
        world.bodies().asleep().unwrap(),
        [false, false, true, true, true, true, true, true, false]
    );
    let rows = [1, 2, 3, 4, 5, 6, 7, 8, 10];
    let row_of = |world: &World, id| world.bodies().rows_of(&[id]).unwrap()[0] as usize;
    assert_eq!(world.bodies().ids().unwrap(), rows.map(|row| row as jostle_base::Id));
    assert_eq!(world.bodies().positions().unwrap(), rows.map(|row| before.positions[row]));
    for touch in world.contacts().unwrap() {
        let [a, b] = touch.pair.map(|id| world.bodies().positions().unwrap()[row_of(&world, id)]);
        let distance = (b[0] - a[0]).hypot(b[1] - a[1]);
        assert!((distance - 2.0).abs() < 0.02, "{touch:?}");
    }
    for touch in world.wall_contacts().unwrap() {
        assert!(world.bodies().positions().unwrap()[row_of(&world, touch.id)][1] < 1.1);
    }
    let kept = World::restore(&world.snapshot().unwrap()).unwrap();
    assert_eq!(kept.snapshot().unwrap(), world.snapshot().unwrap());
    run(&mut world, 300);
    let kept = World::restore(&world.snapshot().unwrap()).unwrap();
    assert_eq!(kept.snapshot().unwrap(), world.snapshot().unwrap());
}

#[test]
fn a_failed_step_leaves_all_asleep() {
    let mut world = triangles(&[-20.0, 20.0]);
    sleep(&mut world);
    let mut ball = still(&[[-20.0, 3.9]], 1.0);
    ball.velocities[0] = [0.0, -1.0];
    ball.masses[0] = 1e30;
    world.add(ball).unwrap();
    let before = (world.snapshot().unwrap(), world.bodies().asleep().unwrap());
    world.step(1e12, 1).expect_err("it is too far");
    assert_eq!((world.snapshot().unwrap(), world.bodies().asleep().unwrap()), before);
    let mut interrupted = 0;
    loop {
        LEFT.store(interrupted, Ordering::Relaxed);
        let poll = || LEFT.fetch_sub(1, Ordering::Relaxed) <= 0;
        let step = || world.step(STEP, 1);
        if jostle_base::interrupt::watch(poll, step).is_ok() {
            break;
        }
        assert_eq!((world.snapshot().unwrap(), world.bodies().asleep().unwrap()), before);
        interrupted += 1;
    }
    assert!(interrupted > 8, "{interrupted}");
    assert_eq!(world.bodies().asleep().unwrap(), [false, false, false, true, true, true, false]);
}

#[test]
fn a_torus_wakes_across_its_seams() {
    let container = Container::Torus { size: [40.0, 40.0] };
    let mut all = still(&[[39.5, 20.0], [39.5, 22.0]], 1.0);
    all.movable[0] = false;
    let mut world = world_of(with_friction(all, 0.5), WorldSettings { container, ..settings() });
    run(&mut world, 120);
    assert_eq!(world.bodies().asleep().unwrap(), [false, true]);
    let mut ball = still(&[[4.0, 22.0]], 0.5);
    ball.velocities[0] = [-12.0, 0.0];
    world.add(ball).unwrap();
    run(&mut world, 30);
    assert_eq!(world.bodies().asleep().unwrap(), [false; 3]);
    assert!(
        world.bodies().velocities().unwrap()[1][0] < -0.5,
        "{:?}",
        world.bodies().velocities().unwrap()
    );
}

/// A long story with sleeping, waking, adding, removing and editing. `observe` may replace the world
/// at any moment.
fn story(all: Particles, start: WorldSettings, observe: &dyn Fn(World) -> World) -> Vec<u64> {
    let mut world = world_of(all, start);
    run(&mut world, 400);
    let mut hashes = Vec::new();
    for chapter in 0..8u32 {
        for _ in 0..18 {
            run(&mut world, 13);
            world = observe(world);
            let asleep = count(&world) as u64;
            hashes.extend([
                world.state_hash().unwrap(),
                asleep,
                world.contacts().unwrap().len() as u64,
            ]);
        }
        let x = 3.0 * chapter as f32 - 15.0;
        match chapter % 5 {
            0 => {
                let mut ball = still(&[[x, 30.0], [x + 2.5, 31.0]], 0.9);
                ball.velocities[0] = [1.0, -200.0 * (chapter % 3) as f32];
                world.add(ball).map(drop)
            }
            1 => world.edit(|all| {
                // By position, so that it does not depend on the order of adding.
                let highest = (0..all.len()).filter(|&row| all.movable[row]);
                let order =
                    |&a: &usize, &b: &usize| all.positions[a][1].total_cmp(&all.positions[b][1]);
                let row = highest.max_by(order).expect("there is one");
                all.velocities[row] = [2.0, 3.0];
                Ok(())
            }),
            3 => {
                let all = world.bodies().particles().unwrap();
                let rows = (0..all.len()).filter(|&row| all.movable[row]);
                let order =
                    |&a: &usize, &b: &usize| all.positions[a][0].total_cmp(&all.positions[b][0]);
                let row = rows.min_by(order).expect("there is one");
                world.remove(&[world.bodies().ids().unwrap()[row]])
            }
            _ => Ok(()),
        }
        .expect("valid");
    }
    hashes
}

#[test]
fn sleeping_does_not_show_how_it_is_computed() {
    for (seed, friction) in [(2, true), (3, false)] {
        let make = || heap(seed, 72, friction);
        let expected = story(make(), narrow(), &|world| world);
        let slept = expected.chunks(3).any(|of| of[1] > 30);
        let woke = expected.chunks(3).zip(expected.chunks(3).skip(1)).any(|(a, b)| a[1] > b[1] + 9);
        assert!(slept && woke, "{:?}", expected.chunks(3).map(|of| of[1]).collect::<Vec<_>>());
        let brute = WorldSettings { method: Method::Brute, ..narrow() };
        assert_eq!(story(make(), brute, &|world| world), expected);
        let tree = Settings { leaf_capacity: 2, max_depth: 40, threads: Some(3) };
        let other = WorldSettings { tree, ..narrow() };
        assert_eq!(story(make(), other, &|world| world), expected);
        let restored = |world: World| {
            let again = World::restore(&world.snapshot().unwrap()).expect("its own snapshot");
            assert_eq!(again.snapshot().unwrap(), world.snapshot().unwrap());
            assert_eq!(again.contacts().unwrap(), world.contacts().unwrap());
            assert_eq!(again.wall_contacts().unwrap(), world.wall_contacts().unwrap());
            assert_eq!(again.bodies().asleep().unwrap(), world.bodies().asleep().unwrap());
            assert_eq!(again.momentum(), world.momentum());
            again
        };
        assert_eq!(story(make(), narrow(), &restored), expected);
    }
}

#[test]
fn changing_a_few_is_changing_all_of_which_a_few_differ() {
    for seed in 0..12 {
        let friction = seed % 3 > 0;
        let mut world = world_of(heap(seed, 40, friction), narrow());
        run(&mut world, if seed % 4 > 0 { 400 } else { 5 });
        let mut random = Random::new(seed);
        let mut rows: Vec<u32> = (0..40).filter(|_| random.whole(0, 9) < 2.0).collect();
        rows.reverse();
        let values: Vec<f32> = rows.iter().map(|_| random.between(-2.0, 2.0)).collect();
        let change = |all: &mut Particles, index: usize, value: f32| match seed % 5 {
            0 => all.velocities[index] = [value, -0.0],
            1 => all.positions[index][1] += 0.1 + value.abs(),
            2 => all.spins_mut()[index].friction = value.abs(),
            3 => all.masses[index] = 1.0, // as it was
            _ => all.movable[index] = value > 1.0,
        };
        let mut other = World::restore(&world.snapshot().unwrap()).unwrap();
        world
            .edit(|all| {
                let pairs = rows.iter().zip(&values);
                pairs.for_each(|(&row, &value)| change(all, row as usize, value));
                Ok(())
            })
            .unwrap();
        other
            .edit_rows(&rows, |some| {
                values.iter().enumerate().for_each(|(index, &value)| change(some, index, value));
                Ok(())
            })
            .unwrap();
        assert_eq!(world.bodies().asleep().unwrap(), other.bodies().asleep().unwrap());
        for _ in 0..3 {
            assert_eq!(world.snapshot().unwrap(), other.snapshot().unwrap(), "seed {seed}");
            run(&mut world, 20);
            run(&mut other, 20);
        }
    }
}

#[test]
fn the_order_of_adding_does_not_change_who_sleeps() {
    let all = heap(5, 72, true);
    let order: Vec<u32> = (0..72u32).map(|row| (row * 31 + 7) % 72).collect();
    let permuted = gathered(&all, &order);
    let (mut a, mut b) = (world_of(all, narrow()), world_of(permuted, narrow()));
    for _ in 0..40 {
        run(&mut a, 13);
        run(&mut b, 13);
        let (p, q) = (a.bodies().particles().unwrap(), b.bodies().particles().unwrap());
        let again = gathered(&p, &order);
        assert!(again == q);
        let asleep: Vec<bool> =
            order.iter().map(|&row| a.bodies().asleep().unwrap()[row as usize]).collect();
        assert_eq!(asleep, b.bodies().asleep().unwrap());
    }
    assert!(count(&a) > 0);
}

#[test]
fn forged_snapshots_are_refused_or_continue() {
    let mut world = triangles(&[-20.0, 20.0]);
    sleep(&mut world);
    world.add(still(&[[0.0, 4.0]], 1.0)).unwrap();
    let bytes = world.snapshot().unwrap();
    let (mut refused, mut continued) = (0, 0);
    for at in HEAD..bytes.len() {
        for value in [0u8, 1, 2, 0x7f, 0xff] {
            let mut forged = bytes.clone();
            if forged[at] == value {
                continue;
            }
            forged[at] = value;
            let sum = checksum(&forged[HEAD..]).to_le_bytes();
            forged[HEAD - 8..HEAD].copy_from_slice(&sum);
            match World::restore(&forged) {
                Err(_) => refused += 1,
                Ok(mut world) => {
                    continued += 1;
                    if at % 3 == 0 {
                        let _ = world.step(STEP, 3);
                        let _ = (
                            world.contacts(),
                            world.wall_contacts().unwrap(),
                            world.snapshot().unwrap(),
                        );
                        let _ = world.remove(&[1]);
                        let _ = world.step(STEP, 2);
                    }
                }
            }
        }
    }
    assert!(refused > 500 && continued > 500, "{refused} {continued}");
}
