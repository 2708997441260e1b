//! The motions of the shapes that slide in a call.
//!
//! Shapes whose paths may meet form an island, and so do a shape and the moving floor on which it
//! stands. The shapes of an island move one after another, in the order of the call, but a floor
//! before what stands on it. Islands move in parallel. So results do not depend on threads, nor on
//! the order of shapes that do not meet.

use super::call::Call;
use super::islands::{Islands, join_overlapping};
use super::motions::{Island, Memory, Walk, union};
use crate::disjoint_sets::DisjointSets;
use crate::error::Result;
use crate::geometry::Scalar;
use crate::interrupt::{Pulse, Stop};
use crate::memory;
use crate::parallel;
use crate::slide::contains;

/// Number of islands of a task.
const ISLANDS_PER_TASK: usize = 32;

/// Minimum number of shapes for which threads that are awake are used, and are woken.
const WORTH_SHARING: usize = 64;
const WORTH_WAKING: usize = 512;

impl<T: Scalar> Call<'_, T> {
    /// Moves all shapes. If one gets beyond the region by which its island was chosen, because it
    /// was deep inside an obstacle or its floor moved far, its region grows and all is repeated.
    pub fn run(&self, threads: Option<usize>) -> Result<Vec<Walk<T>>> {
        let meets = |&slot: &u32| self.slots.shape(slot).category & self.rules.mask != 0;
        let may_meet = self.walkers.len() > 1 && self.walkers.iter().any(meets);
        let rows = if may_meet { self.walkers.len() } else { 0 };
        let mut regions = memory::collect((0..rows).map(|row| self.region(row)))?;
        let mut sets = self.riders();
        loop {
            self.join_meeting(&mut sets, &regions)?;
            let islands = Islands::of(&mut sets, self.walkers.len())?;
            let walks = self.walk_islands(&islands, threads)?;
            let mut is_done = true;
            for walk in walks.iter().filter(|_| may_meet) {
                if !contains(regions[walk.row], walk.seen) {
                    is_done = false;
                    regions[walk.row] = union(regions[walk.row], walk.seen);
                }
            }
            if is_done {
                return Ok(walks);
            }
        }
    }

    /// Merges the sets of the rows whose regions overlap, each of which has images in a periodic
    /// plane: two regions overlap if, in the first period, two of their images do.
    fn join_meeting(&self, sets: &mut DisjointSets, regions: &[[[T; 2]; 2]]) -> Result<()> {
        if self.period.is_none() {
            return join_overlapping(sets, regions);
        }
        let (mut boxes, mut rows) = (Vec::new(), Vec::new());
        let sides = self.period.sides();
        for (row, &[min, max]) in regions.iter().enumerate() {
            for turns in self.period.images_near(min, max) {
                let shift = self.period.span(turns);
                let image = [min, max].map(|end| [end[0] - shift[0], end[1] - shift[1]]);
                let is_in_first = |axis: usize| {
                    let [low, high] = image.map(|end| end[axis]);
                    !self.period.is_along(axis) || (low <= sides[axis] && high >= T::ZERO)
                };
                if is_in_first(0) && is_in_first(1) {
                    memory::push(&mut boxes, image)?;
                    memory::push(&mut rows, row as u32)?;
                }
            }
        }
        let mut images = DisjointSets::default();
        images.reset(boxes.len());
        join_overlapping(&mut images, &boxes)?;
        (0..boxes.len()).for_each(|image| {
            let root = images.root(image as u32);
            sets.join(rows[image], rows[root as usize]);
        });
        Ok(())
    }

    fn walk_islands(&self, islands: &Islands, threads: Option<usize>) -> Result<Vec<Walk<T>>> {
        let len = self.walkers.len();
        let threads = parallel::threads_for(threads, len, WORTH_SHARING, WORTH_WAKING);
        let stop = Stop::current();
        let parts = parallel::map(threads, islands.len().div_ceil(ISLANDS_PER_TASK), |part| {
            let mut pulse = Pulse::of(&stop);
            let mut walks = Vec::new();
            let mut scratch = Scratch::default();
            let first = part * ISLANDS_PER_TASK;
            for island in first..islands.len().min(first + ISLANDS_PER_TASK) {
<<<<<<< HEAD
                self.walk_island(islands.rows(island), (&mut scratch, &mut pulse), &mut walks)?;
=======
                let (call, rows, memory) = (self, islands.rows(island), &mut memory);
                Island { call, rows, memory }.run(&mut pulse, &mut walks)?;
>>>>>>> slide
            }
            Ok(walks)
        });
        let mut all = memory::with_room(len)?;
        for part in parts {
            all.extend(part?);
        }
        Ok(all)
    }

    /// The sets of the walkers that stand on each other.
    fn riders(&self) -> DisjointSets {
        let len = self.walkers.len();
        let mut sets = DisjointSets::default();
        sets.reset(len);
        for row in 0..len {
            if let Some(floor) = self.moving_floor(row) {
                sets.join(row as u32, floor);
            }
        }
        sets
    }

    /// A box that contains all positions that a shape may take, with room for its rounding, unless
    /// it leaves an obstacle from far inside, or its floor is carried too.
    fn region(&self, row: usize) -> [[T; 2]; 2] {
        let (shape, displacement) = (self.body(row), self.displacements[row]);
        let sum = |v: [T; 2]| v[0].abs() + v[1].abs();
        let carried = self.ride(row).map_or(T::ZERO, |(floor, before)| {
            let now = self.slots.shape(floor).center();
            let own = self.moving_floor(row).map(|row| sum(self.displacements[row as usize]));
            sum(self.carried(now, before)) + own.unwrap_or(T::ZERO)
        });
        let length = sum(displacement) + carried;
        let extent = [0, 1].map(|axis| shape.half_size[axis] + shape.radius);
        let size = sum(shape.min) + sum(self.period.sides()) + length + sum(extent);
        let room = length + extent[0] + extent[1] + size * T::EPSILON * T::from_f64(256.0);
        let [x, y] = shape.min;
        let reach = [extent[0] + room, extent[1] + room];
        [[x - reach[0], y - reach[1]], [x + reach[0], y + reach[1]]]
    }
