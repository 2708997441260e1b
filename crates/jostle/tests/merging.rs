//! What becomes of particles that touch: they merge, or nothing happens.

use jostle_base::{Id, Method};
use jostle_scenes::random::Random;
use jostle_world::forces::{Attractor, Gravitation, Law, Pole, Spring, Springs};
use jostle_world::{Container, Influence, OnTouch, Particles, World, WorldSettings};

use crate::common::worlds::{bouncing, boxed, gathered, run, run_for, world_of};

fn merging() -> WorldSettings {
    WorldSettings { on_touch: OnTouch::Merge, ..WorldSettings::default() }
}

fn row(positions: &[[f32; 2]], velocities: &[[f32; 2]], radius: f32) -> Particles {
    Particles::new(positions.to_vec(), velocities.to_vec(), vec![radius; positions.len()], 1.0)
}

/// A crowd of mixed sizes in which many touch sooner or later.
fn crowd(count: usize, side: f32) -> Particles {
    let mut random = Random::new(5);
    let mut pair = |low: f32, high: f32| [random.between(low, high), random.between(low, high)];
    let positions = (0..count).map(|_| pair(0.0, side)).collect();
    let velocities = (0..count).map(|_| pair(-3.0, 3.0)).collect();
    let radii: Vec<f32> = (0..count).map(|_| pair(0.05, 0.3)[0]).collect();
    let mut all = Particles::new(positions, velocities, radii, 1.0);
    all.masses = (0..count).map(|_| pair(0.1, 9.0)[0]).collect();
    all.restitution = (0..count).map(|_| pair(0.2, 1.0)[0]).collect();
    all
}

/// Mass, momentum, area (over π) and moment of mass, in float64.
fn sums(world: &World) -> [f64; 6] {
    let all = world.bodies().particles().unwrap();
    let mut sums = [0.0; 6];
    for row in 0..all.len() {
        let mass = f64::from(all.masses[row]);
        let [[x, y], [u, v]] =
            [all.positions[row], all.velocities[row]].map(|p| p.map(|k| mass * f64::from(k)));
        let area = f64::from(all.radii[row]) * f64::from(all.radii[row]);
        [mass, u, v, area, x, y].into_iter().zip(&mut sums).for_each(|(own, sum)| *sum += own);
    }
    sums
}

/// What became of each id; nothing is gone.
fn new_ids(world: &World) -> Option<Vec<Id>> {
    let all = world.renumbered().expect("there is memory");
    all.map(|all| all.into_iter().map(|id| id.expect("none is gone")).collect())
}

#[test]
fn mass_momentum_and_area_are_kept_while_a_crowd_merges() {
    for container in [Container::None, Container::Torus { size: [60.0; 2] }] {
        let mut world = world_of(crowd(2000, 60.0), WorldSettings { container, ..merging() });
        let before = sums(&world);
        let mut last = world.len();
        for _ in 0..200 {
            run(&mut world, 1);
            assert!(world.len() <= last);
            last = world.len();
        }
        assert!(last < 1000, "{last} are left in {container:?}");
        let after = sums(&world);
        // Velocities and masses are rounded to 2⁻²⁴ of themselves at every merger.
        let speeds = 2000.0 * 5.0 * 3.0;
        for (k, scale) in [(0, before[0]), (1, speeds), (2, speeds), (3, before[3])] {
            let error = (after[k] - before[k]).abs() / scale;
            assert!(error < 1e-6, "sum {k} is off by {error:e} in {container:?}");
        }
        assert!(world.contacts().unwrap().is_empty());
        assert!(world.bodies().particles().unwrap().validate().is_ok());
    }
}

#[test]
fn the_centre_of_mass_goes_straight_on() {
    let mut world = world_of(crowd(500, 30.0), merging());
    let before = sums(&world);
    run(&mut world, 60);
    let after = sums(&world);
    assert!(world.len() < 400);
    for k in [0, 1] {
        let way = (after[4 + k] - before[4 + k]) / before[0];
        assert!((way - before[1 + k] / before[0]).abs() < 1e-3, "{way}");
    }
}

#[test]
fn two_become_one_as_written() {
    let mut all = row(&[[0.0, 0.0], [1.5, 0.0]], &[[4.0, 0.0], [0.0, 8.0]], 1.0);
    all.masses = vec![1.0, 3.0];
    all.radii = vec![0.75, 1.0];
    all.restitution = vec![0.2, 0.6];
    let mut world = world_of(all, merging());
    run_for(&mut world, 0.25, 1);
    let one = world.bodies().particles().unwrap();
    assert_eq!(one.masses, [4.0]);
    assert_eq!(one.velocities, [[1.0, 6.0]]);
    assert_eq!(one.radii, [1.25]);
    assert_eq!(one.restitution, [0.5]);
    assert_eq!(one.positions, [[(1.0 + 4.5) / 4.0, 6.0 / 4.0]]);
    assert_eq!(new_ids(&world), Some(vec![0, 0]));
}

