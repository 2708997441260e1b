//! What a tree is asked: which shapes a region overlaps, which are nearest to a
//! point, which one a ray or a thrown disc hits first.
//!
//! Every question has one exact formula for one shape, in the arithmetic of the
//! tree. Nodes and blocks of shapes are passed over by tests that may let too much
//! through and never too little; the formula decides about what is left. So the
//! answer is that of brute force. Questions are independent of each other: many
//! are answered on all threads, in their order.

mod circle;
mod nearest;
mod point;
mod polygon;
mod ray;
mod rect;
mod region;

pub use circle::Circle;
pub use nearest::{Nearest, Neighbors, distance, nearest, nearest_by};
pub use point::Point;
pub use polygon::Polygon;
pub use ray::{FirstHit, Ray, RayHits, first_hits, first_hits_by, hit};
pub use rect::Rect;
pub use region::{Hits, MOST_IDS, Region, search, selects};

use crate::error::{Error, Result};
use crate::geometry::Scalar;

/// Questions that one thread answers at a time.
const QUESTIONS: usize = 64;

/// Fewer questions than this are not worth waking other threads for.
const WORTH_WAKING: usize = 512;

/// The threads to use on `len` questions.
fn worthwhile(threads: Option<usize>, len: usize) -> Option<usize> {
    if len < WORTH_WAKING { Some(1) } else { threads }
}

/// Refuses a distance that is negative or not a number; it may be infinite.
fn check_reach<T: Scalar>(max_distance: T) -> Result<()> {
    if max_distance >= T::ZERO {
        return Ok(());
    }
    Err(Error::of("max_distance", max_distance, "it must be at least 0"))
}
