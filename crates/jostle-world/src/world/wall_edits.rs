//! Adding, removing, reading and changing walls between steps.
//!
//! A wall has an id, which stays, and a row in the order of adding. Every change makes the tree of all walls anew and
//! wakes all particles.

use std::ops::Range;

use super::World;
use super::bodies::ids::{Ids, WALL};
use super::islands::wake::wake_all;
use crate::walls::{Wall, Walls, check_count, check_walls};
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::memory;

impl World {
    /// The walls in the order of adding, without the sides of the container.
    pub fn walls(&self) -> &[Wall] {
        self.boundaries.walls.all()
    }

    /// Their ids, ascending. An id is never given twice.
    pub fn wall_ids(&self) -> Result<Vec<Id>> {
        memory::collect((0..self.walls().len() as u32).map(|row| self.boundaries.ids.of(row)))
    }

    /// Whether a wall has this id.
    pub fn has_wall(&self, id: Id) -> bool {
        self.boundaries.ids.row(id).is_some()
    }

    /// The rows of some walls. Refuses ids that no wall has.
    pub fn wall_rows_of(&self, ids: &[Id]) -> Result<Vec<u32>> {
        self.boundaries.ids.rows_of(ids, &WALL)
    }

    /// Adds walls after the others and returns their ids, which are above all ids before. Particles that overlap a
    /// wall are pushed out in several steps.
    pub fn add_walls(&mut self, new: &[Wall]) -> Result<Range<Id>> {
        check_walls(new, self.settings.container, "segments")?;
        check_count(self.walls().len() + new.len())?;
        let mut ids = self.boundaries.ids.copied()?;
        let added = ids.reserve(new.len(), &WALL)?;
        ids.add(added.clone());
        let mut all = memory::with_capacity(self.walls().len() + new.len())?;
        all.extend_from_slice(self.walls());
        all.extend_from_slice(new);
        replace(self, all, ids)?;
        Ok(added)
    }

    /// Removes walls. Motors no longer drive them, and they have no temperature.
    pub fn remove_walls(&mut self, ids: &[Id]) -> Result<()> {
        let rows = self.boundaries.ids.distinct_rows_of(ids, &WALL)?;
        if rows.is_empty() {
            return Ok(());
        }
        let mut gone = memory::filled(self.walls().len(), false)?;
        rows.iter().for_each(|&row| gone[row as usize] = true);
        let stay = self.walls().iter().zip(&gone).filter(|(_, gone)| !**gone);
        let mut all = memory::with_capacity(gone.len() - rows.len())?;
        all.extend(stay.map(|(wall, _)| *wall));
        replace(self, all, self.boundaries.ids.without(&gone)?)?;
        let Self { influences, boundaries, .. } = self;
        influences.forget_walls(|id| boundaries.ids.row(id).is_none());
        Ok(())
    }

    /// Changes some walls; `change` gets copies of them in the order of `ids`, each given at most once. If what it
    /// makes of them is refused, they stay as they were. A wall with new ends has no residuals.
    pub fn set_walls_of(&mut self, ids: &[Id], change: impl FnOnce(&mut [Wall])) -> Result<()> {
        let rows = self.boundaries.ids.distinct_rows_of(ids, &WALL)?;
        let mut new = memory::collect(rows.iter().map(|&row| self.walls()[row as usize]))?;
        change(&mut new);
        let mut all = memory::copy(self.walls())?;
        for (&row, new) in rows.iter().zip(&mut new) {
            let old = &mut all[row as usize];
            if new.ends != old.ends {
                new.residuals = [[0.0; 2]; 2];
            }
            *old = *new;
        }
        check_walls(&new, self.settings.container, "segments")?;
        replace(self, all, self.boundaries.ids.copied()?)
    }

    /// Replaces all walls. Each row keeps its id; further rows have new ids, and the walls beyond the last row are
    /// removed. Refuses to remove one to which a force refers.
    pub fn set_walls(&mut self, walls: Vec<Wall>) -> Result<()> {
        check_count(walls.len())?;
        let (old, new) = (self.walls().len(), walls.len());
        let mut ids = if new < old {
            let gone = memory::collect((0..old).map(|row| row >= new))?;
            self.boundaries.ids.without(&gone)?
        } else {
            self.boundaries.ids.copied()?
        };
        let added = ids.reserve(new.saturating_sub(old), &WALL)?;
        ids.add(added);
        self.influences.check_walls(|id| ids.row(id).is_some())?;
        replace(self, walls, ids)
    }

    /// Gives the world the walls of another one, with their ids.
    #[cfg(feature = "ranks")]
    pub(crate) fn copy_walls(&mut self, other: &Self) -> Result<()> {
        replace(self, memory::copy(other.walls())?, other.boundaries.ids.copied()?)
    }
}

/// Replaces the walls and their ids, and wakes all particles unless these are the present ones.
fn replace(world: &mut World, walls: Vec<Wall>, ids: Ids) -> Result<()> {
    if walls == world.walls() {
        world.boundaries.ids = ids;
        return Ok(());
    }
    let mut walls = Walls::new(walls, world.settings.container, world.settings.tree)?;
    walls.set_sides(world.settings.present_sides());
    wake_all(world)?;
    world.bodies.awake.persistent.recent_motions.clear();
    let old = (0..).map(|row| world.boundaries.ids.of(row));
    world.record.totals.keep_walls(old.map(|id| ids.row(id).is_some()));
    world.boundaries.replace_walls(walls, ids);
    Ok(())
}
