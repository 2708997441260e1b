//! A step of a distributed world.
//!
//! Each rank computes a step of its own particles and of ghosts: copies of the particles of other ranks
//! near them. A rank announces in which cells its particles may be during the step, and gets all
//! particles of others that may be there.
//!
//! Contacts are solved colour by colour, and after each colour ghosts get the velocities, or in position
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
use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use super::asleep::Asleep;
use super::bounds::{distance_at, distance_of_fall, rounding};
use super::domain::Announced;
use super::step::MOST_ATTEMPTS;
use super::waking_of_ranks::islands_of_circles;
use super::{Stats, Watch, World};
use crate::decomposition::{Grid, Marks, Near, RECORD, digest, digest_all, put_record};
use crate::error::{Error, Result};
use crate::forces;
use crate::motion::{Motion, exact};
use crate::parallel::locked;

/// Width of the margin around each particle, in mean radii.
const MARGIN: f64 = 3.0;

/// Factor of the margin from which on each rank gets all particles. It doubles with each repetition.
const ALL: f64 = (1u64 << 30) as f64;

/// Factor of the margin after each step that was not repeated.
const NARROWING: f64 = 0.99;

/// Factor of the margin with which a step begins, at most.
const MOST_WIDENING: f64 = 8.0;

/// Particles that get further than announced are announced this much further.
const FURTHER: f32 = 1.25;

