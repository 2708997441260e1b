//! The boundaries of a world: its container and walls, and the impulses that they give.
//!
//! [`Walls`] has the segments and a copy of the container, which belongs to the settings, with one formula for the gap,
//! the normal and the impact of both. Impulses are of two kinds. Those of bounces and of resting contacts in all
//! sub-steps are added up and reported. The *pushes* of the last sub-step, in which a resting contact has a constant
//! force, begin the first sub-step of the next step (warm starting). Both are kept in one list by row and wall.
//!
//! In a step the boundaries are a list of the walls near each particle, made once in a part of a step. Walls that
//! move are where they were at its beginning, and stages that need them later give the time ([`Clock`]).

use std::sync::OnceLock;

use super::bodies::asleep::{Sleepers, run};
use super::bodies::ids::{Ids, renumber};
use super::bodies::known_or_built;
use super::casts::tree_of_walls;
use super::search::MAX_CANDIDATES;
use super::settings::WorldSettings;
use super::totals::StepSums;
use crate::contacts::sum_of_impulses;
use crate::container::Container;
use crate::events::Bounce;
use crate::particles::Particles;
use crate::resting::{WallImpulse, WallVector};
use crate::walls::{Around, Clock, Near, Wall, Walls, index_of, number_of};
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::memory;
use jostle_index::quadtree::Quadtree;
use jostle_index::shapes::DEFAULT_CATEGORY;

/// The container, the walls and their impulses.
#[derive(Debug, Default)]
pub(crate) struct Boundaries {
    /// The walls, the container and the coefficients of its sides.
    pub(crate) walls: Walls,
    /// The id of each wall. The list of walls is in the order of adding.
    pub(crate) ids: Ids,
    /// The impulses of the last step, sorted by row and wall.
    pub(crate) impulses: Vec<WallImpulse>,
    /// In a part of a step: the walls near each particle.
    pub(crate) near: Near,
    /// The impulses of resting contacts in its sub-steps.
    resting: Vec<WallImpulse>,
    /// The same as vectors, of walls that are no sides of the container.
    pub(crate) resting_vectors: Vec<WallVector>,
    /// The pushes of the last sub-step, sorted by row and wall; in the first one those of the step before.
    pub(crate) pushes: Vec<WallImpulse>,
    /// Those of the sub-step that is computed.
    pub(crate) new_pushes: Vec<WallImpulse>,
    /// Before the attempt at a step: the walls, if any moves, and the impulses.
    walls_before: Vec<Wall>,
    impulses_before: Vec<WallImpulse>,
    /// The tree of the walls, by row, for queries; built by the first query after a step or an edit.
    wall_tree: OnceLock<Quadtree<f32>>,
}

impl Boundaries {
    /// Walls with their ids, and the impulses that they gave in the last step.
    pub(crate) fn new(walls: Walls, ids: Ids, impulses: Vec<WallImpulse>) -> Self {
        Self { walls, ids, impulses, ..Self::default() }
    }

    /// The tree of the walls where they are now, by row.
    pub(crate) fn wall_tree(&self, settings: &WorldSettings) -> Result<&Quadtree<f32>> {
        known_or_built(&self.wall_tree, || tree_of_walls(self.walls.all(), settings))
    }

    /// Must be called when a wall moves or changes, or the period or the settings of the tree.
    pub(crate) fn forget_wall_tree(&mut self) {
        self.wall_tree.take();
    }

    /// Replaces the walls in the same container. A wall that keeps its id and its ends keeps its impulses for warm
    /// starting. So a pile on it stays at rest when another wall changes.
    pub(crate) fn replace_walls(&mut self, new: Walls, ids: Ids) {
        let (old, old_ids) = (&self.walls, &self.ids);
        self.impulses.retain_mut(|impulse| {
            let Some(row) = index_of(impulse.wall) else { return true };
            let Some(now) = ids.row(old_ids.of(row)) else { return false };
            impulse.wall = number_of(now);
            old.all()[row as usize].ends == new.all()[now as usize].ends
        });
        (self.walls, self.ids) = (new, ids);
        self.forget_wall_tree();
    }

    /// The id of the wall with a number, or the code of a side of the container.
    pub(crate) fn id_of(&self, wall: u32) -> Id {
        index_of(wall).map_or_else(|| self.walls.id_of(wall), |row| self.ids.of(row))
    }

