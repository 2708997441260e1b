//! Sums over a world: momentum, energies, and a hash of its state.

use super::World;
use super::force_step::{bodies, find_indices};
use crate::error::Result;
use crate::forces::{self, Attractor, Bodies, Force, Pole};
use crate::particles::{Particles, Spin};
use crate::shapes::Filter;

impl World {
    /// Sum of mass times velocity of the movable particles. Sleeping particles have none.
    pub fn momentum(&self) -> [f64; 2] {
        let all = self.movable_places().map(|at| {
            let mass = f64::from(self.particles.masses[at]);
            self.particles.velocities[at].map(|v| mass * f64::from(v))
        });
        all.fold([0.0; 2], |sum, own| [0, 1].map(|k| sum[k] + own[k]))
    }

    /// Sum of ½ m v² + ½ I ω² of the movable particles, with the moment of inertia I = m r²/2.
    pub fn kinetic_energy(&self) -> f64 {
        let Particles { masses, velocities, radii, .. } = &self.particles;
        let energy = |at: usize| {
            let [x, y] = velocities[at].map(f64::from);
            0.5 * f64::from(masses[at]) * (x * x + y * y)
        };
        let turning = |at: usize| {
            let velocity = f64::from(self.particles.spin(at).velocity);
            let surface_speed = f64::from(radii[at]) * velocity;
            0.25 * f64::from(masses[at]) * (surface_speed * surface_speed)
        };
        let flying: f64 = self.movable_places().map(energy).sum();
        flying + self.movable_places().map(turning).sum::<f64>()
    }

    /// The indices of movable particles that are awake.
    fn movable_places(&self) -> impl Iterator<Item = usize> {
        (0..self.rows.len()).filter(|&at| self.particles.movable[at])
    }

    /// Energy of all movable particles in the field of gravity, and of all forces that have
    /// a potential: attractors (with poles taken as fixed), springs, gravitation, and forces between
    /// kinds if they are equal and opposite.
    pub fn potential_energy(&self) -> f64 {
        let [gx, gy] = self.settings.gravity.map(f64::from);
        let energy = |all: &Particles, at: usize| {
            let p = all.positions[at].map(f64::from);
            -f64::from(all.masses[at]) * (gx * p[0] + gy * p[1])
        };
        let awake = self.movable_places().map(|at| energy(&self.particles, at));
        let asleep = self.asleep.indices();
        let asleep = asleep.map(|at| energy(&self.asleep.sleepers().discs.particles, at));
        let gravity = awake.chain(asleep).sum::<f64>();
        if self.forces.is_empty() { gravity } else { gravity + self.energy_in_forces() }
    }

    /// The part of this rank in the energy of forces between kinds. All ranks call it, in a world without
    /// ghosts, and it then has ghosts that no step can use.
    pub fn own_energy_of_pairs(&mut self) -> Result<f64> {
        // Immovable particles get ghosts, too.
        self.settings.track_events = true;
        self.rebalance()?;
        self.exchange_neighbors()?;
        Ok(self.energy_in_forces())
    }

    fn energy_in_forces(&self) -> f64 {
        let (mut indices, settings) = (Vec::new(), &self.settings);
        find_indices(&self.forces, &self.rows, &mut indices);
        let positions = &self.particles.positions;
        let wrapped: Vec<[f32; 2]> =
            positions.iter().map(|&position| settings.container.wrap(position)).collect();
        let bodies = bodies(&self.particles, &wrapped, (&self.rows, &indices), settings);
        let energy = |force: &Force| match force {
            Force::Attractor(attractor) => self.energy_at(attractor, &bodies),
            Force::Gravitation(gravitation) => forces::gravitation::energy(gravitation, &bodies),
            Force::Springs(springs) => springs.energy(&bodies),
            _ => 0.0,
        };
        let pairs = forces::energy_of_pairs(&self.forces, &bodies, self.own_and_all().0);
        self.forces.iter().map(energy).sum::<f64>() + pairs
    }

    /// Energy of all movable particles in the field of an attractor, which does not act on its
    /// own particle.
    fn energy_at(&self, attractor: &Attractor, bodies: &Bodies<'_>) -> f64 {
        let (pole, own) = match attractor.pole {
            Pole::Point(point) => (point, None),
            Pole::Particle(row) => {
                let index = bodies.indices[row as usize] as usize;
                (bodies.positions[index], Some(index))
            }
        };
        let energy = |index: usize| {
            let position = bodies.positions[index];
            let offset = [0, 1].map(|k| pole[k] - position[k]);
            let offset = bodies.container.minimum_image_within(offset);
            let mass = f64::from(bodies.masses[index]);
            mass * forces::attractor::energy(attractor, offset, bodies.radii[index])
        };
        let felt = |&index: &usize| self.particles.movable[index] && own != Some(index);
        (0..self.rows.len()).filter(felt).map(energy).sum()
    }

    /// A 64-bit hash of the particles, the same on every platform.
    pub fn state_hash(&self) -> u64 {
        let all = self.particles();
        let hash = StateHash::begin(all.len());
        Column::ALL.into_iter().fold(hash, |hash, column| hash.and(&all, column)).0
    }
}

/// The parts of a hash of particles, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// Positions, velocities and all other dense columns.
    Dense,
    /// Friction and rotation.
    Spins,
    /// Categories and masks.
    Filters,
    /// Which are sensors.
    Sensors,
}

impl Column {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Dense, Self::Spins, Self::Filters, Self::Sensors];
}

/// A hash of particles, which may be given in several parts: first a column of all parts, then the next
/// one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StateHash(pub u64);

impl StateHash {
    /// The hash of so many particles, without their columns.
    pub fn begin(count: usize) -> Self {
        let mut hash = Self(0xcbf2_9ce4_8422_2325);
        hash.mix(count as u32);
        hash
    }

    fn mix(&mut self, word: u32) {
        self.0 = (self.0 ^ u64::from(word)).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(23);
    }

    /// The hash with one column of some particles.
    pub fn and(mut self, all: &Particles, column: Column) -> Self {
        // All columns are named, so that none is forgotten.
        #[rustfmt::skip]
        let Particles {
            positions, residuals, velocities, radii, masses, restitutions, movable, spins, filters, sensors,
        } = all;
        let mut mix = |word: u32| self.mix(word);
        match column {
            Column::Dense => {
                for row in 0..all.len() {
                    let ([x, y], [u, v], [a, b]) =
                        (positions[row], velocities[row], residuals[row]);
                    let own = [radii[row], masses[row], restitutions[row]];
                    [x, y, a, b, u, v].iter().chain(&own).for_each(|value| mix(value.to_bits()));
                    mix(u32::from(movable[row]));
                }
            }
            Column::Spins => {
                for Spin { friction, velocity, angle } in spins {
                    let angle = angle.to_bits();
                    let words = [
                        friction.to_bits(),
                        velocity.to_bits(),
                        angle as u32,
                        (angle >> 32) as u32,
                    ];
                    words.into_iter().for_each(&mut mix);
                }
            }
            Column::Filters => {
                for &Filter { category, mask } in filters {
                    [category, mask].into_iter().for_each(&mut mix);
                }
            }
            Column::Sensors => sensors.iter().for_each(|&is_sensor| mix(u32::from(is_sensor))),
        }
        self
    }
}
