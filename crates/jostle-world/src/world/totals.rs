//! Sums over the steps of a record: time, collisions, the virial of contacts, and the impulses of walls and sides.
//!
//! They are no part of the state. The sums of one process have the same bits for every number of threads, because
//! each step adds its contacts and impacts in their canonical order.

use crate::container::{Container, FIRST_SIDE, KNOWN_SIDES};
use crate::events::Bounce;
use crate::walls::index_of;
use jostle_base::bytes::damaged;
use jostle_base::error::Result;
use jostle_base::{memory, plain, saved};

/// Impacts with an impulse, in the order of time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Collisions {
    /// Those of two particles.
    pub pairs: u64,
    /// Those of a particle and a wall or the container.
    pub walls: u64,
}

plain! { Collisions { pairs, walls } }

/// Sums over the steps since a record began.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Totals {
    /// Their length in seconds.
    pub duration: f64,
    /// Their number.
    pub steps: u64,
    /// Impacts.
    pub collisions: Collisions,
    /// Σ r ⊗ J over the contacts of two particles, where r leads from the centre of one to that of the other, and J is
    /// the impulse on the other, friction included.
    pub virial: [[f64; 2]; 2],
    /// Of each side, in the order of [`Container::side_id`], the impulses on particles along the normal and of
    /// friction.
    pub sides: [[f64; 2]; KNOWN_SIDES],
    /// The impulses of each wall on particles; walls after the last one that gave any may be missing.
    pub walls: Vec<[f64; 2]>,
}

saved! { struct Totals { duration, steps, collisions, virial, sides, walls } }

impl Totals {
    /// Refuses sums that are no numbers, and those of walls that do not exist.
    pub(crate) fn check(&self, walls: usize) -> Result<()> {
        let all = self.virial.iter().chain(&self.sides).chain(&self.walls).flatten();
        if all.chain([&self.duration]).all(|sum| sum.is_finite()) && self.walls.len() <= walls {
            return Ok(());
        }
        Err(damaged("the sums of the last call are wrong"))
    }

    /// Leaves out the sums of walls that are removed.
    pub(super) fn keep_walls(&mut self, mut stays: impl Iterator<Item = bool>) {
        self.walls.retain(|_| stays.next().unwrap_or(false));
    }

    /// Makes room for the walls of a step, so that [`Totals::add`] cannot fail.
    pub(super) fn make_room(&mut self, step: &StepSums) -> Result<()> {
        let last = step.walls.iter().map(|(wall, _)| *wall as usize + 1).max();
        let len = self.walls.len().max(last.unwrap_or(0));
        memory::resize(&mut self.walls, len, [0.0; 2])
    }

    /// Adds the collisions and impulses of a step.
    pub(super) fn add(&mut self, step: &StepSums) {
        let Collisions { pairs, walls } = step.collisions;
        self.collisions.pairs = self.collisions.pairs.saturating_add(pairs);
        self.collisions.walls = self.collisions.walls.saturating_add(walls);
        let sums = self.virial.iter_mut().chain(&mut self.sides);
        for (sum, of_step) in sums.zip(step.virial.iter().chain(&step.sides)) {
            *sum = plus(*sum, *of_step);
        }
        for &(wall, impulse) in &step.walls {
            let sum = &mut self.walls[wall as usize];
            *sum = plus(*sum, impulse);
        }
    }
}

/// What an attempt at a step adds.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct StepSums {
    /// Its impacts.
    pub(crate) collisions: Collisions,
    virial: [[f64; 2]; 2],
    sides: [[f64; 2]; KNOWN_SIDES],
    /// Walls and impulses.
    walls: Vec<(u32, [f64; 2])>,
}

impl StepSums {
    /// Begins an attempt, and keeps the memory.
    pub(crate) fn clear(&mut self) {
        self.walls.clear();
        *self = Self { walls: std::mem::take(&mut self.walls), ..Self::default() };
    }

    /// Adds a bounce; `contact_distance` is the sum of both radii.
    pub(crate) fn add_bounce(
        &mut self,
        bounce: &Bounce,
        contact_distance: f64,
        container: &Container,
    ) -> Result<()> {
        // Predicted impacts that turned out to be touches without an impulse are no collisions.
        let is_impact = bounce.impulses[0] > 0.0;
        let normal = bounce.normal.map(f64::from);
        if bounce.is_with_wall() {
            self.collisions.walls += u64::from(is_impact);
            // The normal leads to the wall, and the impulse is that on the disc.
            let impulse = vector(normal.map(|v| -v), bounce.impulses);
            self.add_side(bounce.code, bounce.impulses, container);
            self.add_wall(bounce.code, impulse)
        } else {
            self.collisions.pairs += u64::from(is_impact);
            self.add_contact(contact_distance, normal, bounce.impulses);
            Ok(())
        }
    }

    /// Adds the impulses of a contact of two particles whose centres have a distance along a normal.
    pub(crate) fn add_contact(&mut self, distance: f64, normal: [f64; 2], impulses: [f32; 2]) {
        let impulse = vector(normal, impulses);
        for (row, n) in self.virial.iter_mut().zip(normal) {
            *row = plus(*row, impulse.map(|v| distance * n * v));
        }
    }

    /// Adds impulses along the normal and of friction, if the number is that of a side of the container.
    pub(crate) fn add_side(&mut self, number: u32, impulses: [f32; 2], container: &Container) {
        if index_of(number).is_none() {
            let side = (FIRST_SIDE - container.side_id(number)) as usize;
            self.sides[side] = plus(self.sides[side], impulses.map(f64::from));
        }
    }

    /// Adds an impulse on a particle, if the number is that of a wall.
    pub(crate) fn add_wall(&mut self, number: u32, impulse: [f64; 2]) -> Result<()> {
        index_of(number).map_or(Ok(()), |wall| memory::push(&mut self.walls, (wall, impulse)))
    }
}

/// The sum of impulses along a normal and along its tangent, a quarter turn from +x to +y.
pub(crate) fn vector([x, y]: [f64; 2], impulses: [f32; 2]) -> [f64; 2] {
    let [normal, friction] = impulses.map(f64::from);
    [normal * x - friction * y, normal * y + friction * x]
}

fn plus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}
