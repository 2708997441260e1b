//! The sub-steps of a step: forces and resting contacts give kicks, then all particles fly and
//! collide in the order of time, then positions are corrected.

use super::feel::{accelerate, springs};
use super::given::add_given;
use super::search::Lists;
use super::settings::DEFAULT_SUBSTEPS;
use super::touches::WallImpulse;
use super::{Collisions, Memory, OnTouch, Stage, World, merge};
use crate::error::Result;
use crate::events::{Bounce, Flight, WALL};
use crate::flow::{Flow, Kick};
use crate::forces;
use crate::interrupt;
use crate::motion::Motion;
use crate::parallel;
use crate::resting::{Support, WallPushes};
use crate::walls::{Around, Clock};

use super::bounds::StepBounds;

/// Overlap, as a share of the sum of radii, from which positions are corrected where nothing rests.
const OVERLAP: f32 = 0.003;

/// Candidate pairs that one thread tests for overlap at a time.
const FILTERED: usize = 1 << 14;

impl World {
    /// Whether all collisions are elastic, so that nothing comes to rest.
    pub(super) fn is_elastic(&self) -> bool {
        // Chunks without branches, for vector instructions.
        let elastic = |all: &[f32]| all.iter().fold(true, |so_far, &one| so_far & (one == 1.0));
        self.settings.restitution == 1.0
            && self.particles.restitutions.chunks(256).all(elastic)
            && self.walls.are_elastic()
    }

    /// Whether forces give kicks before and after the flights of a step.
    fn is_pulled(&self) -> bool {
        self.has_accelerations() || springs(&self.forces).next().is_some()
    }

    /// Whether gravity or forces may press inelastic particles against each other or against walls.
    pub(super) fn may_rest(&self) -> bool {
        !self.is_elastic() && (self.is_pulled() || self.settings.gravity != [0.0; 2])
    }

    /// Sub-steps of a step: those of the settings, or as many as the scene needs. One is enough
    /// where flights between collisions are exact and nothing rests.
    pub fn substeps(&self) -> usize {
        let is_one_enough = !self.is_pulled() && !self.may_rest();
        self.settings.substeps.unwrap_or(if is_one_enough { 1 } else { DEFAULT_SUBSTEPS })
    }

    /// The neighbours of all particles from the candidate pairs, and the contacts whose positions
    /// may have to be corrected or that may rest.
    pub(super) fn prepare(&mut self) {
        let threads = self.threads();
        let may_rest = self.may_rest();
        let Memory {
            tree,
            pairs,
            sensed,
            overlaps,
            overlap_parts,
            meetings,
            moving,
            exhausted,
            events,
            ..
        } = &mut self.memory;
        if !self.particles.sensors.is_empty() {
            let is_sensor = |place: u32| self.particles.is_sensor(place as usize);
            take(pairs, sensed, |[a, b]| is_sensor(a) || is_sensor(b));
        }
        moving.clone_from(&self.particles.movable);
        meetings.clear();
        if self.settings.on_touch == OnTouch::Merge {
            merge::expect(pairs, &self.particles, meetings);
            pairs.clear();
        }
        if !exhausted.is_empty() {
            let places = self.rows.iter().zip(moving.iter_mut());
            places.for_each(|(row, moves)| *moves &= exhausted.binary_search(row).is_err());
        }
        events.take_pairs(self.particles.len(), pairs, threads);
        let (particles, restitution) = (&self.particles, self.settings.restitution);
        if may_rest {
            self.contacts.collect(pairs, particles, moving, restitution, tree.rows(), threads);
            return;
        }
        let overlap = |[a, b]: [u32; 2], image: [f32; 2]| {
            let [p, q] = [a, b].map(|place| particles.positions[place as usize]);
            let [c, d] = [a, b].map(|place| particles.residuals[place as usize]);
            let [x, y] = [0, 1].map(|k| (q[k] - p[k] + image[k]) + (d[k] - c[k]));
            let reach = particles.radii[a as usize] + particles.radii[b as usize];
            let reach = reach * (1.0 - OVERLAP);
            x * x + y * y < reach * reach
        };
        overlaps.resize_with(pairs.len(), Default::default);
        for ((image, pairs), (image_of_list, list)) in pairs.iter().zip(overlaps.iter_mut()) {
            *image_of_list = *image;
            let count = pairs.len().div_ceil(FILTERED);
            overlap_parts.resize_with(overlap_parts.len().max(count), Vec::new);
            let parts = overlap_parts.iter_mut().zip(pairs.chunks(FILTERED));
            parallel::for_each(threads, parts, |(part, pairs)| {
                part.clear();
                for &pair in pairs {
                    if overlap(pair, *image) {
                        part.push(pair);
                    }
                }
            });
            list.clear();
            list.extend(overlap_parts[..count].iter().flatten());
            list.sort_unstable();
        }
        self.contacts.collect(overlaps, particles, moving, restitution, tree.rows(), threads);
    }

