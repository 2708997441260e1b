//! The ids of particles, and of walls. They stay what they are when others are removed.
//!
//! Inside the world particles are named by rows, which have no gaps; ids are converted where
//! they come in and go out. As long as nothing was removed, each id is its row.

use std::ops::Range;

use super::Bodies;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::memory;
use jostle_base::saved;

/// Maximum length of the array that [`Bodies::renumbered`] returns; it takes 2 GiB.
const MAX_RENUMBERED: usize = 1 << 27;

/// What has ids, for messages.
pub(crate) struct Named {
    /// The noun: `particle`.
    noun: &'static str,
    /// Why an id may have ended.
    end: &'static str,
    /// The argument of new ones.
    argument: &'static str,
}

/// Particles.
pub(crate) const PARTICLE: Named = Named {
    noun: "particle",
    end: "it was removed, or merged into another",
    argument: "positions",
};

/// Walls.
pub(crate) const WALL: Named = Named { noun: "wall", end: "it was removed", argument: "segments" };

/// The ids of all rows, ascending.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Ids {
    /// The id of each row; None while each id is its row.
    listed: Option<Vec<Id>>,
    /// The id of the particle that is added next.
    next: Id,
}

saved! { struct Ids { listed, next } }

impl Ids {
    /// Each id is its row.
    pub(crate) fn of_rows(len: usize) -> Self {
        Self { listed: None, next: len as Id }
    }

    /// Those that were saved; refuses ids that no world can have.
    pub(crate) fn read(listed: Option<Vec<Id>>, len: usize, next: Id) -> Result<Self> {
        let ids = Self { listed, next };
        ids.check(len)?;
        Ok(ids)
    }

    /// Refuses ids that no world with `len` particles can have.
    pub(crate) fn check(&self, len: usize) -> Result<()> {
        let next = self.next;
        let is_right = match &self.listed {
            None => next == len as Id,
            Some(all) => {
                let is_ascending = all.windows(2).all(|two| two[0] < two[1]);
                let [first, last] = [all.first(), all.last()];
                all.len() == len
                    && is_ascending
                    && first.is_none_or(|&id| id >= 0)
                    && last.is_none_or(|&id| id < next)
                    && next >= 0
            }
        };
        let refused = || Error::of("ids", next, "no world can have these ids");
        if is_right { Ok(()) } else { Err(refused()) }
    }

    /// The id of each row, None while each id is its row, and the id that is given next.
    pub(crate) fn parts(&self) -> (Option<&[Id]>, Id) {
        (self.listed.as_deref(), self.next)
    }

    /// The id of a row.
    pub(crate) fn of(&self, row: u32) -> Id {
        self.listed.as_ref().map_or(Id::from(row), |all| all[row as usize])
    }

    /// The row of an id; None if no particle has it.
    pub(crate) fn row(&self, id: Id) -> Option<u32> {
        match &self.listed {
            None => (0..self.next).contains(&id).then_some(id as u32),
            Some(all) => all.binary_search(&id).ok().map(|row| row as u32),
        }
    }

    /// The ids that so many new rows will get, with memory for them.
    pub(crate) fn reserve(&mut self, count: usize, of: &Named) -> Result<Range<Id>> {
        let first = self.next;
        // An id is never given again, so that a caller's old id cannot name a new particle.
        let Some(end) = first.checked_add(count as Id) else {
            let rule = format!("there are no ids left for new {}s", of.noun);
            return Err(Error::of(of.argument, count, &rule));
        };
        if let Some(all) = &mut self.listed {
            memory::reserve(all, count)?;
        }
        Ok(first..end)
    }

    /// Gives ids to new rows, those of [`Ids::reserve`].
    pub(crate) fn add(&mut self, new: Range<Id>) {
        self.next = new.end;
        if let Some(all) = &mut self.listed {
            all.extend(new);
        }
    }

    /// A copy.
    pub(crate) fn copied(&self) -> Result<Self> {
        let listed = self.listed.as_deref().map(memory::copy).transpose()?;
        Ok(Self { listed, next: self.next })
    }

    /// Removes rows.
    pub(crate) fn without(&self, gone: &[bool]) -> Result<Self> {
        // Ids have gaps then, and need a list.
        let stay = (0..).zip(gone).filter(|(_, gone)| !**gone).map(|(row, _)| self.of(row));
        let mut listed = memory::with_capacity(gone.len())?;
        listed.extend(stay);
        Ok(Self { listed: Some(listed), next: self.next })
    }

    /// The rows of some ids. Refuses ids that nothing has.
    pub(crate) fn rows_of(&self, ids: &[Id], of: &Named) -> Result<Vec<u32>> {
        let row = |(index, &id)| self.row(id).ok_or_else(|| self.refuse(index, id, of));
        memory::try_collect(ids.iter().enumerate().map(row))
    }

