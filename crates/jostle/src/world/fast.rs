//! Few fast particles on a torus.
//!
//! In one part of a step no particle may move further than an eighth of a torus, because it could
//! collide with images that the search does not list. So a fast particle needs many parts. If only
//! few are fast, they are held while all others make the step. Then they move, in parts of their
//! own, among the others, which do not move. Each moves until its first hit: both particles
//! get new velocities, and the rest of its displacement is lost. So only the fast particles and
//! their neighbours are computed in the additional parts.

use std::cmp::Ordering;

use super::step::MAX_PARTS;
use super::{OnTouch, World, WorldSettings};
use crate::error::{Error, Result};
use crate::particles::Particles;
use crate::quadtree::Quadtree;
use crate::query::{self, Rect};
use crate::shapes::{Each, Shapes};

/// Up to this number of parts, the step of all particles is divided.
const FEW_PARTS: f32 = 8.0;

/// Particles are held if they are fewer than one in this number.
const HELD_SHARE: usize = 64;

/// Scratch for the fast particles.
#[derive(Debug, Default)]
pub(super) struct FastMemory {
    /// Whether the particle in each row is held during the step; empty if none is.
    pub(super) held: Vec<bool>,
    tree: Quadtree<f32>,
    near: Option<Box<World>>,
}

/// The particles that still move, by place, and bounds of the others, which do not move.
#[derive(Debug, Default)]
struct Moving {
    moves: Vec<bool>,
    places: Vec<u32>,
    fastest_other: f32,
    largest_other: f32,
}

impl World {
    /// Chooses the particles that make their own parts of a step of `dt` seconds; without that
    /// all particles would need `parts`. Returns whether there are any.
    pub(super) fn hold_the_fast(&mut self, dt: f32, parts: f32) -> bool {
        self.memory.fast.held.clear();
        // Merging changes rows, which the small world cannot pass back.
        if parts <= FEW_PARTS || self.settings.on_touch == OnTouch::Merge {
            return false;
        }
        let most = FEW_PARTS * self.settings.container.reach();
        let is_fast = |place: usize| self.way(place, dt) > most;
        let count = (0..self.len()).filter(|&place| is_fast(place)).count();
        if count == 0 || count * HELD_SHARE >= self.len() {
            return false;
        }
        let mut held = vec![false; self.len()];
        self.rows.iter().enumerate().for_each(|(place, &row)| {
            held[row as usize] = is_fast(place);
        });
        self.memory.fast.held = held;
        true
    }

    /// Whether the particle in a row is held.
    pub(super) fn is_held(&self, row: u32) -> bool {
        self.memory.fast.held.get(row as usize).is_some_and(|&held| held)
    }

    /// Moves the held particles for `dt` seconds.
    pub(super) fn move_the_held(&mut self, dt: f32) -> Result<()> {
        if self.memory.fast.held.is_empty() {
            return Ok(());
        }
        let mut tree = std::mem::take(&mut self.memory.fast.tree);
        let mut near = self.memory.fast.near.take().unwrap_or_default();
        let done = self.move_held(&mut tree, &mut near, dt);
        let fast = &mut self.memory.fast;
        (fast.tree, fast.near) = (tree, Some(near));
        done
    }

    fn move_held(&mut self, tree: &mut Quadtree<f32>, near: &mut World, dt: f32) -> Result<()> {
        let mut moving = Moving::default();
        for (place, &row) in (0..).zip(&self.rows) {
            let ([u, v], radius) =
                (self.particles.velocities[place as usize], self.particles.radii[place as usize]);
            moving.moves.push(self.is_held(row));
            if self.is_held(row) {
                moving.places.push(place);
            } else {
                moving.fastest_other = moving.fastest_other.max(u.abs().max(v.abs()));
                moving.largest_other = moving.largest_other.max(radius);
            }
        }
        let settings = WorldSettings { gravity: [0.0; 2], drag: 0.0, ..self.settings };
        near.configure_empty(settings)?;
        let shapes = Shapes {
            centers: self.particles.positions.clone(),
            radii: Each::Rows(self.particles.radii.clone()),
            ..Shapes::default()
        };
        tree.rebuild(&shapes, settings.tree, &|_, _| Ordering::Equal)?;
        let (mut left, mut turns) = (f64::from(dt), 0.0);
        while !moving.places.is_empty() {
            let ways = moving.places.iter().map(|&place| {
                let [u, v] = self.particles.velocities[place as usize];
                u.abs().max(v.abs()) * left as f32
            });
            let longest = ways.fold(0.0, f32::max);
            let parts = (longest / settings.container.reach()).ceil().max(1.0);
            turns += 1.0;
            if turns + parts > 4.0 * MAX_PARTS {
                let row = moving.places.iter().map(|&place| self.rows[place as usize]).min();
                return Err(too_many_tours(dt, row.unwrap_or(0), parts));
            }
            let h = (left / f64::from(parts)) as f32;
            let places = self.near(tree, &moving, h)?;
            self.move_once(near, &places, &mut moving, h)?;
            if parts == 1.0 {
                break;
            }
            left -= left / f64::from(parts);
        }
        Ok(())
    }

