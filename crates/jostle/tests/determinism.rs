//! Same input, same bits: whatever the threads, the method and the order of adding.

use std::sync::{Mutex, PoisonError};

use jostle_base::settings::DEFAULT_MAX_PAIRS;
use jostle_base::{Method, Settings};
use jostle_index::pairs::{self, Found};
use jostle_index::{Each, Scalar, Shapes};
use jostle_scenes::{self as scenes, SCENES, Scene, random::Random};
use jostle_simd::{self as simd, Instructions};
use jostle_world::forces::Gravitation;
use jostle_world::{Changes, Influence, OnTouch, Particles, World, WorldSettings};

use crate::common::worlds::{change, gathered, run, shuffled, walled, world_of};

/// State of each scene after 240 steps of 1/60 s, with at most 1,000 particles
/// and seed 0. A change of the physics changes them: see CONTRIBUTING.
const PINNED: [(&str, u64); 24] = [
    ("article", 0xb8c7_9d59_32ff_7ad4),
    ("gas", 0xe52f_16cd_f8cc_8723),
    ("pile", 0xc9c0_8a65_0b9e_c437),
    ("rain", 0xf849_c708_6821_809d),
    ("mixed", 0xb173_6c73_033e_ad9b),
    ("clusters", 0x3b36_d4a2_2b5a_e11b),
    ("shots", 0x3720_ed6b_f194_adcf),
    ("billiards", 0x1e6f_96c5_e461_deb0),
    ("orbit", 0x7d5a_16be_a2bd_44aa),
    ("springs", 0xf32a_e95b_0086_f32b),
    ("stars", 0x680b_902f_5f68_e3ec),
    ("thermostat", 0xe422_7176_a519_af3f),
    ("sand", 0x0e70_608f_7183_81f6),
    ("galton", 0x3882_6622_da6c_8c11),
    ("brownian", 0x97dd_91a5_6928_0fa8),
    ("emitters", 0xd3a5_6564_4761_3ee2),
    ("heap", 0x5e2e_5aab_5a3e_8d51),
    ("mill", 0xdd58_0858_2549_ce66),
    ("conveyor", 0xbc19_cfd7_6a39_e822),
    ("piston", 0xec36_bf00_0d63_c92c),
    ("pinball", 0x5d12_a0db_e70f_a6c0),
    ("life", 0xf6b8_12be_fc85_cf14),
    ("flock", 0x47f9_7fb8_f454_0e81),
    ("fluid", 0x9dee_90f6_5355_cf38),
];

/// State and number of stars that form from 2,000 grains of dust in 300 steps.
const PINNED_STARS: (u64, usize) = (0xdac9_604a_877e_5dfa, 1177);

/// State of some scenes whose particles have friction and spin, in the same way.
const PINNED_WITH_FRICTION: [(u64, &str); 4] = [
    (0x3d34_203f_909a_e463, "gas"),
    (0x1ea2_787f_1a1c_5d09, "pile"),
    (0x5117_b759_bc3b_cc75, "mixed"),
    (0xd23f_8072_6c37_1b80, "sand"),
];

/// A scene whose particles have friction and spin.
fn make_rough(name: &str, count: usize) -> World {
    let scene = scenes::find(name).expect("it exists");
    let mut world = scene.create(Some(count), 0).expect("a scene is valid");
    let mut random = Random::new(5);
    let roughen = |all: &mut Particles| {
        let movable = all.movable.clone();
        for (spin, movable) in all.spins_mut().iter_mut().zip(movable) {
            (spin.friction, spin.velocity) = (random.between(0.0, 1.0), random.between(-2.0, 2.0));
            if !movable {
                spin.velocity = 0.0;
            }
        }
        Ok(())
    };
    world.edit(roughen).expect("valid");
    world
}

fn make(scene: &Scene, count: usize) -> World {
    scene.create(Some(count.min(scene.default_count)), 0).expect("a scene is valid")
}

#[test]
fn every_scene_ends_in_its_pinned_state() {
    let mut wrong = Vec::new();
    for (scene, (name, pinned)) in SCENES.iter().zip(PINNED) {
        assert_eq!(scene.name, name);
        let mut world = make(scene, 1000);
        run(&mut world, 240);
        if world.state_hash().unwrap() != pinned {
            wrong.push(format!("(\"{name}\", {:#018x}),", world.state_hash().unwrap()));
        }
    }
    assert!(wrong.is_empty(), "these states are not the pinned ones:\n{}", wrong.join("\n"));
}

