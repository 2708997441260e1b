//! Forces, apart from gravity and contacts.
//!
//! [`accelerate`] sums the accelerations by attractors, gravitation, and forces between neighbours:
//! those between kinds of particles and flocking. Springs are integrated in parts of a sub-step
//! ([`springs::SpringSolver`]). The thermostat and thermal walls act when particles bounce off
//! walls, Andersen's thermostat at the end of a step. Motors move immovable particles and walls.
//! The order of every sum depends only on the state.

pub mod attractor;
pub mod chance;
pub mod flocking;
pub mod gravitation;
pub mod motor;
mod neighbors;
pub mod pair;
mod sorted;
pub mod springs;
mod tables;
pub mod thermal;
pub mod thermostat;

pub use attractor::{Attractor, Law, Pole};
pub use flocking::Flocking;
pub use gravitation::Gravitation;
pub use motor::Motor;
pub use pair::{PairForce, PairTable};
pub use springs::{Spring, Springs};
pub use thermal::{Andersen, HotWalls, ThermalWalls};
pub use thermostat::Thermostat;

use std::cmp::Ordering;
use std::collections::HashSet;
use std::fmt::Display;

use crate::container::Container;
use crate::particles::{FARTHEST, check_kinds_of_table, check_vectors};
use crate::walls::index_of;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::parallel;
use jostle_base::settings::Method;
use jostle_base::table::sparse_value;

/// A force. It refers to particles by id; within a world, by row.
#[derive(Clone, Debug, PartialEq)]
pub enum Force {
    /// Attraction to a point or to a particle.
    Attractor(Attractor),
    /// Attraction between all particles.
    Gravitation(Gravitation),
    /// Springs between pairs of particles.
    Springs(Springs),
    /// Walls that heat or cool the particles that bounce off them.
    Thermostat(Thermostat),
    /// Sides of the container and walls at a temperature.
    ThermalWalls(ThermalWalls),
    /// New velocities at random times (Andersen's thermostat).
    Andersen(Andersen),
    /// A given motion of immovable particles and walls.
    Motor(Motor),
    /// Forces between kinds of particles within a cutoff.
    Pair(PairForce),
    /// Separation, alignment and cohesion of neighbours.
    Flocking(Flocking),
}

impl Force {
    /// Refuses numbers out of range.
    pub fn validate(&self) -> Result<()> {
        match self {
            Self::Attractor(attractor) => attractor.validate(),
            Self::Gravitation(gravitation) => gravitation.validate(),
            Self::Springs(springs) => springs.validate(),
            Self::Thermostat(thermostat) => thermostat.validate(),
            Self::ThermalWalls(walls) => walls.validate(),
            Self::Andersen(bath) => bath.validate(),
            Self::Motor(motor) => motor.validate(),
            Self::Pair(_) => Ok(()),
            Self::Flocking(flocking) => flocking.validate(),
        }
    }

    /// The particles to which it refers.
    fn named(&self) -> Vec<Id> {
        match self {
            Self::Attractor(Attractor { pole: Pole::Particle(id), .. }) => vec![*id],
            Self::Springs(springs) => springs.0.iter().flat_map(|spring| spring.pair).collect(),
            Self::Motor(motor) => motor.ids.clone(),
            _ => Vec::new(),
        }
    }

    /// The indices of the walls to which it refers.
    pub fn walls(&self) -> &[u32] {
        match self {
            Self::Motor(motor) => &motor.walls,
            Self::ThermalWalls(hot) => &hot.walls,
            _ => &[],
        }
    }

    /// Whether it acts on particles by their rows, also in the sub-steps. Motors only set
    /// velocities before a step.
    fn names_any(&self) -> bool {
        match self {
            Self::Attractor(attractor) => matches!(attractor.pole, Pole::Particle(_)),
            Self::Springs(springs) => !springs.0.is_empty(),
            _ => false,
        }
    }
}

