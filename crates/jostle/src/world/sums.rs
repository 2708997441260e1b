//! Sums over a world: momentum, energies, and a hash of its state.

use super::World;
use super::feel::{bodies, find_places};
use crate::forces::{self, Attractor, Bodies, Force, Pole};
use crate::parallel;
use crate::particles::{Particles, Spin};
use crate::shapes::Filter;

impl World {
    /// Sum of mass times velocity. Sleeping particles have none.
    pub fn momentum(&self) -> [f64; 2] {
        let Particles { masses, velocities, .. } = &self.particles;
        let all = masses.iter().zip(velocities);
        all.fold([0.0; 2], |sum, (&m, v)| [0, 1].map(|k| sum[k] + f64::from(m) * f64::from(v[k])))
    }

    /// Sum of ½ m v² + ½ I ω², with the moment of inertia I = m r²/2.
    pub fn kinetic_energy(&self) -> f64 {
        let Particles { masses, velocities, radii, spins, .. } = &self.particles;
        let energy = |(&m, v): (&f32, &[f32; 2])| {
            let [x, y] = v.map(f64::from);
            0.5 * f64::from(m) * (x * x + y * y)
        };
        let turning = |((&m, &r), spin): ((&f32, &f32), &Spin)| {
            let surface_speed = f64::from(r) * f64::from(spin.velocity);
            0.25 * f64::from(m) * (surface_speed * surface_speed)
        };
        let flying: f64 = masses.iter().zip(velocities).map(energy).sum();
        flying + masses.iter().zip(radii).zip(spins).map(turning).sum::<f64>()
    }

    /// Energy of all movable particles in the field of gravity, and of all forces that have
    /// a potential: attractors (with poles taken as fixed), springs and gravitation.
    pub fn potential_energy(&self) -> f64 {
        let [gx, gy] = self.settings.gravity.map(f64::from);
        let energy = |all: &Particles, at: usize| {
            let p = all.positions[at].map(f64::from);
            -f64::from(all.masses[at]) * (gx * p[0] + gy * p[1])
        };
        let awake = (0..self.rows.len()).filter(|&at| self.particles.movable[at]);
        let awake = awake.map(|at| energy(&self.particles, at));
        let asleep = self.asleep.indices();
        let asleep = asleep.map(|at| energy(&self.asleep.sleepers().particles, at));
        let gravity = awake.chain(asleep).sum::<f64>();
        if self.forces.is_empty() { gravity } else { gravity + self.energy_in_forces() }
    }

    fn energy_in_forces(&self) -> f64 {
        let (mut places, settings) = (Vec::new(), &self.settings);
        find_places(&self.forces, &self.rows, &mut places);
        let positions = &self.particles.positions;
        let wrapped: Vec<[f32; 2]> =
            positions.iter().map(|&position| settings.container.wrap(position)).collect();
        let bodies = bodies(&self.particles, &wrapped, &places, settings);
        let energy = |force: &Force| match force {
            Force::Attractor(attractor) => self.energy_at(attractor, &bodies),
            Force::Gravitation(gravitation) => forces::gravitation::energy(gravitation, &bodies),
            Force::Springs(springs) => springs.energy(&bodies),
            Force::Thermostat(_) | Force::ThermalWalls(_) | Force::Andersen(_) => 0.0,
        };
        parallel::among(self.threads(), || self.forces.iter().map(energy).sum())
    }

    /// Energy of all movable particles in the field of an attractor, which does not act on its
    /// own particle.
    fn energy_at(&self, attractor: &Attractor, bodies: &Bodies<'_>) -> f64 {
        let (pole, own) = match attractor.pole {
            Pole::Point(point) => (point, None),
            Pole::Particle(row) => {
                let place = bodies.places[row as usize] as usize;
                (bodies.positions[place], Some(place))
            }
        };
        let energy = |place: usize| {
            let position = bodies.positions[place];
            let offset = [0, 1].map(|k| pole[k] - position[k]);
            let offset = forces::nearest(&bodies.container, offset);
            let mass = f64::from(bodies.masses[place]);
            mass * forces::attractor::energy(attractor, offset, bodies.radii[place])
        };
        let felt = |&place: &usize| self.particles.movable[place] && own != Some(place);
        (0..self.rows.len()).filter(felt).map(energy).sum()
    }

    /// A 64-bit hash of the particles, the same on every platform.
    pub fn state_hash(&self) -> u64 {
        let all = self.particles();
        let mut hash = 0xcbf2_9ce4_8422_2325u64;
        let mut mix = |word: u32| {
            hash = (hash ^ u64::from(word)).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(23);
        };
        mix(all.len() as u32);
        for row in 0..all.len() {
            let ([x, y], [u, v]) = (all.positions[row], all.velocities[row]);
            let [a, b] = all.residuals[row];
            let own = [all.radii[row], all.masses[row], all.restitutions[row]];
            [x, y, a, b, u, v].iter().chain(&own).for_each(|value| mix(value.to_bits()));
            mix(u32::from(all.movable[row]));
        }
        for Spin { friction, velocity, angle } in &all.spins {
            let angle = angle.to_bits();
            let words =
                [friction.to_bits(), velocity.to_bits(), angle as u32, (angle >> 32) as u32];
            words.into_iter().for_each(&mut mix);
        }
        for &Filter { category, mask } in &all.filters {
            [category, mask].into_iter().for_each(&mut mix);
        }
        hash
    }
}
