//! Queries: shapes that overlap a region, nearest neighbours, neighbours within a distance, casts
//! of rays, discs and boxes.
//!
//! Every query has one exact test of a single shape, in the arithmetic of the tree. Nodes and
//! blocks of shapes are skipped by conservative tests, so the result is that of brute force.
//! Queries are independent of each other; many are processed in Morton order on all threads.

mod adjacency;
mod circle;
mod frontier;
mod images;
mod nearest;
mod overlapping;
mod point;
mod polygon;
mod ray;
mod ray_search;
mod rect;
mod region;
mod window;

pub use adjacency::{neighbors, neighbors_of_pairs};
pub use circle::Circle;
pub use images::Images;
pub use nearest::{
    Nearest, Neighbors, check_nearest, distance, distance_in, nearest, nearest_from,
};
pub use overlapping::each_overlap;
pub use point::Point;
pub use polygon::Polygon;
pub use ray::{Ray, hit, normal};
pub use ray_search::{
    AllHits, FirstHit, RayContact, RayHits, RayPath, all_hits, all_hits_by, first_hits,
    first_hits_by,
};
pub use rect::Rect;
pub use region::{Hits, MAX_IDS, Region, search, search_here, selects};
pub use window::Window;

use crate::geometry::Scalar;
use jostle_base::error::{Error, Result};
use jostle_base::interrupt;
use jostle_base::memory;
use jostle_base::morton;
use jostle_base::parallel;
use jostle_base::sorting;

/// Returns the id of the shape at an index of a tree, or None to ignore the shape. A trait object,
/// so that searches are compiled once; calls are rare.
pub type IdOf<'a> = dyn Fn(usize) -> Option<u64> + 'a;

/// Number of queries of a task.
const QUERIES_PER_TASK: usize = 128;

/// Minimum number of queries for which threads that are awake are used.
const WORTH_SHARING: usize = 512;

/// Minimum number of queries for which threads are woken.
const WORTH_WAKING: usize = 4096;

/// Approximate number of values read to test a node.
const NODE_WORK: usize = 16;

/// The order in which to process queries at some positions: approximately Morton order, so that
/// consecutive queries read the same nodes, which are then in the cache.
fn morton_order<T: Scalar>(
    positions: impl ExactSizeIterator<Item = [T; 2]> + Clone,
) -> Result<Vec<u32>> {
    let len = positions.len();
    if len <= QUERIES_PER_TASK {
        return memory::collect(0..len as u32);
    }
    let (mut min, mut max) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for position in positions.clone() {
        for axis in 0..2 {
            min[axis] = min[axis].min(position[axis].to_f64());
            max[axis] = max[axis].max(position[axis].to_f64());
        }
    }
    // Infinite if all positions agree along an axis. Then 0 · ∞ is NaN below, and the cast makes 0
    // of it.
    let scale = [0, 1].map(|axis| 65535.0 / (max[axis] - min[axis]));
    let key = |position: [T; 2]| {
        let along = [0, 1].map(|axis| (position[axis].to_f64() - min[axis]) * scale[axis]);
        let [x, y] = along.map(|along| u32::from(along as u16));
        morton::key(x, y)
    };
    let keys: Vec<u32> = memory::collect(positions.map(key))?;
    interrupt::check()?;
    // The order of queries in one of these cells does not matter, so the leading bits suffice.
    // More cells than queries, so that a cell has about one. The counters of 2¹⁶ cells are a
    // quarter of a mebibyte, about what the second-level cache has free.
    let bits = (len.ilog2() + 2).clamp(MIN_BITS, MAX_BITS);
    let mut order = memory::zeroed(len)?;
    let queries = (0..).zip(&keys);
    let cell_of = |&(_, key): &(u32, &u32)| (key >> (32 - bits)) as usize;
    let mut ends = vec![0; 1 << bits];
    sorting::counting_sort(queries, cell_of, |(query, _)| query, &mut ends, &mut order);
    Ok(order)
}

/// The grid has at least four times as many cells as there are queries. Its number of cells is a
/// power of two; these are the smallest and the largest exponent.
const MIN_BITS: u32 = 8;
const MAX_BITS: u32 = 16;

/// The number of threads for `len` queries.
fn worthwhile(threads: Option<usize>, len: usize) -> Option<usize> {
    // A query takes half a microsecond to two (docs/benchmarks-notes.md): 512 take up to a
    // millisecond, 4,096 several. That is far above what a thread costs, so that short queries
    // gain, too. Calls of these sizes with one thread and with two measure it.
    parallel::threads_for(threads, len, WORTH_SHARING, WORTH_WAKING)
}

fn is_positive_or_zero<T: Scalar>(distance: T) -> bool {
    distance >= T::ZERO
}

/// Refuses distances that are negative or NaN; they may be infinite.
fn check_max_distances<T: Scalar>(max_distances: &[T]) -> Result<()> {
    match max_distances.iter().position(|distance| !is_positive_or_zero(*distance)) {
        None => Ok(()),
        Some(index) => {
            Err(Error::at("max_distance", index, max_distances[index], "it must be at least 0"))
        }
    }
}
