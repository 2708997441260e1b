//! Domain decomposition: a world that is distributed over ranks. Each rank holds the particles of
//! its domain and copies of those near it (ghosts), as in parallel molecular dynamics (S. Plimpton,
//! *Fast Parallel Algorithms for Short-Range Molecular Dynamics*, Journal of Computational Physics
//! 117, 1995).

mod cells;
mod cuts;
mod group;
mod records;
mod rounds;
mod scale;

use crate::forces::chance::mixed;
pub use cells::{CircleBlocks, Grid, Marks, Near};
pub use cuts::{SAMPLES, cuts, key, sample};
pub use group::{Communicator, Group, Traffic};
pub use records::{RECORD, put_record, read_records, record_fields};
pub use rounds::{Link, rounds};
pub use scale::{CELLS, Scale, read_samples, sample_positions};

/// A hash of a hash and a number.
pub fn digest(hash: u64, number: u64) -> u64 {
    mixed(hash.rotate_left(23) ^ number)
}

/// A hash of a hash and some numbers.
pub fn digest_all(hash: u64, numbers: impl IntoIterator<Item = f64>) -> u64 {
    numbers.into_iter().fold(hash, |hash, number| digest(hash, number.to_bits()))
}
