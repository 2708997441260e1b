//! The pairs that begin and cease to touch, and the number of collisions.

use std::collections::BTreeSet;

use jostle_base::{Id, Method, Settings};
use jostle_scenes::random::Random;
use jostle_world::{Collisions, Container, OnTouch, Particles, TouchEvents, World, WorldSettings};

use crate::common::worlds::{STEP, bouncing, boxed, discs, still, world_of};

pub type Pairs = BTreeSet<[Id; 2]>;

/// One call of `step` as Python makes it.
fn call(world: &mut World, steps: usize) {
    world.begin_record().unwrap();
    world.step(STEP, steps).expect("a step succeeds");
    world.end_record().expect("few pairs touch");
}

fn events(world: &World) -> TouchEvents {
    let [pairs, _] = world.events().unwrap().expect("they are tracked");
    pairs
}

fn tracked(settings: WorldSettings) -> WorldSettings {
    WorldSettings { track_events: true, ..settings }
}

fn crowd(count: usize, side: f32, seed: u64) -> Particles {
    let mut random = Random::new(seed);
    let mut pair =
        |least: f32, most: f32| [random.between(least, most), random.between(least, most)];
    let positions = (0..count).map(|_| pair(1.0, side - 1.0)).collect();
    let velocities = (0..count).map(|_| pair(-9.0, 9.0)).collect();
    let radii = (0..count).map(|_| pair(0.2, 0.6)[0]).collect();
    let mut all = Particles::new(positions, velocities, radii, 1.0);
    for row in (0..count).step_by(7) {
        all.movable[row] = false;
        all.velocities[row] = if row % 2 == 0 { [0.0; 2] } else { all.velocities[row] };
    }
    all
}

fn settings(on_touch: OnTouch, container: Container, gravity: [f32; 2]) -> WorldSettings {
    tracked(WorldSettings { on_touch, container, gravity, ..WorldSettings::default() })
}

/// Coefficient of restitution of all discs of a world: those that fall lose energy.
fn restitution(settings: &WorldSettings) -> f32 {
    if settings.gravity == [0.0; 2] { 1.0 } else { 0.5 }
}

fn world_with(all: Particles, settings: WorldSettings) -> World {
    world_of(bouncing(all, restitution(&settings)), settings)
}

fn all_settings(side: f32) -> Vec<WorldSettings> {
    let square = boxed([0.0; 2], [side; 2]);
    let torus = Container::Torus { size: [side; 2] };
    let mut all = Vec::new();
    for on_touch in [OnTouch::Bounce, OnTouch::Merge, OnTouch::Ignore] {
        for container in [square, torus] {
            for gravity in [[0.0; 2], [0.0, -9.8]] {
                all.push(settings(on_touch, container, gravity));
            }
        }
    }
    all
}

/// The pairs of ids whose surfaces have at most the gap at which they touch, and those that clearly
/// touch: with at most a share of that gap.
pub fn touching_by_brute_force(world: &World, surely: f64) -> [Pairs; 2] {
    let (all, ids, container) = (
        world.bodies().particles().unwrap(),
        world.bodies().ids().unwrap(),
        world.settings().container,
    );
    let mut found = [Pairs::new(), Pairs::new()];
    let exact =
        |row: usize, k: usize| f64::from(all.positions[row][k]) + f64::from(all.residuals[row][k]);
    for j in 0..all.len() {
        for i in 0..j {
            let [a, b] = [i, j].map(|row| all.filter(row));
            let may = a.category & b.mask != 0 && b.category & a.mask != 0;
            if !may || !all.may_touch(i, j) {
                continue;
            }
            let offset = [0, 1].map(|k| exact(j, k) - exact(i, k));
            let [x, y] = match container {
                Container::Torus { size } => [0, 1].map(|k| {
                    let side = f64::from(size[k]);
                    offset[k] - side * (offset[k] / side).round()
                }),
                _ => offset,
            };
            let reach = f64::from(all.radii[i]) + f64::from(all.radii[j]);
            let size = |row: usize| exact(row, 0).abs() + exact(row, 1).abs() + reach;
            let near = (size(i).max(size(j)) / f64::from(1 << 22)).min(1e-3 * reach);
            let gap = x.hypot(y) - reach;
            if gap <= near * (1.0 + 1e-9) {
                found[0].insert([ids[i], ids[j]]);
            }
            if gap <= near * surely {
                found[1].insert([ids[i], ids[j]]);
            }
        }
    }
    found
}

