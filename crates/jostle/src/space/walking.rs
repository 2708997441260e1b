//! Shapes of a space that move and slide along others.
//!
//! Shapes whose paths may meet form an island. The shapes of an island move one after another, in
//! the order of the call, and islands move in parallel. So results do not depend on threads,
//! nor on the order of shapes that do not meet.

use super::Space;
use super::layers::Layers;
use super::slots::{Id, Slots};
use crate::disjoint_sets::DisjointSets;
use crate::error::{Error, Result};
use crate::geometry::{Bounds, Scalar, Shape};
use crate::interrupt::{Pulse, Stop};
use crate::memory;
use crate::pairs;
use crate::parallel;
use crate::query::each_overlap;
use crate::settings::DEFAULT_MAX_PAIRS;
use crate::shapes::{Each, Shapes, check_finite};
use crate::slide::{Obstacle, SlideHit, SlideRules, Surface, Walker};

/// Number of islands of a task.
const ISLANDS_PER_TASK: usize = 32;

/// Minimum number of shapes for which threads that are awake are used, and are woken.
const WORTH_SHARING: usize = 64;
const WORTH_WAKING: usize = 512;

/// With more fresh obstacles than this, a tree of them is faster than testing each.
const FEW: usize = 64;

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
    /// The last floor met; −1 if there is none.
    pub floors: Vec<Id>,
    /// Index of the first hit of each shape, and the total number of hits.
    pub offsets: Vec<usize>,
    /// The ids of the obstacles met by each shape, in the order in which they were met.
    pub ids: Vec<Id>,
    /// The normal of each obstacle where it was met.
    pub normals: Vec<[T; 2]>,
}

/// The floors on which shapes stood after they moved, so that moving floors carry them.
#[derive(Clone, Debug)]
pub(super) struct Rides<T>(Vec<Option<Ride<T>>>);

impl<T> Default for Rides<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<T> Rides<T> {
    pub(super) fn memory_bytes(&self) -> usize {
        self.0.capacity() * size_of::<Option<Ride<T>>>()
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
    floor: Option<u32>,
    kinds: [bool; 3],
}

/// What all islands of a call have in common.
struct Call<'a, T> {
    slots: &'a Slots<T>,
    layers: &'a Layers<T>,
    rides: &'a [Option<Ride<T>>],
    rules: &'a SlideRules<T>,
    /// The shapes that move, with their displacements.
    walkers: &'a [u32],
    displacements: &'a [[T; 2]],
    is_walker: &'a [bool],
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
        memory::lengthen(&mut self.rides.0, self.slots.count(), None)?;
        let mut is_walker = memory::filled(self.slots.count(), false)?;
        walkers.iter().for_each(|&slot| is_walker[slot as usize] = true);
        let mut fresh: Vec<u32> = memory::with_room(self.layers.fresh_listed())?;
        fresh.extend(self.layers.fresh().filter(|&slot| !is_walker[slot as usize]));
        if fresh.len() > FEW {
            self.layers.fold(&self.slots, self.settings)?;
            fresh.clear();
        }
        let call = Call {
            slots: &self.slots,
            layers: &self.layers,
            rides: &self.rides.0,
            rules,
            walkers: &walkers,
            displacements,
            is_walker: &is_walker,
            fresh: &fresh,
        };
        let walks = call.run(self.settings.threads)?;
        self.finish(&walkers, walks)
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
            all.floors.push(walk.floor.map_or(-1, |floor| self.slots.id(floor)));
            all.ids.extend(walk.hits.iter().map(|hit| self.slots.id(hit.slot)));
            all.normals.extend(walk.hits.iter().map(|hit| hit.normal));
            all.offsets.push(all.ids.len());
        }
        for (walk, &slot) in walks.iter().zip(walkers) {
            self.rides.0[slot as usize] = walk.floor.map(|floor| Ride {
                id: self.slots.id(slot),
                floor: self.slots.id(floor),
                center: self.slots.shape(floor).center(),
            });
        }
        Ok(all)
    }
}

