//! Resting contacts of two particles.

use super::{Support, Surfaces};
use crate::contacts::Contact;
use crate::flow::Kick;
use crate::motion::Velocities;

/// Two particles whose contact rests.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    places: [u32; 2],
    normal: [f32; 2],
    inverse_masses: [f32; 2],
    /// Impulse for a change of the normal speed by one: 1 / (1/m₁ + 1/m₂).
    effective_mass: f32,
    /// Speed at which the gap may close.
    closing_speed: f32,
    impulse: f32,
    /// The index of the contact.
    contact: u32,
}

/// The impact of a pair at the beginning of the sub-step.
#[derive(Clone, Copy, Debug)]
pub struct Impact {
    /// Speed at which the two separate at least after it.
    bounce: f32,
    /// Whether they touch and approach too fast to rest.
    pub is_fast: bool,
    impulse: f32,
}

impl Pair {
    /// The pair, if its contact may rest in this sub-step. The contact is up to date with the
    /// positions.
    pub fn of(
        contact: &Contact,
        index: u32,
        scene: &Support<'_>,
        kicks: &[Kick],
    ) -> Option<(Self, Impact)> {
        let h = scene.flow.duration as f32;
        let places = contact.places;
        let [a, b] = places.map(|place| scene.motions.velocity(place));
        let relative = [b[0] - a[0], b[1] - a[1]];
        let surfaces = Surfaces {
            gap: contact.gap,
            reach: contact.reach,
            normal_speed: dot(contact.normal, relative),
            restitution: contact.restitution,
            speeds: places.map(|place| kicks[place as usize].speed),
            has_pushed: contact.impulse > 0.0,
        };
        let start = surfaces.start(h)?;
        // The normal is taken as constant.
        if dot(relative, relative).sqrt() * h > 0.5 * contact.reach {
            return None;
        }
        let [inverse_a, inverse_b] = contact.inverse_masses;
        let pair = Self {
            places,
            normal: contact.normal,
            inverse_masses: contact.inverse_masses,
            effective_mass: 1.0 / (inverse_a + inverse_b),
            closing_speed: start.closing_speed,
            impulse: contact.impulse,
            contact: index,
        };
        Some((pair, Impact { bounce: start.bounce, is_fast: start.is_fast, impulse: 0.0 }))
    }

    /// Starts from the impulse of the sub-step before.
    pub fn start(&self, velocities: &Velocities) -> f32 {
        if self.impulse > 0.0 {
            let both = self.places.map(|place| velocities.get(place));
            self.apply(velocities, both, self.impulse);
        }
        0.0
    }

    /// Corrects the impulse so that the two do not come closer than touching. Returns by how much
    /// that changed the speed of the lighter one.
    #[inline(always)]
    pub fn solve(&mut self, velocities: &Velocities) -> f32 {
        let mut impulse = self.impulse;
        let change = self.correct(&mut impulse, -self.closing_speed, velocities);
        self.impulse = impulse;
        change
    }

    /// As [`Pair::solve`] for the impacts at the beginning.
    #[inline(always)]
    pub fn collide(&self, impact: &mut Impact, velocities: &Velocities) -> f32 {
        self.correct(&mut impact.impulse, impact.bounce, velocities)
    }

    /// Corrects an impulse so that the two separate with `least_speed` at least.
    #[inline(always)]
    fn correct(&self, impulse: &mut f32, least_speed: f32, velocities: &Velocities) -> f32 {
        let both = self.places.map(|place| velocities.get(place));
        let [a, b] = both;
        let normal_speed = dot(self.normal, [b[0] - a[0], b[1] - a[1]]);
        let new = (*impulse + (least_speed - normal_speed) * self.effective_mass).max(0.0);
        let change = new - *impulse;
        *impulse = new;
        self.apply(velocities, both, change);
        let [inverse_a, inverse_b] = self.inverse_masses;
        change.abs() * if inverse_a > inverse_b { inverse_a } else { inverse_b }
    }

    /// Stores the impulse in the contact.
    pub fn store(&self, impact: &Impact, contacts: &mut [Contact]) {
        let contact = &mut contacts[self.contact as usize];
        contact.impulse = self.impulse;
        contact.touched |= self.impulse > 0.0 || impact.impulse > 0.0;
    }

    /// What cannot move has an inverse mass of 0 and is not written, because others may be writing
    /// to it at the same time.
    #[inline(always)]
    fn apply(&self, velocities: &Velocities, both: [[f32; 2]; 2], impulse: f32) {
        for (k, sign) in [(0, -1.0), (1, 1.0)] {
            let inverse_mass = self.inverse_masses[k];
            if inverse_mass > 0.0 {
                let change = sign * impulse * inverse_mass;
                velocities.set(self.places[k], pushed(both[k], self.normal, change));
            }
        }
    }
}

fn dot(a: [f32; 2], b: [f32; 2]) -> f32 {
    a[0] * b[0] + a[1] * b[1]
}

#[inline(always)]
pub(super) fn pushed(velocity: [f32; 2], direction: [f32; 2], speed: f32) -> [f32; 2] {
    [0, 1].map(|k| velocity[k] + direction[k] * speed)
}
