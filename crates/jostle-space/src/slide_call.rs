//! A call of [`Space::move_and_slide`](super::Space::move_and_slide): its arguments, and the
//! shapes.

use super::floors::{Floors, NONE};
use super::layers::Layers;
use super::slots::Slots;
use super::traces::{CallNumber, Traces, motion, swept};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_base::settings::Settings;
use jostle_index::geometry::{Bounds, Scalar, Shape};
use jostle_index::period::{Period, Turns};
use jostle_index::quadtree::Quadtree;
use jostle_index::query::each_overlap;
use jostle_index::shapes::{Each, Shapes};
use jostle_slide::{CheckedRules, Obstacle, Solid};

/// What all islands of a call have in common.
pub(crate) struct SlideCall<'a, T> {
    /// The shapes.
    pub slots: &'a Slots<T>,
    /// Their trees.
    pub layers: &'a Layers<T>,
    /// The floors on which shapes stand.
    pub floors: &'a Floors<T>,
    /// Where shapes were before they moved.
    pub traces: &'a Traces<T>,
    /// The call since which all rows have moved.
    pub since: CallNumber,
    /// The obstacles that have moved since and do not move in this call.
    pub moved: Moved<T>,
    /// The period of the plane.
    pub period: Period<T>,
    /// How shapes slide.
    pub rules: &'a CheckedRules<T>,
    /// The shapes that move.
    pub walkers: &'a [u32],
    /// The displacement of each walker.
    pub displacements: &'a [[T; 2]],
    /// Obstacles that are in no tree.
    pub fresh: &'a [u32],
}

impl<T: Scalar> SlideCall<'_, T> {
    /// The shape of a row, by its centre.
    pub(crate) fn body(&self, row: usize) -> Shape<T> {
        let shape = self.slots.shape(self.walkers[row]);
        let center = shape.center();
        Shape { min: center, max: center, half_size: shape.core_half_size(), ..shape }
    }

    /// The floor on which a row stood after its last motion, and its centre then.
    pub(crate) fn standing(&self, row: usize) -> Option<(u32, [T; 2])> {
        let slot = self.walkers[row];
        // By id, not by slot: the shape, or its floor, may have been removed and the slot used
        // again.
        let standing =
            self.floors.all[slot as usize].filter(|standing| standing.id == self.slots.id(slot))?;
        Some((self.slots.slot(standing.floor)?, standing.center))
    }

    /// Whether a row is an obstacle of other rows, as far as `mask` decides.
    pub(crate) fn is_obstacle(&self, row: usize) -> bool {
        self.slots.category(self.walkers[row]) & self.rules.mask() != 0
    }

    /// The motions of obstacles that concern a row.
    pub(crate) fn viewer(&self, row: usize) -> Viewer<T> {
        Viewer { since: self.traces.since(self.walkers[row]), floor: self.standing(row) }
    }

    /// The motion of an obstacle since the last motion of a shape; if the obstacle has not moved
    /// since, its motion in this call.
    pub(crate) fn motion(&self, viewer: &Viewer<T>, slot: u32, now: [T; 2]) -> [T; 2] {
        // The floor's place is that of the moment in which the shape stood on it, also if the floor
        // moved earlier in the same call. For other obstacles the place before their first motion
        // since is what counts.
        let floor = viewer.floor.filter(|&(floor, _)| floor == slot).map(|(_, before)| before);
        let before = floor.or_else(|| self.traces.before(slot, viewer.since));
        motion(&self.period, before.unwrap_or_else(|| self.slots.center(slot)), now)
    }

    /// The row of the floor of a row, if it moves in this call too.
    pub(crate) fn moving_floor(&self, row: usize) -> Option<u32> {
        let (floor, _) = self.standing(row)?;
        Some(self.floors.rows[floor as usize]).filter(|&row| row != NONE)
    }

    /// By how much a row has been moved since the last motion of any row, before this call.
    pub(crate) fn moved_before(&self, row: usize) -> [T; 2] {
        let slot = self.walkers[row];
        let before = self.traces.before(slot, self.since);
        let now = self.slots.center(slot);
        before.map_or([T::ZERO; 2], |before| motion(&self.period, before, now))
    }

    /// Lists the images of obstacles that do not move in this call, in a region that is moved by
    /// minus these periods.
    pub(crate) fn find(
        &self,
        viewer: &Viewer<T>,
        bounds: &Bounds<T>,
        turns: Turns,
        stack: &mut Vec<u32>,
        near: &mut Vec<Obstacle<T>>,
    ) {
        let is_any_moved = !self.moved.is_empty();
        let is_moved = |slot: u32| {
            let before = self.traces.before(slot, viewer.since).filter(|_| is_any_moved);
            before.is_some_and(|before| before != self.slots.center(slot))
        };
        for number in self.layers.indices() {
            let (tree, slot) = self.layers.layer(number);
            each_overlap(tree, bounds, -T::INFINITY, stack, |index| {
                if let Some(slot) = slot(tree.rows()[index])
                    // Shapes that move in this call are found in the spatial hash of their island,
                    // where they are now.
                    && self.floors.rows[slot as usize] == NONE
                    && !is_moved(slot)
                {
                    near.push(self.obstacle(viewer, slot, tree.columns().shape(index), turns));
                }
            });
        }
        for &slot in self.fresh {
            let shape = self.slots.shape(slot);
            if !is_moved(slot) && meets(bounds, &shape) {
                near.push(self.obstacle(viewer, slot, shape, turns));
            }
        }
        self.moved.each_near(bounds, stack, |slot| {
            // An obstacle that has moved is found by the box around its path, since it may have
            // been anywhere on it. So it is left out above, or it would be listed twice.
            if is_moved(slot) {
                near.push(self.obstacle(viewer, slot, self.slots.shape(slot), turns));
            }
        });
    }

    fn obstacle(
        &self,
        viewer: &Viewer<T>,
        slot: u32,
        shape: Shape<T>,
        turns: Turns,
    ) -> Obstacle<T> {
        let is_floor = viewer.floor.is_some_and(|(floor, _)| floor == slot);
        let has_moved = is_floor || !self.moved.is_empty();
        let motion =
            if has_moved { self.motion(viewer, slot, shape.center()) } else { [T::ZERO; 2] };
        Obstacle { solid: Solid::of(shape), turns, motion, index: slot }
    }
}

