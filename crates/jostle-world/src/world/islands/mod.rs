//! Islands: particles that touch or are tied by springs, and that fall asleep and wake together.
//!
//! An island that rests is taken out of the columns that a step works on, with its contacts and the impulses of walls
//! on it, and appended to `bodies.asleep`. Most particles of a pile then cost nothing. It returns if a step would touch
//! it, or if a change between steps concerns it. So no particle ever meets a sleeping one, and the stages of a step
//! do not depend on sleeping.
//!
//! - `motion`: how particles moved in the last quarters of a second, and which islands are slow by that.
//! - `groups`: which particles form an island, and what each rests on.
//! - `sleep`: which islands fall asleep at the end of a step, and their removal from the columns.
//! - `wake`: which sleeping islands a step would touch, and their return.
//!
//! [`Islands`] has the working memory of all four. What is kept from step to step is in the columns: the recent motion
//! of each awake particle in `Persistent`, the sleeping islands in `Asleep`.

pub(crate) mod groups;
pub(crate) mod motion;
pub(crate) mod sleep;
pub(crate) mod wake;

use groups::Rest;
use jostle_base::disjoint_sets::DisjointSets;
use jostle_base::ids::Id;
use jostle_index::pairs::JoinScratch;
use jostle_index::quadtree::Quadtree;
use jostle_index::shapes::Shapes;
use motion::IslandMotion;

/// Stands for no island.
pub(crate) const NONE: u32 = u32::MAX;

/// The islands of a step: working memory, of which nothing is kept from step to step. Within a step, `touched` lasts
/// from the attempt that lists it until these islands wake, when the attempt has been undone.
#[derive(Debug, Default)]
pub(crate) struct Islands {
    groups: DisjointSets,
    /// The squares of the mean speeds of each particle over their limits: in the previous quarter
    /// and in this one.
    squares: Vec<[f32; 2]>,
    /// The change of the mean velocity of each particle over its limit, in units of [`motion::UNIT`].
    changes: Vec<[i64; 3]>,
    /// What each particle rests on.
    rests: Vec<Rest>,
    /// The first member of the island of each particle.
    pub(crate) first: Vec<u32>,
    /// The motion of each island at the index of its first member.
    pub(crate) motions: Vec<IslandMotion>,
    /// In a distributed world, the name of each island at that index.
    pub(crate) names: Vec<Id>,
    /// For each particle that falls asleep, the first member of its island and its own index.
    pub(crate) members: Vec<[u32; 2]>,
    /// The number among the new sleeping islands of the island of each particle; [`NONE`] if it stays awake.
    pub(crate) island_of: Vec<u32>,
    /// The sleeping islands that the attempt at a step would touch.
    touched: Vec<u32>,
    join: JoinScratch,
    /// Circles around particles that have left their bounds, and their tree.
    shapes: Shapes<f32>,
    tree: Quadtree<f32>,
    /// The index of each row that contacts of waking islands name; [`NONE`] for all others.
    indices: Vec<u32>,
    /// Rows that wake, and which indices stay awake, if waking is taken back.
    woken_rows: Vec<u32>,
    keep: Vec<bool>,
}