#[test]
fn scenes_with_friction_end_in_their_pinned_state() {
    let mut wrong = Vec::new();
    for (pinned, name) in PINNED_WITH_FRICTION {
        let mut world = make_rough(name, 1000);
        run(&mut world, 240);
        if world.state_hash().unwrap() != pinned {
            wrong.push(format!("({:#018x}, \"{name}\"),", world.state_hash().unwrap()));
        }
    }
    assert!(wrong.is_empty(), "these states are not the pinned ones:\n{}", wrong.join("\n"));
}

#[test]
fn friction_does_not_show_how_it_is_computed() {
    for (_, name) in PINNED_WITH_FRICTION {
        let mut expected = make_rough(name, 1000);
        run(&mut expected, 40);
        let check = |mut world: World, way: &str| {
            run(&mut world, 40);
            assert_eq!(
                world.state_hash().unwrap(),
                expected.state_hash().unwrap(),
                "{name}: {way}"
            );
            assert_eq!(world.contacts().unwrap(), expected.contacts().unwrap(), "{name}: {way}");
            assert_eq!(
                world.wall_contacts().unwrap(),
                expected.wall_contacts().unwrap(),
                "{name}: {way}"
            );
        };
        let mut brute = make_rough(name, 1000);
        change(&mut brute, |settings| settings.method = Method::Brute);
        check(brute, "brute force");
        for hash in with_each_kind(|| {
            let mut world = make_rough(name, 1000);
            run(&mut world, 40);
            world.state_hash().unwrap()
        }) {
            assert_eq!(hash, expected.state_hash().unwrap(), "{name}: instructions");
        }
        let straight = make_rough(name, 1000);
        let order = shuffled(straight.len(), 9);
        let particles = gathered(&straight.bodies().particles().unwrap(), &order);
        let mut mixed_up = walled(particles, straight.walls().to_vec(), *straight.settings());
        mixed_up.set_forces(renamed(&straight.forces().unwrap(), &order)).expect("still valid");
        run(&mut mixed_up, 40);
        let particles = gathered(&expected.bodies().particles().unwrap(), &order);
        assert!(
            mixed_up.bodies().particles().unwrap() == particles,
            "{name} depends on the order of adding"
        );
        let mut half = make_rough(name, 1000);
        run(&mut half, 20);
        let mut half = World::restore(&half.snapshot().unwrap()).expect("it can be restored");
        run(&mut half, 20);
        assert_eq!(
            half.state_hash().unwrap(),
            expected.state_hash().unwrap(),
            "{name}: a snapshot"
        );
    }
}

#[test]
fn threads_do_not_show_in_friction() {
    for (_, name) in PINNED_WITH_FRICTION {
        let hashes = [1, 2, 8].map(|threads| {
            let mut world = make_rough(name, 21_000);
            change(&mut world, |settings| settings.tree.threads = Some(threads));
            run(&mut world, 2);
            (world.state_hash().unwrap(), world.contacts().unwrap(), world.wall_contacts().unwrap())
        });
        assert!(hashes.iter().all(|hash| *hash == hashes[0]), "{name}");
    }
}

#[test]
fn dust_becomes_stars_of_a_pinned_state() {
    let mut random = Random::new(3);
    let mut pair = |most: f32| [random.between(-most, most), random.between(-most, most)];
    let positions = (0..2000).map(|_| pair(30.0)).collect();
    let velocities = (0..2000).map(|_| pair(0.5)).collect();
    let dust = Particles::new(positions, velocities, vec![0.1; 2000], 1.0);
    let settings = WorldSettings { on_touch: OnTouch::Merge, ..WorldSettings::default() };
    let mut world = world_of(dust, settings);
    let pull = Gravitation { g: 2.0, softening: 0.05, theta: 0.5 };
    world.set_forces(vec![Influence::Gravitation(pull)]).expect("a valid force");
    run(&mut world, 300);
    let found = (world.state_hash().unwrap(), world.len());
    assert_eq!(found, PINNED_STARS, "{found:#x?}");
}

/// The limit is one for the whole process: tests that set it wait for each other. Others do
/// not notice, since no answer depends on it.
static LIMIT: Mutex<()> = Mutex::new(());

