//! The motions of the shapes of one island, one after another.
//!
//! Each motion is stopped by all other shapes at their current positions, so it causes no new
//! overlap. A floor that would move into shapes that stand on it pushes them first. Shapes that
//! stand on a floor are carried after the floor has moved, by the rest of its motion.

use super::call::{Call, WALL};
use super::crowd::Crowd;
use super::riders::{Rider, Riders};
use super::rides::NONE;
use crate::error::Result;
use crate::geometry::{Bounds, Scalar, contact};
use crate::interrupt::Pulse;
use crate::memory;
use crate::slide::{Obstacle, SlideHit, Solid, Surface, Walker, slop};

/// Work of a walk, in the units of [`Pulse`].
const WORK: usize = 256;

/// The motion of one shape.
pub struct Walk<T> {
    /// Its row in the call.
    pub row: usize,
    /// Its centre afterwards, which may be outside the first period.
    pub center: [T; 2],
    /// The displacement that it has made.
    pub moved: [T; 2],
    /// The displacement without its components into obstacles.
    pub remaining: [T; 2],
    /// The obstacles met.
    pub hits: Vec<SlideHit<T>>,
    /// The last floor, and the centre of that shape at this time.
    pub floor: Option<(u32, [T; 2])>,
    /// Whether it met a floor, a wall and a ceiling.
    pub kinds: [bool; 3],
    /// The region whose obstacles had an effect.
    pub seen: [[T; 2]; 2],
}

/// How the floors of a shape have pushed it before its own motion.
#[derive(Clone, Debug)]
struct Pushed<T> {
    by: [T; 2],
    hits: Vec<SlideHit<T>>,
    /// The region whose obstacles had an effect; empty at first.
    seen: [[T; 2]; 2],
}

impl<T: Scalar> Default for Pushed<T> {
    fn default() -> Self {
        Self { by: [T::ZERO; 2], hits: Vec::new(), seen: [[T::INFINITY; 2], [-T::INFINITY; 2]] }
    }
}

/// Scratch of a task.
pub struct Scratch<T> {
    near: Vec<Obstacle<T>>,
    stack: Vec<u32>,
    crowd: Crowd<T>,
    riders: Riders,
    /// For each shape; empty if nothing stands on another.
    pushed: Vec<Pushed<T>>,
    /// The shapes that do not stop the one that moves; empty if nothing stands on another.
    skipped: Vec<bool>,
    above: Vec<Rider>,
    /// By how much each of `above` is pushed, and whether it overlaps the one below all.
    pushes: Vec<([T; 2], bool)>,
}

impl<T> Default for Scratch<T> {
    fn default() -> Self {
        let (near, stack, crowd, riders) =
            (Vec::new(), Vec::new(), Crowd::default(), Riders::default());
        let (pushed, skipped, above, pushes) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { near, stack, crowd, riders, pushed, skipped, above, pushes }
    }
}

/// The shapes of an island: its rows in the call, and where they are now.
pub struct Island<'a, T> {
    /// The call.
    pub call: &'a Call<'a, T>,
    /// Its rows, ascending. The index of a shape is its position in this list.
    pub rows: &'a [u32],
    /// The scratch of the task.
    pub scratch: &'a mut Scratch<T>,
}

