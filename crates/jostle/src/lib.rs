#![doc = include_str!("../README.md")]
#![warn(clippy::disallowed_macros, clippy::disallowed_methods, clippy::disallowed_types)]

pub use jostle_base::{Error, Id, Method, Result, Settings};
pub use jostle_index::pairs::{Found, Overlaps, find as find_pairs, find_between, overlaps};
pub use jostle_index::query::{
    Circle, Hits, Nearest, Neighbors, Point, Polygon, Ray, RayHits, Rect, Region, Window, all_hits,
    first_hits, nearest, neighbors, search,
};
pub use jostle_index::{
    Bounds, Columns, Core, Each, Filter, Node, Period, Quadtree, Scalar, Shape, Shapes,
};
pub use jostle_separate::{Separated, Separation, separate};
pub use jostle_slide::SlideRules;
pub use jostle_space::{Events, Saved, ShapeChanges, Slides, Space, Wanted};
