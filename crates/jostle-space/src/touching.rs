//! The pairs of the last update.
//!
//! If many of them change, they are a sorted list, which is compared as a whole. If few change,
//! they are linked, so that the pairs of the shapes that changed are found directly.

use super::keys::{self, Key, slots_of};
use super::links::Links;
use jostle_base::error::Result;
use jostle_base::interrupt::Pulse;
use jostle_base::memory;

/// Maximum number of pairs of the shapes that change in an update: half of the numbers of records,
/// so that as many other pairs can be linked.
pub(super) const MAX_PAIRS: usize = 1 << 31;

/// A list is linked if the shapes that changed have fewer than one of so many pairs.
const LINKED_BELOW: usize = 16;

/// Links become a list if the shapes that changed have more than one of so many pairs. This is a
/// larger share than that of [`LINKED_BELOW`], so that the form does not change often.
const LISTED_ABOVE: usize = 8;

/// Maximum number of linked pairs that change in an update. So these changes, which are not
/// interrupted, take less than 0.1 s.
const MAX_LINKED: usize = 1 << 20;

/// Pairs of slots.
#[derive(Clone, Debug, Default)]
pub(super) struct Touching {
    /// All pairs, ascending; empty if they are in `links`.
    list: Vec<Key>,
    links: Option<Links>,
    /// Whether each slot is in a pair of the list; empty until it is computed.
    paired: Vec<bool>,
    /// Memory for sorting.
    starts: Vec<u32>,
    /// Memory for the next list.
    spare: Vec<Key>,
}

/// What an update changes, ascending.
pub(super) struct Difference {
    pub(super) entered: Vec<Key>,
    pub(super) left: Vec<Key>,
    next: Next,
}

/// What is to be stored.
enum Next {
    /// All pairs.
    List(Vec<Key>),
    /// The records to remove, each after its key.
    Records(Vec<[i64; 2]>),
}

impl Touching {
    /// The pairs with these keys, ascending.
    pub(super) fn of(list: Vec<Key>) -> Self {
        Self { list, ..Self::default() }
    }

    /// Increases the number of slots to `slots`.
    pub(super) fn widen(&mut self, slots: usize) -> Result<()> {
        self.links.as_mut().map_or(Ok(()), |links| links.widen(slots))
    }

    /// Compares with the current pairs of the slots that changed, and reserves the memory for
    /// [`Touching::change`]. After an error the pairs are the same as before.
    pub(super) fn compare(
        &mut self,
        slots: &[u32],
        is_changed: &[bool],
        found: &[[u32; 2]],
    ) -> Result<Difference> {
        let memory = std::mem::take(&mut self.spare);
        let found = keys::sorted(found, is_changed.len(), &mut self.starts, memory)?;
        if let Some(links) = &self.links {
            // Links cost random reads for each pair that changes, a list a sequential read of all
            // pairs. With one in eight changing the list is taken, with one in sixteen the links.
            // Between the two the form stays, or it would be converted back and forth. Of 200,000
            // discs every eighth moves: 5.5 ms by lists, 9.5 by links; every fiftieth: 2.1 and 2.0
            // (docs/benchmarks-notes.md).
            let most = MAX_LINKED.min(links.len() / LISTED_ABOVE).checked_sub(found.len());
            let is_fit = !links.is_wasteful() && links.len() <= MAX_PAIRS;
            if let Some(most) = most.filter(|_| is_fit)
                && let Some(old) = links.of_changed(slots, is_changed, most)?
            {
                return self.compare_linked(old, found);
            }
            self.list = links.list()?;
            self.links = None;
        }
        // All slots have changed, so all old pairs are compared, and none has to be taken out of
        // the list first.
        if slots.len() == is_changed.len() {
            return self.compare_list(&self.list, &[], found);
        }
        let [old, rest] = keys::parted(&self.list, is_changed)?;
        let changing = old.len() + found.len();
        let most = MAX_LINKED.min(self.list.len() / LINKED_BELOW);
        if changing >= most || self.list.len() > MAX_PAIRS {
            return self.compare_list(&old, &rest, found);
        }
        self.links = Some(Links::of(&self.list, is_changed.len())?);
        // Two forms of the pairs are never kept at the same time.
        self.free_list();
        let links = self.links.as_ref().expect("they were made");
        let old = links.of_changed(slots, is_changed, MAX_LINKED)?.expect("they are few");
        self.compare_linked(old, found)
    }

