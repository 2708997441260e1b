//! Adding, removing, reading and changing particles between steps.

use std::ops::Range;

use super::World;
use super::bodies::Bodies;
use super::bodies::discs::{Discs, Persistent, RecentMotion};
use super::bodies::ids::{Ids, PARTICLE};
use super::distribution::Distribution;
use super::islands::NONE;
use super::islands::wake::{forget_woken, wake_all, wake_changed};
use super::plan::start_threads;
use crate::particles::{Changes, Effect, Particles};
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::table::Table;
use jostle_base::{memory, reserve};
use jostle_index::shapes::{Each, MAX_ROWS};

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
        // Memory for all particles, also if those that sleep wake.
        let ids = self.bodies.ids.reserve(particles.len(), &PARTICLE)?;
        let Discs { particles: awake, rows, persistent } = &mut self.bodies.awake;
        awake.reserve(&particles, new)?;
        persistent.reserve(&Persistent::default(), new)?;
        reserve!(new; *rows);
        self.external.reserve(new)?;
        // A step tests only particles that move against sleeping ones. So an immovable particle put
        // on a sleeping island would never wake it.
        if !particles.movable.iter().all(|&movable| movable) {
            wake_all(self)?;
        }
        self.bodies.ids.add(ids.clone());
        self.bodies.awake.particles.extend(&particles);
        self.bodies.awake.rows.extend(old as u32..new as u32);
        self.external.resize(new);
        self.bodies.awake.persistent.resize(self.bodies.awake.rows.len());
        self.bodies.forget_indices();
        start_threads(self);
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
        let mut gone = memory::filled(self.len(), false)?;
        rows.iter().for_each(|&row| gone[row as usize] = true);
        let removal = Removal::new(self, gone)?;
        // Islands wake while rows still have their old meaning.
        wake_changed(self, &rows)?;
        forget_woken(self);
        let Removal { gone, shifted, .. } = take_out(self, removal);
        self.influences
            .renumber(|row| (!gone[row as usize]).then(|| Id::from(shifted[row as usize])));
        let ids = &self.bodies.ids;
        self.record.drop_merged(|id| ids.row(id).is_some());
        self.external.end_if_zero(&*self.halo)
    }

    /// A copy of some particles, in this order. It costs as much as there are ids.
    pub fn read(&self, ids: &[Id]) -> Result<Particles> {
        self.bodies.particles_in(&self.bodies.rows_of(ids)?)
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
        let rows = memory::collect(0..self.len() as u32)?;
        set_rows(self, &rows, changes)
    }

    /// As [`World::set_all`]; `change` gets a copy of all particles in the order of adding. A particle with
    /// a new position has no residual.
    pub fn edit(&mut self, change: impl FnOnce(&mut Particles) -> Result<()>) -> Result<()> {
        let rows = memory::collect(0..self.len() as u32)?;
        self.edit_rows(&rows, change)
    }

    /// As [`World::edit`], of the particles in some rows, in this order; each at most once.
    pub fn edit_rows(
        &mut self,
        rows: &[u32],
        change: impl FnOnce(&mut Particles) -> Result<()>,
    ) -> Result<()> {
        let before = self.bodies.particles_in(rows)?;
        let mut copy = before.copied()?;
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
        let len = self.len();
        self.bodies.awake.particles.reserve(&copy, len)?;
        let indices = wake_edited(self, rows, &before, &copy)?;
        forget_turns(&mut self.bodies.awake, &indices, |nth| copy.positions[nth]);
        self.bodies.forget_tree();
        let len = self.bodies.awake.rows.len();
        for (nth, index) in indices.into_iter().enumerate() {
            // Those that still sleep have not changed.
            if (index as usize) < len {
                self.bodies.awake.particles.put(len, index as usize, &copy, nth);
            }
        }
        self.bodies.awake.particles.drop_defaults();
        Ok(())
    }
}

/// Removes rows, so that the others move up; returns how many remain before each.
pub(crate) fn take_out(world: &mut World, mut removal: Removal) -> Removal {
    let Removal { gone, shifted, keep, ids } = &mut removal;
    keep.extend(world.bodies.awake.rows.iter().map(|&row| !gone[row as usize]));
    world.boundaries.renumber(gone, shifted);
    world.bodies.keep(keep);
    world.contacts.retain(keep);
    world.bodies.ids = std::mem::take(ids);
    world.external.remove(gone);
    world.bodies.asleep.renumber(shifted);
    world.bodies.awake.rows.iter_mut().for_each(|row| *row = shifted[*row as usize]);
    world.bodies.forget_indices();
    removal
}

/// Rows to remove. It has the memory that [`take_out`] needs.
pub(crate) struct Removal {
    /// Whether each row is removed.
    pub(crate) gone: Vec<bool>,
    /// How many rows remain before each.
    pub(crate) shifted: Vec<u32>,
    /// Whether each index of those that are awake stays.
    keep: Vec<bool>,
    /// The ids of the rows that remain.
    ids: Ids,
}

impl Removal {
    pub(crate) fn new(world: &mut World, gone: Vec<bool>) -> Result<Self> {
        let (mut shifted, mut left) = (memory::with_capacity(gone.len())?, 0);
        for &gone in &gone {
            shifted.push(left);
            left += u32::from(!gone);
        }
        let keep = memory::with_capacity(gone.len())?;
        world.contacts.reserve_retain(gone.len())?;
        let ids = world.bodies.ids.without(&gone)?;
        Ok(Self { gone, shifted, keep, ids })
    }
}

