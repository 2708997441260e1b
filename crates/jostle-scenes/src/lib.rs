//! Named scenes from a seed, the same for tests, benchmarks and the simulator.
//!
//! Lengths are in pixels, times in seconds, y grows downwards; a step is 1/60 s. The size of a
//! scene depends on its number of particles. Immovable discs are additional and have the first
//! rows.
//!
//! The modules are listed in reading order: each uses only those above it.

#![warn(unreachable_pub)]
#![warn(clippy::disallowed_macros, clippy::disallowed_methods, clippy::disallowed_types)]

pub mod random;
mod placing;
mod start;
mod scene;
mod gases;
mod falling;
mod games;
mod mixing;
mod sand;
mod heap;
mod soft;
mod machines;
mod pinball;
mod galton;
mod emitters;
mod stars;
mod life;
mod fluid;
mod list;

pub use galton::{GaltonBoard, galton_board};
pub use list::{SCENES, find};
pub use scene::Scene;

/// The length of a step in seconds for which scenes are designed.
pub const STEP: f64 = 1.0 / 60.0;
