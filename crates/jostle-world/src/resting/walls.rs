//! Resting contacts of a particle with walls.

use super::pairs::{Pass, Phase};
use super::{MAX_REST_GAP, Start, Support, Surfaces, WallImpulse, WallVector, are_touching};
use crate::contacts::RELAXATION;
use crate::flow::Kick;
use crate::forces::springs::Push;
use crate::motion::{Scalars, Vectors};
use crate::trajectory::rest_speeds;
use crate::walls::{self, OPPOSED, index_of};

/// Walls on which a particle can rest at once, at most.
const MAX_CONTACTS: usize = 4;

/// A particle that rests on walls.
#[derive(Clone, Copy, Debug)]
pub struct OnWalls {
    pub index: u32,
    /// Change of the surface speed by a change of the velocity along the surface: m r²/I, 0 for
    /// points.
    softness: f32,
    contacts: [Option<RestingContact>; MAX_CONTACTS],
}

/// A wall on which a particle rests.
#[derive(Clone, Copy, Debug)]
struct RestingContact {
    /// The number of the wall.
    wall: u32,
    inward: [f32; 2],
    /// The velocity of the wall.
    velocity: [f32; 2],
    /// Coefficient of friction.
    friction: f32,
    start: Start,
    /// Speeds given by the wall along the normal and along itself, in the impact at the beginning
    /// and after it.
    pushes: [[f32; 2]; 2],
}

impl OnWalls {
    /// The particle, if a wall contact of it may rest in this sub-step.
    pub fn of(
        index: usize,
        scene: &Support<'_>,
        kick: &Kick,
        found: &mut Vec<walls::WallContact>,
    ) -> Option<Self> {
        let motions = scene.motions;
        let (position, radius) = (motions.position(index as u32), scene.particles.radii[index]);
        let exact = motions.exact(index as u32);
        let h = scene.flow.duration as f32;
        // The search radius is the one of the rule: beyond it no contact rests.
        let far = f64::from(MAX_REST_GAP * kick.speed * h);
        let mut contacts = [None; MAX_CONTACTS];
        let is_near_walls =
            !scene.walls.is_empty() && !scene.walls.is_far(index as u32, position, far as f32);
        if is_near_walls {
            let position_now = (exact, 0.0);
            scene.walls.contacts(index as u32, position_now, f64::from(radius), far, found);
        } else {
            found.clear();
        }
        let (is_between, before) = (!found.is_empty(), scene.impulses_before(index));
        let rest = |contact: &walls::WallContact, curve: f32| {
            let own = before.iter().find(|of| of.wall == contact.wall);
            let pushes = own.map_or([0.0; 2], |of| of.pushes);
            RestingContact::of(index, (contact, curve, pushes), is_between, scene, kick)
        };
        let container = scene.walls.container;
        if !container.is_far(position.map(f64::from), f64::from(radius), [far; 2]) {
            for (number, side) in container.sides() {
                let contact = side.contact(number, exact, f64::from(radius));
                contacts[number as usize] = rest(&contact, side.curve(radius));
            }
        }
        if is_near_walls {
            let curve = |is_end: bool| if is_end { radius } else { f32::INFINITY };
            let resting = found.iter().filter_map(|of| rest(of, curve(of.is_end)));
            let free = contacts.iter_mut().filter(|contact| contact.is_none());
            // The number of contacts of a particle is fixed, so nothing is allocated. A disc that
            // touches more walls rests on the first ones, and events keep it out of the others.
            free.zip(resting).for_each(|(to, contact)| *to = Some(contact));
            forget_wedges(&mut contacts);
        }
        let rests = contacts.iter().any(Option::is_some);
        let softness = if radius == 0.0 { 0.0 } else { 2.0 };
        rests.then_some(Self { index: index as u32, softness, contacts })
    }

    /// The numbers of its contacts.
    pub fn numbers(&self) -> impl Iterator<Item = u32> {
        (0..).zip(&self.contacts).filter(|(_, contact)| contact.is_some()).map(|(number, _)| number)
    }

