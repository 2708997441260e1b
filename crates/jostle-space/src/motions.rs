//! The motions of the shapes of one island, one after another.
//!
//! Each motion is stopped by all other shapes at their current positions, so it causes no new
//! overlap. A floor that would move into shapes that stand on it pushes them first, and so does
//! another shape with the displacement of the floor: both are parts of one floor. Shapes that stand
//! on a floor are carried after the floor has moved, by the rest of its motion.

use super::floors::NONE;
use super::slide_call::SlideCall;
use super::spatial_hash::SpatialHash;
use super::stacks::{StackedWalker, Stacks};
use super::traces::motion;
use jostle_base::error::Result;
use jostle_base::interrupt::Pulse;
use jostle_base::memory;
use jostle_index::geometry::{Bounds, Scalar, Shape, contact};
use jostle_slide::{Obstacle, SlideHit, Solid, Surface, Walker, slop};

/// Work of a walk, in the units of [`Pulse`].
const WORK: usize = 256;

/// The motion of one shape.
pub(crate) struct Walk<T> {
    /// Its row in the call.
    pub row: usize,
    /// Its centre afterwards, which may be outside the first period.
    pub center: [T; 2],
    /// The displacement that it has made.
    pub moved: [T; 2],
    /// The displacement without its components into obstacles.
    pub remaining: [T; 2],
    /// The obstacles met; some may be listed several times.
    pub hits: Vec<SlideHit<T>>,
    /// The last floor, and the centre of that shape at this time.
    pub floor: Option<(u32, [T; 2])>,
    /// The displacement of that floor, or else of the one on which it stood before.
    pub platform_velocity: [T; 2],
    /// Whether it met a floor, a wall and a ceiling.
    pub kinds: [bool; 3],
    /// Whether it overlaps obstacles that leave it no room.
    pub is_crushed: bool,
    /// The region whose obstacles had an effect.
    pub seen: [[T; 2]; 2],
}

/// How the floors of a shape have pushed it before its own motion.
#[derive(Clone, Debug)]
struct Pushed<T> {
    by: [T; 2],
    /// The part of `by` that is due to other parts of its floor, until its floor moves.
    ahead: [T; 2],
    hits: Vec<SlideHit<T>>,
    /// The region whose obstacles had an effect; empty at first.
    seen: [[T; 2]; 2],
}

impl<T: Scalar> Default for Pushed<T> {
    fn default() -> Self {
        let (by, ahead, hits) = ([T::ZERO; 2], [T::ZERO; 2], Vec::new());
        Self { by, ahead, hits, seen: [[T::INFINITY; 2], [-T::INFINITY; 2]] }
    }
}

/// Scratch of a task.
#[derive(Default)]
pub(crate) struct Scratch<T> {
    near: Vec<Obstacle<T>>,
    stack: Vec<u32>,
    hash: SpatialHash<T>,
    stacks: Stacks,
    /// Whether another shape has the displacement of each, which is not 0.
    twins: Vec<bool>,
    /// Whether each also touches such a shape, and neither stands on the other: both are parts of
    /// one body. Empty if nothing stands on another.
    are_parts: Vec<bool>,
    /// How far along each axis any shape has moved at most: before this call, and, of obstacles, in
    /// it. The second is for shapes that are no obstacles, which meet all motions of the call.
    reach: [[T; 2]; 2],
    /// For each shape; empty if nothing stands on another.
    pushed: Vec<Pushed<T>>,
    /// The shapes that do not stop the one that moves; empty if nothing stands on another.
    skipped: Vec<bool>,
    above: Vec<StackedWalker>,
    /// By how much each of `above` is pushed, and whether it overlaps the one below all.
    pushes: Vec<([T; 2], bool)>,
}

/// The shapes of an island: its rows in the call, and where they are now.
pub(crate) struct Island<'a, T> {
    /// The call.
    pub call: &'a SlideCall<'a, T>,
    /// Its rows, ascending. The index of a shape is its position in this list.
    pub rows: &'a [u32],
    /// The scratch of the task.
    pub scratch: &'a mut Scratch<T>,
}

