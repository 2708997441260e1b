//! Sums over a world: momentum, energies, and a hash of its state.

use std::ops::Range;

use super::World;
use super::bodies::Bodies;
use super::bodies::discs::Discs;
use super::force_step::{find_indices, force_input};
use crate::container::Container;
use crate::forces::{ForceInput, Influence, Role, Springs};
use crate::particles::Particles;
use jostle_base::bytes::Plain;
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_base::table::{Declared, Kind, Table, Value, Visitor, sparse_value};

impl World {
    /// Sum of mass times velocity of the movable particles. Sleeping particles have none.
    pub fn momentum(&self) -> [f64; 2] {
        let all = movable_indices(&self.bodies.awake.particles).map(|at| {
            let mass = f64::from(self.bodies.awake.particles.masses[at]);
            self.bodies.awake.particles.velocities[at].map(|v| mass * f64::from(v))
        });
        all.fold([0.0; 2], |sum, own| [0, 1].map(|k| sum[k] + own[k]))
    }

    /// Sum of m (r − about) × v + I ω of the movable particles, with the moment of inertia I = m r²/2.
    pub fn angular_momentum(&self, about: [f64; 2]) -> f64 {
        let all = &self.bodies.awake.particles;
        let own = |at: usize| {
            let arm = [0, 1].map(|k| f64::from(all.positions[at][k]) - about[k]);
            let [u, v] = all.velocities[at].map(f64::from);
            let (radius, turning) = (f64::from(all.radii[at]), f64::from(all.spin(at).velocity));
            let moment = arm[0] * v - arm[1] * u + 0.5 * radius * radius * turning;
            f64::from(all.masses[at]) * moment
        };
        movable_indices(all).map(own).sum()
    }

    /// Sum of m (v − u)² of the movable particles over 2 (n − 1), where u is their mean velocity; NaN for fewer
    /// than two.
    pub fn temperature(&self) -> f64 {
        let all = &self.bodies.awake.particles;
        let mass: f64 = movable_indices(all).map(|at| f64::from(all.masses[at])).sum();
        let mean = self.momentum().map(|of| of / mass);
        let energy = |at: usize| {
            let [u, v] = [0, 1].map(|k| f64::from(all.velocities[at][k]) - mean[k]);
            f64::from(all.masses[at]) * (u * u + v * v)
        };
        // Sleeping particles, which are all movable, do not move, apart from the mean.
        let (awake, asleep) = (movable_indices(all).count(), self.bodies.asleep.len());
        if awake + asleep < 2 {
            return f64::NAN;
        }
        movable_indices(all).map(energy).sum::<f64>() / (2 * (awake + asleep - 1)) as f64
    }

    /// Sum of ½ m v² + ½ I ω² of the movable particles, with the moment of inertia I = m r²/2.
    pub fn kinetic_energy(&self) -> f64 {
        let Particles { masses, velocities, radii, .. } = &self.bodies.awake.particles;
        let energy = |at: usize| {
            let [x, y] = velocities[at].map(f64::from);
            0.5 * f64::from(masses[at]) * (x * x + y * y)
        };
        let turning = |at: usize| {
            let velocity = f64::from(self.bodies.awake.particles.spin(at).velocity);
            let surface_speed = f64::from(radii[at]) * velocity;
            0.25 * f64::from(masses[at]) * (surface_speed * surface_speed)
        };
        let flying: f64 = movable_indices(&self.bodies.awake.particles).map(energy).sum();
        flying + movable_indices(&self.bodies.awake.particles).map(turning).sum::<f64>()
    }

    /// Energy of all movable particles in the field of gravity, and of all forces that have
    /// a potential: attractors (with poles taken as fixed), springs, gravitation, and forces between
    /// kinds if they are equal and opposite.
    pub fn potential_energy(&self) -> Result<f64> {
        let [gx, gy] = self.settings.gravity.map(f64::from);
        let energy = |all: &Particles, at: usize| {
            let p = all.positions[at].map(f64::from);
            -f64::from(all.masses[at]) * (gx * p[0] + gy * p[1])
        };
        let awake = movable_indices(&self.bodies.awake.particles)
            .map(|at| energy(&self.bodies.awake.particles, at));
        let asleep = self.bodies.asleep.indices();
        let asleep = asleep.map(|at| energy(&self.bodies.asleep.sleepers().discs.particles, at));
        let gravity = awake.chain(asleep).sum::<f64>();
        let in_forces = if self.influences.is_empty() { 0.0 } else { energy_in_forces(self)? };
        Ok(gravity + in_forces)
    }

    /// A 64-bit hash of the particles but their kinds, the same on every platform.
    pub fn state_hash(&self) -> Result<u64> {
        let all = self.bodies.particles()?;
        let hash = StateHash::begin(all.len());
        Ok(StateHash::parts(&all).into_iter().fold(hash, |hash, part| hash.and(&all, part)).0)
    }
}

