//! The query methods of `Quadtree` and `Space`, with their docstrings, written once.

mod casts;
mod index;
mod near;
mod regions;

pub(crate) use casts::cast_methods;
pub use index::{CountedTree, Index};
pub(crate) use near::near_methods;
pub(crate) use regions::region_methods;

/// Implements the query methods of a class. `$with_index!(self, index => ...)` evaluates an
/// expression with the [`Index`] of an object in either precision. In the docstrings, `$name` is a
/// variable with an object, `$make` the code before the arguments of the shapes, and `$ids` and
/// `$id` are the terms for what identifies shapes.
macro_rules! query_methods {
    ($class:ident, $with_index:ident, $name:literal, $make:literal, $ids:literal, $id:literal) => {
        $crate::query_methods::region_methods!($class, $with_index, $name, $make, $ids);
        $crate::query_methods::near_methods!($class, $with_index, $name, $make, $ids, $id);
        $crate::query_methods::cast_methods!($class, $with_index, $name, $make, $id);
    };
}

pub(crate) use query_methods;
