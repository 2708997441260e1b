//! The step of a world of elastic collisions: events in the order of time.

use super::feel::{accelerate, springs};
use super::settings::DEFAULT_SUBSTEPS;
use super::{Memory, OnTouch, Stage, World, merge};
use crate::error::Result;
use crate::events::Flight;
use crate::flow::Flow;
use crate::forces;
use crate::interrupt;
use crate::motion::Motion;
use crate::parallel;
use crate::resolve::{self, Rules, Scene};

use super::bounds::StepBounds;

/// Overlap, as a share of the sum of radii, from which positions are corrected.
const OVERLAP: f32 = 0.003;

impl World {
    /// Whether all collisions are elastic and no force is `Springs`. Such a world needs no resting
    /// contacts.
    pub(super) fn is_exact(&self) -> bool {
        let elastic = |&restitution: &f32| restitution == 1.0;
        self.settings.restitution == 1.0
            && self.particles.restitutions.iter().all(elastic)
            && springs(&self.forces).next().is_none()
    }

    /// Sub-steps of a step: those of the settings, or as many as the scene needs. One is enough
    /// where flights between collisions are exact.
    pub fn substeps(&self) -> usize {
        let is_enough = self.is_exact() && !forces::pull(&self.forces);
        self.settings.substeps.unwrap_or(if is_enough { 1 } else { DEFAULT_SUBSTEPS })
    }

    /// The neighbours of all particles from the candidate pairs. Pairs that overlap more than
    /// rounding explains become contacts, whose positions are corrected.
    pub(super) fn prepare_events(&mut self) {
        let threads = self.threads();
        let Memory { tree, pairs, overlaps, meetings, fast, moving, exhausted, events, .. } =
            &mut self.memory;
        moving.clone_from(&self.particles.movable);
        meetings.clear();
        if self.settings.on_touch == OnTouch::Merge {
            merge::expect(pairs, &self.particles, meetings);
            pairs.clear();
        }
        if !fast.held.is_empty() {
            let (rows, held) = (&self.rows, &fast.held);
            let is_free = |place: usize| !held[rows[place] as usize];
            let free = |pair: &[u32; 2]| pair.iter().all(|&place| is_free(place as usize));
            pairs.iter_mut().for_each(|(_, pairs)| pairs.retain(free));
            moving.iter_mut().enumerate().for_each(|(place, moves)| *moves &= is_free(place));
        }
        if !exhausted.is_empty() {
            let places = self.rows.iter().zip(moving.iter_mut());
            places.for_each(|(row, moves)| *moves &= exhausted.binary_search(row).is_err());
        }
        let (particles, restitution) = (&self.particles, self.settings.restitution);
        let overlap = |[a, b]: [u32; 2], image: [f32; 2]| {
            let [p, q] = [a, b].map(|place| particles.positions[place as usize]);
            let [x, y] = [0, 1].map(|k| q[k] - p[k] + image[k]);
            let reach = particles.radii[a as usize] + particles.radii[b as usize];
            let reach = reach * (1.0 - OVERLAP);
            x * x + y * y < reach * reach
        };
        events.neighbors.fill(particles.len(), pairs);
        overlaps.clear();
        for (image, pairs) in pairs.iter() {
            let mut found = pairs.clone();
            found.retain(|&pair| overlap(pair, *image));
            found.sort_unstable();
            overlaps.push((*image, found));
        }
        self.contacts.collect(overlaps, particles, restitution, tree.rows(), threads);
    }

    /// Moves the particles through the sub-steps and stores where they are then.
    pub(super) fn fly(&mut self, dt: f32, watch: &mut (dyn FnMut(Stage) + Send)) -> Result<()> {
        let (threads, substeps) = (self.threads(), self.substeps());
        let settings = &self.settings;
        let rules = Rules {
            gravity: settings.gravity,
            drag: settings.drag,
            restitution: settings.restitution,
            container: settings.container,
            rest_speed: 0.0,
            thermostat: forces::thermostat(&self.forces),
            threads,
        };
        self.wall_pushes.fill(Default::default());
        let memory = &mut self.memory;
        memory.motions.resize(self.particles.len());
        let (motions, particles) = (&memory.motions, &self.particles);
        parallel::for_rows(threads, particles.len(), |place| {
            let (position, velocity) = (particles.positions[place], particles.velocities[place]);
            motions.set(place as u32, Motion { position, velocity, ..Motion::default() });
        });
        let mut bounds = StepBounds::new(
            &memory.tree,
            particles,
            &mut memory.reaches,
            &mut memory.grown,
            settings.container,
        );
        let mut scene = Scene {
            particles,
            motions,
            sweeps: &[],
            contacts: &mut self.contacts,
            wall_pushes: &mut self.wall_pushes,
            memory: &mut memory.resolving,
        };
        memory.events.bounced.clear();
        memory.events.exhausted.clear();
        let h = f64::from(dt) / substeps as f64;
        let flow = Flow::new(h, settings.gravity, settings.drag);
        let step = dt / substeps as f32;
        for substep in 0..substeps {
            interrupt::check()?;
            if substep > 0 && forces::pull(&self.forces) {
                watch(Stage::Resolve);
                memory.forces.find_halfway(motions, &settings.container, step);
                accelerate(&self.forces, particles, settings, &mut memory.forces);
                watch(Stage::Forces);
            }
            let flight = Flight {
                particles,
                movable: &memory.moving,
                motions,
                candidates: &memory.pairs,
                gravity: flow.gravity,
                end: flow.duration,
                flow,
                accelerations: &memory.forces.accelerations,
                kicks: flow.kicks,
                bounded: substep == 0,
                container: settings.container,
                restitution: settings.restitution,
                thermostat: rules.thermostat,
                pairs: settings.on_touch == OnTouch::Bounce,
                threads,
            };
            memory.events.fly(&flight, &mut bounds)?;
            resolve::settle(&mut scene, &rules);
            merge::note(&mut memory.meetings, motions, threads);
        }
        let exhausted = memory.events.exhausted.iter().map(|&place| self.rows[place as usize]);
        memory.exhausted.extend(exhausted);
        memory.exhausted.sort_unstable();
        self.stats.unresolved = memory.exhausted.len() as u64;
        memory.events.bounced.sort_unstable();
        memory.events.bounced.dedup();
        let touched = memory.events.bounced.iter().chain(&memory.touched_before);
        let touched = touched.map(|&[a, b]| {
            let pair = [a.min(b), a.max(b)];
            let [p, q] = pair.map(|place| motions.position(place).map(f64::from));
            let offset = [0, 1].map(|k| q[k] - p[k]);
            let nearest = settings.container.short_way(offset);
            (pair, [0, 1].map(|k| (nearest[k] - offset[k]) as f32))
        });
        self.contacts.keep_lasting(touched, particles, particles.len());
        resolve::measure_contacts(&mut self.contacts, motions, threads);
        self.store()
    }
}
