//! The query methods of `Quadtree`, `Space` and `World`, with their docstrings, written once.

mod casts;
mod index;
mod near;
mod regions;

pub(crate) use casts::cast_methods;
pub use index::{Casts, CountedTree, Index, NeighborIndex};
pub(crate) use near::{near_methods, neighbor_methods};
pub(crate) use regions::region_methods;

/// Implements the query methods of a class. `$with_index!(self, index => ...)` evaluates an
/// expression with the [`Index`] of an object in either precision.
macro_rules! query_methods {
    ($class:ident, $with_index:ident) => {
        $crate::query_methods::region_methods!($class, $with_index);
        $crate::query_methods::near_methods!($class, $with_index);
        $crate::query_methods::neighbor_methods!($class, $with_index);
        $crate::query_methods::cast_methods!($class, $with_index);
    };
}

pub(crate) use query_methods;
