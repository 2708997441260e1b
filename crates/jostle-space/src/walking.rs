//! Moving shapes that slide along others: the call and its result. `walks` computes the motions.

use super::floors::{NONE, Standing};
use super::motions::Walk;
use super::slide_call::{Moved, SlideCall};
use super::space::Space;
use super::traces::CallNumber;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::memory;
use jostle_index::geometry::{Core, Scalar};
use jostle_index::period::Period;
use jostle_index::shapes::check_finite;
use jostle_slide::{CheckedRules, SlideRules};

/// With more fresh obstacles than this, a tree of them is faster than testing each.
const FEW: usize = 64;

/// The result of [`Space::move_and_slide`]; one value for each shape, in the order of the call.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Slides<T> {
    /// The displacement that each shape has made.
    pub displacement: Vec<[T; 2]>,
    /// The requested displacements without their components into the obstacles met.
    pub remaining: Vec<[T; 2]>,
    /// Whether a floor was met.
    pub on_floor: Vec<bool>,
    /// Whether a wall was met.
    pub on_wall: Vec<bool>,
    /// Whether a ceiling was met.
    pub on_ceiling: Vec<bool>,
    /// Whether obstacles leave no room to a shape, so that it overlaps one.
    pub crushed: Vec<bool>,
    /// The last floor met; −1 if there is none.
    pub floor: Vec<Id>,
    /// The displacement, since the last call for the shape, of that floor, or else of the floor on
    /// which it stood before.
    pub platform_velocity: Vec<[T; 2]>,
    /// Index of the first hit of each shape, and the total number of hits.
    pub offsets: Vec<usize>,
    /// The ids of the obstacles met by each shape, each once, in the order in which they were met.
    pub ids: Vec<Id>,
    /// The normal of each obstacle where it was met first.
    pub normals: Vec<[T; 2]>,
}

impl<T: Scalar> Space<T> {
    /// Moves shapes by displacements; they slide along the other shapes and do not enter them.
    ///
    /// A shape that stood on a floor after its last motion is carried first if the floor has moved
    /// since, and obstacles that have moved since push it. A shape that overlaps others is moved
    /// out of them first if other shapes do not prevent it; those that it still overlaps do not
    /// stop it. A shape given as a box is stored as its centre and half its size from then on.
    /// Errors as in [`Space::move_to`].
    pub fn move_and_slide(
        &mut self,
        ids: &[Id],
        displacements: &[[T; 2]],
        rules: &SlideRules<T>,
    ) -> Result<Slides<T>> {
        check_reach(rules, &self.period)?;
        let rules = &rules.check()?;
        check_displacements(ids, displacements, &self.period)?;
        let walkers = self.slots.find(ids)?;
        self.check_walkers(ids, &walkers)?;
        self.reserve_changes(walkers.len())?;
        // All memory that the call needs to store its results is reserved first. After the motions
        // are computed nothing can fail any more.
        memory::lengthen(&mut self.floors.all, self.slots.count(), None)?;
        memory::lengthen(&mut self.floors.rows, self.slots.count(), NONE)?;
        self.traces.begin_call(walkers.len(), self.slots.count())?;
        self.starts.reserve(self.slots.count())?;
        for (row, &slot) in walkers.iter().enumerate() {
            self.floors.rows[slot as usize] = row as u32;
        }
        let walks = self.walk(&walkers, displacements, rules);
        // Before the `?` below: the column has to be empty between calls, after a failed one as
        // well.
        walkers.iter().for_each(|&slot| self.floors.rows[slot as usize] = NONE);
        self.finish(&walkers, walks?)
    }

    /// Refuses segments, and shapes that could collide with their own images.
    fn check_walkers(&self, ids: &[Id], walkers: &[u32]) -> Result<()> {
        for (row, &slot) in walkers.iter().enumerate() {
            if self.slots.shape(slot).core != Core::Box {
                let rule = "it is a segment, and segments are obstacles: circles and boxes slide";
                return Err(Error::at("ids", row, ids[row], rule));
            }
        }
        if self.period.is_none() {
            return Ok(());
        }
        for (&slot, (row, id)) in walkers.iter().zip(ids.iter().enumerate()) {
            let shape = self.slots.shape(slot);
            let half = shape.core_half_size().map(|half| half + shape.radius);
            let sides = self.period.sides();
            let is_wide =
                |&axis: &usize| self.period.is_along(axis) && half[axis] + half[axis] > sides[axis];
            if let Some(axis) = (0..2).find(is_wide) {
                let (name, side) = (["x", "y"][axis], sides[axis].to_f64());
                let rule = format!(
                    "a shape that moves must not be wider than the period, which is {side} along {name}"
                );
                return Err(Error::at("ids", row, id, &rule));
            }
        }
        Ok(())
    }

    /// Computes the motions.
    fn walk(
        &mut self,
        walkers: &[u32],
        displacements: &[[T; 2]],
        rules: &CheckedRules<T>,
    ) -> Result<Vec<Walk<T>>> {
        let mut fresh: Vec<u32> = memory::with_capacity(self.layers.fresh_listed())?;
        let is_walker = |slot: u32| self.floors.rows[slot as usize] != NONE;
        fresh.extend(self.layers.fresh().filter(|&slot| !is_walker(slot)));
        // Each walker tests each fresh obstacle. With more of them a tree pays off already within
        // this call.
        if fresh.len() > FEW {
            self.layers.fold(&self.slots, self.settings)?;
            fresh.clear();
        }
        // The longest memory of any of them: an obstacle that moved before that has been met by
        // all.
        let since = walkers.iter().map(|&slot| self.traces.since(slot)).min().unwrap_or_default();
        let moved = self.moved_before(walkers, since, rules.mask())?;
        let call = SlideCall {
            slots: &self.slots,
            layers: &self.layers,
            floors: &self.floors,
            traces: &self.traces,
            since,
            moved,
            period: self.period,
            rules,
            walkers,
            displacements,
            fresh: &fresh,
        };
        call.run(self.settings.threads)
    }

