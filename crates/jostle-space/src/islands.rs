//! Islands of walkers whose paths may meet.
//!
//! Walkers whose regions overlap are in one island. Regions are sorted by the `cells` that they
//! touch. In a cell with few of them, each pair is tested; more than a few are joined without a
//! test, so the cost does not grow with the square of their number. An island may be larger than
//! needed, never smaller.

use std::ops::Range;

use super::cells::{self, Cell, Level};
use jostle_base::disjoint_sets::DisjointSets;
use jostle_base::error::Result;
use jostle_base::interrupt::Pulse;
use jostle_base::memory;
use jostle_index::geometry::Scalar;

/// Maximum number of pairs of two groups that are tested.
const FEW_PAIRS: usize = 256;

/// The rows of a call by island, ascending in each.
pub(crate) struct Islands {
    rows: Vec<u32>,
    ends: Vec<u32>,
}

impl Islands {
    /// Islands of the rows below `len`, from the sets of rows that belong together.
    pub(crate) fn of(sets: &mut DisjointSets, len: usize) -> Result<Self> {
        let roots: Vec<u32> = memory::collect((0..len as u32).map(|row| sets.root(row)))?;
        let mut rows: Vec<u32> = memory::collect(0..len as u32)?;
        // The root of a set is its smallest row, so islands are in the order of their first rows,
        // whatever the order in which sets were joined.
        rows.sort_unstable_by_key(|&row| (roots[row as usize], row));
        let mut ends: Vec<u32> = memory::with_capacity(len)?;
        let root = |index: usize| roots[rows[index] as usize];
        let is_end = |&end: &usize| end == len || root(end) != root(end - 1);
        ends.extend((1..=len).filter(is_end).map(|end| end as u32));
        Ok(Self { rows, ends })
    }

    /// Number of islands.
    pub(crate) fn len(&self) -> usize {
        self.ends.len()
    }

    /// The rows of an island.
    pub(crate) fn rows(&self, index: usize) -> &[u32] {
        let start = if index == 0 { 0 } else { self.ends[index - 1] as usize };
        &self.rows[start..self.ends[index] as usize]
    }
}

/// Merges the sets of the rows whose boxes `[min, max]` overlap.
pub(crate) fn join_overlapping<T: Scalar>(
    sets: &mut DisjointSets,
    boxes: &[[[T; 2]; 2]],
) -> Result<()> {
    let touched = Touched::of(boxes)?;
    let mut pulse = Pulse::current();
    let mut start = 0;
    while start < touched.0.len() {
        let (level, cell, _) = touched.0[start];
        let group = touched.group(level, cell);
        start = group.end;
        pulse.check(FEW_PAIRS.min(group.len() * group.len()) + group.len())?;
        let rows = &touched.0[group.clone()];
        join_groups(sets, boxes, rows, rows);
        // A small box meets a large one in the cell of the large one's level that contains its own
        // cell. Upwards only, so each pair of groups is visited once.
        for coarser in touched.levels_above(level) {
            let above = touched.group(coarser, cells::ancestor(cell, coarser - level));
            join_groups(sets, boxes, rows, &touched.0[above]);
        }
    }
    Ok(())
}

/// Level, cell and row.
type Entry = (Level, Cell, u32);

/// The cells that boxes touch, sorted.
struct Touched(Vec<Entry>);

impl Touched {
    fn of<T: Scalar>(boxes: &[[[T; 2]; 2]]) -> Result<Self> {
        let mut all = Vec::new();
        for (row, &[min, max]) in boxes.iter().enumerate() {
            let side = (max[0] - min[0]).max(max[1] - min[1]);
            let level = cells::level_of(side.to_f64());
            for cell in cells::each(cells::range(level, min, max)) {
                memory::push(&mut all, (level, cell, row as u32))?;
            }
        }
        all.sort_unstable();
        Ok(Self(all))
    }

    /// The entries of a cell.
    fn group(&self, level: Level, cell: Cell) -> Range<usize> {
        let key = |entry: &Entry| (entry.0, entry.1);
        let start = self.0.partition_point(|entry| key(entry) < (level, cell));
        let len = self.0[start..].partition_point(|entry| key(entry) == (level, cell));
        start..start + len
    }

    /// The levels of boxes above a level, ascending.
    fn levels_above(&self, level: Level) -> impl Iterator<Item = Level> {
        let next = |level: Level| {
            let start = self.0.partition_point(|entry| entry.0 <= level);
            self.0.get(start).map(|entry| entry.0)
        };
        std::iter::successors(next(level), move |&level| next(level))
    }
}

fn join_groups<T: Scalar>(
    sets: &mut DisjointSets,
    boxes: &[[[T; 2]; 2]],
    a: &[Entry],
    b: &[Entry],
) {
    // In a cell with very many shapes nearly all of them are connected in any case. Too large an
    // island costs parallel work, never a wrong result.
    if a.len() * b.len() > FEW_PAIRS {
        a.iter().chain(b).for_each(|entry| sets.join(a[0].2, entry.2));
        return;
    }
    for first in a {
        for second in b {
            let [one, other] = [first, second].map(|entry| boxes[entry.2 as usize]);
            if (0..2).all(|axis| one[0][axis] <= other[1][axis] && other[0][axis] <= one[1][axis]) {
                sets.join(first.2, second.2);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sets by brute force.
    fn slowly(boxes: &[[[f64; 2]; 2]]) -> DisjointSets {
        let mut sets = DisjointSets::default();
        sets.reset(boxes.len()).unwrap();
        for (i, a) in boxes.iter().enumerate() {
            for (j, b) in boxes.iter().enumerate() {
                if (0..2).all(|axis| a[0][axis] <= b[1][axis] && b[0][axis] <= a[1][axis]) {
                    sets.join(i as u32, j as u32);
                }
            }
        }
        sets
    }

    #[test]
    fn boxes_of_all_sizes_that_overlap_are_in_one_set() {
        let mut state = 7u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as f64 / f64::from(1u32 << 24)
        };
        for spread in [1.0, 30.0, 1000.0] {
            let boxes: Vec<[[f64; 2]; 2]> = (0..200)
                .map(|_| {
                    let min = [random() * spread - spread / 2.0, random() * spread];
                    let side = 4f64.powf(random() * 6.0 - 3.0);
                    [min, [min[0] + side * random(), min[1] + side]]
                })
                .collect();
            let mut sets = DisjointSets::default();
            sets.reset(boxes.len()).unwrap();
            join_overlapping(&mut sets, &boxes).unwrap();
            let mut exact = slowly(&boxes);
            for row in 0..200 {
                let root = exact.root(row);
                assert_eq!(sets.root(row), sets.root(root), "{spread} {row}");
                if spread == 1000.0 {
                    assert_eq!(sets.root(row), root);
                }
            }
        }
    }
}
