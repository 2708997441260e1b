//! Categories and masks of the particles of a world.

use jostle_base::bytes::{HEAD, checksum};
use jostle_base::{Method, Settings};
use jostle_index::{Filter, pairs};
use jostle_scenes::random::Random;
use jostle_world::{Container, OnTouch, Particles, Touch, Wall, World, WorldSettings};

use crate::common::worlds::{
    bouncing, boxed, discs, gathered, run, shuffled, still, walled, world_of,
};

const ROCK: Filter = Filter { category: 1, mask: 1 };
const GHOST: Filter = Filter { category: 2, mask: 2 };

/// Particles that all have one filter.
fn of_kind(mut all: Particles, filter: Filter) -> Particles {
    all.filters_mut().fill(filter);
    all
}

fn may_touch(a: Filter, b: Filter) -> bool {
    a.category & b.mask != 0 && b.category & a.mask != 0
}

/// Discs of many sizes at random places, between two points at opposite corners, so that the grid
/// of the tree is the same for every seed.
fn crowd(count: usize, side: f32, speed: f32, seed: u64) -> Particles {
    let mut random = Random::new(seed);
    let mut pair =
        |least: f32, most: f32| [random.between(least, most), random.between(least, most)];
    let mut positions: Vec<[f32; 2]> = (0..count).map(|_| pair(1.0, side - 1.0)).collect();
    let velocities = (0..count + 2).map(|_| pair(-speed, speed)).collect();
    let radii = (0..count + 2).map(|_| pair(0.25, 0.4)[0]).collect();
    positions.extend([[0.0; 2], [side * 0.999_9; 2]]);
    let mut all = Particles::new(positions, velocities, radii, 1.0);
    for corner in [count, count + 1] {
        all.movable[corner] = false;
        (all.radii[corner], all.velocities[corner]) = (0.0, [0.0; 2]);
    }
    all
}

fn containers(side: f32) -> [Container; 4] {
    let half = 0.5 * side;
    [
        Container::None,
        boxed([0.0; 2], [side; 2]),
        Container::Circle { center: [half; 2], radius: 1.5 * half },
        Container::Torus { size: [side; 2] },
    ]
}

/// A world of two kinds that ignore each other, and one of each kind alone.
fn together_and_alone(kinds: [Particles; 2], settings: WorldSettings) -> (World, [World; 2]) {
    let alone = kinds.clone().map(|kind| world_of(kind, settings));
    let [rocks, ghosts] = kinds;
    let mut both = of_kind(rocks, ROCK);
    both.extend(&of_kind(ghosts, GHOST));
    (world_of(both, settings), alone)
}

/// Positions, residuals, velocities and rotations of some rows.
fn motion(world: &World, first: usize, len: usize) -> String {
    let Particles { positions, residuals, velocities, spins, .. } =
        world.bodies().particles().unwrap();
    let rows = first..first + len;
    let spins = spins.get(rows.clone());
    format!(
        "{:?} {:?} {:?} {spins:?}",
        &positions[rows.clone()],
        &residuals[rows.clone()],
        &velocities[rows]
    )
}

/// Pairs of rows that overlap, whatever their filters.
fn overlaps(all: &Particles) -> Vec<[usize; 2]> {
    let near = |&[i, j]: &[usize; 2]| {
        let [x, y] = [0, 1].map(|k| all.positions[i][k] - all.positions[j][k]);
        let reach = all.radii[i] + all.radii[j];
        x * x + y * y < reach * reach
    };
    let pairs = (0..all.len()).flat_map(|j| (0..j).map(move |i| [i, j]));
    pairs.filter(near).collect()
}

