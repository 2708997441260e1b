//! Shapes of a space that move and slide along others.
//!
//! Shapes whose paths may meet form an island, and so do a shape and the moving floor on which it
//! stands. The shapes of an island move one after another, in the order of the call, but a floor
//! before what stands on it. Islands move in parallel. So results do not depend on threads, nor on
//! the order of shapes that do not meet.

use super::Space;
use super::crowd::Crowd;
use super::islands::{Islands, join_overlapping};
use super::layers::Layers;
use super::saved::Saved;
use super::slots::{Id, Slots};
use super::walls::Walls;
use crate::disjoint_sets::DisjointSets;
use crate::error::{Error, Result};
use crate::geometry::{Bounds, Scalar, Shape};
use crate::interrupt::{Pulse, Stop};
use crate::memory;
use crate::parallel;
use crate::query::each_overlap;
use crate::shapes::check_finite;
use crate::slide::{Obstacle, SlideHit, SlideRules, Solid, Surface, Walker, contains};

/// Number of islands of a task.
const ISLANDS_PER_TASK: usize = 32;

/// Minimum number of shapes for which threads that are awake are used, and are woken.
const WORTH_SHARING: usize = 64;
const WORTH_WAKING: usize = 512;

/// With more fresh obstacles than this, a tree of them is faster than testing each.
const FEW: usize = 64;

/// Work of a walk, in the units of [`Pulse`].
const WORK: usize = 256;

/// Shapes that stand on each other, up to this number, do not stop the lowest one.
const MOST_STACKED: usize = 64;

/// The bit of the index of an obstacle that is a wall and not a slot.
const WALL: u32 = 1 << 31;

/// A slot that is no walker.
const NONE: u32 = u32::MAX;

/// The result of [`Space::move_and_slide`]; one value for each shape, in the order of the call.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Slides<T> {
    /// How far each shape has moved.
    pub displacements: Vec<[T; 2]>,
    /// The displacements that were asked for, without their components into the obstacles met.
    pub remaining: Vec<[T; 2]>,
    /// Whether a floor was met.
    pub on_floor: Vec<bool>,
    /// Whether a wall was met.
    pub on_wall: Vec<bool>,
    /// Whether a ceiling was met.
    pub on_ceiling: Vec<bool>,
    /// The last floor met; −1 if there is none. The wall with the index k has the number −2 − k.
    pub floors: Vec<Id>,
    /// Index of the first hit of each shape, and the total number of hits.
    pub offsets: Vec<usize>,
    /// The ids of the obstacles met by each shape, in the order in which they were met, walls as
    /// in `floors`.
    pub ids: Vec<Id>,
    /// The normal of each obstacle where it was met.
    pub normals: Vec<[T; 2]>,
}

/// The floors on which shapes stood after they moved, so that moving floors carry them.
#[derive(Clone, Debug)]
pub(super) struct Rides<T> {
    /// For each slot.
    all: Vec<Option<Ride<T>>>,
    /// The row of each slot in a call; [`NONE`] between calls.
    rows: Vec<u32>,
}

impl<T> Default for Rides<T> {
    fn default() -> Self {
        Self { all: Vec::new(), rows: Vec::new() }
    }
}

/// The ids of each shape and its floor, and the centres of the floors.
type SavedRides<T> = (Vec<[Id; 2]>, Vec<[T; 2]>);

impl<T: Scalar> Rides<T> {
    pub(super) fn memory_bytes(&self) -> usize {
        self.all.capacity() * size_of::<Option<Ride<T>>>() + self.rows.capacity() * size_of::<u32>()
    }

    /// All rides.
    pub(super) fn save(&self) -> Result<SavedRides<T>> {
        let (mut ids, mut centers) = (Vec::new(), Vec::new());
        for ride in self.all.iter().flatten() {
            memory::push(&mut ids, [ride.id, ride.floor])?;
            memory::push(&mut centers, ride.center)?;
        }
        Ok((ids, centers))
    }

    /// What [`save`](Self::save) has returned. The ids of shapes that are gone have no effect.
    pub(super) fn restore(saved: &Saved<T>, count: usize) -> Result<Self> {
        let mut rides = Self::default();
        memory::lengthen(&mut rides.all, count, None)?;
        for (&[id, floor], &center) in saved.rides.iter().zip(&saved.ride_centers) {
            // The slot is in the low bits of an id.
            if let Some(ride) = rides.all.get_mut(id as u32 as usize) {
                *ride = Some(Ride { id, floor, center });
            }
        }
        Ok(rides)
    }
}

/// A shape, the floor on which it stood, and the centre of the floor then.
#[derive(Clone, Copy, Debug)]
struct Ride<T> {
    id: Id,
    floor: Id,
    center: [T; 2],
}

/// The motion of one shape.
struct Walk<T> {
    row: usize,
    center: [T; 2],
    remaining: [T; 2],
    hits: Vec<SlideHit<T>>,
    /// The last floor, and the centre of that shape at this time.
    floor: Option<(u32, [T; 2])>,
    kinds: [bool; 3],
    /// The region whose obstacles had an effect.
    seen: [[T; 2]; 2],
}