impl<T: Scalar> Island<'_, T> {
    /// Moves all shapes.
    pub(crate) fn run(&mut self, pulse: &mut Pulse, walks: &mut Vec<Walk<T>>) -> Result<()> {
        let (call, rows) = (self.call, self.rows);
        self.scratch.hash.fill(rows.iter().map(|&row| call.body(row as usize)))?;
        self.order()?;
        let Scratch { stacks, reach, pushed, skipped, .. } = &mut *self.scratch;
        *reach = [[T::ZERO; 2]; 2];
        rows.iter().for_each(|&row| widen(&mut reach[0], call.moved_before(row as usize)));
        pushed.clear();
        skipped.clear();
        if stacks.is_any() {
            memory::resize(pushed, rows.len(), Pushed::default())?;
            memory::resize(skipped, rows.len(), false)?;
        }
        // One after the other, each against the current places of all others. So two shapes never
        // end up in each other, as they could if both moved at the same time against old places.
        for nth in 0..rows.len() {
            let index = self.scratch.stacks.order[nth] as usize;
            self.push_stacked(index, pulse)?;
            let mut walk = self.walk(index);
            pulse.check(WORK + self.scratch.near.len())?;
            let Scratch { above, skipped, hash, pushed, .. } = &mut *self.scratch;
            // `push_stacked` has set these marks for this motion only.
            above.iter().for_each(|upper| skipped[upper.index as usize] = false);
            // At once, so the next shape meets this one where it is now.
            hash.move_to(index, call.period.wrap(walk.center));
            if let Some(pushed) = pushed.get(index) {
                walk.moved = sum(pushed.by, walk.moved);
                walk.seen = union(walk.seen, pushed.seen);
            }
            if call.is_obstacle(walk.row) {
                widen(&mut self.scratch.reach[1], walk.moved);
            }
            memory::push(walks, walk)?;
        }
        Ok(())
    }

    /// Chooses the order of the shapes.
    fn order(&mut self) -> Result<()> {
        let (call, rows, len) = (self.call, self.rows, self.rows.len());
        let Scratch { hash, stacks, twins, are_parts, .. } = &mut *self.scratch;
        let displacement = |index: usize| call.displacements[rows[index] as usize];
        twins.clear();
        are_parts.clear();
        memory::resize(twins, len, false)?;
        if len == 1 {
            return stacks.fill(len, 0..len, |_| None, false, |_, _| Ok(()));
        }
        let mut are_any_twins = false;
        let mut sorted: Vec<u32> = memory::collect(0..len as u32)?;
        // Sorted by displacement, equal ones are neighbours: a comparison of all pairs would be
        // quadratic.
        sorted.sort_unstable_by(|&a, &b| {
            let [a, b] = [a, b].map(|index| displacement(index as usize));
            a[0].total_order(&b[0]).then_with(|| a[1].total_order(&b[1]))
        });
        for pair in sorted.windows(2) {
            let [a, b] = [pair[0] as usize, pair[1] as usize];
            if displacement(a) == displacement(b) && displacement(a) != [T::ZERO; 2] {
                (twins[a], twins[b], are_any_twins) = (true, true, true);
            }
        }
        let (hash, twins) = (&*hash, &*twins);
        let is_obstacle = |index: &usize| call.is_obstacle(rows[*index] as usize);
        let obstacles = (0..len).filter(is_obstacle);
        // What is no obstacle stops nobody. Moved last, it meets everything else where that will
        // stay.
        let starts = obstacles.chain((0..len).filter(|index| !is_obstacle(index)));
        let floor =
            |index: usize| rows.binary_search(&call.moving_floor(rows[index] as usize)?).ok();
        stacks.fill(len, starts, floor, are_any_twins, |index, ahead| {
            if twins[index] {
                each_ahead(call, hash, index, displacement(index), |other| {
                    // The foremost first: in a row of shapes that march together each would
                    // otherwise be stopped by the one before it, which is about to move away.
                    if displacement(other) == displacement(index) {
                        ahead.push(other as u32);
                    }
                });
            }
            // All parts of its floor that it may reach.
            if let Some(floor) = floor(index).filter(|&floor| twins[floor]) {
                let body = hash.get(index);
                let length = |[x, y]: [T; 2]| x.abs() + y.abs();
                let reach = length(displacement(index)) + length(displacement(floor));
                let reach = reach + slop(body, &call.period, reach);
                each_around(call, hash, (body, reach), [T::ZERO; 2], |other, _| {
                    if other != index && displacement(other) == displacement(floor) {
                        ahead.push(other as u32);
                    }
                });
            }
            Ok(())
        })?;
        if stacks.is_any() {
            let is_part = |index: usize| twins[index] && touches_twin(call, hash, (rows, index));
            are_parts.extend((0..len).map(is_part));
        }
        Ok(())
    }

    /// Lists the shapes that a shape would enter and that stand on another one with its
    /// displacement: both are parts of one floor.
    fn list_on_twins(&mut self, index: usize) {
        let (call, rows) = (self.call, self.rows);
        let Scratch { hash, stacks, twins, above, .. } = &mut *self.scratch;
        above.clear();
        if !twins[index] || !stacks.is_any() {
            return;
        }
        let displacement = |index: usize| call.displacements[rows[index] as usize];
        let (body, by) = (hash.get(index), displacement(index));
        let close = slop(body, &call.period, by[0].abs() + by[1].abs());
        each_around(call, hash, (body, close), by, |other, image| {
            let floor = call.moving_floor(rows[other] as usize);
            let floor = floor.and_then(|row| rows.binary_search(&row).ok());
            let is_met =
                image.outline().overlaps(body) || image.outline().enters(body, by, close).is_some();
            if let Some(floor) = floor.filter(|&floor| floor != index && other != index)
                && displacement(floor) == by
                && is_met
            {
                above.push(StackedWalker::on_lowest(other as u32));
            }
        });
        above.sort_unstable_by_key(|upper| upper.index);
        above.dedup();
    }

    /// Pushes the shapes that stand on a shape and would stop its motion, the uppermost first.
    /// Afterwards those that overlapped it before are skipped, and all if it is a part of a body,
    /// whose parts stay together.
    fn push_stacked(&mut self, index: usize, pulse: &mut Pulse) -> Result<()> {
        self.list_on_twins(index);
        let Scratch { stacks, above, pushes, skipped, .. } = &mut *self.scratch;
        stacks.list_above(index, above)?;
        if above.is_empty() {
            return Ok(());
        }
        pushes.clear();
        memory::reserve(pushes, above.len())?;
        above.iter().for_each(|upper| skipped[upper.index as usize] = true);
        // How far the floor would get if those above were not there. They are pushed by that
        // motion, and then the floor moves in earnest, with what they leave free.
        let plan = self.walk(index);
        pulse.check(WORK + self.scratch.near.len())?;
        let Scratch { above, pushes, hash, pushed, skipped, .. } = &mut *self.scratch;
        pushed[index].seen = union(pushed[index].seen, plan.seen);
        let period = self.call.period;
        for upper in &above[..] {
            let (floor, by) = match upper.floor.checked_sub(1) {
                None => (index, difference(plan.moved, pushed[upper.index as usize].ahead)),
                Some(nth) => (above[nth].index as usize, pushes[nth].0),
            };
            let body = hash.get(upper.index as usize);
            let [a, b] = period.nearest_images(hash.get(floor), body);
            let (normal, _) = contact(&a, &b);
            // One that is no obstacle meets the motion of its floor when it moves itself.
            // Only towards the upper one: a floor that sinks or moves sideways does not push, it
            // carries later.
            let is_pushed = by[0] * normal[0] + by[1] * normal[1] > slop(body, &period, T::ZERO)
                && self.call.is_obstacle(self.rows[upper.index as usize] as usize);
            let is_inside = period.overlap(hash.get(index), body);
            pushes.push((if is_pushed { by } else { [T::ZERO; 2] }, is_inside));
            skipped[upper.index as usize] = false;
        }
        // The uppermost first, so that each finds the place above it free.
        for nth in (0..self.scratch.above.len()).rev() {
            let (by, _) = self.scratch.pushes[nth];
            if by != [T::ZERO; 2] {
                let StackedWalker { index, floor, .. } = self.scratch.above[nth];
                let by = self.push(index as usize, by);
                pulse.check(WORK + self.scratch.near.len())?;
                // Its own floor moves later by the whole displacement. What other parts of it have
                // pushed already must not be added again.
                if floor == 0 {
                    let ahead = &mut self.scratch.pushed[index as usize].ahead;
                    *ahead = sum(*ahead, by);
                }
            }
        }
        let Scratch { above, pushes, skipped, are_parts, .. } = &mut *self.scratch;
        for (upper, &(_, is_inside)) in above.iter().zip(&pushes[..]) {
            skipped[upper.index as usize] = is_inside || are_parts[index];
        }
        Ok(())
    }

    /// Pushes a shape by a displacement; it slides along obstacles. Returns how far it has moved.
    fn push(&mut self, index: usize, by: [T; 2]) -> [T; 2] {
        let start = self.scratch.hash.get(index).min;
        let (center, hits, seen) = self.with_walker(index, Around::default(), |walker| {
            walker.slide(by);
            (walker.center(), std::mem::take(&mut walker.hits), walker.seen)
        });
        let Scratch { hash, pushed, .. } = &mut *self.scratch;
        hash.move_to(index, self.call.period.wrap(center));
        let all = &mut pushed[index];
        let moved = difference(center, start);
        all.by = sum(all.by, moved);
        all.hits = hits;
        all.seen = union(all.seen, seen);
        moved
    }

    /// The motion of a shape among all others that are not skipped, which is computed but not made.
    fn walk(&mut self, index: usize) -> Walk<T> {
        let (call, row) = (self.call, self.rows[index] as usize);
        let start = self.scratch.hash.get(index).min;
        let carried = call.standing(row).map_or([T::ZERO; 2], |(floor, before)| {
            let by = motion(&call.period, before, self.center_of(floor));
            let pushed = self.scratch.pushed.get(index).map_or([T::ZERO; 2], |pushed| pushed.by);
            difference(by, pushed)
        });
        // What it stops has not passed through it.
        let is_passed = !call.is_obstacle(row);
        let [before, now] = self.scratch.reach;
        let reach = if is_passed { [0, 1].map(|axis| before[axis].max(now[axis])) } else { before };
        // Nothing has moved since the last motion of this shape, so there is no motion to repeat.
        // This is the usual case of a crowd on a floor that stands still.
        let is_calm = carried == [T::ZERO; 2] && reach == [T::ZERO; 2] && call.moved.is_empty();
        let around = Around { reach, is_passed, carried };
        let mut walk = self.with_walker(index, around, |walker| {
            if !is_calm {
                walker.carry(carried);
            }
            let was_free = walker.leave_obstacles();
            walker.walk(call.displacements[row]);
            Walk {
                row,
                center: walker.center(),
                moved: difference(walker.center(), start),
                remaining: walker.remaining,
                floor: walker.last_of(Surface::Floor).map(|slot| (slot, start)),
                platform_velocity: [T::ZERO; 2],
                kinds: [Surface::Floor, Surface::Wall, Surface::Ceiling]
                    .map(|kind| walker.last_of(kind).is_some()),
                // Its own motion may have brought it out.
                is_crushed: !was_free && !walker.is_free(),
                seen: walker.seen,
                hits: std::mem::take(&mut walker.hits),
            }
        });
        if let Some((slot, center)) = walk.floor.as_mut() {
            *center = self.center_of(*slot);
        }
        walk.platform_velocity = self.platform_velocity(row, walk.floor);
        walk
    }

    /// The motion, since the last motion of a row, of the floor on which it is, or else was.
    fn platform_velocity(&self, row: usize, floor: Option<(u32, [T; 2])>) -> [T; 2] {
        let viewer = self.call.viewer(row);
        let slot = floor.or(viewer.floor).map(|(slot, _)| slot);
        slot.map_or([T::ZERO; 2], |slot| self.call.motion(&viewer, slot, self.center_of(slot)))
    }

    /// Calls `act` with a shape that can move among all others that are not skipped.
    fn with_walker<R>(
        &mut self,
        index: usize,
        around: Around<T>,
        act: impl FnOnce(&mut Walker<'_, T>) -> R,
    ) -> R {
        let (call, rows) = (self.call, self.rows);
        let viewer = call.viewer(rows[index] as usize);
        let Scratch { near, stack, hash, skipped, pushed, .. } = &mut *self.scratch;
        let hash = &*hash;
        let is_skipped = |other: usize| other == index || skipped.get(other) == Some(&true);
        let mut find = |bounds: &Bounds<T>, near: &mut Vec<Obstacle<T>>| {
            for turns in call.period.images_near(bounds.min, bounds.max) {
                let bounds = &bounds.moved(call.period.span(turns));
                call.find(&viewer, bounds, turns, stack, near);
                // Shapes of the island may have been up to `reach` away when their motions began,
                // which are met as well.
                let wide = Bounds {
                    min: difference(bounds.min, around.reach),
                    max: sum(bounds.max, around.reach),
                    ..*bounds
                };
                hash.each_near(&wide, |other, body| {
                    if is_skipped(other) {
                        return;
                    }
                    let index = call.walkers[rows[other] as usize];
                    let mut motion = call.motion(&viewer, index, body.min);
                    // A motion from before this call is met in any case. One of this call has been
                    // stopped by this shape already, unless the shape is no obstacle.
                    let is_recorded = call.traces.before(index, viewer.since).is_some();
                    if !around.is_passed && !is_recorded {
                        motion =
                            around.motion_with_floor(motion, slop(body, &call.period, T::ZERO));
                    }
                    near.push(Obstacle { solid: Solid::Shape(*body), turns, motion, index });
                });
            }
        };
        let rules = (call.rules, call.period);
        let mut walker = Walker::new(rules, *hash.get(index), near, &mut find);
        if let Some(pushed) = pushed.get(index) {
            walker.hits.extend(&pushed.hits);
        }
        act(&mut walker)
    }

    /// The current centre of a shape.
    fn center_of(&self, slot: u32) -> [T; 2] {
        match self.call.floors.rows[slot as usize] {
            NONE => self.call.slots.shape(slot).center(),
            // A floor in another island has moved or will move; its place before the call is what
            // both orders agree on.
            row => match self.rows.binary_search(&row) {
                Ok(index) => self.scratch.hash.get(index).min,
                Err(_) => self.call.slots.shape(slot).center(),
            },
        }
    }
}