    /// Makes the sub-steps.
    pub(super) fn fly(&mut self, dt: f32, watch: &mut (dyn FnMut(Stage) + Send)) -> Result<()> {
        let (threads, substeps) = (self.threads(), self.memory.substeps);
        let (is_elastic, may_rest) = (self.is_elastic(), self.may_rest());
        let has_kicks = may_rest || self.is_pulled();
        let has_accelerations = self.has_accelerations();
        let settings = &self.settings;
        let memory = &mut self.memory;
        memory.motions.resize(self.particles.len());
        let (motions, particles) = (&memory.motions, &self.particles);
        parallel::for_rows(threads, particles.len(), |place| {
            let (position, velocity) = (particles.positions[place], particles.velocities[place]);
            let residual = particles.residuals[place];
            motions.set(place as u32, Motion { position, residual, velocity, travel: [0.0; 2] });
        });
        memory.spins.fill(&particles.spins);
        memory.hot_walls.fill(forces::thermal_walls(&self.forces), self.time);
        let has_friction = particles.spins.iter().any(|spin| spin.friction > 0.0);
        memory.limits.clear();
        if !self.asleep.is_empty() {
            memory.limits.extend_from_slice(&memory.reaches);
        }
        let mut bounds = StepBounds::new(
            &memory.tree,
            particles,
            &mut memory.reaches,
            &mut memory.grown,
            settings.container,
        );
        if !may_rest {
            self.wall_pushes.fill(Default::default());
        }
        let with_friction = if may_rest && has_friction { particles.len() } else { 0 };
        self.wall_frictions.resize(with_friction, Default::default());
        memory.events.begin_step();
        memory.wall_impulses.clear();
        if !may_rest {
            memory.wall_pushes.clear();
        }
        let is_bounded = memory.bounded && !may_rest && springs(&self.forces).next().is_none();
        let h = f64::from(dt) / substeps as f64;
        let flow = Flow::new(h, settings.gravity, settings.drag);
        let clock = |substeps: usize| {
            let elapsed = substeps as f64 * h;
            Clock { elapsed, rate: flow.seconds / flow.duration }
        };
        let walls = |clock: Clock| Around {
            walls: &self.walls,
            near: &memory.near_walls,
            particles,
            clock,
        };
        if may_rest {
            memory.resting.begin_step(&self.contacts, particles, has_friction);
        }
        memory.correction.begin_step(&self.contacts, particles);
        for substep in 0..substeps {
            interrupt::check()?;
            let (at_start, at_end) = (walls(clock(substep)), walls(clock(substep + 1)));
            let forces = &mut memory.forces;
            if substep > 0 && has_accelerations {
                forces.find_halfway(motions, &settings.container, h as f32);
                accelerate(&self.forces, particles, settings, forces);
                add_given(&mut forces.accelerations, &self.rows, &self.given);
                watch(Stage::Forces);
            }
            let kicks = &mut memory.kicks;
            kicks.clear();
            if has_kicks {
                kicks.resize(particles.len(), Kick::default());
                forces.kick(kicks, &flow);
                if !forces.sprung.is_empty() && !self.forces.is_empty() {
                    forces.sprung.act(motions, kicks, h);
                    watch(Stage::Forces);
                }
            }
            if may_rest {
                let support = Support {
                    particles,
                    moving: &memory.moving,
                    motions,
                    spins: &memory.spins,
                    has_friction,
                    flow: &flow,
                    container: settings.container,
                    walls: at_start,
                    rows: &self.rows,
                    pushes: &memory.wall_pushes,
                    restitution: settings.restitution,
                    threads,
                };
                let contacts = &self.contacts;
                let (normal, friction) = (&mut self.wall_pushes[..], &mut self.wall_frictions[..]);
                let impulses = &mut memory.wall_impulses;
                let new = &mut memory.new_wall_pushes;
                new.clear();
                let pushes = WallPushes { normal, friction, walls: new, impulses };
                memory.resting.support(&support, contacts, pushes, kicks)?;
                new.sort_unstable_by_key(|of| (of.row, of.wall));
                std::mem::swap(new, &mut memory.wall_pushes);
                watch(Stage::Resting);
            }
            let flight = Flight {
                particles,
                movable: &memory.moving,
                motions,
                spins: &memory.spins,
                has_friction,
                gravity: flow.gravity,
                end: flow.duration,
                flow,
                kicks,
                is_first: true,
                bounded: substep == 0 && is_bounded,
                container: settings.container,
                walls: at_start,
                restitution: settings.restitution,
                is_elastic,
                thermostat: forces::thermostat(&self.forces),
                hot: &memory.hot_walls,
                pairs: settings.on_touch == OnTouch::Bounce,
                candidates: &memory.pairs,
                sensed: &memory.sensed,
                senses_all: settings.on_touch == OnTouch::Ignore && settings.track_events,
                limits: &memory.limits,
                threads,
            };
            memory.events.fly(&flight, &mut bounds)?;
            watch(Stage::Events);
            let (contacts, container) = (&self.contacts, &settings.container);
            memory.correction.run(contacts, motions, particles, (container, at_end), threads);
            merge::note(&mut memory.meetings, motions, threads);
            watch(Stage::Correction);
        }
        if may_rest {
            memory.resting.end_step(&mut self.contacts);
        }
        memory.correction.end_step(&mut self.contacts);
        Ok(())
    }