fn set(pairs: &[[Id; 2]]) -> Pairs {
    assert!(pairs.is_sorted_by(|a, b| a < b), "sorted, without doubles");
    assert!(pairs.iter().all(|[i, j]| i < j));
    pairs.iter().copied().collect()
}

/// What [`follow`] has seen.
#[derive(Default)]
struct Seen {
    entered: usize,
    stayed: usize,
    left: usize,
    both: usize,
}

/// Compares the events of a call with the pairs that touch before it and at its end, and with those
/// of the contacts of each of its steps, which a copy makes. Returns those at the end.
fn follow(world: &mut World, before: &Pairs, steps: usize, seen: &mut Seen) -> Pairs {
    let mut copy = World::restore(&world.snapshot().unwrap()).expect("it was saved");
    let mut during = Pairs::new();
    let bounces = world.settings().on_touch == OnTouch::Bounce;
    for _ in 0..steps {
        copy.step(STEP, 1).expect("a step succeeds");
        if bounces {
            during.extend(copy.contacts().expect("few").iter().map(|touch| touch.pair));
        }
    }
    call(world, steps);
    let TouchEvents { entered, stayed, left, .. } = events(world);
    let [entered, stayed, left] = [entered, stayed, left].map(|pairs| set(&pairs));
    let now: Pairs = entered.difference(&left).chain(&stayed).copied().collect();
    if steps == 0 {
        let lasting = |pair: &&[Id; 2]| pair.iter().all(|&id| world.bodies().contains(id));
        assert_eq!(now, before.iter().filter(lasting).copied().collect());
        return now;
    }
    // Pairs that resting contacts press together may have a larger gap.
    let [near, surely] = touching_by_brute_force(world, 1.0 - 1e-9);
    assert!(surely.is_subset(&now), "missing {:?}", surely.difference(&now).collect::<Vec<_>>());
    let rests = restitution(world.settings()) < 1.0 && bounces;
    assert!(rests || now.is_subset(&near));
    assert_eq!(stayed, before & &now);
    assert!(before.is_disjoint(&entered));
    assert!(now.is_disjoint(&left));
    if bounces {
        assert_eq!(entered, &(&during | &now) - before);
        assert_eq!(left, &(before | &during) - &now);
    } else {
        assert!((&now - before).is_subset(&entered));
        assert!((before - &now).is_subset(&left));
    }
    seen.entered += entered.len();
    seen.stayed += stayed.len();
    seen.left += left.len();
    seen.both += entered.intersection(&left).count();
    now
}

#[test]
fn events_are_those_of_a_model() {
    for (number, settings) in all_settings(12.0).into_iter().enumerate() {
        let mut seen = Seen::default();
        for seed in 0..6 {
            let crowd_of = if seed < 3 { crowd } else { crowd_with_sensors };
            let mut world = world_with(crowd_of(60, 12.0, seed), settings);
            if seed % 2 == 1 {
                let kind = |row: usize| 1 << (row % 3);
                world
                    .edit(|all| {
                        for (row, filter) in all.filters_mut().iter_mut().enumerate() {
                            (filter.category, filter.mask) = (kind(row), 7 ^ kind(row + 1));
                        }
                        Ok(())
                    })
                    .expect("valid");
            }
            let mut random = Random::new(seed);
            // Until many rest on each other, in some of the worlds.
            let mut before =
                follow(&mut world, &Pairs::new(), 100 * (seed as usize % 3), &mut seen);
            for _ in 0..12 {
                let steps = random.between(0.0, 6.0) as usize;
                before = follow(&mut world, &before, steps, &mut seen);
                let ids = world.bodies().ids().unwrap();
                let one = ids[random.between(0.0, ids.len() as f32) as usize];
                world.remove(&[one]).expect("it exists");
                let new = bouncing(crowd(1, 12.0, one as u64), restitution(&settings));
                world.add(new).expect("it fits");
                let row = random.between(0.0, world.len() as f32 - 1.0) as u32;
                world
                    .edit_rows(&[row], |all| {
                        all.positions[0] = [0, 1].map(|_| random.between(1.0, 11.0));
                        Ok(())
                    })
                    .expect("valid");
            }
        }
        let Seen { entered, stayed, left, both } = seen;
        let is_merging = settings.on_touch == OnTouch::Merge;
        let least = if is_merging { 30 } else { 300 };
        assert!(entered > least && left > least, "{number}: {entered} {left}");
        let has_floor = settings.container.has_sides();
        let rests = restitution(&settings) < 1.0 && has_floor;
        let stays = rests || settings.on_touch == OnTouch::Ignore;
        assert!(!stays || is_merging || stayed > 100, "{number}: {stayed}");
        assert!(settings.on_touch != OnTouch::Bounce || both > 100, "{number}: {both}");
    }
}

