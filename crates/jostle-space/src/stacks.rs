//! The walkers of an island that stand on others: the order in which all move, and which stand on
//! which.

use jostle_base::error::Result;
use jostle_base::memory;

/// No walker.
const NONE: u32 = u32::MAX;

/// A floor pushes the walkers on it, those on them and so on, up to this number of levels.
const MAX_STACKED: u32 = 64;

/// Walkers by their indices in the island, each with the floor on which it stands.
#[derive(Debug, Default)]
pub(crate) struct Stacks {
    /// All walkers in the order in which they move.
    pub order: Vec<u32>,
    /// The first walker that stands on each; empty if nothing stands on another.
    first: Vec<u32>,
    /// The next one that stands on the same floor.
    next: Vec<u32>,
    /// Whether each is in `order`.
    listed: Vec<bool>,
    waiting: Vec<u32>,
}

/// A walker that stands on another one, or on one that stands on it, and so on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StackedWalker {
    /// Its index in the island.
    pub index: u32,
    /// The index of its floor in the list, plus 1; 0 if it stands on the lowest one.
    pub floor: usize,
    depth: u32,
}

impl StackedWalker {
    /// A walker that stands on the lowest one.
    pub(crate) fn on_lowest(index: u32) -> Self {
        Self { index, floor: 0, depth: 0 }
    }
}

impl Stacks {
    /// Replaces the walkers. `floor` is the index of the floor of a walker. The order is that of
    /// `starts`, except that the floor, and others that `ahead` lists, move before a walker.
    /// `is_any_ahead` is whether it lists any.
    pub(crate) fn fill(
        &mut self,
        len: usize,
        starts: impl Iterator<Item = usize>,
        floor: impl Fn(usize) -> Option<usize>,
        is_any_ahead: bool,
        mut ahead: impl FnMut(usize, &mut Vec<u32>) -> Result<()>,
    ) -> Result<()> {
        self.order.clear();
        self.first.clear();
        self.listed.clear();
        memory::reserve(&mut self.order, len)?;
        let is_any_floor = (0..len).any(|index| floor(index).is_some());
        if !is_any_floor && !is_any_ahead {
            self.order.extend(starts.map(|index| index as u32));
            return Ok(());
        }
        memory::resize(&mut self.listed, len, false)?;
        let (mut is_found, mut found) = (memory::filled(len, false)?, Vec::new());
        // A depth-first search (topological order): what a walker stands on, and what is ahead of
        // it, is listed before it. The stack is a list, because a tower of a thousand crates is a
        // chain of a thousand floors.
        for start in starts {
            memory::push(&mut self.waiting, start as u32)?;
            while let Some(&index) = self.waiting.last() {
                let at = index as usize;
                // Met for the second time: everything that had to come before it is in the list
                // now.
                if std::mem::replace(&mut is_found[at], true) {
                    self.waiting.pop();
                    if !std::mem::replace(&mut self.listed[at], true) {
                        self.order.push(index);
                    }
                    continue;
                }
                found.clear();
                ahead(at, &mut found)?;
                found.extend(floor(at).map(|floor| floor as u32));
                // One that is found already is in the list, or waits for this one in a ring.
                found.retain(|&other| !is_found[other as usize]);
                // The spatial hash finds neighbours in any order. Descending, since the last one
                // pushed is taken first.
                found.sort_unstable_by(|a, b| b.cmp(a));
                memory::reserve(&mut self.waiting, found.len())?;
                self.waiting.append(&mut found);
            }
        }
        if !is_any_floor {
            return Ok(());
        }
        self.next.clear();
        memory::resize(&mut self.first, len, NONE)?;
        memory::resize(&mut self.next, len, NONE)?;
        // In a ring, the walker that moves first counts as having no floor.
        for &index in self.order.iter().rev() {
            self.listed[index as usize] = false;
            if let Some(floor) = floor(index as usize)
                && self.listed[floor]
            {
                self.next[index as usize] = self.first[floor];
                self.first[floor] = index;
            }
        }
        Ok(())
    }

