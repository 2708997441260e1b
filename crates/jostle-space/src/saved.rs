//! The contents of a space as plain columns, from which the same space can be made again.

use jostle_base::ids::Id;
use jostle_index::geometry::Core;

/// The columns of a space, with a row for each slot, and the state of its last update.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Saved<T> {
    /// Min x, min y, max x, max y; both corners are the centre unless a shape is given as a box.
    pub corners: Vec<[T; 4]>,
    /// Radii.
    pub radii: Vec<T>,
    /// Half sizes; empty if there are none.
    pub half_sizes: Vec<[T; 2]>,
    /// What each core is within its corners; empty if all are boxes.
    pub cores: Vec<Core>,
    /// Categories and masks; empty if there are none.
    pub filters: Vec<[u32; 2]>,
    /// The generation of each slot, with a bit for vacant ones.
    pub generations: Vec<u32>,
    /// Slots to be used again, the last one first.
    pub free: Vec<u32>,
    /// The ids of all shapes, in the order of adding.
    pub ids: Vec<Id>,
    /// Pairs of slots at the last update.
    pub pairs: Vec<[u32; 2]>,
    /// Slots that have changed since.
    pub changed: Vec<u32>,
    /// Slots that have been removed since.
    pub leaving: Vec<u32>,
    /// Slots whose shapes have moved since, and maybe some that have not.
    pub moved_since: Vec<u32>,
    /// The centre of each of these at the last update.
    pub starts: Vec<[T; 2]>,
    /// Number of updates.
    pub updates: u64,
    /// For each shape that stood on another one after its last motion, the ids of both.
    pub rides: Vec<[Id; 2]>,
    /// The centre of the lower shape of each of these at that time.
    pub ride_centers: Vec<[T; 2]>,
    /// The number of the next call of `move_and_slide`.
    pub calls: i64,
    /// For each slot the call since which its shape meets the motions of obstacles; missing numbers
    /// are 0.
    pub slid: Vec<i64>,
    /// For each slot the call since which its shape has moved; missing numbers are 0.
    pub moved: Vec<i64>,
    /// The centre before each of these motions.
    pub before: Vec<[T; 2]>,
}
