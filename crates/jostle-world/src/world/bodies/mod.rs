//! The particles of a world, awake and asleep: their columns, ids and rows.
//!
//! Those that are awake are kept in the canonical order of the last step: Morton order of their positions at its
//! beginning, ties by their other values. So neighbours in space are neighbours in memory, and every sum and every
//! loop runs in an order that comes from the state. A particle has an *id*, which stays, and which only callers use; a
//! *row*, its place in the order of adding; and an *index*, its place in memory, which changes with every step.

pub(crate) mod ids;
pub(crate) mod discs;
pub(crate) mod asleep;

use std::sync::OnceLock;

use super::settings::WorldSettings;
use crate::particles::{Particles, Spin};
use asleep::Asleep;
use discs::Discs;
use ids::Ids;
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_base::saved;
use jostle_base::table::{Table, dense};
use jostle_index::quadtree::Quadtree;
use jostle_index::shapes::{DEFAULT_CATEGORY, Each, Filter, Shapes, fill_filters};

/// The particles of a world.
#[derive(Debug, Default)]
pub struct Bodies {
    /// Those that are awake, by index.
    pub(crate) awake: Discs,
    /// The others; their indices come after those of all that are awake.
    pub(crate) asleep: Asleep,
    /// The id of each row.
    pub(crate) ids: Ids,
    /// The index of each row, once it was needed.
    indices: OnceLock<Vec<u32>>,
    /// For queries, the tree of all particles, by row, and that of those that are awake, by index. The first query
    /// that needs it after a step or an edit builds it.
    tree: OnceLock<Quadtree<f32>>,
    awake_tree: OnceLock<Quadtree<f32>>,
}

saved! { struct Bodies { awake, asleep, ids; indices, tree, awake_tree } }

