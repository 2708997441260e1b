//! The bytes of snapshots are those of the files in `tests/library/data`, so that no change of the format goes
//! unnoticed.
//!
//! A deliberate change raises `VERSION` in `world/snapshot/mod.rs`; then `JOSTLE_WRITE=1 cargo test -p jostle --test
//! all snapshot_format` writes the files. Where the physics has changed, so have the states in them: then the files are
//! written anew without a new version.

use std::path::Path;
use std::sync::Arc;

use jostle_index::{Each, Filter};
use jostle_world::forces::{
    Andersen, Attractor, Flocking, Grab, Gravitation, Law, Motor, PairForce, PairTable, Pole, Pump,
    Spring, Springs, ThermalWalls, Thermostat, WallIds,
};
use jostle_world::{Changes, Influence, Sides, Surface, Wall, World, WorldSettings};

use crate::common::worlds::{
    bouncing, boxed, discs, forced, inside, moving, restored, run, still, surface,
};

fn spring(a: i64, b: i64) -> Influence {
    let (length, stiffness, damping) = (2.5, 20.0, 0.5);
    Influence::Springs(Springs(vec![Spring {
        pair: [a, b],
        length,
        stiffness,
        damping,
        max_stretch: 9.0,
    }]))
}

/// Discs that sleep on the ground and on a wall, and others that fly, with all that is kept beside forces.
fn asleep() -> World {
    let mut places: Vec<[f32; 2]> = (0..6).map(|k| [2.0 + 2.5 * k as f32, 9.0]).collect();
    places.extend([[17.5, 9.25], [10.0, 2.0], [16.0, 2.0], [5.0, 3.4]]);
    let mut all = bouncing(still(&places, 1.0), 0.25);
    all.spins_mut().iter_mut().for_each(|spin| spin.friction = 0.4);
    all.filters_mut()[8] = Filter { category: 2, mask: 6 };
    (all.sensors_mut()[8], all.movable[7], all.radii[6]) = (true, false, 0.75);
    all.spins_mut()[7].velocity = 0.5;
    let rough = Surface { restitution: None, friction: Some(0.3) };
    let settings = WorldSettings {
        gravity: [0.0, 9.8],
        sides: Sides([Surface::default(), surface(0.5), rough, surface(0.125)]),
        track_events: true,
        ..inside(boxed([0.0; 2], [20.0, 10.0]))
    };
    let motor = Motor {
        ids: vec![7],
        walls: WallIds::default(),
        pivot: [10.0, 2.5],
        angular_velocity: 0.5,
        velocity: [0.0; 2],
        cycle: f32::INFINITY,
    };
    let mut world = forced(all, vec![spring(0, 1), Influence::Motor(motor)], settings);
    let surface = Surface { restitution: Some(0.5), friction: Some(0.3) };
    let filter = Filter { category: 5, mask: 7 };
    let shelf = Wall { surface, filter, ..Wall::new([[3.0, 4.5], [7.0, 4.5]]) };
    world.set_walls(vec![shelf, Wall::new([[18.0, 2.0], [19.0, 3.0]])]).expect("valid");
    world.remove(&[5]).expect("it is there");
    run(&mut world, 150);
    assert!(
        world.bodies().asleep().unwrap().iter().filter(|&&asleep| asleep).count() > 4,
        "{:?}",
        world.bodies().asleep().unwrap()
    );
    let mut flying = discs(&[([16.0, 5.0], [1.0, -2.0]), ([14.0, 9.0], [0.5, 4.0])], 0.5);
    flying.movable[1] = true;
    world.add(flying).expect("valid");
    world.add_forces(&[10], &[[0.5, -0.25]], Some(&[[1.0, 2.0]])).expect("valid");
    world.set_attachment(Some("{\"name\": \"µ\"}".to_owned()));
    run(&mut world, 20);
    world
}

/// Every kind of force, and moving walls.
fn with_forces() -> World {
    let places: Vec<[f32; 2]> = (0..6).map(|k| [2.0 + 3.0 * k as f32, 5.0]).collect();
    let table = PairTable::new(2, vec![0.5, 0.0, -1.0, 0.0, 1.0, 0.0, 0.25, 0.0], 4.0, 0.5);
    let forces = vec![
        Influence::Attractor(Attractor {
            pole: Pole::Point([4.0, -6.0]),
            strength: 0.5,
            law: Law::Harmonic,
        }),
        Influence::Attractor(Attractor {
            pole: Pole::Particle(2),
            strength: 0.25,
            law: Law::InverseSquare,
        }),
        Influence::Gravitation(Gravitation { g: 0.01, softening: 0.1, theta: 0.6 }),
        spring(3, 4),
        Influence::Thermostat(Thermostat { speed: 2.0, rate: 0.3 }),
        Influence::ThermalWalls(ThermalWalls {
            temperature: 2.0,
            sides: [true, false, false, true, false],
            walls: WallIds(vec![1]),
            seed: 7,
        }),
        Influence::Grab(Grab { id: 5, point: [3.0, 4.0], rate: 2.0, max_force: 6.0 }),
        Influence::Andersen(Andersen { temperature: 1.5, rate: 0.25, seed: 8 }),
        Influence::Pair(PairForce { table: Arc::new(table.expect("valid")) }),
        Influence::Pump(Pump {
            drain: [0.0, -9.0, 2.0, -8.0],
            position: [3.0, 1.0],
            velocity: [0.0, 4.0],
            rate: 0.5,
            width: 1.5,
            spread: 0.25,
            seed: 9,
        }),
        Influence::Flocking(Flocking {
            cutoff: 3.5,
            separation: 1.0,
            alignment: 0.5,
            cohesion: 0.25,
            max_speed: 5.0,
            min_speed: 0.5,
        }),
    ];
    let mut all = still(&places, 0.75);
    all.kinds = vec![0, 1, 0, 1, 1, 0];
    let mut world = forced(all, vec![], inside(boxed([0.0; 2], [20.0, 10.0])));
    let walls = [([[1.0, 8.0], [9.0, 8.5]], [0.25, 0.0]), ([[12.0, 2.0], [18.0, 2.0]], [0.0; 2])];
    world.set_walls(walls.map(|(ends, velocity)| moving(ends, velocity)).to_vec()).expect("valid");
    world.set_forces(forces).expect("valid");
    world
        .set(&[1], &Changes { sensors: Some(Each::One(true)), ..Changes::default() })
        .expect("valid");
    run(&mut world, 10);
    world
}

#[test]
fn the_bytes_of_snapshots_are_those_of_the_files() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/library/data");
    for (name, world) in [("asleep", asleep()), ("forces", with_forces())] {
        let (path, bytes) =
            (folder.join(format!("snapshot-{name}.jostle")), world.snapshot().unwrap());
        if std::env::var_os("JOSTLE_WRITE").is_some() {
            std::fs::write(&path, &bytes).expect("the file can be written");
        }
        let pinned = std::fs::read(&path).expect("the file can be read");
        assert!(bytes == pinned, "{name}: the first lines of this test say what to do");
        let (mut old, mut new) = (World::restore(&pinned).expect("it is whole"), restored(&world));
        run(&mut old, 20);
        run(&mut new, 20);
        assert_eq!(old.state_hash().unwrap(), new.state_hash().unwrap(), "{name}");
    }
}
