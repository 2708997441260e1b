//! Which particles form an island, and what each of them rests on.

use super::Islands;
use crate::contacts::Contacts;
use crate::particles::Particles;
use crate::resting::WallImpulse;
use crate::world::bodies::discs::Discs;
use jostle_base::error::Result;
use jostle_base::memory;

/// What a particle rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Rest {
    /// Nothing.
    Free,
    /// Other movable particles.
    OnOther,
    /// A wall or a static particle.
    Supported,
}

impl Islands {
    /// Joins the particles of some pairs of indices. Static particles belong to no island; kinematic
    /// ones keep theirs awake.
    pub(super) fn group(
        &mut self,
        discs: &Discs,
        own: u32,
        joined: impl Iterator<Item = [u32; 2]>,
    ) -> Result<()> {
        let Discs { particles, rows, .. } = discs;
        self.groups.reset(rows.len())?;
        for pair in joined {
            // Pairs of two ghosts are known to their own processes.
            let is_known = pair.iter().any(|&index| rows[index as usize] < own);
            if is_known && pair.iter().all(|&index| is_member(particles, index)) {
                self.groups.join(pair[0], pair[1]);
            }
        }
        Ok(())
    }

    /// Finds what each particle rests on: walls that pushed it in the last sub-step, other particles by contacts, or
    /// by the springs of the `tied` pairs.
    pub(super) fn find_rests(
        &mut self,
        discs: &Discs,
        contacts: &Contacts,
        wall_impulses: &[WallImpulse],
        tied: impl Iterator<Item = [u32; 2]>,
    ) -> Result<()> {
        let (rests, movable) = (&mut self.rests, &discs.particles.movable);
        rests.clear();
        // Pushes are those of the last sub-step. A bounce has none, so it is no support.
        let is_on_wall = |row: u32| {
            let first = wall_impulses.partition_point(|impulse| impulse.row < row);
            let of_row = wall_impulses[first..].iter().take_while(|impulse| impulse.row == row);
            of_row.map(|impulse| impulse.pushes[0]).any(|push| push > 0.0)
        };
        let rest = |&row: &u32| if is_on_wall(row) { Rest::Supported } else { Rest::Free };
        memory::extend(rests, discs.rows.iter().map(rest))?;
        // Only contacts with an impulse carry anything. Surfaces that merely touch support nothing.
        let pressed = contacts.lasting().filter(|contact| contact.presses());
        for pair in pressed.map(|contact| contact.indices).chain(tied) {
            let [a, b] = pair.map(|index| index as usize);
            let rest = if movable[a] && movable[b] { Rest::OnOther } else { Rest::Supported };
            [a, b].into_iter().for_each(|index| rests[index] = rests[index].max(rest));
        }
        // A kinematic particle is a member of its island, and as a member without support it keeps
        // the island awake. Static particles are no members.
        for (rest, &movable) in rests.iter_mut().zip(movable) {
            if !movable {
                *rest = Rest::Free;
            }
        }
        Ok(())
    }
}

/// Whether a particle may be a member of an island. Static particles belong to none.
pub(super) fn is_member(particles: &Particles, index: u32) -> bool {
    !particles.is_static(index as usize)
}
