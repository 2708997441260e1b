//! Shapes with ids that are added, moved, changed and removed, and the events of their pairs.
//!
//! `slots` holds the shapes, `rows` the order of adding, `layers` the trees over them. `touching` holds the pairs of the last
//! update: if many change, as a sorted list of `keys`, if few change, as `links`. `events` compares
//! them with the current pairs, only for the shapes in `changes`; `swept` adds the pairs that met on the way from their
//! `starts`, by the test in `crossing`. `walking` moves shapes that slide
//! along others: `walks` computes their motions, `floors` has what they stand on,
//! `traces` where obstacles were before they moved. Those that may meet form `islands`, and in an
//! island a `spatial_hash` of `cells` finds them.
//!
//! The modules are listed in reading order: each uses only those above it.

#![warn(unreachable_pub)]
#![warn(clippy::disallowed_macros, clippy::disallowed_methods, clippy::disallowed_types)]

mod saved;
mod slots;
mod rows;
mod layers;
mod keys;
mod links;
mod touching;
mod changes;
mod floors;
mod traces;
mod starts;
mod crossing;
mod space;
mod queries;
mod pairs;
mod swept;
mod events;
mod saving;
mod cells;
mod spatial_hash;
mod islands;
mod stacks;
mod slide_call;
mod motions;
mod walks;
mod walking;

pub use events::{Events, WithCategories, between};
pub use pairs::Wanted;
pub use saved::Saved;
pub use space::{ShapeChanges, Space};
pub use walking::Slides;
