//! The forces of a world in a step: accelerations, kicks and springs.

use super::bodies::Bodies;
use super::displacements::id_of;
use super::external::has_accelerations;
use super::{World, WorldSettings};
use crate::container::Container;
use crate::flow::{Flow, Kick};
use crate::forces::{self, ASLEEP, ForceInput, Influences, springs::SpringSolver};
use crate::motion::Motions;
use crate::particles::{self, Particles};
use crate::world::bodies::discs::Discs;
use jostle_base::disjoint_sets::DisjointSets;
use jostle_base::error::{Error, Result};
use jostle_base::interrupt;
use jostle_base::{memory, parallel};

/// Scratch of the forces; unused in a world without them.
#[derive(Debug, Default)]
pub(crate) struct ForceScratch {
    pub(crate) all: forces::Scratch,
    /// The index of each row, where forces name particles.
    pub(crate) indices: Vec<u32>,
    /// Positions of the particles in the middle of the sub-step.
    pub(crate) halfway: Vec<[f32; 2]>,
    /// Their velocities at its beginning.
    pub(crate) velocities: Vec<[f32; 2]>,
    /// Accelerations there; empty if no force has any.
    pub(crate) accelerations: Vec<[f32; 2]>,
    pub(crate) old_accelerations: Vec<[f32; 2]>,
    /// Estimated displacements by springs; empty if there are none.
    pub(crate) spring_displacements: Vec<f32>,
    /// Islands of particles connected by springs.
    pub(crate) groups: DisjointSets,
    pub(crate) sprung: SpringSolver,
    /// Whether any springs are so stiff that they may be solved together with contacts.
    pub(crate) are_springs_stiff: bool,
    /// Scratch: sums over the springs of each particle.
    sums: Vec<[f64; 2]>,
}

impl ForceScratch {
    /// Writes the kicks of the accelerations in a sub-step.
    pub(crate) fn kick(&self, kicks: &mut [Kick], flow: &Flow) {
        for (kick, acceleration) in kicks.iter_mut().zip(&self.accelerations) {
            let by = acceleration.map(f64::from);
            kick.before = by.map(|a| a * flow.kicks[0]);
            kick.after = by.map(|a| a * flow.kicks[1]);
        }
    }

    /// Writes the positions in the middle of a sub-step of `h` seconds.
    pub(crate) fn find_halfway(&mut self, motions: &Motions, container: &Container, h: f32) {
        let columns = self.halfway.iter_mut().zip(&mut self.velocities);
        for ((middle, before), index) in columns.zip(0..) {
            let (position, velocity) = (motions.position(index), motions.velocity(index));
            *before = velocity;
            *middle = container.period().wrap(halfway(position, velocity, h));
        }
    }
}

impl World {
    /// Computes the accelerations of the first sub-step. They do not depend on the
    /// order of the particles, which is not yet that of the step.
    pub(crate) fn apply_forces(&mut self, dt: f32, substeps: usize) -> Result<()> {
        let has_accelerations = has_accelerations(&self.external, &self.influences);
        self.scratch.kicks.clear();
        let settings = &self.settings;
        let scratch = &mut self.scratch.forces;
        scratch.accelerations.clear();
        scratch.spring_displacements.clear();
        scratch.are_springs_stiff = false;
        if self.influences.is_empty() && !self.external.act() {
            return Ok(());
        }
        find_indices(
            &self.influences,
            &self.bodies.awake.rows,
            self.bodies.asleep.len(),
            &mut scratch.indices,
        )?;
        // The sub-steps are those before refinement, which needs the contacts. If there are more in
        // the end, `apply_forces_in_substep` computes the accelerations again.
        let h = dt / substeps as f32;
        let particles = &self.bodies.awake.particles;
        if has_accelerations {
            let all = particles.positions.iter().zip(&particles.velocities);
            // Accelerations where the free flight is in the middle of the sub-step make kicks and
            // flight a leapfrog method, which is symplectic and of second order.
            scratch.halfway.clear();
            let wrap = |there| settings.container.period().wrap(there);
            let all = all.map(|(&p, &v)| wrap(halfway(p, v, h)));
            memory::extend(&mut scratch.halfway, all)?;
            memory::assign(&mut scratch.velocities, &particles.velocities)?;
            self.accelerate(h)?;
        }
        let Self { influences, bodies, settings, scratch, .. } = &mut *self;
        let scratch = &mut scratch.forces;
        estimate_springs(influences, &bodies.awake, settings, scratch, (dt, substeps))?;
        let ForceScratch { accelerations, spring_displacements, .. } = &self.scratch.forces;
        let particles = &self.bodies.awake.particles;
        let displacement = |index: usize| {
            force_displacement(accelerations.get(index), spring_displacements.get(index), dt)
        };
        // A particle must not leave the range of coordinates. This is refused before anything has
        // moved.
        let longest = (0..particles.len()).filter_map(displacement).fold(0.0, f32::max);
        if longest <= particles::FARTHEST {
            return Ok(());
        }
        let most = particles::FARTHEST;
        let id =
            id_of(&self.bodies, &*self.halo, longest, |index| displacement(index).unwrap_or(0.0));
        let rule = format!("forces would move particle {id} by {longest:e}, more than {most:e}");
        Err(Error::of("dt", dt, &rule))
    }