/// Which motions of other shapes of a call a shape meets.
#[derive(Default)]
struct Around<T> {
    /// How far away from the path these shapes may be now.
    reach: [T; 2],
    /// Whether it meets all of them. Otherwise the others have been stopped by it, and it meets
    /// only those that move with its floor.
    is_passed: bool,
    /// The motion of its floor, as far as it has not followed it yet.
    carried: [T; 2],
}

impl<T: Scalar> Around<T> {
    /// The motion of another shape, if it is that of the floor up to rounding errors.
    fn motion_with_floor(&self, motion: [T; 2], slop: T) -> [T; 2] {
        let [x, y] = difference(motion, self.carried);
        if x.abs() <= slop && y.abs() <= slop { self.carried } else { [T::ZERO; 2] }
    }
}

fn sum<T: Scalar>(a: [T; 2], b: [T; 2]) -> [T; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

fn difference<T: Scalar>(a: [T; 2], b: [T; 2]) -> [T; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

/// Increases the lengths along each axis to those of a displacement.
fn widen<T: Scalar>(reach: &mut [T; 2], by: [T; 2]) {
    *reach = [0, 1].map(|axis| reach[axis].max(by[axis].abs()));
}

/// Whether a shape touches one with its displacement, and neither stands on the other.
fn touches_twin<T: Scalar>(
    call: &SlideCall<'_, T>,
    hash: &SpatialHash<T>,
    (rows, index): (&[u32], usize),
) -> bool {
    let displacement = |index: usize| call.displacements[rows[index] as usize];
    let stands_on = |a: usize, b: usize| call.moving_floor(rows[a] as usize) == Some(rows[b]);
    let (body, period, mut is_found) = (hash.get(index), call.period, false);
    let close = slop(body, &period, T::ZERO);
    each_around(call, hash, (body, close), [T::ZERO; 2], |other, _| {
        let [a, b] = period.nearest_images(body, hash.get(other));
        is_found |= other != index
            && displacement(other) == displacement(index)
            && !stands_on(other, index)
            && !stands_on(index, other)
            && contact(&a, &b).1 >= -close;
    });
    is_found
}

/// Calls `act` with the index of each shape that another one would enter by a displacement.
fn each_ahead<T: Scalar>(
    call: &SlideCall<'_, T>,
    hash: &SpatialHash<T>,
    index: usize,
    displacement: [T; 2],
    mut act: impl FnMut(usize),
) {
    let body = hash.get(index);
    let close = slop(body, &call.period, displacement[0].abs() + displacement[1].abs());
    each_around(call, hash, (body, close), displacement, |other, image| {
        if other != index && image.outline().enters(body, displacement, close).is_some() {
            act(other);
        }
    });
}

/// Calls `act` with the index and the image of each shape that may be closer than `close` to the
/// path of a shape along a displacement.
fn each_around<T: Scalar>(
    call: &SlideCall<'_, T>,
    hash: &SpatialHash<T>,
    (body, close): (&Shape<T>, T),
    displacement: [T; 2],
    mut act: impl FnMut(usize, Solid<T>),
) {
    let [min, max] = [-T::ONE, T::ONE].map(|side| {
        [0, 1].map(|axis| {
            let reach = body.half_size[axis] + body.radius + close;
            let ahead =
                if displacement[axis] * side > T::ZERO { displacement[axis] } else { T::ZERO };
            body.min[axis] + side * reach + ahead
        })
    });
    let bounds = Bounds {
        min,
        max,
        half_size: [T::ZERO; 2],
        radius: T::ZERO,
        category: body.category,
        mask: body.mask & call.rules.mask(),
    };
    for turns in call.period.images_near(min, max) {
        let shift = call.period.span(turns);
        hash.each_near(&bounds.moved(shift), |other, shape| {
            act(other, Solid::Shape(shape.moved([-shift[0], -shift[1]])));
        });
    }
}

/// The smallest region that contains two, as lower and upper corner.
pub(crate) fn union<T: Scalar>(a: [[T; 2]; 2], b: [[T; 2]; 2]) -> [[T; 2]; 2] {
    [[0, 1].map(|axis| a[0][axis].min(b[0][axis])), [0, 1].map(|axis| a[1][axis].max(b[1][axis]))]
}
