//! Waking in a distributed world: a rank may touch islands that sleep on other ranks.
//!
//! Sleeping particles stay on the rank on which they fell asleep. In each step a rank gets the circles of those
//! near its moving particles. The names of all islands that any rank would touch go to all ranks, which wake
//! their parts of them.

use super::carried::keep_resting;
use super::carried::{NONE, Resting};
use super::domain::Domain;
use super::domain::domain_of_mut;
use super::reductions::sum_up;
use super::{Grid, Near};
use crate::container::Container;
use crate::particles::Particles;
use crate::world::World;
use crate::world::bodies::asleep::{Asleep, Island, Sleepers};
use crate::world::islands::wake::wake;
use crate::world::reach::{ROUNDED_UP, rounding};
use jostle_base::bytes::Plain;
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::parallel::locked;
use jostle_base::settings::Settings;
use jostle_index::shapes::Filter;

/// Bytes of the circle of a sleeping particle: its island, centre, radius, category and mask.
const CIRCLE: usize = 28;

impl Asleep {
    /// Lists the circles of sleeping particles for each rank that may have moving particles near them.
    pub(crate) fn circles_near(
        &self,
        grid: &Grid<'_>,
        near: &Near,
        container: &Container,
        size: usize,
    ) -> Vec<Vec<u8>> {
        let mut to = vec![Vec::new(); size];
        let all = &self.sleepers().discs.particles;
        let mut ranks = Vec::new();
        for number in self.islands() {
            let Island { particles, name, .. } = &self.sleepers().islands[number as usize];
            for at in particles.clone().map(|at| at as usize) {
                let (position, radius) = (all.positions[at], all.radii[at]);
                // Reserves for rounding, as for the circles of moving particles.
                let half_width = f64::from(radius) * ROUNDED_UP
                    + f64::from(rounding(position, radius, container));
                near.list_ranks(grid, container.period().wrap(position), half_width, &mut ranks);
                for &rank in &ranks {
                    put_circle(&mut to[rank as usize], *name, all, at);
                }
            }
        }
        to
    }
}

fn put_circle(to: &mut Vec<u8>, island: Id, all: &Particles, at: usize) {
    let start = to.len();
    to.resize(start + CIRCLE, 0);
    let ([x, y], filter) = (all.positions[at], all.filter(at));
    (island as u64).store(&mut to[start..start + 8]);
    [x, y, all.radii[at]].store(&mut to[start + 8..start + 20]);
    [filter.category, filter.mask].store(&mut to[start + 20..]);
}

/// Sleeping islands of which only the circles are known.
pub(crate) fn islands_of_circles(bytes: &[u8], settings: Settings) -> Result<Asleep> {
    let mut circles: Vec<(Id, [f32; 3], [u32; 2])> = bytes
        .chunks_exact(CIRCLE)
        .map(|from| {
            (u64::load(&from[..8]) as Id, Plain::load(&from[8..20]), Plain::load(&from[20..]))
        })
        .collect();
    // Circles of an island come from several ranks.
    circles.sort_by_key(|&(island, ..)| island);
    let mut found = Asleep::default();
    if circles.is_empty() {
        return Ok(found);
    }
    let positions: Vec<_> = circles.iter().map(|(_, [x, y, _], _)| [*x, *y]).collect();
    let radii = circles.iter().map(|(_, [.., radius], _)| *radius).collect();
    let mut sleepers = Sleepers::default();
    let len = positions.len();
    let mut all = Particles::new(positions, vec![[0.0; 2]; len], radii, 1.0);
    for (filter, (.., [category, mask])) in all.filters_mut().iter_mut().zip(&circles) {
        *filter = Filter { category: *category, mask: *mask };
    }
    all.simplify();
    sleepers.discs.particles = all;
    sleepers.discs.rows.resize(len, 0);
    let mut end = 0;
    for circles in circles.chunk_by(|a, b| a.0 == b.0) {
        let particles = end..end + circles.len() as u32;
        end = particles.end;
        sleepers.islands.push(Island { particles, name: circles[0].0, ..Island::default() });
    }
    found.append(&sleepers, settings)?;
    Ok(found)
}

