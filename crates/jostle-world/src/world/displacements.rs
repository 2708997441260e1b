//! How far particles would travel in a step without collisions: refuses steps in which this is too far, and divides
//! those of particles that merge on a torus.

use super::bodies::Bodies;
use super::distribution::Distribution;
use super::reductions::largest;
use super::{OnTouch, World, WorldSettings};
use crate::container::MAX_TOURS;
use crate::particles::{FARTHEST, Particles};
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;

/// The smallest id of a particle with this `number`, for an error.
pub(crate) fn id_of(
    bodies: &Bodies,
    halo: &dyn Distribution,
    number: f32,
    of: impl Fn(usize) -> f32,
) -> Id {
    // The number comes from the same function, so equality finds its particle. Of several it is
    // the smallest id, which depends on no order.
    let rows = &bodies.awake.rows;
    let indices = (0..rows.len()).filter(|&index| of(index) == number);
    indices.map(|index| halo.id_among_all(&bodies.ids, rows[index])).min().unwrap_or(0)
}

/// The longer side of the box of a particle's displacement without collisions in `dt` seconds,
/// or more.
fn displacement(all: &Particles, settings: &WorldSettings, index: usize, dt: f32) -> f32 {
    let (gravity, v) = (settings.gravity, all.velocities[index]);
    let along = |k: usize| (v[k].abs() + gravity[k].abs() * dt) * dt;
    along(0).max(along(1))
}

/// The largest of these displacements.
fn longest_displacement(all: &Particles, settings: &WorldSettings, dt: f32) -> f32 {
    largest((0..all.len()).map(|index| displacement(all, settings, index, dt)))
}

/// Refuses a step in which a particle would move too far.
pub(crate) fn check_displacements(world: &World, dt: f32) -> Result<()> {
    let World { bodies, settings, halo, .. } = world;
    let particles = &bodies.awake.particles;
    let longest = longest_displacement(particles, settings, dt);
    let tours = longest / settings.container.period().shortest();
    if longest <= FARTHEST && tours <= MAX_TOURS {
        return Ok(());
    }
    let by = |index: usize| displacement(particles, settings, index, dt);
    let id = id_of(bodies, &**halo, longest, by);
    let rule = if longest > FARTHEST {
        let most = FARTHEST;
        format!("particle {id} would move by {longest:e}, more than {most:e}")
    } else {
        format!("particle {id} would travel {tours} times the period; take smaller steps")
    };
    Err(Error::of("dt", dt, &rule))
}

/// The number of parts of a step of `dt` seconds: one, unless particles merge on a torus. These
/// touch only their nearest images.
pub(crate) fn parts(world: &World, dt: f32) -> Result<usize> {
    if world.settings.on_touch != OnTouch::Merge {
        return Ok(1);
    }
    // The longest of all ranks, because all must make the same number of parts.
    let own = longest_displacement(&world.bodies.awake.particles, &world.settings, dt);
    let [longest] = world.halo().largest([f64::from(own)])?;
    let parts = longest as f32 / world.settings.container.max_reach();
    Ok(parts.ceil().max(1.0) as usize)
}