/// As [`crowd`], with a sensor among every four, some movable and some not.
fn crowd_with_sensors(count: usize, side: f32, seed: u64) -> Particles {
    let mut all = crowd(count, side, seed);
    (0..count).step_by(4).for_each(|row| all.sensors_mut()[row] = true);
    all
}

/// The events and the number of collisions after each of some calls.
fn history(mut world: World, calls: usize) -> Vec<(TouchEvents, Collisions)> {
    let mut all = Vec::new();
    for _ in 0..calls {
        call(&mut world, 3);
        all.push((events(&world), world.record().totals().collisions));
    }
    all
}

#[test]
fn events_depend_neither_on_threads_nor_on_the_method_nor_on_the_order_of_adding() {
    for settings in all_settings(30.0) {
        let all = crowd_with_sensors(400, 30.0, 5);
        let world = |settings| world_with(all.clone(), settings);
        let expected = history(world(settings), 8);
        let tree = |threads| Settings { threads: Some(threads), ..Settings::default() };
        for threads in [1, 2, 5] {
            let other = WorldSettings { tree: tree(threads), ..settings };
            assert_eq!(history(world(other), 8), expected);
        }
        let brute = WorldSettings { method: Method::Brute, ..settings };
        assert_eq!(history(world(brute), 8), expected);
        if settings.on_touch == OnTouch::Merge {
            continue; // The smallest id depends on the order.
        }
        let mut reversed = Particles::default();
        (0..all.len()).rev().for_each(|row| reversed.push(&all, row));
        let renamed = |pairs: &[[Id; 2]]| {
            let last = all.len() as Id - 1;
            let mut pairs: Vec<[Id; 2]> = pairs.iter().map(|[i, j]| [last - j, last - i]).collect();
            pairs.sort_unstable();
            pairs
        };
        for (of, expected) in history(world_with(reversed, settings), 8).iter().zip(&expected) {
            assert_eq!(of.1, expected.1);
            assert_eq!(renamed(&of.0.entered), expected.0.entered);
            assert_eq!(renamed(&of.0.stayed), expected.0.stayed);
            assert_eq!(renamed(&of.0.left), expected.0.left);
        }
    }
}

#[test]
fn tracking_changes_no_bit() {
    for settings in all_settings(30.0) {
        let hash = |settings| {
            let mut world = world_with(crowd(300, 30.0, 3), settings);
            call(&mut world, 30);
            world.state_hash().unwrap()
        };
        assert_eq!(hash(WorldSettings { track_events: false, ..settings }), hash(settings));
    }
}

#[test]
fn many_threads_count_as_one() {
    let run = |threads| {
        let tree = Settings { threads: Some(threads), ..Settings::default() };
        let container = Container::Torus { size: [260.0; 2] };
        let settings = tracked(WorldSettings { tree, container, ..WorldSettings::default() });
        let mut world = world_of(crowd(20_000, 260.0, 1), settings);
        call(&mut world, 3);
        (world.record().totals().collisions, events(&world))
    };
    let expected = run(1);
    assert!(expected.0.pairs > 1000, "{:?}", expected.0);
    assert!(run(2) == expected && run(5) == expected);
}