impl Domain {
    /// The contacts at rest of islands that wake, with the rows of own particles.
    fn contacts_of_woken(&self, names: &[Id]) -> Vec<Resting> {
        let is_kept = |of: &&super::islands::SleepingContact| {
            let contact = &of.contact;
            let is_at_rest = contact.presses() && contact.image == [0.0; 2];
            is_at_rest && names.binary_search(&of.island).is_ok()
        };
        let mut woken: Vec<Resting> = self
            .sleeping
            .iter()
            .filter(is_kept)
            .map(|of| {
                let impulses = [of.contact.impulse, of.contact.friction_impulse];
                // The order of the ids is that of `Resting`: one that sleeps is movable.
                Resting { ids: of.ids, rows: [NONE; 2], impulses }
            })
            .collect();
        let mut rows: Vec<(Id, u32)> =
            woken.iter().flat_map(|of| of.ids).map(|id| (id, NONE)).collect();
        rows.sort_unstable();
        rows.dedup();
        for (&id, row) in self.ids[..self.own].iter().zip(0..) {
            if let Ok(at) = rows.binary_search_by_key(&id, |&(id, _)| id) {
                rows[at].1 = row;
            }
        }
        for of in &mut woken {
            of.rows = of.ids.map(|id| rows[rows.partition_point(|&(other, _)| other < id)].1);
        }
        woken
    }
}

/// Adds the contacts of islands that wake to those at rest.
pub(super) fn recall_contacts_of_woken(world: &mut World, islands: &[u32]) {
    // They are added to those of the last step.
    keep_resting(world);
    let mut names: Vec<Id> = world.bodies.asleep.names(islands).collect();
    names.sort_unstable();
    let domain = domain_of_mut(world);
    let woken = domain.contacts_of_woken(&names);
    domain.resting.extend(woken);
}

/// Wakes the islands that any rank would touch, or all; there are no ghosts.
pub(super) fn wake_touched(world: &mut World, touched: &[u32], all: bool) -> Result<()> {
    let mut names: Vec<Id> = world.bodies.asleep.names(touched).collect();
    let domain = domain_of_mut(world);
    names.append(&mut domain.touched);
    names.sort_unstable();
    names.dedup();
    // Names travel, because the numbers of islands differ between ranks.
    let bytes: Vec<u8> = names.iter().flat_map(|name| name.to_le_bytes()).collect();
    let found = locked(&domain.group).share(&bytes)?.concat();
    let (found, _) = found.as_chunks::<8>();
    let mut names: Vec<Id> = found.iter().map(|name| Id::from_le_bytes(*name)).collect();
    names.sort_unstable();
    let islands = if all {
        world.bodies.asleep.islands().collect()
    } else {
        world.bodies.asleep.named(&names)?
    };
    wake(world, &islands)?;
    // The numbers of particles that are awake have changed, on which steps depend.
    sum_up(world)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn circles_are_read_as_islands() {
        let mut all =
            Particles::new(vec![[1.0, 2.0], [3.0, 4.0]], vec![[0.0; 2]; 2], vec![5.0; 2], 1.0);
        all.filters_mut()[1] = Filter { category: 2, mask: 3 };
        let mut bytes = Vec::new();
        for (island, at) in [(9, 0), (4, 1), (9, 1)] {
            put_circle(&mut bytes, island, &all, at);
        }
        let found = islands_of_circles(&bytes, Settings::default()).unwrap();
        assert_eq!(found.names(&[0, 1]).collect::<Vec<Id>>(), [4, 9]);
        let discs = &found.sleepers().discs.particles;
        assert_eq!(discs.positions, [[3.0, 4.0], [1.0, 2.0], [3.0, 4.0]]);
        assert_eq!((discs.radii[0], discs.filter(0)), (5.0, Filter { category: 2, mask: 3 }));
        assert!(islands_of_circles(&[], Settings::default()).unwrap().is_empty());
    }
}
