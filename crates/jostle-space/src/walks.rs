//! The motions of the shapes that slide in a call.
//!
//! Shapes whose paths may meet form an island, and so do a shape and the moving floor on which it
//! stands. The shapes of an island move one after another, in the order of the call, with three
//! exceptions: a floor moves before the shapes that stand on it, the foremost of shapes with the
//! same displacement first, and shapes that are no obstacles last. Islands move in parallel. So
//! results do not depend on threads, nor on the order of shapes that do not meet.

use super::islands::{Islands, join_overlapping};
use super::motions::{Island, Scratch, Walk, union};
use super::slide_call::SlideCall;
use super::traces::motion;
use jostle_base::disjoint_sets::DisjointSets;
use jostle_base::error::Result;
use jostle_base::interrupt::{Pulse, Stop};
use jostle_base::memory;
use jostle_base::parallel;
use jostle_index::geometry::Scalar;
use jostle_slide::contains;

/// Number of islands of a task.
const ISLANDS_PER_TASK: usize = 32;

/// Minimum number of shapes for which threads that are awake are used, and are woken.
const WORTH_SHARING: usize = 64;
const WORTH_WAKING: usize = 512;

impl<T: Scalar> SlideCall<'_, T> {
    /// Moves all shapes. If a shape leaves the region by which its island was chosen, because it
    /// was deep inside an obstacle or its floor moved far, its region is enlarged and all motions
    /// are computed again.
    pub(crate) fn run(&self, threads: Option<usize>) -> Result<Vec<Walk<T>>> {
        let len = self.walkers.len();
        // Walkers that are no obstacles cannot meet, however near they are: each is an island, and
        // no region is needed.
        let may_meet = len > 1 && (0..len).any(|row| self.is_obstacle(row));
        let rows = if may_meet { len } else { 0 };
        let mut regions = memory::collect((0..rows).map(|row| self.region(row)))?;
        let mut sets = self.stacked()?;
        loop {
            self.join_meeting(&mut sets, &regions)?;
            let islands = Islands::of(&mut sets, self.walkers.len())?;
            let walks = self.walk_islands(&islands, threads)?;
            // Regions are estimates made before the motions are known. A motion that leaves its
            // region may have met shapes of another island, which are not where they are taken to
            // be. So the region grows to what was looked at, islands are merged, and all motions
            // are computed again from the same start. It ends: with the same islands the motions
            // are the same and stay in the regions, and the number of islands can only fall.
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
                // Only images that touch the first period: of two regions that overlap in the
                // periodic plane, some images overlap there.
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
        images.reset(boxes.len())?;
        join_overlapping(&mut images, &boxes)?;
        (0..boxes.len()).for_each(|image| {
            let root = images.root(image as u32);
            // Sets of images become sets of rows: all images of a row are one.
            sets.join(rows[image], rows[root as usize]);
        });
        Ok(())
    }

    fn walk_islands(&self, islands: &Islands, threads: Option<usize>) -> Result<Vec<Walk<T>>> {
        let len = self.walkers.len();
        // A walk is several casts, each with a search of all layers, so it costs far more than a
        // shape of a pair search. Calls with as many walkers, with one thread and with two, measure
        // the limits.
        let threads = parallel::threads_for(threads, len, WORTH_SHARING, WORTH_WAKING);
        let stop = Stop::current();
        let parts = parallel::map(threads, islands.len().div_ceil(ISLANDS_PER_TASK), |part| {
            let mut pulse = Pulse::of(&stop);
            let mut walks = Vec::new();
            let mut scratch = Scratch::default();
            let first = part * ISLANDS_PER_TASK;
            for island in first..islands.len().min(first + ISLANDS_PER_TASK) {
                let (call, rows, scratch) = (self, islands.rows(island), &mut scratch);
                Island { call, rows, scratch }.run(&mut pulse, &mut walks)?;
            }
            Ok(walks)
        });
        let mut all = memory::with_capacity(len)?;
        for part in parts {
            all.extend(part?);
        }
        Ok(all)
    }

    /// The sets of the walkers that stand on each other.
    fn stacked(&self) -> Result<DisjointSets> {
        let len = self.walkers.len();
        let mut sets = DisjointSets::default();
        sets.reset(len)?;
        for row in 0..len {
            if let Some(floor) = self.moving_floor(row) {
                sets.join(row as u32, floor);
            }
        }
        Ok(sets)
    }

    /// A box that contains all positions that a shape may take or has had since the last motions of
    /// others, with a margin for rounding, unless it leaves an obstacle from far inside, an
    /// obstacle that has moved pushes it, or its floor is carried too.
    fn region(&self, row: usize) -> [[T; 2]; 2] {
        let (shape, displacement) = (self.body(row), self.displacements[row]);
        let sum = |v: [T; 2]| v[0].abs() + v[1].abs();
        let carried = self.standing(row).map_or(T::ZERO, |(floor, before)| {
            let own = self.moving_floor(row).map(|row| sum(self.displacements[row as usize]));
            sum(motion(&self.period, before, self.slots.center(floor))) + own.unwrap_or(T::ZERO)
        });
        // Sums of absolute components are upper bounds of lengths without a square root. Sliding
        // never makes a displacement longer, and a floor carries at most by its own motion.
        let length = sum(displacement) + carried + sum(self.moved_before(row)) + self.rules.reach();
        let extent = [0, 1].map(|axis| shape.half_size[axis] + shape.radius);
        let size = sum(shape.min) + sum(self.period.sides()) + length + sum(extent);
        let margin = length + extent[0] + extent[1] + size * T::EPSILON * T::from_f64(256.0);
        let [x, y] = shape.min;
        let half_width = [extent[0] + margin, extent[1] + margin];
        [[x - half_width[0], y - half_width[1]], [x + half_width[0], y + half_width[1]]]
    }
}
