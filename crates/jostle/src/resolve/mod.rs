//! Contacts change velocities and ways: one sub-step, in six acts.
//!
//! 1. *kick*: gravity and drag, the straight way.
//! 2. *impact*: what meets at speed bounces at the moment of impact.
//! 3. *rest*: what leans on each other is held apart, softly started from the
//!    impulses of the step before.
//! 4. *confine* and *guard*: no way leaves its sweep or its container, none
//!    passes through another.
//! 5. *advance*: positions move along the ways.
//! 6. *separate*: remaining overlap is pushed apart without touching speeds.
//!
//! Each act goes through the contacts colour by colour, so the answer does not
//! depend on threads. Without gravity nothing leans and act 3 is left out:
//! then every change is a bounce between two, which never adds energy.

mod guard;
mod impact;
mod rest;
mod separate;

pub use rest::AtWall;

use std::sync::atomic::{AtomicBool, Ordering};

use crate::contacts::{Contact, Contacts};
use crate::container::{Container, MAX_WALLS};
use crate::integrate::{self, Sweep};
use crate::motion::Motions;
use crate::parallel;
use crate::particles::Particles;

/// Rounds of bounces in a sub-step; what then still meets, meets in the next.
const IMPACT_ROUNDS: usize = 4;

/// Rounds over the resting contacts in a sub-step.
const REST_ROUNDS: usize = 12;

/// What is the same for all particles during a step.
#[derive(Clone, Copy, Debug)]
pub struct Rules {
    /// Acceleration.
    pub gravity: [f32; 2],
    /// Rate at which speeds die away, per second.
    pub drag: f32,
    /// The world's share of every bounce.
    pub restitution: f32,
    /// The walls.
    pub container: Container,
    /// Slower than this against each other, things do not bounce but lean, and come to rest.
    pub rest_speed: f32,
    /// Threads to use.
    pub threads: Option<usize>,
}

/// Everything that a sub-step reads and writes.
pub struct Scene<'a> {
    /// What the particles are; positions and velocities are those of the step's start.
    pub particles: &'a Particles,
    /// How they move.
    pub motions: &'a Motions,
    /// Where they may be.
    pub sweeps: &'a [Sweep],
    /// Which of them may touch.
    pub contacts: &'a mut Contacts,
    /// Resting speeds given by each wall to each particle.
    pub wall_pushes: &'a mut [[f32; MAX_WALLS]],
    /// Memory for those of them that are near a wall.
    pub at_walls: &'a mut Vec<AtWall>,
}

/// One sub-step of `h` seconds.
pub fn substep(scene: &mut Scene<'_>, rules: &Rules, h: f32) {
    kick(scene, rules, h);
    measure_all(scene, rules);
    bounce(scene, rules, h);
    if rules.rest_speed > 0.0 {
        lean(scene, rules, h);
    }
    confine(scene, rules);
    guard::guard(&scene.contacts.list, scene.motions);
    advance(scene, rules);
    settle(scene, rules);
}

/// Calls `act` on every movable particle.
fn each_particle(
    scene: &mut Scene<'_>,
    rules: &Rules,
    act: impl Fn(u32, &mut [f32; MAX_WALLS]) + Sync + Send,
) {
    let movable = &scene.particles.movable;
    parallel::for_chunks(rules.threads, scene.wall_pushes, |first, pushes| {
        for (offset, push) in pushes.iter_mut().enumerate() {
            if movable[first + offset] {
                act((first + offset) as u32, push);
            }
        }
    });
}

fn kick(scene: &mut Scene<'_>, rules: &Rules, h: f32) {
    let motions = scene.motions;
    each_particle(scene, rules, |place, _| {
        motions.set(place, integrate::kick(motions.get(place), rules.gravity, rules.drag, h));
    });
}

/// Brings normal and gap of every contact up to date with the positions.
pub fn measure_all(scene: &mut Scene<'_>, rules: &Rules) {
    let motions = scene.motions;
    scene.contacts.each(rules.threads, |contact| measure(contact, motions));
}

fn measure(contact: &mut Contact, motions: &Motions) {
    let [a, b] = contact.places.map(|place| motions.position(place));
    let offset = [0, 1].map(|k| b[k] - a[k] + contact.image[k]);
    let length = (offset[0] * offset[0] + offset[1] * offset[1]).sqrt();
    if length > 0.0 && length < f32::INFINITY {
        contact.normal = offset.map(|v| v / length);
    }
    contact.gap = length - contact.reach;
}

