//! A call of [`Space::move_and_slide`](super::Space::move_and_slide): its arguments, and the
//! shapes.

use super::layers::Layers;
use super::rides::{NONE, Rides};
use super::slots::Slots;
use super::walls::Walls;
use crate::geometry::{Bounds, Scalar, Shape};
use crate::period::{Period, Turns};
use crate::query::each_overlap;
use crate::slide::{Obstacle, SlideRules, Solid};

/// The bit in the index of an obstacle that marks a wall; without it the index is a slot.
pub const WALL: u32 = 1 << 31;

/// What all islands of a call have in common.
pub struct Call<'a, T> {
    /// The shapes.
    pub slots: &'a Slots<T>,
    /// Their trees.
    pub layers: &'a Layers<T>,
    /// The line segments.
    pub walls: &'a Walls<T>,
    /// The floors on which shapes stand.
    pub rides: &'a Rides<T>,
    /// The period of the plane.
    pub period: Period<T>,
    /// How shapes slide.
    pub rules: &'a SlideRules<T>,
    /// The shapes that move.
    pub walkers: &'a [u32],
    /// The displacement of each walker.
    pub displacements: &'a [[T; 2]],
    /// Obstacles that are in no tree.
    pub fresh: &'a [u32],
}

impl<T: Scalar> Call<'_, T> {
    /// The shape of a row, by its centre.
    pub fn body(&self, row: usize) -> Shape<T> {
        let shape = self.slots.shape(self.walkers[row]);
        let center = shape.center();
        Shape { min: center, max: center, half_size: shape.core_half_size(), ..shape }
    }

    /// The floor on which a row stood after its last motion, and its centre then.
    pub fn ride(&self, row: usize) -> Option<(u32, [T; 2])> {
        let slot = self.walkers[row];
        let ride = self.rides.all[slot as usize].filter(|ride| ride.id == self.slots.id(slot))?;
        Some((self.slots.slot(ride.floor)?, ride.center))
    }

    /// The minimum image of the displacement of a floor.
    pub fn carried(&self, now: [T; 2], before: [T; 2]) -> [T; 2] {
        self.period.minimum_image([now[0] - before[0], now[1] - before[1]])
    }

    /// The row of the floor of a row, if it moves in this call too.
    pub fn moving_floor(&self, row: usize) -> Option<u32> {
        let (floor, _) = self.ride(row)?;
        Some(self.rides.rows[floor as usize]).filter(|&row| row != NONE)
    }

    /// Lists the images of obstacles that do not move in this call, in a region that is moved by
    /// minus these periods.
    pub fn find(
        &self,
        bounds: &Bounds<T>,
        turns: Turns,
        stack: &mut Vec<u32>,
        near: &mut Vec<Obstacle<T>>,
    ) {
        for number in self.layers.indices() {
            let (tree, slot) = self.layers.layer(number);
            each_overlap(tree, bounds, -T::INFINITY, stack, |index| {
                if let Some(slot) = slot(tree.rows()[index])
                    && self.rides.rows[slot as usize] == NONE
                {
                    let solid = Solid::Shape(tree.columns().shape(index));
                    near.push(Obstacle { solid, turns, index: slot });
                }
            });
        }
        for &slot in self.fresh {
            let shape = self.slots.shape(slot);
            if meets(bounds, &shape) {
                near.push(Obstacle { solid: Solid::Shape(shape), turns, index: slot });
            }
        }
        self.walls.each_near(bounds, stack, |wall, ends| {
            near.push(Obstacle { solid: Solid::Segment(ends), turns, index: WALL | wall });
        });
    }
}

/// Whether a shape may overlap a region, and their filters allow it.
fn meets<T: Scalar>(region: &Bounds<T>, shape: &Shape<T>) -> bool {
    Bounds::of(shape).overlaps(region, [T::ZERO; 2], -T::INFINITY)
}
