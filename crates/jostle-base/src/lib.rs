//! Errors, threads, interruption, sorting, memory and tables of columns, for the other crates of jostle.

#![warn(unreachable_pub)]
#![warn(clippy::disallowed_macros, clippy::disallowed_methods, clippy::disallowed_types)]

pub mod error;
pub mod memory;
pub mod bytes;
pub mod cache;
pub mod interrupt;
pub mod sorting;
pub mod ids;
pub mod settings;
pub mod morton;
pub mod parallel;
pub mod table;
pub mod disjoint_sets;

pub use error::{Error, Result};
pub use ids::Id;
pub use settings::{Method, Settings};