impl Bodies {
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.awake.rows.len() + self.asleep.len()
    }

    /// Whether there is no particle.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A copy of all particles in the order of adding.
    pub fn particles(&self) -> Result<Particles> {
        self.particles_at(self.indices()?)
    }

    /// A copy of the particles in some rows, in this order.
    pub(crate) fn particles_in(&self, rows: &[u32]) -> Result<Particles> {
        self.particles_at(&self.indices_of(rows)?)
    }

    /// A copy of the particles at some indices, in this order.
    fn particles_at(&self, indices: &[u32]) -> Result<Particles> {
        if self.asleep.is_empty() {
            return self.awake.particles.gathered(indices);
        }
        let mut copy = Particles::default();
        copy.reserve(&self.awake.particles, indices.len())?;
        copy.reserve(&self.asleep.sleepers().discs.particles, indices.len())?;
        copy.resize(indices.len());
        for (row, &index) in indices.iter().enumerate() {
            let (all, at) = self.disc_at(index as usize);
            copy.put(indices.len(), row, all, at);
        }
        copy.drop_defaults();
        Ok(copy)
    }

    /// Centres in the order of adding.
    pub fn positions(&self) -> Result<Vec<[f32; 2]>> {
        self.column(|all, at| all.positions[at])
    }

    /// Velocities in the order of adding.
    pub fn velocities(&self) -> Result<Vec<[f32; 2]>> {
        self.column(|all, at| all.velocities[at])
    }

    /// Radii in the order of adding.
    pub fn radii(&self) -> Result<Vec<f32>> {
        self.column(|all, at| all.radii[at])
    }

    /// Masses in the order of adding.
    pub fn masses(&self) -> Result<Vec<f32>> {
        self.column(|all, at| all.masses[at])
    }

    /// Restitutions in the order of adding.
    pub fn restitution(&self) -> Result<Vec<f32>> {
        self.column(|all, at| all.restitution[at])
    }

    /// Whether each particle can be moved, in the order of adding.
    pub fn movable(&self) -> Result<Vec<bool>> {
        self.column(|all, at| all.movable[at])
    }

    /// Coefficients of friction in the order of adding.
    pub fn friction(&self) -> Result<Vec<f32>> {
        self.spins(|spin| spin.friction)
    }

    /// Angles in radians, −π to π without π, in the order of adding.
    pub fn angles(&self) -> Result<Vec<f32>> {
        self.spins(|spin| spin.rounded_angle())
    }

    /// Angular velocities in the order of adding.
    pub fn angular_velocities(&self) -> Result<Vec<f32>> {
        self.spins(|spin| spin.velocity)
    }

    /// Categories and masks in the order of adding.
    pub fn filters(&self) -> Result<Vec<Filter>> {
        self.column(|all, at| all.filter(at))
    }

    /// Whether each particle is a sensor, in the order of adding.
    pub fn sensors(&self) -> Result<Vec<bool>> {
        self.column(|all, at| all.is_sensor(at))
    }

    /// Kinds in the order of adding.
    pub fn kinds(&self) -> Result<Vec<u8>> {
        self.column(|all, at| all.kind(at))
    }

    /// Whether some particles may not touch others.
    pub(crate) fn has_filters(&self) -> bool {
        let sleepers = &self.asleep.sleepers().discs.particles;
        !self.awake.particles.filters.is_empty() || !sleepers.filters.is_empty()
    }

    /// A function that returns the category of the particle in a row.
    pub(crate) fn categories(&self) -> Result<impl Fn(u32) -> u32> {
        let indices = if self.has_filters() { self.indices()? } else { &[] };
        Ok(move |row: u32| {
            indices.get(row as usize).map_or(DEFAULT_CATEGORY, |&index| {
                let (all, at) = self.disc_at(index as usize);
                all.filter(at).category
            })
        })
    }

    /// Whether each particle is asleep, in the order of adding.
    pub fn asleep(&self) -> Result<Vec<bool>> {
        let mut asleep = memory::filled(self.len(), false)?;
        self.asleep.rows().for_each(|row| asleep[row as usize] = true);
        Ok(asleep)
    }

    fn spins(&self, of: impl Fn(Spin) -> f32) -> Result<Vec<f32>> {
        self.column(|all, at| of(all.spin(at)))
    }

    fn column<V: Copy + Default>(&self, value: impl Fn(&Particles, usize) -> V) -> Result<Vec<V>> {
        self.disc_column(|discs, at| value(&discs.particles, at))
    }

    /// A column in the order of adding, of values at the indices of the particles that are awake and of the others.
    pub(crate) fn disc_column<V: Copy + Default>(
        &self,
        value: impl Fn(&Discs, usize) -> V,
    ) -> Result<Vec<V>> {
        let mut column = memory::filled(self.len(), V::default())?;
        for (at, &row) in self.awake.rows.iter().enumerate() {
            column[row as usize] = value(&self.awake, at);
        }
        let sleepers = &self.asleep.sleepers().discs;
        for at in self.asleep.indices() {
            column[sleepers.rows[at] as usize] = value(sleepers, at);
        }
        Ok(column)
    }

    /// The columns of the particle at an index, and its row in them.
    pub(crate) fn disc_at(&self, index: usize) -> (&Particles, usize) {
        match index.checked_sub(self.awake.rows.len()) {
            None => (&self.awake.particles, index),
            Some(at) => (&self.asleep.sleepers().discs.particles, at),
        }
    }

    /// Whether the particle at an index is immovable. Those that sleep never are.
    pub(crate) fn is_immovable(&self, index: u32) -> bool {
        self.awake.particles.movable.get(index as usize) == Some(&false)
    }

    /// The sleeping islands of the particles at some indices, ascending.
    pub(crate) fn islands_of(&self, indices: &[u32]) -> Result<Vec<u32>> {
        let awake = self.awake.rows.len();
        let sleeping = indices.iter().filter_map(|&index| (index as usize).checked_sub(awake));
        self.asleep.islands_of(sleeping)
    }

    /// Keeps some indices of those that are awake.
    pub(crate) fn keep(&mut self, keep: &[bool]) {
        self.awake.particles.keep(keep);
        self.awake.particles.simplify();
        self.awake.persistent.keep(keep);
        dense::keep(&mut self.awake.rows, keep);
        self.forget_indices();
    }

    /// The indices of some rows.
    pub(crate) fn indices_of(&self, rows: &[u32]) -> Result<Vec<u32>> {
        let indices = if rows.is_empty() { &[] } else { self.indices()? };
        memory::collect(rows.iter().map(|&row| indices[row as usize]))
    }

    /// The index of each row; those of sleeping particles come after those of all others. They are
    /// computed when they are first needed, and kept until [`Bodies::forget_indices`].
    pub(crate) fn indices(&self) -> Result<&[u32]> {
        // Most steps need no index by row, so the list is made on demand.
        let indices = known_or_built(&self.indices, || self.find_indices())?;
        debug_assert!(self.are_indices(indices));
        Ok(indices)
    }

    /// Must be called when the order of the particles or their number changes.
    pub(crate) fn forget_indices(&mut self) {
        self.indices.take();
        self.forget_tree();
    }

    /// The tree of all particles, by row.
    pub(crate) fn tree(&self, settings: &WorldSettings) -> Result<&Quadtree<f32>> {
        known_or_built(&self.tree, || {
            let filters = if self.has_filters() { self.filters()? } else { Vec::new() };
            tree_of((self.positions()?, self.radii()?), filters.into_iter(), settings)
        })
    }

    /// The tree of the particles that are awake, by index.
    pub(crate) fn awake_tree(&self, settings: &WorldSettings) -> Result<&Quadtree<f32>> {
        known_or_built(&self.awake_tree, || {
            let Particles { positions, radii, filters, .. } = &self.awake.particles;
            let columns = (memory::copy(positions)?, memory::copy(radii)?);
            tree_of(columns, filters.iter().copied(), settings)
        })
    }

    /// Whether [`Bodies::tree`] is there already, or is the tree of those that are awake.
    pub(crate) fn has_tree(&self) -> bool {
        self.asleep.is_empty() || self.tree.get().is_some()
    }

    /// Must be called when a position, a radius, a filter, the period or the settings of the tree change.
    pub(crate) fn forget_tree(&mut self) {
        self.tree.take();
        self.awake_tree.take();
    }

    fn find_indices(&self) -> Result<Vec<u32>> {
        let mut indices = memory::filled(self.len(), 0)?;
        self.rows_and_indices().for_each(|(row, index)| indices[row as usize] = index);
        Ok(indices)
    }

    fn are_indices(&self, indices: &[u32]) -> bool {
        let is_right = |(row, index): (u32, u32)| indices.get(row as usize) == Some(&index);
        indices.len() == self.len() && self.rows_and_indices().all(is_right)
    }

    pub(crate) fn rows_and_indices(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        let (awake, rows) = (self.awake.rows.len(), &self.asleep.sleepers().discs.rows);
        let asleep = self.asleep.indices().map(move |at| (rows[at], (awake + at) as u32));
        self.awake.rows.iter().copied().zip(0..).chain(asleep)
    }
}

/// What `cell` has; `build` makes it if there is nothing.
pub(crate) fn known_or_built<V>(
    cell: &OnceLock<V>,
    build: impl FnOnce() -> Result<V>,
) -> Result<&V> {
    match cell.get() {
        Some(known) => Ok(known),
        None => {
            let built = build()?;
            Ok(cell.get_or_init(|| built))
        }
    }
}

/// A tree of circles, with filters if there are any.
fn tree_of(
    (positions, radii): (Vec<[f32; 2]>, Vec<f32>),
    filters: impl ExactSizeIterator<Item = Filter>,
    settings: &WorldSettings,
) -> Result<Quadtree<f32>> {
    let mut shapes = Shapes::circles(positions, Each::Rows(radii))?;
    fill_filters(filters, shapes.columns_mut().filters)?;
    Quadtree::new(&shapes.in_period(settings.container.period())?, settings.tree)
}
