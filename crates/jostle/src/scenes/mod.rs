//! Named scenes from a seed, the same for tests, benchmarks and the simulator.
//!
//! Lengths are in pixels, times in seconds, y grows downwards; a step is 1/60 s. The size of a
//! scene depends on its number of particles. Immovable discs are additional and have the first
//! rows.

mod falling;
mod emitters;
mod fluid;
mod galton;
mod games;
mod gases;
mod heap;
mod life;
mod list;
mod machines;
mod mixing;
mod pinball;
mod placing;
pub mod random;
mod sand;
mod soft;
mod stars;

use crate::container::Container;
use crate::error::{Error, Result};
use crate::forces::Force;
use crate::forces::motor::turn;
use crate::particles::Particles;
use crate::walls::Wall;
use crate::world::{Defaults, World, WorldSettings};
pub use emitters::{Emitter, emitters};
pub use galton::{GaltonBoard, galton_board};
pub use list::SCENES;
pub use placing::wall;
use random::Random;

/// The length of a step in seconds for which scenes are designed.
pub const STEP: f64 = 1.0 / 60.0;

/// Maximum number of particles of a scene.
const MAX_COUNT: usize = 100_000_000;

/// A named scene.
pub struct Scene {
    /// Its name.
    pub name: &'static str,
    /// Default number of particles.
    pub default_count: usize,
    /// A description in two sentences.
    pub about: &'static str,
    make: fn(usize, &mut Random) -> Start,
    view: fn(usize) -> [f32; 4],
}

/// The initial state of a scene.
struct Start {
    particles: Particles,
    settings: WorldSettings,
    forces: Vec<Force>,
    walls: Vec<Wall>,
}

impl Start {
    fn new(particles: Particles, settings: WorldSettings) -> Self {
        Self { particles, settings, forces: Vec::new(), walls: Vec::new() }
    }

    fn with(mut self, force: Force) -> Self {
        self.forces.push(force);
        self
    }

    /// Adds walls between consecutive corners.
    fn walled(mut self, corners: &[[f32; 2]]) -> Self {
        self.walls.extend(corners.windows(2).map(|ends| Wall::new([ends[0], ends[1]])));
        self
    }
}

/// The scene called `name`.
pub fn find(name: &str) -> Result<&'static Scene> {
    SCENES.iter().find(|scene| scene.name == name).ok_or_else(|| {
        let names = SCENES.map(|scene| scene.name).join(", ");
        Error::of("name", format!("'{name}'"), &format!("the scenes are {names}"))
    })
}

impl Scene {
    /// Its world with `count` particles (`None`: the default number).
    pub fn create(&self, count: Option<usize>, seed: u64) -> Result<World> {
        let count = self.count(count)?;
        let start = (self.make)(count, &mut Random::new(seed));
        let friction = common_friction(&start.particles);
        let mut world = World::new(start.particles, start.settings)?;
        world.set_walls(start.walls)?;
        world.set_forces(start.forces)?;
        world.set_defaults(Defaults { friction, ..Defaults::default() })?;
        Ok(world)
    }

    /// The rectangle to display: min x, min y, max x, max y.
    pub fn view(&self, count: Option<usize>) -> Result<[f32; 4]> {
        Ok((self.view)(self.count(count)?))
    }

    fn count(&self, count: Option<usize>) -> Result<usize> {
        match count.unwrap_or(self.default_count) {
            count if count <= MAX_COUNT => Ok(count),
            count => Err(Error::of("n", count, &format!("a scene holds at most {MAX_COUNT}"))),
        }
    }
}

/// The common coefficient of friction of all particles; 0 if they differ.
fn common_friction(all: &Particles) -> f32 {
    let first = all.spin(0).friction;
    if all.spins.iter().all(|spin| spin.friction == first) { first } else { 0.0 }
}

/// The unit vector at an angle from +x towards +y, with the same bits on every machine.
fn direction(angle: f64) -> [f32; 2] {
    let [less, sine] = turn(angle);
    [(1.0 + less) as f32, sine as f32]
}

/// Area of a disc.
fn area_of(radius: f32) -> f32 {
    std::f32::consts::PI * radius * radius
}

/// Side of the square of which the area `covered` is the fraction `coverage`, at least `min`.
fn side_for(covered: f32, coverage: f32, min: f32) -> f32 {
    (covered / coverage).sqrt().max(min)
}

/// Default settings with a rectangular container.
fn boxed([min_x, min_y, max_x, max_y]: [f32; 4]) -> WorldSettings {
    let container = Container::Box { min: [min_x, min_y], max: [max_x, max_y] };
    WorldSettings { container, ..WorldSettings::default() }
}

impl std::fmt::Debug for Scene {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Scene").field("name", &self.name).finish_non_exhaustive()
    }
}