    /// Compares the pairs `old` of the slots that changed; `rest` are the others.
    fn compare_list(&self, old: &[Key], rest: &[Key], found: Vec<Key>) -> Result<Difference> {
        let (left, entered) = keys::difference(old, |key| *key, &found)?;
        let list = if rest.is_empty() { found } else { keys::merged(&found, rest)? };
        Ok(Difference { entered, left, next: Next::List(list) })
    }

    /// As [`Touching::compare_list`], of linked pairs.
    fn compare_linked(&mut self, old: Vec<[i64; 2]>, found: Vec<Key>) -> Result<Difference> {
        let (records, entered) = keys::difference(&old, |found| found[0], &found)?;
        let left = memory::collect(records.iter().map(|record| record[0]))?;
        let links = self.links.as_mut().expect("they are linked");
        // What comes after this cannot fail, so the events that the caller gets and the pairs that
        // are stored agree.
        links.reserve(entered.len(), left.len())?;
        self.spare = found;
        Ok(Difference { entered, left, next: Next::Records(records) })
    }

    /// Stores the current pairs.
    pub(super) fn change(&mut self, difference: Difference) {
        match difference.next {
            Next::List(list) => {
                let old = std::mem::replace(&mut self.list, list);
                // What `prepare_has` has computed belongs to the old list.
                self.paired.clear();
                // Memory is freed if much more is allocated than needed.
                let is_wasteful = old.capacity() > 4 * self.list.len();
                self.spare = if is_wasteful { Vec::new() } else { old };
            }
            Next::Records(left) => {
                let links = self.links.as_mut().expect("they were compared");
                links.change(&left, &difference.entered);
            }
        }
    }

    /// Frees the memory of the list and of what belongs to it.
    fn free_list(&mut self) {
        (self.list, self.paired, self.starts) = Default::default();
    }

    /// Prepares [`Touching::has`], which takes time only once after an update.
    pub(super) fn prepare_has(&mut self, slots: usize) -> Result<()> {
        if self.list.is_empty() || !self.paired.is_empty() {
            return Ok(());
        }
        let mut pulse = Pulse::current();
        let mut paired = std::mem::take(&mut self.paired);
        memory::resize(&mut paired, slots, false)?;
        for &key in &self.list {
            pulse.check(1)?;
            slots_of(key).into_iter().for_each(|slot| paired[slot as usize] = true);
        }
        self.paired = paired;
        Ok(())
    }

    /// Whether a slot is in any pair.
    pub(super) fn has(&self, slot: u32) -> bool {
        match &self.links {
            Some(links) => links.has(slot),
            None => self.paired.get(slot as usize) == Some(&true),
        }
    }

    /// The keys of all pairs, ascending.
    pub(super) fn all(&self) -> Result<Vec<Key>> {
        match &self.links {
            Some(links) => links.list(),
            None => memory::collect(self.list.iter().copied()),
        }
    }

