//! The walkers of an island at their current positions, found by a region.
//!
//! A hash table of the `cells` that they touch. With few walkers, all are tested.

use super::cells::{self, Cell, Level};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_index::geometry::{Bounds, Scalar, Shape};

/// Up to this number of walkers, testing all is faster.
const FEW: usize = 64;

/// No entry.
const NONE: u32 = u32::MAX;

/// Maximum number of cells that a body touches.
const CELLS: usize = 4;

/// Bodies given by their centres.
#[derive(Debug, Default)]
pub(crate) struct SpatialHash<T> {
    /// The bodies.
    bodies: Vec<Shape<T>>,
    /// The level of each; empty if there are few.
    levels: Vec<Level>,
    /// The levels of all, ascending.
    all_levels: Vec<Level>,
    /// The first entry of each bucket. Entry `CELLS * k + i` is that of the body `k` in its `i`th
    /// cell.
    heads: Vec<u32>,
    next: Vec<u32>,
}

impl<T: Scalar> SpatialHash<T> {
    /// Replaces the bodies.
    pub(crate) fn fill(&mut self, bodies: impl ExactSizeIterator<Item = Shape<T>>) -> Result<()> {
        self.bodies.clear();
        self.levels.clear();
        memory::reserve(&mut self.bodies, bodies.len())?;
        self.bodies.extend(bodies);
        let len = self.bodies.len();
        // Building and updating the table costs more than testing up to 64 boxes for each region.
        if len <= FEW {
            return Ok(());
        }
        // Small bodies belong to the level of the mean.
        let side = |body: &Shape<T>| {
            let [x, y] = extents(body).map(T::to_f64);
            let position = body.min[0].abs().max(body.min[1].abs()).to_f64();
            2.0 * x.max(y) + position * 8.0 * T::EPSILON.to_f64()
        };
        // Small bodies share the level of the mean, so that a region is looked up in few levels.
        // The price is some more candidates in their cells.
        let mean = self.bodies.iter().map(side).sum::<f64>() / len as f64;
        memory::reserve(&mut self.levels, len)?;
        let least = mean.max(f64::MIN_POSITIVE);
        self.levels.extend(self.bodies.iter().map(|body| cells::level_of(side(body).max(least))));
        self.all_levels.clear();
        for &level in &self.levels {
            if let Err(at) = self.all_levels.binary_search(&level) {
                self.all_levels.insert(at, level);
            }
        }
        self.heads.clear();
        memory::resize(&mut self.heads, 2 * len.next_power_of_two(), NONE)?;
        self.next.clear();
        memory::resize(&mut self.next, CELLS * len, NONE)?;
        (0..len).for_each(|index| self.link(index));
        Ok(())
    }

    /// A body.
    pub(crate) fn get(&self, index: usize) -> &Shape<T> {
        &self.bodies[index]
    }

    /// Moves a body.
    pub(crate) fn move_to(&mut self, index: usize, center: [T; 2]) {
        if self.is_sorted() {
            self.unlink(index);
        }
        self.bodies[index].min = center;
        self.bodies[index].max = center;
        if self.is_sorted() {
            self.link(index);
        }
    }

    /// Calls `act` with each body that may overlap a region and whose filters allow it, once.
    pub(crate) fn each_near(&self, region: &Bounds<T>, mut act: impl FnMut(usize, &Shape<T>)) {
        let mut test = |index: usize| {
            let body = &self.bodies[index];
            if Bounds::of(body).overlaps(region, [T::ZERO; 2], -T::INFINITY) {
                act(index, body);
            }
        };
        let range = |level| cells::range(level, region.min, region.max);
        let count = |level| {
            let [first, last] = range(level);
            let side = |axis: usize| last[axis] as f64 - first[axis] as f64 + 1.0;
            side(0) * side(1)
        };
        let cells: f64 = self.all_levels.iter().map(|&level| count(level)).sum();
        // A region of more cells than there are bodies: a test of each body is shorter.
        if !self.is_sorted() || cells > self.bodies.len() as f64 {
            (0..self.bodies.len()).for_each(test);
            return;
        }
        for &level in &self.all_levels {
            let searched = range(level);
            for cell in cells::each(searched) {
                let mut entry = self.heads[self.bucket(level, cell)];
                while entry != NONE {
                    let index = entry as usize / CELLS;
                    // A body in several of these cells is tested in the first cell that it has in
                    // common with the region. A bucket may have bodies of other cells, and a body
                    // in several of its cells.
                    let [own, last] = self.cells_of(index);
                    let first = [0, 1].map(|axis: usize| own[axis].max(searched[0][axis]));
                    let (at, width) = ((entry as usize % CELLS) as i64, last[0] - own[0] + 1);
                    let is_of_cell = cell == [own[0] + at % width, own[1] + at / width];
                    if self.levels[index] == level && is_of_cell && first == cell {
                        test(index);
                    }
                    entry = self.next[entry as usize];
                }
            }
        }
    }