/// A pile whose islands fall asleep.
fn pile(track_events: bool) -> World {
    let settings = WorldSettings {
        gravity: [0.0, -9.8],
        container: boxed([0.0; 2], [20.0, 40.0]),
        track_events,
        ..WorldSettings::default()
    };
    let mut positions = Vec::new();
    for k in 0..12 {
        let (x, y) = (3.0 + 4.0 * (k % 4) as f32, 1.0 + 2.0 * (k / 4) as f32);
        positions.push([x, y]);
    }
    world_of(bouncing(still(&positions, 1.0), 0.3), settings)
}

#[test]
fn sleeping_pairs_stay_until_something_parts_them() {
    let mut world = pile(true);
    call(&mut world, 1);
    let touching = set(&events(&world).entered);
    assert_eq!(touching.len(), 8);
    for _ in 0..60 {
        call(&mut world, 1);
        let TouchEvents { entered, stayed, left, .. } = events(&world);
        assert!(entered.is_empty() && left.is_empty(), "{entered:?} {left:?}");
        assert_eq!(set(&stayed), touching);
    }
    assert!(world.bodies().asleep().unwrap().iter().all(|&asleep| asleep));
    world
        .edit_rows(&[8], |all| {
            all.velocities[0] = [0.0, 9.0];
            Ok(())
        })
        .expect("valid");
    call(&mut world, 6);
    let TouchEvents { entered, stayed, left, .. } = events(&world);
    assert_eq!((entered, left, stayed.len()), (vec![], vec![[4, 8]], 7));
    world.remove(&[0]).expect("it exists");
    call(&mut world, 0);
    assert_eq!(events(&world).left, [[0, 4]]);
}

#[test]
fn pairs_that_touch_asleep_are_found_when_tracking_begins() {
    let mut world = pile(false);
    call(&mut world, 60);
    assert!(world.bodies().asleep().unwrap().iter().all(|&asleep| asleep));
    assert_eq!(world.events().unwrap(), None);
    world.configure(tracked(*world.settings())).expect("valid");
    assert!(
        world.bodies().asleep().unwrap().iter().all(|&asleep| asleep),
        "tracking wakes nothing"
    );
    call(&mut world, 1);
    assert_eq!(events(&world).entered.len(), 8);
    world.configure(WorldSettings { track_events: false, ..*world.settings() }).expect("valid");
    assert_eq!(world.events().unwrap(), None);
}

#[test]
fn discs_that_only_touch_enter_without_a_collision() {
    let discs = still(&[[0.0; 2], [2.0, 0.0]], 1.0);
    let mut world = world_of(discs, tracked(WorldSettings::default()));
    call(&mut world, 5);
    assert_eq!(
        (events(&world).entered, world.record().totals().collisions.pairs),
        (vec![[0, 1]], 0)
    );
    call(&mut world, 5);
    assert_eq!(events(&world).stayed, [[0, 1]]);
}

#[test]
fn an_undone_step_leaves_no_events_and_no_collisions() {
    // Both bounce; then a number overflows.
    let discs = Particles::new(
        vec![[0.0; 2], [3.0, 0.0], [0.0, 50.0]],
        vec![[1e3, 0.0], [0.0; 2], [1e17, 0.0]],
        vec![1.0; 3],
        1.0,
    );
    let mut world = world_of(discs, tracked(WorldSettings::default()));
    world.begin_record().unwrap();
    assert!(world.step(1e3, 1).is_err());
    world.end_record().expect("few");
    assert_eq!((events(&world), world.record().totals().collisions), Default::default());
}

#[test]
fn a_snapshot_contains_the_record() {
    for settings in all_settings(30.0) {
        let mut world = world_with(crowd(200, 30.0, 2), settings);
        call(&mut world, 4);
        let mut copy = World::restore(&world.snapshot().unwrap()).expect("it was saved");
        assert_eq!(events(&copy), events(&world));
        assert_eq!(copy.record().totals().collisions, world.record().totals().collisions);
        call(&mut world, 4);
        call(&mut copy, 4);
        assert_eq!(events(&copy), events(&world));
    }
}

