//! Springs between pairs of particles.
//!
//! Springs are much stiffer than the other forces, so they act in parts of a sub-step.
//! The stiffest spring determines the number of parts, up to a limit; springs that need
//! more are softened. Each part is a leapfrog step: half of the displacement, the change
//! of velocity, the other half.

use super::{Bodies, check_number, nearest};
use crate::container::Container;
use crate::error::{Error, Result};
use crate::flow::Kick;
use crate::groups::Groups;
use crate::motion::Motions;
use crate::particles::FARTHEST;
use crate::space::Id;

/// Parts of a sub-step at most.
const MOST_PARTS: f64 = 32.0;

/// Phase of the fastest spring in one part, in radians: its period is right to 0.2 %.
const SWING: f64 = 0.2;

/// The same with the maximum number of parts: still stable.
const MOST_SWING: f64 = 1.0;

/// Largest relative change of a velocity by damping in one part.
const MOST_DAMPING: f64 = 0.25;

/// F = stiffness · (L − length) + damping · dL/dt along the line between two particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// Ids of its ends.
    pub pair: [Id; 2],
    /// Its length at rest.
    pub length: f32,
    /// Force for each unit of length.
    pub stiffness: f32,
    /// Force for each unit of speed at which it gets longer.
    pub damping: f32,
    /// It breaks if its length exceeds that at rest by more than this; infinite for never.
    pub max_stretch: f32,
}

/// Some springs, in any order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Springs(pub Vec<Spring>);

impl Springs {
    /// Refuses numbers out of range.
    pub fn validate(&self) -> Result<()> {
        for (index, spring) in self.0.iter().enumerate() {
            let [i, j] = spring.pair;
            if i == j {
                let value = format!("({i}, {j})");
                return Err(Error::at("pairs", index, value, "a spring has two ends"));
            }
            let numbers = [
                ("lengths", spring.length),
                ("stiffness", spring.stiffness),
                ("damping", spring.damping),
            ];
            for (argument, value) in numbers {
                check_number(argument, value, 0.0).map_err(|error| error.in_row(index))?;
            }
            if spring.max_stretch.is_nan() || spring.max_stretch < 0.0 {
                let rule = "it must be at least 0";
                return Err(Error::at("max_stretch", index, spring.max_stretch, rule));
            }
        }
        Ok(())
    }

    /// Renames particles, see [`follow`](super::follow). Springs of removed particles are removed,
    /// and springs whose ends merged into one particle.
    pub fn follow(&mut self, renamed: impl Fn(Id) -> Option<Id>) {
        self.0.retain_mut(|spring| {
            let [i, j] = spring.pair.map(&renamed);
            let both = i.zip(j);
            spring.pair = both.map_or(spring.pair, |(i, j)| [i, j]);
            both.is_some_and(|(i, j)| i != j)
        });
    }

    /// Sum of ½ · stiffness · stretch².
    pub fn energy(&self, bodies: &Bodies<'_>) -> f64 {
        let energy = |spring: &Spring| {
            let stretch = length(spring, bodies) - f64::from(spring.length);
            0.5 * f64::from(spring.stiffness) * stretch * stretch
        };
        let mut all: Vec<f64> = self.0.iter().map(energy).collect();
        // The sum must not depend on the order of the springs.
        all.sort_unstable_by(f64::total_cmp);
        all.iter().sum()
    }

    /// Removes springs that are stretched too far.
    pub fn break_stretched(&mut self, bodies: &Bodies<'_>) {
        self.0.retain(|spring| {
            spring.max_stretch == f32::INFINITY
                || length(spring, bodies) - f64::from(spring.length)
                    <= f64::from(spring.max_stretch)
        });
    }
}

/// The length of a spring.
fn length(spring: &Spring, bodies: &Bodies<'_>) -> f64 {
    let [a, b] = spring.pair.map(|row| bodies.positions[bodies.places[row as usize] as usize]);
    let [x, y] = nearest(&bodies.container, [0, 1].map(|k| b[k] - a[k])).map(f64::from);
    (x * x + y * y).sqrt()
}