    /// The obstacles that have moved since a call.
    fn moved_before(&self, walkers: &[u32], since: CallNumber, mask: u32) -> Result<Moved<T>> {
        let is_obstacle = |&slot: &u32| {
            self.slots.category(slot) & mask != 0
                && self.floors.rows[slot as usize] == NONE
                && self.layers.has(slot)
        };
        let moved = self.traces.moved_since(since).filter(is_obstacle);
        let moved = moved.filter_map(|slot| Some((slot, self.traces.before(slot, since)?)));
        let moved = moved.filter(|&(slot, before)| before != self.slots.center(slot));
        Moved::new(moved, &self.slots, &self.period, (walkers.len(), self.settings))
    }

    /// Stores the new positions; nothing fails after the first change.
    fn finish(&mut self, walkers: &[u32], mut walks: Vec<Walk<T>>) -> Result<Slides<T>> {
        // Islands finish in any order; results are in the order of the call.
        walks.sort_unstable_by_key(|walk| walk.row);
        let hits = walks.iter().map(|walk| walk.hits.len()).sum();
        let mut all = Slides {
            displacement: memory::with_capacity(walks.len())?,
            remaining: memory::with_capacity(walks.len())?,
            on_floor: memory::with_capacity(walks.len())?,
            on_wall: memory::with_capacity(walks.len())?,
            on_ceiling: memory::with_capacity(walks.len())?,
            crushed: memory::with_capacity(walks.len())?,
            floor: memory::with_capacity(walks.len())?,
            platform_velocity: memory::with_capacity(walks.len())?,
            offsets: memory::with_capacity(walks.len() + 1)?,
            ids: memory::with_capacity(hits)?,
            normals: memory::with_capacity(hits)?,
        };
        all.offsets.push(0);
        for (walk, &slot) in walks.iter().zip(walkers) {
            let before = self.slots.center(slot);
            if self.slots.set_center(slot, self.period.wrap(walk.center)) {
                self.note(slot);
                self.traces.note(slot, || before);
                self.starts.note(slot, || before);
            }
            all.displacement.push(walk.moved);
            all.remaining.push(walk.remaining);
            let [floor, wall, ceiling] = walk.kinds;
            all.on_floor.push(floor);
            all.on_wall.push(wall);
            all.on_ceiling.push(ceiling);
            all.crushed.push(walk.is_crushed);
            all.platform_velocity.push(walk.platform_velocity);
            all.floor.push(walk.floor.map_or(-1, |(floor, _)| self.slots.id(floor)));
            for (nth, hit) in walk.hits.iter().enumerate() {
                // A shape meets few obstacles, so a set of them would cost more.
                if walk.hits[..nth].iter().all(|before| before.index != hit.index) {
                    all.ids.push(self.slots.id(hit.index));
                    all.normals.push(hit.normal);
                }
            }
            all.offsets.push(all.ids.len());
        }
        for (walk, &slot) in walks.iter().zip(walkers) {
            let standing = |(floor, center)| Standing {
                id: self.slots.id(slot),
                floor: self.slots.id(floor),
                center,
            };
            self.floors.all[slot as usize] = walk.floor.map(standing);
        }
        self.traces.end_call(walkers);
        Ok(all)
    }
}

/// Refuses lengths by which a shape would meet an image of an obstacle twice.
fn check_reach<T: Scalar>(rules: &SlideRules<T>, period: &Period<T>) -> Result<()> {
    for (name, value) in [("snap", rules.snap), ("step_height", rules.step_height)] {
        let is_too_long = |&axis: &usize| period.is_along(axis) && value > period.sides()[axis];
        if let Some(axis) = (0..2).find(is_too_long) {
            let side = period.sides()[axis].to_f64();
            return Err(Error::of(name, value, &format!("it must be at most {side}, the period")));
        }
    }
    Ok(())
}

/// Refuses displacements that are not finite, whose squares may overflow, or that are longer than
/// the period.
fn check_displacements<T: Scalar>(
    ids: &[Id],
    displacements: &[[T; 2]],
    period: &Period<T>,
) -> Result<()> {
    const ARGUMENT: &str = "displacements";
    if displacements.len() != ids.len() {
        let (found, expected) = (displacements.len(), ids.len());
        return Err(Error::Length { argument: ARGUMENT, found, expected });
    }
    check_finite(ARGUMENT, displacements)?;
    let limit =
        |axis: usize| if period.is_along(axis) { period.sides()[axis] } else { T::RADII[1] };
    for axis in 0..2 {
        let is_too_long = |v: &[T; 2]| v[axis].abs() > limit(axis);
        let Some(index) = displacements.iter().position(is_too_long) else { continue };
        let what = if period.is_along(axis) { ", the period" } else { "" };
        let rule = format!("a component must be at most {:e}{what}", limit(axis).to_f64());
        return Err(Error::at(
            ARGUMENT,
            index,
            jostle_index::shapes::tuple(&displacements[index]),
            &rule,
        ));
    }
    Ok(())
}