    /// Computes the accelerations in the middle of a sub-step of `h` seconds.
    pub(crate) fn accelerate(&mut self, h: f32) -> Result<()> {
        // Forces sort by a tree. All ranks need the same extent, or the Morton order would differ.
        let extent = self.everywhere().extent(&self.scratch.forces.halfway)?;
        let Self {
            bodies: Bodies { awake: Discs { particles, rows, .. }, .. },
            external,
            settings,
            scratch,
            ..
        } = self;
        let ForceScratch { all: scratch, indices, halfway, velocities, accelerations, .. } =
            &mut scratch.forces;
        let bodies = force_input(particles, halfway, (rows, indices), settings);
        let bodies = ForceInput { velocities, seconds: h, extent, ..bodies };
        self.influences.accelerate(&bodies, scratch, accelerations)?;
        // External accelerations come after the limits of forces, so the speed limits of a flock do
        // not cut them.
        external.add_to(accelerations, rows);
        interrupt::check()?;
        self.halo.protocol().share_accelerations(self)
    }
}

/// Estimates displacements by springs, and finds out whether any are stiff.
fn estimate_springs(
    influences: &Influences,
    Discs { particles, rows, .. }: &Discs,
    settings: &WorldSettings,
    scratch: &mut ForceScratch,
    (dt, substeps): (f32, usize),
) -> Result<()> {
    let h = f64::from(dt) / substeps as f64;
    let ForceScratch { indices, groups, spring_displacements, sums, are_springs_stiff, .. } =
        scratch;
    let all = awake_springs(influences, indices);
    if all.clone().next().is_none() {
        return Ok(());
    }
    let bodies = force_input(particles, &particles.positions, (rows, indices), settings);
    *are_springs_stiff =
        forces::springs::are_stiff(all.clone(), &bodies, &particles.movable, h, sums)?;
    let velocities = &particles.velocities;
    forces::springs::estimate_displacements(
        all,
        &bodies,
        velocities,
        dt,
        groups,
        spring_displacements,
    )
}

/// Gives some particles new velocities by Andersen's thermostat, at the end of a step of `dt` seconds that began at
/// a time.
pub(crate) fn apply_andersen(
    influences: &Influences,
    particles: &mut Particles,
    time: f64,
    dt: f32,
    threads: Option<usize>,
) {
    let Some(&andersen) = influences.andersen_thermostats().next() else { return };
    let Particles { positions, residuals, velocities, masses, movable, .. } = particles;
    parallel::for_chunks(threads, velocities, |first, velocities| {
        for (velocity, index) in velocities.iter_mut().zip(first..) {
            // The random numbers follow from the state of the particle, the seed and the time.
            // So they depend on no index, no thread and no other particle.
            let ([x, y], [a, b], [u, v]) = (positions[index], residuals[index], *velocity);
            let state = [x, y, a, b, u, v].map(f64::from);
            let [x, y, a, b, u, v] = state;
            if movable[index]
                && let Some(new) = andersen.velocity(masses[index], dt, &[x, y, a, b, u, v, time])
            {
                *velocity = new;
            }
        }
    });
}

/// Removes springs that are stretched too far.
pub(crate) fn break_springs(
    influences: &mut Influences,
    Discs { particles, rows, .. }: &Discs,
    indices: &[u32],
    settings: &WorldSettings,
) {
    let bodies = force_input(particles, &particles.positions, (rows, indices), settings);
    influences.break_springs(&bodies);
}

/// The springs of particles that are awake.
pub(crate) fn awake_springs<'a>(
    influences: &'a Influences,
    indices: &'a [u32],
) -> impl Iterator<Item = &'a forces::Spring> + Clone {
    // A spring joins its movable ends to one island, so both sleep or none. Immovable ends never
    // sleep.
    let is_awake =
        |spring: &&forces::Spring| spring.pair.iter().all(|&row| indices[row as usize] != ASLEEP);
    influences.springs().flat_map(|springs| &springs.0).filter(is_awake)
}

/// Writes the index of each row, if any force or spring refers to particles, of which some are asleep.
pub(crate) fn find_indices(
    influences: &Influences,
    rows: &[u32],
    asleep: usize,
    indices: &mut Vec<u32>,
) -> Result<()> {
    indices.clear();
    if influences.act_by_rows() {
        memory::resize(indices, rows.len() + asleep, ASLEEP)?;
        for (index, &row) in rows.iter().enumerate() {
            indices[row as usize] = index as u32;
        }
    }
    Ok(())
}

/// The particles at some positions, as arguments of the forces, with the row of each index and the
/// index of each row.
pub(crate) fn force_input<'a>(
    particles: &'a Particles,
    positions: &'a [[f32; 2]],
    (rows, indices): (&'a [u32], &'a [u32]),
    settings: &WorldSettings,
) -> ForceInput<'a> {
    let (container, threads) = (settings.container, settings.tree.threads);
    ForceInput {
        positions,
        velocities: &particles.velocities,
        masses: &particles.masses,
        radii: &particles.radii,
        kinds: &particles.kinds,
        movable: &particles.movable,
        rows,
        own_rows: u32::MAX,
        indices,
        container,
        seconds: 0.0,
        method: settings.method,
        threads,
        extent: None,
    }
}

/// Position of a free particle in the middle of a sub-step of `h` seconds.
#[inline]
fn halfway(position: [f32; 2], velocity: [f32; 2], h: f32) -> [f32; 2] {
    [0, 1].map(|k| position[k] + velocity[k] * (0.5 * h))
}

/// Estimated displacement by forces in `dt` seconds, beside that of the velocity.
pub(crate) fn force_displacement(
    acceleration: Option<&[f32; 2]>,
    by_springs: Option<&f32>,
    dt: f32,
) -> Option<f32> {
    // The displacement is ½ |a| dt², and |a| is at most √2 times its larger component. So this is
    // an upper bound of it.
    let pulled = acceleration.map(|a| a[0].abs().max(a[1].abs()) * dt * dt);
    match (pulled, by_springs) {
        (None, None) => None,
        (a, b) => Some(a.unwrap_or(0.0) + b.copied().unwrap_or(0.0)),
    }
}