/// Writes an estimate of the displacement of each particle by springs in a step of `dt` into
/// `reaches[place]`. All particles of an island have the largest one, because an impact on one end
/// may move the other within the step.
pub fn reach<'a>(
    springs: impl Iterator<Item = &'a Spring> + Clone,
    bodies: &Bodies<'_>,
    velocities: &[[f32; 2]],
    dt: f32,
    groups: &mut Groups,
    reaches: &mut Vec<f32>,
) {
    groups.reset(bodies.positions.len());
    reaches.clear();
    reaches.resize(bodies.positions.len(), 0.0);
    for spring in springs.clone() {
        let [a, b] = spring.pair.map(|row| bodies.places[row as usize]);
        groups.join(a, b);
    }
    let places = |spring: &Spring| spring.pair.map(|row| bodies.places[row as usize] as usize);
    for spring in springs.clone() {
        let places = places(spring);
        let speed = |place: usize| {
            let [x, y] = velocities[place].map(f64::from);
            (x * x + y * y).sqrt()
        };
        let masses = places.map(|place| f64::from(bodies.masses[place]));
        let stretch = (length(spring, bodies) - f64::from(spring.length)).abs();
        let swing = stretch * (f64::from(spring.stiffness) / masses[0].min(masses[1])).sqrt();
        let fastest = speed(places[0]).max(speed(places[1])) + swing;
        let of_all = &mut reaches[groups.root(places[0] as u32) as usize];
        *of_all = of_all.max((fastest * f64::from(dt)) as f32);
    }
    for place in springs.flat_map(places) {
        reaches[place] = reaches[groups.root(place as u32) as usize];
    }
}

/// The springs of a world in one step, in an order that comes from the state.
#[derive(Debug, Default)]
pub struct Sprung {
    ties: Vec<Tie>,
    ends: Vec<End>,
    container: Container,
}

/// A spring between two ends.
#[derive(Clone, Copy, Debug)]
struct Tie {
    ends: [u32; 2],
    length: f64,
    stiffness: f64,
    damping: f64,
}

/// A particle with springs.
#[derive(Clone, Copy, Debug, Default)]
struct End {
    place: u32,
    inverse_mass: f64,
    /// Sum of the stiffness of its springs over its mass.
    stiffness: f64,
    /// Sum of their damping over its mass.
    damping: f64,
    position: [f64; 2],
    velocity: [f64; 2],
    change: [f64; 2],
}

impl Sprung {
    /// Whether there is no spring.
    pub fn is_empty(&self) -> bool {
        self.ties.is_empty()
    }

