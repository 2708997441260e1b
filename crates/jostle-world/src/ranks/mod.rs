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

pub use carried::{own_kept, own_touches_asleep, take_kept};
use cells::{CircleBlocks, Grid, Near};
use cuts::{cuts, key, sample};
pub use distribute::OwnParticles;
pub use distribute::{
    check_distributable, distribute, of_records, own_and_all, own_awake, own_particles,
    own_records, part, rebalance_every, set_work,
};
pub use edits::{add, own_ids, remove, set_ids};
use group::Group;
pub use group::{Communicator, Traffic};
pub use migration::drop_ghosts;
pub use parts::{check_head, restore};
pub use records::{RECORD, put_record, read_records, record_fields};
pub use reductions::{agree_on_losses, own_energy_of_pairs};
use rounds::{Link, rounds};
use scale::{Scale, read_samples, sample_positions};