/// Steps two kinds together and alone, and compares their bits. Returns the numbers of contacts of
/// both kinds alone, and of overlaps of one with the other.
fn compare(kinds: [Particles; 2], settings: WorldSettings, name: &str) -> [usize; 3] {
    let (mut both, mut alone) = together_and_alone(kinds, settings);
    let mut found = [0; 3];
    for step in 0..150 {
        run(&mut both, 1);
        let mut first = 0;
        for (kind, world) in alone.iter_mut().enumerate() {
            run(world, 1);
            let same = motion(&both, first, world.len()) == motion(world, 0, world.len());
            assert!(same, "{name}, {:?}: kind {kind}, step {step}", settings.container);
            found[kind] += world.contacts().unwrap().len();
            first += world.len();
        }
        let pairs = overlaps(&both.bodies().particles().unwrap());
        let half = alone[0].len();
        found[2] += pairs.iter().filter(|[i, j]| *i < half && *j >= half).count();
    }
    found
}

#[test]
fn kinds_that_ignore_each_other_move_as_if_alone() {
    for container in containers(8.0) {
        for gravity in [[0.0, 0.0], [0.0, 5.0]] {
            // Few enough for one window: its end depends on the number of impacts.
            let kinds = [1, 2].map(|seed| {
                let mut all = crowd(20, 8.0, 2.0, seed);
                all.spins_mut().iter_mut().for_each(|spin| spin.friction = 0.5);
                all
            });
            let settings = WorldSettings { gravity, container, ..WorldSettings::default() };
            let found = compare(kinds, settings, "a gas");
            assert!(found.iter().all(|&count| count > 20), "{found:?}");
        }
    }
}

#[test]
fn a_pile_does_not_feel_its_copy() {
    // A copy has the same mean speed, on which the candidate pairs depend, and thus the order in
    // which contacts are solved.
    // On a torus, where discs fall forever, a step is divided into more parts in a dense world.
    for &container in &containers(10.0)[..3] {
        let mut all = bouncing(crowd(90, 10.0, 2.0, 3), 0.4);
        all.spins_mut().iter_mut().for_each(|spin| spin.friction = 0.5);
        let gravity = [0.5, 9.0];
        let settings = WorldSettings { gravity, container, ..WorldSettings::default() };
        let found = compare([all.clone(), all], settings, "a pile");
        assert!(found.iter().all(|&count| count > 200), "{found:?}");
    }
}

/// Particles of which each may touch some of the others.
fn mixed(count: usize, side: f32, seed: u64) -> Particles {
    let mut all = crowd(count, side, 4.0, seed);
    let mut random = Random::new(seed + 1);
    for filter in all.filters_mut() {
        let [category, mask] = [0, 1].map(|_| random.whole(0, 7) as u32);
        *filter = Filter { category, mask };
    }
    all.filters[0] = Filter::default();
    all
}

#[test]
fn only_pairs_that_may_touch_do() {
    for container in containers(20.0) {
        let settings = WorldSettings { gravity: [0.0, 5.0], container, ..Default::default() };
        let mut world = world_of(bouncing(mixed(300, 20.0, 3), 0.5), settings);
        let mut found = 0;
        for _ in 0..100 {
            run(&mut world, 1);
            let filters = world.bodies().filters().unwrap();
            for Touch { pair, .. } in world.contacts().unwrap() {
                let [a, b] = pair.map(|row| filters[row as usize]);
                assert!(may_touch(a, b), "{a:?} {b:?}");
                found += 1;
            }
        }
        assert!(found > 100, "{container:?}: {found}");
    }
}

#[test]
fn walls_stop_particles_that_touch_no_others() {
    // Particles have the category 1 and touch only 2, that of the walls.
    let (particles, of_walls) = (Filter { category: 1, mask: 2 }, Filter { category: 2, mask: 1 });
    for method in [Method::Quadtree, Method::Brute] {
        let container = boxed([0.0; 2], [20.0; 2]);
        let settings = WorldSettings { container, method, ..WorldSettings::default() };
        let walls = [-1.0f32, 1.0]
            .map(|slope| Wall::new([[0.0, 10.0 - 10.0 * slope], [20.0, 10.0 + 10.0 * slope]]));
        let mut expected = walled(crowd(200, 20.0, 9.0, 5), walls.to_vec(), settings);
        let mut on = WorldSettings { on_touch: OnTouch::Ignore, ..settings };
        expected.configure(on).unwrap();
        run(&mut expected, 100);
        on.on_touch = OnTouch::Bounce;
        let walls = walls.map(|wall| Wall { filter: of_walls, ..wall });
        let mut world = walled(of_kind(crowd(200, 20.0, 9.0, 5), particles), walls.to_vec(), on);
        run(&mut world, 100);
        assert_eq!(motion(&world, 0, 202), motion(&expected, 0, 202), "{method:?}");
    }
}