fn bounce(scene: &mut Scene<'_>, rules: &Rules, h: f32) {
    let motions = scene.motions;
    let particles = scene.particles;
    for _ in 0..IMPACT_ROUNDS {
        let any = AtomicBool::new(false);
        scene.contacts.solve(rules.threads, |contact| {
            if impact::between(contact, motions, rules.rest_speed, h) {
                any.store(true, Ordering::Relaxed);
            }
        });
        if rules.container.has_walls() {
            each_particle(scene, rules, |place, _| {
                let restitution = rules.restitution * particles.restitutions[place as usize];
                let motion = motions.get(place);
                let radius = particles.radii[place as usize];
                let bounced = impact::against_walls(motion, radius, restitution, rules, h);
                if let Some(bounced) = bounced {
                    motions.set(place, bounced);
                    any.store(true, Ordering::Relaxed);
                }
            });
        }
        if !any.into_inner() {
            break;
        }
    }
}

fn lean(scene: &mut Scene<'_>, rules: &Rules, h: f32) {
    let (motions, threads) = (scene.motions, rules.threads);
    scene.contacts.each(threads, |contact| rest::prepare(contact, motions, rules));
    find_at_walls(scene, rules, h);
    each_particle(scene, rules, |place, _| rest::suspend(place, motions, h));
    scene.contacts.solve(threads, |contact| rest::start(contact, motions));
    each_at_wall(scene, rules, |at_wall| at_wall.start(motions));
    scene.contacts.solve(threads, |contact| rest::calm(contact, motions, rules, h));
    for _ in 0..REST_ROUNDS {
        scene.contacts.solve(threads, |contact| rest::between(contact, motions, h));
        each_at_wall(scene, rules, |at_wall| at_wall.correct(motions, h));
    }
    for at_wall in scene.at_walls.iter() {
        scene.wall_pushes[at_wall.place as usize] = at_wall.pushes;
    }
    each_particle(scene, rules, |place, _| rest::resume(place, motions, h));
}

/// Lists the movable particles that may touch a wall.
fn find_at_walls(scene: &mut Scene<'_>, rules: &Rules, h: f32) {
    let Scene { particles, motions, wall_pushes, at_walls, .. } = scene;
    at_walls.clear();
    if !rules.container.has_walls() {
        return;
    }
    let all = particles.radii.iter().zip(wall_pushes.iter()).zip(&particles.movable).enumerate();
    let movable = all.filter(|&(_, (_, &movable))| movable);
    at_walls.extend(movable.filter_map(|(place, ((&radius, &pushes), _))| {
        AtWall::find(place as u32, motions, radius, pushes, rules, h)
    }));
}

fn each_at_wall(scene: &mut Scene<'_>, rules: &Rules, act: impl Fn(&mut AtWall) + Sync + Send) {
    parallel::for_chunks(rules.threads, scene.at_walls, |_, chunk| chunk.iter_mut().for_each(&act));
}

fn confine(scene: &mut Scene<'_>, rules: &Rules) {
    let (motions, sweeps, particles) = (scene.motions, scene.sweeps, scene.particles);
    each_particle(scene, rules, |place, _| {
        let row = place as usize;
        let (sweep, radius) = (&sweeps[row], particles.radii[row]);
        motions.set(place, integrate::confine(motions.get(place), sweep, &rules.container, radius));
    });
}

fn advance(scene: &mut Scene<'_>, rules: &Rules) {
    let (motions, particles) = (scene.motions, scene.particles);
    each_particle(scene, rules, |place, _| {
        let mut motion = motions.get(place);
        let goal = [0, 1].map(|k| motion.position[k] + motion.travel[k]);
        motion.position = rules.container.clamp(goal, particles.radii[place as usize]);
        motions.set(place, motion);
    });
}

fn settle(scene: &mut Scene<'_>, rules: &Rules) {
    let (motions, particles) = (scene.motions, scene.particles);
    scene
        .contacts
        .solve(rules.threads, |contact| separate::push_apart(contact, motions, &particles.radii));
    if rules.container.has_walls() {
        each_particle(scene, rules, |place, _| {
            let mut motion = motions.get(place);
            let radius = particles.radii[place as usize];
            motion.position = rules.container.clamp(motion.position, radius);
            motions.set(place, motion);
        });
    }
}