<<<<<<< HEAD

    /// The shape of a row, by its centre.
    fn body(&self, row: usize) -> Shape<T> {
        let shape = self.slots.shape(self.walkers[row]);
        let center = shape.center();
        Shape { min: center, max: center, half_size: shape.core_half_size(), ..shape }
    }

    /// The floor on which a row stood after its last motion, and its centre then.
    fn ride(&self, row: usize) -> Option<(u32, [T; 2])> {
        let slot = self.walkers[row];
        let ride = self.rides.all[slot as usize].filter(|ride| ride.id == self.slots.id(slot))?;
        Some((self.slots.slot(ride.floor)?, ride.center))
    }

    /// How far a floor has moved, the shorter way around.
    fn carried(&self, now: [T; 2], before: [T; 2]) -> [T; 2] {
        self.period.shortest([now[0] - before[0], now[1] - before[1]])
    }

    /// The row of the floor of a row, if it moves in this call too.
    fn moving_floor(&self, row: usize) -> Option<u32> {
        let (floor, _) = self.ride(row)?;
        Some(self.rides.rows[floor as usize]).filter(|&row| row != NONE)
    }

    /// Whether a row stands on another one that moves, or on one that stands on it, and so on.
    fn stands_on(&self, rider: u32, floor: u32) -> bool {
        let mut next = self.moving_floor(rider as usize);
        // The chain may be a ring.
        for _ in 0..MOST_STACKED {
            match next {
                Some(row) if row != floor => next = self.moving_floor(row as usize),
                found => return found.is_some(),
            }
        }
        false
    }

    /// Moves the shapes of an island one after another.
    fn walk_island(
        &self,
        rows: &[u32],
        (scratch, pulse): (&mut Scratch<T>, &mut Pulse),
        walks: &mut Vec<Walk<T>>,
    ) -> Result<()> {
        let Scratch { near, stack, crowd, order, waiting } = scratch;
        crowd.fill(rows.iter().map(|&row| self.body(row as usize)))?;
        self.order(rows, order, waiting)?;
        for &index in &order[..] {
            let (index, row) = (index as usize, rows[index as usize] as usize);
            let center_of = |slot: u32| match self.rides.rows[slot as usize] {
                NONE => self.slots.shape(slot).center(),
                row => match rows.binary_search(&row) {
                    Ok(index) => crowd.get(index).min,
                    Err(_) => self.slots.shape(slot).center(),
                },
            };
            let carried = self
                .ride(row)
                .map(|(floor, before)| (self.carried(center_of(floor), before), floor));
            let mut find = |bounds: &Bounds<T>, near: &mut Vec<Obstacle<T>>| {
                for turns in self.period.images_near(bounds.min, bounds.max) {
                    let bounds = &bounds.moved(self.period.span(turns));
                    self.find(bounds, turns, stack, near);
                    crowd.each_near(bounds, |other, body| {
                        // What stands on it is carried with it, and does not stop it.
                        if other != index && !self.stands_on(rows[other], row as u32) {
                            let slot = self.walkers[rows[other] as usize];
                            near.push(Obstacle { solid: Solid::Shape(*body), turns, index: slot });
                        }
                    });
                }
            };
            let rules = (self.rules, self.period);
            let mut walker = Walker::new(rules, *crowd.get(index), near, &mut find);
            if let Some((displacement, floor)) = carried
                && displacement != [T::ZERO; 2]
            {
                walker.carry(displacement, floor);
            }
            walker.leave_obstacles();
            walker.slide(self.displacements[row]);
            let floor = walker.last_of(Surface::Floor);
            let kinds = [Surface::Floor, Surface::Wall, Surface::Ceiling]
                .map(|kind| walker.last_of(kind).is_some());
            let (center, remaining, seen) = (walker.center(), walker.remaining, walker.seen);
            let hits = std::mem::take(&mut walker.hits);
            pulse.check(WORK + near.len())?;
            let still = |slot: u32| if slot & WALL == 0 { center_of(slot) } else { center };
            let floor = floor.map(|slot| (slot, still(slot)));
            crowd.move_to(index, self.period.wrap(center));
            memory::push(walks, Walk { row, center, remaining, hits, floor, kinds, seen })?;
        }
        Ok(())
    }

    /// Lists the indices of the rows of an island in the order in which they move: a floor before
    /// what stands on it, otherwise ascending.
    fn order(&self, rows: &[u32], order: &mut Vec<u32>, waiting: &mut Vec<u32>) -> Result<()> {
        order.clear();
        memory::reserve(order, rows.len())?;
        if rows.iter().all(|&row| self.moving_floor(row as usize).is_none()) {
            order.extend(0..rows.len() as u32);
            return Ok(());
        }
        let mut listed = memory::filled(rows.len(), false)?;
        for index in 0..rows.len() {
            let mut next = Some(index);
            // A floor that is listed or waits already ends the chain, also if it is a ring.
            while let Some(index) = next.filter(|&index| !listed[index]) {
                listed[index] = true;
                memory::push(waiting, index as u32)?;
                let floor = self.moving_floor(rows[index] as usize);
                next = floor.and_then(|row| rows.binary_search(&row).ok());
            }
            while let Some(index) = waiting.pop() {
                order.push(index);
            }
        }
        Ok(())
    }

    /// Lists the images of obstacles that do not move in this call, in a region that is moved by
    /// minus these periods.
    fn find(
        &self,
        bounds: &Bounds<T>,
        turns: Turns,
        stack: &mut Vec<u32>,
        near: &mut Vec<Obstacle<T>>,
    ) {
        for index in self.layers.indices() {
            let (tree, slot) = self.layers.layer(index);
            each_overlap(tree, bounds, -T::INFINITY, stack, |place| {
                if let Some(slot) = slot(tree.rows()[place])
                    && self.rides.rows[slot as usize] == NONE
                {
                    let solid = Solid::Shape(tree.columns().shape(place));
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
        self.walls.each_near(bounds, stack, |index, ends| {
            near.push(Obstacle { solid: Solid::Segment(ends), turns, index: WALL | index });
        });
    }
}

/// Whether a shape may overlap a region, and their filters allow it.
fn meets<T: Scalar>(region: &Bounds<T>, shape: &Shape<T>) -> bool {
    Bounds::of(shape).overlaps(region, [T::ZERO; 2], -T::INFINITY)
}

/// Memory of a task.
struct Scratch<T> {
    near: Vec<Obstacle<T>>,
    stack: Vec<u32>,
    crowd: Crowd<T>,
    order: Vec<u32>,
    waiting: Vec<u32>,
}

impl<T> Default for Scratch<T> {
    fn default() -> Self {
        let (near, stack, crowd) = (Vec::new(), Vec::new(), Crowd::default());
        Self { near, stack, crowd, order: Vec::new(), waiting: Vec::new() }
    }
=======
>>>>>>> slide
}
