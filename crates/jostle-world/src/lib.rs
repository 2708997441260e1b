//! Discs with mass that collide in the order of time, with forces, walls, resting contacts and sleep.

#![cfg_attr(
    not(feature = "ranks"),
    allow(dead_code, reason = "some functions of the parts are for `ranks` alone")
)]
#![warn(clippy::disallowed_macros, clippy::disallowed_methods, clippy::disallowed_types)]

mod surface;
pub mod particles;
mod motion;
mod flow;
mod roots;
mod trajectory;
mod tolerance;
pub mod container;
pub mod walls;
pub mod forces;
mod halo;
mod events;
mod contacts;
mod resting;
mod correction;
pub mod world;
#[cfg(feature = "ranks")]
pub mod ranks;

pub use container::Container;
pub use forces::Influence;
pub use particles::{Changes, Particles, Spin};
#[cfg(feature = "ranks")]
pub use ranks::{Communicator, OwnParticles, Traffic};
pub use surface::{Sides, Surface};
pub use walls::Wall;
pub use world::{
    Bodies, Casts, Collisions, NewDiscs, OnTouch, Stage, StateHash, Stats, Totals, Touch,
    TouchEvents, Touched, WallTouch, World, WorldSettings,
};