    fn is_sorted(&self) -> bool {
        !self.levels.is_empty()
    }

    fn cells_of(&self, index: usize) -> [Cell; 2] {
        let body = &self.bodies[index];
        let extent = extents(body);
        let side = |sign: T| [0, 1].map(|axis| body.min[axis] + sign * extent[axis]);
        cells::range(self.levels[index], side(-T::ONE), side(T::ONE))
    }

    fn bucket(&self, level: Level, [x, y]: Cell) -> usize {
        // Odd factors from the golden ratio and from hash functions: neighbouring cells get buckets
        // far from each other. The order in a bucket has no effect, because the walker takes the
        // first impact with ties by geometry.
        let mixed = (x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
            ^ (y as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f)
            ^ (level as u64).wrapping_mul(0x1656_67b1_9e37_79f9);
        (mixed.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as usize & (self.heads.len() - 1)
    }

    fn link(&mut self, index: usize) {
        for (k, cell) in cells::each(self.cells_of(index)).take(CELLS).enumerate() {
            let (bucket, entry) = (self.bucket(self.levels[index], cell), CELLS * index + k);
            // The entry of a body in its k-th cell has a fixed number, so linking and unlinking
            // allocate nothing.
            self.next[entry] = std::mem::replace(&mut self.heads[bucket], entry as u32);
        }
    }

    fn unlink(&mut self, index: usize) {
        for (k, cell) in cells::each(self.cells_of(index)).take(CELLS).enumerate() {
            let (bucket, entry) = (self.bucket(self.levels[index], cell), CELLS * index + k);
            let after = self.next[entry];
            if self.heads[bucket] as usize == entry {
                self.heads[bucket] = after;
                continue;
            }
            let mut before = self.heads[bucket] as usize;
            while self.next[before] as usize != entry {
                before = self.next[before] as usize;
            }
            self.next[before] = after;
        }
    }
}

fn extents<T: Scalar>(body: &Shape<T>) -> [T; 2] {
    body.half_size.map(|half| half + body.radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moving_bodies_are_found_as_by_testing_all() {
        let mut state = 3u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as f64 / f64::from(1u32 << 24)
        };
        let mut body = |scale: f64| {
            let center = [random() * 100.0 - 50.0, random() * 100.0];
            let half_size = [random() * scale, 0.0];
            let radius = random() * scale;
            Shape {
                min: center,
                max: center,
                half_size,
                radius,
                category: 1,
                mask: 1,
                core: jostle_index::Core::Box,
            }
        };
        let all: Vec<_> = (0..300).map(|k| body(if k % 40 == 0 { 30.0 } else { 1.0 })).collect();
        let mut hash = SpatialHash::default();
        hash.fill(all.iter().copied()).unwrap();
        for round in 0..600 {
            let probe = body(if round % 10 == 0 { 60.0 } else { 2.0 });
            hash.move_to(round * 7 % 300, probe.min);
            let extent = extents(&probe);
            let side = |sign: f64| [0, 1].map(|k| probe.min[k] + sign * extent[k]);
            let (half_size, radius) = ([0.0; 2], 0.0);
            let region =
                Bounds { min: side(-1.0), max: side(1.0), half_size, radius, category: 1, mask: 1 };
            let mut found = Vec::new();
            hash.each_near(&region, |index, _| found.push(index));
            found.sort_unstable();
            let meets = |index: &usize| {
                Bounds::of(hash.get(*index)).overlaps(&region, [0.0; 2], f64::NEG_INFINITY)
            };
            assert_eq!(found, (0..300).filter(meets).collect::<Vec<_>>());
        }
    }
}
