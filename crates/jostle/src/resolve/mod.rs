//! Contacts change velocities and ways: one sub-step, in six acts.
//!
//! 1. *kick*: gravity, forces and drag, the straight way. Springs act right after it.
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

pub use rest::{AtWall, Leaning};

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use crate::contacts::{COLOURS, Colours, Contact, Contacts};
use crate::container::{Container, MAX_WALLS};
use crate::error::Result;
use crate::forces::Thermostat;
use crate::integrate::{self, Sweep};
use crate::interrupt;
use crate::motion::{Motion, Motions, Velocities};
use crate::parallel;
use crate::particles::Particles;

/// Rounds of bounces in a sub-step; what then still meets, meets in the next.
const IMPACT_ROUNDS: usize = 4;

/// Rounds over the resting contacts in a sub-step.
const REST_ROUNDS: usize = 12;

/// Pairs are in balance when no speed changes by more than this share of the rest speed.
const BALANCED: f32 = 0.0005;

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
    /// What walls do to the speed of what bounces off them.
    pub thermostat: Option<Thermostat>,
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
    /// Memory for a sub-step.
    pub memory: &'a mut Memory,
}

/// What a sub-step needs and the next one uses again.
#[derive(Debug, Default)]
pub struct Memory {
    at_walls: Vec<AtWall>,
    leaning: Vec<Leaning>,
    velocities: Velocities,
}

/// The sub-step of `h` seconds that [`kick`] has begun.
pub fn substep(scene: &mut Scene<'_>, rules: &Rules, h: f32) -> Result<()> {
    measure_all(scene, rules);
    bounce(scene, rules, h)?;
    if rules.rest_speed > 0.0 {
        lean(scene, rules, h)?;
    }
    interrupt::check()?;
    confine(scene, rules);
    guard::guard(scene.contacts, scene.motions, rules.threads);
    interrupt::check()?;
    advance(scene, rules);
    settle(scene, rules);
    Ok(())
}

/// Calls `act` on every movable particle.
fn each_particle(scene: &Scene<'_>, rules: &Rules, act: impl Fn(u32) + Sync + Send) {
    let movable = &scene.particles.movable;
    parallel::for_rows(rules.threads, movable.len(), |place| {
        if movable[place] {
            act(place as u32);
        }
    });
}

/// Begins a sub-step of `h` seconds. `accelerations` are those by forces, halfway along
/// it; empty where there are none.
pub fn kick(scene: &Scene<'_>, rules: &Rules, accelerations: &[[f32; 2]], h: f32) {
    let (motions, Rules { gravity, drag, .. }) = (scene.motions, *rules);
    each_particle(scene, rules, |place| {
        let motion = motions.get(place);
        let kicked = match accelerations.get(place as usize) {
            None => integrate::kick(motion, gravity, drag, h),
            Some(&by) => integrate::kick_and_pull(motion, gravity, by, drag, h),
        };
        motions.set(place, kicked);
    });
}

/// Brings normal and gap of every contact up to date with the positions.
fn measure_all(scene: &mut Scene<'_>, rules: &Rules) {
    measure_contacts(scene.contacts, scene.motions, rules.threads);
}

/// As [`measure_all`] for all of some contacts.
pub fn measure_contacts(contacts: &mut Contacts, motions: &Motions, threads: Option<usize>) {
    contacts.each(threads, |contact| measure(contact, motions));
}

