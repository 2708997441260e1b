//! Adding, removing, reading and changing particles between steps.

use std::ops::Range;

use super::World;
use super::bodies::Bodies;
use super::bodies::discs::RecentMotion;
use super::distribution::Distribution;
use super::islands::wake::{wake_all, wake_changed};
use crate::particles::{Changes, Effect, Particles};
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::table::Table;
use jostle_index::shapes::MAX_ROWS;

impl World {
    /// Adds particles after the others and returns their ids, which are above all ids before. An
    /// immovable one wakes all.
    pub fn add(&mut self, mut particles: Particles) -> Result<Range<Id>> {
        // All checks come before the first change. So a refused call leaves the world as it was.
        particles.validate()?;
        self.settings.container.check_fit(&particles.radii)?;
        self.influences.check_kinds(&particles.kinds)?;
        particles.simplify();
        let (old, new) = (self.len(), self.len() + particles.len());
        if new > MAX_ROWS {
            return Err(Error::of("positions", new, "a world holds at most 2147483647 particles"));
        }
        let ids = self.bodies.ids.add(particles.len())?;
        // A step tests only particles that move against sleeping ones. So an immovable particle put
        // on a sleeping island would never wake it.
        if !particles.movable.iter().all(|&movable| movable) {
            wake_all(self);
        }
        self.bodies.awake.particles.extend(&particles);
        self.bodies.awake.rows.extend(old as u32..new as u32);
        self.external.resize(new);
        self.bodies.awake.persistent.resize(self.bodies.awake.rows.len());
        self.bodies.forget_indices();
        Ok(ids)
    }

    /// Removes particles. The rows after them move up; the ids of others stay. Springs and
    /// attractors of a removed particle are removed too. The islands of removed particles wake; all
    /// wake if an immovable one is removed.
    pub fn remove(&mut self, ids: &[Id]) -> Result<()> {
        let rows = self.bodies.distinct_rows_of(ids)?;
        if rows.is_empty() {
            return Ok(());
        }
        // Islands wake while rows still have their old meaning.
        wake_changed(self, &rows);
        let mut gone = vec![false; self.len()];
        rows.iter().for_each(|&row| gone[row as usize] = true);
        let shifted = take_out(self, &gone);
        self.influences
            .renumber(|row| (!gone[row as usize]).then(|| Id::from(shifted[row as usize])));
        let ids = &self.bodies.ids;
        self.record.drop_merged(|id| ids.row(id).is_some());
        self.external.end_if_zero(&*self.halo)
    }

    /// A copy of some particles, in this order. It costs as much as there are ids.
    pub fn read(&self, ids: &[Id]) -> Result<Particles> {
        Ok(self.bodies.particles_in(&self.bodies.rows_of(ids)?))
    }

    /// Changes some columns of some particles, each given at most once. Refused values change nothing.
    ///
    /// It costs as much as there are ids, apart from the first call after a step, which reads all row
    /// numbers. The islands of changed particles wake. All wake if an immovable one changes, but those that
    /// do not touch it sleep on if only its velocities change.
    pub fn set(&mut self, ids: &[Id], changes: &Changes) -> Result<()> {
        let rows = self.bodies.distinct_rows_of(ids)?;
        set_rows(self, &rows, changes)
    }

    /// As [`World::set`], of all particles in the order of adding.
    pub fn set_all(&mut self, changes: &Changes) -> Result<()> {
        let rows: Vec<u32> = (0..self.len() as u32).collect();
        set_rows(self, &rows, changes)
    }

    /// As [`World::set_all`]; `change` gets a copy of all particles in the order of adding. A particle with
    /// a new position has no residual.
    pub fn edit(&mut self, change: impl FnOnce(&mut Particles) -> Result<()>) -> Result<()> {
        let rows: Vec<u32> = (0..self.len() as u32).collect();
        self.edit_rows(&rows, change)
    }

