//! What a step exchanges with other processes that have parts of the same world.
//!
//! A process computes the motion of its own particles and of *ghosts*, copies of the particles of other
//! processes near them. All processes make the same calls in the same order. [`Alone`] stands for one
//! process that has the whole world. It exchanges nothing.

use std::fmt::Debug;

use crate::forces::chance::mixed;
use jostle_base::error::Result;

/// The processes that share a world, and what a sub-step exchanges with them.
pub trait Halo: Debug + Sync {
    /// Whether no other process has a part of the world. Then no function of this trait sends a
    /// message, and several threads may call them.
    fn is_alone(&self) -> bool;

    /// Whether the particle at each index belongs to this process. Particles behind the end of the list
    /// do.
    fn own(&self) -> &[bool];

    /// Indices of ghosts, and of particles that are ghosts elsewhere.
    fn shared(&self) -> &[u32];

    /// The number of particles of all processes that are awake, if this one has `own` of them.
    fn count(&self, own: usize) -> usize;

    /// Replaces numbers by their sums over all processes. Returns an error if a process has failed.
    fn add_up(&self, numbers: &mut [u64]) -> Result<()>;

    /// Replaces numbers by their largest values on all processes. Returns an error if a process has
    /// failed.
    fn take_largest(&self, numbers: &mut [f64]) -> Result<()>;

    /// Sets the bits that are set on any process, in bytes of which other processes may have more or
    /// fewer. Returns an error if a process has failed.
    fn any_bits(&self, any: &mut Vec<u8>) -> Result<()>;

    /// Calls `put` to append `size` bytes of each particle that is a ghost elsewhere, then `take` with
    /// those of each ghost. It does not report failures: call `wait` before it, so that all processes
    /// know of them.
    fn exchange(
        &self,
        size: usize,
        put: &dyn Fn(u32, &mut Vec<u8>),
        take: &mut dyn FnMut(u32, &[u8]),
    ) -> Result<()>;
}

/// One process.
#[derive(Clone, Copy, Debug, Default)]
pub struct Alone;

impl Halo for Alone {
    fn is_alone(&self) -> bool {
        true
    }

    fn own(&self) -> &[bool] {
        &[]
    }

    fn shared(&self) -> &[u32] {
        &[]
    }

    fn count(&self, own: usize) -> usize {
        own
    }

    fn add_up(&self, _: &mut [u64]) -> Result<()> {
        Ok(())
    }

    fn take_largest(&self, _: &mut [f64]) -> Result<()> {
        Ok(())
    }

    fn any_bits(&self, _: &mut Vec<u8>) -> Result<()> {
        Ok(())
    }

    fn exchange(
        &self,
        _size: usize,
        _put: &dyn Fn(u32, &mut Vec<u8>),
        _take: &mut dyn FnMut(u32, &[u8]),
    ) -> Result<()> {
        Ok(())
    }
}

impl dyn Halo + '_ {
    /// Whether a particle belongs to this process and is no ghost.
    #[inline(always)]
    pub fn owns(&self, index: u32) -> bool {
        self.own().get(index as usize).is_none_or(|&is_own| is_own)
    }

    /// The sum of each number over all processes.
    pub fn sum<const N: usize>(&self, mut own: [u64; N]) -> Result<[u64; N]> {
        self.add_up(&mut own)?;
        Ok(own)
    }

    /// The largest of each number on all processes.
    pub fn largest<const N: usize>(&self, mut own: [f64; N]) -> Result<[f64; N]> {
        self.take_largest(&mut own)?;
        Ok(own)
    }

    /// Whether a condition is true on any process.
    pub fn any(&self, own: bool) -> Result<bool> {
        // A sum tells it, so one kind of message is enough for all questions.
        Ok(self.sum([u64::from(own)])? != [0])
    }

    /// Waits for all processes. Returns an error if one has failed.
    pub fn wait(&self) -> Result<()> {
        // A message without numbers still tells whether a rank has failed.
        self.sum([]).map(|[]: [u64; 0]| ())
    }

    /// Replaces numbers of all ghosts by those that their own processes have. It does not report
    /// failures: call `wait` before it.
    pub fn refresh<const N: usize>(
        &self,
        get: impl Fn(u32) -> [f32; N],
        set: impl Fn(u32, [f32; N]),
    ) -> Result<()> {
        // Numbers travel as their bits, so ghosts have exactly the state of their own rank.
        let put = |index, to: &mut Vec<u8>| {
            get(index).iter().for_each(|number| to.extend(number.to_le_bytes()));
        };
        self.exchange(N * size_of::<f32>(), &put, &mut |index, bytes| {
            let (numbers, _) = bytes.as_chunks::<4>();
            set(index, std::array::from_fn(|k| f32::from_le_bytes(numbers[k])));
        })
    }

    /// The indices of all ghosts, with a number of each from its own process.
    pub fn labels(&self, of: impl Fn(u32) -> u64) -> Result<Vec<(u32, u64)>> {
        let mut all = Vec::new();
        let put = |index, to: &mut Vec<u8>| to.extend(of(index).to_le_bytes());
        self.exchange(size_of::<u64>(), &put, &mut |index, bytes| {
            let (numbers, _) = bytes.as_chunks::<8>();
            all.push((index, u64::from_le_bytes(numbers[0])));
        })?;
        Ok(all)
    }
}

/// A hash of a hash and a number.
pub fn digest(hash: u64, number: u64) -> u64 {
    // The rotation makes the order of the numbers count.
    mixed(hash.rotate_left(23) ^ number)
}

/// A hash of a hash and some numbers.
pub fn digest_all(hash: u64, numbers: impl IntoIterator<Item = f64>) -> u64 {
    numbers.into_iter().fold(hash, |hash, number| digest(hash, number.to_bits()))
}