    /// Allocated bytes, used or not.
    pub(super) fn memory_bytes(&self) -> usize {
        let keys = self.list.capacity() + self.spare.capacity();
        let links = self.links.as_ref().map_or(0, Links::memory_bytes);
        keys * size_of::<Key>()
            + self.starts.capacity() * size_of::<u32>()
            + self.paired.capacity()
            + links
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::super::keys::key_of;
    use super::*;
    use jostle_base::error::Error;
    use jostle_base::interrupt;

    const SLOTS: usize = 400;

    fn is_changed(slots: &[u32], len: usize) -> Vec<bool> {
        let mut changed = vec![false; len];
        slots.iter().for_each(|&slot| changed[slot as usize] = true);
        changed
    }

    /// Pairs of neighbours and others, some of which depend on the round.
    fn pairs(round: u32) -> Vec<[u32; 2]> {
        let all = (0..SLOTS as u32).flat_map(|a| (a + 1..SLOTS as u32).map(move |b| [b, a]));
        let mixed = |[a, b]: [u32; 2]| (a * 31 + b * 17 + round * 7 * (a % 3)).is_multiple_of(29);
        all.filter(|&[a, b]| a == b + 1 || mixed([a, b])).collect()
    }

    #[test]
    fn lists_and_links_tell_the_same_as_sets() {
        let mut touching = Touching::default();
        let mut expected = BTreeSet::new();
        let all: Vec<u32> = (0..SLOTS as u32).collect();
        let mut forms = [0; 2];
        for round in 0..40 {
            // All, a few and single slots; also none, whose pairs are removed, and all but one.
            let slots: &[u32] = match round % 5 {
                0 if round % 3 == 0 => &all,
                0 => &all[1..],
                1 => &all[7..13],
                2 => &all[round..=round],
                _ => &[],
            };
            let changed = is_changed(slots, SLOTS);
            let mut found = pairs(round as u32);
            found.retain(|&[a, b]| changed[a as usize] || changed[b as usize]);
            found.retain(|_| round != 30);
            let difference = touching.compare(slots, &changed, &found).unwrap();
            let has_changed = |key: &&Key| slots_of(**key).iter().any(|&s| changed[s as usize]);
            let old: BTreeSet<Key> = expected.iter().filter(has_changed).copied().collect();
            let new: BTreeSet<Key> = found.iter().map(|&pair| key_of(pair)).collect();
            assert!(difference.left.iter().eq(old.difference(&new)), "{round}");
            assert!(difference.entered.iter().eq(new.difference(&old)), "{round}");
            touching.change(difference);
            expected = &(&expected - &old) | &new;
            assert!(touching.all().unwrap().iter().eq(&expected), "{round}");
            touching.prepare_has(SLOTS).unwrap();
            let has = |slot| expected.iter().any(|&key| slots_of(key).contains(&slot));
            assert!(all.iter().all(|&slot| touching.has(slot) == has(slot)), "{round}");
            forms[usize::from(touching.links.is_some())] += 1;
        }
        assert!(forms[0] > 5 && forms[1] > 5, "{forms:?}");
    }

    #[test]
    fn memory_of_links_is_given_back() {
        const MANY: u32 = 100_000;
        let mut touching = Touching::default();
        let all: Vec<u32> = (0..MANY).collect();
        let pairs: Vec<[u32; 2]> = all.windows(2).map(|two| [two[0], two[1]]).collect();
        let mut update = |slots: &[u32], found: &[[u32; 2]]| {
            let difference =
                touching.compare(slots, &is_changed(slots, MANY as usize), found).unwrap();
            touching.change(difference);
            (touching.links.is_some(), touching.memory_bytes())
        };
        update(&all, &pairs);
        let (linked, full) = update(&[5], &pairs[4..6]);
        assert!(linked);
        // Each update removes few of the pairs.
        for slots in all.chunks(1000).take(99) {
            update(slots, &[]);
        }
        let (_, kept) = update(&[], &[]);
        assert!(kept < full / 4, "{kept} of {full}");
    }

    #[test]
    fn an_interrupted_comparison_changes_nothing() {
        const MANY: u32 = 1 << 20;
        let all: Vec<u32> = (0..MANY).collect();
        let pairs: Vec<[u32; 2]> = all.windows(2).map(|two| [two[0], two[1]]).collect();
        let mut touching = Touching::default();
        let first = touching.compare(&all, &is_changed(&all, all.len()), &pairs).unwrap();
        touching.change(first);
        let expected = touching.all().unwrap();
        for slots in [&all[..], &all[1..], &[3]] {
            let changed = is_changed(slots, all.len());
            let found = if slots.len() > 1 { &pairs[1..] } else { &[] };
            let compared = || touching.compare(slots, &changed, found).map(|_| ());
            let stopped = interrupt::watch(|| true, compared);
            assert_eq!(stopped, Err(Error::Interrupted));
            assert!(touching.all().unwrap() == expected);
        }
    }
}
