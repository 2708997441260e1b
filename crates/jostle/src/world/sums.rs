//! A world summed up: momentum, energies, and one number for its state.

use super::World;
use crate::particles::Particles;

impl World {
    /// Sum of mass times velocity.
    pub fn momentum(&self) -> [f64; 2] {
        let Particles { masses, velocities, .. } = &self.particles;
        let all = masses.iter().zip(velocities);
        all.fold([0.0; 2], |sum, (&m, v)| [0, 1].map(|k| sum[k] + f64::from(m) * f64::from(v[k])))
    }

    /// Sum of ½ m v².
    pub fn kinetic_energy(&self) -> f64 {
        let Particles { masses, velocities, .. } = &self.particles;
        let energy = |(&m, v): (&f32, &[f32; 2])| {
            let [x, y] = v.map(f64::from);
            0.5 * f64::from(m) * (x * x + y * y)
        };
        masses.iter().zip(velocities).map(energy).sum()
    }

    /// Sum of −m g·x over everything movable: energy in the field of gravity.
    pub fn potential_energy(&self) -> f64 {
        let Particles { masses, positions, movable, .. } = &self.particles;
        let [gx, gy] = self.settings.gravity.map(f64::from);
        let all = masses.iter().zip(positions).zip(movable);
        let energy = |((&m, p), _): ((&f32, &[f32; 2]), &bool)| {
            -f64::from(m) * (gx * f64::from(p[0]) + gy * f64::from(p[1]))
        };
        all.filter(|&(_, &movable)| movable).map(energy).sum()
    }

    /// 64 bits that are the same for the same particles on every platform.
    pub fn state_hash(&self) -> u64 {
        let all = self.particles();
        let mut hash = 0xcbf2_9ce4_8422_2325u64;
        let mut mix = |word: u32| {
            hash = (hash ^ u64::from(word)).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(23);
        };
        mix(all.len() as u32);
        for row in 0..all.len() {
            let ([x, y], [u, v]) = (all.positions[row], all.velocities[row]);
            let own = [all.radii[row], all.masses[row], all.restitutions[row]];
            [x, y, u, v].iter().chain(&own).for_each(|value| mix(value.to_bits()));
            mix(u32::from(all.movable[row]));
        }
        hash
    }
}