/// As [`measure_all`] for those that pushed, for whoever looks at them afterwards.
pub fn measure_touching(scene: &mut Scene<'_>, rules: &Rules) {
    let motions = scene.motions;
    scene.contacts.each(rules.threads, |contact| {
        if contact.touched {
            measure(contact, motions);
        }
    });
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

/// The number of a turn: rounds have one for each colour and one for the walls. Turn 0 is
/// before all rounds.
fn turn(round: usize, colour: u32) -> u32 {
    1 + round as u32 * (COLOURS as u32 + 2) + colour
}

fn bounce(scene: &mut Scene<'_>, rules: &Rules, h: f32) -> Result<()> {
    let motions = scene.motions;
    let particles = scene.particles;
    for round in 0..IMPACT_ROUNDS {
        interrupt::check()?;
        let any = AtomicBool::new(false);
        // What has not changed since it was looked at last still does not bounce.
        let changed =
            |place: u32, colour: u32| round == 0 || motions.turn(place) >= turn(round - 1, colour);
        scene.contacts.solve(rules.threads, |contact, colour| {
            let [a, b] = contact.places;
            if !changed(a, colour) && !changed(b, colour) {
                return;
            }
            let turn = turn(round, colour);
            if impact::between(contact, motions, rules.rest_speed, h, turn) {
                any.store(true, Ordering::Relaxed);
            }
        });
        if rules.container.has_walls() {
            let walls = COLOURS as u32 + 1;
            each_particle(scene, rules, |place| {
                if !changed(place, walls) {
                    return;
                }
                let restitution = rules.restitution * particles.restitutions[place as usize];
                let motion = motions.get(place);
                let radius = particles.radii[place as usize];
                let bounced = impact::against_walls(motion, radius, restitution, rules, h);
                if let Some(bounced) = bounced {
                    let bounced = rules.thermostat.map_or(bounced, |t| t.drive_motion(bounced, h));
                    motions.set(place, Motion { turn: turn(round, walls), ..bounced });
                    any.store(true, Ordering::Relaxed);
                }
            });
        }
        if !any.into_inner() {
            break;
        }
    }
    Ok(())
}

fn lean(scene: &mut Scene<'_>, rules: &Rules, h: f32) -> Result<()> {
    let (motions, threads) = (scene.motions, rules.threads);
    find_at_walls(scene, rules, h);
    let Memory { leaning, velocities, at_walls, .. } = scene.memory;
    let len = scene.particles.len();
    velocities.resize(len);
    let velocities = &*velocities;
    parallel::for_rows(threads, len, |place| {
        velocities.set(place as u32, motions.velocity(place as u32));
    });
    let contacts = &mut *scene.contacts;
    leaning.resize(contacts.list.len(), Leaning::default());
    parallel::for_chunks_of_two(threads, leaning, &mut contacts.list, |_, leaning, contacts| {
        for (leaning, contact) in leaning.iter_mut().zip(contacts) {
            *leaning = Leaning::of(contact, motions, rules.rest_speed, h);
        }
    });
    let mut pairs = Coloured { colours: contacts.colours(), leaning, threads };
    pairs.each(|leaning| leaning.start(velocities));
    parallel::for_chunks(threads, at_walls, |_, chunk| {
        chunk.iter_mut().for_each(|at_wall| at_wall.start(velocities));
    });
    pairs.each(|leaning| leaning.calm(velocities, rules.rest_speed, h));
    for _ in 0..REST_ROUNDS {
        interrupt::check()?;
        let most = pairs.most(|leaning| leaning.correct(velocities));
        parallel::for_chunks(threads, at_walls, |_, chunk| {
            chunk.iter_mut().for_each(|at_wall| at_wall.correct(velocities, h));
        });
        if most < BALANCED * rules.rest_speed {
            break;
        }
    }
    for at_wall in at_walls.iter() {
        scene.wall_pushes[at_wall.place as usize] = at_wall.pushes;
    }
    parallel::for_chunks_of_two(threads, leaning, &mut contacts.list, |_, leaning, contacts| {
        leaning.iter().zip(contacts).for_each(|(leaning, contact)| leaning.tell(contact));
    });
    let velocities = &scene.memory.velocities;
    each_particle(scene, rules, |place| {
        motions.set(place, rest::resume(motions.get(place), velocities.get(place), h));
    });
    Ok(())
}

/// Pairs that lean, colour by colour.
struct Coloured<'a> {
    colours: Colours,
    leaning: &'a mut [Leaning],
    threads: Option<usize>,
}

impl Coloured<'_> {
    /// Calls `act` on every pair, colour after colour.
    fn each(&mut self, act: impl Fn(&mut Leaning) + Sync + Send) {
        self.chunks(|chunk| chunk.iter_mut().for_each(&act));
    }

    /// As `each`; returns the largest of what `act` returns, and at least 0.
    fn most(&mut self, act: impl Fn(&mut Leaning) -> f32 + Sync + Send) -> f32 {
        // The bits of numbers that are not negative are in the order of the numbers.
        let most = AtomicU32::new(0);
        self.chunks(|chunk| {
            let largest = chunk.iter_mut().map(&act).fold(0.0f32, f32::max);
            most.fetch_max(largest.to_bits(), Ordering::Relaxed);
        });
        f32::from_bits(most.into_inner())
    }

    fn chunks(&mut self, act: impl Fn(&mut [Leaning]) + Sync + Send) {
        for (colour, range) in self.colours.iter().enumerate() {
            let leaning = &mut self.leaning[range.clone()];
            let threads = if colour == COLOURS { Some(1) } else { self.threads };
            parallel::for_chunks(threads, leaning, |_, chunk| act(chunk));
        }
    }
}

/// Lists the movable particles that may touch a wall.
fn find_at_walls(scene: &mut Scene<'_>, rules: &Rules, h: f32) {
    let Scene { particles, motions, wall_pushes, memory, .. } = scene;
    let at_walls = &mut memory.at_walls;
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

fn confine(scene: &Scene<'_>, rules: &Rules) {
    let (motions, sweeps, particles) = (scene.motions, scene.sweeps, scene.particles);
    each_particle(scene, rules, |place| {
        let row = place as usize;
        let (sweep, radius) = (&sweeps[row], particles.radii[row]);
        motions.set(place, integrate::confine(motions.get(place), sweep, &rules.container, radius));
    });
}

fn advance(scene: &Scene<'_>, rules: &Rules) {
    let (motions, particles) = (scene.motions, scene.particles);
    each_particle(scene, rules, |place| {
        let mut motion = motions.get(place);
        let goal = [0, 1].map(|k| motion.position[k] + motion.travel[k]);
        motion.position = rules.container.clamp(goal, particles.radii[place as usize]);
        motions.set(place, motion);
    });
}

/// Pushes apart what overlaps, and back inside what overlaps the walls.
pub fn settle(scene: &mut Scene<'_>, rules: &Rules) {
    let (motions, particles) = (scene.motions, scene.particles);
    scene.contacts.solve(rules.threads, |contact, _| {
        separate::push_apart(contact, motions, &particles.radii)
    });
    if rules.container.has_walls() {
        each_particle(scene, rules, |place| {
            let mut motion = motions.get(place);
            let radius = particles.radii[place as usize];
            motion.position = rules.container.clamp(motion.position, radius);
            motions.set(place, motion);
        });
    }
}