    /// The rows of some ids. Refuses ids that nothing has, and ids given twice.
    pub(crate) fn distinct_rows_of(&self, ids: &[Id], of: &Named) -> Result<Vec<u32>> {
        let rows = self.rows_of(ids, of)?;
        if rows.is_sorted_by(|a, b| a < b) {
            return Ok(rows);
        }
        let mut sorted = memory::collect((0..rows.len()).map(|index| (rows[index], index)))?;
        sorted.sort_unstable();
        let twice = sorted.windows(2).filter(|two| two[0].0 == two[1].0);
        match twice.map(|two| two[1].1).min() {
            Some(index) => Err(Error::at("ids", index, ids[index], "it is given twice")),
            None => Ok(rows),
        }
    }

    /// What is wrong with an id that nothing has.
    fn refuse(&self, index: usize, id: Id, Named { noun, end, .. }: &Named) -> Error {
        let rule = if (0..self.next).contains(&id) {
            format!("no {noun} has this id any more: {end}")
        } else {
            format!("no {noun} has this id; ids are below {}", self.next)
        };
        Error::missing("ids", index, id, &rule)
    }
}

impl Bodies {
    /// The id of each row, ascending. An id is never given twice.
    pub fn ids(&self) -> Result<Vec<Id>> {
        memory::collect((0..self.len() as u32).map(|row| self.ids.of(row)))
    }

    /// Whether a particle has this id.
    pub fn contains(&self, id: Id) -> bool {
        self.ids.row(id).is_some()
    }

    /// The rows of some ids. Refuses ids that no particle has.
    pub fn rows_of(&self, ids: &[Id]) -> Result<Vec<u32>> {
        self.ids.rows_of(ids, &PARTICLE)
    }

    /// The rows of some ids. Refuses ids that no particle has, and ids given twice.
    pub fn distinct_rows_of(&self, ids: &[Id]) -> Result<Vec<u32>> {
        self.ids.distinct_rows_of(ids, &PARTICLE)
    }

    /// The present id of each id that was given; None where no particle has it. `merged` are old and new ids.
    pub(crate) fn renumbered(&self, merged: &[[Id; 2]]) -> Result<Vec<Option<Id>>> {
        let len = self.ids.next as usize;
        if len > MAX_RENUMBERED {
            return Err(Error::NoMemory { bytes: len.saturating_mul(size_of::<Option<Id>>()) });
        }
        let mut new = memory::with_capacity(len)?;
        new.resize(len, None);
        (0..self.len() as u32).map(|row| self.ids.of(row)).for_each(|id| {
            new[id as usize] = Some(id);
        });
        merged.iter().for_each(|&[old, heir]| new[old as usize] = Some(heir));
        Ok(new)
    }
}

/// Removes what belongs to removed rows, and gives the rest the rows that they have then.
pub(crate) fn renumber<V>(
    all: &mut Vec<V>,
    row: impl Fn(&mut V) -> &mut u32,
    (gone, shifted): (&[bool], &[u32]),
) {
    all.retain_mut(|value| {
        let row = row(value);
        let stays = !gone[*row as usize];
        *row = shifted[*row as usize];
        stays
    });
}

/// Removes some values of a column.
pub(crate) fn retain_unless<V>(column: &mut Vec<V>, gone: &[bool]) {
    let mut gone = gone.iter();
    column.retain(|_| gone.next().is_some_and(|&gone| !gone));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_that_no_world_can_have_are_refused() {
        let read = |listed: Option<&[Id]>, len, next| {
            Ids::read(listed.map(<[Id]>::to_vec), len, next).is_ok()
        };
        assert!(read(None, 3, 3) && read(Some(&[]), 0, 7) && read(Some(&[0, 1, 6]), 3, 7));
        assert!(!read(None, 3, 4) && !read(None, 3, -1) && !read(Some(&[]), 0, -1));
        assert!(!read(Some(&[0, 1]), 3, 7) && !read(Some(&[0, 1, 7]), 3, 7));
        assert!(!read(Some(&[1, 0]), 2, 7) && !read(Some(&[1, 1]), 2, 7));
        assert!(!read(Some(&[-1, 1]), 2, 7));
    }

    #[test]
    fn ids_run_out_and_never_repeat() {
        let mut ids = Ids::read(Some(vec![4]), 1, Id::MAX - 2).unwrap();
        assert_eq!(ids.reserve(2, &PARTICLE), Ok(Id::MAX - 2..Id::MAX));
        ids.add(Id::MAX - 2..Id::MAX);
        assert!(ids.reserve(1, &PARTICLE).unwrap_err().to_string().contains("no ids left"));
        assert_eq!(ids.reserve(0, &PARTICLE), Ok(Id::MAX..Id::MAX));
        assert_eq!([4, Id::MAX - 1, Id::MAX].map(|id| ids.row(id)), [Some(0), Some(2), None]);
    }
}
