//! How far particles get in a step, from which the bounds, the contacts and the islands that wake follow.

use super::force_step::{ForceScratch, force_displacement};
use super::settings::WorldSettings;
use crate::container::Container;
use crate::particles::Particles;
use crate::resting::TOUCHING;

/// Share of the radius within which surfaces may come to rest, whatever their speeds.
pub(crate) const SLACK: f32 = 0.005;

// Two discs that touch by the rule of resting have a contact whatever their speeds: their slacks together are at least
// `SLACK` times the smaller diameter, of which `TOUCHING` is a share. (A point has no slack of its own.)
const _: () = assert!(TOUCHING < SLACK);

/// Factor that makes an upper bound of a distance. It is a reserve for the rounding of the few operations in float32
/// that computed the distance, which is below 10⁻⁶ in all.
pub(crate) const ROUNDED_UP: f64 = 1.000_01;

/// The reaches of particles by their velocities and by forces, if nothing hits them.
pub(crate) struct FreeReaches<'a> {
    accelerations: &'a [[f32; 2]],
    fall: f32,
    longest: f32,
    dt: f32,
}

impl<'a> FreeReaches<'a> {
    /// Those of a step of `dt` seconds.
    pub(crate) fn new(settings: &WorldSettings, forces: &'a ForceScratch, dt: f32) -> Self {
        let fall = distance_of_fall(settings.gravity, dt);
        let longest = settings.container.max_reach();
        Self { accelerations: &forces.accelerations, fall, longest, dt }
    }

    /// That of a particle.
    pub(crate) fn of(&self, particles: &Particles, index: usize) -> f32 {
        let pulled = || force_displacement(self.accelerations.get(index), None, self.dt);
        let is_movable = particles.movable[index];
        let by_forces = if is_movable { self.fall + pulled().unwrap_or(0.0) } else { 0.0 };
        (distance_at(particles.velocities[index], self.dt) + by_forces).min(self.longest)
    }

    /// That of a particle, but at most the reach of its `bounds`. Where these are made for the whole
    /// step it is the free reach, which depends on no other particle.
    pub(crate) fn within(&self, particles: &Particles, index: usize, bounds: f32) -> f32 {
        self.of(particles, index).min(bounds)
    }
}

/// Upper bound of the distance that a particle travels at a velocity in `dt` seconds.
#[inline(always)]
pub(crate) fn distance_at([u, v]: [f32; 2], dt: f32) -> f32 {
    (u * u + v * v).sqrt() * dt * ROUNDED_UP as f32
}

/// The distance that a particle at rest falls in `dt` seconds.
pub(crate) fn distance_of_fall([x, y]: [f32; 2], dt: f32) -> f32 {
    0.5 * dt * dt * (x * x + y * y).sqrt()
}

/// How far from its surface at the beginning of a step a particle may rest on another: its free
/// displacement, but at most its radius, and a share of its radius for surfaces that nearly touch.
#[inline(always)]
pub(crate) fn rest_distance(free: f32, radius: f32) -> f32 {
    // Without the limit by the radius a fast particle would have a contact with each on its way.
    free.min(radius) + SLACK * radius
}

/// Upper bound of the residual of a position, which on a torus may be that of the far side, and of
/// the error of a distance of about the radius in float32.
pub(crate) fn rounding(position: [f32; 2], radius: f32, container: &Container) -> f32 {
    rounding_of(position, radius, torus_sides(container))
}

#[inline(always)]
pub(crate) fn rounding_of([x, y]: [f32; 2], radius: f32, sides: f32) -> f32 {
    f32::EPSILON * (x.abs() + y.abs() + sides + 4.0 * radius)
}

/// Sum of the sides of a torus; 0 for other containers.
pub(crate) fn torus_sides(container: &Container) -> f32 {
    let [width, height] = container.period().sides();
    width + height
}