#[test]
fn touching_is_not_overlapping() {
    let mut world = world_of(row(&[[0.0, 0.0], [2.0, 0.0]], &[[0.0; 2]; 2], 1.0), merging());
    run_for(&mut world, 0.1, 10);
    assert_eq!((world.len(), new_ids(&world)), (2, None));
}

#[test]
fn a_chain_merges_in_one_go_and_what_that_makes_touch_follows() {
    // 1–3–4 touch in a row; 0 is touched by what they become, 2 by nothing.
    let at = [[1.9, 2.1], [0.0, 0.0], [50.0, 0.0], [1.9, 0.0], [3.8, 0.0]];
    let mut world = world_of(row(&at, &[[0.0; 2]; 5], 1.0), merging());
    run_for(&mut world, 1e-3, 1);
    assert_eq!(new_ids(&world), Some(vec![0, 0, 2, 0, 0]));
    assert_eq!(world.bodies().radii().unwrap(), [2.0, 1.0]);
    assert_eq!(world.bodies().positions().unwrap()[1], [50.0, 0.0]);
    world.begin_record().unwrap();
    run_for(&mut world, 1e-3, 1);
    assert_eq!(new_ids(&world), None);
}

#[test]
fn coincident_particles_merge() {
    let mut all = row(&[[3.0, 4.0]; 300], &[[1.0, 0.0]; 300], 0.5);
    all.radii[7] = 0.0; // a point inside others
    let mut world = world_of(all, merging());
    run_for(&mut world, 0.5, 1);
    assert_eq!(world.bodies().positions().unwrap(), [[3.5, 4.0]]);
    assert_eq!(world.bodies().velocities().unwrap(), [[1.0, 0.0]]);
    assert!(world.bodies().particles().unwrap().validate().is_ok());
}

#[test]
fn nothing_is_missed_however_fast() {
    // A hundred radii a sub-step, straight through the other.
    let mut world =
        world_of(row(&[[-200.0, 0.3], [0.0, 0.0]], &[[4e4, 0.0], [0.0; 2]], 0.5), merging());
    run_for(&mut world, 1e-2, 1);
    assert_eq!(world.len(), 1);
    assert_eq!(world.bodies().velocities().unwrap(), [[2e4, 0.0]]);
}

#[test]
fn on_a_torus_the_minimum_image_is_used() {
    let container = Container::Torus { size: [10.0, 8.0] };
    let all = row(&[[0.25, 4.0], [9.25, 4.0]], &[[0.0; 2]; 2], 0.75);
    let mut world = world_of(all, WorldSettings { container, ..merging() });
    run_for(&mut world, 0.1, 1);
    assert_eq!(world.bodies().positions().unwrap(), [[9.75, 4.0]]);
}

#[test]
fn what_cannot_be_moved_stays_and_holds() {
    let mut all = row(&[[0.0, 0.0], [1.5, 0.0], [9.0, 0.0]], &[[0.0; 2]; 3], 1.0);
    all.velocities[2] = [-100.0, 0.0];
    all.movable[1] = false;
    let mut world = world_of(all, merging());
    run_for(&mut world, 0.1, 2);
    let one = world.bodies().particles().unwrap();
    assert_eq!((one.positions, one.velocities), (vec![[1.5, 0.0]], vec![[0.0; 2]]));
    assert_eq!((one.masses, one.movable), (vec![3.0], vec![false]));
}

#[test]
fn what_would_not_fit_as_one_stays_apart() {
    let container = Container::Torus { size: [10.0; 2] };
    let all = row(&[[1.0, 1.0], [2.0, 1.0]], &[[0.0; 2]; 2], 2.0);
    let mut world = world_of(all, WorldSettings { container, ..merging() });
    run_for(&mut world, 0.1, 3);
    assert_eq!(world.len(), 2);
    assert_eq!(world.contacts().unwrap().len(), 1);
    assert_eq!(world.bodies().positions().unwrap(), [[1.0, 1.0], [2.0, 1.0]]);
}

#[test]
fn what_grows_at_a_wall_stays_inside() {
    let container = boxed([0.0; 2], [20.0; 2]);
    let all = row(&[[1.0, 1.0], [1.0, 2.5]], &[[0.0; 2]; 2], 1.0);
    let mut world = world_of(all, WorldSettings { container, ..merging() });
    run_for(&mut world, 0.1, 1);
    let ([x, _], radius) =
        (world.bodies().positions().unwrap()[0], world.bodies().radii().unwrap()[0]);
    assert!(x >= radius, "{x} {radius}");
}

