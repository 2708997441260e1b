//! Resting contacts of a particle with walls.

use super::pairs::{Pass, Phase};
use super::{FARTHEST, RELAXATION, Start, Support, Surfaces};
use crate::container::{MAX_WALLS, Wall};
use crate::flow::Kick;
use crate::motion::{Scalars, Vectors};

/// A particle that rests on walls.
#[derive(Clone, Copy, Debug)]
pub struct Walls {
    pub place: u32,
    /// Coefficient of friction.
    friction: f32,
    /// Change of the surface speed by a change of the velocity along the surface: m r²/I, 0 for points.
    softness: f32,
    contacts: [Option<WallContact>; MAX_WALLS],
}

/// A wall on which a particle rests.
#[derive(Clone, Copy, Debug)]
struct WallContact {
    inward: [f32; 2],
    start: Start,
    /// Speeds given by the wall along the normal and along itself, in the impact at the beginning and
    /// after it.
    pushes: [[f32; 2]; 2],
}

impl Walls {
    /// The particle, if a wall contact of it may rest in this sub-step; `pushes` and those of friction
    /// are from the sub-step before.
    pub fn of(
        place: usize,
        pushes: [f32; MAX_WALLS],
        frictions: [f32; MAX_WALLS],
        scene: &Support<'_>,
        kick: &Kick,
    ) -> Option<Self> {
        let motions = scene.motions;
        let (position, radius) = (motions.position(place as u32), scene.particles.radii[place]);
        let h = scene.flow.duration as f32;
        let far = f64::from(FARTHEST * kick.speed * h);
        if scene.container.is_far(position.map(f64::from), f64::from(radius), [far; 2]) {
            return None;
        }
        let velocity = motions.velocity(place as u32);
        let contact = |wall: Wall, push: f32, friction: f32| {
            let surfaces = Surfaces {
                gap: wall.gap,
                reach: radius,
                normal_speed: wall.inward[0] * velocity[0] + wall.inward[1] * velocity[1],
                restitution: scene.restitution * scene.particles.restitutions[place],
                speeds: [kick.speed, 0.0],
                has_pushed: push > 0.0,
            };
            let start = surfaces.start(h)?;
            Some(WallContact { inward: wall.inward, start, pushes: [[0.0; 2], [push, friction]] })
        };
        let walls = scene.container.walls(position, radius);
        let contacts = [0, 1, 2, 3].map(|k| contact(walls[k]?, pushes[k], frictions[k]));
        let rests = contacts.iter().any(Option::is_some);
        let friction = scene.particles.spin(place).friction;
        let softness = if radius == 0.0 { 0.0 } else { 2.0 };
        rests.then_some(Self { place: place as u32, friction, softness, contacts })
    }

    /// Whether the particle touches a wall and approaches it too fast to rest.
    pub fn is_fast(&self) -> bool {
        self.contacts.iter().flatten().any(|contact| contact.start.is_fast)
    }

    /// Starts from the impulses of the sub-step before.
    pub fn start(&self, velocities: &Vectors, surface_speeds: &Scalars) {
        let mut velocity = velocities.get(self.place);
        let mut surface_speed = surface_speeds.get(self.place);
        for contact in self.contacts.iter().flatten() {
            let [push, friction] = contact.pushes[Phase::Rest as usize];
            velocity = pushed(velocity, contact.inward, push);
            if self.friction > 0.0 {
                velocity = pushed(velocity, turned(contact.inward), friction);
                surface_speed -= friction * self.softness;
            }
        }
        velocities.set(self.place, velocity);
        surface_speeds.set(self.place, surface_speed);
    }

    /// Corrects the impulses so that the particle leaves each wall with the least speed at
    /// least, and does not slide if friction is large enough.
    pub fn solve(&mut self, velocities: &Vectors, surface_speeds: &Scalars, pass: Pass) {
        let phase = pass.phase();
        let relaxation = if pass == Pass::Relaxed { RELAXATION } else { 1.0 };
        let mut velocity = velocities.get(self.place);
        let mut surface_speed = surface_speeds.get(self.place);
        for contact in self.contacts.iter_mut().flatten() {
            let inward = contact.inward;
            let normal_speed = inward[0] * velocity[0] + inward[1] * velocity[1];
            let least_speed = match phase {
                Phase::Impact => contact.start.bounce,
                Phase::Rest => -contact.start.closing_speed,
            };
            let [push, friction] = &mut contact.pushes[phase as usize];
            let new = (*push + relaxation * (least_speed - normal_speed)).max(0.0);
            velocity = pushed(velocity, inward, new - *push);
            *push = new;
            if self.friction > 0.0 {
                let along = turned(inward);
                let sliding = along[0] * velocity[0] + along[1] * velocity[1] - surface_speed;
                let most = self.friction * *push;
                let wanted = *friction - sliding / (1.0 + self.softness);
                let new = wanted.max(-most).min(most);
                velocity = pushed(velocity, along, new - *friction);
                surface_speed -= (new - *friction) * self.softness;
                *friction = new;
            }
        }
        velocities.set(self.place, velocity);
        surface_speeds.set(self.place, surface_speed);
    }

    /// The walls that push the particle, and the sums of the impulses of both phases.
    pub fn impulses(&self, mass: f32) -> impl Iterator<Item = (u8, [f32; 2])> {
        let contacts = (0..).zip(&self.contacts);
        let found = contacts.filter_map(|(wall, contact)| Some((wall, contact.as_ref()?.pushes)));
        let sums = found.map(move |(wall, [impact, rest])| {
            (wall, [0, 1].map(|k| mass * (impact[k] + rest[k])))
        });
        sums.filter(|(_, [normal, _])| *normal > 0.0)
    }

    /// Stores the impulses.
    pub fn store(
        &self,
        wall_pushes: &mut [[f32; MAX_WALLS]],
        wall_frictions: &mut [[f32; MAX_WALLS]],
    ) {
        let pushes = self.contacts.map(|contact| {
            contact.map_or([0.0; 2], |contact| contact.pushes[Phase::Rest as usize])
        });
        wall_pushes[self.place as usize] = pushes.map(|[push, _]| push);
        if let Some(frictions) = wall_frictions.get_mut(self.place as usize) {
            *frictions = pushes.map(|[_, friction]| friction);
        }
    }
}

/// A vector after a quarter turn.
#[inline(always)]
fn turned([x, y]: [f32; 2]) -> [f32; 2] {
    [-y, x]
}

#[inline(always)]
fn pushed(velocity: [f32; 2], direction: [f32; 2], speed: f32) -> [f32; 2] {
    [0, 1].map(|k| velocity[k] + direction[k] * speed)
}