/// Refuses invalid forces; `exists` returns whether the world has a particle.
pub fn validate(forces: &[Force], exists: impl Fn(Id) -> bool) -> Result<()> {
    let (mut thermostats, mut baths, mut hot) = (0, 0, HashSet::new());
    for (index, force) in forces.iter().enumerate() {
        force.validate()?;
        if let Some(id) = force.named().into_iter().find(|&id| !exists(id)) {
            let value = format!("a force on particle {id}");
            return Err(Error::at("forces", index, value, "no particle has this id"));
        }
        thermostats += usize::from(matches!(force, Force::Thermostat(_)));
        if thermostats > 1 {
            let rule = "a world has one thermostat at most";
            return Err(Error::at("forces", index, "another Thermostat", rule));
        }
        baths += usize::from(matches!(force, Force::Andersen(_)));
        if baths > 1 {
            let rule = "a world has one at most";
            return Err(Error::at("forces", index, "another AndersenThermostat", rule));
        }
        if let Force::ThermalWalls(walls) = force
            && let Some(number) = walls.numbers().find(|&number| !hot.insert(number))
        {
            let of_wall = |index| format!("wall {index}");
            let name = index_of(number).map_or(format!("side {number}"), of_wall);
            let rule = format!("{name} has a temperature already");
            return Err(Error::at("forces", index, "another ThermalWalls", &rule));
        }
    }
    Ok(())
}

/// Renumbers particles: `renamed` returns the new id of a particle, None if it was removed.
/// Attractors and springs of a removed particle are removed; motors no longer drive it.
pub fn follow(forces: &mut Vec<Force>, renamed: impl Fn(Id) -> Option<Id>) {
    forces.retain_mut(|force| match force {
        Force::Attractor(Attractor { pole: Pole::Particle(name), .. }) => {
            let new = renamed(*name);
            *name = new.unwrap_or(*name);
            new.is_some()
        }
        Force::Springs(springs) => {
            springs.follow(&renamed);
            true
        }
        Force::Motor(motor) => {
            motor.follow(&renamed);
            true
        }
        _ => true,
    });
}

/// Refuses a torus on which forces between neighbours would act from two images of a particle.
pub fn check_fit(forces: &[Force], container: Container) -> Result<()> {
    let period = container.period();
    let (most, [width, height]) = (0.5 * period.shortest(), period.sides());
    let cutoff = |force: &Force| match force {
        Force::Pair(pair) => pair.table.cutoff(),
        Force::Flocking(flocking) => flocking.cutoff,
        _ => 0.0,
    };
    match forces.iter().position(|force| cutoff(force) > most) {
        None => Ok(()),
        Some(index) => {
            let value = format!("a force with the cutoff {}", cutoff(&forces[index]));
            let rule = format!("on Torus({width}, {height}) a cutoff is at most {most}");
            Err(Error::at("forces", index, value, &rule))
        }
    }
}

/// Refuses thermal walls on sides that a container does not have.
pub fn check_sides(forces: &[Force], container: Container) -> Result<()> {
    for (index, force) in forces.iter().enumerate() {
        if let Force::ThermalWalls(hot) = force
            && let Some(rule) = hot.misfit(container)
        {
            let sides: Vec<u32> =
                hot.numbers().filter(|&number| index_of(number).is_none()).collect();
            let value = format!("ThermalWalls with sides={sides:?}");
            return Err(Error::at("forces", index, value, rule));
        }
    }
    Ok(())
}

/// The largest cutoff of forces between neighbours; 0 without any.
pub fn largest_cutoff(forces: &[Force]) -> f32 {
    let cutoff = |force: &Force| match force {
        Force::Pair(pair) => pair.table.cutoff(),
        Force::Flocking(flocking) => flocking.cutoff,
        _ => 0.0,
    };
    forces.iter().map(cutoff).fold(0.0, f32::max)
}

/// Refuses kinds of particles that the table of a force does not have.
pub fn check_kinds(forces: &[Force], kinds: &[u8]) -> Result<()> {
    pairs(forces).try_for_each(|pair| check_kinds_of_table(kinds, pair.table.kinds()))
}