#[test]
fn forces_follow_what_their_particles_become() {
    let at = [[0.0, 0.0], [9.0, 0.0], [1.5, 0.0], [20.0, 0.0]];
    let mut world = world_of(row(&at, &[[0.0; 2]; 4], 1.0), merging());
    let tie = |pair| Spring {
        pair,
        length: 8.0,
        stiffness: 0.0,
        damping: 0.0,
        max_stretch: f32::INFINITY,
    };
    let pull = |row| {
        let pole = Pole::Particle(row);
        Influence::Attractor(Attractor { pole, strength: 0.0, law: Law::Harmonic })
    };
    let ties = |pairs: &[[Id; 2]]| {
        Influence::Springs(Springs(pairs.iter().map(|&pair| tie(pair)).collect()))
    };
    world.set_forces(vec![pull(2), pull(3), ties(&[[0, 2], [2, 3], [1, 3]])]).expect("valid");
    run_for(&mut world, 1e-3, 1);
    assert_eq!(new_ids(&world), Some(vec![0, 1, 0, 3]));
    assert_eq!(world.forces().unwrap(), [pull(0), pull(3), ties(&[[0, 3], [1, 3]])]);
    run_for(&mut world, 1e-3, 5);
}

#[test]
fn account_of_merging_is_kept_over_several_steps() {
    let mut world = world_of(crowd(400, 20.0), merging());
    let all = world.bodies().particles().unwrap();
    let marks = |world: &World| {
        world.bodies().masses().unwrap().iter().map(|&m| f64::from(m)).collect::<Vec<_>>()
    };
    run(&mut world, 50);
    let map = new_ids(&world).expect("some merged");
    assert_eq!(map.len(), 400);
    let mut expected = vec![0.0; world.len()];
    for (row, &new) in map.iter().enumerate() {
        expected[world.bodies().rows_of(&[new]).unwrap()[0] as usize] += f64::from(all.masses[row]);
    }
    for (found, expected) in marks(&world).iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
    }
    // The first of a group gives its id.
    for (id, &new) in map.iter().enumerate() {
        assert!(new as usize <= id && map[new as usize] == new);
    }
    let mut left = map.clone();
    left.sort_unstable();
    left.dedup();
    assert_eq!(world.bodies().ids().unwrap(), left);
    let added = world.add(row(&[[500.0; 2]], &[[0.0; 2]], 1.0)).expect("valid");
    assert_eq!(added, 400..401);
    assert_eq!(new_ids(&world), Some([map, vec![400]].concat()));
}

#[test]
fn removing_changes_no_id() {
    let at = [[0.0; 2], [9.0, 0.0], [18.0, 0.0], [10.5, 0.0]];
    let mut world = world_of(row(&at, &[[0.0; 2]; 4], 1.0), merging());
    world.remove(&[2]).expect("it is there");
    assert_eq!((world.bodies().ids().unwrap(), world.renumbered().unwrap()), (vec![0, 1, 3], None));
    run_for(&mut world, 0.1, 1);
    let merged = vec![Some(0), Some(1), None, Some(1)];
    assert_eq!(
        (world.bodies().ids().unwrap(), world.renumbered().unwrap()),
        (vec![0, 1], Some(merged))
    );
    let error = world.remove(&[3]).expect_err("it is part of another").to_string();
    assert!(error.starts_with("ids[0] is 3; no particle has this id any more"), "{error}");
    world.remove(&[1]).expect("it is there");
    let merged = vec![Some(0), None, None, None];
    assert_eq!(
        (world.bodies().ids().unwrap(), world.renumbered().unwrap()),
        (vec![0], Some(merged))
    );
    world.remove(&[]).expect("nothing to do");
    world.remove(&[0]).expect("it is there");
    assert!(world.is_empty() && world.bodies().ids().unwrap().is_empty());
    assert_eq!(world.add(row(&[[0.0; 2]], &[[0.0; 2]], 1.0)).expect("valid"), 4..5);
}

// ---- the same bits -------------------------------------------------------------------------------

fn star_settings(threads: Option<usize>, method: Method) -> WorldSettings {
    let mut settings =
        WorldSettings { container: Container::Torus { size: [70.0; 2] }, method, ..merging() };
    settings.tree.threads = threads;
    settings
}

fn stars(all: Particles, threads: Option<usize>, method: Method) -> World {
    let mut world = world_of(all, star_settings(threads, method));
    let pull = Gravitation { g: 0.05, softening: 0.05, theta: 0.5 };
    world.set_forces(vec![Influence::Gravitation(pull)]).expect("valid");
    world
}

#[test]
fn threads_and_methods_do_not_show() {
    let end = |count, threads, method| {
        let mut world = stars(crowd(count, 70.0), threads, method);
        run(&mut world, 5);
        (world.state_hash().unwrap(), world.contacts().unwrap(), new_ids(&world))
    };
    let one = end(13_000, Some(1), Method::Quadtree);
    assert_eq!(one, end(13_000, Some(2), Method::Quadtree));
    let one = end(1500, Some(1), Method::Quadtree);
    assert_eq!(one, end(1500, Some(3), Method::Brute));
}

