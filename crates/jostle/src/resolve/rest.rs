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
use crate::motion::{Motion, Motions, Velocities};

/// Rate at which the slow motion of what leans dies away, per second.
const CALMING: f32 = 200.0;

/// Two particles that lean on each other, with what all rounds need and nothing else.
#[derive(Clone, Copy, Debug, Default)]
pub struct Leaning {
    places: [u32; 2],
    normal: [f32; 2],
    inverse_masses: [f32; 2],
    /// Momentum for a change of speed by one: 1 / (1/m₁ + 1/m₂); 0 where they do not lean.
    weight: f32,
    /// How fast the gap between them may close.
    slack: f32,
    /// Momentum that holds them apart.
    impulse: f32,
    /// Whether it was ever above 0.
    pressed: bool,
}

impl Leaning {
    /// Finds out whether the two lean on each other: they touch already or meet too slowly
    /// to bounce, and move little enough for the contact to be taken as flat. What meets
    /// at speed is left to the impacts of this sub-step or the next, or it would not bounce.
    pub fn of(contact: &Contact, motions: &Motions, rest_speed: f32, h: f32) -> Self {
        let [a, b] = contact.places.map(|place| motions.travel(place));
        let way = [b[0] - a[0], b[1] - a[1]];
        let flat = way[0] * way[0] + way[1] * way[1] <= 0.25 * contact.reach * contact.reach;
        let [a, b] = contact.places.map(|place| motions.velocity(place));
        let parting = contact.normal[0] * (b[0] - a[0]) + contact.normal[1] * (b[1] - a[1]);
        let leans = flat && (contact.gap <= 0.0 || parting > -rest_speed);
        let [inverse_a, inverse_b] = contact.inverse_masses;
        Self {
            places: contact.places,
            normal: contact.normal,
            inverse_masses: contact.inverse_masses,
            weight: if leans { 1.0 / (inverse_a + inverse_b) } else { 0.0 },
            slack: contact.gap.max(0.0) / h,
            impulse: if leans { contact.impulse } else { 0.0 },
            pressed: false,
        }
    }

    /// Tells the contact what came of it.
    pub fn tell(&self, contact: &mut Contact) {
        contact.impulse = self.impulse;
        contact.touched |= self.pressed;
    }

    /// Starts from the impulse of the sub-step before.
    pub fn start(&mut self, velocities: &Velocities) {
        if self.impulse > 0.0 {
            let both = self.places.map(|place| velocities.get(place));
            self.apply(velocities, both, self.impulse);
        }
    }

    /// Corrects the impulse so that the two do not come closer than touching. Returns by
    /// how much that changed the speed of the lighter one.
    #[inline(always)]
    pub fn correct(&mut self, velocities: &Velocities) -> f32 {
        let both = self.places.map(|place| velocities.get(place));
        let [a, b] = both;
        let n = self.normal;
        let parting = n[0] * (b[0] - a[0]) + n[1] * (b[1] - a[1]);
        let impulse = (self.impulse - (parting + self.slack) * self.weight).max(0.0);
        let change = impulse - self.impulse;
        self.impulse = impulse;
        self.pressed |= impulse > 0.0;
        self.apply(velocities, both, change);
        let [inverse_a, inverse_b] = self.inverse_masses;
        change.abs() * if inverse_a > inverse_b { inverse_a } else { inverse_b }
    }

    /// What cannot move has an inverse mass of 0 and is left alone: others may be writing
    /// to it at the same time.
    #[inline(always)]
    fn apply(&self, velocities: &Velocities, [a, b]: [[f32; 2]; 2], impulse: f32) {
        let [inverse_a, inverse_b] = self.inverse_masses;
        if inverse_a > 0.0 {
            velocities.set(self.places[0], pushed(a, self.normal, -impulse * inverse_a));
        }
        if inverse_b > 0.0 {
            velocities.set(self.places[1], pushed(b, self.normal, impulse * inverse_b));
        }
    }

    /// Takes away some of the slow motion that two leaning particles have against each
    /// other, evenly in all directions. Discs without friction would slide about for
    /// minutes before a pile found its last gap; what moves fast enough to bounce is left
    /// alone.
    pub fn calm(&self, velocities: &Velocities, rest_speed: f32, h: f32) {
        if self.impulse == 0.0 {
            return;
        }
        let [a, b] = self.places.map(|place| velocities.get(place));
        let sliding = [b[0] - a[0], b[1] - a[1]];
        if sliding[0] * sliding[0] + sliding[1] * sliding[1] > rest_speed * rest_speed {
            return;
        }
        let share = CALMING * h / (1.0 + CALMING * h);
        let [inverse_a, inverse_b] = self.inverse_masses;
        if inverse_a > 0.0 {
            velocities.set(self.places[0], pushed(a, sliding, share * self.weight * inverse_a));
        }
        if inverse_b > 0.0 {
            velocities.set(self.places[1], pushed(b, sliding, -share * self.weight * inverse_b));
        }
    }
}

/// Gives to the way what the new velocity makes of it, as if each push had come at the
/// start of the sub-step.
pub fn resume(motion: Motion, velocity: [f32; 2], h: f32) -> Motion {
    let way = |k: usize| motion.travel[k] - motion.velocity[k] * h + velocity[k] * h;
    Motion { velocity, travel: [way(0), way(1)], ..motion }
}

#[inline(always)]
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

    /// As [`Leaning::start`], against the walls.
    pub fn start(&mut self, velocities: &Velocities) {
        let mut velocity = velocities.get(self.place);
        for (wall, push) in self.walls.iter().zip(&mut self.pushes) {
            match wall {
                Some(wall) => velocity = pushed(velocity, wall.inward, *push),
                None => *push = 0.0,
            }
        }
        velocities.set(self.place, velocity);
    }

    /// As [`Leaning::correct`], against the walls.
    pub fn correct(&mut self, velocities: &Velocities, h: f32) {
        let mut velocity = velocities.get(self.place);
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
        velocities.set(self.place, velocity);
    }
}
