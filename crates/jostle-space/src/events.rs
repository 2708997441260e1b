//! Changes of the pairs since the last update.
//!
//! Only pairs with a shape that changed can have entered or exited. The current ones come from a join
//! of the layer of these shapes with all, and are compared with those of the last update.

use super::changes::Changes;
use super::keys::{self, Key, slots_of};
use super::space::Space;
use super::touching::{Difference, MAX_PAIRS};
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::interrupt::Pulse;
use jostle_base::memory;
use jostle_base::sorting;
use jostle_index::geometry::Scalar;
use jostle_index::pairs::JoinScratch;
use jostle_index::shapes::DEFAULT_CATEGORY;

/// Pairs converted to ids between two checks for an interruption.
const CHUNK: usize = 1 << 14;

/// Pairs of ids, the smaller first, sorted by first, then by second.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Events {
    /// Pairs that overlap and did not overlap at the update before; of a swept update also those that
    /// met on the way.
    pub entered: Vec<[Id; 2]>,
    /// Pairs that overlapped at the update before and do not overlap now, or a shape of which was
    /// removed; of a swept update also those that met on the way.
    pub left: Vec<[Id; 2]>,
    /// The categories of the shapes in `entered` and in `left` at the time of the update, which may have been removed
    /// since; empty if no shape of the space had a category of its own.
    pub categories: [Vec<[u32; 2]>; 2],
    /// The number of the update of its space.
    update: u64,
}

/// Pairs with the categories of their shapes, as in [`Events`].
pub type WithCategories = (Vec<[Id; 2]>, Vec<[u32; 2]>);

/// The pairs of which one shape has a category in `first` and the other one in `second`, and their categories, in the
/// same order. Those that fit only in the other order are turned.
pub fn between(
    pairs: &[[Id; 2]],
    categories: &[[u32; 2]],
    [first, second]: [u32; 2],
) -> Result<WithCategories> {
    let (mut kept, mut kept_categories) = (Vec::new(), Vec::new());
    let mut pulse = Pulse::current();
    for (row, &[i, j]) in pairs.iter().enumerate() {
        pulse.check(1)?;
        let [a, b] = categories.get(row).copied().unwrap_or([DEFAULT_CATEGORY; 2]);
        let (pair, both) = if a & first != 0 && b & second != 0 {
            ([i, j], [a, b])
        } else if b & first != 0 && a & second != 0 {
            ([j, i], [b, a])
        } else {
            continue;
        };
        memory::push(&mut kept, pair)?;
        if !categories.is_empty() {
            memory::push(&mut kept_categories, both)?;
        }
    }
    Ok((kept, kept_categories))
}

impl<T: Scalar> Space<T> {
    /// The pairs that entered and exited since the last update. If the shapes that changed have
    /// more than `max_pairs` pairs, nothing is done.
    pub fn update(&mut self, max_pairs: usize) -> Result<Events> {
        self.compare(false, max_pairs)
    }

    /// As [`Space::update`], with the pairs that overlapped only on the way since the last update, among those that
    /// entered and among those that exited. Each shape has moved from where it was at the last update, or was added
    /// since, to where it is, along a straight line and all in the same time, with its present size and filter. The
    /// limit is also one for the pairs of bounds of the paths.
    pub fn update_swept(&mut self, max_pairs: usize) -> Result<Events> {
        self.compare(true, max_pairs)
    }

    fn compare(&mut self, is_swept: bool, max_pairs: usize) -> Result<Events> {
        let max_pairs = max_pairs.min(MAX_PAIRS);
        let any_removed = self.slots.len() < self.slots.count();
        let present = self.changes.present(&self.layers, any_removed)?;
        // Why only the changed shapes are joined: a pair can enter or exit only if one of its
        // shapes has changed. With all of these in one layer (`front`) the joins of that layer with
        // every layer, itself included, find all their current pairs, each once. `touching` has
        // those of the last update. The differences are the events.
        let front = match self.layers.common_layer(&present) {
            Some(layer) => Some(layer),
            None => {
                // Fresh shapes have changed; usually no other shapes have changed.
                if self.layers.fresh_len() < present.len() {
                    self.layers.reserve_fresh(present.len())?;
                    // A query has built some of them into a layer, together with others or in
                    // several layers. The next fold brings them together again.
                    present.iter().for_each(|&slot| self.layers.freshen(slot));
                }
                self.layers.fold(&self.slots, self.settings)?
            }
        };
        let found = match self.pairs_with_changed(front, &present, max_pairs) {
            Err(Error::TooManyPairs { .. }) => {
                // Shapes that have left their layers or are unchanged may have been counted; they
                // are excluded here.
                let front = self.layers.part(&present, &self.slots, self.settings)?;
                self.pairs_with_changed(front, &present, max_pairs)?
            }
            found => found?,
        };
        let crossed = if is_swept { self.crossed(&present, max_pairs)? } else { Vec::new() };
        let events = self.take_over(&found, &crossed)?;
        // Memory is freed if much more is allocated than needed.
        let is_wasteful = found.capacity() > 4 * found.len();
        self.changes.found = if is_wasteful { Vec::new() } else { found };
        Ok(events)
    }