    /// A contact, as springs see it; the speed is that of the particle.
    pub fn push(&self, number: usize) -> Option<Push> {
        let contact = self.contacts[number]?;
        let [x, y] = [0, 1].map(|k| contact.inward[k] * contact.velocity[k]);
        Some(Push {
            normal: contact.inward,
            least_speed: x + y - contact.start.closing_speed,
            impulse: contact.pushes[Phase::Rest as usize][0],
        })
    }

    /// Leaves out the impact of a contact.
    pub fn forgo_impact(&mut self, number: usize) {
        if let Some(contact) = &mut self.contacts[number] {
            contact.start.bounce = f32::MIN;
        }
    }

    /// Replaces the impulse over mass of a contact.
    pub fn set_push(&mut self, number: usize, push: f32) {
        if let Some(contact) = &mut self.contacts[number] {
            contact.pushes[Phase::Rest as usize][0] = push;
        }
    }

    /// Whether the particle touches a wall and approaches it too fast to rest.
    pub fn is_fast(&self) -> bool {
        self.contacts.iter().flatten().any(|contact| contact.start.is_fast)
    }

    /// Starts from the impulses of the sub-step before.
    pub fn start(&self, velocities: &Vectors, surface_speeds: &Scalars) {
        let mut velocity = velocities.get(self.index);
        let mut surface_speed = surface_speeds.get(self.index);
        for contact in self.contacts.iter().flatten() {
            let [push, friction] = contact.pushes[Phase::Rest as usize];
            velocity = pushed(velocity, contact.inward, push);
            if contact.friction > 0.0 {
                velocity = pushed(velocity, turned(contact.inward), friction);
                surface_speed -= friction * self.softness;
            }
        }
        velocities.set(self.index, velocity);
        surface_speeds.set(self.index, surface_speed);
    }

    /// Corrects the impulses so that the particle leaves each wall with the least speed at
    /// least, and does not slide if friction is large enough.
    pub fn solve(&mut self, velocities: &Vectors, surface_speeds: &Scalars, pass: Pass) {
        let phase = pass.phase();
        // Impulses are divided by the mass here: a wall does not move, so the mass cancels.
        let relaxation = if pass == Pass::Relaxed { RELAXATION } else { 1.0 };
        let mut velocity = velocities.get(self.index);
        let mut surface_speed = surface_speeds.get(self.index);
        // The contacts of one particle are solved in a fixed order, by one thread. No other task of
        // this turn reads or writes the particle.
        for contact in self.contacts.iter_mut().flatten() {
            let inward = contact.inward;
            let [u, v] = [0, 1].map(|k| velocity[k] - contact.velocity[k]);
            let normal_speed = inward[0] * u + inward[1] * v;
            let least_speed = match phase {
                Phase::Impact => contact.start.bounce,
                Phase::Rest => -contact.start.closing_speed,
            };
            let coefficient = contact.friction;
            let [push, friction] = &mut contact.pushes[phase as usize];
            let new = (*push + relaxation * (least_speed - normal_speed)).max(0.0);
            velocity = pushed(velocity, inward, new - *push);
            *push = new;
            if coefficient > 0.0 {
                let along = turned(inward);
                let [u, v] = [0, 1].map(|k| velocity[k] - contact.velocity[k]);
                let sliding = along[0] * u + along[1] * v - surface_speed;
                // The limit follows the push that was just corrected.
                let most = coefficient * *push;
                let wanted = *friction - sliding / (1.0 + self.softness);
                let new = wanted.max(-most).min(most);
                velocity = pushed(velocity, along, new - *friction);
                surface_speed -= (new - *friction) * self.softness;
                *friction = new;
            }
        }
        velocities.set(self.index, velocity);
        surface_speeds.set(self.index, surface_speed);
    }

    /// The impulses of the walls that push the particle, as sums of both phases.
    pub fn impulses(&self, row: u32, mass: f32) -> impl Iterator<Item = WallImpulse> {
        let all = self.contacts.iter().flatten().map(move |contact| {
            let (wall, [impact, pushes]) = (contact.wall, contact.pushes);
            let impulses = [0, 1].map(|k| mass * (impact[k] + pushes[k]));
            WallImpulse { row, wall, impulses, pushes }
        });
        all.filter(|of| of.impulses[0] > 0.0 || of.pushes[0] > 0.0)
    }

