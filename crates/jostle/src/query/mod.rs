//! What a tree is asked: which shapes a region overlaps, which are nearest to a
//! point, which one a ray or a thrown disc hits first.
//!
//! Every question has one exact formula for one shape, in the arithmetic of the
//! tree. Nodes and blocks of shapes are passed over by tests that may let too much
//! through and never too little; the formula decides about what is left. So the
//! answer is that of brute force. Questions are independent of each other: many
//! are answered on all threads, in their order.

mod circle;
mod frontier;
mod nearest;
mod overlapping;
mod point;
mod polygon;
mod ray;
mod rect;
mod region;
mod window;

pub use circle::Circle;
pub use nearest::{Nearest, Neighbors, check_nearest, distance, nearest, nearest_by};
pub use overlapping::each_overlap;
pub use point::Point;
pub use polygon::Polygon;
pub use ray::{FirstHit, Ray, RayHits, first_hits, first_hits_by, hit};
pub use rect::Rect;
pub use region::{Hits, MOST_IDS, Region, search, selects};

use crate::error::{Error, Result};
use crate::geometry::Scalar;
use crate::interrupt;
use crate::memory;
use crate::parallel;

/// Names the shape in a place of a tree, or hides it. Only few shapes are asked for, so the searches do
/// not depend on its type and are compiled once.
pub type IdOf<'a> = dyn Fn(usize) -> Option<u64> + 'a;

/// Questions that one thread answers at a time.
const QUESTIONS: usize = 128;

/// Fewer questions than this are not worth sharing with other threads.
const WORTH_SHARING: usize = 512;

/// Fewer questions than this are not worth waking other threads for.
const WORTH_WAKING: usize = 4096;

/// About as many numbers are read when a search looks at a node.
const NODE_WORK: usize = 16;

/// The order in which to take questions about these places: along a curve that keeps
/// neighbours together, so that one finds in the cache what the one before it has seen.
fn along_a_curve<T: Scalar>(
    places: impl ExactSizeIterator<Item = [T; 2]> + Clone,
) -> Result<Vec<u32>> {
    let len = places.len();
    let mut order: Vec<u32> = memory::collect(0..len as u32)?;
    if len <= QUESTIONS {
        return Ok(order);
    }
    let (mut min, mut max) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for place in places.clone() {
        for axis in 0..2 {
            min[axis] = min[axis].min(place[axis].to_f64());
            max[axis] = max[axis].max(place[axis].to_f64());
        }
    }
    let scale = [0, 1].map(|axis| 65535.0 / (max[axis] - min[axis]));
    let cell = |place: [T; 2], axis: usize| {
        spread(((place[axis].to_f64() - min[axis]) * scale[axis]) as u16)
    };
    let keys: Vec<u32> = memory::collect(places.map(|place| cell(place, 0) | cell(place, 1) << 1))?;
    interrupt::check()?;
    // Counting is enough: within one of so many cells the order does not matter.
    let bits = (len.ilog2() + 2).clamp(LEAST_BITS, MOST_BITS);
    let mut starts = vec![0u32; (1 << bits) + 1];
    keys.iter().for_each(|&key| starts[(key >> (32 - bits)) as usize + 1] += 1);
    for cell in 1..starts.len() {
        starts[cell] += starts[cell - 1];
    }
    for (question, &key) in keys.iter().enumerate() {
        let start = &mut starts[(key >> (32 - bits)) as usize];
        order[*start as usize] = question as u32;
        *start += 1;
    }
    Ok(order)
}

/// The curve has four times as many cells as there are queries, but at least and at most the
/// powers of two with these exponents.
const LEAST_BITS: u32 = 8;
const MOST_BITS: u32 = 16;

/// The bits of a number, every second place left free.
fn spread(number: u16) -> u32 {
    let mut bits = u32::from(number);
    for (shift, mask) in [(8, 0x00ff_00ff), (4, 0x0f0f_0f0f), (2, 0x3333_3333), (1, 0x5555_5555)] {
        bits = (bits | bits << shift) & mask;
    }
    bits
}

/// The threads to use on `len` questions.
fn worthwhile(threads: Option<usize>, len: usize) -> Option<usize> {
    parallel::threads_for(threads, len, WORTH_SHARING, WORTH_WAKING)
}

/// Refuses a distance that is negative or not a number; it may be infinite.
fn check_reach<T: Scalar>(max_distance: T) -> Result<()> {
    if max_distance >= T::ZERO {
        return Ok(());
    }
    Err(Error::of("max_distance", max_distance, "it must be at least 0"))
}
