//! Motion of one shape among others that it cannot enter: it slides along them.
//!
//! The first time of impact along the displacement is computed by the [`Outline`] of each
//! obstacle. The shape moves there, the rest of the displacement loses its component into the
//! obstacle, and so on (collide and slide). `walker` guarantees that the shape
//! does not overlap an obstacle after any of these motions, by the formula of
//! [`geometry::overlap`](jostle_index::geometry::overlap).
//!
//! C. Ericson, *Real-Time Collision Detection* (2005), chapter 5.5 (moving shapes). K. Fauerby,
//! *Improved Collision Detection and Response* (2003), for collide and slide.

#![warn(unreachable_pub)]
#![warn(clippy::disallowed_macros, clippy::disallowed_methods, clippy::disallowed_types)]

mod outline;
mod convex;
mod rounded_box;
mod segment;
mod solid;
mod rules;
mod walker;
mod ground;

pub use outline::Outline;
pub use rules::{CheckedRules, DEFAULT_MAX_SLIDES, MAX_SLIDES, SlideRules, Surface};
pub use solid::{FindObstacles, Obstacle, Solid};
pub use walker::{SlideHit, Walker, contains, slop};