    /// The impulses as vectors, of walls that are no sides of the container.
    pub fn vectors(&self, row: u32, mass: f32) -> impl Iterator<Item = WallVector> {
        let walls = self.contacts.iter().flatten().filter(|of| index_of(of.wall).is_some());
        walls.map(move |of| {
            let along = turned(of.inward);
            let [normal, friction] = [0, 1].map(|k| of.pushes[0][k] + of.pushes[1][k]);
            let impulse = [0, 1].map(|k| mass * (normal * of.inward[k] + friction * along[k]));
            WallVector { row, wall: of.wall, impulse }
        })
    }
}

impl RestingContact {
    /// The contact with a wall, with the radius of the curve on which the particle slides along it and
    /// the impulses of the sub-step before, if it may rest in this sub-step. `is_between` tells whether walls
    /// beside those of the container are near.
    fn of(
        index: usize,
        (contact, curve, pushes): (&walls::WallContact, f32, [f32; 2]),
        is_between: bool,
        scene: &Support<'_>,
        kick: &Kick,
    ) -> Option<Self> {
        let (number, gap) = (contact.wall, contact.gap as f32);
        let inward = contact.normal.map(|v| v as f32);
        let own = scene.motions.velocity(index as u32);
        let velocity = scene.walls.walls.velocity(number);
        let [u, v] = [0, 1].map(|k| own[k] - velocity[k]);
        // On a wall from which gravity and forces move it away it rests only if other particles push it.
        let change = scene.change(kick);
        let away = [0, 1].map(|k| inward[k] * change[k] as f32);
        let is_pushed = pushes[0] > 0.0 || are_touching(gap, scene.particles.radii[index]);
        if away[0] + away[1] > 0.0 && !is_pushed {
            return None;
        }
        let surface = scene.walls.walls.surface(number);
        let restitution = surface.restitution_with(scene.particles.restitution[index]);
        let surfaces = Surfaces {
            gap,
            size: scene.particles.radii[index],
            curve,
            speed: (u * u + v * v).sqrt(),
            normal_speed: inward[0] * u + inward[1] * v,
            restitution,
            rest_speeds: rest_speeds(f64::from(restitution)).map(|limit| limit as f32),
            speeds: [kick.speed, 0.0],
            has_pushed: pushes[0] > 0.0,
        };
        let mut start = surfaces.start(scene.flow.duration as f32);
        if !start.rests {
            return None;
        }
        // Otherwise a disc between walls at an acute angle would be thrown out by its impact on
        // one.
        if is_between && surfaces.normal_speed > 0.0 && start.bounce == 0.0 {
            start.bounce = -surfaces.restitution * surfaces.normal_speed;
        }
        let own = f64::from(scene.particles.spin(index).friction);
        let friction = surface.friction_with(own) as f32;
        // An impulse from before the friction became 0 does not count.
        let pushes = [pushes[0], if friction > 0.0 { pushes[1] } else { 0.0 }];
        Some(Self { wall: number, inward, velocity, friction, start, pushes: [[0.0; 2], pushes] })
    }
}

/// Lets the impulses of a particle between walls at an acute angle begin at 0. They are large, and
/// nearly cancel; from 0 on, each iteration makes the particle slower, also where they do not
/// converge.
fn forget_wedges(contacts: &mut [Option<RestingContact>; MAX_CONTACTS]) {
    let inward = |at: usize| contacts[at].map_or([0.0; 2], |contact| contact.inward);
    let are_opposed = |a: usize, b: usize| {
        let ([x, y], [u, v]) = (inward(a), inward(b));
        x * u + y * v < OPPOSED as f32
    };
    if (0..MAX_CONTACTS).any(|a| (0..a).any(|b| are_opposed(a, b))) {
        contacts.iter_mut().flatten().for_each(|contact| contact.pushes = [[0.0; 2]; 2]);
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
