//! jostle: 2D collision detection (broad phase, narrow phase, queries) and the simulation of
//! discs that collide.
//!
//! The modules are in reading order: each uses only those above it.

#![warn(clippy::disallowed_macros, clippy::disallowed_methods, clippy::disallowed_types)]

pub mod error;
pub mod memory;
pub mod bytes;
pub mod cache;
pub mod interrupt;
pub mod sorting;
pub mod settings;
pub mod morton;
pub mod simd;
pub mod geometry;
pub mod period;
pub mod shapes;
pub mod parallel;
pub mod table;
pub mod columns;
pub mod quadtree;
pub mod pairs;
pub mod query;
pub mod separate;
pub mod slide;
pub mod disjoint_sets;
pub mod space;
pub mod particles;
pub mod motion;
pub mod flow;
pub mod roots;
pub mod trajectory;
pub mod tolerance;
pub mod container;
pub mod walls;
pub mod forces;
pub mod halo;
pub mod events;
pub mod contacts;
pub mod resting;
pub mod correction;
pub mod world;
pub mod ranks;
pub mod scenes;

pub use columns::Columns;
pub use container::Container;
pub use error::{Error, Result};
pub use forces::Force;
pub use geometry::{Bounds, Scalar, Shape};
pub use particles::{Changes, Particles, Spin};
pub use period::Period;
pub use quadtree::{Node, Quadtree};
pub use ranks::{Communicator, OwnParticles, Traffic};
pub use separate::{Separated, Separation, separate};
pub use settings::{Method, Settings};
pub use shapes::{Each, Filter, Shapes};
pub use slide::SlideRules;
pub use space::{Id, Slides, Space};
pub use walls::Wall;
pub use world::{
    Collisions, Defaults, OnTouch, Stage, StateHash, Stats, Touch, TouchEvents, WallTouch, World,
    WorldSettings,
};