/// The forces between kinds among them.
pub fn pairs(forces: &[Force]) -> impl Iterator<Item = &PairForce> {
    forces.iter().filter_map(|force| match force {
        Force::Pair(pair) => Some(pair),
        _ => None,
    })
}

/// Whether all that accelerate are forces between neighbours.
pub fn are_short_ranged(forces: &[Force]) -> bool {
    forces.iter().all(|force| !pulls(force) || acts_on_neighbors(force))
}

fn acts_on_neighbors(force: &Force) -> bool {
    matches!(force, Force::Pair(_) | Force::Flocking(_))
}

fn pulls(force: &Force) -> bool {
    acts_on_neighbors(force) || matches!(force, Force::Attractor(_) | Force::Gravitation(_))
}

/// Whether any of them refers to particles.
pub fn name_any(forces: &[Force]) -> bool {
    forces.iter().any(Force::names_any)
}

/// Whether [`accelerate`] sums any of them.
pub fn pull(forces: &[Force]) -> bool {
    forces.iter().any(pulls)
}

/// The motors among them.
pub fn motors(forces: &[Force]) -> impl Iterator<Item = &Motor> {
    forces.iter().filter_map(|force| match force {
        Force::Motor(motor) => Some(motor),
        _ => None,
    })
}

/// The thermostat among them.
pub fn thermostat(forces: &[Force]) -> Option<Thermostat> {
    forces.iter().find_map(|force| match force {
        Force::Thermostat(thermostat) => Some(*thermostat),
        _ => None,
    })
}

/// The thermal walls among them.
pub fn thermal_walls(forces: &[Force]) -> impl Iterator<Item = &ThermalWalls> {
    forces.iter().filter_map(|force| match force {
        Force::ThermalWalls(walls) => Some(walls),
        _ => None,
    })
}

/// Andersen's thermostat among them.
pub fn bath(forces: &[Force]) -> Option<Andersen> {
    forces.iter().find_map(|force| match force {
        Force::Andersen(bath) => Some(*bath),
        _ => None,
    })
}

/// Stands for the index of a particle that is asleep.
pub const ASLEEP: u32 = u32::MAX;

/// The particles as arguments of the forces, in any order.
#[derive(Clone, Copy, Debug)]
pub struct Bodies<'a> {
    /// Centres.
    pub positions: &'a [[f32; 2]],
    /// Velocities.
    pub velocities: &'a [[f32; 2]],
    /// Masses.
    pub masses: &'a [f32],
    /// Radii.
    pub radii: &'a [f32],
    /// Kinds; empty if all are 0.
    pub kinds: &'a [u8],
    /// The row of each.
    pub rows: &'a [u32],
    /// `indices[row]` is the index of the particle in `row`, or [`ASLEEP`]; may be empty if no
    /// force refers to particles.
    pub indices: &'a [u32],
    /// The container; on a torus, offsets are minimum images.
    pub container: Container,
    /// Seconds for which the accelerations act.
    pub seconds: f32,
    /// How neighbours are found. The result is the same.
    pub method: Method,
    /// Number of threads.
    pub threads: Option<usize>,
    /// The AABB of the bodies of all processes, if the world is distributed.
    pub extent: Option<[[f32; 2]; 2]>,
}

impl Bodies<'_> {
    /// The kind of a body.
    pub fn kind(&self, body: usize) -> u8 {
        sparse_value(self.kinds, body)
    }

    /// Orders bodies at the same position by everything that forces between neighbours depend on.
    fn compare(&self, a: usize, b: usize) -> Ordering {
        let numbers = |body: usize| {
            let [u, v] = self.velocities[body];
            [u, v, self.masses[body]]
        };
        let pairs = numbers(a).into_iter().zip(numbers(b));
        let by_numbers = pairs.map(|(a, b)| a.total_cmp(&b)).fold(Ordering::Equal, Ordering::then);
        by_numbers.then_with(|| self.kind(a).cmp(&self.kind(b)))
    }
}