#[test]
fn collisions_count_pairs_and_walls_of_all_substeps() {
    let container = boxed([-4.0, -1.0], [4.0, 1.0]);
    for substeps in [1, 8] {
        let discs = Particles::new(
            vec![[-3.0, 0.0], [0.0; 2]],
            vec![[1.0, 0.0], [0.0; 2]],
            vec![1.0; 2],
            1.0,
        );
        let settings =
            WorldSettings { container, substeps: Some(substeps), ..WorldSettings::default() };
        let mut world = world_of(discs, settings);
        world.begin_record().unwrap();
        world.step(5.0, 2).expect("a step succeeds");
        assert_eq!(world.record().totals().collisions, Collisions { pairs: 3, walls: 2 });
        world.begin_record().unwrap();
        assert_eq!(world.record().totals().collisions, Collisions::default());
    }
}

/// A paused game begins records and makes no steps. If each kept the one before, dropping them would overflow the stack.
#[test]
fn records_without_steps_keep_nothing() {
    let mut world = world_of(crowd(5, 40.0, 11), tracked(WorldSettings::default()));
    (0..300_000).for_each(|_| world.begin_record().unwrap());
    world.step(0.1, 1).expect("a step succeeds");
    world.end_record().expect("few pairs touch");
}

/// A model of discs that pass through each other: pairs that touch in a flight without events.
fn passing_by_brute_force(before: &Particles, dt: f64, settings: &WorldSettings) -> Pairs {
    const MOMENTS: usize = 4000;
    let mut found = Pairs::new();
    let place = |row: usize, t: f64| {
        let falls = if before.movable[row] { 1.0 } else { 0.0 };
        [0, 1].map(|k| {
            let (p, v) = (before.positions[row][k], before.velocities[row][k]);
            f64::from(p) + (f64::from(v) + 0.5 * falls * f64::from(settings.gravity[k]) * t) * t
        })
    };
    for j in 0..before.len() {
        for i in 0..j {
            let reach = f64::from(before.radii[i]) + f64::from(before.radii[j]);
            let touches = |moment: usize| {
                let t = dt * moment as f64 / MOMENTS as f64;
                let (p, q) = (place(i, t), place(j, t));
                let [x, y] =
                    settings.container.period().exact().minimum_image([q[0] - p[0], q[1] - p[1]]);
                x * x + y * y < reach * reach
            };
            if before.may_touch(i, j) && (0..=MOMENTS).any(touches) {
                found.insert([i as Id, j as Id]);
            }
        }
    }
    found
}

#[test]
fn discs_that_pass_through_each_other_in_a_step_touch() {
    let torus = Container::Torus { size: [40.0; 2] };
    for (container, gravity, on_touch) in [
        (Container::None, [0.0; 2], OnTouch::Ignore),
        (Container::None, [3.0, -200.0], OnTouch::Ignore),
        (Container::None, [3.0, -200.0], OnTouch::Bounce),
        (torus, [0.0; 2], OnTouch::Ignore),
        (torus, [3.0, -200.0], OnTouch::Ignore),
        (torus, [3.0, -200.0], OnTouch::Bounce),
    ] {
        let mut all = crowd(50, 40.0, 11);
        for velocity in &mut all.velocities {
            *velocity = velocity.map(|v| 30.0 * v);
        }
        if on_touch == OnTouch::Bounce {
            (0..50).filter(|row| row % 7 > 0).for_each(|row| all.sensors_mut()[row] = true);
        }
        let base = WorldSettings { on_touch, gravity, container, ..WorldSettings::default() };
        let settings = tracked(base);
        let mut world = world_of(all.clone(), settings);
        world.begin_record().unwrap();
        world.step(0.2, 1).expect("a step succeeds");
        world.end_record().expect("few pairs touch");
        let found = set(&events(&world).entered);
        let model = passing_by_brute_force(&all, 0.2, &settings);
        let missing: Vec<_> = model.difference(&found).collect();
        assert!(missing.is_empty(), "{settings:?}: {missing:?} of {}", model.len());
        // The model misses what is short.
        assert!(found.len() <= model.len() + model.len() / 20 + 2 && model.len() > 15);
        assert_eq!(world.record().totals().collisions.pairs, 0);
    }
}