    /// Replaces all springs; `inverse_mass` is 0 for immovable particles.
    pub fn prepare<'a>(
        &mut self,
        springs: impl Iterator<Item = &'a Spring>,
        places: &[u32],
        container: Container,
        inverse_mass: impl Fn(usize) -> f32,
    ) {
        let Self { ties, ends, .. } = self;
        self.container = container;
        ties.clear();
        ties.extend(springs.map(|spring| {
            let [a, b] = spring.pair.map(|row| places[row as usize]);
            Tie {
                ends: [a.min(b), a.max(b)],
                length: f64::from(spring.length),
                stiffness: f64::from(spring.stiffness),
                damping: f64::from(spring.damping),
            }
        }));
        ties.sort_unstable_by(|a, b| {
            let numbers = |tie: &Tie| [tie.length, tie.stiffness, tie.damping];
            let pairs = numbers(a).into_iter().zip(numbers(b));
            let by_numbers = pairs.map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne());
            a.ends.cmp(&b.ends).then(by_numbers.unwrap_or(std::cmp::Ordering::Equal))
        });
        ends.clear();
        ends.extend(ties.iter().flat_map(|tie| tie.ends).map(|place| End {
            place,
            inverse_mass: f64::from(inverse_mass(place as usize)),
            ..End::default()
        }));
        ends.sort_unstable_by_key(|end| end.place);
        ends.dedup_by_key(|end| end.place);
        for tie in ties.iter_mut() {
            tie.ends = tie.ends.map(|place| {
                ends.binary_search_by_key(&place, |end| end.place).expect("every end is listed")
                    as u32
            });
            for end in tie.ends {
                let end = &mut ends[end as usize];
                end.stiffness += tie.stiffness * end.inverse_mass;
                end.damping += tie.damping * end.inverse_mass;
            }
        }
    }

    /// Adds the effect of the springs in a sub-step of `step` seconds to the kicks: the flight gets
    /// their mean velocity, and the velocity after it is the last one.
    pub fn act(&mut self, motions: &Motions, kicks: &mut [Kick], step: f64) {
        let parts = self.parts(step);
        let part = step / parts;
        let Self { ties, ends, container } = self;
        for end in ends.iter_mut() {
            end.position = motions.position(end.place).map(f64::from);
            let velocity = motions.velocity(end.place);
            let kick = &kicks[end.place as usize];
            end.velocity = [0, 1].map(|k| f64::from(velocity[k]) + kick.before[k]);
        }
        // Springs that are too stiff for the parts are softened (Gershgorin's bound).
        let most_stiff = 0.5 * (MOST_SWING / part) * (MOST_SWING / part);
        let most_damped = MOST_DAMPING / part;
        let soften = |most: f64, own: f64| if own > most { most / own } else { 1.0 };
        for _ in 0..parts as usize {
            ends.iter_mut().for_each(|end| end.drift(0.5 * part));
            for tie in ties.iter() {
                let [a, b] = tie.ends.map(|end| ends[end as usize]);
                let softer = soften(most_stiff, a.stiffness).min(soften(most_stiff, b.stiffness));
                let less = soften(most_damped, a.damping).min(soften(most_damped, b.damping));
                let impulse = tie.pull(&a, &b, container, [softer, less]).map(|v| v * part);
                for (end, sign) in tie.ends.into_iter().zip([1.0, -1.0]) {
                    let end = &mut ends[end as usize];
                    let by = |k: usize| end.change[k] + sign * impulse[k] * end.inverse_mass;
                    end.change = [by(0), by(1)];
                }
            }
            for end in ends.iter_mut() {
                end.velocity = [0, 1].map(|k| end.velocity[k] + end.change[k]);
                end.change = [0.0; 2];
                end.drift(0.5 * part);
            }
        }
        for end in ends.iter().filter(|end| end.inverse_mass > 0.0) {
            let motion = motions.get(end.place);
            let kick = &mut kicks[end.place as usize];
            let mean = [0, 1].map(|k| {
                let displacement = end.position[k] - f64::from(motion.position[k]);
                bounded(displacement / step)
            });
            let last = end.velocity.map(bounded);
            kick.before = [0, 1].map(|k| mean[k] - f64::from(motion.velocity[k]));
            kick.after = [0, 1].map(|k| kick.after[k] + (last[k] - mean[k]));
        }
    }

    /// The number of parts of a sub-step.
    fn parts(&self, h: f64) -> f64 {
        let most = |number: fn(&End) -> f64| self.ends.iter().map(number).fold(0.0, f64::max);
        let swings = (2.0 * most(|end| end.stiffness)).sqrt() * h / SWING;
        let damped = most(|end| end.damping) * h / MOST_DAMPING;
        swings.max(damped).ceil().clamp(1.0, MOST_PARTS)
    }
}

/// A velocity within the limits of a world; 0 for NaN.
fn bounded(value: f64) -> f64 {
    let most = f64::from(FARTHEST);
    if value.is_nan() { 0.0 } else { value.clamp(-most, most) }
}

impl End {
    fn drift(&mut self, time: f64) {
        self.position = [0, 1].map(|k| self.position[k] + self.velocity[k] * time);
    }
}

impl Tie {
    /// The force on its first end.
    fn pull(&self, a: &End, b: &End, container: &Container, [softer, less]: [f64; 2]) -> [f64; 2] {
        let offset = container.short_way([0, 1].map(|k| b.position[k] - a.position[k]));
        let [x, y] = offset;
        let length = (x * x + y * y).sqrt();
        if length == 0.0 {
            return [0.0; 2];
        }
        let along = offset.map(|v| v / length);
        let parting =
            along[0] * (b.velocity[0] - a.velocity[0]) + along[1] * (b.velocity[1] - a.velocity[1]);
        let force =
            softer * self.stiffness * (length - self.length) + less * self.damping * parting;
        along.map(|v| v * force)
    }
}