    /// The category of a wall. As for casts, that of a side is the usual one.
    pub(crate) fn category_of(&self, wall: u32) -> u32 {
        index_of(wall)
            .map_or(DEFAULT_CATEGORY, |row| self.walls.all()[row as usize].filter.category)
    }

    /// Begins an attempt at a step, which [`Boundaries::undo`] takes back.
    pub(crate) fn begin_attempt(&mut self) -> Result<()> {
        memory::reserve_len(&mut self.pushes, self.impulses.len())?;
        self.walls_before.clear();
        if self.walls.move_any() {
            memory::append(&mut self.walls_before, self.walls.all())?;
        }
        std::mem::swap(&mut self.impulses_before, &mut self.impulses);
        self.impulses.clear();
        let pushes = self.impulses_before.iter().filter(|impulse| impulse.pushes[0] > 0.0);
        self.pushes.clear();
        self.pushes.extend(pushes);
        Ok(())
    }

    /// Moves the walls to the end of a part of `dt` seconds.
    pub(crate) fn end_part(&mut self, dt: f64) {
        if self.walls.move_any() {
            self.forget_wall_tree();
            self.walls.advance(dt);
        }
    }

    /// Restores what there was before the attempt.
    pub(crate) fn undo(&mut self) {
        if !self.walls_before.is_empty() {
            self.walls.restore(std::mem::take(&mut self.walls_before));
        }
        std::mem::swap(&mut self.impulses, &mut self.impulses_before);
    }

    /// Finds the walls that may come near each particle in a part of `dt` seconds: those that overlap its bounds in
    /// `tree`, or are nearer to them than `usual`. `reaches` has how far these let it get.
    pub(crate) fn find_near(
        &mut self,
        tree: &Quadtree<f32>,
        (reaches, usual): (&[f32], f32),
        settings: &WorldSettings,
        dt: f64,
    ) -> Result<()> {
        self.walls.begin_part(settings.tree, dt)?;
        self.near.fill(&self.walls, tree, (reaches, usual), settings.method, MAX_CANDIDATES)
    }

    /// Begins the sub-steps of a part.
    pub(crate) fn begin_substeps(&mut self, may_rest: bool) {
        self.resting.clear();
        self.resting_vectors.clear();
        // Nothing will read or renew the pushes of the step before.
        if !may_rest {
            self.pushes.clear();
        }
    }

    /// The walls near each particle at a time of the part.
    pub(crate) fn around<'a>(&'a self, particles: &'a Particles, clock: Clock) -> Around<'a> {
        around(&self.walls, &self.near, particles, clock)
    }

    /// Keeps what resting contacts have found in a sub-step. The impulses of all sub-steps are reported. The pushes of
    /// the last one alone begin the next step.
    pub(crate) fn end_resting(&mut self) -> Result<()> {
        let new =
            self.new_pushes.iter().map(|impulse| WallImpulse { pushes: [0.0; 2], ..*impulse });
        memory::extend(&mut self.resting, new)?;
        std::mem::swap(&mut self.new_pushes, &mut self.pushes);
        Ok(())
    }

    /// Adds the impulses of a part: of bounces in the order of time, and of resting contacts. Adds those of resting
    /// contacts to the sums of the step, where these are on own rows; `sums` has those of bounces already.
    pub(crate) fn collect(
        &mut self,
        bounced: &[Bounce],
        rows: &[u32],
        (sums, container, own_rows): (&mut StepSums, &Container, u32),
    ) -> Result<()> {
        for of in self.resting.iter().filter(|of| of.row < own_rows) {
            sums.add_side(of.wall, of.impulses, container);
        }
        for of in self.resting_vectors.iter().filter(|of| of.row < own_rows) {
            sums.add_wall(of.wall, of.impulse.map(f64::from))?;
        }
        let bounced = bounced.iter().filter(|bounce| bounce.is_with_wall());
        let bounced = bounced.map(|bounce| WallImpulse {
            row: rows[bounce.pair[0] as usize],
            wall: bounce.code,
            impulses: bounce.impulses,
            pushes: [0.0; 2],
        });
        memory::extend(&mut self.impulses, bounced)?;
        memory::append(&mut self.impulses, &self.resting)?;
        self.resting.clear();
        self.resting_vectors.clear();
        Ok(())
    }

