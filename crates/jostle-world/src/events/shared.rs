//! Discs that are shared with other processes: hashes of their trajectories, by which these find out
//! whether they have computed the same, and windows of the same length in all of them.

use super::Events;
use super::flight::TimeWindow;
use super::window::most_impacts;
use crate::halo::{digest, digest_all};
use jostle_base::error::Result;
use jostle_base::memory;

/// Lengths of a window, each half as long as the one before.
const LENGTHS: usize = 11;

impl Events {
    /// As [`Events::end_of_window`], from the impacts of all processes. The impact of two discs is
    /// counted by the process of the first.
    pub(super) fn end_of_window_of_all(
        &self,
        window: &TimeWindow<'_>,
        shortest: f64,
    ) -> Result<f64> {
        let halo = window.flight.halo;
        // The ends of all possible windows are tested at once: one message between the processes
        // instead of one for each halving.
        let mut ends = [window.end; LENGTHS];
        let mut early = [0; LENGTHS];
        let length = window.end - window.begin;
        for (number, end) in ends.iter_mut().enumerate().skip(1) {
            // A power of two, so each product is exact, and the ends have the same bits as those of
            // repeated halving.
            *end = window.begin + length * 0.5f64.powi(number as i32);
        }
        let all = self.blocks.iter().flat_map(|block| block.first.iter().chain(&block.crossing));
        for event in all.filter(|event| event.time > window.begin && halo.owns(event.pair[0])) {
            for (count, end) in early.iter_mut().zip(&ends) {
                *count += u64::from(event.time <= *end);
            }
        }
        let early = halo.sum(early)?;
        let most = most_impacts(halo.count(window.starts.len())) as u64;
        let mut number = 0;
        let is_long = |number: usize| length * 0.5f64.powi(number as i32 + 1) >= shortest;
        while number + 1 < LENGTHS && is_long(number) && early[number] > most {
            number += 1;
        }
        Ok(ends[number])
    }

    /// Adds the trajectories in the window to the hashes, and finds which ghosts may meet discs of
    /// this process.
    pub(super) fn digest_shared(&mut self, window: &TimeWindow<'_>) -> Result<()> {
        let halo = window.flight.halo;
        if halo.is_alone() {
            return Ok(());
        }
        memory::resize(&mut self.digests, halo.shared().len(), 0)?;
        memory::resize(&mut self.may_meet, halo.shared().len(), false)?;
        for (at, &index) in halo.shared().iter().enumerate() {
            let hash = self.digest_of(window, index, self.digests[at]);
            self.digests[at] = hash;
            if halo.owns(index) || self.may_meet[at] {
                continue;
            }
            let mut meets = false;
            self.neighbors.of(index, |other| {
                meets |= halo.owns(other.index) && window.starts[other.index as usize].is_movable;
            });
            self.may_meet[at] = meets;
        }
        Ok(())
    }

    /// A hash of `hash` and the trajectory of a disc. Without events and kicks it follows from its start,
    /// which is the same on all processes.
    fn digest_of(&self, window: &TimeWindow<'_>, index: u32, hash: u64) -> u64 {
        // A disc that a process has simulated again may have a trajectory without events there.
        let trajectory = self.trajectory(index).filter(|(_, trajectory)| trajectory.count > 0);
        if trajectory.is_none() && window.flight.kicks.is_empty() {
            return hash;
        }
        let parts = self.pieces(window, index).flat_map(|part| {
            let [position, velocity] = [part.piece.position, part.piece.velocity];
            [part.piece.time, position[0], position[1], velocity[0], velocity[1]]
        });
        let hash = digest_all(hash, parts);
        match trajectory {
            None => hash,
            Some((_, trajectory)) => {
                digest(hash, trajectory.groups ^ u64::from(trajectory.is_exhausted))
            }
        }
    }
}
