//! Pinned hashes after each stage of some steps: they say in which stage the bits of a change differ first.

use std::fmt::Write;

use jostle_base::Method;
use jostle_index::Filter;
use jostle_scenes::{self as scenes, STEP, random::Random};
use jostle_world::forces::{Motor, Spring, Springs, WallIds};
use jostle_world::{Container, Influence, Particles, Stage, Surface, Wall, World, WorldSettings};

use crate::common::worlds::{
    bouncing, boxed, change, moving, run, still, walled, with_friction, world_of,
};

/// The steps of which stages are pinned, counted from 1.
const STEPS: [usize; 3] = [1, 15, 60];

/// A column for each stage in the order of [`Stage::ALL`], and one for the state after the step.
const COLUMNS: usize = Stage::ALL.len() + 1;

/// A scene, a step, and 16 bits of the hash of each of its stages: forces, bounds, build, pairs, contacts, resting,
/// events, correction, store, end. 0 stands for a stage that the step does not have.
type Row = (&'static str, usize, [u16; COLUMNS]);

#[rustfmt::skip]
const PINNED: [Row; 42] = [
    ("gas", 1, [0x0000, 0x0d36, 0x883e, 0x3e54, 0x883e, 0x0000, 0xd9b9, 0xd9b9, 0xb067, 0xf7e4]),
    ("gas", 15, [0x0000, 0xb98d, 0x4093, 0x99e3, 0xbc37, 0x0000, 0x4dcf, 0x4dcf, 0x547d, 0x0a19]),
    ("gas", 60, [0x0000, 0xe70a, 0xfa16, 0x2e9e, 0xaf8a, 0x0000, 0x15f2, 0x15f2, 0x61e5, 0xee37]),
    ("pile", 1, [0x0000, 0x2b23, 0x14ba, 0x2ba0, 0x14ba, 0x2987, 0x8cea, 0x8cea, 0x8e34, 0xc8bd]),
    ("pile", 15, [0x0000, 0xe833, 0x9371, 0x5572, 0x4e8e, 0x9be3, 0xa3aa, 0xbd4b, 0x504a, 0x928f]),
    ("pile", 60, [0x0000, 0x1eda, 0x5957, 0x45d0, 0x1782, 0x6a94, 0x390d, 0x1aaf, 0xdb7d, 0xa071]),
    ("heap", 1, [0x0000, 0xadd9, 0xb51d, 0xdf40, 0x5ccc, 0x7977, 0x8f5e, 0x8f5e, 0x0444, 0xd4ad]),
    ("heap", 15, [0x0000, 0x843c, 0x7f3e, 0xf68a, 0x6768, 0x7db6, 0x8831, 0x2317, 0xebb0, 0x4d4a]),
    ("heap", 60, [0x0000, 0x575b, 0xe289, 0x83c1, 0x3042, 0x7530, 0x3370, 0x6bd8, 0x6507, 0x43c2]),
    ("springs", 1, [0xdcff, 0xf313, 0xf924, 0x536f, 0x46eb, 0x1e1e, 0xf748, 0xf748, 0xbc3b, 0xe3d9]),
    ("springs", 15, [0xd10f, 0x5272, 0x11f1, 0x734b, 0x102d, 0xe10f, 0x12f1, 0x12f1, 0x7fea, 0x105f]),
    ("springs", 60, [0x7c02, 0xa961, 0x05e2, 0xeb7d, 0xbd94, 0xcfac, 0x64da, 0x2628, 0xa434, 0xc16f]),
    ("piston", 1, [0x9565, 0xc349, 0x0bd2, 0x0142, 0x0bd2, 0x0000, 0x1c56, 0x1c56, 0x2f5b, 0x6f0b]),
    ("piston", 15, [0x9565, 0xcef2, 0x3e36, 0xa886, 0x840f, 0x0000, 0x2b5a, 0x2b5a, 0x0b2c, 0x68fe]),
    ("piston", 60, [0x9565, 0xd588, 0xd4df, 0x2d91, 0x2c04, 0x0000, 0xbd81, 0xbd81, 0x579c, 0xa103]),
    ("mill", 1, [0x14de, 0xee85, 0xf740, 0x0b99, 0x0fba, 0xfb88, 0xbb8c, 0xbb8c, 0xfdca, 0x2460]),
    ("mill", 15, [0x14de, 0x15d4, 0x5b27, 0xcb1a, 0xcf7a, 0x7e18, 0x02e2, 0x6253, 0xb602, 0x01ca]),
    ("mill", 60, [0x14de, 0xf6f5, 0x84ea, 0x3a17, 0x8324, 0xd868, 0x9ea5, 0xb206, 0xea3e, 0x6e47]),
    ("thermostat", 1, [0x81e5, 0x6828, 0xe0aa, 0x29d5, 0xe0aa, 0x0000, 0x8b36, 0x8b36, 0x1921, 0xc15f]),
    ("thermostat", 15, [0x81e5, 0x30b5, 0xb833, 0xa37a, 0xa255, 0x0000, 0x27a1, 0x27a1, 0x236b, 0x15ec]),
    ("thermostat", 60, [0x81e5, 0xe530, 0x2e78, 0x709e, 0xc457, 0x0000, 0xc449, 0xc449, 0xc759, 0x346a]),
    ("orbit", 1, [0x0000, 0x74fe, 0xc8ca, 0xf9b4, 0xc8ca, 0x0000, 0xdaba, 0xdaba, 0xebf6, 0x87bf]),
    ("orbit", 15, [0x0000, 0x33e7, 0xd4c5, 0xbb45, 0x9670, 0x0000, 0xac08, 0xac08, 0x40b0, 0x921c]),
    ("orbit", 60, [0x0000, 0x7cde, 0x3028, 0x9edf, 0xf9a2, 0x0000, 0xd59f, 0xd59f, 0x31c6, 0x7827]),
    ("sand", 1, [0x0000, 0xf08e, 0xf5bf, 0xe538, 0xc420, 0x6390, 0xce03, 0xb0e4, 0xb10c, 0x6feb]),
    ("sand", 15, [0x0000, 0xb6b9, 0xb3a9, 0x3d96, 0x8315, 0xedde, 0x6d60, 0xbff3, 0x0742, 0x72e1]),
    ("sand", 60, [0x0000, 0x4d1a, 0xac4d, 0x6d5b, 0x5c78, 0xb3c0, 0x49e2, 0x6d08, 0x4cbe, 0x3f64]),
    ("life", 1, [0x813e, 0x9fa5, 0x5ee2, 0x81e5, 0x5ee2, 0x0000, 0xa49b, 0xa49b, 0x2277, 0x08be]),
    ("life", 15, [0xbf37, 0x464b, 0xfc88, 0x81e5, 0xba12, 0x0000, 0xa2c1, 0xa2c1, 0x9234, 0xced3]),
    ("life", 60, [0xc8e0, 0x055f, 0x7dc4, 0x81e5, 0xb664, 0x0000, 0xa1b4, 0xa1b4, 0x4d10, 0xe8cc]),
    ("stars", 1, [0x68f2, 0xde1a, 0x62a6, 0x17c1, 0x62a6, 0x0000, 0x1bbe, 0x1bbe, 0x6362, 0xd14f]),
    ("stars", 15, [0xc10f, 0xec31, 0x2332, 0x91f4, 0x7f49, 0x0000, 0x76ee, 0x76ee, 0xa2f9, 0xde73]),
    ("stars", 60, [0xcba2, 0x015a, 0x3057, 0xc60e, 0x3ed4, 0x0000, 0xfdce, 0xfdce, 0x4fe5, 0xbbb5]),
    ("flock", 1, [0x1cff, 0xba4e, 0x38dd, 0xae8b, 0x38dd, 0x0000, 0xbcb8, 0xbcb8, 0xd44d, 0xdb23]),
    ("flock", 15, [0x96f0, 0x997d, 0x31b5, 0xae8b, 0x4dda, 0x0000, 0x6c52, 0x6c52, 0xed16, 0x11ac]),
    ("flock", 60, [0x2b50, 0x8e04, 0x21cc, 0xae8b, 0xcc36, 0x0000, 0xb913, 0xb913, 0x56c4, 0x9342]),
    ("sleepers", 1, [0x0000, 0xee6c, 0x83a5, 0xeb2a, 0x83a5, 0xaeca, 0x2bbf, 0x2bbf, 0xd158, 0xb0a2]),
    ("sleepers", 15, [0x0000, 0x57cb, 0x0dcc, 0xeb2a, 0x83a5, 0xaeca, 0x2839, 0x2839, 0x6caf, 0x79ac]),
    ("sleepers", 60, [0x0000, 0xf5a7, 0x0b3c, 0xcef0, 0x5be1, 0xb659, 0x6792, 0x6792, 0xc07f, 0xb3bd]),
    ("belt", 1, [0xc57d, 0x21e5, 0x71f1, 0x9b0d, 0x71f1, 0x6d61, 0xee4d, 0xee4d, 0x263f, 0x73cb]),
    ("belt", 15, [0xc519, 0x4c6d, 0xb265, 0xa880, 0x814a, 0xb93e, 0xf480, 0xf480, 0xcfec, 0xc6dc]),
    ("belt", 60, [0x0667, 0x88bc, 0x21b5, 0x5b83, 0x7446, 0x9a06, 0x36aa, 0x36aa, 0x51cd, 0x3e92]),
];

/// A name, and a function that makes the world.
type Scene = (&'static str, fn() -> World);

/// The scenes use everything that a step has.
const SCENES: [Scene; 14] = [
    ("gas", || scene("gas", 200)),
    ("pile", || scene("pile", 100)),
    ("heap", || scene("heap", 120)),
    ("springs", || scene("springs", 150)),
    ("piston", || scene("piston", 120)),
    ("mill", || scene("mill", 120)),
    ("thermostat", || scene("thermostat", 150)),
    ("orbit", || scene("orbit", 120)),
    ("sand", || scene("sand", 150)),
    ("life", || scene("life", 150)),
    ("stars", || scene("stars", 200)),
    ("flock", || scene("flock", 100)),
    ("sleepers", sleepers),
    ("belt", belt),
];

fn scene(name: &str, count: usize) -> World {
    scenes::find(name).unwrap().create(Some(count), 0).unwrap()
}

/// Rough discs that rest in a row and fall asleep. A ball wakes some of them at the end.
fn sleepers() -> World {
    let mut positions: Vec<[f32; 2]> = (0..12).map(|k| [2.1 * k as f32, 1.0]).collect();
    positions.push([9.0, 8.3]);
    let mut all = with_friction(still(&positions, 1.0), 0.5);
    all.velocities[12] = [0.4, 0.0];
    let container = boxed([-1.0, 0.0], [25.0, 20.0]);
    let settings = WorldSettings { container, gravity: [0.0, -15.0], ..Default::default() };
    world_of(bouncing(all, 0.4), settings)
}

/// A torus with walls that move, a driven disc, springs, sensors and discs that ignore each other.
fn belt() -> World {
    let mut random = Random::new(4);
    let place = |k: usize| [(k % 9) as f32 * 3.0, (k / 9) as f32 * 3.0];
    let velocities = (0..81).map(|_| [random.between(-9.0, 9.0), random.between(-9.0, 9.0)]);
    let positions = (0..81).map(place).collect();
    let mut all = Particles::new(positions, velocities.collect(), vec![1.1; 81], 1.0);
    all.restitution.iter_mut().step_by(2).for_each(|of| *of = 0.7 * 0.7);
    all.filters_mut()[..20].fill(Filter { category: 2, mask: 3 });
    all.filters_mut()[20..25].fill(Filter { category: 4, mask: 4 });
    all.sensors_mut()[40] = true;
    all.spins_mut()[50..].iter_mut().for_each(|spin| spin.friction = 0.3);
    (all.movable[60], all.masses[7]) = (false, 90.0);
    let container = Container::Torus { size: [27.0; 2] };
    let (gravity, track_events) = ([0.0, -3.0], true);
    let settings = WorldSettings { container, gravity, track_events, ..Default::default() };
    let mut belt = moving([[1.4, 1.4], [6.0, 1.4]], [4.0, 1.0]);
    belt.surface.restitution = Some(1.0);
    // Of the categories of all discs, which walls stop.
    let filter = Filter { category: 5, ..Filter::default() };
    belt.filter = filter;
    let surface = Surface { restitution: Some(0.25), friction: Some(0.8) };
    let slope = Wall { surface, filter, ..Wall::new([[10.0, 13.6], [20.0, 14.0]]) };
    let mut world = walled(all, vec![belt, slope], settings);
    let spring = |pair| Spring {
        pair,
        length: 3.0,
        stiffness: 40.0,
        damping: 0.5,
        max_stretch: f32::INFINITY,
    };
    let (pivot, velocity) = ([18.0; 2], [0.0, 2.0]);
    let (ids, walls) = (vec![60], WallIds::default());
    let motor = Motor { ids, walls, pivot, angular_velocity: 1.5, velocity, cycle: 0.5 };
    let springs = Springs(vec![spring([0, 1]), spring([1, 2]), spring([30, 40])]);
    world.set_forces(vec![Influence::Springs(springs), Influence::Motor(motor)]).unwrap();
    world
}

/// The hash of each stage of the next step: of all its sub-steps, parts and repetitions.
fn hashes_of_step(world: &mut World) -> [u64; COLUMNS] {
    let mut all = [0u64; COLUMNS];
    let mut watch = |stage: Stage, world: &World| {
        let of = &mut all[stage as usize];
        *of = of.rotate_left(5).wrapping_mul(0x0000_0100_0000_01b3)
            ^ world.stage_hash(stage).unwrap();
    };
    world.step_watched(STEP, 1, &mut watch).unwrap();
    all[COLUMNS - 1] = world.state_hash().unwrap();
    all
}

/// The rows of a scene.
fn rows((name, make): Scene) -> Vec<Row> {
    let (mut world, mut rows) = (make(), Vec::new());
    let mut done = 0;
    for number in STEPS {
        world.step(STEP, number - 1 - done).unwrap();
        let short = |hash: u64| (hash ^ hash >> 16 ^ hash >> 32 ^ hash >> 48) as u16;
        rows.push((name, number, hashes_of_step(&mut world).map(short)));
        done = number;
    }
    rows
}

fn name_of(column: usize) -> &'static str {
    Stage::ALL.get(column).map_or("end", |(_, name)| name)
}

#[test]
fn each_stage_of_a_step_gives_its_pinned_bits() {
    let rows: Vec<Row> = SCENES.into_iter().flat_map(rows).collect();
    let mut wrong = String::new();
    for (name, _) in SCENES {
        let pinned = |step: usize| PINNED.iter().find(|row| (row.0, row.1) == (name, step));
        let first = rows.iter().filter(|row| row.0 == name).find_map(|(_, step, found)| {
            let pinned = pinned(*step).map_or([0; COLUMNS], |row| row.2);
            Some((step, (0..COLUMNS).find(|&k| found[k] != pinned[k])?))
        });
        if let Some((step, column)) = first {
            let stage = name_of(column);
            writeln!(wrong, "{name}: step {step} differs first, from the stage {stage} on")
                .unwrap();
        }
    }
    let line = |(name, step, hashes): &Row| {
        let hashes = hashes.map(|hash| format!("{hash:#06x}")).join(", ");
        format!("    (\"{name}\", {step}, [{hashes}]),\n")
    };
    let table: String = rows.iter().map(line).collect();
    let list = "cargo test --package jostle --test all list_stages -- --ignored --nocapture";
    assert!(wrong.is_empty(), "{wrong}`{list}` lists all steps. The new table:\n{table}");
}

#[test]
fn sleepers_are_among_the_pinned_steps() {
    let mut world = sleepers();
    run(&mut world, STEPS[1]);
    assert!(!world.bodies().asleep().unwrap().contains(&true));
    run(&mut world, STEPS[2] - STEPS[1]);
    let asleep = world.bodies().asleep().unwrap().iter().filter(|&&asleep| asleep).count();
    assert!((2..12).contains(&asleep), "{asleep}");
}

/// Prints the hashes of all stages of all steps, to be compared with those of other code.
#[test]
#[ignore = "prints a long list"]
fn list_stages_of_all_steps() {
    for (name, make) in SCENES {
        let mut world = make();
        for step in 1..=STEPS[STEPS.len() - 1] {
            for (column, hash) in hashes_of_step(&mut world).into_iter().enumerate() {
                println!("{name} {step} {} {hash:016x}", name_of(column));
            }
        }
    }
}

#[test]
fn neither_threads_nor_methods_show_in_the_stages() {
    for (name, make) in SCENES {
        let all = [(Method::Quadtree, 1), (Method::Brute, 2)].map(|(method, threads)| {
            let mut world = make();
            change(&mut world, |settings| {
                (settings.method, settings.tree.threads) = (method, Some(threads));
            });
            (0..8).map(|_| hashes_of_step(&mut world)).collect::<Vec<_>>()
        });
        assert_eq!(all[0], all[1], "{name}");
    }
}
