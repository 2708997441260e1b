//! The world: particles that move and collide.
//!
//! A [`World`] composes parts. Each owns its data, and its functions take it and slices of others:
//!
//! - [`bodies`]: the columns of the particles, awake and asleep, their ids, rows and indices.
//! - [`boundaries`]: the container and the walls, and the impulses that they give.
//! - `influences`: forces and what else acts on particles; [`external`]: accelerations that the caller computes.
//! - `contacts`: the contacts of the last step, with their impulses for warm starting, and the solver.
//! - [`islands`]: particles that touch, which fall asleep and wake together.
//! - [`record`]: what happened: sums over steps ([`totals`]), and pairs that began and ceased to touch.
//! - [`snapshot`]: the whole world in bytes.
//! - [`queries`] of particles, [`wall_queries`], and what [`casts`] hit of walls and of the container.
//! - [`distribution`]: the processes that share the world.
//!
//! [`step`] has the order of a step, [`substeps`] that of a sub-step, and [`plan`] what the stages do; their files are
//! named after them. [`StepScratch`] is the working memory of a step. [`undo`] restores what there was before it. The
//! modules are listed in reading order: each uses only those above it, and the [`World`].

pub(crate) mod settings;
pub(crate) mod search;
pub(crate) mod bodies;
pub(crate) mod casts;
pub(crate) mod boundaries;
pub(crate) mod reductions;
pub(crate) mod distribution;
pub(crate) mod external;
pub(crate) mod torques;
pub(crate) mod displacements;
pub(crate) mod drive;
pub(crate) mod pumps;
pub(crate) mod force_step;
pub(crate) mod plan;
pub(crate) mod reach;
pub(crate) mod renewal;
pub(crate) mod bounds;
pub(crate) mod islands;
pub(crate) mod edits;
pub(crate) mod wall_edits;
pub(crate) mod totals;
pub(crate) mod record;
pub(crate) mod merge;
pub(crate) mod refinement;
pub(crate) mod contacts;
pub(crate) mod touching;
pub(crate) mod touches;
pub(crate) mod undo;
pub(crate) mod reorder;
pub(crate) mod store;
pub(crate) mod turns;
mod free_positions;
mod net_forces;
mod impulses;
pub(crate) mod sums;
pub(crate) mod stage_hash;
pub(crate) mod substeps;
pub(crate) mod step;
pub(crate) mod snapshot;
pub(crate) mod queries;
pub(crate) mod wall_queries;
pub(crate) mod alone;

use crate::contacts::{ContactShape, Contacts};
use crate::correction::Correction;
use crate::events::Events;
use crate::flow::Kick;
use crate::forces::{Influence, Influences, WallTemperatures};
use crate::motion::{Motions, Spins};
use crate::particles::Particles;
use crate::resting::Resting;
use crate::walls::Walls;
pub use bodies::Bodies;
use bodies::discs::Discs;
use boundaries::Boundaries;
pub use casts::Casts;
use distribution::{Agreement, Distribution};
use drive::check_motors;
use external::External;
use force_step::ForceScratch;
pub use free_positions::NewDiscs;
use islands::Islands;
use islands::wake::wake_all;
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::memory;
use jostle_index::quadtree::Quadtree;
use jostle_index::shapes::Shapes;
use plan::start_threads;
pub use record::{Record, TouchEvents, Touched};
pub use settings::{DEFAULT_SUBSTEPS, OnTouch, WorldSettings};
pub use sums::StateHash;
use torques::Torques;
pub use totals::{Collisions, Totals};
pub use touches::{Touch, WallTouch};
use undo::Before;

/// The stages of a step, in the order of the data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// The forces, before the other stages and in each sub-step; only if there are forces.
    Forces,
    /// The bounds of every particle.
    Bounds,
    /// The tree of the bounds.
    Build,
    /// The candidate pairs.
    Pairs,
    /// The particles in the order of the tree, their neighbours, and the contacts, coloured.
    Contacts,
    /// The impulses of resting contacts, in each sub-step; only if particles may rest.
    Resting,
    /// The flights and collisions in the order of time, in each sub-step.
    Events,
    /// The position correction, in each sub-step.
    Correction,
    /// The new state, and what touched.
    Store,
}

impl Stage {
    /// All stages with their names, in the order of the data.
    pub const ALL: [(Self, &str); 9] = [
        (Self::Forces, "forces"),
        (Self::Bounds, "bounds"),
        (Self::Build, "build"),
        (Self::Pairs, "pairs"),
        (Self::Contacts, "contacts"),
        (Self::Resting, "resting"),
        (Self::Events, "events"),
        (Self::Correction, "correction"),
        (Self::Store, "store"),
    ];
}

