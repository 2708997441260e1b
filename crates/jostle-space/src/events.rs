//! Changes of the pairs since the last update.
//!
//! Only pairs with a shape that changed can have entered or left. The current ones come from a join
//! of the layer of these shapes with all, and are compared with those of the last update.

use super::changes::Changes;
use super::keys::{Key, slots_of};
use super::space::Space;
use super::touching::MAX_PAIRS;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::interrupt::Pulse;
use jostle_base::memory;
use jostle_base::sorting;
use jostle_index::geometry::Scalar;
use jostle_index::pairs::JoinScratch;

/// Pairs converted to ids between two checks for an interruption.
const CHUNK: usize = 1 << 14;

/// Pairs of ids, the smaller first, sorted by first, then by second.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Events {
    /// Pairs that overlap and did not overlap at the update before.
    pub entered: Vec<[Id; 2]>,
    /// Pairs that overlapped at the update before and do not overlap now, or a shape of which was
    /// removed.
    pub left: Vec<[Id; 2]>,
    /// The number of the update of its space.
    update: u64,
}

impl<T: Scalar> Space<T> {
    /// The pairs that entered and left since the last update. If the shapes that changed have
    /// more than `max_pairs` pairs, nothing is done.
    pub fn update(&mut self, max_pairs: usize) -> Result<Events> {
        let max_pairs = max_pairs.min(MAX_PAIRS);
        let any_removed = self.slots.len() < self.slots.count();
        let present = self.changes.present(&self.layers, any_removed)?;
        // Why only the changed shapes are joined: a pair can enter or leave only if one of its
        // shapes has changed. With all of these in one layer (`front`) the joins of that layer with
        // every layer, itself included, find all their current pairs, each once. `touching` knows
        // those of the last update; the difference are the events.
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
        let events = self.take_over(&found)?;
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
    /// first change.
    fn take_over(&mut self, found: &[[u32; 2]]) -> Result<Events> {
        let Changes { slots, changed, leaving, updates, .. } = &self.changes;
        let update = updates + 1;
        let difference = self.touching.compare(slots, changed, found)?;
        // The lists of ids are made before anything is stored: an error that comes later than this
        // would lose events.
        let (left, entered) =
            (self.sorted_ids(&difference.left)?, self.sorted_ids(&difference.entered)?);
        self.slots.reserve_free(leaving.len())?;
        self.touching.change(difference);
        self.changes.leaving.drain(..).for_each(|slot| self.slots.free(slot));
        self.changes.clear();
        Ok(Events { entered, left, update })
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

    /// The pairs that overlapped at this update and at the one before, sorted; None if there was
    /// another update after these events.
    pub fn stayed(&self, events: &Events) -> Result<Option<Vec<[Id; 2]>>> {
        if events.update != self.changes.updates {
            return Ok(None);
        }
        let mut pairs = self.sorted_ids(&self.touching.all()?)?;
        let mut pulse = Pulse::current();
        let mut entered = events.entered.iter().peekable();
        pairs.retain(|pair| !pulse.stops(1) && entered.next_if_eq(&pair).is_none());
        pulse.check(0)?;
        Ok(Some(pairs))
    }
}