#[test]
fn overlaps_are_those_of_brute_force() {
    let all = mixed(300, 12.0, 5);
    let expected: Vec<[u32; 2]> = overlaps(&all)
        .into_iter()
        .filter(|&[i, j]| may_touch(all.filter(i), all.filter(j)))
        .filter(|&[i, j]| all.movable[i] || all.movable[j])
        .map(|pair| pair.map(|row| row as u32))
        .collect();
    for method in [Method::Quadtree, Method::Brute] {
        let settings = WorldSettings { on_touch: OnTouch::Ignore, method, ..Default::default() };
        let world = world_of(all.clone(), settings);
        let contacts = world.contacts().unwrap();
        let mut found: Vec<[u32; 2]> =
            contacts.iter().map(|touch| touch.pair.map(|id| id as u32)).collect();
        found.sort_unstable_by_key(|&[i, j]| [j, i]);
        assert_eq!(found, expected);
    }
    assert!(expected.len() > 50);
    let world = world_of(all, WorldSettings::default());
    let found = pairs::within(world.tree().unwrap(), None, 1 << 20).unwrap();
    assert_eq!(found.pairs.len(), expected.len(), "the tree of a world carries them");
}

#[test]
fn filters_do_not_show_how_pairs_are_found() {
    for on_touch in [OnTouch::Bounce, OnTouch::Merge] {
        for container in containers(20.0) {
            let tree = Settings { threads: Some(1), ..Settings::default() };
            let base = WorldSettings { container, on_touch, tree, ..Default::default() };
            let settings = WorldSettings { gravity: [0.0, 5.0], ..base };
            let all = bouncing(mixed(300, 20.0, 4), 0.5);
            let mut expected = world_of(all.clone(), settings);
            run(&mut expected, 60);
            let brute = WorldSettings { method: Method::Brute, ..settings };
            let mut other = world_of(all.clone(), brute);
            run(&mut other, 60);
            let same =
                other.bodies().particles().unwrap() == expected.bodies().particles().unwrap();
            assert!(same, "{on_touch:?} {container:?}: brute force");
            let mut half = world_of(all.clone(), settings);
            run(&mut half, 30);
            let mut half = World::restore(&half.snapshot().unwrap()).unwrap();
            run(&mut half, 30);
            assert!(
                half.bodies().particles().unwrap() == expected.bodies().particles().unwrap(),
                "{on_touch:?}: a snapshot"
            );
            assert_eq!(half.snapshot().unwrap(), expected.snapshot().unwrap());
            let order = shuffled(all.len(), 9);
            let particles = gathered(&all, &order);
            let mut other = world_of(particles, settings);
            run(&mut other, 60);
            if on_touch == OnTouch::Bounce {
                let permuted = gathered(&expected.bodies().particles().unwrap(), &order);
                assert!(
                    other.bodies().particles().unwrap() == permuted,
                    "{container:?}: the order of adding"
                );
            } else {
                // Where particles merge, rows close up.
                assert!(other.len() == expected.len() && other.len() < all.len());
                assert_eq!(other.momentum(), expected.momentum());
            }
        }
    }
}

#[test]
fn threads_do_not_show_in_filters() {
    let hashes = [1, 2, 8].map(|threads| {
        let tree = Settings { threads: Some(threads), ..Settings::default() };
        let container = boxed([0.0; 2], [160.0; 2]);
        let settings = WorldSettings { gravity: [0.0, 9.0], container, tree, ..Default::default() };
        let mut world = world_of(bouncing(mixed(30_000, 160.0, 6), 0.5), settings);
        run(&mut world, 3);
        (world.state_hash().unwrap(), world.contacts().unwrap())
    });
    assert!(hashes.iter().all(|hash| *hash == hashes[0]));
}

