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

use std::sync::Mutex;

use crate::error::Result;
use crate::forces::chance::mixed;
use crate::parallel::locked;
pub use cells::{CircleBlocks, Grid, Marks, Near};
pub use cuts::{SAMPLES, cuts, key, sample};
pub use group::{Communicator, Group, Traffic};
pub use records::{RECORD, put_record, read_records, record_fields};
pub use rounds::Link;
pub use scale::{CELLS, Scale, read_samples, sample_positions};

/// The data that a sub-step exchanges with other ranks.
#[derive(Debug, Clone, Copy)]
pub struct Halo<'a> {
    /// The ranks.
    pub group: &'a Mutex<Group>,
    /// Particles of all ranks, each counted once.
    pub total: usize,
    /// Whether the disc at each index belongs to this rank; the others are ghosts.
    pub is_own: &'a [bool],
    /// Indices of ghosts, and of discs that are ghosts elsewhere.
    pub shared: &'a [u32],
    /// The indices of the discs that are ghosts of each rank.
    pub sent: &'a [Vec<u32>],
    /// The indices of the ghosts from each rank.
    pub ghosts: &'a [Vec<u32>],
}

impl Halo<'_> {
    /// Replaces numbers of all ghosts by those that their own ranks have. No rank may have failed
    /// since the last call.
    pub fn refresh<const N: usize>(
        &self,
        get: impl Fn(u32) -> [f32; N],
        set: impl Fn(u32, [f32; N]),
    ) -> Result<()> {
        let all = self.exchange(N * size_of::<f32>(), |index, to| {
            get(index).iter().for_each(|number| to.extend(number.to_le_bytes()));
        })?;
        let (numbers, _) = all.as_chunks::<4>();
        for (&index, numbers) in self.ghosts.iter().flatten().zip(numbers.chunks_exact(N)) {
            set(index, std::array::from_fn(|k| f32::from_le_bytes(numbers[k])));
        }
        Ok(())
    }

    /// A number of each ghost from its own rank, with its index.
    pub fn labels(&self, of: impl Fn(u32) -> u64) -> Result<Vec<(u32, u64)>> {
        let all =
            self.exchange(size_of::<u64>(), |index, to| to.extend(of(index).to_le_bytes()))?;
        let (numbers, _) = all.as_chunks::<8>();
        let indices = self.ghosts.iter().flatten();
        Ok(indices
            .zip(numbers)
            .map(|(&index, number)| (index, u64::from_le_bytes(*number)))
            .collect())
    }

    /// Sends `size` bytes of each disc that is a ghost elsewhere; returns those of all ghosts, in
    /// their order.
    fn exchange(&self, size: usize, put: impl Fn(u32, &mut Vec<u8>)) -> Result<Vec<u8>> {
        let bytes_of = |lists: &[Vec<u32>]| -> Vec<usize> {
            lists.iter().map(|indices| indices.len() * size).collect()
        };
        let (sent, received) = (bytes_of(self.sent), bytes_of(self.ghosts));
        let mut to = Vec::with_capacity(sent.iter().sum());
        self.sent.iter().flatten().for_each(|&index| put(index, &mut to));
        locked(self.group).exchange_known(&to, &sent, &received)
    }

    /// The bits that are set on any rank, in bytes of which other ranks may have more or fewer.
    /// Returns an error if a rank has failed.
    pub fn any_of_each(&self, own: &[u8]) -> Result<Vec<u8>> {
        let mut any = Vec::new();
        for bytes in locked(self.group).share(own)? {
            any.resize(any.len().max(bytes.len()), 0);
            any.iter_mut().zip(bytes).for_each(|(any, bits)| *any |= bits);
        }
        Ok(any)
    }

    /// Whether a condition is true on any rank. Returns an error if a rank has failed.
    pub fn any(&self, own: bool) -> Result<bool> {
        Ok(locked(self.group).sum([u64::from(own)])? != [0])
    }
}

/// A hash of a hash and a number.
pub fn digest(hash: u64, number: u64) -> u64 {
    mixed(hash.rotate_left(23) ^ number)
}

/// A hash of a hash and some numbers.
pub fn digest_all(hash: u64, numbers: impl IntoIterator<Item = f64>) -> u64 {
    numbers.into_iter().fold(hash, |hash, number| digest(hash, number.to_bits()))
}