/// The indices of movable particles.
fn movable_indices(all: &Particles) -> impl Iterator<Item = usize> {
    (0..all.len()).filter(|&at| all.movable[at])
}

/// Energy of the forces that have a potential.
pub(crate) fn energy_in_forces(world: &World) -> Result<f64> {
    let World { bodies: all, settings, influences, halo, .. } = world;
    let Discs { particles, rows, .. } = &all.awake;
    let mut indices = Vec::new();
    find_indices(influences, rows, all.asleep.len(), &mut indices)?;
    let wrap = |&position: &[f32; 2]| settings.container.period().wrap(position);
    let wrapped = memory::collect(particles.positions.iter().map(wrap))?;
    let bodies = force_input(particles, &wrapped, (rows, &indices), settings);
    let bodies = ForceInput { own_rows: halo.own_rows(), ..bodies };
    let of_influence = |influence: &Influence| match influence.role() {
        Role::Force(force) => force.energy(&bodies),
        Role::Springs(springs) => energy_of_springs(springs, all, &settings.container),
        Role::Motor(_)
        | Role::Thermostat(_)
        | Role::ThermalWalls(_)
        | Role::Andersen(_)
        | Role::Pump(_) => Ok(0.0),
    };
    influences.list().iter().map(of_influence).sum()
}

/// Energy of springs, also between sleeping particles.
fn energy_of_springs(springs: &Springs, bodies: &Bodies, container: &Container) -> Result<f64> {
    let mut positions = memory::filled(bodies.len(), [0.0; 2])?;
    for (row, index) in bodies.rows_and_indices() {
        let (all, at) = bodies.disc_at(index as usize);
        positions[row as usize] = container.period().wrap(all.positions[at]);
    }
    springs.energy(&positions, container)
}

/// A hash of particles, of one part of their columns after the other. Part 0 is all dense columns, row by row;
/// part k is the k-th sparse column. Each part may be hashed in several calls with successive rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StateHash(pub u64);

impl StateHash {
    /// The hash of so many particles, without their columns.
    pub fn begin(count: usize) -> Self {
        // The offset basis of the hash FNV-1a, and in `mix` its prime. Words are mixed instead of
        // bytes, and the rotation brings the high bits to where the next word changes them.
        let mut hash = Self(0xcbf2_9ce4_8422_2325);
        hash.mix(count as u32);
        hash
    }

    /// The parts that the hash of these particles has: sparse columns with default values alone are left out.
    pub fn parts(all: &Particles) -> Vec<usize> {
        let mut parts = Parts { found: vec![0], sparse: 0 };
        all.visit(&mut parts);
        parts.found
    }

    /// The hash with one part of some particles.
    pub fn and(mut self, all: &Particles, part: usize) -> Self {
        let len = all.len();
        let count = if part == 0 { 1 } else { len.max(1) };
        for first in (0..len).step_by(count) {
            let rows = first..first + count;
            all.visit(&mut HashedRows { hash: &mut self, rows, part, sparse: 0 });
        }
        self
    }

    fn mix(&mut self, word: u32) {
        self.0 = (self.0 ^ u64::from(word)).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(23);
    }

    /// Mixes in the bytes of a value as words; the last one is filled up with 0.
    pub(super) fn mix_value<P: Plain>(&mut self, value: P) {
        const LARGEST: usize = 16;
        const { assert!(P::SIZE <= LARGEST) };
        let mut bytes = [0; LARGEST];
        value.store(&mut bytes[..P::SIZE]);
        let (words, _) = bytes[..P::SIZE.next_multiple_of(4)].as_chunks::<4>();
        words.iter().for_each(|word| self.mix(u32::from_le_bytes(*word)));
    }
}

/// Whether a column is a part of the hash. Kinds belong to forces, as their tables do, which are no part either.
fn is_hashed(about: Declared) -> bool {
    about.name != "kinds"
}

/// Lists the parts of a hash.
struct Parts {
    found: Vec<usize>,
    /// Sparse columns so far.
    sparse: usize,
}

impl Visitor for Parts {
    fn column<V: Value>(&mut self, about: Declared, column: &[V]) {
        if about.kind == Kind::Sparse {
            self.sparse += 1;
            if !column.is_empty() && is_hashed(about) {
                self.found.push(self.sparse);
            }
        }
    }
}

/// Adds some rows of one part to a hash.
struct HashedRows<'a> {
    hash: &'a mut StateHash,
    rows: Range<usize>,
    part: usize,
    /// Sparse columns so far.
    sparse: usize,
}

impl Visitor for HashedRows<'_> {
    fn column<V: Value>(&mut self, about: Declared, column: &[V]) {
        let is_sparse = about.kind == Kind::Sparse;
        self.sparse += usize::from(is_sparse);
        if self.part == if is_sparse { self.sparse } else { 0 } {
            self.rows.clone().for_each(|row| self.hash.mix_value(sparse_value(column, row)));
        }
    }
}
