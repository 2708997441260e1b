//! A world that is distributed over ranks. Each rank holds the particles of its domain and copies of
//! those near it (ghosts), as in parallel molecular dynamics (S. Plimpton, *Fast Parallel Algorithms
//! for Short-Range Molecular Dynamics*, Journal of Computational Physics 117, 1995).
//!
//! `domain` is the [`Distribution`](crate::world::distribution::Distribution) of a world, `protocol`
//! what ranks do together at the points of a step.

mod carried;
mod cells;
mod cuts;
mod distribute;
mod domain;
mod edits;
mod ghosts;
mod group;
mod islands;
mod merge;
mod migration;
mod parts;
mod protocol;
mod records;
mod reductions;
mod rounds;
mod scale;
mod waking;

use cells::{CircleBlocks, Grid, Near};
use cuts::{cuts, key, sample};
pub use distribute::OwnParticles;
use group::Group;
pub use group::{Communicator, Traffic};
pub use records::{RECORD, put_record, read_records, record_fields};
use rounds::{Link, rounds};
use scale::{Scale, read_samples, sample_positions};