#[test]
fn coincident_particles_are_ordered_by_their_filters() {
    let filters = [GHOST, ROCK, Filter { category: 3, mask: 3 }, Filter::default()];
    let world = |order: [usize; 4]| {
        let mut all = still(&[[0.0; 2]; 4], 1.0);
        all.filters = order.map(|at| filters[at]).to_vec();
        let mut world = world_of(all, WorldSettings::default());
        run(&mut world, 20);
        let mut all: Vec<_> = world
            .bodies()
            .filters()
            .unwrap()
            .into_iter()
            .zip(world.bodies().positions().unwrap())
            .collect();
        all.sort_by_key(|&(filter, _)| filter);
        all
    };
    let expected = world([0, 1, 2, 3]);
    assert!(expected.iter().any(|(_, position)| *position != [0.0; 2]));
    assert_eq!(world([3, 1, 0, 2]), expected);
    assert_eq!(world([2, 3, 1, 0]), expected);
}

#[test]
fn without_filters_nothing_is_stored() {
    let bytes = |all: Particles| world_of(all, WorldSettings::default()).snapshot().unwrap();
    let mut all = crowd(50, 9.0, 1.0, 2);
    let plain = bytes(all.clone());
    all.filters_mut();
    assert_eq!(bytes(all.clone()), plain, "defaults are not stored");
    all.filters_mut()[7].mask = 5;
    let mut world = world_of(all, WorldSettings::default());
    assert_eq!(world.bodies().particles().unwrap().filters.len(), 52);
    assert_ne!(world.state_hash().unwrap(), World::restore(&plain).unwrap().state_hash().unwrap());
    world.remove(&[7]).unwrap();
    assert!(world.bodies().particles().unwrap().filters.is_empty());
}

/// Discs on a floor: rocks at the same places as ghosts.
fn resting() -> World {
    let rows = [-2.0, 0.0, 2.0].map(|x| [x, 1.0]);
    let discs = bouncing(still(&rows, 1.0), 0.3);
    let mut all = of_kind(discs.clone(), ROCK);
    all.extend(&of_kind(discs, GHOST));
    let container = boxed([-20.0, 0.0], [20.0, 50.0]);
    let settings = WorldSettings { gravity: [0.0, -9.8], container, ..Default::default() };
    let mut world = world_of(all, settings);
    run(&mut world, 90);
    assert_eq!(world.bodies().asleep().unwrap(), [true; 6]);
    world
}

#[test]
fn sleeping_particles_wake_only_for_what_they_may_touch() {
    let mut world = resting();
    let mut ball = bouncing(discs(&[([-10.0, 1.0], [6.0, 0.0])], 1.0), 0.3);
    ball.filters = vec![GHOST];
    world.add(ball.clone()).unwrap();
    let mut half = World::restore(&world.snapshot().unwrap()).unwrap();
    run(&mut world, 120);
    let asleep = world.bodies().asleep().unwrap();
    assert_eq!(asleep[..3], [true; 3], "rocks");
    assert!(!asleep[4], "a ghost that was hit");
    assert_eq!(
        world.bodies().positions().unwrap()[..3],
        resting().bodies().positions().unwrap()[..3]
    );
    run(&mut half, 120);
    assert_eq!(half.state_hash().unwrap(), world.state_hash().unwrap());
    // A ball of both kinds wakes both.
    ball.filters = vec![Filter { category: 3, mask: 3 }];
    let mut world = resting();
    world.add(ball.clone()).unwrap();
    run(&mut world, 120);
    assert!(
        world.bodies().positions().unwrap()[..6]
            .iter()
            .all(|[x, _]| !(-2.0..=2.0).contains(x) || *x != x.round())
    );
    // One that leaves its bounds, because it is hit during the step.
    ball.filters = vec![ROCK];
    ball.positions = vec![[-8.0, 1.0]];
    ball.velocities = vec![[0.0; 2]];
    let mut shot = Particles::new(vec![[-19.0, 1.0]], vec![[500.0, 0.0]], vec![1.0], 20.0);
    (shot.filters, shot.restitution) = (vec![ROCK], vec![0.3]);
    let mut world = resting();
    world.add(ball).unwrap();
    world.add(shot).unwrap();
    run(&mut world, 3);
    assert_eq!(world.bodies().asleep().unwrap()[3..6], [true; 3], "ghosts");
    assert!(
        world.bodies().positions().unwrap()[2][0] > 3.0,
        "a rock was hit: {:?}",
        world.bodies().positions().unwrap()
    );
}