    /// Stores the results of the sub-steps: positions and velocities, what touched, and who had too
    /// many events.
    pub(super) fn record(&mut self) -> Result<()> {
        let (threads, settings, memory) = (self.threads(), &self.settings, &mut self.memory);
        let (motions, particles) = (&memory.motions, &self.particles);
        let exhausted = memory.events.exhausted.iter().map(|&place| self.rows[place as usize]);
        memory.exhausted.extend(exhausted);
        memory.exhausted.sort_unstable();
        self.stats.unresolved = memory.exhausted.len() as u64;
        let bounced = &mut memory.events.bounced;
        if !bounced.is_sorted_by(|a, b| a.order(b).is_le()) {
            bounced.sort_unstable_by(Bounce::order);
        }
        let bounced = &memory.events.bounced;
        for of in bounced.iter().filter(|of| of.impulses[0] > 0.0) {
            let Collisions { pairs, walls } = &mut memory.collisions;
            *(if of.pair[1] == WALL { walls } else { pairs }) += 1;
        }
        let off_walls = bounced.iter().filter(|of| of.pair[1] == WALL);
        let off_walls = off_walls.map(|of| (of.pair[0], of.code, of.impulses));
        let off_walls = off_walls.chain(memory.wall_impulses.drain(..));
        self.wall_impulses.extend(off_walls.map(|(place, wall, impulses)| WallImpulse {
            row: self.rows[place as usize],
            wall,
            impulses,
            pushes: [0.0; 2],
        }));
        let pairs = bounced.iter().filter(|of| of.pair[1] != WALL).map(|of| (of.pair, of.impulses));
        let sensed = &mut memory.events.sensed;
        sensed.iter_mut().for_each(|[a, b]| (*a, *b) = ((*a).min(*b), (*a).max(*b)));
        sensed.sort_unstable();
        sensed.dedup();
        if settings.on_touch != OnTouch::Bounce {
            let sensed = std::mem::take(sensed);
            self.record_pairs(&sensed);
            self.memory.events.sensed = sensed;
            return self.store();
        }
        let sensed = sensed.iter().map(|&pair| (pair, [0.0; 2]));
        let touched = pairs.chain(sensed).chain(memory.touched_before.iter().copied());
        let touched = touched.map(|([a, b], impulses)| {
            let pair = [a.min(b), a.max(b)];
            let image = settings.container.nearest_image(|| {
                let [p, q] = pair.map(|place| motions.position(place).map(f64::from));
                [0, 1].map(|k| q[k] - p[k])
            });
            (pair, image, impulses)
        });
        self.contacts.keep_lasting(touched, particles, particles.len());
        self.contacts.each(threads, |contact| contact.measure(motions));
        self.store()
    }
}

/// Moves some pairs from lists to others, which are empty.
fn take(from: &mut Lists, to: &mut Lists, is_taken: impl Fn([u32; 2]) -> bool) {
    to.extend(from.iter_mut().map(|(image, pairs)| {
        let taken = pairs.iter().copied().filter(|&pair| is_taken(pair)).collect();
        pairs.retain(|&pair| !is_taken(pair));
        (*image, taken)
    }));
}