/// A callback that is called when a stage of a step ends, to time it. The world has not completed the step.
pub type Watch<'a> = dyn FnMut(Stage, &World) + Send + 'a;

/// The search of the last step, its sub-steps and its unresolved particles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// Nodes of the tree.
    pub nodes: usize,
    /// Nodes without children.
    pub leaves: usize,
    /// Subdivisions above the deepest node.
    pub depth: usize,
    /// Pairs tested.
    pub tests: u64,
    /// Particles that had too many collisions in a part of the step, and then stayed with what
    /// pressed them.
    pub unresolved: u64,
    /// Sub-steps of all parts of the step.
    pub substeps: usize,
    /// Times that the collisions of a particle became elastic in a part of the step, because it had
    /// many (inelastic collapse).
    pub collapsed: u64,
}

/// Particles, their settings and forces.
///
/// ```
/// use jostle_world::{Particles, World, WorldSettings};
/// let (left, right) = ([-2.0, 0.0], [2.0, 0.0]);
/// let discs = Particles::new(vec![left, right], vec![[1.0, 0.0], [0.0, 0.0]], vec![1.0; 2], 1.0);
/// let mut world = World::new(discs, WorldSettings::default())?;
/// world.step(0.1, 40)?;
/// assert_eq!(world.bodies().particles()?.velocities, [[0.0, 0.0], [1.0, 0.0]]); // they swapped
/// # Ok::<(), jostle_base::Error>(())
/// ```
#[derive(Debug, Default)]
pub struct World {
    pub(crate) settings: WorldSettings,
    /// Forces, springs, motors and thermostats. They refer to particles by rows.
    pub(crate) influences: Influences,
    /// The container and the walls, and the impulses that they gave.
    pub(crate) boundaries: Boundaries,
    /// Accelerations that the caller computes.
    pub(crate) external: External,
    /// The particles.
    pub(crate) bodies: Bodies,
    pub(crate) contacts: Contacts,
    pub(crate) time: f64,
    /// Text of the caller, see [`World::attachment`].
    pub(crate) attachment: Option<String>,
    pub(crate) stats: Stats,
    /// What happened since the last call of [`World::begin_record`].
    pub(crate) record: Record,
    /// The part of the world that this process has.
    pub(crate) halo: Box<dyn Distribution>,
    /// Which particles belong together; working memory.
    pub(crate) islands: Islands,
    pub(crate) scratch: StepScratch,
}

/// Scratch of a step.
#[derive(Debug, Default)]
pub(crate) struct StepScratch {
    /// How far each particle may get from where a part begins before it leaves its bounds.
    pub(crate) reaches: Vec<f32>,
    pub(crate) old_reaches: Vec<f32>,
    /// Smaller ones: a particle beyond its own may touch a sleeping island, or leave the circle that other processes
    /// have for it. Empty if there are neither.
    pub(crate) watched_reaches: Vec<f32>,
    pub(crate) grown: bounds::Grown,
    /// Rows that were exhausted in the step.
    pub(crate) exhausted: Vec<u32>,
    pub(crate) touching: touching::Scratch,
    pub(crate) events: Events,
    pub(crate) shapes: Shapes<f32>,
    pub(crate) tree: Quadtree<f32>,
    pub(crate) motions: Motions,
    pub(crate) spins: Spins,
    pub(crate) resting: Resting,
    pub(crate) correction: Correction,
    pub(crate) listing: search::ListScratch,
    pub(crate) contact_shape: ContactShape,
    /// The candidate pairs.
    pub(crate) pairs: search::Lists,
    /// Those of pairs that pass through each other, if it matters whether they touch.
    pub(crate) sensed: search::Lists,
    /// Those of which contacts are made.
    pub(crate) contact_pairs: search::Lists,
    pub(crate) contact_pair_parts: Vec<Vec<[u32; 2]>>,
    /// How far from its surface each particle may rest in the step.
    pub(crate) rest_distances: Vec<f32>,
    /// Which particles lose energy, or may touch one that does, of a world in which some do and
    /// others do not; else empty.
    pub(crate) lossy: Vec<bool>,
    pub(crate) horizon: renewal::Horizon,
    pub(crate) renewed: renewal::Renewed,
    /// The candidate pairs of a world whose particles merge.
    pub(crate) candidate_merges: Vec<merge::CandidateMerge>,
    /// Of a distributed one: the particles at the beginning of a part of the step, by indices.
    pub(crate) starts: Particles,
    pub(crate) kicks: Vec<Kick>,
    pub(crate) wall_temperatures: WallTemperatures,
    pub(crate) forces: ForceScratch,
    pub(crate) torques: Torques,
    pub(crate) before: Before,
    /// Columns to reorder into, for all parts of a step but the first.
    pub(crate) spare: Discs,
}

