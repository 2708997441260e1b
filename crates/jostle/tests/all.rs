//! All integration tests, in one program: it is compiled and linked once.

mod common;

mod allocations;
mod determinism;
mod events;
mod filters;
mod forces;
mod friction;
mod given;
mod grid;
mod interrupt;
mod kinematic;
mod limits;
mod locality;
mod merging;
mod motors;
mod moving_walls;
mod neighbors;
mod periodic;
mod physics;
mod pushed;
mod query;
mod ranks;
mod scales;
mod scenes;
mod separate;
mod sides;
mod sleeping;
mod slide;
mod snapshot;
mod space;
mod thermal;
mod threads;
mod torus_walls;
mod tree;
mod walls;