    /// Overlapping pairs of slots, at least one of which changed. All changed slots, `present`, are
    /// in the layer `front`.
    fn pairs_with_changed(
        &mut self,
        front: Option<usize>,
        present: &[u32],
        most: usize,
    ) -> Result<Vec<[u32; 2]>> {
        let mut found = Vec::new();
        let Some(front) = front else { return Ok(found) };
        let mut scratch = JoinScratch::default();
        scratch.keep(std::mem::take(&mut self.changes.found));
        let all_changed = self.layers.len_of(front) == present.len();
        // If the layer has no other shapes, all pairs of the join have a changed shape, and none
        // has to be tested for it.
        let changed = (!all_changed).then_some(&self.changes.changed[..]);
        for other in self.layers.indices() {
            self.layers.join_changed([front, other], changed, most, &mut scratch, &mut found)?;
        }
        Ok(found)
    }

    /// Stores the current pairs of the slots that changed. All steps that can fail precede the
    /// first change. Pairs that have `crossed` do not overlap, so they are not stored.
    fn take_over(&mut self, found: &[[u32; 2]], crossed: &[Key]) -> Result<Events> {
        let Changes { slots, changed, leaving, updates, .. } = &self.changes;
        let update = updates + 1;
        let difference = self.touching.compare(slots, changed, found)?;
        // The lists of ids are made before anything is stored: an error that comes later than this
        // would lose events.
        let [left, entered] = self.told(&difference, crossed)?;
        // Now, as long as the slots of removed shapes still have their categories.
        let categories = [self.categories_of(&entered)?, self.categories_of(&left)?];
        self.slots.reserve_free(leaving.len())?;
        self.touching.change(difference);
        self.starts.clear(&self.changes.slots);
        self.changes.leaving.drain(..).for_each(|slot| self.slots.free(slot));
        self.changes.clear();
        Ok(Events { entered, left, categories, update })
    }

    /// The pairs that exited and those that entered, as ids.
    fn told(&self, difference: &Difference, crossed: &[Key]) -> Result<[Vec<[Id; 2]>; 2]> {
        let Difference { left, entered, .. } = difference;
        if crossed.is_empty() {
            return Ok([self.sorted_ids(left)?, self.sorted_ids(entered)?]);
        }
        // A pair that overlapped at the last update has not entered. It can only be among these if a size or a
        // filter has changed, so that it did not overlap with the present one.
        let (_, crossed) = keys::difference(left, |key| *key, crossed)?;
        let (left, entered) = (keys::merged(left, &crossed)?, keys::merged(entered, &crossed)?);
        Ok([self.sorted_ids(&left)?, self.sorted_ids(&entered)?])
    }

    /// The pairs of ids, sorted, from ascending keys.
    fn sorted_ids(&self, keys: &[Key]) -> Result<Vec<[Id; 2]>> {
        let mut pulse = Pulse::current();
        let mut ids = memory::with_capacity(keys.len())?;
        let are_ids = self.slots.are_ids();
        for some in keys.chunks(CHUNK) {
            pulse.check(some.len())?;
            if are_ids {
                ids.extend(some.iter().map(|&key| slots_of(key).map(Id::from)));
            } else {
                ids.extend(some.iter().map(|&key| self.pair_of_ids(slots_of(key))));
            }
        }
        if !are_ids {
            sorting::sort(&mut ids, &mut pulse)?;
        }
        Ok(ids)
    }

    /// The categories of the shapes in some pairs; empty if all are the default. The slots may be those of shapes
    /// removed since the last update.
    fn categories_of(&self, pairs: &[[Id; 2]]) -> Result<Vec<[u32; 2]>> {
        if !self.slots.has_filters() {
            return Ok(Vec::new());
        }
        let mut pulse = Pulse::current();
        let mut categories = memory::with_capacity(pairs.len())?;
        for pair in pairs {
            pulse.check(1)?;
            // The low bits of an id are its slot.
            categories.push(pair.map(|id| self.slots.category(id as u32)));
        }
        Ok(categories)
    }

    /// As [`Space::stayed`], with the present categories.
    pub fn stayed_with_categories(&self, events: &Events) -> Result<Option<WithCategories>> {
        let Some(pairs) = self.stayed(events)? else { return Ok(None) };
        let categories = self.categories_of(&pairs)?;
        Ok(Some((pairs, categories)))
    }

    /// The pairs that overlapped at this update and at the one before, sorted; None if there was
    /// another update after these events.
    pub fn stayed(&self, events: &Events) -> Result<Option<Vec<[Id; 2]>>> {
        if events.update != self.changes.updates {
            return Ok(None);
        }
        let mut pairs = self.sorted_ids(&self.touching.all()?)?;
        let mut pulse = Pulse::current();
        let mut entered = events.entered.iter().peekable();
        pairs.retain(|pair| {
            // Pairs that met on the way only are not among those of the update.
            while entered.next_if(|entered| *entered < pair).is_some() {}
            !pulse.stops(1) && entered.next_if_eq(&pair).is_none()
        });
        pulse.check(0)?;
        Ok(Some(pairs))
    }
}
