//! A step of a distributed world.
//!
//! Each rank computes a step of its own particles and of ghosts: copies of the particles of other ranks
//! near them. A rank announces in which cells its particles may be during the step, and gets all
//! particles of others that may be there.
//!
//! Contacts are solved colour by colour, and between two colours ghosts get the velocities, or in position
//! correction the displacements, that their own ranks have computed. So an own particle needs no
//! more than the particles that it touches.
//!
//! Collisions in the order of time have chains that may be long. So ranks compare the trajectories of
//! ghosts that may meet own particles with those that their own ranks have computed. If all are
//! equal, every own particle has met the same particles, on the same trajectories, as in one process:
//! each pair is computed by a rank that has the true trajectory of both, and a history without
//! contradictions is unique. The colours of contacts are compared, too. Otherwise, or if a particle
//! got further than announced, all ranks repeat the step with a wider halo.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use super::domain::halo_of;
use super::step::MAX_ATTEMPTS;
use super::{Stats, Watch, World};
use crate::decomposition::{digest, digest_all};
use crate::error::{Error, Result};
use crate::forces;
use crate::halo::Halo;
use crate::motion::{Motion, exact};
use crate::parallel::locked;

/// Factor of the margin after each step that was not repeated.
const NARROWING: f64 = 0.99;

/// Factor of the margin with which a step begins, at most.
const MAX_WIDENING: f64 = 8.0;

/// What the ranks have computed for the particles that they share, compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Agreement {
    Same,
    /// Some particle has got further than announced.
    Further,
    Different,
}

impl World {
    /// Makes a step of a distributed world. If it fails on any rank, it fails on all, and changes nothing. A
    /// rank that panics tells the others, too.
    pub(super) fn step_with_other_ranks(
        &mut self,
        single: f32,
        dt: f64,
        watch: &mut Watch<'_>,
    ) -> Result<()> {
        let done =
            catch_unwind(AssertUnwindSafe(|| self.try_step_with_other_ranks(single, dt, watch)));
        let is_cause = !matches!(done, Ok(Ok(()) | Err(Error::OtherRank { .. })));
        if is_cause && let Some(domain) = &self.domain {
            locked(&domain.group).fail();
        }
        done.unwrap_or_else(|panic| resume_unwind(panic))
    }

    fn try_step_with_other_ranks(
        &mut self,
        single: f32,
        dt: f64,
        watch: &mut Watch<'_>,
    ) -> Result<()> {
        self.drop_ghosts();
        self.check_displacements(single)?;
        self.walls.check_displacements(f64::from(single))?;
        self.move_to_domains()?;
        let Some(domain) = &self.domain else { return Ok(()) };
        if domain.is_still {
            self.stay_still();
            return Ok(());
        }
        let resting = domain.resting.len();
        let done = self.repeat_until_ranks_agree(single, dt, watch);
        if done.is_err() {
            self.drop_ghosts();
            self.cancel_waking();
            if let Some(domain) = &mut self.domain {
                domain.resting.truncate(resting);
            }
        }
        done
    }

    /// Ends a step in which nothing can move.
    fn stay_still(&mut self) {
        self.wall_impulses.clear();
        self.stats = Stats::default();
        if let Some(domain) = &mut self.domain {
            domain.steps += 1;
        }
    }

    /// Makes a step. If particles would meet sleeping ones of any rank, wakes these and makes it anew.
    fn repeat_until_ranks_agree(
        &mut self,
        single: f32,
        dt: f64,
        watch: &mut Watch<'_>,
    ) -> Result<()> {
        if let Some(domain) = &mut self.domain {
            domain.widened = domain.widening;
            domain.further.clear();
        }
        let mut attempt = 0;
        loop {
            let has_all = self.exchange_ghosts(single)?;
            self.recall_resting();
            self.begin();
            let done = self.step_in_parts(single, watch);
            let mut done = done.and_then(|()| match self.scratch.agreement.take() {
                Some(agreement) => Ok(agreement),
                None => self.compare_with_other_ranks(),
            });
            if matches!(done, Ok(Agreement::Same)) && !self.scratch.meets_sleepers {
                match self.end_step_with_other_ranks(single, dt) {
                    Ok(()) => return Ok(()),
                    Err(error) => done = Err(error),
                }
            }
            if let Some(domain) = &mut self.domain {
                domain.note_further();
            }
            self.undo();
            self.drop_ghosts();
            match done? {
                Agreement::Same => {
                    self.wake_touched_of_ranks(attempt == MAX_ATTEMPTS)?;
                    attempt += 1;
                    continue;
                }
                Agreement::Different if has_all => {
                    let rule = "the ranks do not agree on the step; please report it";
                    return Err(Error::of("dt", dt, rule));
                }
                Agreement::Different | Agreement::Further => {}
            }
            if let Some(domain) = &mut self.domain {
                domain.widened *= 2.0;
                domain.repeats += 1;
            }
        }
    }

