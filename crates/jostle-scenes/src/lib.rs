//! Named scenes from a seed, the same for tests, benchmarks and the simulator.
//!
//! Lengths are in pixels, times in seconds, y grows downwards; a step is 1/60 s. The size of a
//! scene depends on its number of particles. Immovable discs are additional and have the first
//! rows.

#![warn(unreachable_pub)]
#![warn(clippy::disallowed_macros, clippy::disallowed_methods, clippy::disallowed_types)]

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

use std::ops::Range;

pub use emitters::{Emitter, emitters};
pub use galton::{GaltonBoard, galton_board};
use jostle_base::error::{Error, Result};
use jostle_world::container::Container;
use jostle_world::forces::Force;
use jostle_world::forces::motor::turn;
use jostle_world::particles::Particles;
use jostle_world::walls::Wall;
use jostle_world::world::{Defaults, World, WorldSettings};
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
    make: Make,
    view: fn(usize) -> [f32; 4],
}

/// A function that makes the initial state with a number of particles.
#[derive(Clone, Copy)]
enum Make {
    Whole(fn(usize, &mut Random) -> Start),
    /// It can make a range of the particles without the others.
    Parts(fn(usize, &mut Random, Range<usize>) -> Start),
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
        self.create_rows(self.count(count)?, seed, 0..usize::MAX)
    }

    /// The part of its world that has the particles of one of `size` ranks, with the settings of
    /// the whole. The parts of all ranks, one after the other, are the particles of
    /// [`Scene::create`]. Not all scenes can be made in parts; the others are made as a whole
    /// first.
    pub fn create_part(
        &self,
        count: Option<usize>,
        seed: u64,
        [rank, size]: [usize; 2],
    ) -> Result<World> {
        let count = self.count(count)?;
        let part = |len: usize| len * rank / size..len * (rank + 1) / size;
        if let Make::Parts(_) = self.make {
            return self.create_rows(count, seed, part(count));
        }
        let whole = self.create(Some(count), seed)?;
        whole.check_distributable()?;
        whole.part(part(whole.len()))
    }

    fn create_rows(&self, count: usize, seed: u64, rows: Range<usize>) -> Result<World> {
        let random = &mut Random::new(seed);
        let start = match self.make {
            Make::Whole(make) => make(count, random),
            Make::Parts(make) => make(count, random, rows),
        };
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
