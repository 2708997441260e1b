//! A hash of what each stage of a step computes. Tests compare it with pinned numbers, so that a change of the
//! code says in which stage the bits changed first.
//!
//! Each hash is of quantities, not of the data structures that hold them: of columns in the order of the
//! particles, and of sorted pairs. So it stays the same if only the storage changes.

use super::search::Lists;
use super::{Stage, StateHash, StepScratch, World};
use crate::contacts::Contacts;
use crate::flow::Kick;
use crate::motion::{Motions, Spins};
use jostle_base::bytes::Plain;
use jostle_base::error::Result;
use jostle_simd::LANES;

impl World {
    /// A hash of the results of a stage, for a watcher that is called at its end, see
    /// [`World::step_watched`]. The same for every number of threads and every [`Method`](jostle_base::Method).
    #[doc(hidden)]
    pub fn stage_hash(&self, stage: Stage) -> Result<u64> {
        let mut hash = StateHash::begin(self.bodies.awake.rows.len());
        match stage {
            Stage::Forces => {
                hash.mix_all(&self.scratch.forces.accelerations);
                mix_kicks(&mut hash, &self.scratch.kicks);
            }
            Stage::Bounds => {
                let shapes = &self.scratch.shapes;
                hash.mix_all(shapes.centers());
                (0..shapes.len()).for_each(|row| hash.mix_value(shapes.radii().at(row)));
                hash.mix_all(&self.scratch.reaches);
            }
            Stage::Build => hash.mix_all(self.scratch.tree.rows()),
            Stage::Pairs => {
                mix_pairs(&mut hash, &self.scratch.pairs);
                mix_pairs(&mut hash, &self.scratch.sensed);
            }
            Stage::Contacts => {
                hash.mix_all(&self.bodies.awake.rows);
                mix_contacts(&mut hash, &self.contacts);
            }
            Stage::Resting => {
                mix_kicks(&mut hash, &self.scratch.kicks);
                for push in &self.boundaries.pushes {
                    hash.mix_value([push.row, push.wall]);
                    hash.mix_value(push.pushes);
                }
            }
            Stage::Events | Stage::Correction => {
                let StepScratch { motions, spins, .. } = &self.scratch;
                mix_motions(&mut hash, self.bodies.awake.rows.len(), motions, spins);
            }
            Stage::Store => {
                hash.mix_value(self.state_hash()?);
                hash.mix_value(self.record.of_step().pairs);
                hash.mix_value(self.record.of_step().walls);
                for contact in self.contacts.lasting() {
                    hash.mix_value(contact.indices);
                    hash.mix_value([contact.impulse, contact.friction_impulse]);
                    hash.mix_value(contact.totals);
                }
            }
        }
        Ok(hash.0)
    }
}

/// The kicks of the sub-step; there are none before it.
fn mix_kicks(hash: &mut StateHash, kicks: &[Kick]) {
    for kick in kicks {
        hash.mix_value(kick.before);
        hash.mix_value(kick.after);
        hash.mix_value(kick.is_supported);
        hash.mix_value(kick.speed);
    }
}

/// Positions and velocities, also of rotation.
fn mix_motions(hash: &mut StateHash, len: usize, motions: &Motions, spins: &Spins) {
    for index in 0..len as u32 {
        hash.mix_value([motions.position(index), motions.residual(index)]);
        hash.mix_value(motions.velocity(index));
        if !spins.is_empty() {
            hash.mix_value(spins.velocity(index));
            hash.mix_value(spins.angle(index));
        }
    }
}

/// The contacts in the order in which they are solved, with the impulses of the last step.
fn mix_contacts(hash: &mut StateHash, contacts: &Contacts) {
    for block in &contacts.blocks.list {
        for lane in (0..LANES).filter(|lane| block.lanes >> lane & 1 == 1) {
            hash.mix_value([0, 1].map(|k| block.indices.of(k)[lane]));
            hash.mix_value([0, 1].map(|k| block.images[k][lane]));
            hash.mix_value([block.impulses[1][lane], block.friction_impulses[1][lane]]);
        }
    }
}

impl StateHash {
    fn mix_all<P: Plain>(&mut self, column: &[P]) {
        column.iter().for_each(|value| self.mix_value(*value));
    }
}

/// Pairs of indices, the smaller first, sorted: the order in which they are found is not fixed.
fn mix_pairs(hash: &mut StateHash, lists: &Lists) {
    for (image, pairs) in lists.iter().filter(|(_, pairs)| !pairs.is_empty()) {
        hash.mix_value(*image);
        let is_here = *image == [0.0; 2];
        let ordered = |&[a, b]: &[u32; 2]| if is_here { [a.min(b), a.max(b)] } else { [a, b] };
        let mut pairs: Vec<[u32; 2]> = pairs.iter().map(ordered).collect();
        pairs.sort_unstable();
        hash.mix_all(&pairs);
    }
}
