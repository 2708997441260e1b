//! The ranks of a world, and their collective operations.

use std::fmt;

use jostle_base::error::{Error, Result};

/// Messages between ranks. All ranks make the same calls in the same order.
pub trait Communicator: Send {
    /// The number of this rank.
    fn rank(&self) -> usize;
    /// The number of ranks.
    fn size(&self) -> usize;
    /// Gathers the same number of bytes from each rank, in the order of ranks.
    fn gather(&mut self, own: &[u8]) -> Result<Vec<u8>>;
    /// Gathers bytes from each rank, in the order of ranks; `counts` has how many come from each.
    fn gather_all(&mut self, own: &[u8], counts: &[usize]) -> Result<Vec<u8>>;
    /// Sends one number to each rank; returns those from each rank.
    fn transpose(&mut self, to: &[u64]) -> Result<Vec<u64>>;
    /// Sends bytes to each rank; returns those from each rank. `sent` and `received` are their
    /// numbers, in the order of ranks.
    fn exchange(&mut self, to: &[u8], sent: &[usize], received: &[usize]) -> Result<Vec<u8>>;
}

/// Numbers that ranks gather at a time.
const WORDS: usize = 16;

/// The messages that a rank has sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Calls in which all ranks take part.
    pub calls: u64,
    /// Messages to other ranks that carry particles or digests.
    pub messages: u64,
    /// Their bytes.
    pub bytes: u64,
}

/// The ranks of a world. A rank that fails reports it to the others at its next call, so that none
/// waits for it: the first number of each gathered block is whether its rank has failed.
pub struct Group {
    communicator: Box<dyn Communicator>,
    /// The messages that this rank has sent.
    pub traffic: Traffic,
}

impl fmt::Debug for Group {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Group").field("rank", &self.rank()).field("size", &self.size()).finish()
    }
}

impl Group {
    /// The ranks of a communicator.
    pub fn new(communicator: Box<dyn Communicator>) -> Self {
        Self { communicator, traffic: Traffic::default() }
    }

    /// The number of this rank.
    pub fn rank(&self) -> usize {
        self.communicator.rank()
    }

    /// The number of ranks.
    pub fn size(&self) -> usize {
        self.communicator.size()
    }

    /// Gathers numbers from all ranks, fifteen at most. Returns an error if a rank has failed.
    pub fn gather<const N: usize>(&mut self, own: [u64; N]) -> Result<Vec<[u64; N]>> {
        let all = self.gather_some(own)?;
        Ok(all.iter().map(|of| std::array::from_fn(|k| of[k])).collect())
    }

    fn gather_some(&mut self, own: impl IntoIterator<Item = u64>) -> Result<Vec<[u64; WORDS - 1]>> {
        // The first word tells whether the rank has failed, so no failure needs a message of its
        // own.
        let mut block = [0; WORDS];
        for (count, number) in (1..).zip(own) {
            block[count] = number;
        }
        let all = self.gather_blocks(&block)?;
        // Every rank sees the same block, so all return the error in the same call.
        match all.iter().position(|block| block[0] > 0) {
            Some(rank) => Err(Error::OtherRank { rank }),
            None => Ok(all.iter().map(|block| std::array::from_fn(|k| block[k + 1])).collect()),
        }
    }

    fn gather_blocks(&mut self, own: &[u64; WORDS]) -> Result<Vec<[u64; WORDS]>> {
        self.traffic.calls += 1;
        let bytes: Vec<u8> = own.iter().flat_map(|word| word.to_le_bytes()).collect();
        let all = self.communicator.gather(&bytes)?;
        let (words, _) = all.as_chunks::<8>();
        let words: Vec<u64> = words.iter().map(|bytes| u64::from_le_bytes(*bytes)).collect();
        let (blocks, _) = words.as_chunks::<WORDS>();
        Ok(blocks.to_vec())
    }

    /// Reports to the others that this rank has failed. Called once for each error of this rank,
    /// and not for errors of other ranks.
    pub fn fail(&mut self) {
        let mut block = [0; WORDS];
        block[0] = 1;
        // If this fails, the others have an error, too.
        _ = self.gather_blocks(&block);
    }

    /// Replaces numbers, fifteen at most, by the largest of all ranks.
    pub fn largest(&mut self, numbers: &mut [f64]) -> Result<()> {
        // Each rank computes the result itself from the numbers in the order of ranks, so all have
        // the same bits.
        let all = self.gather_some(numbers.iter().map(|number| number.to_bits()))?;
        for (k, number) in numbers.iter_mut().enumerate() {
            *number = all.iter().map(|of| f64::from_bits(of[k])).fold(*number, f64::max);
        }
        Ok(())
    }

    /// Replaces numbers, fifteen at most, by their sums over all ranks.
    pub fn sum(&mut self, numbers: &mut [u64]) -> Result<()> {
        let all = self.gather_some(numbers.iter().copied())?;
        for (k, number) in numbers.iter_mut().enumerate() {
            *number = all.iter().map(|of| of[k]).sum();
        }
        Ok(())
    }

    /// Gathers bytes from each rank, in the order of ranks.
    pub fn share(&mut self, own: &[u8]) -> Result<Vec<Vec<u8>>> {
        // Failures are reported in this call, so the next one is made by all ranks.
        let counts = self.gather([own.len() as u64])?;
        let counts: Vec<usize> = counts.iter().map(|[count]| *count as usize).collect();
        self.traffic.calls += 1;
        let all = self.communicator.gather_all(own, &counts)?;
        Ok(split(&all, &counts))
    }

    /// Sends bytes to each rank; returns those from each rank.
    pub fn exchange(&mut self, to: &[Vec<u8>]) -> Result<Vec<Vec<u8>>> {
        let sent: Vec<usize> = to.iter().map(Vec::len).collect();
        let lengths: Vec<u64> = sent.iter().map(|&count| count as u64).collect();
        // The calls that follow cannot report a failure, so it is asked for before.
        self.gather([])?;
        self.traffic.calls += 1;
        let received = self.communicator.transpose(&lengths)?;
        let received: Vec<usize> = received.iter().map(|&count| count as usize).collect();
        let all = self.exchange_known(&to.concat(), &sent, &received)?;
        Ok(split(&all, &received))
    }

    /// Sends bytes to each rank, and returns those from each, with the bytes of all ranks one after
    /// another. It must be known how many come from each rank, and that none has failed.
    pub fn exchange_known(
        &mut self,
        to: &[u8],
        sent: &[usize],
        received: &[usize],
    ) -> Result<Vec<u8>> {
        if sent.is_empty() {
            // One rank alone has no lists of ghosts, and makes no call.
            return Ok(Vec::new());
        }
        self.traffic.calls += 1;
        for (rank, &bytes) in sent.iter().enumerate() {
            if rank != self.rank() && bytes > 0 {
                self.traffic.messages += 1;
                self.traffic.bytes += bytes as u64;
            }
        }
        self.communicator.exchange(to, sent, received)
    }
}

/// The parts of some bytes.
fn split(all: &[u8], counts: &[usize]) -> Vec<Vec<u8>> {
    let mut rest = all;
    let part = |&count: &usize| rest.split_off(..count).unwrap_or_default().to_vec();
    counts.iter().map(part).collect()
}
