//! Pairs that met on the way from the last update to this one, and are apart at both.

use super::crossing::{Motion, cross};
use super::keys::{Key, key_of};
use super::layers;
use super::space::Space;
use super::starts;
use jostle_base::error::{Error, Result};
use jostle_base::interrupt::Pulse;
use jostle_base::memory;
use jostle_base::sorting;
use jostle_index::geometry::Scalar;
use jostle_index::pairs::{self, Filters, JoinScratch};
use jostle_index::quadtree::Quadtree;
use jostle_index::shapes::{Shapes, middle_of};

/// Approximate number of values read to test whether two shapes cross.
const CROSSING_WORK: usize = 64;

/// A pair and its motions.
type Candidate<T> = ([u32; 2], [Motion<T>; 2]);

impl<T: Scalar> Space<T> {
    /// Pairs of slots that overlap neither now nor with the shapes where they were at the last update, and overlap
    /// in between if each moves along a straight line; ascending. `present` are the slots that have changed, all of
    /// them in layers. The bounds of the paths may have at most `max_pairs` pairs.
    pub(super) fn crossed(&mut self, present: &[u32], max_pairs: usize) -> Result<Vec<Key>> {
        let mut moved = memory::with_capacity(present.len())?;
        moved.extend(present.iter().copied().filter(|&slot| self.start_of(slot).is_some()));
        if moved.is_empty() {
            return Ok(Vec::new());
        }
        let mut tree = Quadtree::default();
        let settings = layers::fitting(self.settings, moved.len(), self.slots.len());
        tree.fill_unordered(&self.bounds_of_paths(&moved)?, settings)?;
        match self.crossed_in(&tree, &moved, max_pairs) {
            Err(Error::TooManyPairs { .. }) => {
                // Copies of shapes that have left their layers may have been counted; here there are none.
                self.layers.part(present, &self.slots, self.settings)?;
                self.crossed_in(&tree, &moved, max_pairs)
            }
            found => found,
        }
    }

    fn start_of(&self, slot: u32) -> Option<[T; 2]> {
        self.starts.of(slot, &self.slots, &self.period)
    }

    /// The shape in a slot at the last update, with its present size, and now.
    fn motion_of(&self, slot: u32) -> Motion<T> {
        let now = self.slots.shape(slot);
        [self.start_of(slot).map_or(now, |start| starts::at(&now, start)), now]
    }

    /// The bounds of the paths of shapes.
    ///
    /// Their gaps are computed with the same operations as those of the shapes on their way. Rounding is monotone,
    /// so no pair that crosses is missing, and no tolerance is needed.
    fn bounds_of_paths(&self, moved: &[u32]) -> Result<Shapes<T>> {
        let mut shapes = Shapes::none_in(self.period);
        self.slots.gather(moved, &mut shapes)?;
        let mut boxes = memory::with_capacity(moved.len())?;
        boxes.extend(moved.iter().map(|&slot| self.bounds_of_path(slot)));
        let columns = shapes.columns_mut();
        columns.centers.clear();
        columns.centers.extend(boxes.iter().map(middle_of));
        *columns.boxes = Some(boxes);
        *columns.cores = None;
        Ok(shapes)
    }

    fn bounds_of_path(&self, slot: u32) -> [T; 4] {
        let [start, now] = self.motion_of(slot);
        let low = [0, 1].map(|axis| start.min[axis].min(now.min[axis]));
        let high = [0, 1].map(|axis| start.max[axis].max(now.max[axis]));
        if self.period.is_none() {
            return [low[0], low[1], high[0], high[1]];
        }
        // A move by a period rounds the sides.
        let error = self.period.sides().map(|side| T::from_f64(4.0) * T::EPSILON * side);
        let [low, high] = self.period.wrap_corners([low, high]);
        [low[0] - error[0], low[1] - error[1], high[0] + error[0], high[1] + error[1]]
    }

    /// As [`Space::crossed`]; `tree` has the bounds of the paths of `moved`.
    fn crossed_in(&self, tree: &Quadtree<T>, moved: &[u32], max_pairs: usize) -> Result<Vec<Key>> {
        let mut crossed = Vec::new();
        let mut left = max_pairs;
        let mut motions = memory::with_capacity(moved.len())?;
        motions.extend(moved.iter().map(|&slot| self.motion_of(slot)));
        let found = pairs::within(tree, None, left)?.pairs;
        left -= found.len();
        let candidates = found.into_iter().map(|pair| {
            let [i, j] = pair.map(|row| row as usize);
            Some(([moved[i], moved[j]], [motions[i], motions[j]]))
        });
        self.keep_crossed(candidates, &mut crossed)?;
        let mut scratch = JoinScratch::default();
        let moved_in = self.layers.count_in(moved)?;
        // A layer without a shape at rest has nothing that was not found above.
        let layers = self.layers.indices();
        for index in layers.filter(|&index| moved_in[index] < self.layers.len_of(index)) {
            let (layer, slot_of) = self.layers.layer(index);
            let (none, filters) = ([T::ZERO; 2], Filters::Apply);
            let found = pairs::indices_between(tree, layer, none, filters, left, &mut scratch);
            let found = found.map_err(|error| error.with_max_pairs(max_pairs))?.pairs;
            left -= found.len();
            let candidates = found.into_iter().map(|[index, other]| {
                // Shapes at rest only: pairs that both move were found above.
                let slot = slot_of(layer.rows()[other as usize]);
                let slot = slot.filter(|&slot| self.start_of(slot).is_none())?;
                let row = tree.rows()[index as usize] as usize;
                // Not read from its slot: neighbours in the tree are neighbours in memory.
                let rest = layer.columns().shape(other as usize);
                Some(([moved[row], slot], [motions[row], [rest; 2]]))
            });
            self.keep_crossed(candidates, &mut crossed)?;
        }
        sorting::sort(&mut crossed, &mut Pulse::current())?;
        Ok(crossed)
    }

    fn keep_crossed(
        &self,
        candidates: impl Iterator<Item = Option<Candidate<T>>>,
        crossed: &mut Vec<Key>,
    ) -> Result<()> {
        let mut pulse = Pulse::current();
        for candidate in candidates {
            pulse.check(CROSSING_WORK)?;
            let Some((pair, [a, b])) = candidate else { continue };
            if cross(&a, &b, &self.period) {
                memory::push(crossed, key_of(pair))?;
            }
        }
        Ok(())
    }
}
