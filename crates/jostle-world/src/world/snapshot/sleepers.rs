//! Serialization of sleeping islands.

use std::ops::Range;

use super::super::World;
use super::super::asleep::{Island, Sleepers};
use super::super::discs::Discs;
use super::{
    get_contacts, get_particles, get_wall_impulses, put_contacts, put_particles, put_wall_impulses,
};
use crate::particles::Spin;
use jostle_base::bytes::{Reader, Writer, damaged};
use jostle_base::error::Result;
use jostle_index::shapes::MAX_ROWS;

impl World {
    /// Refuses restored drifts and sleeping particles that no world can have.
    pub(crate) fn check_sleeping(&self) -> Result<()> {
        if self
            .persistent
            .drifts
            .iter()
            .flat_map(|of| of.before.into_iter().chain(of.now))
            .any(f32::is_nan)
        {
            return Err(damaged("a mean speed is not possible"));
        }
        let Sleepers { discs, contacts, wall_impulses, islands } = self.asleep.sleepers();
        let Discs { particles, rows, .. } = discs;
        let container = &self.settings.container;
        container.check_fit(&particles.radii).map_err(|error| damaged(&error.to_string()))?;
        let indices = self.indices();
        let is_still = |spin: &Spin| spin.velocity == 0.0;
        let at_rest = particles.velocities.iter().all(|&velocity| velocity == [0.0; 2])
            && particles.spins.iter().all(is_still)
            && particles.movable.iter().all(|&movable| movable);
        let slice = |range: &Range<u32>| range.start as usize..range.end as usize;
        let are_own = |island: &Island| {
            let first = self.rows.len() as u32;
            let own = first + island.particles.start..first + island.particles.end;
            let index = |row: u32| indices[row as usize];
            let is_own = |&row: &u32| own.contains(&index(row));
            let is_fixed = |&row: &u32| {
                self.particles.movable.get(index(row) as usize).is_some_and(|&movable| !movable)
            };
            let contacts = &contacts[slice(&island.contacts)];
            contacts.iter().all(|contact| {
                contact.indices.iter().any(is_own)
                    && contact.indices.iter().all(|row| is_own(row) || is_fixed(row))
            }) && wall_impulses[slice(&island.wall_impulses)].iter().all(|of| is_own(&of.row))
        };
        debug_assert_eq!(rows.len(), self.asleep.len());
        if at_rest && islands.iter().all(are_own) {
            return Ok(());
        }
        Err(damaged("a sleeping particle moves, or touches one that is not in its island"))
    }
}

pub(super) fn put_sleepers(to: &mut Writer, all: &Sleepers) {
    to.put_count(all.islands.len());
    for Island { particles, contacts, wall_impulses, .. } in &all.islands {
        to.put([particles, contacts, wall_impulses].map(|range| range.len() as u32));
    }
    let Discs { particles, rows, .. } = &all.discs;
    to.put_all(rows);
    put_particles(to, particles);
    put_contacts(to, all.contacts.iter().collect());
    put_wall_impulses(to, &all.wall_impulses);
}

/// The sleeping islands, of `len` particles together, beside `awake` others.
pub(super) fn get_sleepers(from: &mut Reader<'_>, len: usize, awake: usize) -> Result<Sleepers> {
    let count = from.get_count()?;
    let sizes: Vec<[u32; 3]> = from.get_all(count)?;
    let mut ends = [0u32; 3];
    let mut islands = Vec::with_capacity(count);
    for size in sizes {
        let starts = ends;
        for (end, size) in ends.iter_mut().zip(size) {
            *end = end.checked_add(size).ok_or_else(|| damaged("an island is too large"))?;
        }
        if size[0] == 0 {
            return Err(damaged("an island is empty"));
        }
        let [particles, contacts, wall_impulses] = [0, 1, 2].map(|k| starts[k]..ends[k]);
        islands.push(Island { particles, contacts, wall_impulses, ..Island::default() });
    }
    let total = len.saturating_add(awake);
    let mut all = Sleepers { islands, ..Sleepers::default() };
    let Discs { particles, rows, .. } = &mut all.discs;
    *rows = from.get_all(len)?;
    *particles = get_particles(from, len)?;
    particles.validate().map_err(|error| damaged(&error.to_string()))?;
    all.contacts = get_contacts(from, total)?;
    all.wall_impulses = get_wall_impulses(from, total)?;
    let found = [len, all.contacts.len(), all.wall_impulses.len()];
    if ends.map(|end| end as usize) != found || total > MAX_ROWS {
        return Err(damaged("the sizes of its islands are wrong"));
    }
    Ok(all)
}