/// Scratch of [`accelerate`].
#[derive(Debug, Default)]
pub struct Scratch {
    gravitation: gravitation::Scratch,
    neighbors: neighbors::Scratch,
}

/// Writes the sum of all accelerations of each body. The sums are finite and do not depend on the
/// order of the bodies.
pub fn accelerate(
    forces: &[Force],
    bodies: &Bodies<'_>,
    scratch: &mut Scratch,
    accelerations: &mut Vec<[f32; 2]>,
) {
    accelerations.clear();
    accelerations.resize(bodies.positions.len(), [0.0; 2]);
    let Scratch { gravitation: gravitation_scratch, neighbors } = scratch;
    if forces.iter().any(acts_on_neighbors) {
        neighbors.sort(bodies, |a, b| bodies.compare(a, b));
    }
    for force in forces {
        match force {
            Force::Attractor(attractor) => attractor::add(attractor, bodies, accelerations),
            Force::Gravitation(gravitation) => {
                gravitation::add(gravitation, bodies, gravitation_scratch, accelerations);
            }
            Force::Pair(pair) => pair::add(pair, bodies, neighbors, accelerations),
            Force::Flocking(flocking) => flocking::add(flocking, bodies, neighbors, accelerations),
            _ => {}
        }
    }
    let threads = parallel::worthwhile(bodies.threads, bodies.positions.len());
    parallel::for_chunks(threads, accelerations, |_, chunk| {
        chunk.iter_mut().for_each(|acceleration| *acceleration = acceleration.map(bounded));
    });
    for force in forces {
        if let Force::Flocking(flocking) = force {
            for (acceleration, &velocity) in accelerations.iter_mut().zip(bodies.velocities) {
                *acceleration = flocking.limited(velocity, *acceleration, bodies.seconds);
            }
        }
    }
}

/// Potential energy of the particles in all forces between kinds: half of that of each pair for
/// each of its bodies whose row is below `own`.
pub fn energy_of_pairs(forces: &[Force], bodies: &Bodies<'_>, own: usize) -> f64 {
    let mut scratch = neighbors::Scratch::default();
    let mut all = pairs(forces).filter(|pair| pair.table.is_reciprocal()).peekable();
    if all.peek().is_some() {
        scratch.sort(bodies, |a, b| bodies.compare(a, b));
    }
    all.map(|pair| pair::energy(pair, bodies, own, &mut scratch)).sum()
}

/// A number within the limits of a world; 0 for NaN.
fn bounded(value: f32) -> f32 {
    if value.is_nan() { 0.0 } else { value.clamp(-FARTHEST, FARTHEST) }
}

/// Refuses a point or a vector that is not finite or out of range.
pub fn check_pair(argument: &'static str, [x, y]: [f32; 2]) -> Result<()> {
    check_vectors(argument, &[[x, y]]).map_err(|_| {
        let rule = format!("both coordinates must be finite and within ±{FARTHEST:e}");
        Error::of(argument, format!("({x}, {y})"), &rule)
    })
}

/// Refuses a number that is not finite or out of range.
fn check_number(argument: &'static str, value: f32, min: f32) -> Result<()> {
    if (min..=FARTHEST).contains(&value) {
        return Ok(());
    }
    let rule = if min == 0.0 {
        format!("it must be finite and between 0 and {FARTHEST:e}")
    } else {
        format!("it must be finite and within ±{FARTHEST:e}")
    };
    Err(Error::of(argument, value, &rule))
}

/// Refuses a list with a value that is given twice.
fn check_distinct<V: Ord + Copy + Display>(argument: &'static str, all: &[V]) -> Result<()> {
    let mut sorted: Vec<(V, usize)> = all.iter().copied().zip(0..).collect();
    sorted.sort_unstable();
    match sorted.windows(2).find(|two| two[0].0 == two[1].0) {
        Some(two) => Err(Error::at(argument, two[1].1, two[1].0, "it is given twice")),
        None => Ok(()),
    }
}