/// What the ranks have computed for the particles that they share, compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Agreement {
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
        let mut widening = self.domain.as_ref().map_or(1.0, |domain| domain.widening);
        let mut further = HashMap::new();
        let mut attempt = 0;
        loop {
            let has_all = self.exchange_ghosts(single, widening, &further)?;
            self.begin();
            let done = self.step_in_parts(single, watch);
            let mut done = done.and_then(|()| self.compare_with_other_ranks());
            if matches!(done, Ok(Agreement::Same)) && !self.scratch.meets_sleepers {
                match self.end_step_with_other_ranks(single, dt, widening) {
                    Ok(()) => return Ok(()),
                    Err(error) => done = Err(error),
                }
            }
            self.undo();
            self.drop_ghosts();
            match done? {
                Agreement::Same => {
                    self.wake_touched_of_ranks(attempt == MOST_ATTEMPTS)?;
                    attempt += 1;
                    continue;
                }
                Agreement::Different if has_all => {
                    let rule = "the ranks do not agree on the step; please report it";
                    return Err(Error::of("dt", dt, rule));
                }
                Agreement::Different | Agreement::Further => widening *= 2.0,
            }
            let Some(domain) = &mut self.domain else { return Ok(()) };
            domain.repeats += 1;
            for (row, distance) in domain.far.drain(..) {
                let known = further.entry(row).or_insert(0.0f32);
                *known = known.max(distance * FURTHER);
            }
        }
    }

    /// Makes a step final that is the same on all ranks. If there is an error, it can be undone.
    fn end_step_with_other_ranks(&mut self, single: f32, dt: f64, widening: f64) -> Result<()> {
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
            domain.widening = (widening * NARROWING).clamp(1.0, MOST_WIDENING);
            domain.has_contacts = true;
        }
        Ok(())
    }

    /// Announces where own particles may be, and gets the ghosts that may be there. `further` has
    /// distances of rows that got further than announced before. Returns whether the margin is so wide that
    /// each rank has all particles.
    fn exchange_ghosts(
        &mut self,
        dt: f32,
        widening: f64,
        further: &HashMap<u32, f32>,
    ) -> Result<bool> {
        if let Some(domain) = &mut self.domain {
            domain.foreign = Asleep::default();
        }
        if self.is_alone() {
            self.recall_resting();
            return Ok(true);
        }
        let (margin, extent) = self.margin_and_extent(dt, widening)?;
        let arrived = {
            let Self { domain, particles, rows, settings, forces, asleep, .. } = self;
            let Some(domain) = domain else { return Ok(true) };
            let grid = Grid::new(&settings.container, &domain.scales, domain.awake);
            domain.announced.resize(domain.own, Announced::default());
            let fall = distance_of_fall(settings.gravity, dt);
            let mut group = locked(&domain.group);
            domain.sent.resize(group.size(), Vec::new());
            domain.sent.iter_mut().for_each(Vec::clear);
            domain.is_sent.clear();
            domain.is_sent.resize(domain.own, false);
            let mut marks = Marks::new(&grid);
            let mut cells = Vec::with_capacity(rows.len());
            for (place, &row) in rows.iter().enumerate() {
                let own = distance_at(particles.velocities[place], dt);
                let usual = own + if particles.movable[place] { fall } else { 0.0 };
                let distance = further.get(&row).map_or(usual, |known| known.max(usual));
                let of = &mut domain.announced[row as usize];
                *of = Announced {
                    position: particles.positions[place],
                    distance: distance + margin as f32,
                };
                let center = settings.container.wrap(particles.positions[place]);
                let radius = f64::from(particles.radii[place]) + f64::from(of.distance);
                let rounding = f64::from(rounding(of.position, &settings.container));
                let range = grid.range(center, radius * 1.000_01 + rounding);
                cells.push(range);
                // Nothing changes the motion of others, but they may touch, and wake sleeping ones.
                let wakes = domain.asleep > 0 && !particles.is_static(place);
                if particles.movable[place] || settings.track_events || wakes {
                    grid.each_cell(range, |cell| marks.set(cell));
                }
            }
            let all = group.share(&marks.runs())?;
            let near = Near::new(&grid, &all, group.rank());
            let mut to = vec![Vec::new(); group.size()];
            let mut ranks = Vec::new();
            for (place, &row) in rows.iter().enumerate() {
                ranks.clear();
                grid.each_cell(cells[place], |cell| ranks.extend_from_slice(near.of(cell)));
                if ranks.is_empty() {
                    continue;
                }
                ranks.sort_unstable();
                ranks.dedup();
                domain.is_sent[row as usize] = true;
                let name = (domain.id(row), forces::kinds_of(forces, row as usize));
                for &rank in &ranks {
                    put_record(&mut to[rank as usize], name, particles, place);
                    domain.sent[rank as usize].push(row);
                }
            }
            let arrived = group.exchange(&to)?;
            if domain.asleep > 0 {
                let circles = asleep.circles_near(&grid, &near, &settings.container, group.size());
                let circles = group.exchange(&circles)?.concat();
                domain.foreign = islands_of_circles(&circles, settings.tree)?;
            }
            arrived
        };
        self.append_records(&arrived, false);
        if let Some(domain) = &mut self.domain {
            domain.note_received(arrived.iter().map(|bytes| bytes.len() / RECORD).collect());
        }
        self.recall_resting();
        Ok(margin >= extent)
    }

    /// Whether there is one rank only, which has no ghosts.
    fn is_alone(&self) -> bool {
        self.domain.as_ref().is_none_or(|domain| locked(&domain.group).size() < 2)
    }

    /// The margin around each particle, and the longer side of the AABB of all positions.
    fn margin_and_extent(&mut self, dt: f32, widening: f64) -> Result<(f64, f64)> {
        let Self { domain, particles, rows, settings, scratch, .. } = self;
        let Some(domain) = domain else { return Ok((0.0, 0.0)) };
        let places = particles.positions.iter().map(|&at| settings.container.wrap(at));
        let own = domain.own_of(places, rows).fold([f64::MIN; 4], |most, [x, y]| {
            let [x, y] = [f64::from(x), f64::from(y)];
            [most[0].max(x), most[1].max(y), most[2].max(-x), most[3].max(-y)]
        });
        let radii: f64 = particles.radii.iter().map(|&radius| f64::from(radius)).sum();
        let numbers = [own[0], own[1], own[2], own[3], radii].map(f64::to_bits);
        let all = locked(&domain.group).gather(numbers)?;
        let number = |k: usize| all.iter().map(move |of| f64::from_bits(of[k]));
        let [right, bottom, left, top] = [0, 1, 2, 3].map(|k| number(k).fold(f64::MIN, f64::max));
        // In the order of ranks, so that all have the same sum.
        let radius = number(4).sum::<f64>() / domain.awake.max(1) as f64;
        // The first step moves particles that are outside of a torus.
        let is_torus = settings.container.period().is_some();
        let area = [[-left, -top], [right, bottom]].map(|at| at.map(|v| v as f32));
        domain.extent = (!is_torus).then_some(area);
        let extent = (right + left).max(bottom + top).max(0.0);
        let usual = f64::from(scratch.usual_speed) * f64::from(dt);
        let of_forces = 0.5 * f64::from(forces::largest_cutoff(&self.forces));
        let margin = (MARGIN * radius + usual) * widening + of_forces;
        Ok((if widening < ALL { margin } else { margin.max(extent) }, extent))
    }

    /// Lists the particles that other ranks have too, by their new places.
    pub(super) fn find_shared(&mut self) {
        if let Some(domain) = &mut self.domain {
            domain.list_places(&self.rows);
        }
    }

    /// Adds what happened to shared particles in a part of the step to their hashes, and finds those that
    /// got further than announced.
    pub(super) fn digest_shared(&mut self) {
        let Self { domain, scratch, rows, particles, .. } = self;
        let Some(domain) = domain else { return };
        let events = &scratch.events;
        for (at, &place) in domain.shared.iter().enumerate() {
            let row = rows[place as usize] as usize;
            let motion = scratch.motions.get(place);
            let [x, y] = exact(motion.position, motion.residual);
            let [u, v] = motion.velocity.map(f64::from);
            let mut hash = digest_all(domain.digests[row], [x, y, u, v]);
            hash = digest(hash, events.digests.get(at).copied().unwrap_or(0));
            if !scratch.spins.is_empty() {
                hash = digest_all(hash, [f64::from(scratch.spins.velocity(place))]);
            }
            domain.digests[row] = hash;
            domain.may_meet[row] |= events.may_meet.get(at).is_some_and(|&may_meet| may_meet);
        }
        for &(place, distance) in &events.outside_limits {
            let left = domain.left.get(place as usize).copied().unwrap_or(f32::INFINITY);
            if distance > f64::from(left) {
                domain.far.push((rows[place as usize], distance as f32));
            }
        }
        for (place, &limit) in domain.left.iter().enumerate() {
            let ([x, y], [u, v]) =
                (scratch.motions.position(place as u32), particles.positions[place]);
            let square = (x - u) * (x - u) + (y - v) * (y - v);
            if square > limit * limit {
                domain.far.push((rows[place], square.sqrt()));
            }
        }
    }

    /// Gives ghosts the state that their own ranks have computed, at the beginning of all sub-steps but the
    /// first.
    pub(super) fn refresh_ghosts(&self, substep: usize) -> Result<()> {
        let Some(domain) = &self.domain else { return Ok(()) };
        if substep == 0 {
            return Ok(());
        }
        domain.halo().any(false)?;
        let motions = &self.scratch.motions;
        domain.halo().refresh(
            |place| {
                let of = motions.get(place);
                let ([x, y], [a, b], [u, v]) = (of.position, of.residual, of.velocity);
                [x, y, a, b, u, v]
            },
            |place, [x, y, a, b, u, v]| {
                let displacement = motions.displacement(place);
                let (position, residual, velocity) = ([x, y], [a, b], [u, v]);
                motions.set(place, Motion { position, residual, velocity, displacement });
            },
        )?;
        let spins = &self.scratch.spins;
        if !domain.has_friction() {
            return Ok(());
        }
        domain.halo().refresh(
            |place| [spins.velocity(place)],
            |place, [velocity]| spins.set_velocity(place, velocity),
        )
    }

    /// Gives ghosts the accelerations that their own ranks have computed, from neighbours that this rank
    /// need not have. Particles whose neighbours other ranks have not announced are noted as far.
    pub(super) fn share_accelerations(&mut self) -> Result<()> {
        let Self { domain, rows, scratch, settings, forces, .. } = self;
        let Some(domain) = domain else { return Ok(()) };
        if locked(&domain.group).size() < 2 || !forces::pull(forces) {
            return Ok(());
        }
        domain.list_places(rows);
        let force = &mut scratch.forces;
        let accelerations = Cell::from_mut(&mut force.accelerations[..]).as_slice_of_cells();
        domain.halo().any(false)?;
        domain.halo().refresh(
            |place| accelerations[place as usize].get(),
            |place, acceleration| accelerations[place as usize].set(acceleration),
        )?;
        let reach = 0.5 * forces::largest_cutoff(forces);
        for (&position, &row) in force.halfway.iter().zip(&*rows) {
            let Some(of) = domain.announced.get(row as usize) else { continue };
            let offset = [0, 1].map(|k| f64::from(position[k]) - f64::from(of.position[k]));
            let [x, y] = settings.container.minimum_image(offset);
            let distance = x.hypot(y) as f32 * 1.000_01 + reach;
            if distance > of.distance {
                domain.far.push((row, distance));
            }
        }
        Ok(())
    }

    /// The AABB of some positions of all ranks; None if the world is not distributed.
    pub(super) fn extent_of_halfway(&self) -> Result<Option<[[f32; 2]; 2]>> {
        let Some(domain) = &self.domain else { return Ok(None) };
        let all = domain.own_of(self.scratch.forces.halfway.iter(), &self.rows);
        let own = all.fold([f32::MIN; 4], |most, &[x, y]| {
            [most[0].max(x), most[1].max(y), most[2].max(-x), most[3].max(-y)]
        });
        let [right, bottom, left, top] = self.largest_of_all(own.map(f64::from))?.map(|v| v as f32);
        Ok(Some([[-left, -top], [right, bottom]]))
    }

    /// Compares the hashes of all ghosts that may meet own particles with those of their own ranks, on all
    /// ranks.
    fn compare_with_other_ranks(&mut self) -> Result<Agreement> {
        let Some(domain) = &self.domain else { return Ok(Agreement::Same) };
        let mut group = locked(&domain.group);
        if group.size() < 2 {
            return Ok(Agreement::Same);
        }
        let far = group.sum([domain.far.len() as u64])?;
        if far != [0] {
            return Ok(Agreement::Further);
        }
        let bytes = |(rank, rows): (u32, &Vec<u32>)| {
            let hash = |&row: &u32| {
                let pairs = domain.own_pairs.get(&(row, rank)).copied().unwrap_or(0);
                digest(domain.digests[row as usize], pairs)
            };
            rows.iter().flat_map(|row| hash(row).to_le_bytes()).collect()
        };
        let to: Vec<Vec<u8>> = (0..).zip(&domain.sent).map(bytes).collect();
        let counts: Vec<usize> = domain.received.iter().map(|count| count * 8).collect();
        let all = group.exchange_known(&to, &counts)?.concat();
        let (all, _) = all.as_chunks::<8>();
        let differ = (domain.own..domain.ids.len()).zip(all).filter(|(row, theirs)| {
            let own = digest(domain.digests[*row], domain.ghost_pairs[*row]);
            domain.may_meet[*row] && own != u64::from_le_bytes(**theirs)
        });
        let different = group.sum([differ.count() as u64])?;
        Ok(if different == [0] { Agreement::Same } else { Agreement::Different })
    }
}
