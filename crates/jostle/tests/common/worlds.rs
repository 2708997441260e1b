//! Worlds of tests in a line each: discs, walls and settings, worlds of them, and their steps.

pub use jostle_scenes::STEP;
use jostle_scenes::random::Random;
use jostle_world::{Container, Influence, Particles, Surface, Wall, World, WorldSettings};

/// Position and velocity of a disc.
pub type Row = ([f32; 2], [f32; 2]);

/// Discs of one radius and of density 1.
pub fn discs(rows: &[Row], radius: f32) -> Particles {
    let (positions, velocities): (Vec<_>, Vec<_>) = rows.iter().copied().unzip();
    Particles::new(positions, velocities, vec![radius; rows.len()], 1.0)
}

/// Discs of one radius and of density 1, without velocities.
pub fn still(positions: &[[f32; 2]], radius: f32) -> Particles {
    let len = positions.len();
    Particles::new(positions.to_vec(), vec![[0.0; 2]; len], vec![radius; len], 1.0)
}

/// The particles with one coefficient of friction.
pub fn with_friction(mut all: Particles, friction: f32) -> Particles {
    all.spins_mut().iter_mut().for_each(|spin| spin.friction = friction);
    all
}

/// The particles with one coefficient of restitution.
pub fn bouncing(mut all: Particles, restitution: f32) -> Particles {
    all.restitution.fill(restitution);
    all
}

/// The rows `order` of some particles.
pub fn gathered(all: &Particles, order: &[u32]) -> Particles {
    let mut some = Particles::default();
    some.gather(all, order, None);
    some
}

/// A permutation of 0..len.
pub fn shuffled(len: usize, seed: u64) -> Vec<u32> {
    let mut random = Random::new(seed);
    let mut order: Vec<u32> = (0..len as u32).collect();
    for last in (1..len).rev() {
        order.swap(last, random.whole(0, last as u32) as usize);
    }
    order
}

/// A surface with a coefficient of restitution, and the friction of the discs.
pub fn surface(restitution: f32) -> Surface {
    Surface { restitution: Some(restitution), friction: None }
}

/// A wall between two points.
pub fn wall(a: [f32; 2], b: [f32; 2]) -> Wall {
    Wall::new([a, b])
}

/// A wall with a velocity.
pub fn moving(ends: [[f32; 2]; 2], velocity: [f32; 2]) -> Wall {
    Wall { velocity, ..Wall::new(ends) }
}

/// Walls from each point to the next.
pub fn chain(points: &[[f32; 2]]) -> Vec<Wall> {
    points.windows(2).map(|two| wall(two[0], two[1])).collect()
}

/// The sides of a polygon.
pub fn closed(points: &[[f32; 2]]) -> Vec<Wall> {
    let mut all = chain(points);
    all.push(wall(points[points.len() - 1], points[0]));
    all
}

/// A rectangular container.
pub fn boxed(min: [f32; 2], max: [f32; 2]) -> Container {
    Container::Box { min, max }
}

/// Settings with a container.
pub fn inside(container: Container) -> WorldSettings {
    WorldSettings { container, ..WorldSettings::default() }
}

/// Settings with gravity towards −y.
pub fn falling() -> WorldSettings {
    WorldSettings { gravity: [0.0, -9.8], ..WorldSettings::default() }
}

/// A world of particles and settings that are valid.
pub fn world_of(all: Particles, settings: WorldSettings) -> World {
    World::new(all, settings).expect("the particles and settings of a test are valid")
}

/// A world with walls.
pub fn walled(all: Particles, walls: Vec<Wall>, settings: WorldSettings) -> World {
    let mut world = world_of(all, settings);
    world.set_walls(walls).expect("the walls of a test are valid");
    world
}

/// A world with forces.
pub fn forced(all: Particles, forces: Vec<Influence>, settings: WorldSettings) -> World {
    let mut world = world_of(all, settings);
    world.set_forces(forces).expect("the forces of a test are valid");
    world
}

/// Changes the settings of a world.
pub fn change(world: &mut World, change: impl Fn(&mut WorldSettings)) {
    let mut settings = *world.settings();
    change(&mut settings);
    world.configure(settings).expect("the settings of a test are valid");
}

/// Makes steps of 1/60 s.
pub fn run(world: &mut World, steps: usize) {
    run_for(world, STEP, steps);
}

/// Makes steps of `dt` seconds.
pub fn run_for(world: &mut World, dt: f64, steps: usize) {
    world.step(dt, steps).expect("a step succeeds");
}

/// The world of its own snapshot.
pub fn restored(world: &World) -> World {
    World::restore(&world.snapshot().unwrap()).expect("its own snapshot can be restored")
}
