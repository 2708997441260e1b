//! The worlds whose memory is short, and the calls that then fail.

use jostle_base::{Error, Result, memory};
use jostle_index::query::{Circle, Ray};
use jostle_index::{Each, shapes::Filter};
use jostle_scenes::{self as scenes, STEP, random::Random};
use jostle_world::forces::Gravitation;
use jostle_world::{Changes, Container, Influence, OnTouch, Particles, Wall, World, WorldSettings};

/// Particles of each world. A column of bytes is large, and several threads are used.
pub const LEN: usize = 10_000;

/// A name, and a function that makes the world with a number of steps before it is tested.
pub type Made = (&'static str, fn() -> World, usize);

pub const WORLDS: [Made; 12] = [
    ("gas", || scene("gas"), 1),
    ("pile", || scene("pile"), 3),
    ("mixed", || scene("mixed"), 1),
    ("sand", || scene("sand"), 2),
    ("springs", || scene("springs"), 1),
    ("life", || scene("life"), 1),
    ("flock", || scene("flock"), 1),
    ("thermostat", || scene("thermostat"), 1),
    ("orbit", || scene("orbit"), 1),
    ("stars", stars_on_torus, 2),
    ("sleeping", sleeping, 45),
    ("tracked", tracked, 2),
];

fn scene(name: &str) -> World {
    scenes::find(name).unwrap().create(Some(LEN), 1).unwrap()
}

/// Places of a square lattice.
fn lattice(pitch: f32) -> Vec<[f32; 2]> {
    let side = (LEN as f32).sqrt().ceil() as usize;
    (0..LEN).map(|k| [(k % side) as f32 * pitch, (k / side) as f32 * pitch]).collect()
}

fn random_velocities(speed: f32) -> Vec<[f32; 2]> {
    let mut random = Random::new(7);
    let mut one = || [random.between(-speed, speed), random.between(-speed, speed)];
    (0..LEN).map(|_| one()).collect()
}

/// Dust on a torus that attracts itself and merges.
fn stars_on_torus() -> World {
    let dust = Particles::new(lattice(1.0), random_velocities(5.0), vec![0.4; LEN], 1.0);
    let container = Container::Torus { size: [105.0; 2] };
    let settings = WorldSettings { container, on_touch: OnTouch::Merge, ..Default::default() };
    let mut world = World::new(dust, settings).unwrap();
    let pull = Gravitation { g: 0.01, softening: 0.5, theta: 0.7 };
    world.set_forces(vec![Influence::Gravitation(pull)]).unwrap();
    world
}

/// Discs on a floor, each an island; most of them sleep, and a few fall on them.
fn sleeping() -> World {
    let mut all: Vec<[f32; 2]> = (0..LEN).map(|k| [k as f32 * 2.5, 1.0]).collect();
    all.iter_mut().step_by(100).for_each(|position| position[1] = 7.5);
    let mut discs = Particles::new(all, vec![[0.0; 2]; LEN], vec![1.0; LEN], 1.0);
    discs.restitution.fill(0.3);
    let container = Container::Box { min: [-50.0, 0.0], max: [2.6 * LEN as f32, 100.0] };
    let settings = WorldSettings { gravity: [0.0, -9.8], container, ..Default::default() };
    World::new(discs, settings).unwrap()
}

/// Rough discs with categories, sensors and events that are recorded.
fn tracked() -> World {
    let mut discs = Particles::new(lattice(1.1), random_velocities(2.0), vec![0.5; LEN], 1.0);
    discs.restitution.fill(0.8);
    discs.spins_mut().iter_mut().for_each(|spin| spin.friction = 0.3);
    let filter = |k: usize| Filter { category: 1 << (k % 3), mask: u32::MAX << (k % 2) };
    discs.filters_mut().iter_mut().enumerate().for_each(|(k, of)| *of = filter(k));
    discs.sensors_mut().iter_mut().step_by(50).for_each(|is_sensor| *is_sensor = true);
    let container = Container::Box { min: [-1.0; 2], max: [115.0; 2] };
    let settings =
        WorldSettings { gravity: [0.0, -9.8], container, track_events: true, ..Default::default() };
    World::new(discs, settings).unwrap()
}

/// A name, and a call.
pub type Call = (&'static str, fn(&mut World) -> Result<()>);

pub const CALLS: [Call; 25] = [
    ("step", |world| world.step(STEP, 1)),
    ("snapshot", |world| world.snapshot().map(drop)),
    ("restore", |world| World::restore(&world.snapshot()?).map(drop)),
    ("new", |world| World::new(world.bodies().particles()?, *world.settings()).map(drop)),
    ("add", |world| world.add(world.bodies().particles()?).map(drop)),
    ("add immovable", |world| {
        let mut particles = Particles::new(vec![[5.0; 2]], vec![[0.0; 2]], vec![0.5], 1.0);
        particles.movable.fill(false);
        world.add(particles).map(drop)
    }),
    ("remove", |world| world.remove(&some_ids(world)?)),
    ("set", |world| {
        let ids = some_ids(world)?;
        let velocities = Each::Rows(memory::filled(ids.len(), [1.0, 2.0])?);
        let changes = Changes {
            velocities: Some(velocities),
            friction: Some(Each::One(0.5)),
            kinds: Some(Each::One(0)),
            ..Changes::default()
        };
        world.set(&ids, &changes)
    }),
    ("edit", |world| {
        world.edit(|all| {
            all.velocities.fill([0.5, 0.25]);
            Ok(())
        })
    }),
    ("set_walls", |world| {
        let wall = |k: usize| Wall::new([[k as f32, 500.0], [k as f32 + 0.5, 501.0]]);
        world.set_walls(memory::collect((0..3000).map(wall))?)
    }),
    ("set_forces", |world| world.set_forces(world.forces()?)),
    ("configure", |world| {
        let settings = WorldSettings { drag: 0.5, ..*world.settings() };
        world.configure(settings)
    }),
    ("accelerate", |world| world.set_accelerations(memory::filled(world.len(), [1.0, 0.0])?)),
    ("pairs", |world| world.pairs_within(1.0, (None, true), 1 << 24).map(drop)),
    ("overlaps", |world| world.overlaps((None, true), 1 << 24).map(drop)),
    ("neighbors", |world| world.neighbors(1.0, None).map(drop)),
    ("nearest", |world| {
        let positions = world.bodies().positions()?;
        world.nearest(&positions, (2, Each::One(5.0)), None).map(drop)
    }),
    ("first_hits", |world| world.first_hits(&rays(world)?, None).map(drop)),
    ("all_hits", |world| world.all_hits(&rays(world)?, None).map(drop)),
    ("search_walls", |world| {
        let positions = world.bodies().positions()?;
        let regions = Circle::all(&Each::Rows(positions), &Each::One(300.0))?;
        world.search_walls(&regions, None).map(drop)
    }),
    ("wall_hits", |world| {
        world.first_wall_hits(&rays(world)?, None)?;
        world.all_wall_hits(&rays(world)?, None).map(drop)
    }),
    ("contacts", |world| world.contacts().map(drop)),
    ("events", |world| {
        world.events()?;
        world.wall_contacts().map(drop)
    }),
    ("energy", |world| world.potential_energy().map(drop)),
    ("scene", |_| scenes::find("pile")?.create(Some(LEN), 1).map(drop)),
];

fn rays(world: &World) -> Result<Vec<Ray<f32>>> {
    let origins = Each::Rows(world.bodies().positions()?);
    Ray::all(&origins, &Each::One([1.0, 0.5]), &Each::One(0.0), Each::One(20.0))
}

fn some_ids(world: &World) -> Result<Vec<i64>> {
    let mut ids = world.bodies().ids()?;
    ids.retain(|id| id % 2 == 0);
    Ok(ids)
}

/// Whether an error says that there is no memory.
pub fn is_no_memory(error: &Error) -> bool {
    matches!(error, Error::NoMemory { .. })
}