pub(crate) fn set_rows(world: &mut World, rows: &[u32], changes: &Changes) -> Result<()> {
    changes.validate(rows.len())?;
    let exact = exact_values(world, rows, changes)?;
    if let Some(radii) = &changes.radii {
        radii.check(|radii| world.settings.container.check_fit(radii))?;
    }
    if let Some(kinds) = &changes.kinds {
        kinds.check(|kinds| world.influences.check_kinds(kinds))?;
    }
    // The copies are made only if some part of the world needs what changes.
    let len = world.bodies.len();
    changes.reserve(&mut world.bodies.awake.particles, len)?;
    let indices = if may_wake(&world.bodies, &*world.halo) {
        let before = world.bodies.particles_in(rows)?;
        let mut after = before.copied()?;
        changes.reserve(&mut after, rows.len())?;
        let all = memory::collect(0..rows.len() as u32)?;
        [changes, &exact].into_iter().for_each(|new| new.write(&mut after, &all));
        wake_edited(world, rows, &before, &after)?
    } else {
        world.bodies.indices_of(rows)?
    };
    if let Some(positions) = &changes.positions {
        forget_turns(&mut world.bodies.awake, &indices, |nth| positions.at(nth));
    }
    // As above, sleeping particles are left out.
    if changes.is_of_shapes() {
        world.bodies.forget_tree();
    }
    let awake = &mut world.bodies.awake.particles;
    [changes, &exact].into_iter().for_each(|new| new.write(awake, &indices));
    Ok(())
}

/// A particle that gets another position begins a new path. Those that sleep do not change.
fn forget_turns(awake: &mut Discs, indices: &[u32], new: impl Fn(usize) -> [f32; 2]) {
    let Discs { particles, persistent, .. } = awake;
    for (nth, &index) in indices.iter().enumerate() {
        if let Some(turns) = persistent.turns.get_mut(index as usize)
            && particles.positions[index as usize] != new(nth)
        {
            *turns = [0; 2];
        }
    }
}

/// What the changes leave out: of a position or an angle that is the present one in float32, what rounding removed.
/// So assigning what was read changes nothing.
fn exact_values(world: &World, rows: &[u32], changes: &Changes) -> Result<Changes> {
    let mut exact = Changes::default();
    let has_new_centers = changes.positions.is_some() && changes.residuals.is_none();
    if !has_new_centers && changes.angles.is_none() {
        return Ok(exact);
    }
    let indices = world.bodies.indices_of(rows)?;
    let discs = || indices.iter().map(|&index| world.bodies.disc_at(index as usize)).enumerate();
    if let Some(positions) = changes.positions.as_ref().filter(|_| has_new_centers) {
        let residual = |(nth, (all, at)): (usize, (&Particles, usize))| {
            if all.positions[at] == positions.at(nth) { all.residuals[at] } else { [0.0; 2] }
        };
        exact.residuals = Some(Each::Rows(memory::collect(discs().map(residual))?));
    }
    if let Some(angles) = &changes.angles {
        let angle = |(nth, (all, at)): (usize, (&Particles, usize))| {
            let (spin, new) = (all.spin(at), angles.at(nth));
            if f64::from(spin.rounded_angle()) == new { spin.angle } else { new }
        };
        exact.angles = Some(Each::Rows(memory::collect(discs().map(angle))?));
    }
    Ok(exact)
}

/// Whether changes may wake particles, or concern those whose motion is observed.
fn may_wake(bodies: &Bodies, halo: &dyn Distribution) -> bool {
    !bodies.asleep.is_empty()
        || !bodies.awake.persistent.recent_motions.is_empty()
        || !halo.is_alone()
}

/// Wakes what changes concern, and clears how the changed particles moved. Returns the index of each row; of those that
/// sleep, [`NONE`].
fn wake_edited(
    world: &mut World,
    rows: &[u32],
    before: &Particles,
    after: &Particles,
) -> Result<Vec<u32>> {
    let mut indices = world.bodies.indices_of(rows)?;
    if !may_wake(&world.bodies, &*world.halo) {
        return Ok(indices);
    }
    let [mut driven, mut changed, mut moved] = [(); 3].map(|()| Vec::new());
    for (nth, &row) in rows.iter().enumerate() {
        match Effect::of(before, after, nth) {
            Effect::None => {}
            // A new velocity of an immovable particle concerns only what touches it. A new
            // position may concern islands that are not touched yet.
            Effect::Velocity if !before.movable[nth] => memory::push(&mut driven, row)?,
            _ => {
                memory::push(&mut changed, row)?;
                memory::push(&mut moved, indices[nth])?;
            }
        }
    }
    let len = world.bodies.awake.rows.len();
    let mut by_row = memory::collect(0..rows.len())?;
    by_row.sort_unstable_by_key(|&nth| rows[nth]);
    world.halo.protocol().wake_edited(world, &mut driven, &changed)?;
    // Particles that have woken come after all others.
    for index in moved.into_iter().filter(|&index| (index as usize) < len) {
        // What was observed of the particle does not hold after the change. It is observed for
        // two whole quarters again before it may sleep.
        let recent = &mut world.bodies.awake.persistent.recent_motions;
        if let Some(recent) = recent.get_mut(index as usize) {
            *recent = RecentMotion::UNKNOWN;
        }
    }
    indices.iter_mut().filter(|index| **index as usize >= len).for_each(|index| *index = NONE);
    for (index, row) in (0..).zip(&world.bodies.awake.rows).skip(len) {
        if let Ok(at) = by_row.binary_search_by_key(row, |&nth| rows[nth]) {
            indices[by_row[at]] = index;
        }
    }
    Ok(indices)
}