impl<T: Scalar> Call<'_, T> {
    fn run(&self, threads: Option<usize>) -> Result<Vec<Walk<T>>> {
        let (ends, members) = self.islands()?;
        let threads =
            parallel::threads_for(threads, self.walkers.len(), WORTH_SHARING, WORTH_WAKING);
        let stop = Stop::current();
        let parts = parallel::map(threads, ends.len().div_ceil(ISLANDS_PER_TASK), |part| {
            let mut pulse = Pulse::of(&stop);
            let mut walks = Vec::new();
            let mut memory = Memory::default();
            let first = part * ISLANDS_PER_TASK;
            for island in first..ends.len().min(first + ISLANDS_PER_TASK) {
                let start = if island == 0 { 0 } else { ends[island - 1] as usize };
                let rows = &members[start..ends[island] as usize];
                pulse.check(64 * rows.len())?;
                self.walk_island(rows, &mut memory, &mut walks);
            }
            Ok(walks)
        });
        let mut all = memory::with_room(self.walkers.len())?;
        for part in parts {
            all.extend(part?);
        }
        Ok(all)
    }

    /// Rows of the call by island, ascending in each, and the end of each island.
    fn islands(&self) -> Result<(Vec<u32>, Vec<u32>)> {
        let len = self.walkers.len();
        let mut sets = DisjointSets::default();
        sets.reset(len);
        let meets = |&slot: &u32| self.slots.shape(slot).category & self.rules.mask != 0;
        if len > 1 && self.walkers.iter().any(meets) {
            let rows = 0..len;
            let boxes = memory::collect(rows.map(|row| self.region(row)))?;
            let regions = Shapes::from_boxes(boxes, Each::One(T::ZERO), None)?;
            for [a, b] in pairs::find(&regions, None, Some(1), DEFAULT_MAX_PAIRS)?.pairs {
                sets.join(a, b);
            }
        }
        let mut members: Vec<u32> = memory::collect(0..len as u32)?;
        let roots: Vec<u32> = memory::collect((0..len as u32).map(|row| sets.root(row)))?;
        members.sort_by_key(|&row| roots[row as usize]);
        let mut ends: Vec<u32> = memory::with_room(len)?;
        let root = |index: usize| roots[members[index] as usize];
        ends.extend(
            (1..=len).filter(|&end| end == len || root(end) != root(end - 1)).map(|e| e as u32),
        );
        Ok((ends, members))
    }

    /// A box that contains all positions that a shape may take, with room for its rounding and
    /// for leaving obstacles.
    fn region(&self, row: usize) -> [T; 4] {
        let (shape, displacement) = (self.body(row), self.displacements[row]);
        let ride = self.ride(row).map_or([T::ZERO; 2], |(carried, _)| carried);
        let length = displacement[0].abs() + displacement[1].abs() + ride[0].abs() + ride[1].abs();
        let extent = [0, 1].map(|axis| shape.half_size[axis] + shape.radius);
        let size = shape.min[0].abs().max(shape.min[1].abs()) + length + extent[0] + extent[1];
        let room = length + extent[0] + extent[1] + size * T::EPSILON * T::from_f64(256.0);
        let [x, y] = shape.min;
        let reach = [extent[0] + room, extent[1] + room];
        [x - reach[0], y - reach[1], x + reach[0], y + reach[1]]
    }

    /// The shape of a row, by its centre.
    fn body(&self, row: usize) -> Shape<T> {
        let shape = self.slots.shape(self.walkers[row]);
        let center = shape.center();
        Shape { min: center, max: center, half_size: shape.core_half_size(), ..shape }
    }

    /// By how much the floor of a row has moved since the row's last motion, and the floor.
    fn ride(&self, row: usize) -> Option<([T; 2], u32)> {
        let slot = self.walkers[row];
        let ride = self.rides[slot as usize].filter(|ride| ride.id == self.slots.id(slot))?;
        let floor = self.slots.slot(ride.floor)?;
        let now = self.slots.shape(floor).center();
        let moved = [now[0] - ride.center[0], now[1] - ride.center[1]];
        (moved != [T::ZERO; 2]).then_some((moved, floor))
    }

    /// Moves the shapes of an island one after another.
    fn walk_island(&self, rows: &[u32], memory: &mut Memory<T>, walks: &mut Vec<Walk<T>>) {
        let Memory { near, stack, bodies } = memory;
        bodies.clear();
        bodies.extend(rows.iter().map(|&row| self.body(row as usize)));
        for (index, &row) in rows.iter().enumerate() {
            let row = row as usize;
            let mut find = |bounds: &Bounds<T>, near: &mut Vec<Obstacle<T>>| {
                self.find(bounds, stack, near);
                for (other, body) in bodies.iter().enumerate() {
                    if other != index && meets(bounds, body) {
                        let slot = self.walkers[rows[other] as usize];
                        near.push(Obstacle { shape: *body, slot });
                    }
                }
            };
            let mut walker = Walker::new(self.rules, bodies[index], near, &mut find);
            if let Some((displacement, floor)) = self.ride(row) {
                walker.carry(displacement, floor);
            }
            walker.leave_obstacles();
            walker.slide(self.displacements[row]);
            let floor = walker.last_of(Surface::Floor);
            let kinds = [Surface::Floor, Surface::Wall, Surface::Ceiling]
                .map(|kind| walker.last_of(kind).is_some());
            let (center, remaining) = (walker.center(), walker.remaining);
            let hits = std::mem::take(&mut walker.hits);
            bodies[index].min = center;
            bodies[index].max = center;
            walks.push(Walk { row, center, remaining, hits, floor, kinds });
        }
    }

    /// Lists the obstacles in a region that do not move in this call.
    fn find(&self, bounds: &Bounds<T>, stack: &mut Vec<u32>, near: &mut Vec<Obstacle<T>>) {
        for index in self.layers.indices() {
            let (tree, slot) = self.layers.layer(index);
            each_overlap(tree, bounds, -T::INFINITY, stack, |place| {
                if let Some(slot) = slot(tree.rows()[place])
                    && !self.is_walker[slot as usize]
                {
                    near.push(Obstacle { shape: tree.columns().shape(place), slot });
                }
            });
        }
        for &slot in self.fresh {
            let shape = self.slots.shape(slot);
            if meets(bounds, &shape) {
                near.push(Obstacle { shape, slot });
            }
        }
    }
}

/// Whether a shape may overlap a region, and their filters allow it.
fn meets<T: Scalar>(region: &Bounds<T>, shape: &Shape<T>) -> bool {
    Bounds::of(shape).overlaps(region, [T::ZERO; 2], -T::INFINITY)
}

/// Memory of a task.
struct Memory<T> {
    near: Vec<Obstacle<T>>,
    stack: Vec<u32>,
    bodies: Vec<Shape<T>>,
}

impl<T> Default for Memory<T> {
    fn default() -> Self {
        Self { near: Vec::new(), stack: Vec::new(), bodies: Vec::new() }
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