    /// Whether any walker stands on another.
    pub(crate) fn is_any(&self) -> bool {
        !self.first.is_empty()
    }

    /// Adds to `above`, which has some that stand on a walker, all others that do, those on them and
    /// so on, a floor before what stands on it.
    pub(crate) fn list_above(&self, index: usize, above: &mut Vec<StackedWalker>) -> Result<()> {
        let (mut lowest, mut floor, mut depth) = (index, 0, 0);
        loop {
            let mut upper = self.first.get(lowest).copied().unwrap_or(NONE);
            // Above 64 levels a tower is carried but not pushed: each floor of it would push all
            // above, so the cost grows with the square of its height.
            while upper != NONE && depth < MAX_STACKED {
                memory::push(above, StackedWalker { index: upper, floor, depth })?;
                upper = self.next[upper as usize];
            }
            let Some(next) = above.get(floor) else { return Ok(()) };
            (lowest, depth) = (next.index as usize, next.depth + 1);
            floor += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fill(stacks: &mut Stacks, floors: &[Option<usize>]) {
        let len = floors.len();
        stacks.fill(len, 0..len, |index| floors[index], false, |_, _| Ok(())).unwrap();
    }

    fn above(floors: &[Option<usize>], index: usize) -> Vec<(u32, usize)> {
        let (mut stacks, mut above) = (Stacks::default(), Vec::new());
        fill(&mut stacks, floors);
        stacks.list_above(index, &mut above).unwrap();
        above.iter().map(|upper| (upper.index, upper.floor)).collect()
    }

    fn order(floors: &[Option<usize>]) -> Vec<u32> {
        let mut stacks = Stacks::default();
        fill(&mut stacks, floors);
        stacks.order
    }

    #[test]
    fn floors_come_before_what_stands_on_them() {
        assert_eq!(order(&[None, None, None]), [0, 1, 2]);
        assert_eq!(order(&[Some(2), None, Some(1), Some(1)]), [1, 2, 0, 3]);
        assert_eq!(order(&[Some(1), Some(2), Some(0), Some(1)]), [2, 1, 0, 3]);
    }

    #[test]
    fn those_ahead_come_first() {
        let mut stacks = Stacks::default();
        let ahead = |index: usize, ahead: &mut Vec<u32>| {
            ahead.extend([&[2, 3][..], &[], &[3], &[0], &[1]][index]);
            Ok(())
        };
        stacks.fill(5, [4, 0, 1, 2, 3].into_iter(), |_| None, true, ahead).unwrap();
        assert_eq!(stacks.order, [1, 4, 3, 2, 0]);
        assert!(!stacks.is_any());
    }

    #[test]
    fn riders_of_riders_are_listed_with_their_floors() {
        let floors = [None, Some(0), Some(1), Some(0), Some(3), Some(2), None];
        assert_eq!(above(&floors, 0), [(1, 0), (3, 0), (2, 1), (4, 2), (5, 3)]);
        assert_eq!(above(&floors, 2), [(5, 0)]);
        assert_eq!(above(&floors, 6), []);
        assert_eq!(above(&[None, None], 0), []);
    }

    #[test]
    fn a_ring_is_cut_below_the_one_that_moves_first() {
        let ring = [Some(1), Some(2), Some(0)];
        assert_eq!(above(&ring, 2), [(1, 0), (0, 1)]);
        assert_eq!(above(&ring, 0), []);
    }

    #[test]
    fn a_tall_stack_is_listed_up_to_a_limit() {
        let floors: Vec<_> = (0..100usize).map(|index| index.checked_sub(1)).collect();
        assert_eq!(above(&floors, 0).len(), MAX_STACKED as usize);
        assert_eq!(above(&floors, 90).len(), 9);
    }
}
