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

use std::collections::HashMap;

use super::bounds::{distance_at, distance_of_fall};
use super::domain::Announced;
use super::{Watch, World};
use crate::decomposition::{Grid, Marks, Near, RECORD, digest, digest_all, put_record};
use crate::error::{Error, Result};
use crate::motion::{Motion, exact};
use crate::parallel::locked;

/// Width of the margin around each particle, in mean radii.
const MARGIN: f64 = 3.0;

/// Repetitions of a step. Each is with a margin twice as wide, so the last ones have all particles.
const MOST_REPEATS: usize = 64;

/// Factor of the margin after each step that was not repeated.
const NARROWING: f64 = 0.99;

/// Factor of the margin with which a step begins, at most.
const MOST_WIDENING: f64 = 8.0;

/// Particles that get further than announced are announced this much further.
const FURTHER: f32 = 1.25;

impl World {
    /// Makes a step of a distributed world. If it fails on any rank, it fails on all, and changes nothing.
    pub(super) fn step_with_other_ranks(&mut self, dt: f32, watch: &mut Watch<'_>) -> Result<()> {
        self.drop_ghosts();
        let done = self.try_step_with_other_ranks(dt, watch);
        if let Err(error) = &done
            && let Some(domain) = &self.domain
            && !matches!(error, Error::OtherRank { .. })
        {
            locked(&domain.group).fail();
        }
        done
    }

    fn try_step_with_other_ranks(&mut self, dt: f32, watch: &mut Watch<'_>) -> Result<()> {
        self.check_displacements(dt)?;
        self.walls.check_displacements(f64::from(dt))?;
        self.move_to_domains()?;
        let mut widening = self.domain.as_ref().map_or(1.0, |domain| domain.widening);
        let mut further = HashMap::new();
        for _ in 0..MOST_REPEATS {
            self.exchange_ghosts(dt, widening, &further)?;
            self.begin();
            let done = self.step_in_parts(dt, watch);
            let done = done.and_then(|()| self.agrees_with_other_ranks());
            if let Ok(true) = done {
                self.apply_bath(dt);
                self.keep_wall_pushes();
                super::touches::add_up(&mut self.wall_impulses);
                self.close_step();
                if let Some(domain) = &mut self.domain {
                    domain.steps += 1;
                    // The next steps need about as much.
                    domain.widening = (widening * NARROWING).clamp(1.0, MOST_WIDENING);
                    domain.has_contacts = true;
                }
                return Ok(());
            }
            self.undo();
            self.drop_ghosts();
            done?;
            widening *= 2.0;
            let Some(domain) = &mut self.domain else { break };
            domain.repeats += 1;
            for (row, distance) in domain.far.drain(..) {
                let known = further.entry(row).or_insert(0.0f32);
                *known = known.max(distance * FURTHER);
            }
        }
        let rule = "the ranks do not agree on the step; please report it";
        Err(Error::of("dt", dt, rule))
    }

