//! Seeded scenes by name, the same for tests, benchmarks and the simulator.
//!
//! Lengths are pixels, times seconds, y grows downwards; a step is 1/60 s. Every
//! scene takes any number of particles: its size follows.

mod falling;
mod games;
mod gases;
mod placing;
pub mod random;

use crate::container::Container;
use crate::error::{Error, Result};
use crate::particles::Particles;
use crate::world::{World, WorldSettings};
use random::Random;

/// The step that scenes are made for, seconds.
pub const STEP: f64 = 1.0 / 60.0;

/// Most particles that a scene is made with.
const MAX_COUNT: usize = 100_000_000;

/// A named scene.
pub struct Scene {
    /// What it is called.
    pub name: &'static str,
    /// Particles where none are asked for.
    pub default_count: usize,
    /// What to look at, in two sentences.
    pub about: &'static str,
    make: fn(usize, &mut Random) -> (Particles, WorldSettings),
    view: fn(usize) -> [f32; 4],
}

/// All scenes.
pub const SCENES: [Scene; 9] = [
    Scene {
        name: "article",
        default_count: 500,
        about: "The article's particles in its 800 × 500 window, under right physics. \
                Watch them come to rest, which the article's rules never let them do.",
        make: falling::article,
        view: falling::article_view,
    },
    Scene {
        name: "gas",
        default_count: 10_000,
        about: "Equal elastic discs over 40 % of the area. \
                Speeds that start out even soon spread as in a real gas, and the energy stays.",
        make: gases::gas,
        view: gases::gas_view,
    },
    Scene {
        name: "pile",
        default_count: 1_000,
        about: "Discs of radius 5 to 10 fall into a box and come to rest. \
                Look how little they overlap, even at the bottom.",
        make: falling::pile,
        view: falling::pile_view,
    },
    Scene {
        name: "rain",
        default_count: 2_000,
        about: "Drops fall in over time and fill the ground. \
                The tree deepens where they gather and stays shallow in the sky.",
        make: falling::rain,
        view: falling::rain_view,
    },
    Scene {
        name: "mixed",
        default_count: 5_000,
        about: "Radii from 1 to 100, every octave covering the same area. \
                One size of grid cell fits none of them; the tree does not mind.",
        make: gases::mixed,
        view: gases::mixed_view,
    },
    Scene {
        name: "clusters",
        default_count: 5_000,
        about: "Nine tenths of the discs start in a hundredth of the area. \
                Watch nine crowds burst and the tree's small boxes spread with them.",
        make: gases::clusters,
        view: gases::clusters_view,
    },
    Scene {
        name: "shots",
        default_count: 1_000,
        about: "Small shots at up to 3,000 px/s among pegs that nothing moves. \
                None ever passes through a peg or a wall.",
        make: games::shots,
        view: games::shots_view,
    },
    Scene {
        name: "billiards",
        default_count: 16,
        about: "A cue ball breaks a rack of balls. \
                Follow how the momentum of one spreads over all.",
        make: games::billiards,
        view: games::billiards_view,
    },
    Scene {
        name: "orbit",
        default_count: 2_000,
        about: "Discs swirl about the centre of a round container. \
                The wall has no friction, so the swirl never dies.",
        make: games::orbit,
        view: games::orbit_view,
    },
];

/// The scene called `name`.
pub fn find(name: &str) -> Result<&'static Scene> {
    SCENES.iter().find(|scene| scene.name == name).ok_or_else(|| {
        let names = SCENES.map(|scene| scene.name).join(", ");
        Error::of("name", format!("'{name}'"), &format!("the scenes are {names}"))
    })
}

impl Scene {
    /// Its world with `count` particles (`None`: as many as suit it).
    pub fn create(&self, count: Option<usize>, seed: u64) -> Result<World> {
        let count = self.count(count)?;
        let (particles, settings) = (self.make)(count, &mut Random::new(seed));
        World::new(particles, settings)
    }

    /// The part of its world to look at: min x, min y, max x, max y.
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

/// Area of a disc.
fn area_of(radius: f32) -> f32 {
    std::f32::consts::PI * radius * radius
}

/// Side of the square of which `covered` is the share `coverage`.
fn side_for(covered: f32, coverage: f32, least: f32) -> f32 {
    (covered / coverage).sqrt().max(least)
}

/// The default rules inside four walls.
fn boxed([min_x, min_y, max_x, max_y]: [f32; 4]) -> WorldSettings {
    let container = Container::Box { min: [min_x, min_y], max: [max_x, max_y] };
    WorldSettings { container, ..WorldSettings::default() }
}

impl std::fmt::Debug for Scene {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Scene").field("name", &self.name).finish_non_exhaustive()
    }
}
