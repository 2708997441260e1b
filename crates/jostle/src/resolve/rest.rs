//! What leans on each other: sequential impulses with accumulated clamping.
//!
//! Each contact keeps the sum of its impulses and never lets it pull (E. Catto,
//! *Iterative Dynamics with Temporal Coherence*, 2005). Starting from the sums of
//! the step before, a pile finds its balance over several steps, and small
//! sub-steps with few rounds beat one step with many (M. Macklin et al., *Small
//! Steps in Physics Simulation*, 2019). A contact that is still open may close
//! its gap within the sub-step, no faster.
//!
//! Only velocities change here. The ways follow afterwards, all at once, as if
//! each push had come at the start of the sub-step.

use super::Rules;
use crate::contacts::Contact;
use crate::container::{MAX_WALLS, Wall};
use crate::motion::Motions;

/// Rate at which the slow motion of what leans dies away, per second.
const CALMING: f32 = 200.0;

/// Finds out whether the two lean on each other: they touch already or meet too slowly
/// to bounce, and move little enough for the contact to be taken as flat. What meets at speed is
/// left to the impacts of this sub-step or the next, or it would not bounce.
pub fn prepare(contact: &mut Contact, motions: &Motions, rules: &Rules) {
    let [a, b] = contact.places.map(|place| motions.travel(place));
    let way = [b[0] - a[0], b[1] - a[1]];
    let flat = way[0] * way[0] + way[1] * way[1] <= 0.25 * contact.reach * contact.reach;
    let [a, b] = contact.places.map(|place| motions.velocity(place));
    let parting = contact.normal[0] * (b[0] - a[0]) + contact.normal[1] * (b[1] - a[1]);
    contact.leans = flat && (contact.gap <= 0.0 || parting > -rules.rest_speed);
    if !contact.leans {
        contact.impulse = 0.0;
    }
}

/// Takes back from the way what the velocity gave to it.
pub fn suspend(place: u32, motions: &Motions, h: f32) {
    let (way, velocity) = (motions.travel(place), motions.velocity(place));
    motions.set_travel(place, [0, 1].map(|k| way[k] - velocity[k] * h));
}

/// Gives to the way what the new velocity makes of it.
pub fn resume(place: u32, motions: &Motions, h: f32) {
    let (way, velocity) = (motions.travel(place), motions.velocity(place));
    motions.set_travel(place, [0, 1].map(|k| way[k] + velocity[k] * h));
}

fn apply(contact: &Contact, motions: &Motions, velocities: [[f32; 2]; 2], impulse: f32) {
    for (which, sign) in [(0, -1.0), (1, 1.0)] {
        let speed = sign * impulse * contact.inverse_masses[which];
        if speed != 0.0 {
            let velocity = [0, 1].map(|k| velocities[which][k] + contact.normal[k] * speed);
            motions.set_velocity(contact.places[which], velocity);
        }
    }
}

/// Starts from the impulse of the sub-step before.
pub fn start(contact: &mut Contact, motions: &Motions) {
    if contact.impulse > 0.0 {
        let velocities = contact.places.map(|place| motions.velocity(place));
        apply(contact, motions, velocities, contact.impulse);
    }
}

/// Corrects the impulse so that the two do not come closer than touching.
pub fn between(contact: &mut Contact, motions: &Motions, h: f32) {
    if !contact.leans {
        return;
    }
    let velocities = contact.places.map(|place| motions.velocity(place));
    let [a, b] = velocities;
    let n = contact.normal;
    let parting = n[0] * (b[0] - a[0]) + n[1] * (b[1] - a[1]);
    let spare = parting + contact.gap.max(0.0) / h;
    if spare >= 0.0 && contact.impulse == 0.0 {
        return;
    }
    let [inverse_a, inverse_b] = contact.inverse_masses;
    let impulse = (contact.impulse - spare / (inverse_a + inverse_b)).max(0.0);
    let change = impulse - contact.impulse;
    contact.impulse = impulse;
    contact.touched |= impulse > 0.0;
    apply(contact, motions, velocities, change);
}

