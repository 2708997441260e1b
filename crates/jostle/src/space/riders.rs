//! The walkers of an island that stand on others: the order in which all move, and which stand on
//! which.

use crate::error::Result;
use crate::memory;

/// No walker.
const NONE: u32 = u32::MAX;

/// A floor pushes riders, their riders and so on, up to this number of levels.
const MAX_STACKED: u32 = 64;

/// Walkers by their indices in the island, each with the floor on which it stands.
#[derive(Debug, Default)]
pub struct Riders {
    /// All walkers in the order in which they move: a floor before its riders, otherwise ascending.
    pub order: Vec<u32>,
    /// The first rider of each; empty if nothing stands on another.
    first: Vec<u32>,
    /// The next rider of the same floor.
    next: Vec<u32>,
    /// Whether each is in `order`.
    listed: Vec<bool>,
    waiting: Vec<u32>,
}

/// A walker that stands on another one, or on one that stands on it, and so on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rider {
    /// Its index in the island.
    pub index: u32,
    /// The index of its floor in the list, plus 1; 0 if it stands on the lowest one.
    pub floor: usize,
    depth: u32,
}

impl Riders {
    /// Replaces the walkers. `floor` is the index of the floor of a walker.
    pub fn fill(&mut self, len: usize, floor: impl Fn(usize) -> Option<usize>) -> Result<()> {
        self.order.clear();
        self.first.clear();
        memory::reserve(&mut self.order, len)?;
        if (0..len).all(|index| floor(index).is_none()) {
            self.order.extend(0..len as u32);
            return Ok(());
        }
        self.next.clear();
        self.listed.clear();
        memory::resize(&mut self.first, len, NONE)?;
        memory::resize(&mut self.next, len, NONE)?;
        memory::resize(&mut self.listed, len, false)?;
        for index in 0..len {
            let mut next = Some(index);
            // The chain ends at a floor that is listed or waiting; so a ring ends, too.
            while let Some(index) = next.filter(|&index| !self.listed[index]) {
                self.listed[index] = true;
                memory::push(&mut self.waiting, index as u32)?;
                next = floor(index);
            }
            self.order.extend(std::iter::from_fn(|| self.waiting.pop()));
        }
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
    pub fn is_any(&self) -> bool {
        !self.first.is_empty()
    }

    /// Lists the riders of a walker, their riders and so on, a floor before its riders.
    pub fn list_above(&self, index: usize, above: &mut Vec<Rider>) -> Result<()> {
        above.clear();
        let (mut lowest, mut floor, mut depth) = (index, 0, 0);
        loop {
            let mut rider = self.first.get(lowest).copied().unwrap_or(NONE);
            while rider != NONE && depth < MAX_STACKED {
                memory::push(above, Rider { index: rider, floor, depth })?;
                rider = self.next[rider as usize];
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

    fn above(floors: &[Option<usize>], index: usize) -> Vec<(u32, usize)> {
        let (mut riders, mut above) = (Riders::default(), Vec::new());
        riders.fill(floors.len(), |index| floors[index]).unwrap();
        riders.list_above(index, &mut above).unwrap();
        above.iter().map(|rider| (rider.index, rider.floor)).collect()
    }

    fn order(floors: &[Option<usize>]) -> Vec<u32> {
        let mut riders = Riders::default();
        riders.fill(floors.len(), |index| floors[index]).unwrap();
        riders.order
    }

    #[test]
    fn floors_come_before_what_stands_on_them() {
        assert_eq!(order(&[None, None, None]), [0, 1, 2]);
        assert_eq!(order(&[Some(2), None, Some(1), Some(1)]), [1, 2, 0, 3]);
        assert_eq!(order(&[Some(1), Some(2), Some(0), Some(1)]), [2, 1, 0, 3]);
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
