//! Nothing passes through anything.
//!
//! The bounces of a sub-step are found in rounds, and a crowd of fast particles
//! can have more of them than there are rounds. So before anything moves, the
//! straight line from each fast pair's first offset to its last is tested: if it cuts
//! through the contact, both displacements are truncated where it enters. Displacements
//! only get shorter, and 0 is always allowed, so this ends. A long row of particles could
//! need as many passes as it has members: after `MOST_PASSES` passes, the whole row
//! stops.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::contacts::{Contact, Contacts};
use crate::groups::Groups;
use crate::motion::{Motion, Motions};

/// Passes that shorten to the point of touching; later ones stop at the start.
const GENTLE_PASSES: usize = 8;

/// Maximum number of passes. Islands that are still being shortened then stop.
const MOST_PASSES: usize = 64;

/// How deep a line may cut, as a share of the sum of radii: a rounded bounce is
/// no passage.
const TOLERANCE: f32 = 0.95;

/// Shortens the ways of everything that would pass through something.
pub fn guard(contacts: &mut Contacts, motions: &Motions, threads: Option<usize>) {
    let any_fast = AtomicBool::new(false);
    contacts.each(threads, |contact| {
        contact.fast = may_get_through(contact, motions);
        if contact.fast {
            any_fast.store(true, Ordering::Relaxed);
        }
    });
    if !any_fast.into_inner() {
        return;
    }
    for pass in 0..MOST_PASSES {
        let any = AtomicBool::new(false);
        contacts.solve(threads, |contact, colour| {
            // What has not been shortened since it was looked at last is still free.
            let shortened = |place| motions.turn(place) >= turn(pass.max(1) - 1, colour);
            if !contact.fast || (pass > 0 && !contact.places.into_iter().any(shortened)) {
                return;
            }
            if let Some(share) = free_share(contact, motions) {
                let share = if pass < GENTLE_PASSES { share } else { 0.0 };
                shorten(contact, motions, share, turn(pass, colour));
                any.store(true, Ordering::Relaxed);
            }
        });
        if !any.into_inner() {
            return;
        }
    }
    stop_islands(contacts, motions);
}

/// Stops every island of fast contacts in which the last pass has truncated a displacement. No
/// other contact can be cut through (see [`may_get_through`]).
fn stop_islands(contacts: &Contacts, motions: &Motions) {
    let fast = || contacts.list.iter().filter(|contact| contact.fast);
    let mut islands = Groups::default();
    islands.reset(motions.len());
    for contact in fast().filter(|contact| !contact.inverse_masses.contains(&0.0)) {
        islands.join(contact.places[0], contact.places[1]);
    }
    let mut stops = vec![false; motions.len()];
    for place in fast().flat_map(|contact| contact.places) {
        if motions.turn(place) >= turn(MOST_PASSES - 1, 0) {
            stops[islands.root(place) as usize] = true;
        }
    }
    for place in fast().flat_map(|contact| contact.places) {
        if stops[islands.root(place) as usize] {
            motions.set_travel(place, [0.0; 2]);
        }
    }
}

/// Turns of passes come behind those of the bounces.
fn turn(pass: usize, colour: u32) -> u32 {
    super::turn(super::IMPACT_ROUNDS + pass, colour)
}

/// How the offset between the two changes.
fn way(contact: &Contact, motions: &Motions) -> [f32; 2] {
    let [a, b] = contact.places.map(|place| motions.travel(place));
    [b[0] - a[0], b[1] - a[1]]
}

fn dot(a: [f32; 2], b: [f32; 2]) -> f32 {
    a[0] * b[0] + a[1] * b[1]
}

/// Whether the two could get far into each other, now or once other ways are shortened:
/// a way that is shortened makes those behind it fast, however alike the two ways were
/// before. But no way gets longer, so what is too far apart now stays so.
fn may_get_through(contact: &Contact, motions: &Motions) -> bool {
    let square = |place| dot(motions.travel(place), motions.travel(place));
    let [a, b] = contact.places.map(square);
    let needed = (0.1 * contact.reach).max(0.99 * contact.gap);
    // (√a + √b)² ≤ 2 (a + b): most contacts need no root.
    let needed_squared = needed * needed;
    2.0 * (a + b) > needed_squared && a + b + 2.0 * (a * b).sqrt() > needed_squared
}

/// Whether the two move by more than a tenth of the sum of radii against each
/// other. What is slower cannot get far into the other before the next sub-step.
fn is_fast(contact: &Contact, motions: &Motions) -> bool {
    let way = way(contact, motions);
    dot(way, way) > 0.01 * contact.reach * contact.reach
}

/// The share of their ways that the two can go before the line between their
/// offsets enters the contact; `None` if it never does.
fn free_share(contact: &Contact, motions: &Motions) -> Option<f32> {
    if !is_fast(contact, motions) {
        return None;
    }
    let start = contact.normal.map(|v| v * (contact.gap + contact.reach));
    let way = way(contact, motions);
    let approach = dot(start, way);
    if approach >= 0.0 {
        return None;
    }
    if contact.gap <= 0.0 {
        return Some(0.0);
    }
    let length = dot(way, way);
    let nearest = (-approach / length).min(1.0);
    let closest = [0, 1].map(|k| start[k] + way[k] * nearest);
    let limit = TOLERANCE * contact.reach;
    if dot(closest, closest) >= limit * limit {
        return None;
    }
    let middle = -approach / length;
    let apart = [0, 1].map(|k| start[k] + way[k] * middle);
    let free = (contact.reach * contact.reach - dot(apart, apart)).max(0.0);
    Some((middle - (free / length).sqrt()).clamp(0.0, 1.0))
}

fn shorten(contact: &Contact, motions: &Motions, share: f32, turn: u32) {
    // What cannot move has no way, and others may be reading it at the same time.
    for (place, inverse_mass) in contact.places.into_iter().zip(contact.inverse_masses) {
        if inverse_mass > 0.0 {
            let motion = motions.get(place);
            motions.set(place, Motion { travel: motion.travel.map(|v| v * share), turn, ..motion });
        }
    }
}
