//! A scene: its name, and the world that it makes.

use std::ops::Range;

use super::random::Random;
use super::start::Start;
use jostle_base::error::{Error, Result};
#[cfg(feature = "ranks")]
use jostle_world::ranks;
use jostle_world::world::World;

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
    pub(crate) make: Make,
    pub(crate) view: fn(usize) -> [f32; 4],
}

/// A function that makes the initial state with a number of particles.
#[derive(Clone, Copy)]
pub(crate) enum Make {
    Whole(fn(usize, &mut Random) -> Result<Start>),
    /// It can make a range of the particles without the others.
    Parts(fn(usize, &mut Random, Range<usize>) -> Result<Start>),
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
    #[cfg(feature = "ranks")]
    pub fn create_part(
        &self,
        count: Option<usize>,
        seed: u64,
        [rank, size]: [usize; 2],
    ) -> Result<World> {
        let count = self.count(count)?;
        let part = |len: usize| len * rank / size..len * (rank + 1) / size;
        // No rank needs memory for the whole.
        if let Make::Parts(_) = self.make {
            return self.create_rows(count, seed, part(count));
        }
        let whole = self.create(Some(count), seed)?;
        ranks::check_distributable(&whole)?;
        ranks::part(&whole, part(whole.len()))
    }

    fn create_rows(&self, count: usize, seed: u64, rows: Range<usize>) -> Result<World> {
        let random = &mut Random::new(seed);
        let start = match self.make {
            Make::Whole(make) => make(count, random)?,
            Make::Parts(make) => make(count, random, rows)?,
        };
        let mut world = World::new(start.particles, start.settings)?;
        world.set_walls(start.walls)?;
        world.set_forces(start.forces)?;
        Ok(world)
    }

    /// The rectangle to display: min x, min y, max x, max y.
    pub fn view(&self, count: Option<usize>) -> Result<[f32; 4]> {
        Ok((self.view)(self.count(count)?))
    }

    fn count(&self, count: Option<usize>) -> Result<usize> {
        checked(count.unwrap_or(self.default_count))
    }
}

/// A number of particles. Refuses more than a scene may have.
pub(crate) fn checked(count: usize) -> Result<usize> {
    if count <= MAX_COUNT {
        return Ok(count);
    }
    Err(Error::of("n", count, &format!("a scene holds at most {MAX_COUNT}")))
}

impl std::fmt::Debug for Scene {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Scene").field("name", &self.name).finish_non_exhaustive()
    }
}
