//! 2D collision detection: a quadtree over discs, boxes and rounded boxes that finds every pair that
//! overlaps, shapes with ids that move, casts, move-and-slide, and shapes moved apart.
//!
//! ```
//! use jostle::{Each, Quadtree, Settings, Shapes};
//! let centers = vec![[0.0, 0.0], [1.5, 0.0], [4.0, 0.0]];
//! let shapes = Shapes::circles(centers, Each::One(1.0))?;
//! let tree = Quadtree::<f64>::build(&shapes, Settings::default())?;
//! # Ok::<(), jostle::Error>(())
//! ```

#![warn(clippy::disallowed_macros, clippy::disallowed_methods, clippy::disallowed_types)]

pub use jostle_base::{Error, Id, Method, Result, Settings};
pub use jostle_index::{
    Bounds, Columns, Each, Filter, Node, Period, Quadtree, Scalar, Shape, Shapes,
};
pub use jostle_separate::{Separated, Separation, separate};
pub use jostle_slide::SlideRules;
pub use jostle_space::{Slides, Space};
