//! Random operations on an object and on the simplest model of it, whose answers must be equal.
//!
//! A seed makes one case: an object and a sequence of operations. `driver` runs cases and repeats one that
//! fails; the other files have an object each. `JOSTLE_OPERATIONS=1000000` runs more operations,
//! `JOSTLE_SEED=17` the case with this seed alone, whose operations are printed.

mod driver;
mod formulas;
mod model;
mod queries;
mod ranks;
mod slide;
mod space;
mod world;
