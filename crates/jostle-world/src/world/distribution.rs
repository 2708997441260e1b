//! How a world is distributed over processes.
//!
//! A [`World`] reads from its [`Distribution`] what all processes have in common, and calls its [`Protocol`]
//! at some points of a step and of edits: to exchange particles, compare, repeat. What one process does instead is in
//! [`alone`](super::alone). Neither trait has a default for an exchange, so that `ranks` has each.

use std::any::Any;

use super::bodies::asleep::Sleepers;
use super::bodies::discs::Discs;
use super::bodies::ids::Ids;
use super::record::Touched;
use super::{World, WorldSettings};
use crate::contacts::{Contact, ContactShape};
use crate::halo::Halo;
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_index::pairs::JoinScratch;
use jostle_index::quadtree::Quadtree;

/// What the processes have computed for the particles that they share, compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Agreement {
    Same,
    /// A particle has left the circle that its process announced.
    Further,
    Different,
}

/// What the particles of all processes require.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Agreed {
    /// Whether all collisions keep the energy.
    pub(crate) is_lossless: bool,
    pub(crate) has_friction: bool,
    pub(crate) any_sleeps: bool,
}

/// The part of a world that this process has.
pub(crate) trait Distribution: Halo + Any + Send {
    /// What the processes do together.
    fn protocol(&self) -> &'static dyn Protocol;

    /// Whether this process has the whole world by itself, with its rows in the order of adding. False
    /// for a distributed world of one process: it is alone, but its rows and ids are those of a part.
    fn is_whole(&self) -> bool;

    /// Rows below this number are own ones; ghosts are in the rows from it on. `u32::MAX` if there are
    /// no ghosts.
    fn own_rows(&self) -> u32;

    /// The id of each row among the particles of all processes; empty if the world knows them.
    fn ids(&self) -> &[Id];

    /// The id of a row among the particles of all processes.
    fn id_among_all(&self, ids: &Ids, row: u32) -> Id {
        if self.is_whole() { ids.of(row) } else { self.ids()[row as usize] }
    }

    /// Two rows with these categories that touched; none of two ghosts, which their own processes report.
    fn known_pair(&self, ids: &Ids, rows: [u32; 2], categories: [u32; 2]) -> Option<Touched> {
        let is_known = rows.iter().any(|&row| row < self.own_rows());
        let pair = rows.map(|row| self.id_among_all(ids, row));
        is_known.then(|| Touched::ascending(pair, categories))
    }

    /// What the particles of all processes require; None if it is what the own ones require.
    fn agreed(&self) -> Option<Agreed>;

    /// The AABB of the centres of all processes, if the exchange of ghosts has found it. It is returned
    /// once.
    fn take_extent(&mut self) -> Option<[[f32; 2]; 2]>;

    /// Tells the others that this process has failed, so that their next call returns an error.
    fn fail(&self);

    /// Chooses domains anew in the next step.
    fn forget_domains(&mut self);

    /// Finds the islands of other processes that overlap the circles of a tree. `radius` gives the
    /// radius of each circle; None leaves it out. Returns whether there are any.
    fn touch_others(
        &mut self,
        circles: &Quadtree<f32>,
        radius: &dyn Fn(u32) -> Option<f32>,
        settings: &WorldSettings,
        scratch: &mut JoinScratch,
    ) -> Result<bool>;

    /// Keeps the contacts of islands that fall asleep, which are still `awake`, each with the number of its island. Returns
    /// false if the world has to keep them.
    fn keep_contacts(
        &mut self,
        sleepers: &Sleepers,
        contacts: &[(u32, Contact)],
        awake: &Discs,
    ) -> Result<bool>;
}

/// What the processes do together with the whole world, of which their distribution is a part.
pub(crate) trait Protocol: Sync {
    /// Makes a step. If it fails on this process, the others learn of it.
    fn guard(
        &self,
        world: &mut World,
        step: &mut dyn FnMut(&mut World) -> Result<()>,
    ) -> Result<()>;

    /// Removes the ghosts of the last step.
    fn begin_step(&self, world: &mut World);

    /// Moves particles to the processes of their domains. Returns false if nothing can move. The step
    /// is complete then.
    fn migrate(&self, world: &mut World) -> Result<bool>;

    /// Gets the ghosts that an attempt at a step of `dt` seconds needs.
    fn gather(&self, world: &mut World, dt: f32) -> Result<()>;

    /// Gets the ghosts that a part of a step needs, if the present ones are only those near by.
    fn renew(&self, world: &mut World, dt: f32) -> Result<()>;

    /// Lists the particles with which a part of a step begins, in their order.
    fn begin_part(&self, world: &mut World);

    /// Gives ghosts the accelerations that their own processes have computed.
    fn share_accelerations(&self, world: &mut World) -> Result<()>;

    /// What the order of solving contacts depends on, and the refinement of the sub-steps, on all
    /// processes.
    fn agree_on_order(
        &self,
        world: &mut World,
        own: ContactShape,
        refinement: usize,
    ) -> Result<(ContactShape, usize)>;

    /// Limits the displacements of own particles to the circles that other processes know.
    fn limit(&self, world: &mut World) -> Result<()>;

    /// Records what happened to shared particles in a part of a step.
    fn end_part(&self, world: &mut World);

    /// Merges each island of pairs of indices that touch; returns whether any merged.
    fn merge_islands(&self, world: &mut World, touching: &[[u32; 2]]) -> Result<bool>;

    /// Gets the ghosts near the present positions of own particles.
    fn gather_near(&self, world: &mut World) -> Result<()>;

    /// Compares what the processes have computed in an attempt at a step, which may have ended early because it
    /// `meets_sleepers`; if particles merge, in a part, before they do.
    fn compare(&self, world: &mut World, meets_sleepers: bool) -> Result<Agreement>;

    /// Makes a step final that is the same on all processes.
    fn end_step(&self, world: &mut World);

    /// Removes what an attempt at a step has exchanged, after the world is as it was before.
    fn undo(&self, world: &mut World);

    /// Prepares the next attempt at a step of `dt` seconds on which the processes did not agree.
    fn widen(&self, world: &mut World, agreement: Agreement, dt: f64) -> Result<()>;

    /// Removes what a step that failed has exchanged.
    fn give_up(&self, world: &mut World);

    /// Wakes the islands that an attempt at a step would touch, or all.
    fn wake_touched(&self, world: &mut World, touched: &[u32], all: bool) -> Result<()>;

    /// Wakes the islands that changes concern: `driven` are rows of immovable particles of which only
    /// the velocities change, `changed` those of other changes.
    fn wake_edited(&self, world: &mut World, driven: &mut [u32], changed: &[u32]) -> Result<()>;

    /// Adds the contacts of islands that wake to those of the last step.
    fn recall_contacts(&self, world: &mut World, islands: &[u32]) -> Result<()>;

    /// Removes the contacts of islands that no longer sleep.
    fn drop_contacts(&self, world: &mut World);

    /// Names the islands, and adds up the motion of their members on all processes.
    fn join_islands(&self, world: &mut World) -> Result<()>;

    /// Keeps the touching pairs of islands that fall asleep.
    fn keep_pairs(&self, world: &mut World) -> Result<()>;

    /// The pairs of sleeping particles that touch.
    fn touching_asleep(&self, world: &World) -> Result<Vec<Touched>>;
}