/// What all islands of a call have in common.
struct Call<'a, T> {
    slots: &'a Slots<T>,
    layers: &'a Layers<T>,
    walls: &'a Walls<T>,
    rides: &'a Rides<T>,
    rules: &'a SlideRules<T>,
    /// The shapes that move, with their displacements.
    walkers: &'a [u32],
    displacements: &'a [[T; 2]],
    /// Obstacles that are in no tree.
    fresh: &'a [u32],
}

impl<T: Scalar> Space<T> {
    /// Moves shapes by displacements; they slide along the other shapes and do not enter them.
    ///
    /// A shape that stood on a floor after its last motion is carried first if the floor has
    /// moved since. A shape that overlaps others is moved out of them first if there is room;
    /// those that it still overlaps do not stop it. A shape that is given as a box goes on as
    /// its centre and half its size. Refuses what [`Space::move_to`] refuses.
    pub fn move_and_slide(
        &mut self,
        ids: &[Id],
        displacements: &[[T; 2]],
        rules: &SlideRules<T>,
    ) -> Result<Slides<T>> {
        if !self.period.is_none() {
            let rule = "move_and_slide needs a space without a period";
            return Err(Error::of("period", crate::shapes::tuple(&self.period.sides()), rule));
        }
        check_displacements(ids, displacements)?;
        let walkers = self.slots.find(ids)?;
        self.reserve_changes(walkers.len())?;
        memory::lengthen(&mut self.rides.all, self.slots.count(), None)?;
        memory::lengthen(&mut self.rides.rows, self.slots.count(), NONE)?;
        for (row, &slot) in walkers.iter().enumerate() {
            self.rides.rows[slot as usize] = row as u32;
        }
        let walks = self.walk(&walkers, displacements, rules);
        walkers.iter().for_each(|&slot| self.rides.rows[slot as usize] = NONE);
        self.finish(&walkers, walks?)
    }

    /// Computes the motions.
    fn walk(
        &mut self,
        walkers: &[u32],
        displacements: &[[T; 2]],
        rules: &SlideRules<T>,
    ) -> Result<Vec<Walk<T>>> {
        let mut fresh: Vec<u32> = memory::with_room(self.layers.fresh_listed())?;
        let is_walker = |slot: u32| self.rides.rows[slot as usize] != NONE;
        fresh.extend(self.layers.fresh().filter(|&slot| !is_walker(slot)));
        if fresh.len() > FEW {
            self.layers.fold(&self.slots, self.settings)?;
            fresh.clear();
        }
        let call = Call {
            slots: &self.slots,
            layers: &self.layers,
            walls: &self.walls,
            rides: &self.rides,
            rules,
            walkers,
            displacements,
            fresh: &fresh,
        };
        call.run(self.settings.threads)
    }

    /// The id of what a shape has met.
    fn id_of_met(&self, slot: u32) -> Id {
        if slot & WALL == 0 { self.slots.id(slot) } else { -2 - Id::from(slot & !WALL) }
    }

    /// Stores the new positions; nothing here fails after the first change.
    fn finish(&mut self, walkers: &[u32], mut walks: Vec<Walk<T>>) -> Result<Slides<T>> {
        walks.sort_unstable_by_key(|walk| walk.row);
        let hits = walks.iter().map(|walk| walk.hits.len()).sum();
        let mut all = Slides {
            displacements: memory::with_room(walks.len())?,
            remaining: memory::with_room(walks.len())?,
            on_floor: memory::with_room(walks.len())?,
            on_wall: memory::with_room(walks.len())?,
            on_ceiling: memory::with_room(walks.len())?,
            floors: memory::with_room(walks.len())?,
            offsets: memory::with_room(walks.len() + 1)?,
            ids: memory::with_room(hits)?,
            normals: memory::with_room(hits)?,
        };
        all.offsets.push(0);
        for (walk, &slot) in walks.iter().zip(walkers) {
            let before = self.slots.shape(slot).center();
            if self.slots.set_center(slot, walk.center) {
                self.note(slot);
            }
            let moved = [walk.center[0] - before[0], walk.center[1] - before[1]];
            all.displacements.push(moved);
            all.remaining.push(walk.remaining);
            let [floor, wall, ceiling] = walk.kinds;
            all.on_floor.push(floor);
            all.on_wall.push(wall);
            all.on_ceiling.push(ceiling);
            all.floors.push(walk.floor.map_or(-1, |(floor, _)| self.id_of_met(floor)));
            all.ids.extend(walk.hits.iter().map(|hit| self.id_of_met(hit.index)));
            all.normals.extend(walk.hits.iter().map(|hit| hit.normal));
            all.offsets.push(all.ids.len());
        }
        for (walk, &slot) in walks.iter().zip(walkers) {
            let ride = |(floor, center)| Ride {
                id: self.slots.id(slot),
                floor: self.slots.id(floor),
                center,
            };
            let floor = walk.floor.filter(|(floor, _)| floor & WALL == 0);
            self.rides.all[slot as usize] = floor.map(ride);
        }
        Ok(all)
    }
}

