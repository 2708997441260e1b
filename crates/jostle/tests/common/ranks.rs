//! Ranks of a distributed world that are threads of one process.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use jostle_base::{Error, Result};
use jostle_world::Communicator;

/// A rank waits as long for a message; then it reports that it would wait forever.
const PATIENCE: Duration = Duration::from_secs(20);

/// A channel to each rank, and one from each.
pub struct ThreadRank {
    rank: usize,
    to: Vec<Sender<Vec<u8>>>,
    from: Vec<Receiver<Vec<u8>>>,
    /// Whether hashes of trajectories are changed on their path to this rank.
    pub tampers: bool,
    knows_lengths: bool,
}

impl ThreadRank {
    fn swap(&mut self, parts: Vec<Vec<u8>>) -> Result<Vec<Vec<u8>>> {
        for (to, part) in self.to.iter().zip(parts) {
            _ = to.send(part);
        }
        let lost = |_| Error::of("rank", self.rank, "it would wait forever");
        self.from.iter().map(|from| from.recv_timeout(PATIENCE).map_err(lost)).collect()
    }
}

impl Communicator for ThreadRank {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.to.len()
    }

    fn gather(&mut self, own: &[u8]) -> Result<Vec<u8>> {
        let all = self.swap(vec![own.to_vec(); self.to.len()])?;
        assert!(all.iter().all(|part| part.len() == own.len()), "another call than the others");
        Ok(all.concat())
    }

    fn gather_all(&mut self, own: &[u8], counts: &[usize]) -> Result<Vec<u8>> {
        let all = self.swap(vec![own.to_vec(); self.to.len()])?;
        assert!(all.iter().zip(counts).all(|(part, &count)| part.len() == count));
        Ok(all.concat())
    }

    fn transpose(&mut self, to: &[u64]) -> Result<Vec<u64>> {
        self.knows_lengths = true;
        let all = self.swap(to.iter().map(|number| number.to_le_bytes().to_vec()).collect())?;
        Ok(all.iter().map(|part| u64::from_le_bytes(part[..].try_into().unwrap())).collect())
    }

    fn exchange(&mut self, to: &[u8], sent: &[usize], received: &[usize]) -> Result<Vec<u8>> {
        let mut rest = to;
        let parts = sent.iter().map(|&count| rest.split_off(..count).unwrap().to_vec()).collect();
        let mut all = self.swap(parts)?;
        assert!(rest.is_empty());
        assert!(all.iter().zip(received).all(|(part, &count)| part.len() == count));
        if self.tampers && !std::mem::take(&mut self.knows_lengths) {
            all.iter_mut().flatten().for_each(|byte| *byte ^= 1);
        }
        Ok(all.concat())
    }
}

pub fn ranks(size: usize) -> Vec<ThreadRank> {
    let mut all: Vec<ThreadRank> = (0..size)
        .map(|rank| {
            let (to, from) = (vec![], vec![]);
            ThreadRank { rank, to, from, tampers: false, knows_lengths: false }
        })
        .collect();
    for from in 0..size {
        for to in 0..size {
            let (sender, receiver) = channel();
            all[from].to.push(sender);
            all[to].from.push(receiver);
        }
    }
    all
}