/// The motions of obstacles that concern a shape that moves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Viewer<T> {
    /// The call since which it has not moved by itself.
    pub since: CallNumber,
    /// The floor on which it stood then, and the centre of the floor.
    pub floor: Option<(u32, [T; 2])>,
}

/// With more shapes that have moved, and more walkers, a tree is faster than testing each.
const FEW_MOVED: usize = 16;
const FEW_WALKERS: usize = 8;

/// The obstacles that have moved since the last motion of a shape that moves in a call, as boxes
/// around their paths.
pub(crate) struct Moved<T> {
    slots: Vec<u32>,
    paths: Vec<Shape<T>>,
    /// Empty if there are few.
    tree: Quadtree<T>,
}

impl<T: Scalar> Moved<T> {
    /// The paths of shapes from the centres before.
    pub(crate) fn new(
        moved: impl Iterator<Item = (u32, [T; 2])>,
        slots: &Slots<T>,
        period: &Period<T>,
        (walkers, settings): (usize, Settings),
    ) -> Result<Self> {
        let mut all = Self { slots: Vec::new(), paths: Vec::new(), tree: Quadtree::default() };
        for (slot, before) in moved {
            let path = swept(slots, slot, motion(period, before, slots.center(slot)));
            memory::push(&mut all.slots, slot)?;
            memory::push(&mut all.paths, path)?;
        }
        // A tree is built once and searched by each walker. With few of either a test of each path
        // by each walker is faster than its construction.
        if all.paths.len() > FEW_MOVED && walkers > FEW_WALKERS {
            let each = || all.paths.iter();
            let bounded =
                |path: &Shape<T>| path.sides().map(|v| v.max(-T::MAX_SIZE).min(T::MAX_SIZE));
            let boxes = memory::collect(each().map(bounded))?;
            let filters = [
                Each::Rows(memory::collect(each().map(|path| path.category))?),
                Each::Rows(memory::collect(each().map(|path| path.mask))?),
            ];
            let shapes = Shapes::from_boxes(boxes, Each::One(T::ZERO), Some(filters))?;
            all.tree.fill_unordered(&shapes, settings)?;
        }
        Ok(all)
    }

    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.slots.is_empty()
    }

    /// Calls `act` with the slot of each shape whose path may meet a region.
    fn each_near(&self, region: &Bounds<T>, stack: &mut Vec<u32>, mut act: impl FnMut(u32)) {
        if self.tree.rows().is_empty() {
            let near = self.paths.iter().zip(&self.slots).filter(|(path, _)| meets(region, path));
            return near.for_each(|(_, &slot)| act(slot));
        }
        each_overlap(&self.tree, region, -T::INFINITY, stack, |index| {
            act(self.slots[self.tree.rows()[index] as usize]);
        });
    }
}

/// Whether a shape may overlap a region, and their filters allow it.
fn meets<T: Scalar>(region: &Bounds<T>, shape: &Shape<T>) -> bool {
    Bounds::of(shape).overlaps(region, [T::ZERO; 2], -T::INFINITY)
}
