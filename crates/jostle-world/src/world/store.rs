//! The motions of a step: loaded from the columns before the sub-steps, and stored into them at the end.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};

use super::bodies::discs::{Discs, Persistent};
use super::plan::Plan;
use super::turns::count_turns;
use super::{OnTouch, World};
use crate::motion::{self, Motion, Motions, Spins};
use crate::particles::{FARTHEST, Particles, wrap_angle};
use jostle_base::error::{Error, Result};
use jostle_base::{memory, parallel};
use jostle_index::period::Period;

/// Particles that one thread stores at a time.
const STORED: usize = 1 << 14;

/// Loads positions and velocities of all particles for the sub-steps. In a gas the first flight reads
/// the columns and writes all motions, so nothing is to be loaded. That relies on an invariant: between the
/// beginning of a part and its first events nothing writes `motions`. What changes velocities before is in the kicks.
pub(crate) fn load_motions(
    particles: &Particles,
    on_touch: OnTouch,
    plan: &Plan,
    (motions, spins): (&mut Motions, &mut Spins),
) -> Result<()> {
    motions.resize(particles.len(), on_touch == OnTouch::Merge)?;
    let motions = &*motions;
    if plan.has_kicks() || !particles.spins.is_empty() {
        parallel::for_rows(plan.threads, particles.len(), |index| {
            motions.set(index as u32, Motion::of(particles, index));
        });
    }
    spins.fill(&particles.spins)
}

/// Stores positions and velocities in the columns, and the impulses of contacts for warm starting.
pub(crate) fn store_motions(world: &mut World, threads: Option<usize>) -> Result<()> {
    if let Some(contact) = world.contacts.remember(world.bodies.awake.particles.len()) {
        let index = contact.indices[0] as usize;
        return Err(not_finite(world, "contact_impulses", index, "inf"));
    }
    let World { bodies, boundaries, settings, scratch, .. } = &mut *world;
    let are_finite = boundaries.pushes.iter().all(|impulse| impulse.pushes[0].is_finite());
    let motions = (&scratch.motions, &scratch.spins);
    let period = settings.container.period();
    if !period.is_none() {
        let Discs { persistent: Persistent { turns, .. }, rows, .. } = &mut bodies.awake;
        memory::resize_default(turns, rows.len())?;
        let motions = &scratch.motions;
        let position = |index: usize| motions.position(index as u32);
        let residual = |index: usize| motions.residual(index as u32);
        count_turns(turns, (position, residual), &period, threads);
    }
    if are_finite & write(&mut bodies.awake.particles, motions, &period, threads) {
        Ok(())
    } else {
        Err(name_what_is_not_finite(world))
    }
}

/// Writes motions into the columns of the particles; returns whether all are finite.
fn write(
    particles: &mut Particles,
    (motions, all_spins): (&Motions, &Spins),
    period: &Period<f32>,
    threads: Option<usize>,
) -> bool {
    let Particles { positions, residuals, velocities, spins, .. } = particles;
    let any = AtomicBool::new(false);
    let chunks = || (0..).step_by(STORED);
    let columns = positions.chunks_mut(STORED).zip(residuals.chunks_mut(STORED));
    let columns = columns.zip(velocities.chunks_mut(STORED)).zip(chunks());
    parallel::for_each(threads, columns, |(((positions, residuals), velocities), first)| {
        let columns = positions.iter_mut().zip(residuals).zip(velocities).zip(first..);
        for (((position, residual), velocity), index) in columns {
            let mut motion = motions.get(index);
            // Numbers that are only too large become the limit. Those that are not finite
            // refuse the step, which is undone then, so it does not matter what is stored here.
            if !is_allowed(&motion) {
                if !is_finite(&motion) {
                    // Relaxed, here and below: the value is read after all threads have joined.
                    any.store(true, Ordering::Relaxed);
                }
                clamp(&mut motion);
            }
            (*position, *residual) = motion::wrapped(motion.position, motion.residual, period);
            *velocity = motion.velocity;
        }
    });
    parallel::for_chunks(threads, spins, |first, spins| {
        for (spin, index) in spins.iter_mut().zip(first as u32..) {
            let (velocity, angle) = (all_spins.velocity(index), all_spins.angle(index));
            if !velocity.is_finite() {
                any.store(true, Ordering::Relaxed);
            }
            spin.velocity = velocity.clamp(-FARTHEST, FARTHEST);
            spin.angle = wrap_angle(angle);
        }
    });
    !any.into_inner()
}

/// Returns an error with the first row whose number is not finite after the sub-steps.
fn name_what_is_not_finite(world: &World) -> Error {
    let motion = |index: usize| world.scratch.motions.get(index as u32);
    let infinite = world.boundaries.pushes.iter().filter(|impulse| !impulse.pushes[0].is_finite());
    let infinite: HashMap<u32, f32> =
        infinite.map(|impulse| (impulse.row, impulse.pushes[0])).collect();
    let push =
        |index: usize| infinite.get(&world.bodies.awake.rows[index]).copied().unwrap_or_default();
    let spins = &world.scratch.spins;
    let spin = |index: usize| {
        if spins.is_empty() { 0.0 } else { spins.velocity(index as u32) }
    };
    let bad = |&index: &usize| {
        !(is_finite(&motion(index)) && push(index).is_finite() && spin(index).is_finite())
    };
    // The smallest id makes the error the same for every order and number of threads.
    let index = (0..world.bodies.awake.rows.len()).filter(bad).min_by_key(|&index| {
        world.halo.id_among_all(&world.bodies.ids, world.bodies.awake.rows[index])
    });
    let index = index.expect("only called if there is one");
    let Motion { position, velocity, .. } = motion(index);
    let columns: [(&str, &[f32]); 4] = [
        ("angular_velocities", &[spin(index)]),
        ("velocities", &velocity),
        ("positions", &position),
        ("wall_impulses", &[push(index)]),
    ];
    let broken = columns.into_iter().find(|(_, numbers)| !numbers.iter().all(|v| v.is_finite()));
    let (argument, numbers) = broken.expect("one of them is not finite");
    let numbers: Vec<String> = numbers.iter().map(ToString::to_string).collect();
    not_finite(world, argument, index, &format!("({})", numbers.join(", ")))
}

fn not_finite(world: &World, argument: &'static str, at: usize, value: &str) -> Error {
    let row = world.bodies.awake.rows[at];
    let id = world.halo.id_among_all(&world.bodies.ids, row);
    // Ids of a distributed world have no gaps.
    let index = if world.halo.is_whole() { row as usize } else { id as usize };
    Error::NotFinite { argument, index, id, value: value.to_string() }
}

/// Whether all numbers are finite and not too large.
#[inline(always)]
fn is_allowed(Motion { position: [x, y], velocity: [u, v], .. }: &Motion) -> bool {
    let is_small = |value: &f32| value.abs() <= FARTHEST;
    // Without short circuits, so that there is no branch for each number.
    is_small(x) & is_small(y) & is_small(u) & is_small(v)
}

/// Makes numbers that are too large the largest allowed ones.
fn clamp(motion: &mut Motion) {
    let allowed = |vector: [f32; 2]| vector.map(|v| v.clamp(-FARTHEST, FARTHEST));
    // The residual belongs to the position before.
    if allowed(motion.position) != motion.position {
        motion.residual = [0.0; 2];
    }
    motion.position = allowed(motion.position);
    motion.velocity = allowed(motion.velocity);
}

/// Whether a step may end with these numbers.
#[inline(always)]
fn is_finite(motion: &Motion) -> bool {
    motion.position.iter().chain(&motion.velocity).all(|value| value.is_finite())
}