    /// Makes a step final that is the same on all ranks. If there is an error, it can be undone.
    fn end_step_with_other_ranks(&mut self, single: f32, dt: f64) -> Result<()> {
        self.apply_bath(single);
        self.keep_wall_pushes();
        super::touches::add_up(&mut self.wall_impulses);
        self.record_touching();
        self.fall_asleep(dt)?;
        self.forget_woken();
        self.close_step();
        if let Some(domain) = &mut self.domain {
            domain.steps += 1;
            // The next steps need about as much.
            domain.widening = (domain.widened * NARROWING).clamp(1.0, MAX_WIDENING);
            domain.has_contacts = self.contacts.has_impulses();
            if !domain.has_contacts {
                domain.resting.clear();
            }
        }
        Ok(())
    }

    /// Lists the particles that other ranks have too, by their new indices.
    pub(super) fn find_shared(&mut self) {
        if let Some(domain) = &mut self.domain {
            domain.list_indices(&self.rows);
        }
    }

    /// Adds what happened to shared particles in a part of the step to their hashes, and finds those that
    /// got further than announced.
    pub(super) fn digest_shared(&mut self) {
        let Self { domain, scratch, rows, particles, .. } = self;
        let Some(domain) = domain else { return };
        let events = &scratch.events;
        for (at, &index) in domain.shared.iter().enumerate() {
            let row = rows[index as usize] as usize;
            let motion = scratch.motions.get(index);
            let [x, y] = exact(motion.position, motion.residual);
            let [u, v] = motion.velocity.map(f64::from);
            let mut hash = digest_all(domain.digests[row], [x, y, u, v]);
            hash = digest(hash, events.digests.get(at).copied().unwrap_or(0));
            if !scratch.spins.is_empty() {
                hash = digest_all(hash, [f64::from(scratch.spins.velocity(index))]);
            }
            domain.digests[row] = hash;
            domain.may_meet[row] |= events.may_meet.get(at).is_some_and(|&may_meet| may_meet);
        }
        for &(index, distance) in &events.outside_limits {
            let left = domain.left.get(index as usize).copied().unwrap_or(f32::INFINITY);
            if distance > f64::from(left) {
                domain.far.push((rows[index as usize], distance as f32));
            }
        }
        for (index, &limit) in domain.left.iter().enumerate() {
            let ([x, y], [u, v]) =
                (scratch.motions.position(index as u32), particles.positions[index]);
            let square = (x - u) * (x - u) + (y - v) * (y - v);
            if square > limit * limit {
                domain.far.push((rows[index], square.sqrt()));
            }
        }
    }

    /// Gives ghosts the state that their own ranks have computed, at the beginning of all sub-steps but the
    /// first.
    pub(super) fn refresh_ghosts(&self, substep: usize) -> Result<()> {
        if substep == 0 {
            return Ok(());
        }
        let halo = halo_of(&self.domain);
        halo.wait()?;
        let motions = &self.scratch.motions;
        halo.refresh(
            |index| {
                let of = motions.get(index);
                let ([x, y], [a, b], [u, v]) = (of.position, of.residual, of.velocity);
                [x, y, a, b, u, v]
            },
            |index, [x, y, a, b, u, v]| {
                let displacement = motions.displacement(index);
                let (position, residual, velocity) = ([x, y], [a, b], [u, v]);
                motions.set(index, Motion { position, residual, velocity, displacement });
            },
        )?;
        let spins = &self.scratch.spins;
        if !self.has_friction() {
            return Ok(());
        }
        halo.refresh(
            |index| [spins.velocity(index)],
            |index, [velocity]| spins.set_velocity(index, velocity),
        )
    }