#[test]
fn changed_filters_wake_and_count() {
    let mut world = resting();
    let set = |world: &mut World, row: usize, filter| {
        let change = |all: &mut Particles| {
            all.filters_mut()[row] = filter;
            Ok(())
        };
        world.edit(change).unwrap();
    };
    set(&mut world, 0, GHOST);
    let asleep = world.bodies().asleep().unwrap();
    assert!(!asleep[0] && asleep[3..] == [true; 3]);
    // The rock is a ghost now, in the place of another.
    run(&mut world, 30);
    let [a, b] = [world.bodies().positions().unwrap()[0], world.bodies().positions().unwrap()[3]];
    let [x, y] = [0, 1].map(|k| b[k] - a[k]);
    assert!(x.hypot(y) > 1.9, "{a:?} {b:?}");
}

#[test]
fn merging_follows_filters() {
    let positions = vec![[0.0, 0.0], [1.0, 0.0], [1.8, 0.0], [2.8, 0.0]];
    let mut all = still(&positions, 1.0);
    let both = Filter { category: 4, mask: 1 };
    all.filters = vec![ROCK, GHOST, Filter { category: 1, mask: 5 }, both];
    let settings = WorldSettings { on_touch: OnTouch::Merge, ..WorldSettings::default() };
    let mut world = world_of(all, settings);
    run(&mut world, 1);
    // The last two merge; what they are together touches the first.
    assert_eq!(world.bodies().filters().unwrap(), [Filter { category: 5, mask: 5 }, GHOST]);
    assert_eq!(world.bodies().masses().unwrap(), [3.0, 1.0]);
}

#[test]
fn filters_of_a_wrong_length_are_refused() {
    let mut all = crowd(3, 9.0, 1.0, 2);
    all.filters = vec![ROCK; 4];
    let error = World::new(all, WorldSettings::default()).unwrap_err().to_string();
    assert_eq!(error, "categories has 4 rows; it must have 5, one for each shape");
}

#[test]
fn forged_filters_make_a_world_or_a_sentence() {
    let mut world = resting();
    let mut more = crowd(3, 9.0, 1.0, 2);
    more.retain(|row| row < 3);
    more.filters = vec![Filter { category: 0xabcd_ef01, mask: 0x1234_5678 }; 3];
    world.add(more).unwrap();
    let bytes = world.snapshot().unwrap();
    let stored = 0xabcd_ef01u32.to_le_bytes();
    let at = bytes.windows(4).position(|four| four == stored).expect("it is stored");
    // Before the values there is a bit for each row, set for those that have one.
    let rows = at - 1;
    assert_eq!(bytes[rows].count_ones(), 3);
    let forged = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = bytes.clone();
        change(&mut bytes);
        let head = [(bytes.len() - HEAD) as u64, checksum(&bytes[HEAD..])];
        bytes[12..HEAD].copy_from_slice(&head.map(u64::to_le_bytes).concat());
        World::restore(&bytes)
    };
    assert!(forged(&|_| ()).is_ok());
    assert!(forged(&|bytes| bytes[rows] = 0).is_err());
    assert!(forged(&|bytes| bytes.truncate(rows + 10)).is_err());
    let other = forged(&|bytes| bytes[at] = 7).expect("every filter is possible");
    assert!(
        other
            .bodies()
            .filters()
            .unwrap()
            .contains(&Filter { category: 0xabcd_ef07, mask: 0x1234_5678 })
    );
}