impl<T: Scalar> Call<'_, T> {
    /// Moves all shapes. If one gets beyond the region by which its island was chosen, because it
    /// was deep inside an obstacle or its floor moved far, its region grows and all is repeated.
    fn run(&self, threads: Option<usize>) -> Result<Vec<Walk<T>>> {
        let meets = |&slot: &u32| self.slots.shape(slot).category & self.rules.mask != 0;
        let may_meet = self.walkers.len() > 1 && self.walkers.iter().any(meets);
        let rows = if may_meet { self.walkers.len() } else { 0 };
        let mut regions = memory::collect((0..rows).map(|row| self.region(row)))?;
        let mut sets = self.riders();
        loop {
            join_overlapping(&mut sets, &regions)?;
            let islands = Islands::of(&mut sets, self.walkers.len())?;
            let walks = self.walk_islands(&islands, threads)?;
            let mut is_done = true;
            for walk in walks.iter().filter(|_| may_meet) {
                let [low, high] = regions[walk.row];
                if !contains([low, high], walk.seen) {
                    is_done = false;
                    let [seen_low, seen_high] = walk.seen;
                    regions[walk.row] = [
                        [0, 1].map(|axis| low[axis].min(seen_low[axis])),
                        [0, 1].map(|axis| high[axis].max(seen_high[axis])),
                    ];
                }
            }
            if is_done {
                return Ok(walks);
            }
        }
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
                self.walk_island(islands.rows(island), (&mut scratch, &mut pulse), &mut walks)?;
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
            sum([now[0] - before[0], now[1] - before[1]]) + own.unwrap_or(T::ZERO)
        });
        let length = sum(displacement) + carried;
        let extent = [0, 1].map(|axis| shape.half_size[axis] + shape.radius);
        let size = shape.min[0].abs().max(shape.min[1].abs()) + length + extent[0] + extent[1];
        let room = length + extent[0] + extent[1] + size * T::EPSILON * T::from_f64(256.0);
        let [x, y] = shape.min;
        let reach = [extent[0] + room, extent[1] + room];
        [[x - reach[0], y - reach[1]], [x + reach[0], y + reach[1]]]
    }

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
            let carried = self.ride(row).map(|(floor, before)| {
                let now = center_of(floor);
                ([now[0] - before[0], now[1] - before[1]], floor)
            });
            let mut find = |bounds: &Bounds<T>, near: &mut Vec<Obstacle<T>>| {
                self.find(bounds, stack, near);
                crowd.each_near(bounds, |other, body| {
                    // What stands on it is carried with it, and does not stop it.
                    if other != index && !self.stands_on(rows[other], row as u32) {
                        let slot = self.walkers[rows[other] as usize];
                        near.push(Obstacle { solid: Solid::Shape(*body), index: slot });
                    }
                });
            };
            let mut walker = Walker::new(self.rules, *crowd.get(index), near, &mut find);
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
            crowd.move_to(index, center);
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

    /// Lists the obstacles in a region that do not move in this call.
    fn find(&self, bounds: &Bounds<T>, stack: &mut Vec<u32>, near: &mut Vec<Obstacle<T>>) {
        for index in self.layers.indices() {
            let (tree, slot) = self.layers.layer(index);
            each_overlap(tree, bounds, -T::INFINITY, stack, |place| {
                if let Some(slot) = slot(tree.rows()[place])
                    && self.rides.rows[slot as usize] == NONE
                {
                    near.push(Obstacle {
                        solid: Solid::Shape(tree.columns().shape(place)),
                        index: slot,
                    });
                }
            });
        }
        for &slot in self.fresh {
            let shape = self.slots.shape(slot);
            if meets(bounds, &shape) {
                near.push(Obstacle { solid: Solid::Shape(shape), index: slot });
            }
        }
        self.walls.each_near(bounds, stack, |index, ends| {
            near.push(Obstacle { solid: Solid::Segment(ends), index: WALL | index });
        });
    }
}

/// Whether a shape may overlap a region, and their filters allow it.
fn meets<T: Scalar>(region: &Bounds<T>, shape: &Shape<T>) -> bool {
    Bounds::of(shape).overlaps(region, [T::ZERO; 2], -T::INFINITY)
}

/// Scratch of a task.
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
}

/// Refuses displacements that are not finite or whose squares may overflow.
fn check_displacements<T: Scalar>(ids: &[Id], displacements: &[[T; 2]]) -> Result<()> {
    const ARGUMENT: &str = "displacements";
    if displacements.len() != ids.len() {
        let (found, expected) = (displacements.len(), ids.len());
        return Err(Error::Length { argument: ARGUMENT, found, expected });
    }
    check_finite(ARGUMENT, displacements)?;
    let most = T::RADII[1];
    let is_too_long = |v: &[T; 2]| v[0].abs() > most || v[1].abs() > most;
    let Some(index) = displacements.iter().position(is_too_long) else { return Ok(()) };
    let rule = format!("a component must be at most {:e}", most.to_f64());
    Err(Error::at(ARGUMENT, index, crate::shapes::tuple(&displacements[index]), &rule))
}
