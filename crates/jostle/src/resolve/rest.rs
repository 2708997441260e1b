//! What leans on each other: sequential impulses with accumulated clamping.
//!
//! Each contact keeps the sum of its impulses and never lets it pull (E. Catto,
//! *Iterative Dynamics with Temporal Coherence*, 2005). Starting from the sums of
//! the step before, a pile finds its balance over several steps, and small
//! sub-steps with few rounds beat one step with many (M. Macklin et al., *Small
//! Steps in Physics Simulation*, 2019). A contact that is still open may close
//! its gap within the sub-step, no faster.

use super::Rules;
use crate::contacts::Contact;
use crate::container::MAX_WALLS;
use crate::motion::{Motion, Motions};

/// Whether the contact changes slowly enough to be taken as flat. What passes
/// at speed is left to the impacts and the guard.
fn is_slow(contact: &Contact, a: &Motion, b: &Motion) -> bool {
    let way = [0, 1].map(|k| b.travel[k] - a.travel[k]);
    way[0] * way[0] + way[1] * way[1] <= 0.25 * contact.reach * contact.reach
}

/// Gives the motion a push of `speed` along `direction` for the whole sub-step.
fn pushed(motion: Motion, direction: [f32; 2], speed: f32, h: f32) -> Motion {
    let change = direction.map(|v| v * speed);
    Motion {
        velocity: [0, 1].map(|k| motion.velocity[k] + change[k]),
        travel: [0, 1].map(|k| motion.travel[k] + change[k] * h),
        ..motion
    }
}

fn apply(contact: &Contact, motions: &Motions, [a, b]: [Motion; 2], impulse: f32, h: f32) {
    let [inverse_a, inverse_b] = contact.inverse_masses;
    if inverse_a > 0.0 {
        motions.set(contact.places[0], pushed(a, contact.normal, -impulse * inverse_a, h));
    }
    if inverse_b > 0.0 {
        motions.set(contact.places[1], pushed(b, contact.normal, impulse * inverse_b, h));
    }
}

/// Starts from the impulse of the sub-step before.
pub fn start(contact: &mut Contact, motions: &Motions, h: f32) {
    if contact.impulse == 0.0 {
        return;
    }
    let pair = contact.places.map(|place| motions.get(place));
    if !is_slow(contact, &pair[0], &pair[1]) {
        contact.impulse = 0.0;
        return;
    }
    apply(contact, motions, pair, contact.impulse, h);
}

/// Corrects the impulse so that the two do not come closer than touching.
pub fn between(contact: &mut Contact, motions: &Motions, h: f32) {
    let pair = contact.places.map(|place| motions.get(place));
    let [a, b] = &pair;
    let n = contact.normal;
    let parting = (0..2).map(|k| n[k] * (b.velocity[k] - a.velocity[k])).sum::<f32>();
    let spare = parting + contact.gap.max(0.0) / h;
    if (spare >= 0.0 && contact.impulse == 0.0) || !is_slow(contact, a, b) {
        return;
    }
    let [inverse_a, inverse_b] = contact.inverse_masses;
    let impulse = (contact.impulse - spare / (inverse_a + inverse_b)).max(0.0);
    let change = impulse - contact.impulse;
    contact.impulse = impulse;
    contact.touched |= impulse > 0.0;
    apply(contact, motions, pair, change, h);
}

/// As [`start`], for one particle and its walls.
pub fn start_on_walls(
    place: u32,
    motions: &Motions,
    radius: f32,
    pushes: &mut [f32; MAX_WALLS],
    rules: &Rules,
    h: f32,
) {
    if *pushes == [0.0; MAX_WALLS] {
        return;
    }
    let mut motion = motions.get(place);
    let walls = rules.container.walls(motion.position, radius);
    for (wall, push) in walls.iter().zip(pushes) {
        match wall {
            Some(wall) => motion = pushed(motion, wall.inward, *push, h),
            None => *push = 0.0,
        }
    }
    motions.set(place, motion);
}

/// As [`between`], for one particle and its walls.
pub fn on_walls(
    place: u32,
    motions: &Motions,
    radius: f32,
    pushes: &mut [f32; MAX_WALLS],
    rules: &Rules,
    h: f32,
) {
    let mut motion = motions.get(place);
    let walls = rules.container.walls(motion.position, radius);
    for (wall, push) in walls.iter().zip(pushes) {
        let Some(wall) = wall else { continue };
        let parting = (0..2).map(|k| wall.inward[k] * motion.velocity[k]).sum::<f32>();
        let spare = parting + wall.gap.max(0.0) / h;
        if spare < 0.0 || *push > 0.0 {
            let new = (*push - spare).max(0.0);
            motion = pushed(motion, wall.inward, new - *push, h);
            *push = new;
        }
    }
    motions.set(place, motion);
}
