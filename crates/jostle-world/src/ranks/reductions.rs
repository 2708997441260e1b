//! What the particles of all ranks require, and what they have together.

use super::domain::{domain_of, domain_of_mut};
use super::ghosts::exchange_neighbors;
use super::migration::rebalance;
use crate::world::World;
use crate::world::contacts::loses_energy;
use crate::world::plan::are_own_lossless;
use crate::world::sums::energy_in_forces;
use jostle_base::error::Result;
use jostle_base::parallel::locked;

/// Finds out whether any rank has collisions that lose energy, on which the automatic number of
/// sub-steps depends. All ranks call it after a change.
pub fn agree_on_losses(world: &mut World) -> Result<()> {
    let Some(domain) = domain_of(world) else { return Ok(()) };
    let own = (0..).zip(&world.bodies.awake.rows).filter(|(_, row)| domain.owns(**row));
    let is_lossy = !world.boundaries.walls.are_elastic()
        || own.map(|of| of.0).any(|index| loses_energy(&world.bodies.awake.particles, index));
    let is_lossy = world.halo().any(is_lossy)?;
    domain_of_mut(world).is_lossless = !is_lossy;
    Ok(())
}

/// Finds out what the particles that are awake require on all ranks, and how many these are.
pub(super) fn sum_up(world: &mut World) -> Result<()> {
    let has_friction = world.bodies.awake.particles.has_friction();
    let moving = (0..world.bodies.awake.rows.len())
        .any(|index| !world.bodies.awake.particles.is_static(index));
    // One message for all that a step needs to know of the others, instead of one for each
    // question.
    let flags = [!are_own_lossless(world), has_friction, moving].map(u64::from);
    let counts =
        [world.bodies.awake.rows.len(), world.bodies.asleep.len()].map(|count| count as u64);
    let own = [flags[0], flags[1], flags[2], counts[0], counts[1]];
    let (rows, domain) = (world.bodies.awake.rows.len(), domain_of_mut(world));
    let load =
        [domain.work * rows as f64, domain.received.iter().sum::<usize>() as f64].map(f64::to_bits);
    let all =
        locked(&domain.group).gather([own[0], own[1], own[2], own[3], own[4], load[0], load[1]])?;
    let sum = |k: usize| all.iter().map(|of| of[k]).sum::<u64>();
    let [inelastic, frictions, moving, awake, asleep] = [0, 1, 2, 3, 4].map(sum);
    let loads = |k: usize| all.iter().map(move |of| f64::from_bits(of[k]));
    domain.note_load(loads(5), loads(6).sum());
    (domain.is_lossless, domain.has_friction) = (inelastic == 0, frictions > 0);
    (domain.awake, domain.asleep) = (awake as usize, asleep as usize);
    domain.is_still = asleep > 0 && moving == 0;
    // Ranks exchange angular velocities if any particle has friction, so all need the column.
    if frictions > 0 {
        world.bodies.awake.particles.spins_mut();
    }
    Ok(())
}

/// The part of this rank in the energy of forces between kinds. All ranks call it, in a world without
/// ghosts, and it then has ghosts that no step can use.
pub fn own_energy_of_pairs(world: &mut World) -> Result<f64> {
    if world.halo.is_whole() {
        return energy_in_forces(world);
    }
    // Immovable particles get ghosts, too.
    world.settings.track_events = true;
    rebalance(world)?;
    exchange_neighbors(world)?;
    energy_in_forces(world)
}
