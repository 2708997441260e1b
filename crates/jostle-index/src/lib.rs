//! A quadtree over discs, boxes, line segments and those with a radius: exact pairs, contacts and queries.

#![warn(unreachable_pub)]
#![warn(clippy::disallowed_macros, clippy::disallowed_methods, clippy::disallowed_types)]

pub mod geometry;
pub mod period;
pub mod shapes;
pub mod columns;
pub mod quadtree;
pub mod pairs;
pub mod query;

pub use columns::Columns;
pub use geometry::{Bounds, Core, Scalar, Shape};
pub use period::Period;
pub use quadtree::{Node, Quadtree};
pub use shapes::{Each, Filter, Shapes};