    /// Moves the particles for `h` seconds in a small world of the particles in `places`.
    fn move_once(
        &mut self,
        near: &mut World,
        places: &[u32],
        moving: &mut Moving,
        h: f32,
    ) -> Result<()> {
        near.fill(&self.particles, places);
        near.begin();
        near.memory.exhausted.clear();
        near.step_once(h, near.substeps(), &mut |_| ()).map_err(|error| match error {
            Error::NotFinite { argument, index, value } => {
                let index = self.rows[places[index] as usize] as usize;
                Error::NotFinite { argument, index, value }
            }
            other => other,
        })?;
        let Particles { positions, velocities, .. } = &near.particles;
        for ((position, velocity), &row) in positions.iter().zip(velocities).zip(&near.rows) {
            let place = places[row as usize] as usize;
            let hit = self.particles.velocities[place] != *velocity;
            self.particles.velocities[place] = *velocity;
            // The other particles have already made their step.
            if moving.moves[place] {
                self.particles.positions[place] = *position;
                moving.moves[place] = !hit;
            }
        }
        let Moving { moves, places, .. } = moving;
        places.retain(|&place| moves[place as usize]);
        Ok(())
    }

    /// The places of the moving particles and of their candidates within `h` seconds, ascending.
    fn near(&self, tree: &Quadtree<f32>, moving: &Moving, h: f32) -> Result<Vec<u32>> {
        let Particles { positions, velocities, radii, .. } = &self.particles;
        let mut places = moving.places.clone();
        places.sort_unstable();
        if self.settings.on_touch == OnTouch::Ignore {
            return Ok(places);
        }
        // Margin of the bounds of the particles that do not move, see `World::bound`.
        let margin = moving.fastest_other * h + moving.largest_other;
        let offsets = [[0.0; 2]].into_iter().chain(self.settings.container.images());
        let offsets: Vec<[f32; 2]> =
            offsets.flat_map(|[x, y]| [[x, y], [-x, -y]]).skip(1).collect();
        let windows = places.iter().flat_map(|&place| {
            let place = place as usize;
            let [position, velocity] = [positions[place], velocities[place]];
            let reach = radii[place] + margin;
            let low = [0, 1].map(|k| position[k] + (velocity[k] * h).min(0.0) - reach);
            let high = [0, 1].map(|k| position[k] + (velocity[k] * h).max(0.0) + reach);
            offsets
                .iter()
                .map(move |by| [low[0] + by[0], low[1] + by[1], high[0] + by[0], high[1] + by[1]])
        });
        let windows = Rect::all(&windows.collect::<Vec<_>>())?;
        places.extend(query::search(tree, &windows, None)?.ids);
        places.sort_unstable();
        places.dedup();
        Ok(places)
    }

    /// Takes the settings, without particles.
    fn configure_empty(&mut self, settings: WorldSettings) -> Result<()> {
        self.fill(&Particles::default(), &[]);
        self.configure(settings)
    }

    /// Replaces all particles by copies of those in `places`.
    fn fill(&mut self, all: &Particles, places: &[u32]) {
        self.particles.gather(all, places, Some(1));
        self.rows = (0..places.len() as u32).collect();
        self.wall_pushes.clear();
        self.wall_pushes.resize(places.len(), Default::default());
        self.contacts.recall(Vec::new(), places.len());
    }
}

/// The error of a step in which a particle would circle a torus too often.
pub(super) fn too_many_tours(dt: f32, row: u32, parts: f32) -> Error {
    let tours = parts / 8.0;
    let rule = format!("particle {row} would circle the torus {tours} times; take smaller steps");
    Error::of("dt", dt, &rule)
}
