//! All overlapping pairs of a space, with their contacts, and the neighbours of every shape.

use super::space::Space;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::interrupt::Pulse;
use jostle_base::memory;
use jostle_base::sorting;
use jostle_index::geometry::Scalar;
use jostle_index::pairs::{Found, Overlaps};
use jostle_index::query::{self, Hits, MAX_IDS};
use jostle_index::shapes::half_of;

/// A search for pairs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted<T> {
    /// Shapes pair if the gap between them is below this.
    pub distance: T,
    /// If given, both shapes must have a category in it.
    pub mask: Option<u32>,
    /// The maximum number of pairs.
    pub max_pairs: usize,
}

impl<T: Scalar> Space<T> {
    /// All overlapping pairs of ids, the smaller first, in unspecified order, which does not depend
    /// on the number of threads. With a `mask` only those of which both have a category in it.
    pub fn pairs(&mut self, mask: Option<u32>, max_pairs: usize) -> Result<Vec<[Id; 2]>> {
        self.pairs_within(&Wanted { distance: T::ZERO, mask, max_pairs })
    }

    /// As [`Space::pairs`], all whose gap is below a distance.
    pub fn pairs_within(&mut self, wanted: &Wanted<T>) -> Result<Vec<[Id; 2]>> {
        let found = self.pairs_of_slots(wanted)?;
        let mut pulse = Pulse::current();
        let mut ids = memory::with_capacity(found.len())?;
        for pair in found {
            pulse.check(1)?;
            ids.push(self.pair_of_ids(pair));
        }
        Ok(ids)
    }

    /// As [`Space::pairs`], with normals and depths; sorted if `sorted`.
    pub fn contacts(
        &mut self,
        (mask, sorted): (Option<u32>, bool),
        max_pairs: usize,
    ) -> Result<Overlaps<T, Id>> {
        let mut pairs = self.pairs(mask, max_pairs)?;
        if sorted {
            sorting::sort(&mut pairs, &mut Pulse::current())?;
        }
        let shape_of = |id: Id| self.slots.shape(self.slots.slot(id).expect("it was found"));
        Overlaps::of(pairs, 0, &self.period, |pair| pair.map(shape_of))
    }

    /// For each shape, in the order of adding, the ids of all shapes whose gap to it is below `distance`, in that
    /// order too, itself left out.
    pub fn neighbors(&mut self, distance: T, mask: Option<u32>) -> Result<Hits<Id>> {
        let wanted = Wanted { distance, mask, max_pairs: MAX_IDS / 2 };
        let mut pairs = self.pairs_of_slots(&wanted).map_err(|error| match error {
            Error::TooManyPairs { .. } => Error::TooManyIds { limit: MAX_IDS },
            other => other,
        })?;
        let ids = self.rows.ids(&self.slots);
        let mut rows: Vec<u32> = memory::filled(self.slots.count(), 0)?;
        for (row, slot) in (0..).zip(self.slots.look_up(ids)?) {
            rows[slot as usize] = row;
        }
        let mut pulse = Pulse::current();
        for pair in &mut pairs {
            pulse.check(1)?;
            *pair = pair.map(|slot| rows[slot as usize]);
        }
        let found = Found { pairs, tests: 0 };
        let Hits { offsets, ids: rows, tests } =
            query::neighbors_of_pairs(ids.len(), found, self.settings.threads)?;
        let ids = memory::collect(rows.into_iter().map(|row| ids[row as usize]))?;
        Ok(Hits { offsets, ids, tests })
    }

    /// All pairs of slots, from the trees of all layers.
    fn pairs_of_slots(&mut self, wanted: &Wanted<T>) -> Result<Vec<[u32; 2]>> {
        half_of(wanted.distance)?;
        self.layers.fold(&self.slots, self.settings)?;
        match self.all_pairs(wanted) {
            Err(Error::TooManyPairs { .. }) => {
                // Shapes that have left their layers may have been counted; here there are none.
                self.layers.part(&[], &self.slots, self.settings)?;
                self.all_pairs(wanted)
            }
            found => found,
        }
    }

    fn all_pairs(&self, wanted: &Wanted<T>) -> Result<Vec<[u32; 2]>> {
        let (mut found, limits) = (Vec::new(), (wanted.mask, wanted.max_pairs));
        let layers: Vec<usize> = self.layers.indices().collect();
        let grown = layers.iter().map(|&layer| self.layers.grown(layer, wanted.distance));
        let grown = grown.collect::<Result<Vec<_>>>()?;
        for (which, &a) in layers.iter().enumerate() {
            for (&b, other) in layers.iter().zip(&grown).skip(which) {
                self.layers.join([a, b], [&grown[which], other], limits, &mut found)?;
            }
        }
        Ok(found)
    }

    pub(super) fn pair_of_ids(&self, slots: [u32; 2]) -> [Id; 2] {
        let [a, b] = slots.map(|slot| self.slots.id(slot));
        [a.min(b), a.max(b)]
    }
}