impl World {
    /// A world of `particles`. Refuses invalid particles and settings.
    pub fn new(particles: Particles, settings: WorldSettings) -> Result<Self> {
        let mut world = Self::default();
        world.configure(settings)?;
        world.add(particles)?;
        Ok(world)
    }

    /// The particles: their columns, in the order of adding, and their ids.
    pub fn bodies(&self) -> &Bodies {
        &self.bodies
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    /// Whether there is no particle.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// The settings.
    pub fn settings(&self) -> &WorldSettings {
        &self.settings
    }

    /// Changes the settings. If they are refused, the old ones stay. All particles wake, unless only
    /// settings without influence on the results change.
    pub fn configure(&mut self, settings: WorldSettings) -> Result<()> {
        // All that may be refused comes first, also the walls, whose tree may fail.
        settings.validate()?;
        settings.container.check_fit(&self.bodies.radii()?)?;
        self.influences.check_fit(settings.container)?;
        let new_walls = if settings.container == self.settings.container {
            None
        } else {
            self.influences.check_sides(settings.container)?;
            let walls = memory::copy(self.walls())?;
            Some(Walls::new(walls, settings.container, settings.tree)?)
        };
        // The method, the tree and the tracking of events change no result, so nothing wakes for
        // them.
        let WorldSettings { method, tree, track_events, .. } = settings;
        if settings != (WorldSettings { method, tree, track_events, ..self.settings }) {
            wake_all(self)?;
            self.bodies.awake.persistent.recent_motions.clear();
        }
        if settings.container.period() != self.settings.container.period() {
            self.bodies.awake.persistent.turns.clear();
        }
        if let Some(walls) = new_walls {
            self.boundaries.walls = walls;
            // The numbers of sides have another meaning in another container, and the scales of
            // domains have the period of the old one.
            self.boundaries.impulses.clear();
            self.halo.forget_domains();
        }
        if track_events != self.settings.track_events {
            self.record.forget_pairs();
        }
        self.settings = settings;
        self.bodies.forget_tree();
        self.boundaries.forget_wall_tree();
        self.boundaries.walls.set_sides(settings.present_sides());
        start_threads(self);
        Ok(())
    }

    /// The forces and all else that acts on particles, as given to [`World::set_forces`].
    pub fn forces(&self) -> Result<Vec<Influence>> {
        let mut influences = Influences::default();
        influences.copy_from(&self.influences)?;
        influences.renumber(|row| Some(self.bodies.ids.of(row as u32)));
        Ok(influences.into_list())
    }

    /// Whether there are any.
    pub fn has_forces(&self) -> bool {
        !self.influences.is_empty()
    }

    /// Changes the forces and all else that acts on particles. If they are refused, the old ones stay. All
    /// particles wake; if only grabs change, those that are grabbed.
    pub fn set_forces(&mut self, forces: Vec<Influence>) -> Result<()> {
        let mut influences = Influences::from(forces);
        influences.check_kinds(&self.bodies.kinds()?)?;
        influences.validate(|id| self.bodies.contains(id))?;
        influences.check_fit(self.settings.container)?;
        influences.check_sides(self.settings.container)?;
        influences.check_walls(|id| self.has_wall(id))?;
        check_motors(&influences, &self.bodies)?;
        influences.renumber(|id| self.bodies.ids.row(id).map(Id::from));
        if influences == self.influences {
            return Ok(());
        }
        if influences.differ_by_grabs(&self.influences) {
            let mut rows = Vec::new();
            memory::extend(&mut rows, influences.grabbed().map(|row| row as u32))?;
            self.halo.protocol().wake_edited(self, &mut [], &rows)?;
        } else {
            wake_all(self)?;
            self.bodies.awake.persistent.recent_motions.clear();
        }
        self.influences = influences;
        Ok(())
    }

    /// Simulated seconds.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Text that the world keeps and does not read, in snapshots too: programs keep their own settings there, as
    /// JSON. The state does not depend on it.
    pub fn attachment(&self) -> Option<&str> {
        self.attachment.as_deref()
    }

    /// Replaces that text.
    pub fn set_attachment(&mut self, text: Option<String>) {
        self.attachment = text;
    }

    /// Numbers of the last step.
    pub fn stats(&self) -> Stats {
        self.stats
    }

    /// The present id of each id that was given, if particles merged since the record began: merged particles share the
    /// smallest of their ids. None stands for an id that no particle has; None in place of all if
    /// nothing merged. An error if more than 2²⁷ ids were given, or there is no memory for them.
    pub fn renumbered(&self) -> Result<Option<Vec<Option<Id>>>> {
        self.record.merged().map(|merged| self.bodies.renumbered(merged)).transpose()
    }
}