    /// Gives ghosts the accelerations that their own ranks have computed, from neighbours that this rank
    /// need not have. Particles whose neighbours other ranks have not announced are noted as far.
    pub(super) fn share_accelerations(&mut self) -> Result<()> {
        let has_accelerations = self.has_accelerations();
        let Self { domain, rows, scratch, settings, forces, .. } = self;
        let Some(domain) = domain else { return Ok(()) };
        if locked(&domain.group).size() < 2 || !has_accelerations {
            return Ok(());
        }
        domain.list_indices(rows);
        let halo: &dyn Halo = &**domain;
        let force = &mut scratch.forces;
        let accelerations = Cell::from_mut(&mut force.accelerations[..]).as_slice_of_cells();
        halo.wait()?;
        halo.refresh(
            |index| accelerations[index as usize].get(),
            |index, acceleration| accelerations[index as usize].set(acceleration),
        )?;
        let half_cutoff = 0.5 * forces::largest_cutoff(forces);
        for (&position, &row) in force.halfway.iter().zip(&*rows) {
            let Some(of) = domain.announced.get(row as usize) else { continue };
            let offset = [0, 1].map(|k| f64::from(position[k]) - f64::from(of.position[k]));
            let [x, y] = settings.container.minimum_image(offset);
            let distance = (x * x + y * y).sqrt() as f32 * 1.000_01 + half_cutoff;
            if distance > of.distance {
                domain.far.push((row, distance));
            }
        }
        Ok(())
    }

    /// The AABB of some positions of all ranks; None if the world is not distributed.
    pub(super) fn extent_of_halfway(&self) -> Result<Option<[[f32; 2]; 2]>> {
        let Some(domain) = &self.domain else { return Ok(None) };
        let all = self.scratch.forces.halfway.iter().map(|&[x, y]| [x, y, -x, -y]);
        let most = [f32::MIN; 4];
        let own = domain
            .own_or(most, all, &self.rows)
            .fold(most, |most, own| [0, 1, 2, 3].map(|k| most[k].max(own[k])));
        let [right, bottom, left, top] = self.largest_of_all(own.map(f64::from))?.map(|v| v as f32);
        Ok(Some([[-left, -top], [right, bottom]]))
    }

    /// Compares the hashes of all ghosts that may meet own particles with those of their own ranks,
    /// on all ranks. Refuses, on all ranks, a step that is the same on all and in which a particle
    /// has too many collisions.
    pub(super) fn compare_with_other_ranks(&mut self) -> Result<Agreement> {
        let Some(domain) = &self.domain else { return Ok(Agreement::Same) };
        let halo: &dyn Halo = &**domain;
        if halo.is_alone() {
            return match self.scratch.events.has_too_many() {
                true if !self.scratch.meets_sleepers => Err(self.too_many_collisions()),
                _ => Ok(Agreement::Same),
            };
        }
        if halo.any(!domain.far.is_empty())? {
            return Ok(Agreement::Further);
        }
        let hash = |row: u32, rank: u32| {
            let pairs = domain.own_pairs.get(&(row, rank)).copied().unwrap_or(0);
            digest(domain.digests[row as usize], pairs)
        };
        let sent = (0..).zip(&domain.sent);
        let hashes = sent.flat_map(|(rank, rows)| rows.iter().map(move |&row| hash(row, rank)));
        let to: Vec<u8> = hashes.flat_map(u64::to_le_bytes).collect();
        let sent: Vec<usize> = domain.sent.iter().map(|rows| rows.len() * 8).collect();
        let received: Vec<usize> = domain.received.iter().map(|count| count * 8).collect();
        let all = locked(&domain.group).exchange_known(&to, &sent, &received)?;
        let (all, _) = all.as_chunks::<8>();
        let differ = (domain.own..domain.ids.len()).zip(all).filter(|(row, theirs)| {
            let own = digest(domain.digests[*row], domain.ghost_pairs[*row]);
            domain.may_meet[*row] && own != u64::from_le_bytes(**theirs)
        });
        // A step that ended early, or that differs, is repeated.
        let is_refused = !self.scratch.meets_sleepers && self.scratch.events.has_too_many();
        let [different, refused] = halo.sum([differ.count() as u64, u64::from(is_refused)])?;
        if different > 0 {
            return Ok(Agreement::Different);
        }
        if is_refused {
            return Err(self.too_many_collisions());
        }
        if refused > 0 {
            // The ranks that refuse it report this now.
            halo.wait()?;
        }
        Ok(Agreement::Same)
    }
}