impl<T: Scalar> Island<'_, T> {
    /// Moves all shapes.
    pub fn run(&mut self, pulse: &mut Pulse, walks: &mut Vec<Walk<T>>) -> Result<()> {
        let (call, rows) = (self.call, self.rows);
        let Scratch { crowd, riders, pushed, skipped, .. } = &mut *self.scratch;
        crowd.fill(rows.iter().map(|&row| call.body(row as usize)))?;
        riders.fill(rows.len(), |index| {
            rows.binary_search(&call.moving_floor(rows[index] as usize)?).ok()
        })?;
        pushed.clear();
        skipped.clear();
        if riders.is_any() {
            memory::resize(pushed, rows.len(), Pushed::default())?;
            memory::resize(skipped, rows.len(), false)?;
        }
        for nth in 0..rows.len() {
            let index = self.scratch.riders.order[nth] as usize;
            self.push_riders(index, pulse)?;
            let mut walk = self.walk(index);
            pulse.check(WORK + self.scratch.near.len())?;
            let Scratch { above, skipped, crowd, pushed, .. } = &mut *self.scratch;
            above.iter().for_each(|rider| skipped[rider.index as usize] = false);
            crowd.move_to(index, call.period.wrap(walk.center));
            if let Some(pushed) = pushed.get(index) {
                walk.moved = sum(pushed.by, walk.moved);
                walk.seen = union(walk.seen, pushed.seen);
            }
            memory::push(walks, walk)?;
        }
        Ok(())
    }

    /// Pushes the shapes that stand on a shape and would stop its motion, the uppermost first.
    /// Afterwards those that overlapped it before are skipped.
    fn push_riders(&mut self, index: usize, pulse: &mut Pulse) -> Result<()> {
        let Scratch { riders, above, pushes, skipped, .. } = &mut *self.scratch;
        riders.list_above(index, above)?;
        if above.is_empty() {
            return Ok(());
        }
        pushes.clear();
        memory::reserve(pushes, above.len())?;
        above.iter().for_each(|rider| skipped[rider.index as usize] = true);
        let plan = self.walk(index);
        pulse.check(WORK + self.scratch.near.len())?;
        let Scratch { above, pushes, crowd, pushed, skipped, .. } = &mut *self.scratch;
        pushed[index].seen = union(pushed[index].seen, plan.seen);
        let period = self.call.period;
        for rider in &above[..] {
            let (floor, by) = match rider.floor.checked_sub(1) {
                None => (index, plan.moved),
                Some(nth) => (above[nth].index as usize, pushes[nth].0),
            };
            let body = crowd.get(rider.index as usize);
            let [a, b] = period.nearest_images(crowd.get(floor), body);
            let (normal, _) = contact(&a, &b);
            let is_pushed = by[0] * normal[0] + by[1] * normal[1] > slop(body, &period, T::ZERO);
            let is_inside = period.overlap(crowd.get(index), body);
            pushes.push((if is_pushed { by } else { [T::ZERO; 2] }, is_inside));
            skipped[rider.index as usize] = false;
        }
        for nth in (0..self.scratch.above.len()).rev() {
            let (by, _) = self.scratch.pushes[nth];
            if by != [T::ZERO; 2] {
                self.push(self.scratch.above[nth].index as usize, by);
                pulse.check(WORK + self.scratch.near.len())?;
            }
        }
        let Scratch { above, pushes, skipped, .. } = &mut *self.scratch;
        for (rider, &(_, is_inside)) in above.iter().zip(&pushes[..]) {
            skipped[rider.index as usize] = is_inside;
        }
        Ok(())
    }

    /// Pushes a shape by a displacement; it slides along obstacles.
    fn push(&mut self, index: usize, by: [T; 2]) {
        let start = self.scratch.crowd.get(index).min;
        let (center, hits, seen) = self.with_walker(index, |walker| {
            walker.slide(by);
            (walker.center(), std::mem::take(&mut walker.hits), walker.seen)
        });
        let Scratch { crowd, pushed, .. } = &mut *self.scratch;
        crowd.move_to(index, self.call.period.wrap(center));
        let all = &mut pushed[index];
        all.by = sum(all.by, [center[0] - start[0], center[1] - start[1]]);
        all.hits = hits;
        all.seen = union(all.seen, seen);
    }

    /// The motion of a shape among all others that are not skipped, which is computed but not made.
    fn walk(&mut self, index: usize) -> Walk<T> {
        let (call, row) = (self.call, self.rows[index] as usize);
        let start = self.scratch.crowd.get(index).min;
        let carried = call.ride(row).map(|(floor, before)| {
            let by = call.carried(self.center_of(floor), before);
            let pushed = self.scratch.pushed.get(index).map_or([T::ZERO; 2], |pushed| pushed.by);
            let is_walker = call.rides.rows[floor as usize] != NONE;
            ([by[0] - pushed[0], by[1] - pushed[1]], Some(floor).filter(|_| !is_walker))
        });
        let (center, remaining, hits, floor, kinds, seen) = self.with_walker(index, |walker| {
            if let Some((displacement, platform)) = carried
                && displacement != [T::ZERO; 2]
            {
                walker.carry(displacement, platform);
            }
            walker.leave_obstacles();
            walker.slide(call.displacements[row]);
            let kinds = [Surface::Floor, Surface::Wall, Surface::Ceiling]
                .map(|kind| walker.last_of(kind).is_some());
            let floor = walker.last_of(Surface::Floor);
            let hits = std::mem::take(&mut walker.hits);
            (walker.center(), walker.remaining, hits, floor, kinds, walker.seen)
        });
        let still = |slot: u32| if slot & WALL == 0 { self.center_of(slot) } else { center };
        let floor = floor.map(|slot| (slot, still(slot)));
        let moved = [center[0] - start[0], center[1] - start[1]];
        Walk { row, center, moved, remaining, hits, floor, kinds, seen }
    }

    /// Calls `act` with a shape that can move among all others that are not skipped.
    fn with_walker<R>(&mut self, index: usize, act: impl FnOnce(&mut Walker<'_, T>) -> R) -> R {
        let (call, rows) = (self.call, self.rows);
        let Scratch { near, stack, crowd, skipped, pushed, .. } = &mut *self.scratch;
        let crowd = &*crowd;
        let is_skipped = |other: usize| other == index || skipped.get(other) == Some(&true);
        let mut find = |bounds: &Bounds<T>, near: &mut Vec<Obstacle<T>>| {
            for turns in call.period.images_near(bounds.min, bounds.max) {
                let bounds = &bounds.moved(call.period.span(turns));
                call.find(bounds, turns, stack, near);
                crowd.each_near(bounds, |other, body| {
                    if !is_skipped(other) {
                        let index = call.walkers[rows[other] as usize];
                        near.push(Obstacle { solid: Solid::Shape(*body), turns, index });
                    }
                });
            }
        };
        let rules = (call.rules, call.period);
        let mut walker = Walker::new(rules, *crowd.get(index), near, &mut find);
        if let Some(pushed) = pushed.get(index) {
            walker.hits.extend(&pushed.hits);
        }
        act(&mut walker)
    }

    /// The current centre of a shape.
    fn center_of(&self, slot: u32) -> [T; 2] {
        match self.call.rides.rows[slot as usize] {
            NONE => self.call.slots.shape(slot).center(),
            row => match self.rows.binary_search(&row) {
                Ok(index) => self.scratch.crowd.get(index).min,
                Err(_) => self.call.slots.shape(slot).center(),
            },
        }
    }
}

fn sum<T: Scalar>(a: [T; 2], b: [T; 2]) -> [T; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

/// The smallest region that contains two, as lower and upper corner.
pub fn union<T: Scalar>(a: [[T; 2]; 2], b: [[T; 2]; 2]) -> [[T; 2]; 2] {
    [[0, 1].map(|axis| a[0][axis].min(b[0][axis])), [0, 1].map(|axis| a[1][axis].max(b[1][axis]))]
}