#[test]
fn the_order_of_adding_moves_slots_and_nothing_else() {
    let all = crowd(1500, 70.0);
    let mut order: Vec<u32> = (0..1500).collect();
    let mut random = Random::new(12);
    (1..1500).rev().for_each(|last| order.swap(last, random.whole(0, last as u32) as usize));
    let shuffled = gathered(&all, &order);
    let [mut first, mut second] = [all, shuffled].map(|all| stars(all, Some(1), Method::Quadtree));
    run(&mut first, 40);
    run(&mut second, 40);
    assert!(first.len() < 1200);
    assert_eq!(first.len(), second.len());
    // Where each of the second stands in the first, by way of the rows they began in.
    let (map, other) = (new_ids(&first).unwrap(), new_ids(&second).unwrap());
    let rows = |world: &World, ids: &[Id]| -> Vec<u32> {
        ids.iter().map(|&id| world.bodies().rows_of(&[id]).unwrap()[0]).collect()
    };
    let (map, other) = (rows(&first, &map), rows(&second, &other));
    let mut back = vec![0; first.len()];
    order.iter().zip(other).for_each(|(&row, new)| back[map[row as usize] as usize] = new);
    let permuted = gathered(&second.bodies().particles().unwrap(), &back);
    assert!(permuted == first.bodies().particles().unwrap());
    assert_eq!(first.momentum(), second.momentum());
}

// ---- ignore --------------------------------------------------------------------------------------

#[test]
fn ghosts_pass_through_each_other_and_not_through_walls() {
    let container = boxed([0.0; 2], [10.0; 2]);
    let settings =
        WorldSettings { on_touch: OnTouch::Ignore, container, ..WorldSettings::default() };
    let mut world =
        world_of(row(&[[2.0, 5.0], [8.0, 5.0]], &[[1.0, 0.0], [-1.0, 0.0]], 1.0), settings);
    run_for(&mut world, 0.1, 25);
    let touches = world.contacts().unwrap();
    assert_eq!(touches.len(), 1);
    assert_eq!((touches[0].pair, touches[0].normal), ([0, 1], [1.0, 0.0]));
    assert!((touches[0].depth - 1.0).abs() < 1e-4, "{touches:?}");
    assert_eq!(world.stats().tests, 0);
    run_for(&mut world, 0.1, 25);
    let at = world.bodies().positions().unwrap();
    assert!((at[0][0] - 7.0).abs() < 1e-4 && (at[1][0] - 3.0).abs() < 1e-4, "{at:?}");
    assert!(world.contacts().unwrap().is_empty());
    run_for(&mut world, 0.1, 40); // two on to the wall, two back
    assert_eq!(world.bodies().velocities().unwrap(), [[-1.0, 0.0], [1.0, 0.0]]);
    assert_eq!(world.len(), 2);
}

#[test]
fn ghosts_rest_on_the_floor() {
    let settings = WorldSettings {
        on_touch: OnTouch::Ignore,
        container: boxed([0.0; 2], [10.0; 2]),
        gravity: [0.0, 10.0],
        ..WorldSettings::default()
    };
    let all = bouncing(row(&[[5.0, 5.0], [5.2, 2.0]], &[[0.0; 2]; 2], 1.0), 0.3);
    let mut world = world_of(all, settings);
    run(&mut world, 600);
    assert!(
        world.bodies().positions().unwrap().iter().all(|p| (p[1] - 9.0).abs() < 1e-3),
        "{:?}",
        world.bodies().positions().unwrap()
    );
    assert!(world.kinetic_energy() < 1e-6);
}

#[test]
fn any_number_of_ghosts_may_overlap() {
    let all = row(&[[1.0, 1.0]; 20_000], &[[1.0, 0.0]; 20_000], 1.0);
    let settings = WorldSettings { on_touch: OnTouch::Ignore, ..WorldSettings::default() };
    let mut world = world_of(all, settings);
    run_for(&mut world, 0.1, 1); // two hundred million pairs, and none is looked for
    let error = world.contacts().unwrap_err().to_string();
    assert!(error.starts_with("more than 33554432 pairs of particles may touch"), "{error}");
}

#[test]
fn the_rule_may_change_between_steps() {
    let mut world = world_of(crowd(500, 12.0), WorldSettings::default());
    for on_touch in [OnTouch::Ignore, OnTouch::Bounce, OnTouch::Merge, OnTouch::Bounce] {
        run_for(&mut world, 0.01, 3);
        world.configure(WorldSettings { on_touch, ..*world.settings() }).expect("valid");
        world.contacts().unwrap();
    }
    run_for(&mut world, 0.01, 3);
    assert!(world.len() < 500);
}