/// What `work` gives with each kind of vector instructions.
fn with_each_kind<R>(work: impl Fn() -> R) -> [R; 3] {
    let _alone = LIMIT.lock().unwrap_or_else(PoisonError::into_inner);
    let kinds = [Instructions::Portable, Instructions::Avx2, Instructions::Avx512];
    kinds.map(|most| {
        simd::limit(most);
        assert!(simd::widest() <= most);
        work()
    })
}

#[test]
fn vector_instructions_do_not_show_in_a_world() {
    for scene in &SCENES {
        let hashes = with_each_kind(|| {
            let mut world = make(scene, 400);
            run(&mut world, 30);
            world.state_hash().unwrap()
        });
        assert!(hashes.iter().all(|hash| *hash == hashes[0]), "{}: {hashes:x?}", scene.name);
    }
}

/// Rounded boxes or circles, crowded and of many sizes, with or without filters.
fn crowd<T: Scalar>(count: usize, boxes: bool, filters: bool) -> Shapes<T> {
    let mut random = Random::new(7);
    let side = (count as f32).sqrt();
    let mut pairs = |most: f32| -> Vec<[T; 2]> {
        let mut number = || T::from_f64(f64::from(random.between(0.0, most)));
        (0..count).map(|_| [number(), number()]).collect()
    };
    let (centers, sizes) = (pairs(side), pairs(0.5));
    let radii = pairs(0.6).into_iter().map(|[radius, _]| radius).collect();
    let bits =
        |shift: u32| Each::Rows((0..count as u32).map(|row| 1 << (row >> shift & 3)).collect());
    let filters = filters.then(|| [bits(0), Each::One(5)]);
    Shapes::new(centers, Each::Rows(radii), boxes.then_some(Each::Rows(sizes)), filters).unwrap()
}

/// Circles of one radius, which are searched by a grid.
fn equal_circles<T: Scalar>(count: usize) -> Shapes<T> {
    let mut circles = crowd(count, false, false);
    *circles.columns_mut().radii = Each::One(T::from_f64(0.4));
    circles
}

/// Pairs and numbers of tests, by every way of finding them.
fn found<T: Scalar>(shapes: &Shapes<T>, threads: usize) -> [Found; 3] {
    let find = |method| pairs::find(shapes, method, Some(threads), DEFAULT_MAX_PAIRS).unwrap();
    [None, Some(Method::Brute), Some(Method::Quadtree)].map(find)
}

fn the_order_of_pairs_is_always_the_same<T: Scalar>() {
    for count in [2, 100, 5_000, 40_000] {
        let find = |threads| {
            let shapes = equal_circles::<T>(count);
            pairs::find(&shapes, None, Some(threads), DEFAULT_MAX_PAIRS).unwrap()
        };
        let expected = find(1);
        assert!([2, 8].into_iter().all(|threads| find(threads) == expected), "{count}: threads");
        let others = with_each_kind(|| find(1));
        assert!(others.iter().all(|other| *other == expected), "{count}: instructions");
    }
    for count in [2, 15, 16, 17, 200, 600, 2_000, 12_000] {
        for (boxes, filters) in [(false, false), (true, false), (false, true), (true, true)] {
            // Brute force would take long; the tree is what uses threads.
            let shapes =
                crowd::<T>(count.min(if boxes || filters { 2_000 } else { count }), boxes, filters);
            let expected = found(&shapes, 1);
            for other in [2, 8].map(|threads| found(&shapes, threads)) {
                assert!(other == expected, "{count} {boxes} {filters}: threads show");
            }
            for other in with_each_kind(|| found(&shapes, 1)) {
                assert!(other == expected, "{count} {boxes} {filters}: instructions show");
            }
        }
    }
}

#[test]
fn neither_threads_nor_instructions_show_in_the_order_of_pairs() {
    the_order_of_pairs_is_always_the_same::<f32>();
    the_order_of_pairs_is_always_the_same::<f64>();
}

#[test]
fn threads_do_not_show() {
    for scene in &SCENES {
        let hashes = [1, 2, 8].map(|threads| {
            // Enough particles for every parallel path to be taken, colours included.
            let mut world = scene.create(Some(21_000), 1).expect("a scene is valid");
            change(&mut world, |settings| settings.tree.threads = Some(threads));
            run(&mut world, 2);
            world.state_hash().unwrap()
        });
        assert!(hashes.iter().all(|hash| *hash == hashes[0]), "{}: {hashes:x?}", scene.name);
    }
}