    /// As [`World::edit`], of the particles in some rows, in this order; each at most once.
    pub fn edit_rows(
        &mut self,
        rows: &[u32],
        change: impl FnOnce(&mut Particles) -> Result<()>,
    ) -> Result<()> {
        let before = self.bodies.particles_in(rows);
        let mut copy = before.clone();
        change(&mut copy)?;
        if copy.len() != before.len() {
            let (found, expected) = (copy.len(), before.len());
            return Err(Error::Length { argument: "positions", found, expected });
        }
        copy.validate()?;
        self.settings.container.check_fit(&copy.radii)?;
        self.influences.check_kinds(&copy.kinds)?;
        // A residual is what rounding removed from the old centre. It would displace the new one.
        let pairs = copy.residuals.iter_mut().zip(copy.positions.iter().zip(&before.positions));
        let moved = pairs.filter(|(_, (new, old))| new != old);
        moved.for_each(|(residual, _)| *residual = [0.0; 2]);
        copy.simplify();
        wake_edited(self, rows, &before, &copy)?;
        let (indices, len) = (self.bodies.indices_of(rows), self.bodies.awake.rows.len());
        for (nth, index) in indices.into_iter().enumerate() {
            // Those that still sleep have not changed; their indices are behind those of all others.
            if (index as usize) < len {
                self.bodies.awake.particles.put(len, index as usize, &copy, nth);
            }
        }
        self.bodies.awake.particles.drop_defaults();
        Ok(())
    }
}

/// Removes rows, so that the others move up; returns how many remain before each.
pub(crate) fn take_out(world: &mut World, gone: &[bool]) -> Vec<u32> {
    let mut shifted = Vec::with_capacity(world.len());
    let mut left = 0;
    for &gone in gone {
        shifted.push(left);
        left += u32::from(!gone);
    }
    // Columns of awake particles are by index; `gone` and `shifted` are by row.
    let keep: Vec<bool> = world.bodies.awake.rows.iter().map(|&row| !gone[row as usize]).collect();
    world.boundaries.renumber(gone, &shifted);
    world.bodies.keep(&keep);
    world.contacts.retain(&keep);
    world.bodies.ids.remove(gone);
    world.external.remove(gone);
    world.bodies.asleep.renumber(&shifted);
    world.bodies.awake.rows.iter_mut().for_each(|row| *row = shifted[*row as usize]);
    world.bodies.forget_indices();
    shifted
}

fn set_rows(world: &mut World, rows: &[u32], changes: &Changes) -> Result<()> {
    changes.validate(rows.len())?;
    if let Some(radii) = &changes.radii {
        radii.check(|radii| world.settings.container.check_fit(radii))?;
    }
    if let Some(kinds) = &changes.kinds {
        kinds.check(|kinds| world.influences.check_kinds(kinds))?;
    }
    // The copies are made only if some part of the world must know what changes.
    if may_wake(&world.bodies, &*world.halo) {
        let before = world.bodies.particles_in(rows);
        let mut after = before.clone();
        changes.write(&mut after, &(0..rows.len() as u32).collect::<Vec<u32>>());
        wake_edited(world, rows, &before, &after)?;
    }
    // As above, sleeping particles are left out.
    let indices = world.bodies.indices_of(rows);
    changes.write(&mut world.bodies.awake.particles, &indices);
    Ok(())
}

/// Whether changes may wake particles, or concern those whose motion is observed.
fn may_wake(bodies: &Bodies, halo: &dyn Distribution) -> bool {
    !bodies.asleep.is_empty()
        || !bodies.awake.persistent.recent_motions.is_empty()
        || !halo.is_alone()
}

/// Wakes what changes concern, and forgets how the changed particles moved.
fn wake_edited(
    world: &mut World,
    rows: &[u32],
    before: &Particles,
    after: &Particles,
) -> Result<()> {
    if !may_wake(&world.bodies, &*world.halo) {
        return Ok(());
    }
    let (mut driven, mut changed) = (Vec::new(), Vec::new());
    for (nth, &row) in rows.iter().enumerate() {
        match Effect::of(before, after, nth) {
            Effect::None => {}
            // A new velocity of an immovable particle concerns only what touches it. A new
            // position may concern islands that nothing here knows of.
            Effect::Velocity if !before.movable[nth] => driven.push(row),
            _ => changed.push(row),
        }
    }
    for index in world.bodies.indices_of(&changed) {
        // What was observed of the particle does not hold after the change. It is observed for
        // two whole quarters again before it may sleep.
        let recent = &mut world.bodies.awake.persistent.recent_motions;
        if let Some(recent) = recent.get_mut(index as usize) {
            *recent = RecentMotion::UNKNOWN;
        }
    }
    world.halo.protocol().wake_edited(world, &mut driven, &changed)
}
