//! Resting contacts of a particle with walls.

use super::{Start, Support, Surfaces};
use crate::container::{MAX_WALLS, Wall};
use crate::flow::Kick;
use crate::motion::Vectors;

/// A particle that rests on walls.
#[derive(Clone, Copy, Debug)]
pub struct Walls {
    place: u32,
    contacts: [Option<WallContact>; MAX_WALLS],
}

/// A wall on which a particle rests.
#[derive(Clone, Copy, Debug)]
struct WallContact {
    inward: [f32; 2],
    start: Start,
    /// Speed given by the wall in the impact at the beginning.
    impact: f32,
    /// Speed given by the wall after it.
    push: f32,
}

impl Walls {
    /// The particle, if a wall contact of it may rest in this sub-step; `pushes` are those of the
    /// sub-step before.
    pub fn of(
        place: usize,
        pushes: [f32; MAX_WALLS],
        scene: &Support<'_>,
        kick: &Kick,
    ) -> Option<Self> {
        let (velocity, radius) =
            (scene.motions.velocity(place as u32), scene.particles.radii[place]);
        let contact = |wall: Wall, push: f32| {
            let surfaces = Surfaces {
                gap: wall.gap,
                reach: radius,
                normal_speed: wall.inward[0] * velocity[0] + wall.inward[1] * velocity[1],
                restitution: scene.restitution * scene.particles.restitutions[place],
                speeds: [kick.speed, 0.0],
                has_pushed: push > 0.0,
            };
            let start = surfaces.start(scene.flow.duration as f32)?;
            Some(WallContact { inward: wall.inward, start, impact: 0.0, push })
        };
        let walls = scene.container.walls(scene.motions.position(place as u32), radius);
        let contacts = [0, 1, 2, 3].map(|k| contact(walls[k]?, pushes[k]));
        let rests = contacts.iter().any(Option::is_some);
        rests.then_some(Self { place: place as u32, contacts })
    }

    /// Whether the particle touches a wall and approaches it too fast to rest.
    pub fn is_fast(&self) -> bool {
        self.contacts.iter().flatten().any(|contact| contact.start.is_fast)
    }

    /// Starts from the impulses of the sub-step before.
    pub fn start(&self, velocities: &Vectors) {
        let mut velocity = velocities.get(self.place);
        for contact in self.contacts.iter().flatten() {
            velocity = pushed(velocity, contact.inward, contact.push);
        }
        velocities.set(self.place, velocity);
    }

    /// Corrects the impulses so that the particle does not get beyond the walls.
    pub fn solve(&mut self, velocities: &Vectors) {
        self.correct(velocities, |contact| (&mut contact.push, -contact.start.closing_speed));
    }

    /// As [`Walls::solve`] for the impacts at the beginning.
    pub fn collide(&mut self, velocities: &Vectors) {
        self.correct(velocities, |contact| (&mut contact.impact, contact.start.bounce));
    }

    /// Corrects the speeds that walls give so that the particle leaves each with the least speed
    /// at least.
    fn correct(
        &mut self,
        velocities: &Vectors,
        which: impl Fn(&mut WallContact) -> (&mut f32, f32),
    ) {
        let mut velocity = velocities.get(self.place);
        for contact in self.contacts.iter_mut().flatten() {
            let inward = contact.inward;
            let normal_speed = inward[0] * velocity[0] + inward[1] * velocity[1];
            let (push, least_speed) = which(contact);
            let new = (*push + (least_speed - normal_speed)).max(0.0);
            velocity = pushed(velocity, inward, new - *push);
            *push = new;
        }
        velocities.set(self.place, velocity);
    }

    /// Stores the impulses.
    pub fn store(&self, wall_pushes: &mut [[f32; MAX_WALLS]]) {
        wall_pushes[self.place as usize] =
            self.contacts.map(|contact| contact.map_or(0.0, |contact| contact.push));
    }
}

#[inline(always)]
fn pushed(velocity: [f32; 2], direction: [f32; 2], speed: f32) -> [f32; 2] {
    [0, 1].map(|k| velocity[k] + direction[k] * speed)
}
