//! Saving and restoring a space.

use super::changes::Changes;
use super::floors::Floors;
use super::keys::{Key, key_of, slots_of};
use super::layers::Layers;
use super::rows::Rows;
use super::saved::Saved;
use super::slots::{Slots, VACANT};
use super::space::Space;
use super::starts::Starts;
use super::touching::Touching;
use super::traces::Traces;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::memory;
use jostle_base::settings::Settings;
use jostle_index::geometry::Scalar;
use jostle_index::period::Period;
use jostle_index::shapes::{
    Each, MAX_ROWS, check_boxes, check_each_half_size, check_finite, check_radii,
};

impl<T: Scalar> Space<T> {
    /// The contents of this space.
    pub fn save(&mut self) -> Result<Saved<T>> {
        let mut saved = self.slots.save()?;
        saved.ids = memory::collect(self.rows.ids(&self.slots).iter().copied())?;
        saved.pairs = memory::collect(self.touching.all()?.into_iter().map(slots_of))?;
        saved.changed = memory::collect(self.changes.slots.iter().copied())?;
        saved.leaving = memory::collect(self.changes.leaving.iter().copied())?;
        saved.updates = self.changes.updates;
        (saved.rides, saved.ride_centers) = self.floors.save()?;
        self.traces.save(&mut saved)?;
        self.starts.save(&mut saved)?;
        Ok(saved)
    }

    /// The space with these contents. Refuses contents that no space can have.
    pub fn restore(settings: Settings, period: Period<T>, mut saved: Saved<T>) -> Result<Self> {
        settings.validate()?;
        // A pickle may come from anywhere. Everything is checked before a column is used as an
        // index, so a damaged one is an error and never a panic later.
        if !is_consistent(&saved) {
            let rule = "it must be the state of a space, as pickle stores it";
            return Err(Error::of("state", "inconsistent", rule));
        }
        check_boxes("state", &saved.corners)?;
        check_radii("state", &saved.radii)?;
        check_each_half_size("state", &Each::Rows(saved.half_sizes.clone()))?;
        let count = saved.generations.len();
        let mut keys: Vec<Key> = memory::collect(saved.pairs.iter().map(|&pair| key_of(pair)))?;
        // `touching` requires ascending keys; the order in which they were saved is not relied
        // upon.
        keys.sort_unstable();
        let mut changes = Changes::default();
        changes.widen(count)?;
        changes.reserve(saved.changed.len() + saved.leaving.len())?;
        saved.changed.iter().for_each(|&slot| changes.note(slot));
        changes.leaving.extend(&saved.leaving);
        changes.updates = saved.updates;
        check_finite("state", &saved.ride_centers)?;
        let floors = Floors::restore(&saved, count)?;
        let starts = Starts::restore(&saved, count)?;
        let traces = Traces::restore(&mut saved, count)?;
        let rows = Rows::of(std::mem::take(&mut saved.ids));
        let slots = Slots::restore(saved)?;
        let mut layers = Layers::of(period);
        layers.widen(count)?;
        layers.reserve_fresh(slots.len())?;
        // Layers are not saved: which shapes are in which tree changes no answer. The first fold
        // builds one tree of all.
        slots.present().for_each(|slot| layers.freshen(slot));
        let touching = Touching::of(keys);
        Ok(Self {
            settings,
            period,
            slots,
            rows,
            layers,
            touching,
            changes,
            floors,
            traces,
            starts,
        })
    }
}

/// Whether the columns have the same length, and lists of slots are slots in the right state.
fn is_consistent<T>(saved: &Saved<T>) -> bool {
    let count = saved.generations.len();
    let fits = |len: usize| len == count;
    let same = saved.rides.len() == saved.ride_centers.len()
        && fits(saved.corners.len())
        && fits(saved.radii.len())
        && (saved.half_sizes.is_empty() || fits(saved.half_sizes.len()))
        && (saved.cores.is_empty() || fits(saved.cores.len()))
        && (saved.filters.is_empty() || fits(saved.filters.len()));
    let exists = |&slot: &u32| (slot as usize) < count;
    let lists = [&saved.free, &saved.changed, &saved.leaving];
    if !same || count > MAX_ROWS || !lists.iter().all(|list| list.iter().all(exists)) {
        return false;
    }
    let is_vacant = |slot: u32| saved.generations[slot as usize] & VACANT != 0;
    let present = saved.generations.iter().filter(|generation| **generation & VACANT == 0).count();
    // Each shape once: as many different ids as there are shapes, each of a slot with its generation.
    let is_present = |id: &Id| {
        let generation = saved.generations.get(*id as u32 as usize);
        *id >= 0 && generation.is_some_and(|generation| Id::from(*generation) == *id >> 32)
    };
    let mut ids = saved.ids.clone();
    ids.sort_unstable();
    ids.dedup();
    if ids.len() != saved.ids.len() || ids.len() != present || !ids.iter().all(is_present) {
        return false;
    }
    // A slot that is free twice would be given to two shapes.
    let once = |list: &[&Vec<u32>]| {
        let mut all: Vec<u32> = list.iter().flat_map(|list| list.iter().copied()).collect();
        let len = all.len();
        all.sort_unstable();
        all.dedup();
        all.len() == len
    };
    let vacant = saved.free.iter().chain(&saved.leaving).all(|&slot| is_vacant(slot));
    let lists = once(&[&saved.free, &saved.leaving]) && once(&[&saved.changed]);
    let mut is_free = vec![false; count];
    saved.free.iter().for_each(|&slot| is_free[slot as usize] = true);
    let mut pairs = saved.pairs.clone();
    pairs.sort_unstable();
    pairs.dedup();
    let good_pair = |pair: &[u32; 2]| {
        pair[0] < pair[1] && pair.iter().all(|slot| exists(slot) && !is_free[*slot as usize])
    };
    vacant && lists && pairs.len() == saved.pairs.len() && pairs.iter().all(good_pair)
}