    /// Announces where own particles may be, and gets the ghosts that may be there. `further` has
    /// distances of rows that got further than announced before.
    fn exchange_ghosts(
        &mut self,
        dt: f32,
        widening: f64,
        further: &HashMap<u32, f32>,
    ) -> Result<()> {
        if self.is_alone() {
            self.recall_resting();
            return Ok(());
        }
        let (grid, margin) = self.grid_and_margin(dt, widening)?;
        let arrived = {
            let Self { domain, particles, rows, settings, .. } = self;
            let Some(domain) = domain else { return Ok(()) };
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
                let rounding = f64::from(f32::EPSILON) * grid.extent();
                let range = grid.range(center, radius * 1.000_01 + rounding);
                cells.push(range);
                // Nothing changes the motion of others.
                if particles.movable[place] {
                    grid.each_cell(range, |cell| marks.set(cell));
                }
            }
            let all = group.share(&marks.0)?;
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
                for &rank in &ranks {
                    let id = domain.ids[row as usize];
                    put_record(&mut to[rank as usize], id, particles, place);
                    domain.sent[rank as usize].push(row);
                }
            }
            group.exchange(&to)?
        };
        self.append_records(&arrived, false);
        if let Some(domain) = &mut self.domain {
            domain.note_received(arrived.iter().map(|bytes| bytes.len() / RECORD).collect());
        }
        self.recall_resting();
        Ok(())
    }

    /// Whether there is one rank only, which has no ghosts.
    fn is_alone(&self) -> bool {
        self.domain.as_ref().is_none_or(|domain| locked(&domain.group).size() < 2)
    }

    /// The grid of cells over all particles, and the margin around each.
    fn grid_and_margin(&self, dt: f32, widening: f64) -> Result<(Grid, f64)> {
        let Some(domain) = &self.domain else {
            return Ok((Grid::new(&self.settings.container, [[0.0; 2]; 2], 1), 0.0));
        };
        let [low, high] = self.extent_of_all()?.unwrap_or_default();
        let corners = [low, high].map(|corner| self.settings.container.wrap(corner));
        let area = corners.map(|corner| corner.map(f64::from));
        let grid = Grid::new(&self.settings.container, area, domain.total);
        let own: f64 = self.particles.radii.iter().map(|&radius| f64::from(radius)).sum();
        // In the order of ranks, so that all have the same sum.
        let sums = locked(&domain.group).gather([own.to_bits()])?;
        let sum: f64 = sums.iter().map(|[sum]| f64::from_bits(*sum)).sum();
        let radius = sum / domain.total.max(1) as f64;
        let usual = f64::from(self.memory.usual_speed) * f64::from(dt);
        // A finest cell of the Morton order must not have particles that no rank has together.
        let finest = grid.extent() / f64::from(1u32 << 14);
        Ok((grid, (MARGIN * radius + usual + finest) * widening))
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
        let Self { domain, memory, rows, particles, .. } = self;
        let Some(domain) = domain else { return };
        let events = &memory.events;
        for (at, &place) in domain.shared.iter().enumerate() {
            let row = rows[place as usize] as usize;
            let motion = memory.motions.get(place);
            let [x, y] = exact(motion.position, motion.residual);
            let [u, v] = motion.velocity.map(f64::from);
            let mut hash = digest_all(domain.digests[row], [x, y, u, v]);
            hash = digest(hash, events.digests.get(at).copied().unwrap_or(0));
            if !memory.spins.is_empty() {
                hash = digest_all(hash, [f64::from(memory.spins.velocity(place))]);
            }
            domain.digests[row] = hash;
            domain.may_meet[row] |= events.may_meet.get(at).is_some_and(|&may_meet| may_meet);
        }
        for &(place, distance) in &events.outside_limits {
            if domain.owns(rows[place as usize]) {
                domain.far.push((rows[place as usize], distance as f32));
            }
        }
        for (place, &limit) in memory.limits.iter().enumerate() {
            let ([x, y], [u, v]) =
                (memory.motions.position(place as u32), particles.positions[place]);
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
        let motions = &self.memory.motions;
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
        let spins = &self.memory.spins;
        if !domain.has_friction() {
            return Ok(());
        }
        domain.halo().refresh(
            |place| [spins.velocity(place)],
            |place, [velocity]| spins.set_velocity(place, velocity),
        )
    }

    /// Whether the hashes of all ghosts that may meet own particles are those of their own ranks, on all
    /// ranks, and no particle has got further than announced.
    fn agrees_with_other_ranks(&mut self) -> Result<bool> {
        let Some(domain) = &self.domain else { return Ok(true) };
        let mut group = locked(&domain.group);
        if group.size() < 2 {
            return Ok(true);
        }
        let far = group.sum([domain.far.len() as u64])?;
        if far != [0] {
            return Ok(false);
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
        Ok(different == [0])
    }
}