/// When many inelastic discs land, histories depend on each other across blocks. On one thread all are in one block,
/// so nothing is simulated again.
#[test]
fn threads_do_not_show_where_many_discs_land() {
    let hashes = [1, 2].map(|threads| {
        let mut world = scenes::find("gas").unwrap().create(Some(2_500), 1).unwrap();
        change(&mut world, |settings| {
            settings.tree.threads = Some(threads);
            settings.gravity = [0.0, 900.0];
        });
        let lossy = Changes { restitution: Some(Each::One(0.9)), ..Changes::default() };
        world.set(&world.bodies().ids().unwrap(), &lossy).unwrap();
        run(&mut world, 70);
        world.state_hash().unwrap()
    });
    assert_eq!(hashes[0], hashes[1]);
}

#[test]
fn brute_force_and_the_tree_make_the_same_world() {
    for scene in &SCENES {
        let [brute, tree] = [Method::Brute, Method::Quadtree].map(|method| {
            let mut world = make(scene, 300);
            change(&mut world, |settings| settings.method = method);
            run(&mut world, 80);
            (world.state_hash().unwrap(), world.contacts().unwrap(), world.wall_contacts().unwrap())
        });
        assert_eq!(brute, tree, "{}", scene.name);
    }
}

#[test]
fn leaf_capacity_and_depth_do_not_show() {
    for scene in &SCENES {
        let hashes =
            [(1, 4096), (16, 4096), (64, 4096), (4, 2), (1, 0)].map(|(capacity, depth)| {
                let mut world = make(scene, 200);
                change(&mut world, |settings| {
                    settings.tree =
                        Settings { leaf_capacity: capacity, max_depth: depth, ..settings.tree };
                });
                run(&mut world, 30);
                world.state_hash().unwrap()
            });
        assert!(hashes.iter().all(|hash| *hash == hashes[0]), "{}: {hashes:x?}", scene.name);
    }
}

/// The same forces on particles of which row `order[i]` has become row i.
fn renamed(forces: &[Influence], order: &[u32]) -> Vec<Influence> {
    let mut rows = vec![0; order.len()];
    order.iter().zip(0..).for_each(|(&old, new)| rows[old as usize] = new);
    let mut forces = forces.to_vec();
    for force in &mut forces {
        match force {
            Influence::Springs(springs) => {
                springs.0.iter_mut().for_each(|s| s.pair = s.pair.map(|row| rows[row as usize]));
            }
            Influence::Motor(motor) => {
                motor.ids.iter_mut().for_each(|row| *row = rows[*row as usize]);
            }
            _ => {}
        }
    }
    forces
}

#[test]
fn a_permutation_permutes_and_changes_nothing_else() {
    for scene in &SCENES {
        let mut straight = make(scene, 300);
        let order = shuffled(straight.len(), 9);
        let particles = gathered(&straight.bodies().particles().unwrap(), &order);
        let mut mixed_up = walled(particles, straight.walls().to_vec(), *straight.settings());
        mixed_up.set_forces(renamed(&straight.forces().unwrap(), &order)).expect("still valid");
        run(&mut straight, 80);
        run(&mut mixed_up, 80);
        if straight.len() == order.len() {
            let expected = gathered(&straight.bodies().particles().unwrap(), &order);
            let same = mixed_up.bodies().particles().unwrap() == expected;
            assert!(same, "{} depends on the order of adding", scene.name);
        } else {
            // Where particles merge, rows close up.
            let sorted = |world: &World| {
                let mut all = world.bodies().positions().unwrap();
                all.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
                all
            };
            assert_eq!(sorted(&mixed_up), sorted(&straight), "{}", scene.name);
        }
        assert_eq!(mixed_up.kinetic_energy(), straight.kinetic_energy());
        assert_eq!(mixed_up.momentum(), straight.momentum());
    }
}

#[test]
fn one_call_or_many_make_the_same_world() {
    let scene = &SCENES[0];
    let (mut once, mut often) = (make(scene, 300), make(scene, 300));
    run(&mut once, 60);
    (0..60).for_each(|_| run(&mut often, 1));
    assert_eq!(once.state_hash().unwrap(), often.state_hash().unwrap());
}

#[test]
fn a_hash_tells_states_apart() {
    let mut world = make(&SCENES[0], 100);
    let before = world.state_hash().unwrap();
    world
        .edit(|all| {
            all.positions[57][1] = all.positions[57][1].next_up();
            Ok(())
        })
        .expect("a valid change");
    assert_ne!(world.state_hash().unwrap(), before);
}
