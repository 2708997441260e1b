//! A step of a distributed world.
//!
//! Each rank computes a step of its own particles and of ghosts: copies of the particles of other ranks
//! near them. What happens to a particle depends on those that it meets, so ranks compare the histories
//! of ghosts that may meet own particles with those that their own ranks have computed. If all are
//! equal, every own particle has met the same particles, on the same trajectories, as in one process:
//! each pair is computed by a rank that has the true trajectory of both. Otherwise the step is
//! repeated with a wider halo.
//!
//! A rank announces in which cells its particles may be during the step, and gets all particles
//! of others that may be there. A particle that gets further than announced repeats the step too.

use std::collections::HashMap;

use super::domain::Announced;
use super::{Watch, World};
use crate::decomposition::{Grid, Marks, Near, RECORD, digest, digest_all, put_record};
use crate::disjoint_sets::DisjointSets;
use crate::error::{Error, Result};
use crate::motion::exact;
use crate::parallel::locked;

/// Width of the margin around each particle, in mean radii.
const MARGIN: f64 = 3.0;

/// Repetitions of a step. Each is with a margin twice as wide, so the last ones have all particles.
const MOST_REPEATS: usize = 64;

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
        let (mut widening, mut further) = (1.0, HashMap::new());
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
        let (grid, margin) = self.grid_and_margin(dt, widening)?;
        let arrived = {
            let Self { domain, particles, rows, settings, .. } = self;
            let Some(domain) = domain else { return Ok(()) };
            domain.announced.resize(domain.own, Announced::default());
            let [gx, gy] = settings.gravity;
            let fall = 0.5 * dt * dt * (gx * gx + gy * gy).sqrt();
            let mut marks = Marks::new(&grid);
            let circle = |place: usize, announced: &Announced| {
                let center = settings.container.wrap(particles.positions[place]);
                let radius = f64::from(particles.radii[place]) + f64::from(announced.distance);
                (center, radius * 1.000_01 + f64::from(f32::EPSILON) * grid.extent())
            };
            for (place, &row) in rows.iter().enumerate() {
                let [u, v] = particles.velocities[place];
                let own = (u * u + v * v).sqrt() * dt * 1.000_01;
                let usual = own + if particles.movable[place] { fall } else { 0.0 };
                let distance = further.get(&row).map_or(usual, |known| known.max(usual));
                let of = &mut domain.announced[row as usize];
                *of = Announced {
                    position: particles.positions[place],
                    distance: distance + margin as f32,
                };
                // Nothing changes the motion of others.
                if particles.movable[place] {
                    let (center, radius) = circle(place, of);
                    grid.each_cell(center, radius, |cell| marks.set(cell));
                }
            }
            let mut group = locked(&domain.group);
            let all = group.share(&marks.0)?;
            let near = Near::new(&grid, &all, group.rank());
            let mut to = vec![Vec::new(); group.size()];
            domain.sent.resize(to.len(), Vec::new());
            domain.sent.iter_mut().for_each(Vec::clear);
            domain.is_sent.clear();
            domain.is_sent.resize(domain.own, false);
            let mut ranks = Vec::new();
            for (place, &row) in rows.iter().enumerate() {
                let (center, radius) = circle(place, &domain.announced[row as usize]);
                ranks.clear();
                grid.each_cell(center, radius, |cell| ranks.extend_from_slice(near.of(cell)));
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
        let len = self.rows.len();
        if let Some(domain) = &mut self.domain {
            domain.received = arrived.iter().map(|bytes| bytes.len() / RECORD).collect();
            domain.far.clear();
            for column in [&mut domain.digests] {
                column.clear();
                column.resize(len, 0);
            }
            domain.may_meet.clear();
            domain.may_meet.resize(len, false);
        }
        Ok(())
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
        let islands = self.islands_of_corrections();
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
                let turning = f64::from(memory.spins.velocity(place));
                hash = digest_all(hash, [turning, memory.spins.angle(place)]);
            }
            if let Some(island) = islands.get(&place) {
                hash = digest(hash, *island);
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
            let distance = f64::from(x - u).hypot(f64::from(y - v)) as f32;
            if distance > limit {
                domain.far.push((rows[place], distance));
            }
        }
    }

    /// The islands of overlapping particles whose positions were corrected: for each place in one the sum
    /// of hashes of its members. A correction depends on all members.
    fn islands_of_corrections(&self) -> HashMap<u32, u64> {
        let mut islands = HashMap::new();
        let Some(domain) = &self.domain else { return islands };
        let overlaps = &self.memory.overlaps;
        if overlaps.iter().all(|(_, pairs)| pairs.is_empty()) {
            return islands;
        }
        let mut sets = DisjointSets::default();
        sets.reset(self.rows.len());
        let all = || overlaps.iter().flat_map(|(_, pairs)| pairs);
        let moves = |place: u32| self.memory.moving[place as usize];
        // Particles that do not move connect nothing.
        all().filter(|[a, b]| moves(*a) && moves(*b)).for_each(|&[a, b]| sets.join(a, b));
        let mut sums: HashMap<u32, u64> = HashMap::new();
        for pair in all() {
            let hash = pair.iter().fold(0u64, |sum, &place| {
                let id = domain.ids[self.rows[place as usize] as usize];
                sum.wrapping_add(digest(0, id as u64))
            });
            for root in distinct(pair.map(|place| sets.root(place))) {
                let sum = sums.entry(root).or_default();
                *sum = sum.wrapping_add(digest(1, hash));
            }
        }
        for &place in all().flatten() {
            islands.insert(place, sums[&sets.root(place)]);
        }
        islands
    }

    /// Whether the hashes of all ghosts that may meet own particles are those of their own ranks, on all
    /// ranks, and no particle has got further than announced.
    fn agrees_with_other_ranks(&mut self) -> Result<bool> {
        let Some(domain) = &self.domain else { return Ok(true) };
        let mut group = locked(&domain.group);
        let far = group.sum([domain.far.len() as u64])?;
        if far != [0] {
            return Ok(false);
        }
        let bytes = |rows: &Vec<u32>| {
            rows.iter().flat_map(|&row| domain.digests[row as usize].to_le_bytes()).collect()
        };
        let to: Vec<Vec<u8>> = domain.sent.iter().map(bytes).collect();
        let counts: Vec<usize> = domain.received.iter().map(|count| count * 8).collect();
        let all = group.exchange_known(&to, &counts)?.concat();
        let (all, _) = all.as_chunks::<8>();
        let ghosts = domain.digests[domain.own..].iter().zip(&domain.may_meet[domain.own..]);
        let differ = ghosts.zip(all).filter(|((own, may_meet), theirs)| {
            **may_meet && **own != u64::from_le_bytes(**theirs)
        });
        let different = group.sum([differ.count() as u64])?;
        Ok(different == [0])
    }
}

/// Two numbers, or one if they are equal.
fn distinct([a, b]: [u32; 2]) -> impl Iterator<Item = u32> {
    [Some(a), (a != b).then_some(b)].into_iter().flatten()
}