/// Takes away some of the slow motion that two leaning particles have against each
/// other, evenly in all directions. Discs without friction would slide about for
/// minutes before a pile found its last gap; what moves fast enough to bounce is left
/// alone.
pub fn calm(contact: &Contact, motions: &Motions, rules: &Rules, h: f32) {
    if contact.impulse == 0.0 {
        return;
    }
    let [a, b] = contact.places.map(|place| motions.velocity(place));
    let sliding = [b[0] - a[0], b[1] - a[1]];
    if sliding[0] * sliding[0] + sliding[1] * sliding[1] > rules.rest_speed * rules.rest_speed {
        return;
    }
    let share = CALMING * h / (1.0 + CALMING * h);
    let [inverse_a, inverse_b] = contact.inverse_masses;
    let push = sliding.map(|v| share * v / (inverse_a + inverse_b));
    if inverse_a > 0.0 {
        motions.set_velocity(contact.places[0], [0, 1].map(|k| a[k] + push[k] * inverse_a));
    }
    if inverse_b > 0.0 {
        motions.set_velocity(contact.places[1], [0, 1].map(|k| b[k] - push[k] * inverse_b));
    }
}

fn pushed(velocity: [f32; 2], direction: [f32; 2], speed: f32) -> [f32; 2] {
    [0, 1].map(|k| velocity[k] + direction[k] * speed)
}

/// A particle that may touch walls during the sub-step.
#[derive(Clone, Copy, Debug)]
pub struct AtWall {
    /// Its place.
    pub place: u32,
    /// The walls around it.
    walls: [Option<Wall>; MAX_WALLS],
    /// Speeds given by each wall.
    pub pushes: [f32; MAX_WALLS],
}

/// Room to a wall, in radii, within which the particle is watched.
const NEAR: f32 = 0.25;

impl AtWall {
    /// The particle at `place`, if a wall is near it or has pushed it lately.
    pub fn find(
        place: u32,
        motions: &Motions,
        radius: f32,
        pushes: [f32; MAX_WALLS],
        rules: &Rules,
        h: f32,
    ) -> Option<Self> {
        let velocity = motions.velocity(place);
        let leans = |wall: &Wall| {
            let parting = wall.inward[0] * velocity[0] + wall.inward[1] * velocity[1];
            wall.gap <= 0.0 || parting > -rules.rest_speed
        };
        let walls = rules.container.walls(motions.position(place), radius);
        let walls = walls.map(|wall| wall.filter(leans));
        let speed = velocity.iter().fold(0.0f32, |most, v| most.max(v.abs()));
        let near = |wall: &Wall| wall.gap < 2.0 * speed * h + NEAR * radius;
        let watched = walls.iter().flatten().any(near) || pushes != [0.0; MAX_WALLS];
        watched.then_some(Self { place, walls, pushes })
    }

    /// As [`start`], against the walls.
    pub fn start(&mut self, motions: &Motions) {
        let mut velocity = motions.velocity(self.place);
        for (wall, push) in self.walls.iter().zip(&mut self.pushes) {
            match wall {
                Some(wall) => velocity = pushed(velocity, wall.inward, *push),
                None => *push = 0.0,
            }
        }
        motions.set_velocity(self.place, velocity);
    }

    /// As [`between`], against the walls.
    pub fn correct(&mut self, motions: &Motions, h: f32) {
        let mut velocity = motions.velocity(self.place);
        for (wall, push) in self.walls.iter().zip(&mut self.pushes) {
            let Some(wall) = wall else { continue };
            let parting = wall.inward[0] * velocity[0] + wall.inward[1] * velocity[1];
            let spare = parting + wall.gap.max(0.0) / h;
            if spare < 0.0 || *push > 0.0 {
                let new = (*push - spare).max(0.0);
                velocity = pushed(velocity, wall.inward, new - *push);
                *push = new;
            }
        }
        motions.set_velocity(self.place, velocity);
    }
}