    /// Adds up the impulses of a step, and the pushes of its last sub-step.
    pub(crate) fn end_attempt(&mut self) -> Result<()> {
        let Self { impulses, pushes, .. } = self;
        let of_pushes = pushes.iter().map(|impulse| WallImpulse { impulses: [0.0; 2], ..*impulse });
        memory::extend(impulses, of_pushes)?;
        // Sums depend on the order, so equal numbers decide the rest.
        impulses.sort_unstable_by_key(|impulse| {
            (impulse.row, impulse.wall, impulse.impulses.map(f32::to_bits))
        });
        impulses.dedup_by(|next, sum| {
            let is_same = (next.row, next.wall) == (sum.row, sum.wall);
            if is_same {
                sum.impulses = sum_of_impulses(sum.impulses, next.impulses);
                sum.pushes = [0, 1].map(|k| sum.pushes[k] + next.pushes[k]);
            }
            is_same
        });
        impulses.retain(|impulse| impulse.impulses[0] > 0.0);
        Ok(())
    }

    /// Adds impulses of the last step on rows that had none, for which there is memory.
    pub(crate) fn insert(&mut self, new: &[WallImpulse]) {
        self.impulses.extend_from_slice(new);
        self.impulses.sort_unstable_by_key(|impulse| (impulse.row, impulse.wall));
    }

    /// Removes the impulses on some rows.
    pub(crate) fn drop_rows(&mut self, rows: &[u32]) {
        self.impulses.retain(|impulse| rows.binary_search(&impulse.row).is_err());
    }

    /// Copies the impulses on islands that fall asleep to these.
    pub(crate) fn copy_to(&self, new: &mut Sleepers) -> Result<()> {
        let mut of_rows: Vec<[u32; 2]> = memory::with_capacity(new.discs.rows.len())?;
        for (number, island) in (0..).zip(&new.islands) {
            let range = island.particles.start as usize..island.particles.end as usize;
            of_rows.extend(new.discs.rows[range].iter().map(|&row| [row, number]));
        }
        of_rows.sort_unstable();
        let impulses = self.impulses.iter().filter_map(|impulse| {
            let found = of_rows.binary_search_by_key(&impulse.row, |&[row, _]| row);
            found.ok().map(|at| (of_rows[at][1], *impulse))
        });
        // A stable order: those of an island stay sorted by rows and walls.
        let mut all = Vec::new();
        memory::extend(&mut all, impulses)?;
        let mut impulses = all;
        impulses.sort_unstable_by_key(|(island, of)| (*island, of.row, of.wall));
        let mut end = 0;
        for (number, island) in (0..).zip(&mut new.islands) {
            island.wall_impulses = run(&impulses, end, number);
            end = island.wall_impulses.end;
        }
        new.wall_impulses = memory::collect(impulses.into_iter().map(|(_, impulse)| impulse))?;
        Ok(())
    }

    /// Gives merged particles the impulses on their parts in this step; `heirs` has the new row of each. Their pushes
    /// begin with 0.
    pub(crate) fn inherit(&mut self, heirs: &[u32], has_merged: &[bool]) {
        self.pushes.retain(|impulse| !has_merged[impulse.row as usize]);
        self.impulses.iter_mut().for_each(|impulse| impulse.row = heirs[impulse.row as usize]);
    }

    /// Removes the impulses on removed rows, and gives the rest their new rows.
    pub(crate) fn renumber(&mut self, gone: &[bool], shifted: &[u32]) {
        renumber(&mut self.impulses, |impulse| &mut impulse.row, (gone, shifted));
    }

    /// Removes the pushes on removed rows, and gives the rest their new rows. Only a step that goes on needs them.
    pub(crate) fn renumber_pushes(&mut self, gone: &[bool], shifted: &[u32]) {
        renumber(&mut self.pushes, |impulse| &mut impulse.row, (gone, shifted));
    }
}

/// The walls around the particles, from borrowed columns: the others of the boundaries may be written.
pub(crate) fn around<'a>(
    walls: &'a Walls,
    near: &'a Near,
    particles: &'a Particles,
    clock: Clock,
) -> Around<'a> {
    Around { container: walls.container(), walls, near, particles, clock }
}