#[test]
fn sensors_change_no_motion() {
    // The lengths of windows and parts of a step follow from all particles, so bits may differ.
    let container = boxed([0.0; 2], [30.0; 2]);
    let settings = settings(OnTouch::Bounce, container, [0.0; 2]);
    let alone = crowd(40, 30.0, 4);
    let mut both = alone.clone();
    let mut sensors = crowd(40, 30.0, 5);
    sensors.sensors_mut().fill(true);
    both.extend(&sensors);
    let [mut alone, mut both] = [alone, both].map(|all| world_of(all, settings));
    for world in [&mut alone, &mut both] {
        call(world, 60);
    }
    let (expected, found) =
        (alone.bodies().particles().unwrap(), both.bodies().particles().unwrap());
    for (a, b) in expected.positions.iter().zip(&found.positions) {
        assert!((0..2).all(|k| (a[k] - b[k]).abs() < 1e-3), "{a:?} {b:?}");
    }
    assert_eq!(alone.record().totals().collisions.pairs, both.record().totals().collisions.pairs);
    let with_sensor = |pair: &[Id; 2]| pair[1] >= 40;
    let entered = events(&both).entered;
    assert!(entered.iter().filter(|pair| with_sensor(pair)).count() > 30);
    let without: Vec<[Id; 2]> = entered.into_iter().filter(|pair| !with_sensor(pair)).collect();
    assert_eq!(without, events(&alone).entered);
}

#[test]
fn contacts_tell_what_touches_a_sensor() {
    for on_touch in [OnTouch::Bounce, OnTouch::Merge, OnTouch::Ignore] {
        let mut all = Particles::new(
            vec![[0.0; 2], [1.0, 0.0], [30.0, 0.0]],
            vec![[0.0; 2], [0.5, 0.0], [0.0; 2]],
            vec![1.0; 3],
            1.0,
        );
        (all.movable[0], all.sensors_mut()[0]) = (false, true);
        let settings = tracked(WorldSettings { on_touch, ..WorldSettings::default() });
        let mut world = world_of(all, settings);
        call(&mut world, 2);
        let contacts = world.contacts().expect("few");
        assert_eq!(contacts.iter().map(|touch| touch.pair).collect::<Vec<_>>(), [[0, 1]]);
        assert_eq!((contacts[0].normal_impulse, contacts[0].normal), (0.0, [1.0, 0.0]));
        assert_eq!((world.len(), world.bodies().velocities().unwrap()[1]), (3, [0.5, 0.0]));
        assert_eq!(events(&world).entered, [[0, 1]]);
    }
}

#[test]
fn a_sensor_over_a_pile_lets_it_sleep_unless_it_moves() {
    for speed in [0.0, 0.01] {
        let mut world = pile(true);
        let mut sensor = discs(&[([9.0, 3.0], [speed, 0.0])], 4.0);
        (sensor.movable[0], sensor.sensors_mut()[0]) = (false, true);
        let id = world.add(sensor).expect("it fits").start;
        let mut touching = Vec::new();
        for _ in 0..90 {
            call(&mut world, 1);
            let TouchEvents { entered, stayed, left, .. } = events(&world);
            assert!(left.is_empty());
            touching = [entered, stayed].concat();
        }
        assert_eq!(touching.iter().filter(|pair| pair[1] == id).count(), 6);
        let asleep = world.bodies().asleep().unwrap().iter().filter(|&&asleep| asleep).count();
        assert_eq!(asleep, if speed == 0.0 { 12 } else { 6 });
        let copy = World::restore(&world.snapshot().unwrap()).expect("it was saved");
        assert_eq!(
            (copy.bodies().sensors().unwrap(), events(&copy)),
            (world.bodies().sensors().unwrap(), events(&world))
        );
    }
}
